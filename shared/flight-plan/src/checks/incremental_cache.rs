//! What one check keeps for the next: after an edit nearly every leg of a plan is what it was.
//!
//! Plans share the legs that they have in common (`Arc<Leg>`); an edit copies only those that it changes. A rule about one leg reads
//! its step, the two before it and the one after it. So a leg is checked again only if it is another leg, is entered differently, or
//! has such a neighbour. If a fix or the initial value of a variable has changed, every leg that reads it is checked again
//! (`plan_context`). An edit of a runway, or of the bounds of a variable, has every leg checked again. The plan is still walked
//! from leg to leg (some 0.1 µs each).
//!
//! The result is what a whole check gives, byte for byte of every problem (`tests/edited.rs`).

use super::extent::Region;
use super::inspection::{Expressions, Inspection};
use super::plan_context::{Moved, PlanContext};
use super::step::{Around, Point, Step};
use crate::ids::Ids;
use crate::{FlightPlan, Leg};
use aircraft::Profile;
use std::sync::Arc;
use terrain::Terrain;

/// The last check of a plan that is being edited, for one aircraft over one terrain.
///
/// Legs that both plans share, that are entered as before and have the same surroundings are not checked again.
pub struct IncrementalCache {
    pub(super) profile: Profile,
    pub(super) terrain: Arc<dyn Terrain>,
    pub(super) last: Option<Last>,
}

impl std::fmt::Debug for IncrementalCache {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("IncrementalCache").field("profile", &self.profile.name).finish_non_exhaustive()
    }
}

impl IncrementalCache {
    /// An empty cache. The terrain must not change: for other elevations, make a new cache.
    pub fn new(profile: Profile, terrain: Arc<dyn Terrain>) -> Self {
        Self { profile, terrain, last: None }
    }
}

/// The last check.
pub(super) struct Last {
    context: PlanContext,
    steps: Vec<Step>,
    expressions: Arc<Expressions>,
    ids: Arc<Ids>,
}

impl Last {
    /// Keeps a check for the next one.
    pub fn of(inspection: Inspection, recall: Recall) -> Self {
        let context = PlanContext::of(inspection.plan, recall.context);
        let (steps, expressions, ids) = inspection.into_parts();
        Self { context, steps, expressions, ids }
    }
}

/// The cache in use: the last check's steps in their order, and how they match a new plan.
#[derive(Default)]
pub(super) struct Recall {
    old: std::vec::IntoIter<Step>,
    /// How many there were.
    total: usize,
    /// How many old steps the next search compares: more after each search without a match.
    ahead: usize,
    /// How many may still be compared: the search costs no more than the plan.
    left: usize,
    /// Of each new step: the old one of the same leg, and what followed that.
    from: Vec<Option<Origin>>,
    context: Option<PlanContext>,
    moved: Moved,
    pub expressions: Arc<Expressions>,
    pub ids: Arc<Ids>,
}

/// Where a step was in the last check.
#[derive(Clone, Copy)]
struct Origin {
    number: usize,
    after: Option<usize>,
    /// It is what it was, as far as it goes by itself.
    same: bool,
}

/// Looked at first: what a few deleted legs leave over.
const AHEAD: usize = 8;

impl Recall {
    /// What may be remembered for a plan.
    pub fn of(last: Option<Last>, plan: &FlightPlan) -> Self {
        let known = last.and_then(|last| Some((last.context.moved(plan, &last.expressions)?, last)));
        let Some((moved, last)) = known else { return Self::default() };
        let Last { context, steps, mut expressions, ids } = last;
        moved.forget(&mut expressions);
        let total = steps.len();
        Self {
            old: steps.into_iter(),
            total,
            ahead: AHEAD,
            left: 4 * total,
            from: Vec::with_capacity(total),
            context: Some(context),
            moved,
            expressions,
            ids,
        }
    }

    /// There is something to remember.
    pub fn is_useful(&self) -> bool {
        self.total > 0
    }

    pub fn total(&self) -> usize {
        self.total
    }

    /// The step of the next leg, if it was there, in this context.
    pub fn step(
        &mut self,
        leg: &Arc<Leg>,
        around: &Arc<Around>,
        (start, within): (Option<Point>, Option<Region>),
        before: Option<usize>,
    ) -> Option<Step> {
        let Some(step) = self.find(leg) else {
            self.from.push(None);
            return None;
        };
        let number = self.total - self.old.len() - 1;
        let before = before.map(|before| self.was(before));
        let same = Arc::ptr_eq(&step.around, around)
            && step.start == start
            && step.start_within == within
            && step.before.map(Some) == before
            && !self.moved.is_read_by(leg);
        self.from.push(Some(Origin { number, after: step.after, same }));
        same.then_some(step)
    }

    /// The old step of a leg; those before it are given up.
    fn find(&mut self, leg: &Arc<Leg>) -> Option<Step> {
        let ahead = self.ahead.min(self.left);
        let found = self.old.as_slice().iter().take(ahead).position(|old| Arc::ptr_eq(&old.leg, leg));
        match found {
            Some(skipped) => {
                self.ahead = AHEAD;
                self.old.nth(skipped)
            }
            None => {
                self.left -= ahead.min(self.old.len());
                self.ahead = self.ahead.saturating_mul(2);
                None
            }
        }
    }

    /// What a list has around it: that of the last check, if it is the same.
    pub fn around(&self, new: Around) -> Arc<Around> {
        let old = self.old.as_slice().iter().take(AHEAD).map(|step| &step.around);
        let mut same = old.filter(|old| ***old == new && !self.moved.is_read_around(old));
        same.next().cloned().unwrap_or_else(|| Arc::new(new))
    }

    fn origin(&self, step: usize) -> Option<Origin> {
        self.from.get(step).copied().flatten()
    }

    /// A step is what it was, as far as it goes by itself.
    fn is_same(&self, step: usize) -> bool {
        self.origin(step).is_some_and(|origin| origin.same)
    }

    /// The leg of a step was the one of this number before.
    pub fn was(&self, step: usize) -> Option<usize> {
        self.origin(step).map(|origin| origin.number)
    }

    /// Whether the problems found for this leg last time still hold: its step, the two before it and the one after it are the same.
    pub fn holds(&self, number: usize, step: &Step, steps: &[Step]) -> bool {
        let Some(origin) = self.origin(number) else { return false };
        let before = step.before.and_then(|i| Some((i, steps.get(i)?)));
        let near = before.map(|(i, _)| i).into_iter().chain(before.and_then(|(_, step)| step.before));
        let after = step.after.map(|after| self.was(after));
        origin.same
            && origin.after.map(Some) == after
            && near.chain(step.after).all(|neighbour| self.is_same(neighbour))
    }
}
