//! The preview of a plan that is being edited: what an edit doesn't reach is not flown again.
//!
//! A flight is kept in stretches: the situation in which each begins, and which stages and legs were read on it. A stretch
//! stays valid as long as it begins in the same situation and what it read is unchanged. So after an edit the flight is
//! resumed at the beginning of the first stretch that read something that has changed, and flown until a leg begins just as it did
//! before ([`are_equivalent`]). From there on the former flight is taken over, with its times and numbers shifted. The result
//! is what a whole new preview would give: the same waypoints at the same times, distances and energy, except for the rounding of
//! sums. The path rejoins quickly because the preview restarts at every waypoint (see `flight`).
//!
//! If conditions depend on time, energy, motion or place, the former flight is only kept up to the edit. If a
//! runway, a variable or the order of stages has changed, the plan is flown as a whole. The window works like this at each frame of
//! a drag; hash and review follow when the plan is left alone.

mod diversion;

pub(crate) use diversion::end_in_ground;
pub use diversion::{Diversion, Glided, Powered, glide_instead};

use super::changes::{Changes, reads_flight};
use super::equivalence::are_equivalent;
use super::flight::{Circumstances, Flight, Progress, empty};
use super::shift::{Marks, Shift};
use super::situation::Situation;
use super::{Options, Preview, PreviewError, Scenario, Start};
use aircraft::{Profile, Winds};
use flight_plan::{Id, Program};
use foldhash::{HashMap, HashMapExt};
use std::sync::Arc;
use terrain::Terrain;

/// Waypoints on a stretch, at least, as long as there are few stretches.
const WAYPOINTS: usize = 8;
/// Most stretches remembered, some tens of kilobytes each: beyond, they become longer.
const MAX_STRETCHES: usize = 1536;

/// A preview for plan after plan, of one aircraft in the same winds, with the same scenario.
pub struct Rehearsal {
    profile: Profile,
    terrain: Arc<dyn Terrain>,
    winds: Winds,
    options: Options,
    scenario: Scenario,
    flown: Option<Flown>,
}

/// How much of the former track is in the new one, unchanged but for the time and the numbers of passages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kept {
    /// Points at the beginning; nothing about them has changed.
    pub head: usize,
    /// Points at the end.
    pub tail: usize,
}

struct Flown {
    program: Arc<Program>,
    /// What is in the place of the plan where it isn't kept.
    none: Arc<Program>,
    start: Start,
    reads_flight: bool,
    stretches: Vec<Stretch>,
    every: usize,
    preview: Preview,
    end: Situation,
    outcome: Result<(), PreviewError>,
    /// Where it ends now has to be found out.
    unfinished: bool,
    kept: Kept,
}

/// A part of the flight, from one beginning of a leg to another.
struct Stretch {
    /// Without the plan; `None`: at the start of the flight.
    begin: Option<Box<Situation>>,
    before: Marks,
    /// Stages and legs that what happened on it depends on.
    reads: Vec<Id>,
}

impl Rehearsal {
    /// Nothing flown yet; nobody does anything in these flights.
    pub fn new(
        profile: Profile,
        terrain: Arc<dyn Terrain>,
        winds: impl Into<Winds>,
        options: Options,
    ) -> Self {
        let (winds, scenario) = (winds.into(), Scenario::default());
        Self { profile, terrain, winds, options, scenario, flown: None }
    }

    /// The same, with things done in each flight.
    #[must_use]
    pub fn with(self, scenario: Scenario) -> Self {
        Self { scenario, flown: None, ..self }
    }

