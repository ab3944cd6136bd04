//! What the recorder writes, read again.
#![cfg(test)]

mod common;

use common::{Rig, UNIX, cbor, frame, ms, numbered, position};
use recording::{Config, Contents, Ending, Frame, Input, Level, Payload, Report, Schema, scan};
use serde_json::{Value, json};
use std::time::Duration;

type Messages = Vec<(String, u64, Value)>;

/// What a file holds, with its messages: topic, time, payload.
fn read(bytes: &[u8]) -> (Contents, Messages) {
    let mut messages = Vec::new();
    let contents = scan(bytes, &mut |m| {
        messages.push((m.channel.topic.clone(), m.log_ns, serde_json::from_slice(m.data).unwrap()));
    });
    (contents.unwrap(), messages)
}

fn of<'a>(messages: &'a Messages, topic: &str) -> Vec<&'a Value> {
    messages.iter().filter(|m| m.0 == topic).map(|m| &m.2).collect()
}

fn rig() -> Rig {
    Rig::new(Config::new("uav1"))
}

#[test]
fn frame_becomes_a_message_of_its_key_with_its_schema() {
    let mut rig = rig();
    let schema = br#"{"type":"object"}"#;
    let of_count = Schema {
        key: "legwork/any/counter/variable/count".into(),
        name: "Count".into(),
        text: schema.to_vec(),
    };
    rig.step(ms(0), Input::Schema(of_count));
    rig.frame(ms(10), numbered("uav1", 7, ms(10)));
    let odd = json!({"a": [1, null, "ü"]});
    rig.frame(ms(20), frame("legwork/uav1/third-party/event/things", ms(20), &odd));
    rig.step(ms(30), Input::Close);
    let (contents, messages) = read(&rig.files[0].1);
    assert_eq!((contents.ending, contents.findings.as_slice(), rig.finished), (Ending::Finished, &[][..], 1));
    let channels: Vec<_> = contents.channels.values().collect();
    assert_eq!(channels[0].topic, "legwork/uav1/counter/variable/count");
    assert_eq!((channels[0].schema.as_str(), &*channels[0].schema_data), ("Count", &schema[..]));
    assert_eq!((channels[1].schema.as_str(), channels[1].encoding.as_str()), ("", "json"));
    assert_eq!(messages[0].1, u64::try_from((UNIX + ms(10)).as_nanos()).unwrap());
    assert_eq!(messages[0].2["value"]["number"], 7);
    assert_eq!(messages[1].2, odd);
    assert_eq!(contents.metadata[0].1["vehicle"], "uav1");
}

#[test]
fn other_readers_read_it_too() {
    let mut rig = rig();
    for i in 0..200 {
        rig.frame(ms(10 * i), position(ms(10 * i)));
    }
    rig.step(ms(2000), Input::Close);
    let bytes = &rig.files[0].1;
    let summary = mcap::Summary::read(bytes).unwrap().unwrap();
    let stats = summary.stats.unwrap();
    let messages = mcap::MessageStream::new(bytes).unwrap().map(Result::unwrap).count();
    assert_eq!(stats.message_count, messages as u64);
    assert_eq!(stats.chunk_count as usize, summary.chunk_indexes.len());
    assert!(stats.chunk_count > 30, "chunks are small: {}", stats.chunk_count);
    let fixes = summary.channels.values().find(|c| c.topic == "foxglove/uav1/location").unwrap();
    assert_eq!(fixes.schema.as_ref().unwrap().name, "foxglove.LocationFix");
}

#[test]
fn position_is_a_place_on_the_map_and_the_path_is_drawn_every_minute() {
    let mut rig = rig();
    for second in 0..150 {
        rig.frame(ms(1000 * second), position(ms(1000 * second)));
    }
    rig.step(ms(150_000), Input::Plan("{\"type\":\"FeatureCollection\",\"features\":[]}".into()));
    rig.frame(ms(200_000), position(ms(200_000)));
    rig.step(ms(200_000), Input::Close);
    let (_, messages) = read(&rig.files[0].1);
    let fixes = of(&messages, "foxglove/uav1/location");
    assert_eq!(fixes.len(), 151);
    assert!((fixes[2]["latitude"].as_f64().unwrap() - 36.30002).abs() < 1e-9);
    assert_eq!(fixes[2]["timestamp"]["sec"], UNIX.as_secs() + 2);
    let paths = of(&messages, "foxglove/uav1/path");
    let points: Vec<usize> = paths
        .iter()
        .map(|p| {
            let drawing: Value = serde_json::from_str(p["geojson"].as_str().unwrap()).unwrap();
            drawing["features"][0]["geometry"]["coordinates"].as_array().unwrap().len()
        })
        .collect();
    assert_eq!(points, [61, 121, 151]);
    assert_eq!(of(&messages, "foxglove/uav1/plan").len(), 2, "at its change, and at the next minute");
}

