//! Identifiers and values of a plan.

use geodesy::LatLon;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;
use std::fmt;

/// An identifier of the document: letters, digits, `-`, `_`, `.`; unique, stable across edits.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Id(SmolStr);

impl Id {
    /// From its text.
    pub fn new(text: &str) -> Self {
        Self(text.into())
    }

    /// Its text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl From<&str> for Id {
    fn from(text: &str) -> Self {
        Self::new(text)
    }
}

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// A variable's type and initial value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", content = "value", rename_all = "kebab-case")]
pub enum VariableValue {
    /// True or false.
    Bool(bool),
    /// A number, in the variable's unit.
    Number(f64),
    /// Free text.
    Text(String),
    /// A position.
    Position(LatLon),
    /// A simple polygon: its corners, not closed.
    Polygon(Vec<LatLon>),
}
