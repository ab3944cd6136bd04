//! The way to a landing with the engine: what is checked here is what is fed.
//!
//! The autopilot flies straight from altitude to altitude: it would climb on its way towards a ridge, and come to it too low. Where the
//! slopes lead too near to the ground it circles up before the transit, and down where the approach begins.

use super::gates::{CORNERS, Gate, circles, is_over_ground};
use super::gliding::SPARE_M;
use super::way::{INITIAL_M, gates};
use super::{Approach, Situation, along};
use aircraft::glide::Circle;
use geometry::LatLon;
use geometry::near::{distance_and_course, distance_m};
use usal::contract::{SafeParameters, SafeRunway};

/// Height kept above the ground on the way, metres; as much of it is asked for as the aircraft has where it is, and towards the approach
/// no more than this share of what it still has above that.
const CLEARANCE_M: f64 = 100.0;
const CLEAR_SHARE: f64 = 0.5;
/// Slopes that differ by less are one, metres.
const LEVEL_M: f64 = 10.0;
/// Share of the steepest climb and descent that is told.
const STEEP: f64 = 0.7;
/// More waypoints are not fed.
const MOST_GATES: u32 = 200;

/// A way with the engine.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Powered {
    /// Up to where the final descent begins.
    pub gates: Vec<Gate>,
    /// Time to the threshold, seconds.
    pub time_s: f64,
}

/// What the ways have in common.
struct Ends<'a> {
    s: &'a Situation<'a>,
    /// Where the approach begins, and its altitude, metres AMSL.
    initial: (LatLon, f64),
    heading_deg: f64,
    /// Metres AMSL.
    transit_m: f64,
}

/// `None`: the ground on the way is too high, or the wind too strong.
pub(super) fn powered(runway: &SafeRunway, safe: &SafeParameters, s: &Situation) -> Option<Powered> {
    let [initial, last] = gates(runway, Approach::Whole, safe);
    let needed_m = ground_to_clear_m(s, initial.0).unwrap_or(initial.1);
    if needed_m > s.profile.ceiling_amsl_m {
        return None;
    }
    let highest_m = s.profile.ceiling_amsl_m.max(initial.1);
    let transit_m = s.altitude_amsl_m.max(needed_m).clamp(initial.1, highest_m);
    let ends = Ends { s, initial, heading_deg: runway.heading_deg, transit_m };
    let has_m = s.terrain.and_then(|terrain| terrain.elevation_m(s.position));
    let has_m = has_m.map_or(f64::INFINITY, |ground_m| (s.altitude_amsl_m - ground_m - 1.0).max(0.0));
    let clearance_m =
        |told_m: f64| (CLEAR_SHARE * (told_m - initial.1)).clamp(SPARE_M, CLEARANCE_M - 1.0).min(has_m);
    let ways = [(false, false), (false, true), (true, false), (true, true)];
    ways.into_iter().find_map(|(circles_up, circles_down)| {
        let mut gates = up(circles_up, circles_down, &ends)?;
        gates.extend(down(circles_down, &ends)?);
        gates.push(Gate { position: last.0, altitude_amsl_m: last.1, on_arc: false });
        if gates.len() > MOST_GATES as usize || !is_over_ground(&gates, s, clearance_m) {
            return None;
        }
        let time_s = time_s(&gates, runway.threshold, s)?;
        Some(Powered { gates, time_s })
    })
}

/// To the altitude of the transit; on the way there, if that is long enough.
fn up(in_circles: bool, circles_down: bool, ends: &Ends) -> Option<Vec<Gate>> {
    let Ends { s, initial, transit_m, .. } = ends;
    let climb_m = transit_m - s.altitude_amsl_m;
    let climb_mps = STEEP * s.profile.max_climb_mps.max(0.1);
    if climb_m < LEVEL_M {
        return Some(vec![]);
    }
    if !in_circles {
        let way_m = distance_m(s.position, initial.0) - if circles_down { 0.0 } else { descent_m(ends) };
        let time_s = way_m / s.profile.cruise_airspeed_mps.max(1.0);
        return (climb_m <= climb_mps * time_s).then(Vec::new);
    }
    let count = count(climb_m, climb_mps, s)?;
    let around = circles(s.position, (s.track_deg, true), count, (s.altitude_amsl_m, *transit_m), s);
    // it is there
    Some(around.into_iter().skip(1).collect())
}

