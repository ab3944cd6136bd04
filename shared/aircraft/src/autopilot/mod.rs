//! Guidance: the waypoint follower that the simulated autopilot and the preview share.
//!
//! The owner of the waypoints keeps the list; [`Guidance`] knows only the leg being flown:
//!
//! 1. [`Guidance::direct`] begins a leg at the aircraft's position; [`Guidance::proceed`] begins the leg
//!    from the target just reached to the one that follows it.
//! 2. [`Guidance::step`] with the target after the current one, if there is one, gives the demand for the
//!    aircraft and says when the current target is reached.
//! 3. When it is, the owner takes the next target from its list and calls `proceed`. At the end of the list it calls
//!    `direct` with what it wants instead (a loiter, a way home).
//!
//! Fly-by targets are reached early, by the turn anticipation r · tan(A/2) at the real ground speed, so
//! that the turn ends on the next leg; fly-over targets are reached abeam. A take-off is reached at its
//! altitude, a landing at standstill, a loiter never. An autopilot with other [`Habits`] is flown by the same code.

mod habits;
mod lateral;
mod leg;
mod plane;
mod runway;
mod told;

use crate::{Demand, Profile, State};
use geometry::LatLon;
pub use habits::{Autopilot, Corners, Habits, wp_radius_m};
use leg::{Corner, Leg, Place};
pub use told::{FLY_OVER_M, GREATEST_ACCEPTANCE_M, arc_acceptance_m, turn_acceptance_m};

/// What to do at, or on the way to, a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Take off along a heading (degrees true) and climb to the target's altitude.
    TakeOff {
        /// Runway heading, degrees true.
        heading_deg: f64,
    },
    /// Fly to it.
    Fly,
    /// Circle it until a new command.
    Loiter {
        /// Metres; positive clockwise. Zero: the aircraft's planning turn radius, clockwise.
        radius_m: f64,
    },
    /// Land: the target is the touch-down point, its altitude the runway's elevation.
    Land {
        /// Runway heading, degrees true.
        heading_deg: f64,
    },
}

/// A waypoint, as guidance sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Where.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Airspeed towards it as the autopilot is told it, m/s; not a positive number: cruise.
    pub airspeed_mps: f64,
    /// What to do.
    pub action: Action,
    /// Cross it before turning.
    pub fly_over: bool,
    /// Go on to the next one this far before it, metres; `None`: as is the follower's habit.
    pub acceptance_m: Option<f64>,
}

/// What guidance says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guided {
    /// For [`crate::Aircraft::step`].
    pub demand: Demand,
    /// The current target is reached: go on to the next.
    pub reached: bool,
    /// How long ago it was, seconds, at the present speed; 0 where that is not known.
    pub late_s: f64,
    /// Off the line or circle, metres, positive to the right of (outside) it.
    pub cross_track_m: f64,
    /// To the target, metres.
    pub distance_m: f64,
    /// Direction of the line, or to a loiter's centre, degrees true in 0..360.
    pub course_deg: f64,
    /// Wanted altitude less the real one, metres.
    pub altitude_error_m: f64,
}

/// The follower: the leg being flown and the aircraft's limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Guidance {
    profile: Profile,
    habits: Habits,
    leg: Option<Leg>,
    /// Turn at the end of the leg, kept from step to step: it costs more than all the rest.
    corner: Option<(Target, Corner)>,
}

impl Guidance {
    /// Nothing to fly yet: wings level, cruise. It keeps close to its lines.
    pub fn new(profile: Profile) -> Self {
        Self::with(profile, Habits::CLOSE)
    }

    /// The same with other habits.
    pub fn with(profile: Profile, habits: Habits) -> Self {
        Self { profile, habits, leg: None, corner: None }
    }

    /// Begins a leg at the aircraft's position and altitude, to `target`.
    pub fn direct(&mut self, state: &State, target: Target) {
        self.begin(Leg::new(state.position, state.altitude_amsl_m, target));
    }

