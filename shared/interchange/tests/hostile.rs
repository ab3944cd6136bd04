//! Files that mean harm: never a panic, never a hang, never more memory than the limits.
#![cfg(test)]

use interchange::{Assumptions, Error, Export, Format, MAX_BYTES, MAX_ITEMS, read, write};
use proptest::prelude::*;
use std::io::{Cursor, Write};

const FIXTURES: [(Format, &[u8]); 9] = [
    (Format::Plan, include_bytes!("fixtures/survey.plan")),
    (Format::Waypoints, include_bytes!("fixtures/patrol.waypoints")),
    (Format::Kml, include_bytes!("fixtures/places.kml")),
    (Format::GeoJson, include_bytes!("fixtures/places.geojson")),
    (Format::Gpx, include_bytes!("fixtures/tour.gpx")),
    (Format::Waypoints, include_bytes!("corpus/mission-planner-fence.waypoints")),
    (Format::Waypoints, include_bytes!("corpus/mavproxy-fence.txt")),
    (Format::Waypoints, include_bytes!("corpus/mavproxy-rally.txt")),
    (Format::FpXml, include_bytes!("corpus/research-inspection.xml")),
];

fn all(bytes: &[u8]) {
    for (_, format) in Format::ALL {
        if let Ok(import) = read(format, bytes, &Assumptions::default()) {
            // whatever was read can be written down and read again
            let document = flight_plan::write(&import.plan);
            flight_plan::read(&document);
            if format.is_written() {
                write(format, &Export { plan: &import.plan, steps: &[] }).unwrap();
            }
        }
    }
    Format::by_content(bytes);
}

fn packed(name: &str, content: &[u8]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    writer.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
    writer.write_all(content).unwrap();
    writer.finish().unwrap().into_inner()
}

/// Numbers that surprise.
const NUMBERS: [&str; 12] =
    ["NaN", "inf", "-inf", "1e400", "-0", "1e308", "4e-320", "9223372036854775808", "-1", "0x10", "", "91"];

#[derive(Debug, Clone)]
enum Change {
    Byte(usize, u8),
    Cut(usize),
    Drop(usize, usize),
    Repeat(usize, usize),
    Number(usize, usize),
}

fn change() -> impl Strategy<Value = Change> {
    let at = 0..10_000usize;
    prop_oneof![
        (at.clone(), any::<u8>()).prop_map(|(i, b)| Change::Byte(i, b)),
        at.clone().prop_map(Change::Cut),
        (at.clone(), 1..200usize).prop_map(|(i, n)| Change::Drop(i, n)),
        (at.clone(), 1..200usize).prop_map(|(i, n)| Change::Repeat(i, n)),
        (at, 0..NUMBERS.len()).prop_map(|(i, n)| Change::Number(i, n)),
    ]
}

