//! What is known of the vehicle, and how old it is. LinkEvent go in, panels read; nothing here draws,
//! waits or sends.

mod aged;
pub mod log;
mod requests;
mod trail;

pub use aged::Aged;
pub use log::{Level, Line, Log};
pub use requests::{Outcome, READ_ABOARD, Request, Requests, Ticket};
pub use trail::Trail;

use crate::link::{LinkEvent, LinkState, Reply, Telemetry};
use flight_exec::{Phase, Status};
use flight_plan::{FlightPlan, Id};
use std::sync::Arc;
use usal::contract::{
    Ahead, Air, Alarm, Attitude, Engine, GatewayEvent, GatewayStatus, Gps, Navigation, PlanEvent,
    PlanVariables, Position, Power, ProposalReport, Severity, Stamped,
};

/// A vehicle, as far as the ground station knows it.
#[derive(Debug, Default)]
pub struct Vehicle {
    /// The way to it.
    pub link: LinkState,
    /// When anything was heard of it last, seconds of the window's clock.
    pub heard_s: Option<f64>,
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
    /// The active plan.
    pub aboard: Option<ActivePlan>,
    /// What the last proposal would do, until committed or dropped.
    pub proposal: Option<Proposal>,
    /// Where it has been.
    pub trail: Trail,
    /// Commands on their way, and their answers.
    pub requests: Requests,
    /// What happened.
    pub log: Log,
}

/// A plan the FP Manager flies.
#[derive(Debug, Clone)]
pub struct ActivePlan {
    /// Its hash.
    pub hash: Arc<str>,
    /// The plan.
    pub plan: Arc<FlightPlan>,
}

/// A proposal that was answered.
#[derive(Debug, Clone)]
pub struct Proposal {
    /// What it would do.
    pub report: ProposalReport,
    /// The leg at which it will be entered, if one must be named.
    pub entry: Option<Id>,
}

/// A payload of the news, as told by the link.
macro_rules! remember {
    ($field:expr, $stamped:expr, $now:expr) => {
        $field = Some(Aged::new($stamped, $now))
    };
}

impl Vehicle {
    /// Takes news in. Returns whether the plan aboard should be asked for.
    pub fn hear(&mut self, news: LinkEvent, now_s: f64) -> bool {
        match news {
            LinkEvent::Link(link) => self.link_changed(link, now_s),
            LinkEvent::Telemetry(heard) => {
                self.heard_s = Some(now_s);
                self.take(heard, now_s);
            }
            LinkEvent::Answer { ticket, result } => self.answered(ticket, result, now_s),
        }
        self.lacks_plan_aboard()
    }

    fn link_changed(&mut self, link: LinkState, now_s: f64) {
        if link != self.link {
            self.log.add(now_s, link.level(), "link", &link.text());
        }
        self.link = link;
    }

    fn take(&mut self, heard: Telemetry, now_s: f64) {
        match heard {
            Telemetry::Position(p) => {
                self.trail.add(p.value.position, p.time_s);
                remember!(self.position, p, now_s);
            }
            Telemetry::Attitude(v) => remember!(self.attitude, v, now_s),
            Telemetry::Air(v) => remember!(self.air, v, now_s),
            Telemetry::Gps(v) => remember!(self.gps, v, now_s),
            Telemetry::Engine(v) => remember!(self.engine, v, now_s),
            Telemetry::Power(v) => remember!(self.power, v, now_s),
            Telemetry::Navigation(v) => remember!(self.navigation, v, now_s),
            Telemetry::Gateway(v) => remember!(self.gateway, v, now_s),
            Telemetry::Status(v) => remember!(self.status, *v, now_s),
            Telemetry::Ahead(v) => remember!(self.ahead, v, now_s),
            Telemetry::Variables(v) => remember!(self.variables, v, now_s),
            Telemetry::PlanEvent(event) => self.plan_event(event, now_s),
            Telemetry::GatewayEvent(event) => self.gateway_event(&event, now_s),
        }
    }

