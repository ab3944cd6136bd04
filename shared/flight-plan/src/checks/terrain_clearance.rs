//! `below-terrain`: a leg goes into the ground; `low-clearance`: it comes nearer than the margin, away from runways.

use super::Inspection;
use super::remedy::relevelled;
use super::step::{Point, Step};
use crate::{Edit, LegKind, Problem, StageKind};

/// Height above the ground that a leg keeps, metres; departure, approach and land stages may come nearer.
const MARGIN_M: f64 = 50.0;
/// Distance between samples of the ground, metres: half of what 3″ data resolves.
const SPACING_M: f64 = 45.0;
/// Most samples on a leg.
const MAX_SAMPLES: f64 = 2_000.0;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    if is_high(view, step) == Some(true) {
        return;
    }
    let Some((clearance_m, ground_m)) = lowest_clearance_m(view, step) else { return };
    let near_runway =
        matches!(step.around.stage.kind, StageKind::Departure | StageKind::Approach | StageKind::Land);
    let leg = &step.leg.id;
    if clearance_m < 0.0 {
        let message = format!(
            "raise this leg by {:.0} m: it goes into the ground, which is {ground_m:.0} m AMSL high there",
            MARGIN_M - clearance_m
        );
        let problem = Problem::error("below-terrain", message).of(leg);
        problems.push(problem.perhaps_fixed_by(raised(view, step, clearance_m)));
    } else if clearance_m < MARGIN_M && !near_runway {
        let message = format!(
            "raise this leg by {:.0} m: it passes {clearance_m:.0} m above the ground",
            MARGIN_M - clearance_m
        );
        let problem = Problem::warning("low-clearance", message).of(leg);
        problems.push(problem.perhaps_fixed_by(raised(view, step, clearance_m)));
    }
}

/// Even the highest ground around is well below the whole leg.
fn is_high(view: &Inspection, step: &Step) -> Option<bool> {
    let (start, end) = (step.start?, step.end?);
    let (south_west, north_east) = step.path?.around(start.position, end.position)?;
    let lowest_m = start.altitude_amsl_m?.min(end.altitude_amsl_m?);
    Some(lowest_m - view.terrain.at_most_m(south_west, north_east)? >= MARGIN_M)
}

/// The leg raised at both ends by what it lacks, to whole metres.
fn raised(view: &Inspection, step: &Step, clearance_m: f64) -> Option<Edit> {
    let lacks_m = MARGIN_M - clearance_m;
    let lift = |of: &Step| relevelled(view, &of.leg.id, of.altitude(), of.end?.altitude_amsl_m?, lacks_m);
    let end = lift(step)?;
    let Some(before) = view.before(step) else { return Some(end) };
    let start = lift(before)?;
    Some(Edit::All(vec![start, end]))
}

/// `(least height above the ground, ground elevation there)`, metres.
fn lowest_clearance_m(view: &Inspection, step: &Step) -> Option<(f64, f64)> {
    // the preview flies patterns, and sees the ground below all of them
    let end = step.end.filter(|_| !matches!(step.leg.kind, LegKind::Pattern(_)))?;
    let at_end = clearance_m(view, end, end.altitude_amsl_m?);
    let along = step.start.zip(step.path).and_then(|(start, path)| {
        let from_m = start.altitude_amsl_m?;
        let samples = (path.length_m() / SPACING_M).ceil().clamp(1.0, MAX_SAMPLES);
        let to_m = end.altitude_amsl_m?;
        let clearance_at = |(share, position)| {
            let altitude_m = from_m + (to_m - from_m) * share;
            clearance_m(view, Point { position, altitude_amsl_m: None }, altitude_m)
        };
        let samples = path.along(start.position, end.position, samples as u32);
        samples.filter_map(clearance_at).min_by(|a, b| a.0.total_cmp(&b.0))
    });
    at_end.into_iter().chain(along).min_by(|a, b| a.0.total_cmp(&b.0))
}

fn clearance_m(view: &Inspection, at: Point, altitude_m: f64) -> Option<(f64, f64)> {
    let ground_m = view.terrain.elevation_m(at.position)?;
    Some((altitude_m - ground_m, ground_m))
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes_over, fixed, plan_with};
    use geometry::LatLon;
    use terrain::Terrain;

    /// A ridge between A and B.
    struct Ridge(f64);
    impl Terrain for Ridge {
        fn elevation_m(&self, p: LatLon) -> Option<f64> {
            Some(if (p.lon_deg + 84.185).abs() < 0.001 { self.0 } else { 300.0 })
        }
    }

    #[test]
    fn a_ridge_between_two_waypoints_is_seen() {
        let plan = plan_with(r#"<IF id="a" fix="A"/><TF id="b" fix="B"/>"#);
        for (ridge_m, expected) in
            [(440.0, &[][..]), (460.0, &["low-clearance"]), (510.0, &["below-terrain"])]
        {
            assert_eq!(codes_over(&plan, &Ridge(ridge_m)), expected, "{ridge_m}");
        }
    }

    /// Over flat ground at 300 m.
    #[test]
    fn a_leg_that_is_too_low_is_raised() {
        for altitude_m in [340, 250] {
            let low = format!(
                r#"<IF id="a" fix="A"/><TF id="b" fix="B" altitude="{altitude_m}" altitudeReference="amsl"/>"#
            );
            let code = if altitude_m < 300 { "below-terrain" } else { "low-clearance" };
            fixed(&plan_with(&low), code);
        }
    }

    /// The ground and the runway are at 300 m.
    #[test]
    fn a_remedy_counts_from_what_the_altitude_counted_from() {
        for (reference, low_m, raised_m) in
            [("amsl", "320.5", 350.0), ("agl", "20.5", 50.0), ("home", "20", 50.0)]
        {
            let leg = |id: &str, fix: &str, kind: &str| {
                format!(
                    r#"<{kind} id="{id}" fix="{fix}" altitude="{low_m}" altitudeReference="{reference}"/>"#
                )
            };
            let plan = plan_with(&format!("{}{}", leg("a", "A", "IF"), leg("b", "B", "TF")));
            let repaired = fixed(&plan, "low-clearance");
            let altitude = repaired.leg(&"a".into()).unwrap().leg.altitude.clone().unwrap();
            let said = (altitude.reference.name(), altitude.metres);
            assert_eq!(said, (reference, crate::Value::Constant(raised_m)));
        }
    }
}
