//! A ground station on a plain link: what is said to an autopilot, and what comes back, message by message.

use super::Autopilot;
use anyhow::{Context, bail, ensure};
use autopilot_link::frame::{Beginning, Decoder, Sender, begins, encode};
use autopilot_link::{Event, Link, Peer};
use mavlink::dialects::ardupilotmega::*;
use std::collections::VecDeque;
use std::time::{Duration, Instant};
use tokio::runtime::Runtime;

/// What ground stations call themselves.
pub const OWN: Sender = Sender { system: 255, component: MavComponent::MAV_COMP_ID_MISSIONPLANNER as u8 };
/// Another component of the same station.
pub const OTHER: Sender = Sender { system: 255, component: 191 };
/// How long an autopilot may take for an answer, on a busy machine.
const PATIENCE: Duration = Duration::from_secs(30);
/// So long a flight may take to what is waited for, by the machine's clock.
pub const FLIGHT: Duration = Duration::from_secs(600);

/// The link, and who is at the other end.
pub struct Station {
    /// Which autopilot it is.
    pub autopilot: Autopilot,
    /// What it calls itself.
    pub target: Sender,
    runtime: Runtime,
    link: Link,
    peer: Option<Peer>,
    decoder: Decoder,
    heard: VecDeque<MavMessage>,
    sequence: u8,
    beat: Instant,
}

