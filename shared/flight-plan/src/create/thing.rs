//! What legs use: fixes, runways, zones, variables, stages, emergency plans.

use crate::template::{self, WayHome};
use crate::uses::SlotMut;
use crate::{
    Edit, EmergencyChoice, Fix, FlightPlan, Id, Leg, Place, Stage, StageKind, Thing, Turnaround, Value,
    Variable, VariableValue, Zone, ZoneKind, ZoneShape,
};
use aircraft::Profile;
use geometry::LatLon;
use std::sync::Arc;
use terrain::Terrain;

/// A fix.
pub fn fix(plan: &FlightPlan, position: LatLon) -> Fix {
    Fix { id: plan.fresh_id("FIX"), position, name: String::new(), description: String::new() }
}

/// A zone at every altitude, at all times.
pub fn zone(plan: &FlightPlan, kind: ZoneKind, shape: ZoneShape) -> Zone {
    let stem = match kind {
        ZoneKind::KeepIn => "keep-in-",
        ZoneKind::KeepOut => "keep-out-",
    };
    let id = plan.fresh_id(stem);
    Zone { id, name: String::new(), kind, shape, floor: None, ceiling: None, active: Vec::new() }
}

/// A variable that anybody may write.
pub fn variable(plan: &FlightPlan, initial: VariableValue) -> Variable {
    let stem = match initial {
        VariableValue::Bool(_) => "flag",
        VariableValue::Number(_) => "number",
        VariableValue::Text(_) => "text",
        VariableValue::Position(_) => "place",
        VariableValue::Polygon(_) => "area",
    };
    Variable::new(plan.fresh_id(stem), initial)
}

/// An empty stage; one to take off or land gets the plan's first runway.
fn stage(plan: &FlightPlan, kind: StageKind) -> Stage {
    let on_runway = matches!(kind, StageKind::TakeOff | StageKind::Land);
    Stage {
        id: plan.unique_id(kind.word()),
        name: kind.name().into(),
        kind,
        emergency: EmergencyChoice::default(),
        runway: plan.runways.first().filter(|_| on_runway).map(|runway| runway.id.clone()),
        altitude: (kind == StageKind::TakeOff).then(template::climb_out),
        speed_mps: None,
        turnaround: Turnaround::default(),
        legs: Vec::new(),
    }
}

/// A new stage of the main plan, before the first one of its last flight that comes later; a take-off behind a whole flight begins
/// another one.
pub fn add_stage(plan: &FlightPlan, kind: StageKind) -> (Id, Edit) {
    let stage = stage(plan, kind);
    let id = stage.id.clone();
    let stage = Box::new(stage);
    let last = plan.stages.get(plan.flights().last().unwrap_or(0)..).unwrap_or_default();
    let lands = last.last().is_some_and(|stage| stage.kind == StageKind::Land);
    let takes_off = last.first().is_some_and(|stage| stage.kind == StageKind::TakeOff);
    let begins_another = kind == StageKind::TakeOff && takes_off && lands;
    let later = last.iter().find(|other| order(other.kind) > order(kind)).filter(|_| !begins_another);
    let edit = match later {
        Some(later) => Edit::InsertStage { stage, before: later.id.clone() },
        None => Edit::AppendStage { to: None, stage },
    };
    (id, edit)
}

/// When a kind of stage comes in a flight; en-route and mission stages alternate.
fn order(kind: StageKind) -> usize {
    match kind {
        StageKind::TakeOff => 0,
        StageKind::Departure => 1,
        StageKind::EnRoute | StageKind::Mission => 2,
        StageKind::Arrival => 3,
        StageKind::Approach => 4,
        StageKind::Land => 5,
    }
}

/// Takes a stage one place up (-1) or down (1) among its neighbours; `None`: it is at the end.
pub fn shift_stage(plan: &FlightPlan, stage: &Id, by: isize) -> Option<Edit> {
    let mut lists = std::iter::once(&plan.stages).chain(plan.emergency_plans.iter().map(|e| &e.stages));
    let (list, index) = lists.find_map(|list| Some((list, list.iter().position(|s| s.id == *stage)?)))?;
    let other = list.get(index.checked_add_signed(by)?)?.id.clone();
    Some(match by < 0 {
        true => Edit::MoveStage { stage: stage.clone(), before: other },
        false => Edit::MoveStage { stage: other, before: stage.clone() },
    })
}

/// An emergency plan that brings the aircraft to a runway from anywhere, with the fixes that it needs; the first of a plan
/// becomes the plan's own. It is flown inwards all the way: places on the centre line come after the beginning of the final, where that
/// is farther out.
pub fn emergency_plan(
    plan: &FlightPlan,
    way: WayHome<'_>,
    profile: &Profile,
    terrain: &dyn Terrain,
) -> (Id, Edit) {
    let id = plan.unique_id("return");
    let (fixes, emergency) = template::bring_home(plan, &id, way, profile, terrain);
    let mut edits: Vec<Edit> = fixes.into_iter().map(|fix| Edit::Add(Box::new(Thing::Fix(fix)))).collect();
    edits.push(Edit::Add(Box::new(Thing::EmergencyPlan(emergency))));
    if plan.emergency.by_cause.is_empty() {
        edits.push(Edit::SetEmergency { of: None, cause: None, plan: Some(id.clone()) });
    }
    (id, Edit::All(edits))
}