    fn plan_event(&mut self, event: Stamped<PlanEvent>, now_s: f64) {
        let (level, text) = log::plan_event(&event.value);
        self.log.add(now_s, level, "plan", &text);
    }

    fn gateway_event(&mut self, event: &GatewayEvent, now_s: f64) {
        if let Some((level, text)) = log::gateway_event(event) {
            self.log.add(now_s, level, "gateway", &text);
        }
    }

    fn answered(&mut self, ticket: Ticket, result: Result<Reply, String>, now_s: f64) {
        let outcome = match &result {
            Ok(Reply::Proposal(report)) if !report.acceptable => Outcome::Refused("see its problems".into()),
            Ok(_) => Outcome::Accepted,
            Err(reason) => Outcome::Refused(reason.clone()),
        };
        let Some(label) = self.requests.settle(ticket, outcome.clone(), now_s) else { return };
        if let Outcome::Refused(reason) = &outcome {
            self.log.add(now_s, Level::Caution, "command", &format!("{label}: refused, {reason}"));
        }
        match result {
            Ok(Reply::Proposal(report)) => {
                let entry = report.entry_needed.then(|| report.next_leg.clone()).flatten();
                self.proposal = Some(Proposal { report: *report, entry });
            }
            Ok(Reply::Plan(aboard)) => self.aboard = aboard,
            Ok(Reply::Done) | Err(_) => {}
        }
    }

    fn lacks_plan_aboard(&self) -> bool {
        let Some(active) = self.active_hash() else { return false };
        self.aboard.as_ref().is_none_or(|aboard| aboard.hash != active)
    }

    /// Hash of the plan that the FP Manager says is active.
    pub fn active_hash(&self) -> Option<Arc<str>> {
        self.status.as_ref()?.value.plan.clone()
    }

    /// What the executor is doing; idle when nothing is known.
    pub fn phase(&self) -> Phase {
        self.status.as_ref().map_or(Phase::Idle, |s| s.value.phase)
    }

    /// The leg being flown.
    pub fn current_leg(&self) -> Option<&Id> {
        Some(&self.status.as_ref()?.value.place.as_ref()?.leg)
    }

    /// In the air, as far as is known.
    pub fn is_airborne(&self) -> bool {
        self.position.as_ref().is_some_and(|p| !p.value.on_ground)
    }

    /// Seconds since anything was heard, if ever.
    pub fn silence_s(&self, now_s: f64) -> Option<f64> {
        self.heard_s.map(|heard| (now_s - heard).max(0.0))
    }

    /// Alarms, the most severe first: the gateway's, and those of the link itself.
    pub fn alarms(&self, now_s: f64) -> Vec<Alarm> {
        let mut alarms = self.gateway.as_ref().map(|g| g.value.alarms.clone()).unwrap_or_default();
        alarms.extend(self.link_alarm(now_s));
        alarms.sort_by(|a, b| b.severity.cmp(&a.severity).then_with(|| a.id.cmp(&b.id)));
        alarms
    }

    fn link_alarm(&self, now_s: f64) -> Option<Alarm> {
        let silence = self.silence_s(now_s).filter(|s| *s > LINK_CAUTION_S && self.link.is_wanted())?;
        let warning = silence > LINK_WARNING_S && self.is_airborne();
        Some(Alarm {
            id: "link-silent".into(),
            severity: if warning { Severity::Warning } else { Severity::Caution },
            source: "ground station".into(),
            advice: "Nothing is heard from the vehicle. It flies on by its plan; check the link.".into(),
            cause: None,
        })
    }
}

/// Silence after which the operator should know, seconds.
pub const LINK_CAUTION_S: f64 = 3.0;
/// Silence after which the operator should act, seconds.
pub const LINK_WARNING_S: f64 = 10.0;
