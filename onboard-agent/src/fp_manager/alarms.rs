//! Pure: the gateway's alarms that ask for an emergency plan, each answered once.
//!
//! They come as events; those raised while nobody listened are found in the gateway's state
//! after a join.

use std::cmp::Reverse;
use std::collections::BTreeSet;
use usal::contract::{Alarm, Cause, Severity};

/// More identifiers are not remembered: a gateway has a few dozen alarms.
const MOST: usize = 256;

/// What was answered.
#[derive(Debug, Default)]
pub struct Alarms {
    /// Identifiers of alarms that were answered and are still raised, as far as known.
    answered: BTreeSet<String>,
    /// Alarms may have been raised unheard.
    unread: bool,
}

impl Alarms {
    /// With what an earlier FP Manager of this flight answered.
    pub fn restored(answered: BTreeSet<String>) -> Self {
        Self { answered, unread: false }
    }

    /// Identifiers of what was answered, to be kept for a restart.
    pub fn answered(&self) -> &BTreeSet<String> {
        &self.answered
    }

    /// An alarm came up; the cause to act on, if any.
    pub fn raised(&mut self, alarm: &Alarm) -> Option<Cause> {
        let cause = actionable(alarm)?;
        if self.answered.len() < MOST {
            self.answered.insert(alarm.id.clone());
        }
        Some(cause)
    }

    /// An alarm went away.
    pub fn cleared(&mut self, id: &str) {
        self.answered.remove(id);
    }

    /// The gateway was joined: the next list of its alarms has to be looked at.
    pub fn joined(&mut self) {
        self.unread = true;
    }

    /// The alarms raised now, as the gateway publishes them; the causes of those that nobody
    /// answered yet, the most severe first. Nothing but after a join.
    pub fn listed(&mut self, alarms: &[Alarm]) -> Vec<Cause> {
        if !std::mem::take(&mut self.unread) {
            return Vec::new();
        }
        self.answered.retain(|id| alarms.iter().any(|alarm| alarm.id == *id));
        let unanswered: Vec<&Alarm> = alarms.iter().filter(|a| !self.answered.contains(&a.id)).collect();
        let mut causes: Vec<Cause> = unanswered.into_iter().filter_map(|alarm| self.raised(alarm)).collect();
        causes.sort_by_key(|cause| Reverse(*cause));
        causes
    }
}

fn actionable(alarm: &Alarm) -> Option<Cause> {
    alarm.cause.filter(|_| alarm.severity == Severity::Warning)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn alarm(id: &str, severity: Severity, cause: Option<Cause>) -> Alarm {
        Alarm { id: id.into(), severity, source: "gateway".into(), advice: "land".into(), cause }
    }

    fn warning(id: &str, cause: Cause) -> Alarm {
        alarm(id, Severity::Warning, Some(cause))
    }

    #[test]
    fn only_warnings_with_a_cause_are_acted_on() {
        let cases = [
            (alarm("a", Severity::Warning, Some(Cause::Gps)), Some(Cause::Gps)),
            (alarm("a", Severity::Caution, Some(Cause::Gps)), None),
            (alarm("a", Severity::Warning, None), None),
        ];
        for (alarm, cause) in cases {
            assert_eq!(Alarms::default().raised(&alarm), cause, "{alarm:?}");
        }
    }

    #[test]
    fn raised_unheard_it_is_found_after_a_join_and_once() {
        let list = [warning("energy-low", Cause::Energy), warning("engine-out", Cause::Engine)];
        let mut alarms = Alarms::default();
        assert_eq!(alarms.listed(&list), [], "not without a join: the event comes");
        alarms.joined();
        assert_eq!(alarms.listed(&list), [Cause::Engine, Cause::Energy]);
        alarms.joined();
        assert_eq!(alarms.listed(&list), []);
    }

    #[test]
    fn answered_before_a_restart_it_is_not_answered_again_unless_it_went_away() {
        let list = [warning("energy-low", Cause::Energy)];
        let mut alarms = Alarms::default();
        alarms.raised(&list[0]);
        let mut alarms = Alarms::restored(alarms.answered().clone());
        alarms.joined();
        assert_eq!(alarms.listed(&list), []);
        alarms.cleared("energy-low");
        alarms.joined();
        assert_eq!(alarms.listed(&list), [Cause::Energy]);
    }

    #[test]
    fn gone_unheard_it_counts_anew() {
        let list = [warning("energy-low", Cause::Energy)];
        let mut alarms = Alarms::default();
        alarms.raised(&list[0]);
        for (listed, causes) in [(&list[..0], vec![]), (&list[..], vec![Cause::Energy])] {
            alarms.joined();
            assert_eq!(alarms.listed(listed), causes);
        }
    }
}
