//! A leg: what every leg has, then what its kind has.

use super::super::Scene;
use super::super::field;
use super::level::{altitude_row, speed_row};
use super::{emergency_row, heading, name_row, position_row, send};
use crate::command::Queue;
use crate::theme;
use crate::units::{Unit, Units};
use egui::{RichText, Ui};
use flight_exec::{Command, Phase};
use flight_plan::{
    Act, Area, Call, DecideBefore, Edit, Id, Leg, LegAction, LegContext, LegKind, Pattern, Place,
    PlanWaypoint, Procedure, Scan, Trigger, TurnDirection, Value,
};

const DEGREES: Unit = Unit { symbol: "°", per_si: 1.0, decimals: 0 };
const SECONDS: Unit = Unit { symbol: "s", per_si: 1.0, decimals: 0 };
const TIMES: Unit = Unit { symbol: "×", per_si: 1.0, decimals: 0 };
const SHARE: Unit = Unit { symbol: "%", per_si: 100.0, decimals: 0 };

/// Draws a leg's properties.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, context: &LegContext<'_>, queue: &mut Queue) {
    let leg = context.leg;
    heading(ui, leg.kind_name(), &leg.id);
    fly_row(ui, scene, context, queue);
    name_row(ui, &leg.id, &leg.name, queue);
    altitude_row(ui, scene, &leg.id, leg.altitude.as_ref(), queue);
    speed_row(ui, scene, &leg.id, leg.speed_mps.as_ref(), queue);
    kind_rows(ui, scene, leg, queue);
    number_rows(ui, scene.units(), leg, queue);
    action_rows(ui, leg);
    emergency_row(ui, scene.document.plan(), &leg.id, &leg.emergency, queue);
    ui.add_space(2.0);
    if ui.button("Delete this leg").clicked() {
        queue.edit(Edit::DeleteLeg { leg: leg.id.clone() });
    }
}

/// Draws the properties of a leg inside a procedure, which the window shows and doesn't change.
pub fn show_in_procedure(ui: &mut Ui, scene: &Scene<'_>, procedure: &Procedure, leg: &Leg) {
    heading(ui, leg.kind_name(), &leg.id);
    field::row(ui, "Procedure", |ui| ui.label(procedure.id.as_str()));
    let mut nothing = Queue::default();
    ui.add_enabled_ui(false, |ui| {
        altitude_row(ui, scene, &leg.id, leg.altitude.as_ref(), &mut nothing);
        speed_row(ui, scene, &leg.id, leg.speed_mps.as_ref(), &mut nothing);
        kind_rows(ui, scene, leg, &mut nothing);
        number_rows(ui, scene.units(), leg, &mut nothing);
    });
    action_rows(ui, leg);
}

/// Commands that concern this leg of the plan that is being flown.
fn fly_row(ui: &mut Ui, scene: &Scene<'_>, context: &LegContext<'_>, queue: &mut Queue) {
    let id = &context.leg.id;
    let aboard = scene.vehicle.aboard.as_ref().is_some_and(|a| a.plan.leg(id).is_some());
    let flying = matches!(scene.vehicle.phase(), Phase::Flying | Phase::Holding | Phase::AwaitingDecision);
    if !(aboard && flying) {
        return;
    }
    ui.horizontal(|ui| {
        if ui.button("Go to this leg").clicked() {
            queue.plan(Command::GoTo { leg: id.clone() });
        }
        let emergency = scene
            .vehicle
            .status
            .as_ref()
            .and_then(|s| s.value.place.as_ref())
            .is_some_and(|p| p.plan != flight_exec::Branching::Main);
        if emergency && ui.button("Return to the main plan here").clicked() {
            queue.plan(Command::ReturnToMain { leg: id.clone() });
        }
    });
    if let Some(place) = iteration_of(scene, id) {
        ui.label(RichText::new(super::super::flight::iteration(&place)).color(theme::of(ui).active));
    }
}

