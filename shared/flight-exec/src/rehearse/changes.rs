//! Which stages and legs of a plan a flight would read otherwise than those of another plan.

use crate::layout::cursor::Cursor;
use flight_plan::{DecideBefore, Fix, Id, Leg, LegKind, Place, Program, Stage, Value};
use foldhash::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// What is another one, from the plan flown before to the plan to be flown.
#[derive(Debug, Default)]
pub(super) struct Changes {
    /// Stages and legs of the former plan: changed, gone, or with another one before them or (at the end of a list) behind.
    ids: HashSet<Id>,
    /// What moved places in lists, the innermost lists first.
    pub moves: Vec<Move>,
}

/// Legs put into a list, or taken out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Move {
    stage: usize,
    /// Where the loops around the list are, outermost first.
    around: Vec<usize>,
    /// Places of the list that are gone.
    gone: Range<usize>,
    /// What is behind them is so many places on.
    by: isize,
}

impl Move {
    /// Puts a cursor where its leg is now; false: it can't say where that is.
    pub fn follow(&self, cursor: &mut Cursor) -> bool {
        if cursor.section.is_some() || cursor.stage != self.stage {
            return true;
        }
        if cursor.loops.iter().any(|frame| !frame.trail.is_empty()) {
            return false;
        }
        let depth = self.around.len();
        let inside = cursor.loops.len() >= depth
            && cursor.loops.iter().zip(&self.around).all(|(frame, index)| frame.index == *index);
        if !inside {
            return true;
        }
        let index = match cursor.loops.get_mut(depth) {
            Some(frame) => &mut frame.index,
            None => &mut cursor.index,
        };
        if *index >= self.gone.end {
            *index = index.saturating_add_signed(self.by);
            return true;
        }
        !self.gone.contains(index)
    }
}

/// Compares two plans.
struct Comparison<'a> {
    old: &'a Program,
    new: &'a Program,
    /// Fixes that are not where they were.
    fixes: HashSet<&'a Id>,
    changes: Changes,
}

/// Which list of legs.
struct List<'a> {
    /// The stage or loop.
    around: &'a Id,
    stage: usize,
    /// Where the loops around it are in their lists, outermost first.
    loops: Vec<usize>,
}

impl Changes {
    /// Of the main plan; `None`: something on which everything depends.
    pub fn between(old: &Program, new: &Program) -> Option<Self> {
        let (was, is) = (old.flown(), new.flown());
        let kept =
            was.runways == is.runways && was.variables == is.variables && questions(old) == questions(new);
        let alike = |(a, b): (&Stage, &Stage)| (&a.id, a.kind) == (&b.id, b.kind);
        let stages = was.stages.len() == is.stages.len() && was.stages.iter().zip(&is.stages).all(alike);
        if !kept || !stages {
            return None;
        }
        let fixes = moved_fixes(&old.plan.fixes, &new.plan.fixes);
        let mut comparison = Comparison { old, new, fixes, changes: Self::default() };
        for (index, (a, b)) in was.stages.iter().zip(&is.stages).enumerate() {
            comparison.stages(index, a, b);
        }
        Some(comparison.changes)
    }

    pub fn touches(&self, id: &Id) -> bool {
        self.ids.contains(id)
    }

    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }
}

/// How early each stage asks: the longest distance (metres) and time (seconds) before an intersection. As far as that one looks ahead
/// all the time.
fn questions(program: &Program) -> Vec<[f64; 2]> {
    let stages = program.flown().stages.iter().filter(|_| program.has_forks());
    stages.map(|stage| earliest(&stage.legs)).collect()
}

fn earliest(legs: &[Arc<Leg>]) -> [f64; 2] {
    let of = |leg: &Arc<Leg>| match leg.as_fork().map(|fork| fork.decide_before) {
        Some(DecideBefore::Distance(metres)) => [metres, 0.0],
        Some(DecideBefore::Time(seconds)) => [0.0, seconds],
        None => earliest(leg.body()),
    };
    legs.iter()
        .map(of)
        .fold([0.0; 2], |[m, s], [metres, seconds]| [f64::max(m, metres), f64::max(s, seconds)])
}

/// What follows may depend on how long it was flown and how much was used: some condition or number of the main plan reads the flight.
pub(super) fn reads_flight(program: &Program) -> bool {
    let reads = |source: &str| program.expression(source).is_ok_and(|e| e.reads_flight());
    let mut found = false;
    for stage in &program.flown().stages {
        stage.for_each_expression(&mut |source, _| found |= reads(source));
        found |= legs_read(&stage.legs, &reads);
    }
    // the energy begins anew in each flight: it is not shifted by what was used before
    found || program.flown().flights().nth(1).is_some()
}

fn legs_read(legs: &[Arc<Leg>], reads: &dyn Fn(&str) -> bool) -> bool {
    legs.iter().any(|leg| {
        let mut found = false;
        leg.for_each_expression(&mut |source, _| found |= reads(source));
        found || legs_read(leg.body(), reads)
    })
}

