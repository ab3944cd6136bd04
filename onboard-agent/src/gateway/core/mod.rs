//! Pure: the gateway's state machine. No IO, clock or randomness: time is an argument.
//!
//! `step` takes one thing that happened and gives what is to be done about it. Every step ends
//! with the same round: alarms, what the autopilot is seen to do, what the FP Manager is known to
//! do, then the orders that follow. The state says what was confirmed, the intent what is wanted.

mod airspeed;
mod alarms;
mod batch;
mod buffer;
mod climb_out;
mod control;
mod deviation;
mod direct;
mod feeding;
mod forced_end;
mod io;
mod launch;
mod met;
mod no_further;
mod observe;
mod off_path;
mod pilot;
mod requests;
mod safe;
mod states;
mod supervise;
mod telemetry;
#[cfg(test)]
mod tests;
mod views;

#[cfg(test)]
pub use buffer::CAPACITY;
pub use io::{Answer, Input, Intent, Output, Settings, Snapshot};
pub use telemetry::{Telemetry, Timed};

use super::order::{Course, Mode, Order, OrderId, Report, Time};
use alarms::{AlarmInputs, Alarms};
use buffer::Buffer;
use control::Control;
use forced_end::ForcedEnd;
use geometry::LatLon;
use off_path::Way;
use states::{Trigger, is_flying, is_safe};
use std::time::Duration;
use supervise::FpManager;
use usal::contract::{GatewayEvent, GatewayState, SafeParameters, SafeRunway, Token, Waypoint};

/// Silent for so long on the ground: the autopilot is off.
const OFF_AFTER: Duration = Duration::from_secs(10);
/// Silent for so long in the air: it has come down by now.
const COME_DOWN_AFTER: Duration = Duration::from_secs(3600);
/// Why nothing can be begun while the state is `Off`.
const NOT_HEARD: &str = "The autopilot is not heard; check its link.";

/// The gateway. See the module's text.
pub struct Gateway {
    settings: Settings,
    state: GatewayState,
    cause: String,
    telemetry: Telemetry,
    alarms: Alarms,
    buffer: Buffer,
    control: Control,
    fp_manager: FpManager,
    safe: SafeParameters,
    runways: Vec<SafeRunway>,
    highest: Token,
    /// The last waypoint that ends the plan was flown.
    ended: bool,
    /// The last flight ended with a landing of the FP Manager's.
    finished: bool,
    /// What was last reported as progress.
    reported: Option<Option<Token>>,
    low_reported: bool,
    /// What must survive a restart can't be written.
    not_stored: bool,
    /// Somebody floods the port.
    flooded: bool,
    forced_end: ForcedEnd,
    /// A flight was met in the air: what was known of it.
    adopting: Option<Snapshot>,
    /// It was seen to stand, not armed: whatever takes off since without an order to is somebody's own flight.
    stood: bool,
    /// Another station's list is aboard, and is not flown; until ours is.
    list_lost: bool,
    /// The driver was told to change nothing aboard.
    hands_off: bool,
    /// What is flown between waypoints.
    way: Way,
    /// The waypoint that it waits at for its altitude.
    at: Option<no_further::At>,
    /// Of the last step.
    now: Time,
}

impl Gateway {
    /// A gateway that has received nothing yet. `restored`: what an earlier one stored.
    pub fn new(settings: Settings, restored: Option<Snapshot>) -> Self {
        let known = restored.clone();
        Self {
            settings,
            state: GatewayState::Off,
            cause: "the autopilot was not heard yet".into(),
            telemetry: Telemetry::default(),
            alarms: Alarms::default(),
            buffer: Buffer::default(),
            control: Control::default(),
            fp_manager: FpManager::default(),
            safe: known.as_ref().map_or_else(SafeParameters::default, |k| k.safe),
            runways: known.map_or_else(Vec::new, |k| k.runways),
            highest: Token(0),
            ended: false,
            finished: false,
            reported: None,
            low_reported: false,
            not_stored: false,
            flooded: false,
            forced_end: restored
                .as_ref()
                .map_or_else(ForcedEnd::default, |k| ForcedEnd::restored(k.terminated, k.terminated_unix_s)),
            adopting: restored,
            stood: false,
            list_lost: false,
            hands_off: false,
            way: Way::default(),
            at: None,
            now: Time::ZERO,
        }
    }

