//! What a service is given before it begins.

use super::{Books, Runtime};
use crate::board::Board;
use crate::clock::Clock;
use crate::folder::Folder;
use crate::statistics::Statistics;
use crate::wiring::{Port, Ports};
use crate::{Adapter, Service, Tasks, Timing, Wiring, audit, logging, versions};
use std::sync::Arc;
use std::time::Instant;
use tokio::sync::Notify;
use tokio::task::JoinSet;
use usal::{Conductor, Kind, Participant, Session, SessionError, Spec};

impl<S: Service, A: Adapter<S>> Runtime<S, A> {
    /// Opens all that the declaration and the wiring name, and then lets others know.
    ///
    /// # Errors
    /// The wiring is not what is declared, or the session is closed.
    pub fn open(
        session: &Session,
        service: S,
        adapter: A,
        timing: Timing,
        folder: Folder,
        notify: Arc<Notify>,
    ) -> anyhow::Result<Self> {
        let spec = S::SPEC;
        let mut wiring = Wiring::default();
        S::wire(&mut wiring);
        check(&spec, &wiring)?;
        let board = Board::open(&spec, timing != Timing::Machine, session)?;
        let emitted = spec.says.iter().filter(|said| said.kind == Kind::Event);
        let emitters = emitted.map(|said| Ok((said.name, session.emitter_untyped(spec.name, said.name)?)));
        let emitters = emitters.collect::<Result<_, SessionError>>()?;
        let senders = Arc::default();
        let ports = Ports::open(&mut wiring, describe(&spec, session)?, session, &senders)?;
        // who sees it can ask
        let announcement = session.announce(spec.name)?;
        // who is waited for hears all that is said at a tick
        let clock = clock(session, spec.name, timing)?;
        let books = audit::start(session, spec.name, clock.reader())?;
        let lines = logging::start(session, spec.name, clock.reader())?;
        let versions = versions::start(session, &wiring)?;
        Ok(Self {
            service,
            adapter,
            session: session.clone(),
            clock,
            notify,
            wiring,
            ports,
            senders,
            board,
            emitters,
            folder,
            tasks: Tasks::default(),
            calls: JoinSet::new(),
            statistics: Statistics::default(),
            led: Instant::now(),
            failed: None,
            ending: false,
            _books: Books([Some(books), lines, versions].into_iter().flatten().collect()),
            _announcement: announcement,
        })
    }
}

fn clock(session: &Session, name: &str, timing: Timing) -> Result<Clock, SessionError> {
    Ok(match timing {
        Timing::Machine => Clock::machine(),
        Timing::Follows => Clock::follows(Participant::join(session, name)?),
        Timing::Leads => Clock::leads(Conductor::new(session)?),
    })
}

/// Answers `describe`.
fn describe<I: 'static>(spec: &Spec, session: &Session) -> Result<Port<I>, SessionError> {
    let mut server = session.serve_description(spec.name)?;
    let description = spec.describe();
    Ok(Box::new(move || {
        while let Some(incoming) = server.try_recv() {
            incoming.answer(Ok(description.clone()));
        }
        None
    }))
}

/// What is declared is served, and nothing else.
fn check<I>(spec: &Spec, wiring: &Wiring<I>) -> anyhow::Result<()> {
    let declared = spec.says.iter().filter(|said| said.kind == Kind::Invocation).map(|said| said.name);
    let (mut declared, mut served): (Vec<_>, Vec<_>) = (declared.collect(), wiring.served.clone());
    declared.sort_unstable();
    served.sort_unstable();
    anyhow::ensure!(
        declared == served,
        "the service `{}` declares the invocations {declared:?} and serves {served:?}",
        spec.name
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Request;
    use usal::Said;
    use usal::contract::Empty;
    use usal::topics::Invocation;

    const ADD: Invocation<u32, u32> = Invocation::new("adder", "add");
    const CLEAR: Invocation<Empty, Empty> = Invocation::new("adder", "clear");
    const SPEC: Spec =
        Spec { name: "adder", about: "adds", says: &[Said::invocation(ADD), Said::invocation(CLEAR)] };

    enum Input {
        Add(#[expect(dead_code, reason = "nobody asks here")] Request<u32, u32>),
        Clear(#[expect(dead_code, reason = "nobody asks here")] Request<Empty, Empty>),
    }

    #[test]
    fn what_is_served_is_what_is_declared_in_any_order() {
        let mut wiring = Wiring::default();
        wiring.serve(CLEAR, Input::Clear);
        let error = check(&SPEC, &wiring).unwrap_err().to_string();
        assert!(error.contains(r#"["add", "clear"]"#) && error.contains(r#"["clear"]"#), "{error}");
        wiring.serve(ADD, Input::Add);
        check(&SPEC, &wiring).unwrap();
        // twice the same: one of them would hear nothing
        wiring.serve(ADD, Input::Add);
        assert!(check(&SPEC, &wiring).is_err());
    }
}
