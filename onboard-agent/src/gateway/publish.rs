//! The gateway's variables.

use super::core::Gateway;
use service::{Board, Time};
use usal::topics::gateway as topic;

/// Shows what is new of the telemetry, and state and navigation when they changed or are due.
pub fn show(now: Time, gateway: &Gateway, board: &mut Board) {
    let t = gateway.telemetry();
    board.measured(topic::POSITION, t.position());
    board.measured(topic::ATTITUDE, t.attitude);
    board.measured(topic::AIR, t.air);
    board.measured(topic::GPS, t.gps);
    board.measured(topic::ENGINE, t.engine);
    board.measured(topic::POWER, t.power);
    if let Some((looked, links)) = &t.links {
        board.changing(topic::LINKS, *looked, |_| links.clone());
    }
    let urgent = gateway.urgent();
    board.changing(topic::NAVIGATION, urgent, |_| gateway.navigation());
    board.changing(topic::STATE, urgent, |_| gateway.status(now));
}
