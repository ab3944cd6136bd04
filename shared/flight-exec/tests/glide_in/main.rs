//! The choice of a way in without an engine, held against a search that flies each of many simple ways ([`search`]): emergency plans and
//! Safe mode make it by the same functions.
#![cfg(test)]

mod search;

use aircraft::glide::{GlideStart, reserve_m};
use aircraft::glide_in::{End, FINAL_M, WayIn};
use aircraft::{Profile, Strip, Wind};
use flight_exec::clears_way_in;
use geometry::{LatLon, LocalFrame, Vec2};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use search::{Begin, Flown, Glider, Way};
use std::f64::consts::PI;
use terrain::Terrain;

const THRESHOLD: LatLon = LatLon::new(36.49, -84.27);
const LENGTH_M: f64 = 600.0;
/// Elevation of the runway and of the flat ground, metres AMSL.
const GROUND_M: f64 = 320.0;
/// Finals that are tried, metres.
const FINALS_M: [f64; 8] = [150.0, 210.0, 280.0, 350.0, 450.0, 580.0, 700.0, 1000.0];
/// With so much more than the reserve a way is clearly one, metres.
const CLEARLY_M: f64 = 30.0;
/// A way that is clearly one is so high above the ground everywhere that it is not near its ends, metres.
const OVER_GROUND_M: f64 = 60.0;
/// Lower than this nobody turns by more than 30 degrees, metres.
const SANE_M: f64 = 20.0;

/// Nearer than so many radii to a place the turn to there matters.
const TURNS_FIRST_RADII: f64 = 4.0;

/// A round hill, flat at its top.
#[derive(Debug, Clone, Copy)]
struct Hill {
    at: Vec2,
    radius_m: f64,
    height_m: f64,
}

impl Hill {
    fn height_m(&self, place: Vec2) -> f64 {
        let share = 1.0 - (place - self.at).length() / self.radius_m;
        self.height_m * (2.0 * share).clamp(0.0, 1.0)
    }
}

struct Ground(Option<Hill>, LocalFrame);

impl Terrain for Ground {
    fn elevation_m(&self, place: LatLon) -> Option<f64> {
        Some(GROUND_M + self.0.map_or(0.0, |hill| hill.height_m(self.1.to_local(place))))
    }
}

#[derive(Debug, Clone)]
struct Case {
    profile: &'static str,
    /// From direction, degrees, and speed as a share of the airspeed, no more than 12 m/s.
    wind: (f64, f64),
    runway_deg: f64,
    /// Bearing from the threshold, degrees, and distance, metres.
    place: (f64, f64),
    course_deg: f64,
    /// In heights that a glide straight to the threshold takes.
    height: f64,
    hill: Option<(f64, f64, f64, f64)>,
}

fn case() -> impl Strategy<Value = Case> {
    let profiles: Vec<_> = Profile::names();
    let deg = || 0.0..360.0;
    let hill = (deg(), 300.0..2500.0, 200.0..700.0, 30.0..250.0);
    (
        proptest::sample::select(profiles),
        (deg(), 0.0..0.5),
        deg(),
        (deg(), prop_oneof![50.0..3500.0, 50.0..1200.0]),
        deg(),
        0.8..4.0,
        proptest::option::of(hill),
    )
        .prop_map(|(profile, wind, runway_deg, place, course_deg, height, hill)| Case {
            profile,
            wind,
            runway_deg,
            place,
            course_deg,
            height,
            hill,
        })
}

/// A way that was flown, and how.
type Tried = (Way, Flown);

struct World {
    profile: Profile,
    wind: Wind,
    glider: Glider,
    ground: Ground,
    ends: Vec<End>,
    begin: Begin,
}

