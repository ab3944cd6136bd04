//! What is issued to the gateway: numbers, transactions, contents.

use crate::policy::{Findings, Policy, policy};
use crate::trace::{Seen, Step, Trace, apart_m, knows};
use aircraft::Profile;
use flight_exec::{Action, Command, Config, Event, Input, Phase, Token, Waypoint};
use std::collections::{BTreeMap, BTreeSet};

pub const POLICIES: &[Policy] = &[
    policy("tokens-grow", "A token is greater than every one fed before it.", tokens_grow),
    policy("batches-count-by-one", "Within a batch tokens count up by one.", batches_count_by_one),
    policy("no-empty-feed", "A feed cancels something or appends something.", no_empty_feed),
    policy("cancels-what-was-fed", "cancel_after never names a token never fed.", cancels_what_was_fed),
    policy("cancelled-stays-cancelled", "What was cancelled is never believed ahead again.", cancelled_stays),
    policy(
        "ahead-is-the-buffer",
        "While flying, executor and gateway have the same waypoints ahead.",
        ahead_is_the_buffer,
    ),
    policy(
        "a-waypoint-never-changes",
        "A token means the same waypoint for ever, within half a metre; the mark of the end goes when more is fed behind it, and never comes.",
        never_changes,
    ),
    policy(
        "one-cancellation-an-input",
        "A command is answered by one cancelling transaction at most, before anything is appended.",
        one_cancellation,
    ),
    policy("finite-and-on-earth", "Every waypoint has finite numbers and lies on Earth.", finite),
    policy("within-the-envelope", "Every airspeed is one the aircraft can fly.", within_the_envelope),
    policy(
        "climbs-can-be-flown",
        "From one waypoint of a leg to the next altitude changes by no more than climb or descent make, and ten metres.",
        climbs,
    ),
    policy("legs-of-the-plan", "Every waypoint belongs to a leg of the active plan.", legs_of_the_plan),
    policy(
        "take-off-first",
        "A take-off is the first waypoint after a start and nowhere else.",
        take_off_first,
    ),
    policy("landing-last", "A landing ends its plan.", landing_last),
    policy(
        "muted-while-the-gateway-controls",
        "Nothing is fed while the gateway controls the flight.",
        muted,
    ),
    policy("muted-while-holding", "Nothing is fed while holding.", muted_while_holding),
    policy(
        "fed-again-after-control",
        "When the gateway gives control back, everything ahead is fed again with new tokens.",
        fed_again,
    ),
    policy(
        "fed-again-after-hold",
        "A resume feeds everything ahead again in one transaction.",
        fed_after_hold,
    ),
    policy("nothing-near-is-altered", "Nothing nearer than the stopping distance is altered.", nothing_near),
    policy("idle-is-silent", "Without a flight nothing is fed.", idle_is_silent),
];

fn each(trace: &Trace, found: &mut Findings, holds: impl Fn(&Waypoint) -> bool) {
    for (step, _, waypoints) in trace.feeds() {
        for waypoint in waypoints {
            found.expect(step, holds(waypoint), || format!("{waypoint:?}"));
        }
    }
}

fn tokens_grow(trace: &Trace, found: &mut Findings) {
    let mut highest = Token(0);
    for (step, _, waypoints) in trace.feeds() {
        for waypoint in waypoints {
            found
                .expect(step, waypoint.token > highest, || format!("{:?} after {highest:?}", waypoint.token));
            highest = highest.max(waypoint.token);
        }
    }
}

fn batches_count_by_one(trace: &Trace, found: &mut Findings) {
    for (step, _, waypoints) in trace.feeds() {
        for pair in waypoints.windows(2) {
            let (a, b) = (pair[0].token.0, pair[1].token.0);
            found.expect(step, b == a + 1, || format!("{b} after {a}"));
        }
    }
}

fn no_empty_feed(trace: &Trace, found: &mut Findings) {
    for (step, cancel, waypoints) in trace.feeds() {
        found.expect(step, cancel.is_some() || !waypoints.is_empty(), || "an empty feed".into());
    }
}

fn cancels_what_was_fed(trace: &Trace, found: &mut Findings) {
    let mut fed = BTreeSet::from([Token(0)]);
    for (step, cancel, waypoints) in trace.feeds() {
        if let Some(last) = cancel.filter(|last| *last != Token(0)) {
            found.expect(step, fed.contains(&last), || format!("cancels after {last:?}, never fed"));
        }
        fed.extend(waypoints.iter().map(|w| w.token));
    }
}

