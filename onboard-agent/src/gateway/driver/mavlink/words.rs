//! What the autopilot says in words: its reasons, which its answers to commands lack.

use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::{MavSeverity, STATUSTEXT_DATA};
use std::collections::VecDeque;
use std::time::Duration;

/// What is older is not about what happens now.
const LATELY: Duration = Duration::from_secs(20);
/// So many texts are kept.
const MOST: usize = 6;
/// A text may come in pieces, up to this length in bytes.
const LONGEST: usize = 250;
/// Parts of the texts that tell in flight that an engine gives no power any more: PX4's, of its failure detector, and ArduPlane's.
const ENGINE_FAILS: [&[&str]; 3] =
    [&["motor failure: motor ", " undercurrent"], &["motor failure detected"], &["uncommanded engine stop"]];
/// In front of what an autopilot says of its engine on the ground only.
const ON_GROUND: [&str; 2] = ["prearm:", "arm:"];

/// Its last warnings.
#[derive(Debug, Clone, Default)]
pub struct Words {
    texts: VecDeque<Text>,
}

#[derive(Debug, Clone)]
struct Text {
    at: Time,
    /// Number of a text in pieces; 0: it is whole.
    id: u16,
    /// The last piece.
    piece: u8,
    text: String,
}

impl Words {
    /// It says something. The warning that this is, as far as it has come by now.
    pub fn hear(&mut self, now: Time, message: &STATUSTEXT_DATA) -> Option<&str> {
        // not every autopilot keeps to the alphabet
        let piece = message.text.to_str().ok()?;
        tracing::info!(piece, "the autopilot says");
        if message.severity as u32 > MavSeverity::MAV_SEVERITY_WARNING as u32 {
            return None;
        }
        let id = message.id;
        let begun = self.texts.iter().position(|text| id > 0 && text.id == id);
        if let Some(at) = begun.filter(|_| message.chunk_seq > 0) {
            let text = self.texts.get_mut(at)?;
            let follows = message.chunk_seq == text.piece.wrapping_add(1);
            if !follows || text.text.len() + piece.len() > LONGEST {
                return None;
            }
            text.text.push_str(piece);
            text.piece = message.chunk_seq;
            return Some(&text.text);
        }
        if self.texts.len() == MOST {
            self.texts.pop_front();
        }
        self.texts.push_back(Text { at: now, id, piece: message.chunk_seq, text: piece.into() });
        self.texts.back().map(|text| text.text.as_str())
    }

    /// What it said lately, each once.
    pub fn lately(&self, now: Time) -> Option<String> {
        let mut said: Vec<&str> = vec![];
        for text in self.texts.iter().filter(|text| now.saturating_sub(text.at) <= LATELY) {
            let words = text.text.trim();
            if !words.is_empty() && !said.contains(&words) {
                said.push(words);
            }
        }
        (!said.is_empty()).then(|| said.join("; "))
    }
}

/// A warning tells that an engine gives no power any more.
pub fn tells_of_engine(warning: &str) -> bool {
    let said = warning.to_lowercase();
    let has_all = |parts: &[&str]| parts.iter().all(|part| said.contains(part));
    !ON_GROUND.iter().any(|before| said.starts_with(before))
        && ENGINE_FAILS.iter().any(|parts| has_all(parts))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(words: &str, id: u16, chunk_seq: u8) -> STATUSTEXT_DATA {
        let severity = MavSeverity::MAV_SEVERITY_CRITICAL;
        STATUSTEXT_DATA { severity, text: words.into(), id, chunk_seq }
    }

    #[test]
    fn what_it_said_lately_is_told_once_with_its_pieces_put_together() {
        let mut words = Words::default();
        let at = Duration::from_secs;
        words.hear(at(0), &text("long ago", 0, 0));
        for second in [30, 31] {
            words.hear(at(second), &text("Arming denied: ", 7, 0));
            words.hear(at(second), &text("no GPS", 7, 1));
            words.hear(at(second), &text("battery low", 0, 0));
        }
        let quiet = STATUSTEXT_DATA { severity: MavSeverity::MAV_SEVERITY_INFO, ..text("ready", 0, 0) };
        words.hear(at(32), &quiet);
        let said = words.lately(at(33)).unwrap_or_default();
        assert_eq!(said.matches("battery low").count(), 1, "{said}");
        assert!(said.contains("Arming denied: no GPS") && !said.contains("ready"), "{said}");
        assert!(!said.contains("long ago"), "{said}");
        assert_eq!(words.lately(at(90)), None);
    }

    #[test]
    fn a_warning_that_its_engine_has_failed_is_known_by_its_words() {
        for said in [
            "Motor failure: Motor 1 undercurrent detected",
            "Preflight Fail: Motor failure detected",
            "Uncommanded engine stop",
        ] {
            assert!(tells_of_engine(said), "{said}");
        }
        for said in [
            "Battery failsafe",
            "Engine temperature high",
            "Motor failure: Motor 1 overcurrent detected",
            "PreArm: Motors Emergency Stopped",
            "Arm: Motor failure detected",
            "Preflight Fail: motor 3 has no telemetry",
        ] {
            assert!(!tells_of_engine(said), "{said}");
        }
    }

    #[test]
    fn a_piece_is_heard_with_what_it_was_added_to_and_no_other_text() {
        let (mut words, at) = (Words::default(), Duration::from_secs);
        words.hear(at(0), &text("Battery 1: ", 3, 0));
        let engine = words.hear(at(0), &text("Motor failure: Motor 1 ", 4, 0)).map(str::to_owned);
        assert!(engine.is_some_and(|said| !tells_of_engine(&said)), "it is not whole");
        words.hear(at(1), &text("GPS: fix lost", 0, 0));
        assert!(words.hear(at(1), &text("undercurrent detected", 4, 1)).is_some_and(tells_of_engine));
        assert_eq!(words.hear(at(60), &text("it is low", 3, 1)), Some("Battery 1: it is low"));
        assert_eq!(words.hear(at(60), &text("it is low", 3, 5)), None, "what is between was lost");
    }

    #[test]
    fn whatever_is_said_is_bounded() {
        let mut words = Words::default();
        for n in 0..1000_u16 {
            words.hear(Time::ZERO, &text(&format!("{n} {}", "x".repeat(40)), n % 3, (n / 3 % 256) as u8));
        }
        assert!(words.lately(Time::ZERO).unwrap_or_default().len() < 2000);
    }
}