#[test]
fn services_log_lines_are_foxgloves() {
    let mut rig = rig();
    let line = json!({"time_s": 1.0, "validity_s": 1.0, "value": {"level": "WARN", "target": "link", "message": "lost"}});
    rig.frame(ms(1), frame("legwork/uav1/gateway/event/log", ms(1), &line));
    rig.step(ms(2), Input::Line { level: Level::Info, message: "mended".into() });
    rig.step(ms(3), Input::Close);
    let (_, messages) = read(&rig.files[0].1);
    let told: Vec<_> = of(&messages, "foxglove/uav1/log")
        .iter()
        .map(|l| (l["level"].as_u64().unwrap(), l["name"].as_str().unwrap(), l["message"].as_str().unwrap()))
        .collect();
    assert_eq!(told, [(3, "gateway", "link: lost"), (2, "storage", "mended")]);
}

#[test]
fn files_are_ended_by_size_and_each_knows_the_documents() {
    let mut rig = Rig::new(Config { file_bytes: 20_000, ..Config::new("uav1") });
    let plan = Frame {
        payload: cbor(&json!({"xml": "<p/>"})),
        ..frame("legwork/uav1/fp-manager/invocation/plan", ms(0), &json!(0))
    };
    rig.step(ms(0), Input::Document(plan));
    for i in 0..1000 {
        rig.frame(ms(10 * i), numbered("uav1", i, ms(10 * i)));
    }
    rig.step(ms(10_000), Input::Close);
    assert!(rig.files.len() > 3 && rig.finished == rig.files.len(), "{} files", rig.files.len());
    let mut next = 0;
    for (name, bytes) in &rig.files {
        assert!(bytes.len() < 40_000, "{name} has {}", bytes.len());
        let (contents, messages) = read(bytes);
        assert_eq!((contents.ending, contents.findings.len()), (Ending::Finished, 0));
        assert_eq!(messages[0].0, "legwork/uav1/fp-manager/invocation/plan");
        for count in of(&messages, "legwork/uav1/counter/variable/count") {
            assert_eq!(count["value"]["number"], next);
            next += 1;
        }
    }
    assert_eq!(next, 1000);
}

#[test]
fn what_is_lost_before_and_what_cannot_be_read_is_counted_and_stands_in_the_file() {
    let mut rig = Rig::new(Config { message_bytes: 1000, ..Config::new("uav1") });
    rig.step(ms(0), Input::Missed { count: 5, why: "the recorder does not keep up" });
    rig.frame(
        ms(1),
        Frame { key: "legwork/a/b/event/c".into(), at: ms(1), payload: Payload::Cbor(vec![0xff]) },
    );
    rig.frame(
        ms(2),
        Frame { key: "legwork/a/b/event/c".into(), at: ms(2), payload: Payload::Json(b"{".to_vec()) },
    );
    rig.frame(ms(3), frame("legwork/a/b/event/c", ms(3), &json!("x".repeat(2000))));
    rig.frame(ms(2000), numbered("uav1", 1, ms(2000)));
    rig.step(ms(2001), Input::Close);
    assert_eq!(rig.recorder.status().missed, 8);
    let counts: Vec<u64> = rig
        .reports
        .iter()
        .map(|r| match r {
            Report::Missed { count, .. } => *count,
            other => panic!("{other}"),
        })
        .collect();
    assert_eq!(counts, [5, 3], "told at once, then together");
    let (_, messages) = read(&rig.files[0].1);
    assert_eq!(of(&messages, "foxglove/uav1/log").len(), 2);
}

#[test]
fn full_disk_is_told_once_counted_and_left_behind() {
    let mut rig = rig();
    rig.frame(ms(0), numbered("uav1", 0, ms(0)));
    rig.until(ms(100));
    rig.broken = true;
    for i in 1..1000 {
        rig.frame(ms(100 + 20 * i), numbered("uav1", i, ms(20 * i)));
    }
    assert!(rig.recorder.status().failure.is_some());
    assert_eq!(rig.reports.len(), 1, "{:?}", rig.reports);
    rig.broken = false;
    for i in 1000..2000 {
        rig.frame(ms(100 + 20 * i), numbered("uav1", i, ms(20 * i)));
    }
    rig.step(ms(50_000), Input::Close);
    let status = rig.recorder.status();
    assert_eq!(status.failure, None);
    let in_files: usize = rig
        .files
        .iter()
        .map(|(_, bytes)| of(&read(bytes).1, "legwork/uav1/counter/variable/count").len())
        .sum();
    assert_eq!(in_files as u64 + status.missed, 2000);
    let (_, messages) = read(&rig.files.last().unwrap().1);
    let told = of(&messages, "foxglove/uav1/log")[0]["message"].as_str().unwrap().to_owned();
    assert!(told.contains("goes on") && told.contains(&status.missed.to_string()), "{told}");
    assert_eq!(rig.reports.len(), 2, "{:?}", rig.reports);
}

