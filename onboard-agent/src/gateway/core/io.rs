//! What goes into the gateway's core and what comes out of it.

use super::climb_out::ClimbOut;
use crate::gateway::order::{Order, OrderId, Report};
use aircraft::Profile;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use terrain::Terrain;
use usal::Instance;
use usal::contract::{
    Action, Feed, FeedAnswer, GatewayEvent, GatewayRequest, Join, JoinAnswer, SafeParameters, SafeRunway,
    Token, Waypoint,
};

/// What the gateway knows before it starts.
#[derive(Clone)]
pub struct Settings {
    /// The vehicle's name; `Terminate` has to repeat it.
    pub vehicle: String,
    /// The aircraft.
    pub profile: Profile,
    /// The ground, if known.
    pub terrain: Option<Arc<dyn Terrain>>,
    /// It listens where strangers can connect.
    pub exposed: bool,
    /// What it hears is a log that is played: nothing can be commanded.
    pub replay: bool,
}

/// Everything that can happen to the core.
#[derive(Debug, Clone, PartialEq)]
pub enum Input {
    /// Time passed.
    Tick,
    /// From the driver.
    Report(Report),
    /// What must survive a restart is on the disk, or can't be written there.
    Stored(bool),
    /// Somebody floods the port, or no longer does.
    Flooded(bool),
    /// The FP Manager is alive, and flies this plan.
    Heartbeat {
        /// Counts up from the start of its process.
        count: u64,
        /// Hash of the plan.
        plan: Option<String>,
        /// Who sends it, if that is said.
        from: Option<Instance>,
    },
    /// So many messages came in the name of the FP Manager, from others than the one that joined.
    Strangers(u64),
    /// The FP Manager presents itself; who it is, if that is said.
    Join(u64, Join, Option<Instance>),
    /// The FP Manager sends waypoints.
    Feed(u64, Feed, Option<Instance>),
    /// Somebody asks for something.
    Request(u64, GatewayRequest),
}

/// What the core wants done.
#[derive(Debug, Clone, PartialEq)]
pub enum Output {
    /// For the driver.
    Order(OrderId, Order),
    /// For everybody.
    Event(GatewayEvent),
    /// The one answer to an input with this number.
    Answer(u64, Answer),
    /// What must survive a restart has changed: store [`Snapshot`].
    Save,
}

/// The answer to an input that has a number.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// To [`Input::Join`].
    Join(JoinAnswer),
    /// To [`Input::Feed`].
    Feed(FeedAnswer),
    /// To [`Input::Request`]: taken, or why not. What comes of it is seen in the state, once the
    /// autopilot has confirmed it.
    Request(Result<(), String>),
}

/// What the autopilot is meant to do.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Intent {
    /// Whatever it or its pilot likes.
    #[default]
    Nothing,
    /// Fly the list.
    Fly,
    /// Circle.
    Hold,
    /// Follow a direct command.
    Direct,
    /// Go home by its own means: no runway is known to us.
    Return,
}

/// What survives a restart of the gateway.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// The stored runways.
    pub runways: Vec<SafeRunway>,
    /// When Safe mode acts.
    pub safe: SafeParameters,
    /// Highest token accepted in this flight.
    pub highest: Token,
    /// What the autopilot was meant to do.
    pub intent: Intent,
    /// The buffer, the waypoint steered to first.
    pub waypoints: Vec<Waypoint>,
    /// Hash of the plan that was flown.
    pub plan: Option<String>,
    /// What the autopilot called its mode when it was heard last: in another one somebody has switched it since.
    #[serde(default)]
    pub mode: Option<String>,
    /// The flight was ended by force; a restart does not bring it back.
    #[serde(default)]
    pub terminated: bool,
    /// When, seconds since 1970, if that was known.
    #[serde(default)]
    pub terminated_unix_s: Option<i64>,
    /// The alarm of an engine that has failed, or seemed to.
    #[serde(default)]
    pub engine: Option<String>,
    /// What was asked for in the climb, and waits for its end.
    #[serde(default)]
    pub climb_out: ClimbOut,
}

impl Snapshot {
    /// A launch was granted, and the take-off was not flown yet.
    pub fn takes_off(&self) -> bool {
        let begins =
            self.waypoints.first().is_some_and(|first| matches!(first.action, Action::TakeOff { .. }));
        self.intent == Intent::Fly && begins
    }

    /// Of this flight, with what is known now of all that does not belong to a flight; an engine that has failed stays so.
    pub fn with_news(&self, now: Self) -> Self {
        let Self { runways, safe, terminated, terminated_unix_s, engine, .. } = now;
        let engine = engine.or_else(|| self.engine.clone());
        Self { runways, safe, terminated, terminated_unix_s, engine, ..self.clone() }
    }
}
