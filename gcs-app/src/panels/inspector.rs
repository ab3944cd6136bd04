//! What is selected, and what can be changed about it. Every change is an edit of the document.

mod inherited;
mod leg;
mod level;
mod several;

use super::field::{self, Change};
use super::{Panel, PanelId, Place, Scene};
use crate::command::{DocumentCommand, FlyCommand, Queue, Selection};
use crate::coordinates;
use crate::document::procedure_leg;
use crate::theme;
use crate::units;
use egui::{RichText, ScrollArea, Ui};
use flight_exec::Command;
use flight_plan::{
    Edit, EmergencyPlan, Fix, FlightPlan, Id, Procedure, Runway, Stage, Variable, VariableValue, Zone,
    ZoneKind, ZoneShape,
};
use level::{altitude_row, speed_row};
use wire::Convert;

/// The panel.
#[derive(Debug)]
pub struct Inspector;

impl Panel for Inspector {
    fn id(&self) -> PanelId {
        "inspector"
    }
    fn name(&self) -> &'static str {
        "Inspector"
    }
    fn place(&self) -> Place {
        Place::Right { height: 290.0 }
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        selected(ui, scene, queue);
    }
}

fn selected(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    ScrollArea::vertical().id_salt("inspector").auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 5.0;
        ui.set_width(ui.available_width());
        let plan = scene.document.plan();
        let together = scene.selected_legs();
        if together.len() > 1 {
            several::show(ui, scene, &together, queue);
            return;
        }
        match &scene.view.selection {
            None => summary(ui, scene),
            Some(Selection::Leg(id)) => match plan.leg(id) {
                Some(context) => leg::show(ui, scene, &context, queue),
                None => found(ui, procedure_leg(plan, id), |ui, (procedure, leg)| {
                    leg::show_in_procedure(ui, scene, procedure, leg)
                }),
            },
            Some(Selection::Stage(id)) => {
                found(ui, plan.stage(id), |ui, stage| show_stage(ui, scene, stage, queue))
            }
            Some(Selection::Emergency(id)) => found(ui, plan.emergency_plan(id), show_emergency),
            Some(Selection::Fix(id)) => found(ui, plan.fix(id), |ui, fix| show_fix(ui, fix, queue)),
            Some(Selection::Runway(id)) => {
                found(ui, plan.runway(id), |ui, runway| show_runway(ui, scene, runway))
            }
            Some(Selection::Zone(id)) => found(ui, plan.zone(id), |ui, zone| show_zone(ui, scene, zone)),
            Some(Selection::Procedure(id)) => found(ui, plan.procedure(id), show_procedure),
            Some(Selection::Variable(id)) => {
                found(ui, plan.variable(id), |ui, v| show_variable(ui, scene, v, queue))
            }
        }
    });
}

fn found<T>(ui: &mut Ui, thing: Option<T>, show: impl FnOnce(&mut Ui, T)) {
    match thing {
        Some(thing) => show(ui, thing),
        None => {
            ui.label("It is no longer in the plan.");
        }
    }
}

fn heading(ui: &mut Ui, kind: &str, id: &Id) {
    let p = theme::of(ui);
    ui.horizontal(|ui| {
        ui.label(RichText::new(id.as_str()).size(15.0).strong());
        ui.label(RichText::new(kind).color(p.weak));
    });
}

/// The whole plan, when nothing is selected.
fn summary(ui: &mut Ui, scene: &Scene<'_>) {
    let plan = scene.document.plan();
    let p = theme::of(ui);
    ui.label(RichText::new(&plan.name).size(15.0).strong());
    let forecast = scene.forecast();
    let rows: [(&str, String); 5] = [
        ("Aircraft", plan.aircraft.clone()),
        ("Length", scene.units().distance().show(forecast.length_m())),
        ("Duration", units::duration(forecast.duration_s())),
        ("Waypoints", forecast.waypoints.len().to_string()),
        ("Energy left", forecast.battery_left.map_or_else(|| "–".into(), |b| format!("{:.0} %", b * 100.0))),
    ];
    for (name, value) in rows {
        field::row(ui, name, |ui| ui.label(value));
    }
    if let Some(why) = &forecast.cut_short {
        ui.label(RichText::new(format!("⚠ {why}")).color(p.caution));
    }
    ui.label(
        RichText::new("Select something in the tree or on the map to change it.").size(12.0).color(p.weak),
    );
}

/// Sends what happened to a field as an edit: a drag becomes one undo step.
fn send(change: Change<Edit>, queue: &mut Queue) {
    match change {
        Change::None => {}
        Change::Moving(edit) => queue.document(DocumentCommand::DragEdit(edit)),
        Change::Set(edit) => queue.edit(edit),
        Change::Ended => queue.document(DocumentCommand::EndGesture),
    }
}

