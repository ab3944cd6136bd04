//! Edits as values: what a person did to a plan, to be applied, undone, or offered as a remedy.

pub(crate) mod lists;
mod number;
mod rename;
mod repair;
pub(crate) mod shape;
mod things;

use crate::{
    Altitude, AltitudeReference, Area, Cause, EmergencyChoice, EmergencyPlan, Fix, FlightPlan, Id, Leg,
    LegAction, LegKind, PlanWaypoint, Procedure, Runway, Stage, Value, Variable, VariableError,
    VariableValue, Zone,
};
use geometry::LatLon;
use std::sync::Arc;

/// A change of a plan.
#[derive(Debug, Clone, PartialEq)]
pub enum Edit {
    /// Moves a fix, and with it every leg that goes there.
    MoveFix {
        /// The fix.
        fix: Id,
        /// Where to.
        to: LatLon,
    },
    /// Moves what a leg or zone goes to, holds at or is about: its waypoint, its centre, or the whole of a polygon or route (by its
    /// first point). A place that names a fix becomes a position of the leg's own; one that is bound to a variable moves
    /// the variable's initial value.
    MoveWaypoint {
        /// The leg or zone.
        leg: Id,
        /// Where to.
        to: LatLon,
    },
    /// Moves a corner of a leg's or zone's polygon, or a point of a route.
    MoveCorner {
        /// The leg or zone.
        leg: Id,
        /// `None`: the outer ring or the route, else which hole.
        hole: Option<usize>,
        /// Which corner.
        corner: usize,
        /// Where to.
        to: LatLon,
    },
    /// Puts a corner into a leg's or zone's polygon, or a point into a route.
    InsertCorner {
        /// The leg or zone.
        leg: Id,
        /// `None`: the outer ring or the route, else which hole.
        hole: Option<usize>,
        /// Before which corner; their number: at the end.
        before: usize,
        /// Where.
        at: LatLon,
    },
    /// Removes a corner of a leg's or zone's polygon, or a point of a route.
    RemoveCorner {
        /// The leg or zone.
        leg: Id,
        /// `None`: the outer ring or the route, else which hole.
        hole: Option<usize>,
        /// Which corner.
        corner: usize,
    },
    /// Resizes a circular area or zone, or a pattern that has a radius (a spiral's outer one). A radius that is bound to a
    /// variable alone changes the variable's initial value.
    SetRadius {
        /// The leg or zone.
        leg: Id,
        /// Metres.
        radius_m: f64,
    },
    /// Gives a scan or contour another area.
    SetArea {
        /// The scan or contour.
        leg: Id,
        /// The area.
        area: Area,
    },
    /// Sets any number of a leg by its name in the document: see [`Leg::numbers`].
    SetNumber {
        /// The leg.
        leg: Id,
        /// Its attribute: `course`, `spacing`, `turns`, …
        name: String,
        /// `None`: leave it out, where that is possible.
        value: Option<Value<f64>>,
    },
    /// What is done on a leg.
    SetActions {
        /// The leg.
        leg: Id,
        /// All of its actions.
        actions: Vec<LegAction>,
    },
    /// Sets or removes the altitude of a leg or stage.
    SetAltitude {
        /// The leg or stage.
        of: Id,
        /// `None`: inherit.
        altitude: Option<Altitude>,
    },
    /// Sets or removes the airspeed of a leg or stage.
    SetSpeed {
        /// The leg or stage.
        of: Id,
        /// m/s; `None`: inherit.
        speed_mps: Option<Value<f64>>,
    },
    /// Cross the leg's waypoint before turning, or cut the corner.
    SetFlyOver {
        /// The leg.
        leg: Id,
        /// Cross it.
        fly_over: bool,
    },
    /// Sets or removes the count of a loop.
    SetCount {
        /// The iterative leg.
        leg: Id,
        /// The count.
        count: Option<Value<f64>>,
    },
    /// Sets or removes the default branch of an intersection.
    SetDefault {
        /// The intersection leg.
        leg: Id,
        /// The branch.
        branch: Option<Id>,
    },
    /// Renames a leg, stage, fix, zone, procedure or emergency plan for people; its identifier stays.
    Rename {
        /// Which.
        id: Id,
        /// Its new name.
        name: String,
    },
    /// Sets a variable's initial value.
    SetVariable {
        /// The variable.
        name: Id,
        /// Its value, within its type and bounds.
        value: VariableValue,
    },
    /// Associates or dissociates an emergency plan.
    SetEmergency {
        /// A leg or stage; `None`: the whole document.
        of: Option<Id>,
        /// `None`: the fallback for every cause.
        cause: Option<Cause>,
        /// `None`: inherit.
        plan: Option<Id>,
    },
    /// Puts a new leg into a list.
    InsertLeg {
        /// The leg.
        leg: Box<Leg>,
        /// Where.
        at: Spot,
    },
    /// Removes a leg and what is in it.
    DeleteLeg {
        /// The leg.
        leg: Id,
    },
    /// Takes a leg elsewhere.
    MoveLeg {
        /// The leg.
        leg: Id,
        /// Where.
        at: Spot,
    },
    /// Puts another leg in the place of one.
    ReplaceLeg {
        /// The old leg.
        leg: Id,
        /// The new one.
        with: Box<Leg>,
    },
    /// Gives the last thing with an identifier another one. References keep meaning the first.
    Distinguish {
        /// The identifier that several things have.
        id: Id,
        /// The last one's new identifier.
        to: Id,
    },
    /// Corrects what a leg, stage or emergency plan refers to.
    Refer {
        /// Whose reference; `None`: the document's own emergency association.
        of: Option<Id>,
        /// What it names.
        from: Id,
        /// What it is to name.
        to: Id,
    },
    /// Corrects a variable's name, or a whole number, in the expressions of a leg or stage.
    CorrectName {
        /// The leg or stage.
        of: Id,
        /// Only in expressions that read like this; `None`: in all of them.
        within: Option<Arc<str>>,
        /// What it reads, or writes.
        from: Id,
        /// What it is to read, or write.
        to: Id,
    },
    /// Gives a leg, stage, fix, runway, zone, procedure, emergency plan or variable another identifier, and whatever refers to
    /// it. (Of a variable and a thing with one name: the thing.)
    SetId {
        /// Its identifier.
        id: Id,
        /// Its new one.
        to: Id,
    },
    /// Renames the plan for people.
    SetTitle(String),
    /// Makes the plan one for another aircraft.
    SetAircraft(String),
    /// Names the runway of a stage or of an emergency plan.
    SetRunway {
        /// The stage or emergency plan.
        of: Id,
        /// The runway.
        runway: Id,
    },
    /// Adds something at the end of its list.
    Add(Box<Thing>),
    /// Puts another thing of the same sort in the place of one.
    Replace {
        /// The old one.
        id: Id,
        /// The new one.
        with: Box<Thing>,
    },
    /// Removes a fix, runway, variable, zone, procedure, stage or emergency plan, with what is in it. (Of a variable and a thing
    /// with one name: the thing.)
    Remove {
        /// Its identifier.
        id: Id,
    },
    /// Takes a fix, runway, variable, zone, procedure or emergency plan elsewhere in its list.
    MoveThing {
        /// Its identifier.
        id: Id,
        /// Before which of its list; `None`: to the end.
        before: Option<Id>,
    },
    /// Adds a stage at the end.
    AppendStage {
        /// Of which emergency plan; `None`: of the main plan.
        to: Option<Id>,
        /// The stage.
        stage: Box<Stage>,
    },
    /// Puts a new stage before another one.
    InsertStage {
        /// The stage.
        stage: Box<Stage>,
        /// Before which.
        before: Id,
    },
    /// Gives a stage the properties of another one; its legs stay.
    ReplaceStage {
        /// The stage.
        stage: Id,
        /// What it is to be like.
        with: Box<Stage>,
    },
    /// Takes a stage elsewhere.
    MoveStage {
        /// The stage.
        stage: Id,
        /// Before which.
        before: Id,
    },
    /// Puts a copy of a leg into a list. It and the legs in it get new identifiers where theirs are taken.
    PasteLeg {
        /// The leg.
        leg: Box<Leg>,
        /// Where.
        at: Spot,
    },
    /// Several edits as one.
    All(Vec<Edit>),
}

