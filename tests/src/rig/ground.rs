//! The test as a ground station and a participant of the clock.

use super::Pace;
use super::processes::VEHICLE;
use std::time::{Duration, Instant};
use usal::{
    Config, EventSubscriber, Participant, Presence, Session, Start, VariableSubscriber,
    contract::{
        Ahead, Air, Attitude, ClockTick, FpManagerEvent, GatewayStatus, Navigation, PlanStatus, Position,
        Recording, TimedGatewayEvent,
    },
    topics::{fp_manager, gateway, storage},
};

/// With an autopilot that knows nothing of us, the flight is looked at this often.
const LOOK: Duration = Duration::from_millis(50);

/// The test's side of the contract.
pub struct Ground {
    pub session: Session,
    pub clock: Clock,
    pub plan_events: EventSubscriber<FpManagerEvent>,
    pub gateway_events: EventSubscriber<TimedGatewayEvent>,
    pub status: VariableSubscriber<PlanStatus>,
    pub ahead: VariableSubscriber<Ahead>,
    pub state: VariableSubscriber<GatewayStatus>,
    pub position: VariableSubscriber<Position>,
    pub navigation: VariableSubscriber<Navigation>,
    pub attitude: VariableSubscriber<Attitude>,
    pub air: VariableSubscriber<Air>,
    pub recording: VariableSubscriber<Recording>,
    pub presence: Presence,
}

/// What tells the time.
pub enum Clock {
    Lockstep(Participant),
    /// The machine's, counted from then: the autopilot may not be heard.
    Free(Instant, tokio::time::Interval),
}

impl Ground {
    pub async fn open(endpoint: &str, pace: Pace) -> anyhow::Result<Self> {
        let session = Session::open(Config::client(VEHICLE, endpoint).named("operator")).await?;
        Ok(Self {
            plan_events: session.listen(fp_manager::EVENTS, Start::Remembered)?,
            gateway_events: session.listen(gateway::EVENTS, Start::Remembered)?,
            status: session.follow(fp_manager::STATUS)?,
            ahead: session.follow(fp_manager::AHEAD)?,
            state: session.follow(gateway::STATE)?,
            position: session.follow(gateway::POSITION)?,
            navigation: session.follow(gateway::NAVIGATION)?,
            attitude: session.follow(gateway::ATTITUDE)?,
            air: session.follow(gateway::AIR)?,
            recording: session.follow(storage::RECORDING)?,
            presence: session.presence()?,
            clock: match pace {
                Pace::Lockstep => Clock::Lockstep(Participant::join(&session, "test")?),
                Pace::Free(since) => Clock::Free(since, tokio::time::interval(LOOK)),
            },
            session,
        })
    }

    /// Waits until time has gone on, and gives it; in lockstep with the tick to be acknowledged.
    pub async fn next(&mut self) -> Option<(f64, Option<ClockTick>)> {
        match &mut self.clock {
            Clock::Lockstep(clock) => clock.next().await.map(|tick| (tick.time_s, Some(tick))),
            Clock::Free(since, look) => {
                look.tick().await;
                Some((since.elapsed().as_secs_f64(), None))
            }
        }
    }

    /// The work for this instant is done.
    pub fn acknowledge(&self, tick: ClockTick) {
        if let Clock::Lockstep(clock) = &self.clock {
            clock.acknowledge(tick);
        }
    }
}
