//! The FP Manager over loopback, with a gateway that flies at a waypoint a step.
#![cfg(test)]

mod ahead;
mod fake_gateway;

use fake_gateway::{DEADLINE, FakeGateway, free_endpoint, until, within};
use onboard_agent::single_instance::AlreadyRunning;
use onboard_agent::{Trigger, fp_manager, shutdown};
use sha2::{Digest, Sha256};
use std::path::Path;
use std::sync::Arc;
use system_tests::logs::Logs;
use tokio::process::Child;
use tokio::task::JoinHandle;
use usal::contract::*;
use usal::topics::{FP_MANAGER, fp_manager as topic};
use usal::{CallError, Occurrence, Session, Start};

const SQUARE: &str = include_str!("../../../assets/plans/square.xml");

/// An FP Manager: a real process where it is to be killed, else in this one.
enum Manager {
    Embedded { _task: JoinHandle<anyhow::Result<()>>, _trigger: Trigger },
    Process(Child),
}

impl Manager {
    fn start(config: &fp_manager::Config, logs: &Logs) -> Self {
        let Some(directory) = &config.state_dir else {
            let (trigger, shutdown) = shutdown();
            let task = tokio::spawn(fp_manager::run(config.clone(), shutdown));
            return Self::Embedded { _task: task, _trigger: trigger };
        };
        let mut command = tokio::process::Command::new(env!("CARGO_BIN_EXE_onboard-agent"));
        command
            .args(["fp-manager", "--simulated", "--connect", &config.connect, "--state-dir"])
            .arg(directory)
            .stderr(logs.of("fp-manager").unwrap());
        Self::Process(command.kill_on_drop(true).spawn().unwrap())
    }
}

/// A flight with its gateway, FP Manager and a client.
struct Flight {
    gateway: FakeGateway,
    client: Session,
    manager: Option<Manager>,
    config: fp_manager::Config,
    logs: Logs,
}

impl Flight {
    async fn new(state_dir: Option<&Path>) -> Self {
        Self::over(Arc::new(terrain::Tiles::new()), state_dir).await
    }

    /// Over some ground.
    async fn over(terrain: Arc<dyn terrain::Terrain>, state_dir: Option<&Path>) -> Self {
        let endpoint = free_endpoint();
        let gateway = FakeGateway::open(&endpoint).await;
        let client = Session::open(usal::Config::client("uav1", &endpoint).named("operator")).await.unwrap();
        let config = fp_manager::Config {
            simulated: true,
            terrain,
            state_dir: state_dir.map(Into::into),
            ..fp_manager::Config::new("uav1", &endpoint)
        };
        Self::of(gateway, client, config).await
    }

    /// Without memory, otherwise than usual.
    async fn with(change: impl FnOnce(&mut fp_manager::Config)) -> Self {
        let endpoint = free_endpoint();
        let gateway = FakeGateway::open(&endpoint).await;
        let client = Session::open(usal::Config::client("uav1", &endpoint).named("operator")).await.unwrap();
        let mut config = fp_manager::Config { simulated: true, ..fp_manager::Config::new("uav1", &endpoint) };
        change(&mut config);
        Self::of(gateway, client, config).await
    }

    async fn of(gateway: FakeGateway, client: Session, config: fp_manager::Config) -> Self {
        let mut flight = Self { gateway, client, manager: None, config, logs: Logs::new().unwrap() };
        flight.start_manager().await;
        flight
    }

    async fn start_manager(&mut self) {
        self.manager = Some(Manager::start(&self.config, &self.logs));
        self.gateway.participants(1).await;
    }

    /// SIGKILL: no goodbye.
    async fn kill_manager(&mut self) {
        let Some(Manager::Process(mut process)) = self.manager.take() else { panic!("no process") };
        process.kill().await.unwrap();
        self.gateway.participants(0).await;
    }

    /// Answers are awaited while time goes on.
    async fn command(&mut self, command: Command) -> Result<Empty, CallError> {
        self.gateway.step_until_done(self.client.call(topic::COMMAND, &command, DEADLINE)).await
    }

    async fn propose(&mut self, xml: &str) -> Result<ProposalReport, CallError> {
        let propose = Propose { xml: xml.into(), seen_revision: None };
        self.gateway.step_until_done(self.client.call(topic::PROPOSE, &propose, DEADLINE)).await
    }

