//! A plan put forward: checked, compiled and its path reviewed on a thread of its own, while the flight goes on.

use super::{Config, listed};
use aircraft::Wind;
use flight_exec::{Conditions, compile_and_review};
use flight_plan::{Problem, Program};
use std::sync::Arc;
use tokio::task::JoinHandle;
use usal::Incoming;
use usal::contract::{ProposalReport, Propose, Refusal};

type Looked = Result<Arc<Program>, Vec<Problem>>;

/// The proposal that is being looked at, if there is one.
#[derive(Default)]
pub struct Desk(Option<(Incoming<Propose, ProposalReport>, JoinHandle<Looked>)>);

impl Desk {
    /// Begins to look at a proposal in a wind; one that comes while another is on the desk is refused.
    pub fn take(&mut self, incoming: Incoming<Propose, ProposalReport>, config: &Config, wind: Wind) {
        if self.0.is_some() {
            let reason = "another proposal is being looked at: propose again in a moment";
            return incoming.answer(Err(Refusal { code: "busy".into(), reason: reason.into() }));
        }
        let (xml, config) = (incoming.request.xml.clone(), config.clone());
        let work = tokio::task::spawn_blocking(move || look(&xml, &config, wind));
        self.0 = Some((incoming, work));
    }

    /// A proposal that has been looked at; never, if there is none. May be cancelled.
    pub async fn next(&mut self) -> (Incoming<Propose, ProposalReport>, Result<Arc<Program>, Refusal>) {
        let looked = match &mut self.0 {
            Some((_, work)) => work.await,
            None => std::future::pending().await,
        };
        match self.0.take() {
            Some((incoming, _)) => (incoming, outcome(looked.unwrap_or_else(|e| Err(vec![broken(&e)])))),
            // it was there a line ago
            None => std::future::pending().await,
        }
    }
}

/// Looks at a document, here and now.
///
/// # Errors
/// Its problems.
pub fn looked_at(xml: &str, config: &Config, wind: Wind) -> Result<Arc<Program>, Refusal> {
    outcome(look(xml, config, wind))
}

fn look(xml: &str, config: &Config, wind: Wind) -> Looked {
    // when the flight begins is not known: zones with periods count as active
    let conditions = Conditions { wind, ..Conditions::default() };
    compile_and_review(xml.as_bytes(), &config.profile, &config.terrain, conditions)
}

fn outcome(looked: Looked) -> Result<Arc<Program>, Refusal> {
    looked.map_err(|problems| Refusal { code: "plan-errors".into(), reason: listed(&problems) })
}

fn broken(error: &tokio::task::JoinError) -> Problem {
    Problem::error("not-reviewed", format!("the review of this plan failed; please report it: {error}"))
}
