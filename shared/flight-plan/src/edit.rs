//! Edits as values: what a person did to a plan, to be applied, undone, or offered as a remedy.

mod repair;

use crate::{
    Altitude, Area, Cause, EmergencyChoice, FlightPlan, Id, Leg, LegKind, Pattern, Place, PlanWaypoint,
    Runway, Stage, Value, Variable, VariableError, VariableValue, Zone,
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
    /// Moves what a leg goes to, holds at or is about: its waypoint, its centre, or the whole of a polygon (by its first corner).
    /// A place that names a fix becomes a position of the leg's own; one that is bound to a variable moves the variable's initial value.
    MoveWaypoint {
        /// The leg.
        leg: Id,
        /// Where to.
        to: LatLon,
    },
    /// Moves a corner of a scan's polygon.
    MoveCorner {
        /// The scan.
        leg: Id,
        /// `None`: the outer ring, else which hole.
        hole: Option<usize>,
        /// Which corner.
        corner: usize,
        /// Where to.
        to: LatLon,
    },
    /// Resizes a circular scan or an orbit. A radius that is bound to a variable alone changes the variable's initial value.
    SetRadius {
        /// The leg.
        leg: Id,
        /// Metres.
        radius_m: f64,
    },
    /// Gives a scan another area.
    SetArea {
        /// The scan.
        leg: Id,
        /// The area.
        area: Area,
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
    /// Renames a leg, stage, fix or emergency plan for people; its identifier stays.
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
    /// Gives the last thing of an identifier another one. What refers to it goes on meaning the first.
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
    /// Makes the plan one for another aircraft.
    SetAircraft(String),
    /// Names the runway of a stage or of an emergency plan.
    SetRunway {
        /// The stage or emergency plan.
        of: Id,
        /// The runway.
        runway: Id,
    },
    /// Puts another runway in the place of one.
    ReplaceRunway {
        /// The old runway.
        runway: Id,
        /// The new one.
        with: Box<Runway>,
    },
    /// Puts another variable in the place of one.
    ReplaceVariable {
        /// The old variable.
        name: Id,
        /// The new one.
        with: Box<Variable>,
    },
    /// Puts another zone in the place of one.
    ReplaceZone {
        /// The old zone.
        zone: Id,
        /// The new one.
        with: Box<Zone>,
    },
    /// Adds a stage at the end.
    AppendStage {
        /// Of which emergency plan; `None`: of the main plan.
        to: Option<Id>,
        /// The stage.
        stage: Box<Stage>,
    },
    /// Removes a procedure and what is in it.
    DeleteProcedure {
        /// The procedure.
        procedure: Id,
    },
    /// Several edits as one.
    All(Vec<Edit>),
}

/// A place in a list of legs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Spot {
    /// Before a leg.
    Before(Id),
    /// After a leg.
    After(Id),
    /// At the end of a stage or loop.
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

impl Edit {
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
            Edit::MoveWaypoint { leg, to } => return move_waypoint(plan, leg, *to),
            Edit::MoveCorner { leg, hole, corner, to } => *corner_mut(plan, leg, *hole, *corner)? = *to,
            Edit::SetRadius { leg, radius_m } => return set_radius(plan, leg, *radius_m),
            Edit::SetArea { leg, area } => match &mut leg_mut(plan, leg)?.kind {
                LegKind::Scan(scan) => scan.area = area.clone(),
                _ => return Err(not_applicable(leg, "is no scan: it has no area")),
            },
            Edit::SetAltitude { of, altitude } => {
                *at_leg_or_stage(plan, of, |l| &mut l.altitude, |s| &mut s.altitude)? = altitude.clone()
            }
            Edit::SetSpeed { of, speed_mps } => {
                *at_leg_or_stage(plan, of, |l| &mut l.speed_mps, |s| &mut s.speed_mps)? = speed_mps.clone()
            }
            Edit::SetFlyOver { leg, fly_over } => waypoint_mut(plan, leg)?.fly_over = *fly_over,
            Edit::SetCount { leg, count } => match &mut leg_mut(plan, leg)?.kind {
                LegKind::Iterative { count: old, .. } => *old = count.clone(),
                _ => return Err(not_applicable(leg, "is no iterative leg: it has no count")),
            },
            Edit::SetDefault { leg, branch } => match &mut leg_mut(plan, leg)?.kind {
                LegKind::Intersection { default, .. } => *default = branch.clone(),
                _ => return Err(not_applicable(leg, "is no intersection: it has no branches")),
            },
            Edit::Rename { id, name } => name_mut(plan, id)?.clone_from(name),
            Edit::SetVariable { name, value } => return set_variable(plan, name, value.clone()),
            Edit::SetEmergency { of, cause, plan: to } => {
                associate(emergency_mut(plan, of.as_ref())?, *cause, to.as_ref())
            }
            Edit::InsertLeg { leg, at } => return insert(plan, leg.as_ref().clone(), at),
            Edit::DeleteLeg { leg } => drop(remove(plan, leg)?),
            Edit::MoveLeg { leg, at } => {
                let moved = remove(plan, leg)?;
                return insert(plan, moved, at);
            }
            Edit::ReplaceLeg { leg, with } => *leg_mut(plan, leg)? = with.as_ref().clone(),
            Edit::Distinguish { id, to } => return repair::distinguish(plan, id, to),
            Edit::Refer { of, from, to } => return repair::refer(plan, of.as_ref(), from, to),
            Edit::SetAircraft(name) => plan.aircraft.clone_from(name),
            Edit::SetRunway { of, runway } => return repair::set_runway(plan, of, runway),
            Edit::ReplaceRunway { runway, with } => return repair::replace_runway(plan, runway, with),
            Edit::ReplaceVariable { name, with } => return repair::replace_variable(plan, name, with),
            Edit::ReplaceZone { zone, with } => return repair::replace_zone(plan, zone, with),
            Edit::AppendStage { to, stage } => return repair::append_stage(plan, to.as_ref(), stage),
            Edit::DeleteProcedure { procedure } => return repair::delete_procedure(plan, procedure),
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

/// The list that holds a leg, and the leg's index in it.
fn list_of<'a>(legs: &'a mut Vec<Leg>, id: &Id) -> Option<(&'a mut Vec<Leg>, usize)> {
    if let Some(index) = legs.iter().position(|l| l.id == *id) {
        return Some((legs, index));
    }
    legs.iter_mut().find_map(|leg| match &mut leg.kind {
        LegKind::Iterative { body, .. } => list_of(body, id),
        _ => None,
    })
}

fn list_in_plan<'a>(plan: &'a mut FlightPlan, id: &Id) -> Result<(&'a mut Vec<Leg>, usize), EditError> {
    found(stages_mut(plan).find_map(|s| list_of(&mut s.legs, id)), id)
}