fn apply(bytes: &mut Vec<u8>, change: &Change) {
    if bytes.is_empty() {
        return;
    }
    let length = bytes.len();
    match *change {
        Change::Byte(i, b) => bytes[i % length] = b,
        Change::Cut(i) => bytes.truncate(i % length),
        Change::Drop(i, n) => drop(bytes.drain(i % length..(i % length + n).min(length))),
        Change::Repeat(i, n) => {
            let piece = bytes[i % length..(i % length + n).min(length)].to_vec();
            bytes.splice(i % length..i % length, piece);
        }
        Change::Number(i, n) => {
            // the number at or behind this place becomes another
            let numeric = |b: &u8| b.is_ascii_digit() || *b == b'.' || *b == b'-';
            let Some(start) = bytes[i % length..].iter().position(numeric).map(|s| s + i % length) else {
                return;
            };
            let end = bytes[start..].iter().position(|b| !numeric(b)).map_or(length, |e| e + start);
            bytes.splice(start..end, NUMBERS[n].bytes());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        all(&bytes);
    }

    #[test]
    fn damaged_files(which in 0..FIXTURES.len(), changes in prop::collection::vec(change(), 1..6)) {
        let mut bytes = FIXTURES[which].1.to_vec();
        changes.iter().for_each(|c| apply(&mut bytes, c));
        all(&bytes);
        if FIXTURES[which].0 == Format::Kml {
            all(&packed("doc.kml", &bytes));
        }
    }

    #[test]
    fn damaged_archives(changes in prop::collection::vec(change(), 1..4)) {
        let mut bytes = packed("doc.kml", FIXTURES[2].1);
        changes.iter().for_each(|c| apply(&mut bytes, c));
        all(&bytes);
    }

    #[test]
    fn any_mission_items(items in prop::collection::vec((prop::sample::select(vec![16, 17, 18, 19, 20, 21, 22, 31, 82, 84, 85, 93, 177, 178, 189, 203, 206, 2000, 5000, 5001, 5002, 5004, 5100, 9999]), 0..12u16, prop::collection::vec(prop_oneof![Just(0.0), -5.0..30.0f64, any::<f64>()], 7)), 0..40)) {
        let mut list = "QGC WPL 110\n".to_owned();
        for (number, (command, frame, params)) in items.iter().enumerate() {
            let params: String = params.iter().map(|p| format!("{p}\t")).collect();
            list += &format!("{number}\t0\t{frame}\t{command}\t{params}1\n");
        }
        let import = read(Format::Waypoints, list.as_bytes(), &Assumptions::default()).unwrap();
        let again = flight_plan::read(flight_plan::write(&import.plan));
        prop_assert_eq!(again.plan, import.plan);
    }
}

#[test]
fn a_zip_bomb_is_not_unpacked() {
    let bomb = packed("doc.kml", &vec![b' '; MAX_BYTES + 1]);
    assert!(bomb.len() < 200_000);
    assert_eq!(read(Format::Kmz, &bomb, &Assumptions::default()).unwrap_err(), Error::TooLong);
}

#[test]
fn an_archive_without_a_drawing() {
    let error = read(Format::Kmz, &packed("readme.txt", b"hello"), &Assumptions::default()).unwrap_err();
    assert!(error.to_string().contains("no KML file"), "{error}");
}

#[test]
fn deep_nesting_is_refused() {
    let deep = |open: &str, close: &str| format!("{}{}", open.repeat(100_000), close.repeat(100_000));
    for (format, text) in [
        (Format::Plan, format!("{{\"fileType\": \"Plan\", \"mission\": {}}}", deep("[", "]"))),
        (Format::GeoJson, deep("{\"type\":\"GeometryCollection\",\"geometries\":[", "]}")),
        (Format::Kml, format!("<kml>{}</kml>", deep("<Folder>", "</Folder>"))),
        (
            Format::Kml,
            format!("<kml><Placemark>{}</Placemark></kml>", deep("<MultiGeometry>", "</MultiGeometry>")),
        ),
        (Format::Gpx, format!("<gpx>{}</gpx>", deep("<extensions>", "</extensions>"))),
    ] {
        assert!(read(format, text.as_bytes(), &Assumptions::default()).is_err(), "{format:?}");
    }
}

#[test]
fn floods_are_refused() {
    let line = "1\t0\t3\t16\t0\t0\t0\t0\t36\t-84\t100\t1\n";
    let point = "<rtept lat='1' lon='1'/>";
    let placemark = "<Placemark><Point><coordinates>1,1</coordinates></Point></Placemark>";
    let feature = "{\"type\":\"Feature\",\"properties\":{},\"geometry\":null},";
    let too_many = MAX_ITEMS + 2;
    for (format, text) in [
        (Format::Waypoints, format!("QGC WPL 110\n{}", line.repeat(too_many))),
        (
            Format::Plan,
            format!("{{\"fileType\":\"Plan\",\"mission\":{{\"items\":[{}0]}}}}", "0,".repeat(too_many)),
        ),
        (Format::Plan, format!("[{}0]", "0,".repeat(9_000_000))),
        (Format::Gpx, format!("<gpx><rte>{}</rte></gpx>", point.repeat(too_many))),
        (Format::Kml, format!("<kml>{}</kml>", placemark.repeat(too_many))),
        (Format::Kml, format!("<kml>{}</kml>", "<a/>".repeat(1_000_001))),
        (
            Format::Kml,
            format!(
                "<kml><Placemark><LineString><coordinates>{}</coordinates></LineString></Placemark></kml>",
                "1,1 ".repeat(1_000_001)
            ),
        ),
        (
            Format::GeoJson,
            format!("{{\"type\":\"Polygon\",\"coordinates\":[[{}[1,1]]]}}", "[1,1],[2,2],".repeat(500_001)),
        ),
        (
            Format::GeoJson,
            format!(
                "{{\"type\":\"FeatureCollection\",\"features\":[{}]}}",
                feature.repeat(too_many).trim_end_matches(',')
            ),
        ),
    ] {
        let error = read(format, text.as_bytes(), &Assumptions::default()).unwrap_err();
        assert!(matches!(error, Error::TooMany { .. }), "{format:?}: {error}");
    }
}

#[test]
fn a_text_that_a_thousand_points_share_is_not_kept_a_thousand_times() {
    let text = "x".repeat(MAX_BYTES / 1000);
    let point = "<Point><coordinates>1,1</coordinates></Point>".repeat(1001);
    let segment = "<trkseg><trkpt lat='1' lon='1'/></trkseg>".repeat(1001);
    let points = "[1,1],".repeat(1001);
    let points = points.trim_end_matches(',');
    for (format, file) in [
        (
            Format::Kml,
            format!(
                "<kml><Placemark><description>{text}</description><MultiGeometry>{point}</MultiGeometry></Placemark></kml>"
            ),
        ),
        (Format::Gpx, format!("<gpx><trk><desc>{text}</desc>{segment}</trk></gpx>")),
        (
            Format::GeoJson,
            format!(
                "{{\"type\":\"Feature\",\"properties\":{{\"name\":\"{text}\"}},\"geometry\":{{\"type\":\"MultiPoint\",\"coordinates\":[{points}]}}}}"
            ),
        ),
    ] {
        let error = read(format, file.as_bytes(), &Assumptions::default()).unwrap_err();
        assert!(matches!(error, Error::TooMany { limit: MAX_BYTES, .. }), "{format:?}: {error}");
    }
}

#[test]
fn a_directory_of_many_packed_files_is_not_read() {
    let entry = [b"PK\x01\x02".as_slice(), &[0; 42]].concat();
    let error = read(Format::Kmz, &entry.repeat(10_001), &Assumptions::default()).unwrap_err();
    assert!(error.to_string().contains("packed files"), "{error}");
}

#[test]
fn a_runway_at_every_corner_is_refused() {
    let runway = "<Placemark><ExtendedData><Data name='legwork'><value>runway</value></Data></ExtendedData><Point><coordinates>1,1</coordinates></Point></Placemark>";
    let error =
        read(Format::Kml, format!("<kml>{}</kml>", runway.repeat(101)).as_bytes(), &Assumptions::default());
    assert!(error.unwrap_err().to_string().contains("runways"));
}

#[test]
fn take_offs_that_lead_nowhere_are_not_looked_behind_again_and_again() {
    let list = "1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t100\t1\n".repeat(MAX_ITEMS);
    let import = read(Format::Waypoints, format!("QGC WPL 110\n{list}").as_bytes(), &Assumptions::default());
    assert!(import.unwrap().plan.stages.is_empty());
}

#[test]
fn characters_that_a_plan_cannot_hold_are_left_out_of_names() {
    let kml = "<kml><Document><name>a\u{0}b</name><Placemark><name>c\u{1}d</name><Point><coordinates>1,2</coordinates></Point></Placemark></Document></kml>";
    let geojson = r#"{"type":"Feature","properties":{"name":"c\u0001d"},"geometry":{"type":"Point","coordinates":[1,2]}}"#;
    for (format, file) in [(Format::Kml, kml), (Format::GeoJson, geojson)] {
        let plan = read(format, file.as_bytes(), &Assumptions::default()).unwrap().plan;
        assert_eq!(plan.fixes[0].name, "cd");
        assert_eq!(flight_plan::read(flight_plan::write(&plan)).plan, plan, "{format:?}");
    }
}

#[test]
fn a_number_that_is_infinite_is_none() {
    for item in
        ["18\t3\t0\t-11e40020\t0\t36\t1\t50", "16\t02e308\t0\t0\t0\t36\t1\t50", "19\tinf\t0\t0\t0\t36\t1\t50"]
    {
        let list = format!("QGC WPL 110\n1\t0\t3\t{item}\t1\n");
        let plan = read(Format::Waypoints, list.as_bytes(), &Assumptions::default()).unwrap().plan;
        assert!(!plan.stages.is_empty(), "{item}");
        assert_eq!(flight_plan::read(flight_plan::write(&plan)).plan, plan, "{item}");
    }
}

#[test]
fn broken_files_say_where() {
    for (format, text, said) in [
        (Format::Waypoints, "QGC WPL 120\n", "line 1: version 120"),
        (Format::Waypoints, "hello", "line 1: this is no waypoint file"),
        (Format::Waypoints, "QGC WPL 110\n0\t1\t0\n", "line 2: an item has 12 fields, not 3"),
        (Format::Waypoints, "QGC WPL 110\n0 1 0 x 0 0 0 0 0 0 0 1\n", "line 2: `x` is no number"),
        (Format::Plan, "{\n\"fileType\": ", "line 2: not a complete JSON document"),
        (Format::Plan, "{}", "no QGroundControl plan"),
        (Format::GeoJson, "{\"type\": \"Feature\"", "no complete GeoJSON"),
        (Format::Kml, "<kml>\n<Document>", "line 2: the file ends inside"),
        (Format::Kml, "<html/>", "line 1: this is no KML file"),
        (Format::Gpx, "<kml/>", "line 1: this is no GPX file"),
        (Format::Kmz, "PK", "zip file can't be read"),
        (Format::Csv, "a,b", "only written"),
        (Format::FpXml, "<FlightPlan>\n<Locale/>", "line 2: the file ends inside"),
        (Format::FpXml, "<FlightPlan/>", "line 1: this is no flight plan of stages: it has no <MainFP>"),
    ] {
        let error = read(format, text.as_bytes(), &Assumptions::default()).unwrap_err().to_string();
        assert!(error.contains(said), "{format:?}: {error}");
    }
    assert!(
        read(Format::Kml, b"<\0k\0m\0", &Assumptions::default()).unwrap_err().to_string().contains("UTF-8")
    );
}
