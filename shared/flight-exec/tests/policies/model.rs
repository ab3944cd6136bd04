//! The reference model: the plan as a recipe, read aloud while the trace is listened to.
//!
//! It knows nothing of cursors, horizons and bookmarks. It flies each list from its beginning to its end by plain recursion, and
//! at every step says which passage (leg, direction, iterations) must be entered next, or which arrival counted. What a choice depends
//! on (decisions, counts, conditions) it takes from the commands of the trace. A jump ends one recitation and begins another.

use crate::policy::{Findings, Policy, policy};
use crate::tape::{Jump, Observed, record};
use crate::trace::{Step, Trace};
use flight_exec::{IterationPlace, PlacePointer};
use flight_plan::{Id, IterativeForm, Leg, LegKind, LegPath, Program, Stage, StageKind, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

pub const POLICIES: &[Policy] = &[policy(
    "flown-as-the-model-says",
    "Legs, directions and iterations are those that the reference model reads out of the plan.",
    recite,
)];

/// Why a recitation ends before the plan does.
enum Stop {
    /// Nothing more was recorded.
    Over,
    /// The next thing recorded is a jump.
    Jump,
    Wrong(String),
}

type Flown<T = ()> = Result<T, Stop>;

/// A loop being flown.
#[derive(Debug, Clone, Default)]
struct Frame {
    id: Option<Id>,
    iteration: u64,
    reverse: bool,
    /// Passed on the last forward pass, with what was passed inside.
    visited: Vec<Visit>,
}

#[derive(Debug, Clone)]
struct Visit {
    id: Id,
    inside: Vec<Visit>,
}

/// Where to begin: a leg by its indices from the stage's list down; the loops around it; `after`: not the leg itself, what follows it.
struct Entry<'p> {
    indices: &'p [usize],
    frames: Vec<Frame>,
    after: bool,
}

struct Model<'a, 'f> {
    tape: Vec<(Step<'a>, Observed<'a>)>,
    at: usize,
    found: &'f mut Findings,
    program: Option<&'a Program>,
    section: Option<usize>,
    stack: Vec<Frame>,
    /// The leg (stage) entered last.
    here: Option<Id>,
    counts: BTreeMap<Id, u64>,
    taken: BTreeMap<Id, Id>,
    /// Likewise, after so many legs were skipped before they were entered: what led to the one behind them was decided already.
    taken_since: Vec<(usize, Id, Id)>,
    cannot_be_flown: BTreeSet<Id>,
    /// Since a leg was entered.
    skipped: Vec<Id>,
    /// Legs that were skipped before they were entered, and have not been missed yet.
    may_miss: usize,
    /// And those that have, since a leg was entered.
    missed: usize,
    perhaps_missed: usize,
}

fn recite(trace: &Trace, found: &mut Findings) {
    let mut model = Model {
        tape: record(trace),
        at: 0,
        found,
        program: None,
        section: None,
        stack: Vec::new(),
        here: None,
        counts: BTreeMap::new(),
        taken: BTreeMap::new(),
        taken_since: Vec::new(),
        cannot_be_flown: BTreeSet::new(),
        skipped: Vec::new(),
        may_miss: 0,
        missed: 0,
        perhaps_missed: 0,
    };
    while let Some(jump) = model.next_jump() {
        if let Err(Stop::Wrong(what)) = model.jump(jump) {
            let at = model.at.min(model.tape.len() - 1);
            let step = model.tape[at].0;
            model.found.expect(step, false, || what);
        }
    }
}