fn cancelled_stays(trace: &Trace, found: &mut Findings) {
    let mut live = BTreeSet::new();
    let mut cancelled = BTreeSet::new();
    for step in trace.steps() {
        for (cancel, waypoints) in step.feeds() {
            if let Some(last) = cancel {
                cancelled.extend(live.split_off(&Token(last.0.saturating_add(1))));
            }
            live.extend(waypoints.iter().map(|w| w.token));
        }
        if step.after.is_fed() && !cancelled.is_empty() {
            let back = step.after.tokens().into_iter().find(|t| cancelled.contains(t));
            found.expect(step, back.is_none(), || format!("{back:?} was cancelled"));
        }
    }
}

/// Where a batch was just refused the two differ, until the executor has received that and holds.
fn ahead_is_the_buffer(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.after.is_fed()) {
        let next = trace.moments.get(step.at + 1).map(|m| &m.stimulus);
        let rejected = matches!(next, Some(crate::trace::Stimulus::Input(Input::Rejected { .. })));
        if !rejected {
            let buffer: Vec<_> = step.after.buffer.iter().map(|w| w.token).collect();
            let ahead = step.after.tokens();
            // what was reported late is still ahead for the executor
            let same = ahead.ends_with(&buffer);
            found.expect(step, same, || format!("executor {ahead:?}, gateway {buffer:?}"));
        }
    }
}

/// So near to each other that an autopilot sees no difference, two waypoints laid out anew share their number.
fn never_changes(trace: &Trace, found: &mut Findings) {
    let mut known: BTreeMap<Token, &Waypoint> = BTreeMap::new();
    for step in trace.steps() {
        known.extend(step.feeds().flat_map(|(_, waypoints)| waypoints).map(|w| (w.token, w)));
        for (i, waypoint) in step.after.ahead.iter().enumerate().filter(|_| step.after.is_fed()) {
            let sent = known.get(&waypoint.token);
            let followed = i + 1 < step.after.ahead.len();
            let marked = |w: &Waypoint| w.end_of_plan == waypoint.end_of_plan || (w.end_of_plan && followed);
            found.expect(step, sent.is_some_and(|w| is_the_same(w, waypoint) && marked(w)), || {
                format!("{sent:?} is now {waypoint:?}")
            });
        }
    }
}

/// The same but for the mark of the end, which only the last waypoint has: what is fed behind it takes it away.
fn is_the_same(a: &Waypoint, b: &Waypoint) -> bool {
    let near = (a.position == b.position || a.position.distance_m(b.position) < 0.5)
        && (a.altitude_amsl_m - b.altitude_amsl_m).abs() < 0.5
        && (a.airspeed_mps - b.airspeed_mps).abs() < 0.05;
    near && (&a.leg, a.action, a.fly_over) == (&b.leg, b.action, b.fly_over)
}

fn one_cancellation(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.command().is_some() && s.feeds().next().is_some()) {
        // an action that is due as well may write a variable
        if step.events().any(|e| matches!(e, Event::VariableChanged { by, .. } if **by == *"plan")) {
            continue;
        }
        let later = step.feeds().skip(1).any(|(cancel, _)| cancel.is_some());
        found.expect(step, !later, || "cancels twice, or after appending".into());
    }
}

fn finite(trace: &Trace, found: &mut Findings) {
    each(trace, found, |w| {
        w.position.is_valid() && w.altitude_amsl_m.is_finite() && w.airspeed_mps.is_finite()
    });
}

fn within_the_envelope(trace: &Trace, found: &mut Findings) {
    let profile = Profile::default();
    let envelope = profile.min_airspeed_mps..=profile.max_airspeed_mps;
    each(trace, found, |w| envelope.contains(&w.airspeed_mps));
}

/// The gateway's own limit of plausibility: what the profile climbs on the way, and ten metres.
fn climbs(trace: &Trace, found: &mut Findings) {
    let profile = Profile::default();
    for (step, _, waypoints) in trace.feeds() {
        for pair in waypoints.windows(2).filter(|p| p[0].leg == p[1].leg) {
            let seconds = apart_m(pair[0].position, pair[1].position) / pair[1].airspeed_mps;
            let change_m = pair[1].altitude_amsl_m - pair[0].altitude_amsl_m;
            let allowed = -profile.max_descent_mps * seconds - 10.0..=profile.max_climb_mps * seconds + 10.0;
            let flown = pair.iter().all(|w| w.action == Action::Fly);
            found.expect(step, !flown || allowed.contains(&change_m), || {
                format!("{change_m:.0} m in {seconds:.0} s from {:?} to {:?}", pair[0], pair[1])
            });
        }
    }
}

