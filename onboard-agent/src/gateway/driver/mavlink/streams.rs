//! Which messages the autopilot is to send, and how often. Asked for again when they don't come, or come too seldom: the order may
//! have been lost.

use super::Peer;
use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::*;
use mavlink::{Message, MessageData};
use std::time::Duration;

/// So long a message's rate is observed before it is asked for again.
const OBSERVED: Duration = Duration::from_secs(3);
/// And each time twice as long, up to so many times: an autopilot may have its reasons.
const MAX_DOUBLINGS: u32 = 5;

/// What came before and has not for so long has stopped.
const STOPPED: Duration = Duration::from_secs(10);

/// `(message, interval in milliseconds, what it says)`; interval 0: asked for once, until it comes. What says nothing that is missed has no
/// name: some autopilots steer nowhere while somebody flies by hand, and do not send it.
const WANTED: [(u32, u32, &str); 17] = [
    (GLOBAL_POSITION_INT_DATA::ID, 100, "position"),
    (ATTITUDE_DATA::ID, 100, "attitude"),
    (MISSION_CURRENT_DATA::ID, 100, "place on the list"),
    (VFR_HUD_DATA::ID, 200, "airspeed"),
    (GPS_RAW_INT_DATA::ID, 400, "GPS"),
    (SYS_STATUS_DATA::ID, 500, "battery"),
    (WIND_DATA::ID, 500, "wind"),
    (WIND_COV_DATA::ID, 500, "wind"),
    (RPM_DATA::ID, 500, "engine speed"),
    (EFI_STATUS_DATA::ID, 1000, "engine"),
    (FUEL_STATUS_DATA::ID, 1000, "fuel"),
    (SCALED_PRESSURE_DATA::ID, 1000, "pressure"),
    (SYSTEM_TIME_DATA::ID, 1000, "time of day"),
    (EXTENDED_SYS_STATE_DATA::ID, 500, "whether it stands"),
    (POSITION_TARGET_GLOBAL_INT_DATA::ID, 1000, ""),
    (HOME_POSITION_DATA::ID, 0, "home"),
    (AUTOPILOT_VERSION_DATA::ID, 0, "version"),
];

/// Without these nothing is flown; each autopilot has them, and they are missed even if they never came.
const NEEDED: [u32; 5] = [
    GLOBAL_POSITION_INT_DATA::ID,
    ATTITUDE_DATA::ID,
    MISSION_CURRENT_DATA::ID,
    VFR_HUD_DATA::ID,
    GPS_RAW_INT_DATA::ID,
];

/// How ArduPilot begins to say that it has no such message; its number and a bracket follow.
const LACKING: &str = "No ap_message for mavlink id (";

/// Of these each autopilot has one.
const WINDS: [u32; 2] = [WIND_DATA::ID, WIND_COV_DATA::ID];

/// What came of each.
#[derive(Debug, Clone, Default)]
pub struct Streams {
    streams: [Stream; WANTED.len()],
    /// What was last said of those that have stopped.
    told: Vec<&'static str>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Stream {
    /// When it was first asked for; `None`: never.
    asked: Option<Time>,
    /// Counted since then; `None`: not asked for over this link.
    since: Option<Time>,
    count: u32,
    /// Asked for in vain, one time after the other.
    in_vain: u32,
    /// The autopilot has said that it has no such message.
    is_lacking: bool,
    /// When it came last.
    came: Option<Time>,
    /// It is asked for once, and has come over this link.
    is_got: bool,
}

impl Stream {
    /// It has to be asked for: the first time, or as less than half of what was asked for has come.
    fn is_due(&mut self, now: Time, interval_ms: u32) -> bool {
        let Some(since) = self.since else {
            self.since = Some(now);
            self.asked.get_or_insert(now);
            return true;
        };
        let looked = now.saturating_sub(since);
        if looked < OBSERVED * (1 << self.in_vain.min(MAX_DOUBLINGS)) {
            return false;
        }
        let wanted = looked.as_millis() / u128::from(interval_ms.max(1));
        let missing = self.count == 0 || u128::from(self.count) * 2 < wanted;
        let in_vain = if missing { self.in_vain + 1 } else { 0 };
        *self = Self { since: Some(now), count: 0, in_vain, ..*self };
        missing
    }
}

impl Streams {
    /// Another link is used: everything is asked for again. What has stopped stays told, and what came before is missed if it does not
    /// come over this one.
    pub fn begin_anew(&mut self) {
        for stream in &mut self.streams {
            *stream = Stream { asked: stream.asked, came: stream.came, ..Stream::default() };
        }
    }

    /// A message came.
    pub fn seen(&mut self, now: Time, message: &MavMessage) {
        let id = message.message_id();
        let known = WANTED.iter().zip(&mut self.streams).find(|((wanted, ..), _)| *wanted == id);
        if let Some(((_, interval_ms, _), stream)) = known {
            stream.count += 1;
            stream.is_got = *interval_ms == 0;
            stream.is_lacking = false;
            if says_something(message) {
                stream.came = Some(now);
            }
        }
    }

