//! CPU per message of telemetry: from the bytes of a link through the driver to what the gateway's core is told, beside a bare decode
//! of the same bytes with the `mavlink` crate in the same run. Prints nanoseconds for each message, and the ratio.
#![expect(clippy::unwrap_used, reason = "a bench ends where it can't go on")]

use autopilot_link::Outbox;
use mavlink::dialects::ardupilotmega::*;
use mavlink::{MavHeader, MavlinkVersion, Message, calculate_crc};
use onboard_agent::gateway::driver::{DEFAULT, Driver, FromLink, Setup};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Bytes of a frame before its payload.
const HEADER: usize = 10;
/// Seconds of telemetry in a run, and messages in each.
const SECONDS: u64 = 200;
const A_SECOND: usize = 50;
/// Runs of each, one after the other, so that whatever else the machine does hits both.
const RUNS: usize = 15;

fn main() {
    let telemetry: Vec<Vec<u8>> = (0..SECONDS).map(second).collect();
    let (mut bare, mut through) = (vec![], vec![]);
    for _ in 0..RUNS {
        bare.push(per_message(|| telemetry.iter().map(|bytes| decode(bytes)).sum()));
        let mut driver = (DEFAULT.make)(&Setup::default());
        drive(&mut *driver, Duration::ZERO, &frame(0, &heartbeat()));
        let mut now = Duration::ZERO;
        through.push(per_message(|| {
            let pieces = telemetry.iter().map(|bytes| {
                now += Duration::from_secs(1);
                drive(&mut *driver, now, bytes)
            });
            pieces.sum()
        }));
    }
    let (bare_ns, through_ns) = (median(&mut bare), median(&mut through));
    println!("bare decode    {bare_ns:7.0} ns a message");
    println!("through driver {through_ns:7.0} ns a message, {:.2} x bare", through_ns / bare_ns);
}

/// Nanoseconds for each message of a run; `run` gives how many there were.
fn per_message(run: impl FnOnce() -> usize) -> f64 {
    let begun = Instant::now();
    let count = run();
    assert_eq!(count, SECONDS as usize * A_SECOND, "every message is decoded");
    begun.elapsed().as_nanos() as f64 / count as f64
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Checksum and fields of each frame, which no decoder can do without.
fn decode(mut bytes: &[u8]) -> usize {
    let mut count = 0;
    while let Some((&[_, length, _, _, _, _, _, a, b, c], rest)) = bytes.split_first_chunk::<HEADER>() {
        let id = u32::from_le_bytes([a, b, c, 0]);
        let (payload, rest) = rest.split_at(length.into());
        let summed = calculate_crc(&bytes[1..HEADER + payload.len()], MavMessage::extra_crc(id));
        let (checksum, rest) = rest.split_first_chunk::<2>().unwrap();
        assert_eq!(u16::from_le_bytes(*checksum), summed);
        black_box(MavMessage::parse(MavlinkVersion::V2, id, payload).unwrap());
        (bytes, count) = (rest, count + 1);
    }
    count
}

/// Takes bytes in and does all that follows; how many messages there were in them.
fn drive(driver: &mut dyn Driver, now: Duration, bytes: &[u8]) -> usize {
    driver.receive(0, FromLink::Stream(bytes));
    let mut count = 0;
    while driver.process(now) {
        count += 1;
        std::iter::from_fn(|| driver.next_report()).for_each(|report| drop(black_box(report)));
    }
    let mut outbox = Outbox::default();
    driver.send(&mut outbox);
    count
}

/// What an autopilot sends in a second.
fn second(at: u64) -> Vec<u8> {
    (0..A_SECOND).flat_map(|n| frame((at as usize * A_SECOND + n) as u8, &message(at, n))).collect()
}

fn message(at: u64, n: usize) -> MavMessage {
    let time_boot_ms = (at * 1000) as u32 + 20 * n as u32;
    match n % 5 {
        _ if n == 0 => heartbeat(),
        0 | 2 => MavMessage::ATTITUDE(ATTITUDE_DATA { time_boot_ms, roll: 0.1, ..ATTITUDE_DATA::DEFAULT }),
        1 | 3 => MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
            time_boot_ms,
            lat: 363_190_000 + n as i32,
            lon: -841_730_000,
            alt: 450_000,
            relative_alt: 100_000,
            vx: 2200,
            ..GLOBAL_POSITION_INT_DATA::DEFAULT
        }),
        _ => MavMessage::VFR_HUD(VFR_HUD_DATA { airspeed: 22.0, throttle: 40, ..VFR_HUD_DATA::DEFAULT }),
    }
}

fn heartbeat() -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        mavtype: MavType::MAV_TYPE_FIXED_WING,
        autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
        ..HEARTBEAT_DATA::DEFAULT
    })
}

fn frame(sequence: u8, message: &MavMessage) -> Vec<u8> {
    let mut bytes = vec![];
    let header = MavHeader { system_id: 1, component_id: 1, sequence };
    mavlink::write_v2_msg(&mut bytes, header, message).unwrap();
    bytes
}