fn name_row(ui: &mut Ui, id: &Id, name: &str, queue: &mut Queue) {
    field::row(ui, "Name", |ui| {
        if let Some(name) = field::text(ui, "Name", name, false) {
            queue.edit(Edit::Rename { id: id.clone(), name });
        }
    });
}

/// Which emergency plan applies to a leg or stage; by-cause associations are listed.
fn emergency_row(
    ui: &mut Ui,
    plan: &FlightPlan,
    of: &Id,
    choice: &flight_plan::EmergencyChoice,
    queue: &mut Queue,
) {
    let fallback = choice.by_cause.iter().find(|(cause, _)| cause.is_none()).map(|(_, id)| id);
    field::row(ui, "Alternate", |ui| {
        let text = fallback.map_or("inherited", Id::as_str);
        egui::ComboBox::from_id_salt(("emergency", of)).selected_text(text).show_ui(ui, |ui| {
            let ids = plan.emergency_plans.iter().map(|e| Some(&e.id));
            for id in std::iter::once(None).chain(ids) {
                if ui.selectable_label(id == fallback, id.map_or("inherited", Id::as_str)).clicked() {
                    queue.edit(Edit::SetEmergency { of: Some(of.clone()), cause: None, plan: id.cloned() });
                }
            }
        });
    });
    let p = theme::of(ui);
    for (cause, id) in choice.by_cause.iter().filter_map(|(cause, id)| cause.map(|c| (c, id))) {
        ui.label(RichText::new(format!("{cause:?}: {id}")).size(12.0).color(p.weak));
    }
}

fn show_stage(ui: &mut Ui, scene: &Scene<'_>, stage: &Stage, queue: &mut Queue) {
    heading(ui, &format!("{:?} stage", stage.kind), &stage.id);
    name_row(ui, &stage.id, &stage.name, queue);
    if let Some(runway) = &stage.runway {
        field::row(ui, "Runway", |ui| ui.label(runway.as_str()));
    }
    altitude_row(ui, scene, &stage.id, stage.altitude.as_ref(), queue);
    speed_row(ui, scene, &stage.id, stage.speed_mps.as_ref(), queue);
    emergency_row(ui, scene.document.plan(), &stage.id, &stage.emergency, queue);
}

fn show_emergency(ui: &mut Ui, plan: &EmergencyPlan) {
    heading(ui, "emergency plan", &plan.id);
    field::row(ui, "Name", |ui| ui.label(&plan.name));
    field::row(ui, "Lands on", |ui| ui.label(plan.runway.as_str()));
    let legs: usize = plan.stages.iter().map(|s| s.legs.len()).sum();
    field::row(ui, "Legs", |ui| ui.label(legs.to_string()));
}

fn show_fix(ui: &mut Ui, fix: &Fix, queue: &mut Queue) {
    heading(ui, "fix", &fix.id);
    name_row(ui, &fix.id, &fix.name, queue);
    position_row(ui, "Position", fix.position, |to| Edit::MoveFix { fix: fix.id.clone(), to }, queue);
    if !fix.description.is_empty() {
        ui.label(&fix.description);
    }
}

/// A position as text, `latitude, longitude` in degrees.
fn position_row(
    ui: &mut Ui,
    name: &str,
    at: geometry::LatLon,
    edit: impl Fn(geometry::LatLon) -> Edit,
    queue: &mut Queue,
) {
    field::row(ui, name, |ui| {
        let text = field::text(ui, name, &units::position(at), false);
        if let Some(to) = text.as_deref().and_then(coordinates::position) {
            queue.edit(edit(to));
        }
    });
}

fn show_runway(ui: &mut Ui, scene: &Scene<'_>, runway: &Runway) {
    let u = scene.units();
    heading(ui, "runway", &runway.id);
    field::row(ui, "Threshold", |ui| ui.label(units::position(runway.threshold)));
    field::row(ui, "Elevation", |ui| {
        ui.label(format!("{} AMSL", u.altitude().show(runway.elevation_amsl_m)))
    });
    field::row(ui, "Heading", |ui| ui.label(units::bearing(runway.heading_deg)));
    field::row(ui, "Length", |ui| ui.label(u.length().show(runway.length_m)));
    field::row(ui, "Priority", |ui| ui.label(runway.priority.to_string()));
}

