//! Loops along a polygon's edge, at growing distances inside or outside it.

use super::{PatternError, Stored, Vertex, counted, finite, not_negative, positive};
use crate::polygon::signed_area_m2;
use crate::turn::Turn;
use crate::{Flattening, Polygon, Vec2};
use i_overlay::mesh::float::outline::offset::OutlineOffset;
use i_overlay::mesh::float::style::{LineJoin, OutlineStyle};
use serde::{Deserialize, Serialize};

/// Distances from the edge at which loops may be flown.
const MOST_LEVELS: u64 = 10_000;
/// The library computes in whole numbers: tenths of a millimetre.
const UNITS_PER_M: f64 = 10_000.0;
/// Smaller loops are dust of the computation, square metres.
const LEAST_AREA_M2: f64 = 0.01;

/// Which side of the edge the loops are on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// In the area, round its holes too, until no room is left.
    Inward,
    /// Around the area; its holes do not count.
    Outward,
}

/// What makes contours, besides their area.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ContourParameters {
    /// Distance between neighbouring loops, metres.
    pub spacing_m: f64,
    /// Distance of the first loop from the edge, metres: 0 is the perimeter, half the spacing the first track of a search.
    pub first_m: f64,
    /// Which side of the edge.
    pub side: Side,
    /// At how many distances; inward, fewer where the area ends.
    pub levels: u64,
    /// How loops along the outer edge are flown; those round holes go the other way.
    pub turn: Turn,
    /// Where the aircraft comes from: each loop begins at its corner nearest to the end of the one before.
    pub entry: Vec2,
    /// How far straight lines may cut a loop's rounded corners, metres.
    pub tolerance_m: f64,
}

/// Closed loops; each is a track, ending where it begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Contours {
    stored: Stored,
}

impl Contours {
    /// Lays them out, from the edge on.
    ///
    /// Inward, an area whose middle is farther than half the spacing from its last loop gets one loop more, half a spacing
    /// farther in.
    ///
    /// # Errors
    /// A parameter that makes no sense; more waypoints than can be stored; no room for a loop.
    pub fn new(area: &Polygon, p: &ContourParameters) -> Result<Self, PatternError> {
        positive("spacing", p.spacing_m)?;
        not_negative("distance from the edge", p.first_m)?;
        counted("distances from the edge", p.levels, MOST_LEVELS)?;
        finite("entry", p.entry.length())?;
        positive("tolerance", p.tolerance_m)?;
        let mut stored = Stored::default();
        let mut at = p.entry;
        let mut level = rings(area, p, p.first_m)?;
        for number in 1..=p.levels {
            let offset_m = p.first_m + number as f64 * p.spacing_m;
            let next = if number < p.levels { rings(area, p, offset_m)? } else { Vec::new() };
            let core = if p.side == Side::Inward && number < p.levels {
                without_loops_inside(rings(area, p, offset_m - p.spacing_m / 2.0)?, &next)
            } else {
                Vec::new()
            };
            for rings in [level, core] {
                at = fly(&mut stored, rings, at)?;
            }
            if next.is_empty() {
                break;
            }
            level = next;
        }
        if stored.count() == 0 {
            let width_m = area.width_m(area.narrowest_heading_deg());
            return Err(PatternError::TooNarrow { width_m, spacing_m: 2.0 * p.first_m });
        }
        Ok(Self { stored })
    }

    /// See [`super::Pattern::count`].
    pub fn count(&self) -> u64 {
        self.stored.count()
    }

    /// See [`super::Pattern::vertex`].
    pub fn vertex(&self, index: u64) -> Option<Vertex> {
        self.stored.vertex(index)
    }
}

/// An area in one piece: its outer ring anticlockwise, then its holes, clockwise.
type Shape = Vec<Vec<Vec2>>;

/// The areas whose edges lie a distance from the polygon's edge, turned as they are flown.
fn rings(area: &Polygon, p: &ContourParameters, offset_m: f64) -> Result<Vec<Shape>, PatternError> {
    let mut shapes = match p.side {
        Side::Inward => offset(area, -offset_m, p.tolerance_m)?,
        Side::Outward => offset(&area.without_holes(), offset_m, p.tolerance_m)?,
    };
    if p.turn == Turn::Right {
        shapes.iter_mut().flatten().for_each(|ring| ring.reverse());
    }
    Ok(shapes)
}

