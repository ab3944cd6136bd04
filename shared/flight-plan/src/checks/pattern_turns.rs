//! Turns inside patterns, which the aircraft can't fly within the room that there is: `turn-too-tight` where nothing of the
//! pattern is flown as drawn, `tracks-too-close` from one track into the next, `segment-too-short` along a route.
//!
//! Tracks of scans and corridors are interleaved instead, and turn outside the area; circles have a rule of their own.

use super::Inspection;
use super::path::{Path, SHORTEST_M, course_change_deg};
use super::remedy::{changed, or_slower, slower, slower_or, speed_for_radius_mps};
use super::spacings::spacing_m;
use super::step::Step;
use crate::{Area, LegKind, Pattern, Place, Problem, Spacing, Value, VariableValue};
use geometry::LatLon;
use geometry::geodesy::normalise_180;
use std::f64::consts::{PI, TAU};

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let LegKind::Pattern(pattern) = &step.leg.kind else { return };
    let tight = |found: Option<Tight>| found.and_then(|tight| tight.problem(view, step));
    problems.extend(match pattern {
        Pattern::Sector { radius_m, sectors, .. } => tight(sector(view, radius_m, sectors)),
        Pattern::Spiral { inner_radius_m, outer_radius_m, .. } => {
            let (rim, middle) = spiral(view, step, inner_radius_m, outer_radius_m).unzip();
            tight(rim).or_else(|| tight(middle))
        }
        Pattern::Contour { area, inward, .. } => tight(outermost_loop(view, step, area, *inward)),
        Pattern::ExpandingSquare { .. } | Pattern::TrackLine { .. } => tight(between_tracks(view, step)),
        Pattern::Corridor { .. } | Pattern::FigureEight { .. } => None,
    });
    if let Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. } = pattern {
        let beside_m = outermost_track_m(view, step, pattern).unwrap_or(0.0);
        problems.extend(along(view, step, route, beside_m));
    }
}

