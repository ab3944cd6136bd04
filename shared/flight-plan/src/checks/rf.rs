//! `rf-not-on-circle`: start and end are not equally far from the centre; `rf-not-tangent`: the path has a corner of
//! more than 1° where the arc begins or ends; `turn-too-tight`: the radius is below the aircraft's at that speed.

use super::Inspection;
use super::inspection::{Path, Step, course_change_deg};
use crate::{LegKind, Problem};

/// Radii may differ by so much, metres, or by the share below, whichever is more.
const TOLERANCE_M: f64 = 2.0;
const TOLERANCE_SHARE: f64 = 0.005;
/// Corner that is still called tangent, degrees.
const TANGENT_DEG: f64 = 1.0;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for step in &view.steps {
        if let LegKind::Rf { to, centre, .. } = &step.context.leg.kind
            && centre.is_valid()
            && let Some(end) = view.place(&to.place)
        {
            too_tight(view, step, centre.distance_m(end), problems);
            circle(step, centre.distance_m(end), problems);
        }
        tangent(view, step, problems);
    }
}

fn too_tight(view: &Inspection, step: &Step, radius_m: f64, problems: &mut Vec<Problem>) {
    let needed_m = view.turn_radius_m(step.speed_mps);
    if radius_m < needed_m {
        let message = format!(
            "widen the arc to {needed_m:.0} m or fly it slower: its radius is {radius_m:.0} m, too tight at {:.0} m/s",
            step.speed_mps
        );
        problems.push(Problem::error("turn-too-tight", message).of(&step.context.leg.id));
    }
}

fn circle(step: &Step, radius_m: f64, problems: &mut Vec<Problem>) {
    let (Some(start), LegKind::Rf { centre, .. }) = (step.start, &step.context.leg.kind) else { return };
    let start_m = centre.distance_m(start.position);
    if (start_m - radius_m).abs() > TOLERANCE_M.max(radius_m * TOLERANCE_SHARE) {
        let message = format!(
            "move the centre or an end: the arc starts {start_m:.1} m from its centre and ends {radius_m:.1} m from it"
        );
        problems.push(Problem::error("rf-not-on-circle", message).of(&step.context.leg.id));
    }
}

/// Where this path meets the one before it, if one of the two is an arc.
fn tangent(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let Some(before) = step.before.and_then(|i| view.steps.get(i)) else { return };
    let (Some(here), Some(there)) = (step.path, before.path) else { return };
    let blame = match (here, there) {
        (Path::Arc { .. }, _) => step,
        (_, Path::Arc { .. }) => before,
        _ => return,
    };
    let corner_deg = course_change_deg(there.course_end_deg(), here.course_start_deg());
    if corner_deg > TANGENT_DEG {
        let message = format!(
            "move the centre or an end: between `{}` and `{}` the path turns by {corner_deg:.1}°, at most {TANGENT_DEG}° is tangent",
            before.context.leg.id, step.context.leg.id
        );
        problems.push(Problem::error("rf-not-tangent", message).of(&blame.context.leg.id));
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::check_legs;
    use geometry::LatLon;

    /// Eastward from A to B, then a right turn of 90° about a centre south of B.
    fn with(radius_m: f64, centre_off_m: f64, bearing_off_deg: f64) -> String {
        let b = LatLon::new(36.3, -84.17);
        let south = 180.0 + LatLon::new(36.3, -84.20).inverse(b).bearing_end_deg - 90.0 + bearing_off_deg;
        let centre = b.destination(south, radius_m + centre_off_m);
        let end = centre.destination(south - 90.0, radius_m);
        format!(
            r#"<IF id="a" fix="A"/><TF id="b" fix="B"/>
            <RF id="r" lat="{}" lon="{}" centreLat="{}" centreLon="{}" turn="right"/>"#,
            end.lat_deg, end.lon_deg, centre.lat_deg, centre.lon_deg
        )
    }

    #[test]
    fn arcs_are_tangent_on_their_circle_and_flyable() {
        check_legs(&[
            (&with(300.0, 0.0, 0.0), &[]),
            (&with(300.0, 0.0, 0.9), &[]),
            (&with(300.0, 0.0, 1.2), &["rf-not-tangent"]),
            (&with(300.0, 10.0, 0.0), &["rf-not-on-circle"]),
            (&with(130.0, 0.0, 0.0), &["turn-too-tight"]),
        ]);
    }
}
