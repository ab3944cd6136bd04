//! A command that leads elsewhere is looked at before it is given: what would follow, on the map and in words, then the
//! command, named by its effect.

use super::{Scene, answer, field};
use crate::command::{FlyCommand, Queue};
use crate::state::{Considered, Vehicle};
use crate::theme;
use crate::units::{self, Unit};
use egui::{RichText, ScrollArea, Ui};
use flight_exec::{Command, Foresight};
use flight_plan::checks::CLEARANCE_M;
use flight_plan::{Altitude, AltitudeReference, Id, Value};
use usal::contract::GatewayState;

/// Room for the button: what it does is known in more words a moment later, and nothing below moves for that, screen points.
const BUTTON: f32 = 2.0 * 17.0 + 12.0;
/// What was told so long ago is of another place, seconds of the window's clock: it is looked at again each second.
const OLD_S: f64 = 5.0;
/// The same by the aircraft's clock, which in a simulation may be much faster.
const OLD_AIRCRAFT_S: f64 = 20.0;
/// So many legs are named.
const MOST_LEGS: usize = 12;

/// Draws what would follow the command that is considered; false: none is.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, width: Option<f32>, queue: &mut Queue) -> bool {
    let Some(considered) = scene.vehicle.outlook.considered() else { return false };
    super::read_beside_map(ui, width, |ui| body(ui, scene, considered, queue));
    true
}

fn body(ui: &mut Ui, scene: &Scene<'_>, considered: &Considered, queue: &mut Queue) {
    let p = theme::of(ui);
    let what = crate::app::plan_label(&considered.command, scene.vehicle);
    ui.label(RichText::new(format!("{what}?")).strong().size(16.0));
    // the decision first: it is never scrolled away
    let gone_on =
        considered.command == Command::SkipLeg && considered.has_gone_on(scene.vehicle.current_leg());
    ui.scope(|ui| {
        ui.set_min_height(BUTTON);
        // who is in a hurry holds the button, whatever is known by then
        ui.add_enabled_ui(!gone_on, |ui| give(ui, scene, considered, queue));
    });
    ui.horizontal(|ui| {
        if ui.button("Cancel").clicked() {
            queue.fly(FlyCommand::PutAside);
        }
        // everything else is looked at again by itself
        if gone_on && ui.button("Look again").clicked() {
            queue.fly(FlyCommand::Consider(considered.command.clone()));
        }
    });
    if gone_on {
        let text = "⚠ The aircraft is on another leg by now: look again.";
        ui.label(RichText::new(text).color(p.caution));
    }
    ui.separator();
    match &considered.foresight {
        None => {
            ui.horizontal(|ui| {
                ui.add(egui::Spinner::new().size(14.0));
                ui.label("Looking ahead…");
            });
        }
        Some(Err(why)) => {
            ui.label(RichText::new(format!("⚠ What follows is not known: {why}")).color(p.caution));
        }
        Some(Ok(foresight)) => follows(ui, considered, foresight, scene),
    }
}

/// The command itself. It is always held: what is known of the way changes while it is read, and a button that is to be clicked now
/// and held a moment later is pressed in vain. Amber, where something is against it or nothing is known.
fn give(ui: &mut Ui, scene: &Scene<'_>, considered: &Considered, queue: &mut Queue) {
    let p = theme::of(ui);
    let text = effect(considered, scene.vehicle);
    let is_as_told = since(considered, scene).is_empty();
    let is_clean = matches!(&considered.foresight, Some(Ok(foresight)) if is_as_told && cautions(considered, foresight, scene).is_empty());
    let colour = if is_clean { p.accent } else { p.caution };
    if field::hold_button(ui, &text, colour, ui.available_width()) {
        queue.plan(considered.command.clone());
    }
}

/// What has become of the aircraft since what follows was told, or is about to: who reads it decides about another flight.
fn since(considered: &Considered, scene: &Scene<'_>) -> Vec<String> {
    let vehicle = scene.vehicle;
    let again = if vehicle.open_link().is_some() { ": looking again" } else { "" };
    let age_s = considered.age_s(scene.now_s, vehicle.clock_s(scene.now_s));
    let is_old = considered.age_s(scene.now_s, None).is_some_and(|age_s| age_s > OLD_S);
    let old = age_s.filter(|age_s| is_old || *age_s > OLD_AIRCRAFT_S);
    let old = old.map(|age_s| format!("Looked at {} ago{again}", units::duration(age_s)));
    // another leg is not skipped at all: that is said at the button
    let is_elsewhere =
        considered.command != Command::SkipLeg && considered.has_gone_on(vehicle.current_leg());
    let elsewhere = is_elsewhere.then(|| format!("The aircraft is on another leg by now{again}"));
    let state = vehicle.gateway.as_ref().map(|gateway| gateway.value.state);
    let landing = (state == Some(GatewayState::Land)).then(|| {
        let (watch, unit) = (&vehicle.watch, scene.units().altitude());
        let agl = watch.agl_m.map(|m| format!(", {} above {}", unit.show(m), watch.below()));
        format!("It is landing{}: it would go around", agl.unwrap_or_default())
    });
    old.into_iter().chain(elsewhere).chain(landing).collect()
}

