//! Shell: the gateway's variables and events on the network.

use super::core::{Gateway, Timed};
use super::order::Time;
use serde::Serialize;
use std::time::Duration;
use usal::contract::{
    Air, Attitude, Engine, GatewayEvent, GatewayState, GatewayStatus, Gps, Navigation, Position, Power,
    Stamped, TimedGatewayEvent, Token,
};
use usal::topics::{Variable, gateway};
use usal::{EventPublisher, Session, SessionError, VariablePublisher};

/// How long a value may be believed, seconds: the position's freshness is a matter of a second,
/// the rest may be seen a little longer.
const POSITION_VALIDITY_S: f64 = 1.0;
const VALIDITY_S: f64 = 3.0;
/// State and navigation are told at least so often.
const PERIOD: Duration = Duration::from_millis(200);

/// A telemetry value and the time of what was last published.
struct Telemetered<T> {
    publisher: VariablePublisher<T>,
    told: Option<Time>,
}

impl<T: Serialize> Telemetered<T> {
    fn new(session: &Session, variable: Variable<T>) -> Result<Self, SessionError> {
        Ok(Self { publisher: session.publish(variable)?, told: None })
    }

    /// Publishes a value that is newer than the last, unless it comes sooner than `spacing`.
    fn tell(&mut self, value: Timed<T>, validity_s: f64, spacing: Duration) {
        let Some((time, value)) = value else { return };
        let due = self.told.is_none_or(|told| time > told && time.saturating_sub(told) >= spacing);
        if due {
            self.told = Some(time);
            self.publisher.set(time.as_secs_f64(), validity_s, &value);
        }
    }
}

/// All that the gateway says.
pub struct Publishers {
    position: Telemetered<Position>,
    attitude: Telemetered<Attitude>,
    air: Telemetered<Air>,
    gps: Telemetered<Gps>,
    engine: Telemetered<Engine>,
    power: Telemetered<Power>,
    navigation: VariablePublisher<Navigation>,
    state: VariablePublisher<GatewayStatus>,
    events: EventPublisher<TimedGatewayEvent>,
    spacing: Duration,
    told_at: Option<Time>,
    told: Option<(Option<Token>, GatewayState, bool, usize)>,
}

impl Publishers {
    /// Declares everything. `spacing`: telemetry comes no closer than this.
    ///
    /// # Errors
    /// If the session is closed.
    pub fn new(session: &Session, spacing: Duration) -> Result<Self, SessionError> {
        Ok(Self {
            position: Telemetered::new(session, gateway::POSITION)?,
            attitude: Telemetered::new(session, gateway::ATTITUDE)?,
            air: Telemetered::new(session, gateway::AIR)?,
            gps: Telemetered::new(session, gateway::GPS)?,
            engine: Telemetered::new(session, gateway::ENGINE)?,
            power: Telemetered::new(session, gateway::POWER)?,
            navigation: session.publish(gateway::NAVIGATION)?,
            state: session.publish(gateway::STATE)?,
            events: session.emitter(gateway::EVENTS)?,
            spacing,
            told_at: None,
            told: None,
        })
    }

    /// Publishes events, what is new of telemetry, and state and navigation when they changed or
    /// are due.
    pub fn tell(&mut self, now: Time, gateway: &Gateway, events: Vec<GatewayEvent>) {
        for event in events {
            tracing::info!(?event, time_s = now.as_secs_f64(), "event");
            self.events.emit(&Stamped { time_s: now.as_secs_f64(), validity_s: VALIDITY_S, value: event });
        }
        self.tell_telemetry(gateway);
        self.tell_conduct(now, gateway);
    }

    fn tell_telemetry(&mut self, gateway: &Gateway) {
        let (t, spacing) = (gateway.telemetry(), self.spacing);
        self.position.tell(t.position(), POSITION_VALIDITY_S, spacing);
        self.attitude.tell(t.attitude, POSITION_VALIDITY_S, spacing);
        self.air.tell(t.air, VALIDITY_S, spacing);
        self.gps.tell(t.gps, VALIDITY_S, spacing);
        self.engine.tell(t.engine, VALIDITY_S, spacing);
        self.power.tell(t.power, VALIDITY_S, spacing);
    }

    fn tell_conduct(&mut self, now: Time, gateway: &Gateway) {
        let conduct = Some(gateway.conduct());
        let due = self.told_at.is_none_or(|at| now.saturating_sub(at) >= PERIOD);
        if !due && conduct == self.told {
            return;
        }
        self.told = conduct;
        self.told_at = Some(now);
        let time_s = now.as_secs_f64();
        self.navigation.set(time_s, VALIDITY_S, &gateway.navigation());
        self.state.set(time_s, VALIDITY_S, &gateway.status(now));
    }
}