/// A part of a plan that has a list of its own.
#[derive(Debug, Clone, PartialEq)]
pub enum Thing {
    /// A named position.
    Fix(Fix),
    /// A runway.
    Runway(Runway),
    /// A variable.
    Variable(Variable),
    /// A zone.
    Zone(Zone),
    /// A procedure.
    Procedure(Procedure),
    /// An emergency plan.
    EmergencyPlan(EmergencyPlan),
}

/// A place in a list of legs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Spot {
    /// Before a leg.
    Before(Id),
    /// After a leg.
    After(Id),
    /// At the end of a stage, procedure or loop.
    EndOf(Id),
}

/// Why an edit can't be applied.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EditError {
    /// The plan has no such thing (any more).
    #[error("the plan has no `{0}`: it may have been removed, choose another")]
    Unknown(Id),
    /// It has no such property.
    #[error("`{id}` {reason}")]
    NotApplicable {
        /// What was to be edited.
        id: Id,
        /// Why it can't be, and what to do.
        reason: &'static str,
    },
    /// The variable does not take the value.
    #[error(transparent)]
    Variable(#[from] VariableError),
}

/// What is raised is raised to whole multiples of this, metres: somebody who flies at 437 m has calculated, and nobody did.
const RAISED_TO_M: f64 = 10.0;

