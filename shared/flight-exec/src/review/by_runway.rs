//! `ground-by-runway`: the way in to a runway, or out of it, goes into the ground. The autopilot flies both by the runway's elevation
//! alone.

use super::View;
use super::flown::{Flown, Point};
use flight_plan::{Id, Problem, Runway, StageKind};
use std::collections::HashMap;

/// So near to a runway the elevations are coarser than it is level, metres.
const BESIDE_M: f64 = 150.0;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let mut deepest: HashMap<&Id, Ground> = HashMap::new();
    let mut order = Vec::new();
    for flown in view.flights.all() {
        for (leg, ground) in flown.points.iter().filter_map(|point| Ground::under(view, flown, point)) {
            match deepest.get_mut(leg) {
                Some(old) if old.depth_m >= ground.depth_m => {}
                Some(old) => *old = ground,
                None => {
                    order.push(leg);
                    deepest.insert(leg, ground);
                }
            }
        }
    }
    problems.extend(order.into_iter().filter_map(|leg| Some(deepest.get(leg)?.problem(leg))));
}

/// Ground that is higher than the way over it.
struct Ground<'a> {
    kind: StageKind,
    runway: &'a Runway,
    point: Point,
    depth_m: f64,
    /// Before the threshold of a landing, behind the end of a take-off.
    away_m: f64,
}

impl<'a> Ground<'a> {
    fn under(view: &'a View, flown: &'a Flown, point: &Point) -> Option<(&'a Id, Self)> {
        let leg = flown.leg(point)?;
        let stage = view.program.stage(&view.program.path(leg)?)?;
        let kind = stage.kind;
        let runway = view.program.plan.runway(stage.runway.as_ref()?)?;
        let depth_m = view.terrain.elevation_m(point.position)? - point.altitude_amsl_m;
        let from_threshold_m = runway.threshold.distance_m(point.position);
        let away_m = match kind {
            StageKind::Land => from_threshold_m,
            StageKind::TakeOff => from_threshold_m - runway.length_m,
            _ => return None,
        };
        let is_in_ground = away_m > BESIDE_M && depth_m > 0.0;
        is_in_ground.then_some((leg, Self { kind, runway, point: *point, depth_m, away_m }))
    }

    fn problem(&self, leg: &Id) -> Problem {
        let Self { runway, point, depth_m, away_m, .. } = self;
        let (direction, way, end) = match self.kind {
            StageKind::Land => ("land in the other direction", "the way in", "before its threshold"),
            _ => ("take off in the other direction", "the climb", "behind its end"),
        };
        let message = format!(
            "{direction}, or correct the elevation of runway `{}` ({:.0} m): {way} goes {:.0} m into the ground {away_m:.0} m {end}, at {:.5}, {:.5}, if the elevations that are loaded are right",
            runway.id,
            runway.elevation_amsl_m,
            depth_m.ceil(),
            point.position.lat_deg,
            point.position.lon_deg
        );
        Problem::warning("ground-by-runway", message).of(leg).with_place(point.position)
    }
}
