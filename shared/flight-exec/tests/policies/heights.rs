//! How high and how fast: as each leg says, whichever way it is flown, and with the values of now.

use crate::actions::updated_since_jump;
use crate::policy::{Findings, Policy, policy};
use crate::trace::{Seen, Step, Trace, apart_m, same_passage};
use aircraft::Profile;
use flight_exec::{Action, Command, Config, Event, Input, PlacePointer, Waypoint};
use flight_plan::{Altitude, Id, IterativeForm, Leg, LegKind, Program, Value, VariableValue};
use std::collections::BTreeSet;

pub const POLICIES: &[Policy] = &[
    policy(
        "own-height-and-speed",
        "A pattern or a holding is flown at its own speed and altitude, backwards as well, but for the way to where it began.",
        own,
    ),
    policy(
        "height-and-speed-of-now",
        "Beyond the stopping distance everything ahead has the speed and altitude that the variables give it now.",
        of_now,
    ),
];

/// What the plans call a speed or an altitude of `n`: see `writing`.
const SPEED_OF_N: (f64, f64) = (18.0, 2.0);
const ALTITUDE_OF_N: (f64, f64) = (480.0, 20.0);
/// A climb is spread over the waypoints: so much beyond what can be climbed on the way, metres.
const LEAD_M: f64 = 8.0;
/// What differs by less was not sent again, metres, and what that makes of a climb.
const SENT_M: f64 = 1.0;

fn value(value: &Value<f64>, (least, by_n): (f64, f64), n: f64) -> f64 {
    match value {
        Value::Constant(constant) => *constant,
        Value::Expression(_) => least + by_n * n,
    }
}

fn speed(leg: &Leg, n: f64) -> Option<f64> {
    Some(value(leg.speed_mps.as_ref()?, SPEED_OF_N, n))
}

fn altitude_m(leg: &Leg, n: f64) -> Option<f64> {
    let altitude: &Altitude = leg.altitude.as_ref()?;
    // until it is reached, that of a climb is its end
    let climbs = matches!(leg.kind, LegKind::Ha(_) | LegKind::Fa { .. });
    (!climbs).then(|| value(&altitude.metres, ALTITUDE_OF_N, n))
}

/// What is on the way from one waypoint to another is as the leg says; the altitude as far as it can be climbed.
fn is_as_said(leg: &Leg, n: f64, from: &Waypoint, to: &Waypoint) -> bool {
    let profile = Profile::default();
    let time_s = apart_m(from.position, to.position) / to.airspeed_mps.max(1.0);
    let (up_m, down_m) = (profile.max_climb_mps * time_s, profile.max_descent_mps * time_s);
    let reached_m = |m: f64, lead_m: f64| {
        m.max(from.altitude_amsl_m - down_m - lead_m).min(from.altitude_amsl_m + up_m + lead_m)
    };
    // the waypoint before may have been ahead of the aircraft as well
    let off_m = altitude_m(leg, n).map_or(0.0, |m| {
        let (a, b) = (reached_m(m, 0.0), reached_m(m, LEAD_M));
        (a.min(b) - to.altitude_amsl_m).max(to.altitude_amsl_m - a.max(b)).max(0.0)
    });
    has_speed(leg, n, to) && off_m < SENT_M
}

fn has_speed(leg: &Leg, n: f64, waypoint: &Waypoint) -> bool {
    speed(leg, n).is_none_or(|mps| (waypoint.airspeed_mps - mps).abs() < 0.05)
}

/// A passage: where, and each waypoint steered to with its step.
type Passage<'a> = (&'a PlacePointer, Vec<(Step<'a>, &'a Waypoint)>);

fn passages(trace: &Trace) -> Vec<Passage<'_>> {
    let mut passages: Vec<Passage> = Vec::new();
    let (mut broken, mut resumed_at) = (true, None);
    for step in trace.steps() {
        broken |= step.is_jump();
        let (Some(place), Some(front)) = (step.after.place(), step.after.ahead.first()) else { continue };
        if step.accepted() == Some(&Command::Resume) {
            (broken, resumed_at) = (true, Some(front.token));
        }
        if matches!(step.input(), Some(Input::GatewayControls(_)))
            && step.before.ahead.first().is_some_and(|w| resumed_at == Some(w.token))
        {
            // sent once more, with another number
            resumed_at = Some(front.token);
        }
        // that may be where the hold was given, as high as the one behind it
        if resumed_at == Some(front.token) {
            continue;
        }
        let current = step.after.status.current;
        match passages.last_mut().filter(|(of, _)| !broken && same_passage(of, place)) {
            // the same one, or sent once more with another number
            Some((_, flown))
                if flown
                    .last()
                    .is_some_and(|(_, w)| Some(w.token) == current || w.position == front.position) => {}
            Some((_, flown)) => flown.push((step, front)),
            None => passages.push((place, vec![(step, front)])),
        }
        broken = false;
    }
    passages
}

