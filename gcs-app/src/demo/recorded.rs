//! What the recording of a flight holds, as far as the report and the judge want it. Pure.

use crate::report::{Happening, TrackPoint};
use flight_exec::Event;
use flight_plan::{FlightPlan, Id, Runway};
use geometry::LatLon;
use recording::Message;
use serde::{Deserialize, Serialize};
use usal::contract::{
    Alarm, FpManagerEvent, GatewayEvent, GatewayState, PlanDocument, Power, Stamped, TimedGatewayEvent,
};
use wire::Convert;

/// The vehicle's name in the demo, part of every key.
pub const VEHICLE: &str = "demo";
/// Key of the places where the aircraft really was.
pub const TRUTH: &str = "legwork/demo/simulator/variable/truth";
/// Key of what the executor tells.
pub const PLAN_EVENTS: &str = "legwork/demo/fp-manager/event/events";
/// Key of what the gateway tells.
pub const GATEWAY_EVENTS: &str = "legwork/demo/gateway/event/events";
/// Key of the energy that is left.
const POWER: &str = "legwork/demo/gateway/variable/power";
/// Key of the plan's document.
const PLAN: &str = "legwork/demo/fp-manager/invocation/plan";

/// Where the aircraft really was.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Truth {
    /// Where.
    pub position: LatLon,
    /// Metres above mean sea level.
    pub altitude_amsl_m: f64,
}

/// What is behind a state of the gateway may be told so much later than the state, seconds.
const TOLD_WITHIN_S: f64 = 5.0;

/// The gateway went to another state.
#[derive(Debug, Clone, PartialEq)]
pub struct Transition {
    /// When, seconds.
    pub time_s: f64,
    /// To which one.
    pub to: GatewayState,
    /// Why, in the gateway's words.
    pub cause: String,
    /// The alarms that were raised then, or hardly later.
    pub alarms: Vec<Alarm>,
}

impl Transition {
    /// Into Safe mode, or worse.
    pub fn is_safe_mode(&self) -> bool {
        use GatewayState::{SafeApproach, SafeHold, SafeLand, SafeReturn, Terminate};
        matches!(self.to, SafeHold | SafeReturn | SafeApproach | SafeLand | Terminate)
    }

    /// For the report.
    pub fn happening(&self) -> Happening {
        let Self { time_s, to, cause, .. } = self;
        Happening {
            time_s: *time_s,
            text: format!("the gateway went to {to:?}: {cause}"),
            important: true,
            details: serde_json::json!({"event": "state-changed", "to": to, "cause": cause}),
        }
    }
}

/// A flight, as it was recorded. Times are seconds.
#[derive(Debug, Default)]
pub struct Recorded {
    /// Where the aircraft really was.
    pub points: Vec<TrackPoint>,
    /// The share of the energy that was left, with its time.
    pub battery: Vec<(f64, f64)>,
    /// What the executor told, with its time.
    pub events: Vec<(f64, Event)>,
    /// The gateway's states, in order.
    pub states: Vec<Transition>,
    /// The alarms that are raised now.
    raised: Vec<Alarm>,
    /// Refused waypoints and patterns, and what was lost.
    pub refusals: Vec<String>,
    /// The plans that were active, each with its hash.
    pub plans: Vec<(Option<String>, FlightPlan)>,
}

impl Recorded {
    /// Takes in a message of the recording. What the report doesn't want is passed over.
    pub fn message(&mut self, message: &Message<'_>) {
        self.take(&message.channel.topic, message.data);
    }

    fn take(&mut self, topic: &str, data: &[u8]) {
        let taken = match topic {
            TRUTH => serde_json::from_slice(data).map(|stamped| self.truth(&stamped)),
            PLAN_EVENTS => serde_json::from_slice(data).map(|stamped| self.plan_event(stamped)),
            GATEWAY_EVENTS => serde_json::from_slice(data).map(|stamped| self.gateway_event(stamped)),
            POWER => serde_json::from_slice(data).map(|stamped| self.power(&stamped)),
            PLAN => serde_json::from_slice(data).map(|document| self.plan(document)),
            _ => return,
        };
        if let Err(error) = taken {
            self.refusals.push(format!("the recording can't be read at a message of {topic}: {error}"));
        }
    }

