//! Handing out: topping the horizon up, and laying the path out anew when something has changed.

use super::Executor;
use crate::api::{Output, Token};
use crate::flight::Replaced;
use crate::layout::cursor::{Cursor, LayoutError};
use crate::layout::stretch::{Continuation, Stretch, lay_out};
use flight_plan::Id;

/// The seconds of the horizon are counted from behind so many waypoints. So what follows a long line is handed out before that begins:
/// an autopilot that is given a new list in the middle of a line may leave it.
const AT_HAND: usize = 3;

impl Executor {
    /// Tops the horizon up.
    pub(super) fn fill(&mut self, out: &mut Vec<Output>) {
        let first = self.flight.horizon.len();
        self.lengthen(out);
        self.feed(None, first, out);
    }

    /// Lays out what is missing to the horizon, without feeding it.
    fn lengthen(&mut self, out: &mut Vec<Output>) {
        let horizon = &self.flight.horizon;
        if self.is_muted() || horizon.continuation() != Continuation::Open {
            return;
        }
        let mut more = self.asks_for_more(horizon.len());
        let Some(tail) = horizon.tail().filter(|t| more(0, t)) else { return };
        let stretch = lay_out(tail, &self.world(), false, false, more);
        self.append(stretch, out);
    }

    /// Asks for more until there are enough waypoints ahead, and enough seconds behind those at hand. `kept`: so many waypoints come
    /// before what is laid out.
    fn asks_for_more(&self, kept: usize) -> impl FnMut(usize, &Cursor) -> bool + use<> {
        let c = &self.setup.config;
        let (most, least, horizon_s) =
            (c.horizon_waypoints.max(4), c.least_waypoints.max(2), c.horizon_s.max(60.0));
        let mut at_hand_s = self.flight.horizon.bookmark(AT_HAND).map_or(0.0, |behind| behind.path.time_s);
        move |new, cursor| {
            let ahead = kept + new;
            if ahead <= AT_HAND {
                at_hand_s = cursor.path.time_s;
            }
            ahead < most && (ahead < least || cursor.path.time_s - at_hand_s < horizon_s)
        }
    }

    /// Takes a stretch over behind what is issued.
    fn append(&mut self, stretch: Stretch, out: &mut Vec<Output>) {
        let errors = self.flight.horizon.append(stretch, &mut self.life.numbers);
        self.laid_out(errors, out);
    }

    /// Something was laid out: reports what could not be, and holds where nothing will ever follow.
    fn laid_out(&mut self, errors: Vec<LayoutError>, out: &mut Vec<Output>) {
        for error in errors {
            self.flight.reported.report(error, out);
        }
        if self.flight.horizon.continuation() == Continuation::Stalled {
            self.stalled(out);
        }
    }

    /// A loop without waypoints: nothing will ever follow, so the aircraft holds where its path ends.
    fn stalled(&mut self, out: &mut Vec<Output>) {
        let leg = self.flight.horizon.tail().and_then(|t| t.loop_ids(&self.world()).pop());
        let reason = "this loop flies no waypoint; change its body by a plan update, or go to another leg";
        let leg = leg.unwrap_or_else(|| Id::new("plan"));
        self.flight.reported.report(LayoutError::Leg { leg, reason: reason.into() }, out);
        if self.flight.horizon.is_empty() {
            self.hold(out);
        }
    }

    fn feed(&self, cancel_after: Option<Token>, first: usize, out: &mut Vec<Output>) {
        let horizon = &self.flight.horizon;
        if !self.is_muted() && (cancel_after.is_some() || horizon.len() > first) {
            out.push(Output::Feed { cancel_after, waypoints: horizon.waypoints_from(first) });
        }
    }

    /// How many of the waypoints ahead can't be altered.
    pub(crate) fn alterable_from(&self) -> usize {
        self.path_ahead().alterable_from()
    }

    /// Lays the path out anew behind what can't be altered, and feeds what differs.
    pub(super) fn replan(&mut self, out: &mut Vec<Output>) {
        self.replan_from(self.alterable_from(), false, out);
    }

    /// Lays the path out anew from waypoint number `from` on: see [`Executor::replan_with`].
    pub(super) fn replan_from(&mut self, from: usize, arriving: bool, out: &mut Vec<Output>) {
        self.replan_with(from, self.bookmark(from), arriving, out);
    }

    /// The cursor before waypoint number `index`, or behind the last one; before the start the one that starts.
    pub(crate) fn bookmark(&self, index: usize) -> Cursor {
        let start = || Cursor::start(None, self.here(), self.life.numbers.passage());
        self.flight.horizon.bookmark(index).cloned().unwrap_or_else(start)
    }

