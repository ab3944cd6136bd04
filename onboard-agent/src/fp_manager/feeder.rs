//! Pure: waypoints on their way to the gateway, one transaction at a time, in order.
//!
//! What waits is one transaction: later ones are merged into it, so it never holds more than the
//! executor's horizon. A transaction whose answer got lost may or may not have been taken; that
//! is settled by the highest token the gateway gives at a join.

use service::Time;
use std::time::Duration;
use usal::contract::{Feed, FeedAnswer, Token};

/// Pause before a transaction that found no room, or no ear, is sent again.
const RETRY: Duration = Duration::from_millis(500);

/// The way from executor to gateway.
#[derive(Debug, Default)]
pub struct Feeder {
    waiting: Option<Feed>,
    sent: Option<Feed>,
    /// The answer to what was sent got lost.
    uncertain: bool,
    /// What was sent is of no interest any more, whatever the answer.
    abandoned: bool,
    not_before: Option<Time>,
}

/// What became of a transaction.
#[derive(Debug, Clone, PartialEq)]
pub enum BatchResult {
    /// Taken by the gateway.
    Taken,
    /// Refused whole: its first token, and why.
    Refused(Token, String),
    /// Not now; it will be sent again.
    Later(String),
    /// Nobody knows: join, and pass the answer to [`Feeder::settle`].
    Unknown,
}

impl Feeder {
    /// Takes a transaction over.
    pub fn push(&mut self, feed: Feed) {
        self.waiting = Some(match self.waiting.take() {
            Some(earlier) => merged(earlier, feed),
            None => feed,
        });
    }

    /// The transaction to be sent now, if any.
    pub fn send(&mut self, now: Time) -> Option<Feed> {
        if self.sent.is_some() || self.not_before.is_some_and(|t| now < t) {
            return None;
        }
        self.not_before = None;
        self.sent = self.waiting.take();
        self.sent.clone()
    }

    /// The answer to what was sent; `None`: there was none.
    pub fn answered(&mut self, now: Time, answer: Option<FeedAnswer>) -> BatchResult {
        let Some(sent) = self.sent.take() else { return BatchResult::Taken };
        if std::mem::take(&mut self.abandoned) {
            return BatchResult::Taken;
        }
        match answer {
            Some(FeedAnswer::Accepted) => BatchResult::Taken,
            Some(FeedAnswer::Refused { faults }) => {
                let first = sent.waypoints.first().map_or(Token(0), |w| w.token);
                let newer = self.waiting.take().filter(|w| w.cancel_after.is_some_and(|last| last < first));
                match newer {
                    // what was refused is not wanted any more, but what it was to cancel still is not
                    Some(Feed { cancel_after, waypoints }) => {
                        let cancel_after = cancel_after.min(sent.cancel_after.or(cancel_after));
                        self.waiting = Some(Feed { cancel_after, waypoints });
                        BatchResult::Later(sentence(&faults))
                    }
                    None => BatchResult::Refused(first, sentence(&faults)),
                }
            }
            Some(FeedAnswer::Full) => self.later(now, sent, "the gateway's buffer is full"),
            Some(FeedAnswer::NotNow(why)) => self.later(now, sent, &why),
            None => {
                self.sent = Some(sent);
                self.uncertain = true;
                BatchResult::Unknown
            }
        }
    }

    fn later(&mut self, now: Time, sent: Feed, why: &str) -> BatchResult {
        self.unsend(sent);
        self.not_before = Some(now + RETRY);
        BatchResult::Later(why.to_owned())
    }

    /// The gateway has given the highest token it ever took: what it took is done, the rest is sent again.
    pub fn settle(&mut self, highest: Token) {
        if !std::mem::take(&mut self.uncertain) {
            return;
        }
        let Some(sent) = self.sent.take() else { return };
        if sent.waypoints.last().is_none_or(|w| w.token > highest) {
            self.unsend(sent);
        }
    }

    fn unsend(&mut self, sent: Feed) {
        self.waiting = Some(match self.waiting.take() {
            Some(later) => merged(sent, later),
            None => sent,
        });
    }

    /// The aircraft flies: a start that was taken back, and had to wait for an ear, is somebody else's flight by now.
    pub fn drop_take_back(&mut self) {
        self.waiting.take_if(|feed| feed.cancel_after == Some(Token(0)) && feed.waypoints.is_empty());
    }

