//! What was found out, in words: whether a plan can be flown, and what to change.

use super::super::driver::{self, unsupported};
use super::super::session::is_armed;
use super::{Looked, SETTLED};
use crate::gateway::driver::examination::{Degree, Finding};
use crate::gateway::order::Time;
use mavlink::MessageData;
use mavlink::dialects::ardupilotmega::*;

/// What the plan's flying and Safe mode steer by, and how often it has to come, 1/s: half of what is asked for.
const STREAMS: [(u32, &str, f64); 2] =
    [(GLOBAL_POSITION_INT_DATA::ID, "position", 5.0), (ATTITUDE_DATA::ID, "attitude", 5.0)];
/// With less a flight does not begin, per cent.
const BATTERY_LOW: i8 = 30;

/// All findings, what it is first.
pub fn findings(looked: &Looked, now: Time) -> Vec<Finding> {
    let Some((_, beat)) = &looked.heard else { return vec![] };
    let Some(dialect) = looked.dialect else {
        return vec![to_do("autopilot", unsupported((beat.autopilot, beat.mavtype)))];
    };
    let mut all = vec![ok("autopilot", format!("{}, system {}", dialect.kind.name, system(looked)))];
    all.push(version(looked.version, dialect.flown));
    all.push(place(beat));
    all.extend(needed(looked));
    all.extend(advised(looked));
    all.push(gps(looked));
    all.push(home(looked));
    all.push(battery(looked));
    all.extend(STREAMS.iter().map(|(id, name, least)| stream(looked, now, *id, name, *least)));
    all.push(arming(looked, now));
    all
}

fn ok(about: &'static str, says: impl Into<String>) -> Finding {
    Finding::new(Degree::Ok, about, says)
}

fn to_do(about: &'static str, says: impl Into<String>) -> Finding {
    Finding::new(Degree::ToDo, about, says)
}

fn note(about: &'static str, says: impl Into<String>) -> Finding {
    Finding::new(Degree::Note, about, says)
}

fn system(looked: &Looked) -> u8 {
    looked.session.peer().map_or(0, |peer| peer.system)
}

fn version(said: Option<u32>, flown: [u8; 2]) -> Finding {
    let Some(version) = said.and_then(driver::version) else {
        return note("version", "it does not say its version");
    };
    let [major, minor] = flown;
    if version.series == flown {
        return ok("version", format!("{version}, of the {major}.{minor} that this agent has flown"));
    }
    note(
        "version",
        format!(
            "{version}: this agent has flown {major}.{minor}; fly this one in its simulation first, for it may have other habits"
        ),
    )
}

fn place(beat: &HEARTBEAT_DATA) -> Finding {
    if is_armed(beat) {
        return to_do("state", "it is armed: look it over on the ground, disarmed");
    }
    ok("state", "disarmed")
}

fn needed(looked: &Looked) -> Option<Finding> {
    let need = looked.dialect?.need?;
    Some(match need.verdict(&looked.needed) {
        Some(Ok(())) => {
            ok("parameters", format!("{} is {}, or this version has none", need.name, need.wanted))
        }
        Some(Err(why)) => to_do("parameters", why),
        None => to_do("parameters", format!("{} was asked for and not told: check the link", need.name)),
    })
}

fn advised(looked: &Looked) -> Vec<Finding> {
    let advice = looked.dialect.map_or(&[][..], |dialect| dialect.advice);
    let judged = advice.iter().filter_map(|advice| {
        let value = *looked.advised.get(advice.name)?;
        let name = advice.name;
        Some(match (advice.is_good)(value) {
            true => ok("parameters", format!("{name} is {value}")),
            false => Finding::new(advice.degree, "parameters", advice.sentence(value)),
        })
    });
    let silent = advice.iter().filter(|advice| !looked.advised.contains_key(advice.name));
    let silent =
        silent.map(|a| note("parameters", format!("this version has no {}, or does not tell it", a.name)));
    judged.chain(silent).collect()
}

