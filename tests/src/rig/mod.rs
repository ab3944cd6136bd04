//! A whole system on loopback, whose time goes on only when the test says so.

mod doubts;
mod ground;
mod processes;
mod seen;
mod track;
mod world;

use crate::binaries::Program;
use crate::logs::Logs;
use crate::plans::{Field, RUNWAY_M};
use anyhow::{Context, bail, ensure};
use doubts::{Doubts, Told};
use geometry::LatLon;
use ground::Ground;
use processes::Places;
pub use seen::Seen;
use std::{
    path::Path,
    time::{Duration, Instant},
};
use track::Track;
use usal::{
    CallError, Occurrence,
    contract::{
        Air, Attitude, Command, Foresee, Foresight, GatewayEvent, GatewayRequest, GatewayState,
        GatewayStatus, Navigation, PlanStatus, Position, ProposalReport, Propose, Recording, Stamped,
    },
    topics::{self, fp_manager, gateway},
};
use world::World;

/// Where the simulator stands.
pub const FIELD: Field =
    Field { threshold: LatLon::new(36.4905, -84.2710), elevation_m: 322.0, heading_deg: 52.0 };

/// An aircraft that landed on its runway stands at most so far short of it, metres.
const SHORT_M: f64 = 30.0;
/// And so far from its centre line.
const BESIDE_M: f64 = 30.0;

const CALL: Duration = Duration::from_secs(20);
/// Wall-clock time in which a part of the system must do something.
const PATIENCE: Duration = Duration::from_secs(60);

/// A simulated world, gateway, FP Manager, and the test as a ground station and clock participant.
pub struct Rig {
    /// The gateway's process.
    pub gateway: Program,
    /// The FP Manager's process.
    pub fp_manager: Program,
    /// The flight recorder's process, once it is started.
    pub storage: Option<Program>,
    /// What happened.
    pub seen: Seen,
    /// Where it was flown.
    pub track: Track,
    /// What the gateway told of it that was not so; on somebody else's autopilot, which says itself what it does.
    pub doubts: Doubts,
    /// Where it flies.
    pub field: Field,
    world: World,
    places: Places,
    ground: Option<Ground>,
}

/// How time passes.
#[derive(Clone, Copy, PartialEq)]
pub enum Pace {
    /// Tick by tick, when the test says so.
    Lockstep,
    /// By itself, counted from then: an autopilot that knows nothing of us.
    Free(Instant),
}

impl Rig {
    /// Starts everything; further arguments go to the simulator.
    pub async fn start(simulator_arguments: &[&str]) -> anyhow::Result<Self> {
        let home = format!(
            "{},{},{},{}",
            FIELD.threshold.lat_deg, FIELD.threshold.lon_deg, FIELD.elevation_m, FIELD.heading_deg
        );
        let mut arguments = vec!["--tcp", "127.0.0.1:0", "--lockstep", "--speed", "0", "--home", &home];
        arguments.extend(simulator_arguments);
        let logs = Logs::new()?;
        let simulator = Program::start("legwork-sim", &arguments, &logs, "simulator")?;
        let said = simulator.wait_for("listening on tcp ").with_context(|| logs.ends())?;
        Self::assemble(World::Ours(simulator), &format!("tcp:{said}"), Pace::Lockstep, logs).await
    }

    /// Starts the agent on somebody else's autopilot (`tcp:HOST:PORT`, …) in a simulation of its own, around the place where it
    /// stands. `conditions`: of its world, as arguments of our simulator.
    pub async fn attach(autopilot: &str, conditions: &[&str]) -> anyhow::Result<Self> {
        let (world, address) = World::theirs(autopilot, conditions).await?;
        let mut rig = Self::assemble(world, &address, Pace::Free(Instant::now()), Logs::new()?).await?;
        rig.until("a position on the ground, in the world that was asked for", 120.0, |rig, _| {
            rig.attitude().is_some()
                && rig.position().is_some_and(|p| p.on_ground)
                && rig.world.is_as_asked().is_ok_and(|is| is)
        })
        .await?;
        let (position, attitude) = (rig.position().context("position")?, rig.attitude().context("attitude")?);
        rig.field = Field {
            threshold: position.position,
            elevation_m: position.altitude_amsl_m,
            heading_deg: attitude.heading_deg,
        };
        Ok(rig)
    }

