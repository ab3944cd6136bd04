//! The waypoints to a runway.

use super::gliding::{Gate, glide_in};
use super::{Approach, Landing, Situation, along};
use aircraft::Profile;
use geometry::LatLon;
use usal::contract::{Action, Id, SafeParameters, SafeRunway, Token, Waypoint};

/// Slope of the final approach, height over distance (about 4.6 degrees).
const GLIDE_SLOPE: f64 = 0.08;
/// Straight and level before the final descent, metres.
const INITIAL_M: f64 = 700.0;
/// Length of a short final, and of what is straight before it, metres.
const SHORT_FINAL_M: f64 = 400.0;
const SHORT_INITIAL_M: f64 = 100.0;
/// Height kept above the ground on the way, metres.
const CLEARANCE_M: f64 = 100.0;
/// Touch-down point behind the threshold, as a share of the length.
const TOUCHDOWN: f64 = 0.15;

/// Where an approach begins, and where its final descent begins; each with its altitude, metres AMSL.
pub(super) fn gates(runway: &SafeRunway, approach: Approach, safe: &SafeParameters) -> [(LatLon, f64); 2] {
    let (final_m, initial_m) = match approach {
        Approach::Whole => (safe.return_height_m.clamp(40.0, 500.0) / GLIDE_SLOPE, INITIAL_M),
        Approach::Short => (SHORT_FINAL_M, SHORT_INITIAL_M),
    };
    let back_deg = runway.heading_deg + 180.0;
    let altitude_m = runway.elevation_amsl_m + final_m * GLIDE_SLOPE;
    [final_m + initial_m, final_m].map(|m| (runway.threshold.destination(back_deg, m), altitude_m))
}

/// The way to a landing: over the ground on the way, down to the initial approach point, along the
/// extended centre line, and the landing. Its tokens are 0: they are not reported.
pub fn path(landing: &Landing, safe: &SafeParameters, s: &Situation) -> Vec<Waypoint> {
    let runway = &landing.runway;
    let mut way = if s.glides { glided(landing, safe, s) } else { powered(landing, safe, s) };
    let touchdown = runway.threshold.destination(runway.heading_deg, TOUCHDOWN * runway.length_m);
    let landing = Action::Land { heading_deg: runway.heading_deg };
    way.push(waypoint(touchdown, runway.elevation_amsl_m, approach_speed(s.profile), landing));
    way
}

fn powered(landing: &Landing, safe: &SafeParameters, s: &Situation) -> Vec<Waypoint> {
    let [initial, last] = gates(&landing.runway, landing.approach, safe);
    let mut way = transit(initial.0, initial.1, s);
    way.push(waypoint(initial.0, initial.1, s.profile.cruise_airspeed_mps, Action::Fly));
    way.push(waypoint(last.0, last.1, approach_speed(s.profile), Action::Fly));
    way
}

/// At the speed of the best glide until the landing.
fn glided(landing: &Landing, safe: &SafeParameters, s: &Situation) -> Vec<Waypoint> {
    let glide = glide_in(&landing.runway, landing.approach, safe, s);
    let fly = |gate: Gate| Waypoint {
        on_arc: gate.on_arc,
        ..waypoint(gate.position, gate.altitude_amsl_m, s.profile.cruise_airspeed_mps, Action::Fly)
    };
    glide.into_iter().flat_map(|glide| glide.gates).map(fly).collect()
}

/// Where the ground on the way (or our own height) is above the approach height: stay high until
/// the descent has to begin.
fn transit(to: LatLon, approach_m: f64, s: &Situation) -> Vec<Waypoint> {
    let way = s.position.inverse(to);
    let needed_m = ground_to_clear_m(s, to).unwrap_or(approach_m);
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

/// The altitude that clears the ground between here and a place, metres AMSL; `None`: nothing is known of it.
pub(super) fn ground_to_clear_m(s: &Situation, to: LatLon) -> Option<f64> {
    let terrain = s.terrain?;
    let ground = along(s.position, to).filter_map(|(_, place)| terrain.elevation_m(place));
    ground.max_by(f64::total_cmp).map(|ground_m| ground_m + CLEARANCE_M)
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
    use super::super::tests::{runway, situation};
    use super::*;

    #[test]
    fn the_way_ends_with_a_landing_in_line_with_the_runway_and_clears_the_ground() {
        let (profile, ground) = (Profile::default(), terrain::Flat(700.0));
        let runway = runway("main", 0.0, 12.0, 52.0, 1);
        let s = Situation { altitude_amsl_m: 500.0, terrain: Some(&ground), ..situation(&profile) };
        let landing = Landing { runway, reversed: false, approach: Approach::Whole };
        let way = path(&landing, &SafeParameters::default(), &s);
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

    #[test]
    fn a_glide_to_a_short_final_has_nothing_that_is_climbed_to() {
        let profile = Profile::default();
        let landing =
            Landing { runway: runway("main", 0.0, 3.0, 0.0, 1), reversed: false, approach: Approach::Short };
        let s = Situation { glides: true, ..situation(&profile) };
        let way = path(&landing, &SafeParameters::default(), &s);
        assert_eq!(way.len(), 3);
        assert!(way.iter().all(|w| w.altitude_amsl_m < s.altitude_amsl_m));
        assert!(way[0].position.distance_m(landing.runway.threshold) < 600.0);
    }
}
