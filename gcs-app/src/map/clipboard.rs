//! Copy, cut, paste and duplicate: legs, fixes, zones and runways as text, coordinates as a waypoint or where a new mission is, and
//! drawings of other programs.

use super::drawings;
use super::menu::Menu;
use super::tools::{Canvas, new_leg};
use crate::command::{Clip, Queue, Selection, ViewCommand};
use crate::coordinates::{self, Known};
use crate::guide::Answer;
use crate::jobs::{Taken, Task};
use crate::panels::start;
use egui::{Context, Event, Ui, ViewportCommand};
use flight_plan::clipboard::{self, Pasted};
use flight_plan::create::{self, Drawn, LegChoice};
use flight_plan::describe::Subject;
use flight_plan::{FlightPlan, Id, Place, Thing, Value};
use geometry::LatLon;
use interchange::{Feature, Format};
use new_leg::{Aim, Side};
use std::collections::VecDeque;

/// What a drawing holds, or why it can't be pasted.
type Read = Result<Vec<Feature>, String>;

/// Drawings that are being read, each on a thread of its own, in the order in which they were pasted.
#[derive(Debug, Default)]
pub struct Pastes(VecDeque<Paste>);

/// A drawing on its way.
#[derive(Debug)]
struct Paste {
    read: Task<Read>,
    /// Behind what was selected when it was pasted, or why it can't be put anywhere.
    aim: Result<Aim, String>,
    /// Into which document: by now another may be shown.
    into: u64,
}

impl Pastes {
    /// One is being read.
    pub fn is_reading(&self) -> bool {
        !self.0.is_empty()
    }

    fn begin(&mut self, format: Format, text: String, canvas: &Canvas<'_>) {
        let read = move || drawings::read(format, &text);
        let read = Task::begin(canvas.scene.layers.wake(), read);
        self.0.push_back(Paste {
            read,
            aim: aim(canvas, new_leg::mission_aim),
            into: canvas.scene.document.id(),
        });
    }

    /// Puts what was read into the plan.
    fn take(&mut self, canvas: &Canvas<'_>, queue: &mut Queue) {
        let Some(first) = self.0.front() else { return };
        let read = match first.read.take() {
            Taken::NotYet => return,
            Taken::Done(read) => read,
            Taken::Failed => Err("The drawing could not be read: open it as a file.".into()),
        };
        match self.0.pop_front() {
            Some(Paste { aim, into, .. }) if into == canvas.scene.document.id() => {
                paste_drawing(read, aim, canvas, queue);
            }
            Some(_) => queue.view(ViewCommand::Notice(NOT_SHOWN.into())),
            None => {}
        }
    }
}

const NOT_SHOWN: &str =
    "The drawing was not pasted: it was meant for a plan that is not shown any more. Paste it again.";
const NO_BRANCH: &str = "A branch can't be cut: cut its legs, or delete it with Del.";

/// Takes the keys and what the menu asked for, unless something is being typed.
pub fn run(ui: &Ui, menu: &mut Menu, pastes: &mut Pastes, canvas: &Canvas<'_>, queue: &mut Queue) {
    pastes.take(canvas, queue);
    if ui.ctx().text_edit_focused() || canvas.scene.is_asking() {
        return;
    }
    let is_ours = |event: &&Event| matches!(event, Event::Copy | Event::Cut | Event::Paste(_));
    let events: Vec<Event> = ui.input(|i| i.events.iter().filter(is_ours).cloned().collect());
    for event in events {
        match event {
            Event::Copy => drop(copy(ui.ctx(), canvas)),
            Event::Cut => cut(ui.ctx(), canvas, queue),
            Event::Paste(text) => {
                if let Some(format) = drawings::format_of(&text) {
                    pastes.begin(format, text, canvas);
                    continue;
                }
                let under = canvas.pointer.map(|at| canvas.view.geo(at)).filter(|at| at.is_valid());
                paste(&text, menu.paste_at().or(under), canvas, queue);
            }
            _ => {}
        }
    }
}