/// `Skip side2, fly side3 next`.
fn effect(considered: &Considered, vehicle: &Vehicle) -> String {
    let name = |leg: &Id| vehicle.name_of(leg);
    let next = match &considered.foresight {
        Some(Ok(foresight)) => foresight.next_leg.as_ref(),
        _ => None,
    };
    match &considered.command {
        Command::SkipLeg => {
            let leg = considered.on_leg.as_ref().map_or_else(|| "this leg".to_owned(), name);
            let next = next.map_or_else(String::new, |next| format!(", fly {} next", name(next)));
            format!("Skip {leg}{next}")
        }
        other => crate::app::plan_label(other, vehicle),
    }
}

/// What would follow, in words.
fn follows(ui: &mut Ui, considered: &Considered, foresight: &Foresight, scene: &Scene<'_>) {
    let p = theme::of(ui);
    ui.label(RichText::new("══ double line on the map: the path that would be flown").color(p.text));
    ScrollArea::vertical().id_salt("consider").auto_shrink(false).show(ui, |ui| {
        for line in since(considered, scene).into_iter().chain(cautions(considered, foresight, scene)) {
            ui.label(RichText::new(format!("⚠ {line}")).color(p.caution));
        }
        for line in facts(considered, foresight, scene) {
            ui.label(line);
        }
    });
}

fn cautions(considered: &Considered, foresight: &Foresight, scene: &Scene<'_>) -> Vec<String> {
    let units = scene.units();
    let climb = foresight.short_of_altitude_m.map(|short_m| {
        format!("Climb not done: it arrives {} below the leg's altitude", units.altitude().show(short_m))
    });
    let end = foresight.cut_short.clone();
    let unfinished = (end.is_none() && !foresight.landed).then(|| "It does not end on the ground".to_owned());
    let height = height(considered, foresight);
    let low = height.filter(|height| height.least_m < CLEARANCE_M).map(|height| {
        let [least, kept] = [height.least_m, CLEARANCE_M].map(|m| units.altitude().show(m));
        format!(
            "Only {least} above the ground where it is lowest{}: a plan is written to keep {kept}",
            height.by()
        )
    });
    climb
        .into_iter()
        .chain(unknown_ground(height).map(str::to_owned))
        .chain(low)
        .chain(foresight.problems.iter().map(|problem| answer::told(scene, false, problem)))
        .chain(end)
        .chain(unfinished)
        .collect()
}

/// The height above the ground on the way that would be flown, until the approach.
#[derive(Clone, Copy)]
struct Height {
    least_m: f64,
    is_whole: bool,
    /// By the agent's elevations, not by this window's.
    is_from_aboard: bool,
}

impl Height {
    /// `, by this window's elevations`.
    fn by(self) -> &'static str {
        if self.is_from_aboard { "" } else { ", by this window's elevations" }
    }
}

/// What the agent knows; else what this window knows.
fn height(considered: &Considered, foresight: &Foresight) -> Option<Height> {
    let aboard = foresight.clearance_m.map(|least_m| (least_m, true));
    let here = || considered.clearance.map(|here| (here.least_m, here.is_whole));
    let (least_m, is_whole) = aboard.or_else(here)?;
    Some(Height { least_m, is_whole, is_from_aboard: aboard.is_some() })
}

fn unknown_ground(height: Option<Height>) -> Option<&'static str> {
    match height {
        None => {
            Some("The ground below is known neither aboard nor here: load elevations (Maps), and look again")
        }
        Some(height) if !height.is_whole => Some(
            "The ground below is known for a part of the way only: load more elevations (Maps), and look again",
        ),
        Some(_) => None,
    }
}

fn facts(considered: &Considered, foresight: &Foresight, scene: &Scene<'_>) -> Vec<String> {
    let (vehicle, units) = (scene.vehicle, scene.units());
    let next = foresight.next_leg.as_ref().map(|leg| format!("Flies next: {}", vehicle.name_of(leg)));
    let clearance = height(considered, foresight).map(|height| {
        let least = units.altitude().show(height.least_m);
        format!("Least height above the ground until the approach: {least}{}", height.by())
    });
    let end = format!(
        "Ends in {} after {}, with {:.0} % energy left",
        units::duration(foresight.time_s),
        units.distance().show(foresight.distance_m),
        foresight.battery_left * 100.0
    );
    let rounds = begun_anew(&considered.command, vehicle);
    let levels = change_of_level(foresight, vehicle, units.altitude());
    next.into_iter()
        .chain(levels)
        .chain(rounds)
        .chain(left_out(foresight, vehicle))
        .chain(clearance)
        .chain([end])
        .collect()
}

