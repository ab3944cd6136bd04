//! From a leg of the plan to its points, forwards or in reverse.

use super::pattern::Flight;
use super::scan::Sweeps;
use super::trail::Visit;
use super::until_altitude::Track;
use super::{ExpandError, Expansion, Point, arc, course, holding, orbit};
use crate::api::FARTHEST_M;
use crate::layout::path::{Level, PathEnd, PathState};
use crate::layout::world::World;
use flight_plan::{Holding, HoldingLength, Leg, LegKind, PlanWaypoint, TurnDirection};
use geometry::LatLon;
use geometry::holding::Racetrack as Shape;
use geometry::turn::Turn;

/// Nearer than this two positions are the same place, metres.
pub const SAME_PLACE_M: f64 = 1.0;

/// What a leg needs to know about its place in the path.
#[derive(Debug, Clone, Copy)]
pub struct Approach<'a> {
    /// Where the path is.
    pub path: &'a PathState,
    /// Altitude of the leg.
    pub level: Level,
    /// Airspeed on the leg, m/s.
    pub airspeed_mps: f64,
    /// Its passage forwards, when it is flown in reverse now.
    pub reversed: Option<&'a Visit>,
    /// Where the path goes afterwards, if known (orbits).
    pub continuation: Option<LatLon>,
}

/// The points of a leg.
///
/// # Errors
/// A value that can't be computed, or an impossible geometry.
pub fn expand(leg: &Leg, approach: &Approach, world: &World) -> Result<Expansion, ExpandError> {
    match approach.reversed {
        Some(visit) => backward(leg, visit, approach, world),
        None => forward(leg, approach, world),
    }
}

fn forward(leg: &Leg, approach: &Approach, world: &World) -> Result<Expansion, ExpandError> {
    let from = approach.path.last.position;
    Ok(match &leg.kind {
        LegKind::If(to) => {
            let to = waypoint(to, world)?;
            // the path starts here; an aircraft that is elsewhere has to come here first
            let there = crate::layout::path::distance_m(from, to.position) < SAME_PLACE_M;
            Expansion::Points(if there { Vec::new() } else { vec![to] })
        }
        LegKind::Tf(to) => Expansion::Points(vec![waypoint(to, world)?]),
        LegKind::Df { to, turn } => {
            Expansion::Points(course::direct(waypoint(to, world)?, *turn, approach, world))
        }
        LegKind::Rf { to, centre, turn } => {
            let to = waypoint(to, world)?;
            let tolerance_m = world.config.arc_tolerance_m;
            Expansion::Points(arc::radius_to_fix(from, to, *centre, *turn, tolerance_m))
        }
        LegKind::Hf(holding) => racetrack(holding, 0.0, true, approach, world)?,
        LegKind::Ha(holding) | LegKind::Hm { holding, .. } => {
            racetrack(holding, 0.0, false, approach, world)?
        }
        LegKind::Scan(scan) => Expansion::Scan(Box::new(Sweeps::new(scan, approach, world)?)),
        LegKind::Orbit { centre, radius_m, turns, turn } => {
            let values = (world.place(centre)?, world.number(radius_m)?, world.number(turns)?, *turn);
            let tolerance_m = world.config.arc_tolerance_m;
            Expansion::Orbit(orbit::Circle::new(values, from, approach.continuation, tolerance_m)?)
        }
        LegKind::Cf { to, course_deg } => {
            let (to, inbound_deg) = (waypoint(to, world)?, world.number(course_deg)?);
            Expansion::Points(course::to_fix(to, inbound_deg, approach, world)?)
        }
        LegKind::Fa { from: fix, course_deg } => {
            let (fix, course_deg) = (waypoint(fix, world)?, world.number(course_deg)?);
            let to_fix = crate::layout::path::distance_m(from, fix.position) > SAME_PLACE_M;
            Expansion::UntilAltitude(Track::new(fix, to_fix, course_deg, approach.airspeed_mps))
        }
        LegKind::Pattern(pattern) => Expansion::Pattern(Box::new(Flight::new(pattern, approach, world)?)),
        // control legs fly nothing themselves; a call has become its legs when the plan was compiled
        LegKind::Iterative { .. } | LegKind::Intersection { .. } | LegKind::Call(_) => {
            Expansion::Points(Vec::new())
        }
    })
}