impl Edit {
    /// Another altitude for a leg or stage that is at `metres` now: `by_m` higher or a little more, to whole metres of the same
    /// reference.
    pub fn relevel(of: &Id, metres: f64, reference: AltitudeReference, by_m: f64) -> Self {
        let wanted_m = metres + by_m;
        let metres = Value::Constant(if by_m > 0.0 { wanted_m.ceil() } else { wanted_m.floor() });
        Self::SetAltitude { of: of.clone(), altitude: Some(Altitude { metres, reference }) }
    }

    /// Another altitude for a leg or stage that is at `metres` now: at least `by_m` higher, to tens of metres of the same reference.
    pub fn raise(of: &Id, metres: f64, reference: AltitudeReference, by_m: f64) -> Self {
        let metres = Value::Constant(((metres + by_m) / RAISED_TO_M).ceil() * RAISED_TO_M);
        Self::SetAltitude { of: of.clone(), altitude: Some(Altitude { metres, reference }) }
    }

    /// It takes something out of the plan.
    pub fn removes(&self) -> bool {
        match self {
            Edit::DeleteLeg { .. } | Edit::Remove { .. } => true,
            Edit::All(edits) => edits.iter().any(Edit::removes),
            _ => false,
        }
    }

    /// The plan with this edit made. The old one is untouched.
    ///
    /// # Errors
    /// Something the edit names is not there or can't be edited this way; nothing is applied then. The result may
    /// still have problems: see [`crate::check`].
    pub fn apply(&self, plan: &FlightPlan) -> Result<FlightPlan, EditError> {
        let mut edited = plan.clone();
        self.change(&mut edited)?;
        Ok(edited)
    }