fn iteration_of(scene: &Scene<'_>, id: &Id) -> Option<flight_exec::IterationPlace> {
    let place = scene.vehicle.status.as_ref()?.value.place.as_ref()?;
    place.iterations.iter().find(|i| i.leg == *id).cloned()
}

/// Another kind in the place of the leg's own.
fn with_kind(leg: &Leg, kind: LegKind) -> Edit {
    Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(Leg { kind, ..leg.clone() }) }
}

/// What is particular to a kind and no number.
fn kind_rows(ui: &mut Ui, scene: &Scene<'_>, leg: &Leg, queue: &mut Queue) {
    match &leg.kind {
        LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, .. } => waypoint_rows(ui, leg, to, queue),
        LegKind::Cf { to, .. } | LegKind::Fa { from: to, .. } => waypoint_rows(ui, leg, to, queue),
        LegKind::Rf { to, centre, .. } => {
            waypoint_rows(ui, leg, to, queue);
            field::row(ui, "Centre", |ui| ui.label(crate::units::position(*centre)));
        }
        LegKind::Hf(h) | LegKind::Ha(h) => waypoint_rows(ui, leg, &h.fix, queue),
        LegKind::Hm { holding, until, .. } => {
            waypoint_rows(ui, leg, &holding.fix, queue);
            until_row(ui, leg, until.as_deref(), queue);
        }
        LegKind::Iterative { until, .. } => until_row(ui, leg, until.as_deref(), queue),
        LegKind::Intersection { default, decide_before, .. } => {
            fork_rows(ui, scene.units(), leg, default.as_ref(), decide_before, queue)
        }
        LegKind::Scan(Scan { area, .. }) | LegKind::Pattern(Pattern::Contour { area, .. }) => {
            area_row(ui, area)
        }
        LegKind::Pattern(pattern) => pattern_rows(ui, pattern),
        LegKind::Orbit { centre, .. } => centre_row(ui, centre),
        LegKind::Call(call) => call_rows(ui, call),
    }
    turn_row(ui, leg, queue);
}

fn place_text(place: &Place) -> String {
    match place {
        Place::Fix(id) => format!("fix {id}"),
        Place::Position(Value::Constant(at)) => crate::units::position(*at),
        Place::Position(Value::Expression(source)) => format!("= {source}"),
    }
}

fn waypoint_rows(ui: &mut Ui, leg: &Leg, to: &PlanWaypoint, queue: &mut Queue) {
    match &to.place {
        Place::Position(Value::Constant(at)) => {
            position_row(ui, "To", *at, |to| Edit::MoveWaypoint { leg: leg.id.clone(), to }, queue);
        }
        other => {
            field::row(ui, "To", |ui| ui.label(place_text(other)));
        }
    }
    let mut fly_over = to.fly_over;
    if ui.checkbox(&mut fly_over, "Cross it before turning (fly-over)").changed() {
        queue.edit(Edit::SetFlyOver { leg: leg.id.clone(), fly_over });
    }
}

fn centre_row(ui: &mut Ui, centre: &Place) {
    field::row(ui, "Centre", |ui| ui.label(place_text(centre)));
}

fn area_row(ui: &mut Ui, area: &Area) {
    let text = match area {
        Area::Circle { centre, .. } => return centre_row(ui, centre),
        Area::Polygon { corners, holes } => format!("{} corners, {} holes", corners.len(), holes.len()),
        Area::Expression(source) => format!("= {source}"),
    };
    field::row(ui, "Area", |ui| ui.label(text));
}

fn pattern_rows(ui: &mut Ui, pattern: &Pattern) {
    match pattern {
        Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. } => {
            field::row(ui, "Route", |ui| ui.label(format!("{} points", route.len())));
        }
        _ => pattern.centre().into_iter().for_each(|centre| centre_row(ui, centre)),
    }
}

