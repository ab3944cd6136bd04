//! Parameters of an autopilot that our flying depends on: asked for, never changed.

use super::Peer;
use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::*;
use std::time::Duration;

/// Asked for again after this, as long as it is not as it has to be: a launch waits for the answer, and a bad radio loses a third of them.
const ASK_AGAIN: Duration = Duration::from_secs(1);
/// Firmware that has not answered so often has no such parameter.
const MOST_ASKED: u32 = 15;

/// What a parameter has to be for our flying to be possible.
#[derive(Debug)]
pub struct Need {
    /// Its name.
    pub name: &'static str,
    /// The whole number that it has to be.
    pub wanted: i32,
    /// What another number leads to.
    pub otherwise: &'static str,
}

impl Need {
    /// It is as it has to be.
    pub fn is_met(&self, value: f64) -> bool {
        value == f64::from(self.wanted)
    }

    /// Whether it can be flown; `None`: not known yet.
    pub fn verdict(&self, asked: &Asked) -> Option<Result<(), String>> {
        match asked.value {
            Some(value) if self.is_met(value) => Some(Ok(())),
            Some(value) => Some(Err(format!(
                "The autopilot's parameter {} is {value}: {}. Set it to {}.",
                self.name, self.otherwise, self.wanted
            ))),
            None => asked.is_settled().then_some(Ok(())),
        }
    }
}

/// A parameter that is asked for, and what was told of it.
#[derive(Debug, Clone, Default)]
pub struct Asked {
    value: Option<f64>,
    count: u32,
    ask_at: Time,
}

impl Asked {
    /// Asks for it, until it is as it has to be, or there is none.
    pub fn tick(
        &mut self,
        now: Time,
        name: &str,
        is_good: impl Fn(f64) -> bool,
        peer: Peer,
        out: &mut Vec<MavMessage>,
    ) {
        let is_over = self.value.map_or(self.is_settled(), is_good);
        if is_over || now < self.ask_at {
            return;
        }
        self.count += 1;
        self.ask_at = now + ASK_AGAIN;
        out.push(MavMessage::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA {
            param_index: -1,
            target_system: peer.system,
            target_component: peer.component,
            param_id: name.into(),
        }));
    }

    /// The autopilot says a parameter.
    pub fn said(&mut self, name: &str, message: &PARAM_VALUE_DATA, whole_as_bits: bool) {
        if message.param_id.to_str() == Ok(name) {
            self.value = Some(number(message, whole_as_bits));
        }
    }

    /// Its value, if it was told.
    pub fn value(&self) -> Option<f64> {
        self.value
    }

    /// It was told, or this firmware has none.
    pub fn is_settled(&self) -> bool {
        self.value.is_some() || self.count >= MOST_ASKED
    }
}

/// Whole numbers come as their bits, or as numbers.
pub fn number(message: &PARAM_VALUE_DATA, whole_as_bits: bool) -> f64 {
    match message.param_type {
        MavParamType::MAV_PARAM_TYPE_REAL32 => message.param_value.into(),
        _ if !whole_as_bits => message.param_value.into(),
        _ => (message.param_value.to_bits() as i32).into(),
    }
}
