//! Parameters of an autopilot without which our flying is not possible: asked for, never changed.

use super::Peer;
use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::*;
use std::time::Duration;

/// Asked for again after this, as long as it is not as it has to be: a launch waits for the answer, and a bad radio loses a third of them.
const ASK_AGAIN: Duration = Duration::from_secs(1);
/// Firmware that has not answered so often has no such parameter.
const MOST_ASKED: u32 = 15;

/// What a parameter has to be.
#[derive(Debug)]
pub struct Need {
    /// Its name.
    pub name: &'static str,
    /// The whole number that it has to be.
    pub wanted: i32,
    /// What another number leads to.
    pub otherwise: &'static str,
}

/// What is known of one that is needed.
#[derive(Debug, Clone, Default)]
pub struct Needed {
    value: Option<i32>,
    asked: u32,
    ask_at: Time,
}

impl Needed {
    /// Asks for it, as long as that helps.
    pub fn tick(&mut self, now: Time, need: &Need, peer: Peer, out: &mut Vec<MavMessage>) {
        let settled = self.value == Some(need.wanted) || (self.value.is_none() && self.asked >= MOST_ASKED);
        if settled || now < self.ask_at {
            return;
        }
        self.asked += 1;
        self.ask_at = now + ASK_AGAIN;
        out.push(MavMessage::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA {
            param_index: -1,
            target_system: peer.system,
            target_component: peer.component,
            param_id: need.name.into(),
        }));
    }

    /// The autopilot says a parameter.
    pub fn said(&mut self, need: &Need, message: &PARAM_VALUE_DATA) {
        if message.param_id.to_str() == Ok(need.name) {
            self.value = Some(whole(message));
        }
    }

    /// Whether it can be flown; `None`: not known yet.
    pub fn verdict(&self, need: &Need) -> Option<Result<(), String>> {
        match self.value {
            Some(value) if value == need.wanted => Some(Ok(())),
            Some(value) => Some(Err(format!(
                "The autopilot's parameter {} is {value}: {}. Set it to {}.",
                need.name, need.otherwise, need.wanted
            ))),
            None => (self.asked >= MOST_ASKED).then_some(Ok(())),
        }
    }
}

/// Whole numbers come as their bits, or as a number.
fn whole(message: &PARAM_VALUE_DATA) -> i32 {
    match message.param_type {
        MavParamType::MAV_PARAM_TYPE_REAL32 => message.param_value.round() as i32,
        _ => message.param_value.to_bits() as i32,
    }
}
