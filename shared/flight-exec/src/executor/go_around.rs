//! A landing that is broken off near the ground: a climb straight ahead comes before the turn to wherever it leads. What can't climb does
//! not break off.

use super::Executor;
use crate::api::{Action, AircraftState, Refusal, TURN_HEIGHT_M};
use crate::flight::refusal;
use crate::layout::cursor::Cursor;
use crate::layout::path::{PathEnd, PathState, distance_m};
use aircraft::glide_in::ALIGNED_DEG;
use flight_plan::Runway;
use geometry::geodesy::normalise_180;

/// As close together the ground ahead is looked at, metres.
const SPACING_M: f64 = 45.0;
/// A climb that takes longer than this leads nowhere, metres.
const FARTHEST_M: f64 = 5_000.0;

/// A climb straight ahead.
struct Climb {
    heading_deg: f64,
    way_m: f64,
    altitude_amsl_m: f64,
}

impl Executor {
    /// A person may lead it elsewhere, as low as it is.
    pub(super) fn check_may_turn(&self, to: &Cursor) -> Result<(), Refusal> {
        self.go_around(to).map(drop)
    }

    /// Where the climb ends that a way to elsewhere begins with; `None`: it may turn where it is.
    ///
    /// # Errors
    /// It is on a landing, too low to turn, and can't climb.
    pub(super) fn go_around(&self, to: &Cursor) -> Result<Option<PathState>, Refusal> {
        let Some((state, runway)) = self.short_final(to) else { return Ok(None) };
        let height_m = state.altitude_amsl_m - runway.elevation_amsl_m;
        if state.on_ground {
            let reason = "it has touched down: let it roll out, then start the next flight";
            return Err(refusal("on-ground", reason));
        }
        if self.is_gliding() {
            let reason = format!(
                "the engine is out and it is {height_m:.0} m above runway `{}`: it can't climb, and a turn from there ends in the \
                 ground; let it land",
                runway.id
            );
            return Err(refusal("too-low-to-turn", reason));
        }
        let Some(climb) = self.climb_ahead(state, runway) else {
            let reason = format!(
                "it is {height_m:.0} m above runway `{}`, and the ground straight ahead rises faster than it climbs: let it land",
                runway.id
            );
            return Err(refusal("too-low-to-turn", reason));
        };
        Ok(Some(self.end_of(climb)))
    }

    /// The aircraft and its runway, while it steers to the touch-down from lower than it may turn, and is led elsewhere.
    fn short_final(&self, to: &Cursor) -> Option<(&AircraftState, &Runway)> {
        let front = self.flight.horizon.front().filter(|_| !self.is_muted())?;
        let goes_on = to.place(&self.world()).leg == front.place.leg;
        let lands = matches!(front.waypoint.action, Action::Land { .. }) && !goes_on;
        let program = &self.setup.program;
        let stage = program.stage(&program.path(&front.place.leg).filter(|_| lands)?)?;
        let runway = program.plan.runway(stage.runway.as_ref()?)?;
        let state = self.life.aircraft()?;
        let ground_m = self.setup.terrain.elevation_m(state.position).unwrap_or(f64::NEG_INFINITY);
        let least_m = runway.elevation_amsl_m.max(ground_m) + TURN_HEIGHT_M;
        (state.altitude_amsl_m < least_m).then_some((state, runway))
    }

    /// Straight on, until it is high enough above the runway and all ground that it has passed. `None`: ground is in its way.
    fn climb_ahead(&self, state: &AircraftState, runway: &Runway) -> Option<Climb> {
        let profile = &self.setup.profile;
        let is_in_line = normalise_180(state.track_deg - runway.heading_deg).abs() <= ALIGNED_DEG;
        let heading_deg = if is_in_line { runway.heading_deg } else { state.track_deg };
        let ground_mps = state.wind().ground_speed_mps(profile.cruise_airspeed_mps, heading_deg)?.max(1.0);
        // it still sinks when it is told
        let lead_m = self.setup.config.latency_s * ground_mps;
        let mut highest_m = runway.elevation_amsl_m;
        let mut way_m = 0.0;
        while way_m < FARTHEST_M {
            let place = state.position.destination(heading_deg, way_m);
            // the elevations may be coarser than a runway is level
            let is_runway = distance_m(place, runway.threshold) <= runway.length_m;
            let ground_m = self.setup.terrain.elevation_m(place).filter(|_| !is_runway);
            highest_m = ground_m.map_or(highest_m, |ground_m| highest_m.max(ground_m));
            let climbed_m = profile.max_climb_mps * (way_m - lead_m).max(0.0) / ground_mps;
            let altitude_amsl_m = state.altitude_amsl_m + climbed_m;
            if ground_m.is_some_and(|ground_m| altitude_amsl_m <= ground_m) {
                return None;
            }
            if altitude_amsl_m >= highest_m + TURN_HEIGHT_M {
                return Some(Climb { heading_deg, way_m, altitude_amsl_m: highest_m + TURN_HEIGHT_M });
            }
            way_m += SPACING_M;
        }
        None
    }

    /// It ends as much later as a turn begins before its waypoint.
    fn end_of(&self, climb: Climb) -> PathState {
        let (here, Climb { heading_deg, way_m, altitude_amsl_m }) = (self.here(), climb);
        let way_m = way_m + self.path_ahead().stopping_distance_m();
        PathState {
            last: PathEnd { position: here.last.position.destination(heading_deg, way_m), ..here.last },
            course_deg: heading_deg,
            predicted_amsl_m: altitude_amsl_m,
            commanded_amsl_m: altitude_amsl_m,
            distance_m: here.distance_m + way_m,
            time_s: here.time_s + way_m / here.last.airspeed_mps.max(1.0),
        }
    }
}
