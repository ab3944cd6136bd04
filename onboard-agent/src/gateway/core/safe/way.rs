//! The waypoints to a runway.

use super::gates::Gate;
use super::{Landing, Situation};
use aircraft::Profile;
use geometry::LatLon;
use usal::contract::{Action, Id, SafeParameters, SafeRunway, Token, Waypoint};

/// Slope of the final approach, height over distance (about 4.6 degrees).
const GLIDE_SLOPE: f64 = 0.08;
/// Straight and level before the final descent, metres.
pub(super) const INITIAL_M: f64 = 700.0;
/// Touch-down point behind the threshold, as a share of the length.
pub(super) const TOUCHDOWN: f64 = 0.15;

/// With the engine: where an approach begins, and where its final descent begins; each with its altitude, metres AMSL.
pub(super) fn gates(runway: &SafeRunway, safe: &SafeParameters) -> [(LatLon, f64); 2] {
    let final_m = safe.return_height_m.clamp(40.0, 500.0) / GLIDE_SLOPE;
    let back_deg = runway.heading_deg + 180.0;
    let altitude_m = runway.elevation_amsl_m + final_m * GLIDE_SLOPE;
    [final_m + INITIAL_M, final_m].map(|m| (runway.threshold.destination(back_deg, m), altitude_m))
}

/// The way to a landing: over the ground on the way, along the extended centre line, and the landing. Its tokens are 0: they are not
/// reported.
pub fn path(landing: &Landing, s: &Situation) -> Vec<Waypoint> {
    let runway = &landing.runway;
    let mut way = flown(&landing.gates, s);
    let touchdown = runway.threshold.destination(runway.heading_deg, TOUCHDOWN * runway.length_m);
    let landing = Action::Land { heading_deg: runway.heading_deg };
    way.push(waypoint(touchdown, runway.elevation_amsl_m, approach_speed(s.profile), landing));
    way
}

/// Slower from where the final descent begins, but without an engine at the speed of the best glide until the landing.
fn flown(gates: &[Gate], s: &Situation) -> Vec<Waypoint> {
    let last = gates.len().saturating_sub(1);
    let fly = |(i, gate): (usize, &Gate)| {
        let slower = i == last && !s.glides;
        let mps = if slower { approach_speed(s.profile) } else { s.profile.cruise_airspeed_mps };
        Waypoint { on_arc: gate.on_arc, ..waypoint(gate.position, gate.altitude_amsl_m, mps, Action::Fly) }
    };
    gates.iter().enumerate().map(fly).collect()
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
    use super::super::choose;
    use super::super::tests::{HOME, Wall, runway, situation};
    use super::*;

    #[test]
    fn the_way_ends_with_a_landing_in_line_with_the_runway_and_clears_the_ground() {
        let (profile, ground) = (Profile::default(), Wall(HOME.lat_deg + 0.02, 700.0));
        let runway = runway("main", 0.0, 12.0, 52.0, 1);
        let s = Situation { altitude_amsl_m: 500.0, terrain: Some(&ground), ..situation(&profile) };
        let way = path(&choose(&[runway], &SafeParameters::default(), &s).unwrap(), &s);
        assert!(way.iter().any(|w| w.altitude_amsl_m >= 800.0));
        let [initial, last, land] = &way[way.len() - 3..] else { panic!() };
        assert!(matches!(land.action, Action::Land { .. }) && land.end_of_plan);
        for (a, b) in [(initial, last), (last, land)] {
            assert!((a.position.bearing_deg(b.position) - 52.0).abs() < 0.5);
        }
        let slope = (last.altitude_amsl_m - land.altitude_amsl_m) / last.position.distance_m(land.position);
        assert!((0.05..=0.1).contains(&slope), "{slope}");
        assert!(way.iter().all(|w| w.token == Token(0)));
    }

    #[test]
    fn a_glide_to_a_short_final_has_nothing_that_is_climbed_to() {
        let profile = Profile::default();
        // by the whole final it would take 360 m
        let abeam = runway("abeam", 90.0, 3.0, 0.0, 1);
        let s = Situation { glides: true, altitude_amsl_m: 322.0 + 366.0, ..situation(&profile) };
        let landing = choose(&[abeam], &SafeParameters::default(), &s).unwrap();
        let way = path(&landing, &s);
        assert_eq!(way.len(), 2, "{landing}: {way:?}");
        assert!(way.iter().all(|w| w.altitude_amsl_m < s.altitude_amsl_m));
        assert!(way[0].position.distance_m(landing.runway.threshold) < 600.0);
    }
}
