//! When a new list may go up.
//!
//! With each new list PX4 drops the line along which it flies, and goes straight from where it is to what it steers to. On
//! the line that is the same. Behind a turn it is not: it would never come onto the leg. So what is not needed soon waits
//! until the aircraft is on its line: as far beside as it is then, it comes nearer only all the way to the leg's end. With a new
//! list it also drops a take-off in the air, and turns: that one waits until it is over, or is to be left.

use super::Window;
use crate::gateway::order::{Fed, Fix};
use geometry::{LatLon, LocalFrame, Vec2};
use usal::contract::{Action, Waypoint};

/// On the line: not farther from it than this, metres …
const ON_LINE_M: f64 = 2.0;
/// … or, on a long one, than this share of its length: no two maps have the same straight lines …
const ON_LINE_SHARE: f64 = 3e-4;
/// … and not across it by more than this, degrees.
const ALONG_LINE_DEG: f64 = 3.0;
/// What is on board for less than so many seconds of flight can't wait.
const LEAST_S: f64 = 30.0;

impl Window {
    /// What is new from a position on may go up later, when the aircraft is on its line.
    pub(super) fn may_wait(&self, new_from: u64) -> bool {
        let takes_off = |fed: &Fed| matches!(fed.waypoint.action, Action::TakeOff { .. });
        self.chain.active().is_some_and(takes_off) || self.may_wait_for_its_line(new_from)
    }

    fn may_wait_for_its_line(&self, new_from: u64) -> bool {
        let first = self.chain.first();
        let (Some(fix), Some(from), Some(to)) = (self.fix, self.chain.before(first), self.chain.active())
        else {
            return false;
        };
        let aboard = (first..new_from).map_while(|position| self.chain.at(position));
        !is_along(&fix, from.position, to.waypoint.position) && lasts(&fix, aboard)
    }
}

/// The aircraft flies along the line from `from` to `to`.
fn is_along(fix: &Fix, from: LatLon, to: LatLon) -> bool {
    let frame = LocalFrame::new(from);
    let line = frame.to_local(to);
    let length_m = line.length();
    let velocity = Vec2::new(fix.east_mps, fix.north_mps);
    let speed_mps = velocity.length();
    if length_m == 0.0 || speed_mps == 0.0 {
        return false;
    }
    let aside_m = line.cross(frame.to_local(fix.position)) / length_m;
    let along = line.dot(velocity) / (length_m * speed_mps);
    aside_m.abs() <= ON_LINE_M.max(ON_LINE_SHARE * length_m) && along >= ALONG_LINE_DEG.to_radians().cos()
}

/// What is on board, the waypoint steered to first, lasts long enough for the list to wait.
fn lasts<'a>(fix: &Fix, aboard: impl Iterator<Item = &'a Waypoint>) -> bool {
    let (mut seconds, mut from, mut count) = (0.0, fix.position, 0);
    for waypoint in aboard {
        seconds += from.distance_m(waypoint.position) / waypoint.airspeed_mps.max(1.0);
        (from, count) = (waypoint.position, count + 1);
    }
    // the one steered to, and where it turns to next
    count >= 2 && seconds >= LEAST_S
}
