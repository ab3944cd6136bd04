//! What the autopilot is, and whether it can be flown.

use super::super::super::DIALECTS;
use super::{Known, MavlinkDriver};
use crate::gateway::order::{Kind, Report, Time, Version};
use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, MavAutopilot, MavType, PARAM_VALUE_DATA};

/// Nobody circles wider than this, metres.
const WIDEST_M: f64 = 20_000.0;
/// So many heartbeats in a row that say that it is something else are believed.
const UNLIKE: u8 = 3;

impl MavlinkDriver {
    /// At each heartbeat, as long as one is not known, or not as it has to be.
    pub(super) fn ask_parameters(&mut self, now: Time) {
        let (Some(dialect), Some(peer)) = (self.dialect(), self.session.peer()) else { return };
        let out = &mut self.session.out;
        if let Some(need) = dialect.need {
            self.needed.tick(now, need.name, |value| need.is_met(value), peer, out);
        }
        if let Some(name) = dialect.landing_limit {
            self.landing_limit.tick(now, name, |_| true, peer, out);
        }
        self.loiter_radius.tick(now, dialect.loiter_radius, |_| true, peer, out);
        self.set_up.tick(now, dialect, peer, out);
        self.judge();
    }

    /// It says a parameter.
    pub(super) fn hear_parameter(&mut self, value: &PARAM_VALUE_DATA) {
        let Some(dialect) = self.dialect() else { return };
        if let Some(need) = dialect.need {
            self.needed.said(need.name, value, dialect.whole_as_bits);
        }
        if let Some(name) = dialect.landing_limit {
            self.landing_limit.said(name, value, dialect.whole_as_bits);
        }
        self.reports.extend(self.set_up.said(value, dialect).map(Report::SetUp));
        let before = self.loiter_radius.value();
        self.loiter_radius.said(dialect.loiter_radius, value, dialect.whole_as_bits);
        let radius_m =
            self.loiter_radius.value().filter(|radius_m| (1.0..=WIDEST_M).contains(&radius_m.abs()));
        self.reports
            .extend(radius_m.filter(|_| self.loiter_radius.value() != before).map(Report::LoiterRadius));
        self.judge();
    }

    /// The first heartbeat says what it is; it stays that, until several in a row say otherwise: one may be garbled.
    /// False: this one says so, and is none of its own.
    pub(super) fn recognise(&mut self, beat: &HEARTBEAT_DATA) -> bool {
        let kind = (beat.autopilot, beat.mavtype);
        match self.known {
            None => {
                let dialect = DIALECTS.iter().copied().find(|dialect| (dialect.is)(beat));
                if let Some(dialect) = dialect {
                    self.session.manner = dialect.manner;
                }
                self.list.supported = dialect.is_some();
                self.known = Some(Known { kind, unlike: 0, dialect });
                self.judge();
            }
            Some(known) if known.kind == kind => self.known = Some(Known { unlike: 0, ..known }),
            Some(known) if known.unlike + 1 < UNLIKE => {
                self.known = Some(Known { unlike: known.unlike + 1, ..known });
                return false;
            }
            Some(known) if known.dialect.is_some() => {
                self.list.supported = false;
                self.known = Some(Known { kind, unlike: 0, dialect: None });
                let (was, is) = (people(known.kind), people(kind));
                self.tell(Err(format!("It was {was} and says now that it is {is}: start the agent anew.")));
            }
            Some(_) => {}
        }
        true
    }

    /// Says whether it can be flown, once that is known and when it changes.
    pub(super) fn judge(&mut self) {
        let Some(Known { kind, dialect, .. }) = self.known else { return };
        let Some(dialect) = dialect else {
            // one that turned into another was refused by name
            return if self.told.is_none() {
                self.tell(Err(unsupported(kind)))
            };
        };
        if dialect.landing_limit.is_some() && !self.landing_limit.is_settled() {
            return;
        }
        let landing_deg = self.landing_limit.value();
        self.list.keep(dialect.feeding, landing_deg);
        let verdict = dialect.need.map_or(Some(Ok(())), |need| need.verdict(&self.needed));
        if let Some(verdict) = verdict {
            self.tell(verdict.map(|()| Kind { landing_deg, version: self.version, ..dialect.kind }));
        }
    }

    fn tell(&mut self, capability: Result<Kind, String>) {
        if self.told.as_ref() != Some(&capability) {
            self.told = Some(capability.clone());
            self.reports.push_back(Report::Capability(capability));
        }
    }
}

/// As `flight_sw_version` says it: a byte for each number, the highest first, and the kind of release (`FIRMWARE_VERSION_TYPE`).
pub fn version(said: u32) -> Option<Version> {
    let [major, minor, patch, kind] = (said > 0).then(|| said.to_be_bytes())?;
    let release = match kind {
        0..64 => "-dev",
        64..128 => "-alpha",
        128..192 => "-beta",
        192..255 => "-rc",
        255 => "",
    };
    Some(Version { series: [major, minor], patch, release })
}

fn people((autopilot, kind): (MavAutopilot, MavType)) -> String {
    let plain = |name: String| {
        name.replace("MAV_AUTOPILOT_", "").replace("MAV_TYPE_", "").replace('_', " ").to_lowercase()
    };
    format!("{} on {}", plain(format!("{autopilot:?}")), plain(format!("{kind:?}")))
}

/// Why such an autopilot is not flown, and what would be.
pub fn unsupported(kind: (MavAutopilot, MavType)) -> String {
    let known = DIALECTS.iter().map(|dialect| dialect.kind.name).collect::<Vec<_>>().join(", ");
    format!("{} is not supported. Connect one of: {known}.", people(kind))
}