/// Removes a fix, runway, zone, procedure, emergency plan, stage or variable; legs keep the place of a fix, and nothing
/// is associated with an emergency plan any more.
pub fn remove(plan: &FlightPlan, id: &Id) -> Edit {
    let mut edits = Vec::new();
    if plan.fix(id).is_some() {
        edits.push(move_fix_into_legs(plan, id));
    }
    if plan.emergency_plan(id).is_some() {
        edits.extend(dissociate(plan, id));
    }
    edits.push(Edit::Remove { id: id.clone() });
    Edit::All(edits)
}

/// Every leg that goes to a fix goes to its position instead.
pub fn move_fix_into_legs(plan: &FlightPlan, id: &Id) -> Edit {
    let Some(fix) = plan.fix(id) else { return Edit::All(Vec::new()) };
    replace_fix(plan, id, &Place::Position(Value::Constant(fix.position)))
}

/// Every leg that goes to a fix goes elsewhere instead.
pub(super) fn replace_fix(plan: &FlightPlan, id: &Id, with: &Place) -> Edit {
    let with = |fix: &Id| (fix == id).then(|| with.clone());
    Edit::All(every_leg(plan).into_iter().filter_map(|leg| replace_fixes(leg, &with)).collect())
}

/// A procedure or a leg of one has the positions of its fixes as its own: a call moves these, while a fix stays where it is.
/// `None`: it is no such thing, or goes to no fix.
pub fn own_places(plan: &FlightPlan, of: &Id) -> Option<Edit> {
    let legs = match plan.procedure(of) {
        Some(procedure) => legs_in(&procedure.legs),
        None => {
            let (procedure, _) = plan.procedure_leg(of)?;
            let leg = legs_in(&procedure.legs).into_iter().find(|leg| leg.id == *of)?;
            legs_in(std::slice::from_ref(leg))
        }
    };
    let position = |fix: &Id| Some(Place::Position(Value::Constant(plan.fix(fix)?.position)));
    let edits: Vec<Edit> = legs.into_iter().filter_map(|leg| replace_fixes(leg, &position)).collect();
    (!edits.is_empty()).then_some(Edit::All(edits))
}

/// The edit by which a leg goes elsewhere instead of to the fixes that `with` knows; `None`: it goes to none of them.
fn replace_fixes(leg: &Arc<Leg>, with: &impl Fn(&Id) -> Option<Place>) -> Option<Edit> {
    // a loop goes nowhere itself; to replace it would put its old body back
    if !leg.body().is_empty() {
        return None;
    }
    let mut leg = leg.as_ref().clone();
    let mut hit = false;
    leg.for_each_slot_mut(&mut |slot| {
        if let SlotMut::Place(place) = slot
            && let Place::Fix(fix) = &*place
            && let Some(other) = with(fix)
        {
            *place = other;
            hit = true;
        }
    });
    hit.then(|| Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(leg) })
}

/// Every leg, in emergency plans and procedures too.
pub(crate) fn every_leg(plan: &FlightPlan) -> Vec<&Arc<Leg>> {
    let stages = plan.all_stages().map(|(_, stage)| &stage.legs);
    stages
        .chain(plan.procedures.iter().map(|procedure| &procedure.legs))
        .flat_map(|legs| legs_in(legs))
        .collect()
}

/// Legs, and those in them.
pub(crate) fn legs_in(legs: &[Arc<Leg>]) -> Vec<&Arc<Leg>> {
    legs.iter().flat_map(|leg| std::iter::once(leg).chain(legs_in(leg.body()))).collect()
}

/// Takes an emergency plan from whatever is associated with it.
fn dissociate(plan: &FlightPlan, id: &Id) -> Vec<Edit> {
    let stages = plan.all_stages().map(|(_, stage)| (Some(stage.id.clone()), &stage.emergency));
    let legs = every_leg(plan).into_iter().map(|leg| (Some(leg.id.clone()), &leg.emergency));
    let all = std::iter::once((None, &plan.emergency)).chain(stages).chain(legs);
    let of = |(of, choice): (Option<Id>, &EmergencyChoice)| {
        let hits = choice.by_cause.iter().filter(|(_, to)| to == id);
        let edit = |(cause, _): &_| Edit::SetEmergency { of: of.clone(), cause: *cause, plan: None };
        hits.map(edit).collect::<Vec<_>>()
    };
    all.flat_map(of).collect()
}