/// From the altitude of the transit to where the approach begins.
fn down(in_circles: bool, ends: &Ends) -> Option<Vec<Gate>> {
    let Ends { s, initial: (initial, approach_m), heading_deg, transit_m } = *ends;
    let there = Gate { position: initial, altitude_amsl_m: approach_m, on_arc: false };
    let falls_m = transit_m - approach_m;
    if falls_m < LEVEL_M {
        return (!in_circles).then(|| vec![there]);
    }
    if in_circles {
        let count = count(falls_m, STEEP * s.profile.max_descent_mps.max(0.1), s)?;
        return Some(circles(initial, (heading_deg, true), count, (transit_m, approach_m), s));
    }
    let (way_m, descent_m) = (distance_m(s.position, initial), descent_m(ends));
    if descent_m + INITIAL_M <= way_m {
        let bearing_deg = s.position.inverse(initial).bearing_start_deg;
        let position = s.position.destination(bearing_deg, way_m - descent_m);
        return Some(vec![Gate { position, altitude_amsl_m: transit_m, on_arc: false }, there]);
    }
    // what is left of it is lost on the level part of the approach
    let fits = transit_m - s.altitude_amsl_m < LEVEL_M && descent_m <= way_m + INITIAL_M;
    fits.then(|| vec![there])
}

/// Length of the descent to where the approach begins, metres.
fn descent_m(ends: &Ends) -> f64 {
    let profile = ends.s.profile;
    let slope = STEEP * profile.max_descent_mps.max(0.1) / profile.cruise_airspeed_mps.max(1.0);
    (ends.transit_m - ends.initial.1) / slope
}

/// So many circles for a height at a rate, m/s; `None`: too many.
fn count(height_m: f64, mps: f64, s: &Situation) -> Option<u32> {
    let count = (height_m / (mps * Circle::of(s.profile, s.wind()).time_s)).ceil().max(1.0);
    (count * f64::from(CORNERS) < f64::from(MOST_GATES)).then_some(count as u32)
}

fn time_s(gates: &[Gate], threshold: LatLon, s: &Situation) -> Option<f64> {
    let (mut here, mut time_s) = (s.position, 0.0);
    for place in gates.iter().map(|gate| gate.position).chain([threshold]) {
        let (distance_m, course_deg) = distance_and_course(here, place);
        time_s += distance_m / s.wind().ground_speed_mps(s.profile.cruise_airspeed_mps, course_deg)?;
        here = place;
    }
    Some(time_s)
}

/// The altitude that clears the ground between here and a place, metres AMSL; `None`: nothing is known of it.
fn ground_to_clear_m(s: &Situation, to: LatLon) -> Option<f64> {
    let terrain = s.terrain?;
    let ground = along(s.position, to).filter_map(|(_, place)| terrain.elevation_m(place));
    ground.max_by(f64::total_cmp).map(|ground_m| ground_m + CLEARANCE_M)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{HOME, Wall, runway, situation};
    use super::super::{choose, path};
    use super::*;
    use aircraft::Profile;

    /// How far it is told to fly above a ridge of 700 m, so far north of it, on its way to a threshold, both in km; from an altitude,
    /// metres AMSL.
    fn over_the_ridge_m(threshold_km: f64, ridge_km: f64, altitude_amsl_m: f64) -> f64 {
        let ridge = HOME.destination(0.0, 1000.0 * ridge_km);
        let wall = Wall(ridge.lat_deg, 700.0);
        let profile = Profile::default();
        let s = Situation { altitude_amsl_m, terrain: Some(&wall), ..situation(&profile) };
        let safe = SafeParameters::default();
        let landing =
            choose(&[runway("behind", 0.0, threshold_km, 0.0, 1)], &safe, &s).expect("it can be flown over");
        let way = path(&landing, &safe, &s);
        let mut from = (s.position, altitude_amsl_m);
        let mut least_m = f64::INFINITY;
        for waypoint in &way {
            let (start, start_m) =
                std::mem::replace(&mut from, (waypoint.position, waypoint.altitude_amsl_m));
            for (share, place) in along(start, waypoint.position) {
                let told_m = start_m + share * (waypoint.altitude_amsl_m - start_m);
                if terrain::Terrain::elevation_m(&wall, place) == Some(700.0) {
                    least_m = least_m.min(told_m - 700.0);
                }
            }
        }
        least_m
    }

    /// It climbed towards the one, and had begun its descent before the others.
    #[test]
    fn no_slope_leads_through_a_ridge_on_the_way() {
        for (threshold_km, ridge_km, altitude_amsl_m) in
            [(12.0, 2.2, 500.0), (12.0, 8.4, 800.0), (5.4, 1.5, 500.0)]
        {
            let over_m = over_the_ridge_m(threshold_km, ridge_km, altitude_amsl_m);
            assert!((99.0..1000.0).contains(&over_m), "{threshold_km} km, {ridge_km} km: {over_m} m");
        }
    }

    #[test]
    fn over_plain_ground_nobody_circles() {
        let profile = Profile::default();
        for terrain in [None, Some(&terrain::Flat(300.0) as &dyn terrain::Terrain)] {
            let s = Situation { altitude_amsl_m: 500.0, terrain, ..situation(&profile) };
            let way = powered(&runway("main", 0.0, 12.0, 0.0, 1), &SafeParameters::default(), &s).unwrap();
            assert!(way.gates.iter().all(|gate| !gate.on_arc), "{way:?}");
        }
    }
}
