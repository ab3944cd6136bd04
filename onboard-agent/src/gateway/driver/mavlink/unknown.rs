//! Messages that our dialect does not have: an autopilot may be newer, or have some of its own. That is nobody's mistake.

use mavlink::Message;
use mavlink::dialects::ardupilotmega::MavMessage;
use std::collections::BTreeSet;

/// So many numbers are told in the log.
const MOST_TOLD: usize = 64;

/// The numbers that were told.
#[derive(Debug, Default)]
pub struct Unknown(BTreeSet<u32>);

impl Unknown {
    /// The dialect has no message of this number; each is told once.
    pub fn is(&mut self, id: u32) -> bool {
        if MavMessage::default_message_from_id(id).is_some() {
            return false;
        }
        if self.0.len() < MOST_TOLD && self.0.insert(id) {
            tracing::info!(id, "messages of this number are not known here, and passed over");
        }
        true
    }
}