fn leg_mut<'a>(plan: &'a mut FlightPlan, id: &Id) -> Result<&'a mut Leg, EditError> {
    let (list, index) = list_in_plan(plan, id)?;
    found(list.get_mut(index), id)
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
    choice.by_cause.retain(|(c, _)| *c != cause);
    choice.by_cause.extend(plan.map(|plan| (cause, plan.clone())));
    // the order in which a document says it: the fallback first
    choice.by_cause.sort_by_key(|(cause, _)| *cause);
}

fn set_variable(plan: &mut FlightPlan, name: &Id, value: VariableValue) -> Result<(), EditError> {
    let variable = found(plan.variables.iter_mut().find(|v| v.name == *name), name)?;
    variable.accepts(&value)?;
    variable.initial = value;
    Ok(())
}

fn move_waypoint(plan: &mut FlightPlan, id: &Id, to: LatLon) -> Result<(), EditError> {
    if let LegKind::Scan(scan) = &mut leg_mut(plan, id)?.kind
        && let Area::Polygon { corners, holes } = &mut scan.area
    {
        shift(corners, holes, to);
        return Ok(());
    }
    match place_mut(leg_mut(plan, id)?) {
        None => Err(not_applicable(id, "goes nowhere itself: move the legs in it")),
        Some(Place::Position(Value::Expression(source))) => {
            let variable = bound_to(id, source)?;
            set_variable(plan, &variable, VariableValue::Position(to))
        }
        Some(place) => {
            *place = Place::Position(Value::Constant(to));
            Ok(())
        }
    }
}

/// The variable that an expression consists of.
fn bound_to(id: &Id, source: &Arc<str>) -> Result<Id, EditError> {
    let word = source.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    if word {
        Ok(Id(source.clone()))
    } else {
        Err(not_applicable(id, "is computed by an expression: edit the variables in it"))
    }
}

