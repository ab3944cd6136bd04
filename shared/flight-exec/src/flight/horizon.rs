//! The waypoints issued and not flown yet, and where the path goes on behind them.

use super::{Numbers, Offset, all_equivalent, both_or_none};
use crate::api::{Action, PlacePointer, Token, Waypoint};
use crate::layout::cursor::{Cursor, LayoutError};
use crate::layout::path::{PathState, distance_and_course};
use crate::layout::stretch::{Continuation, IssuedWaypoint, Stretch};
use crate::value::Choice;
use flight_plan::Id;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// What the aircraft steers to, and what follows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Horizon {
    issued: VecDeque<IssuedWaypoint>,
    /// Where the path goes on after the last waypoint issued.
    tail: Option<Cursor>,
    continuation: Continuation,
    /// True if choices were made after the last waypoint.
    tail_has_choices: bool,
    /// Passage (and its leg) whose beginning was announced. A wait at an intersection has the number of
    /// the passage that follows it: hence the leg.
    announced: Option<(u64, Id)>,
}

/// What became of the waypoints that were laid out anew.
pub(crate) struct Replaced {
    /// The waypoint after which everything is cancelled, if something is.
    pub cancel_after: Option<Token>,
    /// The number of the first waypoint that is new.
    pub first: usize,
    /// What can't be laid out.
    pub errors: Vec<LayoutError>,
}

impl Default for Horizon {
    fn default() -> Self {
        Self {
            issued: VecDeque::new(),
            tail: None,
            continuation: Continuation::Open,
            tail_has_choices: false,
            announced: None,
        }
    }
}

impl Horizon {
    /// The waypoint steered to.
    pub fn front(&self) -> Option<&IssuedWaypoint> {
        self.issued.front()
    }

    pub fn back(&self) -> Option<&IssuedWaypoint> {
        self.issued.back()
    }

    pub fn get(&self, index: usize) -> Option<&IssuedWaypoint> {
        self.issued.get(index)
    }

    pub fn iter(&self) -> impl ExactSizeIterator<Item = &IssuedWaypoint> {
        self.issued.iter()
    }

    pub fn len(&self) -> usize {
        self.issued.len()
    }

    pub fn is_empty(&self) -> bool {
        self.issued.is_empty()
    }

    /// Where the path goes on after the last waypoint issued.
    pub fn tail(&self) -> Option<&Cursor> {
        self.tail.as_ref()
    }

    pub fn continuation(&self) -> Continuation {
        self.continuation
    }

    /// The cursor before waypoint number `index`, or behind the last one; `None` before the start.
    pub fn bookmark(&self, index: usize) -> Option<&Cursor> {
        self.issued.get(index).map(|h| &h.before).or(self.tail.as_ref())
    }

    /// Every bookmark, and the place where the path goes on.
    pub fn bookmarks(&self) -> impl Iterator<Item = &Cursor> {
        let issued = self.issued.iter().flat_map(|h| [Some(&h.before), h.sealed.as_deref()]);
        issued.flatten().chain(&self.tail)
    }

    /// Likewise, to bring them to another plan or to give back what a snapshot keeps aside.
    pub fn bookmarks_mut(&mut self) -> impl Iterator<Item = &mut Cursor> {
        let issued = self.issued.iter_mut().flat_map(|h| [Some(&mut h.before), h.sealed.as_deref_mut()]);
        issued.flatten().chain(&mut self.tail)
    }

    /// There is a choice that may still turn out otherwise.
    pub fn has_provisional_choices(&self) -> bool {
        self.tail_has_choices || self.issued.iter().any(|h| !h.choices.is_empty())
    }

    /// An intersection is ahead whose choice may still turn out otherwise.
    pub fn has_forks(&self) -> bool {
        let is_fork = |choice: &Choice| matches!(choice, Choice::Branch { .. });
        self.issued.iter().any(|h| h.choices.iter().any(is_fork))
    }

    /// The plan ends behind the last waypoint, by choices that may still turn out otherwise.
    pub fn ends_by_choice(&self) -> bool {
        self.continuation == Continuation::Ended && self.tail_has_choices
    }

    /// The number of waypoints up to the last that can't be laid out anew.
    pub fn behind_pinned(&self) -> usize {
        self.issued.iter().rposition(|h| h.pinned).map_or(0, |i| i + 1)
    }

    /// The passage that was entered last, and its leg.
    pub fn entered(&self) -> Option<&(u64, Id)> {
        self.announced.as_ref()
    }

