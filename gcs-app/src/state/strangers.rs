//! What others said in the name of a vehicle's services: it does not count, and the operator is told.

use super::GROUND_STATION;
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
        let is_news = !self.are_heard(now_s);
        let heard = self.heard.entry(service).or_default();
        *heard = heard.saturating_add(count);
        self.heard_s = Some(now_s);
        is_news
    }

    /// How many messages were ignored.
    pub fn ignored(&self) -> u64 {
        self.heard.values().fold(0, |sum, count| sum.saturating_add(*count))
    }

    /// As a sentence; nothing as long as nobody else spoke.
    pub fn text(&self) -> Option<String> {
        let services = self.heard.keys().copied().collect::<Vec<_>>().join(" and ");
        match self.ignored() {
            0 => None,
            1 => Some(format!("1 message of a stranger in the name of {services} is ignored")),
            count => Some(format!("{count} messages of a stranger in the name of {services} are ignored")),
        }
    }

    /// The alarm, as long as they go on.
    pub fn alarm(&self, now_s: f64) -> Option<Alarm> {
        let text = self.text().filter(|_| self.are_heard(now_s))?;
        Some(Alarm {
            id: "stranger".into(),
            severity: Severity::Caution,
            source: GROUND_STATION.into(),
            advice: format!("{text}: find that program and stop it."),
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
}
