//! How a link does: what came over it, what was lost or came twice, how fast, and how long it is there and back.
//!
//! A sender numbers its messages for each link; a gap is a loss, until the missing message comes late.

use super::Peer;
use crate::gateway::order::Time;
use autopilot_link::frame::Frame;
use std::collections::VecDeque;
use std::time::Duration;
use usal::contract::AutopilotLink;

/// Senders whose numbers are followed; of others only the messages are counted.
const SENDERS: usize = 16;
/// A message that is so many numbers late is none: its sender counts anew.
const LATE: usize = 64;
/// Rates are those of so many seconds, looked at once a second.
const SECONDS: usize = 5;

/// The numbers of one sender.
#[derive(Debug, Clone)]
struct Numbers {
    newest: u8,
    /// Checksums of the last messages, by number modulo [`LATE`]; `None`: it has not come.
    recent: [Option<u16>; LATE],
}

/// What a number means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Came {
    /// It is new, and so many before it are missing.
    New { missing: u8 },
    /// It was missing.
    Late,
    /// It was here before.
    Again,
}

impl Numbers {
    fn from(sequence: u8, checksum: u16) -> Self {
        let mut numbers = Self { newest: sequence, recent: [None; LATE] };
        numbers.put(sequence, checksum);
        numbers
    }

    fn place(&mut self, sequence: u8) -> Option<&mut Option<u16>> {
        self.recent.get_mut(usize::from(sequence) % LATE)
    }

    fn put(&mut self, sequence: u8, checksum: u16) {
        if let Some(place) = self.place(sequence) {
            *place = Some(checksum);
        }
    }

    fn take(&mut self, sequence: u8, checksum: u16) -> Came {
        let ahead = sequence.wrapping_sub(self.newest);
        if (1..=127).contains(&ahead) {
            (1..ahead).for_each(|step| {
                let missing = self.newest.wrapping_add(step);
                self.place(missing).into_iter().for_each(|place| *place = None);
            });
            self.newest = sequence;
            self.put(sequence, checksum);
            return Came::New { missing: ahead - 1 };
        }
        let behind = usize::from(self.newest.wrapping_sub(sequence));
        match self.place(sequence).copied().flatten() {
            None if behind < LATE => {
                self.put(sequence, checksum);
                Came::Late
            }
            Some(same) if behind < LATE && same == checksum => Came::Again,
            // another message under a number that was used: it has started anew
            _ => {
                *self = Self::from(sequence, checksum);
                Came::New { missing: 0 }
            }
        }
    }
}

/// What was counted up to an instant.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    at: Time,
    received: u64,
    received_bytes: u64,
    sent_bytes: u64,
    lost: u64,
}

/// How one link does.
#[derive(Debug, Clone, Default)]
pub struct Statistics {
    now: Count,
    duplicates: u64,
    senders: Vec<(Peer, Numbers)>,
    /// As it was in the last seconds, the oldest first.
    past: VecDeque<Count>,
    probe: Probe,
}

impl Statistics {
    /// A frame came.
    pub fn received(&mut self, frame: &Frame<'_>) {
        self.now.received += 1;
        self.now.received_bytes += frame.bytes.len() as u64;
        match self.number(frame) {
            Some(Came::New { missing }) => self.now.lost += u64::from(missing),
            Some(Came::Late) => self.now.lost = self.now.lost.saturating_sub(1),
            Some(Came::Again) => self.duplicates += 1,
            None => {}
        }
    }

    fn number(&mut self, frame: &Frame<'_>) -> Option<Came> {
        let known = self.senders.iter_mut().find(|(sender, _)| *sender == frame.sender);
        if let Some((_, numbers)) = known {
            return Some(numbers.take(frame.sequence, frame.checksum));
        }
        if self.senders.len() < SENDERS {
            self.senders.push((frame.sender, Numbers::from(frame.sequence, frame.checksum)));
        }
        None
    }

    /// A frame was sent.
    pub fn sent(&mut self, bytes: usize) {
        self.now.sent_bytes += bytes as u64;
    }