    /// Replaces the waypoints from number `from` on by what `cursor` gives. Waypoints that come out the same keep their
    /// numbers; one transaction cancels and appends the rest.
    pub(super) fn replan_with(&mut self, from: usize, cursor: Cursor, arriving: bool, out: &mut Vec<Output>) {
        let from = from.min(self.flight.horizon.len());
        let at_least = self.flight.horizon.len() - from;
        let kept = from.checked_sub(1).and_then(|i| self.flight.horizon.get(i));
        let marked = kept.is_some_and(|h| h.waypoint.end_of_plan);
        let lay_out = |cursor: &Cursor| {
            let mut more = self.asks_for_more(from);
            lay_out(cursor, &self.world(), arriving, marked, |n, c| more(n, c) || n < at_least)
        };
        let mut stretch = lay_out(&cursor);
        if from == 0 && self.is_led_elsewhere(&stretch) {
            stretch = lay_out(&cursor.going_on_from(self.here()));
        }
        let replaced = self.flight.horizon.replace(from, stretch, &mut self.life.numbers);
        let Replaced { cancel_after, first, errors } = replaced;
        self.laid_out(errors, out);
        self.feed(cancel_after, first, out);
        self.settle(out);
    }

    /// The leg that has begun leads from here to another place than the one steered to: the way to it, and the climb, begin where the
    /// aircraft is, so that the distance flown counts on.
    fn is_led_elsewhere(&self, stretch: &Stretch) -> bool {
        let horizon = &self.flight.horizon;
        let first = stretch.issued.first().filter(|first| horizon.is_entered(first));
        horizon.front().zip(first).is_some_and(|(old, new)| !old.is_where(new))
    }

    /// Goes from here to wherever `cursor` is, near the ground by a climb straight ahead: everything not flown is cancelled.
    pub(super) fn jump(&mut self, mut cursor: Cursor, out: &mut Vec<Output>) {
        // without an engine, or with a hill ahead, there is no climb
        let climb = self.go_around(&cursor).ok().flatten();
        cursor.passage = self.life.numbers.passage();
        // a count belongs to an activation: that of a loop which is left is forgotten
        let around = cursor.loop_ids(&self.world());
        self.flight.overrides.retain_counts(|leg| around.contains(leg));
        self.begin_anew_what_was_left(&mut cursor, &around);
        if cursor.section.is_none() {
            self.flight.emergencies.end();
        }
        self.flight.emergencies.takes_stopped_engine();
        self.flight.emergencies.another_way();
        self.flight.horizon.clear_issued();
        self.flight.questions.forget_distant();
        self.life.mode.forget_place();
        self.flight.questions.forget_defaults();
        // somebody has asked for the way ahead: what is wrong with it is reported, reported before or not
        self.flight.reported.clear();
        let before = cursor.clone();
        if let Some(climb) = climb {
            cursor.climb_first(climb);
        }
        let more = self.asks_for_more(0);
        let stretch = lay_out(&cursor, &self.world(), false, false, more);
        self.append(stretch, out);
        if let Some(climb) = climb {
            self.flight.horizon.climb_first(&climb, before, &mut self.life.numbers);
        }
        self.flight.acting.abandon_but_around(self.flight.horizon.front());
        self.flight.overrides.abandon_wait();
        // until another leg is entered, a loop on the way out may be gone back to: by a count, or a condition
        if let Some(mut front) = self.flight.horizon.take_front() {
            self.begin_anew_what_was_left(&mut front.before, &around);
            self.flight.horizon.put_front(front);
        }
        self.feed(Some(Token(0)), 0, out);
        self.settle(out);
    }

    /// A loop whose actions are not followed was left, or is entered here: what comes is another activation of it. A count that was set
    /// before, or on the way to the loop, is that of the loop as it is entered now.
    fn begin_anew_what_was_left(&mut self, cursor: &mut Cursor, around: &[Id]) {
        for (frame, id) in cursor.loops.iter_mut().zip(around) {
            let acts = self.setup.program.leg(id).is_some_and(|leg| !leg.actions.is_empty());
            if acts && !self.flight.acting.follows(id, frame.activation) {
                frame.activation = cursor.passage;
            }
            self.flight.overrides.move_counts(id, frame.activation);
        }
    }

    /// Sends everything ahead once more, with new numbers: the gateway may have lost it.
    pub(super) fn refeed(&mut self, out: &mut Vec<Output>) {
        self.flight.horizon.renumber(&mut self.life.numbers);
        // nothing is left ahead where all of it was refused: the way on belongs to the same transaction
        self.lengthen(out);
        self.feed(Some(Token(0)), 0, out);
        self.settle(out);
    }

    /// Waiting for a decision or not, or for a time, whatever it steers to.
    pub(super) fn settle(&mut self, out: &mut Vec<Output>) {
        let front = self.flight.horizon.front();
        self.flight.overrides.settle_wait(front);
        self.life.mode.settle(front.is_some_and(|front| front.waits_for_decision()), out);
    }
}
