//! The ways on from forks, as far as they are places.

use super::Reader;
use flight_plan::{FlightPlan, Id, Leg, LegContext};
use geometry::LatLon;
use std::sync::Arc;

/// Most ways of a plan that are drawn.
const MOST: usize = 500;
/// Most legs of a way that are drawn.
const LONGEST: usize = 50;

/// A branch of a fork.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// The fork.
    pub fork: Id,
    /// What people read.
    pub label: String,
    /// It is taken without a decision.
    pub is_default: bool,
    /// From where the path arrives at the fork to where the way leads back.
    pub line: Vec<LatLon>,
}

/// All of a plan.
pub(super) fn of(plan: &FlightPlan, reader: &Reader<'_>) -> Vec<Way> {
    let mut ways = Vec::new();
    for context in plan.all_legs() {
        let Some(fork) = context.leg.as_fork().filter(|fork| fork.branches.len() > 1) else { continue };
        let before = context.siblings.get(..context.index).unwrap_or_default();
        let Some(from) = before.iter().rev().find_map(|leg| last_place(leg, reader)) else { continue };
        for branch in fork.branches {
            let mut line = vec![from];
            let next = branch.next.clone().or_else(|| after(&context));
            trace(
                context.siblings,
                next,
                fork.branches.iter().filter_map(|b| b.next.as_ref()),
                reader,
                &mut line,
            );
            let label = if branch.label.is_empty() { branch.id.to_string() } else { branch.label.clone() };
            let is_default = fork.default == Some(&branch.id);
            ways.push(Way { fork: context.leg.id.clone(), label, is_default, line });
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

/// Leg by leg, until another way is met or something is said about what follows.
fn trace<'a>(
    list: &[Arc<Leg>],
    mut next: Option<Id>,
    heads: impl Iterator<Item = &'a Id> + Clone,
    reader: &Reader<'_>,
    line: &mut Vec<LatLon>,
) {
    for step in 0..LONGEST {
        let Some(index) = next.as_ref().and_then(|id| list.iter().position(|leg| leg.id == *id)) else {
            return;
        };
        let Some(leg) = list.get(index) else { return };
        let meets = step > 0 && heads.clone().any(|head| *head == leg.id);
        line.extend(reader.place_of(leg.first_flown()));
        if meets || leg.as_fork().is_some_and(|fork| !fork.branches.is_empty()) {
            return;
        }
        if let Some(target) = &leg.next {
            let target = list.iter().find(|leg| leg.id == *target);
            return line.extend(target.and_then(|leg| reader.place_of(leg.first_flown())));
        }
        next = list.get(index + 1).map(|leg| leg.id.clone());
    }
}

fn last_place(leg: &Leg, reader: &Reader<'_>) -> Option<LatLon> {
    let inside = leg.body().iter().rev().find_map(|leg| last_place(leg, reader));
    inside.or_else(|| reader.place_of(leg))
}
