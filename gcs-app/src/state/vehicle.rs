//! One vehicle: what is known of it, and how old that is.

use super::watch::{GROUND_STATION, Sight, Watch};
use super::{
    Aged, LOOK_AHEAD, Level, Log, Losses, Names, Outcome, Outlook, RecentEvents, Repeats, Requests, START,
    Strangers, Ticket, Told, Trail, log,
};
use crate::link::{
    LinkEvent, LinkId, LinkState, Loss, Numbered, PlainEvent, PlainValue, Reply, Rows, Telemetry,
};
use aircraft::Autopilot;
use flight_exec::{Event, Phase, ProposalReport, Status};
use flight_plan::{Cause, EmergencyPlan, FlightPlan, Id};
use geometry::LatLon;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;
use terrain::Terrain;
use usal::contract::{
    Ahead, Air, Alarm, Attitude, AutopilotLinks, Engine, GatewayEvent, GatewayStatus, Gps, Navigation,
    PlanVariables, Position, Power, Recording, Severity, Stamped,
};

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
    /// Commands on their way, and their answers.
    pub requests: Requests,
    /// What happened.
    pub log: Log,
    /// What happened that nobody must miss and nobody has put aside yet, oldest first.
    pub unread: VecDeque<String>,
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

macro_rules! remember {
    ($field:expr, $stamped:expr, $now:expr) => {
        $field = Some(Aged::new($stamped, $now))
    };
}

impl Vehicle {
    /// Takes in a link's message about this vehicle.
    pub(super) fn receive(&mut self, link: LinkId, event: LinkEvent, now_s: f64) {
        if self.link_id.is_some_and(|current| link < current) {
            return;
        }
        if self.link_id != Some(link) {
            self.begin_link(link, now_s);
        }
        match event {
            LinkEvent::Link(state) => self.link_changed(state, now_s),
            LinkEvent::Services(there) => self.services = there,
            LinkEvent::Telemetry(telemetry) => {
                self.received_s = Some(now_s);
                self.take(telemetry, now_s);
            }
            LinkEvent::Lost(loss) => self.lost(loss, now_s),
            LinkEvent::Strangers { service, count } => self.strange(service, count, now_s),
            LinkEvent::Answer { ticket, result } => self.answered(ticket, result, now_s),
        }
    }

    /// Another link to the same vehicle: what is known of it stays, what was asked over the last one is void.
    pub(super) fn begin_link(&mut self, link: LinkId, now_s: f64) {
        self.link_id = Some(link);
        self.plan_events.begin_link();
        self.gateway_events.begin_link();
        self.strangers = Strangers::default();
        self.plain_events.values_mut().for_each(RecentEvents::begin_link);
        self.give_up_requests(now_s);
    }

    fn give_up_requests(&mut self, now_s: f64) {
        self.requests.settle_all("the link was closed before the answer came", now_s);
        self.proposal = None;
        self.outlook = Outlook::default();
    }

    pub(super) fn link_changed(&mut self, link: LinkState, now_s: f64) {
        if link != self.link {
            self.log.add(now_s, link.level(), "link", &link.text());
        }
        if link == LinkState::Off {
            self.services = Arc::default();
            self.give_up_requests(now_s);
        }
        self.link = link;
    }

    /// The link over which it can be asked, if there is one.
    pub fn open_link(&self) -> Option<LinkId> {
        self.link_id.filter(|_| self.link != LinkState::Off)
    }

    /// Its autopilot, if it said what it is and its habits are known.
    pub fn autopilot(&self) -> Option<Autopilot> {
        self.gateway.as_ref()?.value.autopilot.as_ref()?.habits.as_ref()?.parse().ok()
    }