fn backward(leg: &Leg, visit: &Visit, approach: &Approach, world: &World) -> Result<Expansion, ExpandError> {
    let start = visit.start;
    let back = passed(&start);
    // the way back starts where the way out ended, wherever a loop in between has led
    let end = Point { fly_over: false, ..passed(&visit.end) };
    let elsewhere = crate::layout::path::distance_m(end.position, approach.path.last.position) > SAME_PLACE_M;
    let connection = elsewhere.then_some(end);
    Ok(match &leg.kind {
        LegKind::If(_) | LegKind::Iterative { .. } | LegKind::Intersection { .. } | LegKind::Call(_) => {
            Expansion::Points(Vec::new())
        }
        // how the course was joined belongs to the way out
        LegKind::Tf(_) | LegKind::Df { .. } | LegKind::Cf { .. } => {
            Expansion::Points(connection.into_iter().chain([back]).collect())
        }
        // from where the altitude was reached along the track to its fix, and back to where it was come from
        LegKind::Fa { from: fix, .. } => {
            let fix = waypoint(fix, world)?;
            let apart = |from: LatLon| crate::layout::path::distance_m(fix.position, from) > SAME_PLACE_M;
            let passed = apart(end.position) && apart(back.position);
            Expansion::Points(connection.into_iter().chain(passed.then_some(fix)).chain([back]).collect())
        }
        LegKind::Rf { centre, turn, .. } => {
            let tolerance_m = world.config.arc_tolerance_m;
            let arc = arc::radius_to_fix(end.position, back, *centre, opposite(*turn), tolerance_m);
            Expansion::Points(connection.into_iter().chain(arc).collect())
        }
        LegKind::Hf(holding) => racetrack(holding, 180.0, true, approach, world)?,
        LegKind::Ha(holding) | LegKind::Hm { holding, .. } => {
            racetrack(holding, 180.0, false, approach, world)?
        }
        LegKind::Scan(_) | LegKind::Orbit { .. } | LegKind::Pattern(_) => {
            let reversed = visit.flown.as_ref().map(|flown| flown.reversed(back, connection.is_some()));
            reversed.unwrap_or_else(|| Expansion::Points(vec![back]))
        }
    })
}

/// A point of the way out, as it was passed there.
pub fn passed(passing: &PathEnd) -> Point {
    Point {
        fly_over: passing.fly_over,
        level: Some(passing.level),
        airspeed_mps: Some(passing.airspeed_mps),
        ..Point::fly(passing.position)
    }
}

fn racetrack(
    holding: &Holding,
    turned_deg: f64,
    once: bool,
    approach: &Approach,
    world: &World,
) -> Result<Expansion, ExpandError> {
    let fix = waypoint(&holding.fix, world)?;
    let (from, course_deg) = (approach.path.last.position, approach.path.course_deg);
    let there = crate::layout::path::distance_m(from, fix.position) < SAME_PLACE_M;
    let arrival_deg = if there { course_deg } else { from.inverse(fix.position).bearing_end_deg };
    let inbound_deg = match &holding.inbound_course_deg {
        Some(course) => world.number(course)? + turned_deg,
        // "as the aircraft arrives" is that at either end
        None => arrival_deg,
    };
    let leg_m = match &holding.leg {
        HoldingLength::Distance(metres) => world.number(metres)?,
        HoldingLength::Time(seconds) => world.number(seconds)? * approach.airspeed_mps,
    };
    let radius_m = world.turn_radius_m(approach.airspeed_mps);
    let shape = Shape {
        fix: fix.position,
        inbound_course_deg: inbound_deg,
        turn: side(holding.turn),
        // an entry's straight line may be two radii longer, and the corners around its turns stand out by up to one each
        leg_m: leg_m.min(FARTHEST_M - 4.0 * radius_m).max(0.0),
        radius_m,
    };
    let tolerance_m = world.config.arc_tolerance_m;
    Ok(Expansion::Holding(holding::Racetrack::new(
        &shape,
        (!there).then_some(fix),
        arrival_deg,
        once,
        tolerance_m,
    )))
}

/// The full turn at the end of a pass of a form-A loop.
pub fn turn_round(path: &PathState, turn: TurnDirection, airspeed_mps: f64, world: &World) -> Expansion {
    let radius_m = world.turn_radius_m(airspeed_mps);
    let round = geometry::holding::turn_round(path.last.position, path.course_deg, side(turn), radius_m);
    Expansion::Points(arc::vertices(&round, world.config.arc_tolerance_m))
}

/// The plan's word for a side in geometry's.
pub fn side(turn: TurnDirection) -> Turn {
    match turn {
        TurnDirection::Left => Turn::Left,
        TurnDirection::Right => Turn::Right,
    }
}

fn waypoint(waypoint: &PlanWaypoint, world: &World) -> Result<Point, ExpandError> {
    let position = world.place(&waypoint.place)?;
    Ok(Point { fly_over: waypoint.fly_over, ..Point::fly(position) })
}

fn opposite(turn: TurnDirection) -> TurnDirection {
    match turn {
        TurnDirection::Left => TurnDirection::Right,
        TurnDirection::Right => TurnDirection::Left,
    }
}
