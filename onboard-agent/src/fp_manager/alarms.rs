//! Pure: the gateway's alarms that ask for an emergency plan, each answered once.
//!
//! They come as events; those raised while nobody listened, and those that could not be answered then, are found in
//! the gateway's state.

use flight_plan::Cause;
use std::cmp::Reverse;
use std::collections::BTreeSet;
use usal::contract::{Alarm, Severity};
use wire::Convert;

/// More identifiers are not remembered: a gateway has a few dozen alarms.
const MOST: usize = 256;

/// The gateway's alarms of an engine, for those that are remembered by name only: told, they say it by their cause.
const ENGINE_OUT: [&str; 3] = ["engine-out", "engine-suspected", "disarmed-in-flight"];

/// What was answered.
#[derive(Debug, Default)]
pub struct Alarms {
    /// Identifiers of alarms that were answered and are still raised, as far as known.
    answered: BTreeSet<String>,
    /// Alarms may have been missed when they were raised, or can be answered now.
    unread: bool,
    /// The engine gives no power, or seems to, whoever answered that.
    engine_out: bool,
    /// Those for which Safe mode is wanted of the gateway, and not granted yet.
    ask_for_safe: BTreeSet<String>,
}

/// An alarm that asks for an emergency plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Call {
    /// The alarm's identifier.
    pub id: String,
    /// What the plan has to be for.
    pub cause: Cause,
}

impl Alarms {
    /// With what an earlier FP Manager of this flight answered.
    pub fn restored(answered: BTreeSet<String>) -> Self {
        let engine_out = ENGINE_OUT.iter().any(|id| answered.contains(*id));
        Self { answered, unread: false, engine_out, ask_for_safe: BTreeSet::new() }
    }

    /// Identifiers of what was answered, to be kept for a restart.
    pub fn answered(&self) -> &BTreeSet<String> {
        &self.answered
    }

    /// The engine gives no power, or seems to, as the gateway told last.
    pub fn engine_is_out(&self) -> bool {
        self.engine_out
    }

    /// One was raised.
    pub fn raised(&mut self, alarm: &Alarm) {
        self.engine_out |= tells_of_engine(alarm);
    }

    /// All that are raised now.
    pub fn all(&mut self, alarms: &[Alarm]) {
        self.engine_out = alarms.iter().any(tells_of_engine);
    }

    /// It was acted on; until it goes away, nothing more comes of it.
    pub fn answer(&mut self, call: Call) {
        if self.answered.len() < MOST {
            self.answered.insert(call.id);
        }
    }

    /// Safe mode is wanted for it.
    pub fn asks_for_safe(&mut self, call: &Call) {
        self.ask_for_safe.insert(call.id.clone());
    }

    /// Safe mode was granted, or is wanted for a reason that does not go away with an alarm.
    pub fn safe_is_settled(&mut self) {
        self.ask_for_safe.clear();
    }

    /// Whether Safe mode was wanted only for alarms that are not among those raised now, or from a pilot who has the aircraft by now. They
    /// ask again, if they are still raised when he gives that back.
    pub fn no_longer_ask_for_safe(&mut self, alarms: &[Alarm], is_pilots: bool) -> bool {
        let is_raised = |id: &str| alarms.iter().any(|alarm| alarm.id == id);
        let over: Vec<String> = self.ask_for_safe.extract_if(.., |id| is_pilots || !is_raised(id)).collect();
        for id in &over {
            self.answered.remove(id);
            self.unread = true;
        }
        !over.is_empty() && self.ask_for_safe.is_empty()
    }

    /// An alarm went away.
    pub fn cleared(&mut self, id: &str) {
        self.answered.remove(id);
    }

    /// The next list of the gateway's alarms has to be read.
    pub fn read_again(&mut self) {
        self.unread = true;
    }

    /// What was answered in an earlier flight asks anew.
    pub fn new_flight(&mut self) {
        *self = Self { unread: true, ..Self::default() };
    }

    /// The alarms raised now, as the gateway publishes them; those that nobody answered yet, the most severe first.
    /// Nothing, unless they have to be read.
    pub fn listed(&mut self, alarms: &[Alarm]) -> Vec<Call> {
        if !std::mem::take(&mut self.unread) {
            return Vec::new();
        }
        self.answered.retain(|id| alarms.iter().any(|alarm| alarm.id == *id));
        let unanswered = alarms.iter().filter(|alarm| !self.answered.contains(&alarm.id));
        let mut calls: Vec<Call> = unanswered.filter_map(call).collect();
        calls.sort_by_key(|call| Reverse(call.cause));
        calls
    }
}

fn tells_of_engine(alarm: &Alarm) -> bool {
    alarm.cause.convert() == Some(Cause::Engine)
}