fn gps(looked: &Looked) -> Finding {
    match looked.gps {
        None => to_do("gps", "nothing is told of it: check that the autopilot has one and sends GPS_RAW_INT"),
        Some((fix, satellites)) if fix as u32 >= GpsFixType::GPS_FIX_TYPE_3D_FIX as u32 => {
            ok("gps", format!("3D fix, {satellites} satellites"))
        }
        Some((_, satellites)) => to_do(
            "gps",
            format!("no 3D fix ({satellites} satellites): give the antenna a free view of the sky, and wait"),
        ),
    }
}

fn home(looked: &Looked) -> Finding {
    match looked.has_home {
        true => ok("home", "the take-off place is set"),
        false => to_do("home", "no take-off place is set: it comes with the first good fix, wait for it"),
    }
}

fn battery(looked: &Looked) -> Finding {
    let Some(power) = &looked.power else {
        return to_do("battery", "nothing is told of it: check that the autopilot sends SYS_STATUS");
    };
    let volts = f64::from(power.voltage_battery) / 1000.0;
    match power.battery_remaining {
        _ if matches!(power.voltage_battery, 0 | u16::MAX) => to_do(
            "battery",
            "it is not measured: set up the battery monitor; without it nobody knows when to come home",
        ),
        ..0 => to_do(
            "battery",
            format!("{volts:.1} V, but how much is left is not known: set the battery's capacity"),
        ),
        left if left < BATTERY_LOW => to_do("battery", format!("{volts:.1} V, {left} %: charge it")),
        left => ok("battery", format!("{volts:.1} V, {left} %")),
    }
}

fn stream(looked: &Looked, now: Time, id: u32, name: &str, least: f64) -> Finding {
    let since = looked.heard.as_ref().map_or(now, |(since, _)| *since + SETTLED);
    let seconds = now.saturating_sub(since).as_secs_f64().max(1.0);
    let rate = f64::from(looked.counts.get(&id).copied().unwrap_or_default()) / seconds;
    if rate >= least {
        return ok("streams", format!("{name} {rate:.0} times a second"));
    }
    to_do(
        "streams",
        format!(
            "{name} comes {rate:.1} times a second, {least:.0} are needed: raise the rates of this port (SRn_… of \
             ArduPilot, MAV_n_RATE of PX4), or its baud rate"
        ),
    )
}

fn arming(looked: &Looked, now: Time) -> Finding {
    let said = looked.session.words.lately(now);
    let check = MavSysStatusSensor::MAV_SYS_STATUS_PREARM_CHECK;
    let told = looked.power.as_ref().filter(|power| power.onboard_control_sensors_present.contains(check));
    match (told.map(|power| power.onboard_control_sensors_health.contains(check)), said) {
        (Some(true), None) => ok("arming", "its own checks are passed"),
        (Some(true), Some(said)) => {
            note("arming", format!("its own checks are passed; lately it said: {said}"))
        }
        (Some(false), None) => {
            to_do("arming", "it would refuse to arm, and does not say why: see its own ground station")
        }
        (Some(false), Some(said)) => to_do("arming", format!("it would refuse to arm: {said}")),
        (None, Some(said)) => to_do("arming", format!("it warns: {said}")),
        (None, None) => note("arming", "it does not say whether it would arm, and warns of nothing"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_version_that_was_not_flown_is_told_with_the_one_that_was() {
        let flown = version(Some(0x0407_0000), [4, 7]);
        assert_eq!((flown.degree, flown.says.starts_with("4.7.0-dev, ")), (Degree::Ok, true), "{flown:?}");
        let other = version(Some(0x0405_01FF), [4, 7]);
        assert_eq!(other.degree, Degree::Note);
        assert!(other.says.starts_with("4.5.1: ") && other.says.contains("4.7"), "{other:?}");
        assert_eq!(version(None, [4, 7]).degree, Degree::Note);
        assert_eq!(version(Some(0), [4, 7]).degree, Degree::Note);
    }
}
