//! Rows on their way to another place: a line shows where they would go, or a sentence why they can't.

use super::alternates;
use super::drop::{At, Found, LegSpot, Mark, for_alternate, for_branch, for_legs, for_stage, for_thing};
use super::row::{HEIGHT, depth, indent};
use super::rows::Row;
use crate::command::{BranchId, Queue, Selection};
use crate::panels::Scene;
use crate::panels::binding::DraggedVariable;
use crate::theme;
use egui::containers::menu::menu_style;
use egui::{
    Area, CursorIcon, DragAndDrop, Frame, Id as WidgetId, Key, Layout, Order, Popup, PopupAnchor, PopupKind,
    Pos2, Rect, RichText, Stroke, StrokeKind, Ui, pos2, vec2,
};
use flight_plan::create::{self, StageSpot};
use flight_plan::{Edit, FlightPlan, Id};

/// From one row to the next, screen points.
pub(super) const STEP: f32 = HEIGHT + 1.0;
/// So near to its edge the tree scrolls, screen points.
const EDGE: f32 = 18.0;

/// What is dragged.
#[derive(Debug, Clone, PartialEq, Eq)]
enum What {
    Legs(Vec<Id>),
    /// A branch of a fork, with its legs.
    Branch(BranchId),
    Stage(Id),
    Alternate(Id),
    /// A fix, a zone and the like.
    Thing(Selection),
}

/// A place for what is dragged.
enum Where {
    Legs(LegSpot),
    /// Before which one of its fork.
    Branch(Option<Id>),
    Stage(StageSpot),
    Alternate(Option<Id>),
    /// Before which one of its list.
    Thing(Option<Id>),
}

/// What a drop here would do.
#[derive(Debug, Clone, PartialEq)]
enum Outcome {
    /// It is there already.
    Nothing,
    Edit(Box<Edit>),
    /// The cause is asked for.
    Associate(Option<Id>),
}

/// A drag.
#[derive(Debug)]
pub(in crate::panels) struct Drag {
    what: What,
    name: String,
    /// Where it was last, and what a drop there would do; so long as the pointer means the same place.
    over: Option<(Mark, Result<Outcome, String>)>,
}

/// Where the rows are on the screen.
#[derive(Debug, Clone, Copy)]
pub(in crate::panels) struct View {
    /// What is seen of them.
    pub rect: Rect,
    /// How far they are scrolled, screen points.
    pub offset: f32,
    /// From one row to the next, screen points.
    pub step: f32,
}

/// An emergency plan was dropped: for which cause?
#[derive(Debug)]
pub(in crate::panels) struct Asking {
    at: Pos2,
    alternate: Id,
    of: Vec<Option<Id>>,
}

impl Drag {
    /// Of a row, and what is selected with it; `None`: it stays where it is.
    pub fn begin(row: &Row, scene: &Scene<'_>) -> Option<Self> {
        let selection = row.selection.as_ref()?;
        let what = match selection {
            _ if let Some(branch) = row.as_branch() => What::Branch(branch),
            Selection::Leg(id) => match scene.selected_legs() {
                legs if legs.contains(id) => What::Legs(legs),
                _ => What::Legs(vec![id.clone()]),
            },
            Selection::Stage(id) => What::Stage(id.clone()),
            Selection::Emergency(id) => What::Alternate(id.clone()),
            other => What::Thing(other.clone()),
        };
        let name = match &what {
            What::Legs(legs) if legs.len() > 1 => format!("{} legs", legs.len()),
            _ => row.text.clone(),
        };
        Some(Self { what, name, over: None })
    }

    /// Shows where it would go. True when it was let go: see [`Drag::drop`].
    fn show(&mut self, ui: &Ui, rows: &[Row], view: View, plan: &FlightPlan) -> bool {
        let Some(at) = ui.input(|i| i.pointer.latest_pos()) else { return false };
        if let What::Thing(Selection::Variable(name)) = &self.what {
            // fields of the inspector and the map take it
            DragAndDrop::set_payload(ui.ctx(), DraggedVariable(name.clone()));
        }
        self.find(rows, view, at, plan);
        if let Some((mark, outcome)) = &self.over {
            paint(ui, *mark, view, outcome.is_ok());
        }
        let why_not = self.over.as_ref().and_then(|(_, outcome)| outcome.as_ref().err());
        ui.set_cursor_icon(if why_not.is_some() { CursorIcon::NotAllowed } else { CursorIcon::Grabbing });
        ghost(ui, at, &self.name, why_not.map(String::as_str));
        ui.input(|i| i.pointer.any_released())
    }