    /// Flies a plan. As much of it as was flown before is kept.
    ///
    /// # Errors
    /// As [`super::preview_as_far_as_possible`], and `Cancelled`. A flight that ends too early ([`PreviewError::TooLong`], [`PreviewError::OutOfEnergy`] and the
    /// like) is there up to its end all the same.
    pub fn fly(
        &mut self,
        program: &Arc<Program>,
        start: Start,
        progress: Progress,
    ) -> Result<(), PreviewError> {
        let given = Circumstances { winds: self.winds, scenario: &self.scenario, options: &self.options };
        let known = self.flown.take().filter(|flown| flown.start == start);
        let mut flown = match known.and_then(|flown| flown.revised(program)) {
            Some((mut flown, changes)) => {
                flown.update(given, &changes, progress)?;
                flown
            }
            None => {
                let flight = Flight::new(program, &self.profile, &self.terrain, start, given, true)?;
                Flown::whole(program, start, flight, progress)?
            }
        };
        flown.thin_out();
        let outcome = flown.outcome.clone();
        self.flown = Some(flown);
        outcome
    }

    /// The last flight, if there was one.
    pub fn preview(&self) -> Option<&Preview> {
        self.flown.as_ref().map(|flown| &flown.preview)
    }

    /// What the last flight has in common with the one before.
    pub fn kept(&self) -> Kept {
        self.flown.as_ref().map_or(Kept { head: 0, tail: 0 }, |flown| flown.kept)
    }
}

impl Flown {
    fn whole(
        program: &Arc<Program>,
        start: Start,
        flight: Flight,
        progress: Progress,
    ) -> Result<Self, PreviewError> {
        let mut flown = Self {
            program: program.clone(),
            none: Arc::default(),
            start,
            reads_flight: reads_flight(program),
            stretches: vec![Stretch { begin: None, before: Marks::default(), reads: Vec::new() }],
            every: WAYPOINTS,
            preview: empty(),
            end: flight.at.clone(),
            outcome: Ok(()),
            unfinished: false,
            kept: Kept { head: 0, tail: 0 },
        };
        flown.fly_on(0, flight, progress)?;
        flown.kept = Kept { head: 0, tail: 0 };
        Ok(flown)
    }

    /// With another plan to be flown, and what that changes; `None`: everything.
    fn revised(mut self, program: &Arc<Program>) -> Option<(Self, Changes)> {
        let changes = Changes::between(&self.program, program)?;
        let reads_flight = if changes.is_empty() { self.reads_flight } else { reads_flight(program) };
        if reads_flight && !self.reads_flight {
            return None;
        }
        self.reads_flight = reads_flight;
        self.program = program.clone();
        for index in (1..self.stretches.len()).rev() {
            let stretch = self.stretches.get_mut(index).and_then(|s| s.begin.as_mut());
            let found = stretch.is_none_or(|begin| {
                let mut cursors = begin.executor.horizon_mut().bookmarks_mut();
                changes.moves.is_empty() || cursors.all(|c| changes.moves.iter().all(|m| m.follow(c)))
            });
            if !found {
                self.merge(index);
            }
        }
        Some((self, changes))
    }

    /// A stretch becomes part of the one before it.
    fn merge(&mut self, index: usize) {
        let gone = self.stretches.remove(index);
        if let Some(before) = index.checked_sub(1).and_then(|i| self.stretches.get_mut(i)) {
            before.reads.extend(gone.reads);
            before.reads.sort_unstable();
            before.reads.dedup();
        }
    }

    fn thin_out(&mut self) {
        while self.stretches.len() > MAX_STRETCHES {
            self.every *= 2;
            for index in (1..self.stretches.len()).rev().step_by(2) {
                self.merge(index);
            }
        }
    }

    /// Flies what has changed. After an error there is no flight any more.
    fn update(
        &mut self,
        given: Circumstances,
        changes: &Changes,
        progress: Progress,
    ) -> Result<(), PreviewError> {
        let all = self.preview.track.len();
        self.kept = Kept { head: all, tail: all };
        let mut from = 0;
        loop {
            let ahead = self.stretches.iter().enumerate().skip(from);
            let touched = |stretch: &Stretch| stretch.reads.iter().any(|id| changes.touches(id));
            let found = ahead.filter(|_| !changes.is_empty()).find(|(_, s)| touched(s)).map(|(i, _)| i);
            let last = self.stretches.len() - 1;
            let Some(first) = found.or(self.unfinished.then_some(last)) else { return Ok(()) };
            let Some(joined) = self.fly_again(first, given, progress)? else { return Ok(()) };
            from = joined;
            self.drop_what_is_beyond(joined, given.options);
        }
    }

