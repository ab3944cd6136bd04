//! Take-off and landing: the autopilot performs them, the plan says where and how high.

use super::arc::vertices;
use super::track::SAME_PLACE_M;
use super::{ExpandError, Point};
use crate::api::Action;
use crate::layout::homeward::{GlideIn, end_of, needed_amsl_m};
use crate::layout::path::{Level, PathState, distance_m};
use crate::layout::world::World;
use aircraft::Wind;
use aircraft::glide::{GlideStart, Laps};
use aircraft::glide_in::ALIGNED_DEG;
use aircraft::power::glide_sink_mps;
use flight_plan::{AltitudeReference, Runway, Stage};
use geometry::geodesy::{normalise_180, normalise_360};
use geometry::{LatLon, PathElement};

/// The point at which a take-off is over: on the runway's line, as far as the climb takes at the profile's climb rate.
///
/// # Errors
/// The stage names no runway of the plan, or has no altitude with a value.
pub fn take_off(stage: &Stage, world: &World) -> Result<Vec<Point>, ExpandError> {
    let runway = runway(stage, world)?;
    let altitude = stage.altitude.as_ref().ok_or(ExpandError::Incomplete)?;
    // the ground that a climb-out altitude is above is the runway, not what lies below its end
    let is_amsl = altitude.reference == AltitudeReference::Amsl;
    let ground_m = if is_amsl { 0.0 } else { runway.elevation_amsl_m };
    let metres = ground_m + world.number(&altitude.metres)?;
    let level = Level { metres, reference: AltitudeReference::Amsl };
    let climb_m = (level.metres - runway.elevation_amsl_m).max(0.0);
    let speed_mps = world.profile.cruise_airspeed_mps;
    let way_m = runway.length_m + climb_m / world.profile.max_climb_mps.max(0.1) * speed_mps;
    let position = runway.threshold.destination(runway.heading_deg, way_m);
    let action = Action::TakeOff { heading_deg: runway.heading_deg };
    Ok(vec![Point { action, level: Some(level), ..Point::fly(position) }])
}

/// The final approach and the touch-down point. It begins at the runway's approach entry, if it has one and the path has not passed
/// that already: is there, or nearer to the threshold and on the runway's line.
///
/// # Errors
/// The stage names no runway of the plan.
pub fn land(stage: &Stage, path: &PathState, world: &World) -> Result<Vec<Point>, ExpandError> {
    let runway = runway(stage, world)?;
    let final_m = world.config.final_approach_m;
    let mut points = Vec::new();
    let gate = on_final(runway, final_m, world);
    let is_aligned = |from: LatLon| {
        // where the final begins there is no direction to it any more
        distance_m(from, gate.position) < SAME_PLACE_M
            || normalise_180(from.bearing_deg(gate.position) - runway.heading_deg).abs() <= ALIGNED_DEG
    };
    if let Some(wind) = world.glides_in {
        return Ok(gliding_in(path, runway, (wind, world)));
    }
    let mut from = path.last.position;
    let threshold_m = |at| distance_m(at, runway.threshold);
    let passed = |entry| {
        let nearer = threshold_m(from) <= threshold_m(entry) && is_aligned(from);
        nearer || distance_m(from, entry) < SAME_PLACE_M
    };
    if let Some(entry) = runway.approach_entry.filter(|entry| !passed(*entry)) {
        points.push(Point { position: entry, ..on_final(runway, threshold_m(entry), world) });
        from = entry;
    }
    if !is_aligned(from) {
        let radius_m = world.turn_radius_m(path.last.airspeed_mps);
        points.push(on_final(runway, final_m + 4.0 * radius_m, world));
    }
    points.push(gate);
    points.push(touch_down(runway));
    Ok(points)
}

fn touch_down(runway: &Runway) -> Point {
    Point {
        fly_over: true,
        action: Action::Land { heading_deg: runway.heading_deg },
        level: Some(Level { metres: runway.elevation_amsl_m, reference: AltitudeReference::Amsl }),
        ..Point::fly(runway.threshold)
    }
}