fn legs_of_the_plan(trace: &Trace, found: &mut Findings) {
    for (step, _, waypoints) in trace.feeds() {
        // what is near when the plan changes stays as it was
        let kept: BTreeSet<_> = step.before.ahead.iter().map(|w| &w.leg).collect();
        let Some(program) = &step.after.program else { continue };
        for waypoint in waypoints {
            let known = knows(program, &waypoint.leg) || kept.contains(&waypoint.leg);
            found.expect(step, known, || format!("no leg {}", waypoint.leg));
        }
    }
}

fn take_off_first(trace: &Trace, found: &mut Findings) {
    let is_take_off = |w: &&Waypoint| matches!(w.action, Action::TakeOff { .. });
    for (step, cancel, waypoints) in trace.feeds() {
        for taking_off in waypoints.iter().filter(is_take_off) {
            let first =
                cancel == Some(Token(0)) && waypoints.first().is_some_and(|w| w.token == taking_off.token);
            found.expect(step, first, || format!("{:?} is not the first", taking_off.token));
        }
        if let (Some(Command::Start), Some(first)) = (step.accepted(), waypoints.first()) {
            found.expect(step, is_take_off(&first), || "begins without a take-off".into());
        }
    }
}

fn landing_last(trace: &Trace, found: &mut Findings) {
    for (step, _, waypoints) in trace.feeds() {
        for landing in waypoints.iter().filter(|w| matches!(w.action, Action::Land { .. })) {
            found.expect(step, landing.end_of_plan, || format!("{:?} ends nothing", landing.token));
        }
    }
}

fn muted(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.after.gateway_controls) {
        found.expect(step, step.feeds().next().is_none(), || "fed".into());
    }
}

fn muted_while_holding(trace: &Trace, found: &mut Findings) {
    let holds = |seen: &Seen| seen.status.phase == Phase::Holding;
    for step in trace.steps().filter(|s| holds(s.before) && holds(s.after)) {
        found.expect(step, step.feeds().next().is_none(), || "fed".into());
    }
}

fn fed_again(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| matches!(s.input(), Some(Input::GatewayControls(false)))) {
        if step.before.gateway_controls && step.after.is_fed() {
            all_anew(step, found);
        }
    }
}

fn fed_after_hold(trace: &Trace, found: &mut Findings) {
    for (step, command) in trace.accepted() {
        if *command == Command::Resume && step.after.is_fed() {
            all_anew(step, found);
        }
    }
}

fn all_anew(step: Step, found: &mut Findings) {
    let highest = step.before.tokens().into_iter().max().unwrap_or_default();
    let new = step.after.tokens().into_iter().all(|t| t > highest);
    let whole = step.feeds().next().is_some_and(|(cancel, w)| cancel == Some(Token(0)) && !w.is_empty());
    found.expect(step, new && whole, || "not everything was fed again".into());
}

/// Changes that keep the way: everything but jumps, and a changed choice at the fork itself.
fn nothing_near(trace: &Trace, found: &mut Findings) {
    let profile = Profile::default();
    for step in trace.steps().filter(|s| s.before.is_fed() && s.after.is_fed() && keeps_the_way(s)) {
        let (Some(aircraft), Some(front)) = (step.after.aircraft, step.before.ahead.first()) else {
            continue;
        };
        let speed_mps = aircraft.ground_speed_mps.max(profile.min_airspeed_mps);
        let stop_m = profile.turn_radius_m(speed_mps) + Config::default().latency_s * speed_mps;
        let mut way_m = apart_m(aircraft.position, front.position);
        let mut before = front;
        for near in step.before.ahead.iter().take_while(|w| !matches!(w.action, Action::Loiter { .. })) {
            way_m += apart_m(before.position, near.position);
            // distances in a local frame differ from geodesics by millimetres
            if way_m > stop_m - 0.1 {
                break;
            }
            before = near;
            let kept = step.after.ahead.iter().any(|w| w.token == near.token && is_the_same(w, near));
            found.expect(step, kept, || format!("{:?} at {way_m:.0} m was altered", near.token));
        }
    }
}

fn keeps_the_way(step: &Step) -> bool {
    let enters = |c: &Command| matches!(c, Command::Commit { entry: Some(_), .. });
    let commits = |c: &Command| matches!(c, Command::Commit { .. });
    let alters = step.accepted().is_some_and(|c| (!step.is_jump() || commits(c)) && !enters(c));
    alters && !matches!(step.accepted(), Some(Command::Resume))
        || matches!(step.input(), Some(Input::Tick | Input::Aircraft(_)))
}

fn idle_is_silent(trace: &Trace, found: &mut Findings) {
    let rests = |seen: &Seen| !seen.is_flying();
    for step in trace.steps().filter(|s| rests(s.before) && rests(s.after)) {
        found.expect(step, step.feeds().next().is_none(), || "fed".into());
    }
}
