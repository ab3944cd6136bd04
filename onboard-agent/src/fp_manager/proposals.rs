//! A plan put forward: checked, compiled and its path reviewed on a thread of its own, its document kept on the disk,
//! while the flight goes on. In flight that is the path ahead, from where the aircraft is.

use super::service::{Input, Out, Output};
use super::{Config, listed};
use flight_exec::{Conditions, Executor, Refusal, compile_and_review, compile_and_review_ahead};
use flight_plan::{Problem, Program};
use service::Request;
use std::sync::Arc;
use usal::contract::{ProposalReport, Propose};
use wire::Convert;

/// A plan put forward.
pub type Asked = Request<Propose, ProposalReport>;

/// A plan that may be proposed, and its document as it is kept.
pub struct Fit {
    /// The plan.
    pub program: Arc<Program>,
    /// The document.
    pub xml: Vec<u8>,
}

/// What a plan is reviewed for.
pub struct Situation {
    /// Wind and time of day.
    pub conditions: Conditions,
    /// The flight that it would take over; `None`: on the ground.
    pub flight: Option<Executor>,
}

/// What was found.
pub type Reviewed = Result<Fit, Vec<Problem>>;
type Outcome = Result<Arc<Program>, Refusal>;

/// The proposal that is being reviewed, if there is one.
#[derive(Default)]
pub struct ProposalReview(Option<Proposal>);

struct Proposal {
    asked: Asked,
    in_flight: bool,
    /// It is fit, and its document is being kept.
    fit: Option<Arc<Program>>,
}

/// A proposal that has been reviewed and is kept.
pub struct Conclusion {
    /// What was asked.
    pub asked: Asked,
    /// It was reviewed for a flight under way: what lies ahead of that.
    pub in_flight: bool,
    /// The plan, if it may be proposed.
    pub outcome: Outcome,
}

impl ProposalReview {
    /// Begins to review a proposal; one that comes while another is being reviewed is refused.
    pub fn take(&mut self, asked: Asked, config: &Config, situation: Situation, out: &mut Out) {
        if self.0.is_some() {
            let reason = "another proposal is being reviewed: propose again in a moment";
            let refusal = Refusal { code: "busy".into(), reason: reason.into() };
            return out.answer(asked.reply, Err(refusal.convert()));
        }
        let (xml, config, in_flight) =
            (asked.request.xml.clone(), config.clone(), situation.flight.is_some());
        out.work(move || review(&xml, &config, &situation), Input::ProposalReviewed);
        self.0 = Some(Proposal { asked, in_flight, fit: None });
    }

    /// It has been reviewed: its document is kept, unless it is refused.
    pub fn reviewed(&mut self, reviewed: Result<Reviewed, String>, out: &mut Out) -> Option<Conclusion> {
        match outcome(reviewed.unwrap_or_else(|error| Err(vec![broken(&error)]))) {
            Ok(Fit { program, xml }) => {
                out.push(Output::Document { hash: program.hash().clone(), xml });
                self.0.as_mut()?.fit = Some(program);
                None
            }
            Err(refusal) => self.conclude(Err(refusal)),
        }
    }

    /// Its document has been kept.
    pub fn kept(&mut self) -> Option<Conclusion> {
        let program = self.0.as_mut()?.fit.take()?;
        self.conclude(Ok(program))
    }

    fn conclude(&mut self, outcome: Outcome) -> Option<Conclusion> {
        let Proposal { asked, in_flight, .. } = self.0.take()?;
        Some(Conclusion { asked, in_flight, outcome })
    }
}

/// What was reviewed for a flight under way is good for that one: once it is over, nobody has reviewed all of the plan.
///
/// # Errors
/// The flight is over.
pub fn good_for_now(in_flight: bool, executor: &Executor) -> Result<(), Refusal> {
    if in_flight && !executor.is_under_way() {
        let reason = "the flight that this plan was reviewed for is over: propose it again";
        return Err(Refusal { code: "flight-over".into(), reason: reason.into() });
    }
    Ok(())
}

/// Reviews a document, here and now.
///
/// # Errors
/// Its problems.
pub fn reviewed(xml: &str, config: &Config, situation: &Situation) -> Outcome {
    outcome(review(xml, config, situation)).map(|fit| fit.program)
}

fn review(xml: &str, config: &Config, situation: &Situation) -> Reviewed {
    let program = match &situation.flight {
        Some(flight) => compile_and_review_ahead(xml.as_bytes(), flight, situation.conditions)?,
        None => compile_and_review(xml.as_bytes(), &config.profile, &config.terrain, situation.conditions)?,
    };
    // neither is for the flight to wait for: the hash is worked out when it is first asked for
    program.hash();
    let xml = flight_plan::write(&program.plan).into_bytes();
    Ok(Fit { program, xml })
}

fn outcome(reviewed: Reviewed) -> Result<Fit, Refusal> {
    reviewed.map_err(|problems| Refusal { code: "plan-errors".into(), reason: listed(&problems) })
}

/// A review that broke off.
pub(super) fn broken(error: &str) -> Problem {
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
            engine_out: false,
            heading_deg: None,
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

    /// A landing ends the flight while the plan is reviewed, or while its document is kept.
    #[test]
    fn a_plan_reviewed_for_a_flight_that_is_over_is_not_put_forward() {
        let mut executor = flying();
        let refused = |in_flight, executor: &Executor| good_for_now(in_flight, executor).is_err();
        assert!(!refused(true, &executor) && !refused(false, &executor));
        executor.step(Time::ZERO, Input::Landed, &mut Vec::new());
        assert!(refused(true, &executor) && !refused(false, &executor));
    }
}
