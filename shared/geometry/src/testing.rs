//! What several tests need.

use crate::path::course_change_deg;
use crate::{LatLon, PathElement};

pub const HERE: LatLon = LatLon::new(36.55, -84.25);

/// Each element begins where the one before ends, in its direction, and no arc is tighter.
pub fn assert_smooth(path: &[PathElement], least_radius_m: f64) {
    assert!(!path.is_empty());
    for pair in path.windows(2) {
        let gap_m = pair[0].end().distance_m(pair[1].start());
        assert!(gap_m < 1e-3, "gap of {gap_m} m: {pair:?}");
        let kink = course_change_deg(pair[0].end_course_deg(), pair[1].start_course_deg());
        // a millimetre over short pieces
        let shortest_m = pair[0].length_m().min(pair[1].length_m());
        assert!(kink.abs() < 0.01 + 0.06 / shortest_m, "kink of {kink}°: {pair:?}");
    }
    for element in path {
        if let PathElement::Arc { radius_m, .. } = element {
            assert!(*radius_m >= least_radius_m - 1e-6, "{element:?}");
        }
    }
}

/// Begins and ends at positions with courses.
pub fn assert_joins(path: &[PathElement], from: (LatLon, f64), to: (LatLon, f64)) {
    let (first, last) = (path.first().unwrap(), path.last().unwrap());
    assert!(first.start().distance_m(from.0) < 1e-3);
    assert!(course_change_deg(first.start_course_deg(), from.1).abs() < 0.01, "{path:?}");
    assert!(last.end().distance_m(to.0) < 1e-3);
    assert!(course_change_deg(last.end_course_deg(), to.1).abs() < 0.01, "{path:?}");
}

pub fn length_m(path: &[PathElement]) -> f64 {
    path.iter().map(PathElement::length_m).sum()
}