    /// Begins the leg from the current target to `target`; as [`Guidance::direct`] if there is none, or if it is
    /// no place to start a line from (a take-off ends where it ends, and so does a loiter).
    pub fn proceed(&mut self, state: &State, target: Target) {
        let from = self.leg.as_ref().map(|leg| leg.target).filter(|t| t.action == Action::Fly);
        match from {
            Some(t) => self.begin(Leg::new(t.position, t.altitude_amsl_m, target)),
            None => self.direct(state, target),
        }
    }

    /// Its habits.
    pub fn habits(&self) -> &Habits {
        &self.habits
    }

    /// From now on the air is so much warmer than the standard's, °C.
    pub fn set_isa_deviation_c(&mut self, isa_deviation_c: f64) {
        self.habits.isa_deviation_c = isa_deviation_c;
    }

    /// Another altitude of the current target, metres AMSL.
    pub fn set_altitude(&mut self, altitude_amsl_m: f64) {
        if let Some(leg) = &mut self.leg {
            leg.target.altitude_amsl_m = altitude_amsl_m;
        }
    }

    /// Another airspeed towards the current target, m/s.
    pub fn set_airspeed(&mut self, airspeed_mps: f64) {
        if let Some(leg) = &mut self.leg {
            leg.target.airspeed_mps = airspeed_mps;
        }
    }

    /// The target being flown to.
    pub fn target(&self) -> Option<&Target> {
        self.leg.as_ref().map(|leg| &leg.target)
    }

    /// What to do now, given the target after the current one.
    pub fn step(&mut self, state: &State, next: Option<&Target>) -> Guided {
        let Some(leg) = self.leg.clone() else {
            return self.idle(state);
        };
        let place = leg.place(state);
        match leg.target.action {
            Action::Fly => {
                let corner = self.corner_to(&leg, next);
                self.fly(&leg, &place, state, corner)
            }
            Action::Loiter { radius_m } => self.circle(&leg, &place, state, radius_m),
            Action::TakeOff { .. } => self.take_off(&leg, &place, state),
            Action::Land { .. } => self.land(&leg, &place, state),
        }
    }

    fn begin(&mut self, leg: Leg) {
        self.leg = Some(leg);
        self.corner = None;
    }

    fn idle(&self, state: &State) -> Guided {
        let airspeed_mps = self.true_mps(self.profile.cruise_airspeed_mps, state);
        let demand = Demand { airspeed_mps, ..Demand::default() };
        Guided {
            demand: if state.on_ground { Demand::default() } else { demand },
            reached: false,
            late_s: 0.0,
            cross_track_m: 0.0,
            distance_m: 0.0,
            course_deg: state.track_deg(),
            altitude_error_m: 0.0,
        }
    }

    fn corner_to(&mut self, leg: &Leg, next: Option<&Target>) -> Option<Corner> {
        let next = next.filter(|_| !leg.target.fly_over)?;
        match self.corner {
            Some((known, corner)) if known == *next => Some(corner),
            _ => {
                let corner = leg.corner(next);
                self.corner = Some((*next, corner));
                Some(corner)
            }
        }
    }

    fn fly(&self, leg: &Leg, place: &Place, state: &State, corner: Option<Corner>) -> Guided {
        let early_m = match leg.target.acceptance_m {
            Some(acceptance_m) => acceptance_m,
            None => corner.map_or(0.0, |c| self.early_m(leg, c, state)),
        };
        let early_m = if self.goes_by_distance(leg) { along_m(early_m, place) } else { early_m };
        let (altitude_m, slope) = leg.altitude_at(place.remaining_m);
        let along_mps = place.velocity.dot(leg.along).max(0.0);
        let mut demand = self.demand(leg, state, altitude_m, slope * along_mps);
        demand.bank_rad = self.follow_line(leg, place);
        let late_s = if leg.is_a_point() { 0.0 } else { (early_m - place.remaining_m) / along_mps.max(1.0) };
        let mut guided = self.guided(leg, place, demand, altitude_m - state.altitude_amsl_m);
        guided.late_s = late_s.max(0.0);
        guided.reached_if(leg.is_a_point() || place.remaining_m <= early_m)
    }

    /// It goes on within a distance of its target, or behind it (ArduPlane's `Plane::verify_nav_wp`).
    fn goes_by_distance(&self, leg: &Leg) -> bool {
        leg.target.acceptance_m.is_some() || matches!(self.habits.corners, Corners::Radius(_))
    }

