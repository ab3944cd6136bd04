//! The engine fails where the plan names an alternate, over hills that both know.

use super::whole::Whole;
use super::*;
use flight_exec::Branching;
use flight_exec::Event;
use terrain::{Tile, Tiles};

pub const SQUARE: &str = include_str!("../../../../../assets/plans/square.xml");
/// Surveys 300 m above home, and names an alternate of its own for an engine failure, by a detour.
pub const SURVEY: &str = include_str!("survey.xml");
const PERSONALITIES: [Personality; 2] = [Personality::ArduPlane, Personality::Px4];

pub fn hills() -> Arc<dyn Terrain> {
    let tile = include_bytes!("../../../../../assets/terrain/N36W085.hgt");
    let mut tiles = Tiles::new();
    tiles.add(Tile::from_hgt("N36W085.hgt", tile).unwrap());
    Arc::new(tiles)
}

fn height_m(whole: &Whole) -> f64 {
    whole.flight.sim.autopilot.aircraft.state().altitude_amsl_m - GROUND_M
}

/// The wind of these flights, from the side of the runway, and one that is against the landing.
const ASIDE: (f64, f64) = (270.0, 5.0);
const AGAINST: (f64, f64) = (HEADING_DEG, 5.0);

/// So far beside the runway it has to be above the ground, metres.
const NEAR_M: f64 = 300.0;

/// In a wind from there, m/s, on a leg, so high above home, the engine fails, and that is told within 10 s. Until it is on the ground, which
/// is nowhere but near the runway.
fn glided(personality: Personality, wind: (f64, f64), plan: &str, leg: &str, least_m: f64) -> Whole {
    let hills = hills();
    let mut whole = Whole::over(personality, hills.clone(), 61, &[]);
    whole.flight.sim.autopilot.wind = aircraft::Wind::from_direction(wind.0, wind.1);
    whole.start(plan);
    whole.run_until(900.0, leg, |w| w.entered(leg) && height_m(w) > least_m);
    assert!(whole.flight.sim.inject("engine-out".parse().unwrap()));
    whole.run_until(10.0, "the alarm", |w| w.flight.station.gateway().snapshot().engine.is_some());
    whole.run_until(400.0, "down", |w| {
        let (here, ground_m) = (place(w), hills.elevation_m(place(w)));
        let is_above = ground_m.is_none_or(|ground_m| height_m(w) + GROUND_M > ground_m);
        assert!(is_above || STRIP.beside_m(here) < NEAR_M, "{personality}: {here:?} is in a hill");
        w.flight.state() == GatewayState::Stop
    });
    whole
}

/// Its alternate was flown by the FP Manager to the end, and its autopilot flew every list.
fn assert_flies_its_alternate(whole: &Whole, plan: &str) {
    let told = &whole.happened;
    let entered = |e: &Event| match e {
        Event::LegEntered { place } => place.plan == Branching::Emergency(plan.into()),
        _ => false,
    };
    assert!(told.iter().any(entered), "{told:?}");
    assert!(!told.iter().any(|e| matches!(e, Event::WaypointsRejected { .. })), "{told:?}");
    let own = |state: &GatewayState| {
        use GatewayState::{Manual, SafeApproach, SafeHold, SafeLand, SafeReturn};
        matches!(state, Manual | SafeApproach | SafeHold | SafeLand | SafeReturn)
    };
    let changes = whole.flight.changes();
    assert!(!changes.iter().any(|(_, state)| own(state)), "{changes:?}");
    let said = whole.flight.station.gateway().telemetry().said.as_ref();
    assert!(!said.is_some_and(|(_, words)| words.contains("mission")), "{said:?}");
}

pub const STRIP: aircraft::Strip =
    aircraft::Strip { threshold: HOME, heading_deg: HEADING_DEG, length_m: 600.0 };

fn place(whole: &Whole) -> LatLon {
    whole.flight.sim.autopilot.aircraft.state().position
}

#[test]
fn an_engine_that_fails_low_on_a_circuit_is_followed_by_its_alternate_as_far_as_the_height_allows() {
    for personality in PERSONALITIES {
        let whole = glided(personality, ASIDE, SQUARE, "side2", 128.0);
        assert_flies_its_alternate(&whole, "return");
        // the turn towards it takes more than there is: as near as it gets
        let beside_m = STRIP.beside_m(place(&whole));
        assert!(beside_m < 250.0, "{personality}: {beside_m:.0} m");
    }
}

#[test]
fn an_alternate_by_a_detour_is_cut_short_over_the_hills_that_the_glide_does_not_cross() {
    for personality in PERSONALITIES {
        let whole = glided(personality, ASIDE, SURVEY, "scan", 290.0);
        assert_flies_its_alternate(&whole, "return2");
        assert!(
            STRIP.is_landed_on(place(&whole)),
            "{personality}: {:.0} m beside it",
            STRIP.beside_m(place(&whole))
        );
    }
}

/// Against the wind the final takes more height than PX4 takes a landing from.
#[test]
fn a_glide_against_the_wind_comes_down_on_the_runway_and_not_before_it() {
    for personality in PERSONALITIES {
        let whole = glided(personality, AGAINST, SURVEY, "scan", 290.0);
        assert_flies_its_alternate(&whole, "return2");
        let beside_m = STRIP.beside_m(place(&whole));
        assert!(STRIP.is_landed_on(place(&whole)), "{personality}: {beside_m:.0} m beside it");
    }
}
