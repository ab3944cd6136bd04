//! What comes from a vehicle: each message is kept with its age, and logged where it says something new.

use super::{Raised, Vehicle};
use crate::link::{LinkEvent, LinkId, LinkState, Loss, Numbered, PlainEvent, PlainValue, Telemetry};
use crate::state::{Aged, Level, Names, RecentEvents, START, Strangers, log, losses};
use flight_exec::{Event, Phase, Status};
use std::sync::Arc;
use usal::contract::{GatewayEvent, GatewayState, GatewayStatus, Recording, Stamped};

/// More announcements than these are read in the log.
const MOST_UNREAD: usize = 3;

macro_rules! remember {
    ($field:expr, $stamped:expr, $now:expr) => {
        $field = Some(Aged::new($stamped, $now))
    };
}

impl Vehicle {
    /// Takes in a link's message about this vehicle.
    pub(in crate::state) fn receive(&mut self, link: LinkId, event: LinkEvent, now_s: f64) {
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
    pub(in crate::state) fn begin_link(&mut self, link: LinkId, now_s: f64) {
        self.link_id = Some(link);
        self.plan_events.begin_link();
        self.gateway_events.begin_link();
        self.strangers = Strangers::default();
        self.plain_events.values_mut().for_each(RecentEvents::begin_link);
        self.give_up_requests(now_s);
    }

    pub(in crate::state) fn link_changed(&mut self, link: LinkState, now_s: f64) {
        if link != self.link {
            self.log.add(now_s, link.level(), "link", &link.text());
        }
        if link == LinkState::Off {
            self.services = Arc::default();
            self.give_up_requests(now_s);
        }
        self.link = link;
    }

    fn take(&mut self, telemetry: Telemetry, now_s: f64) {
        match telemetry {
            Telemetry::Position(p) => {
                self.trail.add(p.value.position, p.time_s);
                self.circling.fly(p.value.position, self.is_held() && !p.value.on_ground);
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
        if let Some(text) = losses::sentence(loss) {
            self.log.add(now_s, Level::Caution, "link", &text);
        }
    }

    fn strange(&mut self, service: &'static str, count: u64, now_s: f64) {
        let is_news = self.strangers.heard(service, count, now_s);
        if let Some(text) = self.strangers.text().filter(|_| is_news) {
            self.log.add(now_s, Level::Caution, "link", &text);
        }
    }

    /// Its gateway has it circle where it is.
    fn is_held(&self) -> bool {
        let state = self.gateway.as_ref().map(|gateway| gateway.value.state);
        matches!(state, Some(GatewayState::Hold | GatewayState::SafeHold))
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
        if log::ends_a_flight(event)
            && let Some(over) = self.said_of_glide.take()
        {
            self.unread.retain(|known| *known != over);
        }
        if log::is_of_a_start(event) {
            self.unread.retain(|known| !log::says_no_start(known));
        }
        if let Some(text) = log::announced(event, text, self.names()) {
            self.announce(text, log::is_of_glide(event));
        }
        self.why_safe.happened(event);
        if let Event::EmergencyStarted { cause, plan, from_leg } = event {
            self.raised = Some(Raised { cause: *cause, plan: plan.clone(), from_leg: from_leg.clone() });
        }
    }

    /// `of_glide`: what was said before of the glide is over.
    fn announce(&mut self, text: String, of_glide: bool) {
        // asked for again and again, it is refused as often
        self.unread.retain(|known| *known != text);
        if of_glide && let Some(before) = self.said_of_glide.replace(text.clone()) {
            self.unread.retain(|known| *known != before);
        }
        self.unread.push_back(text);
        while self.unread.len() > MOST_UNREAD {
            self.unread.pop_front();
        }
    }

    fn gateway_event(&mut self, event: &Numbered<GatewayEvent>, now_s: f64) {
        let Some((level, text)) = log::gateway_event(&event.event.value) else { return };
        if !self.gateway_events.is_new(event.sequence, event.event.time_s, &text) {
            return;
        }
        self.log.add(now_s, level, "gateway", &text);
        if let GatewayEvent::StateChanged { from, to, cause } = &event.event.value {
            self.why_safe.state_changed(*from, *to, cause);
        }
    }
}
