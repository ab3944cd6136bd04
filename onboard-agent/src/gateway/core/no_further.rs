//! A waypoint that the aircraft does not get past: some autopilots circle there until they have its altitude, and one with too little
//! power, or with ice, never has it.

use super::Gateway;
use crate::gateway::order::Time;
use geometry::LatLon;
use geometry::near::distance_m;
use std::time::Duration;
use usal::contract::{Action, GatewayState};

/// It circles within this, metres.
const NEAR_M: f64 = 400.0;
/// An altitude that differs by less is not waited for, metres.
const SAME_M: f64 = 5.0;
/// It was there for so long, and came nearer to its altitude more slowly than this, m/s.
const LASTS: Duration = Duration::from_secs(90);
const CLOSING_MPS: f64 = 0.2;

/// A waypoint that it is at.
#[derive(Debug, Clone, Copy)]
pub struct At {
    place: LatLon,
    since: Time,
    /// How far off its altitude it was then, metres.
    off_m: f64,
}

impl Gateway {
    /// It circles at a waypoint, and comes no nearer to its altitude.
    pub(super) fn gets_no_further(&mut self, now: Time) -> bool {
        let Some((place, off_m)) = self.waits_for_altitude() else {
            self.at = None;
            return false;
        };
        let at = self.at.filter(|at| at.place == place).unwrap_or(At { place, since: now, off_m });
        self.at = Some(at);
        let took = now.saturating_sub(at.since);
        took >= LASTS && at.off_m - off_m < CLOSING_MPS * took.as_secs_f64()
    }

    /// The waypoint that it is at, and how far it is off its altitude, metres. `None`: it is at none, or has its altitude.
    fn waits_for_altitude(&self) -> Option<(LatLon, f64)> {
        use GatewayState::{Approach, Nav, SafeApproach, SafeReturn};
        let waypoint = self.buffer.current().filter(|w| w.action == Action::Fly)?;
        let fix = self.telemetry.fix_now(self.now)?;
        let off_m = (waypoint.altitude_amsl_m - fix.altitude_amsl_m).abs();
        let is_at = matches!(self.state, Nav | Approach | SafeReturn | SafeApproach)
            && distance_m(fix.position, waypoint.position) < NEAR_M;
        (is_at && off_m > SAME_M).then_some((waypoint.position, off_m))
    }
}
