//! What one kind of MAVLink autopilot does in its own way, for the driver they share.

use super::Peer;
use super::chain::Chain;
use super::commands::Command;
use super::examine::Advice;
use super::item::Item;
use super::list::Feeding;
use super::mission::{Entry, Rules};
use super::parameters::Need;
use crate::gateway::order::{Aim, Kind, Mode};
use mavlink::MessageData;
use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, MavType, WIND_DATA};
use std::borrow::Cow;

/// A kind of autopilot.
#[derive(Debug)]
pub struct Dialect {
    /// What kind it is.
    pub kind: Kind,
    /// This is one.
    pub is: fn(&HEARTBEAT_DATA) -> bool,
    /// How its list is kept; and the steepest landing that it takes, degrees, if it says that.
    pub feeding: fn(Chain, Option<f64>) -> Box<dyn Feeding>,
    /// How it deals with its list.
    pub rules: &'static Rules,
    /// The messages for entries from a number on.
    pub entries: fn(u16, &[Item], Peer) -> Vec<Entry>,
    /// What an entry says.
    pub decode: fn(&Entry) -> Item,
    /// Who steers in a mode, by its number. `sent`: it was sent to a place, and has not been sent elsewhere since.
    pub meaning: fn(number: u32, sent: bool) -> Mode,
    /// What it calls a mode.
    pub mode_name: fn(u32) -> Cow<'static, str>,
    /// The commands that make it do something, one after the other.
    pub steer: fn(&Aim) -> Vec<Command>,
    /// The command that makes it steer to an entry of its list.
    pub select: fn(u16) -> Command,
    /// The commands that arm it.
    pub arm: &'static [Command],
    /// What ends that if no launch follows: the mode in which it was armed may start its list.
    pub stands: Option<Command>,
    /// Behind the last entry of its list it changes to circling by itself.
    pub holds_at_end: bool,
    /// A change of mode makes it forget the airspeed that was commanded.
    pub forgets_speed: bool,
    /// An airspeed is commanded again with so many heartbeats after it: it may not have been taken, whatever was answered.
    pub speed_repeats: u8,
    /// Major and minor version with which its habits were found out and whole missions flown, in its own simulation.
    pub flown: [u8; 2],
    /// The parameter that decides whether it can be flown.
    pub need: Option<&'static Need>,
    /// The parameter that says how steep a landing may be in its list, degrees; `None`: it takes any.
    pub landing_limit: Option<&'static str>,
    /// The parameter that says how wide it circles where no radius is commanded, metres; positive clockwise.
    pub loiter_radius: &'static str,
    /// It sends whole numbers among its parameters as their bits, not as numbers.
    pub whole_as_bits: bool,
    /// Parameters that should be so before it is flown.
    pub advice: &'static [Advice],
    /// How it is spoken to.
    pub manner: Manner,
}

impl Dialect {
    /// It is armed in the mode that flies its list, and in no other.
    pub fn arms_in_waypoints(&self) -> bool {
        self.stands.is_some()
    }
}

/// How an autopilot is spoken to.
#[derive(Debug, Clone, Copy)]
pub struct Manner {
    /// What we say that we are: some tell their reasons to a ground station only.
    pub we_are: MavType,
    /// The message that says the wind.
    pub wind: u32,
    /// What it puts into a summary.
    pub summary: Summary,
}

/// How an autopilot says things in `HIGH_LATENCY2`, which leaves it little room.
#[derive(Debug, Clone, Copy)]
pub struct Summary {
    /// The number of a mode, of which 16 bits are said.
    pub mode: fn(u16) -> u32,
    /// The wind's direction is the one that it blows to; else the one that it comes from.
    pub wind_blows_to: bool,
}

impl Default for Manner {
    /// As long as it is not known what it is.
    fn default() -> Self {
        let summary = Summary { mode: u32::from, wind_blows_to: false };
        Self { we_are: MavType::MAV_TYPE_ONBOARD_CONTROLLER, wind: WIND_DATA::ID, summary }
    }
}