    async fn load(&mut self, xml: &str) {
        let report = self.propose(xml).await.unwrap();
        assert!(report.acceptable, "{:?}", report.problems);
        self.command(Command::Commit { hash: report.hash, entry: None }).await.unwrap();
    }

    async fn step(&mut self, steps: usize) {
        for _ in 0..steps {
            self.gateway.step().await;
        }
    }

    async fn step_until(&mut self, condition: impl Fn(&FakeGateway) -> bool) {
        for _ in 0..2000 {
            if condition(&self.gateway) {
                return;
            }
            self.gateway.step().await;
        }
        panic!("never; requests {:?}, flown {:?}", self.gateway.requests, self.gateway.flown);
    }

    async fn start(&mut self) {
        self.command(Command::Start).await.unwrap();
        self.step_until(|g| g.launches() > 0).await;
    }
}

fn legs(gateway: &FakeGateway) -> Vec<String> {
    let mut legs: Vec<String> = gateway.flown.iter().map(|w| w.leg.to_string()).collect();
    legs.dedup();
    legs
}

#[tokio::test(flavor = "multi_thread")]
async fn plan_is_proposed_committed_started_and_flown_to_its_end() {
    let mut flight = Flight::new(None).await;
    let mut events = flight.client.listen(topic::EVENTS, Start::Remembered).unwrap();
    let status = flight.client.follow(topic::STATUS).unwrap();
    flight.load(SQUARE).await;
    flight.start().await;
    flight.step_until(|g| g.finished()).await;
    flight.step(3).await;
    let flown = legs(&flight.gateway);
    for leg in ["take-off", "side1", "side2", "side3", "side4", "land"] {
        assert_eq!(flown.iter().filter(|l| *l == leg).count(), 1, "{leg} in {flown:?}");
    }
    let tokens: Vec<u64> = flight.gateway.flown.iter().map(|w| w.token.0).collect();
    assert!(tokens.is_sorted_by(|a, b| a < b), "{tokens:?}");
    until(async || status.latest().is_some_and(|s| format!("{:?}", s.stamped.value.phase) == "Finished"))
        .await;
    let mut entered = Vec::new();
    while let Some(occurrence) = events.try_recv() {
        match occurrence {
            Occurrence::Event { event: Stamped { value: PlanEvent::LegEntered { place }, .. }, .. } => {
                entered.push(place.leg.to_string());
            }
            Occurrence::Event { .. } => {}
            Occurrence::Gap { missed } => panic!("{missed} events lost"),
        }
    }
    assert!(entered.ends_with(&["land".to_owned()]), "{entered:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn bad_plan_is_refused_with_its_problems() {
    let mut flight = Flight::new(None).await;
    for (xml, told) in [("garbage", "error"), (&SQUARE.replace("fix=\"B\"", "fix=\"Z\""), "Z")] {
        match flight.propose(xml).await {
            Err(CallError::Refused(refusal)) => {
                assert_eq!(refusal.code, "plan-errors");
                assert!(refusal.reason.contains(told), "{}", refusal.reason);
            }
            other => panic!("{other:?}"),
        }
    }
    let refused = flight.command(Command::Start).await.unwrap_err();
    assert!(matches!(refused, CallError::Refused(r) if r.code == "no-plan"));
}

#[tokio::test(flavor = "multi_thread")]
async fn proposal_against_an_older_revision_is_refused() {
    let mut flight = Flight::new(None).await;
    flight.load(SQUARE).await;
    let stale = Propose { xml: SQUARE.into(), seen_revision: Some(0) };
    let call = flight.client.call(topic::PROPOSE, &stale, DEADLINE);
    let refused = flight.gateway.step_until_done(call).await.unwrap_err();
    assert!(matches!(refused, CallError::Refused(r) if r.code == "stale-revision"));
}

#[tokio::test(flavor = "multi_thread")]
async fn active_plan_and_its_variables_can_be_read() {
    let mut flight = Flight::new(None).await;
    flight.load(SQUARE).await;
    let call = flight.client.call(topic::PLAN_DOCUMENT, &Empty {}, DEADLINE);
    let document = flight.gateway.step_until_done(call).await.unwrap();
    assert_eq!(document.info.name, "Square circuit");
    assert_eq!(flight_plan::hash(&flight_plan::read(&document.xml).plan), document.info.hash.unwrap());
}

#[tokio::test(flavor = "multi_thread")]
async fn active_plan_is_a_file_with_the_hash_of_the_status_also_after_a_restart() {
    let directory = tempfile::tempdir().unwrap();
    let mut flight = Flight::new(Some(directory.path())).await;
    flight.load(SQUARE).await;
    for _ in 0..2 {
        flight.step(1).await;
        let status = flight.client.follow(topic::STATUS).unwrap();
        until(async || status.latest().is_some_and(|s| s.stamped.value.plan.is_some())).await;
        let plan = status.latest().unwrap().stamped.value.plan.clone().unwrap();
        let file = flight.client.fetch(FP_MANAGER, topic::PLAN_FILE, DEADLINE).await.unwrap();
        let digest = Sha256::digest(&file);
        assert_eq!(digest.iter().map(|b| format!("{b:02x}")).collect::<String>(), *plan);
        assert_eq!(*flight_plan::hash(&flight_plan::read(std::str::from_utf8(&file).unwrap()).plan), *plan);
        flight.kill_manager().await;
        flight.start_manager().await;
    }
}

/// `start` was answered with success, and the plan was said to be flown.
#[tokio::test(flavor = "multi_thread")]
async fn where_a_log_is_played_nothing_can_be_commanded() {
    let mut flight = Flight::with(|config| config.replay = true).await;
    for command in [Command::Start, Command::Hold, Command::Rewind] {
        match flight.command(command).await {
            Err(CallError::Refused(refusal)) => {
                assert!(
                    refusal.code == "replay" && refusal.reason.contains("nothing can be commanded"),
                    "{refusal}"
                );
            }
            other => panic!("{other:?}"),
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn hold_and_resume_reach_the_gateway_in_order() {
    let mut flight = Flight::new(None).await;
    flight.load(SQUARE).await;
    flight.start().await;
    flight.step_until(|g| g.flown.len() >= 2).await;
    flight.command(Command::Hold).await.unwrap();
    flight.step_until(|g| g.state == GatewayState::Hold).await;
    let held = flight.gateway.flown.len();
    flight.step(20).await;
    assert_eq!(flight.gateway.flown.len(), held);
    flight.command(Command::Resume).await.unwrap();
    flight.step_until(|g| g.finished()).await;
    let kinds: Vec<_> = flight.gateway.requests.clone();
    assert_eq!(kinds, [GatewayRequest::Launch, GatewayRequest::Hold, GatewayRequest::Resume]);
}

#[tokio::test(flavor = "multi_thread")]
async fn who_resumes_is_answered_as_the_gateway_answers() {
    let mut flight = Flight::new(None).await;
    flight.load(SQUARE).await;
    flight.start().await;
    flight.step_until(|g| g.flown.len() >= 2).await;
    flight.command(Command::Hold).await.unwrap();
    flight.step_until(|g| g.state == GatewayState::Hold).await;
    // until the FP Manager knows
    flight.step(3).await;
    flight.gateway.refuse_resume = Some("not while the test says so".into());
    match flight.command(Command::Resume).await {
        Err(CallError::Refused(refusal)) => {
            assert_eq!(refusal.code, "not-granted");
            assert!(refusal.reason.contains("not while the test says so"), "{refusal}");
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(flight.gateway.state, GatewayState::Hold);
    flight.gateway.refuse_resume = None;
    flight.command(Command::Resume).await.unwrap();
    assert_ne!(flight.gateway.state, GatewayState::Hold, "it has agreed");
}

#[tokio::test(flavor = "multi_thread")]
async fn alarm_with_a_cause_flies_the_emergency_plan() {
    let mut flight = Flight::new(None).await;
    flight.load(SQUARE).await;
    flight.start().await;
    flight.step_until(|g| g.flown.iter().any(|w| w.leg.as_str() == "side1")).await;
    flight.gateway.alarm("energy-low", Cause::Energy);
    flight.step_until(|g| g.finished()).await;
    let flown = legs(&flight.gateway);
    assert!(flown.contains(&"r1".to_owned()) && !flown.contains(&"side3".to_owned()), "{flown:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn alarm_without_an_emergency_plan_asks_the_gateway_for_safe_mode() {
    let mut flight = Flight::new(None).await;
    flight.load(&SQUARE.replace(r#"<mainPlan emergency="return">"#, "<mainPlan>")).await;
    flight.start().await;
    flight.step_until(|g| g.flown.len() >= 2).await;
    flight.gateway.alarm("energy-low", Cause::Energy);
    flight.step_until(|g| g.requests.contains(&GatewayRequest::Safe)).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn abort_asks_the_gateway_for_safe_mode_whatever_the_plan_says() {
    let mut flight = Flight::new(None).await;
    flight.load(SQUARE).await;
    flight.start().await;
    flight.step_until(|g| g.flown.len() >= 2).await;
    flight.command(Command::AbortToSafe).await.unwrap();
    flight.step_until(|g| g.requests.contains(&GatewayRequest::Safe)).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn emergency_plan_refused_by_the_gateway_leaves_the_flight_to_safe_mode() {
    let mut flight = Flight::new(None).await;
    flight.load(SQUARE).await;
    flight.start().await;
    flight.step_until(|g| g.flown.iter().any(|w| w.leg.as_str() == "side1")).await;
    flight.gateway.refuse_leg = Some("r1".into());
    flight.gateway.alarm("energy-low", Cause::Energy);
    flight.step_until(|g| g.requests.contains(&GatewayRequest::Safe)).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_plan_calls_a_service_once_where_it_says_so() {
    let mut flight = Flight::new(None).await;
    let invocation: usal::topics::Invocation<serde_json::Value, Empty> =
        usal::topics::Invocation::new("payload", "drop");
    let service = Session::open(usal::Config::client("uav1", &flight.config.connect).named("plan-service"))
        .await
        .unwrap();
    let mut drops = service.serve(invocation).unwrap();
    let action =
        r#"<action on="end"><invoke service="payload" operation="drop" argument='{"bay": 2}'/></action>"#;
    let side = r#"<TF id="side2" fix="B"/>"#;
    let with = format!(r#"<TF id="side2" fix="B">{action}</TF>"#);
    flight.load(&SQUARE.replace(side, &with)).await;
    flight.start().await;
    flight.step_until(|g| g.finished()).await;
    let dropped = within(drops.recv()).await.unwrap();
    assert_eq!(dropped.request, serde_json::json!({"bay": 2}));
    dropped.answer(Ok(Empty {}));
    flight.step(20).await;
    assert!(drops.try_recv().is_none(), "once");
}

#[tokio::test(flavor = "multi_thread")]
async fn alarm_raised_while_it_was_dead_is_acted_on_once() {
    let directory = tempfile::tempdir().unwrap();
    let mut flight = Flight::new(Some(directory.path())).await;
    let mut events = flight.client.listen(topic::EVENTS, Start::Remembered).unwrap();
    flight.load(SQUARE).await;
    flight.start().await;
    flight.step_until(|g| g.flown.iter().any(|w| w.leg.as_str() == "take-off")).await;
    flight.kill_manager().await;
    flight.gateway.alarm("energy-low", Cause::Energy);
    // both times it finds the alarm raised
    for _ in 0..2 {
        flight.gateway.safe_return();
        flight.start_manager().await;
        let runways = flight.gateway.runways.len();
        flight.step_until(|g| g.runways.len() > runways).await;
        flight.step(1).await;
        flight.kill_manager().await;
    }
    flight.gateway.safe_return();
    flight.start_manager().await;
    flight.step_until(|g| g.finished()).await;
    let flown = legs(&flight.gateway);
    assert!(flown.contains(&"r1".to_owned()) && !flown.contains(&"side3".to_owned()), "{flown:?}");
    let mut started = 0;
    while let Some(occurrence) = events.try_recv() {
        let Occurrence::Event { event, .. } = occurrence else { continue };
        started += usize::from(matches!(event.value, PlanEvent::EmergencyStarted { .. }));
    }
    assert_eq!(started, 1);
}

/// The vehicle was carried home and switched on again: what its journal says it was flying is not gone on with.
#[tokio::test(flavor = "multi_thread")]
async fn plan_of_an_interrupted_flight_is_rewound_on_the_ground_and_stays_so() {
    let directory = tempfile::tempdir().unwrap();
    let mut flight = Flight::new(Some(directory.path())).await;
    let status = flight.client.follow(topic::STATUS).unwrap();
    flight.load(SQUARE).await;
    flight.start().await;
    flight.step_until(|g| g.flown.iter().any(|w| w.leg.as_str() == "side2")).await;
    let refused = flight.command(Command::Rewind).await.unwrap_err();
    assert!(matches!(refused, CallError::Refused(r) if r.code == "in-the-air"));
    flight.kill_manager().await;
    flight.gateway.state = GatewayState::Stop;
    flight.start_manager().await;
    flight.step(3).await;
    flight.command(Command::Rewind).await.unwrap();
    // it is in the journal: another restart does not bring the old flight back
    flight.kill_manager().await;
    flight.start_manager().await;
    flight.step(3).await;
    until(async || status.latest().is_some_and(|s| s.stamped.value.phase == Phase::Idle)).await;
    let flown = flight.gateway.flown.len();
    flight.gateway.is_carried_back();
    flight.step(3).await;
    flight.start().await;
    flight.step_until(|g| g.finished()).await;
    let again: Vec<String> = flight.gateway.flown[flown..].iter().map(|w| w.leg.to_string()).collect();
    assert!(again.contains(&"take-off".to_owned()) && again.contains(&"side1".to_owned()), "{again:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn what_would_follow_is_told_and_not_done() {
    let mut flight = Flight::new(None).await;
    let ask = |command| Foresee { command };
    flight.load(SQUARE).await;
    let call = flight.client.call(topic::FORESEE, &ask(None), DEADLINE);
    let refused = flight.gateway.step_until_done(call).await.unwrap_err();
    assert!(matches!(refused, CallError::Refused(r) if r.code == "not-flying"));
    flight.start().await;
    flight.step_until(|g| g.flown.iter().any(|w| w.leg.as_str() == "side1")).await;
    let go = Command::GoTo { leg: "side4".into() };
    let call = flight.client.call(topic::FORESEE, &ask(Some(go)), DEADLINE);
    let told = flight.gateway.step_until_done(call).await.unwrap();
    assert_eq!(told.next_leg, Some("side4".into()));
    assert!(told.left_out.contains(&"side3".into()) && told.path.len() > 10, "{told:?}");
    flight.step_until(|g| g.finished()).await;
    assert!(legs(&flight.gateway).contains(&"side3".to_owned()), "nothing was done");
}

#[tokio::test(flavor = "multi_thread")]
async fn launch_refused_is_told_once_with_its_reason_and_asked_again() {
    let mut flight = Flight::new(None).await;
    let mut events = flight.client.listen(topic::EVENTS, Start::Remembered).unwrap();
    flight.load(SQUARE).await;
    flight.gateway.refuse_launch = Some("There is no GPS fix.".into());
    flight.command(Command::Start).await.unwrap();
    flight.step(10).await;
    flight.gateway.refuse_launch = None;
    flight.step_until(|g| g.launches() > 0).await;
    flight.step_until(|g| g.finished()).await;
    let mut told = Vec::new();
    while let Some(occurrence) = events.try_recv() {
        if let Occurrence::Event {
            event: Stamped { value: PlanEvent::NotGranted { request, reason }, .. },
            ..
        } = occurrence
        {
            told.push((request, reason));
        }
    }
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].0 == "launch" && told[0].1.contains("no GPS fix"), "{told:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn killed_and_restarted_it_goes_on_at_its_place() {
    let directory = tempfile::tempdir().unwrap();
    let mut flight = Flight::new(Some(directory.path())).await;
    flight.load(SQUARE).await;
    flight.start().await;
    flight.step_until(|g| g.flown.iter().any(|w| w.leg.as_str() == "side1")).await;
    flight.kill_manager().await;
    flight.step(2).await;
    flight.start_manager().await;
    flight.step_until(|g| g.finished()).await;
    let flown = legs(&flight.gateway);
    for leg in ["take-off", "side1", "side2", "side3", "side4", "land"] {
        assert_eq!(flown.iter().filter(|l| *l == leg).count(), 1, "{leg} in {flown:?}");
    }
    assert_eq!(flight.gateway.joins.len(), 2);
    assert_eq!(flight.gateway.joins[0].plan, None);
    assert!(flight.gateway.joins[1].plan.is_some() && flight.gateway.joins[1].last_token.0 > 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn runways_of_the_plan_are_stored_when_it_becomes_active_at_the_start_and_after_each_join() {
    let mut flight = Flight::new(None).await;
    flight.load(SQUARE).await;
    flight.step_until(|g| g.runways.len() == 1).await;
    flight.start().await;
    flight.step_until(|g| g.runways.len() == 2).await;
    flight.step_until(|g| g.flown.len() >= 2).await;
    flight.gateway.safe_hold();
    flight.step_until(|g| g.runways.len() == 3).await;
    let plan = flight_plan::read(SQUARE).plan;
    let ids: Vec<String> = plan.runways.iter().map(|r| r.id.to_string()).collect();
    for stored in &flight.gateway.runways {
        assert_eq!(stored.iter().map(|r| r.id.clone()).collect::<Vec<_>>(), ids);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn gateway_that_lost_its_buffer_is_fed_again() {
    let mut flight = Flight::new(None).await;
    flight.load(SQUARE).await;
    flight.start().await;
    flight.step_until(|g| g.flown.iter().any(|w| w.leg.as_str() == "side2")).await;
    flight.gateway.safe_return();
    flight.step_until(|g| g.finished()).await;
    let flown = legs(&flight.gateway);
    assert!(flown.ends_with(&["land".to_owned()]), "{flown:?}");
    let tokens: Vec<u64> = flight.gateway.flown.iter().map(|w| w.token.0).collect();
    assert!(tokens.is_sorted_by(|a, b| a < b), "{tokens:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn waypoints_refused_by_the_gateway_hold_the_flight_and_are_told() {
    let mut flight = Flight::new(None).await;
    let mut events = flight.client.listen(topic::EVENTS, Start::Remembered).unwrap();
    flight.load(SQUARE).await;
    flight.gateway.refuse_leg = Some("side2".into());
    flight.command(Command::Start).await.unwrap();
    let told = within(async {
        loop {
            flight.gateway.step().await;
            while let Some(occurrence) = events.try_recv() {
                if let Occurrence::Event {
                    event: Stamped { value: PlanEvent::WaypointsRejected { reason, .. }, .. },
                    ..
                } = occurrence
                {
                    return reason;
                }
            }
        }
    })
    .await;
    assert!(told.contains("not there"), "{told}");
}

#[tokio::test(flavor = "multi_thread")]
async fn damaged_journal_is_set_aside_and_told_and_the_manager_runs() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("segment-00000007.journal"), b"\xffgarbage").unwrap();
    let mut flight = Flight::new(Some(directory.path())).await;
    let mut events = flight.client.listen(topic::EVENTS, Start::Remembered).unwrap();
    assert!(directory.path().join("segment-00000007.unusable").exists());
    match flight.command(Command::Start).await.unwrap_err() {
        CallError::Refused(refusal) => assert!(refusal.reason.contains("lost"), "{refusal}"),
        other => panic!("{other:?}"),
    }
    flight.load(SQUARE).await;
    until(async || {
        matches!(events.try_recv(), Some(Occurrence::Event { event, .. })
            if matches!(&event.value, PlanEvent::NotJournalled { reason } if reason.contains("unusable")))
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn variable_is_written_by_its_writers_only_and_who_did_is_told() {
    let mut flight = Flight::new(None).await;
    let mut events = flight.client.listen(topic::EVENTS, Start::Remembered).unwrap();
    let variable =
        r#"<variables><variable name="fire" type="bool" initial="false" writers="fire-watch"/></variables>"#;
    flight.load(&SQUARE.replace("<mainPlan", &format!("{variable}<mainPlan"))).await;
    let set = Command::SetVariable { name: "fire".into(), value: VariableValue::Bool(true) };
    let refused = flight.command(set.clone()).await.unwrap_err();
    assert!(refused.to_string().contains("fire-watch"), "{refused}");
    let service = usal::Config::client("uav1", &flight.config.connect).named("fire-watch");
    let service = Session::open(service).await.unwrap();
    flight.gateway.step_until_done(service.call(topic::COMMAND, &set, DEADLINE)).await.unwrap();
    until(async || {
        matches!(events.try_recv(), Some(Occurrence::Event { event, .. })
            if matches!(&event.value, PlanEvent::VariableChanged { by, .. } if **by == *"fire-watch"))
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn second_manager_of_a_vehicle_or_a_state_directory_does_not_start() {
    let directory = tempfile::tempdir().unwrap();
    let flight = Flight::new(Some(directory.path())).await;
    let elsewhere = fp_manager::Config { state_dir: None, ..flight.config.clone() };
    let refused = within(fp_manager::run(elsewhere, shutdown().1)).await.unwrap_err();
    assert!(refused.is::<AlreadyRunning>() && refused.to_string().contains("uav1"), "{refused:#}");
    let endpoint = free_endpoint();
    let Manager::Process(mut second) =
        Manager::start(&fp_manager::Config { connect: endpoint, ..flight.config.clone() }, &flight.logs)
    else {
        panic!("no process")
    };
    assert_eq!(within(second.wait()).await.unwrap().code(), Some(2));
}

#[tokio::test(flavor = "multi_thread")]
async fn proposal_not_committed_survives_a_kill() {
    let directory = tempfile::tempdir().unwrap();
    let mut flight = Flight::new(Some(directory.path())).await;
    let report = flight.propose(SQUARE).await.unwrap();
    flight.kill_manager().await;
    flight.start_manager().await;
    flight.command(Command::Commit { hash: report.hash, entry: None }).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn state_directory_that_cannot_be_written_is_told_and_flown_without_until_it_can() {
    let directory = tempfile::tempdir().unwrap();
    // a file where the folder should be: nobody can write there, not even root
    let folder = directory.path().join("state");
    std::fs::write(&folder, b"").unwrap();
    let mut flight = Flight::new(Some(&folder)).await;
    let mut events = flight.client.listen(topic::EVENTS, Start::Remembered).unwrap();
    flight.load(SQUARE).await;
    flight.start().await;
    let mut received = Vec::new();
    let mut tell = |flight: &Flight| {
        let _ = flight;
        while let Some(Occurrence::Event { event, .. }) = events.try_recv() {
            match event.value {
                PlanEvent::NotJournalled { .. } => received.push("not journalled"),
                PlanEvent::Journalled => received.push("journalled"),
                _ => {}
            }
        }
        received.clone()
    };
    flight.step_until(|g| g.flown.len() >= 2).await;
    until(async || tell(&flight) == ["not journalled"]).await;
    std::fs::remove_file(&folder).unwrap();
    within(async {
        while tell(&flight).len() < 2 {
            flight.gateway.state = GatewayState::Hold;
            flight.step(1).await;
        }
    })
    .await;
    assert_eq!(tell(&flight), ["not journalled", "journalled"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn plan_accepted_is_on_disk_before_it_is_told() {
    let directory = tempfile::tempdir().unwrap();
    let mut flight = Flight::new(Some(directory.path())).await;
    flight.load(SQUARE).await;
    flight.kill_manager().await;
    flight.start_manager().await;
    let call = flight.client.call(topic::PLAN_DOCUMENT, &Empty {}, DEADLINE);
    let document = flight.gateway.step_until_done(call).await.unwrap();
    assert_eq!(document.info.name, "Square circuit");
}

#[tokio::test(flavor = "multi_thread")]
async fn landed_while_it_was_dead_it_does_not_take_off_again() {
    let directory = tempfile::tempdir().unwrap();
    let mut flight = Flight::new(Some(directory.path())).await;
    flight.load(SQUARE).await;
    flight.start().await;
    flight.step_until(|g| g.end_is_aboard()).await;
    flight.kill_manager().await;
    flight.step_until(|g| g.finished()).await;
    let flown = flight.gateway.flown.len();
    flight.start_manager().await;
    flight.step(30).await;
    assert_eq!(flight.gateway.flown.len(), flown);
    assert_eq!(flight.gateway.requests, [GatewayRequest::Launch]);
}