    async fn assemble(world: World, autopilot: &str, pace: Pace, logs: Logs) -> anyhow::Result<Self> {
        let places = Places::new(autopilot, pace, logs)?;
        let gateway = places.start_gateway()?;
        let fp_manager = places.start_fp_manager()?;
        let ground = Ground::open(&places.endpoint, pace).await.with_context(|| places.logs.ends())?;
        Ok(Self {
            world,
            gateway,
            fp_manager,
            storage: None,
            seen: Seen::default(),
            track: Track::default(),
            doubts: Doubts::default(),
            field: FIELD,
            places,
            ground: Some(ground),
        })
    }

    /// Puts a plan forward and makes it the active one.
    pub async fn load(&self, xml: &str) -> anyhow::Result<ProposalReport> {
        let report = self.propose(xml).await?;
        ensure!(report.acceptable, "not acceptable: {:?}", report.problems);
        self.command(Command::Commit { hash: report.hash.clone(), entry: None }).await?;
        Ok(report)
    }

    /// Puts a plan forward.
    pub async fn propose(&self, xml: &str) -> anyhow::Result<ProposalReport> {
        let request = Propose { xml: xml.to_owned(), seen_revision: None };
        Ok(self.ground()?.session.call(fp_manager::PROPOSE, &request, CALL).await?)
    }

    /// Gives the FP Manager a command.
    pub async fn command(&self, command: Command) -> anyhow::Result<()> {
        self.ground()?.session.call(fp_manager::COMMAND, &command, CALL).await?;
        Ok(())
    }

    /// What the FP Manager foresees of the rest of the flight.
    pub async fn foresee(&self) -> anyhow::Result<Foresight> {
        Ok(self.ground()?.session.call(fp_manager::FORESEE, &Foresee { command: None }, CALL).await?)
    }

    /// Asks the gateway for something itself.
    pub async fn ask_gateway(&self, request: GatewayRequest) -> anyhow::Result<()> {
        self.ground()?.session.call(gateway::REQUEST, &request, CALL).await?;
        Ok(())
    }

    /// Has the flight ended by force.
    pub async fn terminate(&self) -> anyhow::Result<()> {
        self.ask_gateway(GatewayRequest::Terminate { confirm: processes::VEHICLE.into() }).await
    }

    /// Loads the mission and starts it; comes back when the aircraft is airborne.
    pub async fn fly_mission(&mut self) -> anyhow::Result<()> {
        let mission = self.field.mission(1800.0);
        self.fly(&mission).await
    }

    /// Loads a plan and starts it; comes back when the aircraft is airborne.
    pub async fn fly(&mut self, plan: &str) -> anyhow::Result<()> {
        self.until("the autopilot is there", 60.0, |rig, _| {
            rig.gateway_status().is_some_and(|s| s.state == GatewayState::Stop)
        })
        .await?;
        self.load(plan).await?;
        self.start_off().await?;
        self.until("airborne", 120.0, |rig, _| rig.position().is_some_and(|p| !p.on_ground)).await
    }

    /// An aircraft that the wind has moved or turned on the ground, where its simulation's ground holds nothing, is started a second time:
    /// that is meant.
    async fn start_off(&self) -> anyhow::Result<()> {
        let Err(error) = self.command(Command::Start).await else { return Ok(()) };
        let is_of_its_place = error.downcast_ref::<CallError>().is_some_and(
            |error| matches!(error, CallError::Refused(why) if ["wrong-way", "not-at-the-runway"].contains(&why.code.as_str())),
        );
        match (&self.world, is_of_its_place) {
            (World::Theirs(_), true) => self.command(Command::Start).await,
            _ => Err(error),
        }
    }

    /// Lets time go on, tick by tick, until the condition holds; an error after so many simulated seconds.
    pub async fn until(
        &mut self,
        what: &str,
        limit_s: f64,
        holds: impl Fn(&Rig, &Seen) -> bool,
    ) -> anyhow::Result<()> {
        let mut ends_at = None;
        loop {
            let ground = self.ground.as_mut().context("no ground station")?;
            self.world.is_as_asked()?;
            let next = tokio::time::timeout(PATIENCE, ground.next()).await;
            let Some((time_s, tick)) =
                next.with_context(|| format!("time stands still; waiting for: {what}"))?
            else {
                bail!("the session is closed")
            };
            self.seen.time_s = time_s;
            self.drain();
            self.doubts.compare(time_s, self.told().as_ref(), self.world.heard().as_ref());
            let done = holds(self, &self.seen);
            let late = time_s > *ends_at.get_or_insert(time_s + limit_s);
            if let Some(tick) = tick {
                self.ground()?.acknowledge(tick);
            }
            if done {
                return Ok(());
            }
            ensure!(!late, "not within {limit_s} simulated seconds: {what}\n{}", self.story());
        }
    }

