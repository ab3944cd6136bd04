//! The way to a landing with the engine: what is checked here is what is fed.
//!
//! The autopilot flies straight from altitude to altitude. So it is told to climb at once, as steeply as it can be counted on: told the
//! altitude of a far place it would climb all the way there, and come to a ridge too low. Where that slope, or the one down to the
//! approach, leads too near to the ground, it circles up before the transit, and down where the approach begins.

use super::Situation;
use super::gates::{CORNERS, Circles, Gate, is_over_ground, turned_m};
use super::gliding::SPARE_M;
use super::ground::along_high;
use super::way::{INITIAL_M, gates};
use aircraft::power::demanded_power_w;
use geometry::LatLon;
use geometry::geodesy::normalise_180;
use geometry::near::distance_and_course;
use usal::contract::{SafeParameters, SafeRunway};

/// Height kept above the ground on the way, metres; towards the approach no more than this share of what it still has above that.
const CLEARANCE_M: f64 = 100.0;
const KEPT_SHARE: f64 = 0.5;
/// Slopes that differ by less are one, metres.
const LEVEL_M: f64 = 10.0;
/// Share of the steepest climb and descent that is told.
const STEEP: f64 = 0.7;
/// Most circles on one way: more waypoints are not fed.
const MOST_CIRCLES: u32 = 192 / CORNERS;

/// A way with the engine.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Powered {
    /// Up to where the final descent begins.
    pub gates: Vec<Gate>,
    /// Time to the threshold, seconds.
    pub time_s: f64,
    /// What that takes, joules.
    pub energy_j: f64,
}

/// What the ways have in common.
struct Ends<'a> {
    s: &'a Situation<'a>,
    /// Where the approach begins, and its altitude, metres AMSL.
    initial: (LatLon, f64),
    heading_deg: f64,
    /// Metres AMSL.
    transit_m: f64,
    /// Straight to there: how far, and at which speed over the ground, metres and m/s.
    way_m: f64,
    ground_mps: f64,
}

/// How a height is changed: on the way, or in circles to one side.
type InCircles = Option<bool>;

/// `None`: the ground on the way is too high, or the wind too strong.
pub(super) fn powered(runway: &SafeRunway, safe: &SafeParameters, s: &Situation) -> Option<Powered> {
    let [initial, last] = gates(runway, safe);
    let needed_m = ground_to_clear_m(s, initial).unwrap_or(initial.1);
    if needed_m > s.profile.ceiling_amsl_m {
        return None;
    }
    let highest_m = s.profile.ceiling_amsl_m.max(initial.1);
    let transit_m = s.altitude_amsl_m.max(needed_m).clamp(initial.1, highest_m);
    let (way_m, course_deg) = distance_and_course(s.position, initial.0);
    let ground_mps = s.wind().ground_speed_mps(s.profile.cruise_airspeed_mps, course_deg)?;
    let ends = Ends { s, initial, heading_deg: runway.heading_deg, transit_m, way_m, ground_mps };
    let asked_m = |told_m: f64| (KEPT_SHARE * (told_m - initial.1)).clamp(SPARE_M, CLEARANCE_M - 1.0);
    let ups = sides(normalise_180(course_deg - s.track_deg) >= 0.0);
    let downs = sides(normalise_180(runway.heading_deg - course_deg) >= 0.0);
    let ways = combined(ups, downs).into_iter();
    let mut over_ground = ways.filter_map(|(up_by, down_by)| {
        let most = if up_by.is_some() && down_by.is_some() { MOST_CIRCLES / 2 } else { MOST_CIRCLES };
        let mut gates = up(up_by, down_by, most, &ends)?;
        gates.extend(down(down_by, most, &ends)?);
        gates.push(Gate { position: last.0, altitude_amsl_m: last.1, on_arc: false });
        is_over_ground(&gates, s, asked_m).then_some(gates)
    });
    let gates = over_ground.next()?;
    let (time_s, energy_j) = takes(&gates, runway, s)?;
    Some(Powered { gates, time_s, energy_j })
}

/// On the way, in circles to the one side, to the other.
fn sides(right: bool) -> [InCircles; 3] {
    [None, Some(right), Some(!right)]
}

/// Without circles first, then with those down, those up, and both.
fn combined(ups: [InCircles; 3], downs: [InCircles; 3]) -> Vec<(InCircles, InCircles)> {
    let mut all: Vec<_> = ups.into_iter().flat_map(|up| downs.map(|down| (up, down))).collect();
    all.sort_by_key(|(up, down)| (up.is_some(), down.is_some()));
    all
}

