//! The FP Manager as a service: what it serves and follows, and what each thing that happens means to the manager.

use super::Config;
use super::background_review::BackgroundReview;
use super::command_review::{Asked, CommandReview, Verdict};
use super::foreseeing::{Foreseeing, Foreseen};
use super::gateway_events::Report;
use super::journal::{Entry, Saved};
use super::manager::{Effect, Manager};
use super::proposals::{
    Asked as Proposed, Conclusion, ProposalReview, Reviewed, Situation, good_for_now, reviewed,
};
use super::publish;
use super::resuming::Resuming;
use flight_exec::{Command, Event, Refusal};
use flight_plan::{Problem, Program};
use serde::de::DeserializeOwned;
use service::{Board, Request, Service, Time, Wiring};
use std::sync::Arc;
use std::time::Duration;
use usal::contract;
use usal::contract::*;
use usal::topics::{GATEWAY, Variable, fp_manager, gateway};
use usal::{CallError, Instance, Occurrence, Spec, Start};
use wire::Convert;

/// The gateway answers at once or not at all, wall-clock.
const CALL_TIMEOUT: Duration = Duration::from_millis(1500);

/// All that can happen to it.
pub enum Input {
    /// It begins.
    Started,
    /// Time has passed.
    Tick,
    /// It ends.
    Ended,
    /// Of a gateway, and whose it is.
    Report(Option<Instance>, Report),
    /// So many reports in the name of the gateway came from others than the one that we joined.
    Strangers(u64),
    /// The gateway is there, or there again.
    GatewayAppeared,
    /// So many events of the gateway were lost.
    EventsLost(u64),
    /// A plan is put forward.
    Propose(Request<Propose, ProposalReport>),
    /// A command is given.
    Command(Request<contract::Command, Empty>),
    /// What would follow is asked for.
    Foresee(Request<Foresee, Foresight>),
    /// That is known now, and who asked for it.
    Foreseen(String, Result<Foreseen, String>),
    /// The plan's document is asked for.
    Plan(Request<Empty, PlanDocument>),
    /// The gateway's answer.
    Fed(Result<FeedAnswer, CallError>),
    /// The gateway's answer.
    Joined(Result<JoinAnswer, CallError>),
    /// The gateway's answer.
    Requested(GatewayRequest, Result<Empty, CallError>),
    /// The proposal has been reviewed.
    ProposalReviewed(Result<Reviewed, String>),
    /// The proposal's document is on the disk.
    ProposalKept,
    /// The command that was the first to wait has been reviewed.
    CommandReviewed(Result<Vec<Problem>, String>),
    /// A path that was taken at once has been reviewed.
    WayReviewed(Result<Vec<Problem>, String>),
    /// The journal has something to report.
    Journal(Event),
    /// The journal wants a new state.
    StateWanted,
}

/// What it wants of the journal.
pub enum Output {
    /// Record these.
    Turn {
        /// What.
        entries: Vec<Entry>,
        /// They have to be on the disk before anything else of the turn takes effect.
        sync: bool,
    },
    /// Keep a plan's document.
    Plan(Arc<Program>),
    /// Keep a proposal's document, and say when that is done.
    Document {
        /// The plan's hash.
        hash: Arc<str>,
        /// The document.
        xml: Vec<u8>,
    },
    /// The state as it is.
    State(Box<Saved>, Vec<Arc<Program>>),
    /// Say what there is to be said.
    PollJournal,
}

pub(super) type Out = service::Out<Input, Output>;

/// The FP Manager.
pub struct FpManager {
    config: Config,
    manager: Manager,
    /// Why the past could not be restored.
    troubles: Vec<String>,
    proposal_review: ProposalReview,
    command_review: CommandReview,
    background_review: BackgroundReview,
    foreseeing: Foreseeing,
    resuming: Resuming,
    heartbeats: u64,
}

impl Service for FpManager {
    type Input = Input;
    type Output = Output;
    const SPEC: Spec = usal::spec::FP_MANAGER;

