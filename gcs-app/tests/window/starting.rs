//! Why the aircraft is not started.

use super::flying::connected;
use super::vehicle::{gateway_status, status};
use flight_exec::Phase;
use gcs_app::link::Telemetry;
use usal::contract::{GatewayState, Stamped};

/// It was grey, and for each reason a tooltip said that a vehicle on the ground with a plan aboard can be started.
#[test]
fn a_start_that_is_not_possible_says_why_in_sight_and_at_the_button() {
    let (mut window, hash) = connected();
    window.harness.set_size(egui::vec2(960.0, 600.0));
    let start = "Start and take off (hold)";
    for (plan, phase, state, why) in [
        (None, Phase::Idle, GatewayState::Stop, "No plan aboard: push one"),
        (Some(&hash), Phase::Finished, GatewayState::Stop, "Rewind first: the flight is over"),
        (Some(&hash), Phase::Flying, GatewayState::TakeOff, "It was started: the take-off is under way"),
        (
            Some(&hash),
            Phase::Flying,
            GatewayState::Manual,
            "The plan was begun, and the pilot has the aircraft",
        ),
        (Some(&hash), Phase::Flying, GatewayState::Off, "what its autopilot does is not known"),
    ] {
        let mut value = status(phase);
        value.plan = plan.map(|hash| hash.as_str().into());
        window.receive_status(value);
        let gateway = gateway_status(state);
        window.receive(Telemetry::Gateway(Stamped { time_s: 1.0, validity_s: 2.0, value: gateway }.into()));
        window.receive_position(true);
        // a plan that was flown to its end is said to be
        let said = if phase == Phase::Finished { "Rewind first: the plan was flown" } else { why };
        assert!(window.paints(said), "{why}");
        let start = if plan.is_some() { start } else { "Start and take off with the plan aboard (hold)" };
        assert!(!window.is_enabled(start), "{why}");
        window.harness.hover_at(window.centre(start));
        window.steps(60);
        assert!(window.shows(why), "{why}");
        window.harness.hover_at(window.centre("Map"));
        window.steps(2);
    }
}