    /// How far the rows are scrolled now, because the drag is at their edge.
    fn scrolls(ui: &Ui, view: View) -> Option<f32> {
        let at = ui.input(|i| i.pointer.latest_pos())?;
        let down = (at.y - view.rect.bottom() + EDGE).max(0.0) - (view.rect.top() + EDGE - at.y).max(0.0);
        (down != 0.0).then(|| (view.offset + down.clamp(-EDGE, EDGE) * 0.5).max(0.0))
    }

    fn find(&mut self, rows: &[Row], view: View, pointer: Pos2, plan: &FlightPlan) {
        let y = (pointer.y - view.rect.top() + view.offset) / view.step;
        if !view.rect.contains(pointer) || y < 0.0 || y as usize >= rows.len() {
            self.over = None;
            return;
        }
        let at = At { row: y as usize, down: y.fract(), depth: depth(view.rect.left(), pointer.x) };
        let (mark, place) = match self.place(rows, at) {
            Ok((mark, place)) => (mark, Ok(place)),
            Err(why) => (Mark::Onto(at.row), Err(why)),
        };
        // a large plan is not searched again while the pointer means the same place
        if self.over.as_ref().is_none_or(|(over, _)| *over != mark) {
            let outcome = place.map_err(str::to_owned).and_then(|place| self.outcome(place, plan));
            self.over = Some((mark, outcome));
        }
    }

    fn place(&self, rows: &[Row], at: At) -> Found<Where> {
        Ok(match &self.what {
            What::Legs(_) => for_legs(rows, at).map(|(mark, spot)| (mark, Where::Legs(spot)))?,
            What::Branch(of) => {
                for_branch(rows, at, of).map(|(mark, before)| (mark, Where::Branch(before)))?
            }
            What::Stage(_) => for_stage(rows, at).map(|(mark, spot)| (mark, Where::Stage(spot)))?,
            What::Alternate(id) => match for_thing(rows, at, &Selection::Emergency(id.clone())) {
                Ok((mark, before)) => (mark, Where::Thing(before)),
                Err(_) => for_alternate(rows, at).map(|(mark, of)| (mark, Where::Alternate(of)))?,
            },
            What::Thing(thing) => {
                for_thing(rows, at, thing).map(|(mark, before)| (mark, Where::Thing(before)))?
            }
        })
    }

    fn outcome(&self, place: Where, plan: &FlightPlan) -> Result<Outcome, String> {
        let moved = match (&self.what, place) {
            (What::Legs(legs), Where::Legs(LegSpot::At(spot))) => create::relocate(plan, legs, &spot)?,
            (What::Legs(legs), Where::Legs(LegSpot::Branch { fork, branch })) => {
                create::into_branch(plan, legs, &fork, &branch)?
            }
            (What::Branch(of), Where::Branch(before)) => {
                create::relocate_branch(plan, &of.fork, &of.branch, before.as_ref())
            }
            (What::Stage(stage), Where::Stage(spot)) => create::relocate_stage(plan, stage, &spot),
            (What::Alternate(id), Where::Thing(before)) => create::relocate_thing(plan, id, before.as_ref()),
            (What::Thing(thing), Where::Thing(before)) => {
                create::relocate_thing(plan, thing.id(), before.as_ref())
            }
            (_, Where::Alternate(of)) => return Ok(Outcome::Associate(of)),
            _ => None,
        };
        Ok(moved.map_or(Outcome::Nothing, |edit| Outcome::Edit(Box::new(edit))))
    }

