//! `bad-scan`: spacing, radius or overshoot that give no pattern; `bad-polygon`: an area that is no simple polygon.

use super::Inspection;
use crate::{Area, Id, LegKind, Problem, Scan, Spacing};
use geometry::{LatLon, LocalFrame, Polygon};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for step in &view.steps {
        if let LegKind::Scan(scan) = &step.context.leg.kind {
            sizes(view, scan, &step.context.leg.id, problems);
            if let Area::Polygon { corners, holes } = &scan.area {
                polygon(corners, holes, &step.context.leg.id, problems);
            }
        }
    }
}

fn sizes(view: &Inspection, scan: &Scan, of: &Id, problems: &mut Vec<Problem>) {
    let mut report = |message: &str| problems.push(Problem::error("bad-scan", message).of(of));
    if let Spacing::Metres(spacing_m) = &scan.spacing
        && view.number(spacing_m).is_some_and(|s| s <= 0.0)
    {
        report("make the spacing of the tracks more than 0 m");
    }
    if view.number(&scan.overshoot_m).is_some_and(|o| o < 0.0) {
        report("make the overshoot 0 m or more");
    }
    if let Area::Circle { radius_m, .. } = &scan.area
        && view.number(radius_m).is_some_and(|r| r <= 0.0)
    {
        report("make the radius of the area more than 0 m");
    }
}

fn polygon(corners: &[LatLon], holes: &[Vec<LatLon>], of: &Id, problems: &mut Vec<Problem>) {
    let mut report = |message: String| problems.push(Problem::error("bad-polygon", message).of(of));
    match LocalFrame::around(corners).map(|frame| Polygon::from_geo(&frame, corners, holes)) {
        None => report("give the area at least three corners, or a centre and a radius".into()),
        Some(Err(error)) => report(format!("correct the area: {error}")),
        Some(Ok(_)) => {}
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::check_legs;

    fn area(corners: &[(f64, f64)], hole: &[(f64, f64)]) -> String {
        let ring = |ring: &[(f64, f64)]| -> String {
            let corner = |(x, y): &(f64, f64)| {
                format!(r#"<corner lat="{}" lon="{}"/>"#, 36.3 + y / 1e3, -84.2 + x / 1e3)
            };
            ring.iter().map(corner).collect()
        };
        let hole = if hole.is_empty() { String::new() } else { format!("<hole>{}</hole>", ring(hole)) };
        format!(r#"<scan id="s" spacing="150"><area>{}{hole}</area></scan>"#, ring(corners))
    }

    #[test]
    fn areas_are_simple_polygons() {
        let square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)];
        let inside = [(2.0, 2.0), (4.0, 2.0), (4.0, 4.0)];
        let concave = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (5.0, 2.0), (0.0, 10.0)];
        check_legs(&[
            (&area(&square, &[]), &[]),
            (&area(&concave, &[]), &[]),
            (&area(&square, &inside), &[]),
            (&area(&[], &[]), &["bad-polygon"]),
            (&area(&[(0.0, 0.0), (10.0, 0.0)], &[]), &["bad-polygon"]),
            (&area(&[(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 10.0)], &[]), &["bad-polygon"]),
            (&area(&square, &[(12.0, 2.0), (14.0, 2.0), (14.0, 4.0)]), &["bad-polygon"]),
            (&area(&square, &[(8.0, 2.0), (12.0, 2.0), (12.0, 4.0)]), &["bad-polygon"]),
        ]);
    }

    #[test]
    fn sizes_give_a_pattern() {
        let with = |attributes: &str, radius: &str| {
            format!(r#"<scan id="s" {attributes}><area fix="A" radius="{radius}"/></scan>"#)
        };
        check_legs(&[
            (&with(r#"spacing="150""#, "500"), &[]),
            (&with(r#"spacing="0""#, "500"), &["bad-scan"]),
            (&with(r#"spacing="150" overshoot="-1""#, "500"), &["bad-scan"]),
            (&with(r#"spacing="150""#, "0"), &["bad-scan"]),
        ]);
    }
}
