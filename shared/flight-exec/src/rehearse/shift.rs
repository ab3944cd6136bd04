//! Taking over the rest of a former flight: its times, sums and numbers are others now.

use super::Preview;
use super::situation::{Situation, microseconds, seconds};
use crate::api::{Event, Time, Token};

/// How many entries of each list of a preview there are up to a certain point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Marks {
    pub track: usize,
    waypoints: usize,
    events: usize,
    refusals: usize,
    proposals: usize,
    legs: usize,
    stops: usize,
}

/// From one point to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Between(Marks, Marks);

/// How far marks have moved.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moved(Marks, Marks);

impl Marks {
    fn of(preview: &Preview) -> Self {
        Self {
            track: preview.track.len(),
            waypoints: preview.waypoints.len(),
            events: preview.events.len(),
            refusals: preview.refusals.len(),
            proposals: preview.proposals.len(),
            legs: preview.legs.len(),
            stops: preview.stops.len(),
        }
    }

    fn each(self, other: Self, of: impl Fn(usize, usize) -> usize) -> Self {
        Self {
            track: of(self.track, other.track),
            waypoints: of(self.waypoints, other.waypoints),
            events: of(self.events, other.events),
            refusals: of(self.refusals, other.refusals),
            proposals: of(self.proposals, other.proposals),
            legs: of(self.legs, other.legs),
            stops: of(self.stops, other.stops),
        }
    }

    /// Behind what was flown from here on.
    pub fn after(self, flown: &Preview) -> Self {
        self.each(Self::of(flown), |before, more| before + more)
    }

    pub fn until(self, end: Self) -> Between {
        Between(self, end)
    }

    pub fn until_end(self, preview: &Preview) -> Between {
        Between(self, Self::of(preview))
    }

    /// What was here is there now.
    pub fn to(self, there: Self) -> Moved {
        Moved(self, there)
    }

    /// Moved as far as other marks.
    pub fn moved(self, by: Moved) -> Self {
        let Moved(from, to) = by;
        self.each(from, |n, from| n - from).each(to, |n, to| n + to)
    }
}

impl Between {
    /// Puts what was flown in the place of what is between.
    pub fn replace(self, preview: &mut Preview, flown: Preview) {
        let Between(a, b) = self;
        preview.track.splice(a.track..b.track, flown.track);
        preview.waypoints.splice(a.waypoints..b.waypoints, flown.waypoints);
        preview.events.splice(a.events..b.events, flown.events);
        preview.refusals.splice(a.refusals..b.refusals, flown.refusals);
        preview.proposals.splice(a.proposals..b.proposals, flown.proposals);
        preview.legs.splice(a.legs..b.legs, flown.legs);
        preview.stops.splice(a.stops..b.stops, flown.stops);
    }
}

/// What is to be added to whatever comes behind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shift {
    time_us: i64,
    distance_m: f64,
    energy_j: f64,
    tokens: i64,
    /// Numbers of passages as actions report them.
    passages: i64,
    /// Indices of passages, and counts of waypoints.
    indices: isize,
    waypoints: isize,
}

impl Shift {
    /// From a situation to an equivalent one, later or earlier.
    pub fn between(from: &Situation, to: &Situation) -> Self {
        let token = |at: &Situation| at.renumbering.token(at.executor.last_token().0) as i64;
        let passage = |at: &Situation| at.renumbering.passage(at.executor.numbers().passage()) as i64;
        Self {
            time_us: to.now_us as i64 - from.now_us as i64,
            distance_m: to.distance_m - from.distance_m,
            energy_j: to.used_j() - from.used_j(),
            tokens: token(to) - token(from),
            passages: passage(to) - passage(from),
            indices: to.passages as isize - from.passages as isize,
            waypoints: to.waypoints as isize - from.waypoints as isize,
        }
    }

    pub fn is_nothing(&self) -> bool {
        let numbers = (self.time_us, self.tokens, self.passages, self.indices, self.waypoints);
        numbers == (0, 0, 0, 0, 0) && self.distance_m == 0.0 && self.energy_j == 0.0
    }

    fn time_s(&self, time_s: f64) -> f64 {
        seconds(microseconds(time_s).saturating_add_signed(self.time_us))
    }

    fn index(&self, index: Option<usize>) -> Option<usize> {
        index.map(|i| i.saturating_add_signed(self.indices))
    }

    /// To what a preview has behind certain marks. It has no stops there: a plan of several flights takes over no former flight.
    pub fn apply(&self, preview: &mut Preview, behind: Marks) {
        for point in preview.track.iter_mut().skip(behind.track) {
            point.time_s = self.time_s(point.time_s);
            point.passage = self.index(point.passage);
        }
        for flown in preview.waypoints.iter_mut().skip(behind.waypoints) {
            flown.from_s = self.time_s(flown.from_s);
            flown.passage = self.index(flown.passage);
            flown.waypoint.token = Token(flown.waypoint.token.0.saturating_add_signed(self.tokens));
        }
        for (time_s, event) in preview.events.iter_mut().skip(behind.events) {
            *time_s = self.time_s(*time_s);
            if let Event::ActionDone { passage, .. } | Event::ActionRefused { passage, .. } = event {
                *passage = passage.saturating_add_signed(self.passages);
            }
        }
        preview.refusals.iter_mut().skip(behind.refusals).for_each(|(t, _)| *t = self.time_s(*t));
        preview.proposals.iter_mut().skip(behind.proposals).for_each(|(t, _)| *t = self.time_s(*t));
        for passage in preview.legs.iter_mut().skip(behind.legs) {
            passage.start_s = self.time_s(passage.start_s);
            passage.end_s = self.time_s(passage.end_s);
        }
    }

    /// To a situation. The executor keeps its own numbers and clock, which count from wherever they like.
    pub fn apply_to(&self, at: &mut Situation) {
        let moved = |us: u64| us.saturating_add_signed(self.time_us);
        at.now_us = moved(at.now_us);
        at.stepped_us = moved(at.stepped_us);
        for due_us in [&mut at.due.report_us, &mut at.due.track_us, &mut at.due.advance_us] {
            *due_us = moved(*due_us);
        }
        at.moment.time_s = at.time_s();
        let last_step = at.executor.last_step().map(|_| Time::from_micros(at.stepped_us));
        at.executor.set_last_step(last_step);
        at.distance_m += self.distance_m;
        at.aircraft.use_energy(self.energy_j);
        at.passages = at.passages.saturating_add_signed(self.indices);
        at.waypoints = at.waypoints.saturating_add_signed(self.waypoints);
        at.renumbering.tokens += self.tokens;
        at.renumbering.passages += self.passages;
        if let Some(passage) = &mut at.passage {
            passage.start_s = self.time_s(passage.start_s);
            passage.end_s = self.time_s(passage.end_s);
            passage.distance_m += self.distance_m;
            passage.energy_j += self.energy_j;
        }
        if let Some(steered) = &mut at.steered {
            steered.from_s = self.time_s(steered.from_s);
            steered.passage = self.index(steered.passage);
        }
    }
}
