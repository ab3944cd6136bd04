//! What the window follows of a vehicle: whatever the services declare. What has a place of its own in the window is
//! decoded by its type, everything else comes as plain text.

use super::session::{Open, Outlet};
use super::{Numbered, PlainValue, Rows, Telemetry};
use serde_json::Value;
use usal::SessionError;
use usal::contract::{Kind, PlanEvent, Stamped};
use usal::spec::Said;
use usal::topics::{Events, Variable, fp_manager, gateway, storage};
use wire::Convert;

/// Longest text of a plain value, characters.
const TEXT_MAX: usize = 120;
/// Rows of a plain value.
const ROWS_MAX: usize = 24;

type Subscribe = fn(&mut Open, &Outlet) -> Result<(), SessionError>;

/// A variable or a stream of events that has a type of its own here.
struct Decoded {
    service: &'static str,
    kind: Kind,
    name: &'static str,
    subscribe: Subscribe,
}

macro_rules! variable {
    ($topic:expr, $into:expr) => {
        Decoded {
            service: $topic.service,
            kind: Kind::Variable,
            name: $topic.name,
            subscribe: |open, outlet| open.follow($topic, $into, outlet),
        }
    };
}

macro_rules! events {
    ($topic:expr, $into:expr) => {
        Decoded {
            service: $topic.service,
            kind: Kind::Event,
            name: $topic.name,
            subscribe: |open, outlet| open.listen($topic, $into, outlet),
        }
    };
}

const DECODED: &[Decoded] = &[
    variable!(gateway::POSITION, Telemetry::Position),
    variable!(gateway::ATTITUDE, Telemetry::Attitude),
    variable!(gateway::AIR, Telemetry::Air),
    variable!(gateway::GPS, Telemetry::Gps),
    variable!(gateway::ENGINE, Telemetry::Engine),
    variable!(gateway::POWER, Telemetry::Power),
    variable!(gateway::NAVIGATION, Telemetry::Navigation),
    variable!(gateway::STATE, Telemetry::Gateway),
    events!(gateway::EVENTS, Telemetry::GatewayEvent),
    variable!(fp_manager::STATUS, |status| Telemetry::Status(Box::new(status.convert()))),
    variable!(fp_manager::AHEAD, Telemetry::Ahead),
    variable!(fp_manager::VARIABLES, Telemetry::Variables),
    events!(fp_manager::EVENTS, plan_event),
    variable!(storage::RECORDING, Telemetry::Recording),
];

fn plan_event(Numbered { sequence, event }: Numbered<PlanEvent>) -> Telemetry {
    Telemetry::PlanEvent(Numbered { sequence, event: event.convert() })
}

/// Follows something that a service declares. Requests and files are asked for when they are wanted; the clock of a
/// simulation, which has no time of its own, is for those who take part in it.
///
/// # Errors
/// The session is closed.
pub(super) fn subscribe(
    open: &mut Open,
    service: &'static str,
    said: &Said,
    outlet: &Outlet,
) -> Result<(), SessionError> {
    let name = said.name;
    if let Some(decoded) = decoded(service, said.kind, name) {
        return (decoded.subscribe)(open, outlet);
    }
    match said.kind {
        Kind::Variable if said.rate.is_some() => {
            let value = move |value: Stamped<Value>| Telemetry::Plain(PlainValue::new(service, name, &value));
            open.follow(Variable::<Value>::new(service, name), value, outlet)
        }
        Kind::Event => {
            let event =
                move |event: Numbered<Value>| Telemetry::Plain(PlainValue::new(service, name, &event.event));
            open.listen(Events::<Stamped<Value>>::new(service, name), event, outlet)
        }
        _ => Ok(()),
    }
}

fn decoded(service: &str, kind: Kind, name: &str) -> Option<&'static Decoded> {
    DECODED.iter().find(|d| (d.service, d.kind, d.name) == (service, kind, name))
}

impl PlainValue {
    fn new(service: &'static str, name: &'static str, stamped: &Stamped<Value>) -> Self {
        let Stamped { time_s, validity_s, value } = stamped;
        Self { service, name, rows: Stamped { time_s: *time_s, validity_s: *validity_s, value: rows(value) } }
    }
}

/// A value for people: the fields of an object one by one.
fn rows(value: &Value) -> Rows {
    match value {
        Value::Object(fields) => fields
            .iter()
            .take(ROWS_MAX)
            .map(|(name, value)| (cut(&name.replace('_', " ")), text(value)))
            .collect(),
        other => vec![(String::new(), text(other))],
    }
}

fn text(value: &Value) -> String {
    match value {
        Value::Null => "–".into(),
        Value::Bool(yes) => if *yes { "yes" } else { "no" }.into(),
        Value::String(text) => cut(text),
        other => cut(&other.to_string()),
    }
}

fn cut(text: &str) -> String {
    let mut shown: String = text.chars().filter(|c| !c.is_control()).take(TEXT_MAX).collect();
    if text.chars().nth(TEXT_MAX).is_some() {
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use usal::spec::SERVICES;

    #[test]
    fn what_is_decoded_is_declared() {
        for decoded in DECODED {
            let spec = SERVICES.iter().find(|spec| spec.name == decoded.service).unwrap();
            let declared =
                spec.says.iter().any(|said| (said.kind, said.name) == (decoded.kind, decoded.name));
            assert!(declared, "{}/{} is said by nobody", decoded.service, decoded.name);
        }
    }

    #[test]
    fn plain_values_are_rows_of_short_texts() {
        let value = json!({"plan_name": "Fire watch", "active": true, "hash": null, "list": [1, 2], "long": "x".repeat(500)});
        let rows = rows(&value);
        let text_of =
            |name: &str| rows.iter().find(|(n, _)| n == name).map(|(_, text)| text.as_str()).unwrap();
        assert_eq!(text_of("plan name"), "Fire watch");
        assert_eq!((text_of("active"), text_of("hash"), text_of("list")), ("yes", "–", "[1,2]"));
        assert_eq!(text_of("long").chars().count(), TEXT_MAX + 1);
        let many: serde_json::Map<String, Value> = (0..100).map(|i| (i.to_string(), json!(i))).collect();
        assert_eq!(super::rows(&Value::Object(many)).len(), ROWS_MAX);
        assert_eq!(super::rows(&json!(7)), [(String::new(), "7".to_owned())]);
    }
}
