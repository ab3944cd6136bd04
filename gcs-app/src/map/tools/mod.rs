//! Map tools. A tool is a value that gets what the pointer and the keys do over the map, answers with
//! commands, and paints. It sees no widgets: the toolbox turns what it offers to be grabbed into widgets
//! with names, so that screen readers and tests find them, and keeps what is dragged under the pointer.
//!
//! To add a tool: a file here with a value that implements [`Tool`], and its line in [`all`].

mod bands;
mod besides;
mod corner;
mod crossing;
mod draw_leg;
mod emergency;
mod framed;
mod group;
mod guided;
mod handles;
mod hole;
mod measure;
pub mod new_leg;
pub(super) mod pen;
pub(super) mod pick;
mod procedure;
pub mod select;
mod snap;
mod sweep;
mod thing;
mod toolbox;
mod track;
mod trial;
mod typed;
mod whole;

pub(super) use bands::in_force;
pub(super) use handles::{Near, near};
pub use toolbox::{Toolbox, has_left};

use super::names::Names;
use super::sketch::Sketch;
use super::view::View;
use crate::command::{Queue, Selection};
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{CursorIcon, Key, Painter, Pos2, Rect, Ui};
use geometry::LatLon;
use new_leg::Side;
use pen::Mark;
use snap::snap;
use std::cell::RefCell;

/// All tools, in the order of the toolbar. The first one is in use unless another one is chosen.
fn all() -> Vec<Box<dyn Tool>> {
    vec![
        Box::new(select::Select::default()),
        Box::new(track::Track::default()),
        Box::new(draw_leg::DrawLeg::new(&draw_leg::AREA)),
        Box::new(draw_leg::DrawLeg::new(&draw_leg::LINE)),
        Box::new(draw_leg::DrawLeg::new(&draw_leg::CIRCLE)),
        Box::new(hole::CutHole::default()),
        Box::new(thing::PlaceFix::default()),
        Box::new(thing::DrawZone::default()),
        Box::new(thing::DrawRunway::default()),
        Box::new(procedure::PlaceProcedure::default()),
        Box::new(emergency::DrawEmergency::default()),
        Box::new(measure::Measure::default()),
    ]
}

/// The guide to a new plan has the map: no tool can be chosen.
pub fn is_guided(scene: &Scene<'_>) -> bool {
    guided::Guided::is_wanted(scene)
}

/// What a tool is called.
#[derive(Debug, PartialEq, Eq)]
pub struct Card {
    /// Never changes.
    pub id: &'static str,
    /// For people.
    pub name: &'static str,
    /// On its button.
    pub symbol: &'static str,
    /// Chooses it.
    pub key: Key,
}

/// What a tool sees of the map.
#[derive(Debug, Clone, Copy)]
pub struct Canvas<'a> {
    /// Where things are on the screen.
    pub view: &'a View,
    /// The plan's places.
    pub sketch: &'a Sketch,
    /// Everything else there is to know.
    pub scene: &'a Scene<'a>,
    /// What of the plan's places is on the screen and can be grabbed.
    pub near: &'a [Near<'a>],
    /// Where the pointer is over the map or what can be grabbed there, or was pressed; not while Shift draws around something.
    pub pointer: Option<Pos2>,
    /// What is drawn near a fix means the fix; Alt holds that off.
    pub snaps: bool,
    /// Where the names of the plan's places are asked for.
    pub names: &'a RefCell<Names>,
}

/// Something that can be grabbed.
#[derive(Debug, Clone, PartialEq)]
pub struct Grip {
    /// The tool's own number of it.
    pub key: usize,
    /// For people; two grips of a tool never have the same name.
    pub name: String,
    /// Where it is, on the screen.
    pub at: Pos2,
    /// It is there however many others are.
    pub first: bool,
}

/// Where the pointer is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pointer {
    /// On the screen.
    pub at: Pos2,
    /// The grip under it.
    pub grip: Option<usize>,
    /// With Shift or Ctrl: what is there is selected besides what is.
    pub adds: bool,
    /// It is a click; else a drag begins.
    pub clicks: bool,
}

/// What the pointer does to the grips.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Touch {
    /// It is over this one.
    pub hovered: Option<usize>,
    /// It drags this one.
    pub dragged: Option<usize>,
}

/// A map tool. Each method says what happened; what it should lead to goes into the queue.
pub trait Tool: std::fmt::Debug {
    /// What it is called.
    fn card(&self) -> &'static Card;

    /// What it is for, or what it has found out, as a short sentence; the first tool needs none.
    fn status(&self, _scene: &Scene<'_>) -> Option<String> {
        None
    }

    /// It waits for the result of work on another thread.
    fn is_busy(&self) -> bool {
        false
    }

    /// Choices about what it draws, beside its status.
    fn options(&mut self, _ui: &mut Ui, _scene: &Scene<'_>, _queue: &mut Queue) {}

    /// What can be grabbed now.
    fn grips(&self, _canvas: &Canvas<'_>) -> Vec<Grip> {
        Vec::new()
    }

    /// The pointer is here; `None`: it is not over the map.
    fn hover(&mut self, _at: Option<Pos2>, _canvas: &Canvas<'_>) {}

    /// The map or a grip was clicked, or a grip begins to be dragged.
    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        self.put(snap(pointer.at, canvas), canvas, queue);
    }

    /// A place was clicked, or typed.
    fn put(&mut self, _mark: Mark, _canvas: &Canvas<'_>, _queue: &mut Queue) {}

    /// Places can be typed; the last one that was drawn, from which a bearing and a distance count. `None`: it takes none.
    fn typed_from(&self) -> Option<Option<LatLon>> {
        None
    }

    /// What the last press may have meant, if that is several things; asked for once.
    fn among(&mut self) -> Vec<Selection> {
        Vec::new()
    }

    /// The map was clicked twice: what is drawn ends here. Both clicks were presses before.
    fn finish(&mut self, _canvas: &Canvas<'_>, _queue: &mut Queue) {}

    /// A grip is dragged to a place of the screen.
    fn drag(&mut self, _grip: usize, _to: Pos2, _canvas: &Canvas<'_>, _queue: &mut Queue) {}

    /// A part of the screen was drawn around with Shift.
    fn sweep(&mut self, _area: Rect, _canvas: &Canvas<'_>, _queue: &mut Queue) {}

    /// The drag is over.
    fn release(&mut self, _queue: &mut Queue) {}

    /// Does a key of [`KEYS`] mean something here now?
    fn wants(&self, _key: Key) -> bool {
        false
    }

    /// A key that it wants was pressed.
    fn key(&mut self, _key: Key, _canvas: &Canvas<'_>, _queue: &mut Queue) {}

    /// It was chosen while it is in use: its other choice, where it has one.
    fn again(&mut self) {}

    /// What it draws next goes there, seen from the selected leg.
    fn aim_at(&mut self, _side: Side) {}

    /// Another tool is chosen.
    fn leave(&mut self) {}

    /// How the pointer looks over the map.
    fn cursor(&self) -> CursorIcon {
        CursorIcon::Default
    }

    /// Draws what belongs to it.
    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, touch: Touch, p: &Palette);
}

/// What the pointer asks for.
#[derive(Debug, Clone, PartialEq)]
pub enum Asked {
    /// What can be done here.
    Menu(Pos2),
    /// Which of these is meant.
    Which(Pos2, Vec<Selection>),
}