    fn take(&mut self, telemetry: Telemetry, now_s: f64) {
        match telemetry {
            Telemetry::Position(p) => {
                self.trail.add(p.value.position, p.time_s);
                remember!(self.position, p, now_s);
                self.note_end();
            }
            Telemetry::Attitude(v) => remember!(self.attitude, v, now_s),
            Telemetry::Air(v) => remember!(self.air, v, now_s),
            Telemetry::Gps(v) => remember!(self.gps, v, now_s),
            Telemetry::Engine(v) => remember!(self.engine, v, now_s),
            Telemetry::Power(v) => remember!(self.power, v, now_s),
            Telemetry::Links(v) => remember!(self.links, v, now_s),
            Telemetry::Navigation(v) => remember!(self.navigation, v, now_s),
            Telemetry::Gateway(v) => self.gateway_status(*v, now_s),
            Telemetry::Status(v) => {
                self.follow(&v.value);
                remember!(self.status, *v, now_s);
                self.note_end();
            }
            Telemetry::Ahead(v) => remember!(self.ahead, v, now_s),
            Telemetry::Variables(v) => remember!(self.variables, v, now_s),
            Telemetry::PlanEvent(event) => self.plan_event(&event, now_s),
            Telemetry::GatewayEvent(event) => self.gateway_event(&event, now_s),
            Telemetry::Recording(v) => self.recording(v, now_s),
            Telemetry::Plain(PlainValue { service, name, rows }) => {
                self.plain.insert((service, name), Aged::new(rows, now_s));
            }
            Telemetry::PlainEvent(PlainEvent { service, name, rows }) => {
                self.plain_events.entry((service, name)).or_default().add(rows, now_s);
            }
        }
    }

    /// What a status says that the one before did not.
    fn follow(&mut self, status: &Status) {
        if self.emergency() != status.emergency.as_ref() {
            self.outlook.way_changed();
        }
        if let Some(asked) = &status.decision {
            let before = self.status.as_ref().and_then(|before| before.value.decision.as_ref());
            let is_same = before.is_some_and(|before| before.leg == asked.leg);
            self.decision_s =
                if is_same { self.decision_s.max(asked.time_left_s) } else { asked.time_left_s };
        }
        if status.phase != Phase::Finished {
            (self.ended_in, self.ended_at) = (None, None);
        } else if self.phase() != Phase::Finished {
            // the status of a flight that is over has none any more
            self.ended_in = self.emergency().cloned();
        }
    }

    /// That what was asked for in the climb waits is logged once: its answer and its phase look as if it were done.
    fn gateway_status(&mut self, status: Stamped<GatewayStatus>, now_s: f64) {
        let before = self.gateway.as_ref().and_then(|before| before.value.waits_for_height_m);
        if let Some(height_m) = status.value.waits_for_height_m.filter(|_| before.is_none()) {
            let text = format!(
                "It climbs straight ahead: what was asked for waits until {height_m:.0} m above home"
            );
            self.log.add(now_s, Level::Info, "gateway", &text);
        }
        let was_out = self.is_engine_out();
        remember!(self.gateway, status, now_s);
        if self.is_engine_out() != was_out {
            self.outlook.way_changed();
        }
    }

    /// That a flight is not recorded any more is reported once.
    fn recording(&mut self, recording: Stamped<Recording>, now_s: f64) {
        let failure = recording.value.failure.as_ref();
        let known = self.recording.as_ref().and_then(|known| known.value.failure.as_ref());
        if failure != known {
            let (level, text) = match failure {
                Some(why) => (Level::Caution, format!("the flight is not recorded: {why}")),
                None => (Level::Info, "the flight is recorded again".to_owned()),
            };
            self.log.add(now_s, level, "storage", &text);
        }
        self.recording = Some(Aged::new(recording, now_s));
    }

    fn lost(&mut self, loss: Loss, now_s: f64) {
        self.losses.add(loss);
        if let Some(text) = super::losses::sentence(loss) {
            self.log.add(now_s, Level::Caution, "link", &text);
        }
    }

    fn strange(&mut self, service: &'static str, count: u64, now_s: f64) {
        let is_news = self.strangers.heard(service, count, now_s);
        if let Some(text) = self.strangers.text().filter(|_| is_news) {
            self.log.add(now_s, Level::Caution, "link", &text);
        }
    }

    fn note_end(&mut self) {
        if self.phase() == Phase::Finished && self.ended_at.is_none() {
            let stands = self.position.as_ref().filter(|position| position.value.on_ground);
            self.ended_at = stands.map(|position| position.value.position);
        }
    }