impl World {
    fn new(case: &Case) -> Self {
        let profile = Profile::by_name(case.profile).unwrap();
        let (from_deg, share) = case.wind;
        let wind = Wind::from_direction(from_deg, (share * profile.cruise_airspeed_mps).min(12.0));
        let glider = Glider::new(&profile, profile.planning_bank_deg, wind.vector());
        let place =
            |(bearing_deg, metres): (f64, f64)| Vec2::from_bearing_rad(f64::to_radians(bearing_deg)) * metres;
        let hill = case.hill.map(|(bearing_deg, metres, radius_m, height_m)| Hill {
            at: place((bearing_deg, metres + radius_m)),
            radius_m,
            height_m,
        });
        let strip = Strip { threshold: THRESHOLD, heading_deg: case.runway_deg, length_m: LENGTH_M };
        let named = End { strip, elevation_amsl_m: GROUND_M };
        let other = named.other(&profile, wind, [], |_| Some(GROUND_M));
        Self {
            glider,
            ground: Ground(hill, LocalFrame::new(THRESHOLD)),
            ends: [named].into_iter().chain(other).collect(),
            begin: Begin {
                at: place(case.place),
                height_m: 20.0 + case.height * case.place.1 / profile.glide_ratio,
                course_rad: case.course_deg.to_radians(),
            },
            profile,
            wind,
        }
    }

    fn way(&self, end: &End, final_m: Option<f64>, in_line: bool) -> Way {
        let threshold = self.ground.1.to_local(end.strip.threshold);
        Way { threshold, heading_rad: end.strip.heading_deg.to_radians(), final_m, in_line }
    }

    /// The ways of the search that are clearly some.
    fn clearly(&self) -> Vec<Tried> {
        let ways = self.ends.iter().flat_map(|end| {
            let finals = FINALS_M.into_iter().map(|m| self.way(end, Some(m), true));
            finals.chain([self.way(end, None, true), self.way(end, None, false)])
        });
        let flown = ways.filter_map(|way| Some((way, self.worst_of(&way)?)));
        let is_clearly = |(way, flown): &Tried| {
            flown.clear_m > 0.0 && spare_m(flown) >= CLEARLY_M && !self.is_too_steep(way, flown)
        };
        flown.filter(is_clearly).collect()
    }

    /// Straight in it comes to the threshold with more height than the steepest descent loses.
    fn is_too_steep(&self, way: &Way, flown: &Flown) -> bool {
        let steeper = self.profile.max_descent_mps / self.glider.sink_mps - 1.0;
        way.in_line && way.final_m.is_none() && flown.height_m > steeper * flown.taken_m
    }

    /// With the profile's bank, and turning sooner or later: what works in one moment alone is not clearly a way.
    fn worst_of(&self, way: &Way) -> Option<Flown> {
        let flown = [0.7, 1.0, 1.3].map(|lead| self.fly(&Glider { lead, ..self.glider }, way));
        let [a, b, c] = flown;
        [a?, b?, c?].into_iter().min_by(|a, b| a.height_m.total_cmp(&b.height_m))
    }

    /// As well as an autopilot may fly it: with more bank than is planned with, and turning sooner or later.
    fn best_of(&self, way: &Way) -> Option<Flown> {
        let Profile { planning_bank_deg, max_bank_deg, .. } = self.profile;
        let gliders = [planning_bank_deg, 0.5 * (planning_bank_deg + max_bank_deg), max_bank_deg]
            .into_iter()
            .flat_map(|bank_deg| [0.5, 1.0, 1.5].map(|lead| (bank_deg, lead)))
            .map(|(bank_deg, lead)| Glider {
                lead,
                ..Glider::new(&self.profile, bank_deg, self.wind.vector())
            });
        let flown = gliders.filter_map(|glider| self.fly(&glider, way));
        flown.max_by(|a, b| a.height_m.total_cmp(&b.height_m))
    }

    fn fly(&self, glider: &Glider, way: &Way) -> Option<Flown> {
        let ends = [self.begin.at, way.threshold];
        glider.fly(self.begin, way, |place| {
            let near_m = ends.map(|end| (place - end).length()).into_iter().fold(f64::INFINITY, f64::min);
            let hill_m = self.ground.0.map_or(0.0, |hill| hill.height_m(place));
            if hill_m > 0.0 { hill_m + OVER_GROUND_M.min(0.1 * near_m) } else { f64::NEG_INFINITY }
        })
    }

