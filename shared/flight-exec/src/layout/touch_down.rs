//! Where a glide comes down that has more height than the way ahead can lose: behind the threshold, perhaps behind the runway.

use super::path::distance_and_course;
use crate::api::{Action, AircraftState, Waypoint};
use aircraft::Profile;
use aircraft::glide::turn_rad;
use aircraft::power::glide_sink_mps;
use flight_plan::Runway;

/// The end of a way down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TouchDown {
    /// Height over the threshold, metres.
    pub over_m: f64,
    /// So far behind the threshold it touches down, metres.
    pub behind_m: f64,
    /// So far behind the runway's end it comes to rest, metres; before it, if that is negative.
    pub beyond_m: f64,
}

impl TouchDown {
    /// Along the waypoints ahead, as steeply as the aircraft descends and no lower than each of them is told. It needs the shortest runway
    /// of its profile to come to rest. `None`: they lead to no landing, or against the wind not there.
    pub fn of<'a>(
        profile: &Profile,
        state: &AircraftState,
        ahead: impl Iterator<Item = &'a Waypoint>,
        runway: &Runway,
    ) -> Option<Self> {
        let (steep_mps, glide_mps) = sinks_mps(profile);
        let (mut here, mut altitude_m) = (state.position, state.altitude_amsl_m);
        let mut turns_from_deg = Some(state.track_deg);
        for waypoint in ahead {
            let (straight_m, course_deg) = distance_and_course(here, waypoint.position);
            // at the other corners it turns within the way
            let turn = turns_from_deg.take().map_or(0.0, |from_deg| turn_rad(from_deg, course_deg));
            let way_m = straight_m + turn * profile.turn_radius_m(waypoint.airspeed_mps);
            let over_ground_mps =
                |towards_deg| state.wind().ground_speed_mps(waypoint.airspeed_mps, towards_deg);
            let way_s = way_m / over_ground_mps(course_deg)?;
            let lowest_m = altitude_m - way_s * steep_mps;
            if let Action::Land { heading_deg } = waypoint.action {
                let over_m = lowest_m - runway.elevation_amsl_m;
                let behind_m = over_m / steep_mps * over_ground_mps(heading_deg)?;
                return Some(Self {
                    over_m,
                    behind_m,
                    beyond_m: behind_m + profile.min_runway_m - runway.length_m,
                });
            }
            altitude_m = waypoint.altitude_amsl_m.min(altitude_m - way_s * glide_mps).max(lowest_m);
            here = waypoint.position;
        }
        None
    }
}

/// The steepest and the flattest way down, m/s.
fn sinks_mps(profile: &Profile) -> (f64, f64) {
    let steep_mps = profile.max_descent_mps.max(0.1);
    (steep_mps, glide_sink_mps(profile, profile.cruise_airspeed_mps, 1.0).min(steep_mps))
}
