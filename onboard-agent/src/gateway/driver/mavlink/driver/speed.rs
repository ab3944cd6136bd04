//! The airspeed that was commanded, and when it is commanded again.

use super::super::commands::{Client, Command};
use super::super::dialect::Dialect;
use super::super::session::SessionEvent;
use super::{MavlinkDriver, Seen};
use crate::gateway::order::{Mode, Time};

/// The airspeed that was commanded last.
#[derive(Debug, Default)]
pub(super) struct Speed {
    mps: Option<f64>,
    /// With so many heartbeats more it is commanded again.
    repeats: u8,
}

impl Speed {
    /// It is commanded now, m/s.
    pub(super) fn said(mps: f64, dialect: Option<&Dialect>) -> Self {
        Self { mps: Some(mps), repeats: dialect.map_or(0, |dialect| dialect.speed_repeats) }
    }
}

impl MavlinkDriver {
    /// At each heartbeat. The airspeed is commanded again when it was forgotten, or may not have been taken; in the modes that we ask
    /// for.
    pub(super) fn say_speed_again(
        &mut self,
        now: Time,
        dialect: &Dialect,
        is_forgotten: bool,
        events: &mut Vec<SessionEvent>,
    ) {
        let is_due = is_forgotten || self.speed.repeats > 0;
        let (Some(Seen { mode, armed: true, .. }), true) = (self.seen, is_due) else { return };
        let ours = matches!((dialect.meaning)(mode, self.sent), Mode::Waypoints | Mode::Direct);
        if let Some(mps) = self.speed.mps.filter(|_| ours) {
            self.speed.repeats = self.speed.repeats.saturating_sub(1);
            self.session.command(now, Client::Nobody, Command::Speed(mps), events);
        }
    }
}