    fn change(&self, plan: &mut FlightPlan) -> Result<(), EditError> {
        match self {
            Edit::MoveFix { fix, to } => {
                found(plan.fixes.iter_mut().find(|f| f.id == *fix), fix)?.position = *to
            }
            Edit::MoveWaypoint { leg, to } => return shape::move_waypoint(plan, leg, *to),
            Edit::MoveCorner { leg, hole, corner, to } => {
                return shape::corner(plan, leg, *hole, |points| points.set(*corner, *to));
            }
            Edit::InsertCorner { leg, hole, before, at } => {
                return shape::corner(plan, leg, *hole, |points| points.insert(*before, *at));
            }
            Edit::RemoveCorner { leg, hole, corner } => {
                return shape::corner(plan, leg, *hole, |points| points.remove(*corner));
            }
            Edit::SetRadius { leg, radius_m } => return shape::set_radius(plan, leg, *radius_m),
            Edit::SetArea { leg, area } => return shape::set_area(plan, leg, area),
            Edit::SetNumber { leg, name, value } => {
                return number::set(leg_mut(plan, leg)?, name, value.as_ref());
            }
            Edit::SetActions { leg, actions } => leg_mut(plan, leg)?.actions.clone_from(actions),
            Edit::SetAltitude { of, altitude } => {
                *at_leg_or_stage(plan, of, |l| &mut l.altitude, |s| &mut s.altitude)? = altitude.clone()
            }
            Edit::SetSpeed { of, speed_mps } => {
                *at_leg_or_stage(plan, of, |l| &mut l.speed_mps, |s| &mut s.speed_mps)? = speed_mps.clone()
            }
            Edit::SetFlyOver { leg, fly_over } => waypoint_mut(plan, leg)?.fly_over = *fly_over,
            Edit::SetCount { leg, count } => *count_mut(plan, leg)? = count.clone(),
            Edit::SetDefault { leg, branch } => *default_mut(plan, leg)? = branch.clone(),
            Edit::Rename { id, name } => name_mut(plan, id)?.clone_from(name),
            Edit::SetVariable { name, value } => return set_variable(plan, name, value.clone()),
            Edit::SetEmergency { of, cause, plan: to } => {
                associate(emergency_mut(plan, of.as_ref())?, *cause, to.as_ref())
            }
            Edit::InsertLeg { leg, at } => return lists::insert(plan, leg.as_ref().clone().into(), at),
            Edit::PasteLeg { leg, at } => return lists::paste(plan, leg.as_ref().clone(), at),
            Edit::DeleteLeg { leg } => drop(lists::remove(plan, leg)?),
            Edit::MoveLeg { leg, at } => return lists::relocate(plan, leg, at),
            Edit::ReplaceLeg { leg, with } => *leg_mut(plan, leg)? = with.as_ref().clone(),
            Edit::Distinguish { id, to } => return repair::distinguish(plan, id, to),
            Edit::Refer { of, from, to } => return repair::refer(plan, of.as_ref(), from, to),
            Edit::CorrectName { of, within, from, to } => {
                return rename::in_expressions(plan, of, within.as_deref(), [from, to]);
            }
            Edit::SetId { id, to } => return rename::anything(plan, id, to),
            Edit::SetTitle(name) => plan.name.clone_from(name),
            Edit::SetAircraft(name) => plan.aircraft.clone_from(name),
            Edit::SetRunway { of, runway } => return repair::set_runway(plan, of, runway),
            Edit::Add(thing) => things::add(plan, thing),
            Edit::Replace { id, with } => return things::replace(plan, id, with),
            Edit::Remove { id } => return things::remove(plan, id),
            Edit::MoveThing { id, before } => return things::relocate(plan, id, before.as_ref()),
            Edit::AppendStage { to, stage } => return lists::append_stage(plan, to.as_ref(), stage),
            Edit::InsertStage { stage, before } => {
                return lists::insert_stage(plan, stage.as_ref().clone(), before);
            }
            Edit::ReplaceStage { stage, with } => return lists::replace_stage(plan, stage, with),
            Edit::MoveStage { stage, before } => return lists::move_stage(plan, stage, before),
            Edit::All(edits) => return edits.iter().try_for_each(|edit| edit.change(plan)),
        }
        Ok(())
    }
}

fn found<T>(thing: Option<T>, id: &Id) -> Result<T, EditError> {
    thing.ok_or_else(|| EditError::Unknown(id.clone()))
}

fn not_applicable(id: &Id, reason: &'static str) -> EditError {
    EditError::NotApplicable { id: id.clone(), reason }
}

fn stages_mut(plan: &mut FlightPlan) -> impl Iterator<Item = &mut crate::Stage> {
    plan.stages.iter_mut().chain(plan.emergency_plans.iter_mut().flat_map(|e| e.stages.iter_mut()))
}

fn leg_mut<'a>(plan: &'a mut FlightPlan, id: &Id) -> Result<&'a mut Leg, EditError> {
    let (list, index) = lists::list_in_plan(plan, id)?;
    found(list.get_mut(index).map(Arc::make_mut), id)
}