    /// Flies from the beginning of a stretch on.
    fn fly_again(
        &mut self,
        first: usize,
        given: Circumstances,
        progress: Progress,
    ) -> Result<Option<usize>, PreviewError> {
        let begin = self.stretches.get(first).and_then(|s| s.begin.as_ref());
        let flight = match begin {
            Some(begin) => {
                let mut at = begin.as_ref().clone();
                at.executor.swap_program(self.program.clone());
                Flight::resumed(given, at)
            }
            None => {
                let executor = &self.end.executor;
                let (profile, terrain) = (executor.profile().clone(), executor.terrain().clone());
                Flight::new(&self.program, &profile, &terrain, self.start, given, true)?
            }
        };
        self.fly_on(first, flight, progress)
    }

    /// A flight that is at the beginning of stretch `first` takes its place and that of those behind it, up to the one which
    /// it joins: the new index of that is given; `None`: it went on to the end.
    fn fly_on(
        &mut self,
        first: usize,
        mut flight: Flight,
        progress: Progress,
    ) -> Result<Option<usize>, PreviewError> {
        let Some(old) = self.stretches.get_mut(first) else { return Ok(None) };
        let base = old.before;
        let mut new = vec![Stretch { begin: old.begin.take(), before: base, reads: ahead_of(&flight.at) }];
        let known = self.beginnings(first);
        let mut since = flight.at.waypoints;
        let outcome = loop {
            match flight.on_to_the_next_leg(progress) {
                Ok(false) => break Ok(()),
                Err(PreviewError::Cancelled) => return Err(PreviewError::Cancelled),
                Err(error) => break Err(error),
                Ok(true) => {}
            }
            if let Some(joined) = self.joined(&known, &flight.at) {
                note_reads(&mut new, &flight.at);
                return Ok(Some(self.join(first, joined, new, flight)));
            }
            if flight.at.waypoints >= since + self.every {
                since = flight.at.waypoints;
                note_reads(&mut new, &flight.at);
                new.push(Stretch::beginning(&flight.at, base.after(&flight.result), &self.none));
            }
        };
        flight.close();
        note_reads(&mut new, &flight.at);
        self.kept = Kept { head: self.kept.head.min(base.track), tail: 0 };
        base.until_end(&self.preview).replace(&mut self.preview, flight.result);
        self.stretches.splice(first.., new);
        self.end = flight.at;
        self.outcome = outcome;
        self.unfinished = false;
        self.finish();
        Ok(None)
    }

    /// The stretches behind one, by the leg at which they begin. None, where it matters what time it is.
    fn beginnings(&self, first: usize) -> HashMap<Id, Vec<usize>> {
        let mut beginnings: HashMap<Id, Vec<usize>> = HashMap::new();
        let behind = self.stretches.iter().enumerate().skip(first + 1).filter(|_| !self.reads_flight);
        for (index, stretch) in behind {
            if let Some(begin) = &stretch.begin {
                beginnings.entry(begin.leg()).or_default().push(index);
            }
        }
        beginnings
    }

    fn joined(&self, known: &HashMap<Id, Vec<usize>>, at: &Situation) -> Option<usize> {
        let place = at.moment.place.as_ref()?;
        let alike = |index: &&usize| {
            let begin = self.stretches.get(**index).and_then(|s| s.begin.as_ref());
            begin.is_some_and(|begin| are_equivalent(at, begin))
        };
        known.get(&place.leg)?.iter().find(alike).copied()
    }

