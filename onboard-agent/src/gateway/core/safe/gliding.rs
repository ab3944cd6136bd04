//! A glide to a landing: where it leads, and the altitude that it has there. What is checked here is what is fed.
//!
//! The way in is chosen as an emergency plan's ([`WayIn::best`]). The autopilot flies straight from altitude to altitude. So it is told at
//! each place the altitude that the glide has there: led down sooner it would lack that height before the runway. What the rest of the way
//! can't lose is lost in circles where the final approach begins, and what is left of it on the way there. With more height than that, and
//! no room for a circle, it touches down farther along the runway.
//!
//! By which ways a runway is reached at all is asked as the executor asks it ([`clears_way_in`]), which leaves its glide to Safe mode for
//! the sake of such a way: none of them is dropped here. One in which the ground leaves no room to lose height is flown as it glides.

use super::Situation;
use super::gates::{Circles, Gate, is_over_ground};
use super::way::TOUCHDOWN;
use aircraft::glide::{GlidePoint, GlideStart, Laps, reserve_m};
use aircraft::glide_in::{End, FINAL_M, WayIn};
use flight_exec::{clears_ground, clears_way_in};
use geometry::LatLon;
use geometry::geodesy::normalise_180;

/// Least height above the ground on the way, metres.
pub(super) const SPARE_M: f64 = 15.0;
/// Share of the steepest descent that is counted on.
const STEEP: f64 = 0.7;
/// It may be landed on from these places on, as shares of a runway's length, if there is room to stop.
const FROM: [f64; 3] = [0.0, 0.25, 0.5];

/// A glide that comes to a runway, above the ground on the way.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Glide {
    /// From where the final approach begins, with its circles; none: straight to the landing.
    pub gates: Vec<Gate>,
    /// What is landed on: the runway from some place on.
    pub end: End,
    /// Length of the final approach, metres; `None`: straight from where it is.
    pub final_m: Option<f64>,
    /// In line with the runway at last.
    pub is_in_line: bool,
    /// Time to the threshold without circles, seconds: these take away nothing but height that is too much.
    pub time_s: f64,
    /// Above the whole reserve there, metres.
    pub spare_m: f64,
    /// It comes to the threshold with more height than it can lose, or than the ground leaves it room to lose.
    pub is_too_high: bool,
}

/// The best glides from where the aircraft is to an end of a runway, if it comes there: in line with it, and straight across it.
pub(super) fn glides_in(end: End, s: &Situation) -> [Option<Glide>; 2] {
    let ends = from_there_on(end, s);
    let start =
        GlideStart { position: s.position, altitude_amsl_m: s.altitude_amsl_m, course_deg: s.track_deg };
    let ways = WayIn::all((s.profile, s.wind()), start, &ends, FINAL_M);
    let (in_line, across): (Vec<_>, Vec<_>) = ways.into_iter().partition(WayIn::is_in_line);
    [in_line, across].map(|ways| best(&ways, &ends, s))
}

fn best(ways: &[WayIn], ends: &[End], s: &Situation) -> Option<Glide> {
    let glide = |way: &WayIn| Glide::of(way, *ends.get(way.end)?, s);
    let best = WayIn::best(ways, |way| glide(way).is_some_and(|glide| !glide.is_too_high));
    glide(best.or_else(|| WayIn::best(ways, |way| glide(way).is_some()))?)
}

/// The whole runway, and what is left of it from farther on.
fn from_there_on(end: End, s: &Situation) -> Vec<End> {
    let from = |share: f64| {
        let strip = end.strip.from(share * end.strip.length_m);
        let has_room = share == 0.0 || (1.0 - TOUCHDOWN) * strip.length_m >= s.profile.min_runway_m;
        has_room.then_some(End { strip, ..end })
    };
    FROM.into_iter().filter_map(from).collect()
}

