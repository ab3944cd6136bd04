//! What a step leads to.

use crate::tasks::on_thread;
use crate::{Never, Reply, Time};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::any::Any;
use std::future::Future;
use std::pin::Pin;
use std::time::Duration;
use usal::contract::{Refusal, Stamped};
use usal::topics::{Events, Invocation};
use usal::{CallError, EventPublisher, Instance, Session, Untyped};

/// Something that ends in an input.
pub(crate) type Work<I> = Pin<Box<dyn Future<Output = I> + Send>>;
/// A question to another service, to be asked on a session.
pub(crate) type Question<I> = Box<dyn FnOnce(&Session) -> Work<I> + Send>;

/// An event of one of the service's streams.
pub(crate) struct Emission {
    pub(crate) name: &'static str,
    event: Box<dyn Any + Send>,
    emit: fn(&EventPublisher<Untyped>, &dyn Any),
}

impl Emission {
    pub(crate) fn by(&self, publisher: &EventPublisher<Untyped>) {
        (self.emit)(publisher, &*self.event);
    }
}

fn emit<E: Serialize + 'static>(publisher: &EventPublisher<Untyped>, event: &dyn Any) {
    if let Some(event) = event.downcast_ref::<E>() {
        publisher.emit_any(event);
    }
}

/// A file to be kept.
pub(crate) struct Kept {
    pub(crate) name: &'static str,
    pub(crate) bytes: Vec<u8>,
}

/// Collects what has to be done about an input. It is done in this order: the adapter's part; events; questions and
/// work; files; answers.
pub struct Out<I, O = Never> {
    now: Time,
    pub(crate) own: Vec<O>,
    pub(crate) events: Vec<Emission>,
    pub(crate) questions: Vec<Question<I>>,
    pub(crate) unasked: Vec<Question<()>>,
    pub(crate) work: Vec<Work<I>>,
    pub(crate) kept: Vec<Kept>,
    pub(crate) answers: Vec<Box<dyn FnOnce() + Send>>,
    pub(crate) wait_for_disk: bool,
    pub(crate) leads_to: Option<Time>,
    pub(crate) hears: Vec<(&'static str, Option<Instance>)>,
    pub(crate) failed: Option<anyhow::Error>,
}

impl<I: Send + 'static, O> Out<I, O> {
    /// Nothing yet.
    pub fn new(now: Time) -> Self {
        Self {
            now,
            own: Vec::new(),
            events: Vec::new(),
            questions: Vec::new(),
            unasked: Vec::new(),
            work: Vec::new(),
            kept: Vec::new(),
            answers: Vec::new(),
            wait_for_disk: false,
            leads_to: None,
            hears: Vec::new(),
            failed: None,
        }
    }

    /// The time of the step.
    pub fn now(&self) -> Time {
        self.now
    }

    /// The adapter should do this.
    pub fn push(&mut self, output: O) {
        self.own.push(output);
    }

