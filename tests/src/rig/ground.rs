//! The test as a ground station and a participant of the clock.

use super::Pace;
use super::processes::VEHICLE;
use usal::{
    Config, EventSubscriber, Participant, Presence, Session, Start, VariableSubscriber,
    contract::{
        Attitude, ClockTick, FpManagerEvent, GatewayStatus, Navigation, PlanStatus, Position, Recording,
        TimedGatewayEvent,
    },
    topics::{fp_manager, gateway, storage},
};

/// The test's side of the contract.
pub struct Ground {
    pub session: Session,
    pub clock: Option<Participant>,
    pub plan_events: EventSubscriber<FpManagerEvent>,
    pub gateway_events: EventSubscriber<TimedGatewayEvent>,
    pub status: VariableSubscriber<PlanStatus>,
    pub state: VariableSubscriber<GatewayStatus>,
    pub position: VariableSubscriber<Position>,
    pub navigation: VariableSubscriber<Navigation>,
    pub attitude: VariableSubscriber<Attitude>,
    pub recording: VariableSubscriber<Recording>,
    pub presence: Presence,
}

impl Ground {
    pub async fn open(endpoint: &str, pace: Pace) -> anyhow::Result<Self> {
        let session = Session::open(Config::client(VEHICLE, endpoint).named("operator")).await?;
        Ok(Self {
            plan_events: session.listen(fp_manager::EVENTS, Start::Remembered)?,
            gateway_events: session.listen(gateway::EVENTS, Start::Remembered)?,
            status: session.follow(fp_manager::STATUS)?,
            state: session.follow(gateway::STATE)?,
            position: session.follow(gateway::POSITION)?,
            navigation: session.follow(gateway::NAVIGATION)?,
            attitude: session.follow(gateway::ATTITUDE)?,
            recording: session.follow(storage::RECORDING)?,
            presence: session.presence()?,
            clock: match pace {
                Pace::Lockstep => Some(Participant::join(&session, "test")?),
                Pace::Free => None,
            },
            session,
        })
    }

    /// Waits until time has gone on, and gives it; in lockstep with the tick to be acknowledged.
    pub async fn next(&mut self) -> Option<(f64, Option<ClockTick>)> {
        match &mut self.clock {
            Some(clock) => clock.next().await.map(|tick| (tick.time_s, Some(tick))),
            None => self.position.changed().await.map(|position| (position.stamped.time_s, None)),
        }
    }
}
