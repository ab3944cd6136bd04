//! The ways on from forks, leg by leg, whichever of them the flight takes; and where the path comes from to a leg.

use super::calls::Calls;
use super::{Line, Reader};
use flight_plan::{Area, Id, Leg, LegContext, LegKind, Pattern, Scan};
use geometry::{LatLon, LocalFrame};
use std::collections::HashMap;
use std::sync::Arc;

/// Most ways of a plan that are drawn.
const MOST: usize = 500;
/// Most legs of a way that are drawn.
const LONGEST: usize = 50;
/// Most pieces of a way that are drawn: a leg may be a loop, a route or a call.
const MOST_PIECES: usize = 500;

/// A branch of a fork.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// The fork.
    pub fork: Id,
    /// What people read.
    pub label: String,
    /// It is taken without a decision.
    pub is_default: bool,
    /// From where the path arrives at the fork to where the way leads back, each piece with the leg that goes along it.
    pub lines: Vec<Line>,
}

impl Way {
    /// Its places, one after the other.
    pub fn places(&self) -> impl Iterator<Item = LatLon> {
        self.lines.first().map(|line| line.from).into_iter().chain(self.lines.iter().map(|line| line.to))
    }
}

/// Where the path comes from to each leg.
#[derive(Default)]
pub(super) struct Arrivals<'a> {
    /// To legs that other legs name as what follows them.
    named: HashMap<&'a Id, LatLon>,
    /// To legs that fly nothing themselves: the path goes on from there.
    passed: HashMap<&'a Id, LatLon>,
    /// Where the last leg before in the document ends.
    last: Option<LatLon>,
}

impl<'a> Arrivals<'a> {
    /// Takes the next leg of the document, and gives where the path comes from to it; `None`: that is not known.
    pub(super) fn take(&mut self, context: &LegContext<'a>, reader: &Reader<'_>) -> Option<LatLon> {
        let leg = context.leg;
        let before = context.index.checked_sub(1).and_then(|index| context.siblings.get(index));
        let from = match before.filter(|before| before.falls_through()) {
            Some(before) => match before.as_fork() {
                Some(fork) if fork.branches.is_empty() => None,
                Some(_) => self.passed.get(&before.id).copied(),
                None => last_place(before, reader),
            },
            None => self.named.get(&leg.id).copied(),
        };
        let near = from.or(self.last);
        let own = last_place(leg, reader);
        if let Some(near) = near.filter(|_| own.is_none() || !leg.body().is_empty()) {
            self.passed.insert(&leg.id, near);
        }
        let end = own.or(near);
        if let Some(end) = end {
            let branches = leg.as_fork().map_or(&[][..], |fork| fork.branches).iter();
            let named = branches.filter_map(|branch| branch.next.as_ref()).chain(&leg.next);
            named.for_each(|next| _ = self.named.entry(next).or_insert(end));
        }
        // what is inside a loop comes next, and begins where that does
        self.last = if leg.body().is_empty() { end } else { near };
        from
    }

    /// Where the path arrives at a leg that flies nothing itself.
    fn at(&self, leg: &Id) -> Option<LatLon> {
        self.passed.get(leg).copied()
    }
}

/// All of a plan.
pub(super) fn of(arrivals: &Arrivals<'_>, reader: &Reader<'_>) -> Vec<Way> {
    let mut ways = Vec::new();
    let mut calls = Calls::of(reader.plan);
    for context in reader.plan.all_legs() {
        let Some(fork) = context.leg.as_fork().filter(|fork| fork.branches.len() > 1) else { continue };
        let Some(from) = arrivals.at(&context.leg.id) else { continue };
        let heads: Vec<&Id> = fork.branches.iter().filter_map(|branch| branch.next.as_ref()).collect();
        for branch in fork.branches {
            let mut trace = Trace { reader, calls: &mut calls, at: from, lines: Vec::new() };
            trace.way(context.siblings, branch.next.clone().or_else(|| after(&context)), &heads);
            let label = if branch.label.is_empty() { branch.id.to_string() } else { branch.label.clone() };
            let is_default = fork.default == Some(&branch.id);
            ways.push(Way { fork: context.leg.id.clone(), label, is_default, lines: trace.lines });
        }
        if ways.len() >= MOST {
            break;
        }
    }
    ways
}

