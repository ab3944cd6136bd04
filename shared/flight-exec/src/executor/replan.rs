//! Handing out: topping the horizon up, and laying the path out anew when something has changed.

use crate::api::{Action, Event, Output, Phase, Token, Waypoint};
use crate::executor::Executor;
use crate::layout::cursor::{Cursor, LayoutError};
use crate::layout::stretch::{Continuation, IssuedWaypoint, Stretch, lay_out};
use flight_plan::Id;

/// Most errors remembered so that they are told once.
const MOST_TOLD: usize = 16;

impl Executor {
    /// Tops the horizon up.
    pub(crate) fn fill(&mut self, out: &mut Vec<Output>) {
        let first = self.state.issued.len();
        self.lengthen(out);
        self.feed(None, first, out);
    }

    /// Lays out what is missing to the horizon, without feeding it.
    fn lengthen(&mut self, out: &mut Vec<Output>) {
        if self.is_muted() || self.state.continuation != Continuation::Open {
            return;
        }
        let more = self.horizon(self.state.issued.len(), self.time_made_s());
        let Some(tail) = self.state.tail.as_ref().filter(|t| more(0, t)) else { return };
        let stretch = lay_out(tail, &self.world(), false, false, more);
        self.append(stretch, out);
    }

    /// Asks for more until there are enough waypoints and seconds ahead.
    fn horizon(&self, count: usize, from_s: f64) -> impl Fn(usize, &Cursor) -> bool + use<> {
        let c = &self.config;
        let (most, least, horizon_s) =
            (c.horizon_waypoints.max(4), c.least_waypoints.max(2), c.horizon_s.max(60.0));
        move |new, cursor| {
            let ahead = count + new;
            ahead < most && (ahead < least || cursor.path.time_s - from_s < horizon_s)
        }
    }

    /// Takes a stretch over behind what is issued, numbering its waypoints.
    fn append(&mut self, stretch: Stretch, out: &mut Vec<Output>) {
        if let Some(last) = self.state.issued.back_mut().filter(|_| !stretch.issued.is_empty()) {
            last.waypoint.end_of_plan = false;
        }
        for mut issued in stretch.issued {
            self.state.last_token += 1;
            issued.waypoint.token = Token(self.state.last_token);
            self.state.last_passage = self.state.last_passage.max(issued.passage);
            self.state.issued.push_back(issued);
        }
        self.state.tail = Some(stretch.tail);
        self.state.continuation = stretch.continuation;
        self.state.tail_has_choices = !stretch.tail_notes.is_empty();
        for trouble in stretch.errors {
            self.tell_trouble(trouble, out);
        }
        if stretch.continuation == Continuation::Stalled {
            self.stalled(out);
        }
    }

    /// Tells what doesn't work, once as long as nothing is done about it.
    pub(crate) fn tell_trouble(&mut self, trouble: LayoutError, out: &mut Vec<Output>) {
        if self.state.told.contains(&trouble) {
            return;
        }
        self.state.told.truncate(MOST_TOLD - 1);
        self.state.told.insert(0, trouble.clone());
        out.push(Output::Event(match trouble {
            LayoutError::Leg { leg, reason } | LayoutError::Ground { leg, reason } => {
                Event::PatternRefused { leg, reason }
            }
            LayoutError::Expression { leg, reason } => Event::ExpressionFailed { leg, reason },
        }));
    }

    /// A loop without waypoints: nothing will ever follow, so the aircraft holds where its path ends.
    fn stalled(&mut self, out: &mut Vec<Output>) {
        let leg = self.state.tail.as_ref().and_then(|t| t.loop_ids(&self.world()).pop());
        let reason = "this loop flies no waypoint; change its body by a plan update, or go to another leg";
        let leg = leg.unwrap_or_else(|| Id::new("plan"));
        self.tell_trouble(LayoutError::Leg { leg, reason: reason.into() }, out);
        if self.state.issued.is_empty() {
            self.hold(out);
        }
    }

    fn feed(&self, cancel_after: Option<Token>, first: usize, out: &mut Vec<Output>) {
        let waypoints: Vec<_> = self.state.issued.iter().skip(first).map(|h| h.waypoint.clone()).collect();
        if !self.is_muted() && (cancel_after.is_some() || !waypoints.is_empty()) {
            out.push(Output::Feed { cancel_after, waypoints });
        }
    }

