//! The glide after an engine failure: at the cruise speed with the best glide ratio, in the wind, with more sink in the turns from
//! track to track.

use crate::power::glide_sink_mps;
use crate::{GRAVITY_MPS2, Profile, Wind, Winds};
use geometry::LatLon;
use geometry::geodesy::normalise_180;
use geometry::near::distance_and_course;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Radius of a circle in radii of a planned turn: it is held in wind.
const CIRCLE_RADII: f64 = 1.3;
/// A circle may cost this much more height than it should, before the runway is out of reach.
const CIRCLE_SPARE: f64 = 1.2;
/// More circles would make more waypoints than are fed; above that it goes down faster in them.
const MOST_CIRCLES: f64 = 20.0;
/// An autopilot circles in a wind of up to this share of its airspeed.
const MOST_WIND: f64 = 0.8;

/// With more tailwind than this share of its airspeed a glide rolls past the end of a runway that it was not laid out for.
const MOST_TAILWIND: f64 = 0.1;

/// What is kept of the height for what a glide does not know of (gusts, the way an autopilot turns): metres, and a share of what the
/// glide takes.
const RESERVE_M: f64 = 15.0;
const RESERVE_SHARE: f64 = 0.1;

/// The height that a glide to a runway has to spare there, metres, for it to be counted on: by the height that it takes, metres. The
/// executor and Safe mode keep the same.
pub fn reserve_m(taken_m: f64) -> f64 {
    RESERVE_M + RESERVE_SHARE * taken_m.max(0.0)
}

/// It may land at the end of a runway that nobody has named, into this direction.
pub fn may_land_unnamed(profile: &Profile, wind: Wind, heading_deg: f64) -> bool {
    let tailwind_mps = wind.vector().dot(geometry::Vec2::from_bearing_rad(heading_deg.to_radians()));
    tailwind_mps <= MOST_TAILWIND * profile.cruise_airspeed_mps
}

/// A point of a glide.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GlidePoint {
    /// Seconds since the engine failed.
    pub time_s: f64,
    /// Where.
    pub position: LatLon,
    /// Metres AMSL; may be below the ground.
    pub altitude_amsl_m: f64,
}

/// Where a glide begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GlideStart {
    /// Where.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Where it flies to, degrees true.
    pub course_deg: f64,
}

/// A circle that is flown to lose height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// Metres.
    pub radius_m: f64,
    /// Height that a glide around it takes, metres.
    pub height_m: f64,
    /// How long that takes, seconds.
    pub time_s: f64,
}

impl Circle {
    /// At the cruise speed, over the ground.
    pub fn of(profile: &Profile, wind: Wind) -> Self {
        Self::with_radius(CIRCLE_RADII * profile.turn_radius_m(profile.cruise_airspeed_mps), profile, wind)
    }

    /// The smallest that an autopilot is sure to hold: banked halfway between what is planned with and the steepest. For the little height
    /// that a wider one would take too much of.
    pub fn smallest(profile: &Profile, wind: Wind) -> Self {
        let bank_deg = 0.5 * (profile.planning_bank_deg + profile.max_bank_deg);
        let most_mps = profile.cruise_airspeed_mps + bounded_mps(wind, profile);
        let radius_m = most_mps.powi(2) / (GRAVITY_MPS2 * bank_deg.to_radians().tan());
        Self::with_radius(radius_m.min(Self::of(profile, wind).radius_m), profile, wind)
    }

    fn with_radius(radius_m: f64, profile: &Profile, wind: Wind) -> Self {
        let speed_mps = profile.cruise_airspeed_mps;
        // it is banked most where the wind is behind it
        let wind_mps = bounded_mps(wind, profile);
        let load_factor = ((speed_mps + wind_mps).powi(2) / (GRAVITY_MPS2 * radius_m)).hypot(1.0);
        let time_s = TAU * radius_m / (speed_mps * speed_mps - wind_mps * wind_mps).sqrt();
        Self { radius_m, height_m: time_s * glide_sink_mps(profile, speed_mps, load_factor), time_s }
    }

    /// The height that is kept for one, metres: what it takes, and some to spare.
    pub fn kept_m(&self) -> f64 {
        CIRCLE_SPARE * self.height_m
    }

    /// So many of them can be flown with this much height to lose, and some of it to spare.
    pub fn most(&self, height_m: f64) -> u32 {
        (height_m / self.kept_m()).floor().clamp(0.0, MOST_CIRCLES) as u32
    }
}

/// Circles of one size, one after the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Laps {
    /// Each of them.
    pub circle: Circle,
    /// So many.
    pub count: u32,
}

