//! Runways for missions, which only know points: one that is known to be there, or one that is made up.

use crate::names::Names;
use crate::note::Notes;
use crate::synthetic::{Assumptions, KnownRunway, runway};
use flight_plan::{Id, Runway};
use geometry::LatLon;
use geometry::geodesy::{normalise_180, normalise_360};

/// Two points nearer than this are one place, metres: one runway, which they give no direction; no track leads from one to the other.
pub const SAME_M: f64 = 1.0;
/// Directions nearer than this are the same, degrees.
const SAME_DEG: f64 = 1.0;
/// A point so near to the middle of a runway is on it, metres: half the width of a wide one, and the error of the data.
const ON_RUNWAY_M: f64 = 60.0;
/// A runway is used in the direction that is within so much of the one flown, degrees.
const ALIGNED_DEG: f64 = 45.0;
/// So much of a runway has to be left, metres.
const LEFT_M: f64 = 100.0;

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
        let known = match direction.is_said() {
            true => None,
            false => on_known((self.assumptions.known_runways)(point.0), point.0, told_deg),
        };
        let told_deg = known.as_ref().map(|on| on.heading_deg).or(told_deg);
        let heading_deg = told_deg.unwrap_or(0.0);
        let off_deg = |r: &Runway| told_deg.map_or(0.0, |deg| normalise_180(r.heading_deg - deg).abs());
        // another direction makes another runway: the mission would land there in that direction
        let is_same = |r: &&Runway| r.threshold.distance_m(point.0) < SAME_M && off_deg(r) < SAME_DEG;
        if let Some(same) = self.list.iter().find(is_same) {
            if (same.elevation_amsl_m - point.1).abs() > SAME_M {
                let message = format!(
                    "the altitude of this landing, {:.0} m AMSL, is left out: runway `{}` is at {:.0} m AMSL",
                    point.1, same.id, same.elevation_amsl_m
                );
                notes.push("runway-elevation", place, message);
            }
            return same.id.clone();
        }
        let id = names.take(preferred, "runway");
        self.list.push(match known {
            Some(on) => on.runway(id.clone(), point, place, notes),
            None => {
                let length_m = self.assumptions.runway_length_m;
                runway(id.clone(), point.0, point.1, heading_deg, length_m, place, notes)
            }
        });
        id
    }

    /// All of them.
    pub fn into_vec(self) -> Vec<Runway> {
        self.list
    }
}

/// A point on a runway that is there.
struct OnKnown {
    name: String,
    heading_deg: f64,
    /// From the point to the runway's end, metres.
    left_m: f64,
}

impl OnKnown {
    fn of(known: KnownRunway, at: LatLon) -> Option<Self> {
        let heading_deg = known.threshold.bearing_deg(known.end);
        let (length_m, out_m) = (known.threshold.distance_m(known.end), known.threshold.distance_m(at));
        let off_rad = (known.threshold.bearing_deg(at) - heading_deg).to_radians();
        let (along_m, across_m) = (out_m * off_rad.cos(), out_m * off_rad.sin());
        let left_m = length_m - along_m;
        let is_on = across_m.abs() < ON_RUNWAY_M && along_m > -ON_RUNWAY_M && left_m > LEFT_M;
        is_on.then_some(Self { name: known.name, heading_deg, left_m })
    }

    /// What of it lies ahead of the point.
    fn runway(
        self,
        id: Id,
        (threshold, elevation_amsl_m): (LatLon, f64),
        place: &str,
        notes: &mut Notes,
    ) -> Runway {
        let Self { name, heading_deg, left_m } = self;
        let message = format!(
            "runway `{id}` is taken to be {name}: {left_m:.0} m long, heading {heading_deg:.0}°, elevation \
             {elevation_amsl_m:.0} m; correct it if another one is meant"
        );
        notes.push("runway-known", place, message);
        let (length_m, priority, approach_entry) = (left_m, 1, None);
        Runway { id, threshold, elevation_amsl_m, heading_deg, length_m, priority, approach_entry }
    }
}

/// The known runway at a point: in the direction that is flown, or else in the one in which most of it is left.
fn on_known(known: Vec<KnownRunway>, at: LatLon, told_deg: Option<f64>) -> Option<OnKnown> {
    let aligned =
        |on: &OnKnown| told_deg.is_none_or(|deg| normalise_180(on.heading_deg - deg).abs() < ALIGNED_DEG);
    let on = known.into_iter().filter_map(|known| OnKnown::of(known, at)).filter(aligned);
    on.max_by(|a, b| a.left_m.total_cmp(&b.left_m))
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
