//! The remedies of a problem as buttons: what they would change is told before, and none is pressed that came under the pointer
//! unread.

use super::super::Scene;
use crate::command::{Queue, ViewCommand};
use crate::{theme, units};
use egui::{Button, Pos2, RectAlign, Response, RichText, Tooltip, Ui};
use flight_plan::{Edit, FlightPlan, Problem, Thing, diff};

/// So many changes of a remedy are told before it is made.
const MOST_CHANGES: usize = 8;
/// Until a remedy that came under a pointer at rest can be pressed, seconds.
const READ_S: f64 = 1.5;
/// A pointer that is moved less is at rest, screen points.
const REST: f32 = 4.0;

/// When one is made, the list moves up, and another one may come under the pointer.
#[derive(Debug, Default)]
pub struct Remedies {
    under: Option<Under>,
}

/// What the pointer rests on.
#[derive(Debug)]
struct Under {
    at: Pos2,
    /// The problem, and which of its remedies.
    what: (String, usize),
    /// It came there while the pointer was at rest: at that time, seconds.
    came_s: Option<f64>,
}

impl Remedies {
    /// Where the pointer is in this frame.
    pub fn follow(&mut self, ui: &Ui) {
        let at = ui.input(|i| i.pointer.latest_pos());
        self.under.take_if(|under| at.is_some_and(|at| at.distance(under.at) > REST));
    }

    /// Draws the remedies of a problem, side by side.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        scene: &Scene<'_>,
        problem: &Problem,
        message: &str,
        queue: &mut Queue,
    ) {
        let Some(fix) = problem.fix.as_deref() else { return };
        self.button(ui, scene, ("Fix", ""), (message, 0), fix, queue);
        if let Some(there) = &problem.at_source {
            let text = format!("Fix “{}”", scene.document.label(&there.of));
            let about = format!("For all {} legs that inherit from there.", there.legs);
            self.button(ui, scene, (&text, &about), (message, 1), &there.edit, queue);
        }
    }

    /// Draws the remedy of so many problems with this code at once.
    pub fn of_all(
        &mut self,
        ui: &mut Ui,
        scene: &Scene<'_>,
        (code, count): (&str, usize),
        remedy: &Edit,
        queue: &mut Queue,
    ) {
        let text = format!("Fix all {count}");
        self.button(ui, scene, (&text, "As one step."), (code, 0), remedy, queue);
    }

    /// It has one remedy.
    pub fn is_one(problem: &Problem) -> bool {
        problem.fix.is_some() && problem.at_source.is_none()
    }

    fn button(
        &mut self,
        ui: &mut Ui,
        scene: &Scene<'_>,
        (text, about): (&str, &str),
        what: (&str, usize),
        fix: &Edit,
        queue: &mut Queue,
    ) {
        let is_read = self.is_read(ui, what);
        let colour = if is_read { ui.visuals().text_color() } else { theme::of(ui).weak };
        let button = ui.add(Button::new(RichText::new(text).color(colour)).small().truncate());
        self.rest_on(ui, &button, what);
        // beside the list: whoever decides reads the problem, too
        let row = button.rect.with_max_x(ui.max_rect().right());
        let mut tip = Tooltip::for_enabled(&button);
        tip.popup = tip.popup.anchor(row).align(RectAlign::RIGHT_END);
        tip.show(|ui| {
            about.lines().for_each(|about| drop(ui.label(about)));
            told(ui, scene.document.plan(), fix);
        });
        // a second press before the first one is looked into is none
        let is_known = scene.analysis.version == scene.document.version();
        let again = button.double_clicked() || button.triple_clicked();
        if button.clicked() && is_read && is_known && !again {
            queue.edit(fix.clone());
            guessed(fix).into_iter().for_each(|text| queue.view(ViewCommand::Toast(text)));
        }
    }

    fn is_read(&self, ui: &Ui, (message, number): (&str, usize)) -> bool {
        let is_it = |under: &&Under| (under.what.0.as_str(), under.what.1) == (message, number);
        let came_s = self.under.as_ref().filter(is_it).and_then(|under| under.came_s);
        came_s.is_none_or(|came_s| ui.input(|i| i.time) - came_s > READ_S)
    }

    /// Notes what is under the pointer.
    fn rest_on(&mut self, ui: &Ui, button: &Response, (message, number): (&str, usize)) {
        let at = ui.input(|i| i.pointer.latest_pos()).filter(|_| button.contains_pointer());
        let Some(at) = at else { return };
        let is_other = |under: &Under| (under.what.0.as_str(), under.what.1) != (message, number);
        let rests = self.under.as_ref();
        if rests.is_none_or(is_other) {
            let came_s = rests.map(|_| ui.input(|i| i.time));
            let at = rests.map_or(at, |under| under.at);
            self.under = Some(Under { at, what: (message.to_owned(), number), came_s });
            ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(READ_S));
        }
    }
}

/// What a remedy can't know: where a fix lies that nothing but its name is there of.
fn guessed(remedy: &Edit) -> Option<String> {
    match remedy {
        Edit::All(edits) => edits.iter().find_map(guessed),
        Edit::Add(thing) => match thing.as_ref() {
            Thing::Fix(fix) => Some(format!(
                "{} was put at {}, which is a guess: move it to its place",
                fix.id,
                units::position(fix.position)
            )),
            _ => None,
        },
        _ => None,
    }
}

/// What a remedy would do to the plan.
fn told(ui: &mut Ui, plan: &FlightPlan, fix: &Edit) {
    let changes = diff::of_edit(plan, fix);
    ui.label(RichText::new("Makes this edit; undo takes it back:").color(theme::of(ui).weak));
    for change in changes.iter().take(MOST_CHANGES) {
        ui.label(change.in_names(plan));
    }
    if let Some(more) = changes.len().checked_sub(MOST_CHANGES).filter(|more| *more > 0) {
        ui.label(format!("and {more} more"));
    }
}
