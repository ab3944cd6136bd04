//! Take-off and landing: the autopilot performs them, the plan says where and how high.

use super::arc::vertices;
use super::track::SAME_PLACE_M;
use super::{ExpandError, Point};
use crate::api::Action;
use crate::layout::homeward::{ALIGNED_DEG, Arrival, RESERVE_M, is_on_final};
use crate::layout::path::{Level, PathState, distance_m};
use crate::layout::world::World;
use aircraft::Wind;
use aircraft::glide::{Circle, GlideStart};
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
        let approach = gliding_in(gate, path, runway, (wind, world));
        return Ok(approach.into_iter().chain([touch_down(runway)]).collect());
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
/// Nearer on the runway's line nobody goes back to it: what the steepest descent can't lose is lost in circles there.
fn gliding_in(gate: Point, path: &PathState, runway: &Runway, (wind, world): (Wind, &World)) -> Vec<Point> {
    let (position, altitude_amsl_m) = (path.last.position, path.predicted_amsl_m);
    let from = GlideStart { position, altitude_amsl_m, course_deg: path.course_deg };
    if Arrival::at_landing(world, wind, from, gate.position, runway).0 {
        return losing_height(gate, path, runway, (wind, world));
    }
    let mps = path.last.airspeed_mps.max(1.0);
    let left_s = distance_m(position, runway.threshold) / mps;
    let is_too_high = altitude_amsl_m - world.profile.max_descent_mps * left_s > runway.elevation_amsl_m;
    if !is_too_high || !is_on_final(position, gate.position, runway) {
        return Vec::new();
    }
    let needed_m = RESERVE_M + glide_sink_mps(world.profile, mps, 1.0) * left_s;
    let level = Level { metres: runway.elevation_amsl_m + needed_m, reference: AltitudeReference::Amsl };
    let here = Point { level: Some(level), ..Point::fly(position) };
    // it is there
    losing_height(here, path, runway, (wind, world)).split_off(1)
}

/// With the engine out: to where the final approach begins, and around there as often as it takes to lose what is too much of the height.
/// As many circles as the steepest descent needs, and no more than a glide has height for.
fn losing_height(
    gate: Point,
    path: &PathState,
    runway: &Runway,
    (wind, world): (Wind, &World),
) -> Vec<Point> {
    let (profile, mps) = (world.profile, path.last.airspeed_mps.max(1.0));
    let circle = Circle::of(profile, wind);
    let way_s = distance_m(path.last.position, gate.position) / mps;
    let wanted_m = gate.level.map_or(runway.elevation_amsl_m, |level| level.metres);
    let (steep_mps, glide_mps) = (profile.max_descent_mps, glide_sink_mps(profile, mps, 1.0));
    let too_much_m = path.predicted_amsl_m - steep_mps * way_s - wanted_m;
    let there_is_m = path.predicted_amsl_m - glide_mps * way_s - wanted_m;
    let needed = (too_much_m / (steep_mps * circle.time_s)).ceil().max(0.0);
    let circles = needed.min(f64::from(circle.most(there_is_m)));
    let mut points = vec![gate];
    if circles > 0.0 {
        let side = if normalise_180(runway.heading_deg - path.course_deg) < 0.0 { -1.0 } else { 1.0 };
        let radius_m = circle.radius_m;
        let centre = gate.position.destination(runway.heading_deg + side * 90.0, radius_m);
        let start_bearing_deg = normalise_360(runway.heading_deg - side * 90.0);
        let around =
            PathElement::Arc { centre, radius_m, start_bearing_deg, sweep_deg: side * 360.0 * circles };
        let on_the_way_down = |point| Point { level: gate.level, ..point };
        points.extend(vertices(&[around], world.config.arc_tolerance_m).into_iter().map(on_the_way_down));
    }
    points
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
