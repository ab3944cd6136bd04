//! The creeping line: a scan along the short side.

use crate::Polygon;
use crate::geodesy::normalise_360;

/// Heading of a creeping line's tracks, degrees true in 0..360: at right angles to those of the parallel track search, whose
/// heading is the one with the fewest tracks. `progress_deg`: the direction in which the pattern creeps, if it is given.
pub fn creeping_heading_deg(area: &Polygon, progress_deg: Option<f64>) -> f64 {
    let along_long_side_deg = progress_deg.unwrap_or_else(|| area.fewest_tracks_heading_deg());
    normalise_360(along_long_side_deg + 90.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec2;

    #[test]
    fn tracks_lie_along_the_short_side() {
        let corners = [(0.0, 0.0), (3000.0, 0.0), (3000.0, 500.0), (0.0, 500.0)];
        let area = Polygon::new(corners.map(|(e, n)| Vec2::new(e, n)).to_vec(), vec![]).unwrap();
        assert_eq!(area.fewest_tracks_heading_deg(), 90.0);
        assert_eq!(creeping_heading_deg(&area, None), 180.0);
        assert_eq!(creeping_heading_deg(&area, Some(300.0)), 30.0);
    }
}
