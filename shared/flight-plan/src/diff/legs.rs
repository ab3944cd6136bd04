//! What became of legs.

use super::words::{self, change_of};
use super::{Change, ChangeKind, out_of_order};
use crate::xml::Piece;
use crate::{Altitude, FlightPlan, Id, Leg, LegContext, Place, Stage, Value};
use geometry::LatLon;
use std::collections::HashMap;
use std::sync::Arc;

/// A plan's legs, those of its procedures too.
struct Legs<'p> {
    fixes: HashMap<&'p Id, LatLon>,
    places: Vec<At<'p>>,
    by_id: HashMap<&'p Id, usize>,
}

/// A leg and where it is.
struct At<'p> {
    leg: &'p Leg,
    /// The stage, procedure or loop that it is in.
    inside: &'p Id,
    /// What it takes from its stage, when it has none of its own.
    context: Option<LegContext<'p>>,
}

impl<'p> Legs<'p> {
    fn of(plan: &'p FlightPlan) -> Self {
        let mut places: Vec<At> = Vec::new();
        for context in plan.all_legs() {
            let inside = context.loops.last().map_or(&context.stage.id, |l| &l.id);
            places.push(At { leg: context.leg, inside, context: Some(context) });
        }
        for procedure in &plan.procedures {
            add(&procedure.legs, &procedure.id, &mut places);
        }
        let by_id = places.iter().enumerate().map(|(i, at)| (&at.leg.id, i)).collect();
        Self { fixes: plan.fixes.iter().map(|f| (&f.id, f.position)).collect(), places, by_id }
    }

    fn get(&self, id: &Id) -> Option<&At<'p>> {
        self.by_id.get(id).and_then(|i| self.places.get(*i))
    }
}

fn add<'p>(legs: &'p [Arc<Leg>], inside: &'p Id, places: &mut Vec<At<'p>>) {
    for leg in legs {
        places.push(At { leg, inside, context: None });
        add(leg.body(), &leg.id, places);
    }
}

/// In the new plan's order; what was removed comes last.
pub(super) fn changes(old: &FlightPlan, new: &FlightPlan) -> Vec<Change> {
    let (before, after) = (Legs::of(old), Legs::of(new));
    let reordered = reordered(&before, &after);
    let mut changes = Vec::new();
    for (now, reordered) in after.places.iter().zip(reordered) {
        let id = &now.leg.id;
        let change = |fate, words| Change { part: "leg", id: Some(id.clone()), fate, words };
        let Some(was) = before.get(id) else {
            changes.push(change(ChangeKind::Added, Vec::new()));
            continue;
        };
        let mut words = Vec::new();
        if was.inside != now.inside {
            words.push(format!("from {} to {}", was.inside, now.inside));
        } else if reordered {
            words.push(format!("in another order in {}", now.inside));
        }
        let fate = if words.is_empty() { ChangeKind::Changed } else { ChangeKind::Moved };
        words.extend(properties((&before, was), (&after, now)));
        if !words.is_empty() {
            changes.push(change(fate, words));
        }
    }
    let removed = before.places.iter().filter(|at| !after.by_id.contains_key(&at.leg.id));
    changes.extend(removed.map(|at| Change {
        part: "leg",
        id: Some(at.leg.id.clone()),
        fate: ChangeKind::Removed,
        words: Vec::new(),
    }));
    changes
}

/// For each leg of the new plan: it has overtaken a sibling, or was overtaken.
fn reordered(before: &Legs, after: &Legs) -> Vec<bool> {
    let mut reordered = vec![false; after.places.len()];
    let mut siblings: HashMap<&Id, Vec<(usize, usize)>> = HashMap::new();
    for (i, now) in after.places.iter().enumerate() {
        let was = before.by_id.get(&now.leg.id).copied();
        let stayed = was.filter(|was| before.places.get(*was).is_some_and(|at| at.inside == now.inside));
        siblings.entry(now.inside).or_default().extend(stayed.map(|was| (i, was)));
    }
    for list in siblings.values() {
        let numbers: Vec<usize> = list.iter().map(|(_, was)| *was).collect();
        for ((i, _), outside) in list.iter().zip(out_of_order(&numbers)) {
            if let Some(reordered) = reordered.get_mut(*i) {
                *reordered = outside;
            }
        }
    }
    reordered
}

fn properties((before, was): (&Legs, &At), (after, now): (&Legs, &At)) -> Vec<String> {
    // plans made of each other share what is the same
    let mut words = match std::ptr::eq(was.leg, now.leg) {
        true => Vec::new(),
        false => words::between(&Piece::Leg(was.leg), &Piece::Leg(now.leg)),
    };
    let (old, new) = (fix_of(before, was.leg), fix_of(after, now.leg));
    if let (Some((id, from)), Some((same, to))) = (old, new)
        && id == same
        && from != to
    {
        words.push(format!("its fix {id} moved by {:.0} m", from.distance_m(to)));
    }
    if let (Some(was), Some(now)) = (&was.context, &now.context) {
        let own = |c: &LegContext| {
            let around = || std::iter::once(c.leg).chain(c.loops.iter().copied());
            (around().any(|l| l.altitude.is_some()), around().any(|l| l.speed_mps.is_some()))
        };
        let (old, new) = (was.stage, now.stage);
        let ((high, fast), (still_high, still_fast)) = (own(was), own(now));
        if !(high && still_high) && old.altitude != new.altitude {
            let of = |stage: &Stage| stage.altitude.as_ref().map(altitude);
            words.extend(change_of("its stage's altitude", of(old).as_deref(), of(new).as_deref()));
        }
        if !(fast && still_fast) && old.speed_mps != new.speed_mps {
            let of = |stage: &Stage| stage.speed_mps.as_ref().map(number);
            words.extend(change_of("its stage's speed", of(old).as_deref(), of(new).as_deref()));
        }
    }
    words
}

/// As the document has it: `900 amsl`.
fn altitude(altitude: &Altitude) -> String {
    format!("{} {}", number(&altitude.metres), altitude.reference.name())
}

fn number(value: &Value<f64>) -> String {
    match value {
        Value::Constant(x) => x.to_string(),
        Value::Expression(source) => format!("= {source}"),
    }
}

fn fix_of<'p>(legs: &Legs, leg: &'p Leg) -> Option<(&'p Id, LatLon)> {
    match leg.place()? {
        Place::Fix(id) => Some((id, *legs.fixes.get(id)?)),
        Place::Position(_) => None,
    }
}
