//! `rf-not-on-circle`: start and end are not equally far from the centre; `rf-not-tangent`: the path has a corner of
//! more than 1° where the arc begins or ends; `turn-too-tight`: the radius is below the aircraft's at that speed.

use super::Inspection;
use super::path::{Path, course_change_deg};
use super::remedy::{changed, slower, slower_or, speed_for_radius_mps};
use super::step::Step;
use crate::{Edit, LegKind, Problem, TurnDirection};
use geometry::{LatLon, LocalFrame};

/// Radii may differ by so much, metres, or by the share below, whichever is more.
const TOLERANCE_M: f64 = 2.0;
const TOLERANCE_SHARE: f64 = 0.005;
/// Corner that is still called tangent, degrees.
const TANGENT_DEG: f64 = 1.0;
/// Farther no centre is moved to mend an arc, metres: there the mistake is in its ends.
const FARTHEST_M: f64 = 5000.0;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    if let LegKind::Rf { to, centre, .. } = &step.leg.kind
        && centre.is_valid()
        && let Some(end) = view.place(&to.place)
    {
        too_tight(view, step, centre.distance_m(end), problems);
        circle(view, step, centre.distance_m(end), problems);
    }
    tangent(view, step, problems);
}

fn too_tight(view: &Inspection, step: &Step, radius_m: f64, problems: &mut Vec<Problem>) {
    let needed_m = view.turn_radius_m(step.speed_mps);
    if radius_m < needed_m {
        let speed_mps = speed_for_radius_mps(view, radius_m);
        let message = format!(
            "{}: its radius is {:.0} m, too tight at {:.0} m/s",
            slower_or(view, speed_mps, format!("widen the arc to {:.0} m", needed_m.ceil())),
            radius_m.floor(),
            step.speed_mps
        );
        let leg = &step.leg.id;
        let fix = slower(view, leg, speed_mps);
        problems.push(Problem::error("turn-too-tight", message).of(leg).perhaps_fixed_by(fix));
    }
}

fn circle(view: &Inspection, step: &Step, radius_m: f64, problems: &mut Vec<Problem>) {
    let LegKind::Rf { centre, .. } = &step.leg.kind else { return };
    let start = step.start.map(|start| centre.distance_m(start.position));
    let within = step.start_within.and_then(|region| region.distances_m(*centre));
    let Some((least_m, most_m)) = start.map(|m| (m, m)).or(within) else { return };
    let off_m = (least_m - radius_m).max(radius_m - most_m);
    if off_m > TOLERANCE_M.max(radius_m * TOLERANCE_SHARE) {
        let how_far = match start {
            Some(start_m) => format!("{start_m:.1} m"),
            None if least_m > radius_m => format!("at least {least_m:.0} m"),
            None => format!("at most {most_m:.0} m"),
        };
        let message = format!(
            "move the centre or an end: the arc starts {how_far} from its centre and ends {radius_m:.1} m from it"
        );
        let fix = tangent_arc(view, step).or_else(|| on_circle(view, step));
        let problem = Problem::error("rf-not-on-circle", message).of(&step.leg.id);
        problems.push(problem.perhaps_fixed_by(fix));
    }
}

/// Where this path joins the one before it, if one of the two is an arc.
fn tangent(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let Some(before) = view.before(step) else { return };
    let (Some(here), Some(there_deg)) = (step.directed(), before.course_end_deg()) else { return };
    let is_arc = |step: &Step| matches!(step.leg.kind, LegKind::Rf { .. });
    let culprit = if is_arc(step) {
        step
    } else if is_arc(before) {
        before
    } else {
        return;
    };
    let corner_deg = course_change_deg(there_deg, here.course_start_deg());
    if corner_deg > TANGENT_DEG {
        let message = format!(
            "move the centre or an end: between `{}` and `{}` the path turns by {corner_deg:.1}°, at most {TANGENT_DEG}° is tangent",
            before.leg.id, step.leg.id
        );
        let problem = Problem::error("rf-not-tangent", message).of(&culprit.leg.id);
        problems.push(problem.perhaps_fixed_by(tangent_arc(view, culprit)));
    }
}

/// The centre of the arc from the step's start to its end that begins tangent to the path before it, if it ends tangent to the
/// path after it too, and is wide enough: on the normal of the path at the start, where it is equally far from both ends.
fn tangent_arc(view: &Inspection, step: &Step) -> Option<Edit> {
    let LegKind::Rf { turn, .. } = &step.leg.kind else { return None };
    let (start, end) = (step.start?.position, step.end?.position);
    let course_deg = view.before(step)?.directed()?.course_end_deg();
    let frame = LocalFrame::new(start);
    let chord = frame.to_local(end);
    let side_deg = if *turn == TurnDirection::Right { 90.0 } else { -90.0 };
    let normal = geometry::Vec2::from_bearing_rad((course_deg + side_deg).to_radians());
    let radius_m = chord.dot(chord) / (2.0 * chord.dot(normal));
    if !(radius_m >= view.turn_radius_m(step.speed_mps) && radius_m < frame.radius_m()) {
        return None;
    }
    let centre = frame.to_geo(normal * radius_m);
    let after = view.after(step).and_then(Step::directed);
    let leaves_deg = Path::arc(start, end, centre, *turn).course_end_deg();
    let smooth = |path: Path| course_change_deg(leaves_deg, path.course_start_deg()) <= TANGENT_DEG;
    if !after.is_none_or(smooth) {
        return None;
    }
    moved_centre(step, centre)
}