    fn drain(&mut self) {
        let Some(ground) = self.ground.as_mut() else { return };
        while let Some(occurrence) = ground.plan_events.try_recv() {
            if let Occurrence::Event { event, .. } = occurrence {
                self.seen.plan.push(event.value);
            }
        }
        while let Some(occurrence) = ground.gateway_events.try_recv() {
            if let Occurrence::Event { event, .. } = occurrence {
                self.seen.hear(event.time_s, event.value);
            }
        }
        if let Some(ahead) = ground.ahead.latest() {
            self.track.plan(&ahead.stamped.value);
        }
        let to = ground.navigation.latest().and_then(|said| said.stamped.value.current);
        if let Some(position) = ground.position.latest() {
            let position = position.stamped.value;
            self.track.fly(to, position.position, position.ground_speed_mps);
        }
    }

    /// What the gateway tells now.
    fn told(&self) -> Option<Told> {
        let said = self.gateway_said()?;
        let current = self.navigation().and_then(|navigation| navigation.current);
        let waypoint = current.and_then(|token| self.track.place_of(token));
        Some(Told { status: said.value, at_s: said.time_s, waypoint })
    }

    /// The ground station goes away, without a word.
    pub async fn leave(&mut self) -> anyhow::Result<()> {
        let ground = self.ground.take().context("no ground station")?;
        let session = ground.session.clone();
        drop(ground);
        session.close().await;
        Ok(())
    }

    /// A ground station comes (back).
    pub async fn come_back(&mut self) -> anyhow::Result<()> {
        self.seen = Seen::default();
        self.ground = Some(Ground::open(&self.places.endpoint, self.places.pace).await?);
        Ok(())
    }

    /// Starts the FP Manager anew over the state it left.
    pub fn restart_fp_manager(&mut self) -> anyhow::Result<()> {
        self.fp_manager = self.places.start_fp_manager()?;
        Ok(())
    }

    /// Starts the gateway anew over the state it left, at the same place.
    pub fn restart_gateway(&mut self) -> anyhow::Result<()> {
        self.gateway = self.places.start_gateway()?;
        Ok(())
    }

    /// What the gateway has stored is gone.
    pub fn forget_gateway(&self) -> anyhow::Result<()> {
        self.places.forget_gateway()
    }

    /// Starts the flight recorder, which takes no part in the time.
    pub fn start_storage(&mut self, state: &Path) -> anyhow::Result<()> {
        self.storage = Some(self.places.start_storage(state)?);
        Ok(())
    }

    /// Does something to the simulated world, in the words of the simulator's standard input.
    ///
    /// # Errors
    /// They can't be understood, or nobody is there any more who does it.
    pub fn disturb(&mut self, line: &str) -> anyhow::Result<()> {
        self.world.disturb(line)
    }

    /// Waits, without letting time go on, until the flight recorder says so of itself.
    pub async fn recorder_says(
        &mut self,
        what: &str,
        holds: impl Fn(&Recording) -> bool,
    ) -> anyhow::Result<Recording> {
        let recording = &mut self.ground.as_mut().context("no ground station")?.recording;
        let mut last = None;
        let says = async {
            loop {
                let received = recording.changed().await.context("the session is closed")?;
                let said = last.insert(received.stamped.value.clone());
                if holds(said) {
                    return Ok(said.clone());
                }
            }
        };
        let said = tokio::time::timeout(PATIENCE, says).await;
        said.with_context(|| format!("the recorder doesn't say: {what}; but {last:?}"))?
    }

    /// Waits, without letting time go on, until the network knows whether the FP Manager is there.
    pub async fn fp_manager_is_there(&mut self, there: bool) -> anyhow::Result<()> {
        let presence = &mut self.ground.as_mut().context("no ground station")?.presence;
        let known = async {
            while presence.is_alive(topics::FP_MANAGER) != there {
                presence.changed().await.context("the session is closed")?;
            }
            Ok(())
        };
        tokio::time::timeout(PATIENCE, known).await.with_context(|| format!("FP Manager there: {there}"))?
    }