/// To the altitude of the transit; at once, if the way is long enough.
fn up(by: InCircles, down_by: InCircles, most: u32, ends: &Ends) -> Option<Vec<Gate>> {
    let Ends { s, initial, transit_m, way_m, ground_mps, .. } = *ends;
    let climb_m = transit_m - s.altitude_amsl_m;
    let climb_mps = STEEP * s.profile.max_climb_mps.max(0.1);
    if climb_m < LEVEL_M {
        return by.is_none().then(Vec::new);
    }
    let Some(right) = by else {
        let level_m = way_m - if down_by.is_some() { 0.0 } else { descent_m(ends) };
        let climb_m = climb_m / climb_mps * ground_mps;
        // a place that is nearer than it turns is not flown to
        let there_m = climb_m.max(turned_m(s).min(level_m));
        let position = s.position.destination(s.position.bearing_deg(initial.0), there_m);
        let there = Gate { position, altitude_amsl_m: transit_m, on_arc: false };
        return (climb_m <= level_m).then(|| vec![there]);
    };
    let circles = Circles::at_rate((climb_m, climb_mps), most, right, s);
    // it is there
    Some(circles.gates(s.position, s.track_deg, (s.altitude_amsl_m, transit_m)).split_off(1))
}

/// From the altitude of the transit to where the approach begins.
fn down(by: InCircles, most: u32, ends: &Ends) -> Option<Vec<Gate>> {
    let Ends { s, initial: (initial, approach_m), heading_deg, transit_m, way_m, .. } = *ends;
    let there = Gate { position: initial, altitude_amsl_m: approach_m, on_arc: false };
    let falls_m = transit_m - approach_m;
    if falls_m < LEVEL_M {
        return by.is_none().then(|| vec![there]);
    }
    if let Some(right) = by {
        let rate = (falls_m, STEEP * s.profile.max_descent_mps.max(0.1));
        let circles = Circles::at_rate(rate, most, right, s);
        return Some(circles.gates(initial, heading_deg, (transit_m, approach_m)));
    }
    let descent_m = descent_m(ends);
    if descent_m + INITIAL_M <= way_m {
        let position = s.position.destination(s.position.bearing_deg(initial), way_m - descent_m);
        return Some(vec![Gate { position, altitude_amsl_m: transit_m, on_arc: false }, there]);
    }
    // what is left of it is lost on the level part of the approach
    let fits = transit_m - s.altitude_amsl_m < LEVEL_M && descent_m <= way_m + INITIAL_M;
    fits.then(|| vec![there])
}

/// Length of the descent to where the approach begins, metres.
fn descent_m(ends: &Ends) -> f64 {
    let slope = STEEP * ends.s.profile.max_descent_mps.max(0.1) / ends.ground_mps;
    (ends.transit_m - ends.initial.1) / slope
}

/// How long the way to the threshold takes, and of the energy: seconds and joules. A descent takes little, a climb much.
fn takes(gates: &[Gate], runway: &SafeRunway, s: &Situation) -> Option<(f64, f64)> {
    let profile = s.profile;
    let (mut here, mut altitude_m) = (s.position, s.altitude_amsl_m);
    let (mut time_s, mut energy_j) = (0.0, 0.0);
    let places = gates.iter().map(|gate| (gate.position, gate.altitude_amsl_m));
    for (place, told_m) in places.chain([(runway.threshold, runway.elevation_amsl_m)]) {
        let (distance_m, course_deg) = distance_and_course(here, place);
        let takes_s = distance_m / s.wind().ground_speed_mps(profile.cruise_airspeed_mps, course_deg)?;
        let climb_mps = (told_m - altitude_m) / takes_s.max(1.0);
        time_s += takes_s;
        energy_j += takes_s * demanded_power_w(profile, profile.cruise_airspeed_mps, climb_mps, 1.0);
        (here, altitude_m) = (place, told_m);
    }
    Some((time_s, energy_j))
}

/// The altitude that clears the ground between here and a place, metres AMSL; `None`: no higher one than it has here or is told there, as
/// far as is known.
fn ground_to_clear_m(s: &Situation, (to, to_m): (LatLon, f64)) -> Option<f64> {
    let terrain = s.terrain?;
    let has_m = s.altitude_amsl_m.max(to_m);
    let high = along_high(terrain, s.position, to, |most_m, _| most_m + CLEARANCE_M <= has_m);
    let ground = high.filter_map(|(_, place)| terrain.elevation_m(place));
    ground.max_by(f64::total_cmp).map(|ground_m| ground_m + CLEARANCE_M)
}