/// The polygon grown by a distance (negative: shrunk), metres.
fn offset(area: &Polygon, by_m: f64, tolerance_m: f64) -> Result<Vec<Shape>, PatternError> {
    let ring = |corners: &Vec<Vec2>, anticlockwise: bool| -> Vec<[f64; 2]> {
        let mut ring: Vec<[f64; 2]> = corners.iter().map(|c| [c.e, c.n]).collect();
        if (signed_area_m2(corners) > 0.0) != anticlockwise {
            ring.reverse();
        }
        ring
    };
    let outer = area.outer().to_vec();
    let mut shape = vec![ring(&outer, true)];
    shape.extend(area.holes().iter().map(|hole| ring(hole, false)));
    if by_m == 0.0 {
        return Ok(vec![shape.into_iter().map(from_library).collect()]);
    }
    let step_rad = Flattening::Inscribed.step_rad(by_m.abs(), tolerance_m);
    let style = OutlineStyle::new(by_m).line_join(LineJoin::Round(step_rad));
    let grown = shape.outline_fixed_scale_as::<i64>(&style, UNITS_PER_M).map_err(|_| PatternError::Offset)?;
    let shapes = grown.into_iter().map(|shape| shape.into_iter().map(from_library).collect());
    Ok(shapes.map(without_dust).filter(|shape: &Shape| !shape.is_empty()).collect())
}

fn from_library(ring: Vec<[f64; 2]>) -> Vec<Vec2> {
    ring.into_iter().map(|[e, n]| Vec2::new(e, n)).collect()
}

/// Without rings that are none; nothing if the outer one is none.
fn without_dust(mut shape: Shape) -> Shape {
    let dust = |ring: &Vec<Vec2>| signed_area_m2(ring).abs() < LEAST_AREA_M2;
    if shape.first().is_none_or(dust) {
        return Shape::new();
    }
    shape.retain(|ring| !dust(ring));
    shape
}

/// Those areas that contain none of the others.
fn without_loops_inside(mut areas: Vec<Shape>, others: &[Shape]) -> Vec<Shape> {
    let inside = |area: &Shape, other: &Shape| {
        let corner = other.first().and_then(|ring| ring.first());
        corner.is_some_and(|&c| crate::polygon::contains(area, c))
    };
    areas.retain(|area| !others.iter().any(|other| inside(area, other)));
    areas
}

/// Adds the loops of areas, always the one nearest to where the last ended; gives where that is.
fn fly(stored: &mut Stored, areas: Vec<Shape>, mut at: Vec2) -> Result<Vec2, PatternError> {
    let mut loops: Vec<Vec<Vec2>> = areas.into_iter().flatten().collect();
    while let Some((ring, corner)) = nearest(&loops, at) {
        let mut flown = loops.swap_remove(ring);
        flown.rotate_left(corner);
        at = flown.first().copied().unwrap_or(at);
        flown.push(at);
        stored.push(flown)?;
    }
    Ok(at)
}

