//! What a right click on the map offers: what can be done here and with what is here. A click on several things asks which.

use super::tools::pick::things_near;
use super::tools::{Asked, Canvas, new_leg};
use crate::command::{PreviewCommand, Queue, Selection, ViewCommand};
use crate::map::path;
use crate::map::tools::pen::way;
use crate::panels::leading;
use crate::panels::tree::menu as tree_menu;
use crate::panels::what_if::{self, CAUSES};
use crate::panels::{Scene, tree};
use crate::theme;
use crate::units;
use egui::containers::menu::menu_style;
use egui::{Layout, Popup, PopupAnchor, PopupKind, Pos2, RichText, Ui, ViewportCommand};
use flight_plan::create::{self, Drawn, LegChoice};
use flight_plan::{Edit, Id, LegContext, Place, Thing, Value, Variable, VariableValue};
use geometry::LatLon;
use new_leg::{Aim, Side};

/// The menu, if one is open.
#[derive(Debug, Default)]
pub struct Menu {
    opened: Option<Opened>,
    /// Where what is pasted next goes.
    paste: Option<LatLon>,
}

#[derive(Debug)]
struct Opened {
    at: Pos2,
    place: LatLon,
    things: Vec<Selection>,
    /// It only asks which of the things is meant.
    asks: bool,
}

impl Menu {
    /// Opens what was asked for, and draws what is open.
    pub fn run(&mut self, ui: &Ui, asked: Option<Asked>, canvas: &Canvas<'_>, queue: &mut Queue) {
        if let Some(asked) = asked {
            let (at, things, asks) = match asked {
                Asked::Menu(at) => (at, things_near(at, canvas), false),
                Asked::Which(at, things) => (at, things, true),
            };
            let place = canvas.view.geo(at);
            self.opened = place.is_valid().then_some(Opened { at, place, things, asks });
        }
        let Some(opened) = &self.opened else { return };
        let mut open = true;
        let mut pastes = false;
        let id = ui.scope_id().with(("map menu", opened.at.x.to_bits(), opened.at.y.to_bits()));
        Popup::new(id, ui.ctx().clone(), PopupAnchor::Position(opened.at), ui.layer_id())
            .kind(PopupKind::Menu)
            .layout(Layout::top_down_justified(egui::Align::Min))
            .style(menu_style)
            .gap(0.0)
            .open_bool(&mut open)
            .show(|ui| match opened.asks {
                true => which(ui, canvas, &opened.things, queue),
                false => pastes = here(ui, canvas, opened, queue),
            });
        if pastes {
            self.paste = Some(opened.place);
        }
        if !open {
            self.opened = None;
        }
    }

    /// Nothing is offered any more.
    pub fn close(&mut self) {
        self.opened = None;
    }

    /// Where what is pasted goes, if a place was chosen for it; asked for once.
    pub fn paste_at(&mut self) -> Option<LatLon> {
        self.paste.take()
    }
}

/// Which of several things is meant.
fn which(ui: &mut Ui, canvas: &Canvas<'_>, things: &[Selection], queue: &mut Queue) {
    for thing in things {
        if ui.button(name(canvas.scene, thing)).clicked() {
            queue.view(ViewCommand::Select(Some(thing.clone())));
        }
    }
}

/// True if something is to be pasted here.
fn here(ui: &mut Ui, canvas: &Canvas<'_>, opened: &Opened, queue: &mut Queue) -> bool {
    legs_here(canvas.scene, &opened.things)
        .iter()
        .for_each(|leg| leading::direct(ui, canvas.scene, leg, queue));
    for thing in &opened.things {
        ui.menu_button(name(canvas.scene, thing), |ui| with(ui, canvas.scene, thing, queue));
    }
    if !opened.things.is_empty() {
        ui.separator();
    }
    insert(ui, canvas, opened, queue);
    if ui.button("Make a fix here").clicked() {
        let fix = create::fix(canvas.scene.document.plan(), opened.place);
        let id = fix.id.clone();
        queue.edit(Edit::Add(Box::new(Thing::Fix(fix))));
        queue.view(ViewCommand::Select(Some(Selection::Fix(id))));
    }
    ui.separator();
    if ui.button("Copy the coordinates").clicked() {
        ui.copy_text(units::position(opened.place));
    }
    let pastes = ui.button("Paste here").on_hover_text("Copied legs, or coordinates as a waypoint").clicked();
    if pastes {
        ui.send_viewport_cmd(ViewportCommand::RequestPaste);
    }
    ui.separator();
    what_happens_here(ui, canvas, opened.at, queue);
    place_is_here(ui, canvas.scene, opened.place, queue);
    what_is_here(ui, canvas, opened.place);
    pastes
}

/// The aircraft is led to so many legs here.
const MOST: usize = 4;

/// The legs here, and those that go to a fix here.
fn legs_here(scene: &Scene<'_>, things: &[Selection]) -> Vec<Id> {
    let Some(aboard) = &scene.vehicle.aboard else { return Vec::new() };
    let is_here = |context: &LegContext<'_>| match context.leg.place() {
        _ if things.contains(&Selection::Leg(context.leg.id.clone())) => true,
        Some(Place::Fix(fix)) => things.contains(&Selection::Fix(fix.clone())),
        _ => false,
    };
    let legs = aboard.plan.all_legs().into_iter().filter(is_here);
    legs.map(|context| context.leg.id.clone()).take(MOST).collect()
}

