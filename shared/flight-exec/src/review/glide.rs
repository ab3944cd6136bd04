//! `glide-out-of-reach`: if the engine fails at some point, the glide along the emergency plan that answers there ends before its
//! runway; `glide-just-reached`: it gets there, with less height to spare than its margin; `glide-into-terrain`: it ends in a hill on the
//! way to where that plan is entered. The worst point is named.
//!
//! A plan that is named for an engine failure promises that all of it is within the glide. The fallback does not: it is reported where
//! its runway is so far away that even a glide straight there ends before it (the operator may leave out the rest of the plan),
//! and on how much of the flight.
//!
//! The glide is that of `aircraft::glide`. Legs of take-off, approach and landing are left out: there the runway is ahead, or not
//! yet out of sight. So are, for the fallback, those of departure and arrival: they climb and descend near it.

use super::View;
use super::alternates::{Alternate, Origin, alternates};
use super::emergency_coverage::Engine;
use aircraft::glide::{GlideStart, glide};
use aircraft::power::glide_sink_mps;
use flight_plan::{Problem, StageKind};
use geometry::{LatLon, PathElement};

/// Distance between samples of the ground, metres.
const SPACING_M: f64 = 150.0;
/// Most samples on one path.
const MAX_SAMPLES: f64 = 500.0;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let origins: Vec<Origin> = view.origins(GLIDES_EVERY_S).filter(|from| counts(view, from)).collect();
    for (plan, alternate) in alternates(view) {
        for named in [true, false] {
            let answers = Some(Engine { plan, named });
            let applies = |from: &&Origin| {
                view.emergency_coverage.engine(&from.leg) == answers && (named || !is_near_runway(view, from))
            };
            let here = origins.iter().filter(|from| alternate.is_from(view, from));
            let from: Vec<&Origin> = here.filter(applies).collect();
            let straight = [alternate.runway.threshold];
            let way = if named { alternate.route.as_slice() } else { &straight };
            problems.extend(glides(view, &alternate, (named, way), &from));
        }
    }
}

/// What is wrong with the glides by way of some places to the runway of an emergency plan, from the points of the flight where it
/// answers.
fn glides(
    view: &View,
    alternate: &Alternate,
    (named, way): (bool, &[LatLon]),
    from: &[&Origin],
) -> Option<Problem> {
    let missing = from.iter().map(|from| (missing_m(view, alternate, way, from), *from));
    let missing: Vec<(f64, &Origin)> = missing.collect();
    let count = |is_meant: fn(f64, &View) -> bool| {
        let count = missing.iter().filter(|(missing_m, _)| is_meant(*missing_m, view)).count();
        percent(count, from.len())
    };
    let worst = missing.iter().max_by(|(a, _), (b, _)| a.total_cmp(b)).filter(|(worst_m, _)| *worst_m > 0.0);
    let Some(worst) = worst else {
        let samples = from.iter().filter(|_| named).step_by(SAMPLE_EVERY);
        return samples.into_iter().find_map(|from| hill(view, alternate, from));
    };
    if !is_short(worst.0, view) {
        let percent = count(|missing_m, _| missing_m > 0.0);
        return Some(just_reached(view, alternate, *worst, (named, percent)));
    }
    let counted = Counted {
        percent: count(is_short),
        straight_percent: named.then(|| straight_percent(view, alternate, from)),
    };
    Some(out_of_reach(view, alternate, *worst, counted))
}

/// It ends before the runway, and not only with less to spare than it should have.
fn is_short(missing_m: f64, view: &View) -> bool {
    missing_m > view.conditions.margins.glide_m
}

/// On how much of the flight a plan is out of reach.
struct Counted {
    /// Of a plan that is named for an engine failure by the glide along all of it, of the fallback by one straight to its runway.
    percent: f64,
    /// Of a plan that is named, what it would be as the fallback: without that, to name a plan would look like a change for the worse.
    straight_percent: Option<f64>,
}

fn percent(part: usize, all: usize) -> f64 {
    (100.0 * part as f64 / all.max(1) as f64).ceil()
}

/// As of the fallback: without what is near the runway.
fn straight_percent(view: &View, alternate: &Alternate, from: &[&Origin]) -> f64 {
    let far: Vec<_> = from.iter().filter(|from| !is_near_runway(view, from)).collect();
    let straight = [alternate.runway.threshold];
    let short = far.iter().filter(|from| is_short(missing_m(view, alternate, &straight, from), view));
    percent(short.count(), far.len())
}

/// Seconds between points from which a glide is tried, and how many of them are left out before the next at whose hills one samples.
const GLIDES_EVERY_S: f64 = 5.0;
const SAMPLE_EVERY: usize = 6;

fn counts(view: &View, from: &Origin) -> bool {
    let left_out = [StageKind::TakeOff, StageKind::Approach, StageKind::Land];
    view.stage_kind(&from.leg).is_some_and(|kind| !left_out.contains(&kind))
}

