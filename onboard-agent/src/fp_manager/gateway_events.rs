//! Pure: what is received from the gateway, and what its alarms lead to.

use super::alarms;
use super::manager::{Effect, Manager};
use flight_exec::{Command, Event, Input, Phase, Token};
use service::Time;
use usal::Instance;
use usal::contract::{
    Air, Attitude, GatewayEvent, GatewayRequest, GatewayState, GatewayStatus, Gps, Navigation, Position,
    Power,
};
use wire::Convert;

/// What comes from a gateway.
#[derive(Debug, Clone)]
pub enum Report {
    /// Where the aircraft is.
    Position(Position),
    /// How it flies through the air.
    Air(Air),
    /// How it is turned.
    Attitude(Attitude),
    /// The energy left.
    Power(Power),
    /// The satellites, and their time.
    Gps(Gps),
    /// Its state.
    State(GatewayStatus),
    /// Its buffer and place.
    Navigation(Navigation),
    /// Something happened.
    Event(GatewayEvent),
}

/// Who asks for what an alarm of the gateway leads to.
const GATEWAY: &str = "gateway";

impl Manager {
    /// Something comes from a gateway; only the one that we joined counts.
    pub fn report(&mut self, now: Time, from: Option<Instance>, report: Report, out: &mut Vec<Effect>) {
        if !self.gateway_session.hears(now, from) {
            return self.strangers(1, out);
        }
        match report {
            Report::Position(position) => self.aircraft().position(position),
            Report::Air(air) => self.aircraft().air(air),
            Report::Attitude(attitude) => self.aircraft().attitude(now, attitude),
            Report::Power(power) => self.aircraft().power(power),
            Report::Gps(gps) => gps.unix_s.into_iter().for_each(|unix_s| self.time_of_day(now, unix_s)),
            Report::State(status) => self.gateway_status(now, &status, out),
            Report::Navigation(navigation) => self.navigation(now, &navigation, out),
            Report::Event(event) => self.gateway_event(now, event, out),
        }
    }

    /// So many reports came from others than the gateway that we joined; they do not count. That is told as it goes on, and never
    /// as a flood.
    pub fn strangers(&mut self, count: u64, out: &mut Vec<Effect>) {
        let Some(at_least) = self.gateway_session.strangers(count) else { return };
        tracing::warn!(at_least, "another program than the gateway that we joined reports as it");
        let reason = format!(
            "another program than the gateway that was joined reports as it; it does not count: find it and stop it \
             (reports ignored since the join: at least {at_least})"
        );
        out.push(Effect::Event(Event::NotGranted { request: "report".into(), reason }));
    }

    /// The gateway's buffer and place, as it publishes them.
    pub fn navigation(&mut self, now: Time, navigation: &Navigation, out: &mut Vec<Effect>) {
        if let Some(current) = navigation.current {
            self.progress(now, current.convert(), out);
        }
        if navigation.room > self.feeder.waiting() {
            self.feeder.hurry();
        }
        self.send(now, out);
    }

    /// The gateway's state, as it publishes it.
    pub fn gateway_status(&mut self, now: Time, status: &GatewayStatus, out: &mut Vec<Effect>) {
        let controlled = self.gateway_session.is_controlled();
        if let Some(autopilot) = &status.autopilot {
            self.autopilot = Some(autopilot.clone());
        }
        self.gateway_session.armed(status.armed);
        self.gateway_session.state(now, status.state);
        if !controlled && self.gateway_session.is_controlled() {
            self.feeder.clear();
            self.step(now, Input::GatewayControls(true), out);
        }
        if self.gateway_session.is_airborne() {
            self.feeder.drop_take_back();
        }
        // one that does not know yet what flies has raised nothing, and forgotten nothing
        if status.state != GatewayState::Off {
            self.alarms.all(&status.alarms);
            if self.alarms.no_longer_ask_for_safe(&status.alarms, status.state == GatewayState::Manual) {
                self.gateway_session.unwant(GatewayRequest::Safe);
            }
        }
        if self.gateway_session.is_joined() && self.gateway_session.is_airborne() {
            for call in self.alarms.listed(&status.alarms) {
                self.emergency(now, call, out);
            }
        }
        self.send(now, out);
    }