    /// Publishes an event, with the time of now.
    pub fn emit<E: Serialize + Send + 'static>(
        &mut self,
        events: Events<Stamped<E>>,
        validity_s: f64,
        event: E,
    ) {
        let event = Stamped { time_s: self.now.as_secs_f64(), validity_s, value: event };
        self.events.push(Emission { name: events.name, event: Box::new(event), emit: emit::<Stamped<E>> });
    }

    /// The events of a stream so far: for tests.
    pub fn emitted<E: Clone + 'static>(&self, events: Events<Stamped<E>>) -> Vec<E> {
        let of = self.events.iter().filter(|emission| emission.name == events.name);
        of.filter_map(|e| e.event.downcast_ref::<Stamped<E>>()).map(|s| s.value.clone()).collect()
    }

    /// From now on, of what is followed or listened to of a service, only what comes from this session counts: it can't be
    /// hidden by what others say in its name. `None`: whatever comes.
    pub fn hear_only(&mut self, service: &'static str, session: Option<Instance>) {
        self.hears.push((service, session));
    }

    /// Answers a request.
    pub fn answer<A: Send + 'static>(&mut self, reply: Reply<A>, answer: Result<A, Refusal>) {
        self.answers.push(Box::new(move || reply.send(answer)));
    }

    /// Answers a request once what is to be kept is on the disk; a disk that is slow or fails is not waited for.
    pub fn answer_when_kept<A: Send + 'static>(&mut self, reply: Reply<A>, answer: Result<A, Refusal>) {
        self.wait_for_disk = true;
        self.answer(reply, answer);
    }

    /// Asks a service; the answer comes as an input. In lockstep, time stands until it is there.
    pub fn call<Q, A>(
        &mut self,
        invocation: Invocation<Q, A>,
        request: Q,
        timeout: Duration,
        done: impl FnOnce(Result<A, CallError>) -> I + Send + 'static,
    ) where
        Q: Serialize + Send + 'static,
        A: DeserializeOwned + Send + 'static,
    {
        self.questions.push(Box::new(move |session| {
            let call = session.call(invocation, &request, timeout);
            Box::pin(async move { done(call.await) })
        }));
    }

    /// Asks a service that is only known by name; what comes of it stands in the log.
    pub fn tell(
        &mut self,
        service: String,
        name: String,
        argument: impl Serialize + Send + 'static,
        timeout: Duration,
    ) {
        self.unasked.push(Box::new(move |session| {
            let call = session.call_named::<_, serde_json::Value>(&service, &name, &argument, timeout);
            Box::pin(async move {
                if let Err(error) = call.await {
                    tracing::warn!("the call of {service}/{name}: {error}");
                }
            })
        }));
    }

    /// Has work done on a thread of its own; what comes of it, or why it broke off, comes as an input. In lockstep, time
    /// stands meanwhile, for four seconds at most.
    pub fn work<T: Send + 'static>(
        &mut self,
        work: impl FnOnce() -> T + Send + 'static,
        done: impl FnOnce(Result<T, String>) -> I + Send + 'static,
    ) {
        self.work.push(Box::pin(async move { done(on_thread(work).await) }));
    }

    /// Keeps a file in the service's folder, whole or not at all; the latest wins.
    pub fn keep(&mut self, name: &'static str, bytes: Vec<u8>) {
        self.kept.push(Kept { name, bytes });
    }

    /// Of the service that leads the simulated time: let it be so late now. Everything that is due is done, here and by
    /// everybody who takes part; then the input wired to [`crate::Wiring::stepped`] follows.
    pub fn lead_time_to(&mut self, time: Time) {
        self.leads_to = Some(time);
    }

    /// The service can't go on, and ends.
    pub fn fail(&mut self, error: anyhow::Error) {
        self.failed.get_or_insert(error);
    }

    /// Something leaves the process.
    pub(crate) fn leaves(&self) -> bool {
        !(self.events.is_empty() && self.questions.is_empty() && self.unasked.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Request;
    use usal::contract::Empty;

    const TOLD: Events<Stamped<u32>> = Events::new("a", "told");
    const ASK: Invocation<Empty, Empty> = Invocation::new("b", "ask");
    const NOW: Time = Time::from_millis(2500);

    fn leaves(step: impl FnOnce(&mut Out<(), ()>)) -> bool {
        let mut out = Out::new(NOW);
        step(&mut out);
        out.leaves()
    }

    #[test]
    fn adapter_is_told_whether_something_waits_for_it_to_be_done() {
        assert!(leaves(|out| out.emit(TOLD, 1.0, 7)));
        assert!(leaves(|out| out.call(ASK, Empty {}, Duration::from_secs(1), drop)));
        assert!(leaves(|out| out.tell("b".into(), "ask".into(), Empty {}, Duration::from_secs(1))));
        assert!(!leaves(|out| out.push(())));
        assert!(!leaves(|out| out.keep("file", vec![])));
        assert!(!leaves(|out| out.work(|| (), drop)));
    }

    #[test]
    fn events_carry_the_time_of_the_step_and_come_in_order() {
        let mut out = Out::<(), ()>::new(NOW);
        out.emit(TOLD, 1.0, 7);
        out.emit(Events::<Stamped<u32>>::new("a", "other"), 1.0, 8);
        out.emit(TOLD, 1.0, 9);
        assert_eq!(out.emitted(TOLD), [7, 9]);
        let first = out.events[0].event.downcast_ref::<Stamped<u32>>();
        assert_eq!(first, Some(&Stamped { time_s: 2.5, validity_s: 1.0, value: 7 }));
    }

    #[test]
    fn first_failure_counts_and_only_some_answers_wait_for_the_disk() {
        let mut out = Out::<(), ()>::new(NOW);
        let ((first, _), (second, mut answered)) = (Request::new((), "me"), Request::new((), "me"));
        out.answer(first.reply, Ok(()));
        assert!(!out.wait_for_disk);
        out.answer_when_kept(second.reply, Ok(5));
        assert!(out.wait_for_disk);
        assert!(answered.try_recv().is_err(), "nothing is done before the step is over");
        out.answers.drain(..).for_each(|answer| answer());
        assert_eq!(answered.try_recv(), Ok(Ok(5)));
        out.fail(anyhow::anyhow!("first"));
        out.fail(anyhow::anyhow!("second"));
        assert_eq!(out.failed.map(|error| error.to_string()).as_deref(), Some("first"));
    }
}
