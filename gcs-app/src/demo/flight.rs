//! The flight itself: the mission logic as one more service, in step with the simulated clock.

use super::by_hand;
use super::components::{Components, VEHICLE};
use super::judge::Outcome;
use super::mission::{Act, Script, Step};
use super::progress::Progress;
use super::recorded::{GATEWAY_EVENTS, PLAN_EVENTS, Recorded, refusal};
use super::recording::{Count, Recording};
use super::watcher::Watcher;
use crate::report::TrackPoint;
use anyhow::{Context, bail, ensure};
use flight_exec::{Command, Event, Phase, Status};
use flight_plan::{Edit, FlightPlan, Runway};
use std::sync::Arc;
use std::time::{Duration, Instant};
use usal::contract::{
    ClockTick, FpManagerEvent, GatewayState, GatewayStatus, PlanStatus, Propose, TimedGatewayEvent,
};
use usal::topics::{fp_manager, gateway};
use usal::{Config, EventSubscriber, Occurrence, Participant, Session, Start, VariableSubscriber};
use wire::Convert;

/// A service that does not answer for so long has failed, wall-clock.
const ANSWER_WITHIN: Duration = Duration::from_secs(15);
/// A session that does not close within this time is left alone, wall-clock.
const CLOSE_WITHIN: Duration = Duration::from_secs(2);
/// The agent must be ready to fly after this, wall-clock.
const READY_WITHIN: Duration = Duration::from_secs(30);
/// No tick of the simulated clock for so long is a failure, wall-clock.
const TICK_WITHIN: Duration = Duration::from_secs(15);
/// While the clock stands still, failed components are looked for so often, wall-clock.
const LOOK_EVERY: Duration = Duration::from_millis(500);
/// A flight longer than the preview by this factor and these seconds has failed.
const TOO_LONG: (f64, f64) = (1.3, 240.0);
/// Between two flights of a plan it stands at least so long, simulated seconds.
const STANDS_S: f64 = 5.0;
/// Nobody in the demo orders a hold: one that lasts for so many simulated seconds is a failure.
const HOLD_WITHIN_S: f64 = 60.0;
/// Simulated seconds for which a decision is left to who watches, and their pace, × real time: ten seconds on the wall.
const PATIENCE_S: f64 = 15.0;
const ASKED_PACE: f64 = 1.5;
/// What they read meanwhile.
const ASKED: &str = "The fork asks: decide within 10 s by a button or its key, or the demo decides for you";
/// Simulated seconds after the plan's end in which the aircraft must have come to rest.
const REST_WITHIN_S: f64 = 90.0;

/// The mission logic and what it listens to.
pub struct Flight<'a> {
    session: Session,
    clock: Participant,
    subscribed: Subscriptions,
    script: Script,
    /// With its updates.
    plan: FlightPlan,
    /// Hashes of the plans that were committed, the last one last.
    sent: Vec<Arc<str>>,
    /// Why something of the plan was refused last.
    last_refusal: Option<String>,
    /// Events heard of FP Manager and gateway, and those that were lost on the way here.
    plan_events: Tally,
    gateway_events: Tally,
    progress: &'a Progress,
    watcher: &'a Watcher,
    planned_s: f64,
    /// Simulated time at which the plan was started, seconds.
    started_s: f64,
    now_s: f64,
    wall: Instant,
}

/// Events of a stream.
#[derive(Clone, Copy, Default)]
struct Tally {
    heard: u64,
    lost: u64,
}

/// What was seen of a flight.
pub struct Ending {
    /// What was recorded; times count from the start of the plan.
    pub recorded: Recorded,
    /// For the judge.
    pub outcome: Outcome,
}

/// What comes in.
struct Subscriptions {
    plan_events: EventSubscriber<FpManagerEvent>,
    gateway_events: EventSubscriber<TimedGatewayEvent>,
    state: VariableSubscriber<GatewayStatus>,
    status: VariableSubscriber<PlanStatus>,
}