    /// There is room again, or the gateway takes waypoints again: what waits may go at once.
    pub fn hurry(&mut self) {
        self.not_before = None;
    }

    /// Forgets everything: the executor will feed it anew.
    pub fn clear(&mut self) {
        self.waiting = None;
        if std::mem::take(&mut self.uncertain) {
            self.sent = None;
        }
        self.abandoned = self.sent.is_some();
    }

    /// Nothing waits and nothing is under way.
    pub fn is_idle(&self) -> bool {
        self.waiting.is_none() && self.sent.is_none()
    }

    /// A transaction was sent and not answered yet.
    pub fn is_under_way(&self) -> bool {
        self.sent.is_some()
    }

    /// The first waypoint that waits to be sent.
    pub fn first_waiting(&self) -> Option<Token> {
        self.waiting.as_ref()?.waypoints.first().map(|w| w.token)
    }

    /// So many waypoints wait.
    pub fn waiting(&self) -> usize {
        self.waiting.as_ref().map_or(0, |f| f.waypoints.len())
    }
}

/// One transaction with the effect of two.
fn merged(first: Feed, then: Feed) -> Feed {
    let Feed { mut cancel_after, mut waypoints } = first;
    if let Some(cancel) = then.cancel_after {
        let begins = waypoints.first().map(|w| w.token);
        waypoints.retain(|w| w.token <= cancel);
        // a cut within the first transaction touches nothing that the gateway has
        if begins.is_none_or(|begins| cancel < begins) {
            cancel_after = Some(cancel_after.map_or(cancel, |c| c.min(cancel)));
        }
    }
    waypoints.extend(then.waypoints);
    Feed { cancel_after, waypoints }
}