    fn plan_event(&mut self, event: &Numbered<Event>, now_s: f64) {
        // names may become known between an event and its repetition
        let (_, said) = log::plan_event(&event.event.value, Names(None));
        if !self.plan_events.is_new(event.sequence, event.event.time_s, &said) {
            return;
        }
        let (level, text) = log::plan_event(&event.event.value, self.names());
        self.log.add(now_s, level, "plan", &text);
        let event = &event.event.value;
        if log::is_no_start(event) {
            self.requests.take_back(START);
        }
        if log::is_announced(event) {
            // asked for again and again, it is refused as often
            self.unread.retain(|known| *known != text);
            self.unread.push_back(text);
            while self.unread.len() > MOST_UNREAD {
                self.unread.pop_front();
            }
        }
        if let Event::EmergencyStarted { cause, plan, from_leg } = event {
            self.raised = Some(Raised { cause: *cause, plan: plan.clone(), from_leg: from_leg.clone() });
        }
    }

    fn gateway_event(&mut self, event: &Numbered<GatewayEvent>, now_s: f64) {
        let Some((level, text)) = log::gateway_event(&event.event.value) else { return };
        if self.gateway_events.is_new(event.sequence, event.event.time_s, &text) {
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
        if label == LOOK_AHEAD {
            let foresight = result.and_then(|reply| match reply {
                Reply::Foresight(foresight) => Ok(foresight),
                _ => Err("it answered something else".into()),
            });
            let aircraft_s = self.clock_s(now_s);
            return self.outlook.answered(ticket, foresight, now_s, aircraft_s);
        }
        if let Outcome::Refused(reason) = &outcome {
            self.log.add(now_s, Level::Caution, "command", &format!("{label}: refused, {reason}"));
        }
        match result {
            Ok(Reply::Proposal(report)) => {
                let entry = report.entry_needed.then(|| report.next_leg.clone()).flatten();
                let changes = std::mem::take(&mut self.put_forward);
                let told = Told { window_s: now_s, aircraft_s: self.clock_s(now_s) };
                self.proposal = Some(Proposal { report: *report, changes, entry, told });
            }
            Ok(Reply::Plan(aboard)) => self.aboard = aboard,
            // a command may lead elsewhere
            Ok(Reply::Done) => self.outlook.way_changed(),
            Ok(Reply::Foresight(_)) | Err(_) => {}
        }
    }

    /// Whether the plan aboard should be asked for now; it is taken to be asked for then.
    pub(super) fn should_ask_for_plan(&mut self, now_s: f64) -> bool {
        let is_heard = self.silence_s(now_s).is_some_and(|silence| silence < LINK_CAUTION_S);
        let is_due = self.asked_aboard_s.is_none_or(|asked| now_s - asked > ASK_ABOARD_S);
        let should = is_heard && is_due && self.open_link().is_some() && self.lacks_plan_aboard();
        if should {
            self.asked_aboard_s = Some(now_s);
        }
        should
    }

    /// It flies an emergency plan, or otherwise than the preview has it, and should be asked now which way.
    pub(super) fn should_ask_which_way(&self, now_s: f64) -> bool {
        let wanted = self.outlook.is_elsewhere() || self.emergency().is_some();
        wanted && self.outlook.is_due(now_s) && self.may_look_ahead()
    }

    /// The command that is considered, if it should be asked now what follows.
    pub(super) fn should_ask_what_follows(&self, now_s: f64) -> Option<&flight_exec::Command> {
        let due = self.outlook.to_ask(self.current_leg(), now_s, self.clock_s(now_s));
        due.filter(|_| self.may_look_ahead())
    }

    /// The vehicle answers one such question at a time, and refuses another one of the same asker.
    pub(crate) fn may_look_ahead(&self) -> bool {
        self.open_link().is_some() && !self.requests.is_pending(LOOK_AHEAD)
    }

    /// The emergency plan that is being flown, or was flown last.
    pub fn emergency(&self) -> Option<&Id> {
        self.status.as_ref()?.value.emergency.as_ref()
    }

    fn lacks_plan_aboard(&self) -> bool {
        let Some(active) = self.active_hash() else { return false };
        self.aboard.as_ref().is_none_or(|aboard| aboard.hash != active)
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

    /// An alarm of its gateway says that it has no engine.
    pub fn is_engine_out(&self) -> bool {
        let alarms = self.gateway.as_ref().map(|gateway| gateway.value.alarms.as_slice()).unwrap_or_default();
        alarms.iter().any(|alarm| alarm.cause == Some(usal::contract::Cause::Engine))
    }

    /// What the executor is doing; idle when nothing is known.
    pub fn phase(&self) -> Phase {
        self.status.as_ref().map_or(Phase::Idle, |s| s.value.phase)
    }

    /// What people call a part of the plan aboard; its identifier, where nobody named it.
    pub fn name_of(&self, id: &Id) -> String {
        self.names().of(id)
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

    /// Seconds since anything was received, if ever.
    pub fn silence_s(&self, now_s: f64) -> Option<f64> {
        self.received_s.map(|received_s| (now_s - received_s).max(0.0))
    }

    /// Seconds for which its gateway, that is heard itself, has not heard its autopilot; `None`: it does hear it.
    pub fn autopilot_silence_s(&self, now_s: f64) -> Option<f64> {
        let gateway = self.gateway.as_ref().filter(|gateway| !gateway.is_expired(now_s))?;
        let silence_s = gateway.value.autopilot_age_s + gateway.age_s(now_s);
        (silence_s > AUTOPILOT_SILENT_S).then_some(silence_s)
    }

    /// Looks at the aircraft over the ground; what is raised anew is logged.
    pub(super) fn look(&mut self, terrain: &dyn Terrain, now_s: f64) {
        let before: Vec<String> = self.watch.alarms().map(|alarm| alarm.id).collect();
        let sight = Sight {
            position: live(&self.position, now_s).copied(),
            ahead: live(&self.ahead, now_s),
            state: live(&self.gateway, now_s).map(|status| status.state),
        };
        self.watch.look(sight, terrain, now_s);
        for alarm in self.watch.alarms().filter(|alarm| !before.contains(&alarm.id)) {
            let text = format!("{}: {}", alarm.id, alarm.advice);
            self.log.add(now_s, alarm.severity.into(), GROUND_STATION, &text);
        }
    }

    /// Alarms, the most severe first: the gateway's, and this ground station's own.
    pub fn alarms(&self, now_s: f64) -> Vec<Alarm> {
        let mut alarms = self.gateway.as_ref().map(|g| g.value.alarms.clone()).unwrap_or_default();
        alarms.extend(self.link_alarm(now_s));
        alarms.extend(self.strangers.alarm(now_s));
        alarms.extend(self.watch.alarms());
        alarms.sort_by(|a, b| b.severity.cmp(&a.severity).then_with(|| a.id.cmp(&b.id)));
        alarms
    }

    /// Once after it has fallen silent (true), and once after it is heard again (false).
    pub(super) fn silence_changed(&mut self, now_s: f64) -> Option<bool> {
        let is_silent = self.link_alarm(now_s).is_some();
        let changed = is_silent != self.was_silent;
        self.was_silent = is_silent;
        // a link that was closed on purpose is not heard again
        let is_heard = self.silence_s(now_s).is_some_and(|silence_s| silence_s < LINK_CAUTION_S);
        (changed && (is_silent || is_heard)).then_some(is_silent)
    }

    fn link_alarm(&self, now_s: f64) -> Option<Alarm> {
        let silence = self.silence_s(now_s).filter(|s| *s > LINK_CAUTION_S && self.link.is_wanted())?;
        let warning = silence > LINK_WARNING_S && self.is_airborne();
        Some(Alarm {
            id: "link-silent".into(),
            severity: if warning { Severity::Warning } else { Severity::Caution },
            source: GROUND_STATION.into(),
            advice: "Nothing is heard from the vehicle. It flies on by its plan; check the link.".into(),
            cause: None,
        })
    }
}

/// More announcements than these are read in the log.
const MOST_UNREAD: usize = 3;
/// A value, as long as it is to be believed.
fn live<T>(value: &Option<Aged<T>>, now_s: f64) -> Option<&T> {
    value.as_ref().filter(|value| !value.is_expired(now_s)).map(|value| &value.value)
}

/// The plan aboard is asked for again at most so often, seconds.
const ASK_ABOARD_S: f64 = 3.0;
/// Silence after which the operator should know, seconds.
pub const LINK_CAUTION_S: f64 = 3.0;
/// Silence of its autopilot after which what that said is old, seconds: even an idle one speaks once a second.
const AUTOPILOT_SILENT_S: f64 = 3.0;
/// Silence after which the operator should act, seconds.
pub const LINK_WARNING_S: f64 = 10.0;