#[test]
fn clock_that_jumps_is_told_and_begins_a_new_file() {
    let mut rig = rig();
    rig.frame(ms(0), numbered("uav1", 0, ms(0)));
    rig.step(ms(70_000), Input::Clock(UNIX + ms(70_400)));
    assert_eq!(rig.reports, [], "less than a second is nothing");
    rig.step(ms(80_000), Input::Clock(UNIX + ms(3_680_000)));
    rig.frame(ms(80_001), numbered("uav1", 1, ms(80_001)));
    rig.step(ms(90_000), Input::Clock(UNIX - ms(3_510_000)));
    rig.frame(ms(90_001), numbered("uav1", 2, ms(90_001)));
    rig.step(ms(90_002), Input::Close);
    let jumps: Vec<f64> = rig
        .reports
        .iter()
        .map(|r| match r {
            Report::ClockJumped { by_s } => *by_s,
            other => panic!("{other}"),
        })
        .collect();
    assert_eq!(jumps.len(), 2);
    assert!((jumps[0] - 3600.0).abs() < 0.1 && (jumps[1] + 7200.0).abs() < 0.1, "{jumps:?}");
    assert_eq!(rig.files.len(), 2, "a clock that goes mad does not flood the disk with files");
    let (_, messages) = read(&rig.files[1].1);
    let times: Vec<u64> = messages.iter().map(|m| m.1).collect();
    assert!(times.is_sorted() && times[0] >= u64::try_from((UNIX + ms(3_600_000)).as_nanos()).unwrap());
}

#[test]
fn flood_of_channels_is_bounded() {
    let mut rig = rig();
    for i in 0..5000 {
        rig.frame(ms(1), frame(&format!("legwork/uav1/x/variable/v{i}"), ms(1), &json!(i)));
    }
    rig.step(ms(2), Input::Close);
    let (contents, _) = read(&rig.files[0].1);
    assert!(contents.channels.len() <= 4096);
    assert!(rig.recorder.status().missed >= 900);
}

/// 20 vehicles, 50 messages a second each, without a loss. An hour where it is asked for: `LEGWORK_RECORD_S=3600`.
#[test]
fn twenty_vehicles_for_long_without_a_loss() {
    let seconds = std::env::var("LEGWORK_RECORD_S").ok().and_then(|s| s.parse().ok()).unwrap_or(20);
    let vehicles: Vec<String> = (0..20).map(|v| format!("uav{v}")).collect();
    let mut rig = Rig::new(Config { file_bytes: 8 << 20, ..Config::new("fleet") });
    let (mut held, mut next) = (0u64, [0u64; 20]);
    for tick in 0..seconds * 50 {
        let now = ms(20 * tick);
        for vehicle in &vehicles {
            rig.frame(now, numbered(vehicle, tick, now));
        }
        while rig.files.len() > 1 {
            held += drained(&rig.files.remove(0).1, &mut next);
        }
    }
    rig.step(Duration::from_secs(seconds), Input::Close);
    for (_, bytes) in &rig.files {
        held += drained(bytes, &mut next);
    }
    assert_eq!((held, rig.recorder.status().missed), (seconds * 50 * 20, 0));
    assert_eq!(next, [seconds * 50; 20], "each vehicle's, in order, none missing");
}

fn drained(bytes: &[u8], next: &mut [u64; 20]) -> u64 {
    let mut count = 0;
    let contents = scan(bytes, &mut |m| {
        let vehicle: usize =
            m.channel.topic["legwork/uav".len()..].split('/').next().unwrap().parse().unwrap();
        let value: Value = serde_json::from_slice(m.data).unwrap();
        assert_eq!(value["value"]["number"], next[vehicle]);
        next[vehicle] += 1;
        count += 1;
    });
    assert_eq!(contents.unwrap().findings, []);
    count
}

#[test]
fn name_that_is_taken_costs_what_was_underway_and_nothing_else() {
    let mut rig = rig();
    rig.taken.push("uav1-20251123T080000Z-001.mcap".into());
    for n in 0..10 {
        rig.frame(ms(10 * n), numbered("uav1", n, ms(10 * n)));
    }
    rig.step(ms(200), Input::Close);
    assert_eq!(rig.files.len(), 1);
    assert_eq!(rig.files[0].0, "uav1-20251123T080000Z-002.mcap");
    let status = rig.recorder.status();
    assert_eq!((status.missed, status.failure), (1, None), "the frame with which the file began");
    assert_eq!(of(&read(&rig.files[0].1).1, "legwork/uav1/counter/variable/count").len(), 9);
}