    /// What to ask the autopilot for, to find out how long it takes to answer: its time, with this beside it. Of several
    /// links each asks something of its own.
    pub fn ask_time(&mut self, now: Time, link: usize) -> i64 {
        self.probe.ask(now, link)
    }

    /// The autopilot answered a question.
    pub fn time_answered(&mut self, now: Time, asked: i64) {
        self.probe.answered(now, asked);
    }

    /// How long it is there and back, as it was measured last.
    pub fn round_trip(&self) -> Option<Duration> {
        self.probe.round_trip
    }

    /// How it does, once a second. `bad`: frames that were none.
    pub fn figures(&mut self, now: Time, bad: u64) -> AutopilotLink {
        self.now.at = now;
        let then = self.past.front().copied().unwrap_or(self.now);
        self.past.push_back(self.now);
        if self.past.len() > SECONDS {
            self.past.pop_front();
        }
        let seconds = now.saturating_sub(then.at).as_secs_f64();
        let per_s = |now: u64, then: u64| {
            if seconds > 0.0 { now.saturating_sub(then) as f64 / seconds } else { 0.0 }
        };
        let (received, lost) = (self.now.received - then.received, self.now.lost.saturating_sub(then.lost));
        AutopilotLink {
            received: self.now.received,
            lost: self.now.lost,
            duplicates: self.duplicates,
            bad,
            messages_per_s: per_s(self.now.received, then.received),
            received_bytes_per_s: per_s(self.now.received_bytes, then.received_bytes),
            sent_bytes_per_s: per_s(self.now.sent_bytes, then.sent_bytes),
            loss: if lost == 0 { 0.0 } else { lost as f64 / (lost + received) as f64 },
            round_trip_ms: self.probe.round_trip.map(|time| time.as_secs_f64() * 1e3),
            ..AutopilotLink::default()
        }
    }
}

/// How long it is there and back.
#[derive(Debug, Clone, Default)]
struct Probe {
    /// Questions that are not answered yet, one a second: over a satellite the answer comes after the next question.
    asked: VecDeque<(i64, Time)>,
    round_trip: Option<Duration>,
}

impl Probe {
    fn ask(&mut self, now: Time, link: usize) -> i64 {
        if self.asked.len() >= SECONDS {
            self.asked.pop_front();
            self.round_trip = None;
        }
        // never 0
        let question = i64::try_from(now.as_nanos() + link as u128 + 1).unwrap_or(i64::MAX);
        self.asked.push_back((question, now));
        question
    }