/// What an alarm asks for, if anything.
pub fn call(alarm: &Alarm) -> Option<Call> {
    let cause = alarm.cause.filter(|_| alarm.severity == Severity::Warning)?;
    Some(Call { id: alarm.id.clone(), cause: cause.convert() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn alarm(id: &str, severity: Severity, cause: Option<Cause>) -> Alarm {
        let cause = cause.convert();
        Alarm { id: id.into(), severity, source: "gateway".into(), advice: "land".into(), cause }
    }

    fn warning(id: &str, cause: Cause) -> Alarm {
        alarm(id, Severity::Warning, Some(cause))
    }

    /// Refused because its plan is flown already, an alarm is not answered; the engine is out all the same.
    #[test]
    fn the_engine_is_out_whoever_answered_that() {
        let mut alarms = Alarms::default();
        alarms.raised(&warning("engine-out", Cause::Engine));
        assert!(alarms.engine_is_out());
        alarms.all(&[warning("engine-suspected", Cause::Engine)]);
        assert!(alarms.engine_is_out(), "one followed the other");
        alarms.all(&[warning("disarmed-in-flight", Cause::Engine)]);
        assert!(alarms.engine_is_out(), "it may not run");
        alarms.all(&[warning("gps-lost", Cause::Gps)]);
        assert!(!alarms.engine_is_out());
        assert!(Alarms::restored(["engine-out".to_owned()].into()).engine_is_out());
    }

    #[test]
    fn only_warnings_with_a_cause_are_acted_on() {
        let cases = [
            (alarm("a", Severity::Warning, Some(Cause::Gps)), Some(Cause::Gps)),
            (alarm("a", Severity::Caution, Some(Cause::Gps)), None),
            (alarm("a", Severity::Warning, None), None),
        ];
        for (alarm, cause) in cases {
            assert_eq!(call(&alarm).map(|call| call.cause), cause, "{alarm:?}");
        }
    }

    /// Asks for Safe mode for each of a list.
    fn asking_for_safe(list: &[Alarm]) -> Alarms {
        let mut alarms = Alarms::default();
        for call in list.iter().filter_map(call) {
            alarms.asks_for_safe(&call);
            alarms.answer(call);
        }
        alarms
    }

    /// The voltage sags at full throttle, and the position is still not known when it is back.
    #[test]
    fn safe_mode_is_wanted_until_the_last_alarm_that_asks_for_it_is_over() {
        let list = [warning("gps-lost", Cause::Gps), warning("energy-low", Cause::Energy)];
        for (first, second) in [(0, 1), (1, 0)] {
            let mut alarms = asking_for_safe(&list);
            assert!(!alarms.no_longer_ask_for_safe(&list, false));
            assert!(!alarms.no_longer_ask_for_safe(&list[first..=first], false), "the other one is raised");
            assert_eq!(
                answered(&mut alarms, &list),
                [[Cause::Gps, Cause::Energy][second]],
                "it is over and comes anew"
            );
            assert!(alarms.no_longer_ask_for_safe(&[], false));
            assert!(!alarms.no_longer_ask_for_safe(&[], false), "once");
        }
    }

    #[test]
    fn whatever_asked_before_a_pilot_took_the_aircraft_asks_again_behind_him() {
        let list = [warning("gps-lost", Cause::Gps), warning("energy-low", Cause::Energy)];
        let mut alarms = asking_for_safe(&list);
        assert!(alarms.no_longer_ask_for_safe(&list, true));
        assert_eq!(answered(&mut alarms, &list).len(), 2);
    }

    /// Reads a list and answers what it asks for.
    fn answered(alarms: &mut Alarms, list: &[Alarm]) -> Vec<Cause> {
        alarms.read_again();
        let calls = alarms.listed(list);
        calls.iter().for_each(|call| alarms.answer(call.clone()));
        calls.into_iter().map(|call| call.cause).collect()
    }

    #[test]
    fn raised_unheard_it_is_found_in_the_list_the_most_severe_first_and_once() {
        let list = [warning("energy-low", Cause::Energy), warning("engine-out", Cause::Engine)];
        let mut alarms = Alarms::default();
        assert_eq!(alarms.listed(&list), [], "the event comes");
        assert_eq!(answered(&mut alarms, &list), [Cause::Engine, Cause::Energy]);
        assert_eq!(answered(&mut alarms, &list), []);
    }

    #[test]
    fn what_could_not_be_answered_asks_again_and_what_was_in_the_next_flight() {
        let list = [warning("energy-low", Cause::Energy)];
        let mut alarms = Alarms::default();
        for _ in 0..2 {
            alarms.read_again();
            assert_eq!(alarms.listed(&list).len(), 1);
        }
        assert_eq!(answered(&mut alarms, &list), [Cause::Energy]);
        assert_eq!(answered(&mut alarms, &list), []);
        alarms.new_flight();
        assert_eq!(alarms.listed(&list).len(), 1);
    }

    #[test]
    fn answered_before_a_restart_it_is_not_answered_again_unless_it_went_away() {
        let list = [warning("energy-low", Cause::Energy)];
        let mut alarms = Alarms::default();
        alarms.answer(call(&list[0]).unwrap());
        let mut alarms = Alarms::restored(alarms.answered().clone());
        assert_eq!(answered(&mut alarms, &list), []);
        alarms.cleared("energy-low");
        assert_eq!(answered(&mut alarms, &list), [Cause::Energy]);
    }

    #[test]
    fn gone_unheard_it_counts_anew() {
        let list = [warning("energy-low", Cause::Energy)];
        let mut alarms = Alarms::default();
        alarms.answer(call(&list[0]).unwrap());
        for (listed, causes) in [(&list[..0], vec![]), (&list[..], vec![Cause::Energy])] {
            assert_eq!(answered(&mut alarms, listed), causes);
        }
    }
}