    /// The leg of a waypoint has been entered.
    pub fn is_entered(&self, issued: &IssuedWaypoint) -> bool {
        let announced = self.announced.as_ref();
        announced.is_some_and(|(passage, leg)| *passage == issued.passage && *leg == issued.place.leg)
    }

    /// The waypoint steered to, if its leg has been entered.
    pub fn front_entered(&self) -> Option<&IssuedWaypoint> {
        self.front().filter(|front| self.is_entered(front))
    }

    /// Copies of the waypoints from number `first` on.
    pub fn waypoints_from(&self, first: usize) -> Vec<Waypoint> {
        self.issued.iter().skip(first).map(|h| h.waypoint.clone()).collect()
    }

    /// The token after which everything is cancelled, to replace waypoints from `index` on.
    pub fn last_token_before(&self, index: usize) -> Token {
        let kept = index.checked_sub(1).and_then(|i| self.issued.get(i));
        kept.map_or(Token(0), |h| h.waypoint.token)
    }

    /// The leg of a waypoint is entered; gives the passage before it. `None`: it was entered already.
    pub fn enter(&mut self, issued: &IssuedWaypoint) -> Option<Option<(u64, Id)>> {
        if self.is_entered(issued) {
            return None;
        }
        Some(self.announced.replace((issued.passage, issued.place.leg.clone())))
    }

    /// Nothing of what is issued is flown.
    pub fn clear_issued(&mut self) {
        self.issued.clear();
    }

    /// Nothing is ahead any more.
    pub fn clear_path(&mut self) {
        self.issued.clear();
        self.tail = None;
    }

    /// The first so many waypoints have been flown.
    pub fn take_flown(&mut self, count: usize) -> Vec<IssuedWaypoint> {
        self.issued.drain(..count).collect()
    }

    /// Takes the waypoint steered to, to do something about it; it is put back by [`Horizon::put_front`].
    pub fn take_front(&mut self) -> Option<IssuedWaypoint> {
        self.issued.pop_front()
    }

    /// Puts a waypoint before all others.
    pub fn put_front(&mut self, issued: IssuedWaypoint) {
        self.issued.push_front(issued);
    }

    /// The choices that led to the waypoint steered to are made.
    pub fn take_choices(&mut self) -> Vec<Choice> {
        self.issued.front_mut().map(|h| std::mem::take(&mut h.choices)).unwrap_or_default()
    }

    /// From waypoint number `index` on, the path goes on from a cursor.
    pub fn cut(&mut self, index: usize, cursor: Cursor) {
        self.issued.truncate(index);
        self.tail = Some(cursor);
        self.continuation = Continuation::Open;
    }

    /// What flew nothing may do so by now.
    pub fn reopen(&mut self) {
        self.continuation = Continuation::Open;
    }

    /// Takes a stretch over behind what is issued, numbering its waypoints; gives what could not be laid out.
    pub fn append(&mut self, stretch: Stretch, numbers: &mut Numbers) -> Vec<LayoutError> {
        if let Some(last) = self.issued.back_mut().filter(|_| !stretch.issued.is_empty()) {
            last.waypoint.end_of_plan = false;
        }
        for mut issued in stretch.issued {
            issued.waypoint.token = numbers.next_token();
            numbers.passage_used(issued.passage);
            self.issued.push_back(issued);
        }
        self.tail = Some(stretch.tail);
        self.continuation = stretch.continuation;
        self.tail_has_choices = !stretch.tail_notes.is_empty();
        stretch.errors
    }

    /// A stretch takes the place of the waypoints from number `from` on. Those that come out the same stay as they were sent, so that
    /// many small changes don't add up unseen; the others get new numbers.
    pub fn replace(&mut self, from: usize, stretch: Stretch, numbers: &mut Numbers) -> Replaced {
        let old: Vec<IssuedWaypoint> = self.issued.drain(from..).collect();
        let same = old.iter().zip(&stretch.issued).take_while(|(a, b)| a.is_same_as(b)).count();
        let is_shorter = old.len() > same;
        let first = from + same;
        let before = numbers.token();
        let errors = self.append(stretch, numbers);
        numbers.back_to(before);
        for issued in self.issued.iter_mut().skip(first) {
            issued.waypoint.token = numbers.next_token();
        }
        for (issued, sent) in self.issued.iter_mut().skip(from).zip(old.into_iter().take(same)) {
            issued.waypoint = sent.waypoint;
        }
        let cancel_after = is_shorter.then(|| self.last_token_before(first));
        Replaced { cancel_after, first, errors }
    }

