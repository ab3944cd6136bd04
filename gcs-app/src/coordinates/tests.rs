use super::*;
use flight_plan::Fix;
use proptest::prelude::*;

fn is_at(text: &str, lat_deg: f64, lon_deg: f64) {
    let read = read(text, &Known::default());
    let Ok(at) = read else { panic!("{text}: {read:?}") };
    assert!(at.distance_m(LatLon::new(lat_deg, lon_deg)) < 0.2, "{text}: {at:?}");
}

#[test]
fn degrees_are_read_as_people_write_them() {
    for text in [
        "36.54, -84.23",
        "36.54 -84.23",
        "36.54;-84.23",
        "  +36.54, −84.23 ",
        "36.54N 84.23W",
        "N36.54 W84.23",
        "84.23W, 36.54N",
        "36°32'24\"N 84°13'48\"W",
        "36° 32′ 24″ N, 84° 13′ 48″ W",
        "36 32 24 N 84 13 48 W",
        "N 36 32.4 W 084 13.8",
        "36°32.4' -84°13.8'",
        "36:32:24, -84:13:48",
        "36 32 24 -84 13 48",
        "363224N0841348W",
        "3632.4N 08413.8W",
        "n36.54 w84.23",
    ] {
        is_at(text, 36.54, -84.23);
    }
    is_at("-0 30 0, 0 30 0", -0.5, 0.5);
}

#[test]
fn what_is_no_place_is_refused() {
    for text in [
        "",
        "36.54",
        "91, 0",
        "0, 181",
        "1 2 3",
        "NaN, 0",
        "inf, 0",
        "north",
        "36.54N 84.23N",
        "36 60 0 N 84 0 0 W",
        "-36.54N 84.23W",
        "36.5 30 N 84 W",
        "36°°, ",
        "N W",
        "36.54,-84.23,1,2",
        "99T WL 85664 13154",
        "18I 585664 4511315",
        "+",
        "8FVC+",
        "8FVC2222+2",
        "LONDON+22",
        "CJ+2VX",
        "aircraft",
        "45° 800 m from A",
        "45 800 from 1, 1",
        "361° 1 m from 1, 1",
        "é°N",
        "18T",
    ] {
        let refused = read(text, &Known::default());
        assert!(refused.is_err(), "{text}: {refused:?}");
    }
    assert!(read(&"1".repeat(1 << 20), &Known::default()).unwrap_err().contains("200"));
}

#[test]
fn grids_agree_with_known_values() {
    for text in ["18TWL8566411315", "18T WL 85664 11315", "18twl 85664 11315"] {
        let at = position(text).unwrap();
        assert!(at.distance_m(LatLon::new(40.748333, -73.985278)) < 1.5, "{text}: {at:?}");
    }
    is_at("18T 585664.121 4511315.422", 40.748333, -73.985278);
    is_at("18 north 585664.121mE 4511315.422mN", 40.748333, -73.985278);
    // Sydney, south of the equator
    let at = position("56H 334873 6252266").unwrap();
    assert!(at.distance_m(LatLon::new(-33.857, 151.215)) < 100.0, "{at:?}");
    assert_eq!(position("56 south 334873 6252266"), Some(at));
}

#[test]
fn plus_codes_agree_with_their_reference() {
    for (code, lat, lon) in [
        ("7FG49Q00+", 20.375, 2.775),
        ("7FG49QCJ+2V", 20.3700625, 2.7821875),
        ("7fg49qcj+2vx", 20.3701125, 2.782234375),
        ("8FVC2222+22", 47.0000625, 8.0000625),
        ("4VCPPQGP+Q9", -41.2730625, 174.7859375),
        ("62H20000+", 1.5, -179.5),
    ] {
        is_at(code, lat, lon);
    }
    let near = Some(LatLon::new(51.3708675, -1.217765625));
    let at = read("CJ+2VX", &Known { near, ..Known::default() }).unwrap();
    assert!(at.distance_m(position("9C3W9QCJ+2VX").unwrap()) < 0.1, "{at:?}");
}

#[test]
fn a_place_may_be_named_or_be_a_way_from_one() {
    let a = LatLon::new(36.5, -84.2);
    let fix = Fix { id: "A".into(), position: a, name: String::new(), description: String::new() };
    let plan = FlightPlan { fixes: vec![fix], ..FlightPlan::default() };
    let known =
        Known { plan: Some(&plan), aircraft: Some(LatLon::new(36.6, -84.3)), near: None, world: None };
    assert_eq!(read("A", &known), Ok(a));
    assert_eq!(read("Aircraft", &known), Ok(LatLon::new(36.6, -84.3)));
    for text in ["045° 1.2 km from A", "45/1200m from A", "45 1200 m FROM 36.5, -84.2"] {
        let at = read(text, &known).unwrap();
        assert!(at.distance_m(a.destination(45.0, 1200.0)) < 1e-6, "{text}");
    }
    let far = read("270 1 NM from aircraft", &known).unwrap();
    assert!((far.distance_m(LatLon::new(36.6, -84.3)) - 1852.0).abs() < 1e-6);
    assert!(read("45 x from A", &known).unwrap_err().contains("bearing and distance"));
    assert!(read("B", &known).unwrap_err().contains("“B”"));
}

#[test]
fn cities_and_airports_have_names() {
    let known = Known { world: crate::assets::places().ok(), ..Known::default() };
    for (name, lat, lon) in [
        ("Paris", 48.86, 2.35),
        ("sao paulo", -23.55, -46.63),
        ("KTYS", 35.81, -83.99),
        ("Knoxville Downtown Island", 35.96, -83.87),
    ] {
        let at = read(name, &known).unwrap();
        assert!(at.distance_m(LatLon::new(lat, lon)) < 15_000.0, "{name}: {at:?}");
    }
    let north = read("0° 10 km from KTYS", &known).unwrap();
    assert!(north.distance_m(read("ktys", &known).unwrap()) > 9_900.0);
    assert!(read("Knoxvil", &known).unwrap_err().contains("Knoxville Downtown"));
    assert!(read("Xqzzy", &known).unwrap_err().contains("is no place"));
    assert!(read("Paris", &Known::default()).is_err(), "only where it is asked for");
}

proptest! {
    #[test]
    fn a_position_that_the_window_writes_is_read_again(lat in -90.0..90.0f64, lon in -180.0..180.0f64) {
        let at = LatLon::new(lat, lon);
        let read = position(&crate::units::position(at));
        prop_assert!(read.is_some_and(|back| back.distance_m(at) < 1.0));
    }

    #[test]
    fn no_text_is_too_odd(text in "\\PC{0,60}", code in "[0-9A-Z+ .,°'-]{0,30}") {
        let near = Some(LatLon::new(89.9, 179.9));
        for text in [text, code] {
            if let Ok(at) = read(&text, &Known { near, ..Known::default() }) {
                prop_assert!(at.is_valid());
            }
        }
    }
}