    fn wire(wiring: &mut Wiring<Input>) {
        wiring.started(|| Input::Started);
        follow(wiring, gateway::POSITION, Report::Position);
        follow(wiring, gateway::AIR, Report::Air);
        follow(wiring, gateway::ATTITUDE, Report::Attitude);
        follow(wiring, gateway::POWER, Report::Power);
        follow(wiring, gateway::GPS, Report::Gps);
        wiring.appeared(GATEWAY, || Input::GatewayAppeared);
        follow(wiring, gateway::STATE, Report::State);
        follow(wiring, gateway::NAVIGATION, Report::Navigation);
        // old progress and old alarms are of no interest to one who comes back
        wiring.listen(gateway::EVENTS, Start::Now, |occurrence| match occurrence {
            Occurrence::Event { from, event, .. } => Input::Report(from, Report::Event(event.value)),
            Occurrence::Gap { missed } => Input::EventsLost(missed),
        });
        wiring.strangers(|_, count| Input::Strangers(count));
        wiring.serve(fp_manager::COMMAND, Input::Command);
        wiring.serve(fp_manager::PROPOSE, Input::Propose);
        wiring.serve(fp_manager::FORESEE, Input::Foresee);
        wiring.serve(fp_manager::PLAN_DOCUMENT, Input::Plan);
        wiring.tick(|| Input::Tick);
        wiring.ended(|| Input::Ended);
    }

    fn step(&mut self, now: Time, input: Input, out: &mut Out) {
        match input {
            Input::Started => self.started(now, out),
            Input::Ended | Input::StateWanted => self.save_state(out),
            Input::Propose(asked) => self.proposed(now, asked, out),
            Input::Command(request) => self.asked(now, Asked::from(request), out),
            Input::Foresee(request) => self.foreseeing.begin(&self.manager, now, request, out),
            Input::Foreseen(caller, foreseen) => self.foreseeing.end(&caller, foreseen, out),
            Input::Plan(request) => out.answer(request.reply, Ok(self.document())),
            Input::ProposalReviewed(reviewed) => {
                if let Some(conclusion) = self.proposal_review.reviewed(reviewed, out) {
                    self.concluded(now, conclusion, out);
                }
            }
            Input::ProposalKept => {
                if let Some(conclusion) = self.proposal_review.kept() {
                    self.concluded(now, conclusion, out);
                }
            }
            Input::CommandReviewed(problems) => self.command_reviewed(now, problems, out),
            Input::WayReviewed(problems) => {
                let events = self.background_review.reviewed(problems, out);
                report(events, out);
            }
            Input::Journal(event) => report([event], out),
            other => self.handle(now, other, out),
        }
    }

    fn publish(&mut self, _: Time, board: &mut Board) {
        publish::show(self.manager.executor(), &mut self.heartbeats, board);
    }
}

impl FpManager {
    /// Around a manager, be it a new one or restored.
    pub fn new(config: Config, manager: Manager, troubles: Vec<String>) -> Self {
        Self {
            config,
            manager,
            troubles,
            proposal_review: ProposalReview::default(),
            command_review: CommandReview::default(),
            background_review: BackgroundReview::default(),
            foreseeing: Foreseeing::default(),
            resuming: Resuming::default(),
            heartbeats: 0,
        }
    }

    /// The plan it was started with becomes the active one, unless one was restored.
    fn started(&mut self, now: Time, out: &mut Out) {
        let troubles = std::mem::take(&mut self.troubles).into_iter();
        report(troubles.map(|reason| Event::NotJournalled { reason }), out);
        let plan = self.config.plan.take().filter(|_| self.manager.executor().program().is_none());
        let loaded = plan.map(|xml| {
            let program = reviewed(&xml, &self.config, &self.situation(now))?;
            let report = self.propose(now, program, None, out)?;
            self.command(now, Command::Commit { hash: report.hash, entry: None }, Self::SPEC.name, None, out)
        });
        if let Some(Err(refusal)) = loaded {
            out.fail(anyhow::anyhow!("the plan: {refusal}"));
        }
    }