    /// How far before a corner it goes on to the next leg, metres.
    fn early_m(&self, leg: &Leg, corner: Corner, state: &State) -> f64 {
        let ground_speed_mps = state.ground_speed_mps();
        match self.habits.corners {
            Corners::Radius(radius_m) => {
                let most_m = self.habits.in_thin_air_m(radius_m, state.altitude_amsl_m);
                corner.share() * most_m.min(lateral::look_ahead_m(&self.habits, ground_speed_mps))
            }
            Corners::Early { s, least_m } => (s * ground_speed_mps).max(least_m),
            Corners::Anticipated => {
                corner.anticipation_m(self.profile.turn_radius_m(ground_speed_mps), leg.length_m)
            }
        }
    }

    fn circle(&self, leg: &Leg, place: &Place, state: &State, radius_m: f64) -> Guided {
        let cruise = self.profile.cruise_airspeed_mps;
        let radius_m = if radius_m == 0.0 { self.profile.turn_radius_m(cruise) } else { radius_m };
        let mut demand = self.demand(leg, state, leg.target.altitude_amsl_m, 0.0);
        let lateral = lateral::circle_mps2(&self.habits, place.from_end, radius_m, place.velocity);
        demand.bank_rad = lateral::bank_rad(lateral, self.max_bank_rad());
        let mut guided = self.guided(leg, place, demand, leg.target.altitude_amsl_m - state.altitude_amsl_m);
        guided.cross_track_m = guided.distance_m - radius_m.abs();
        guided
    }

    fn follow_line(&self, leg: &Leg, place: &Place) -> f64 {
        let lateral = lateral::line_mps2(&self.habits, place.cross_track_m, leg.along, place.velocity);
        lateral::bank_rad(lateral, self.max_bank_rad())
    }

    /// Airspeed and climb for an altitude; the bank is the caller's.
    fn demand(&self, leg: &Leg, state: &State, altitude_m: f64, slope_mps: f64) -> Demand {
        const ALTITUDE_GAIN_PER_S: f64 = 0.4;
        let to_altitude = ALTITUDE_GAIN_PER_S * (altitude_m - state.altitude_amsl_m);
        let climb = slope_mps + to_altitude;
        // an aircraft still on its wheels has to leave the ground first
        let climb_mps = if state.on_ground { climb.max(1.0) } else { climb };
        Demand {
            bank_rad: 0.0,
            climb_mps: climb_mps.clamp(-self.profile.max_descent_mps, self.profile.max_climb_mps),
            airspeed_mps: self.airspeed_mps(&leg.target, state),
            ground_amsl_m: None,
        }
    }

    /// True airspeed towards a target, m/s.
    fn airspeed_mps(&self, target: &Target, state: &State) -> f64 {
        let asked = target.airspeed_mps;
        let known = asked.is_finite() && asked > 0.0;
        let wanted = if known { asked } else { self.profile.cruise_airspeed_mps };
        self.true_mps(wanted.clamp(self.profile.min_airspeed_mps, self.profile.max_airspeed_mps), state)
    }

    fn true_mps(&self, told_mps: f64, state: &State) -> f64 {
        self.habits.true_mps(told_mps, state.altitude_amsl_m)
    }

    fn max_bank_rad(&self) -> f64 {
        self.profile.max_bank_deg.to_radians()
    }

    fn guided(&self, leg: &Leg, place: &Place, demand: Demand, altitude_error_m: f64) -> Guided {
        Guided {
            demand,
            reached: false,
            late_s: 0.0,
            cross_track_m: place.cross_track_m,
            distance_m: place.from_end.length(),
            course_deg: leg.course_deg(place),
            altitude_error_m,
        }
    }
}

/// How far before its target along the line it comes within a distance of it, metres: from beside the line later. In the middle of a circle it
/// is at none of its corners.
fn along_m(distance_m: f64, place: &Place) -> f64 {
    (distance_m * distance_m - place.cross_track_m * place.cross_track_m).max(0.0).sqrt()
}

impl Guided {
    fn reached_if(mut self, reached: bool) -> Self {
        self.reached = reached;
        self
    }
}

#[cfg(test)]
mod tests;