/// A property that legs and stages both have.
fn at_leg_or_stage<'a, T>(
    plan: &'a mut FlightPlan,
    id: &Id,
    of_leg: fn(&mut Leg) -> &mut T,
    of_stage: fn(&mut crate::Stage) -> &mut T,
) -> Result<&'a mut T, EditError> {
    if plan.stage(id).is_some() {
        return found(stages_mut(plan).find(|s| s.id == *id).map(of_stage), id);
    }
    leg_mut(plan, id).map(of_leg)
}

fn name_mut<'a>(plan: &'a mut FlightPlan, id: &Id) -> Result<&'a mut String, EditError> {
    if plan.fix(id).is_some() {
        return found(plan.fixes.iter_mut().find(|f| f.id == *id).map(|f| &mut f.name), id);
    }
    if plan.emergency_plan(id).is_some() {
        return found(plan.emergency_plans.iter_mut().find(|e| e.id == *id).map(|e| &mut e.name), id);
    }
    if plan.procedure(id).is_some() {
        return found(plan.procedures.iter_mut().find(|p| p.id == *id).map(|p| &mut p.name), id);
    }
    if plan.zones.iter().any(|z| z.id == *id) {
        return found(plan.zones.iter_mut().find(|z| z.id == *id).map(|z| &mut z.name), id);
    }
    at_leg_or_stage(plan, id, |l| &mut l.name, |s| &mut s.name)
}

fn waypoint_mut<'a>(plan: &'a mut FlightPlan, id: &Id) -> Result<&'a mut PlanWaypoint, EditError> {
    match &mut leg_mut(plan, id)?.kind {
        LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, .. } | LegKind::Rf { to, .. } => Ok(to),
        LegKind::Cf { to, .. } | LegKind::Fa { from: to, .. } => Ok(to),
        LegKind::Hf(h) | LegKind::Ha(h) | LegKind::Hm { holding: h, .. } => Ok(&mut h.fix),
        _ => Err(not_applicable(id, "has no waypoint: choose a leg that goes to one")),
    }
}

fn count_mut<'a>(plan: &'a mut FlightPlan, id: &Id) -> Result<&'a mut Option<Value<f64>>, EditError> {
    match &mut leg_mut(plan, id)?.kind {
        LegKind::Iterative { count, .. } => Ok(count),
        _ => Err(not_applicable(id, "is no iterative leg: it has no count")),
    }
}

fn default_mut<'a>(plan: &'a mut FlightPlan, id: &Id) -> Result<&'a mut Option<Id>, EditError> {
    match &mut leg_mut(plan, id)?.kind {
        LegKind::Intersection { default, .. } => Ok(default),
        _ => Err(not_applicable(id, "is no fork: it has no branches")),
    }
}

fn emergency_mut<'a>(
    plan: &'a mut FlightPlan,
    of: Option<&Id>,
) -> Result<&'a mut EmergencyChoice, EditError> {
    match of {
        None => Ok(&mut plan.emergency),
        Some(id) => at_leg_or_stage(plan, id, |l| &mut l.emergency, |s| &mut s.emergency),
    }
}

fn associate(choice: &mut EmergencyChoice, cause: Option<Cause>, plan: Option<&Id>) {
    let index = choice.by_cause.iter().position(|(known, _)| *known == cause);
    choice.by_cause.retain(|(known, _)| *known != cause);
    if let Some(plan) = plan {
        choice.by_cause.insert(index.unwrap_or(choice.by_cause.len()), (cause, plan.clone()));
    }
    // as a document says it: the fallback first. One cause has one plan, so the others have no precedence and stay as they were added
    choice.by_cause.sort_by_key(|(cause, _)| cause.is_some());
}

fn set_variable(plan: &mut FlightPlan, name: &Id, value: VariableValue) -> Result<(), EditError> {
    let variable = found(plan.variables.iter_mut().find(|v| v.name == *name), name)?;
    variable.accepts(&value)?;
    variable.initial = value;
    Ok(())
}

#[cfg(test)]
mod tests;
