//! What the FP Manager publishes: a few times a second, and at once when it matters.

use crate::clock::Time;
use flight_exec::{Event, Executor};
use std::time::Duration;
use usal::contract::*;
use usal::topics::FP_MANAGER;
use usal::topics::fp_manager as topic;
use usal::{EventPublisher, FileOffer, Session, SessionError, VariablePublisher};
use wire::Convert;

/// Pace of the status and of the sign of life.
const OFTEN: Duration = Duration::from_millis(200);
/// What has not changed is said again so often.
const SELDOM: Duration = Duration::from_secs(1);
/// Published values may be believed for so long, seconds.
const VALID_S: f64 = 3.0;

/// The FP Manager's publishers.
pub struct Publishers {
    status: VariablePublisher<PlanStatus>,
    ahead: VariablePublisher<Ahead>,
    variables: VariablePublisher<PlanVariables>,
    plan: VariablePublisher<PlanInfo>,
    heartbeat: VariablePublisher<Heartbeat>,
    events: EventPublisher<FpManagerEvent>,
    plan_file: FileOffer,
    /// Hash of the plan in the file.
    plan_filed: Option<String>,
    beats: u64,
    often_due: Time,
    seldom_due: Time,
    /// First and last token and number of the waypoints last published.
    ahead_told: Option<(flight_exec::Token, flight_exec::Token, usize)>,
    variables_told: PlanVariables,
    plan_told: PlanInfo,
}

impl Publishers {
    /// On a session.
    ///
    /// # Errors
    /// The session is closed.
    pub fn new(session: &Session) -> Result<Self, SessionError> {
        Ok(Self {
            status: session.publish(topic::STATUS)?,
            ahead: session.publish(topic::AHEAD)?,
            variables: session.publish(topic::VARIABLES)?,
            plan: session.publish(topic::PLAN)?,
            heartbeat: session.publish(topic::HEARTBEAT)?,
            events: session.emitter(topic::EVENTS)?,
            plan_file: session.offer(FP_MANAGER, topic::PLAN_FILE)?,
            plan_filed: None,
            beats: 0,
            often_due: Time::ZERO,
            seldom_due: Time::ZERO,
            ahead_told: None,
            variables_told: PlanVariables::default(),
            plan_told: PlanInfo::default(),
        })
    }

    /// An event.
    pub fn event(&self, now: Time, event: Event) {
        tracing::info!(?event, "plan");
        let event = Stamped { time_s: now.as_secs_f64(), validity_s: f64::MAX, value: event.convert() };
        self.events.emit(&event);
    }

    /// Whatever is due.
    pub fn due(&mut self, now: Time, executor: &Executor) {
        if now < self.often_due {
            return;
        }
        self.often_due = now + OFTEN;
        let all = now >= self.seldom_due;
        if all {
            self.seldom_due = now + SELDOM;
        }
        // before the status: who learns of a plan from it can fetch it
        self.file(now, executor);
        self.signs_of_life(now, executor);
        self.way_ahead(now, executor, all);
        self.plan_and_variables(now, executor, all);
    }

    /// The next call of [`Self::due`] publishes at once.
    pub fn hurry(&mut self) {
        self.often_due = Time::ZERO;
    }

    /// Offers the active plan as a file, whenever it is another one.
    fn file(&mut self, now: Time, executor: &Executor) {
        let Some(program) = executor.program() else { return };
        if self.plan_filed.as_deref() == Some(&**program.hash()) {
            return;
        }
        self.plan_filed = Some(program.hash().to_string());
        let xml = flight_plan::write(&program.plan);
        if let Err(error) = self.plan_file.set(now.as_secs_f64(), xml.into()) {
            tracing::warn!("the plan cannot be fetched as a file: {error}");
        }
    }

    fn signs_of_life(&mut self, now: Time, executor: &Executor) {
        self.beats += 1;
        let plan = executor.program().map(|p| p.hash().to_string());
        self.heartbeat.set(now.as_secs_f64(), VALID_S, &Heartbeat { count: self.beats, plan });
        self.status.set(now.as_secs_f64(), VALID_S, &executor.status().convert());
    }

    fn way_ahead(&mut self, now: Time, executor: &Executor, all: bool) {
        let mut tokens = executor.ahead().map(|w| w.token);
        let count = executor.ahead().count();
        let told = tokens.next().map(|first| (first, tokens.last().unwrap_or(first), count));
        if all || told != self.ahead_told {
            self.ahead_told = told;
            let ahead = Ahead { waypoints: executor.ahead().cloned().map(Convert::convert).collect() };
            self.ahead.set(now.as_secs_f64(), VALID_S, &ahead);
        }
    }

    fn plan_and_variables(&mut self, now: Time, executor: &Executor, all: bool) {
        let variables = plan_variables(executor);
        if all || variables != self.variables_told {
            self.variables.set(now.as_secs_f64(), VALID_S, &variables);
            self.variables_told = variables;
        }
        let plan = plan_info(executor);
        if all || plan != self.plan_told {
            self.plan.set(now.as_secs_f64(), VALID_S, &plan);
            self.plan_told = plan;
        }
    }
}

/// Which plan is active.
pub fn plan_info(executor: &Executor) -> PlanInfo {
    let program = executor.program();
    PlanInfo {
        name: program.map(|p| p.plan.name.clone()).unwrap_or_default(),
        hash: program.map(|p| p.hash().to_string()),
        revision: executor.status().revision,
    }
}

fn plan_variables(executor: &Executor) -> PlanVariables {
    let Some(program) = executor.program() else { return PlanVariables::default() };
    let variables = program.plan.variables.iter().map(|v| PlanVariable {
        name: v.name.clone().convert(),
        value: executor.variables().get(&v.name).unwrap_or(&v.initial).clone().convert(),
        unit: v.unit.clone(),
        min: v.min,
        max: v.max,
    });
    PlanVariables { variables: variables.collect() }
}