fn call_rows(ui: &mut Ui, call: &Call) {
    field::row(ui, "Procedure", |ui| ui.label(call.procedure.as_str()));
    if let Some(anchor) = &call.anchor {
        field::row(ui, "Anchor", |ui| ui.label(place_text(anchor)));
    }
    for (name, source) in &call.arguments {
        field::row(ui, name.as_str(), |ui| ui.label(format!("= {source}")));
    }
}

/// The side of a leg's turns, where it has one.
fn turn_of(kind: &mut LegKind) -> Option<&mut TurnDirection> {
    match kind {
        LegKind::Rf { turn, .. } | LegKind::Iterative { turn, .. } | LegKind::Orbit { turn, .. } => {
            Some(turn)
        }
        LegKind::Hf(h) | LegKind::Ha(h) | LegKind::Hm { holding: h, .. } => Some(&mut h.turn),
        LegKind::Pattern(
            Pattern::Spiral { turn, .. }
            | Pattern::ExpandingSquare { turn, .. }
            | Pattern::Sector { turn, .. }
            | Pattern::Contour { turn, .. }
            | Pattern::FigureEight { turn, .. },
        ) => Some(turn),
        _ => None,
    }
}

/// A choice between left and right.
fn turn_row(ui: &mut Ui, leg: &Leg, queue: &mut Queue) {
    let mut kind = leg.kind.clone();
    let Some(turn) = turn_of(&mut kind) else { return };
    let before = *turn;
    field::row(ui, "Turn", |ui| {
        ui.selectable_value(turn, TurnDirection::Left, "left");
        ui.selectable_value(turn, TurnDirection::Right, "right");
    });
    if *turn != before {
        queue.edit(with_kind(leg, kind));
    }
}

/// What people call a number of the document, its unit, the least it can be, and what it is when it is first given.
fn meaning(name: &'static str, u: Units) -> (&'static str, Unit, f64, f64) {
    match name {
        "course" => ("Course", DEGREES, 0.0, 0.0),
        "heading" => ("Heading", DEGREES, 0.0, 0.0),
        "bearing" => ("Bearing", DEGREES, 0.0, 0.0),
        "length" => ("Leg length", u.length(), 1.0, 1000.0),
        "time" => ("Leg time", SECONDS, 1.0, 60.0),
        "count" => ("Count", TIMES, 1.0, 1.0),
        "maxLaps" => ("Most laps", TIMES, 1.0, 10.0),
        "turns" => ("Turns", TIMES, 0.25, 1.0),
        "passes" => ("Passes", TIMES, 1.0, 1.0),
        "loops" => ("Loops", TIMES, 1.0, 3.0),
        "levels" => ("Levels", TIMES, 1.0, 3.0),
        "levelStep" => ("Level step", u.altitude(), f64::MIN, -50.0),
        "sectors" => ("Sectors", TIMES, 3.0, 3.0),
        "spacing" => ("Spacing", u.length(), 1.0, 100.0),
        "overshoot" => ("Overshoot", u.length(), 0.0, 0.0),
        "radius" => ("Radius", u.length(), 1.0, 300.0),
        "innerRadius" => ("Inner radius", u.length(), 0.0, 0.0),
        "outerRadius" => ("Outer radius", u.length(), 1.0, 500.0),
        "width" => ("Width", u.length(), 1.0, 200.0),
        "height" => ("Height", u.altitude(), 1.0, 100.0),
        "fieldOfView" => ("View angle", DEGREES, 1.0, 60.0),
        "overlap" => ("Overlap", SHARE, 0.0, 0.6),
        other => (other, Unit { symbol: "", per_si: 1.0, decimals: 2 }, f64::MIN, 0.0),
    }
}