/// What can be done with a thing.
fn with(ui: &mut Ui, scene: &Scene<'_>, thing: &Selection, queue: &mut Queue) {
    if !scene.is_selected(thing) && ui.button("Select it").clicked() {
        queue.view(ViewCommand::Select(Some(thing.clone())));
    }
    tree_menu::show(ui, scene, thing, queue);
}

/// New legs here: beside the leg under the pointer, or the selected one.
fn insert(ui: &mut Ui, canvas: &Canvas<'_>, opened: &Opened, queue: &mut Queue) {
    let scene = canvas.scene;
    let plan = scene.document.plan();
    let is_leg = |thing: &&Selection| matches!(thing, Selection::Leg(_));
    let beside = opened.things.iter().find(is_leg).or(scene.view.selection.as_ref());
    let Some(behind) = new_leg::aim(plan, beside, &Side::Behind) else { return };
    let before = new_leg::aim(plan, beside, &Side::Before).filter(|before| *before != behind);
    let mut offer = |name: String, choice: LegChoice, at: &Aim| {
        if ui.button(name).clicked() {
            let drawn = Drawn::Place(Place::Position(Value::Constant(opened.place)));
            let approach = new_leg::approach(canvas, at);
            new_leg::add(choice, &drawn, at.clone(), approach, plan, queue);
        }
    };
    for at in before.iter().chain([&behind]) {
        offer(format!("Add a waypoint here, {}", new_leg::words(at, plan)), LegChoice::Tf, at);
    }
    offer("Add a scan here".into(), LegChoice::Scan, &behind);
    offer("Add an orbit here".into(), LegChoice::Orbit, &behind);
    offer("Add a holding here".into(), LegChoice::Hm, &behind);
}

/// On the path: an alarm at this point of it.
fn what_happens_here(ui: &mut Ui, canvas: &Canvas<'_>, at: Pos2, queue: &mut Queue) {
    let Some(time_s) = path::time_near(at, canvas.view, canvas.scene) else { return };
    ui.menu_button("What happens here", |ui| {
        for cause in CAUSES {
            if ui.button(cause.name()).clicked() {
                queue.preview(PreviewCommand::Scrub(Some(time_s)));
                queue.preview(PreviewCommand::Raise(Some(cause)));
                queue.view(ViewCommand::ShowPanel(what_if::ID, true));
            }
        }
    });
}

/// A place that the plan gets from a variable is here, in another world than the plan's.
fn place_is_here(ui: &mut Ui, scene: &Scene<'_>, at: LatLon, queue: &mut Queue) {
    let is_place = |variable: &&Variable| matches!(variable.initial, VariableValue::Position(_));
    let mut places = scene.document.plan().variables.iter().filter(is_place).peekable();
    if places.peek().is_none() {
        return;
    }
    ui.menu_button("What if here is", |ui| {
        for variable in places {
            if ui.button(variable.name.as_str()).clicked() {
                let mut world = scene.view.what_if.clone();
                what_if::set_variable(&mut world, variable, VariableValue::Position(at));
                queue.preview(PreviewCommand::WhatIf(Box::new(world)));
                queue.view(ViewCommand::ShowPanel(what_if::ID, true));
            }
        }
    });
}

/// Elevation, and the way from the aircraft and from what is selected.
fn what_is_here(ui: &mut Ui, canvas: &Canvas<'_>, place: LatLon) {
    let scene = canvas.scene;
    let weak = theme::of(ui).weak;
    let ground = match scene.ground.0.elevation_m(place) {
        Some(metres) => format!("Ground {} AMSL", scene.units().altitude().show(metres)),
        None => "The ground is not known here".into(),
    };
    let mut lines = vec![units::position(place), ground];
    if let Some(aircraft) = &scene.vehicle.position {
        let from = aircraft.value.position;
        lines.push(format!("From the aircraft {}", way(from, place, scene.units())));
    }
    if let Some((id, from)) = selected_place(canvas) {
        let name = scene.document.plan().label(id);
        lines.push(format!("From {name} {}", way(from, place, scene.units())));
    }
    for line in lines {
        ui.label(RichText::new(line).size(12.0).color(weak));
    }
}

/// What is selected, and where it is.
fn selected_place<'a>(canvas: &Canvas<'a>) -> Option<(&'a Id, LatLon)> {
    let plan = canvas.scene.document.plan();
    let selection = canvas.scene.view.selection.as_ref()?;
    let at = match selection {
        Selection::Fix(id) => plan.fix(id)?.position,
        Selection::Runway(id) => plan.runway(id)?.threshold,
        Selection::Leg(id) => {
            let place = || canvas.sketch.handles.iter().find(|h| h.what.leg() == Some(id)).map(|h| h.at);
            plan.leg(id).and_then(|context| new_leg::place_of(canvas, context.leg)).or_else(place)?
        }
        _ => return None,
    };
    Some((selection.id(), at))
}

/// What a thing is, for people.
fn name(scene: &Scene<'_>, thing: &Selection) -> String {
    let plan = scene.document.plan();
    let kind = match thing {
        Selection::Leg(id) => match plan.leg(id) {
            Some(context) => tree::leg_tag(&context.leg.kind),
            None => "Leg",
        },
        Selection::Stage(_) => "Stage",
        Selection::Emergency(_) => "Emergency plan",
        Selection::Fix(_) => "Fix",
        Selection::Runway(_) => "Runway",
        Selection::Variable(_) => "Variable",
        Selection::Zone(_) => "Zone",
        Selection::Procedure(_) => "Procedure",
    };
    format!("{kind} {}", plan.label(thing.id()))
}
