//! Take-off and landing of a path that was written by us: its first and its last point.

use super::{BEGINS, ENDS, Feature, Vertex};
use crate::names::Names;
use crate::synthetic;
use flight_plan::{Runway, Stage, StageKind};

/// A path takes off from a runway that begins at most so far before its first point, metres.
const TAKE_OFF_M: f64 = 3000.0;
/// A path lands on a runway whose threshold is at most so far from its last point, metres.
const LAND_M: f64 = 100.0;

/// The first point of this path is where a take-off climbs to: it says so itself (GPX), or the path does (KML, GeoJSON).
pub fn begins(path: &Feature, first: &Vertex) -> bool {
    first.kind == "take-off" || path.mark(BEGINS) == Some("take-off")
}

/// The last point of this path is the touch-down point.
pub fn ends(path: &Feature, last: &Vertex) -> bool {
    last.kind == "land" || path.mark(ENDS) == Some("land")
}

/// The stage for one of the ends; `None` if no runway is near. A runway whose direction is unknown gets it from here.
pub fn stage(kind: StageKind, at: &Vertex, runways: &mut [Runway], names: &mut Names) -> Option<Stage> {
    let most_m = if kind == StageKind::TakeOff { TAKE_OFF_M } else { LAND_M };
    let distance_m = |r: &Runway| r.threshold.distance_m(at.position);
    let distances = runways.iter_mut().map(|r| (distance_m(r), r));
    let near = distances.min_by(|(a_m, _), (b_m, _)| a_m.total_cmp(b_m));
    let (_, runway) = near.filter(|(metres, _)| *metres <= most_m)?;
    if kind == StageKind::TakeOff && runway.heading_deg.is_nan() {
        let heading_deg = runway.threshold.bearing_deg(at.position);
        // no position in a file gives it better
        runway.heading_deg = (heading_deg * 100.0).round() / 100.0 % 360.0;
    }
    let (preferred, name) =
        if kind == StageKind::TakeOff { ("take-off", "Take-off") } else { ("land", "Landing") };
    let mut stage = synthetic::stage(names.take(preferred, preferred), name, kind);
    stage.runway = Some(runway.id.clone());
    stage.altitude = at.altitude.clone().filter(|_| kind == StageKind::TakeOff);
    Some(stage)
}
