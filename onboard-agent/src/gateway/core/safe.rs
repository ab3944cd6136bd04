//! Safe mode's own flight: which runway, and the waypoints to it. Needs no other service.

use aircraft::Profile;
use geometry::LatLon;
use terrain::Terrain;
use usal::contract::{Action, Air, Id, SafeParameters, SafeRunway, Token, Waypoint};

/// Slope of the final approach, height over distance (about 4.6 degrees).
const GLIDE_SLOPE: f64 = 0.08;
/// Straight and level before the final descent, metres.
const INITIAL_M: f64 = 700.0;
/// Height kept above the ground on the way, metres.
const CLEARANCE_M: f64 = 100.0;
/// Spacing at which the ground on the way is sampled, metres.
const GROUND_STEP_M: f64 = 200.0;
/// Share of the energy left that may be planned with.
const USABLE: f64 = 0.8;
/// A runway of the next lower priority has to save this share of the way.
const PRIORITY_PENALTY: f64 = 0.25;
/// A tailwind of 1 m/s on landing counts like so many seconds of flight.
const TAILWIND_PENALTY_S: f64 = 20.0;
/// Touch-down point behind the threshold, as a share of the length.
const TOUCHDOWN: f64 = 0.15;

/// Where the aircraft is, for the choice.
pub struct Situation<'a> {
    /// Position.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Wind (blows to), if known.
    pub air: Option<Air>,
    /// Share of the energy left.
    pub battery: f64,
    /// The aircraft.
    pub profile: &'a Profile,
    /// The ground, if known.
    pub terrain: Option<&'a dyn Terrain>,
}

impl Situation<'_> {
    /// Wind along a direction, m/s (tailwind positive).
    fn tailwind_mps(&self, direction_deg: f64) -> f64 {
        let (sin, cos) = direction_deg.to_radians().sin_cos();
        self.air.map_or(0.0, |a| a.wind_east_mps * sin + a.wind_north_mps * cos)
    }

    fn flight_time_s(&self, to: LatLon) -> f64 {
        let way = self.position.inverse(to);
        let speed = self.profile.cruise_airspeed_mps + self.tailwind_mps(way.bearing_start_deg);
        way.distance_m / speed.max(1.0)
    }

    fn endurance_s(&self) -> f64 {
        USABLE * self.battery * self.profile.energy_j / self.profile.cruise_power_w.max(1.0)
    }
}

/// The best runway: of those long enough and within reach of the energy, the one with the least
/// flight time in this wind, made worse by lower priority and by a tailwind on landing.
pub fn choose<'r>(runways: &'r [SafeRunway], s: &Situation) -> Option<&'r SafeRunway> {
    let cost = |r: &SafeRunway| {
        let time_s = s.flight_time_s(r.threshold);
        let priority = 1.0 + PRIORITY_PENALTY * f64::from(r.priority.saturating_sub(1));
        time_s * priority + TAILWIND_PENALTY_S * s.tailwind_mps(r.heading_deg).max(0.0)
    };
    runways
        .iter()
        .filter(|r| is_usable(r, s.profile) && s.flight_time_s(r.threshold) < s.endurance_s())
        .min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

/// Fit to be stored: numbers in range, long enough for the aircraft.
pub fn is_usable(runway: &SafeRunway, profile: &Profile) -> bool {
    let numbers = [runway.elevation_amsl_m, runway.heading_deg, runway.length_m];
    runway.threshold.is_navigable()
        && numbers.iter().all(|n| n.is_finite())
        && runway.length_m >= profile.min_runway_m
        && runway.elevation_amsl_m < profile.ceiling_amsl_m
}

/// The way to a runway: over the ground on the way, down to the initial approach point, along the
/// extended centre line, and the landing. Its tokens are 0: they are not reported.
pub fn path(runway: &SafeRunway, safe: &SafeParameters, s: &Situation) -> Vec<Waypoint> {
    let height_m = safe.return_height_m.clamp(40.0, 500.0);
    let back_deg = runway.heading_deg + 180.0;
    let final_point = runway.threshold.destination(back_deg, height_m / GLIDE_SLOPE);
    let initial = final_point.destination(back_deg, INITIAL_M);
    let approach_m = runway.elevation_amsl_m + height_m;
    let mut way = transit(initial, approach_m, s);
    way.push(waypoint(initial, approach_m, s.profile.cruise_airspeed_mps, Action::Fly));
    way.push(waypoint(final_point, approach_m, approach_speed(s.profile), Action::Fly));
    let touchdown = runway.threshold.destination(runway.heading_deg, TOUCHDOWN * runway.length_m);
    let landing = Action::Land { heading_deg: runway.heading_deg };
    way.push(waypoint(touchdown, runway.elevation_amsl_m, approach_speed(s.profile), landing));
    way
}

