//! Alarms about a vehicle: its own, and what this ground station notices itself, silence above all.

use super::{Vehicle, live};
use crate::state::watch::{GROUND_STATION, Sight};
use crate::state::zones_ahead::Zones;
use terrain::Terrain;
use usal::contract::{Alarm, Severity};

/// Silence after which the operator should know, seconds.
pub const LINK_CAUTION_S: f64 = 3.0;
/// Silence of its autopilot after which what that said is old, seconds: even an idle one speaks once a second.
const AUTOPILOT_SILENT_S: f64 = 3.0;
/// Silence after which the operator should act, seconds.
pub const LINK_WARNING_S: f64 = 10.0;

impl Vehicle {
    /// Seconds since anything was received, if ever.
    pub fn silence_s(&self, now_s: f64) -> Option<f64> {
        self.received_s.map(|received_s| (now_s - received_s).max(0.0))
    }

    /// Seconds for which its gateway, that is heard itself, has not heard its autopilot; `None`: it does hear it.
    pub fn autopilot_silence_s(&self, now_s: f64) -> Option<f64> {
        let gateway = self.gateway.as_ref().filter(|gateway| !gateway.is_expired(now_s))?;
        let silence_s = gateway.value.autopilot_age_s + gateway.age_s(now_s);
        (silence_s > AUTOPILOT_SILENT_S).then_some(silence_s)
    }

    /// Looks at the aircraft over the ground; what is raised anew is logged.
    pub(in crate::state) fn look(&mut self, terrain: &dyn Terrain, now_s: f64, unix_s: i64) {
        let plan = self.aboard.as_ref().map(|aboard| aboard.plan.as_ref());
        let zones = plan.map_or_else(Zones::default, |plan| Zones {
            all: &plan.zones,
            home_m: plan.home().map_or(0.0, |runway| runway.elevation_amsl_m),
            unix_s: Some(unix_s),
        });
        let before: Vec<String> = self.watch.alarms().map(|alarm| alarm.id).collect();
        let sight = Sight {
            position: live(&self.position, now_s).copied(),
            ahead: live(&self.ahead, now_s),
            state: live(&self.gateway, now_s).map(|status| (status.state, status.cause.as_str())),
            runways: plan.map(|plan| plan.runways.as_slice()).unwrap_or_default(),
            zones,
            engine_out: self.is_engine_out(),
        };
        self.watch.look(sight, terrain, now_s);
        for alarm in self.watch.alarms().filter(|alarm| !before.contains(&alarm.id)) {
            let text = format!("{}: {}", alarm.id, alarm.advice);
            self.log.add(now_s, alarm.severity.into(), GROUND_STATION, &text);
        }
    }

    /// Alarms, the most severe first: the gateway's, and this ground station's own.
    pub fn alarms(&self, now_s: f64) -> Vec<Alarm> {
        let mut alarms = self.gateway.as_ref().map(|g| g.value.alarms.clone()).unwrap_or_default();
        alarms.extend(self.link_alarm(now_s));
        alarms.extend(self.strangers.alarm(now_s));
        alarms.extend(self.watch.alarms());
        alarms.sort_by(|a, b| b.severity.cmp(&a.severity).then_with(|| a.id.cmp(&b.id)));
        alarms
    }

    /// Once after it has fallen silent (true), and once after it is heard again (false).
    pub(in crate::state) fn silence_changed(&mut self, now_s: f64) -> Option<bool> {
        let is_silent = self.link_alarm(now_s).is_some();
        let changed = is_silent != self.was_silent;
        self.was_silent = is_silent;
        // a link that was closed on purpose is not heard again
        let is_heard = self.silence_s(now_s).is_some_and(|silence_s| silence_s < LINK_CAUTION_S);
        (changed && (is_silent || is_heard)).then_some(is_silent)
    }

    fn link_alarm(&self, now_s: f64) -> Option<Alarm> {
        let silence = self.silence_s(now_s).filter(|s| *s > LINK_CAUTION_S && self.link.is_wanted())?;
        let warning = silence > LINK_WARNING_S && self.is_airborne();
        Some(Alarm {
            id: "link-silent".into(),
            severity: if warning { Severity::Warning } else { Severity::Caution },
            source: GROUND_STATION.into(),
            advice: "Nothing is heard from the vehicle. It flies on by its plan; check the link.".into(),
            cause: None,
        })
    }
}
