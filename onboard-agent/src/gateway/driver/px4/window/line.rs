//! When a new list may go up.
//!
//! With each new list PX4 drops the line along which it flies, and goes straight from where it is to what it steers to: on a long leg it
//! wanders from its line then, by some metres, and behind a turn it would never come onto it. Where the next line begins all is well again.
//! So what is not needed soon waits for the end of a leg, or for a short one, as those around an arc are; and before a long line begins,
//! so much is put on board that nothing is needed on it. With a new list PX4 also drops a take-off in the air, and turns: that one waits
//! until it is over, or is to be left.

use super::Window;
use crate::gateway::order::{Fed, Fix};
use geometry::{LatLon, LocalFrame, Vec2};
use usal::contract::{Action, Waypoint};

/// On the line: not farther from it than this, metres …
const ON_LINE_M: f64 = 2.0;
/// … and not across it by more than this, degrees.
const ALONG_LINE_DEG: f64 = 3.0;
/// The next line begins as near as this, metres.
const NEAR_M: f64 = 300.0;
/// What is on board for less than so many seconds of flight can't wait: a link is lost for longer than a list takes to go up.
const LEAST_S: f64 = 90.0;
/// A long line is prepared for when it is among so many that come next.
const COMES_NEXT: u64 = 3;

impl Window {
    /// What is new from a position on may go up later, where it does no harm.
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
        !is_near_the_next_line(&fix, from.position, to.waypoint.position) && lasts(fix.position, aboard)
    }

    /// If a long line comes, what is on board behind it lasts until the next lists may go up.
    pub(super) fn lasts_behind_the_next_line(&self) -> bool {
        let first = self.chain.first();
        let line =
            |position| Some((self.chain.at(position)?.position, self.chain.at(position + 1)?.position));
        let is_long = |position: &u64| line(*position).is_some_and(|(from, to)| from.distance_m(to) > NEAR_M);
        let Some(long) = (first..first + COMES_NEXT).find(is_long) else { return true };
        let behind = (long + 1..self.end).map_while(|position| self.chain.at(position));
        line(long).is_none_or(|(_, end)| lasts(end, behind))
    }
}

/// Little is left of the line from `from` to `to`, and that is flown along it.
fn is_near_the_next_line(fix: &Fix, from: LatLon, to: LatLon) -> bool {
    from.distance_m(to) <= NEAR_M || (fix.position.distance_m(to) <= NEAR_M && is_along(fix, from, to))
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
    aside_m.abs() <= ON_LINE_M && along >= ALONG_LINE_DEG.to_radians().cos()
}

/// What is on board, flown from a place on, lasts long enough for a list to wait.
fn lasts<'a>(mut from: LatLon, aboard: impl Iterator<Item = &'a Waypoint>) -> bool {
    let (mut seconds, mut count) = (0.0, 0);
    for waypoint in aboard {
        seconds += from.distance_m(waypoint.position) / waypoint.airspeed_mps.max(1.0);
        (from, count) = (waypoint.position, count + 1);
    }
    // the one steered to, and where it turns to next
    count >= 2 && seconds >= LEAST_S
}
