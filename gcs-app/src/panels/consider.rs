//! A command that leads elsewhere is looked at before it is given: what would follow, on the map and in words, then the
//! command, named by its effect.

use super::{Scene, answer, field};
use crate::command::{FlyCommand, Queue};
use crate::state::{Considered, Vehicle};
use crate::theme;
use crate::units;
use egui::{Panel, RichText, ScrollArea, Ui};
use flight_exec::{Command, Foresight};
use flight_plan::Id;
use usal::contract::GatewayState;

/// Screen points.
const WIDTH: f32 = 260.0;
/// Nearer to the ground is a caution, metres.
const LOW_M: f64 = 30.0;
/// What was told so long ago, by the aircraft's clock, is of another place, seconds.
const OLD_S: f64 = 20.0;
/// So many legs are named.
const MOST_LEGS: usize = 12;

/// Draws what would follow the command that is considered; false: none is.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) -> bool {
    let Some(considered) = scene.vehicle.outlook.considered() else { return false };
    Panel::right("consider")
        .exact_size(WIDTH)
        .resizable(false)
        .frame(theme::panel(ui).inner_margin(12.0))
        .show(ui, |ui| body(ui, scene, considered, queue));
    true
}

fn body(ui: &mut Ui, scene: &Scene<'_>, considered: &Considered, queue: &mut Queue) {
    let p = theme::of(ui);
    ui.label(RichText::new(format!("{}?", effect(considered, scene.vehicle))).strong().size(16.0));
    let gone_on =
        considered.command == Command::SkipLeg && considered.has_gone_on(scene.vehicle.current_leg());
    if gone_on {
        let text = "⚠ The aircraft is on another leg by now: look again.";
        ui.label(RichText::new(text).color(p.caution));
    }
    // the decision first: it is never scrolled away
    ui.horizontal_wrapped(|ui| {
        // who is in a hurry holds the button, whatever is known by then
        ui.add_enabled_ui(!gone_on, |ui| give(ui, scene, considered, queue));
        if ui.button("Look again").clicked() {
            queue.fly(FlyCommand::Consider(considered.command.clone()));
        }
        if ui.button("Cancel").clicked() {
            queue.fly(FlyCommand::PutAside);
        }
    });
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

/// The command itself: a way with problems, or one that is not known, has to be held.
fn give(ui: &mut Ui, scene: &Scene<'_>, considered: &Considered, queue: &mut Queue) {
    let p = theme::of(ui);
    let text = effect(considered, scene.vehicle);
    let is_as_told = since(considered, scene).is_empty();
    let is_clean = matches!(&considered.foresight, Some(Ok(foresight)) if is_as_told && cautions(considered, foresight, scene).is_empty());
    let given = if is_clean {
        field::is_pressed(&ui.add(super::primary_button(&text, p)))
    } else {
        field::hold_button(ui, &text, p.caution, 0.0)
    };
    if given {
        queue.plan(considered.command.clone());
    }
}

/// What has become of the aircraft since what follows was told, or is about to: who reads it decides about another flight.
fn since(considered: &Considered, scene: &Scene<'_>) -> Vec<String> {
    let vehicle = scene.vehicle;
    let age_s = considered.age_s(scene.now_s, vehicle.clock_s(scene.now_s));
    let old = age_s.filter(|age_s| *age_s > OLD_S);
    let old = old.map(|age_s| format!("Looked at {} ago: look again", units::duration(age_s)));
    // another leg is not skipped at all: that is said above the button
    let is_elsewhere =
        considered.command != Command::SkipLeg && considered.has_gone_on(vehicle.current_leg());
    let elsewhere = is_elsewhere.then(|| "The aircraft is on another leg by now: look again".to_owned());
    let state = vehicle.gateway.as_ref().map(|gateway| gateway.value.state);
    let landing = (state == Some(GatewayState::Land)).then(|| {
        let agl =
            vehicle.watch.agl_m.map(|m| format!(", {} above the ground", scene.units().altitude().show(m)));
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
    ui.label(RichText::new("╌╌ on the map: the path that would be flown").color(p.text));
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
    let low = height.filter(|height| height.least_m < LOW_M).map(|height| {
        let least = units.altitude().show(height.least_m);
        format!("Only {least} above the ground where it is lowest{}", height.by())
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
    let named = foresight.left_out.iter().take(MOST_LEGS).map(|leg| vehicle.name_of(leg));
    let named: Vec<String> = named.collect();
    let left_out = match foresight.left_out.len().checked_sub(named.len()) {
        _ if named.is_empty() => "Left out: nothing".to_owned(),
        Some(more) if more > 0 => format!("Left out: {} and {more} more", named.join(", ")),
        _ => format!("Left out: {}", named.join(", ")),
    };
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
    next.into_iter().chain([left_out]).chain(clearance).chain([end]).collect()
}