/// Where the ground on the way (or our own height) is above the approach height: stay high until
/// the descent has to begin.
fn transit(to: LatLon, approach_m: f64, s: &Situation) -> Vec<Waypoint> {
    let way = s.position.inverse(to);
    let needed_m = highest_ground(s, &way).map_or(approach_m, |g| g + CLEARANCE_M);
    let transit_m =
        s.altitude_amsl_m.max(needed_m).clamp(approach_m, s.profile.ceiling_amsl_m.max(approach_m));
    let slope = 0.7 * s.profile.max_descent_mps / s.profile.cruise_airspeed_mps.max(1.0);
    let descent_m = (transit_m - approach_m) / slope;
    if transit_m - approach_m < 10.0 || descent_m + INITIAL_M > way.distance_m {
        return vec![];
    }
    let top = s.position.destination(way.bearing_start_deg, way.distance_m - descent_m);
    vec![waypoint(top, transit_m, s.profile.cruise_airspeed_mps, Action::Fly)]
}

fn highest_ground(s: &Situation, way: &geometry::geodesy::Inverse) -> Option<f64> {
    let terrain = s.terrain?;
    let steps = (way.distance_m / GROUND_STEP_M).clamp(1.0, 1000.0) as u32;
    (0..=steps)
        .map(|i| {
            s.position.destination(way.bearing_start_deg, way.distance_m * f64::from(i) / f64::from(steps))
        })
        .filter_map(|p| terrain.elevation_m(p))
        .max_by(f64::total_cmp)
}

fn approach_speed(profile: &Profile) -> f64 {
    (1.3 * profile.min_airspeed_mps).min(profile.cruise_airspeed_mps)
}

fn waypoint(position: LatLon, altitude_amsl_m: f64, airspeed_mps: f64, action: Action) -> Waypoint {
    let end_of_plan = matches!(action, Action::Land { .. });
    Waypoint {
        token: Token(0),
        position,
        altitude_amsl_m,
        airspeed_mps,
        action,
        fly_over: false,
        on_arc: false,
        leg: Id::from("safe-return"),
        end_of_plan,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOME: LatLon = LatLon::new(36.4905, -84.2710);

    fn runway(id: &str, bearing_deg: f64, km: f64, heading_deg: f64, priority: u32) -> SafeRunway {
        let threshold = HOME.destination(bearing_deg, km * 1000.0);
        SafeRunway {
            id: id.into(),
            threshold,
            elevation_amsl_m: 322.0,
            heading_deg,
            length_m: 600.0,
            priority,
        }
    }

    fn choice(runways: &[SafeRunway], battery: f64, wind_east_mps: f64) -> Option<String> {
        let air = Air {
            airspeed_mps: 25.0,
            wind_east_mps,
            wind_north_mps: 0.0,
            pressure_hpa: 970.0,
            temperature_c: 20.0,
        };
        let profile = Profile::default();
        let s = Situation {
            position: HOME,
            altitude_amsl_m: 600.0,
            air: Some(air),
            battery,
            profile: &profile,
            terrain: None,
        };
        choose(runways, &s).map(|r| r.id.clone())
    }

    #[test]
    fn the_best_runway_is_chosen() {
        let main = runway("main", 0.0, 8.0, 0.0, 1);
        let near = runway("near", 180.0, 2.0, 0.0, 2);
        let similar = runway("similar", 180.0, 7.5, 0.0, 2);
        let downwind = runway("downwind", 0.0, 8.0, 90.0, 1);
        let mut short = runway("short", 0.0, 1.0, 0.0, 1);
        short.length_m = 80.0;
        type Case<'a> = (&'a str, Vec<SafeRunway>, f64, f64, Option<&'a str>);
        let cases: [Case; 6] = [
            ("nothing stored", vec![], 1.0, 0.0, None),
            ("much closer alternate", vec![main.clone(), near.clone()], 1.0, 0.0, Some("near")),
            ("hardly closer alternate", vec![main.clone(), similar], 1.0, 0.0, Some("main")),
            ("tailwind on landing", vec![downwind, main.clone()], 1.0, 8.0, Some("main")),
            ("too short", vec![short, near.clone()], 1.0, 0.0, Some("near")),
            ("out of reach", vec![main], 0.03, 0.0, None),
        ];
        for (name, runways, battery, wind, expected) in cases {
            assert_eq!(choice(&runways, battery, wind).as_deref(), expected, "{name}");
        }
    }

    #[test]
    fn the_way_ends_with_a_landing_in_line_with_the_runway_and_clears_the_ground() {
        let (profile, ground) = (Profile::default(), terrain::Flat(700.0));
        let target = runway("main", 0.0, 12.0, 52.0, 1);
        let s = Situation {
            position: HOME,
            altitude_amsl_m: 500.0,
            air: None,
            battery: 1.0,
            profile: &profile,
            terrain: Some(&ground),
        };
        let way = path(&target, &SafeParameters::default(), &s);
        assert!(way[0].altitude_amsl_m >= 800.0);
        let [initial, last, land] = &way[way.len() - 3..] else { panic!() };
        assert!(matches!(land.action, Action::Land { .. }) && land.end_of_plan);
        for (a, b) in [(initial, last), (last, land)] {
            assert!((a.position.bearing_deg(b.position) - 52.0).abs() < 0.5);
        }
        let slope = (last.altitude_amsl_m - land.altitude_amsl_m) / last.position.distance_m(land.position);
        assert!((0.05..=0.1).contains(&slope), "{slope}");
        assert!(way.iter().all(|w| w.token == Token(0)));
    }
}
