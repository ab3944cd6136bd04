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
    /// It says something.
    /// True: it is a warning.
    pub fn hear(&mut self, now: Time, message: &STATUSTEXT_DATA) -> bool {
        // not every autopilot keeps to the alphabet
        let Ok(piece) = message.text.to_str() else { return false };
        tracing::info!(piece, "the autopilot says");
        if message.severity as u32 > MavSeverity::MAV_SEVERITY_WARNING as u32 {
            return false;
        }
        let id = message.id;
        let begun = self.texts.iter_mut().find(|text| id > 0 && text.id == id);
        if let Some(text) = begun.filter(|_| message.chunk_seq > 0) {
            let follows = message.chunk_seq == text.piece.wrapping_add(1);
            if follows && text.text.len() + piece.len() <= LONGEST {
                text.text.push_str(piece);
                text.piece = message.chunk_seq;
            }
            return true;
        }
        self.texts.push_back(Text { at: now, id, piece: message.chunk_seq, text: piece.into() });
        if self.texts.len() > MOST {
            self.texts.pop_front();
        }
        true
    }

    /// The last of them tells that its engine gives no power any more.
    pub fn tell_of_engine(&self) -> bool {
        let text = self.texts.back().map(|text| text.text.to_lowercase()).unwrap_or_default();
        let has = |words: &[&str]| words.iter().any(|word| text.contains(word));
        has(&["engine", "motor"]) && has(&["fail", "stop", "flameout"])
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
        let tells = |said: &str| {
            let mut words = Words::default();
            words.hear(Time::ZERO, &text(said, 0, 0)) && words.tell_of_engine()
        };
        for said in ["Engine failure", "Uncommanded engine stop", "Motor failure detected"] {
            assert!(tells(said), "{said}");
        }
        for said in ["Battery failsafe", "Engine temperature high", "GPS: fix lost"] {
            assert!(!tells(said), "{said}");
        }
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