/// The ring, and its corner, that is nearest to a point.
fn nearest(rings: &[Vec<Vec2>], point: Vec2) -> Option<(usize, usize)> {
    let places = rings.iter().enumerate().flat_map(|(i, ring)| (0..ring.len()).map(move |j| (i, j)));
    let distance_m = |&(i, j): &(usize, usize)| {
        let corner = rings.get(i).and_then(|ring| ring.get(j));
        corner.map_or(f64::INFINITY, |&c| (c - point).length())
    };
    places.min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::polygon::tests::any_area;
    use proptest::prelude::*;

    fn parameters() -> ContourParameters {
        ContourParameters {
            spacing_m: 100.0,
            first_m: 50.0,
            side: Side::Inward,
            levels: 100,
            turn: Turn::Right,
            entry: Vec2::new(-10.0, -10.0),
            tolerance_m: 1.0,
        }
    }

    fn square(e: f64, n: f64, side: f64) -> Vec<Vec2> {
        [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| Vec2::new(e + x, n + y)).to_vec()
    }

    fn loops(area: &Polygon, p: &ContourParameters) -> Vec<Vec<Vec2>> {
        let contours = Contours::new(area, p).unwrap();
        let vertices: Vec<Vertex> = (0..contours.count()).map(|i| contours.vertex(i).unwrap()).collect();
        vertices.chunk_by(|a, b| a.track == b.track).map(|c| c.iter().map(|v| v.at).collect()).collect()
    }

    #[test]
    fn a_square_shrinks_to_its_middle() {
        let area = Polygon::new(square(0.0, 0.0, 600.0), vec![]).unwrap();
        let loops = loops(&area, &parameters());
        let sides: Vec<f64> = loops.iter().map(|l| (l[1] - l[0]).length().round()).collect();
        assert_eq!(sides, [500.0, 300.0, 100.0]);
        for ring in &loops {
            assert_eq!((ring.len(), ring.first()), (5, ring.last()));
            // clockwise, from the corner nearest to the entry
            assert!(signed_area_m2(ring) < 0.0 && ring[0].e < 300.0 && ring[0].n < 300.0);
        }
    }

    #[test]
    fn a_middle_too_wide_for_the_last_loop_gets_one_more() {
        let area = Polygon::new(square(0.0, 0.0, 680.0), vec![]).unwrap();
        let loops = loops(&area, &parameters());
        let sides: Vec<f64> = loops.iter().map(|l| (l[1] - l[0]).length().round()).collect();
        assert_eq!(sides, [580.0, 380.0, 180.0, 80.0]);
    }

    #[test]
    fn holes_are_gone_round_the_other_way() {
        let area = Polygon::new(square(0.0, 0.0, 1000.0), vec![square(400.0, 400.0, 200.0)]).unwrap();
        let p = ContourParameters { levels: 1, ..parameters() };
        let loops = loops(&area, &p);
        assert_eq!(loops.len(), 2);
        assert!(signed_area_m2(&loops[0]) < 0.0 && signed_area_m2(&loops[1]) > 0.0);
        assert!(loops.iter().flatten().all(|&c| (area.distance_to_edge_m(c) - 50.0).abs() < 21.0));
        assert!(loops[1].iter().all(|&c| (area.distance_to_edge_m(c) - 50.0).abs() < 1e-3));
    }

    #[test]
    fn outward_loops_keep_their_distance() {
        let area = Polygon::new(square(0.0, 0.0, 300.0), vec![square(100.0, 100.0, 50.0)]).unwrap();
        let p = ContourParameters { side: Side::Outward, levels: 3, turn: Turn::Left, ..parameters() };
        let loops = loops(&area, &p);
        assert_eq!(loops.len(), 3);
        for (ring, expected_m) in loops.iter().zip([50.0, 150.0, 250.0]) {
            assert!(signed_area_m2(ring) > 0.0);
            for pair in ring.windows(2) {
                for point in [pair[0], (pair[0] + pair[1]) * 0.5] {
                    let outside_m = area.distance_outside_m(point);
                    assert!((-1.001..1e-3).contains(&(outside_m - expected_m)), "{outside_m}");
                }
            }
        }
    }

    #[test]
    fn the_perimeter_is_the_edge_itself() {
        let area = Polygon::new(square(0.0, 0.0, 300.0), vec![]).unwrap();
        let p = ContourParameters { first_m: 0.0, levels: 1, ..parameters() };
        assert_eq!(loops(&area, &p)[0][..2], [Vec2::default(), Vec2::new(0.0, 300.0)]);
    }

    #[test]
    fn no_room_and_no_sense_are_refused() {
        let area = Polygon::new(square(0.0, 0.0, 90.0), vec![]).unwrap();
        let refused = |p: ContourParameters| Contours::new(&area, &p).unwrap_err();
        assert!(matches!(refused(parameters()), PatternError::TooNarrow { .. }));
        let p = parameters();
        for bad in [f64::NAN, f64::INFINITY, -1.0] {
            assert!(matches!(
                refused(ContourParameters { spacing_m: bad, ..p }),
                PatternError::NotPositive { .. }
            ));
            assert!(matches!(
                refused(ContourParameters { first_m: bad, ..p }),
                PatternError::Negative { .. }
            ));
            assert!(matches!(
                refused(ContourParameters { tolerance_m: bad, ..p }),
                PatternError::NotPositive { .. }
            ));
        }
        assert!(matches!(refused(ContourParameters { levels: 0, ..p }), PatternError::OutOfRange { .. }));
        assert!(matches!(
            refused(ContourParameters { levels: u64::MAX, ..p }),
            PatternError::OutOfRange { .. }
        ));
        let nowhere = Vec2::new(f64::NAN, 0.0);
        assert!(matches!(
            refused(ContourParameters { entry: nowhere, ..p }),
            PatternError::NotANumber { .. }
        ));
        let huge = ContourParameters { side: Side::Outward, first_m: 1e300, ..p };
        assert_eq!(refused(huge), PatternError::Offset);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        /// At the spacing's distance nothing is missed. At half of it, every sharp corner of a loop leaves something outside it:
        /// who wants all, flies loops at half the distance.
        #[test]
        fn no_point_of_the_area_is_farther_than_the_spacing_from_a_loop(
            area in any_area(), spacing_m in 30.0..300.0, left in any::<bool>(),
        ) {
            let turn = if left { Turn::Left } else { Turn::Right };
            let p = ContourParameters { spacing_m, first_m: 0.0, levels: 1000, turn, ..parameters() };
            let loops = loops(&area, &p);
            for ring in &loops {
                prop_assert_eq!(ring.first(), ring.last());
                for pair in ring.windows(2) {
                    let outside_m = area.distance_outside_m((pair[0] + pair[1]) * 0.5);
                    prop_assert!(outside_m < 1e-3, "{}", outside_m);
                }
            }
            let ways = loops.iter().flat_map(|ring| ring.windows(2).map(|w| (w[0], w[1])));
            // loops may cut a corner by the tolerance
            let share = crate::scan::coverage(&area, ways, spacing_m + p.tolerance_m);
            prop_assert!(share > 0.999_999, "{}", share);
        }
    }
}