/// The tightest turn of a pattern.
struct Tight {
    code: &'static str,
    is_error: bool,
    /// The widest turn that fits, metres.
    fits_m: f64,
    /// What has to be how wide for a turn of the aircraft's radius, metres: `(what, of the aircraft's radius, more)`.
    wanted: (&'static str, f64, f64),
    /// Makes it so wide.
    widen: fn(&mut LegKind, f64) -> Option<()>,
}

impl Tight {
    fn problem(self, view: &Inspection, step: &Step) -> Option<Problem> {
        let leg = &step.leg;
        let needed_m = view.turn_radius_m(step.speed_mps);
        if self.fits_m >= needed_m {
            return None;
        }
        let (what, factor, more_m) = self.wanted;
        let wide_m = (factor * needed_m + more_m).ceil();
        let speed_mps = speed_for_radius_mps(view, self.fits_m);
        let or_slower = or_slower(view, speed_mps);
        let message = format!(
            "make the {what} at least {wide_m:.0} m{or_slower}: its turns leave room for a radius of {:.0} m, the aircraft's is {needed_m:.0} m at {:.1} m/s",
            self.fits_m.max(0.0),
            step.speed_mps
        );
        let widened = changed(leg, |kind| (self.widen)(kind, wide_m));
        let fix = widened.or_else(|| slower(view, &leg.id, speed_mps));
        let problem = if self.is_error { Problem::error } else { Problem::warning };
        Some(problem(self.code, message).of(&leg.id).perhaps_fixed_by(fix))
    }
}

/// Chords of c = 2R·sin(σ/2) with turns of 90° + σ/2 at both ends, σ being a sector's angle: each takes r·tan of half of it.
fn sector(view: &Inspection, radius: &Value<f64>, sectors: &Value<f64>) -> Option<Tight> {
    let (radius_m, sectors) = (view.number(radius).filter(|m| *m > 0.0)?, view.number(sectors)?);
    let half_rad = if sectors == 4.0 { PI / 4.0 } else { PI / 6.0 };
    let share = half_rad.sin() / (PI / 4.0 + half_rad / 2.0).tan();
    Some(Tight {
        code: "turn-too-tight",
        is_error: true,
        fits_m: radius_m * share,
        wanted: ("radius of the search", share.recip(), 0.0),
        widen: |kind, to_m| {
            let LegKind::Pattern(Pattern::Sector { radius_m, .. }) = kind else { return None };
            *radius_m = Value::Constant(to_m);
            Some(())
        },
    })
}

/// The outermost round, half a spacing inside, and the innermost one: half a spacing outside a hole; without one the middle is
/// crossed straight, and rounds that are nearer to it than half the spacing aren't needed.
fn spiral(view: &Inspection, step: &Step, inner: &Value<f64>, outer: &Value<f64>) -> Option<(Tight, Tight)> {
    let (inner_m, outer_m) = (view.number(inner)?, view.number(outer)?);
    if inner_m < 0.0 || inner_m >= outer_m {
        return None;
    }
    let half_m = spacing_m(view, step)? / 2.0;
    let rim = Tight {
        code: "turn-too-tight",
        is_error: true,
        fits_m: outer_m - half_m,
        wanted: ("outer radius", 1.0, half_m),
        widen: |kind, to_m| {
            let LegKind::Pattern(Pattern::Spiral { outer_radius_m, .. }) = kind else { return None };
            *outer_radius_m = Value::Constant(to_m);
            Some(())
        },
    };
    let middle = Tight {
        code: "tracks-too-close",
        is_error: false,
        fits_m: inner_m + half_m,
        wanted: ("inner radius", 1.0, -half_m),
        widen: |kind, to_m| {
            let LegKind::Pattern(Pattern::Spiral { inner_radius_m, .. }) = kind else { return None };
            *inner_radius_m = Value::Constant(to_m);
            Some(())
        },
    };
    Some((rim, middle))
}

/// A loop at a distance d inside (outside) an area of the perimeter P is at most P − 2πd (P + 2πd) long, and a loop that is
/// shorter than the aircraft's circle can't be flown at all.
fn outermost_loop(view: &Inspection, step: &Step, area: &Area, inward: bool) -> Option<Tight> {
    let half_m = spacing_m(view, step)? / 2.0;
    let out_m = if inward { -half_m } else { half_m };
    Some(Tight {
        code: "turn-too-tight",
        is_error: true,
        fits_m: perimeter_m(view, area)? / TAU + out_m,
        wanted: ("radius of the area (or its perimeter so many times 2π)", 1.0, -out_m),
        widen: |kind, to_m| {
            let LegKind::Pattern(Pattern::Contour { area: Area::Circle { radius_m, .. }, .. }) = kind else {
                return None;
            };
            *radius_m = Value::Constant(to_m);
            Some(())
        },
    })
}

fn perimeter_m(view: &Inspection, area: &Area) -> Option<f64> {
    let round_m = |corners: &[LatLon]| {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| Path::line(*a, *b).length_m()).sum()
    };
    match area {
        Area::Circle { radius_m, .. } => Some(TAU * view.number(radius_m)?),
        Area::Polygon { corners, .. } => Some(round_m(corners)),
        Area::Expression(source) => match view.value(source)? {
            VariableValue::Polygon(corners) => Some(round_m(&corners)),
            _ => None,
        },
    }
}

/// Two turns of 90° by r·tan 45° each, a spacing apart: between the first legs of a square, between passes beside a route.
fn between_tracks(view: &Inspection, step: &Step) -> Option<Tight> {
    Some(Tight {
        code: "tracks-too-close",
        is_error: false,
        fits_m: spacing_m(view, step)? / 2.0,
        wanted: ("spacing", 2.0, 0.0),
        widen: |kind, to_m| {
            let (LegKind::Pattern(Pattern::ExpandingSquare { spacing, .. })
            | LegKind::Pattern(Pattern::TrackLine { spacing, .. })) = kind
            else {
                return None;
            };
            *spacing = Spacing::Metres(Value::Constant(to_m));
            Some(())
        },
    })
}

/// How far beside its route a pattern has tracks at most, metres.
fn outermost_track_m(view: &Inspection, step: &Step, pattern: &Pattern) -> Option<f64> {
    let spacing_m = spacing_m(view, step)?;
    match pattern {
        Pattern::Corridor { width_m, .. } => Some(((view.number(width_m)? - spacing_m) / 2.0).max(0.0)),
        Pattern::TrackLine { returns, .. } => Some(if *returns { spacing_m / 2.0 } else { spacing_m }),
        _ => None,
    }
}