    /// What was asked before will not be answered any more.
    fn answered(&mut self, now: Time, question: i64) {
        let Some(at) = self.asked.iter().position(|(asked, _)| *asked == question) else { return };
        if let Some((_, asked)) = self.asked.drain(..=at).next_back() {
            self.round_trip = Some(now.saturating_sub(asked));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use autopilot_link::frame::{Decoder, encode};
    use mavlink::dialects::ardupilotmega::{MavMessage, TIMESYNC_DATA};

    const AUTOPILOT: Peer = Peer { system: 1, component: 1 };

    fn at(seconds: u64) -> Time {
        Time::from_secs(seconds)
    }

    fn receive(statistics: &mut Statistics, sender: Peer, sequence: u8, content: i64) {
        let message = MavMessage::TIMESYNC(TIMESYNC_DATA { tc1: content, ..TIMESYNC_DATA::DEFAULT });
        let mut decoder = Decoder::default();
        decoder.push(&encode(sender, sequence, &message));
        statistics.received(&decoder.next_frame().unwrap());
    }

    /// Received, lost and twice after these numbers, the content of each being its number.
    fn counted(sequences: impl IntoIterator<Item = u8>) -> (u64, u64, u64) {
        let mut statistics = Statistics::default();
        sequences.into_iter().for_each(|n| receive(&mut statistics, AUTOPILOT, n, i64::from(n) + 1));
        let figures = statistics.figures(at(1), 0);
        (figures.received, figures.lost, figures.duplicates)
    }

    #[test]
    fn gaps_are_losses_until_what_is_missing_comes_late_and_what_comes_twice_is_told() {
        assert_eq!(counted([250, 251, 252, 253, 254, 255, 0, 1]), (8, 0, 0));
        assert_eq!(counted([10, 12, 15]), (3, 3, 0));
        assert_eq!(counted([10, 12, 11, 13]), (4, 0, 0));
        assert_eq!(counted([10, 11, 11, 12, 10]), (5, 0, 2));
        assert_eq!(counted([254, 1]), (2, 2, 0));
        let rounds = (0..3).flat_map(|_| 0..=255).filter(|n| *n != 100);
        assert_eq!(counted(rounds), (3 * 255, 3, 0));
    }

    #[test]
    fn a_sender_that_counts_anew_or_not_at_all_has_lost_nothing() {
        let mut statistics = Statistics::default();
        (0..20).for_each(|n| receive(&mut statistics, AUTOPILOT, n, 1));
        // it restarts, with other content
        (0..20).for_each(|n| receive(&mut statistics, AUTOPILOT, n, 2));
        // another one has always the same number
        (0..20).for_each(|n| receive(&mut statistics, Peer { component: 2, ..AUTOPILOT }, 7, n));
        let figures = statistics.figures(at(1), 0);
        assert_eq!((figures.received, figures.lost, figures.duplicates), (60, 0, 0));
    }

    #[test]
    fn more_senders_than_can_be_are_counted_and_not_remembered() {
        let mut statistics = Statistics::default();
        for component in 0..=255 {
            (0..3).for_each(|n| receive(&mut statistics, Peer { system: 9, component }, 2 * n, 1));
        }
        assert_eq!(statistics.senders.len(), SENDERS);
        let figures = statistics.figures(at(1), 0);
        assert_eq!((figures.received, figures.lost), (768, 2 * SENDERS as u64));
    }

    #[test]
    fn rates_are_those_of_the_last_seconds() {
        let mut statistics = Statistics::default();
        let mut figures = statistics.figures(at(0), 0);
        assert_eq!((figures.messages_per_s, figures.loss), (0.0, 0.0));
        for second in 1..=20_u8 {
            // ten messages a second, of which one in two is lost from second 11 on
            for n in (0..10).filter(|n| second <= 10 || n % 2 == 0) {
                receive(&mut statistics, AUTOPILOT, second.wrapping_mul(10) + n, 1);
            }
            statistics.sent(100);
            figures = statistics.figures(at(second.into()), 3);
            if second == 10 {
                assert_eq!((figures.messages_per_s, figures.loss), (10.0, 0.0));
            }
        }
        assert_eq!((figures.messages_per_s, figures.sent_bytes_per_s, figures.bad), (5.0, 100.0, 3));
        assert!((figures.loss - 0.5).abs() < 0.02, "{figures:?}");
        // a frame of 13 bytes each
        assert_eq!(figures.received_bytes_per_s, 5.0 * 13.0);
    }

    #[test]
    fn the_way_there_and_back_is_timed_and_forgotten_when_nobody_answers() {
        let mut statistics = Statistics::default();
        let question = statistics.ask_time(at(1), 0);
        statistics.time_answered(at(2), question + 1);
        assert_eq!(statistics.figures(at(2), 0).round_trip_ms, None, "an answer to something else");
        statistics.time_answered(at(1) + Duration::from_millis(40), question);
        assert_eq!(statistics.figures(at(2), 0).round_trip_ms, Some(40.0));
        for second in 2..10 {
            let _ = statistics.ask_time(at(second), 0);
        }
        assert_eq!(statistics.figures(at(10), 0).round_trip_ms, None);
    }

    #[test]
    fn an_answer_that_comes_after_the_next_question_is_timed_too() {
        let mut statistics = Statistics::default();
        let [first, second, _] = [1, 2, 3].map(|second| statistics.ask_time(at(second), 0));
        statistics.time_answered(at(4), second);
        assert_eq!(statistics.round_trip(), Some(Duration::from_secs(2)));
        statistics.time_answered(at(4), first);
        assert_eq!(statistics.round_trip(), Some(Duration::from_secs(2)), "that one was overtaken");
    }
}
