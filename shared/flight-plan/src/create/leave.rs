//! Legs that are taken out of a list: what led to them leads to what followed them.

use super::arrange::list_of;
use crate::{Edit, FlightPlan, Id, Leg, LegKind};
use std::collections::HashSet;
use std::sync::Arc;

/// A list of legs, and which of them go.
pub(super) struct Leaving<'a> {
    list: &'a [Arc<Leg>],
    out: HashSet<&'a Id>,
}

/// What stays of a list, changed where its ways led through what goes.
pub(super) struct Left<'a> {
    /// The edits of the legs that stay.
    pub edits: Vec<Edit>,
    /// A leg of which a way leads nowhere now, and the leg that it led to.
    pub astray: Option<(&'a Leg, Id)>,
}

impl<'a> Leaving<'a> {
    /// These legs go; all of them are in one list. `None`: the first of them is in none.
    pub fn of(plan: &'a FlightPlan, legs: impl IntoIterator<Item = &'a Id>) -> Option<Self> {
        let out: HashSet<&Id> = legs.into_iter().collect();
        let (list, _) = out.iter().find_map(|id| list_of(plan, id))?;
        Some(Self { list, out })
    }

    /// What is to be done to the legs that stay.
    pub fn heal(&self) -> Left<'a> {
        let mut left = Left { edits: Vec::new(), astray: None };
        for (index, leg) in self.list.iter().enumerate().filter(|(_, leg)| !self.goes(&leg.id)) {
            let mut changed = leg.as_ref().clone();
            let mut astray = None;
            let mut lead = |next: &mut Option<Id>| {
                if let Some(lost) = self.lead_on(next, index) {
                    astray.get_or_insert(lost);
                }
            };
            match &mut changed.kind {
                LegKind::Intersection { branches, .. } if !branches.is_empty() => {
                    branches.iter_mut().for_each(|branch| lead(&mut branch.next));
                }
                _ => lead(&mut changed.next),
            }
            left.astray = left.astray.or_else(|| astray.map(|to| (leg.as_ref(), to)));
            if changed != **leg {
                left.edits.push(Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(changed) });
            }
        }
        left
    }

    fn goes(&self, id: &Id) -> bool {
        self.out.contains(id)
    }

    /// Lets a way from a leg of the list lead past what goes; gives where it led, if nothing follows there.
    fn lead_on(&self, next: &mut Option<Id>, from: usize) -> Option<Id> {
        let behind = self.list.get(from + 1).map(|leg| &leg.id);
        let target = next.clone().or_else(|| behind.cloned()).filter(|target| self.goes(target))?;
        let on = self.past(&target);
        // what follows in the list anyway need not be said
        let following = self.list.iter().skip(from + 1).find(|leg| !self.goes(&leg.id)).map(|leg| &leg.id);
        match on {
            // as it was: what it led to may still be in the list
            None => return next.is_some().then_some(target),
            Some(on) if next.is_none() && Some(&on) == following => {}
            Some(on) => *next = Some(on),
        }
        None
    }

    /// The first leg on the way from one that goes that stays.
    fn past(&self, gone: &Id) -> Option<Id> {
        let mut at = gone.clone();
        for _ in 0..=self.list.len() {
            if !self.goes(&at) {
                return Some(at);
            }
            let index = self.list.iter().position(|leg| leg.id == at)?;
            let following = || self.list.get(index + 1).map(|leg| leg.id.clone());
            at = self.list.get(index)?.next.clone().or_else(following)?;
        }
        None
    }
}
