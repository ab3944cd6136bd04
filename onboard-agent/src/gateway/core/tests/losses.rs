//! What comes of each loss in each state: played through, and written into `gateway-states.md` for people.

use super::*;
use crate::gateway::order::Serial;
use crate::gateway::tests::flights::{landing, runway_at, take_off, zigzag};
use std::collections::BTreeSet;
use usal::contract::{Engine, Power};

/// How long a loss is looked at: longer than any alarm waits and than T1, shorter than T2, seconds.
const LASTS_S: u64 = 13;

/// What is lost.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Loss {
    Nothing,
    FpManager,
    Autopilot,
    Gps,
    Energy,
    Engine,
    Command,
}

const LOSSES: [(Loss, &str); 6] = [
    (Loss::FpManager, "FP Manager silent"),
    (Loss::Autopilot, "autopilot not heard"),
    (Loss::Gps, "no GPS fix"),
    (Loss::Energy, "little energy"),
    (Loss::Engine, "engine stands"),
    (Loss::Command, "pilot takes it"),
];

/// Each state, what is wanted in it, and the waypoint of the plan that is steered to there.
const PLAYED: [(GatewayState, Intent, u64); 13] = [
    (GatewayState::Stop, Intent::Nothing, 1),
    (GatewayState::TakeOff, Intent::Fly, 1),
    (GatewayState::Nav, Intent::Fly, 2),
    (GatewayState::Hold, Intent::Hold, 2),
    (GatewayState::Directed, Intent::Direct, 2),
    (GatewayState::Manual, Intent::Nothing, 2),
    (GatewayState::Approach, Intent::Fly, 6),
    (GatewayState::Land, Intent::Fly, 7),
    (GatewayState::SafeHold, Intent::Hold, 2),
    (GatewayState::SafeReturn, Intent::Fly, 2),
    (GatewayState::SafeApproach, Intent::Fly, 6),
    (GatewayState::SafeLand, Intent::Fly, 7),
    (GatewayState::Terminate, Intent::Nothing, 2),
];

/// A gateway in a state, with the whole plan aboard.
fn in_state(state: GatewayState, intent: Intent, steers_to: u64) -> Core {
    let mut core = Core::new();
    core.step(Input::Report(Report::Capability(Ok(PLANE))));
    core.run(1, &reports(GatewayState::Stop, Mode::Hold, Loss::Nothing));
    let join = Join { plan: Some("plan".into()), earlier: vec![], last_token: Token(0) };
    core.step(Input::Join(1, join, fp_manager()));
    let runways = vec![runway_at(LatLon::new(36.3190, -84.1730))];
    core.step(Input::Request(2, GatewayRequest::SetRunways { runways }));
    let plan = std::iter::once(take_off()).chain(zigzag(0, 3, 300.0)).chain(landing());
    let waypoints = (1..).zip(plan).map(|(token, waypoint)| Waypoint { token: Token(token), ..waypoint });
    let fed = Feed { cancel_after: None, waypoints: waypoints.collect() };
    assert_eq!(core.answer(Input::Feed(3, fed, fp_manager())), Answer::Feed(FeedAnswer::Accepted));
    let target = Target::Waypoint(Serial(steers_to));
    core.step(Input::Report(Report::Course(Course { aboard: true, ready: true, target })));
    // what still stood would have landed
    core.run(1, &reports(state, mode_in(state), Loss::Nothing));
    core.gateway.state = state;
    core.gateway.control.set_intent(intent, core.gateway.telemetry.mode);
    core.gateway.control.safe_since = Some(core.now);
    core.gateway.control.way_home_glides = Some(false);
    core.run(1, &reports(state, mode_in(state), Loss::Nothing));
    assert_eq!(core.gateway.state(), state);
    core.done();
    core
}

/// The mode that the autopilot is in there.
fn mode_in(state: GatewayState) -> Mode {
    use GatewayState::{Directed, Hold, Manual, SafeHold, Stop, Terminate};
    match state {
        Stop | Hold | SafeHold => Mode::Hold,
        Directed => Mode::Direct,
        Manual | Terminate => Mode::Other(5),
        _ => Mode::Waypoints,
    }
}

/// The mode that it was ordered to last, which it obeys.
fn obeyed(core: &Core) -> Option<Mode> {
    let steered = |(_, order)| if let Order::Steer(aim) = order { Some(aim.mode()) } else { None };
    core.orders().into_iter().filter_map(steered).next_back()
}