fn is_near_runway(view: &View, from: &Origin) -> bool {
    let near = [StageKind::Departure, StageKind::Arrival];
    view.stage_kind(&from.leg).is_some_and(|kind| near.contains(&kind))
}

/// Height that is lacking at a point to glide to the runway with the margin to spare, metres; infinite if the wind does not let it.
fn missing_m(view: &View, alternate: &Alternate, way: &[LatLon], from: &Origin) -> f64 {
    let available_m =
        from.altitude_amsl_m - alternate.runway.elevation_amsl_m - view.conditions.margins.glide_m;
    height_m(view, alternate, way, from).map_or(f64::INFINITY, |needed_m| needed_m - available_m)
}

/// Height that the glide takes.
fn height_m(view: &View, alternate: &Alternate, way: &[LatLon], from: &Origin) -> Option<f64> {
    let Origin { position, altitude_amsl_m, course_deg, .. } = *from;
    let from = GlideStart { position, altitude_amsl_m, course_deg };
    let heading_deg = alternate.runway.heading_deg;
    let path = glide(view.profile, view.conditions.wind.into(), from, way, heading_deg)?;
    Some(altitude_amsl_m - path.last()?.altitude_amsl_m)
}

/// As What if calls it: it gets there, but what it has to spare is less than it should be.
fn just_reached(
    view: &View,
    alternate: &Alternate,
    (missing_m, from): (f64, &Origin),
    (named, percent): (bool, f64),
) -> Problem {
    let margin_m = view.conditions.margins.glide_m;
    let (plan, runway, over_m) = (&alternate.plan.id, &alternate.runway.id, margin_m - missing_m);
    let way = if named { format!("a glide along all of `{plan}`") } else { "a glide straight to it".into() };
    let message = format!(
        "engine failure: runway `{runway}` is just reached on {percent:.0} % of the flight. At worst, from {from}, {way} comes {over_m:.0} m above its threshold, and {margin_m:.0} m are to be spare: fly {:.0} m higher there",
        missing_m.ceil()
    );
    let subject = if named { &from.leg } else { plan };
    Problem::warning("glide-just-reached", message).of(subject).with_place(from.position)
}

fn out_of_reach(
    view: &View,
    alternate: &Alternate,
    (missing_m, from): (f64, &Origin),
    Counted { percent, straight_percent }: Counted,
) -> Problem {
    let short_m = (missing_m - view.conditions.margins.glide_m) * view.profile.glide_ratio;
    let what = if missing_m.is_finite() {
        format!(
            "ends {short_m:.0} m before the runway `{}`: fly {missing_m:.0} m higher there",
            alternate.runway.id
        )
    } else {
        format!("does not get to the runway `{}` against the wind: fly nearer to it", alternate.runway.id)
    };
    let plan = &alternate.plan.id;
    if let Some(straight) = straight_percent {
        let message = format!(
            "engine failure: `{plan}` is out of glide on {percent:.0} % of the flight where it answers. That is by a glide along all of it, for it is named for an engine failure; by a glide straight to the runway it is {straight:.0} %. How it is flown is between these: places that the height does not suffice for are left out. At worst, from {from}, a glide along all of it {what}, or name a nearer emergency plan for an engine failure"
        );
        return Problem::warning("glide-out-of-reach", message).of(&from.leg).with_place(from.position);
    }
    let message = format!(
        "engine failure: runway out of glide on {percent:.0} % of the flight. Be ready to land elsewhere: no emergency plan is named for the cause `engine`, so a glide straight to the runway counts; at worst, from {from}, it {what}, or name a nearer plan for this cause"
    );
    Problem::warning("glide-out-of-reach", message).of(plan).with_place(from.position)
}

/// A hill that the glide to the plan's entry runs into.
fn hill(view: &View, alternate: &Alternate, from: &Origin) -> Option<Problem> {
    let speed_mps = view.profile.cruise_airspeed_mps;
    let way = PathElement::Line { from: from.position, to: alternate.entry };
    let (length_m, course_deg) = crate::layout::path::distance_and_course(from.position, alternate.entry);
    let slope = glide_sink_mps(view.profile, speed_mps, 1.0)
        / view.conditions.wind.ground_speed_mps(speed_mps, course_deg)?;
    let samples = (length_m / SPACING_M).ceil().clamp(1.0, MAX_SAMPLES);
    let along = (0..samples as u32).map(|i| length_m * f64::from(i) / samples);
    let under = |along_m: f64| -> Option<LatLon> {
        let position = way.point_at(along_m);
        let ground_m = view.terrain.elevation_m(position)?;
        (from.altitude_amsl_m - along_m * slope < ground_m).then_some(position)
    };
    let hit = along.into_iter().find_map(under)?;
    let message = format!(
        "fly higher there, or name another emergency plan for an engine failure. From {from}, the glide to `{}` runs into a hill at {:.5}, {:.5}",
        alternate.plan.id, hit.lat_deg, hit.lon_deg
    );
    Some(Problem::warning("glide-into-terrain", message).of(&from.leg).with_place(hit))
}
