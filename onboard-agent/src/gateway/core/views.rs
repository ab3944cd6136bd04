//! What the gateway publishes about itself.

use super::buffer::CAPACITY;
use super::off_path::right_of_way_m;
use super::telemetry::{OUT_OF_DATE, Telemetry};
use super::{Gateway, seconds};
use crate::gateway::order::{Kind, Mode, Time};
use geometry::{LatLon, LocalFrame};
use usal::Instance;
use usal::contract::{
    Action, AutopilotKind, Circle, GatewayState, GatewayStatus, Navigation, Token, Waypoint,
};

/// Low-water mark of the buffer.
pub const LOW_WAYPOINTS: usize = 3;
/// Low-water mark of the buffer, seconds of flight.
pub const LOW_S: f64 = 10.0;
/// Ground speed below which times make no sense, m/s.
const SLOWEST_MPS: f64 = 3.0;
/// No farther from a centre than so many radii it circles there: it may be wide in a wind.
const ROUND: f64 = 1.5;

impl Gateway {
    /// What it is doing.
    pub fn state(&self) -> GatewayState {
        self.state
    }

    /// The session of the FP Manager that joined last, if one has.
    pub fn fp_manager(&self) -> Option<Instance> {
        self.fp_manager.instance
    }

    /// The autopilot's latest values.
    pub fn telemetry(&self) -> &Telemetry {
        &self.telemetry
    }

    /// What is published at once when it changes: waypoint steered to, state, armed, alarms, who joined.
    pub fn urgent(&self) -> (Option<Token>, GatewayState, bool, usize, Option<Instance>) {
        let current = self.buffer.current().map(|w| w.token);
        (current, self.state, self.telemetry.armed, self.alarms.raised().len(), self.fp_manager.instance)
    }

    /// The variable `state`.
    pub fn status(&self, now: Time) -> GatewayStatus {
        let age = |t: Option<Time>| t.map(|t| now.saturating_sub(t).as_secs_f64());
        let left = self.control.safe_since.map(|s| (s + seconds(self.safe.t2_s)).saturating_sub(now));
        GatewayStatus {
            state: self.state,
            cause: self.cause.clone(),
            armed: self.telemetry.armed,
            autopilot: self.kind(),
            unfit: self.control.capability.as_ref().and_then(|capability| capability.clone().err()),
            autopilot_mode: self.telemetry.mode_name.clone().into_owned(),
            autopilot_age_s: age(self.telemetry.last_received).unwrap_or(f64::MAX),
            fp_manager: self.fp_manager.heard(now, &self.safe).map(|session| session.to_string()),
            fp_manager_age_s: self.fp_manager.age_s(now),
            waits_for_height_m: self.waits_for_height_m(),
            circle: self.circle(),
            safe_return_in_s: left.map(|l| l.as_secs_f64()),
            alarms: self.alarms.raised(),
        }
    }

    /// The circle that it flies: in a hold or a direct command as the autopilot tells it, on the waypoints as it is commanded.
    fn circle(&self) -> Option<Circle> {
        let t = &self.telemetry;
        let (centre, radius_m) = match t.mode.filter(|_| t.is_up(self.now))? {
            Mode::Hold | Mode::Direct => {
                let (at, centre) = t.steers_to?;
                (self.now.saturating_sub(at) < OUT_OF_DATE).then_some((centre, t.loiter_radius_m?))?
            }
            Mode::Waypoints => match self.buffer.current()? {
                Waypoint { position, action: Action::Loiter { radius_m }, .. } => (*position, *radius_m),
                _ => return None,
            },
            Mode::Return | Mode::Other(_) => return None,
        };
        // it may still be on its way there
        let is_there = self.place()?.distance_m(centre) <= ROUND * radius_m.abs();
        let circle = Circle { centre, radius_m: radius_m.abs(), clockwise: radius_m > 0.0 };
        is_there.then_some(circle)
    }

    fn kind(&self) -> Option<AutopilotKind> {
        let kind = self.control.capability.as_ref()?.as_ref().ok()?;
        let Kind { name, habits, landing_deg, version } = *kind;
        let (name, habits) = (name.to_owned(), habits.map(str::to_owned));
        Some(AutopilotKind { name, habits, landing_deg, version: version.map(|version| version.to_string()) })
    }

    /// The variable `navigation`.
    pub fn navigation(&self) -> Navigation {
        let own = |t: Token| (t.0 > 0).then_some(t);
        let (buffer_waypoints, buffer_s) = self.level();
        let to = self.buffer.current().map(|w| w.position);
        let distance_m = to.zip(self.place()).map_or(0.0, |(a, b)| a.distance_m(b));
        Navigation {
            current: self.buffer.current().and_then(|w| own(w.token)),
            next: self.buffer.next().and_then(|w| own(w.token)),
            last: self.buffer.last().and_then(|w| own(w.token)),
            distance_m,
            eta_s: distance_m / self.speed_mps(),
            cross_track_m: self.cross_track_m(to),
            buffer_waypoints,
            buffer_s,
            room: CAPACITY.saturating_sub(buffer_waypoints),
            end_of_plan: self.is_complete(),
        }
    }

    fn speed_mps(&self) -> f64 {
        let ground = self.telemetry.fix.map(|(_, f)| f.north_mps.hypot(f.east_mps));
        let cruise = self.settings.profile.cruise_airspeed_mps;
        ground.filter(|v| *v > SLOWEST_MPS).unwrap_or(cruise)
    }

    /// Waypoints and seconds of flight in the buffer.
    pub(super) fn level(&self) -> (usize, f64) {
        let mut from = self.place();
        let (mut count, mut length_m) = (0, 0.0);
        for w in self.buffer.waypoints() {
            length_m += from.map_or(0.0, |f| flat_distance_m(f, w.position));
            from = Some(w.position);
            count += 1;
        }
        (count, length_m / self.speed_mps())
    }

    /// Right of the line from the waypoint before to the one steered to, metres.
    fn cross_track_m(&self, to: Option<LatLon>) -> f64 {
        let (Some(to), Some(from), Some(here)) = (to, self.buffer.passed(), self.place()) else { return 0.0 };
        let frame = LocalFrame::new(here);
        right_of_way_m(frame.to_local(from), frame.to_local(to))
    }
}

/// Good to a per mille over the length of a segment, which is enough for seconds of flight, and ten
/// times cheaper than the geodesic.
fn flat_distance_m(a: LatLon, b: LatLon) -> f64 {
    LocalFrame::new(a).to_local(b).length()
}
