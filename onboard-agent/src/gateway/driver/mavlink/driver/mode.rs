//! What the autopilot shows of what it does: its mode, and whether it is armed.

use super::{Dialect, MavlinkDriver, Seen};
use crate::gateway::driver::mavlink::session::{self, SessionEvent};
use crate::gateway::order::{Aim, Mode, Report, Time};
use mavlink::dialects::ardupilotmega::HEARTBEAT_DATA;

impl MavlinkDriver {
    pub(super) fn on_heartbeat(&mut self, now: Time, beat: &HEARTBEAT_DATA, events: &mut Vec<SessionEvent>) {
        if !self.recognise(beat) {
            return;
        }
        let (armed, failsafe) = (session::is_armed(beat), session::is_failsafe(beat));
        let Some(dialect) = self.dialect() else {
            // without a dialect nothing is known of its modes
            let (mode, name) = (Mode::Other(beat.custom_mode), "unknown".into());
            return self.reports.push_back(Report::Heartbeat { mode, name, armed, failsafe: false });
        };
        self.shows(now, dialect, Seen { mode: beat.custom_mode, armed, failsafe }, events);
    }

    /// It says nothing but the mode; the rest stays as a heartbeat said it last.
    pub(super) fn on_summary(&mut self, now: Time, mode: u32, events: &mut Vec<SessionEvent>) {
        if let Some((dialect, seen)) = self.dialect().zip(self.seen) {
            self.shows(now, dialect, Seen { mode, ..seen }, events);
        }
    }

    fn shows(&mut self, now: Time, dialect: &'static Dialect, seen: Seen, events: &mut Vec<SessionEvent>) {
        let before = self.seen.replace(seen);
        let going = matches!(self.steering, Some((_, Aim::Direct { .. })));
        if !going && (dialect.meaning)(seen.mode, true) != Mode::Direct {
            self.sent = false;
        }
        self.report_mode(dialect);
        self.stand_late(now, dialect, events);
        let changed = before.is_some_and(|before| before.mode != seen.mode);
        self.say_speed_again(now, dialect, changed && dialect.forgets_speed, events);
    }

    pub(super) fn report_mode(&mut self, dialect: &Dialect) {
        let Some(Seen { mode: number, armed, failsafe }) = self.seen else { return };
        let mode = (dialect.meaning)(number, self.sent);
        self.list.flown = armed && mode == Mode::Waypoints;
        let name = (dialect.mode_name)(number);
        self.reports.push_back(Report::Heartbeat { mode, name, armed, failsafe });
    }

    /// What is under way to take the aircraft from whoever has it is not sent any more.
    pub(super) fn keep_hands(&mut self, off: bool) {
        self.list.hands_off = off;
        if let Some((id, _)) = self.steering.take_if(|_| off) {
            self.take_back(id, "somebody else flies");
        }
    }
}