/// The first faults, for people.
fn sentence(faults: &[(Token, String, String)]) -> String {
    let reasons =
        faults.iter().take(3).map(|(token, code, reason)| format!("waypoint {}: {reason} ({code})", token.0));
    let mut text = reasons.collect::<Vec<_>>().join("; ");
    if faults.len() > 3 {
        text.push_str(&format!("; and {} more", faults.len() - 3));
    }
    if text.is_empty() { "the gateway gives no reason".into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use usal::contract::{Action, LatLon, Waypoint};

    const NOW: Time = Time::ZERO;

    fn waypoint(token: u64) -> Waypoint {
        Waypoint {
            token: Token(token),
            position: LatLon { lat_deg: 36.0, lon_deg: -84.0 },
            altitude_amsl_m: 500.0,
            airspeed_mps: 22.0,
            action: Action::Fly,
            fly_over: false,
            on_arc: false,
            leg: "a".into(),
            end_of_plan: false,
        }
    }

    fn feed(cancel_after: Option<u64>, tokens: impl IntoIterator<Item = u64>) -> Feed {
        Feed { cancel_after: cancel_after.map(Token), waypoints: tokens.into_iter().map(waypoint).collect() }
    }

    /// The gateway's buffer, in tokens.
    fn apply(buffer: &mut Vec<u64>, feed: &Feed) {
        if let Some(cancel) = feed.cancel_after {
            buffer.retain(|t| *t <= cancel.0);
        }
        buffer.extend(feed.waypoints.iter().map(|w| w.token.0));
    }

    proptest! {
        #[test]
        fn merging_has_the_effect_of_one_after_the_other(
            kept in 1u64..6, cuts in proptest::collection::vec((proptest::option::of(0u64..8), 0u64..5), 1..6),
        ) {
            let mut buffer: Vec<u64> = (1..=kept).collect();
            let mut next = kept;
            let mut feeder = Feeder::default();
            let mut direct = buffer.clone();
            for (back, count) in cuts {
                let cancel = back.map(|back| next.saturating_sub(back));
                let one = feed(cancel, next + 1..=next + count);
                next += count;
                apply(&mut direct, &one);
                feeder.push(one);
            }
            apply(&mut buffer, &feeder.send(NOW).unwrap());
            prop_assert_eq!(buffer, direct);
        }
    }

    #[test]
    fn one_in_flight_at_a_time() {
        let mut feeder = Feeder::default();
        feeder.push(feed(None, 1..=2));
        assert_eq!(feeder.send(NOW).unwrap(), feed(None, 1..=2));
        feeder.push(feed(None, 3..=3));
        assert_eq!(feeder.send(NOW), None);
        assert_eq!(feeder.answered(NOW, Some(FeedAnswer::Accepted)), BatchResult::Taken);
        assert_eq!(feeder.send(NOW).unwrap(), feed(None, 3..=3));
        assert!(!feeder.is_idle());
        feeder.answered(NOW, Some(FeedAnswer::Accepted));
        assert!(feeder.is_idle());
    }

    #[test]
    fn buffer_full_it_comes_again_when_there_is_room() {
        let mut feeder = Feeder::default();
        feeder.push(feed(None, 1..=2));
        feeder.send(NOW);
        feeder.push(feed(None, 3..=3));
        assert!(matches!(feeder.answered(NOW, Some(FeedAnswer::Full)), BatchResult::Later(_)));
        assert_eq!(feeder.send(NOW + RETRY / 2), None);
        assert_eq!(feeder.send(NOW + RETRY).unwrap(), feed(None, 1..=3));
        feeder.answered(NOW, Some(FeedAnswer::NotNow("Safe".into())));
        feeder.hurry();
        assert_eq!(feeder.send(NOW).unwrap(), feed(None, 1..=3));
    }

    #[test]
    fn a_start_that_is_taken_back_is_dropped_once_the_aircraft_flies_and_nothing_else_is() {
        for (waits, stays) in
            [(feed(Some(0), []), false), (feed(Some(0), 1..=1), true), (feed(Some(3), []), true)]
        {
            let mut feeder = Feeder::default();
            feeder.push(waits);
            feeder.send(NOW);
            feeder.answered(NOW, Some(FeedAnswer::NotNow("not heard".into())));
            feeder.drop_take_back();
            assert_eq!(!feeder.is_idle(), stays);
        }
    }

    #[test]
    fn refused_batch_takes_those_behind_it_along() {
        let mut feeder = Feeder::default();
        feeder.push(feed(None, 4..=5));
        feeder.send(NOW);
        feeder.push(feed(None, 6..=6));
        let faults = vec![(Token(5), "range".into(), "too far".into())];
        let result = feeder.answered(NOW, Some(FeedAnswer::Refused { faults }));
        assert_eq!(result, BatchResult::Refused(Token(4), "waypoint 5: too far (range)".into()));
        assert!(feeder.is_idle());
    }

    #[test]
    fn refused_batch_that_was_cancelled_meanwhile_takes_nothing_along() {
        for (refused_cancels, cancels) in [(None, 0), (Some(2), 0), (Some(0), 2)] {
            let mut feeder = Feeder::default();
            feeder.push(feed(refused_cancels, 4..=5));
            feeder.send(NOW);
            feeder.push(feed(Some(cancels), 6..=7));
            let faults = vec![(Token(5), "range".into(), "too far".into())];
            assert!(matches!(
                feeder.answered(NOW, Some(FeedAnswer::Refused { faults })),
                BatchResult::Later(_)
            ));
            assert_eq!(feeder.send(NOW).unwrap(), feed(Some(0), 6..=7));
        }
    }

    #[test]
    fn answer_lost_what_the_gateway_took_is_not_sent_twice() {
        for (highest, again) in [(2, None), (0, Some(feed(None, 1..=2)))] {
            let mut feeder = Feeder::default();
            feeder.push(feed(None, 1..=2));
            feeder.send(NOW);
            assert_eq!(feeder.answered(NOW, None), BatchResult::Unknown);
            assert_eq!(feeder.send(NOW + RETRY * 9), None, "not before it is settled");
            feeder.settle(Token(highest));
            assert_eq!(feeder.send(NOW), again);
        }
    }

    #[test]
    fn what_was_forgotten_while_under_way_neither_comes_back_nor_counts_as_refused() {
        let refused = FeedAnswer::Refused { faults: vec![] };
        for answer in [Some(refused), Some(FeedAnswer::NotNow("Safe".into())), None] {
            let mut feeder = Feeder::default();
            feeder.push(feed(None, 1..=2));
            feeder.send(NOW);
            feeder.clear();
            feeder.push(feed(Some(0), 3..=4));
            assert_eq!(feeder.answered(NOW, answer), BatchResult::Taken);
            assert_eq!(feeder.send(NOW).unwrap(), feed(Some(0), 3..=4));
        }
    }
}