    fn truth(&mut self, stamped: &Stamped<Truth>) {
        let Truth { position, altitude_amsl_m } = stamped.value;
        self.points.push(TrackPoint { time_s: stamped.time_s, position, altitude_amsl_m });
    }

    fn power(&mut self, stamped: &Stamped<Power>) {
        self.battery.push((stamped.time_s, stamped.value.battery));
    }

    fn plan_event(&mut self, stamped: FpManagerEvent) {
        let event: Event = stamped.value.convert();
        self.refusals.extend(refusal(&event).map(str::to_owned));
        self.events.push((stamped.time_s, event));
    }

    fn gateway_event(&mut self, stamped: TimedGatewayEvent) {
        let time_s = stamped.time_s;
        match stamped.value {
            GatewayEvent::StateChanged { to, cause, .. } => {
                self.states.push(Transition { time_s, to, cause, alarms: self.raised.clone() });
            }
            GatewayEvent::AlarmRaised(alarm) => {
                if let Some(last) = self.states.last_mut().filter(|last| time_s - last.time_s < TOLD_WITHIN_S)
                {
                    last.alarms.push(alarm.clone());
                }
                self.raised.push(alarm);
            }
            GatewayEvent::AlarmCleared { id } => self.raised.retain(|alarm| alarm.id != id),
            _ => {}
        }
    }

    /// A document is repeated at the beginning of each file.
    fn plan(&mut self, document: PlanDocument) {
        if document.info.hash.is_some()
            && self.plans.last().is_none_or(|(hash, _)| *hash != document.info.hash)
        {
            let plan = flight_plan::read(document.xml.as_bytes()).plan;
            self.plans.push((document.info.hash, plan));
        }
    }

    /// Something is missing: what, if its count is more than 0.
    pub fn lost(&mut self, count: u64, what: &str) {
        if count > 0 {
            self.refusals.push(format!("{count} {what}"));
        }
    }

    /// The plan of this hash was flown last: says so if the recording has another one.
    pub fn ends_with(&mut self, hash: &str) {
        if self.plans.last().is_none_or(|(last, _)| last.as_deref() != Some(hash)) {
            self.refusals.push("the recording lacks the plan that was flown last".into());
        }
    }

    /// The runway of an emergency plan, in the plan that was flown last.
    pub fn runway_of(&self, emergency: &Id) -> Option<&Runway> {
        let (_, plan) = self.plans.last()?;
        let emergency = plan.emergency_plans.iter().find(|plan| plan.id == *emergency)?;
        plan.runway(&emergency.runway)
    }

    /// The flight from `started_s` on: times count from there.
    pub fn since(mut self, started_s: f64) -> Self {
        self.points.retain(|p| p.time_s >= started_s);
        self.points.iter_mut().for_each(|p| p.time_s -= started_s);
        self.battery.iter_mut().for_each(|(time_s, _)| *time_s -= started_s);
        self.events.iter_mut().for_each(|(time_s, _)| *time_s -= started_s);
        self.states.iter_mut().for_each(|state| state.time_s -= started_s);
        self
    }
}

