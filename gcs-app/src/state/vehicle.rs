//! One vehicle: what is known of it, and how old that is.

mod alarms;
mod asking;
mod receiving;

pub use alarms::{LINK_CAUTION_S, LINK_WARNING_S};

use super::watch::Watch;
use super::{
    Aged, Circle, Circling, Log, Losses, Names, Outlook, RecentEvents, Repeats, Requests, Strangers, Told,
    Trail, Unanswered, WhySafe,
};
use crate::link::{LinkId, LinkState, Rows};
use aircraft::Autopilot;
use flight_exec::{Phase, ProposalReport, Status};
use flight_plan::{Cause, EmergencyPlan, FlightPlan, Id};
use geometry::LatLon;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;
use usal::contract::{
    Ahead, Air, Attitude, AutopilotLinks, Engine, GatewayStatus, Gps, Navigation, PlanVariables, Position,
    Power, Recording,
};
use wire::Convert;

/// A vehicle's name: what everything known of it is kept under.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VehicleName(Arc<str>);

impl VehicleName {
    /// As text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl From<&str> for VehicleName {
    fn from(name: &str) -> Self {
        Self(name.into())
    }
}

impl std::fmt::Display for VehicleName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

/// A vehicle, as far as the ground station knows it.
#[derive(Debug, Default)]
pub struct Vehicle {
    /// The way to it.
    pub link: LinkState,
    /// Which link that is; older ones are closed, and what still comes from them is not listened to.
    link_id: Option<LinkId>,
    /// When anything was received from it last, seconds of the window's clock.
    pub received_s: Option<f64>,
    /// Where it is.
    pub position: Option<Aged<Position>>,
    /// Which way up it is.
    pub attitude: Option<Aged<Attitude>>,
    /// The air around it.
    pub air: Option<Aged<Air>>,
    /// Satellites.
    pub gps: Option<Aged<Gps>>,
    /// Engine.
    pub engine: Option<Aged<Engine>>,
    /// Battery.
    pub power: Option<Aged<Power>>,
    /// How the links between its gateway and its autopilot do.
    pub links: Option<Aged<AutopilotLinks>>,
    /// Where it is going.
    pub navigation: Option<Aged<Navigation>>,
    /// What the gateway is doing.
    pub gateway: Option<Aged<GatewayStatus>>,
    /// What the FP Manager is doing.
    pub status: Option<Aged<Status>>,
    /// Waypoints handed out and not flown.
    pub ahead: Option<Aged<Ahead>>,
    /// Values of the plan's variables.
    pub variables: Option<Aged<PlanVariables>>,
    /// How the flight recorder does.
    pub recording: Option<Aged<Recording>>,
    /// The services that are there.
    pub services: Arc<BTreeSet<String>>,
    /// What else they say, by service and name.
    pub plain: BTreeMap<(&'static str, &'static str), Aged<Rows>>,
    /// Their events of that kind, by service and name.
    pub plain_events: BTreeMap<(&'static str, &'static str), RecentEvents>,
    /// The active plan.
    pub aboard: Option<ActivePlan>,
    /// How the plan that was put forward last differs from the one aboard then.
    pub put_forward: Vec<flight_plan::Change>,
    /// What the last proposal would do, until committed or dropped.
    pub proposal: Option<Proposal>,
    /// What is to come.
    pub outlook: Outlook,
    /// Where it has been.
    pub trail: Trail,
    /// The circle in which it is held.
    pub circling: Circling,
    /// Commands on their way, and their answers.
    pub requests: Requests,
    /// What happened.
    pub log: Log,
    /// What happened that nobody must miss and nobody has put aside yet, oldest first.
    pub unread: VecDeque<String>,
    /// What was announced of its glide last.
    said_of_glide: Option<String>,
    /// The emergency that was raised last.
    pub raised: Option<Raised>,
    /// How long there was for the decision that is asked for when it was asked, seconds.
    pub decision_s: f64,
    /// The emergency plan with which the flight ended, instead of the main plan.
    pub ended_in: Option<Id>,
    /// Where it stood when the flight had ended: afterwards it is carried away.
    pub ended_at: Option<LatLon>,
    /// What was lost of its messages.
    pub losses: Losses,
    /// What others said in its name.
    pub strangers: Strangers,
    /// What this ground station watches by itself.
    pub watch: Watch,
    /// Why its gateway's Safe mode leads it.
    pub why_safe: WhySafe,
    plan_events: Repeats,
    gateway_events: Repeats,
    asked_aboard_s: Option<f64>,
    was_silent: bool,
}

/// A plan the FP Manager flies.
#[derive(Debug, Clone)]
pub struct ActivePlan {
    /// Its hash.
    pub hash: Arc<str>,
    /// The plan.
    pub plan: Arc<FlightPlan>,
}

/// An emergency that was raised.
#[derive(Debug, Clone, PartialEq)]
pub struct Raised {
    /// Why.
    pub cause: Cause,
    /// The emergency plan that is flown for it.
    pub plan: Id,
    /// The leg of the main plan that the aircraft was on.
    pub from_leg: Option<Id>,
}

