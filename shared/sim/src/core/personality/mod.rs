//! What differs between the autopilots that are imitated, and only that: identity, modes, parameters, streams, the mission
//! protocol, answers to commands, status texts. Aircraft, guidance, the way along the list, link and faults are shared.
//!
//! What is a number or a choice in the flight is a [`Rules`], which the [`Autopilot`] carries; what talks to the ground is a
//! [`Behaviour`], which the simulator asks.

pub(super) mod arduplane;
pub(super) mod px4;

use super::Peer;
use super::autopilot::Autopilot;
use super::commands::Command;
use super::mode::Mode;
use super::params::Params;
use super::streams::Streamed;
use crate::frame::Sender;
use aircraft::{Habits, Profile};
use mavlink::dialects::ardupilotmega::*;
use std::fmt;
use std::str::FromStr;
use std::time::Duration;

/// Which autopilot it behaves as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Personality {
    /// ArduPlane.
    #[default]
    ArduPlane,
    /// PX4, fixed wing.
    Px4,
    /// PX4, a VTOL that is flown as a wing; it takes off and lands as one, too.
    Px4Vtol,
}

const NAMES: [(Personality, &str); 3] =
    [(Personality::ArduPlane, "arduplane"), (Personality::Px4, "px4"), (Personality::Px4Vtol, "px4-vtol")];

impl Personality {
    pub(super) fn behaviour(self) -> Box<dyn Behaviour> {
        match self {
            Personality::ArduPlane => Box::<arduplane::ArduPlane>::default(),
            Personality::Px4 => Box::<px4::Px4>::default(),
            Personality::Px4Vtol => Box::new(px4::Px4::vtol()),
        }
    }

    pub(super) fn rules(self) -> &'static Rules {
        match self {
            Personality::ArduPlane => &arduplane::RULES,
            Personality::Px4 => &px4::RULES,
            Personality::Px4Vtol => &px4::VTOL_RULES,
        }
    }
}

impl fmt::Display for Personality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(NAMES.iter().find(|(which, _)| which == self).map_or("", |(_, name)| name))
    }
}

impl FromStr for Personality {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = NAMES.iter().find(|(_, name)| *name == text).map(|(which, _)| *which);
        known.ok_or_else(|| {
            format!("{text:?} is no autopilot that is imitated; write arduplane, px4 or px4-vtol")
        })
    }
}

/// What becomes of a flight whose mission list has run out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ListEnd {
    /// It returns to launch; entered again, the mission starts anew.
    Return,
    /// It circles where it is; entered again, the mission is still at its end.
    Hold,
}

/// Where the two differ in flight.
#[derive(Debug)]
pub struct Rules {
    /// The first item that is flown: 1 if item 0 stands for home.
    pub first_item: u16,
    /// The mode that it is switched on in.
    pub first_mode: Mode,
    /// When the list has run out.
    pub list_end: ListEnd,
    /// After a landing it takes off again for what is behind it on the list.
    pub flies_on_after_landing: bool,
    /// A take-off that comes up in the air is passed over.
    pub skips_take_off_in_air: bool,
    /// After the take-off mode it holds in the mode that is for it.
    pub holds_after_take_off: bool,
    /// On the way to a place it changes its altitude evenly; else at once.
    pub climbs_evenly: bool,
    /// It never returns lower than it is, and if the mission has a landing, it flies that.
    pub returns_to_land: bool,
    /// A speed out of range is refused; else it is limited.
    pub refuses_speeds: bool,
    /// It tells which item it flies to.
    pub tells_items: bool,
    /// What it says when it was armed and disarmed.
    pub armed_texts: [&'static str; 2],
    /// How it begins when it says why it does not arm.
    pub refusal_text: &'static str,
    /// What it says when its engine gives no power any more, if it finds that.
    pub engine_text: Option<&'static str>,
    /// What it says when its own fence is crossed.
    pub fence_text: &'static str,
    /// It touches down before the place of its landing item, so many seconds of its airspeed: it flares early.
    pub lands_short_s: f64,
    /// Its parameters for an aircraft.
    pub params: fn(&Profile) -> Params,
    /// How it follows lines, and which airspeed it holds.
    pub habits: fn(&Profile) -> Habits,
    /// A turn of its main loop, in which it reads what has come; zero: it reads everything at once.
    pub turn: Duration,
    /// What it can send, and how often it does.
    pub streams: &'static [Streamed],
    /// Old commands that ask for a certain message are known.
    pub knows_old_requests: bool,
    /// It says so when it is asked for a parameter that it doesn't have.
    pub tells_unknown_params: bool,
    /// Home is where it was armed, and after a flight where it stands.
    pub home_moves: bool,
    /// How a request for a message that it doesn't have is answered.
    pub no_such_message: MavResult,
    /// How another interval of a message that it doesn't have is answered.
    pub no_such_interval: MavResult,
}

/// Who is at the other end of a transfer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Party {
    /// By which link.
    pub peer: Peer,
    /// Who.
    pub sender: Sender,
}

/// A message, and to whom; `None`: to everybody.
pub type Post = (Option<Peer>, MavMessage);

/// How it talks to the ground.
pub trait Behaviour: fmt::Debug + Send {
    /// A message that it makes in its own way; `None`: as all do.
    fn message(&self, a: &Autopilot, now_ns: u64, id: u32) -> Option<MavMessage>;

    /// Carries out a command and says how it went.
    fn command(&mut self, a: &mut Autopilot, c: &Command, now_ns: u64, out: &mut Vec<Post>) -> MavResult;

    /// `SET_MODE`: the number of the command that is acknowledged, and how it went.
    fn set_mode(&mut self, a: &mut Autopilot, c: &SET_MODE_DATA, now_ns: u64) -> (u16, MavResult);

    /// A message of the mission protocol; false: it is none, or not one that is understood.
    fn mission(
        &mut self,
        a: &mut Autopilot,
        party: Party,
        message: &MavMessage,
        now_ns: u64,
        out: &mut Vec<Post>,
    ) -> bool;

    /// A mission item with a value that the dialect doesn't know.
    fn strange_item(&mut self, a: &mut Autopilot, party: Party, out: &mut Vec<Post>);

    /// A parameter as it is sent.
    fn encode_param(&self, value: f32, kind: MavParamType) -> (f32, MavParamType);

    /// A parameter as it comes; `None`: not of the type that it has.
    fn decode_param(&self, value: f32, sent_as: MavParamType, kind: MavParamType) -> Option<f32>;

    /// Another place to fly to, the way of those who steer by streams.
    fn position_target(&mut self, _a: &mut Autopilot, _c: &SET_POSITION_TARGET_GLOBAL_INT_DATA) {}

    /// Somebody is there.
    fn heard(&mut self, _heartbeat: &HEARTBEAT_DATA, _now_ns: u64) {}

    /// After each step: protocols' timers, and what has happened.
    fn after_step(&mut self, a: &mut Autopilot, now_ns: u64, out: &mut Vec<Post>);
}
