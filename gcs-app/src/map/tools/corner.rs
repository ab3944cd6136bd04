//! Corners of outlines and routes: what is one, and how it is removed.

use crate::command::{Queue, ViewCommand};
use crate::map::sketch::{AreaPart, Handled, Sketch};
use flight_plan::{Area, Edit, FlightPlan, Id, LegKind, Pattern, Place, Scan, Value, ZoneShape};

/// The corner that a handle is. Of a route the first point is one, too, though it is grabbed as the place of the leg; one that a
/// variable or a fix says is not: that moves what says it.
pub fn corner_of(plan: &FlightPlan, what: &Handled) -> Option<Handled> {
    match what {
        Handled::Corner { .. } | Handled::Area(_, AreaPart::Corner(_)) => Some(what.clone()),
        Handled::Waypoint(leg) => {
            let leg = leg.clone();
            let is_own =
                matches!(route(&plan.any_leg(&leg)?.kind)?.first()?, Place::Position(Value::Constant(_)));
            is_own.then_some(Handled::Corner { leg, hole: None, corner: 0 })
        }
        _ => None,
    }
}

fn route(kind: &LegKind) -> Option<&[Place]> {
    match kind {
        LegKind::Pattern(Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. }) => Some(route),
        _ => None,
    }
}

/// Removes a corner, unless too few would be left.
pub fn remove_corner(plan: &FlightPlan, sketch: &Sketch, corner: &Handled, queue: &mut Queue) {
    let (leg, hole, corner) = match corner {
        Handled::Corner { leg, hole, corner } => (leg, hole, corner),
        Handled::Area(variable, AreaPart::Corner(corner)) => {
            return match sketch.remove_area_corner(variable, *corner) {
                Some(edit) => queue.edit(edit),
                None => queue.view(too_few("An area", 3)),
            };
        }
        _ => return,
    };
    let (have, least, what) = points_of(plan, leg, *hole);
    if have <= least {
        if let Some(filled) = hole.and_then(|hole| filled(plan, leg, hole)) {
            return queue.edit(filled);
        }
        return queue.view(too_few(what, least));
    }
    queue.edit(Edit::RemoveCorner { leg: leg.clone(), hole: *hole, corner: *corner });
}

/// A hole that has too few corners left is none.
fn filled(plan: &FlightPlan, leg: &Id, hole: usize) -> Option<Edit> {
    let mut area = plan.any_leg(leg)?.area()?.clone();
    let Area::Polygon { holes, .. } = &mut area else { return None };
    (hole < holes.len()).then(|| holes.remove(hole))?;
    Some(Edit::SetArea { leg: leg.clone(), area })
}

fn too_few(what: &str, least: usize) -> ViewCommand {
    ViewCommand::Notice(format!("{what} has at least {least} points: delete the whole of it instead."))
}

/// How many points a ring or route has, how many it must have, and what it is.
fn points_of(plan: &FlightPlan, of: &Id, hole: Option<usize>) -> (usize, usize, &'static str) {
    if let Some(ZoneShape::Polygon(corners)) = plan.zone(of).map(|zone| &zone.shape) {
        return (corners.len(), 3, "A zone");
    }
    match plan.any_leg(of).map(|leg| &leg.kind) {
        Some(LegKind::Pattern(Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. })) => {
            (route.len(), 2, "A line")
        }
        Some(
            LegKind::Scan(Scan { area: Area::Polygon { corners, holes }, .. })
            | LegKind::Pattern(Pattern::Contour { area: Area::Polygon { corners, holes }, .. }),
        ) => {
            let ring = hole.map_or(Some(corners), |hole| holes.get(hole));
            (ring.map_or(0, Vec::len), 3, "An area")
        }
        // of a variable: the edit counts them
        _ => (usize::MAX, 3, "An area"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_point_of_a_line_is_its_corner_unless_a_variable_or_a_fix_says_it() {
        let of = Id::new("line");
        let first = Handled::Waypoint(of.clone());
        for (said, is_own) in
            [(r#"lat="36.33" lon="-84.17""#, true), (r#"at="= fire""#, false), (r#"fix="A""#, false)]
        {
            let variable = r#"<variables><variable name="fire" type="position" initial="36.33 -84.17"/></variables><mainPlan"#;
            let line = format!(
                r#"<trackLine id="line" spacing="400"><route><point {said}/><point lat="36.34" lon="-84.16"/></route></trackLine><TF id="side4""#
            );
            let text = include_str!("../../../../assets/plans/square.xml");
            let text = text.replacen("<mainPlan", variable, 1).replacen(r#"<TF id="side4""#, &line, 1);
            let plan = flight_plan::read(&text).plan;
            let corner = Handled::Corner { leg: of.clone(), hole: None, corner: 0 };
            assert_eq!(corner_of(&plan, &first), is_own.then_some(corner), "{said}");
        }
    }
}
