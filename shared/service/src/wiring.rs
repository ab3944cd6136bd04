//! What a service serves and follows, each with the input that comes of it.

use crate::{Request, Time};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::sync::Arc;
use std::time::Duration;
use usal::topics::{Events, Invocation, Variable};
use usal::{Kind, Occurrence, Presence, Received, Senders, Session, SessionError, Start};

/// Gives the next input, if one is there.
pub(crate) type Port<I> = Box<dyn FnMut() -> Option<I> + Send>;
/// Makes a port on a session.
type Open<I> = Box<dyn FnOnce(&Session, &Arc<Senders>) -> Result<Port<I>, SessionError> + Send>;

/// Something of a service that another one follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Topic {
    /// Whose.
    pub service: &'static str,
    /// A variable or a stream of events.
    pub kind: Kind,
    /// Its name.
    pub name: &'static str,
}

/// Collects a service's connections.
pub struct Wiring<I> {
    /// Names of the invocations served.
    pub(crate) served: Vec<&'static str>,
    pub(crate) follows: Vec<Topic>,
    /// Requests and events: as they come.
    pub(crate) prompt: Vec<Open<I>>,
    /// Variables and presence: at each beat.
    pub(crate) sampled: Vec<Open<I>>,
    pub(crate) started: Option<Box<dyn Fn() -> I + Send>>,
    pub(crate) ended: Option<Box<dyn Fn() -> I + Send>>,
    pub(crate) tick: Option<Box<dyn Fn() -> I + Send>>,
    pub(crate) kept: Option<Box<dyn Fn(bool) -> I + Send>>,
    pub(crate) waiting: Option<Box<dyn Fn(Duration) -> I + Send>>,
    pub(crate) stepped: Option<Box<dyn Fn(Time) -> I + Send>>,
    pub(crate) strangers: Option<Box<dyn Fn(&'static str, u64) -> I + Send>>,
}

impl<I> Default for Wiring<I> {
    fn default() -> Self {
        Self {
            served: Vec::new(),
            follows: Vec::new(),
            prompt: Vec::new(),
            sampled: Vec::new(),
            started: None,
            ended: None,
            tick: None,
            kept: None,
            waiting: None,
            stepped: None,
            strangers: None,
        }
    }
}

impl<I: 'static> Wiring<I> {
    /// Serves an invocation. The answer may come later.
    pub fn serve<Q, A>(
        &mut self,
        invocation: Invocation<Q, A>,
        input: impl Fn(Request<Q, A>) -> I + Send + 'static,
    ) where
        Q: DeserializeOwned + Send + 'static,
        A: Serialize + Send + 'static,
    {
        self.served.push(invocation.name);
        self.prompt.push(Box::new(move |session, _| {
            let mut server = session.serve(invocation)?;
            Ok(Box::new(move || server.try_recv().map(|incoming| input(incoming.into()))))
        }));
    }

    /// Listens to a stream of events: each comes once, in order, and what is lost comes as a gap. Of whom it hears:
    /// [`crate::Out::hear_only`].
    pub fn listen<E>(
        &mut self,
        events: Events<E>,
        start: Start,
        input: impl Fn(Occurrence<E>) -> I + Send + 'static,
    ) where
        E: DeserializeOwned + Send + 'static,
    {
        self.follows.push(Topic { service: events.service, kind: Kind::Event, name: events.name });
        self.prompt.push(Box::new(move |session, senders| {
            let mut subscriber = session.listen_from(events, start, senders.gate(events.service))?;
            Ok(Box::new(move || subscriber.try_recv().map(&input)))
        }));
    }

