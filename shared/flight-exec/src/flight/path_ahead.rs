//! The path ahead, measured from the aircraft.

use super::Horizon;
use crate::api::{Action, AircraftState};
use crate::layout::path::{distance_and_course, distance_m};
use crate::layout::stretch::IssuedWaypoint;
use crate::value::Config;
use aircraft::{Profile, Wind};
use flight_plan::DecideBefore;
use geometry::LatLon;

/// Over the ground a way is never made slower, m/s: against a wind that nobody can fly in.
pub(super) const MIN_GROUND_MPS: f64 = 1.0;

/// What is issued, and where the aircraft is.
#[derive(Clone, Copy)]
pub(crate) struct PathAhead<'a> {
    pub config: &'a Config,
    pub profile: &'a Profile,
    pub horizon: &'a Horizon,
    pub aircraft: Option<&'a AircraftState>,
    /// While it holds: where the hold was given.
    pub held_at: Option<LatLon>,
}

/// A piece of way: metres along the path, seconds in the present wind.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Way {
    pub metres: f64,
    pub seconds: f64,
}

impl Way {
    /// What is left of the way to an intersection until its decision is due; nothing, if it was due before.
    pub fn until_due(self, lead: DecideBefore) -> Way {
        let share = match lead {
            DecideBefore::Distance(metres) => 1.0 - metres / self.metres.max(f64::MIN_POSITIVE),
            DecideBefore::Time(seconds) => 1.0 - seconds / self.seconds.max(f64::MIN_POSITIVE),
        };
        let share = share.max(0.0);
        Way { metres: self.metres * share, seconds: self.seconds * share }
    }
}

impl PathAhead<'_> {
    /// From the aircraft to the waypoint it steers to, metres.
    pub fn left_to_current_m(&self) -> f64 {
        match (self.horizon.front(), self.aircraft) {
            (Some(front), Some(a)) => distance_m(a.position, front.waypoint.position),
            _ => 0.0,
        }
    }

    /// Path length where the aircraft is, metres; never less than where the way to the current waypoint begins, however far the
    /// aircraft was brought away from it.
    pub fn distance_flown_m(&self) -> f64 {
        let on_the_way = |h: &IssuedWaypoint| {
            let begun_m = h.before.end_of_path().distance_m;
            (h.end_m - self.left_on_path_m()).max(begun_m)
        };
        let tail = || self.horizon.tail().map(|t| t.end_of_path().distance_m);
        self.horizon.front().map(on_the_way).or_else(tail).unwrap_or(0.0)
    }

    /// Flying time of the path where the aircraft is, seconds; likewise.
    pub fn time_flown_s(&self) -> f64 {
        let on_the_way = |h: &IssuedWaypoint| {
            let left_s = self.left_on_path_m() / h.waypoint.airspeed_mps.max(1.0);
            (h.end_s - left_s).max(h.before.end_of_path().time_s)
        };
        let tail = || self.horizon.tail().map(|t| t.end_of_path().time_s);
        self.horizon.front().map(on_the_way).or_else(tail).unwrap_or(0.0)
    }

    /// From where the path is left or gone on with to the waypoint steered to, metres: in a hold that is where it was given, wherever
    /// the aircraft has drifted since.
    fn left_on_path_m(&self) -> f64 {
        let held = self.horizon.front().zip(self.held_at);
        held.map_or_else(|| self.left_to_current_m(), |(h, at)| distance_m(at, h.waypoint.position))
    }

    /// Path from the aircraft to a path length ahead, metres; never negative.
    pub fn path_left_m(&self, at_m: f64) -> f64 {
        let beyond = self.horizon.front().filter(|front| at_m > front.before.path.distance_m);
        beyond.map_or(0.0, |front| (self.left_to_current_m() + at_m - front.end_m).max(0.0))
    }

    /// How many of the waypoints ahead can't be altered: those nearer than the stopping distance (turn and
    /// latency), and those whose pattern has been regenerated behind them.
    pub fn alterable_from(&self) -> usize {
        self.horizon.behind_pinned().max(self.kept_by_distance())
    }

    /// Nearer than this nothing is altered: the radius of a turn, and the way flown until an order takes effect, metres.
    pub fn stopping_distance_m(&self) -> f64 {
        let speed_mps = self.aircraft.map_or(0.0, |a| a.ground_speed_mps);
        let speed_mps = speed_mps.max(self.profile.min_airspeed_mps);
        self.profile.turn_radius_m(speed_mps) + self.config.latency_s * speed_mps
    }

    fn kept_by_distance(&self) -> usize {
        let Some(front) = self.horizon.front().filter(|h| !h.is_loiter()) else { return 0 };
        if !matches!(front.waypoint.action, Action::Fly) {
            return 1;
        }
        if self.aircraft.is_none() {
            return 1;
        }
        let stop_m = self.stopping_distance_m();
        let to_front_m = self.left_to_current_m();
        // a circle can be left wherever it is
        let near = |h: &&IssuedWaypoint| !h.is_loiter() && to_front_m + h.end_m - front.end_m <= stop_m;
        self.horizon.iter().take_while(near).count()
    }

    /// From the aircraft along the first waypoints issued.
    pub(super) fn way_along(&self, waypoints: usize) -> Way {
        let mut at = self.aircraft.map(|a| a.position);
        let mut way = Way::default();
        for waypoint in self.horizon.iter().take(waypoints).map(|h| &h.waypoint) {
            if let Some(from) = at {
                way = self.along(way, from, waypoint.position, waypoint.airspeed_mps);
            }
            at = Some(waypoint.position);
        }
        way
    }

    /// One straight piece more, at the speed over the ground.
    pub(super) fn along(&self, way: Way, from: LatLon, to: LatLon, airspeed_mps: f64) -> Way {
        let (metres, course_deg) = distance_and_course(from, to);
        let wind = self.aircraft.map_or(Wind::CALM, AircraftState::wind);
        let mps = wind.ground_speed_mps(airspeed_mps, course_deg).unwrap_or(MIN_GROUND_MPS);
        Way { metres: way.metres + metres, seconds: way.seconds + metres / mps.max(MIN_GROUND_MPS) }
    }
}
