//! What a service is called and says, as a declaration: its description, its publishing rates and the registry come from it.

use crate::topics::{self, Events, Invocation, Variable};
use crate::{ClockAck, ClockTick, Description, FileManifest, Kind, Primitive, Stamped};
use schemars::{JsonSchema, schema_for};

/// A service's declaration.
#[derive(Debug, Clone, Copy)]
pub struct Spec {
    /// Its name, a key segment.
    pub name: &'static str,
    /// What it does, in a line.
    pub about: &'static str,
    /// What it says, in the order of the contract; `describe` need not be mentioned.
    pub says: &'static [Said],
}

/// How often a variable is published.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rate {
    /// As it is measured.
    Measured,
    /// So often, milliseconds, and when something happened.
    Every {
        /// Period.
        ms: u64,
    },
    /// Whenever it changes; repeated so often, milliseconds.
    Changed {
        /// Period of the repetition.
        repeated_ms: u64,
    },
}

/// Something that a service says.
#[derive(Debug, Clone, Copy)]
pub struct Said {
    /// Which kind.
    pub kind: Kind,
    /// Its name.
    pub name: &'static str,
    /// How often a variable is published; `None` of everything else, and of the simulated clock, which isn't stamped.
    pub rate: Option<Rate>,
    /// How long a variable's value may be believed, seconds.
    pub validity_s: f64,
    schema: fn() -> serde_json::Value,
    request: Option<fn() -> serde_json::Value>,
}

fn schema<T: JsonSchema>() -> serde_json::Value {
    schema_for!(T).to_value()
}

impl Said {
    /// A variable.
    pub const fn variable<T: JsonSchema>(variable: Variable<T>, rate: Rate, validity_s: f64) -> Self {
        let plain = Self::plain(Kind::Variable, variable.name, schema::<Stamped<T>>);
        Self { rate: Some(rate), validity_s, ..plain }
    }

    /// A variable that carries its own time.
    pub const fn unstamped<T: JsonSchema>(variable: Variable<T>) -> Self {
        Self::plain(Kind::Variable, variable.name, schema::<T>)
    }

    /// A stream of events.
    pub const fn events<T: JsonSchema>(events: Events<T>) -> Self {
        Self::plain(Kind::Event, events.name, schema::<T>)
    }

    /// An invocation.
    pub const fn invocation<Q: JsonSchema, A: JsonSchema>(invocation: Invocation<Q, A>) -> Self {
        let plain = Self::plain(Kind::Invocation, invocation.name, schema::<A>);
        Self { request: Some(schema::<Q>), ..plain }
    }

    /// A file.
    pub const fn file(name: &'static str) -> Self {
        Self::plain(Kind::File, name, schema::<FileManifest>)
    }

    const fn plain(kind: Kind, name: &'static str, schema: fn() -> serde_json::Value) -> Self {
        Self { kind, name, rate: None, validity_s: 0.0, schema, request: None }
    }

    /// With its JSON Schemas.
    pub fn describe(&self) -> Primitive {
        Primitive {
            kind: self.kind,
            name: self.name.into(),
            schema: (self.schema)(),
            request: self.request.map(|request| request()),
        }
    }
}

impl Spec {
    /// The service's description, with the JSON Schemas.
    pub fn describe(&self) -> Description {
        let describe = Said::invocation(topics::describe(self.name));
        let primitives = self.says.iter().chain([&describe]).map(Said::describe).collect();
        Description { service: self.name.into(), version: env!("CARGO_PKG_VERSION").into(), primitives }
    }
}

/// The services that this version knows, in the order of the contract.
pub const SERVICES: &[&Spec] = &[&GATEWAY, &FP_MANAGER, &STORAGE];

/// The FCS Gateway. The position's freshness is a matter of a second; the rest may be seen a little longer.
pub const GATEWAY: Spec = {
    use topics::gateway::*;
    const STATES: Rate = Rate::Changed { repeated_ms: 200 };
    Spec {
        name: topics::GATEWAY,
        about: "the FCS Gateway: the autopilot's driver and the network's hub",
        says: &[
            Said::variable(POSITION, Rate::Measured, 1.0),
            Said::variable(ATTITUDE, Rate::Measured, 1.0),
            Said::variable(AIR, Rate::Measured, 3.0),
            Said::variable(GPS, Rate::Measured, 3.0),
            Said::variable(ENGINE, Rate::Measured, 3.0),
            Said::variable(POWER, Rate::Measured, 3.0),
            Said::variable(LINKS, Rate::Changed { repeated_ms: 1000 }, 3.0),
            Said::variable(NAVIGATION, STATES, 3.0),
            Said::variable(STATE, STATES, 3.0),
            Said::unstamped(Variable::<ClockTick>::new(topics::GATEWAY, "clock")),
            Said::events(EVENTS),
            Said::invocation(FEED),
            Said::invocation(JOIN),
            Said::invocation(REQUEST),
        ],
    }
};

/// The FP Manager.
pub const FP_MANAGER: Spec = {
    use topics::fp_manager::*;
    const OFTEN: Rate = Rate::Every { ms: 200 };
    const CHANGED: Rate = Rate::Changed { repeated_ms: 1000 };
    Spec {
        name: topics::FP_MANAGER,
        about: "the FP Manager: it connects to the gateway and flies the plan",
        says: &[
            Said::variable(STATUS, OFTEN, 3.0),
            Said::variable(AHEAD, CHANGED, 3.0),
            Said::variable(VARIABLES, CHANGED, 3.0),
            Said::variable(HEARTBEAT, OFTEN, 3.0),
            Said::variable(PLAN, CHANGED, 3.0),
            Said::unstamped(Variable::<ClockAck>::new(topics::FP_MANAGER, "clock-ack")),
            Said::events(EVENTS),
            Said::invocation(PROPOSE),
            Said::invocation(COMMAND),
            Said::invocation(FORESEE),
            Said::invocation(PLAN_DOCUMENT),
            Said::file(PLAN_FILE),
        ],
    }
};

/// Storage, the flight recorder. Without contents of its own: what it records is what the others say.
pub const STORAGE: Spec = Spec {
    name: topics::STORAGE,
    about: "the flight recorder: everything that is said, as MCAP files",
    says: &[Said::variable(topics::storage::RECORDING, Rate::Changed { repeated_ms: 1000 }, 3.0)],
};
