//! Drawings of other programs, and how ours are drawn.
#![cfg(test)]

mod outline;

use flight_plan::{Zone, ZoneKind, ZoneShape};
use geometry::LatLon;
use interchange::{Areas, Assumptions, Export, Format, Import, read, write};
use outline::outline;

fn import(format: Format, text: &str) -> Import {
    read(format, text.as_bytes(), &Assumptions::default()).unwrap()
}

fn said<'a>(import: &'a Import, code: &str) -> Vec<&'a str> {
    import.notes.iter().filter(|n| n.code == code).map(|n| n.message.as_str()).collect()
}

#[test]
fn types_of_other_programs_points_are_no_marks_of_ours() {
    let file = |creator: &str| {
        let text = format!(
            "<gpx version='1.1' creator='{creator}'><wpt lat='36.33' lon='-84.15'><ele>349</ele><name>Trailhead</name><type>path</type></wpt>\
             <wpt lat='36.34' lon='-84.15'><name>Old strip</name><type>runway</type></wpt></gpx>"
        );
        import(Format::Gpx, &text)
    };
    let other = file("Garmin Connect");
    assert_eq!(outline(&other.plan), ["fix Trailhead 36.33 -84.15 ", "fix Old-strip 36.34 -84.15 "]);
    assert_eq!(said(&other, "element-not-carried"), ["<type> of <wpt> is left out (2 times, here first)"]);
    let ours = file("Legwork");
    assert_eq!((ours.plan.fixes.len(), ours.plan.runways.len()), (0, 1));
}

#[test]
fn a_runway_of_which_a_drawing_says_little_is_made_up() {
    let made_up = |after: &str| {
        let text = format!(
            "<gpx version='1.1' creator='Legwork'><wpt lat='36.319' lon='-84.173'><ele>349</ele><name>R05</name><type>runway</type></wpt>{after}</gpx>"
        );
        let import = import(Format::Gpx, &text);
        let notes = import.notes.iter().filter(|n| n.code == "runway-made-up");
        let told: Vec<String> = notes.map(|n| format!("{}: {}", n.place, n.message)).collect();
        (import.plan.runways[0].heading_deg, told)
    };
    let alone =
        "line 1: runway `R05` is assumed from a point: 600 m long, heading 0°, elevation 349 m; correct it";
    assert_eq!(made_up(""), (0.0, vec![alone.to_owned()]));
    let take_off = "<rte><rtept lat='36.3234283' lon='-84.1659721'><ele>429</ele><type>take-off</type></rtept>\
                    <rtept lat='36.33' lon='-84.15'><ele>500</ele></rtept></rte>";
    let (heading_deg, told) = made_up(take_off);
    assert!((51.0..53.0).contains(&heading_deg) && (heading_deg * 100.0).fract() == 0.0, "{heading_deg}");
    assert_eq!(told, [alone.replace("heading 0°", "heading 52°")]);
}

#[test]
fn what_the_metadata_of_a_gpx_file_say_is_told() {
    let file = |root: &str| {
        import(
            Format::Gpx,
            &format!("<gpx version='1.1' creator='x'>{root}<wpt lat='36.3' lon='-84.1'/></gpx>"),
        )
    };
    let named = file("<metadata><name>Tour</name><desc>slowly</desc><bounds minlat='36'/></metadata>");
    assert_eq!(named.plan.name, "Tour");
    assert_eq!(said(&named, "element-not-carried"), ["<desc> of <metadata> is left out"]);
    let old = file("<name>Tour</name><desc>slowly</desc>");
    assert_eq!(old.plan.name, "Tour");
    assert_eq!(said(&old, "element-not-carried"), ["<desc> of <gpx> is left out"]);
}

#[test]
fn every_hole_of_a_boundary_is_one() {
    let ring = |at: f64| {
        format!(
            "<LinearRing><coordinates>{at},36.302 {at}5,36.302 {at}5,36.304 {at},36.302</coordinates></LinearRing>"
        )
    };
    let text = format!(
        "<kml><Placemark><Polygon><outerBoundaryIs><LinearRing><coordinates>-84.17,36.30 -84.15,36.30 -84.15,36.31 -84.17,36.30\
         </coordinates></LinearRing>{}</outerBoundaryIs><innerBoundaryIs>{}{}</innerBoundaryIs></Polygon></Placemark></kml>",
        ring(-84.1),
        ring(-84.16),
        ring(-84.15)
    );
    let import = import(Format::Kml, &text);
    assert!(outline(&import.plan).last().unwrap().contains("2 holes"), "{:?}", outline(&import.plan));
    assert_eq!(said(&import, "element-not-carried"), ["a second outer boundary of an area is left out"]);
}

