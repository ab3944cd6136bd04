//! Which session speaks as which service of the vehicle. What others say in its name doesn't count, and is counted. It keeps
//! mistakes apart and proves nothing: whoever means harm can take another's name.
//!
//! For a window it is the session that answers when the service is asked to describe itself, or of which another service says so; a
//! service knows better whom it has joined, or who has joined it. A service that is gone may come back as another session, so nobody waits for its description:
//! until then whoever names himself counts. A plain put names nobody.

use crate::{Gate, Instance};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Whoever speaks for a service that was silent for so long may have followed it.
const SILENT: Duration = Duration::from_secs(2);

/// The services of a vehicle, by name.
#[derive(Debug, Default)]
pub struct Senders(Mutex<BTreeMap<&'static str, Sender>>);

/// Who speaks as a service.
#[derive(Debug, Default)]
struct Sender {
    known: Known,
    /// When it was heard last.
    heard: Option<Instant>,
    /// Messages of others since they were asked for.
    strange: u64,
    /// There were some since it was described or in doubt.
    is_contested: bool,
    /// Who was it when the service went away; nobody else's word brings him back.
    left: Option<Instance>,
}

#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
enum Known {
    /// It was not described yet, or is gone.
    #[default]
    Nobody,
    Session(Instance),
    /// An older service doesn't say which session it is, or nobody has been chosen yet.
    Anybody,
}

impl Sender {
    fn counts(&mut self, from: Option<Instance>, now: Instant) -> bool {
        let counts = match self.known {
            Known::Nobody => from.is_some(),
            Known::Session(known) => from == Some(known),
            Known::Anybody => true,
        };
        if counts {
            self.heard = Some(now);
            self.left = self.left.filter(|left| from != Some(*left));
        } else {
            self.strange = self.strange.saturating_add(1);
            self.is_contested = true;
        }
        counts
    }

    fn is_silent(&self, now: Instant) -> bool {
        self.heard.is_none_or(|heard| now.saturating_duration_since(heard) >= SILENT)
    }

    /// A session answered for it. While another one speaks that did so before, it is a stranger's answer.
    fn described(&mut self, by: Option<Instance>, now: Instant) {
        if matches!(self.known, Known::Session(_)) && !self.is_silent(now) {
            return;
        }
        self.known = by.map_or(Known::Anybody, Known::Session);
        self.is_contested = false;
    }

    fn know(&mut self, known: Known) {
        if self.known != known {
            (self.known, self.heard, self.is_contested) = (known, None, false);
        }
    }

    fn gone(&mut self) {
        if let Known::Session(session) = self.known {
            self.left = Some(session);
        }
        (self.known, self.heard) = (Known::Nobody, None);
    }
}

impl Senders {
    /// Lets in what comes from the session that is this service.
    pub fn gate(self: &Arc<Self>, service: &'static str) -> Gate {
        let senders = self.clone();
        Arc::new(move |from| senders.counts(service, from, Instant::now()))
    }

    /// It is known without a description who speaks as a service: this session and no other; `None`: whoever does.
    pub fn is_known(&self, service: &'static str, session: Option<Instance>) {
        let known = session.map_or(Known::Anybody, Known::Session);
        self.lock().entry(service).or_default().know(known);
    }

    /// Another service says which session is this one; `None`: it does not know, and whoever names himself counts. One that has gone is
    /// not it any more.
    pub fn is_said(&self, service: &'static str, session: Option<Instance>) {
        let mut senders = self.lock();
        let sender = senders.entry(service).or_default();
        let session = session.filter(|session| sender.left != Some(*session));
        sender.know(session.map_or(Known::Nobody, Known::Session));
    }

    /// Whether a message in the name of a service counts.
    pub fn counts(&self, service: &'static str, from: Option<Instance>, now: Instant) -> bool {
        self.lock().entry(service).or_default().counts(from, now)
    }

    /// A service was described, by a session that says which it is or doesn't.
    pub fn described(&self, service: &'static str, by: Option<Instance>, now: Instant) {
        self.lock().entry(service).or_default().described(by, now);
    }

    /// These are there; who comes back may be another session.
    pub fn alive(&self, services: &BTreeSet<String>) {
        let mut senders = self.lock();
        let gone = senders.iter_mut().filter(|(service, _)| !services.contains(**service));
        gone.for_each(|(_, sender)| sender.gone());
    }

    /// Whether somebody speaks for a service that is silent itself: it should be asked again who it is. Said once, until somebody
    /// does so again.
    pub fn take_doubt(&self, now: Instant) -> bool {
        let mut is_doubtful = false;
        for sender in self.lock().values_mut().filter(|sender| sender.is_contested && sender.is_silent(now)) {
            (sender.is_contested, is_doubtful) = (false, true);
        }
        is_doubtful
    }

    /// How many messages of others came since this was asked last, by service.
    pub fn take_strange(&self) -> Vec<(&'static str, u64)> {
        let mut senders = self.lock();
        let counted =
            senders.iter_mut().map(|(service, sender)| (*service, std::mem::take(&mut sender.strange)));
        counted.filter(|(_, count)| *count > 0).collect()
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<&'static str, Sender>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVICE: &str = "gateway";

    fn instance(text: &str) -> Option<Instance> {
        Some(text.parse().unwrap())
    }

    fn there(services: &[&str]) -> BTreeSet<String> {
        services.iter().map(|&service| service.to_owned()).collect()
    }

    #[test]
    fn only_the_session_that_described_itself_counts() {
        let (senders, now) = (Senders::default(), Instant::now());
        assert!(senders.counts(SERVICE, instance("a1"), now), "nobody waits for its description");
        assert!(!senders.counts(SERVICE, None, now), "a plain put names nobody");
        senders.described(SERVICE, instance("a1"), now);
        assert!(senders.counts(SERVICE, instance("a1"), now));
        assert!(!senders.counts(SERVICE, instance("b2"), now) && !senders.counts(SERVICE, None, now));
        assert!(senders.counts("storage", instance("b2"), now), "each service for itself");
        assert_eq!(senders.take_strange(), [(SERVICE, 3)]);
        assert_eq!(senders.take_strange(), []);
    }

    #[test]
    fn one_that_comes_back_counts_at_once() {
        let (senders, now) = (Senders::default(), Instant::now());
        senders.described(SERVICE, instance("a1"), now);
        assert!(senders.counts(SERVICE, instance("a1"), now));
        senders.alive(&there(&["storage"]));
        assert!(senders.counts(SERVICE, instance("b2"), now), "not described yet");
        senders.alive(&there(&["storage", SERVICE]));
        senders.described(SERVICE, instance("b2"), now);
        assert!(
            senders.counts(SERVICE, instance("b2"), now) && !senders.counts(SERVICE, instance("a1"), now)
        );
    }

    #[test]
    fn a_strangers_description_does_not_count_beside_one_that_speaks() {
        let (senders, now) = (Senders::default(), Instant::now());
        senders.described(SERVICE, instance("a1"), now);
        assert!(senders.counts(SERVICE, instance("a1"), now));
        assert!(!senders.counts(SERVICE, instance("b2"), now) && !senders.take_doubt(now));
        senders.described(SERVICE, instance("b2"), now);
        assert!(!senders.counts(SERVICE, instance("b2"), now));
        let later = now + SILENT;
        assert!(senders.take_doubt(later), "it was silent, and somebody speaks in its name");
        senders.described(SERVICE, instance("b2"), later);
        assert!(senders.counts(SERVICE, instance("b2"), later) && !senders.take_doubt(later + SILENT));
    }

    #[test]
    fn who_is_known_without_a_description_counts_alone() {
        let (senders, now) = (Arc::new(Senders::default()), Instant::now());
        let gate = senders.gate(SERVICE);
        senders.is_known(SERVICE, None);
        assert!(gate(None) && gate(instance("a1")) && gate(instance("b2")), "nobody was chosen yet");
        senders.is_known(SERVICE, instance("a1"));
        assert!(gate(instance("a1")) && !gate(instance("b2")) && !gate(None));
        assert_eq!(senders.take_strange(), [(SERVICE, 2)]);
        senders.is_known(SERVICE, instance("b2"));
        assert!(!gate(instance("a1")) && gate(instance("b2")));
        assert_eq!(senders.counts(SERVICE, None, now), gate(None));
    }

    /// Those that were counted since the last beat were lost with each join that was answered.
    #[test]
    fn strangers_are_not_forgotten_when_it_is_said_anew_who_counts() {
        let (senders, now) = (Senders::default(), Instant::now());
        senders.is_known(SERVICE, instance("a1"));
        assert!(!senders.counts(SERVICE, instance("b2"), now));
        for session in ["a1", "b2"] {
            senders.is_known(SERVICE, instance(session));
        }
        assert_eq!(senders.take_strange(), [(SERVICE, 1)]);
    }

    #[test]
    fn of_two_the_one_that_another_service_names_counts_and_both_until_then() {
        let (senders, now) = (Senders::default(), Instant::now());
        let count = |from: &[Option<Instance>]| -> Vec<bool> {
            from.iter().map(|from| senders.counts(SERVICE, *from, now)).collect()
        };
        let all = [instance("a1"), instance("b2"), None];
        senders.is_said(SERVICE, None);
        assert_eq!(count(&all), [true, true, false], "nobody without a name");
        senders.is_said(SERVICE, instance("a1"));
        assert_eq!(count(&all), [true, false, false]);
        senders.alive(&there(&[]));
        senders.is_said(SERVICE, instance("a1"));
        assert!(count(&all[1..2])[0], "its successor, before the other service knows");
        senders.is_said(SERVICE, instance("b2"));
        assert_eq!(count(&all), [false, true, false]);
    }

    #[test]
    fn an_older_service_does_not_say_who_it_is() {
        let (senders, now) = (Senders::default(), Instant::now());
        senders.described(SERVICE, None, now);
        assert!(senders.counts(SERVICE, None, now) && senders.counts(SERVICE, instance("a1"), now));
    }
}