fn show_zone(ui: &mut Ui, scene: &Scene<'_>, zone: &Zone) {
    let kind = match zone.kind {
        ZoneKind::KeepIn => "keep-in zone",
        ZoneKind::KeepOut => "keep-out zone",
    };
    heading(ui, kind, &zone.id);
    field::row(ui, "Name", |ui| ui.label(&zone.name));
    let shape = match &zone.shape {
        ZoneShape::Circle { radius_m, .. } => format!("circle, {}", scene.units().length().show(*radius_m)),
        ZoneShape::Polygon(corners) => format!("{} corners", corners.len()),
    };
    field::row(ui, "Outline", |ui| ui.label(shape));
    let band = crate::map::zones::band(zone, scene.units()).unwrap_or_else(|| "every altitude".into());
    field::row(ui, "Altitudes", |ui| ui.label(band));
    let active = match zone.active.len() {
        0 => "always".into(),
        n => format!("in {n} periods"),
    };
    field::row(ui, "Active", |ui| ui.label(active));
}

fn show_procedure(ui: &mut Ui, procedure: &Procedure) {
    heading(ui, "procedure", &procedure.id);
    field::row(ui, "Name", |ui| ui.label(&procedure.name));
    field::row(ui, "Legs", |ui| ui.label(procedure.legs.len().to_string()));
    for parameter in &procedure.parameters {
        let default = parameter.default.as_ref().map_or_else(|| "to be given".into(), |d| format!("= {d}"));
        field::row(ui, parameter.name.as_str(), |ui| ui.label(default));
    }
}

/// A variable: its initial value in the document, and its value aboard, which can be set in flight.
fn show_variable(ui: &mut Ui, scene: &Scene<'_>, variable: &Variable, queue: &mut Queue) {
    heading(ui, "variable", &variable.name);
    let change = variable_field(ui, "Initial value", variable, &variable.initial);
    send(change.map(|value| Edit::SetVariable { name: variable.name.clone(), value }), queue);
    let bounds = [variable.min.map(|m| format!("≥ {m}")), variable.max.map(|m| format!("≤ {m}"))];
    let bounds: Vec<String> = bounds.into_iter().flatten().collect();
    if !bounds.is_empty() {
        field::row(ui, "Bounds", |ui| ui.label(format!("{} {}", bounds.join(", "), variable.unit)));
    }
    let Some(aboard) = &scene.vehicle.variables else { return };
    let Some(live) = aboard.value.variables.iter().find(|v| v.name.as_str() == variable.name.as_str()) else {
        return;
    };
    let live: VariableValue = live.value.clone().convert();
    ui.separator();
    super::group_title(ui, "Aboard");
    let shown = crate::state::log::variable(&live);
    super::value_with_age(ui, "Value", &shown, super::age_of(&scene.vehicle.variables, scene.now_s));
    let id = egui::Id::unique(("set aboard", scene.vehicles.shown_name(), &variable.name));
    let mut draft: VariableValue = ui.data(|d| d.get_temp(id)).unwrap_or(live);
    match variable_field(ui, "New value", variable, &draft) {
        Change::Moving(value) | Change::Set(value) => draft = value,
        Change::None | Change::Ended => {}
    }
    if ui.add(super::primary_button("Set aboard", theme::of(ui))).clicked() {
        queue.fly(FlyCommand::Plan(Command::SetVariable {
            name: variable.name.clone(),
            value: draft.clone(),
        }));
    }
    ui.data_mut(|d| d.insert_temp(id, draft));
}

fn variable_field(
    ui: &mut Ui,
    name: &str,
    variable: &Variable,
    value: &VariableValue,
) -> Change<VariableValue> {
    let number_unit = units::Unit { symbol: "", per_si: 1.0, decimals: 2 };
    field::row(ui, name, |ui| match value {
        VariableValue::Number(n) => {
            let change = field::number(ui, name, *n, number_unit, variable.min.unwrap_or(f64::MIN));
            ui.label(&variable.unit);
            change.map(VariableValue::Number)
        }
        VariableValue::Bool(current) => {
            let mut new = *current;
            let text = if new { "true" } else { "false" };
            if ui.checkbox(&mut new, text).changed() {
                Change::Set(VariableValue::Bool(new))
            } else {
                Change::None
            }
        }
        VariableValue::Text(current) => match field::text(ui, name, current, false) {
            Some(new) => Change::Set(VariableValue::Text(new)),
            None => Change::None,
        },
        VariableValue::Position(at) => {
            let text = field::text(ui, name, &units::position(*at), false);
            match text.as_deref().and_then(coordinates::position) {
                Some(to) => Change::Set(VariableValue::Position(to)),
                None => Change::None,
            }
        }
        VariableValue::Polygon(corners) => {
            ui.label(format!("{} corners", corners.len()));
            Change::None
        }
    })
}