    /// How many of the waypoints ahead can't be altered: those nearer than the stopping distance (turn and
    /// latency), and those whose pattern has been regenerated behind them.
    pub(crate) fn alterable_from(&self) -> usize {
        let pinned = self.state.issued.iter().rposition(|h| h.pinned).map_or(0, |i| i + 1);
        pinned.max(self.kept_by_distance())
    }

    /// Nearer than this nothing is altered: the radius of a turn, and the way made until an order takes effect, metres.
    pub(crate) fn stopping_distance_m(&self) -> f64 {
        let speed_mps = self.state.aircraft.as_ref().map_or(0.0, |a| a.ground_speed_mps);
        let speed_mps = speed_mps.max(self.profile.min_airspeed_mps);
        self.profile.turn_radius_m(speed_mps) + self.config.latency_s * speed_mps
    }

    fn kept_by_distance(&self) -> usize {
        let Some(front) = self.state.issued.front().filter(|h| !h.is_loiter()) else { return 0 };
        if !matches!(front.waypoint.action, Action::Fly) {
            return 1;
        }
        if self.state.aircraft.is_none() {
            return 1;
        }
        let stop_m = self.stopping_distance_m();
        let to_front_m = self.to_current_m();
        // a circle can be left wherever it is
        let near = |h: &&IssuedWaypoint| !h.is_loiter() && to_front_m + h.end_m - front.end_m <= stop_m;
        self.state.issued.iter().take_while(near).count()
    }

    /// Lays the path out anew behind what can't be altered, and feeds what differs.
    pub(crate) fn replan(&mut self, out: &mut Vec<Output>) {
        self.replan_from(self.alterable_from(), false, out);
    }

    /// Lays the path out anew from waypoint number `from` on: see [`Executor::replan_with`].
    pub(crate) fn replan_from(&mut self, from: usize, arriving: bool, out: &mut Vec<Output>) {
        self.replan_with(from, self.bookmark(from), arriving, out);
    }

    /// The cursor before waypoint number `index`, or behind the last one; before the start the one that starts.
    pub(crate) fn bookmark(&self, index: usize) -> Cursor {
        let laid_out = self.state.issued.get(index).map(|h| &h.before).or(self.state.tail.as_ref());
        laid_out.cloned().unwrap_or_else(|| Cursor::start(None, self.here(), self.state.last_passage))
    }

    /// Replaces the waypoints from number `from` on by what `cursor` gives. Waypoints that come out the same keep their
    /// numbers; one transaction cancels and appends the rest.
    pub(crate) fn replan_with(&mut self, from: usize, cursor: Cursor, arriving: bool, out: &mut Vec<Output>) {
        let from = from.min(self.state.issued.len());
        let old: Vec<IssuedWaypoint> = self.state.issued.iter().skip(from).cloned().collect();
        let more = self.horizon(from, self.time_made_s());
        let at_least = old.len();
        let kept = from.checked_sub(1).and_then(|i| self.state.issued.get(i));
        let marked = kept.is_some_and(|h| h.waypoint.end_of_plan);
        let lay_out =
            |from: &Cursor| lay_out(from, &self.world(), arriving, marked, |n, c| n < at_least || more(n, c));
        let mut stretch = lay_out(&cursor);
        if from == 0 && self.is_led_elsewhere(&stretch) {
            stretch = lay_out(&cursor.going_on_from(self.here()));
        }
        let same = old.iter().zip(&stretch.issued).take_while(|(a, b)| a.is_same_as(b)).count();
        let sent: Vec<Waypoint> = old.iter().take(same).map(|h| h.waypoint.clone()).collect();
        self.state.issued.truncate(from);
        let before = self.state.last_token;
        let appended = stretch.issued.len() - same;
        self.append(stretch, out);
        self.keep_sent(from, sent, before);
        let cancel = (old.len() > same).then(|| self.last_token_before(from + same));
        if cancel.is_some() || appended > 0 {
            self.feed(cancel, from + same, out);
        }
        self.settle_phase(out);
    }

    /// The leg that has begun leads from here to another place than the one steered to: the way to it, and the climb, begin where the
    /// aircraft is, so that the way made counts on.
    fn is_led_elsewhere(&self, stretch: &Stretch) -> bool {
        let first = stretch.issued.first().filter(|first| self.is_announced(first));
        self.state.issued.front().zip(first).is_some_and(|(old, new)| !old.is_where(new))
    }