impl Station {
    /// Reaches the autopilot at an address (`tcp:HOST:PORT`, …) and waits for its heartbeat.
    ///
    /// # Errors
    /// There is no such address, or nobody speaks there, or one that is known by no quirk.
    pub fn open(address: &str) -> anyhow::Result<Self> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let link =
            runtime.block_on(Link::open(&address.parse()?)).with_context(|| format!("opening {address}"))?;
        let nobody = Sender { system: 0, component: 0 };
        let mut station = Self {
            autopilot: Autopilot::ArduPlane,
            target: nobody,
            runtime,
            link,
            peer: None,
            decoder: Decoder::default(),
            heard: VecDeque::new(),
            sequence: 0,
            beat: Instant::now(),
        };
        let heartbeat = station.hear("a heartbeat", heartbeat)?;
        station.autopilot = Autopilot::of(&heartbeat)?;
        Ok(station)
    }

    /// Says something.
    pub fn say(&mut self, message: &MavMessage) {
        self.say_as(OWN, message);
    }

    /// Says it as somebody else.
    pub fn say_as(&mut self, sender: Sender, message: &MavMessage) {
        self.sequence = self.sequence.wrapping_add(1);
        let frame = encode(sender, self.sequence, message);
        if let Some(peer) = self.peer {
            self.link.send(peer, &frame);
            self.link.flush();
        }
    }

    /// Forgets what has come until now and was not asked for.
    pub fn forget(&mut self) {
        self.heard.clear();
    }

    /// Waits for what `pick` takes of the messages that come, in their order; what came before it is forgotten.
    ///
    /// # Errors
    /// It never comes.
    pub fn hear<T>(&mut self, what: &str, pick: impl FnMut(&MavMessage) -> Option<T>) -> anyhow::Result<T> {
        self.hear_within(PATIENCE, what, pick)
    }

    /// The same, with another patience.
    ///
    /// # Errors
    /// It never comes.
    pub fn hear_within<T>(
        &mut self,
        patience: Duration,
        what: &str,
        mut pick: impl FnMut(&MavMessage) -> Option<T>,
    ) -> anyhow::Result<T> {
        let end = Instant::now() + patience;
        loop {
            while let Some(message) = self.heard.pop_front() {
                if let Some(picked) = pick(&message) {
                    return Ok(picked);
                }
            }
            ensure!(Instant::now() < end, "never came: {what}");
            self.receive(end);
        }
    }

    /// Waits for what `end` takes, and for nothing that `pick` takes before it.
    ///
    /// # Errors
    /// The end never comes.
    pub fn gather<T>(
        &mut self,
        what: &str,
        mut pick: impl FnMut(&MavMessage) -> Option<T>,
        mut end: impl FnMut(&MavMessage) -> bool,
    ) -> anyhow::Result<Vec<T>> {
        let mut gathered = vec![];
        self.hear(what, |message| {
            gathered.extend(pick(message));
            end(message).then_some(())
        })?;
        Ok(gathered)
    }

    /// One piece of the link, or the time for a heartbeat of ours: PX4 acts when no ground station is there.
    fn receive(&mut self, end: Instant) {
        let (link, mut bytes) = (&mut self.link, vec![]);
        let until = end.min(self.beat);
        let event = self.runtime.block_on(async {
            let next = link.next(&mut bytes, |bytes| begins(bytes) != Beginning::Nothing);
            tokio::time::timeout_at(until.into(), next).await
        });
        match event {
            Ok(Event::Connected(peer)) => {
                self.decoder.restart();
                self.peer = Some(peer);
            }
            Ok(Event::Gone(_)) => self.peer = None,
            Ok(Event::Stream(peer)) => {
                self.peer = Some(peer);
                self.decoder.push(&bytes);
            }
            Ok(Event::Datagram(peer)) => {
                self.peer = Some(peer);
                self.decoder.push_datagram(&bytes);
            }
            Err(_) => self.speak(),
        }
        while let Some(frame) = self.decoder.next_frame() {
            let Some(message) = frame.message() else { continue };
            if let (MavMessage::HEARTBEAT(beat), 0) = (&message, self.target.system)
                && beat.autopilot != MavAutopilot::MAV_AUTOPILOT_INVALID
            {
                self.target = frame.sender;
            }
            if frame.sender == self.target {
                self.heard.push_back(message);
            }
        }
    }

    fn speak(&mut self) {
        self.beat = Instant::now() + Duration::from_secs(1);
        self.say(&MavMessage::HEARTBEAT(HEARTBEAT_DATA {
            mavtype: MavType::MAV_TYPE_GCS,
            autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
            ..HEARTBEAT_DATA::DEFAULT
        }));
    }

    /// A command with its seven parameters, and how it is answered.
    ///
    /// # Errors
    /// It is not answered.
    pub fn command(&mut self, command: MavCmd, params: [f32; 7]) -> anyhow::Result<MavResult> {
        self.forget();
        self.say_command(command, params);
        self.answer(command)
    }

    /// A command with its seven parameters.
    pub fn say_command(&mut self, command: MavCmd, params: [f32; 7]) {
        let [param1, param2, param3, param4, param5, param6, param7] = params;
        self.say(&MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            param1,
            param2,
            param3,
            param4,
            param5,
            param6,
            param7,
            command,
            target_system: self.target.system,
            target_component: self.target.component,
            confirmation: 0,
        }));
    }

    /// A command with a place in whole numbers, and how it is answered.
    ///
    /// # Errors
    /// It is not answered.
    pub fn command_int(&mut self, command: COMMAND_INT_DATA) -> anyhow::Result<MavResult> {
        self.forget();
        let (target_system, target_component) = (self.target.system, self.target.component);
        let code = command.command;
        self.say(&MavMessage::COMMAND_INT(COMMAND_INT_DATA { target_system, target_component, ..command }));
        self.answer(code)
    }

    fn answer(&mut self, command: MavCmd) -> anyhow::Result<MavResult> {
        self.hear(&format!("an answer to {command:?}"), |message| match message {
            MavMessage::COMMAND_ACK(ack)
                if ack.command == command && ack.result != MavResult::MAV_RESULT_IN_PROGRESS =>
            {
                Some(ack.result)
            }
            _ => None,
        })
    }

    /// A command that has to be answered so.
    ///
    /// # Errors
    /// It is answered otherwise, or not.
    pub fn expect(&mut self, command: MavCmd, params: [f32; 7], result: MavResult) -> anyhow::Result<()> {
        let answer = self.command(command, params)?;
        ensure!(answer == result, "{command:?} {params:?}: {answer:?}, not {result:?}");
        Ok(())
    }

    /// All that `pick` takes of what comes until the autopilot has answered something else, said after it: answers to what was said
    /// before come before.
    ///
    /// # Errors
    /// Even that is not answered.
    pub fn answers<T>(&mut self, pick: impl FnMut(&MavMessage) -> Option<T>) -> anyhow::Result<Vec<T>> {
        // any number that was not sent a moment ago
        let ts1 = i64::from(self.sequence) + 1;
        self.say(&MavMessage::TIMESYNC(TIMESYNC_DATA { tc1: 0, ts1, ..TIMESYNC_DATA::DEFAULT }));
        let is_back =
            |message: &MavMessage| matches!(message, MavMessage::TIMESYNC(t) if t.tc1 != 0 && t.ts1 == ts1);
        self.gather("the answer to a TIMESYNC", pick, is_back)
    }

    /// Where it is, in whole numbers, and its height above home, metres.
    ///
    /// # Errors
    /// It does not tell.
    pub fn place(&mut self) -> anyhow::Result<(i32, i32, f64)> {
        self.hear("a position", |message| match message {
            MavMessage::GLOBAL_POSITION_INT(p) if p.lat != 0 => {
                Some((p.lat, p.lon, f64::from(p.relative_alt) / 1000.0))
            }
            _ => None,
        })
    }

    /// Waits until it shows a mode by its number.
    ///
    /// # Errors
    /// It never does.
    pub fn shows(&mut self, custom_mode: u32) -> anyhow::Result<()> {
        self.hear_within(FLIGHT, &format!("mode {custom_mode:#x}"), |message| {
            heartbeat(message).filter(|beat| beat.custom_mode == custom_mode).map(drop)
        })
    }

    /// What its texts say until one has `part` in it.
    ///
    /// # Errors
    /// It never says that.
    pub fn says(&mut self, part: &str) -> anyhow::Result<String> {
        let mut said = vec![];
        let found = self.hear(part, |message| {
            said.extend(text(message));
            text(message).filter(|text| text.contains(part))
        });
        found.with_context(|| format!("it said {said:?}"))
    }
}

/// The autopilot's heartbeat.
pub fn heartbeat(message: &MavMessage) -> Option<HEARTBEAT_DATA> {
    match message {
        MavMessage::HEARTBEAT(beat) if beat.autopilot != MavAutopilot::MAV_AUTOPILOT_INVALID => {
            Some(beat.clone())
        }
        _ => None,
    }
}

/// What it says in words.
pub fn text(message: &MavMessage) -> Option<String> {
    match message {
        MavMessage::STATUSTEXT(said) => said.text.to_str().ok().map(str::to_owned),
        _ => None,
    }
}

/// Both are the same, or it is said what they are.
///
/// # Errors
/// They differ.
pub fn same<T: PartialEq + std::fmt::Debug>(what: &str, found: T, expected: T) -> anyhow::Result<()> {
    if found != expected {
        bail!("{what}: {found:?}, not {expected:?}");
    }
    Ok(())
}