/// The piece of a route with the least room for the turns at its ends. Beside the route it is shorter by d·tan(A/2) at a corner
/// to that side, longer at one to the other.
fn along(view: &Inspection, step: &Step, route: &[Place], beside_m: f64) -> Option<Problem> {
    let places: Vec<LatLon> = route.iter().map(|p| view.place(p)).collect::<Option<_>>()?;
    let pieces: Vec<Path> =
        places.windows(2).filter_map(|w| Some(Path::line(*w.first()?, *w.last()?))).collect();
    if pieces.iter().any(|piece| piece.length_m() < SHORTEST_M) {
        return None;
    }
    // tan(A/2), positive to the right; a turn back has no room anywhere
    let corners: Vec<f64> = pieces.windows(2).filter_map(|w| Some(tangent(w.first()?, w.last()?))).collect();
    let at = |corner: Option<usize>| corner.and_then(|i| corners.get(i)).copied().unwrap_or(0.0);
    let fits_m = |(i, piece): (usize, &Path)| {
        let (first, last) = (at(i.checked_sub(1)), at(Some(i)));
        let turns = first.abs() + last.abs();
        (turns > 0.0).then(|| (i, (piece.length_m() - beside_m * (first + last).abs()) / turns))
    };
    let (piece, fits_m) = pieces.iter().enumerate().filter_map(fits_m).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let needed_m = view.turn_radius_m(step.speed_mps);
    let speed_mps = speed_for_radius_mps(view, fits_m);
    let spaced = format!("space the points {} and {} of the route out", piece + 1, piece + 2);
    let message = format!(
        "{}: between them the turns of the tracks have room for a radius of {:.0} m, the aircraft's is {needed_m:.0} m at {:.1} m/s",
        slower_or(view, speed_mps, spaced),
        fits_m.max(0.0),
        step.speed_mps
    );
    let problem = Problem::warning("segment-too-short", message).of(&step.leg.id);
    let fix = slower(view, &step.leg.id, speed_mps);
    (fits_m < needed_m).then(|| problem.perhaps_fixed_by(fix))
}