impl Subscriptions {
    fn listen(session: &Session) -> anyhow::Result<Self> {
        Ok(Self {
            plan_events: session.listen(fp_manager::EVENTS, Start::Remembered)?,
            gateway_events: session.listen(gateway::EVENTS, Start::Remembered)?,
            state: session.follow(gateway::STATE)?,
            status: session.follow(fp_manager::STATUS)?,
        })
    }

    fn status(&self) -> Option<Status> {
        Some(self.status.latest()?.stamped.value.clone().convert())
    }

    fn gateway_state(&self) -> Option<GatewayState> {
        Some(self.state.latest()?.stamped.value.state)
    }
}

impl<'a> Flight<'a> {
    /// Joins the flight: a session, the clock, the subscriptions. It ends early when the
    /// watcher leaves.
    ///
    /// # Errors
    /// The session can't be opened.
    pub async fn join(
        components: &Components,
        plan: FlightPlan,
        script: Script,
        planned_s: f64,
        progress: &'a Progress,
        watcher: &'a Watcher,
    ) -> anyhow::Result<Self> {
        let session = Session::open(Config::client(VEHICLE, &components.endpoint).named("mission")).await?;
        Ok(Self {
            subscribed: Subscriptions::listen(&session)?,
            clock: Participant::join(&session, "mission")?,
            session,
            script,
            plan,
            sent: Vec::new(),
            last_refusal: None,
            plan_events: Tally::default(),
            gateway_events: Tally::default(),
            progress,
            watcher,
            planned_s,
            started_s: 0.0,
            now_s: 0.0,
            wall: Instant::now(),
        })
    }

    /// Waits for the agent, sends the plan, starts it, follows it to its end.
    ///
    /// # Errors
    /// A component fails, does not answer, or the flight does not end in time.
    pub async fn fly(&mut self, components: &mut Components) -> anyhow::Result<()> {
        self.wait_until_ready(components).await?;
        let plan = self.plan.clone();
        self.send_plan(&plan).await.context("the plan was not taken")?;
        self.command(Command::Start).await.context("the plan was not started")?;
        self.started_s = self.now_s;
        self.wall = Instant::now();
        self.tell("The aircraft takes off and flies the plan");
        let (mut phase, mut since_s) = (Phase::Idle, self.now_s);
        loop {
            let before_s = self.now_s;
            let tick = self.next_tick(components).await?;
            self.look(components);
            self.react().await?;
            self.leave_time(self.now_s - before_s).await;
            self.clock.acknowledge(tick);
            let now = self.subscribed.status().map_or(Phase::Idle, |s| s.phase);
            if now != phase {
                (phase, since_s) = (now, self.now_s);
            }
            if phase == Phase::Grounded && self.now_s - since_s > STANDS_S && is_at_rest(components) {
                self.command(Command::Start).await.context("the next flight was not started")?;
                self.tell("The aircraft takes off for its next flight");
                since_s = self.now_s;
            }
            if self.is_over(phase, self.now_s - since_s, components)? {
                break;
            }
        }
        self.look(components);
        Ok(())
    }

    /// The flight has come to its end; an error if it will not.
    fn is_over(&self, phase: Phase, lasts_s: f64, components: &Components) -> anyhow::Result<bool> {
        ensure!(!self.watcher.has_left(), "the window was closed before the flight had ended");
        if phase == Phase::Finished {
            return Ok(is_at_rest(components) || lasts_s > REST_WITHIN_S);
        }
        if self.watcher.is_watching() {
            return Ok(false);
        }
        ensure!(
            phase == Phase::Flying || lasts_s < HOLD_WITHIN_S,
            "the flight does not go on: {phase:?}; {}",
            self.last_refusal()
        );
        let flown_s = self.now_s - self.started_s;
        ensure!(
            flown_s < self.planned_s * TOO_LONG.0 + TOO_LONG.1,
            "after {:.0} min the flight still goes on, {:.0} min were previewed",
            flown_s / 60.0,
            self.planned_s / 60.0
        );
        Ok(false)
    }

    /// Ends the session: the clock does not wait for it any more.
    pub async fn leave(self) {
        // seen to take ten seconds, with nothing left to be said
        if tokio::time::timeout(CLOSE_WITHIN, self.session.close()).await.is_err() {
            tracing::debug!("the mission logic's session does not close, it is left alone");
        }
    }

