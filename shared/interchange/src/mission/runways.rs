//! Runways for missions, which only know points.

use crate::names::Names;
use crate::note::Notes;
use crate::synthetic::{Assumptions, runway};
use flight_plan::{Id, Runway};
use geometry::LatLon;
use geometry::geodesy::{normalise_180, normalise_360};

/// Two points nearer than this are one place, metres: one runway, which they give no direction; no track leads from one to the other.
pub const SAME_M: f64 = 1.0;
/// Directions nearer than this are the same, degrees.
const SAME_DEG: f64 = 1.0;

/// Makes runways up, or takes the one that was given.
pub struct Runways<'a> {
    assumptions: &'a Assumptions,
    list: Vec<Runway>,
}

impl<'a> Runways<'a> {
    /// None yet, but the one that was given.
    pub fn new(assumptions: &'a Assumptions, names: &mut Names) -> Self {
        let list: Vec<Runway> = assumptions.runway.iter().cloned().collect();
        list.iter().for_each(|r| {
            names.take(r.id.as_str(), "runway");
        });
        Self { assumptions, list }
    }

    /// A runway at a point, in the direction towards `to` (or `heading_deg`, if the mission gives one).
    pub fn at(
        &mut self,
        preferred: &str,
        point: (LatLon, f64),
        direction: Direction,
        place: &str,
        (names, notes): (&mut Names, &mut Notes),
    ) -> Id {
        if let Some(given) = &self.assumptions.runway {
            return given.id.clone();
        }
        let told_deg = direction.heading_deg(point.0);
        let heading_deg = told_deg.unwrap_or(0.0);
        let off_deg = |r: &Runway| told_deg.map_or(0.0, |deg| normalise_180(r.heading_deg - deg).abs());
        // another direction makes another runway: the mission would land there in that direction
        let is_same = |r: &&Runway| r.threshold.distance_m(point.0) < SAME_M && off_deg(r) < SAME_DEG;
        if let Some(same) = self.list.iter().find(is_same) {
            if (same.elevation_amsl_m - point.1).abs() > SAME_M {
                let message = format!(
                    "the altitude of this landing, {:.0} m AMSL, is left out: runway `{}` is {:.0} m high",
                    point.1, same.id, same.elevation_amsl_m
                );
                notes.push("runway-elevation", place, message);
            }
            return same.id.clone();
        }
        let length_m = self.assumptions.runway_length_m;
        let made =
            runway(names.take(preferred, "runway"), point.0, point.1, heading_deg, length_m, place, notes);
        let id = made.id.clone();
        self.list.push(made);
        id
    }

    /// All of them.
    pub fn into_vec(self) -> Vec<Runway> {
        self.list
    }
}

/// How the direction of a runway is found.
#[derive(Debug, Clone, Copy)]
pub struct Direction {
    /// Degrees true, if the mission says so; 0 and NaN say nothing.
    pub heading_deg: f64,
    /// A point ahead of the runway.
    pub towards: Option<LatLon>,
    /// A point that it is approached from.
    pub from: Option<LatLon>,
}

impl Direction {
    /// The mission gives it.
    fn is_said(self) -> bool {
        self.heading_deg.is_finite() && self.heading_deg != 0.0
    }

    /// `None`: nothing tells it.
    fn heading_deg(self, at: LatLon) -> Option<f64> {
        if self.is_said() {
            return Some(normalise_360(self.heading_deg % 360.0));
        }
        let far = |p: &LatLon| p.distance_m(at) > SAME_M;
        match (self.towards.filter(far), self.from.filter(far)) {
            (Some(to), _) => Some(at.bearing_deg(to)),
            (None, Some(from)) => Some(from.inverse(at).bearing_end_deg),
            (None, None) => None,
        }
    }
}
