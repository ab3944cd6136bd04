//! Where everything is that has an identifier.

use crate::{FlightPlan, Id, Leg, LegPath};
use foldhash::HashMap;
use std::sync::Arc;

/// A plan's identifiers, but those of its variables and branches. Unchanged by edits that leave every leg in its place.
#[derive(Debug, Default)]
pub(crate) struct Ids {
    spots: HashMap<Id, Spot>,
    /// By the numbers of legs and stages.
    places: Spots,
    /// Of everything but legs that are flown.
    others: Vec<(Id, Spot)>,
    /// Those that are there once more, in document order.
    twice: Vec<Id>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Spot {
    /// The leg of this number.
    Leg(usize),
    /// The stage of this number.
    Stage(usize),
    /// The fix of this index.
    Fix(usize),
    /// Something else that is not flown.
    Other,
}

/// Where legs and stages are, by their numbers: in document order, a loop before its body.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Spots {
    legs: Vec<LegSpot>,
    /// Index of the emergency plan, if it is in one, and of the stage there.
    stages: Vec<(Option<usize>, usize)>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct LegSpot {
    stage: usize,
    /// The number of the loop that it is in.
    parent: Option<usize>,
    /// Its index in its list.
    index: usize,
}

impl Spots {
    /// The next stage.
    pub fn stage(&mut self, emergency_plan: Option<usize>, index: usize) {
        self.stages.push((emergency_plan, index));
    }

    /// The next leg, in the last stage.
    pub fn leg(&mut self, parent: Option<usize>, index: usize) {
        self.legs.push(LegSpot { stage: self.stages.len().saturating_sub(1), parent, index });
    }

    fn path(&self, spot: Spot) -> Option<LegPath> {
        let (stage, mut leg) = match spot {
            Spot::Leg(number) => (self.legs.get(number)?.stage, Some(number)),
            Spot::Stage(number) => (number, None),
            Spot::Fix(_) | Spot::Other => return None,
        };
        let mut indices = Vec::new();
        while let Some(spot) = leg.and_then(|number| self.legs.get(number)) {
            indices.push(spot.index);
            leg = spot.parent;
        }
        indices.reverse();
        let (emergency_plan, stage) = *self.stages.get(stage)?;
        Some(LegPath { emergency_plan, stage, indices })
    }
}

impl Ids {
    /// Of a plan and its legs in the order of their numbers; what was found before if that is the same. `was`: which number a leg
    /// had then, if it is one of those.
    pub fn of(
        plan: &FlightPlan,
        legs: &[&Id],
        places: Spots,
        before: &Arc<Ids>,
        was: impl Fn(usize) -> Option<usize>,
    ) -> Arc<Self> {
        let others = others(plan);
        let stays =
            |(i, id): (usize, &&Id)| was(i) == Some(i) || before.spots.get(*id) == Some(&Spot::Leg(i));
        if before.others == others && before.places == places && legs.iter().enumerate().all(stays) {
            return before.clone();
        }
        let mut ids = Self { places, ..Self::default() };
        ids.spots.reserve(others.len() + legs.len());
        others.iter().for_each(|(id, spot)| ids.add(id, *spot));
        legs.iter().enumerate().for_each(|(i, id)| ids.add(id, Spot::Leg(i)));
        ids.others = others;
        Arc::new(ids)
    }

    fn add(&mut self, id: &Id, spot: Spot) {
        match self.spots.entry(id.clone()) {
            std::collections::hash_map::Entry::Vacant(free) => drop(free.insert(spot)),
            std::collections::hash_map::Entry::Occupied(_) => self.twice.push(id.clone()),
        }
    }

    /// Of everything but the legs that are flown.
    pub fn others(&self) -> impl Iterator<Item = &Id> {
        self.others.iter().map(|(id, _)| id)
    }

    /// Those that are there once more, in document order.
    pub fn twice(&self) -> &[Id] {
        &self.twice
    }

    /// Something is called so.
    pub fn contains(&self, id: &Id) -> bool {
        self.spots.contains_key(id)
    }

    /// Where a leg or stage is.
    pub fn path(&self, id: &Id) -> Option<LegPath> {
        self.places.path(*self.spots.get(id)?)
    }

    /// Index of a fix.
    pub fn fix(&self, id: &Id) -> Option<usize> {
        match self.spots.get(id)? {
            Spot::Fix(index) => Some(*index),
            _ => None,
        }
    }
}

fn others(plan: &FlightPlan) -> Vec<(Id, Spot)> {
    let fixes = plan.fixes.iter().enumerate().map(|(i, fix)| (fix.id.clone(), Spot::Fix(i)));
    let mut ids: Vec<Id> = plan.runways.iter().map(|r| r.id.clone()).collect();
    ids.extend(plan.zones.iter().map(|z| z.id.clone()));
    for procedure in &plan.procedures {
        ids.push(procedure.id.clone());
        add_legs(&procedure.legs, &mut ids);
    }
    ids.extend(plan.emergency_plans.iter().map(|e| e.id.clone()));
    let stages = plan.all_stages().enumerate().map(|(i, (_, stage))| (stage.id.clone(), Spot::Stage(i)));
    fixes.chain(ids.into_iter().map(|id| (id, Spot::Other))).chain(stages).collect()
}

fn add_legs(legs: &[Arc<Leg>], ids: &mut Vec<Id>) {
    for leg in legs {
        ids.push(leg.id.clone());
        add_legs(leg.body(), ids);
    }
}
