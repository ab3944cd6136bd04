//! The parameters that the mirror shows: those that were read from the autopilot anyway, and the one that programs wait for.

use autopilot_link::frame::Frame;
use mavlink::dialects::ardupilotmega::*;

/// More parameters no autopilot has.
const MOST: usize = 4096;

/// The parameters, in the order in which they were heard.
#[derive(Debug, Default)]
pub struct Parameters(Vec<PARAM_VALUE_DATA>);

impl Parameters {
    /// The autopilot said a parameter, or what it is.
    pub fn hear(&mut self, frame: &Frame<'_>) {
        match frame.message() {
            Some(MavMessage::PARAM_VALUE(value)) => self.keep(value),
            Some(MavMessage::HEARTBEAT(beat)) => {
                let number = own_number(beat.autopilot, frame.sender.system);
                let is_new =
                    |number: &PARAM_VALUE_DATA| self.0.iter().all(|known| known.param_id != number.param_id);
                if let Some(number) = number.filter(is_new) {
                    self.keep(number);
                }
            }
            _ => {}
        }
    }

    fn keep(&mut self, value: PARAM_VALUE_DATA) {
        let room = self.0.len() < MOST;
        match self.0.iter_mut().find(|known| known.param_id == value.param_id) {
            Some(known) => *known = value,
            None if room => self.0.push(value),
            None => {}
        }
    }

    /// All of them.
    pub fn all(&self) -> Vec<PARAM_VALUE_DATA> {
        (0..self.0.len()).filter_map(|index| self.at(index)).collect()
    }

    /// One, by its index, or for a negative one by its name.
    pub fn read(&self, index: i16, name: &str) -> Option<PARAM_VALUE_DATA> {
        let by_name = || self.0.iter().position(|value| value.param_id.to_str() == Ok(name));
        self.at(usize::try_from(index).ok().or_else(by_name)?)
    }

    fn at(&self, index: usize) -> Option<PARAM_VALUE_DATA> {
        let value = self.0.get(index)?;
        let number = |n: usize| u16::try_from(n).unwrap_or(u16::MAX);
        Some(PARAM_VALUE_DATA {
            param_count: number(self.0.len()),
            param_index: number(index),
            ..value.clone()
        })
    }
}

/// The parameter that says the vehicle's number: programs do not settle without any.
fn own_number(autopilot: MavAutopilot, system: u8) -> Option<PARAM_VALUE_DATA> {
    let (name, param_type, param_value) = match autopilot {
        MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA => {
            ("SYSID_THISMAV", MavParamType::MAV_PARAM_TYPE_INT16, f32::from(system))
        }
        // a whole number is sent as its bits
        MavAutopilot::MAV_AUTOPILOT_PX4 => {
            ("MAV_SYS_ID", MavParamType::MAV_PARAM_TYPE_INT32, f32::from_bits(system.into()))
        }
        _ => return None,
    };
    Some(PARAM_VALUE_DATA { param_value, param_count: 1, param_index: 0, param_id: name.into(), param_type })
}
