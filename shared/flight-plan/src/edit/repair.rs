//! Edits that remedies are made of: identifiers and references.

use super::{EditError, found, not_applicable, stages_mut};
use crate::uses::SlotMut;
use crate::{Act, FlightPlan, Id, Leg, LegKind, Place, Stage};
use std::collections::HashMap;
use std::sync::Arc;

/// Gives the last thing that is called `id` another identifier; references to `id` keep meaning the first.
pub(super) fn distinguish(plan: &mut FlightPlan, id: &Id, to: &Id) -> Result<(), EditError> {
    let mut counts: HashMap<usize, usize> = HashMap::new();
    Walk::of(plan, &mut |group, found: &mut Id| {
        if found == id {
            *counts.entry(group).or_default() += 1;
        }
    });
    let ambiguous = counts.into_iter().filter(|(_, n)| *n > 1).map(|(group, _)| group).min();
    let mut last: Option<&mut Id> = None;
    Walk::of(plan, &mut |group, found| {
        if Some(group) == ambiguous && found == id {
            last = Some(found);
        }
    });
    *found(last, id)? = to.clone();
    Ok(())
}

/// Every identifier of a plan with the number of the group within which it is unique.
pub(super) struct Walk<'v, 'a> {
    visit: &'v mut dyn FnMut(usize, &'a mut Id),
    /// The last group's number.
    groups: usize,
}

/// Fixes, runways, zones, procedures, emergency plans, stages and legs.
pub(super) const DOCUMENT: usize = 0;
const VARIABLES: usize = 1;

impl<'a> Walk<'_, 'a> {
    pub(super) fn of(plan: &'a mut FlightPlan, visit: &mut dyn FnMut(usize, &'a mut Id)) {
        let mut walk = Walk { visit, groups: VARIABLES };
        plan.fixes.iter_mut().for_each(|f| (walk.visit)(DOCUMENT, &mut f.id));
        plan.runways.iter_mut().for_each(|r| (walk.visit)(DOCUMENT, &mut r.id));
        plan.zones.iter_mut().for_each(|z| (walk.visit)(DOCUMENT, &mut z.id));
        plan.variables.iter_mut().for_each(|v| (walk.visit)(VARIABLES, &mut v.name));
        plan.stages.iter_mut().for_each(|stage| walk.stage(stage));
        for emergency in &mut plan.emergency_plans {
            (walk.visit)(DOCUMENT, &mut emergency.id);
            emergency.stages.iter_mut().for_each(|stage| walk.stage(stage));
        }
        for procedure in &mut plan.procedures {
            (walk.visit)(DOCUMENT, &mut procedure.id);
            let parameters = walk.next_group();
            procedure.parameters.iter_mut().for_each(|p| (walk.visit)(parameters, &mut p.name));
            procedure.legs.iter_mut().for_each(|leg| walk.leg(Arc::make_mut(leg)));
        }
    }

    fn next_group(&mut self) -> usize {
        self.groups += 1;
        self.groups
    }

    fn stage(&mut self, stage: &'a mut Stage) {
        (self.visit)(DOCUMENT, &mut stage.id);
        stage.legs.iter_mut().for_each(|leg| self.leg(Arc::make_mut(leg)));
    }

    fn leg(&mut self, leg: &'a mut Leg) {
        (self.visit)(DOCUMENT, &mut leg.id);
        match &mut leg.kind {
            LegKind::Iterative { body, .. } => {
                body.iter_mut().for_each(|inner| self.leg(Arc::make_mut(inner)))
            }
            LegKind::Intersection { branches, .. } => {
                let of_branches = self.next_group();
                branches.iter_mut().for_each(|b| (self.visit)(of_branches, &mut b.id));
            }
            _ => {}
        }
    }
}

/// Whatever names `from` in a leg, stage or emergency plan (`None`: in the document's own association) names `to`.
pub(super) fn refer(plan: &mut FlightPlan, of: Option<&Id>, from: &Id, to: &Id) -> Result<(), EditError> {
    let mut hits = 0_usize;
    let mut rename = |id: &mut Id| {
        if id == from {
            id.clone_from(to);
            hits += 1;
        }
    };
    match of {
        None => plan.emergency.by_cause.iter_mut().for_each(|(_, id)| rename(id)),
        Some(of) => {
            let emergency = plan.emergency_plans.iter_mut().find(|e| e.id == *of);
            emergency.into_iter().for_each(|e| rename(&mut e.runway));
            for stage in stages_mut(plan).filter(|s| s.id == *of) {
                stage.runway.iter_mut().for_each(&mut rename);
                stage.emergency.by_cause.iter_mut().for_each(|(_, id)| rename(id));
            }
            let leg = super::leg_mut(plan, of).ok();
            leg.into_iter().for_each(|leg| leg_references(leg, &mut rename));
        }
    }
    if hits > 0 { Ok(()) } else { Err(EditError::Unknown(from.clone())) }
}

pub(super) fn leg_references(leg: &mut Leg, rename: &mut dyn FnMut(&mut Id)) {
    leg.next.iter_mut().for_each(&mut *rename);
    leg.emergency.by_cause.iter_mut().for_each(|(_, id)| rename(id));
    let sets = leg.actions.iter_mut().filter_map(|action| match &mut action.act {
        Act::Set { variable, .. } => Some(variable),
        _ => None,
    });
    sets.for_each(&mut *rename);
    match &mut leg.kind {
        LegKind::Intersection { branches, default, .. } => {
            branches.iter_mut().filter_map(|b| b.next.as_mut()).for_each(&mut *rename);
            default.iter_mut().for_each(&mut *rename);
        }
        LegKind::Call(call) => {
            rename(&mut call.procedure);
            call.arguments.iter_mut().for_each(|(name, _)| rename(name));
        }
        _ => {}
    }
    leg.for_each_slot_mut(&mut |slot| {
        if let SlotMut::Place(Place::Fix(id)) = slot {
            rename(id);
        }
    });
}

/// The runway of a stage or of an emergency plan.
pub(super) fn set_runway(plan: &mut FlightPlan, of: &Id, runway: &Id) -> Result<(), EditError> {
    if let Some(emergency) = plan.emergency_plans.iter_mut().find(|e| e.id == *of) {
        emergency.runway = runway.clone();
        return Ok(());
    }
    match stages_mut(plan).find(|s| s.id == *of) {
        Some(stage) => stage.runway = Some(runway.clone()),
        None => return Err(not_applicable(of, "has no runway: choose a stage or an emergency plan")),
    }
    Ok(())
}