/// Why an event says that something of the plan was refused.
pub fn refusal(event: &Event) -> Option<&str> {
    match event {
        Event::WaypointsRejected { reason, .. } | Event::PatternRefused { reason, .. } => Some(reason),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    const SQUARE: &str = include_str!("../../../assets/plans/square.xml");

    fn recorded(messages: &[(&str, Value)]) -> Recorded {
        let mut recorded = Recorded::default();
        messages.iter().for_each(|(topic, value)| recorded.take(topic, value.to_string().as_bytes()));
        recorded
    }

    fn truth(time_s: f64) -> (&'static str, Value) {
        let position = json!({"lat_deg": 36.3, "lon_deg": -84.2});
        (
            TRUTH,
            json!({"time_s": time_s, "validity_s": 1.0, "value": {"position": position, "altitude_amsl_m": 500.0}}),
        )
    }

    fn document(hash: &str) -> (&'static str, Value) {
        (PLAN, json!({"info": {"name": "square", "hash": hash, "revision": 1}, "xml": SQUARE}))
    }

    #[test]
    fn keys_are_the_contracts() {
        for key in [TRUTH, PLAN_EVENTS, GATEWAY_EVENTS, PLAN] {
            assert_eq!(key.parse::<usal::Key>().unwrap().vehicle, VEHICLE);
        }
    }

    #[test]
    fn times_count_from_the_start_of_the_plan() {
        let since = recorded(&[truth(9.5), truth(10.0), truth(10.5)]).since(10.0);
        let times: Vec<f64> = since.points.iter().map(|p| p.time_s).collect();
        assert_eq!(times, [0.0, 0.5]);
        assert_eq!(since.points[0].altitude_amsl_m, 500.0);
    }

    #[test]
    fn states_and_events_are_taken_in_order() {
        let state = |from: &str, to: &str| {
            let value = json!({"event": "state-changed", "from": from, "to": to, "cause": ""});
            (GATEWAY_EVENTS, json!({"time_s": 1.0, "validity_s": 1.0, "value": value}))
        };
        let taken = recorded(&[
            state("stop", "take-off"),
            state("take-off", "nav"),
            ("legwork/demo/a/variable/b", json!(1)),
        ]);
        let states: Vec<GatewayState> = taken.states.iter().map(|state| state.to).collect();
        assert_eq!(states, [GatewayState::TakeOff, GatewayState::Nav]);
        assert!(taken.refusals.is_empty(), "{:?}", taken.refusals);
    }

    #[test]
    fn a_state_has_the_alarms_that_are_raised_then_or_hardly_later() {
        let at = |time_s: f64, value: Value| {
            (GATEWAY_EVENTS, json!({"time_s": time_s, "validity_s": 1.0, "value": value}))
        };
        let raised = |time_s: f64, id: &str| {
            let alarm = json!({"id": id, "severity": "caution", "source": "gateway", "advice": "land", "cause": null});
            let mut event = alarm;
            event["event"] = json!("alarm-raised");
            at(time_s, event)
        };
        let safe = json!({"event": "state-changed", "from": "nav", "to": "safe-hold", "cause": "silent"});
        let taken = recorded(&[
            raised(1.0, "over"),
            at(2.0, json!({"event": "alarm-cleared", "id": "over"})),
            raised(3.0, "before"),
            at(10.0, safe),
            raised(11.0, "soon"),
            raised(40.0, "later"),
        ]);
        let [state] = &taken.since(4.0).states[..] else { panic!() };
        let ids: Vec<&str> = state.alarms.iter().map(|alarm| alarm.id.as_str()).collect();
        assert_eq!((ids, state.cause.as_str(), state.time_s), (vec!["before", "soon"], "silent", 6.0));
    }

    #[test]
    fn document_that_is_repeated_counts_once_and_the_last_must_be_there() {
        let mut taken = recorded(&[document("a"), document("a"), document("b")]);
        assert_eq!(taken.plans.len(), 2);
        taken.ends_with("b");
        assert!(taken.refusals.is_empty(), "{:?}", taken.refusals);
        taken.ends_with("c");
        assert!(taken.refusals[0].contains("flown last"), "{:?}", taken.refusals);
    }

    #[test]
    fn what_is_lost_or_unreadable_is_told() {
        let mut taken = recorded(&[(PLAN_EVENTS, json!({"time_s": 1.0}))]);
        taken.lost(0, "messages were not recorded");
        taken.lost(3, "messages were not recorded");
        assert!(taken.refusals[0].contains(PLAN_EVENTS), "{:?}", taken.refusals);
        assert_eq!(taken.refusals[1], "3 messages were not recorded");
    }
}
