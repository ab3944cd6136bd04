//! CPU per message, beside a bare write with the `mcap` crate in the same run: `cargo bench -p recording`.
#![allow(
    clippy::expect_used,
    clippy::disallowed_methods,
    reason = "a bench looks at the clock, and fails by panicking"
)]

use divan::{Bencher, black_box, counter::ItemsCount};
use mcap::records::MessageHeader;
use mcap::{WriteOptions, write::NoSeek};
use recording::{Config, Frame, Input, Payload, Recorder};
use serde_json::json;
use std::collections::BTreeMap;
use std::io::sink;
use std::time::{Duration, Instant};

/// Messages of a run: 20 vehicles, 50 a second each, for 20 seconds.
const MESSAGES: u64 = 20_000;
/// Between two of them, on the recorder's clock.
const INTERVAL: Duration = Duration::from_millis(1);

fn value() -> serde_json::Value {
    json!({
        "time_s": 1234.56, "validity_s": 3.0,
        "value": {"roll_deg": 1.5, "pitch_deg": 2.5, "heading_deg": 230.1, "roll_rate_dps": 0.01, "pitch_rate_dps": 0.02,
            "yaw_rate_dps": 0.03},
    })
}

fn cbor() -> Payload {
    let mut bytes = Vec::new();
    ciborium::into_writer(&value(), &mut bytes).expect("CBOR");
    Payload::Cbor(bytes)
}

fn keys() -> Vec<String> {
    (0..20).map(|v| format!("legwork/uav{v}/gateway/variable/attitude")).collect()
}

/// With the library alone: JSON that is there already, chunks of the same age.
fn bare(keys: &[String], data: &[u8]) {
    let mut writer = WriteOptions::new()
        .compression(None)
        .chunk_size(None)
        .disable_seeking(true)
        .create(NoSeek::new(sink()))
        .expect("a writer");
    let channels: Vec<u16> =
        keys.iter().map(|k| writer.add_channel(0, k, "json", &BTreeMap::new()).expect("a channel")).collect();
    for (i, channel_id) in (0..MESSAGES).zip(channels.iter().copied().cycle()) {
        let header = MessageHeader { channel_id, sequence: 0, log_time: i, publish_time: i };
        writer.write_to_known_channel(&header, black_box(data)).expect("written");
        if i % 50 == 49 {
            writer.flush().expect("flushed");
        }
    }
}

/// With the recorder, as frames come from the network.
fn recorded(keys: &[String], payload: &Payload) {
    let mut recorder = Recorder::new(Config::new("fleet"));
    let (mut out, mut now) = (Vec::new(), Duration::ZERO);
    for (_, key) in (0..MESSAGES).zip(keys.iter().cycle()) {
        now += INTERVAL;
        let frame = Frame { key: key.clone(), at: now, payload: payload.clone() };
        recorder.step(now, Input::Frame(black_box(frame)), &mut out);
        out.clear();
    }
}

#[divan::bench(sample_count = 20)]
fn bare_mcap_write(bencher: Bencher<'_, '_>) {
    let (keys, data) = (keys(), value().to_string().into_bytes());
    bencher.counter(ItemsCount::new(MESSAGES)).bench_local(|| bare(&keys, &data));
}

#[divan::bench(sample_count = 20)]
fn recorder_json(bencher: Bencher<'_, '_>) {
    let (keys, data) = (keys(), Payload::Json(value().to_string().into_bytes()));
    bencher.counter(ItemsCount::new(MESSAGES)).bench_local(|| recorded(&keys, &data));
}

#[divan::bench(sample_count = 20)]
fn recorder_cbor(bencher: Bencher<'_, '_>) {
    let (keys, data) = (keys(), cbor());
    bencher.counter(ItemsCount::new(MESSAGES)).bench_local(|| recorded(&keys, &data));
}

/// The best of several runs, per message.
fn best(run: impl Fn()) -> Duration {
    let time = |()| {
        let began = Instant::now();
        run();
        began.elapsed() / u32::try_from(MESSAGES).unwrap_or(u32::MAX)
    };
    (0..10).map(|_| time(())).min().unwrap_or_default()
}

fn main() {
    divan::main();
    let keys = keys();
    let json = value().to_string().into_bytes();
    let (bare, with_json, with_cbor) = (
        best(|| bare(&keys, &json)),
        best(|| recorded(&keys, &Payload::Json(json.clone()))),
        best(|| recorded(&keys, &cbor())),
    );
    let ratio = |time: Duration| time.as_secs_f64() / bare.as_secs_f64();
    println!(
        "per message: bare {bare:?}; recorder from JSON {with_json:?} ({:.1} ×), from CBOR {with_cbor:?} ({:.1} ×)",
        ratio(with_json),
        ratio(with_cbor)
    );
}
