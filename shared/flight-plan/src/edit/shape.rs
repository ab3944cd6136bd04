//! Where legs and zones go and what they cover.

use super::{EditError, leg_mut, not_applicable, set_variable};
use crate::figures;
use crate::{Area, FlightPlan, Id, Leg, LegKind, Pattern, Place, Value, VariableValue, Zone, ZoneShape};
use geometry::LatLon;
use std::sync::Arc;

const COMPUTED: &str = "is computed by an expression: edit the variables in it";
const NO_CORNER: &str = "has no such corner: choose a corner of its polygon or route";

/// The variable that an expression consists of.
fn bound_to(id: &Id, source: &Arc<str>) -> Result<Id, EditError> {
    let word = source.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    if word { Ok(Id::new(source)) } else { Err(not_applicable(id, COMPUTED)) }
}

fn zone_mut<'a>(plan: &'a mut FlightPlan, id: &Id) -> Option<&'a mut Zone> {
    plan.zones.iter_mut().find(|z| z.id == *id)
}

pub(super) fn set_area(plan: &mut FlightPlan, id: &Id, area: &Area) -> Result<(), EditError> {
    let missing = not_applicable(id, "has no area: choose a scan or contour");
    area_mut(leg_mut(plan, id)?).ok_or(missing)?.clone_from(area);
    Ok(())
}

/// The area that it covers.
pub(crate) fn area_mut(leg: &mut Leg) -> Option<&mut Area> {
    match &mut leg.kind {
        LegKind::Scan(scan) => Some(&mut scan.area),
        LegKind::Pattern(Pattern::Contour { area, .. }) => Some(area),
        _ => None,
    }
}

fn route_mut(leg: &mut Leg) -> Option<&mut Vec<Place>> {
    match &mut leg.kind {
        LegKind::Pattern(Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. }) => Some(route),
        _ => None,
    }
}

pub(super) fn move_waypoint(plan: &mut FlightPlan, id: &Id, to: LatLon) -> Result<(), EditError> {
    if let Some(zone) = zone_mut(plan, id) {
        match &mut zone.shape {
            ZoneShape::Circle { centre, .. } => *centre = to,
            ZoneShape::Polygon(corners) => shift(corners.iter_mut(), to),
        }
        return Ok(());
    }
    let leg = leg_mut(plan, id)?;
    match area_mut(leg) {
        Some(Area::Polygon { corners, holes }) => {
            shift(corners.iter_mut().chain(holes.iter_mut().flatten()), to);
            return Ok(());
        }
        Some(Area::Expression(source)) => {
            let name = bound_to(id, source)?;
            return with_polygon(plan, &name, |corners| {
                shift(corners.iter_mut(), to);
                Some(())
            });
        }
        _ => {}
    }
    if let Some(route) =
        route_mut(leg).filter(|r| matches!(r.first(), Some(Place::Position(Value::Constant(_)))))
    {
        shift(route.iter_mut().filter_map(constant_mut), to);
        return Ok(());
    }
    let Some(place) = place_mut(leg) else {
        return Err(not_applicable(id, "goes nowhere itself: move the legs in it"));
    };
    match set_place(place, to) {
        Some(source) => {
            let name = bound_to(id, &source)?;
            set_variable(plan, &name, VariableValue::Position(to))
        }
        None => Ok(()),
    }
}

/// Makes a place a position; or gives back the expression that it is bound to.
fn set_place(place: &mut Place, to: LatLon) -> Option<Arc<str>> {
    if let Place::Position(Value::Expression(source)) = place {
        return Some(source.clone());
    }
    *place = Place::Position(Value::Constant(to));
    None
}

fn constant_mut(place: &mut Place) -> Option<&mut LatLon> {
    match place {
        Place::Position(Value::Constant(p)) => Some(p),
        Place::Position(Value::Expression(_)) | Place::Fix(_) => None,
    }
}

/// As [`Leg::place`], to be changed.
pub(crate) fn place_mut(leg: &mut Leg) -> Option<&mut Place> {
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

/// Moves points so that the first one is at `to`; distances and bearings from there stay.
fn shift<'a>(points: impl Iterator<Item = &'a mut LatLon>, to: LatLon) {
    let mut points = points.filter(|p| p.is_valid());
    let Some(first) = points.next() else { return };
    let from = std::mem::replace(first, to);
    for point in points {
        let way = from.inverse(*point);
        *point = figures::place(to.destination(way.bearing_start_deg, way.distance_m));
    }
}

