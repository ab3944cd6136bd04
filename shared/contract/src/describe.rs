//! Self-description: what a service is called, which version it speaks and what it says, with
//! JSON Schemas made from the types. A golden file shows every change of the contract.

use crate::Kind;
use schemars::JsonSchema;
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

#[cfg(test)]
mod tests {
    use crate::Kind;
    use crate::spec::SERVICES;

    #[test]
    fn every_primitive_has_a_schema_and_a_key() {
        for description in SERVICES.iter().map(|service| service.describe()) {
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
