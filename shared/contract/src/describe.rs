//! Self-description: what a service is called, which version it speaks and what it says, with
//! JSON Schemas made from the types. A golden file shows every change of the contract.

use crate::topics::{self, Events, FP_MANAGER, GATEWAY, Invocation, Variable};
use crate::{ClockAck, ClockTick, FileManifest, Kind, Stamped};
use schemars::{JsonSchema, schema_for};
use serde::{Deserialize, Serialize};

/// What a service is and can.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Description {
    /// Its name.
    pub service: String,
    /// Version of the program, semantic; the contract is compatible within a major version.
    pub version: String,
    /// What it says, in the order of the contract.
    pub primitives: Vec<Primitive>,
}

/// A variable, a stream of events, an invocation or a file. Angles in degrees and SI units; units are
/// part of the field names.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Primitive {
    /// Which kind.
    pub kind: Kind,
    /// Its name.
    pub name: String,
    /// JSON Schema of a variable's or event's payload, of an invocation's answer, or
    /// of a file's manifest.
    pub schema: serde_json::Value,
    /// JSON Schema of an invocation's request.
    pub request: Option<serde_json::Value>,
}

impl Primitive {
    fn variable<T: JsonSchema>(variable: Variable<T>) -> Self {
        Self::plain(Kind::Variable, variable.name, schema::<Stamped<T>>())
    }

    fn events<T: JsonSchema>(events: Events<T>) -> Self {
        Self::plain(Kind::Event, events.name, schema::<T>())
    }

    fn invocation<Q: JsonSchema, A: JsonSchema>(invocation: Invocation<Q, A>) -> Self {
        Self { request: Some(schema::<Q>()), ..Self::plain(Kind::Invocation, invocation.name, schema::<A>()) }
    }

    fn file(name: &str) -> Self {
        Self::plain(Kind::File, name, schema::<FileManifest>())
    }

    fn plain(kind: Kind, name: &str, schema: serde_json::Value) -> Self {
        Self { kind, name: name.into(), schema, request: None }
    }
}

fn schema<T: JsonSchema>() -> serde_json::Value {
    schema_for!(T).to_value()
}

fn description(service: &str, primitives: Vec<Primitive>) -> Description {
    Description { service: service.into(), version: env!("CARGO_PKG_VERSION").into(), primitives }
}

/// The FCS Gateway's description.
pub fn gateway_description() -> Description {
    use topics::gateway::*;
    let primitives = vec![
        Primitive::variable(POSITION),
        Primitive::variable(ATTITUDE),
        Primitive::variable(AIR),
        Primitive::variable(GPS),
        Primitive::variable(ENGINE),
        Primitive::variable(POWER),
        Primitive::variable(NAVIGATION),
        Primitive::variable(STATE),
        // carries its own time and is not stamped
        Primitive::plain(Kind::Variable, "clock", schema::<ClockTick>()),
        Primitive::events(EVENTS),
        Primitive::invocation(FEED),
        Primitive::invocation(JOIN),
        Primitive::invocation(REQUEST),
        Primitive::invocation(topics::describe(GATEWAY)),
    ];
    description(GATEWAY, primitives)
}

/// The FP Manager's description.
pub fn fp_manager_description() -> Description {
    use topics::fp_manager::*;
    let primitives = vec![
        Primitive::variable(STATUS),
        Primitive::variable(AHEAD),
        Primitive::variable(VARIABLES),
        Primitive::variable(HEARTBEAT),
        Primitive::variable(PLAN),
        Primitive::plain(Kind::Variable, "clock-ack", schema::<ClockAck>()),
        Primitive::events(EVENTS),
        Primitive::invocation(PROPOSE),
        Primitive::invocation(COMMAND),
        Primitive::invocation(PLAN_DOCUMENT),
        Primitive::file(PLAN_FILE),
        Primitive::invocation(topics::describe(FP_MANAGER)),
    ];
    description(FP_MANAGER, primitives)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_primitive_has_a_schema_and_a_key() {
        for description in [gateway_description(), fp_manager_description()] {
            for primitive in &description.primitives {
                crate::Key::new("uav1", &description.service, primitive.kind, &primitive.name).unwrap();
                assert!(primitive.schema.is_object(), "{}", primitive.name);
                assert_eq!(
                    primitive.request.is_some(),
                    primitive.kind == Kind::Invocation,
                    "{}",
                    primitive.name
                );
            }
        }
    }
}
