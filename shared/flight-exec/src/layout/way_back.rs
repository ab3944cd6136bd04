//! The way back of a loop in a new plan: the legs passed on the way out, without those that are gone, to where those that are left lead
//! now.
//!
//! Backwards a leg leads to where the leg before it ends. What is passed already stays where it was.

use super::expand::track::SAME_PLACE_M;
use super::expand::trail::{Trail, Visit};
use super::path::{PathEnd, distance_m};
use super::world::World;
use flight_plan::{Leg, LegKind, Place};
use geometry::LatLon;
use std::collections::HashMap;

/// The programs before and after a plan update, with the same values.
#[derive(Clone, Copy)]
pub(super) struct Worlds<'a> {
    pub old: World<'a>,
    pub new: World<'a>,
}

/// Where the end of a leg is by now: at another place, or, if the leg is gone, where the leg before it ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moved {
    from: LatLon,
    to: PathEnd,
}

impl Moved {
    /// Where a leg that began at `start` leads backwards.
    pub fn applied(this: Option<Self>, start: PathEnd) -> PathEnd {
        this.filter(|moved| is_same_place(moved.from, start.position)).map_or(start, |moved| moved.to)
    }
}

/// The legs of a trail in the new body, and what has become of the end of the last one. The first leg begins where `before` leads.
/// The ends of the first `ahead` legs can have moved: the path ends behind them.
pub(super) fn remapped(
    trail: &Trail,
    ahead: usize,
    (old, new): (&Leg, &Leg),
    mut before: Option<Moved>,
    worlds: &Worlds,
) -> (Trail, Option<Moved>) {
    let places: HashMap<_, _> = new.body().iter().enumerate().map(|(index, leg)| (&leg.id, index)).collect();
    let mut kept = Vec::with_capacity(trail.len());
    for (number, visit) in trail.iter().enumerate() {
        let Some(leg) = old.body().get(visit.index) else { continue };
        let start = Moved::applied(before, visit.start);
        let there = places.get(&leg.id).and_then(|index| Some((*index, new.body().get(*index)?)));
        let Some((index, new_leg)) = there else {
            before = Some(Moved { from: visit.end.position, to: start });
            continue;
        };
        let (inner, end) = match &visit.inner {
            Some(inner) => {
                let count = if number < ahead { inner.len() } else { 0 };
                let (inner, end) = remapped(inner, count, (leg, new_leg), before, worlds);
                (Some(inner), end)
            }
            None => {
                let own = (number < ahead).then(|| worlds.end_moved(leg, new_leg, visit)).flatten();
                (None, own.or(before.filter(|_| is_same_place(visit.start.position, visit.end.position))))
            }
        };
        before = end;
        let end = if number < ahead { Moved::applied(before, visit.end) } else { visit.end };
        kept.push(Visit { index, highest: index, inner, start, end, ..visit.clone() });
    }
    (kept.into_iter().collect(), before)
}

impl Worlds<'_> {
    /// The end of a leg that leads to a place of its own, if the new plan has moved it.
    fn end_moved(&self, old: &Leg, new: &Leg, visit: &Visit) -> Option<Moved> {
        let is = self.new.place(destination(new)?).ok()?;
        let was = destination(old).and_then(|place| self.old.place(place).ok());
        let unmoved = was.is_some_and(|was| is_same_place(was, is));
        let to = PathEnd { position: is, ..visit.end };
        (!unmoved).then_some(Moved { from: visit.end.position, to })
    }
}

/// The place at which a leg ends, if it has one.
fn destination(leg: &Leg) -> Option<&Place> {
    use LegKind::{Cf, Df, Ha, Hf, Hm, If, Rf, Tf};
    let ends_there =
        matches!(leg.kind, If(_) | Tf(_) | Df { .. } | Rf { .. } | Cf { .. } | Hf(_) | Ha(_) | Hm { .. });
    leg.place().filter(|_| ends_there)
}

fn is_same_place(one: LatLon, other: LatLon) -> bool {
    distance_m(one, other) < SAME_PLACE_M
}
