//! What others said in the name of a vehicle's services: it does not count but for a second FP Manager, and the operator is told.

use super::GROUND_STATION;
use crate::link::may_be_two;
use std::collections::BTreeMap;
use usal::contract::{Alarm, Severity};

/// They are told as an alarm as long as they were heard so lately, seconds.
const LATELY_S: f64 = 10.0;

/// Messages of others since the link was opened.
#[derive(Debug, Default)]
pub struct Strangers {
    /// How many came, by service.
    heard: BTreeMap<&'static str, u64>,
    heard_s: Option<f64>,
}

impl Strangers {
    /// Counts messages in the name of a service; true if that is news.
    pub fn heard(&mut self, service: &'static str, count: u64, now_s: f64) -> bool {
        let is_first = !self.heard.contains_key(service);
        let is_news = !self.are_heard(now_s) || (is_first && may_be_two(service));
        let heard = self.heard.entry(service).or_default();
        *heard = heard.saturating_add(count);
        self.heard_s = Some(now_s);
        is_news
    }

    /// How many messages were ignored.
    pub fn ignored(&self) -> u64 {
        self.of_strangers().fold(0, |sum, (_, count)| sum.saturating_add(count))
    }

    /// As a sentence; nothing as long as nobody else spoke.
    pub fn text(&self) -> Option<String> {
        let parts: Vec<String> = [self.seconds(), self.strange()].into_iter().flatten().collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    /// Services that are there twice.
    fn seconds(&self) -> Option<String> {
        let services: Vec<_> = self.heard.keys().copied().filter(|service| may_be_two(service)).collect();
        (!services.is_empty()).then(|| {
            format!("a second program speaks as {}, and what both say is shown", services.join(" and "))
        })
    }

    /// What is ignored.
    fn strange(&self) -> Option<String> {
        let count = self.ignored();
        let services: Vec<_> = self.of_strangers().map(|(service, _)| service).collect();
        let services = services.join(" and ");
        match count {
            0 => None,
            1 => Some(format!("1 message of a stranger in the name of {services} is ignored")),
            _ => Some(format!("{count} messages of a stranger in the name of {services} are ignored")),
        }
    }

    fn of_strangers(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        self.heard
            .iter()
            .filter(|(service, _)| !may_be_two(service))
            .map(|(service, count)| (*service, *count))
    }

    /// What to do about it.
    fn remedy(&self) -> &'static str {
        match self.seconds() {
            Some(_) => "find both, and stop the one that the gateway has not joined: not the one that flies",
            None => "find that program and stop it",
        }
    }

    /// The alarm, as long as they go on.
    pub fn alarm(&self, now_s: f64) -> Option<Alarm> {
        let text = self.text().filter(|_| self.are_heard(now_s))?;
        Some(Alarm {
            id: "stranger".into(),
            severity: Severity::Caution,
            source: GROUND_STATION.into(),
            advice: format!("{text}: {}.", self.remedy()),
            cause: None,
        })
    }

    fn are_heard(&self, now_s: f64) -> bool {
        self.heard_s.is_some_and(|heard_s| now_s - heard_s < LATELY_S)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_news_once_and_an_alarm_while_they_go_on() {
        let mut strangers = Strangers::default();
        assert_eq!((strangers.text(), strangers.alarm(0.0)), (None, None));
        assert!(strangers.heard("gateway", 1, 0.0));
        assert!(strangers.text().unwrap().starts_with("1 message of a stranger in the name of gateway is"));
        assert!(!strangers.heard("storage", 6, 5.0));
        let advice = strangers.alarm(14.0).unwrap().advice;
        assert!(
            advice.starts_with("7 messages of a stranger in the name of gateway and storage"),
            "{advice}"
        );
        assert_eq!(strangers.alarm(15.0), None);
        assert_eq!(strangers.ignored(), 7, "what was ignored stays known");
        assert!(strangers.heard("gateway", u64::MAX, 30.0), "they are back");
        assert_eq!(strangers.ignored(), u64::MAX);
    }

    #[test]
    fn a_second_fp_manager_is_told_as_one_that_is_shown_and_nobody_is_told_to_stop_the_first() {
        let mut strangers = Strangers::default();
        strangers.heard("gateway", 1, 0.0);
        assert!(strangers.heard("fp-manager", 6, 1.0), "it is news, whatever else was heard");
        let advice = strangers.alarm(2.0).unwrap().advice;
        assert!(
            advice.contains("a second program speaks as fp-manager, and what both say is shown"),
            "{advice}"
        );
        assert!(advice.ends_with("not the one that flies."), "{advice}");
        assert_eq!(strangers.ignored(), 1);
        assert!(!strangers.heard("fp-manager", 1, 3.0));
    }
}