    /// The autopilot says something: ArduPilot says in words which message it does not have, each time that it is asked for it.
    pub fn said(&mut self, text: &STATUSTEXT_DATA) {
        let id = text
            .text
            .to_str()
            .ok()
            .and_then(|text| text.strip_prefix(LACKING)?.strip_suffix(')')?.parse::<u32>().ok());
        let lacking = WANTED.iter().zip(&mut self.streams).find(|((wanted, ..), _)| Some(*wanted) == id);
        lacking.into_iter().for_each(|(_, stream)| stream.is_lacking = true);
    }

    /// Asks for what is missing; of the messages that say the wind, for this one.
    pub fn tick(&mut self, now: Time, peer: Peer, wind: u32, out: &mut Vec<MavMessage>) {
        for ((id, interval_ms, _), stream) in WANTED.iter().zip(&mut self.streams) {
            let other_wind = WINDS.contains(id) && *id != wind;
            let wanted = !other_wind && !stream.is_lacking && !stream.is_got;
            if wanted && stream.is_due(now, *interval_ms) {
                out.push(ask(*id, *interval_ms, peer));
            }
        }
    }

    /// What no longer comes, and of what is needed what never came, if that has changed; of the messages that say the wind, this one counts.
    pub fn stopped(&mut self, now: Time, wind: u32) -> Option<Vec<&'static str>> {
        let over = |id: u32, stream: &Stream| {
            let since = stream.came.or(stream.asked.filter(|_| NEEDED.contains(&id)));
            since.is_some_and(|at| now.saturating_sub(at) > STOPPED)
        };
        let asked_for = |id: u32, interval_ms: u32| interval_ms > 0 && (id == wind || !WINDS.contains(&id));
        let known = WANTED
            .iter()
            .zip(&self.streams)
            .filter(|((id, ms, what), _)| asked_for(*id, *ms) && !what.is_empty());
        let stopped: Vec<_> =
            known.filter(|((id, ..), stream)| over(*id, stream)).map(|((.., what), _)| *what).collect();
        if self.told == stopped {
            return None;
        }
        self.told.clone_from(&stopped);
        Some(stopped)
    }
}

/// Of the battery nothing is known where its share is not: its monitor has failed, or there is none.
fn says_something(message: &MavMessage) -> bool {
    !matches!(message, MavMessage::SYS_STATUS(status) if status.battery_remaining == -1)
}

