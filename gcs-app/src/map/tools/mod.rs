//! Map tools. A tool is a value that gets what the pointer and the keys do over the map, answers with
//! commands, and paints. It sees no widgets: the toolbox turns what it offers to be grabbed into widgets
//! with names, so that screen readers and tests find them, and keeps what is dragged under the pointer.
//!
//! To add a tool: a file here with a value that implements [`Tool`], and its line in [`all`].

mod draw_leg;
mod group;
mod guided;
mod measure;
pub mod new_leg;
pub(super) mod pen;
pub(super) mod pick;
pub mod select;
mod sweep;
mod thing;
mod track;

use super::items::ring;
use super::sketch::{Handled, Sketch};
use super::view::View;
use crate::command::{Queue, Selection};
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{Context, CursorIcon, Key, Modifiers, Painter, Pos2, Rect, Response, Role, Sense, Ui, Vec2};
use flight_plan::{Place, Value};
use geometry::LatLon;
use pen::Mark;
use sweep::Sweep;

/// All tools, in the order of the toolbar. The first one is in use unless another one is chosen.
fn all() -> Vec<Box<dyn Tool>> {
    vec![
        Box::new(select::Select::default()),
        Box::new(track::Track::default()),
        Box::new(draw_leg::DrawLeg::new(&draw_leg::AREA)),
        Box::new(draw_leg::DrawLeg::new(&draw_leg::LINE)),
        Box::new(draw_leg::DrawLeg::new(&draw_leg::CIRCLE)),
        Box::new(thing::PlaceFix),
        Box::new(thing::DrawZone::default()),
        Box::new(thing::DrawRunway::default()),
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
    /// What is drawn near a fix means the fix; Alt holds that off.
    pub snaps: bool,
}

/// A place so near to a fix means the fix, screen points.
const SNAP: f32 = 12.0;

/// The place under the pointer: a fix, the threshold of a runway, or the ground.
fn snap(at: Pos2, canvas: &Canvas<'_>) -> Mark {
    let is_near = |place: LatLon| canvas.snaps && canvas.view.place(place).distance(at) < SNAP;
    let fixes = canvas.sketch.handles.iter().filter_map(|handle| match &handle.what {
        Handled::Fix(id) => Some((id, handle.at)),
        _ => None,
    });
    if let Some((id, at)) = fixes.into_iter().find(|(_, at)| is_near(*at)) {
        return Mark { place: Place::Fix(id.clone()), at };
    }
    let thresholds = canvas.scene.document.plan().runways.iter().map(|runway| runway.threshold);
    let at = thresholds.into_iter().find(|at| is_near(*at)).unwrap_or_else(|| canvas.view.geo(at));
    Mark { place: Place::Position(Value::Constant(at)), at }
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

    /// Choices about what it draws, beside its status.
    fn options(&mut self, _ui: &mut Ui, _scene: &Scene<'_>) {}

    /// What can be grabbed now.
    fn grips(&self, _canvas: &Canvas<'_>) -> Vec<Grip> {
        Vec::new()
    }

    /// The pointer is here; `None`: it is not over the map.
    fn hover(&mut self, _at: Option<Pos2>, _canvas: &Canvas<'_>) {}

    /// The map or a grip was clicked, or a grip begins to be dragged.
    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue);

    /// What the last press may have meant, if that is several things; asked for once.
    fn among(&mut self) -> Vec<Selection> {
        Vec::new()
    }

    /// The map was clicked twice: what is drawn ends here. Both clicks were presses before.
    fn finish(&mut self, _canvas: &Canvas<'_>, _queue: &mut Queue) {}

    /// A grip is dragged to a place of the screen.
    fn drag(&mut self, grip: usize, to: Pos2, canvas: &Canvas<'_>, queue: &mut Queue);

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

    /// Another tool is chosen.
    fn leave(&mut self) {}

    /// How the pointer looks over the map.
    fn cursor(&self) -> CursorIcon {
        CursorIcon::Default
    }

    /// Draws what belongs to it.
    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, touch: Touch, p: &Palette);
}

/// Keys that a tool in use may take.
const KEYS: [Key; 4] = [Key::Escape, Key::Enter, Key::Backspace, Key::Delete];
/// Reach of a grip, screen points.
const REACH: f32 = 18.0;

/// The tools, and the one in use.
#[derive(Debug)]
pub struct Toolbox {
    tools: Vec<Box<dyn Tool>>,
    current: usize,
    /// From the pointer to the grip when the drag began, so that nothing jumps.
    offset: Vec2,
    /// Keys that the tool in use has not seen yet.
    pressed: Vec<Key>,
    sweep: Sweep,
    /// Draws the answers to the guide to a new plan.
    guided: guided::Guided,
    /// The guide asks for something: its tool is in use, whichever was chosen.
    is_guided: bool,
}

impl Default for Toolbox {
    fn default() -> Self {
        Self {
            tools: all(),
            current: 0,
            offset: Vec2::ZERO,
            sweep: Sweep::default(),
            pressed: Vec::new(),
            guided: guided::Guided::default(),
            is_guided: false,
        }
    }
}

impl Toolbox {
    /// Each tool's card, and whether it is in use.
    pub fn cards(&self) -> impl Iterator<Item = (&'static Card, bool)> {
        let current = (!self.is_guided).then_some(self.current);
        self.tools.iter().enumerate().map(move |(i, tool)| (tool.card(), Some(i) == current))
    }

    /// The plan's places can be grabbed now.
    pub fn offers_handles(&self) -> bool {
        !self.is_guided && self.current == 0
    }

    fn in_use(&self) -> Option<&dyn Tool> {
        if self.is_guided {
            return Some(&self.guided);
        }
        self.tools.get(self.current).map(AsRef::as_ref)
    }

    /// Something is being drawn around: the map stays where it is.
    pub fn is_sweeping(&self) -> bool {
        self.sweep.is_active()
    }

    /// What the tool in use says.
    pub fn status(&self, scene: &Scene<'_>) -> Option<String> {
        self.in_use()?.status(scene)
    }

    /// Draws the choices that the tool in use offers.
    pub fn options(&mut self, ui: &mut Ui, scene: &Scene<'_>) {
        if let Some(tool) = self.tools.get_mut(self.current) {
            tool.options(ui, scene);
        }
    }

    /// Puts the tool of this name to use; of none, the first.
    pub fn choose(&mut self, id: &str) {
        let next = self.tools.iter().position(|tool| tool.card().id == id).unwrap_or(0);
        if next == self.current {
            return;
        }
        if let Some(left) = self.tools.get_mut(self.current) {
            left.leave();
        }
        self.current = next;
        self.pressed.clear();
    }

    /// Keys that the tool in use takes. Escape ends its gesture, then the mode.
    pub fn keys(&mut self, ctx: &Context) {
        let pressed = |key: Key| ctx.input(|i| i.modifiers.is_none() && i.key_pressed(key));
        let consume = |key: Key| ctx.input_mut(|i| i.consume_key(Modifiers::NONE, key));
        for key in KEYS.into_iter().filter(|key| pressed(*key)) {
            let wanted = self.in_use().is_some_and(|tool| tool.wants(key));
            if wanted || (key == Key::Escape && self.current != 0) {
                consume(key);
            }
            if wanted {
                self.pressed.push(key);
            } else if key == Key::Escape {
                self.choose("");
            }
        }
    }

    /// Passes what happened on the map to the tool in use, and lets it paint. Gives what a menu was asked for.
    pub fn run(
        &mut self,
        ui: &Ui,
        map: &Response,
        canvas: &Canvas<'_>,
        queue: &mut Queue,
        p: &Palette,
    ) -> Option<Asked> {
        self.is_guided = is_guided(canvas.scene);
        let tool: &mut dyn Tool = match self.is_guided {
            true => &mut self.guided,
            false => self.tools.get_mut(self.current)?.as_mut(),
        };
        tool.hover(map.hover_pos(), canvas);
        for key in std::mem::take(&mut self.pressed) {
            tool.key(key, canvas, queue);
        }
        if map.hovered() {
            ui.ctx().set_cursor_icon(tool.cursor());
        }
        let mut touch = Touch::default();
        let mut asks = map.secondary_clicked();
        for grip in tool.grips(canvas) {
            let response = widget(ui, &grip);
            if response.hovered() {
                touch.hovered = Some(grip.key);
                ui.ctx().set_cursor_icon(CursorIcon::Grab);
            }
            if response.dragged() {
                touch.dragged = Some(grip.key);
            }
            if response.has_focus() {
                ring(ui.painter(), grip.at, p);
            }
            asks |= response.secondary_clicked();
            react(tool, &mut self.offset, &response, &grip, canvas, queue);
        }
        if map.double_clicked() || map.triple_clicked() {
            tool.finish(canvas, queue);
        } else if map.clicked()
            && let Some(at) = map.interact_pointer_pos()
        {
            tool.press(Pointer { at, grip: None, adds: adds(ui.ctx()), clicks: true }, canvas, queue);
        }
        if let Some(area) = self.sweep.follow(map) {
            tool.sweep(area, canvas, queue);
        }
        tool.paint(ui.painter(), canvas, touch, p);
        self.sweep.paint(ui.painter(), p);
        let at = ui.input(|i| i.pointer.interact_pos())?;
        match tool.among() {
            _ if asks => Some(Asked::Menu(at)),
            several if several.len() > 1 => Some(Asked::Which(at, several)),
            _ => None,
        }
    }
}

/// What the pointer asks for.
#[derive(Debug, Clone, PartialEq)]
pub enum Asked {
    /// What can be done here.
    Menu(Pos2),
    /// Which of these is meant.
    Which(Pos2, Vec<Selection>),
}

/// A click with Shift or Ctrl adds to what is selected.
fn adds(ctx: &Context) -> bool {
    ctx.input(|i| i.modifiers.shift || i.modifiers.command)
}

fn widget(ui: &Ui, grip: &Grip) -> Response {
    let rect = Rect::from_center_size(grip.at, Vec2::splat(REACH));
    let response = ui.interact(rect, ui.scope_id().with(&grip.name), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(Role::Button, true, &grip.name));
    response
}

/// Turns what happened to a grip's widget into what the tool understands.
fn react(
    tool: &mut dyn Tool,
    offset: &mut Vec2,
    response: &Response,
    grip: &Grip,
    canvas: &Canvas<'_>,
    queue: &mut Queue,
) {
    let pointer = response.interact_pointer_pos();
    if response.clicked() || response.drag_started() {
        let pointer = Pointer {
            at: pointer.unwrap_or(grip.at),
            grip: Some(grip.key),
            adds: response.clicked() && adds(&response.ctx),
            clicks: response.clicked(),
        };
        tool.press(pointer, canvas, queue);
    }
    let Some(pointer) = pointer else { return };
    if response.drag_started() {
        let pressed = response.ctx.input(|i| i.pointer.press_origin()).unwrap_or(pointer);
        *offset = grip.at - pressed;
    }
    if response.dragged() && response.drag_delta() != Vec2::ZERO {
        tool.drag(grip.key, pointer + *offset, canvas, queue);
    }
    if response.drag_stopped() {
        *offset = Vec2::ZERO;
        tool.release(queue);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_tool_has_a_name_and_a_key_of_its_own() {
        let toolbox = Toolbox::default();
        let cards: Vec<&Card> = toolbox.cards().map(|(card, _)| card).collect();
        let ids: BTreeSet<&str> = cards.iter().map(|c| c.id).collect();
        let keys: BTreeSet<Key> = cards.iter().map(|c| c.key).collect();
        assert_eq!((ids.len(), keys.len()), (cards.len(), cards.len()));
        // keys of the window: fit, and the cursor
        assert!(!keys.contains(&Key::F) && !keys.contains(&Key::Space));
    }

    #[test]
    fn an_unknown_tool_is_the_first_one() {
        let mut toolbox = Toolbox::default();
        toolbox.choose("measure");
        assert_ne!(toolbox.current, 0);
        toolbox.choose("no such tool");
        assert_eq!(toolbox.current, 0);
    }
}