    /// Takes in what happened; what is to be done goes to `out`.
    pub fn step(&mut self, now: Time, input: Input, out: &mut Vec<Output>) {
        self.now = now;
        self.control.fed = false;
        match input {
            Input::Tick => {}
            Input::Report(report) => self.report(now, report, out),
            Input::Stored(stored) => self.not_stored = !stored,
            Input::Flooded(flooded) => self.flooded = flooded,
            Input::Heartbeat { count, plan, from } => self.fp_manager.heartbeat(now, count, plan, from),
            Input::Strangers(count) => self.fp_manager.heard_others(now, count),
            Input::Join(request, join, from) => {
                let answer = self.join(now, join, from, out);
                out.push(Output::Answer(request, Answer::Join(answer)));
            }
            Input::Feed(request, feed, from) => {
                let answer = self.feed(now, feed, from, out);
                out.push(Output::Answer(request, Answer::Feed(answer)));
            }
            Input::Request(request, asked) => {
                let result = self.request(now, asked, out);
                out.push(Output::Answer(request, Answer::Request(result)));
            }
        }
        self.round(now, out);
    }

    fn round(&mut self, now: Time, out: &mut Vec<Output>) {
        self.watch(now, out);
        self.keep_ended(now, out);
        self.observe(now, out);
        self.climb_out(out);
        self.supervise(now, out);
        self.steer(now, out);
        self.report_progress(out);
    }

    /// What must survive a restart. As long as it is not known what an earlier gateway left of a flight, that goes on to be kept.
    pub fn snapshot(&self) -> Snapshot {
        let known = self.known();
        match &self.adopting {
            Some(earlier) => earlier.with_news(known),
            None => known,
        }
    }

    fn known(&self) -> Snapshot {
        Snapshot {
            runways: self.runways.clone(),
            safe: self.safe,
            highest: self.highest,
            intent: self.control.intent,
            waypoints: self.buffer.waypoints().cloned().collect(),
            plan: self.fp_manager.plan.clone(),
            mode: self.telemetry.mode.map(|_| self.telemetry.mode_name.clone().into_owned()),
            terminated: self.forced_end.outlives(),
            terminated_unix_s: self.forced_end.unix_s,
            // of a flight that is over it says nothing of the next one
            engine: self.alarms.of_engine().filter(|_| self.telemetry.is_up(self.now)),
            climb_out: self.control.climb_out.clone(),
        }
    }

    fn report(&mut self, now: Time, report: Report, out: &mut Vec<Output>) {
        let before = self.telemetry.mode;
        self.telemetry.take(now, &report);
        if self.telemetry.mode != before && is_flying(self.state) {
            // a gateway that starts anew has to see who has changed it
            out.push(Output::Save);
        }
        match report {
            Report::Course(course) => self.set_course(course),
            Report::Done(id) => {
                self.control.done(id);
                self.forced_end.answered(now, id);
            }
            Report::PutOff(id, why) => self.put_off(now, id, why, out),
            Report::Failed(id, why) => self.failed(now, id, why, out),
            Report::Unanswered(id, why) => self.not_armed(now, id, &why, true, out),
            Report::Adopted(id, aboard) => self.adopt(id, aboard, out),
            Report::ListUnfit(true) => self.list_refused(now),
            Report::HoldsByItself => self.control.holds_by_itself = true,
            Report::ListReplaced => self.list_replaced(out),
            Report::Rebooted => self.rebooted(out),
            Report::Capability(result) => self.control.capability = Some(result),
            _ => {}
        }
    }

    fn set_course(&mut self, course: Course) {
        let ends = self.buffer.last().is_some_and(|w| w.end_of_plan);
        self.buffer.set_course(course, self.place());
        self.ended |= ends && self.buffer.at_end();
        self.list_lost &= !course.ready;
    }

    /// It is ordered again for a while, as long as nobody wants something else.
    fn put_off(&mut self, now: Time, id: OrderId, why: String, out: &mut Vec<Output>) {
        if self.control.launch.is_put_off_for_good(now) {
            return self.failed(now, id, why, out);
        }
        self.control.failed(now, id);
        self.cause = format!("the autopilot does not arm yet, it is asked again: {why}");
    }

    fn failed(&mut self, now: Time, id: OrderId, why: String, out: &mut Vec<Output>) {
        self.forced_end.answered(now, id);
        self.not_armed(now, id, &why, false, out);
    }

