//! Criss-cross: two scans of one area at right angles.

use super::{PatternError, Vertex};
use crate::polygon::Polygon;
use crate::scan::{Entry, Scan, ScanParameters};

/// Two scans; the second is entered at the corner nearest to the end of the first.
#[derive(Debug, Clone)]
pub struct CrissCross {
    first: Scan,
    second: Scan,
}

impl CrissCross {
    /// The first scan as described; the second, turned by 90° to the right, with the same spacing, overshoot and radius.
    ///
    /// # Errors
    /// A parameter that makes no sense.
    pub fn new(area: &Polygon, p: &ScanParameters) -> Result<Self, PatternError> {
        let first = Scan::new(area, p)?;
        let end = scan_count(&first).checked_sub(1).and_then(|last| scan_vertex(&first, last));
        let across = ScanParameters {
            heading_deg: Some(first.heading_deg() + 90.0),
            grid: None,
            entry: end.map_or(p.entry, |v| Entry::Nearest(v.at)),
            ..*p
        };
        Ok(Self { first, second: Scan::new(area, &across)? })
    }

    /// The scan that is flown first.
    pub fn first(&self) -> &Scan {
        &self.first
    }

    /// The scan that is flown second.
    pub fn second(&self) -> &Scan {
        &self.second
    }

    /// See [`super::Pattern::count`].
    pub fn count(&self) -> u64 {
        scan_count(&self.first).saturating_add(scan_count(&self.second))
    }

    /// See [`super::Pattern::vertex`].
    pub fn vertex(&self, index: u64) -> Option<Vertex> {
        match index.checked_sub(scan_count(&self.first)) {
            None => scan_vertex(&self.first, index),
            Some(later) => {
                let vertex = scan_vertex(&self.second, later)?;
                Some(Vertex { track: vertex.track + self.first.tracks(), ..vertex })
            }
        }
    }
}

/// Two waypoints a track.
pub(super) fn scan_count(scan: &Scan) -> u64 {
    scan.tracks().saturating_mul(2)
}

/// The outermost ends of tracks, gaps included.
pub(super) fn scan_vertex(scan: &Scan, index: u64) -> Option<Vertex> {
    let (from, to) = scan.ends_of_track(index / 2)?;
    let on_track = !index.is_multiple_of(2);
    Some(Vertex { at: if on_track { to } else { from }, track: index / 2, on_track })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec2;
    use crate::scan::Corner;

    #[test]
    fn the_second_scan_begins_where_the_first_ends() {
        let corners = [(0.0, 0.0), (900.0, 0.0), (900.0, 600.0), (0.0, 600.0)];
        let area = Polygon::new(corners.map(|(e, n)| Vec2::new(e, n)).to_vec(), vec![]).unwrap();
        for entry in [Corner::StartLeft, Corner::StartRight, Corner::EndLeft, Corner::EndRight] {
            let p = ScanParameters {
                spacing_m: 100.0,
                grid: None,
                heading_deg: None,
                overshoot_m: 0.0,
                entry: Entry::Corner(entry),
                turn_radius_m: 0.0,
            };
            let both = CrissCross::new(&area, &p).unwrap();
            assert_eq!(both.count(), 2 * (6 + 9));
            let turn = both.second().heading_deg() - both.first().heading_deg();
            assert_eq!(turn, 90.0);
            let (end, begin) = (both.vertex(11).unwrap(), both.vertex(12).unwrap());
            // from half a spacing inside one edge to half a spacing inside the next
            assert!((end.at - begin.at).length() < 100.0, "{end:?} {begin:?}");
            assert_eq!((end.track, begin.track, begin.on_track), (5, 6, false));
            assert_eq!(both.vertex(30), None);
        }
    }
}