    /// Takes over what follows stretch `joined`, where the flight is; gives its new index.
    fn join(&mut self, first: usize, joined: usize, new: Vec<Stretch>, flight: Flight) -> usize {
        let base = new.first().map_or_else(Marks::default, |s| s.before);
        let Some(old) = self.stretches.get(joined) else { return first };
        let Some(begin) = &old.begin else { return first };
        let shift = Shift::between(begin, &flight.at);
        let (gone, after) = (base.until(old.before), base.after(&flight.result));
        let marks = old.before.to(after);
        gone.replace(&mut self.preview, flight.result);
        let tail = self.preview.track.len() - after.track;
        self.kept = Kept { head: self.kept.head.min(base.track), tail: self.kept.tail.min(tail) };
        shift.apply(&mut self.preview, after);
        for stretch in self.stretches.iter_mut().skip(joined) {
            stretch.before = stretch.before.moved(marks);
            if let Some(begin) = &mut stretch.begin {
                shift.apply_to(begin);
            }
        }
        shift.apply_to(&mut self.end);
        // a flight that was cut short is cut elsewhere now
        self.unfinished |= self.outcome.is_err() && !shift.is_nothing();
        let at = first + new.len();
        self.stretches.splice(first..joined, new);
        self.finish();
        at
    }

    /// What has come beyond a limit, from stretch `joined` on, is not flown any more.
    fn drop_what_is_beyond(&mut self, joined: usize, options: &Options) {
        let beyond = |s: &Stretch| s.begin.as_ref().is_some_and(|begin| begin.exceeded(options).is_some());
        let mut behind = self.stretches.iter().enumerate().skip(joined + 1);
        if let Some((first, _)) = behind.find(|(_, s)| beyond(s)) {
            self.stretches.truncate(first);
            self.unfinished = true;
        }
        self.unfinished |= self.outcome.is_ok() && self.end.exceeded(options).is_some();
    }

    /// What the end says about the whole.
    fn finish(&mut self) {
        let battery = self.end.aircraft.battery();
        self.preview.time_s = self.end.time_s();
        self.preview.distance_m = self.end.distance_m;
        self.preview.energy_j = self.end.used_in_all_j();
        self.preview.battery_left = battery.share();
        self.preview.landed = self.end.aircraft.state().on_ground;
    }
}

impl Stretch {
    fn beginning(at: &Situation, before: Marks, none: &Arc<Program>) -> Self {
        let mut begin = Box::new(at.clone());
        begin.executor.swap_program(none.clone());
        begin.executor.set_proposed(None);
        Self { begin: Some(begin), before, reads: ahead_of(at) }
    }
}

/// What was read on the last of these stretches.
fn note_reads(stretches: &mut [Stretch], at: &Situation) {
    let (Some(last), Some(seen)) = (stretches.last_mut(), at.executor.seen()) else { return };
    last.reads.extend(seen.take());
    last.reads.sort_unstable();
    last.reads.dedup();
}

/// Legs that are read once more while the waypoints ahead are flown.
fn ahead_of(at: &Situation) -> Vec<Id> {
    let horizon = at.executor.horizon();
    let mut ids: Vec<Id> = Vec::new();
    for issued in horizon.iter() {
        ids.push(issued.place.leg.clone());
        ids.push(issued.place.stage.clone());
        ids.extend(issued.place.iterations.iter().map(|i| i.leg.clone()));
        ids.extend(issued.silent_legs.iter().map(|silent| silent.leg.clone()));
        ids.extend(issued.choices.iter().map(|choice| choice.leg().clone()));
    }
    ids.extend(at.executor.acting_legs().cloned());
    if let Some(tail) = horizon.tail() {
        let world = at.executor.world();
        ids.extend(tail.current_stage(&world).map(|stage| stage.id.clone()));
        ids.extend(tail.chain(&world).iter().map(|leg| leg.id.clone()));
    }
    ids.sort_unstable();
    ids.dedup();
    ids
}