/// What was chosen in the palette, or by its key. What is pasted comes in a later frame.
pub fn carry_out(clip: Clip, ui: &Ui, canvas: &Canvas<'_>, queue: &mut Queue) {
    match clip {
        Clip::Copy => drop(copy(ui.ctx(), canvas)),
        Clip::Cut => cut(ui.ctx(), canvas, queue),
        Clip::Paste => ui.send_viewport_cmd(ViewportCommand::RequestPaste),
        Clip::Duplicate if named(canvas).is_some() => {
            let plan = canvas.scene.document.plan();
            named(canvas).into_iter().for_each(|what| put(clipboard::duplicate_named(plan, &what), queue));
        }
        Clip::Duplicate => {
            let set = canvas.scene.selected_things();
            put(clipboard::duplicate(canvas.scene.document.plan(), &set), queue);
        }
    }
}

/// What is selected to the clipboard, of a stage its legs; of a fix or runway alone the place; of what has no place all that it needs. `None`: there is nothing to be copied.
fn copy(ctx: &Context, canvas: &Canvas<'_>) -> Option<()> {
    let (plan, scene) = (canvas.scene.document.plan(), canvas.scene);
    let place = match &scene.view.selection {
        Some(Selection::Fix(id)) => plan.fix(id).map(|fix| fix.position),
        Some(Selection::Runway(id)) => plan.runway(id).map(|runway| runway.threshold),
        _ => None,
    };
    let place = place.filter(|_| scene.view.also.is_empty()).map(crate::units::position);
    let set: Vec<Id> = match &scene.view.selection {
        // alone it is no set
        Some(Selection::Stage(id)) if scene.view.also.is_empty() => {
            plan.stage(id)?.legs.iter().map(|leg| leg.id.clone()).collect()
        }
        _ => scene.selected_things(),
    };
    let named = named(canvas).and_then(|what| clipboard::copy_named(plan, &what));
    ctx.copy_text(place.or(named).or_else(|| clipboard::copy(plan, &set))?);
    Some(())
}

/// The emergency plan, procedure or variable that is selected alone.
fn alone<'a>(canvas: &Canvas<'a>) -> Option<&'a Selection> {
    let view = canvas.scene.view;
    view.selection.as_ref().filter(|what| what.is_named() && view.also.is_empty())
}

/// The same as what it is in the plan.
fn named(canvas: &Canvas<'_>) -> Option<Subject> {
    alone(canvas).map(Selection::subject)
}

/// All of it, so that it can be pasted again: of a fix or runway more than its place. The clipboard holds no stages: they stay, without
/// their legs.
fn cut(ctx: &Context, canvas: &Canvas<'_>, queue: &mut Queue) {
    let plan = canvas.scene.document.plan();
    if canvas.scene.selected_branch().is_some() {
        return queue.view(ViewCommand::Notice(NO_BRANCH.into()));
    }
    if let Some(what) = alone(canvas) {
        copy(ctx, canvas);
        return queue.edit(create::remove(plan, what.id()));
    }
    let mut set = canvas.scene.selected_things();
    set.retain(|id| plan.stage(id).is_none());
    if let Some(text) = clipboard::copy(plan, &set) {
        ctx.copy_text(text);
        queue.edit(create::delete_set(plan, &set));
    }
}

/// A drawing becomes legs where it was drawn, or answers the guide.
fn paste_drawing(drawing: Read, aim: Result<Aim, String>, canvas: &Canvas<'_>, queue: &mut Queue) {
    let scene = canvas.scene;
    let plan = scene.document.plan();
    if start::is_wanted(scene) {
        let answered = drawing.and_then(|features| drawings::answer(&features, &scene.view.guide));
        return queue.view(answered.map_or_else(ViewCommand::Notice, ViewCommand::Guide));
    }
    match aim {
        Ok(Aim::Spot(at)) => {
            let aim = Aim::Spot(at.clone());
            let approach = new_leg::approach(canvas, &aim);
            let pasted = drawing.and_then(|features| drawings::legs(&features, at, approach, plan));
            put_at(&aim, pasted, plan, queue);
        }
        Ok(Aim::Way { .. }) => {}
        Err(why) => queue.view(ViewCommand::Notice(why)),
    }
}