/// `First descends 120 m, to 1200 m AMSL`: until the path is level from there on, or turns the other way. Where that is not the altitude
/// of the leg that is flown next, the legs behind it go on so.
fn change_of_level(foresight: &Foresight, vehicle: &Vehicle, unit: Unit) -> Option<String> {
    let from_m = foresight.path.first()?.altitude_amsl_m;
    let mut to_m = from_m;
    for (at, next) in foresight.path.iter().zip(foresight.path.iter().skip(1)) {
        let (by_m, step_m) = (to_m - from_m, next.altitude_amsl_m - at.altitude_amsl_m);
        let is_level = step_m.abs() < LEVEL_MPS * (next.time_s - at.time_s);
        if by_m.abs() >= MUCH_M && (is_level || by_m * step_m < 0.0) {
            break;
        }
        to_m = next.altitude_amsl_m;
    }
    let by_m = to_m - from_m;
    let does = if by_m < 0.0 { "descends" } else { "climbs" };
    let next = foresight.next_leg.as_ref().and_then(|leg| Some((leg, altitude_amsl_m(leg, vehicle)?)));
    let goes_on = next.filter(|(_, leg_m)| (leg_m - to_m).abs() >= MUCH_M);
    let goes_on = goes_on.map_or_else(String::new, |(leg, leg_m)| {
        format!(": to {} on {}, and on behind it", unit.show(leg_m), vehicle.name_of(leg))
    });
    let told = || format!("First {does} {}, to {} AMSL{goes_on}", unit.show(by_m.abs()), unit.show(to_m));
    (by_m.abs() >= MUCH_M).then(told)
}

/// The altitude that a leg of the plan aboard asks for, metres AMSL; `None`: it changes with the ground or a variable.
fn altitude_amsl_m(leg: &Id, vehicle: &Vehicle) -> Option<f64> {
    let plan = &vehicle.aboard.as_ref()?.plan;
    let context = plan.leg(leg)?;
    let Altitude { metres: Value::Constant(metres), reference } = context.altitude()? else { return None };
    match reference {
        AltitudeReference::Amsl => Some(*metres),
        AltitudeReference::Home => Some(metres + plan.home()?.elevation_amsl_m),
        AltitudeReference::Agl => None,
    }
}

/// A path that climbs or descends less is level, m/s.
const LEVEL_MPS: f64 = 0.2;
/// A change of altitude that is told, metres.
const MUCH_M: f64 = 20.0;

/// What is not flown, by whose it is: legs of an emergency plan often have the names of those of the main plan.
fn left_out(foresight: &Foresight, vehicle: &Vehicle) -> Vec<String> {
    let emergency = |leg: &Id| vehicle.emergency_plan_of(leg).map(|plan| &plan.id);
    let (main, others): (Vec<&Id>, Vec<&Id>) =
        foresight.left_out.iter().partition(|leg| emergency(leg).is_none());
    let of_main = match main.as_slice() {
        [] => "Left out: nothing".to_owned(),
        legs => format!("Left out: {}", named(legs, vehicle)),
    };
    let of_others = others.chunk_by(|a, b| emergency(a) == emergency(b)).filter_map(|legs| {
        let plan = emergency(legs.first()?)?;
        Some(format!("Left out of {}: {}", vehicle.name_of(plan), named(legs, vehicle)))
    });
    std::iter::once(of_main).chain(of_others).collect()
}

/// `side2, side3 and 5 more`.
fn named(legs: &[&Id], vehicle: &Vehicle) -> String {
    let names: Vec<String> = legs.iter().take(MOST_LEGS).map(|leg| vehicle.name_of(leg)).collect();
    let more = legs.len() - names.len();
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{more}", names.join(", "))
}

/// `Rounds over the fire begins its rounds anew: 1 of 3`: an emergency ends the loops in which it was raised, and a loop that is entered
/// counts from one.
fn begun_anew(command: &Command, vehicle: &Vehicle) -> Vec<String> {
    let Command::ReturnToMain { leg } = command else { return Vec::new() };
    let Some(context) = vehicle.aboard.as_ref().and_then(|aboard| aboard.plan.leg(leg)) else {
        return Vec::new();
    };
    let entered = context.loops.iter().copied().chain([context.leg]);
    let told = entered.filter_map(|leg| Some((leg, leg.as_loop()?))).map(|(leg, of)| {
        let count = match of.count {
            Some(Value::Constant(count)) => format!("1 of {count}"),
            _ => "from 1".to_owned(),
        };
        format!("{} begins its rounds anew: {count}", vehicle.name_of(&leg.id))
    });
    told.collect()
}