fn after(context: &LegContext<'_>) -> Option<Id> {
    context.siblings.get(context.index + 1).map(|leg| leg.id.clone())
}

/// A way as far as it was followed.
struct Trace<'a, 'p> {
    reader: &'a Reader<'p>,
    calls: &'a mut Calls<'p>,
    at: LatLon,
    lines: Vec<Line>,
}

impl Trace<'_, '_> {
    /// Leg by leg, until another way is met or something is said about what follows.
    fn way(&mut self, list: &[Arc<Leg>], mut next: Option<Id>, heads: &[&Id]) {
        for step in 0..LONGEST {
            let Some(index) = next.as_ref().and_then(|id| list.iter().position(|leg| leg.id == *id)) else {
                return;
            };
            let Some(leg) = list.get(index) else { return };
            if step > 0 && heads.contains(&&leg.id) {
                return self.first(leg);
            }
            if leg.as_fork().is_some_and(|fork| !fork.branches.is_empty()) {
                return;
            }
            self.leg(leg, &leg.id);
            if let Some(target) = &leg.next {
                let target = list.iter().find(|leg| leg.id == *target);
                return target.into_iter().for_each(|target| self.first(target));
            }
            next = list.get(index + 1).map(|leg| leg.id.clone());
        }
    }

    /// Only to where a leg begins.
    fn first(&mut self, leg: &Leg) {
        let first = leg.first_flown();
        let called = self.calls.body(first).first().cloned();
        let first = called.as_deref().map_or(first, Leg::first_flown);
        places(first, self.reader).into_iter().take(1).for_each(|to| self.to(to, &leg.id));
    }

    /// All of a leg, as a leg of the document: what a procedure flies is the call's.
    fn leg(&mut self, leg: &Leg, written: &Id) {
        let called = self.calls.body(leg);
        if !called.is_empty() {
            return called.iter().for_each(|inner| self.leg(inner, written));
        }
        for inner in leg.body() {
            let is_written = leg.id == *written;
            self.leg(inner, if is_written { &inner.id } else { written });
        }
        places(leg, self.reader).into_iter().for_each(|to| self.to(to, written));
    }

    fn to(&mut self, to: LatLon, leg: &Id) {
        let from = std::mem::replace(&mut self.at, to);
        if self.lines.len() < MOST_PIECES {
            self.lines.push(Line { leg: leg.clone(), from, to });
        }
    }
}

/// The places that a leg leads over: of an area its middle.
fn places(leg: &Leg, reader: &Reader<'_>) -> Vec<LatLon> {
    let area = match &leg.kind {
        LegKind::Scan(Scan { area, .. }) | LegKind::Pattern(Pattern::Contour { area, .. }) => area,
        LegKind::Pattern(Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. }) => {
            return route.iter().filter_map(|place| reader.place(place)).collect();
        }
        _ => return reader.place_of(leg).into_iter().collect(),
    };
    let middle = match area {
        Area::Circle { centre, .. } => reader.place(centre),
        Area::Polygon { corners, .. } => middle(corners),
        Area::Expression(source) => reader.polygon(source).and_then(|ring| middle(&ring)),
    };
    middle.into_iter().collect()
}

fn middle(ring: &[LatLon]) -> Option<LatLon> {
    LocalFrame::around(ring).map(|frame| frame.origin())
}

fn last_place(leg: &Leg, reader: &Reader<'_>) -> Option<LatLon> {
    let inside = leg.body().iter().rev().find_map(|leg| last_place(leg, reader));
    inside.or_else(|| places(leg, reader).pop())
}