/// Where legs go on a side of what is selected.
type Aims = fn(&FlightPlan, Option<&Selection>, &Side) -> Option<Aim>;

/// Where legs are pasted: of several that are selected, behind the last.
fn aim(canvas: &Canvas<'_>, aims: Aims) -> Result<Aim, String> {
    let scene = canvas.scene;
    let last = scene.selected_legs().pop().map(Selection::Leg);
    let selected = last.as_ref().or(scene.view.selection.as_ref());
    let aim = aims(scene.document.plan(), selected, &Side::Behind);
    aim.ok_or_else(|| format!("To paste legs, {}", new_leg::NO_STAGE))
}

/// Coordinates become a waypoint where they say, or answer the guide; legs come to where the pointer is.
fn paste(text: &str, under: Option<LatLon>, canvas: &Canvas<'_>, queue: &mut Queue) {
    let scene = canvas.scene;
    let plan = scene.document.plan();
    let aircraft = scene.vehicle.position.as_ref().map(|position| position.value.position);
    let known = Known { plan: Some(plan), aircraft, near: under, world: None };
    let place = coordinates::read(text, &known);
    if let (Ok(at), true) = (&place, start::is_wanted(scene)) {
        return queue.view(ViewCommand::Guide(Answer::Place(*at)));
    }
    // legs of a plan may be of any stage
    let aims = if place.is_ok() { new_leg::mission_aim } else { new_leg::aim };
    let aim = match aim(canvas, aims) {
        Ok(aim) => aim,
        Err(why) => return queue.view(ViewCommand::Notice(why)),
    };
    match place {
        Ok(place) => {
            let drawn = Drawn::Place(Place::Position(Value::Constant(place)));
            let approach = new_leg::approach(canvas, &aim);
            new_leg::add(LegChoice::Tf, &drawn, aim, approach, plan, queue);
        }
        Err(_) => {
            if let Aim::Spot(at) = &aim {
                put_at(&aim, clipboard::paste(plan, text, at, under), plan, queue);
            }
        }
    }
}

/// Puts what was pasted into the plan, and says where the legs are, if they are not in the main plan: what is selected may have been
/// selected for something else.
fn put_at(aim: &Aim, pasted: Result<Pasted, String>, plan: &FlightPlan, queue: &mut Queue) {
    let has_legs = pasted.as_ref().is_ok_and(|pasted| !pasted.legs.is_empty());
    let aside = new_leg::aside(aim, plan).filter(|_| has_legs);
    put(pasted, queue);
    if let Some(whose) = aside {
        queue.view(ViewCommand::Notice(format!(
            "Pasted into {whose}, {}. For the main plan undo it, select a leg or stage there, and paste again.",
            new_leg::words(aim, plan)
        )));
    }
}

/// Puts what was pasted into the plan and selects it, or says why that can't be.
fn put(pasted: Result<Pasted, String>, queue: &mut Queue) {
    match pasted {
        Ok(pasted) => {
            let mut made = selections(&pasted).into_iter();
            queue.edit(pasted.edit);
            queue.view(ViewCommand::Select(made.next()));
            made.for_each(|other| queue.view(ViewCommand::Toggle(other)));
        }
        Err(why) => queue.view(ViewCommand::Notice(why)),
    }
}

/// What was pasted or added, as something to be selected.
pub fn selections(pasted: &Pasted) -> Vec<Selection> {
    let things = pasted.things.iter().map(|thing| match thing {
        Thing::Fix(fix) => Selection::Fix(fix.id.clone()),
        Thing::Zone(zone) => Selection::Zone(zone.id.clone()),
        Thing::Runway(runway) => Selection::Runway(runway.id.clone()),
        Thing::Variable(variable) => Selection::Variable(variable.name.clone()),
        Thing::Procedure(procedure) => Selection::Procedure(procedure.id.clone()),
        Thing::EmergencyPlan(emergency) => Selection::Emergency(emergency.id.clone()),
    });
    let all: Vec<Selection> = pasted.legs.iter().cloned().map(Selection::Leg).chain(things).collect();
    // what is no part of sets is selected alone
    let alone = all.iter().find(|what| what.is_named()).cloned();
    alone.map_or(all, |alone| vec![alone])
}