    fn watch(&mut self, now: Time, out: &mut Vec<Output>) {
        let inputs = AlarmInputs {
            disobeys_since: self.control.disobeys_since,
            sinks_below_target: self.sinks_below_target(),
            sinks: self.sinks(),
            slow: self.is_slow(now),
            fast: self.is_fast(now),
            off_altitude: self.is_off_altitude(now),
            beside_path: self.beside_path(now),
            stands_still: self.stands_still(now),
            no_further: self.gets_no_further(now),
            disarmed: is_flying(self.state) && self.telemetry.flies_disarmed(now),
            flies_on: self.telemetry.armed && self.state == GatewayState::Terminate,
            list_replaced: self.list_lost && self.state != GatewayState::Manual,
            not_in_command: self.state == GatewayState::Manual,
            no_safe_runway: self.control.intent == Intent::Return,
            exposed: self.settings.exposed,
            replay: self.settings.replay,
            other_fp_manager: self.fp_manager.others_heard(now),
            no_runway_stored: self.runways.is_empty() && self.fp_manager.plan.is_some(),
            not_stored: self.not_stored,
            flooded: self.flooded,
        };
        let (mut events, engine) = (vec![], self.alarms.of_engine());
        self.alarms.update(now, &self.telemetry, inputs, &mut events);
        out.extend(events.into_iter().map(Output::Event));
        if self.alarms.of_engine() != engine {
            out.push(Output::Save);
        }
    }

    /// It is in the air, or about to be, as far as is known; not once it is silent for so long that it is off, or has come down: a
    /// link that is away for a while comes back to an aircraft that must have an owner.
    pub fn is_in_flight(&self) -> bool {
        let t = &self.telemetry;
        let may_fly = is_flying(self.state) && (t.armed || t.flies_disarmed(self.now));
        let flies = t.is_airborne() || may_fly;
        let silent_at_most = if self.telemetry.on_ground == Some(true) { OFF_AFTER } else { COME_DOWN_AFTER };
        flies && self.telemetry.last_received.is_some_and(|at| self.now.saturating_sub(at) <= silent_at_most)
    }

    /// Also without an engine; but what stood and is not armed may be carried.
    fn flies_waypoints(&self) -> bool {
        let glides = self.state != GatewayState::Stop && self.telemetry.flies_disarmed(self.now);
        (self.telemetry.armed || glides) && self.telemetry.mode == Some(Mode::Waypoints)
    }

    /// Makes a transition, if the table has one; reports it; does what entering the state asks for.
    fn change(&mut self, trigger: Trigger, cause: &str, out: &mut Vec<Output>) {
        let Some(to) = states::next(self.state, trigger) else { return };
        let from = std::mem::replace(&mut self.state, to);
        self.cause = cause.to_owned();
        if to == GatewayState::TakeOff {
            self.control.climb_out.begins();
        }
        if !is_safe(to) {
            self.control.safe_since = None;
        }
        if to != GatewayState::Hold {
            self.fp_manager.awaited_since = None;
        }
        out.push(Output::Event(GatewayEvent::StateChanged { from, to, cause: cause.to_owned() }));
    }

    /// Progress, and the level of the buffer.
    fn report_progress(&mut self, out: &mut Vec<Output>) {
        if !is_flying(self.state) || !self.buffer.course().aboard {
            return;
        }
        let current = match self.buffer.current() {
            // our own waypoints are not reported
            Some(w) if w.token == Token(0) => return,
            Some(w) => Some(w.token),
            None if self.buffer.at_end() && !is_safe(self.state) => None,
            None => return,
        };
        if self.reported == Some(current) || (self.reported.is_none() && current.is_none()) {
            return;
        }
        self.reported = Some(current);
        out.push(Output::Event(GatewayEvent::Progress { current, taken: self.highest }));
        out.push(Output::Save);
        self.report_level(out);
    }

    fn report_level(&mut self, out: &mut Vec<Output>) {
        let (waypoints, seconds) = self.level();
        let low = !self.is_complete() && (waypoints < views::LOW_WAYPOINTS || seconds < views::LOW_S);
        if low && !self.low_reported {
            out.push(Output::Event(GatewayEvent::BufferLow { waypoints, seconds }));
        }
        self.low_reported = low;
    }

    /// Cancels and appends, as one transaction.
    fn feed_driver(&mut self, cancel_after: Option<Token>, waypoints: Vec<Waypoint>, out: &mut Vec<Output>) {
        let order = self.buffer.feed(cancel_after, waypoints);
        self.control.fed = true;
        self.order(order, out);
    }

    fn forget_waypoints(&mut self, out: &mut Vec<Output>) {
        self.buffer.clear();
        self.list_lost = false;
        self.order(Order::Forget, out);
    }

    fn place(&self) -> Option<LatLon> {
        self.telemetry.fix.map(|(_, f)| f.position)
    }

    fn order(&mut self, order: Order, out: &mut Vec<Output>) -> OrderId {
        let id = self.control.next_id();
        out.push(Output::Order(id, order));
        id
    }
}

/// Seconds as a duration; nonsense gives zero.
fn seconds(s: f64) -> Duration {
    Duration::try_from_secs_f64(s).unwrap_or_default()
}