    /// Something happened at the gateway.
    pub fn gateway_event(&mut self, now: Time, event: GatewayEvent, out: &mut Vec<Effect>) {
        match event {
            GatewayEvent::Progress { current: Some(current), .. } => {
                self.progress(now, current.convert(), out)
            }
            // while waypoints are on their way it is not the end, nor what Safe mode or the pilot flies
            GatewayEvent::Progress { current: None, taken }
                if self.feeder.is_idle()
                    && !self.gateway_session.is_controlled()
                    && !self.is_ahead_of(taken.convert()) =>
            {
                self.step(now, Input::Progress { current: None }, out);
            }
            GatewayEvent::AlarmRaised(alarm) => {
                self.alarms.raised(&alarm);
                if let Some(call) = alarms::call(&alarm) {
                    self.emergency(now, call, out);
                }
            }
            GatewayEvent::AlarmCleared { id } => self.alarms.cleared(&id),
            GatewayEvent::BufferLow { .. } => self.feeder.hurry(),
            GatewayEvent::NotLaunched { reason } => self.not_launched(now, reason, out),
            // it had taken the place of our hold, and the gateway flies the plan
            GatewayEvent::NotDone { .. } if self.executor.status_phase() == Phase::Holding => {
                self.gateway_session.want(GatewayRequest::Hold);
            }
            // brought down by somebody: a join says what became of what is ahead
            GatewayEvent::StateChanged { to: GatewayState::Stop, .. } if self.executor.is_under_way() => {
                self.gateway_session.state(now, GatewayState::Stop);
                self.gateway_session.lost();
            }
            _ => {}
        }
        self.send(now, out);
    }

    /// Waypoints were handed out beyond what the gateway had taken when it spoke.
    fn is_ahead_of(&self, taken: Token) -> bool {
        self.executor.ahead().last().is_some_and(|last| last.token > taken)
    }

    /// An alarm of the gateway asks for an emergency plan. On the ground it has to ask again in the air; while a plan
    /// for something worse is flown, when that is left. If no plan can be flown for it, Safe mode has to do; while the pilot flies, when he
    /// gives the aircraft back.
    fn emergency(&mut self, now: Time, call: alarms::Call, out: &mut Vec<Effect>) {
        if !self.gateway_session.is_airborne() {
            return self.alarms.read_again();
        }
        let cause = call.cause;
        tracing::warn!(?cause, "alarm of the gateway: emergency");
        // laid out before it is known that the engine is out, its plan would be fed twice
        if let Some(state) = self.aircraft_state(now) {
            self.step(now, Input::Aircraft(state), out);
        }
        if let Err(refusal) = self.order(now, Command::Emergency { cause, plan: None }, GATEWAY, out) {
            tracing::warn!(?cause, "no emergency plan flown: {refusal}");
            if refusal.code == "not-more-severe" {
                return;
            }
            if self.gateway_session.is_pilots() || refusal.code == "on-ground" {
                return self.alarms.read_again();
            }
            self.gateway_session.want(GatewayRequest::Safe);
            self.alarms.asks_for_safe(&call);
        }
        self.alarms.answer(call);
    }

    /// The gateway appeared: it has to be joined (again).
    pub fn gateway_appeared(&mut self, now: Time, out: &mut Vec<Effect>) {
        self.gateway_session.lost();
        self.send(now, out);
    }

    /// Events of the gateway are lost for good: what they would have said is settled by a join.
    pub fn events_lost(&mut self, now: Time, missed: u64, out: &mut Vec<Effect>) {
        tracing::warn!(missed, "events of the gateway were lost");
        self.gateway_appeared(now, out);
    }
}