#[cfg(test)]
mod tests {
    use super::super::ground::along;
    use super::super::tests::{HOME, Wall, runway, situation};
    use super::super::{choose, path};
    use super::*;
    use aircraft::Profile;
    use terrain::Terrain;
    use usal::contract::Air;

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
        let way = path(&landing, &s);
        let mut from = (s.position, altitude_amsl_m);
        let mut least_m = f64::INFINITY;
        for waypoint in &way {
            let (start, start_m) =
                std::mem::replace(&mut from, (waypoint.position, waypoint.altitude_amsl_m));
            for (share, place) in along(&wall, start, waypoint.position) {
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

    /// A ridge of 500 m that is as narrow as its elevations are close together.
    struct NarrowRidge(f64);

    impl terrain::Terrain for NarrowRidge {
        fn elevation_m(&self, at: LatLon) -> Option<f64> {
            let off_m = 111_000.0 * (at.lat_deg - self.0).abs();
            Some(300.0 + 200.0 * (1.0 - off_m / 30.0).max(0.0))
        }

        fn spacing_m(&self, _: LatLon) -> Option<f64> {
            Some(30.0)
        }
    }

    #[test]
    fn no_ridge_is_missed_between_two_places_that_are_looked_at() {
        let profile = Profile::default();
        for ridge_m in (0..20).map(|i| 4000.0 + 37.0 * f64::from(i)) {
            let ground = NarrowRidge(HOME.lat_deg + ridge_m / 111_000.0);
            let s = Situation { altitude_amsl_m: 430.0, terrain: Some(&ground), ..situation(&profile) };
            let it = runway("behind", 0.0, 12.0, 0.0, 1);
            let way = powered(&it, &SafeParameters::default(), &s).unwrap_or_else(|| panic!("{ridge_m}"));
            let over = told(&way, &s)
                .into_iter()
                .filter(|(place, _)| 111_000.0 * (place.lat_deg - ground.0).abs() < 60.0);
            let lowest_m = over.map(|(_, told_m)| told_m).fold(f64::INFINITY, f64::min);
            assert!((545.0..900.0).contains(&lowest_m), "ridge at {ridge_m} m: {lowest_m} m");
        }
    }

    /// Flat, but for a knoll beneath the aircraft and a ridge to the north of it. Metres AMSL.
    struct KnollAndRidge {
        knoll_m: f64,
        ridge: Wall,
    }

    impl terrain::Terrain for KnollAndRidge {
        fn elevation_m(&self, at: LatLon) -> Option<f64> {
            let on_knoll = HOME.distance_m(at) < 300.0;
            if on_knoll { Some(self.knoll_m) } else { self.ridge.elevation_m(at) }
        }
    }

    /// Told altitudes every 50 m of the way: how far from the aircraft, and metres AMSL.
    fn told(way: &Powered, s: &Situation) -> Vec<(LatLon, f64)> {
        let mut from = (s.position, s.altitude_amsl_m);
        let mut all = vec![];
        for gate in &way.gates {
            let ((start, start_m), end_m) = (from, gate.altitude_amsl_m);
            from = (gate.position, end_m);
            let (way_m, course_deg) = distance_and_course(start, gate.position);
            let steps = (way_m / 50.0).ceil().max(1.0);
            all.extend((0..=steps as u32).map(|i| {
                let share = f64::from(i) / steps;
                (start.destination(course_deg, share * way_m), start_m + share * (end_m - start_m))
            }));
        }
        all
    }

    fn winds(profile: &Profile) -> [Option<Air>; 3] {
        [0.0, 0.3, -0.3].map(|share| {
            Some(Air {
                airspeed_mps: profile.cruise_airspeed_mps,
                wind_east_mps: 0.1 * share * profile.cruise_airspeed_mps,
                wind_north_mps: share * profile.cruise_airspeed_mps,
                pressure_hpa: 960.0,
                temperature_c: 15.0,
            })
        })
    }

    /// Whoever begins low, or where the elevation model is too high, has the whole clearance once he has left there.
    #[test]
    fn what_it_lacks_where_it_is_it_does_not_lack_over_a_ridge_on_the_way() {
        for name in Profile::names() {
            let profile = Profile::by_name(name).unwrap();
            for air in winds(&profile) {
                for above_m in [-20.0, 5.0, 20.0, 60.0, 95.0] {
                    for (ridge_m, ridge_km) in [(510.0, 2.2), (560.0, 4.0), (800.0, 3.0), (480.0, 6.0)] {
                        let at_ridge = HOME.destination(0.0, 1000.0 * ridge_km);
                        let ground = KnollAndRidge { knoll_m: 480.0, ridge: Wall(at_ridge.lat_deg, ridge_m) };
                        let s = Situation {
                            altitude_amsl_m: 480.0 + above_m,
                            terrain: Some(&ground),
                            air,
                            ..situation(&profile)
                        };
                        let case =
                            format!("{name}, {air:?}, {above_m} m, ridge of {ridge_m} m at {ridge_km} km");
                        let way = powered(&runway("it", 0.0, 12.0, 0.0, 1), &SafeParameters::default(), &s)
                            .unwrap_or_else(|| panic!("{case}"));
                        let clears = |(place, told_m): &(LatLon, f64)| {
                            let over_ridge = ground.ridge.elevation_m(*place) == Some(ridge_m);
                            let far_off = HOME.distance_m(*place) > 600.0;
                            // what a slope gains between two samples of a cliff
                            let least_m = (0.5 * (told_m - 442.0)).clamp(15.0, 98.0) - 30.0;
                            !over_ridge || !far_off || told_m - ridge_m >= least_m
                        };
                        assert!(told(&way, &s).iter().all(clears), "{case}: {way:?}");
                    }
                }
            }
        }
    }

    /// At its ceiling above a runway at the sea: it circles as often as that takes, no steeper than it descends, and is fed.
    #[test]
    fn however_high_above_a_runway_it_is_there_is_a_way_down() {
        for name in Profile::names() {
            let profile = Profile::by_name(name).unwrap();
            for (air, km) in
                winds(&profile).into_iter().flat_map(|air| [1.0, 2.0, 5.0, 20.0].map(|km| (air, km)))
            {
                for altitude_amsl_m in [300.0, 1200.0, 2100.0, profile.ceiling_amsl_m] {
                    let it = SafeRunway { elevation_amsl_m: 0.0, ..runway("it", 70.0, km, 200.0, 1) };
                    let terrain = terrain::Flat(0.0);
                    let s =
                        Situation { altitude_amsl_m, air, terrain: Some(&terrain), ..situation(&profile) };
                    let case = format!("{name}, {air:?}, {km} km, {altitude_amsl_m} m");
                    let way =
                        powered(&it, &SafeParameters::default(), &s).unwrap_or_else(|| panic!("{case}"));
                    assert!(way.gates.len() <= 200, "{case}: {}", way.gates.len());
                    for pair in way.gates.windows(2).filter(|pair| pair[1].on_arc || !pair[0].on_arc) {
                        let (way_m, course_deg) = distance_and_course(pair[0].position, pair[1].position);
                        let mps = s.wind().ground_speed_mps(profile.cruise_airspeed_mps, course_deg).unwrap();
                        let down_mps =
                            (pair[0].altitude_amsl_m - pair[1].altitude_amsl_m) / (way_m / mps).max(1.0);
                        assert!(down_mps <= 1.45 * profile.max_descent_mps, "{case}: {down_mps} m/s");
                    }
                    assert!(choose(&[it], &SafeParameters::default(), &s).is_some(), "{case}");
                }
            }
        }
    }

    /// A slope on the one side of the aircraft, or of where the approach begins.
    #[test]
    fn it_circles_on_the_side_where_there_is_room() {
        let profile = Profile::default();
        for side in [1.0, -1.0] {
            struct Slope(f64);
            impl terrain::Terrain for Slope {
                fn elevation_m(&self, at: LatLon) -> Option<f64> {
                    let aside_m = self.0 * (at.lon_deg - HOME.lon_deg) * 89_000.0;
                    Some(if aside_m > 150.0 { 900.0 } else { 300.0 })
                }
            }
            let slope = Slope(side);
            let s = Situation { altitude_amsl_m: 1400.0, terrain: Some(&slope), ..situation(&profile) };
            let way = powered(&runway("it", 0.0, 3.0, 0.0, 1), &SafeParameters::default(), &s);
            let way = way.unwrap_or_else(|| panic!("{side}"));
            assert!(way.gates.iter().any(|gate| gate.on_arc), "{way:?}");
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