fn ask(id: u32, interval_ms: u32, peer: Peer) -> MavMessage {
    let (command, param2) = match interval_ms {
        0 => (MavCmd::MAV_CMD_REQUEST_MESSAGE, 0.0),
        ms => (MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, ms as f32 * 1000.0),
    };
    MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        param1: id as f32,
        param2,
        param3: 0.0,
        param4: 0.0,
        param5: 0.0,
        param6: 0.0,
        param7: 0.0,
        command,
        target_system: peer.system,
        target_component: peer.component,
        confirmation: 0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked_for(out: &[MavMessage], id: u32) -> usize {
        let asks =
            |message: &&MavMessage| matches!(message, MavMessage::COMMAND_LONG(m) if m.param1 == id as f32);
        out.iter().filter(asks).count()
    }

    #[test]
    fn what_the_autopilot_says_it_does_not_have_is_not_asked_for_again() {
        let (mut streams, mut out) = (Streams::default(), vec![]);
        let peer = Peer { system: 1, component: 1 };
        streams.tick(Time::ZERO, peer, WIND_DATA::ID, &mut out);
        for text in ["No ap_message for mavlink id (371)", "No ap_message for mavlink id (x)", "id (30)"] {
            streams.said(&STATUSTEXT_DATA { text: text.into(), ..STATUSTEXT_DATA::DEFAULT });
        }
        (1..1000).for_each(|second| streams.tick(Time::from_secs(second), peer, WIND_DATA::ID, &mut out));
        assert_eq!(asked_for(&out, FUEL_STATUS_DATA::ID), 1);
        assert!(
            asked_for(&out, RPM_DATA::ID) > 5 && asked_for(&out, ATTITUDE_DATA::ID) > 5,
            "they may have been lost"
        );
    }

    fn battery(battery_remaining: i8) -> MavMessage {
        MavMessage::SYS_STATUS(SYS_STATUS_DATA { battery_remaining, ..SYS_STATUS_DATA::DEFAULT })
    }

    fn wind() -> MavMessage {
        MavMessage::WIND(WIND_DATA::DEFAULT)
    }

    #[test]
    fn what_is_needed_is_missed_even_if_it_never_came() {
        let (mut streams, peer, at) =
            (Streams::default(), Peer { system: 1, component: 1 }, Duration::from_secs);
        streams.tick(at(0), peer, WIND_DATA::ID, &mut vec![]);
        assert_eq!(streams.stopped(at(10), WIND_DATA::ID), None);
        let missing = vec!["position", "attitude", "place on the list", "airspeed", "GPS"];
        assert_eq!(streams.stopped(at(11), WIND_DATA::ID), Some(missing.clone()));
        streams.seen(at(12), &MavMessage::ATTITUDE(ATTITUDE_DATA::DEFAULT));
        let rest: Vec<_> = missing.into_iter().filter(|what| *what != "attitude").collect();
        assert_eq!(streams.stopped(at(12), WIND_DATA::ID), Some(rest));
    }

    #[test]
    fn home_and_version_are_asked_for_until_they_come() {
        let (mut streams, mut out, at) = (Streams::default(), vec![], Duration::from_secs);
        let peer = Peer { system: 1, component: 1 };
        (0..30).for_each(|second| streams.tick(at(second), peer, WIND_DATA::ID, &mut out));
        let before = asked_for(&out, HOME_POSITION_DATA::ID);
        assert!(before > 1, "{before}");
        streams.seen(at(30), &MavMessage::HOME_POSITION(HOME_POSITION_DATA::DEFAULT));
        (30..300).for_each(|second| streams.tick(at(second), peer, WIND_DATA::ID, &mut out));
        assert_eq!(asked_for(&out, HOME_POSITION_DATA::ID), before);
        assert!(asked_for(&out, AUTOPILOT_VERSION_DATA::ID) > before);
    }

    /// Its monitor has failed.
    #[test]
    fn a_battery_whose_share_is_no_longer_known_is_missed_and_one_that_never_was_is_not() {
        let (mut streams, at) = (Streams::default(), Duration::from_secs);
        streams.seen(at(0), &battery(50));
        (1..=11).for_each(|second| streams.seen(at(second), &battery(-1)));
        assert_eq!(streams.stopped(at(11), WIND_DATA::ID), Some(vec!["battery"]));
        let mut never = Streams::default();
        (0..=30).for_each(|second| never.seen(at(second), &battery(-1)));
        assert_eq!(never.stopped(at(30), WIND_DATA::ID), None);
    }

    #[test]
    fn over_another_link_what_has_stopped_is_told_as_over_and_what_does_not_come_is_missed() {
        let (mut streams, at) = (Streams::default(), Duration::from_secs);
        streams.seen(at(0), &battery(50));
        assert_eq!(streams.stopped(at(11), WIND_DATA::ID), Some(vec!["battery"]));
        streams.begin_anew();
        assert_eq!(streams.stopped(at(12), WIND_DATA::ID), None, "it is told already");
        streams.seen(at(13), &battery(50));
        assert_eq!(streams.stopped(at(13), WIND_DATA::ID), Some(vec![]));
        streams.begin_anew();
        assert_eq!(streams.stopped(at(24), WIND_DATA::ID), Some(vec!["battery"]));
    }

    #[test]
    fn what_came_and_no_longer_comes_is_told_until_it_comes_again() {
        let (mut streams, at) = (Streams::default(), Duration::from_secs);
        let stopped = |streams: &mut Streams, second| streams.stopped(at(second), WIND_DATA::ID);
        assert_eq!(stopped(&mut streams, 60), None, "it never came");
        streams.seen(at(60), &battery(50));
        streams.seen(at(60), &MavMessage::HOME_POSITION(HOME_POSITION_DATA::DEFAULT));
        assert_eq!(stopped(&mut streams, 70), None);
        assert_eq!(stopped(&mut streams, 71), Some(vec!["battery"]));
        assert_eq!(stopped(&mut streams, 72), None, "it was told");
        streams.seen(at(73), &battery(50));
        assert_eq!(stopped(&mut streams, 73), Some(vec![]));
    }

    #[test]
    fn the_wind_is_missed_once_and_only_as_it_was_asked_for() {
        let (mut streams, at) = (Streams::default(), Duration::from_secs);
        streams.seen(at(0), &wind());
        streams.seen(at(0), &MavMessage::WIND_COV(WIND_COV_DATA::DEFAULT));
        assert_eq!(streams.stopped(at(11), WIND_DATA::ID), Some(vec!["wind"]));
        streams.seen(at(11), &wind());
        assert_eq!(streams.stopped(at(12), WIND_DATA::ID), Some(vec![]));
    }

    /// What is read and never asked for stays away from an autopilot that sends nothing by itself.
    #[test]
    fn whatever_telemetry_reads_is_asked_for() {
        let source = include_str!("telemetry.rs");
        let (source, _) = source.split_once("#[cfg(test)]").unwrap();
        let read = source.split("MavMessage::").skip(1).filter_map(|rest| rest.split_once("(m)"));
        let names: Vec<&str> = read.map(|(name, _)| name).collect();
        assert!(names.len() > 10 && names.contains(&"FUEL_STATUS"), "{names:?}");
        for name in names {
            let id = MavMessage::message_id_from_name(name).unwrap();
            assert!(WANTED.iter().any(|(wanted, ..)| *wanted == id), "{name} is read and not asked for");
        }
    }
}
