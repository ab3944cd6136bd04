//! What was lost of a vehicle's messages, as far as it is known.

use crate::link::Loss;

/// How much of a vehicle's telemetry was lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Losses {
    /// Events that are missing in the log.
    pub events: u64,
    /// Values that were left out because newer ones followed faster than they were taken.
    pub values: u64,
}

impl Losses {
    /// Counts a loss.
    pub fn add(&mut self, loss: Loss) {
        match loss {
            Loss::Events(count) => self.events = self.events.saturating_add(count),
            Loss::Values(count) => self.values = self.values.saturating_add(count),
        }
    }

    /// As sentences, one a line; nothing if nothing was lost.
    pub fn text(&self) -> Option<String> {
        let events = sentence(Loss::Events(self.events));
        let values = (self.values > 0).then(|| format!("{} values were left out", self.values));
        let lines: Vec<String> = events.into_iter().chain(values).collect();
        (!lines.is_empty()).then(|| lines.join("\n"))
    }
}

/// A loss for the log; `None` for values, which the next one replaces.
pub fn sentence(loss: Loss) -> Option<String> {
    match loss {
        Loss::Events(0) | Loss::Values(_) => None,
        Loss::Events(1) => Some("1 event was lost".into()),
        Loss::Events(count) => Some(format!("{count} events were lost")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_add_up_and_never_overflow() {
        let mut losses = Losses::default();
        assert_eq!(losses.text(), None);
        losses.add(Loss::Events(1));
        assert_eq!(losses.text().as_deref(), Some("1 event was lost"));
        losses.add(Loss::Events(11));
        losses.add(Loss::Values(3));
        assert_eq!(losses.text().as_deref(), Some("12 events were lost\n3 values were left out"));
        losses.add(Loss::Events(u64::MAX));
        assert_eq!(losses.events, u64::MAX);
    }
}
