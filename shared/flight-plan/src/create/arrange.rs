//! Legs that are there, arranged anew: copied, moved, put into a loop, a fork or a procedure.

use super::branch::{SKIP, SKIP_ID, merge, other_way};
use super::gather::{Gathered, gather};
use super::kind::LegChoice;
use super::leg::{Drawn, leg};
use super::rearrange::replaced;
use super::thing::remove;
use crate::{Branch, Call, Edit, FlightPlan, Id, Leg, LegKind, Place, Procedure, Spot, Thing, Value};
use aircraft::Profile;
use geometry::LatLon;
use std::sync::Arc;

/// Takes these legs out; those in a loop that is one of them go with it.
pub fn delete_legs(plan: &FlightPlan, legs: &[Id]) -> Edit {
    let outer = crate::clipboard::outermost(plan, legs).into_iter();
    Edit::All(outer.map(|leg| Edit::DeleteLeg { leg: leg.clone() }).collect())
}

/// Takes legs, fixes, zones and runways out; legs that stay keep the place of a fix.
pub fn delete_set(plan: &FlightPlan, set: &[Id]) -> Edit {
    let (legs, things): (Vec<Id>, Vec<Id>) = set.iter().cloned().partition(|id| plan.any_leg(id).is_some());
    let mut edits = vec![delete_legs(plan, &legs)];
    // the legs that go must not come back with the place of a fix
    let without = edits.first().and_then(|edit| edit.apply(plan).ok());
    let mut rest = without.unwrap_or_else(|| plan.clone());
    for thing in things {
        let edit = remove(&rest, &thing);
        if let Ok(without) = edit.apply(&rest) {
            rest = without;
            edits.push(edit);
        }
    }
    Edit::All(edits)
}

/// A copy of a leg behind it.
pub fn duplicate(plan: &FlightPlan, id: &Id) -> Option<Edit> {
    let (list, index) = list_of(plan, id)?;
    let leg = Box::new(list.get(index)?.as_ref().clone());
    Some(Edit::PasteLeg { leg, at: Spot::After(id.clone()) })
}

/// A leg one place up (`-1`) or down (`1`) in its list.
pub fn shift(plan: &FlightPlan, id: &Id, by: isize) -> Option<Edit> {
    let (list, index) = list_of(plan, id)?;
    let neighbour = list.get(index.checked_add_signed(by)?)?.id.clone();
    let at = if by < 0 { Spot::Before(neighbour) } else { Spot::After(neighbour) };
    Some(Edit::MoveLeg { leg: id.clone(), at })
}

/// A loop around legs of one list; `None` also where a way leads into their middle or out of it.
pub fn loop_around(plan: &FlightPlan, legs: &[Id]) -> Option<(Id, Edit)> {
    let legs = in_order(plan, legs)?;
    let around = leg(plan, &Profile::default(), LegChoice::Iterative, &Drawn::Nothing, None, None)?;
    let id = around.id.clone();
    let Gathered { legs: body, next, led } = gather(plan, &legs, &id)?;
    let around = Leg { next, ..around };
    let mut edits = vec![Edit::InsertLeg { leg: Box::new(around), at: Spot::Before(legs.first()?.clone()) }];
    edits.extend(led);
    edits.extend(body.last().map(|last| replaced(last.as_ref().clone())));
    edits.extend(legs.into_iter().map(|leg| Edit::MoveLeg { leg, at: Spot::EndOf(id.clone()) }));
    Some((id, Edit::All(edits)))
}

/// A loop's legs in its place.
pub fn unloop(plan: &FlightPlan, id: &Id) -> Option<Edit> {
    let (list, index) = list_of(plan, id)?;
    let body = list.get(index)?.body();
    let out = |leg: &Arc<Leg>| Edit::MoveLeg { leg: leg.id.clone(), at: Spot::Before(id.clone()) };
    let edits = body.iter().map(out).chain([Edit::DeleteLeg { leg: id.clone() }]);
    (!body.is_empty()).then(|| Edit::All(edits.collect()))
}

/// A fork around legs that follow each other: through them, which is the default, or past them. Where nothing follows them,
/// the ways meet in a merge.
pub fn fork_around(plan: &FlightPlan, legs: &[Id]) -> Option<(Id, Edit)> {
    let legs = in_order(plan, legs)?;
    let (first, last) = (legs.first()?, legs.last()?);
    let (list, index) = list_of(plan, first)?;
    let through = list.get(index..index + legs.len())?;
    if through.last()?.id != *last {
        return None;
    }
    let follower = through.last()?.next.clone().or(list.get(index + legs.len()).map(|leg| leg.id.clone()));
    let past = follower.clone().unwrap_or_else(|| plan.unique_id("merge"));
    let merge = if follower.is_none() { Some(merge(plan, past.clone())?) } else { None };
    let mut made = leg(plan, &Profile::default(), LegChoice::Intersection, &Drawn::Nothing, None, None)?;
    if let LegKind::Intersection { branches, .. } = &mut made.kind {
        let label = match legs.len() {
            1 => format!("{SKIP}{}", plan.label(first)),
            _ => format!("{SKIP}{} to {}", plan.label(first), plan.label(last)),
        };
        branches.push(Branch { id: Id::new(SKIP_ID), label, next: Some(past), when: None });
    }
    let id = made.id.clone();
    let fork = Edit::InsertLeg { leg: Box::new(made), at: Spot::Before(first.clone()) };
    let merge = merge.map(|merge| Edit::InsertLeg { leg: Box::new(merge), at: Spot::After(last.clone()) });
    Some((id, Edit::All(std::iter::once(fork).chain(merge).collect())))
}