/// The points of a ring or route.
pub(super) enum Points<'a> {
    Ring(&'a mut Vec<LatLon>),
    Route(&'a mut Vec<Place>),
}

impl Points<'_> {
    /// `None`: there is no such point, or it is a route's that is bound to an expression.
    pub fn set(&mut self, index: usize, to: LatLon) -> Option<()> {
        match self {
            Points::Ring(ring) => *ring.get_mut(index)? = to,
            Points::Route(route) => set_place(route.get_mut(index)?, to).is_none().then_some(())?,
        }
        Some(())
    }

    pub fn insert(&mut self, before: usize, at: LatLon) -> Option<()> {
        match self {
            Points::Ring(ring) if before <= ring.len() => ring.insert(before, at),
            Points::Route(route) if before <= route.len() => {
                route.insert(before, Place::Position(Value::Constant(at)));
            }
            _ => return None,
        }
        Some(())
    }

    pub fn remove(&mut self, index: usize) -> Option<()> {
        match self {
            Points::Ring(ring) if index < ring.len() => drop(ring.remove(index)),
            Points::Route(route) if index < route.len() => drop(route.remove(index)),
            _ => return None,
        }
        Some(())
    }
}

/// Changes the points of a zone, an area or a route; of an area that is bound to a variable, the variable's initial value.
pub(super) fn corner(
    plan: &mut FlightPlan,
    id: &Id,
    hole: Option<usize>,
    change: impl Fn(&mut Points) -> Option<()>,
) -> Result<(), EditError> {
    let missing = not_applicable(id, NO_CORNER);
    if let Some(zone) = zone_mut(plan, id) {
        return match &mut zone.shape {
            ZoneShape::Polygon(corners) if hole.is_none() => {
                change(&mut Points::Ring(corners)).ok_or(missing)
            }
            _ => Err(missing),
        };
    }
    let leg = leg_mut(plan, id)?;
    if let Some(route) = route_mut(leg).filter(|_| hole.is_none()) {
        return change(&mut Points::Route(route)).ok_or(missing);
    }
    match (area_mut(leg), hole) {
        (Some(Area::Polygon { corners, .. }), None) => change(&mut Points::Ring(corners)).ok_or(missing),
        (Some(Area::Polygon { holes, .. }), Some(hole)) => {
            holes.get_mut(hole).and_then(|ring| change(&mut Points::Ring(ring))).ok_or(missing)
        }
        (Some(Area::Expression(source)), None) => {
            let name = bound_to(id, source)?;
            with_polygon(plan, &name, |corners| change(&mut Points::Ring(corners)))
        }
        _ => Err(missing),
    }
}

/// Changes the initial value of a polygon variable.
fn with_polygon(
    plan: &mut FlightPlan,
    name: &Id,
    change: impl FnOnce(&mut Vec<LatLon>) -> Option<()>,
) -> Result<(), EditError> {
    let Some(VariableValue::Polygon(mut corners)) = plan.variable(name).map(|v| v.initial.clone()) else {
        return Err(EditError::Unknown(name.clone()));
    };
    change(&mut corners).ok_or_else(|| not_applicable(name, NO_CORNER))?;
    set_variable(plan, name, VariableValue::Polygon(corners))
}

pub(super) fn set_radius(plan: &mut FlightPlan, id: &Id, radius_m: f64) -> Result<(), EditError> {
    let missing = not_applicable(id, "has no radius: choose a circle or a pattern that has one");
    if let Some(zone) = zone_mut(plan, id) {
        let ZoneShape::Circle { radius_m: old, .. } = &mut zone.shape else { return Err(missing) };
        *old = radius_m;
        return Ok(());
    }
    match radius_mut(leg_mut(plan, id)?).ok_or(missing)? {
        Value::Constant(old) => *old = radius_m,
        Value::Expression(source) => {
            let variable = bound_to(id, source)?;
            return set_variable(plan, &variable, VariableValue::Number(radius_m));
        }
    }
    Ok(())
}

/// The radius of a leg's circle or of its pattern; `None`: it has none.
pub fn radius_of(leg: &Leg) -> Option<Value<f64>> {
    radius_mut(&mut leg.clone()).cloned()
}

fn radius_mut(leg: &mut Leg) -> Option<&mut Value<f64>> {
    match &mut leg.kind {
        LegKind::Scan(crate::Scan { area: Area::Circle { radius_m, .. }, .. })
        | LegKind::Orbit { radius_m, .. }
        | LegKind::Pattern(
            Pattern::Contour { area: Area::Circle { radius_m, .. }, .. }
            | Pattern::Spiral { outer_radius_m: radius_m, .. }
            | Pattern::ExpandingSquare { radius_m, .. }
            | Pattern::Sector { radius_m, .. }
            | Pattern::FigureEight { radius_m, .. },
        ) => Some(radius_m),
        _ => None,
    }
}
