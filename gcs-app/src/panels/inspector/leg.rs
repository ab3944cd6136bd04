//! A leg: what every leg has, then what its kind has.

use super::super::Scene;
use super::super::field::{self, Change};
use super::{altitude_row, emergency_row, heading, name_row, position_row, send, speed_row};
use crate::command::Queue;
use crate::theme;
use crate::units::{Unit, Units};
use egui::{RichText, Ui};
use flight_exec::{Command, Phase};
use flight_plan::{
    Area, DecideBefore, Edit, Holding, HoldingLength, Id, Leg, LegContext, LegKind, Place, PlanWaypoint,
    Scan, Spacing, TurnDirection, Value,
};

const DEGREES: Unit = Unit { symbol: "°", per_si: 1.0, decimals: 0 };
const SECONDS: Unit = Unit { symbol: "s", per_si: 1.0, decimals: 0 };
const TIMES: Unit = Unit { symbol: "×", per_si: 1.0, decimals: 0 };

/// Draws a leg's properties.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, context: &LegContext<'_>, queue: &mut Queue) {
    let leg = context.leg;
    heading(ui, leg.kind_name(), &leg.id);
    fly_row(ui, scene, context, queue);
    name_row(ui, &leg.id, &leg.name, queue);
    altitude_row(ui, scene.units(), &leg.id, leg.altitude.as_ref(), queue);
    speed_row(ui, scene.units(), &leg.id, leg.speed_mps.as_ref(), queue);
    kind_rows(ui, scene, leg, queue);
    emergency_row(ui, scene.document.plan(), &leg.id, &leg.emergency, queue);
    ui.add_space(2.0);
    if ui.button("Delete this leg").clicked() {
        queue.edit(Edit::DeleteLeg { leg: leg.id.clone() });
    }
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

fn kind_rows(ui: &mut Ui, scene: &Scene<'_>, leg: &Leg, queue: &mut Queue) {
    let u = scene.units();
    match &leg.kind {
        LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, .. } => waypoint_rows(ui, leg, to, queue),
        LegKind::Rf { to, centre, turn } => {
            waypoint_rows(ui, leg, to, queue);
            field::row(ui, "Centre", |ui| ui.label(crate::units::position(*centre)));
            field::row(ui, "Turn", |ui| ui.label(turn_text(*turn)));
        }
        LegKind::Hf(h) => holding_rows(ui, u, leg, h, LegKind::Hf, queue),
        LegKind::Ha(h) => holding_rows(ui, u, leg, h, LegKind::Ha, queue),
        LegKind::Hm { holding, until, max_laps } => {
            let kind = |holding| LegKind::Hm { holding, until: until.clone(), max_laps: max_laps.clone() };
            holding_rows(ui, u, leg, holding, kind, queue);
        }
        LegKind::Cf { to, .. } | LegKind::Fa { from: to, .. } => waypoint_rows(ui, leg, to, queue),
        LegKind::Pattern(_) | LegKind::Call(_) => {}
        LegKind::Iterative { count, until, .. } => {
            loop_rows(ui, leg, count.as_ref(), until.as_deref(), queue)
        }
        LegKind::Intersection { default, decide_before, .. } => {
            fork_rows(ui, u, leg, default.as_ref(), decide_before, queue)
        }
        LegKind::Scan(scan) => scan_rows(ui, u, leg, scan, queue),
        LegKind::Orbit { radius_m, turns, centre, turn } => {
            orbit_rows(ui, u, leg, (centre, radius_m, turns, *turn), queue)
        }
    }
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

fn turn_text(turn: TurnDirection) -> &'static str {
    match turn {
        TurnDirection::Left => "left",
        TurnDirection::Right => "right",
    }
}

/// A choice between left and right.
fn turn_row(ui: &mut Ui, turn: TurnDirection) -> Change<TurnDirection> {
    field::row(ui, "Turn", |ui| {
        let mut new = turn;
        ui.selectable_value(&mut new, TurnDirection::Left, "left");
        ui.selectable_value(&mut new, TurnDirection::Right, "right");
        if new == turn { Change::None } else { Change::Set(new) }
    })
}

fn value_row(
    ui: &mut Ui,
    name: &str,
    value: &Value<f64>,
    unit: Unit,
    least: f64,
    edit: impl FnOnce(Value<f64>) -> Edit,
    queue: &mut Queue,
) {
    let change = field::row(ui, name, |ui| field::number_value(ui, name, value, unit, least));
    send(change.map(edit), queue);
}