    /// Events heard of each stream: the recording has them, too.
    pub fn counts(&self) -> [Count; 2] {
        [
            (PLAN_EVENTS.to_owned(), self.plan_events.heard),
            (GATEWAY_EVENTS.to_owned(), self.gateway_events.heard),
        ]
    }

    /// What became of the flight, as it was recorded and as it is now.
    pub fn ending(&self, recorded: Recorded, components: &Components, destination: &Runway) -> Ending {
        let mut recorded = recorded.since(self.started_s);
        let active = self.subscribed.status().and_then(|status| status.plan);
        recorded.ends_with(active.as_ref().or(self.sent.last()).map_or("", |hash| hash));
        recorded.lost(self.plan_events.lost, "events of the FP Manager were lost");
        recorded.lost(self.gateway_events.lost, "events of the gateway were lost");
        let truth = components.simulator.truth();
        let emergency = by_hand::emergency_at_end(&recorded.events);
        let landed_by = emergency.as_ref().and_then(|(plan, _)| recorded.runway_of(plan));
        let outcome = Outcome {
            stands_at: truth.position,
            on_ground: truth.on_ground,
            disarmed: !truth.armed,
            ground_speed_mps: truth.ground_speed_mps,
            runway: landed_by.unwrap_or(destination).clone(),
            emergency,
            by_hand: by_hand::deeds(&recorded.events, &self.sent),
            phase: self.subscribed.status().map_or(Phase::Idle, |s| s.phase),
            states: std::mem::take(&mut recorded.states),
            missing_steps: self.script.missing().map(|s| s.name.to_owned()).collect(),
            steps: self.script.steps(),
            refusals: std::mem::take(&mut recorded.refusals),
        };
        Ending { recorded, outcome }
    }

    fn last_refusal(&self) -> &str {
        self.last_refusal.as_deref().unwrap_or("nothing was refused")
    }

    async fn wait_until_ready(&mut self, components: &mut Components) -> anyhow::Result<()> {
        let deadline = Instant::now() + READY_WITHIN;
        loop {
            let tick = self.next_tick(components).await?;
            self.look(components);
            self.clock.acknowledge(tick);
            let is_recorded = components.recording.as_ref().is_some_and(Recording::has_begun);
            let is_there = self.subscribed.gateway_state() == Some(GatewayState::Stop)
                && self.subscribed.status().is_some();
            if is_there && is_recorded {
                return Ok(());
            }
            self.progress.say("waiting for the agent");
            self.watcher.story.tell("Waiting for the agent", Some("the plan is sent and started"));
            ensure!(
                Instant::now() < deadline,
                "the agent is not ready after {} s: gateway {:?}, FP Manager {:?}, recording: {is_recorded}",
                READY_WITHIN.as_secs(),
                self.subscribed.gateway_state(),
                self.subscribed.status().map(|s| s.phase)
            );
        }
    }

    async fn next_tick(&mut self, components: &mut Components) -> anyhow::Result<ClockTick> {
        let mut tick = std::pin::pin!(tokio::time::timeout(TICK_WITHIN, self.clock.next()));
        let tick = loop {
            let waited = tokio::time::timeout(LOOK_EVERY, &mut tick).await;
            if let Some(failure) = components.failure().await {
                bail!(failure);
            }
            if let Ok(tick) = waited {
                break tick;
            }
        };
        let Ok(tick) = tick else {
            bail!(
                "the simulated clock stands still since {} s, at {:.1} s",
                TICK_WITHIN.as_secs(),
                self.now_s
            )
        };
        let tick = tick.context("the connection to the gateway was closed")?;
        self.now_s = tick.time_s;
        Ok(tick)
    }