    /// What comes from the gateway and from the clock.
    fn handle(&mut self, now: Time, input: Input, out: &mut Out) {
        let (manager, mut effects) = (&mut self.manager, Vec::new());
        match input {
            Input::Tick => {
                manager.tick(now, &mut effects);
                self.resuming.tick(now, manager.wants_resume(), out);
                out.push(Output::PollJournal);
            }
            Input::Report(from, report) => manager.report(now, from, report, &mut effects),
            Input::Strangers(count) => manager.strangers(count, &mut effects),
            Input::GatewayAppeared => manager.gateway_appeared(now, &mut effects),
            Input::EventsLost(missed) => manager.events_lost(now, missed, &mut effects),
            Input::Fed(answer) => manager.fed(now, logged(answer, "feed"), &mut effects),
            Input::Joined(answer) => {
                manager.joined(now, logged(answer, "join"), &mut effects);
                out.hear_only(GATEWAY, manager.gateway());
            }
            Input::Requested(request, answer) => {
                let answer = answer.map(drop).map_err(|error| error.to_string());
                if request == GatewayRequest::Resume {
                    self.resuming.answered(&answer, out);
                }
                manager.requested(now, &request, answer, &mut effects);
            }
            _ => {}
        }
        perform(effects, out);
    }

    fn proposed(&mut self, now: Time, asked: Proposed, out: &mut Out) {
        let revision = self.manager.executor().status().revision;
        if asked.request.seen_revision.is_some_and(|seen| seen != revision) {
            let reason = format!("the plan is at revision {revision} by now: look at it, then propose again");
            let refusal = Refusal { code: "stale-revision".into(), reason };
            return out.answer(asked.reply, Err(refusal.convert()));
        }
        let situation = self.situation(now);
        self.proposal_review.take(asked, &self.config, situation, out);
    }

    /// What a plan put forward now is reviewed for.
    fn situation(&self, now: Time) -> Situation {
        let flight = Some(self.manager.executor()).filter(|executor| executor.is_under_way());
        Situation { conditions: self.manager.conditions(now), flight: flight.cloned() }
    }

    /// A proposal has been reviewed. The executor sees to it that the plan it was made for is still the one being flown.
    fn concluded(&mut self, now: Time, conclusion: Conclusion, out: &mut Out) {
        let Conclusion { asked, in_flight, outcome } = conclusion;
        let fit =
            outcome.and_then(|program| good_for_now(in_flight, self.manager.executor()).map(|()| program));
        let answer = fit.and_then(|program| self.propose(now, program, asked.request.seen_revision, out));
        out.answer(asked.reply, answer.convert());
    }

    fn propose(
        &mut self,
        now: Time,
        program: Arc<Program>,
        based_on: Option<u64>,
        out: &mut Out,
    ) -> Result<flight_exec::ProposalReport, Refusal> {
        let mut effects = Vec::new();
        let report = self.manager.propose(now, program, based_on, &mut effects);
        perform(effects, out);
        report
    }

    /// What leads to where nothing was reviewed is reviewed first.
    fn asked(&mut self, now: Time, asked: Asked, out: &mut Out) {
        if self.config.replay {
            let reason = "this is a replay of a telemetry log, and no aircraft is at the other end: nothing can be commanded";
            return asked.answer(Err(Refusal { code: "replay".into(), reason: reason.into() }), out);
        }
        if self.command_review.concern(&asked, &self.manager) {
            self.command_review.take(asked, out);
            return self.go_on(now, out);
        }
        self.give(now, asked, out);
    }

    fn give(&mut self, now: Time, asked: Asked, out: &mut Out) {
        let answer = self.command(now, asked.command.clone(), &asked.by, asked.id.as_deref(), out);
        if answer.is_ok() && asked.command == Command::Resume && self.manager.wants_resume() {
            return self.resuming.wait(now, asked, out);
        }
        asked.answer(answer, out);
    }

