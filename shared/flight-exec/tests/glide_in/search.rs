//! A search for ways in to a runway: each of many simple ways is flown, step by step. It knows nothing of how the product calculates a glide.

use aircraft::Profile;
use geometry::Vec2;
use std::f64::consts::{PI, TAU};

const STEP_S: f64 = 0.5;
/// A way that has not ended after this is none, seconds.
const LONGEST_S: f64 = 1200.0;
/// A turn by more than this is one that wants height, radians.
const TURN_RAD: f64 = PI / 6.0;
/// In line with a runway at its threshold: so far beside its line at most, metres.
const BESIDE_M: f64 = 40.0;
/// Nearer than this a place is reached, metres.
const REACHED_M: f64 = 20.0;
const GRAVITY_MPS2: f64 = 9.80665;

/// What glides: metres and seconds in a plane.
#[derive(Clone, Copy)]
pub struct Glider {
    pub airspeed_mps: f64,
    pub radius_m: f64,
    pub sink_mps: f64,
    /// Blows to there.
    pub wind: Vec2,
    /// It turns towards the runway before its line, by so much of what that turn takes.
    pub lead: f64,
}

/// Where it is; the height is above the runway.
#[derive(Debug, Clone, Copy)]
pub struct Begin {
    pub at: Vec2,
    pub height_m: f64,
    pub course_rad: f64,
}

/// A way to an end of the runway.
#[derive(Debug, Clone, Copy)]
pub struct Way {
    pub threshold: Vec2,
    pub heading_rad: f64,
    /// By a place so far before the threshold, metres.
    pub final_m: Option<f64>,
    /// In line with the runway at last.
    pub in_line: bool,
}

/// How a way ends.
#[derive(Debug, Clone, Copy)]
pub struct Flown {
    /// Over the threshold, metres.
    pub height_m: f64,
    /// Height that the way took, metres.
    pub taken_m: f64,
    /// Lowest height at which there was still to turn, metres; infinite: nowhere.
    pub turns_at_m: f64,
    /// Least height above what was asked for over the ground, metres.
    pub clear_m: f64,
}

impl Glider {
    /// In turns with this bank.
    pub fn new(profile: &Profile, bank_deg: f64, wind: Vec2) -> Self {
        let airspeed_mps = profile.cruise_airspeed_mps;
        let radius_m = airspeed_mps.powi(2) / (GRAVITY_MPS2 * bank_deg.to_radians().tan());
        Self { airspeed_mps, radius_m, sink_mps: airspeed_mps / profile.glide_ratio, wind, lead: 1.0 }
    }

    /// `None`: it never gets there, or not in line.
    pub fn fly(&self, begin: Begin, way: &Way, ground: impl Fn(Vec2) -> f64) -> Option<Flown> {
        let Begin { at: mut here, mut height_m, course_rad } = begin;
        let along = Vec2::from_bearing_rad(way.heading_rad);
        let gate = way.final_m.map(|m| way.threshold - along * m);
        let mut is_past_gate = gate.is_none();
        if gate.is_none() && way.in_line && (way.threshold - here).dot(along) < REACHED_M {
            return None;
        }
        let mut heading_rad = self.heading_for(Vec2::from_bearing_rad(course_rad));
        let (mut turns_at_m, mut clear_m) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..(LONGEST_S / STEP_S) as usize {
            let track = Vec2::from_bearing_rad(heading_rad) * self.airspeed_mps + self.wind;
            let off_rad = turn_rad(track.bearing_rad(), way.heading_rad).abs();
            if way.in_line && off_rad > TURN_RAD {
                turns_at_m = height_m;
            }
            clear_m = clear_m.min(height_m - ground(here));
            is_past_gate |= gate.is_some_and(|gate| {
                let over_ground = track.length() / self.airspeed_mps;
                let lead_m = self.lead * over_ground * self.radius_m * (0.5 * off_rad).min(1.1).tan();
                (gate - here).length() < lead_m.max(REACHED_M)
            });
            let to_go = way.threshold - here;
            if is_past_gate {
                let (ahead_m, beside_m) = (to_go.dot(along), to_go.cross(along).abs());
                let is_there = if way.in_line { ahead_m < REACHED_M } else { to_go.length() < REACHED_M };
                if is_there {
                    let is_good = !way.in_line || (beside_m < BESIDE_M && off_rad < TURN_RAD);
                    let taken_m = begin.height_m - height_m;
                    return is_good.then_some(Flown { height_m, taken_m, turns_at_m, clear_m });
                }
            }
            let aim = match gate {
                Some(gate) if !is_past_gate => gate - here,
                // along the line, from where it is beside it
                _ if way.in_line => {
                    let ahead_m = to_go.dot(along);
                    let on_line = way.threshold - along * ahead_m;
                    on_line + along * self.radius_m.min(ahead_m.max(1.0)) - here
                }
                _ => to_go,
            };
            let wanted_rad = turn_rad(heading_rad, self.heading_for(aim));
            let most_rad = self.airspeed_mps / self.radius_m * STEP_S;
            let turned_rad = wanted_rad.clamp(-most_rad, most_rad);
            heading_rad += turned_rad;
            let load = (turned_rad / STEP_S * self.airspeed_mps / GRAVITY_MPS2).hypot(1.0);
            height_m -= self.sink_mps * load * STEP_S;
            here = here + (Vec2::from_bearing_rad(heading_rad) * self.airspeed_mps + self.wind) * STEP_S;
        }
        None
    }

    /// Where the nose points on a track: into the wind.
    fn heading_for(&self, track: Vec2) -> f64 {
        let track_rad = track.bearing_rad();
        let right = Vec2::from_bearing_rad(track_rad + PI / 2.0);
        track_rad - (self.wind.dot(right) / self.airspeed_mps).clamp(-1.0, 1.0).asin()
    }
}

fn turn_rad(from: f64, to: f64) -> f64 {
    (to - from + PI).rem_euclid(TAU) - PI
}