    /// Takes in what has come, without waiting.
    fn look(&mut self, components: &Components) {
        for point in components.simulator.take_track() {
            let (time_s, position, altitude_amsl_m) = (point.time_s, point.position, point.altitude_amsl_m);
            if let Some(recording) = &components.recording {
                recording.truth(&TrackPoint { time_s, position, altitude_amsl_m });
            }
        }
        while let Some(occurrence) = self.subscribed.plan_events.try_recv() {
            match occurrence {
                Occurrence::Event { event, .. } => self.plan_event(event),
                Occurrence::Gap { missed } => self.plan_events.lost += missed,
            }
        }
        while let Some(occurrence) = self.subscribed.gateway_events.try_recv() {
            match occurrence {
                Occurrence::Event { .. } => self.gateway_events.heard += 1,
                Occurrence::Gap { missed } => self.gateway_events.lost += missed,
            }
        }
        if let Some(status) = self.subscribed.status() {
            self.script.steers_to(status.place.as_ref(), status.current);
            self.progress.show(
                self.now_s - self.started_s,
                self.wall.elapsed().as_secs_f64(),
                status.place.as_ref(),
            );
        }
    }

    fn plan_event(&mut self, stamped: FpManagerEvent) {
        self.plan_events.heard += 1;
        let event: Event = stamped.value.convert();
        if let Some(why) = refusal(&event) {
            self.last_refusal = Some(why.to_owned());
        }
        self.script.hear(&event, self.now_s);
    }

    /// Who sits before the window may decide: it is flown slowly, and the mission logic decides only after a while.
    async fn leave_time(&self, passed_s: f64) {
        if self.watcher.is_watching() && self.script.is_waiting() {
            self.tell(ASKED);
            tokio::time::sleep(Duration::from_secs_f64(passed_s.clamp(0.0, 1.0) / ASKED_PACE)).await;
        }
    }

    /// Does the steps of the mission logic that are due; time stands still meanwhile.
    async fn react(&mut self) -> anyhow::Result<()> {
        while let Some(step) = self.script.next_due(self.now_s, self.patience_s()) {
            let flown_s = self.now_s - self.started_s;
            self.progress.tell(&format!(
                "{:>6}  mission logic: {}",
                crate::report::clock(flown_s),
                step.name
            ));
            self.take(&step).await.with_context(|| format!("mission logic, {}", step.name))?;
            self.tell(step.story);
        }
        Ok(())
    }

    /// Simulated seconds for which the mission logic leaves a decision to who watches.
    fn patience_s(&self) -> f64 {
        if self.watcher.is_watching() { PATIENCE_S } else { 0.0 }
    }

    /// Tells who watches what is happening, and what comes next.
    fn tell(&self, now: &str) {
        let next = self.script.missing().next().map_or("the approach and the landing", |step| step.name);
        self.watcher.story.tell(now, Some(next));
    }

    async fn take(&mut self, step: &Step) -> anyhow::Result<()> {
        for act in &step.acts {
            match act {
                Act::Command(command) => self.command(command.clone()).await?,
                Act::Update(edit) => self.update(edit).await?,
            }
        }
        Ok(())
    }

    /// Another plan than ours is the operator's: it stays as it is.
    async fn update(&mut self, edit: &Edit) -> anyhow::Result<()> {
        let active = self.subscribed.status().and_then(|status| status.plan);
        if active.is_some() && active.as_ref() != self.sent.last() {
            return Ok(());
        }
        let plan = edit.apply(&self.plan)?;
        self.send_plan(&plan).await?;
        self.plan = plan;
        Ok(())
    }

    async fn send_plan(&mut self, plan: &FlightPlan) -> anyhow::Result<()> {
        let request = Propose { xml: flight_plan::write(plan), seen_revision: None };
        let report = self.session.call(fp_manager::PROPOSE, &request, ANSWER_WITHIN).await?;
        ensure!(report.acceptable, "{}", report.problems.join("; "));
        self.sent.push(report.hash.clone());
        self.command(Command::Commit { hash: report.hash, entry: None }).await
    }

    async fn command(&self, command: Command) -> anyhow::Result<()> {
        self.session.call(fp_manager::COMMAND, &command.convert(), ANSWER_WITHIN).await?;
        Ok(())
    }
}

fn is_at_rest(components: &Components) -> bool {
    let truth = components.simulator.truth();
    truth.on_ground && !truth.armed && truth.ground_speed_mps < 0.5
}
