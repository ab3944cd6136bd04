//! The handles of a runway: its ends.

use super::{Handle, Handled};
use flight_plan::{Runway, figures};
use geometry::LatLon;
use geometry::geodesy::normalise_360;

/// Shorter than this it has no direction, metres.
const SHORTEST_M: f64 = 1.0;

/// An end of a runway.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunwayEnd {
    /// Its landing threshold.
    Threshold,
    /// Where it ends.
    Far,
}

impl RunwayEnd {
    /// Its name.
    pub fn name(self, runway: &str) -> String {
        match self {
            Self::Threshold => format!("Threshold of {runway}"),
            Self::Far => format!("End of {runway}"),
        }
    }

    /// A runway with this end elsewhere; the other one stays. `None`: it would have no direction.
    pub fn dragged(self, runway: &Runway, to: LatLon) -> Option<Runway> {
        let (threshold, end) = match self {
            Self::Threshold => (figures::place(to), runway.from_other_end().threshold),
            Self::Far => (runway.threshold, to),
        };
        let way = threshold.inverse(end);
        let (heading_deg, length_m) =
            (figures::direction_deg(normalise_360(way.bearing_start_deg)), way.distance_m.round());
        (length_m >= SHORTEST_M).then(|| Runway { threshold, heading_deg, length_m, ..runway.clone() })
    }
}

/// Those of every runway that has a place and a direction.
pub(super) fn handles(runways: &[Runway]) -> impl Iterator<Item = Handle> {
    let placed = runways
        .iter()
        .filter(|r| r.threshold.is_valid() && r.heading_deg.is_finite() && r.length_m.is_finite());
    placed.flat_map(|runway| {
        let end = runway.from_other_end().threshold;
        [(RunwayEnd::Threshold, runway.threshold), (RunwayEnd::Far, end)]
            .map(|(what, at)| Handle { what: Handled::Runway(runway.id.clone(), what), at })
    })
}