fn holding_rows(
    ui: &mut Ui,
    u: Units,
    leg: &Leg,
    h: &Holding,
    kind: impl Fn(Holding) -> LegKind,
    queue: &mut Queue,
) {
    waypoint_rows(ui, leg, &h.fix, queue);
    send(turn_row(ui, h.turn).map(|turn| with_kind(leg, kind(Holding { turn, ..h.clone() }))), queue);
    if let Some(course) = &h.inbound_course_deg {
        let edit = |v| with_kind(leg, kind(Holding { inbound_course_deg: Some(v), ..h.clone() }));
        value_row(ui, "Inbound", course, DEGREES, 0.0, edit, queue);
    }
    match &h.leg {
        HoldingLength::Distance(d) => {
            let edit = |v| with_kind(leg, kind(Holding { leg: HoldingLength::Distance(v), ..h.clone() }));
            value_row(ui, "Leg length", d, u.length(), 1.0, edit, queue);
        }
        HoldingLength::Time(t) => {
            let edit = |v| with_kind(leg, kind(Holding { leg: HoldingLength::Time(v), ..h.clone() }));
            value_row(ui, "Leg time", t, SECONDS, 1.0, edit, queue);
        }
    }
}

fn loop_rows(ui: &mut Ui, leg: &Leg, count: Option<&Value<f64>>, until: Option<&str>, queue: &mut Queue) {
    let set = |count| Edit::SetCount { leg: leg.id.clone(), count };
    match count {
        Some(count) => value_row(ui, "Count", count, TIMES, 1.0, |v| set(Some(v)), queue),
        None => field::row(ui, "Count", |ui| {
            if ui.button("no limit").clicked() {
                queue.edit(set(Some(Value::Constant(1.0))));
            }
        }),
    }
    field::row(ui, "Until", |ui| {
        if let Some(new) = field::text(ui, "Until", until.unwrap_or_default(), true)
            && let LegKind::Iterative { form, count, turn, body, .. } = leg.kind.clone()
        {
            let until = (!new.trim().is_empty()).then(|| new.trim().into());
            queue.edit(with_kind(leg, LegKind::Iterative { form, count, until, turn, body }));
        }
    });
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

fn scan_rows(ui: &mut Ui, u: Units, leg: &Leg, scan: &Scan, queue: &mut Queue) {
    let with = |scan: Scan| with_kind(leg, LegKind::Scan(scan));
    match &scan.area {
        Area::Circle { centre, radius_m } => {
            field::row(ui, "Centre", |ui| ui.label(place_text(centre)));
            let edit = |radius_m| Edit::SetArea {
                leg: leg.id.clone(),
                area: Area::Circle { centre: centre.clone(), radius_m },
            };
            value_row(ui, "Radius", radius_m, u.length(), 1.0, edit, queue);
        }
        Area::Polygon { corners, holes } => {
            field::row(ui, "Area", |ui| {
                ui.label(format!("{} corners, {} holes", corners.len(), holes.len()))
            });
        }
        Area::Expression(source) => {
            field::row(ui, "Area", |ui| ui.label(format!("= {source}")));
        }
    }
    if let Spacing::Metres(spacing_m) = &scan.spacing {
        let edit = |v| with(Scan { spacing: Spacing::Metres(v), ..scan.clone() });
        value_row(ui, "Spacing", spacing_m, u.length(), 1.0, edit, queue);
    }
    value_row(
        ui,
        "Overshoot",
        &scan.overshoot_m,
        u.length(),
        0.0,
        |v| with(Scan { overshoot_m: v, ..scan.clone() }),
        queue,
    );
    match &scan.heading_deg {
        Some(heading) => value_row(
            ui,
            "Tracks",
            heading,
            DEGREES,
            0.0,
            |v| with(Scan { heading_deg: Some(v), ..scan.clone() }),
            queue,
        ),
        None => field::row(ui, "Tracks", |ui| {
            if ui.button("fewest turns").on_hover_text("Give the tracks a direction").clicked() {
                queue.edit(with(Scan { heading_deg: Some(Value::Constant(0.0)), ..scan.clone() }));
            }
        }),
    }
}

type OrbitParts<'a> = (&'a Place, &'a Value<f64>, &'a Value<f64>, TurnDirection);

fn orbit_rows(
    ui: &mut Ui,
    u: Units,
    leg: &Leg,
    (centre, radius_m, turns, turn): OrbitParts<'_>,
    queue: &mut Queue,
) {
    let orbit = |radius_m: Value<f64>, turns: Value<f64>, turn| {
        with_kind(leg, LegKind::Orbit { centre: centre.clone(), radius_m, turns, turn })
    };
    field::row(ui, "Centre", |ui| ui.label(place_text(centre)));
    value_row(ui, "Radius", radius_m, u.length(), 1.0, |v| orbit(v, turns.clone(), turn), queue);
    value_row(ui, "Turns", turns, TIMES, 0.25, |v| orbit(radius_m.clone(), v, turn), queue);
    send(turn_row(ui, turn).map(|turn| orbit(radius_m.clone(), turns.clone(), turn)), queue);
}