/// A field with a house in its middle: where the house is, nobody may fly.
#[test]
fn holes_of_a_zone_to_stay_inside_of_are_zones_to_keep_out_of() {
    const FIELD: &str = r#"{"type": "Feature", "properties": {"name": "Field"}, "geometry": {"type": "Polygon", "coordinates": [
        [[-84.20, 36.30], [-84.10, 36.30], [-84.10, 36.38], [-84.20, 36.38], [-84.20, 36.30]],
        [[-84.16, 36.33], [-84.16, 36.34], [-84.15, 36.34], [-84.15, 36.33], [-84.16, 36.33]],
        [[-84.13, 36.33], [-84.13, 36.34], [-84.12, 36.34], [-84.13, 36.33]]]}}"#;
    let zones = |areas| {
        let assumptions = Assumptions { areas, ..Assumptions::default() };
        let import = read(Format::GeoJson, FIELD.as_bytes(), &assumptions).unwrap();
        let corners = |zone: &Zone| match &zone.shape {
            ZoneShape::Polygon(corners) => corners.len(),
            ZoneShape::Circle { .. } => 0,
        };
        let zones: Vec<_> =
            import.plan.zones.iter().map(|zone| (zone.id.to_string(), zone.kind, corners(zone))).collect();
        (zones, said(&import, "zone-holes").concat())
    };
    let (inside, told) = zones(Areas::KeepIn);
    assert_eq!(
        inside,
        [
            ("Field".to_owned(), ZoneKind::KeepIn, 4),
            ("Field-hole".to_owned(), ZoneKind::KeepOut, 4),
            ("Field-hole-2".to_owned(), ZoneKind::KeepOut, 3),
        ]
    );
    assert_eq!(told, "the holes of this zone become zones to keep out of");
    let (outside, told) = zones(Areas::KeepOut);
    assert_eq!(outside, [("Field".to_owned(), ZoneKind::KeepOut, 4)]);
    assert!(told.contains("nobody flies inside of them either"), "{told}");
    let (scanned, told) = zones(Areas::Scan);
    assert_eq!((scanned, told.as_str()), (vec![], ""), "a scan has holes itself");
}

#[test]
fn rings_turn_as_geojson_wants() {
    let corners =
        |places: &[(f64, f64)]| places.iter().map(|(lat, lon)| LatLon::new(*lat, *lon)).collect::<Vec<_>>();
    // clockwise, the second across the antimeridian
    for clockwise in [
        corners(&[(36.25, -84.25), (36.37, -84.25), (36.37, -84.1), (36.25, -84.1)]),
        corners(&[(10.0, 179.9), (10.2, 179.9), (10.2, -179.9), (10.0, -179.9)]),
    ] {
        let anticlockwise: Vec<_> = [0, 3, 2, 1].map(|i| clockwise[i]).to_vec();
        for drawn in [clockwise, anticlockwise.clone()] {
            let zone = Zone {
                id: "z".into(),
                name: String::new(),
                kind: ZoneKind::KeepIn,
                shape: ZoneShape::Polygon(drawn),
                floor: None,
                ceiling: None,
                active: Vec::new(),
            };
            let plan = flight_plan::FlightPlan { zones: vec![zone], ..Default::default() };
            let written = write(Format::GeoJson, &Export { plan: &plan, steps: &[] }).unwrap();
            let found = read(Format::GeoJson, &written.bytes, &Assumptions::default()).unwrap().plan;
            assert_eq!(found.zones[0].shape, ZoneShape::Polygon(anticlockwise.clone()));
        }
    }
}

#[test]
fn descriptions_and_altitudes_that_have_no_place_are_told() {
    let kml = import(
        Format::Kml,
        "<kml><Placemark><name>Route</name><description>slowly</description><LineString><coordinates>-84.16,36.32 -84.17,36.33\
         </coordinates></LineString></Placemark><Placemark><Polygon><altitudeMode>absolute</altitudeMode><outerBoundaryIs><LinearRing>\
         <coordinates>-84.17,36.30,450 -84.15,36.30,450 -84.15,36.31,460 -84.17,36.30,450</coordinates></LinearRing></outerBoundaryIs>\
         </Polygon></Placemark></kml>",
    );
    assert_eq!(
        (said(&kml, "description-not-carried").len(), said(&kml, "altitude-not-carried").len()),
        (1, 1)
    );
    let gpx = import(
        Format::Gpx,
        "<gpx version='1.1' creator='x'><rte><rtept lat='36.3' lon='-84.1'><desc>the mill</desc></rtept></rte></gpx>",
    );
    assert_eq!(said(&gpx, "element-not-carried"), ["<desc> of <rtept> is left out"]);
}