impl Glide {
    /// `None`: it leads through the ground, or does not get there.
    fn of(way: &WayIn, end: End, s: &Situation) -> Option<Self> {
        let (over, threshold) = match (way.final_m, way.points.as_slice()) {
            (None, [here, .., threshold]) => (here, threshold),
            (Some(_), [.., gate, threshold]) => (gate, threshold),
            _ => return None,
        };
        if s.terrain.is_some_and(|terrain| !clears_way_in(terrain, way, end.elevation_amsl_m)) {
            return None;
        }
        let (place, course_deg) = match way.final_m {
            Some(metres) => (end.final_begins_at(metres), end.strip.heading_deg),
            None => (s.position, s.track_deg),
        };
        let right = normalise_180(course_deg - s.position.bearing_deg(place)) >= 0.0;
        // it is there
        let first = usize::from(way.final_m.is_none());
        let gates = |told: &Told, right: bool| told.circled(place, course_deg, right).split_off(first);
        let told = Told::of(end.elevation_amsl_m, s, [over, threshold]);
        let is_clear = |gates: &Vec<Gate>| {
            is_over_ground(gates, s, |_| SPARE_M)
                && told.clears_final(gates.last(), [over, threshold], end, s)
        };
        let circled = [right, !right].into_iter().map(|right| gates(&told, right)).find(is_clear);
        let is_too_high = told.is_too_high || circled.is_none();
        let gates = circled.unwrap_or_else(|| gates(&told.as_it_glides(), right));
        Some(Self {
            gates,
            end,
            final_m: way.final_m,
            is_in_line: way.is_in_line(),
            time_s: threshold.time_s,
            spare_m: way.spare_m(),
            is_too_high,
        })
    }
}

/// What it is told where the final approach begins.
struct Told {
    /// These circles first.
    circles: [Laps; 2],
    /// What it has there before them, metres AMSL.
    has_m: f64,
    /// And after them.
    begins_m: f64,
    /// It comes to the threshold with more height than it can lose.
    is_too_high: bool,
}

impl Told {
    /// From there on it keeps the reserve of the way.
    fn of(elevation_m: f64, s: &Situation, [over, threshold]: [&GlidePoint; 2]) -> Self {
        let has_m = over.altitude_amsl_m;
        let takes_m = over.altitude_amsl_m - threshold.altitude_amsl_m;
        let needed_m = elevation_m + takes_m + reserve_m(takes_m);
        let steep_mps = STEEP * s.profile.max_descent_mps;
        let most_m = needed_m.max(elevation_m + steep_mps * (threshold.time_s - over.time_s));
        let circles = Laps::losing((s.profile, s.wind()), steep_mps, (has_m - most_m, has_m - needed_m));
        let height_m: f64 = circles.iter().map(Laps::height_m).sum();
        // the smallest circles are flown the least exactly: another way comes before one that needs them
        let [wide, _] = circles;
        let lowest_m = s.altitude_amsl_m - s.profile.max_descent_mps * (threshold.time_s + wide.time_s());
        Self { circles, has_m, begins_m: (has_m - height_m).min(most_m), is_too_high: lowest_m > elevation_m }
    }

    /// What the glide has there, and nothing of it is lost before.
    fn as_it_glides(&self) -> Self {
        Self { circles: self.circles.map(|laps| Laps { count: 0, ..laps }), begins_m: self.has_m, ..*self }
    }

    /// From the last gate, or from where it is, it is led straight down to the threshold, however high it is: above the ground.
    fn clears_final(
        &self,
        last: Option<&Gate>,
        [over, threshold]: [&GlidePoint; 2],
        end: End,
        s: &Situation,
    ) -> bool {
        let altitude_amsl_m = last.map_or(over.altitude_amsl_m, |gate| gate.altitude_amsl_m);
        let from = GlidePoint { altitude_amsl_m, ..*over };
        let down = GlidePoint { altitude_amsl_m: end.elevation_amsl_m, ..*threshold };
        s.terrain.is_none_or(|terrain| clears_ground(terrain, &[from, down]))
    }

