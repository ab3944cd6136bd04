//! What comes unasked, and how that is changed.

use super::station::{Station, same};
use super::{ARDUPLANE, BOTH, PX4, Quirk};
use MavCmd::{MAV_CMD_GET_MESSAGE_INTERVAL as GET_INTERVAL, MAV_CMD_SET_MESSAGE_INTERVAL as SET_INTERVAL};
use MavResult::{MAV_RESULT_ACCEPTED as ACCEPTED, MAV_RESULT_DENIED as DENIED, MAV_RESULT_FAILED as FAILED};
use anyhow::Context;
use mavlink::Message;
use mavlink::dialects::ardupilotmega::*;
use std::collections::BTreeSet;

const HEARTBEAT: f32 = 0.0;
const ATTITUDE: f32 = 30.0;
/// A message that nobody has.
const NO_MESSAGE: f32 = 9999.0;

fn interval(id: f32, us: f32) -> [f32; 7] {
    [id, us, 0., 0., 0., 0., 0.]
}

pub(super) const QUIRKS: &[Quirk] = &[
    Quirk {
        name: "telemetry_comes_unasked",
        of: ARDUPLANE,
        does: "SYS_STATUS, SYSTEM_TIME, GPS_RAW_INT, SCALED_PRESSURE, ATTITUDE, GLOBAL_POSITION_INT, MISSION_CURRENT, \
               VFR_HUD, BATTERY_STATUS and WIND come unasked",
        check: |s| come(s, &[1, 2, 24, 29, 30, 33, 42, 74, 147, 168]),
        flies: false,
    },
    Quirk {
        name: "telemetry_comes_unasked_with_other_names",
        of: PX4,
        does: "SYS_STATUS, GPS_RAW_INT, SCALED_PRESSURE, ATTITUDE, GLOBAL_POSITION_INT, MISSION_CURRENT, VFR_HUD, \
               ALTITUDE, BATTERY_STATUS, HOME_POSITION, EXTENDED_SYS_STATE and ESC_STATUS come unasked",
        check: |s| come(s, &[1, 24, 29, 30, 33, 42, 74, 141, 147, 242, 245, 291]),
        flies: false,
    },
    Quirk {
        name: "intervals_can_be_set_and_asked_for",
        of: BOTH,
        does: "`SET_MESSAGE_INTERVAL` 0.5 s of ATTITUDE is accepted, and so it is told",
        check: |s| {
            s.expect(SET_INTERVAL, interval(ATTITUDE, 500_000.), ACCEPTED)?;
            let told = told_interval(s, ATTITUDE)?;
            s.expect(SET_INTERVAL, interval(ATTITUDE, 0.), ACCEPTED)?;
            same("interval", told, 500_000)
        },
        flies: false,
    },
    Quirk {
        name: "message_that_is_stopped_has_no_interval",
        of: BOTH,
        does: "`SET_MESSAGE_INTERVAL` −1 stops a message, and so it is told",
        check: |s| {
            s.expect(SET_INTERVAL, interval(ATTITUDE, -1.), ACCEPTED)?;
            let told = told_interval(s, ATTITUDE)?;
            s.expect(SET_INTERVAL, interval(ATTITUDE, 0.), ACCEPTED)?;
            same("interval", told, -1)
        },
        flies: false,
    },
    Quirk {
        name: "interval_of_no_message_is_denied",
        of: ARDUPLANE,
        does: "`SET_MESSAGE_INTERVAL` of 9999: DENIED",
        check: |s| s.expect(SET_INTERVAL, interval(NO_MESSAGE, 1e6), DENIED),
        flies: false,
    },
    Quirk {
        name: "interval_of_no_message_has_failed",
        of: PX4,
        does: "`SET_MESSAGE_INTERVAL` of 9999: FAILED",
        check: |s| s.expect(SET_INTERVAL, interval(NO_MESSAGE, 1e6), FAILED),
        flies: false,
    },
    Quirk {
        name: "heartbeat_is_nobodys_to_change",
        of: PX4,
        does: "`SET_MESSAGE_INTERVAL` of HEARTBEAT: FAILED",
        check: |s| s.expect(SET_INTERVAL, interval(HEARTBEAT, 2e6), FAILED),
        flies: false,
    },
    Quirk {
        name: "time_is_answered",
        of: BOTH,
        does: "a `TIMESYNC` comes back with the time that it was sent",
        check: |s| s.answers(|_| Some(())).map(drop),
        flies: false,
    },
];

/// These messages come, although nobody has asked.
fn come(s: &mut Station, wanted: &[u32]) -> anyhow::Result<()> {
    let mut missing: BTreeSet<u32> = wanted.iter().copied().collect();
    let all = s.hear("all of them", |message| {
        missing.remove(&message.message_id());
        missing.is_empty().then_some(())
    });
    all.with_context(|| format!("missing: {missing:?}"))
}

fn told_interval(s: &mut Station, id: f32) -> anyhow::Result<i32> {
    s.forget();
    s.say_command(GET_INTERVAL, interval(id, 0.));
    s.hear("MESSAGE_INTERVAL", |message| match message {
        MavMessage::MESSAGE_INTERVAL(told) if f32::from(told.message_id) == id => Some(told.interval_us),
        _ => None,
    })
}
