//! From where a take-off really ends onto the line that is drawn from where it was to end.
//!
//! In a take-off an autopilot holds a course, and ends where its altitude is reached; a cross wind has carried it aside by then. From
//! there it flies straight to the waypoint behind the take-off, and only from that one on along lines (ArduPlane's
//! `auto_state.next_wp_crosstrack`, PX4's `SETPOINT_TYPE_TAKEOFF` before). So the place at which the take-off was to end becomes a waypoint of
//! its own, still part of the take-off: the first leg is a line then.

use super::chain::Chain;
use super::item::ItemKind;
use crate::gateway::order::{Fed, Fix};
use geometry::{LocalFrame, Vec2};
use usal::contract::{Action, Waypoint};

/// The waypoints, with one more behind each take-off; it has the take-off's number.
pub fn with_climb_outs(waypoints: Vec<Fed>) -> Vec<Fed> {
    let with_its_own = |fed: Fed| {
        let is_take_off = matches!(fed.waypoint.action, Action::TakeOff { .. });
        let climb_out = is_take_off.then(|| {
            let waypoint = Waypoint { action: Action::Fly, fly_over: false, ..fed.waypoint.clone() };
            Fed { waypoint, ..fed }
        });
        [Some(fed), climb_out].into_iter().flatten()
    };
    waypoints.into_iter().flat_map(with_its_own).collect()
}

/// So many of these were fed.
pub fn fed_of(waypoints: &[Fed]) -> usize {
    waypoints.chunk_by(|a, b| a.serial == b.serial).count()
}

/// This waypoint is where the take-off before it was to end.
pub fn is_climb_out(from: &Waypoint, waypoint: &Waypoint) -> bool {
    matches!(from.action, Action::TakeOff { .. })
        && waypoint.action == Action::Fly
        && from.position == waypoint.position
}

impl Chain {
    /// It takes longer to climb than was thought, and the place lies behind: nobody turns round for it.
    pub fn leave_climb_out_behind(&mut self, fix: &Fix) {
        let (Some(before), Some(active)) = (self.before(self.first()), self.active()) else { return };
        let place = active.waypoint.position;
        let climbs_out = before.kind == ItemKind::TakeOff && before.position == place;
        let to_place = LocalFrame::new(fix.position).to_local(place);
        if climbs_out && to_place.dot(Vec2::new(fix.east_mps, fix.north_mps)) < 0.0 {
            self.leave_active();
        }
    }
}