    /// Waypoints that stayed the same stay as they were sent, so that many small changes don't add up unseen; the others count on
    /// from `before`.
    fn keep_sent(&mut self, from: usize, sent: Vec<Waypoint>, before: u64) {
        let appended = self.state.issued.len().saturating_sub(from + sent.len());
        self.state.last_token = before + appended as u64;
        let numbers = (before + 1..).map(Token);
        for (issued, token) in self.state.issued.iter_mut().skip(from + sent.len()).zip(numbers) {
            issued.waypoint.token = token;
        }
        for (issued, waypoint) in self.state.issued.iter_mut().skip(from).zip(sent) {
            issued.waypoint = waypoint;
        }
    }

    /// The token after which everything is cancelled, to replace waypoints from `index` on.
    fn last_token_before(&self, index: usize) -> Token {
        let kept = index.checked_sub(1).and_then(|i| self.state.issued.get(i));
        kept.map_or(Token(0), |h| h.waypoint.token)
    }

    /// Goes from here to wherever `cursor` is: everything not flown is cancelled.
    pub(crate) fn jump(&mut self, mut cursor: Cursor, out: &mut Vec<Output>) {
        cursor.passage = self.state.last_passage;
        // a count belongs to an activation: that of a loop which is left is forgotten
        let around = cursor.loop_ids(&self.world());
        self.state.counts.retain(|c| around.contains(&c.leg));
        self.begin_anew_what_was_left(&mut cursor, &around);
        if cursor.section.is_none() {
            self.state.emergency = None;
        }
        self.state.issued.clear();
        self.state.ahead = None;
        self.state.held_at = None;
        self.forget_defaults();
        // somebody has asked for the way ahead: what is wrong with it is told, told before or not
        self.state.told.clear();
        let more = self.horizon(0, cursor.path.time_s);
        let stretch = lay_out(&cursor, &self.world(), false, false, more);
        self.append(stretch, out);
        self.abandon_passages();
        // until another leg is entered, a loop on the way out may be gone back to: by a count, or a condition
        if let Some(mut front) = self.state.issued.pop_front() {
            self.begin_anew_what_was_left(&mut front.before, &around);
            self.state.issued.push_front(front);
        }
        self.feed(Some(Token(0)), 0, out);
        self.settle_phase(out);
    }

    /// A loop whose actions are not followed was left, or is entered here: what comes is another activation of it. A count that was set
    /// before, or on the way to the loop, is that of the loop as it is entered now.
    fn begin_anew_what_was_left(&mut self, cursor: &mut Cursor, around: &[Id]) {
        for (frame, id) in cursor.loops.iter_mut().zip(around) {
            let acts = self.program.leg(id).is_some_and(|leg| !leg.actions.is_empty());
            let is_followed = self.state.passages.iter().any(|p| p.is(id, frame.activation));
            if acts && !is_followed {
                frame.activation = cursor.passage;
            }
            let counts = self.state.counts.iter_mut().filter(|c| c.leg == *id);
            counts.filter_map(|c| c.activation.as_mut()).for_each(|of| *of = frame.activation);
        }
    }

    /// Sends everything ahead once more, with new numbers: the gateway may have lost it.
    pub(crate) fn refeed(&mut self, out: &mut Vec<Output>) {
        for issued in &mut self.state.issued {
            self.state.last_token += 1;
            issued.waypoint.token = Token(self.state.last_token);
        }
        // nothing is left ahead where all of it was refused: the way on belongs to the same transaction
        self.lengthen(out);
        self.feed(Some(Token(0)), 0, out);
        self.settle_phase(out);
    }

    /// Waiting for a decision or not, or for a time, whatever it steers to.
    pub(crate) fn settle_phase(&mut self, out: &mut Vec<Output>) {
        let front = self.state.issued.front();
        self.state.wait =
            self.state.wait.filter(|w| front.is_none_or(|h| h.is_loiter() && w.passage == h.passage));
        let waits = self.state.issued.front().is_some_and(IssuedWaypoint::waits_for_decision);
        match self.state.phase {
            Phase::Flying if waits => self.enter_phase(Phase::AwaitingDecision, out),
            Phase::AwaitingDecision if !waits => self.enter_phase(Phase::Flying, out),
            _ => {}
        }
    }
}