/// With the engine out a final approach begins at its gate, if the height suffices for the way by it; nothing is flown to line up for it.
/// Nearer on the runway's line nobody goes back to it: what the steepest descent can't lose is lost in circles there. Where the height
/// does not suffice for this end of the runway, and for the other one it does, it is landed on from there.
fn gliding_in(path: &PathState, runway: &Runway, (wind, world): (Wind, &World)) -> Vec<Point> {
    let (position, altitude_amsl_m) = (path.last.position, path.predicted_amsl_m);
    let from = GlideStart { position, altitude_amsl_m, course_deg: path.course_deg };
    let lands = GlideIn::of(world, wind, from, runway);
    let (runway, final_m) = (&lands.runway, world.config.final_approach_m);
    let end = end_of(runway);
    let left_s = distance_m(position, runway.threshold) / path.last.airspeed_mps.max(1.0);
    let is_too_high = altitude_amsl_m - world.profile.max_descent_mps * left_s > runway.elevation_amsl_m;
    let mut points = if let Some(final_m) = lands.final_m {
        losing_height(on_final(runway, final_m, world), path, runway, (wind, world))
    } else if is_too_high && end.is_on_final(position, end.final_begins_at(final_m)) {
        // it is there
        losing_height(Point::fly(position), path, runway, (wind, world)).split_off(1)
    } else {
        Vec::new()
    };
    points.push(touch_down(runway));
    points
}

/// With the engine out: to where the final approach begins, and around there as often as it takes to lose what is too much of the height.
/// As many circles as the steepest descent needs, and no more than a glide has height for: what is left of it in smaller ones. Each point
/// keeps the height that the rest of the way takes from there.
fn losing_height(
    gate: Point,
    path: &PathState,
    runway: &Runway,
    (wind, world): (Wind, &World),
) -> Vec<Point> {
    let (profile, mps) = (world.profile, path.last.airspeed_mps.max(1.0));
    let way_s = distance_m(path.last.position, gate.position) / mps;
    let needed_m = needed_amsl_m(world, wind, gate.position, runway);
    let wanted_m =
        needed_m.unwrap_or(runway.elevation_amsl_m).max(gate.level.map_or(f64::NEG_INFINITY, |l| l.metres));
    let (steep_mps, glide_mps) = (profile.max_descent_mps, glide_sink_mps(profile, mps, 1.0));
    let [too_much_m, there_is_m] =
        [steep_mps, glide_mps].map(|mps| path.predicted_amsl_m - mps * way_s - wanted_m);
    let laps = Laps::losing((profile, wind), steep_mps, (too_much_m, there_is_m));
    let mut left_m: f64 = laps.iter().map(Laps::height_m).sum();
    let at_least = |metres: f64| Some(Level { metres, reference: AltitudeReference::Amsl });
    let mut points = vec![Point { level: at_least(wanted_m + left_m), ..gate }];
    for laps in laps.into_iter().filter(|laps| laps.count > 0) {
        let corners = around(gate.position, laps, path, runway, world);
        let takes_m = laps.height_m() / (corners.len() as f64).max(1.0);
        points.extend(corners.into_iter().map(|corner| {
            left_m -= takes_m;
            Point { level: at_least(wanted_m + left_m.max(0.0)), ..corner }
        }));
    }
    points
}

/// So many times around, from a place on the runway's line and back to it in line with the runway, on the side that it comes from.
fn around(at: LatLon, laps: Laps, path: &PathState, runway: &Runway, world: &World) -> Vec<Point> {
    let radius_m = laps.circle.radius_m;
    let side = if normalise_180(runway.heading_deg - path.course_deg) < 0.0 { -1.0 } else { 1.0 };
    let centre = at.destination(runway.heading_deg + side * 90.0, radius_m);
    let start_bearing_deg = normalise_360(runway.heading_deg - side * 90.0);
    let sweep_deg = side * 360.0 * f64::from(laps.count);
    let arc = PathElement::Arc { centre, radius_m, start_bearing_deg, sweep_deg };
    vertices(&[arc], world.config.arc_tolerance_m)
}

fn on_final(runway: &Runway, before_m: f64, world: &World) -> Point {
    let height_m = before_m * world.config.glide_slope_deg.to_radians().tan();
    let metres = runway.elevation_amsl_m + height_m;
    Point {
        level: Some(Level { metres, reference: AltitudeReference::Amsl }),
        ..Point::fly(runway.threshold.destination(runway.heading_deg + 180.0, before_m))
    }
}

fn runway<'a>(stage: &Stage, world: &World<'a>) -> Result<&'a Runway, ExpandError> {
    let id = stage.runway.as_ref().ok_or(ExpandError::Incomplete)?;
    world.program.plan.runway(id).ok_or(ExpandError::Incomplete)
}
