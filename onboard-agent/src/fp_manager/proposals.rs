//! A plan put forward: checked, compiled and its path reviewed on a thread of its own, its document kept on the disk,
//! while the flight goes on. In flight that is the path ahead, from where the aircraft is.

use super::journal::JournalHandle;
use super::{Config, listed};
use flight_exec::{Conditions, Executor, Refusal, compile_and_review, compile_and_review_ahead};
use flight_plan::{Problem, Program};
use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;
use tokio::task::JoinHandle;
use tokio::time::Instant;
use usal::Incoming;
use usal::contract::{ProposalReport, Propose};
use wire::Convert;

/// In lockstep time stands for so long (wall-clock) while something is looked at; the others wait for five seconds at most.
pub(super) const LOCKSTEP_PATIENCE: Duration = Duration::from_secs(4);

type Asked = Incoming<Propose, ProposalReport>;

/// A plan that may be proposed, and its document as it is kept.
pub struct Fit {
    /// The plan.
    pub program: Arc<Program>,
    /// The document.
    pub xml: Vec<u8>,
}

/// What a plan is looked at for.
pub struct Sight {
    /// Wind and time of day.
    pub conditions: Conditions,
    /// The flight that it would take over; `None`: on the ground.
    pub flight: Option<Executor>,
}

type Looked = Result<Fit, Vec<Problem>>;
type Outcome = Result<Arc<Program>, Refusal>;

/// The proposal that is being reviewed, if there is one.
#[derive(Default)]
pub struct ProposalReview(Option<Proposal>);

struct Proposal {
    asked: Asked,
    since: Instant,
    /// It was looked at for a flight under way: what lies ahead of that.
    in_flight: bool,
    step: Step,
}

enum Step {
    /// It is being looked at.
    Looking(JoinHandle<Looked>),
    /// Its document is being kept.
    Keeping(Arc<Program>, Pin<Box<dyn Future<Output = ()> + Send>>),
    Done(Outcome),
}

impl ProposalReview {
    /// Begins to look at a proposal; one that comes while another is being reviewed is refused.
    pub fn take(&mut self, asked: Asked, config: &Config, sight: Sight) {
        if self.0.is_some() {
            let reason = "another proposal is being looked at: propose again in a moment";
            let refusal = Refusal { code: "busy".into(), reason: reason.into() };
            return asked.answer(Err(refusal.convert()));
        }
        let (xml, config, in_flight) = (asked.request.xml.clone(), config.clone(), sight.flight.is_some());
        let work = tokio::task::spawn_blocking(move || look(&xml, &config, &sight));
        self.0 = Some(Proposal { asked, since: Instant::now(), in_flight, step: Step::Looking(work) });
    }

    /// A proposal that has been looked at and is kept, and whether that was done for a flight under way; never, if there is none. May be
    /// cancelled.
    pub async fn next(&mut self, journal: &mut Option<JournalHandle>) -> (Asked, bool, Outcome) {
        loop {
            match self.0.take_if(|proposal| matches!(proposal.step, Step::Done(_))) {
                Some(Proposal { asked, in_flight, step: Step::Done(outcome), .. }) => {
                    return (asked, in_flight, outcome);
                }
                _ => self.advance(journal).await,
            }
        }
    }

    async fn advance(&mut self, journal: &mut Option<JournalHandle>) {
        let Some(proposal) = &mut self.0 else { return std::future::pending().await };
        proposal.step = match &mut proposal.step {
            Step::Looking(work) => match outcome(work.await.unwrap_or_else(|e| Err(vec![broken(&e)]))) {
                Ok(fit) => kept(fit, journal),
                Err(refusal) => Step::Done(Err(refusal)),
            },
            Step::Keeping(program, keeping) => {
                keeping.await;
                Step::Done(Ok(program.clone()))
            }
            Step::Done(_) => return,
        };
    }

    /// In lockstep, time stands while a proposal is looked at, but not so long that the others go on without us.
    pub fn holds_time_until(&self) -> Option<Instant> {
        self.0.as_ref().map(|proposal| proposal.since + LOCKSTEP_PATIENCE)
    }
}