    /// By circles of each size, each taking its share of the height; without any, one place.
    fn circled(&self, at: LatLon, course_deg: f64, right: bool) -> Vec<Gate> {
        let all_m: f64 = self.circles.iter().map(Laps::height_m).sum();
        let mut gates = vec![Gate {
            position: at,
            altitude_amsl_m: if all_m > 0.0 { self.has_m } else { self.begins_m },
            on_arc: all_m > 0.0,
        }];
        let mut from_m = self.has_m;
        for laps in self.circles.iter().filter(|laps| laps.count > 0) {
            let to_m = from_m - (self.has_m - self.begins_m) * laps.height_m() / all_m;
            let circles = Circles { count: laps.count, radius_m: laps.circle.radius_m, right };
            gates.extend(circles.gates(at, course_deg, (from_m, to_m)).into_iter().skip(1));
            from_m = to_m;
        }
        gates
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{HOME, Wall, runway, situation};
    use super::super::{choose, path};
    use super::*;
    use aircraft::autopilot::{Action as Does, Guidance, Target};
    use aircraft::glide::Circle;
    use aircraft::{Aircraft, Profile, Strip, Wind};
    use terrain::Terrain;
    use usal::contract::{Action, Air, SafeParameters, Waypoint};

    const LENGTH_M: f64 = 600.0;

    fn target(w: &Waypoint) -> Target {
        let action = match w.action {
            Action::Land { heading_deg } => Does::Land { heading_deg },
            _ => Does::Fly,
        };
        let Waypoint { position, altitude_amsl_m, airspeed_mps, fly_over, .. } = *w;
        Target { position, altitude_amsl_m, airspeed_mps, action, fly_over, acceptance_m: None }
    }

    /// Flies a way with a dead engine; where it comes down.
    fn comes_down(way: &[Waypoint], s: &Situation) -> LatLon {
        let mut aircraft = Aircraft::in_flight(s.profile.clone(), s.position, s.altitude_amsl_m, s.track_deg);
        aircraft.set_engine_healthy(false);
        let mut guidance = Guidance::new(s.profile.clone());
        let mut targets = way.iter().map(target).peekable();
        guidance.direct(aircraft.state(), targets.next().unwrap());
        for _ in 0..20_000 {
            let guided = guidance.step(aircraft.state(), targets.peek());
            if let Some(next) = guided.reached.then(|| targets.next()).flatten() {
                guidance.proceed(aircraft.state(), next);
            }
            aircraft.step(0.2, &guided.demand, &s.wind());
            if aircraft.state().on_ground {
                return aircraft.state().position;
            }
            assert!(aircraft.state().altitude_amsl_m > 322.0, "{:?} it is in the ground", guided);
        }
        panic!("it never comes down")
    }

    fn air(wind: Wind) -> Air {
        let Wind { east_mps: wind_east_mps, north_mps: wind_north_mps } = wind;
        Air { airspeed_mps: 25.0, wind_east_mps, wind_north_mps, pressure_hpa: 970.0, temperature_c: 20.0 }
    }

    /// Bearing and distance of the runway, its heading, height above it.
    const SITUATIONS: [(f64, f64, f64, f64); 7] = [
        (0.0, 8.0, 0.0, 1200.0),
        (0.0, 3.0, 0.0, 330.0),
        (90.0, 3.0, 0.0, 420.0),
        (180.0, 4.0, 300.0, 900.0),
        (40.0, 1.0, 220.0, 250.0),
        (300.0, 0.3, 100.0, 1500.0),
        (10.0, 5.0, 90.0, 700.0),
    ];

    #[test]
    fn every_runway_that_is_chosen_for_a_glide_is_landed_on() {
        for name in Profile::names() {
            let profile = Profile::by_name(name).unwrap();
            let mut landed = 0;
            for (bearing_deg, km, heading_deg, height_m) in SITUATIONS {
                let runways = [runway("it", bearing_deg, km, heading_deg, 1)];
                let wind = Wind::from_direction(heading_deg + 30.0, 0.15 * profile.cruise_airspeed_mps);
                let s = Situation {
                    glides: true,
                    altitude_amsl_m: 322.0 + height_m,
                    air: Some(air(wind)),
                    ..situation(&profile)
                };
                let Some(landing) = choose(&runways, &SafeParameters::default(), &s) else { continue };
                let down = comes_down(&path(&landing, &s), &s);
                let threshold = landing.runway.threshold;
                let off_deg = threshold.bearing_deg(down) - landing.runway.heading_deg;
                let (distance_m, off_rad) = (threshold.distance_m(down), off_deg.to_radians());
                let (along_m, aside_m) = (distance_m * off_rad.cos(), distance_m * off_rad.sin());
                let case = format!("{name}, {bearing_deg}° {km} km, {height_m} m: {landing}");
                assert!((0.0..LENGTH_M).contains(&along_m), "{case}: {along_m:.0} m behind the threshold");
                assert!(aside_m.abs() < 40.0, "{case}: {aside_m:.0} m beside it");
                landed += 1;
            }
            assert!(landed >= 4, "{name}: {landed}");
        }
    }

    #[test]
    fn it_is_told_what_the_glide_has_and_loses_the_rest_in_circles() {
        let profile = Profile::default();
        let s = Situation { glides: true, altitude_amsl_m: 1522.0, ..situation(&profile) };
        let runway = runway("it", 0.0, 4.0, 0.0, 1);
        let strip = Strip { threshold: runway.threshold, heading_deg: 0.0, length_m: LENGTH_M };
        let [glide, _] = glides_in(End { strip, elevation_amsl_m: 322.0 }, &s);
        let glide = glide.unwrap();
        let has_m = 1522.0 - s.position.distance_m(glide.gates[0].position) / profile.glide_ratio;
        assert!((glide.gates[0].altitude_amsl_m - has_m).abs() < 5.0, "{glide:?}");
        assert!(glide.gates.iter().filter(|gate| gate.on_arc).count() > 16, "{glide:?}");
        let last = glide.gates.last().unwrap();
        let needed_m = last.position.distance_m(runway.threshold) / profile.glide_ratio;
        assert!((needed_m..1.5 * needed_m).contains(&(last.altitude_amsl_m - 322.0)), "{glide:?}");
        let turned = glide.gates.windows(2).all(|pair| pair[0].altitude_amsl_m > pair[1].altitude_amsl_m);
        assert!(turned, "nothing is level: {glide:?}");
    }

    /// As in an emergency plan: what a wide circle would take too much of is lost in the smallest one.
    #[test]
    fn what_is_too_little_for_a_wide_circle_is_lost_in_a_small_one() {
        let profile = Profile::default();
        let runway = runway("it", 0.0, 2.0, 0.0, 1);
        let strip = Strip { threshold: runway.threshold, heading_deg: 0.0, length_m: LENGTH_M };
        let radii_m = |height_m: f64| -> Vec<f64> {
            let s = Situation { glides: true, altitude_amsl_m: 322.0 + height_m, ..situation(&profile) };
            let [glide, _] = glides_in(End { strip, elevation_amsl_m: 322.0 }, &s);
            let gates = glide.map_or_else(Vec::new, |glide| glide.gates);
            let across = gates.windows(5).filter(|gates| gates.iter().all(|gate| gate.on_arc));
            across.map(|gates| 0.5 * gates[0].position.distance_m(gates[4].position)).collect()
        };
        let all: Vec<f64> = (10..120).flat_map(|tens| radii_m(10.0 * f64::from(tens))).collect();
        for circle in [Circle::of(&profile, Wind::CALM), Circle::smallest(&profile, Wind::CALM)] {
            assert!(all.iter().any(|radius_m| (radius_m - circle.radius_m).abs() < 1.0), "{circle:?}");
        }
    }

    /// Where the executor says that a runway is reached, and leaves its glide to Safe mode, Safe mode lands on it: also over ground that
    /// leaves no room for circles.
    #[test]
    fn safe_mode_takes_each_runway_that_the_executor_calls_reached() {
        let profile = Profile::default();
        let it = runway("it", 0.0, 1.5, 60.0, 1);
        let strip = Strip { threshold: it.threshold, heading_deg: 60.0, length_m: LENGTH_M };
        let named = End { strip, elevation_amsl_m: it.elevation_amsl_m };
        let mut found = [0, 0];
        for wall in [330.0, 345.0, 380.0].map(|m| Wall(HOME.lat_deg + 0.01, m)) {
            let other = named.other(&profile, Wind::CALM, [], |place| wall.elevation_m(place));
            let ends: Vec<End> = [named].into_iter().chain(other).collect();
            for (height_m, track_deg) in
                (1..60).flat_map(|i| [0.0, 60.0, 140.0].map(|deg| (6.0 * f64::from(i), deg)))
            {
                let s = Situation {
                    glides: true,
                    altitude_amsl_m: 322.0 + height_m,
                    track_deg,
                    terrain: Some(&wall),
                    ..situation(&profile)
                };
                let from = GlideStart {
                    position: s.position,
                    altitude_amsl_m: s.altitude_amsl_m,
                    course_deg: track_deg,
                };
                let ways = WayIn::all((&profile, Wind::CALM), from, &ends, FINAL_M);
                let reached = WayIn::best(&ways, |way| clears_way_in(&wall, way, 322.0)).is_some();
                let chosen = choose(std::slice::from_ref(&it), &SafeParameters::default(), &s);
                assert!(chosen.is_some() || !reached, "{} m, {height_m} m, {track_deg}°", wall.1);
                found[usize::from(reached)] += 1;
            }
        }
        assert!(found.into_iter().all(|n| n > 30), "{found:?}");
    }
}