/// The centre, moved by the shortest distance to where it is equally far from both ends.
fn on_circle(view: &Inspection, step: &Step) -> Option<Edit> {
    let LegKind::Rf { centre, .. } = &step.leg.kind else { return None };
    let frame = LocalFrame::new(step.start?.position);
    let end = frame.to_local(step.end?.position);
    let off = frame.to_local(*centre);
    let along = off.dot(end) / end.dot(end) - 0.5;
    let moved = off - end * along;
    let wide = moved.length() >= view.turn_radius_m(step.speed_mps) && moved.length() < frame.radius_m();
    wide.then(|| moved_centre(step, frame.to_geo(moved))).flatten()
}

fn moved_centre(step: &Step, to: LatLon) -> Option<Edit> {
    changed(&step.leg, |kind| {
        let LegKind::Rf { centre, .. } = kind else { return None };
        let is_near = centre.distance_m(to) <= FARTHEST_M;
        *centre = to;
        is_near.then_some(())
    })
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs};
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

    /// From C, 3.3 km north of B, round to B about a centre so far north of it, and on.
    fn behind(before: &str, centre_m: f64, onward_deg: f64) -> String {
        let end = LatLon::new(36.3, -84.17);
        let (centre, on) = (end.destination(0.0, centre_m), end.destination(onward_deg, 3000.0));
        format!(
            r#"<IF id="a" fix="A"/>{before}<RF id="r" fix="B" centreLat="{}" centreLon="{}" turn="right"/><TF id="t" lat="{}" lon="{}"/>"#,
            centre.lat_deg, centre.lon_deg, on.lat_deg, on.lon_deg
        )
    }

    #[test]
    fn an_arc_from_nobody_knows_where_ends_on_its_tangent_all_the_same() {
        let orbit = r#"<orbit id="o" radius="300" turn="left"><centre fix="C"/></orbit>"#;
        let scan = r#"<scan id="s" spacing="300"><area fix="C" radius="500"/></scan>"#;
        let climb = r#"<FA id="f" fix="C" course="90" altitude="600" altitudeReference="amsl"/>"#;
        for before in [orbit, scan, climb] {
            // about halfway
            check_legs(&[
                (&behind(before, 1700.0, 270.0), &[]),
                (&behind(before, 1700.0, 268.5), &["rf-not-tangent"]),
                (&behind(before, 1700.0, 133.0), &["rf-not-tangent"]),
            ]);
        }
    }

    /// C is 3.3 km from B: a centre 500 m south of it is 3.8 km away from C.
    #[test]
    fn an_arc_is_not_on_its_circle_if_no_place_before_it_is() {
        let orbit = |m: u32| format!(r#"<orbit id="o" radius="{m}" turn="left"><centre fix="C"/></orbit>"#);
        let spiral = r#"<spiral id="o" innerRadius="200" outerRadius="900" spacing="300" direction="inward" turn="left"><centre fix="C"/></spiral>"#;
        let off: &[&str] = &["rf-not-on-circle"];
        check_legs(&[
            (&behind(&orbit(300), -500.0, 90.0), off),
            (&behind(spiral, -500.0, 90.0), off),
            (&behind(&orbit(3300), -500.0, 90.0), off),
            (&behind(&orbit(3400), -500.0, 90.0), &[]),
            // a centre near C
            (&behind(&orbit(300), 3329.0, 270.0), off),
        ]);
    }

    /// A right turn whose end is a typing error away: what mends that is not a centre in another county.
    #[test]
    fn no_remedy_moves_a_centre_by_more_than_5_km() {
        let legs = |north: f64| {
            format!(
                r#"<IF id="a" fix="A"/><TF id="b" fix="B"/>
                <RF id="r" lat="{}" lon="-84.17" centreLat="36.297" centreLon="-84.17" turn="right"/>"#,
                36.3 - north
            )
        };
        let offered = |legs: &str| {
            let plan = crate::read(crate::checks::testing::plan_with(legs)).plan;
            let problems = crate::check(&plan, &aircraft::Profile::default(), &terrain::Flat(300.0));
            let arc = problems.into_iter().find(|problem| problem.code == "rf-not-on-circle");
            arc.unwrap_or_else(|| panic!("not found: {legs}")).fix.is_some()
        };
        assert!(offered(&legs(0.02)), "1 km");
        assert!(!offered(&legs(0.11)), "6 km");
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
        fixed_legs(&[
            (&with(300.0, 10.0, 0.0), "rf-not-on-circle"),
            (&with(300.0, 0.0, 1.2), "rf-not-tangent"),
            (&with(130.0, 0.0, 0.0), "turn-too-tight"),
        ]);
    }
}