impl Comparison<'_> {
    fn stages(&mut self, index: usize, old: &Stage, new: &Stage) {
        let header = |s: &Stage| (s.altitude.clone(), s.speed_mps.clone(), s.runway.clone(), s.turnaround);
        let mut sources = Vec::new();
        old.for_each_expression(&mut |source, _| sources.push(source.clone()));
        if header(old) != header(new) || sources.iter().any(|s| self.reads_otherwise(s)) {
            self.changes.ids.insert(old.id.clone());
        }
        let place = List { around: &old.id, stage: index, loops: Vec::new() };
        self.lists(&place, &old.legs, &new.legs);
    }

    fn lists(&mut self, place: &List, old: &[Arc<Leg>], new: &[Arc<Leg>]) {
        let pairs = || old.iter().zip(new);
        let head = pairs().take_while(|(a, b)| a.id == b.id).count();
        let most = old.len().min(new.len()) - head;
        let backwards = old.iter().rev().zip(new.iter().rev());
        let tail = backwards.take(most).take_while(|(a, b)| a.id == b.id).count();
        let ends = old.iter().skip(old.len() - tail).zip(new.iter().skip(new.len() - tail));
        for (index, (a, b)) in pairs().take(head).chain(ends).enumerate() {
            let index = if index < head { index } else { index + old.len() - tail - head };
            self.legs(place, index, a, b);
        }
        if head == old.len() && head == new.len() {
            return;
        }
        if let Some(by) = new.len().checked_signed_diff(old.len()).filter(|by| *by != 0) {
            let gone = head..old.len() - tail;
            self.changes.moves.push(Move { stage: place.stage, around: place.loops.clone(), gone, by });
        }
        let between = old.get(head..old.len() - tail).unwrap_or_default();
        let behind = old.get(old.len() - tail);
        // the list ends elsewhere: whoever was last has another successor
        let before = if behind.is_none() { head.checked_sub(1).and_then(|i| old.get(i)) } else { None };
        let all = between.iter().chain(behind).chain(before).map(|leg| leg.id.clone());
        self.changes.ids.extend(all);
        if old.is_empty() {
            self.changes.ids.insert(place.around.clone());
        }
        for leg in between {
            self.gone(leg);
        }
    }

    fn gone(&mut self, leg: &Leg) {
        for inner in leg.body() {
            self.changes.ids.insert(inner.id.clone());
            self.gone(inner);
        }
    }

    fn legs(&mut self, place: &List, index: usize, old: &Leg, new: &Leg) {
        if !std::ptr::eq(old, new) && without_body(old) != without_body(new) || self.leads_elsewhere(old) {
            self.changes.ids.insert(old.id.clone());
        }
        let inner = !old.body().is_empty() || !new.body().is_empty();
        if inner && (!std::ptr::eq(old, new) || !self.fixes.is_empty()) {
            let loops = place.loops.iter().copied().chain([index]).collect();
            self.lists(&List { around: &old.id, stage: place.stage, loops }, old.body(), new.body());
        }
    }

    /// The leg is the same, but one of its fixes is somewhere else.
    fn leads_elsewhere(&self, leg: &Leg) -> bool {
        use flight_plan::Part;
        if self.fixes.is_empty() {
            return false;
        }
        let mut elsewhere = false;
        leg.for_each_part(&mut |part| {
            elsewhere |= match part {
                Part::Place(Place::Fix(id)) => self.fixes.contains(id),
                Part::Place(Place::Position(Value::Expression(source))) => self.reads_otherwise(source),
                Part::Number(Value::Expression(source)) | Part::Source(source, _) => {
                    self.reads_otherwise(source)
                }
                _ => false,
            }
        });
        elsewhere
    }

    /// An expression may name fixes, which are resolved when it is compiled.
    fn reads_otherwise(&self, source: &str) -> bool {
        !self.fixes.is_empty() && self.old.expression(source) != self.new.expression(source)
    }
}

/// A leg without the legs inside it.
fn without_body(leg: &Leg) -> Leg {
    let kind = match &leg.kind {
        LegKind::Iterative { form, count, until, turn, .. } => LegKind::Iterative {
            form: *form,
            count: count.clone(),
            until: until.clone(),
            turn: *turn,
            body: Vec::new(),
        },
        other => other.clone(),
    };
    Leg {
        id: leg.id.clone(),
        name: String::new(),
        emergency: Default::default(),
        altitude: leg.altitude.clone(),
        speed_mps: leg.speed_mps.clone(),
        next: leg.next.clone(),
        actions: leg.actions.clone(),
        kind,
    }
}

fn moved_fixes<'a>(old: &'a [Fix], new: &'a [Fix]) -> HashSet<&'a Id> {
    let in_order = old.len() == new.len() && old.iter().zip(new).all(|(a, b)| a.id == b.id);
    if in_order {
        let pairs = old.iter().zip(new);
        return pairs.filter(|(a, b)| a.position != b.position).map(|(a, _)| &a.id).collect();
    }
    let now: HashMap<&Id, _> = new.iter().map(|f| (&f.id, f.position)).collect();
    old.iter().filter(|f| now.get(&f.id) != Some(&f.position)).map(|f| &f.id).collect()
}
