//! Which telemetry a peer gets, and how often.

use super::STEP_NS;

/// A message that is sent by rate, its interval by default (ms; 0: only on request) and the stream of the old
/// `REQUEST_DATA_STREAM` it belongs to (0: none).
pub type Streamed = (u32, u64, u8);

/// In place of a stream: the interval is nobody's to change.
pub const UNCHANGEABLE: u8 = u8::MAX;

/// No message that is sent comes more seldom: a real ArduPlane takes a longer interval for this one.
const LONGEST_NS: u64 = 60_000_000_000;

#[derive(Debug, Clone, Copy)]
struct Stream {
    id: u32,
    interval_ns: u64,
    due_ns: u64,
}

/// The rates of one peer.
#[derive(Debug)]
pub struct Streams {
    known: &'static [Streamed],
    streams: Vec<Stream>,
}

impl Streams {
    /// The defaults, the first of each due at once.
    pub fn new(known: &'static [Streamed], now_ns: u64) -> Self {
        let stream = |(id, ms, _): &Streamed| Stream { id: *id, interval_ns: ms * 1_000_000, due_ns: now_ns };
        Self { known, streams: known.iter().map(stream).collect() }
    }

    /// Sets an interval in microseconds: −1 stops it, 0 is the default; false for an unknown message.
    /// Nothing comes more often than the simulator's step, nothing more seldom than once a minute.
    pub fn set_interval_us(&mut self, id: u32, interval_us: f64, now_ns: u64) -> bool {
        let default = self.known.iter().find(|(known, _, of)| *known == id && *of != UNCHANGEABLE);
        let stream = self.streams.iter_mut().find(|s| s.id == id);
        let (Some((_, default_ms, _)), Some(stream)) = (default, stream) else {
            return false;
        };
        stream.interval_ns = match interval_us {
            us if us < 0.0 => 0,
            us if us >= 1.0 => ((us * 1000.0) as u64).clamp(STEP_NS, LONGEST_NS),
            _ => default_ms * 1_000_000,
        };
        stream.due_ns = now_ns;
        true
    }

    /// The interval in microseconds: −1 if it isn't sent, 0 if unknown.
    pub fn interval_us(&self, id: u32) -> i32 {
        match self.streams.iter().find(|s| s.id == id).map(|s| s.interval_ns) {
            Some(0) => -1,
            Some(ns) => i32::try_from(ns / 1000).unwrap_or(i32::MAX),
            None => 0,
        }
    }

    /// The old way: a group of messages (0: all) at a rate in Hz; 0 Hz stops it.
    pub fn set_group(&mut self, group: u8, rate_hz: u16, now_ns: u64) {
        let us = if rate_hz == 0 { -1.0 } else { 1e6 / f64::from(rate_hz) };
        for &(id, default_ms, of) in self.known {
            // heartbeats aren't anybody's to stop
            if default_ms > 0 && of != 0 && (group == 0 || of == group) {
                self.set_interval_us(id, us, now_ns);
            }
        }
    }

    /// The messages due by now; they are due again an interval later.
    pub fn due(&mut self, now_ns: u64) -> Vec<u32> {
        let mut due = Vec::new();
        for stream in self.streams.iter_mut().filter(|s| s.interval_ns > 0 && s.due_ns <= now_ns) {
            due.push(stream.id);
            stream.due_ns = (stream.due_ns + stream.interval_ns).max(now_ns + 1);
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::personality::Personality;

    fn streams() -> Streams {
        Streams::new(Personality::ArduPlane.rules().streams, 0)
    }

    fn count(streams: &mut Streams, id: u32, seconds: u64) -> usize {
        (0..seconds * 10).flat_map(|i| streams.due(i * STEP_NS)).filter(|d| *d == id).count()
    }

    #[test]
    fn rates_are_kept() {
        for (interval_us, expected) in
            [(0.0, 40), (100_000.0, 100), (1_000_000.0, 10), (300_000.0, 34), (-1.0, 0), (20_000.0, 100)]
        {
            let mut streams = streams();
            assert!(streams.set_interval_us(30, interval_us, 0));
            assert_eq!(count(&mut streams, 30, 10), expected, "{interval_us}");
        }
    }

    #[test]
    fn an_interval_beyond_all_time_is_a_minute() {
        for endless in [61e6, 1e18, f64::MAX, f64::INFINITY] {
            let mut streams = streams();
            assert!(streams.set_interval_us(30, endless, 0));
            assert_eq!(count(&mut streams, 30, 121), 3, "{endless}");
            assert_eq!(streams.interval_us(30), 60_000_000);
        }
    }

    #[test]
    fn groups_and_unknown_messages() {
        let mut streams = streams();
        assert!(!streams.set_interval_us(9999, 1e6, 0));
        streams.set_group(0, 0, 0);
        assert_eq!((streams.interval_us(33), streams.interval_us(0)), (-1, 1_000_000));
        streams.set_group(6, 2, 0);
        assert_eq!((streams.interval_us(33), streams.interval_us(30)), (500_000, -1));
    }
}