/// Every number of the leg's kind.
fn number_rows(ui: &mut Ui, u: Units, leg: &Leg, queue: &mut Queue) {
    // altitude and airspeed have rows of their own
    let own = leg.numbers().into_iter().filter(|(name, _)| !matches!(*name, "altitude" | "speed"));
    for (name, value) in own {
        let (shown, unit, least, first) = meaning(name, u);
        let set = |value| Edit::SetNumber { leg: leg.id.clone(), name: name.into(), value };
        field::row(ui, shown, |ui| match value {
            Some(value) => {
                let change = field::number_value(ui, shown, value, unit, least);
                send(change.map(|value| set(Some(value))), queue);
            }
            None => {
                if ui.button("not given").on_hover_text("Give it a value").clicked() {
                    queue.edit(set(Some(Value::Constant(first))));
                }
            }
        });
    }
}

fn until_row(ui: &mut Ui, leg: &Leg, until: Option<&str>, queue: &mut Queue) {
    field::row(ui, "Until", |ui| {
        let Some(new) = field::text(ui, "Until", until.unwrap_or_default(), true) else { return };
        let condition = (!new.trim().is_empty()).then(|| new.trim().into());
        let mut kind = leg.kind.clone();
        if let LegKind::Iterative { until, .. } | LegKind::Hm { until, .. } = &mut kind {
            *until = condition;
            queue.edit(with_kind(leg, kind));
        }
    });
}

/// What is done on the leg.
fn action_rows(ui: &mut Ui, leg: &Leg) {
    for LegAction { trigger, act } in &leg.actions {
        ui.label(RichText::new(format!("◉ {}: {}", when(trigger), what(act))).size(12.0));
    }
}

fn when(trigger: &Trigger) -> String {
    let number = |value: &Value<f64>| match value {
        Value::Constant(x) => x.to_string(),
        Value::Expression(source) => format!("({source})"),
    };
    match trigger {
        Trigger::Start => "at its start".into(),
        Trigger::End => "at its end".into(),
        Trigger::Distance(metres) => format!("after {} m", number(metres)),
        Trigger::Every(metres) => format!("every {} m", number(metres)),
        Trigger::Time(seconds) => format!("after {} s", number(seconds)),
        Trigger::Abeam(place) => format!("abeam {}", place_text(place)),
    }
}

fn what(act: &Act) -> String {
    match act {
        Act::Photo => "a picture".into(),
        Act::PhotoSeries { .. } => "begin a series of pictures".into(),
        Act::PhotoStop => "end the pictures".into(),
        Act::VideoStart => "record video".into(),
        Act::VideoStop => "end the video".into(),
        Act::Set { variable, to } => format!("{variable} = {to}"),
        Act::Invoke { service, operation, .. } => format!("call {service}/{operation}"),
        Act::Wait { .. } => "circle for a while".into(),
    }
}

fn fork_rows(
    ui: &mut Ui,
    u: Units,
    leg: &Leg,
    default: Option<&Id>,
    before: &DecideBefore,
    queue: &mut Queue,
) {
    let LegKind::Intersection { branches, .. } = &leg.kind else { return };
    field::row(ui, "Default", |ui| {
        egui::ComboBox::from_id_salt("default branch")
            .selected_text(default.map_or("none: hold and ask", Id::as_str))
            .show_ui(ui, |ui| {
                let ids = branches.iter().map(|b| Some(&b.id));
                for id in std::iter::once(None).chain(ids) {
                    if ui
                        .selectable_label(id == default, id.map_or("none: hold and ask", Id::as_str))
                        .clicked()
                    {
                        queue.edit(Edit::SetDefault { leg: leg.id.clone(), branch: id.cloned() });
                    }
                }
            });
    });
    let text = match before {
        DecideBefore::Time(seconds) => crate::units::duration(*seconds),
        DecideBefore::Distance(metres) => u.length().show(*metres),
    };
    field::row(ui, "Due before", |ui| ui.label(text));
    for branch in branches {
        let to = branch.next.as_ref().map_or("what follows", Id::as_str);
        let when = branch.when.as_ref().map(|w| format!(", when {w}")).unwrap_or_default();
        ui.label(format!("▸ {}: to {to}{when}", branch.label));
    }
}