/// A fork behind a leg: on as before, which is the default, or another way, which leads there too until something is drawn into it.
/// Where nothing follows, the ways meet in a merge. `None`: it is a fork itself.
pub fn fork_behind(plan: &FlightPlan, id: &Id) -> Option<(Id, Edit)> {
    let (list, index) = list_of(plan, id)?;
    let before = list.get(index).filter(|leg| leg.as_fork().is_none())?;
    let follower = before.next.clone().or(list.get(index + 1).map(|leg| leg.id.clone()));
    let on = follower.clone().unwrap_or_else(|| plan.unique_id("merge"));
    let merge = if follower.is_none() { Some(merge(plan, on.clone())?) } else { None };
    let mut made = leg(plan, &Profile::default(), LegChoice::Intersection, &Drawn::Nothing, None, None)?;
    if let LegKind::Intersection { branches, .. } = &mut made.kind {
        branches.iter_mut().for_each(|branch| branch.next = Some(on.clone()));
        branches.push(other_way(branches, on));
    }
    let made_id = made.id.clone();
    let freed = before.next.is_some().then(|| replaced(Leg { next: None, ..before.as_ref().clone() }));
    let fork = Edit::InsertLeg { leg: Box::new(made), at: Spot::After(id.clone()) };
    let merge = merge.map(|merge| Edit::InsertLeg { leg: Box::new(merge), at: Spot::After(made_id.clone()) });
    Some((made_id, Edit::All(freed.into_iter().chain([fork]).chain(merge).collect())))
}

/// A procedure of legs of one list, which is called in their place: the call, and the edit. `None` also where a way leads into
/// their middle or out of it.
pub fn procedure_of(plan: &FlightPlan, legs: &[Id]) -> Option<(Id, Edit)> {
    let legs = in_order(plan, legs)?;
    let id = plan.fresh_id("call");
    let Gathered { legs: moved, next, led } = gather(plan, &legs, &id)?;
    let first = moved.first()?.clone();
    let reference = centre_or_first(&moved, |place| position_of(plan, place));
    // where it is: what has an anchor can be dragged elsewhere
    let anchor = own_place(&moved).map(|at| Place::Position(Value::Constant(at)));
    let procedure = Procedure {
        id: plan.fresh_id("procedure"),
        name: String::new(),
        parameters: Vec::new(),
        reference,
        bearing_deg: 0.0,
        legs: moved,
    };
    let call = Call { procedure: procedure.id.clone(), arguments: Vec::new(), anchor, bearing_deg: None };
    let caller = Leg {
        id: id.clone(),
        name: String::new(),
        next,
        actions: Vec::new(),
        kind: LegKind::Call(call),
        ..first.as_ref().clone()
    };
    let mut edits = vec![Edit::InsertLeg { leg: Box::new(caller), at: Spot::Before(first.id.clone()) }];
    edits.extend(led);
    edits.extend(legs.into_iter().map(|leg| Edit::DeleteLeg { leg }));
    edits.push(Edit::Add(Box::new(Thing::Procedure(procedure))));
    Some((id, Edit::All(edits)))
}

fn position_of(plan: &FlightPlan, place: &Place) -> Option<LatLon> {
    match place {
        Place::Fix(id) => plan.fix(id).map(|fix| fix.position),
        Place::Position(Value::Constant(at)) => Some(*at),
        Place::Position(Value::Expression(_)) => None,
    }
}

/// What a procedure of these legs is put by: the centre of what is flown around one, as around a pylon, else their first place.
fn centre_or_first(legs: &[Arc<Leg>], position: impl Fn(&Place) -> Option<LatLon>) -> Option<LatLon> {
    let is_around =
        |leg: &&Leg| matches!(leg.kind, LegKind::Orbit { .. } | LegKind::Scan(_) | LegKind::Pattern(_));
    let flown = || legs.iter().map(|leg| leg.first_flown());
    let position = |leg: &Leg| position(leg.place()?);
    flown().filter(is_around).find_map(position).or_else(|| flown().find_map(position))
}

/// The place that moves with a procedure of these legs. `None` also if a fix is among them: that stays where it is, and would
/// tear the others off.
fn own_place(legs: &[Arc<Leg>]) -> Option<LatLon> {
    let is_fix = |place: &Place| matches!(place, Place::Fix(_));
    if legs.iter().filter_map(|leg| leg.first_flown().place()).any(is_fix) {
        return None;
    }
    centre_or_first(legs, |place| match place {
        Place::Position(Value::Constant(at)) => Some(*at),
        _ => None,
    })
}

/// Legs in the order of their list; `None`: they are of several lists, or none.
fn in_order(plan: &FlightPlan, legs: &[Id]) -> Option<Vec<Id>> {
    let (list, _) = list_of(plan, legs.first()?)?;
    let ordered: Vec<Id> = list.iter().map(|leg| leg.id.clone()).filter(|id| legs.contains(id)).collect();
    (ordered.len() == legs.len()).then_some(ordered)
}

/// The list that a leg is in, and its index there.
pub(super) fn list_of<'a>(plan: &'a FlightPlan, id: &Id) -> Option<(&'a [Arc<Leg>], usize)> {
    fn within<'a>(list: &'a [Arc<Leg>], id: &Id) -> Option<(&'a [Arc<Leg>], usize)> {
        let here = list.iter().position(|leg| leg.id == *id).map(|index| (list, index));
        here.or_else(|| list.iter().find_map(|leg| within(leg.body(), id)))
    }
    let stages = plan.all_stages().map(|(_, stage)| stage.legs.as_slice());
    let mut lists = stages.chain(plan.procedures.iter().map(|procedure| procedure.legs.as_slice()));
    lists.find_map(|list| within(list, id))
}
