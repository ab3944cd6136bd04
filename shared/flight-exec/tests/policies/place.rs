//! Where the flight is in the plan, and that it does not get lost.

use crate::policy::{Findings, Policy, policy};
use crate::trace::{Seen, Step, Trace, kind, same_passage};
use flight_exec::{Branching, Command, Event, Input, Phase, PlacePointer};
use flight_plan::{Id, LegKind};
use std::collections::{BTreeMap, BTreeSet};

pub const POLICIES: &[Policy] = &[
    policy("place-survives-hold", "A hold leaves the place as it is.", survives_hold),
    policy("place-survives-resume", "A resume goes on where the hold was given.", survives_resume),
    policy("place-survives-refusal", "A batch that is refused leaves the place as it is.", survives_refusal),
    policy(
        "place-survives-the-gateway",
        "Whether the gateway takes control or gives it back, the place stays.",
        survives_control,
    ),
    policy(
        "held-means-held",
        "After Hold no new leg is entered until Resume, a jump, or the gateway says so.",
        held_means_held,
    ),
    policy(
        "place-is-the-waypoint",
        "The place told is that of the waypoint steered to.",
        place_is_the_waypoint,
    ),
    policy(
        "entered-is-steered-to",
        "The leg entered last in a step is the one steered to.",
        entered_is_steered_to,
    ),
    policy(
        "entered-by-progress",
        "A leg is entered when the gateway says so, and at no other time.",
        entered_by_progress,
    ),
    policy("entered-once", "A passage is announced once.", entered_once),
    policy(
        "steered-to-is-announced",
        "What the gateway steers to has been announced.",
        steered_to_is_announced,
    ),
    policy("never-back", "The current token never goes back.", never_back),
    policy(
        "way-made-grows",
        "On the way to one waypoint, the way made on the leg grows as the aircraft comes nearer.",
        way_made,
    ),
    policy(
        "skip-leaves-the-leg",
        "A skip leaves the passage it was given on, but for a holding until released, which ends its lap.",
        skip_leaves,
    ),
    policy(
        "go-to-goes-there",
        "A go-to leads to the leg it names, in the plan being flown.",
        go_to_goes_there,
    ),
    policy(
        "progress-of-nobody-is-ignored",
        "Progress of a waypoint that is not ahead changes nothing.",
        strange_progress,
    ),
];

fn stays(step: Step, found: &mut Findings) {
    let (Some(before), Some(after)) = (step.before.place(), step.after.place()) else { return };
    found.expect(step, same_passage(before, after), || format!("{before:?} became {after:?}"));
}

fn survives_hold(trace: &Trace, found: &mut Findings) {
    trace.accepted().filter(|(_, c)| **c == Command::Hold).for_each(|(s, _)| stays(s, found));
}

fn survives_resume(trace: &Trace, found: &mut Findings) {
    trace.accepted().filter(|(_, c)| **c == Command::Resume).for_each(|(s, _)| stays(s, found));
}

fn survives_refusal(trace: &Trace, found: &mut Findings) {
    let refused = |s: &Step| matches!(s.input(), Some(Input::Rejected { .. }));
    for step in trace.steps().filter(refused) {
        if step.goes_back() {
            // to where it was before the commit
            let (before, after) = (trace.step(step.at - 1).before.place(), step.after.place());
            found.expect(step, before == after, || format!("{before:?} became {after:?}"));
        } else {
            stays(step, found);
        }
    }
}

fn survives_control(trace: &Trace, found: &mut Findings) {
    let control = |s: &Step| matches!(s.input(), Some(Input::GatewayControls(_)));
    trace.steps().filter(control).for_each(|s| stays(s, found));
}

fn held_means_held(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.before.status.phase == Phase::Holding) {
        if !matches!(step.input(), Some(Input::Progress { .. })) {
            found.expect(step, step.entered().next().is_none(), || "entered a leg".into());
        }
    }
}

fn place_is_the_waypoint(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.after.is_flying()) {
        let front = step.after.ahead.first();
        let status = &step.after.status;
        let same = status.current == front.map(|w| w.token)
            && status.outstanding == step.after.ahead.len()
            && status.place.as_ref().map(|p| &p.leg) == front.map(|w| &w.leg);
        found.expect(step, same, || format!("{status:?} at {front:?}"));
    }
}

/// What the plan writes at the end of the leg before may change the way at once.
fn entered_is_steered_to(trace: &Trace, found: &mut Findings) {
    let written = |s: &Step| s.events().any(|e| matches!(e, Event::VariableChanged { .. }));
    for step in trace.steps().filter(|s| !written(s)) {
        let told = matches!(step.input(), Some(Input::Progress { current: Some(_) }));
        if let (Some(last), true) = (step.entered().last(), told) {
            let there = step.after.place().is_some_and(|p| same_passage(p, last));
            found.expect(step, there, || format!("entered {last:?}, is at {:?}", step.after.place()));
        }
    }
}

fn entered_by_progress(trace: &Trace, found: &mut Findings) {
    for (step, place) in trace.entered() {
        let told = matches!(step.input(), Some(Input::Progress { .. }));
        found.expect(step, told, || format!("{place:?} by {:?}", step.moment.stimulus));
    }
}