impl Laps {
    /// In which circles a glide loses the height that its way can't lose, wide ones first: as many as `steep_mps` down needs for `too_much_m`,
    /// and no more than a glide has height for, `there_is_m`; what is left of it in the smallest ones. Emergency plans and Safe mode choose
    /// alike: none is too high for a place where the other one lands.
    pub fn losing(
        (profile, wind): (&Profile, Wind),
        steep_mps: f64,
        (mut too_much_m, mut there_is_m): (f64, f64),
    ) -> [Self; 2] {
        [Circle::of(profile, wind), Circle::smallest(profile, wind)].map(|circle| {
            let lap_m = steep_mps * circle.time_s;
            // a cast of a negative number gives 0
            let needed = (too_much_m / lap_m).ceil() as u32;
            let count = needed.min(circle.most(there_is_m));
            too_much_m -= f64::from(count) * lap_m;
            there_is_m -= f64::from(count) * circle.kept_m();
            Self { circle, count }
        })
    }

    /// Height that a glide around all of them takes, metres.
    pub fn height_m(&self) -> f64 {
        f64::from(self.count) * self.circle.height_m
    }

    /// How long that takes, seconds.
    pub fn time_s(&self) -> f64 {
        f64::from(self.count) * self.circle.time_s
    }
}

/// The wind's speed, as far as an autopilot circles in it, m/s.
fn bounded_mps(wind: Wind, profile: &Profile) -> f64 {
    wind.speed_mps().min(MOST_WIND * profile.cruise_airspeed_mps)
}

/// The glide through some places, with a point at each, and at the last one in line with a runway; `None`: against the wind it does
/// not get there.
pub fn glide(
    profile: &Profile,
    winds: Winds,
    from: GlideStart,
    way: &[LatLon],
    runway_heading_deg: f64,
) -> Option<Vec<GlidePoint>> {
    let speed_mps = profile.cruise_airspeed_mps;
    let sink_mps = glide_sink_mps(profile, speed_mps, 1.0);
    let load_factor = 1.0 / profile.planning_bank_deg.to_radians().cos();
    let turning_mps = glide_sink_mps(profile, speed_mps, load_factor);
    let turn_s_per_rad = profile.turn_radius_m(speed_mps) / speed_mps;
    let GlideStart { position, altitude_amsl_m, mut course_deg } = from;
    let mut here = GlidePoint { time_s: 0.0, position, altitude_amsl_m };
    let mut points = vec![here];
    let turn = |at: &mut GlidePoint, from_deg: f64, to_deg: f64| {
        let turn_s = turn_rad(from_deg, to_deg) * turn_s_per_rad;
        at.time_s += turn_s;
        at.altitude_amsl_m -= turn_s * turning_mps;
    };
    for place in way {
        let (distance_m, arrives_deg) = distance_and_course(here.position, *place);
        if distance_m < 1.0 {
            continue;
        }
        let ground_mps = winds.at(here.altitude_amsl_m).ground_speed_mps(speed_mps, arrives_deg)?;
        here.time_s += distance_m / ground_mps;
        here.altitude_amsl_m -= distance_m / ground_mps * sink_mps;
        turn(&mut here, course_deg, arrives_deg);
        here.position = *place;
        course_deg = arrives_deg;
        points.push(here);
    }
    if let Some(last) = points.last_mut() {
        turn(last, course_deg, runway_heading_deg);
    }
    Some(points)
}

/// Angle between two courses, radians in 0..=π.
pub fn turn_rad(from_deg: f64, to_deg: f64) -> f64 {
    normalise_180(to_deg - from_deg).abs().to_radians()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_takes_more_height_in_wind_and_none_is_begun_that_the_height_does_not_suffice_for() {
        for name in Profile::names() {
            let profile = Profile::by_name(name).unwrap();
            let calm = Circle::of(&profile, Wind::CALM);
            let windy = Circle::of(&profile, Wind::from_direction(90.0, 0.3 * profile.cruise_airspeed_mps));
            assert!(windy.height_m > calm.height_m && windy.time_s > calm.time_s, "{name}");
            assert_eq!(windy.radius_m, calm.radius_m, "{name}: it is one over the ground");
            let small = Circle::smallest(&profile, Wind::CALM);
            assert!(small.radius_m < calm.radius_m && small.height_m < calm.height_m, "{name}");
            let storm = Circle::of(&profile, Wind::from_direction(90.0, 1e3));
            assert!(storm.height_m.is_finite() && storm.height_m > 0.0, "{name}");
            assert_eq!([-1.0, 0.0, 1.0, 2.5].map(|n| calm.most(n * calm.height_m)), [0, 0, 0, 2], "{name}");
            assert_eq!((calm.most(1e9), calm.most(f64::NAN)), (20, 0), "{name}");
        }
    }
}