    /// The command that was the first to wait has been reviewed.
    fn command_reviewed(&mut self, now: Time, problems: Result<Vec<Problem>, String>, out: &mut Out) {
        match self.command_review.decide(problems, &self.manager) {
            Some(Verdict::Give(asked)) => self.give(now, asked, out),
            Some(Verdict::Refuse(asked, refusal)) => asked.answer(Err(refusal), out),
            Some(Verdict::Again) | None => {}
        }
        self.go_on(now, out);
    }

    /// Goes on with what waits for a review.
    fn go_on(&mut self, now: Time, out: &mut Out) {
        while let Some(asked) = self.command_review.begin(&self.manager, now, out) {
            self.give(now, asked, out);
        }
    }

    fn command(
        &mut self,
        now: Time,
        command: Command,
        by: &str,
        id: Option<&str>,
        out: &mut Out,
    ) -> Result<(), Refusal> {
        let executor = self.manager.executor();
        let before = executor.takes_its_own_way(&command).then(|| executor.clone());
        let mut effects = Vec::new();
        let answer = self.manager.command(now, command, by, id, &mut effects);
        if let (Ok(()), Some(before)) = (&answer, before) {
            let (after, conditions) = (self.manager.executor().clone(), self.manager.conditions(now));
            let review = move || flight_exec::review_turn(&before, &after, conditions);
            self.background_review.review(review, out);
        }
        perform(effects, out);
        answer
    }

    fn document(&self) -> PlanDocument {
        let executor = self.manager.executor();
        let xml = executor.program().map(|p| flight_plan::write(&p.plan)).unwrap_or_default();
        PlanDocument { info: publish::plan_info(executor), xml }
    }

    fn save_state(&mut self, out: &mut Out) {
        let (saved, plans) = self.manager.state_to_keep();
        out.push(Output::State(Box::new(saved), plans));
    }
}

/// Follows a variable of the gateway.
fn follow<T>(wiring: &mut Wiring<Input>, variable: Variable<T>, report: impl Fn(T) -> Report + Send + 'static)
where
    T: DeserializeOwned + Clone + Send + Sync + 'static,
{
    wiring.follow(variable, move |received| {
        Input::Report(received.from, report(received.stamped.value.clone()))
    });
}

fn report(events: impl IntoIterator<Item = Event>, out: &mut Out) {
    perform(events.into_iter().map(Effect::Event).collect(), out);
}

/// The effects of one turn: its records as one, then the rest.
fn perform(effects: Vec<Effect>, out: &mut Out) {
    let (mut entries, mut sync) = (Vec::new(), false);
    for effect in effects {
        match effect {
            Effect::Record(entry) => entries.push(entry),
            Effect::Keep(program) => out.push(Output::Plan(program)),
            Effect::Sync => sync = true,
            Effect::Event(event) => {
                tracing::info!(?event, "plan");
                out.emit(fp_manager::EVENTS, f64::MAX, event.convert());
            }
            Effect::Feed(feed) => out.call(gateway::FEED, feed, CALL_TIMEOUT, Input::Fed),
            Effect::Join(join) => out.call(gateway::JOIN, join, CALL_TIMEOUT, Input::Joined),
            Effect::Request(request) => {
                let asked = request.clone();
                out.call(gateway::REQUEST, request, CALL_TIMEOUT, |answer| Input::Requested(asked, answer));
            }
            Effect::Invoke { service, operation, argument } => {
                out.tell(service, operation, argument, CALL_TIMEOUT);
            }
        }
    }
    if !entries.is_empty() {
        out.push(Output::Turn { entries, sync });
    }
}

/// An answer, or nothing and a line in the log.
fn logged<A>(answer: Result<A, CallError>, what: &str) -> Option<A> {
    answer.inspect_err(|error| tracing::warn!("{what}: {error}")).ok()
}