/// Only a jump leads to the same passage again. An update may change what is around it; one may take a leg away whose first waypoints
/// are too near to be taken back, and the next one may bring it again.
fn entered_once(trace: &Trace, found: &mut Findings) {
    let mut last: Option<&PlacePointer> = None;
    let mut taken_away: BTreeSet<&Id> = BTreeSet::new();
    for step in trace.steps() {
        if step.is_jump() {
            last = None;
        }
        let program = step.after.program.as_deref();
        let is_gone = |leg: &&Id| program.is_some_and(|p| p.path(leg).is_none());
        taken_away.extend(step.after.ahead.iter().map(|w| &w.leg).filter(is_gone));
        for place in step.entered() {
            let again = |l: &PlacePointer| same_passage(l, place) && !taken_away.contains(&place.leg);
            let twice = last.is_some_and(again);
            found.expect(step, !twice, || format!("{place:?} twice"));
            last = Some(place);
        }
    }
}

fn steered_to_is_announced(trace: &Trace, found: &mut Findings) {
    let mut last: Option<&PlacePointer> = None;
    for step in trace.steps() {
        last = step.entered().last().or(last);
        let Some(Input::Progress { current: Some(token) }) = step.input() else { continue };
        if step.after.status.current == Some(*token)
            && let Some(place) = step.after.place().filter(|_| !updated_since_entry(step))
        {
            let told = last.is_some_and(|l| same_passage(l, place));
            found.expect(step, told, || format!("{place:?} after {last:?}"));
        }
    }
}

/// Legs may change around a passage when the plan does.
fn updated_since_entry(step: Step) -> bool {
    let back = step.trace.moments[..step.at].iter().rev();
    let mut since = back.take_while(|m| !m.outputs.iter().any(is_entry));
    since.any(|m| m.outputs.iter().any(is_activation))
}

fn is_entry(output: &flight_exec::Output) -> bool {
    matches!(output, flight_exec::Output::Event(flight_exec::Event::LegEntered { .. }))
}

fn is_activation(output: &flight_exec::Output) -> bool {
    matches!(output, flight_exec::Output::Event(flight_exec::Event::PlanActivated { .. }))
}

fn never_back(trace: &Trace, found: &mut Findings) {
    let mut last = None;
    for step in trace.steps() {
        if let Some(current) = step.after.status.current {
            found.expect(step, last.is_none_or(|l| current >= l), || format!("{current:?} after {last:?}"));
            last = Some(current);
        }
    }
}

fn way_made(trace: &Trace, found: &mut Findings) {
    let to_front = |seen: &Seen| {
        let front = seen.ahead.first()?;
        Some((front.token, seen.aircraft?.position.distance_m(front.position), seen.place()?.distance_m))
    };
    for step in trace.steps() {
        if let Some(place) = step.after.place() {
            let sound = place.distance_m.is_finite() && place.distance_m >= 0.0;
            found.expect(step, sound, || format!("{} m", place.distance_m));
        }
        let (Some(a), Some(b)) = (to_front(step.before), to_front(step.after)) else { continue };
        if a.0 == b.0 && b.1 < a.1 && matches!(step.input(), Some(Input::Aircraft(_))) {
            // a local frame and the geodesic differ by millimetres
            found.expect(step, b.2 >= a.2 - 0.1, || format!("{} m, then {} m", a.2, b.2));
        }
    }
}

fn skip_leaves(trace: &Trace, found: &mut Findings) {
    for (step, _) in trace.accepted().filter(|(_, c)| **c == Command::SkipLeg) {
        let (Some(before), Some(after)) = (step.before.place(), step.after.place()) else { continue };
        let held = step.before.program.as_deref().and_then(|p| kind(p, &before.leg));
        if !matches!(held, Some(LegKind::Hm { .. })) {
            found.expect(step, !same_passage(before, after), || format!("still {after:?}"));
        }
    }
}

/// A leg that flies nothing (an IF where the path is, an intersection, one that can't be flown) leads on: then the first leg
/// flown reports.
fn go_to_goes_there(trace: &Trace, found: &mut Findings) {
    for (step, command) in trace.accepted() {
        let Command::GoTo { leg } = command else { continue };
        let (Some(program), Some(place)) = (&step.after.program, step.after.place()) else { continue };
        let same_plan = step.before.place().is_none_or(|p| p.plan == place.plan);
        let inside = place.iterations.iter().any(|i| i.leg == *leg) || place.stage == *leg;
        let flies_nothing = program
            .leg(leg)
            .is_some_and(|l| crate::model::may_fly_nothing(l) || l.kind_name() == "intersection");
        let told = trace.events().take_while(|(s, _)| s.at <= step.at);
        let refused = |e: &Event| matches!(e, Event::PatternRefused { leg: of, .. } if of == leg);
        let impossible = told.into_iter().any(|(_, e)| refused(e));
        let there = place.leg == *leg || inside || flies_nothing || impossible;
        found.expect(step, same_plan && there, || format!("{leg} led to {place:?}"));
    }
}

fn strange_progress(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let Some(Input::Progress { current: Some(token) }) = step.input() else { continue };
        if !step.before.tokens().contains(token) {
            // where nothing is ahead the time that has passed may bring something
            let same =
                step.before.status.current == step.after.status.current || step.before.ahead.is_empty();
            let same = same && step.entered().next().is_none();
            found.expect(step, same, || format!("{token:?} of nobody"));
        }
    }
}

/// The places of a plan part, for other policies: which emergency plan, if one is flown.
pub fn emergency_flown(seen: &Seen) -> Option<&flight_plan::Id> {
    match &seen.place()?.plan {
        Branching::Emergency(id) => Some(id),
        Branching::Main => None,
    }
}

/// Iterations around the place by loop.
pub fn iterations(place: &PlacePointer) -> BTreeMap<&flight_plan::Id, (u64, bool)> {
    place.iterations.iter().map(|i| (&i.leg, (i.iteration, i.reverse))).collect()
}