    /// Kills the gateway and starts it anew; comes back with its first status, and the second of that on its own clock.
    pub async fn kill_and_restart_gateway(&mut self) -> anyhow::Result<f64> {
        self.gateway.kill()?;
        let said_s = |rig: &Self| rig.gateway_said().map(|said| said.time_s);
        let last_s = said_s(self);
        // nobody is seen by way of it any more
        self.fp_manager_is_there(false).await?;
        self.restart_gateway()?;
        self.until("the gateway is there again", 60.0, |rig, _| said_s(rig) != last_s).await?;
        said_s(self).context("no status of the gateway")
    }

    /// Lets the frozen FP Manager go on, and waits, without letting time go on, until it says something again: nobody waits
    /// for one who has not answered a tick, and the flight would be far ahead of it.
    pub async fn thaw_fp_manager(&mut self) -> anyhow::Result<()> {
        let status = &mut self.ground.as_mut().context("no ground station")?.status;
        let frozen_s = status.latest().map_or(0.0, |said| said.stamped.time_s);
        self.fp_manager.thaw()?;
        let speaks = async {
            while status.changed().await.context("the session is closed")?.stamped.time_s <= frozen_s {}
            Ok(())
        };
        tokio::time::timeout(PATIENCE, speaks).await.context("the FP Manager does not go on")?
    }

    /// Time goes on when the test says so, not by itself.
    pub fn is_in_lockstep(&self) -> bool {
        self.places.pace == Pace::Lockstep
    }

    fn ground(&self) -> anyhow::Result<&Ground> {
        self.ground.as_ref().context("no ground station")
    }

    /// The FP Manager's latest status.
    pub fn plan_status(&self) -> Option<PlanStatus> {
        Some(self.ground.as_ref()?.status.latest()?.stamped.value.clone())
    }

    /// The gateway's latest status.
    pub fn gateway_status(&self) -> Option<GatewayStatus> {
        Some(self.gateway_said()?.value)
    }

    /// The same, with the second on the gateway's own clock.
    pub fn gateway_said(&self) -> Option<Stamped<GatewayStatus>> {
        Some(self.ground.as_ref()?.state.latest()?.stamped.clone())
    }

    /// The latest second on the gateway's own clock that is known.
    pub fn gateway_s(&self) -> Option<f64> {
        let ground = self.ground.as_ref()?;
        Some(ground.state.latest()?.stamped.time_s.max(ground.position.latest()?.stamped.time_s))
    }

    /// The aircraft's latest position.
    pub fn position(&self) -> Option<Position> {
        Some(self.ground.as_ref()?.position.latest()?.stamped.value)
    }

    /// How it lies in the air.
    pub fn attitude(&self) -> Option<Attitude> {
        Some(self.ground.as_ref()?.attitude.latest()?.stamped.value)
    }

    /// The air that it flies through, and how fast.
    pub fn air(&self) -> Option<Air> {
        Some(self.ground.as_ref()?.air.latest()?.stamped.value)
    }

    /// The buffer.
    pub fn navigation(&self) -> Option<Navigation> {
        Some(self.ground.as_ref()?.navigation.latest()?.stamped.value.clone())
    }

    /// Where things stand, for a failure's message.
    pub fn story(&self) -> String {
        format!(
            "at {:.1} s\nlegs: {:?}\ngateway: {:?}\nstate: {:?}\nplan: {:?}\nnavigation: {:?}",
            self.seen.time_s,
            self.seen.legs(),
            self.seen
                .gateway
                .iter()
                .filter(|e| !matches!(e, GatewayEvent::Progress { .. }))
                .collect::<Vec<_>>(),
            self.gateway_status(),
            self.plan_status(),
            self.navigation(),
        )
    }

    /// What the agent's processes logged last, for a failure's message.
    pub fn log_ends(&self) -> String {
        self.places.logs.ends()
    }

    /// It landed on the runway, not beside it.
    pub fn expect_on_runway(&self) -> anyhow::Result<()> {
        let position = self.position().context("no position")?;
        let (along_m, beside_m) = self.field.along_and_beside_m(position.position);
        println!("it stands {along_m:.0} m along its runway, {beside_m:.0} m beside the centre line");
        let is_on = (-SHORT_M..=RUNWAY_M).contains(&along_m) && beside_m <= BESIDE_M;
        ensure!(is_on, "it stands {along_m:.0} m along the runway, {beside_m:.0} m beside\n{}", self.story());
        Ok(())
    }
}

/// A value of the plan's `number` type.
pub fn number(value: f64) -> usal::contract::VariableValue {
    usal::contract::VariableValue::Number(value)
}

/// An identifier.
pub fn id(text: &str) -> usal::contract::Id {
    usal::contract::Id::new(text)
}