    /// Does it; what is to be asked then.
    fn drop(self, ui: &Ui, scene: &Scene<'_>, queue: &mut Queue) -> Option<Asking> {
        let (_, outcome) = self.over?;
        match (outcome.ok()?, self.what) {
            (Outcome::Edit(edit), _) => queue.edit(*edit),
            (Outcome::Associate(of), What::Alternate(alternate)) => {
                let at = ui.input(|i| i.pointer.latest_pos())?;
                let of = of.map_or_else(|| vec![None], |of| alternates::together(scene, &of));
                return Some(Asking { at, alternate, of });
            }
            _ => {}
        }
        None
    }
}

/// Goes on with a drag until it is let go or given up: how far the rows are scrolled meanwhile, and what is to be asked in the end.
pub(in crate::panels) fn go_on(
    dragged: &mut Option<Drag>,
    ui: &Ui,
    (rows, view): (&[Row], View),
    scene: &Scene<'_>,
    queue: &mut Queue,
) -> (Option<f32>, Option<Asking>) {
    let Some(drag) = dragged else { return (None, None) };
    let was_dropped = drag.show(ui, rows, view, scene.document.plan());
    if ui.input(|i| i.key_pressed(Key::Escape)) {
        *dragged = None;
    } else if was_dropped {
        return (None, dragged.take().and_then(|drag| drag.drop(ui, scene, queue)));
    } else if let Some(offset) = Drag::scrolls(ui, view) {
        ui.request_repaint();
        return (Some(offset), None);
    }
    (None, None)
}

impl Asking {
    /// The menu of the causes; false when it was closed.
    pub fn show(&self, ui: &Ui, plan: &FlightPlan, queue: &mut Queue) -> bool {
        let mut open = true;
        let id = WidgetId::unique("cause of an alternate");
        Popup::new(id, ui.ctx().clone(), PopupAnchor::Position(self.at), ui.layer_id())
            .kind(PopupKind::Menu)
            .layout(Layout::top_down_justified(egui::Align::Min))
            .style(menu_style)
            .gap(0.0)
            .open_bool(&mut open)
            .show(|ui| {
                ui.label(RichText::new(self.question(plan)).color(theme::of(ui).weak));
                alternates::causes_menu(ui, plan, &self.of, &self.alternate, queue);
            });
        open
    }

    /// `Return to R20 for Survey: for which cause?`
    fn question(&self, plan: &FlightPlan) -> String {
        let whose = match self.of.as_slice() {
            [Some(id)] => plan.label(id).to_owned(),
            [None] => "the plan".into(),
            several => format!("{} legs", several.len()),
        };
        format!("{} for {whose}: for which cause?", alternates::plan_name(plan, &self.alternate))
    }
}

fn paint(ui: &Ui, mark: Mark, view: View, is_possible: bool) {
    let p = theme::of(ui);
    let painter = ui.painter().with_clip_rect(view.rect);
    let colour = if is_possible { p.accent } else { p.warning };
    let top = |row: usize| view.rect.top() - view.offset + row as f32 * view.step;
    let line = |y: f32, depth| {
        let x = indent(view.rect.left(), depth) + 14.0;
        painter.circle_filled(pos2(x, y), 3.0, colour);
        painter.hline(x..=view.rect.right() - 6.0, y, Stroke::new(2.0, colour));
    };
    match mark {
        Mark::Above { row, depth } => line(top(row) - 0.5, depth),
        Mark::Below { row, depth } => line(top(row + 1) - 0.5, depth),
        Mark::Onto(row) => {
            let rect = Rect::from_min_size(
                pos2(view.rect.left(), top(row)),
                vec2(view.rect.width(), view.step - 1.0),
            );
            painter.rect_stroke(rect, 4.0, Stroke::new(1.5, colour), StrokeKind::Inside);
        }
    }
}

/// What is dragged, beside the pointer.
fn ghost(ui: &Ui, at: Pos2, name: &str, why_not: Option<&str>) {
    let area = Area::new(WidgetId::unique("dragged row")).order(Order::Tooltip).interactable(false);
    area.fixed_pos(at + vec2(16.0, 12.0)).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            ui.set_max_width(260.0);
            ui.label(RichText::new(name).strong());
            if let Some(why_not) = why_not {
                ui.label(RichText::new(format!("🚫 {why_not}")).color(theme::of(ui).warning));
            }
        });
    });
}