    /// Follows a variable: its latest value, at most once a beat. Of whom it hears: [`crate::Out::hear_only`].
    pub fn follow<T>(&mut self, variable: Variable<T>, input: impl Fn(Arc<Received<T>>) -> I + Send + 'static)
    where
        T: DeserializeOwned + Send + Sync + 'static,
    {
        self.follows.push(Topic { service: variable.service, kind: Kind::Variable, name: variable.name });
        self.sampled.push(Box::new(move |session, senders| {
            let mut subscriber = session.follow_from(variable, senders.gate(variable.service))?;
            Ok(Box::new(move || subscriber.take_new().map(&input)))
        }));
    }

    /// So many messages in the name of a service came from others than the one that it hears, since the last beat.
    pub fn strangers(&mut self, input: impl Fn(&'static str, u64) -> I + Send + 'static) {
        self.strangers = Some(Box::new(input));
    }

    /// A service has appeared, or appeared again.
    pub fn appeared(&mut self, service: &'static str, input: impl Fn() -> I + Send + 'static) {
        self.sampled.push(Box::new(move |session, _| {
            let presence = session.presence()?;
            let mut came = None;
            Ok(Box::new(move || appeared(&presence, service, &mut came).then(&input)))
        }));
    }

    /// Once, before anything else.
    pub fn started(&mut self, input: impl Fn() -> I + Send + 'static) {
        self.started = Some(Box::new(input));
    }

    /// Once, when it is asked to end, after everything else.
    pub fn ended(&mut self, input: impl Fn() -> I + Send + 'static) {
        self.ended = Some(Box::new(input));
    }

    /// Each beat of the clock, after the variables.
    pub fn tick(&mut self, input: impl Fn() -> I + Send + 'static) {
        self.tick = Some(Box::new(input));
    }

    /// Whether what is kept comes to the disk, when that has changed.
    pub fn kept(&mut self, input: impl Fn(bool) -> I + Send + 'static) {
        self.kept = Some(Box::new(input));
    }

    /// Of the service that leads the simulated time: so long, wall-clock, it has stood still. Each 50 ms.
    pub fn waiting(&mut self, input: impl Fn(Duration) -> I + Send + 'static) {
        self.waiting = Some(Box::new(input));
    }

    /// The simulated time led to has been reached by all: see [`crate::Out::lead_time_to`].
    pub fn stepped(&mut self, input: impl Fn(Time) -> I + Send + 'static) {
        self.stepped = Some(Box::new(input));
    }
}

/// It may have gone and come back between two looks: while simulated time stands still, nobody looks.
fn appeared(presence: &Presence, service: &str, came: &mut Option<u64>) -> bool {
    let before = std::mem::replace(came, presence.arrival(service));
    came.is_some() && *came != before
}

/// What a service follows of others.
pub fn followed<S: crate::Service>() -> Vec<Topic> {
    let mut wiring = Wiring::default();
    S::wire(&mut wiring);
    wiring.follows
}

/// A wiring on a session.
pub(crate) struct Ports<I> {
    prompt: Vec<Port<I>>,
    sampled: Vec<Port<I>>,
    /// Where to look first: nobody keeps the others from being heard.
    first: usize,
}

impl<I> Ports<I> {
    pub(crate) fn open(
        wiring: &mut Wiring<I>,
        describe: Port<I>,
        session: &Session,
        senders: &Arc<Senders>,
    ) -> Result<Self, SessionError> {
        // until it says whom it hears
        wiring.follows.iter().for_each(|topic| senders.is_known(topic.service, None));
        let open = |ports: &mut Vec<Open<I>>| -> Result<Vec<Port<I>>, SessionError> {
            std::mem::take(ports).into_iter().map(|open| open(session, senders)).collect()
        };
        // variables first: who is asked something knows what there is to be known
        let sampled = open(&mut wiring.sampled)?;
        let mut prompt = open(&mut wiring.prompt)?;
        prompt.push(describe);
        Ok(Self { prompt, sampled, first: 0 })
    }

    /// A request or an event that is there.
    pub(crate) fn prompt(&mut self) -> Option<I> {
        let count = self.prompt.len();
        for i in 0..count {
            let at = (self.first + i) % count;
            if let Some(input) = self.prompt.get_mut(at).and_then(|port| port()) {
                self.first = at + 1;
                return Some(input);
            }
        }
        None
    }

    /// What is new of the variables.
    pub(crate) fn sampled(&mut self) -> Vec<I> {
        self.sampled.iter_mut().filter_map(|port| port()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn port(inputs: impl IntoIterator<Item = char>) -> Port<char> {
        let mut inputs = inputs.into_iter().collect::<Vec<_>>().into_iter();
        Box::new(move || inputs.next())
    }

    #[test]
    fn flood_at_one_port_keeps_no_other_from_being_heard() {
        let prompt = vec![port("aaaaaa".chars()), port([]), port("bb".chars()), port("c".chars())];
        let mut ports = Ports { prompt, sampled: vec![], first: 0 };
        let heard: String = std::iter::from_fn(|| ports.prompt()).collect();
        assert_eq!(heard, "abcabaaaa");
        assert_eq!(ports.prompt(), None);
    }

    #[test]
    fn each_variable_is_looked_at_once_a_beat() {
        let mut ports = Ports {
            prompt: vec![port("x".chars())],
            sampled: vec![port("ab".chars()), port([]), port("c".chars())],
            first: 0,
        };
        assert_eq!([ports.sampled(), ports.sampled(), ports.sampled()], [vec!['a', 'c'], vec!['b'], vec![]]);
        assert_eq!(ports.prompt(), Some('x'), "requests and events are another matter");
    }
}
