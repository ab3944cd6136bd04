//! Everything that may be said, with its type. What is not here is not part of the contract.

use crate::{Description, Empty};
use std::marker::PhantomData;

/// The FCS Gateway's name.
pub const GATEWAY: &str = "gateway";
/// The FP Manager's name.
pub const FP_MANAGER: &str = "fp-manager";
/// The flight recorder's name.
pub const STORAGE: &str = "storage";

/// A variable: `Stamped<T>` on the wire.
pub struct Variable<T> {
    /// Whose.
    pub service: &'static str,
    /// Its name.
    pub name: &'static str,
    payload: PhantomData<fn() -> T>,
}

/// A stream of events.
pub struct Events<T> {
    /// Whose.
    pub service: &'static str,
    /// Its name.
    pub name: &'static str,
    payload: PhantomData<fn() -> T>,
}

/// An invocation with request `Q` and answer `A`.
pub struct Invocation<Q, A> {
    /// Who serves it.
    pub service: &'static str,
    /// Its name.
    pub name: &'static str,
    /// It changes nothing: anybody may ask, also who does not say a name.
    pub reads_only: bool,
    payload: PhantomData<fn(Q) -> A>,
}

impl<Q, A> Invocation<Q, A> {
    /// Of a service, by name. It changes something: who asks has to say a name.
    pub const fn new(service: &'static str, name: &'static str) -> Self {
        Self { service, name, reads_only: false, payload: PhantomData }
    }

    /// Of a service, by name. It changes nothing: anybody may ask.
    pub const fn reading(service: &'static str, name: &'static str) -> Self {
        Self { service, name, reads_only: true, payload: PhantomData }
    }
}

macro_rules! copyable {
    ($type:ident<$($parameter:ident),+>) => {
        impl<$($parameter),+> Clone for $type<$($parameter),+> {
            fn clone(&self) -> Self {
                *self
            }
        }
        impl<$($parameter),+> Copy for $type<$($parameter),+> {}
    };
}
copyable!(Variable<T>);
copyable!(Events<T>);
copyable!(Invocation<Q, A>);

impl<T> Variable<T> {
    /// Of a service, by name.
    pub const fn new(service: &'static str, name: &'static str) -> Self {
        Self { service, name, payload: PhantomData }
    }
}

impl<T> Events<T> {
    /// Of a service, by name.
    pub const fn new(service: &'static str, name: &'static str) -> Self {
        Self { service, name, payload: PhantomData }
    }
}

/// What a service is and can.
pub const fn describe(service: &'static str) -> Invocation<Empty, Description> {
    Invocation::reading(service, "describe")
}

/// The FCS Gateway.
pub mod gateway {
    use super::{Events, GATEWAY, Invocation, Variable};
    use crate::{
        Air, Attitude, AutopilotLinks, Empty, Engine, Feed, FeedAnswer, GatewayRequest, GatewayStatus, Gps,
        Join, JoinAnswer, Navigation, Position, Power, TimedGatewayEvent,
    };

    /// Where the aircraft is.
    pub const POSITION: Variable<Position> = Variable::new(GATEWAY, "position");
    /// How it lies in the air.
    pub const ATTITUDE: Variable<Attitude> = Variable::new(GATEWAY, "attitude");
    /// Airspeed and wind.
    pub const AIR: Variable<Air> = Variable::new(GATEWAY, "air");
    /// Quality of the position.
    pub const GPS: Variable<Gps> = Variable::new(GATEWAY, "gps");
    /// The engine.
    pub const ENGINE: Variable<Engine> = Variable::new(GATEWAY, "engine");
    /// The battery.
    pub const POWER: Variable<Power> = Variable::new(GATEWAY, "power");
    /// How the links to the autopilot do.
    pub const LINKS: Variable<AutopilotLinks> = Variable::new(GATEWAY, "links");
    /// Where it is steering to, and the waypoint buffer.
    pub const NAVIGATION: Variable<Navigation> = Variable::new(GATEWAY, "navigation");
    /// What the gateway is doing.
    pub const STATE: Variable<GatewayStatus> = Variable::new(GATEWAY, "state");

    /// What happened.
    pub const EVENTS: Events<TimedGatewayEvent> = Events::new(GATEWAY, "events");

    /// Waypoints for the buffer.
    pub const FEED: Invocation<Feed, FeedAnswer> = Invocation::new(GATEWAY, "feed");
    /// The FP Manager presents itself.
    pub const JOIN: Invocation<Join, JoinAnswer> = Invocation::new(GATEWAY, "join");
    /// What people and services may ask of it.
    pub const REQUEST: Invocation<GatewayRequest, Empty> = Invocation::new(GATEWAY, "request");
}

/// The flight recorder.
pub mod storage {
    use super::{STORAGE, Variable};
    use crate::Recording;

    /// How the recording goes.
    pub const RECORDING: Variable<Recording> = Variable::new(STORAGE, "recording");
}

/// The FP Manager.
pub mod fp_manager {
    use super::{Events, FP_MANAGER, Invocation, Variable};
    use crate::{
        Ahead, Command, Empty, Foresee, Foresight, FpManagerEvent, Heartbeat, PlanDocument, PlanInfo,
        PlanStatus, PlanVariables, ProposalReport, Propose,
    };

    /// What the executor is doing, and where.
    pub const STATUS: Variable<PlanStatus> = Variable::new(FP_MANAGER, "status");
    /// The waypoints to be flown next.
    pub const AHEAD: Variable<Ahead> = Variable::new(FP_MANAGER, "ahead");
    /// The plan's variables.
    pub const VARIABLES: Variable<PlanVariables> = Variable::new(FP_MANAGER, "variables");
    /// Sign of life for the gateway.
    pub const HEARTBEAT: Variable<Heartbeat> = Variable::new(FP_MANAGER, "heartbeat");
    /// Which plan is active.
    pub const PLAN: Variable<PlanInfo> = Variable::new(FP_MANAGER, "plan");

    /// What happened.
    pub const EVENTS: Events<FpManagerEvent> = Events::new(FP_MANAGER, "events");

    /// Puts a plan forward; `Command::Commit` makes it the active one.
    pub const PROPOSE: Invocation<Propose, ProposalReport> = Invocation::new(FP_MANAGER, "propose");
    /// What people and services may ask of the executor.
    pub const COMMAND: Invocation<Command, Empty> = Invocation::new(FP_MANAGER, "command");
    /// What would follow a command, or follows without one.
    pub const FORESEE: Invocation<Foresee, Foresight> = Invocation::reading(FP_MANAGER, "foresee");
    /// The active plan's document.
    pub const PLAN_DOCUMENT: Invocation<Empty, PlanDocument> = Invocation::reading(FP_MANAGER, "plan");
    /// File: the active plan's canonical XML; its hash is the plan's.
    pub const PLAN_FILE: &str = "plan";
}
