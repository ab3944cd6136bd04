//! Of what several links say of one aircraft, the newest: a link may be seconds slower than another.

use mavlink::dialects::ardupilotmega::MavMessage;
use std::time::Duration;

/// The autopilot's clock went back by more than this: it started anew, ms.
const REBOOT_MS: u32 = 2000;
/// Kinds of messages that say when they were true.
const STAMPED: usize = 3;

/// Its kind, and when it was true: ms since the autopilot started.
pub fn stamp(message: &MavMessage) -> Option<(usize, u32)> {
    match message {
        MavMessage::GLOBAL_POSITION_INT(m) => Some((0, m.time_boot_ms)),
        MavMessage::ATTITUDE(m) => Some((1, m.time_boot_ms)),
        MavMessage::SYSTEM_TIME(m) => Some((2, m.time_boot_ms)),
        _ => None,
    }
}

/// The autopilot's clock, as one link brings it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Clock {
    /// Of each kind of message, ms.
    at: [Option<u32>; STAMPED],
    /// So often it was seen to start anew.
    boots: u32,
}

impl Clock {
    /// A message with this stamp came.
    pub fn read(&mut self, (kind, ms): (usize, u32)) {
        let before = self.at.get(kind).copied().flatten();
        if before.is_some_and(|before| ms.saturating_add(REBOOT_MS) < before) {
            *self = Self { boots: self.boots.saturating_add(1), ..Self::default() };
        }
        if let Some(at) = self.at.get_mut(kind) {
            *at = Some(ms);
        }
    }

    /// So much older than over the other link is what comes over this one.
    pub fn behind(&self, other: &Self) -> Duration {
        let both = self.at.iter().zip(other.at).find_map(|(own, other)| Some(other?.saturating_sub((*own)?)));
        let ms = both.filter(|_| self.boots == other.boots).unwrap_or(0);
        Duration::from_millis(ms.into())
    }
}

/// The newest that was taken of each kind, over whichever link.
#[derive(Debug, Default)]
pub struct Newest {
    at: [u32; STAMPED],
    boots: u32,
    rebooted: bool,
}

impl Newest {
    /// It is no older than what was taken before. `clock`: of its link, which has read it; `used`: it came over the link that is
    /// spoken over, whose word on a new start counts.
    pub fn takes(&mut self, (kind, ms): (usize, u32), clock: &Clock, used: bool) -> bool {
        if used && clock.boots > self.boots {
            *self = Self { boots: clock.boots, rebooted: true, ..Self::default() };
        }
        let Some(at) = self.at.get_mut(kind).filter(|at| clock.boots == self.boots && ms >= **at) else {
            return false;
        };
        *at = ms;
        true
    }

    /// The latest of all that was taken, ms since the autopilot started.
    pub fn ms(&self) -> u32 {
        self.at.into_iter().max().unwrap_or(0)
    }

    /// It is spoken over this link from now on: a start that another one showed is no news there, and one that only this one
    /// showed is.
    pub fn follow(&mut self, clock: &mut Clock) {
        clock.boots = clock.boots.max(self.boots);
    }

    /// The autopilot started anew; said once.
    pub fn take_reboot(&mut self) -> bool {
        std::mem::take(&mut self.rebooted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What comes over links, the first of which is used: its stamp, and whether it is taken.
    fn check(came: &[(usize, u32, bool)]) -> Newest {
        let (mut newest, mut clocks) = (Newest::default(), [Clock::default(); 2]);
        for (link, ms, taken) in came {
            clocks[*link].read((0, *ms));
            assert_eq!(newest.takes((0, *ms), &clocks[*link], *link == 0), *taken, "{ms} over {link}");
        }
        newest
    }

    #[test]
    fn what_is_older_than_what_was_taken_is_not() {
        check(&[(0, 1000, true), (1, 900, false), (1, 1050, true), (0, 1040, false), (0, 1050, true)]);
    }

    #[test]
    fn a_start_is_seen_once_and_by_the_link_in_use() {
        let came = [(0, 90_000, true), (1, 90_010, true), (1, 300, false), (0, 500, true), (1, 600, true)];
        assert!(check(&came).take_reboot());
        assert!(!check(&came[..3]).take_reboot(), "the link in use has not shown it yet");
        let late =
            [(0, 90_000, true), (1, 80_000, false), (0, 500, true), (1, 80_100, false), (0, 600, true)];
        assert!(check(&late).take_reboot());
        assert!(!check(&[(0, 90_000, true), (1, 80_000, false), (1, 80_500, false)]).take_reboot());
    }

    #[test]
    fn one_link_is_so_much_behind_another() {
        let clock = |ms| {
            let mut clock = Clock::default();
            clock.read((1, ms));
            clock
        };
        assert_eq!(clock(4000).behind(&clock(7600)), Duration::from_millis(3600));
        assert_eq!(clock(7600).behind(&clock(4000)), Duration::ZERO);
        assert_eq!(Clock::default().behind(&clock(4000)), Duration::ZERO);
    }
}
