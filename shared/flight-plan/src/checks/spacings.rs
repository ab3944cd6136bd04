//! `bad-spacing`: no distance between tracks, or a camera that gives none; `too-many-tracks`: so small a one that the
//! pattern would never end.

use super::Inspection;
use super::step::Step;
use crate::{AltitudeReference, Area, LegKind, Pattern, Problem, Spacing, Value};
use geometry::LocalFrame;

/// Most tracks beside each other: at 25 m/s and 1 km each that is a month.
const MAX_TRACKS: f64 = 100_000.0;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let Some(spacing) = spacing_of(&leg.kind) else { return };
    if let Some(message) = wrong(view, step, spacing) {
        problems.push(Problem::error("bad-spacing", message).of(&leg.id));
        return;
    }
    let Some(spacing_m) = metres(view, step, spacing) else { return };
    if let Some(width_m) = width_m(view, step).filter(|w| w / spacing_m > MAX_TRACKS) {
        let least_m = width_m / MAX_TRACKS;
        let message =
            format!("make the spacing at least {least_m:.2} m: {MAX_TRACKS} tracks are too many already");
        problems.push(Problem::error("too-many-tracks", message).of(&leg.id));
    }
}

fn spacing_of(kind: &LegKind) -> Option<&Spacing> {
    match kind {
        LegKind::Scan(scan) => Some(&scan.spacing),
        LegKind::Pattern(pattern) => match pattern {
            Pattern::Spiral { spacing, .. }
            | Pattern::ExpandingSquare { spacing, .. }
            | Pattern::TrackLine { spacing, .. }
            | Pattern::Corridor { spacing, .. }
            | Pattern::Contour { spacing, .. } => Some(spacing),
            Pattern::Sector { .. } | Pattern::FigureEight { .. } => None,
        },
        _ => None,
    }
}

/// What is wrong with a spacing and what to do; numbers without a value are another rule's business.
fn wrong(view: &Inspection, step: &Step, spacing: &Spacing) -> Option<&'static str> {
    let outside = |value: &Value<f64>, allowed: std::ops::Range<f64>| {
        view.number(value).is_some_and(|x| !allowed.contains(&x))
    };
    match spacing {
        Spacing::Metres(metres) => view
            .number(metres)
            .is_some_and(|m| m <= 0.0)
            .then_some("make the spacing of the tracks more than 0 m"),
        Spacing::Camera { field_of_view_deg, overlap, height_m } => {
            let fov = view.number(field_of_view_deg).is_some_and(|deg| deg <= 0.0 || deg >= 180.0);
            let low = height_m.as_ref().and_then(|h| view.number(h)).is_some_and(|h| h <= 0.0);
            let above_ground = |a: &crate::Altitude| a.reference == AltitudeReference::Agl;
            let no_height = height_m.is_none() && !step.altitude().is_some_and(above_ground);
            match () {
                () if fov => Some("make the camera's field of view more than 0° and less than 180°"),
                () if outside(overlap, 0.0..1.0) => {
                    Some("make the overlap 0 or more and less than 1: it is a share")
                }
                () if low => Some("make the camera's height above the ground more than 0 m"),
                () if no_height => Some(
                    "give the camera its `height` above the ground, or the leg an altitude above ground (agl)",
                ),
                () => None,
            }
        }
    }
}

/// The distance between the tracks of a leg that has such, metres; more than 0.
pub(super) fn spacing_m(view: &Inspection, step: &Step) -> Option<f64> {
    metres(view, step, spacing_of(&step.leg.kind)?)
}

/// S = 2·h·tan(FOV/2)·(1 − overlap), metres; more than 0.
fn metres(view: &Inspection, step: &Step, spacing: &Spacing) -> Option<f64> {
    let metres = match spacing {
        Spacing::Metres(metres) => view.number(metres)?,
        Spacing::Camera { field_of_view_deg, overlap, height_m } => {
            let height = height_m.as_ref().or(step.altitude().map(|a| &a.metres))?;
            let half_rad = view.number(field_of_view_deg)?.to_radians() / 2.0;
            2.0 * view.number(height)? * half_rad.tan() * (1.0 - view.number(overlap)?)
        }
    };
    Some(metres).filter(|m| *m > 0.0)
}

/// How wide a pattern is at most, metres.
fn width_m(view: &Inspection, step: &Step) -> Option<f64> {
    match &step.leg.kind {
        LegKind::Scan(scan) => across_m(view, &scan.area),
        LegKind::Pattern(pattern) => match pattern {
            Pattern::Spiral { outer_radius_m: r, .. } | Pattern::ExpandingSquare { radius_m: r, .. } => {
                Some(2.0 * view.number(r)?)
            }
            Pattern::Corridor { width_m, .. } => view.number(width_m),
            Pattern::Contour { area, .. } => across_m(view, area),
            _ => None,
        },
        _ => None,
    }
}

fn across_m(view: &Inspection, area: &Area) -> Option<f64> {
    match area {
        Area::Circle { radius_m, .. } => Some(2.0 * view.number(radius_m)?),
        Area::Polygon { corners, .. } => {
            let middle = LocalFrame::around(corners)?.origin();
            Some(2.0 * corners.iter().map(|c| middle.distance_m(*c)).fold(0.0, f64::max))
        }
        Area::Expression(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::check_legs;

    fn scan(attributes: &str) -> String {
        format!(r#"<scan id="s" {attributes}><area fix="A" radius="500"/></scan>"#)
    }

    #[test]
    fn tracks_are_some_way_apart() {
        check_legs(&[
            (&scan(r#"spacing="150""#), &[]),
            (&scan(r#"spacing="0""#), &["bad-spacing"]),
            (&scan(r#"spacing="-5""#), &["bad-spacing"]),
            (&scan(r#"spacing="0.02""#), &[]),
            (&scan(r#"spacing="0.005""#), &["too-many-tracks"]),
        ]);
    }

    #[test]
    fn a_camera_sees_a_strip() {
        let camera = |fov: &str, overlap: &str, more: &str| {
            scan(&format!(r#"fieldOfView="{fov}" overlap="{overlap}" {more}"#))
        };
        check_legs(&[
            (&camera("60", "0.3", r#"height="120""#), &[]),
            (&camera("60", "0.3", r#"altitude="120" altitudeReference="agl""#), &[]),
            (&camera("60", "0.3", ""), &["bad-spacing"]),
            (&camera("180", "0.3", r#"height="120""#), &["bad-spacing"]),
            (&camera("60", "1", r#"height="120""#), &["bad-spacing"]),
            (&camera("60", "0.3", r#"height="0""#), &["bad-spacing"]),
            (&camera("0.001", "0.3", r#"height="120""#), &["too-many-tracks"]),
        ]);
    }
}
