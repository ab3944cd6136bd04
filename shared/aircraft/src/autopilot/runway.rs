//! Take-off and landing.

use super::leg::{Leg, Place};
use super::{Guidance, Guided, lateral};
use crate::{Demand, State};

/// A take-off is over this far below its altitude, metres.
const TAKE_OFF_DONE_M: f64 = 2.0;
/// Gentle banks near the ground, radians.
const LOW_BANK_RAD: f64 = 0.26;
/// Height over the runway at which the flare begins, metres, and its sink, m/s.
const FLARE_HEIGHT_M: f64 = 2.0;
const FLARE_SINK_MPS: f64 = 0.6;
/// Approach speed as a multiple of the minimum airspeed.
const APPROACH_FACTOR: f64 = 1.3;
/// It slows down for the approach this far before touch-down, metres.
const FINAL_M: f64 = 800.0;
/// Slower than this it has stopped, m/s.
const STOPPED_MPS: f64 = 0.3;

impl Guidance {
    /// Full climb along the runway's line; reached at the altitude.
    pub(super) fn take_off(&self, leg: &Leg, place: &Place, state: &State) -> Guided {
        let lateral = lateral::line_mps2(&self.habits, place.cross_track_m, leg.along, place.velocity);
        let missing_m = leg.target.altitude_amsl_m - state.altitude_amsl_m;
        let demand = Demand {
            bank_rad: lateral::bank_rad(lateral, LOW_BANK_RAD),
            climb_mps: self.profile.max_climb_mps,
            airspeed_mps: self.airspeed_mps(&leg.target, state),
            ground_amsl_m: None,
        };
        self.guided(leg, place, demand, missing_m)
            .reached_if(!state.on_ground && missing_m <= TAKE_OFF_DONE_M)
    }

    /// Down the slope to the touch-down point, flare, roll out; reached at standstill.
    pub(super) fn land(&self, leg: &Leg, place: &Place, state: &State) -> Guided {
        if state.on_ground {
            let stopped = state.ground_speed_mps() < STOPPED_MPS;
            return self.guided(leg, place, Demand::default(), 0.0).reached_if(stopped);
        }
        let runway_m = leg.target.altitude_amsl_m;
        let (slope_m, slope) = leg.altitude_at(place.remaining_m);
        let along_mps = place.velocity.dot(leg.along).max(0.0);
        let mut demand = self.demand(leg, state, slope_m, slope * along_mps);
        demand.bank_rad = self.follow_line(leg, place);
        demand.ground_amsl_m = Some(runway_m);
        if place.remaining_m < FINAL_M {
            let approach_mps = self.true_mps(APPROACH_FACTOR * self.profile.min_airspeed_mps, state);
            demand.airspeed_mps = demand.airspeed_mps.min(approach_mps);
        }
        if state.altitude_amsl_m - runway_m < FLARE_HEIGHT_M {
            demand.climb_mps = -FLARE_SINK_MPS;
            demand.bank_rad = demand.bank_rad.clamp(-LOW_BANK_RAD, LOW_BANK_RAD);
            demand.airspeed_mps = self.true_mps(self.profile.min_airspeed_mps, state);
        }
        self.guided(leg, place, demand, slope_m - state.altitude_amsl_m)
    }
}
