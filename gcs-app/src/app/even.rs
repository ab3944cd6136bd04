//! Whether the ground is even enough for a runway that was drawn.

use crate::units::Units;
use geometry::LatLon;
use terrain::Terrain;

/// Steeper than this hardly any runway is: metres a metre.
const STEEP: f64 = 0.05;
/// Ground that is farther from the line between its ends is no runway, metres: elevations are off by some.
const OFF_M: f64 = 10.0;
/// Parts between places that are looked at.
const PARTS: u32 = 10;

/// `The ground here is no runway: it rises by 117 m over 872 m, 13 %`; `None`: it may be one, or it is not known.
pub(super) fn objection(ground: &dyn Terrain, from: LatLon, to: LatLon, units: Units) -> Option<String> {
    let (line, height) = (from.inverse(to), units.altitude());
    let [begins_m, ends_m] = [ground.elevation_m(from)?, ground.elevation_m(to)?];
    let rise_m = (ends_m - begins_m).abs();
    let share = rise_m / line.distance_m.max(1.0);
    if share > STEEP {
        let (rise, length) = (height.show(rise_m), units.length().show(line.distance_m));
        return Some(format!(
            "The ground here is no runway: it rises by {rise} over {length}, {:.0} %.",
            share * 100.0
        ));
    }
    let off_m = |part: u32| {
        let share = f64::from(part) / f64::from(PARTS);
        let at = from.destination(line.bearing_start_deg, line.distance_m * share);
        Some(ground.elevation_m(at)? - (begins_m + (ends_m - begins_m) * share))
    };
    let off_m = (1..PARTS).filter_map(off_m).max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let side = if off_m < 0.0 { "below" } else { "above" };
    (off_m.abs() > OFF_M).then(|| {
        format!(
            "The ground here is no runway: it lies up to {} {side} the line between its ends.",
            height.show(off_m.abs())
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const WEST: LatLon = LatLon::new(46.0, 9.0);

    /// So high so far east of there.
    struct Ground(fn(f64) -> Option<f64>);

    impl Terrain for Ground {
        fn elevation_m(&self, at: LatLon) -> Option<f64> {
            self.0(WEST.distance_m(at))
        }
    }

    #[test]
    fn a_slope_and_a_hollow_are_no_runway_and_unknown_ground_may_be_one() {
        let said = |ground| objection(&Ground(ground), WEST, WEST.destination(90.0, 600.0), Units::Si);
        assert_eq!(
            said(|m| Some(300.0 + 0.13 * m)).as_deref(),
            Some("The ground here is no runway: it rises by 78 m over 600 m, 13 %.")
        );
        assert_eq!(
            said(|m| Some(400.0 - if (200.0..400.0).contains(&m) { 60.0 } else { 0.0 })).as_deref(),
            Some("The ground here is no runway: it lies up to 60 m below the line between its ends.")
        );
        assert_eq!(
            said(|m| Some(400.0 + 8.0 * (m / 100.0).sin() - 0.02 * m)),
            None,
            "no field is as even as a table"
        );
        assert_eq!(said(|m| (m < 500.0).then_some(400.0)), None);
    }
}