/// A proposal that was answered.
#[derive(Debug, Clone)]
pub struct Proposal {
    /// What it would do.
    pub report: ProposalReport,
    /// What is different in the plan, as it was when it was put forward.
    pub changes: Vec<flight_plan::Change>,
    /// The leg at which it will be entered, if one must be named.
    pub entry: Option<Id>,
    /// When it was answered: the aircraft flies on since.
    pub told: Told,
}

impl Vehicle {
    /// The link over which it can be asked, if there is one.
    pub fn open_link(&self) -> Option<LinkId> {
        self.link_id.filter(|_| self.link != LinkState::Off)
    }

    /// Its autopilot, if it said what it is and its habits are known.
    pub fn autopilot(&self) -> Option<Autopilot> {
        self.gateway.as_ref()?.value.autopilot.as_ref()?.habits.as_ref()?.parse().ok()
    }

    /// The emergency plan that is being flown, or was flown last.
    pub fn emergency(&self) -> Option<&Id> {
        self.status.as_ref()?.value.emergency.as_ref()
    }

    /// Hash of the plan that the FP Manager says is active.
    pub fn active_hash(&self) -> Option<Arc<str>> {
        self.status.as_ref()?.value.plan.clone()
    }

    /// The aircraft's clock, seconds; `None` once it is no longer heard: nobody knows how far it is by now.
    pub fn clock_s(&self, now_s: f64) -> Option<f64> {
        let live = self.position.as_ref().filter(|position| !position.is_expired(now_s));
        live.map(|position| position.time_s)
    }

    /// Why its autopilot can't be flown as it is set up, and what to do, as its gateway says.
    pub fn unfit(&self) -> Option<&str> {
        self.gateway.as_ref()?.value.unfit.as_deref()
    }

    /// What was asked for in the climb waits until the aircraft is so high above home, metres.
    pub fn waits_for_height_m(&self, now_s: f64) -> Option<f64> {
        live(&self.gateway, now_s)?.waits_for_height_m
    }

    /// The circle that its gateway says it flies.
    pub fn told_circle(&self, now_s: f64) -> Option<Circle> {
        let circle = live(&self.gateway, now_s)?.circle.filter(|circle| circle.centre.is_valid())?;
        Some(Circle { centre: circle.centre, radius_m: circle.radius_m })
    }

    /// An alarm of its gateway says that it has no engine.
    pub fn is_engine_out(&self) -> bool {
        let alarms = self.gateway.as_ref().map(|gateway| gateway.value.alarms.as_slice()).unwrap_or_default();
        alarms.iter().any(|alarm| alarm.cause == Some(usal::contract::Cause::Engine))
    }

    /// The emergency that no plan answers, while an alarm of its gateway says that it goes on.
    pub fn unanswered(&self) -> Option<&Unanswered> {
        let alarms = self.gateway.as_ref().map(|gateway| gateway.value.alarms.as_slice()).unwrap_or_default();
        self.why_safe.unanswered(|cause| alarms.iter().any(|alarm| alarm.cause.convert() == Some(cause)))
    }

    /// What the executor is doing; idle when nothing is known.
    pub fn phase(&self) -> Phase {
        self.status.as_ref().map_or(Phase::Idle, |s| s.value.phase)
    }

    /// What people call a part of the plan aboard; its identifier, where nobody named it.
    pub fn name_of(&self, id: &Id) -> String {
        self.names().of(id)
    }

    /// A sentence with names in the place of the identifiers that it quotes.
    pub fn told(&self, sentence: &str) -> String {
        self.names().told(sentence)
    }

    /// What people call a branch of the plan aboard.
    pub fn name_of_branch(&self, fork: &Id, branch: &Id) -> String {
        self.names().of_branch(fork, branch)
    }

    /// The emergency plan aboard that a leg or stage belongs to; `None`: it is one of the main plan.
    pub fn emergency_plan_of(&self, id: &Id) -> Option<&EmergencyPlan> {
        let plan = &self.aboard.as_ref()?.plan;
        let stage = plan.leg(id).map(|context| &context.stage.id).or_else(|| Some(&plan.stage(id)?.id))?;
        plan.emergency_plans.iter().find(|of| of.stages.iter().any(|own| own.id == *stage))
    }

    fn names(&self) -> Names<'_> {
        Names(self.aboard.as_ref().map(|aboard| aboard.plan.as_ref()))
    }

    /// The leg being flown.
    pub fn current_leg(&self) -> Option<&Id> {
        Some(&self.status.as_ref()?.value.place.as_ref()?.leg)
    }

    /// In the air, as far as is known.
    pub fn is_airborne(&self) -> bool {
        self.position.as_ref().is_some_and(|p| !p.value.on_ground)
    }
}

/// A value, as long as it is to be believed.
fn live<T>(value: &Option<Aged<T>>, now_s: f64) -> Option<&T> {
    value.as_ref().filter(|value| !value.is_expired(now_s)).map(|value| &value.value)
}