    /// Height that half a circle takes, metres: the choice counts each turn as a way of its own, and gives away no more than that.
    fn half_circle_m(&self) -> f64 {
        let load = 1.0 / self.profile.planning_bank_deg.to_radians().cos();
        PI * self.glider.radius_m / self.glider.airspeed_mps * self.glider.sink_mps * load
    }

    /// It is so near to where the way leads that the turn to there decides whether it gets there: the choice takes that to be flown on the
    /// spot.
    fn turns_first(&self, chosen: &WayIn) -> bool {
        let end = self.ends[chosen.end];
        let place = chosen.final_m.map_or(end.strip.threshold, |metres| end.final_begins_at(metres));
        (self.ground.1.to_local(place) - self.begin.at).length() < TURNS_FIRST_RADII * self.glider.radius_m
    }

    fn chosen(&self) -> Option<WayIn> {
        let from = GlideStart {
            position: self.ground.1.to_geo(self.begin.at),
            altitude_amsl_m: GROUND_M + self.begin.height_m,
            course_deg: self.begin.course_rad.to_degrees(),
        };
        let ways = WayIn::all((&self.profile, self.wind), from, &self.ends, FINAL_M);
        WayIn::best(&ways, |way| clears_way_in(&self.ground, way, GROUND_M)).cloned()
    }
}

fn spare_m(flown: &Flown) -> f64 {
    flown.height_m - reserve_m(flown.taken_m)
}

/// What is wrong with the choice.
fn fault(case: &Case) -> Option<String> {
    let world = World::new(case);
    let clearly = world.clearly();
    let best = clearly.iter().max_by(|(_, a), (_, b)| spare_m(a).total_cmp(&spare_m(b)))?;
    let Some(chosen) = world.chosen() else { return Some(format!("nothing is reached, but {best:?}")) };
    let in_line = || clearly.iter().filter(|(way, _)| way.in_line);
    if !chosen.is_in_line() {
        let least_m = CLEARLY_M + world.half_circle_m();
        let other = in_line().find(|(_, flown)| spare_m(flown) >= least_m)?;
        return Some(format!("across {}, but {other:?}", told(&chosen)));
    }
    if world.turns_first(&chosen) {
        return None;
    }
    let own = world.best_of(&world.way(&world.ends[chosen.end], chosen.final_m, true));
    let Some(own) = own else {
        // it comes down beside the runway's line, which is no worse than across the runway
        let other = in_line().next()?;
        return Some(format!("{} does not line up, but {other:?}", told(&chosen)));
    };
    if own.height_m < 0.0 {
        return Some(format!("{} does not get there: {own:?}, but {best:?}", told(&chosen)));
    }
    let other = in_line().find(|(_, flown)| flown.turns_at_m > SANE_M)?;
    (own.turns_at_m < SANE_M).then(|| format!("{} turns low: {own:?}, but {other:?}", told(&chosen)))
}

fn told(way: &WayIn) -> String {
    format!(
        "end {} by {:?}, {:.0} m high, spare {:.0} m",
        way.end,
        way.final_m,
        way.height_m(),
        way.spare_m()
    )
}

fn config() -> ProptestConfig {
    let seed = std::env::var("LEGWORK_SEED").map_or(1, |seed| seed.parse().expect("a number"));
    println!("LEGWORK_SEED={seed}");
    ProptestConfig {
        cases: if cfg!(debug_assertions) { 500 } else { 5000 },
        rng_seed: RngSeed::Fixed(seed),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config())]
    #[test]
    fn a_way_in_that_is_clearly_there_is_found_and_none_is_taken_that_does_not_get_there(case in case()) {
        let fault = fault(&case);
        prop_assert!(fault.is_none(), "{}", fault.unwrap_or_default());
    }
}