/// What was looked at for a flight under way is good for that one: once it is over, nobody has looked at all of the plan.
///
/// # Errors
/// The flight is over.
pub fn good_for_now(in_flight: bool, executor: &Executor) -> Result<(), Refusal> {
    if in_flight && !executor.is_under_way() {
        let reason = "the flight that this plan was looked at for is over: propose it again";
        return Err(Refusal { code: "flight-over".into(), reason: reason.into() });
    }
    Ok(())
}

fn kept(fit: Fit, journal: &mut Option<JournalHandle>) -> Step {
    let Fit { program, xml } = fit;
    match journal {
        Some(journal) => {
            let keeping = journal.keep(program.hash().clone(), xml);
            Step::Keeping(program, Box::pin(keeping))
        }
        None => Step::Done(Ok(program)),
    }
}

/// CommandReview at a document, here and now.
///
/// # Errors
/// Its problems.
pub fn looked_at(xml: &str, config: &Config, sight: &Sight) -> Outcome {
    outcome(look(xml, config, sight)).map(|fit| fit.program)
}

fn look(xml: &str, config: &Config, sight: &Sight) -> Looked {
    let program = match &sight.flight {
        Some(flight) => compile_and_review_ahead(xml.as_bytes(), flight, sight.conditions)?,
        None => compile_and_review(xml.as_bytes(), &config.profile, &config.terrain, sight.conditions)?,
    };
    // neither is for the flight to wait for: the hash is worked out when it is first asked for
    program.hash();
    let xml = flight_plan::write(&program.plan).into_bytes();
    Ok(Fit { program, xml })
}

fn outcome(looked: Looked) -> Result<Fit, Refusal> {
    looked.map_err(|problems| Refusal { code: "plan-errors".into(), reason: listed(&problems) })
}

pub(super) fn broken(error: &tokio::task::JoinError) -> Problem {
    Problem::error("not-reviewed", format!("the review of the path failed; please report it: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use aircraft::Profile;
    use flight_exec::{AircraftState, Command, Input, RequestId, Time};
    use terrain::Flat;

    const PLAN: &[u8] = include_bytes!("../../../assets/plans/square.xml");

    fn flying() -> Executor {
        let (profile, ground) = (Profile::default(), Arc::new(Flat(300.0)));
        let program = flight_plan::compile(flight_plan::read(PLAN).plan, &profile, ground.as_ref()).unwrap();
        let (hash, home) = (program.hash().clone(), program.plan.home().unwrap().threshold);
        let mut executor = Executor::new(flight_exec::Config::default(), ground, profile);
        let command = |command| Input::Command { request: RequestId(2), by: "test".into(), command };
        let aircraft = AircraftState {
            position: home,
            altitude_amsl_m: 300.0,
            track_deg: 0.0,
            ground_speed_mps: 0.0,
            airspeed_mps: 0.0,
            wind_east_mps: 0.0,
            wind_north_mps: 0.0,
            battery: 1.0,
            fuel: None,
            on_ground: true,
        };
        let program = Arc::new(program);
        for input in [
            Input::Propose { request: RequestId(1), program, based_on: None, objections: Vec::new() },
            command(Command::Commit { hash, entry: None }),
            command(Command::Start),
            Input::Aircraft(aircraft),
        ] {
            executor.step(Time::ZERO, input, &mut Vec::new());
        }
        executor
    }

    /// A landing ends the flight while the plan is looked at, or while its document is kept.
    #[test]
    fn a_plan_looked_at_for_a_flight_that_is_over_is_not_put_forward() {
        let mut executor = flying();
        let refused = |in_flight, executor: &Executor| good_for_now(in_flight, executor).is_err();
        assert!(!refused(true, &executor) && !refused(false, &executor));
        executor.step(Time::ZERO, Input::Landed, &mut Vec::new());
        assert!(refused(true, &executor) && !refused(false, &executor));
    }
}