    /// Everything is sent once more, with new numbers.
    pub fn renumber(&mut self, numbers: &mut Numbers) {
        for issued in &mut self.issued {
            issued.waypoint.token = numbers.next_token();
        }
    }

    /// The bookmarks of the first so many no longer give them.
    pub fn pin(&mut self, count: usize) {
        self.issued.iter_mut().take(count).for_each(|issued| issued.pinned = true);
    }

    /// A loop around a waypoint will be flown so often.
    pub fn set_count(&mut self, index: usize, leg: &Id, count: u64) {
        self.issued.iter_mut().skip(index).take(1).for_each(|h| h.set_count(leg, count));
    }

    /// The leg is gone on with from the place where the hold was given: laid out anew, it doesn't begin behind the aircraft, and one
    /// that had not begun there, from wherever it is joined, is climbed to from there.
    pub fn rejoin_at(&mut self, rejoin: IssuedWaypoint) {
        if let Some(next) = self.issued.front_mut() {
            let mut path = next.before.path;
            path.last.position = rejoin.waypoint.position;
            path.course_deg = distance_and_course(rejoin.waypoint.position, next.waypoint.position).1;
            path.commanded_amsl_m = rejoin.waypoint.altitude_amsl_m;
            path.predicted_amsl_m = rejoin.waypoint.altitude_amsl_m;
            (path.distance_m, path.time_s) = (rejoin.end_m, rejoin.end_s);
            if next.before.passage == next.passage {
                (next.before.path, next.before.rejoined) = (path, None);
            } else {
                next.before = next.before.going_on_from(path);
            }
        }
        self.issued.push_front(rejoin);
    }

    /// A climb comes before the way, which begins behind it: `before` is where the climb begins. What is decided and passed where that leg
    /// begins is decided there, as it would be without a climb.
    pub fn climb_first(&mut self, climb: &PathState, before: Cursor, numbers: &mut Numbers) {
        let Some(next) = self.issued.front_mut() else { return };
        let mut first = IssuedWaypoint { before, wait_s: None, sealed: None, pinned: true, ..next.clone() };
        if next.waits_for_decision() {
            (first.choices, next.silent_legs) = (Vec::new(), Vec::new());
        } else {
            (first.choices, first.silent_legs) = next.seal();
        }
        let PathState { last, commanded_amsl_m, distance_m, time_s, .. } = climb;
        first.waypoint = Waypoint {
            position: last.position,
            altitude_amsl_m: *commanded_amsl_m,
            airspeed_mps: last.airspeed_mps,
            action: Action::Fly,
            fly_over: true,
            on_arc: false,
            end_of_plan: false,
            ..first.waypoint
        };
        (first.end_m, first.end_s) = (*distance_m, *time_s);
        self.issued.push_front(first);
        self.renumber(numbers);
    }

    /// In another plan: the cursors behind the choices that led to each waypoint.
    pub fn set_sealed(&mut self, sealed: impl IntoIterator<Item = Option<Box<Cursor>>>) {
        for (issued, sealed) in self.issued.iter_mut().zip(sealed) {
            issued.sealed = sealed;
        }
    }

    /// In another plan: the bookmarks of the waypoints that stay, and where those are by now.
    pub fn carry_over(&mut self, kept: &[Cursor], places: Vec<(PlacePointer, Vec<u64>)>) {
        for ((issued, bookmark), (place, activations)) in self.issued.iter_mut().zip(kept).zip(places) {
            issued.before = bookmark.clone();
            issued.pinned = true;
            if place.leg == issued.place.leg {
                (issued.place, issued.activations) = (place, activations);
            }
        }
    }

    pub fn is_equivalent(&self, other: &Self, offset: &Offset) -> bool {
        let Self { issued, tail, continuation, tail_has_choices, announced } = self;
        let same_passage = |a: &(u64, Id), b: &(u64, Id)| a.1 == b.1 && offset.passage(a.0, b.0);
        (continuation, tail_has_choices) == (&other.continuation, &other.tail_has_choices)
            && both_or_none(announced, &other.announced, same_passage)
            && both_or_none(tail, &other.tail, |a, b| offset.cursors(a, b))
            && all_equivalent(issued, &other.issued, |a, b| offset.issued(a, b))
    }
}