impl<'a> Model<'a, '_> {
    // ---- reading -----------------------------------------------------------------------------------------------

    fn next_jump(&mut self) -> Option<Jump<'a>> {
        loop {
            let observed = self.tape.get(self.at)?.1.clone();
            self.at += 1;
            match observed {
                Observed::Jump(jump) => return Some(jump),
                Observed::Entered(place) => self.listen(place),
                Observed::Arrived { leg, finished, of, stop, .. } => {
                    self.listen_to_the_pass(leg, finished, of, &stop)
                }
                other => self.note(&other),
            }
        }
    }

    /// Lost until the next jump: the place is what is reported, what was visited in its loops isn't known.
    fn listen(&mut self, place: &PlacePointer) {
        let frame = |i: &IterationPlace| {
            let id = Some(i.leg.clone());
            Frame { id, iteration: i.iteration, reverse: i.reverse, visited: Vec::new() }
        };
        self.stack = place.iterations.iter().map(frame).collect();
        self.counts.retain(|id, _| place.iterations.iter().any(|i| i.leg == *id));
        self.here = Some(place.leg.clone()).filter(|_| self.stack.is_empty());
    }

    /// Lost, too, it is reported that a pass is over: the next one has begun, or the loop is left, and its own count with it.
    fn listen_to_the_pass(&mut self, leg: &Id, finished: u64, of: Option<u64>, stop: &[bool]) {
        let until = match self.program.and_then(|p| p.leg(leg)).map(|l| &l.kind) {
            Some(LegKind::Iterative { until, .. }) => until.as_deref(),
            _ => None,
        };
        let left = of.is_some_and(|of| finished >= of) || !self.goes_on(until, leg, finished, stop);
        if left {
            self.counts.remove(leg);
        }
        let Some(depth) = self.stack.iter().position(|f| f.id.as_ref() == Some(leg)) else { return };
        self.stack.truncate(depth + usize::from(!left));
        if let Some(frame) = self.stack.get_mut(depth) {
            frame.iteration = finished + 1;
        }
    }

    /// Things that are not part of the way.
    fn note(&mut self, observed: &Observed<'a>) {
        match *observed {
            Observed::Taken(leg, branch) => match self.may_miss + self.missed {
                0 => drop(self.taken.insert(leg.clone(), branch.clone())),
                skipped => self.taken_since.push((skipped, leg.clone(), branch.clone())),
            },
            Observed::Counted(leg, n) => drop(self.counts.insert(leg.clone(), n)),
            Observed::CannotBeFlown(leg) => drop(self.cannot_be_flown.insert(leg.clone())),
            Observed::Skipped { leg, announced } => {
                self.may_miss += usize::from(!announced);
                self.skipped.extend(leg.cloned());
            }
            _ => {}
        }
    }

    /// The next part of the way.
    fn peek(&mut self) -> Flown<Observed<'a>> {
        loop {
            let Some((_, observed)) = self.tape.get(self.at).cloned() else { return Err(Stop::Over) };
            match observed {
                Observed::Jump(_) => return Err(Stop::Jump),
                Observed::Entered(_) | Observed::Arrived { .. } | Observed::Finished => return Ok(observed),
                other => self.note(&other),
            }
            self.at += 1;
        }
    }

    fn agree(&mut self) {
        let step = self.tape[self.at].0;
        self.found.expect(step, true, String::new);
        self.at += 1;
        self.forget_what_was_skipped();
    }

    fn forget_what_was_skipped(&mut self) {
        self.skipped.clear();
        (self.may_miss, self.missed, self.perhaps_missed) = (0, 0, 0);
        self.taken.extend(self.taken_since.drain(..).map(|(_, leg, branch)| (leg, branch)));
    }

    // ---- jumps -------------------------------------------------------------------------------------------------

    fn jump(&mut self, jump: Jump<'a>) -> Flown {
        let mut after = None;
        self.forget_what_was_skipped();
        let target = match jump {
            Jump::Start(program) => {
                self.program = Some(program);
                self.stack.clear();
                self.counts.clear();
                self.taken.clear();
                return self.fly_section(None, &first(), Vec::new(), false);
            }
            Jump::StartNext(program, stage) => {
                self.program = Some(program);
                self.stack.clear();
                let path = program.path(stage).ok_or(Stop::Over)?;
                return self.fly_section(None, &path, Vec::new(), false);
            }
            Jump::Emergency(plan) => {
                let program = self.program.ok_or(Stop::Over)?;
                self.stack.clear();
                self.counts.clear();
                let section = program.plan.emergency_plans.iter().position(|p| p.id == *plan);
                return self.fly_section(section, &first(), Vec::new(), false);
            }
            Jump::GoTo(leg) => leg.clone(),
            Jump::Return(leg) => {
                self.stack.clear();
                leg.clone()
            }
            Jump::Enter(program, entry) => {
                self.program = Some(program);
                entry.clone()
            }
            Jump::GoOn { program, leg, entered, simply } => {
                self.leave_loops_not_around(leg, entered, program);
                self.forget_other_forms(program);
                self.program = Some(program);
                let here = self.here.clone().filter(|_| simply && !self.stack.iter().any(|f| f.reverse));
                after = here.clone();
                // half a pass back, or legs of both plans: the policies on updates look at those
                here.filter(|leg| !self.is_control(leg)).ok_or(Stop::Over)?
            }
        };
        let program = self.program.ok_or(Stop::Over)?;
        let Some(path) = program.path(&target) else { return Err(Stop::Over) };
        let frames = self.frames_around(&path, after.is_some());
        self.counts.retain(|id, _| frames.iter().any(|f| f.id.as_ref() == Some(id)));
        self.fly_section(path.emergency_plan, &path, frames, after.is_some())
    }

    /// The way back of a loop is what was flown forth in it, or around it, to be flown back. What was flown in a plan that never would
    /// have gone back there is forgotten, and where a loop's form has changed everything inside it.
    fn forget_other_forms(&mut self, new: &Program) {
        let form = |program: Option<&Program>, id: Option<&Id>| match &program?.leg(id?)?.kind {
            LegKind::Iterative { form, .. } => Some(*form),
            _ => None,
        };
        let (mut same, mut back) = (true, false);
        for frame in &mut self.stack {
            let old = form(self.program, frame.id.as_ref());
            same &= old == form(Some(new), frame.id.as_ref());
            back |= old == Some(IterativeForm::Reverse);
            if !same || !back {
                frame.visited.clear();
            }
        }
    }

    /// Loops that a new plan hasn't around the leg being flown are left, and their counts forgotten; on the way to a leg (skipped to)
    /// those around the one that was entered last are still there.
    fn leave_loops_not_around(&mut self, leg: &Id, entered: bool, new: &Program) {
        let last = self.here.clone().or(self.stack.last().and_then(|f| f.id.clone())).filter(|_| !entered);
        let chain = |leg: &Id| new.path(leg).map_or(Vec::new(), |path| new.chain(&path));
        let legs: Vec<&Leg> = [Some(leg.clone()), last].iter().flatten().flat_map(chain).collect();
        let around = |id: &Id| legs.iter().any(|l| l.id == *id && l.as_loop().is_some());
        self.stack.retain(|f| f.id.as_ref().is_some_and(around));
        self.counts.retain(|id, _| around(id));
    }

    fn is_control(&self, leg: &Id) -> bool {
        let kind = self.program.and_then(|p| p.leg(leg)).map(|l| &l.kind);
        matches!(kind, Some(LegKind::Iterative { .. } | LegKind::Intersection { .. }))
    }

    /// Loops that are around the old place too keep their iteration; going on, what was visited as well.
    fn frames_around(&self, path: &LegPath, goes_on: bool) -> Vec<Frame> {
        let program = self.program.into_iter();
        let chain = program.flat_map(|p| p.chain(path));
        let outer = path.indices.len().saturating_sub(1);
        let frame = |leg: &Leg| {
            let known = |f: &&Frame| f.id.as_ref() == Some(&leg.id) && path.emergency_plan == self.section;
            let old = self.stack.iter().find(known);
            let visited = old.filter(|_| goes_on).map_or(Vec::new(), |f| still_there(&f.visited, leg.body()));
            let iteration = old.map_or(1, |f| f.iteration);
            Frame { id: Some(leg.id.clone()), iteration, reverse: false, visited }
        };
        chain.take(outer).map(frame).collect()
    }

    // ---- flying ------------------------------------------------------------------------------------------------

    fn fly_section(
        &mut self,
        section: Option<usize>,
        path: &LegPath,
        frames: Vec<Frame>,
        after: bool,
    ) -> Flown {
        let program = self.program.ok_or(Stop::Over)?;
        self.section = section;
        self.stack.clear();
        let mut entry = Some(Entry { indices: &path.indices, frames, after });
        for stage in program.stages(section).iter().skip(path.stage) {
            self.fly_stage(stage, entry.take())?;
            // behind it another flight may begin, when it is started
            if stage.kind == StageKind::Land {
                break;
            }
        }
        match self.peek()? {
            Observed::Finished => {
                self.agree();
                Ok(())
            }
            other => Err(Stop::Wrong(format!("the plan is over, but {other:?}"))),
        }
    }

    fn fly_stage(&mut self, stage: &Stage, entry: Option<Entry>) -> Flown {
        match stage.kind {
            StageKind::TakeOff | StageKind::Land if entry.as_ref().is_some_and(|e| e.after) => Ok(()),
            StageKind::TakeOff | StageKind::Land => self.enter(&stage.id),
            _ => self.forward(&stage.legs, entry.filter(|e| !e.indices.is_empty())),
        }
    }

    fn forward(&mut self, list: &[Arc<Leg>], mut entry: Option<Entry>) -> Flown {
        let mut index = entry.as_ref().map_or(0, |e| e.indices[0]);
        while let Some(leg) = list.get(index) {
            let mut inside = Vec::new();
            let entry = entry.take();
            let next = match &leg.kind {
                LegKind::Intersection { .. } => self.cross(leg, list)?,
                LegKind::Iterative { .. } => {
                    inside = self.fly_loop(leg, false, Vec::new(), entry)?;
                    leg.next.clone()
                }
                _ => {
                    if !entry.is_some_and(|e| e.after) {
                        self.enter(&leg.id)?;
                    }
                    leg.next.clone()
                }
            };
            self.visit(&leg.id, inside);
            let named = next.and_then(|id| list.iter().position(|l| l.id == id));
            index = named.unwrap_or(index + 1);
        }
        Ok(())
    }

    /// Remembers what the way back will pass; a leg that was passed before begins it anew from there.
    fn visit(&mut self, id: &Id, inside: Vec<Visit>) {
        if let Some(frame) = self.stack.last_mut() {
            let again = frame.visited.iter().position(|v| v.id == *id);
            frame.visited.truncate(again.unwrap_or(frame.visited.len()));
            frame.visited.push(Visit { id: id.clone(), inside });
        }
    }

    fn backward(&mut self, list: &[Arc<Leg>]) -> Flown {
        let visited = self.stack.last().map_or(Vec::new(), |f| f.visited.clone());
        for visit in visited.into_iter().rev() {
            let Some(leg) = list.iter().find(|l| l.id == visit.id) else { continue };
            match &leg.kind {
                LegKind::Intersection { .. } => {}
                _ if leg.kind_name() == "IF" => {}
                LegKind::Iterative { .. } if visit.inside.is_empty() => {}
                LegKind::Iterative { .. } => drop(self.fly_loop(leg, true, visit.inside, None)?),
                _ => self.enter(&leg.id)?,
            }
        }
        Ok(())
    }

    /// All passes of a loop; gives what its last forward pass visited. `mirrored`: as part of a way back, so that its passes end at
    /// the beginning of its body.
    fn fly_loop(
        &mut self,
        leg: &Leg,
        mirrored: bool,
        visited: Vec<Visit>,
        entry: Option<Entry>,
    ) -> Flown<Vec<Visit>> {
        let LegKind::Iterative { form, body, .. } = &leg.kind else { return Ok(Vec::new()) };
        let (frame, mut entry) = deeper(entry);
        let fresh = Frame { iteration: 1, reverse: mirrored, visited, ..Frame::default() };
        self.stack.push(Frame { id: Some(leg.id.clone()), ..frame.unwrap_or(fresh) });
        let depth = self.stack.len() - 1;
        loop {
            if self.stack[depth].reverse {
                self.backward(body)?;
            } else {
                self.forward(body, entry.take())?;
            }
            if self.stack[depth].reverse == mirrored {
                if !self.arrive(leg)? {
                    self.counts.remove(&leg.id);
                    return Ok(self.stack.pop().unwrap_or_default().visited);
                }
                self.stack[depth].iteration += 1;
            }
            if *form == IterativeForm::Reverse {
                self.stack[depth].reverse ^= true;
                // until it is turned, the leg being flown is one of the other direction
                self.here = None;
                self.enter(&leg.id)?;
            }
            if !self.stack[depth].reverse {
                self.stack[depth].visited.clear();
            }
        }
    }

    /// The end of a pass: counted, and once more or not.
    fn arrive(&mut self, leg: &Leg) -> Flown<bool> {
        let iteration = self.stack.last().map_or(0, |f| f.iteration);
        let Observed::Arrived { leg: id, finished, of, stop, n } = self.peek()? else {
            return Err(Stop::Wrong(format!(
                "{} ends pass {iteration}, but {:?}",
                leg.id, self.tape[self.at].1
            )));
        };
        let LegKind::Iterative { count, until, .. } = &leg.kind else { return Ok(false) };
        let counts = match (self.counts.get(&leg.id), count) {
            (Some(set), _) => vec![Some(*set)],
            (None, Some(Value::Constant(c))) => vec![Some(*c as u64)],
            (None, Some(Value::Expression(_))) => n.into_iter().map(Some).collect(),
            (None, None) => vec![None],
        };
        if *id != leg.id || finished != iteration || !counts.contains(&of) {
            let told = format!("{id} finished {finished} of {of:?}");
            return Err(Stop::Wrong(format!("{} finishes {iteration} of {counts:?}, told: {told}", leg.id)));
        }
        self.agree();
        let full = of.is_some_and(|n| iteration >= n);
        Ok(!full && self.goes_on(until.as_deref(), &leg.id, iteration, &stop))
    }

    /// By its condition; where that has changed under way, as it was flown.
    fn goes_on(&mut self, until: Option<&str>, leg: &Id, iteration: u64, stop: &[bool]) -> bool {
        match until {
            None => true,
            Some("stop") if stop == [true] => false,
            Some("stop") if stop == [false] => true,
            Some("stop") => {
                let next = self.peek();
                let within = |p: &PlacePointer| {
                    p.iterations.iter().any(|i| i.leg == *leg && i.iteration > iteration) || p.leg == *leg
                };
                matches!(next, Ok(Observed::Entered(place)) if within(place))
            }
            Some(_) => iteration <= 1,
        }
    }

    /// The branch decided; nobody has: it waits. Gives the leg it leads to.
    fn cross(&mut self, leg: &Leg, list: &[Arc<Leg>]) -> Flown<Option<Id>> {
        let LegKind::Intersection { branches, .. } = &leg.kind else { return Ok(None) };
        if branches.len() < 2 {
            return Ok(branches.first().and_then(|b| b.next.clone()));
        }
        let observed = self.peek()?;
        if matches!(observed, Observed::Entered(place) if self.is_here(&leg.id, place)) {
            self.enter(&leg.id)?;
        }
        let entered = match self.peek()? {
            Observed::Entered(place) => Some(&place.leg),
            _ => None,
        };
        let leads_to = |branch: &Id| branches.iter().find(|b| b.id == *branch)?.next.as_ref();
        let Some(branch) = self.decided(&leg.id, leads_to, entered) else {
            return Err(Stop::Wrong(format!("{} was crossed without a decision", leg.id)));
        };
        let chosen = branches.iter().find(|b| b.id == branch);
        let chosen = chosen.ok_or_else(|| Stop::Wrong(format!("{} has no branch {branch}", leg.id)))?;
        let known = |id: &Id| list.iter().any(|l| l.id == *id);
        Ok(chosen.next.clone().filter(known))
    }

    /// What was decided last before the leg behind the intersection was laid out; else whatever was. That a later word was in time, on
    /// the way to that leg, shows in what is `entered`, unless that leg was skipped.
    fn decided<'p>(
        &mut self,
        leg: &Id,
        leads_to: impl Fn(&Id) -> Option<&'p Id>,
        entered: Option<&Id>,
    ) -> Option<Id> {
        let before = self.taken.remove(leg);
        let of = |(_, id, _): &(usize, Id, Id)| id == leg;
        // where the leg behind was skipped as well, that was the skip after those that led to the intersection
        let passed = self.missed + self.perhaps_missed;
        let leads_to_skipped = |branch: &Id| leads_to(branch).is_some_and(|next| self.skipped.contains(next));
        let in_time = self
            .taken_since
            .iter()
            .rposition(|t| of(t) && (t.0 < passed || t.0 == passed && leads_to_skipped(&t.2)));
        let is_behind = before.as_ref().is_some_and(leads_to_skipped);
        let late = || {
            let last = self.taken_since.iter().rposition(of)?;
            let shows = !is_behind && leads_to(&self.taken_since[last].2) == entered;
            Some(last).filter(|_| before.is_none() || shows)
        };
        let since = in_time.or_else(late).map(|i| self.taken_since.remove(i).2);
        since.or(before)
    }

    /// A passage must be entered now. Some legs fly something only where the path is not there yet; a leg reported as impossible may be
    /// left out.
    fn enter(&mut self, id: &Id) -> Flown {
        let start = self.program.and_then(|p| p.leg(id)).is_some_and(may_fly_nothing);
        let next = self.peek()?;
        let optional = start || self.cannot_be_flown.contains(id);
        match next {
            Observed::Entered(place) if self.is_here(id, place) => {
                self.here = Some(id.clone());
                self.agree();
                Ok(())
            }
            _ if optional => {
                // or one of those that were skipped
                self.perhaps_missed += usize::from(self.may_miss > 0);
                Ok(())
            }
            _ if self.may_miss > 0 => {
                self.may_miss -= 1;
                self.missed += 1;
                Ok(())
            }
            other => {
                let loops: Vec<_> = self.stack.iter().map(|f| (&f.id, f.iteration, f.reverse)).collect();
                Err(Stop::Wrong(format!("{id} comes next, in {loops:?}, but {other:?}")))
            }
        }
    }

    fn is_here(&self, id: &Id, place: &PlacePointer) -> bool {
        let told = place.iterations.iter().map(|i| (Some(&i.leg), i.iteration, i.reverse));
        let own = self.stack.iter().map(|f| (f.id.as_ref(), f.iteration, f.reverse));
        place.leg == *id && place.reverse == self.stack.last().is_some_and(|f| f.reverse) && told.eq(own)
    }
}

/// Where the path is at its fix already, and what it is flown until is true.
pub fn may_fly_nothing(leg: &Leg) -> bool {
    matches!(leg.kind_name(), "IF" | "CF" | "FA" | "HA" | "HM")
}

fn first() -> LegPath {
    LegPath { emergency_plan: None, stage: 0, indices: Vec::new() }
}

/// The entry one list further in, with the frame of the loop it goes into.
fn deeper(entry: Option<Entry>) -> (Option<Frame>, Option<Entry>) {
    match entry {
        Some(mut entry) if entry.indices.len() > 1 => {
            let frame = (!entry.frames.is_empty()).then(|| entry.frames.remove(0));
            (frame, Some(Entry { indices: &entry.indices[1..], ..entry }))
        }
        _ => (None, None),
    }
}

fn still_there(visited: &[Visit], body: &[Arc<Leg>]) -> Vec<Visit> {
    let moved = |v: &Visit| {
        let leg = body.iter().find(|l| l.id == v.id)?;
        Some(Visit { id: v.id.clone(), inside: still_there(&v.inside, leg.body()) })
    };
    visited.iter().filter_map(moved).collect()
}
