//! What the window follows of a vehicle: whatever the services declare. What has a place of its own in the window is
//! decoded by its type, everything else comes as plain text.

use super::outlet::Outlet;
use super::session::Open;
use super::{Numbered, PlainEvent, PlainValue, Rows, Telemetry};
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
/// What lies deeper in a plain value is left out.
const DEPTH_MAX: usize = 4;

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
    variable!(gateway::LINKS, Telemetry::Links),
    variable!(gateway::NAVIGATION, Telemetry::Navigation),
    variable!(gateway::STATE, |status| Telemetry::Gateway(Box::new(status))),
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
    match way(service, said) {
        Way::Decoded(subscribe) => subscribe(open, outlet),
        Way::PlainVariable => {
            let value = move |value: Stamped<Value>| {
                Telemetry::Plain(PlainValue { service, name, rows: stamped_rows(&value) })
            };
            open.follow(Variable::<Value>::new(service, name), value, outlet)
        }
        Way::PlainEvents => {
            let event = move |Numbered { sequence, event }: Numbered<Value>| {
                let rows = Numbered { sequence, event: stamped_rows(&event) };
                Telemetry::PlainEvent(PlainEvent { service, name, rows })
            };
            open.listen(Events::<Stamped<Value>>::new(service, name), event, outlet)
        }
        Way::OnRequest | Way::Participants => Ok(()),
    }
}

/// How the window gets what a service declares.
#[derive(Debug, Clone, Copy)]
enum Way {
    /// By its type.
    Decoded(Subscribe),
    /// As plain rows.
    PlainVariable,
    /// As plain rows.
    PlainEvents,
    /// It is asked for when it is wanted.
    OnRequest,
    /// Not at all: it is for those who take part in a simulation.
    Participants,
}

fn way(service: &str, said: &Said) -> Way {
    let is_it = |d: &&Decoded| (d.service, d.kind, d.name) == (service, said.kind, said.name);
    match (DECODED.iter().find(is_it), said.kind) {
        (Some(decoded), _) => Way::Decoded(decoded.subscribe),
        (None, Kind::Variable) if said.rate.is_some() => Way::PlainVariable,
        (None, Kind::Variable) => Way::Participants,
        (None, Kind::Event) => Way::PlainEvents,
        (None, _) => Way::OnRequest,
    }
}

fn stamped_rows(stamped: &Stamped<Value>) -> Stamped<Rows> {
    Stamped { time_s: stamped.time_s, validity_s: stamped.validity_s, value: rows(&stamped.value) }
}

/// A value for people: the fields of an object one by one.
fn rows(value: &Value) -> Rows {
    match value {
        Value::Object(fields) => fields
            .iter()
            .take(ROWS_MAX)
            .map(|(name, value)| (cut(name).replace('_', " "), text(value)))
            .collect(),
        other => vec![(String::new(), text(other))],
    }
}

fn text(value: &Value) -> String {
    let mut out = String::new();
    write(value, DEPTH_MAX, &mut out);
    cut(&out)
}

/// Appends a value, but little more of it than is shown: it may be large and deep.
fn write(value: &Value, depth: usize, out: &mut String) {
    match value {
        Value::Null => out.push('–'),
        Value::Bool(yes) => out.push_str(if *yes { "yes" } else { "no" }),
        Value::Number(number) => out.push_str(&number.to_string()),
        Value::String(text) => out.push_str(&cut(text)),
        Value::Array(_) | Value::Object(_) if depth == 0 => out.push('…'),
        Value::Array(items) => list(items, out, |item, out| write(item, depth - 1, out)),
        Value::Object(fields) => list(fields, out, |(name, value), out| {
            out.push_str(&cut(name).replace('_', " "));
            out.push_str(": ");
            write(value, depth - 1, out);
        }),
    }
}

fn list<T>(items: impl IntoIterator<Item = T>, out: &mut String, write: impl Fn(T, &mut String)) {
    out.push('[');
    for (i, item) in items.into_iter().enumerate() {
        if out.len() > 4 * TEXT_MAX {
            break;
        }
        if i > 0 {
            out.push_str(", ");
        }
        write(item, out);
    }
    out.push(']');
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
    fn whatever_a_service_says_of_itself_is_followed() {
        for (spec, said) in SERVICES.iter().flat_map(|spec| spec.says.iter().map(move |said| (spec, said))) {
            let way = way(spec.name, said);
            let expected = match said.kind {
                Kind::Variable if said.rate.is_none() => matches!(way, Way::Participants),
                Kind::Variable => matches!(way, Way::Decoded(_) | Way::PlainVariable),
                Kind::Event => matches!(way, Way::Decoded(_) | Way::PlainEvents),
                _ => matches!(way, Way::OnRequest),
            };
            assert!(expected, "{}/{}: {way:?}", spec.name, said.name);
        }
        let clocks = SERVICES.iter().flat_map(|spec| spec.says).filter(|said| said.rate.is_none());
        let clocks = clocks.filter(|said| said.kind == Kind::Variable).map(|said| said.name);
        assert_eq!(clocks.collect::<Vec<_>>(), ["clock", "clock-ack"], "these alone are not followed");
    }

    #[test]
    fn plain_values_are_rows_of_short_texts() {
        let value = json!({"plan_name": "Fire watch", "active": true, "hash": null, "list": [1, 2], "long": "x".repeat(500)});
        let rows = rows(&value);
        let text_of =
            |name: &str| rows.iter().find(|(n, _)| n == name).map(|(_, text)| text.as_str()).unwrap();
        assert_eq!(text_of("plan name"), "Fire watch");
        assert_eq!((text_of("active"), text_of("hash"), text_of("list")), ("yes", "–", "[1, 2]"));
        assert_eq!(text_of("long").chars().count(), TEXT_MAX + 1);
        let many: serde_json::Map<String, Value> = (0..100).map(|i| (i.to_string(), json!(i))).collect();
        assert_eq!(super::rows(&Value::Object(many)).len(), ROWS_MAX);
        assert_eq!(super::rows(&json!(7)), [(String::new(), "7".to_owned())]);
        assert_eq!(text(&json!({"at": {"known": true, "lat_deg": 1.5}})), "[at: [known: yes, lat deg: 1.5]]");
    }

    #[test]
    fn neither_a_deep_nor_a_large_value_makes_a_long_text() {
        let deep = (0..100).fold(json!(1), |inner, _| json!([inner]));
        assert_eq!(text(&deep), "[[[[…]]]]");
        let large = json!(vec![json!({ "y".repeat(100_000): "x".repeat(100_000) }); 1000]);
        let mut written = String::new();
        write(&large, DEPTH_MAX, &mut written);
        assert!(written.len() < 2000, "{}", written.len());
        assert_eq!(text(&large).chars().count(), TEXT_MAX + 1);
    }
}
