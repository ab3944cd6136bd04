//! Where no way home can be flown, and what is not known on the way.

use super::tests::{HOME, Wall, runway, situation};
use super::*;
use terrain::Flat;
use usal::contract::SafeParameters;

/// Nothing is known of the ground here.
struct Nowhere;

impl Terrain for Nowhere {
    fn elevation_m(&self, _at: LatLon) -> Option<f64> {
        None
    }
}

fn blowing(east_mps: f64, north_mps: f64) -> Option<Air> {
    let (wind_east_mps, wind_north_mps) = (east_mps, north_mps);
    Some(Air { airspeed_mps: 25.0, wind_east_mps, wind_north_mps, pressure_hpa: 970.0, temperature_c: 20.0 })
}

fn chosen(runway: &SafeRunway, s: &Situation) -> Option<String> {
    choose(std::slice::from_ref(runway), &SafeParameters::default(), s).map(|landing| landing.to_string())
}

#[test]
fn against_a_wind_that_is_faster_than_it_no_runway_is_in_reach() {
    let (profile, ahead) = (Profile::default(), runway("ahead", 0.0, 4.0, 0.0, 1));
    for glides in [false, true] {
        let s = Situation { glides, altitude_amsl_m: 900.0, air: blowing(0.0, -40.0), ..situation(&profile) };
        assert_eq!(chosen(&ahead, &s), None, "gliding: {glides}");
        let calm = Situation { air: None, ..s };
        assert_eq!(chosen(&ahead, &calm).as_deref(), Some("runway ahead"), "gliding: {glides}");
    }
}

#[test]
fn ground_that_is_not_known_is_in_nobodys_way() {
    let (profile, ahead) = (Profile::default(), runway("ahead", 0.0, 8.0, 0.0, 1));
    for glides in [false, true] {
        let s = Situation { glides, altitude_amsl_m: 1200.0, terrain: Some(&Nowhere), ..situation(&profile) };
        assert_eq!(chosen(&ahead, &s).as_deref(), Some("runway ahead"));
        let with_wind = Situation { air: blowing(0.0, 6.0), ..s };
        let way = chosen(&ahead, &with_wind).unwrap();
        assert_eq!(
            way == "runway ahead",
            !glides,
            "it does not land from an end of which nothing is known: {way}"
        );
    }
}

/// Circles and all that come before the approach, and their altitudes never leave what is flown.
#[test]
fn height_that_is_too_much_for_the_way_is_circled_away_before_the_approach() {
    let profile = Profile::default();
    let near = runway("near", 0.0, 1.0, 0.0, 1);
    let s = Situation { altitude_amsl_m: 1500.0, ..situation(&profile) };
    let landing = choose(std::slice::from_ref(&near), &SafeParameters::default(), &s).unwrap();
    let way = path(&landing, &s);
    assert!(way.iter().filter(|w| w.on_arc).count() > 8, "{way:?}");
    assert!(way.windows(2).all(|pair| pair[1].altitude_amsl_m <= pair[0].altitude_amsl_m + 1e-6), "{way:?}");
    let high = Profile { ceiling_amsl_m: 20_000.0, ..profile.clone() };
    let far_up = Situation { altitude_amsl_m: 11_000.0, ..situation(&high) };
    assert_eq!(chosen(&near, &far_up).as_deref(), Some("runway near"), "the circles become wider");
}

#[test]
fn a_ridge_above_the_ceiling_is_not_crossed() {
    let profile = Profile::default();
    let behind = runway("behind", 0.0, 8.0, 0.0, 1);
    let wall = Wall(HOME.lat_deg + 0.02, profile.ceiling_amsl_m);
    let s = Situation { terrain: Some(&wall), ..situation(&profile) };
    assert_eq!(chosen(&behind, &s), None);
    let lower = Wall(HOME.lat_deg + 0.02, 1500.0);
    assert_eq!(chosen(&behind, &Situation { terrain: Some(&lower), ..s }).as_deref(), Some("runway behind"));
}

#[test]
fn a_glide_does_not_roll_past_the_end_of_a_runway_with_the_wind() {
    let profile = Profile::default();
    // it flies towards the other end of it, with the wind
    let main = runway("main", 230.0, 2.6, 50.0, 1);
    let s = Situation { glides: true, track_deg: 230.0, altitude_amsl_m: 542.0, ..situation(&profile) };
    assert!(chosen(&main, &s).is_some_and(|way| way.contains("other end")));
    let wind = blowing(-8.0 * 50_f64.to_radians().sin(), -8.0 * 50_f64.to_radians().cos());
    let with_wind = Situation { air: wind, ..s };
    assert!(chosen(&main, &with_wind).is_none_or(|way| !way.contains("other end")));
}

#[test]
fn a_runway_is_usable_up_to_the_last_of_its_numbers() {
    let (profile, sound) = (Profile::default(), runway("it", 0.0, 4.0, 0.0, 1));
    let nowhere = SafeRunway { threshold: LatLon::new(91.0, 0.0), ..sound.clone() };
    let turned = SafeRunway { heading_deg: f64::INFINITY, ..sound.clone() };
    let above = SafeRunway { elevation_amsl_m: profile.ceiling_amsl_m, ..sound.clone() };
    for bad in [nowhere, turned, above] {
        assert!(!is_usable(&bad, &profile), "{bad:?}");
    }
}

#[test]
fn out_of_its_own_low_place_it_climbs_away_even_if_the_model_has_it_in_the_ground() {
    let (profile, plain) = (Profile::default(), Flat(580.0));
    let on_it = SafeRunway { elevation_amsl_m: 580.0, ..runway("there", 0.0, 8.0, 0.0, 1) };
    let low = Situation { altitude_amsl_m: 600.0, terrain: Some(&plain), ..situation(&profile) };
    assert_eq!(chosen(&on_it, &low).as_deref(), Some("runway there"));
    let below = Situation { altitude_amsl_m: 570.0, ..low };
    assert_eq!(chosen(&on_it, &below).as_deref(), Some("runway there"));
}
