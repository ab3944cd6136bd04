//! Alarms, and the emergencies that they stand for.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How bad an alarm is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// For information.
    Advisory,
    /// Needs attention soon.
    Caution,
    /// Needs action now.
    Warning,
}

/// An alarm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Alarm {
    /// Stable identifier: `gps-lost`, `engine-out`, `energy-low`, `autopilot-silent`, …
    pub id: String,
    /// How bad.
    pub severity: Severity,
    /// Who raised it.
    pub source: String,
    /// What to do.
    pub advice: String,
    /// The emergency cause it stands for, if any.
    pub cause: Option<Cause>,
}

/// Why an emergency was raised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// Operator's decision, no other cause known. The least severe.
    Operator,
    /// A payload failed.
    Payload,
    /// Traffic conflict.
    Traffic,
    /// Ground link lost.
    Link,
    /// Position no longer known.
    Gps,
    /// Fuel or battery too low for the plan.
    Energy,
    /// Engine failure. The most severe.
    Engine,
}
