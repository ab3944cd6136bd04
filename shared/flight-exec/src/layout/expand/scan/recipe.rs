//! What a sweep is made from: the area and the values of its leg as they were.

use super::super::ExpandError;
use super::super::area::{Outline, geometric};
use super::super::spacing::spacing_m;
use super::super::track::Approach;
use super::layout::LaidOut;
use crate::layout::world::World;
use flight_plan::{Scan, ScanEntry, ScanOrder, ScanStyle};
use geometry::LatLon;
use geometry::pattern::creeping_heading_deg;
use geometry::scan::{CellScan as Pattern, Corner, Entry, ScanParameters};
use serde::{Deserialize, Serialize};

/// Numbers and positions only.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    area: Outline,
    /// As the plan gives it: tracks are no farther apart.
    pub spacing_m: f64,
    /// Where the strips of its tracks lie, and how wide they are, when it takes the place of another sweep.
    pub grid: Option<(LatLon, f64)>,
    /// As the plan gives it; `None`: left to the pattern.
    pub heading_deg: Option<f64>,
    /// Tracks lie across the heading.
    across: bool,
    entry: ScanEntry,
    overshoot_m: f64,
    /// Stays what it was when the scan was begun: a gust must not move the tracks.
    pub turn_radius_m: f64,
    /// Each track is flown after its neighbour, too near or not.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    side_by_side: bool,
}

impl Recipe {
    /// The first sweep of a scan, or the second one of a criss-cross.
    ///
    /// # Errors
    /// Values that can't be computed.
    pub fn of(scan: &Scan, second: bool, approach: &Approach, world: &World) -> Result<Self, ExpandError> {
        Ok(Self {
            area: Outline::of(&scan.area, world)?,
            spacing_m: spacing_m(&scan.spacing, approach.level, world)?,
            grid: None,
            heading_deg: scan.heading_deg.as_ref().map(|h| world.number(h)).transpose()?,
            across: second || scan.style == ScanStyle::Creeping,
            // the second sweep begins where the first one ends
            entry: if second { ScanEntry::Nearest } else { scan.entry },
            overshoot_m: world.number(&scan.overshoot_m)?,
            turn_radius_m: world.turn_radius_m(approach.airspeed_mps),
            side_by_side: scan.order == ScanOrder::SideBySide,
        })
    }

    /// The tracks, begun near a position if no corner is asked for.
    ///
    /// # Errors
    /// There are none.
    pub fn lay_out(&self, from: LatLon) -> Result<LaidOut, ExpandError> {
        let (frame, polygon) = self.area.polygon()?;
        let heading_deg = if self.across {
            Some(creeping_heading_deg(&polygon, self.heading_deg))
        } else {
            self.heading_deg
        };
        let parameters = ScanParameters {
            spacing_m: self.grid.map_or(self.spacing_m, |(_, metres)| metres),
            grid: self.grid.map(|(place, _)| frame.to_local(place)),
            heading_deg,
            overshoot_m: self.overshoot_m,
            entry: self.corner().map_or(Entry::Nearest(frame.to_local(from)), Entry::Corner),
            turn_radius_m: if self.side_by_side { 0.0 } else { self.turn_radius_m },
        };
        let pattern = Pattern::new(&polygon, &parameters).map_err(geometric)?;
        Ok(LaidOut::new(pattern, frame))
    }

    /// The corner where it begins, as the tracks see it: those of a creeping line lead to the right of its heading.
    fn corner(&self) -> Option<Corner> {
        let [start_left, start_right, end_left, end_right] = if self.across {
            [Corner::StartRight, Corner::EndRight, Corner::StartLeft, Corner::EndLeft]
        } else {
            [Corner::StartLeft, Corner::StartRight, Corner::EndLeft, Corner::EndRight]
        };
        match self.entry {
            ScanEntry::Nearest => None,
            ScanEntry::StartLeft => Some(start_left),
            ScanEntry::StartRight => Some(start_right),
            ScanEntry::EndLeft => Some(end_left),
            ScanEntry::EndRight => Some(end_right),
        }
    }

    /// The heading that gives these tracks, as the plan would give it.
    pub fn heading_of(&self, laid_out: &LaidOut) -> f64 {
        laid_out.heading_deg() - if self.across { 90.0 } else { 0.0 }
    }

    /// The same in everything but the heading.
    pub fn is_but_for_its_heading(&self, other: &Self) -> bool {
        Self { heading_deg: other.heading_deg, ..self.clone() } == *other
    }

    /// How far beyond a track's end its turn begins. Side by side, tracks end where their author has them end.
    pub fn lead_m(&self) -> f64 {
        if self.side_by_side { 0.0 } else { (self.turn_radius_m - self.overshoot_m).max(0.0) }
    }
}