fn own(trace: &Trace, found: &mut Findings) {
    for (place, flown) in passages(trace) {
        let program = flown.first().and_then(|(step, _)| step.after.program.as_deref());
        let Some(leg) = program.and_then(|p| p.leg(&place.leg)).filter(|leg| is_constant(leg)) else {
            continue;
        };
        let pattern = matches!(leg.kind, LegKind::Scan(_) | LegKind::Orbit { .. } | LegKind::Pattern(_));
        let holding = matches!(leg.kind, LegKind::Hf(_) | LegKind::Ha(_) | LegKind::Hm { .. });
        let flies = flown.iter().filter(|(_, w)| w.action == Action::Fly).collect::<Vec<_>>();
        let own = flies.len().saturating_sub(usize::from(pattern && place.reverse));
        for pair in flies[..own].windows(2).filter(|_| pattern || holding) {
            let [(_, from), (step, to)] = pair else { continue };
            if follows(*step, from, to) && !updated_since_jump(*step) {
                // back it goes as it went out, whatever a plan since then makes of the leg
                let is_right = is_as_said(leg, 0.0, from, to) || place.reverse && was_another(*step, &leg.id);
                found.expect(*step, is_right, || {
                    format!("{} {}: {from:?} to {to:?}", leg.id, if place.reverse { "back" } else { "" })
                });
            }
        }
    }
}

/// An update before this step made another leg of this one.
fn was_another(step: Step, leg: &Id) -> bool {
    let earlier = (0..step.at).map(|at| step.trace.step(at));
    earlier.filter_map(|s| s.update()).any(|(old, new)| old.leg(leg) != new.leg(leg))
}

/// The way led from one to the other, nothing between them.
fn follows(step: Step, from: &Waypoint, to: &Waypoint) -> bool {
    let tokens: Vec<_> = step.before.ahead.iter().take(2).map(|w| w.token).collect();
    tokens == [from.token, to.token]
}

/// It has a speed of its own, and neither speed nor altitude by an expression.
fn is_constant(leg: &Leg) -> bool {
    let constant = |value: &Value<f64>| matches!(value, Value::Constant(_));
    leg.speed_mps.as_ref().is_some_and(constant) && leg.altitude.as_ref().is_none_or(|a| constant(&a.metres))
}

/// Always flown forwards, and by variables.
fn follows_n<'p>(program: &'p Program, id: &Id) -> Option<&'p Leg> {
    let path = program.path(id)?;
    let back = |leg: &&Leg| leg.as_loop().is_some_and(|l| l.form == IterativeForm::Reverse);
    let leg = program.leg(id).filter(|leg| matches!(leg.speed_mps, Some(Value::Expression(_))))?;
    program.chain(&path).iter().all(|leg| !back(leg)).then_some(leg)
}

fn of_now(trace: &Trace, found: &mut Findings) {
    let (mut clock_s, mut written_s) = (0.0_f64, f64::NEG_INFINITY);
    let mut refused = BTreeSet::new();
    let mut sent_again = BTreeSet::new();
    for step in trace.steps() {
        clock_s = clock_s.max(step.moment.now.as_secs_f64());
        let resent = matches!(step.input(), Some(Input::GatewayControls(_)))
            && step.before.ahead.iter().any(|w| sent_again.contains(&w.token));
        if resent || step.accepted() == Some(&Command::Resume) {
            // what was too near to be altered when the hold was given is flown yet, from wherever the aircraft is now
            sent_again = step.after.ahead.iter().map(|w| w.token).collect();
        }
        for event in step.events() {
            match event {
                Event::VariableChanged { .. } => written_s = clock_s,
                Event::PatternRefused { leg, .. } => drop(refused.insert(leg)),
                _ => {}
            }
        }
        let refreshed = clock_s > written_s + Config::default().debounce_s + 0.001;
        if refreshed && step.after.is_flying() {
            ahead_is_of_now(
                step,
                step.after,
                |w| refused.contains(&w.leg) || sent_again.contains(&w.token),
                found,
            );
        }
    }
}

fn ahead_is_of_now(step: Step, seen: &Seen, is_excused: impl Fn(&Waypoint) -> bool, found: &mut Findings) {
    let Some(program) = seen.program.as_deref() else { return };
    let Some(VariableValue::Number(n)) = seen.variables.get(&"n".into()) else { return };
    let (speed_mps, profile) = (crate::flight::SPEED_MPS, Profile::default());
    let stop_m = profile.turn_radius_m(speed_mps) + Config::default().latency_s * speed_mps + 1.0;
    let mut way_m = 0.0;
    for (index, pair) in seen.ahead.windows(2).enumerate() {
        let [from, to] = pair else { continue };
        way_m += apart_m(from.position, to.position);
        // before the first one there may be where a hold was given
        let free = index > 0 && way_m > stop_m && to.action == Action::Fly && !is_excused(to);
        if let Some(leg) = follows_n(program, &to.leg).filter(|_| free) {
            found.expect(step, is_as_said(leg, *n, from, to), || format!("n is {n}: {from:?} to {to:?}"));
        }
    }
}