/// What the autopilot says of itself there.
fn reports(state: GatewayState, mode: Mode, loss: Loss) -> Vec<Report> {
    use GatewayState::{Stop, Terminate};
    let stands = state == Stop;
    let rpm = if loss == Loss::Engine || stands || state == Terminate { 0.0 } else { 5000.0 };
    let throttle = if stands { 0.0 } else { 0.6 };
    let battery = if loss == Loss::Energy { 0.1 } else { 0.9 };
    let gps = Gps { fix_3d: loss != Loss::Gps, satellites: Some(12), hdop: 0.8, unix_s: None };
    vec![
        beat(mode, !stands && state != Terminate),
        Report::OnGround(stands),
        high(if stands { 0.0 } else { 25.0 }),
        Report::Gps(gps),
        Report::Power(Power { voltage_v: 24.0, current_a: 10.0, battery, fuel: None }),
        Report::Engine(Engine { rpm, temperature_c: 80.0, throttle }),
    ]
}

/// So high that a runway is in reach of a glide.
fn high(north_mps: f64) -> Report {
    let Report::Fix(fix) = fix(north_mps) else { unreachable!() };
    Report::Fix(Fix { altitude_amsl_m: 650.0, altitude_home_m: 300.0, ..fix })
}

/// The states that follow, and the alarms that are raised.
fn played(
    (state, intent, steers_to): (GatewayState, Intent, u64),
    loss: Loss,
) -> (Vec<String>, BTreeSet<String>) {
    let mut core = in_state(state, intent, steers_to);
    for _ in 0..10 * LASTS_S {
        core.now += Duration::from_millis(100);
        if loss != Loss::FpManager {
            core.beats += 1;
            let (count, plan, from) = (core.beats, Some("plan".into()), fp_manager());
            core.step(Input::Heartbeat { count, plan, from });
        }
        if loss != Loss::Autopilot {
            let by_pilot = (loss == Loss::Command).then_some(Mode::Other(7));
            let mode = by_pilot.or(obeyed(&core)).unwrap_or(mode_in(state));
            reports(state, mode, loss).into_iter().for_each(|report| core.step(Input::Report(report)));
        }
        core.step(Input::Tick);
    }
    let (mut states, mut alarms) = (vec![], BTreeSet::new());
    for output in &core.out {
        match output {
            Output::Event(GatewayEvent::StateChanged { to, .. }) => states.push(format!("{to:?}")),
            Output::Event(GatewayEvent::AlarmRaised(alarm)) => drop(alarms.insert(alarm.id.to_string())),
            _ => {}
        }
    }
    (states, alarms)
}

/// What a loss changes there.
fn outcome(state: (GatewayState, Intent, u64), loss: Loss) -> String {
    let (_, undisturbed) = played(state, Loss::Nothing);
    let (states, alarms) = played(state, loss);
    let alarms = alarms.difference(&undisturbed).map(|id| format!("`{id}`"));
    let told: Vec<_> = states.into_iter().map(|to| format!("→ {to}")).chain(alarms).collect();
    if told.is_empty() { "goes on".to_owned() } else { told.join(", ") }
}

/// The table for people.
pub fn markdown() -> String {
    let mut text = format!(
        "\n## What it does on a loss\n\nPlayed through for {LASTS_S} s each, with the plan aboard to its landing: the state that follows, and the alarms. An alarm with a \
         cause (GPS, energy,\nengine) makes the FP Manager fly the plan's emergency for it, or ask for Safe mode. Of the ground \
         station's link the\ngateway needs nothing: in every state it goes on, and the plan's emergency `link` is the FP \
         Manager's. Safe mode that\nhas lasted T2 returns, see above.\n\n| state |"
    );
    text.extend(LOSSES.map(|(_, words)| format!(" {words} |")));
    text += &format!("\n|---{}|\n", "|---".repeat(LOSSES.len()));
    for state in PLAYED {
        let cells = LOSSES.map(|(loss, _)| format!(" {} |", outcome(state, loss)));
        text += &format!("| {:?} |{}\n", state.0, cells.concat());
    }
    text
}

/// The human pilot has priority, and a silent FP Manager is not waited for.
#[test]
fn what_is_lost_is_told_or_changes_the_state_wherever_it_matters() {
    for state in PLAYED.into_iter().filter(|(state, ..)| is_flying(*state)) {
        for loss in [Loss::Autopilot, Loss::Gps, Loss::Energy, Loss::Engine] {
            assert!(outcome(state, loss).contains('`'), "{:?}: {loss:?} is not told", state.0);
        }
        let free = state.0 == GatewayState::Manual;
        assert_eq!(outcome(state, Loss::Command).contains("Manual"), !free, "{:?}", state.0);
        let waits = matches!(state.0, GatewayState::Nav | GatewayState::Hold | GatewayState::Directed);
        assert!(!waits || outcome(state, Loss::FpManager).contains("SafeHold"), "{:?}", state.0);
    }
}
