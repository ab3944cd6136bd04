//! Why the aircraft is not started, and why there is nothing to command.

use super::{Scene, emergency, ended, flight};
use flight_exec::Phase;
use usal::contract::GatewayState;

/// Why there is nothing to command.
pub fn nothing_to_do(scene: &Scene<'_>) -> Option<&'static str> {
    let is_flown = scene.vehicle.phase() == Phase::Finished && ended::otherwise(scene).is_none();
    if flight::stands(scene) {
        return why(scene).map(|why| if is_flown && why == IS_OVER { WAS_FLOWN } else { why });
    }
    if scene.vehicle.active_hash().is_none() {
        return Some(NO_PLAN);
    }
    match scene.vehicle.phase() {
        Phase::Finished if is_flown => Some("The plan was flown"),
        Phase::Grounded => Some("Landed: the next flight waits for its start"),
        Phase::Idle => Some("The plan aboard was not started"),
        _ => None,
    }
}

const NO_PLAN: &str = "No plan aboard: push one";
// what is to be done comes first: in a small window the rest is behind a button
const IS_OVER: &str = "Rewind first: the flight is over";
const WAS_FLOWN: &str = "Rewind first: the plan was flown";

/// Why a vehicle that stands on the ground is not started, and what comes first; its autopilot may have reasons of its own.
pub fn why(scene: &Scene<'_>) -> Option<&'static str> {
    let state = scene.vehicle.gateway.as_ref().map(|gateway| gateway.value.state);
    if !flight::stands(scene) {
        return Some("It does not stand on the ground, as far as is known");
    }
    if scene.vehicle.active_hash().is_none() {
        return Some(NO_PLAN);
    }
    if emergency::has_come_down(scene) {
        return Some("Rewind first: an emergency plan was flown");
    }
    match (scene.vehicle.phase(), state) {
        (Phase::Finished, _) => Some(IS_OVER),
        // nothing may have come of an earlier start: the arming was refused, or somebody held it
        (Phase::Idle | Phase::Grounded, _) | (_, Some(GatewayState::Stop)) => None,
        (_, None | Some(GatewayState::Off)) => {
            Some("The plan was begun, and what its autopilot does is not known")
        }
        (_, Some(GatewayState::Manual)) => Some("The plan was begun, and the pilot has the aircraft"),
        (_, Some(GatewayState::Terminate)) => Some("The flight was ended by force"),
        (_, Some(GatewayState::TakeOff)) => Some("It was started: the take-off is under way"),
        _ => Some("The plan is being flown: it has not stopped yet"),
    }
}