fn place_mut(leg: &mut Leg) -> Option<&mut Place> {
    match &mut leg.kind {
        LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, .. } | LegKind::Rf { to, .. } => {
            Some(&mut to.place)
        }
        LegKind::Cf { to, .. } | LegKind::Fa { from: to, .. } => Some(&mut to.place),
        LegKind::Hf(h) | LegKind::Ha(h) | LegKind::Hm { holding: h, .. } => Some(&mut h.fix.place),
        LegKind::Orbit { centre, .. } => Some(centre),
        LegKind::Scan(scan) => centre_mut(&mut scan.area),
        LegKind::Pattern(pattern) => match pattern {
            Pattern::Spiral { centre, .. }
            | Pattern::ExpandingSquare { centre, .. }
            | Pattern::Sector { centre, .. }
            | Pattern::FigureEight { centre, .. } => Some(centre),
            Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. } => route.first_mut(),
            Pattern::Contour { area, .. } => centre_mut(area),
        },
        LegKind::Call(call) => call.anchor.as_mut(),
        LegKind::Iterative { .. } | LegKind::Intersection { .. } => None,
    }
}

fn centre_mut(area: &mut Area) -> Option<&mut Place> {
    match area {
        Area::Circle { centre, .. } => Some(centre),
        Area::Polygon { .. } | Area::Expression(_) => None,
    }
}

/// Moves a polygon so that its first corner comes to `to`; distances and bearings from there stay.
fn shift(corners: &mut [LatLon], holes: &mut [Vec<LatLon>], to: LatLon) {
    let Some(from) = corners.first().copied().filter(|p| p.is_valid()) else { return };
    for corner in corners.iter_mut().chain(holes.iter_mut().flatten()).filter(|p| p.is_valid()) {
        let way = from.inverse(*corner);
        *corner = to.destination(way.bearing_start_deg, way.distance_m);
    }
}

fn corner_mut<'a>(
    plan: &'a mut FlightPlan,
    id: &Id,
    hole: Option<usize>,
    corner: usize,
) -> Result<&'a mut LatLon, EditError> {
    let missing = not_applicable(id, "has no such corner: choose a corner of its polygon");
    let LegKind::Scan(scan) = &mut leg_mut(plan, id)?.kind else { return Err(missing) };
    let Area::Polygon { corners, holes } = &mut scan.area else { return Err(missing) };
    let ring = match hole {
        None => Some(corners),
        Some(hole) => holes.get_mut(hole),
    };
    ring.and_then(|ring| ring.get_mut(corner)).ok_or(missing)
}

fn set_radius(plan: &mut FlightPlan, id: &Id, radius_m: f64) -> Result<(), EditError> {
    let radius = match &mut leg_mut(plan, id)?.kind {
        LegKind::Scan(crate::Scan { area: Area::Circle { radius_m, .. }, .. })
        | LegKind::Orbit { radius_m, .. } => radius_m,
        _ => return Err(not_applicable(id, "has no radius: choose a circular scan or an orbit")),
    };
    match radius {
        Value::Constant(old) => *old = radius_m,
        Value::Expression(source) => {
            let variable = bound_to(id, source)?;
            return set_variable(plan, &variable, VariableValue::Number(radius_m));
        }
    }
    Ok(())
}

fn remove(plan: &mut FlightPlan, id: &Id) -> Result<Leg, EditError> {
    let (list, index) = list_in_plan(plan, id)?;
    Ok(list.remove(index))
}

fn insert(plan: &mut FlightPlan, leg: Leg, at: &Spot) -> Result<(), EditError> {
    match at {
        Spot::Before(id) => {
            let (list, index) = list_in_plan(plan, id)?;
            list.insert(index, leg);
        }
        Spot::After(id) => {
            let (list, index) = list_in_plan(plan, id)?;
            list.insert(index + 1, leg);
        }
        Spot::EndOf(id) => list_inside(plan, id)?.push(leg),
    }
    Ok(())
}

/// The list that a stage or loop has inside.
fn list_inside<'a>(plan: &'a mut FlightPlan, id: &Id) -> Result<&'a mut Vec<Leg>, EditError> {
    if plan.stage(id).is_some() {
        return found(stages_mut(plan).find(|s| s.id == *id).map(|s| &mut s.legs), id);
    }
    match &mut leg_mut(plan, id)?.kind {
        LegKind::Iterative { body, .. } => Ok(body),
        _ => Err(not_applicable(id, "has no legs inside: choose a stage or an iterative leg")),
    }
}

#[cfg(test)]
mod tests;