fn tangent(before: &Path, after: &Path) -> f64 {
    /// Turns up to this need no room, degrees (guidance: no fly-by for less).
    const STRAIGHT_DEG: f64 = 3.0;
    let (from_deg, to_deg) = (before.course_end_deg(), after.course_start_deg());
    let change_deg = course_change_deg(from_deg, to_deg);
    let side = normalise_180(to_deg - from_deg).signum();
    if change_deg <= STRAIGHT_DEG { 0.0 } else { side * (change_deg.to_radians() / 2.0).tan() }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs, message_of};

    fn about(kind: &str, attributes: &str) -> String {
        format!(r#"<{kind} id="p" turn="left" {attributes}><centre fix="A"/></{kind}>"#)
    }

    fn sector(radius: u32, sectors: u32, more: &str) -> String {
        about("sector", &format!(r#"radius="{radius}" sectors="{sectors}" {more}"#))
    }

    fn spiral(inner: u32, outer: u32, spacing: u32) -> String {
        let sizes = format!(r#"innerRadius="{inner}" outerRadius="{outer}" spacing="{spacing}""#);
        about("spiral", &format!(r#"{sizes} direction="outward""#))
    }

    fn square(spacing: u32) -> String {
        about("expandingSquare", &format!(r#"spacing="{spacing}" radius="2000""#))
    }

    fn contour(direction: &str, radius: u32) -> String {
        format!(
            r#"<contour id="p" turn="left" spacing="100" loops="1" direction="{direction}"><area fix="A" radius="{radius}"/></contour>"#
        )
    }

    /// East for `metres`, then north.
    fn route(kind: &str, attributes: &str, metres: f64) -> String {
        let lon = -84.2 + metres / 89_800.0;
        let points = format!(
            r#"<point lat="36.31" lon="-84.2"/><point lat="36.3" lon="-84.2"/><point lat="36.3" lon="{lon}"/><point lat="36.33" lon="{lon}"/>"#
        );
        format!(r#"<{kind} id="p" {attributes}><route>{points}</route></{kind}>"#)
    }

    /// At 25 m/s and 25° of bank the radius is 137 m.
    #[test]
    fn the_chords_of_a_sector_search_have_room_for_their_turns() {
        let tight: &[&str] = &["turn-too-tight"];
        check_legs(&[
            // 2 · r · tan 60°
            (&sector(480, 3, ""), &[]),
            (&sector(470, 3, ""), tight),
            (&sector(470, 6, ""), tight),
            // √2 · R = 2 · r · tan 67.5°
            (&sector(475, 4, ""), &[]),
            (&sector(460, 4, ""), tight),
            (&sector(400, 3, r#"speed="20""#), &[]),
        ]);
        let cases = [sector(470, 3, ""), sector(150, 6, ""), sector(100, 4, "")];
        cases.iter().for_each(|legs| fixed_legs(&[(legs, "turn-too-tight")]));
    }

    /// The slowest is 16 m/s, with a radius of 57 m.
    #[test]
    fn no_speed_is_advised_at_which_the_aircraft_can_not_fly() {
        let corridor = |metres| route("corridor", r#"width="600" spacing="300""#, metres);
        for (legs, code, possible) in [
            (square(200), "tracks-too-close", true),
            (square(100), "tracks-too-close", false),
            (corridor(560.0), "segment-too-short", true),
            (corridor(200.0), "segment-too-short", false),
        ] {
            let message = message_of(&legs, code);
            assert_eq!(message.contains("fly no faster than"), possible, "{message}");
        }
    }

    #[test]
    fn rounds_of_a_spiral_are_as_wide_as_the_aircraft_turns() {
        let close: &[&str] = &["tracks-too-close"];
        check_legs(&[
            (&spiral(100, 900, 100), &[]),
            (&spiral(80, 900, 100), close),
            (&spiral(0, 900, 280), &[]),
            (&spiral(0, 900, 100), close),
            (&spiral(0, 180, 100), &["turn-too-tight"]),
        ]);
        let cases = [spiral(80, 900, 100), spiral(0, 900, 40)];
        cases.iter().for_each(|legs| fixed_legs(&[(legs, "tracks-too-close")]));
        fixed_legs(&[(&spiral(0, 60, 20), "turn-too-tight")]);
    }

    #[test]
    fn a_contour_has_a_loop_that_can_be_flown() {
        check_legs(&[
            (&contour("inward", 190), &[]),
            (&contour("inward", 180), &["turn-too-tight"]),
            (&contour("outward", 90), &[]),
            (&contour("outward", 80), &["turn-too-tight"]),
        ]);
        fixed_legs(&[
            (&contour("inward", 180), "turn-too-tight"),
            (&contour("outward", 20), "turn-too-tight"),
        ]);
    }

    #[test]
    fn tracks_are_far_enough_apart_to_turn_from_one_into_the_next() {
        let line =
            |spacing: u32| route("trackLine", &format!(r#"spacing="{spacing}" returns="true""#), 2000.0);
        check_legs(&[
            (&square(280), &[]),
            (&square(200), &["tracks-too-close"]),
            (&line(280), &[]),
            (&line(200), &["tracks-too-close"]),
        ]);
        let cases = [square(200), square(50), line(200), line(50)];
        cases.iter().for_each(|legs| fixed_legs(&[(legs, "tracks-too-close")]));
    }

    /// Two turns of 90° to the left take r each, and the inner track is shorter by half of what the outermost ones are apart, twice.
    #[test]
    fn between_the_points_of_a_route_there_is_room_for_the_turns_of_all_tracks() {
        let corridor = |metres| route("corridor", r#"width="600" spacing="300""#, metres);
        let line = |metres| route("trackLine", r#"spacing="300" returns="true""#, metres);
        let short: &[&str] = &["segment-too-short"];
        check_legs(&[
            (&corridor(585.0), &[]),
            (&corridor(560.0), short),
            (&line(585.0), &[]),
            (&line(560.0), short),
        ]);
        fixed_legs(&[(&corridor(560.0), "segment-too-short")]);
    }
}
