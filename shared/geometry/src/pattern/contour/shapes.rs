//! Areas grown, shrunk and taken away from each other: the library, and what it calls a shape.

use crate::pattern::PatternError;
use crate::polygon::signed_area_m2;
use crate::{Flattening, Polygon, Vec2};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::scale::FixedScaleFloatOverlay;
use i_overlay::mesh::float::outline::offset::OutlineOffset;
use i_overlay::mesh::float::style::{LineJoin, OutlineStyle};

/// The library computes in whole numbers: tenths of a millimetre.
const UNITS_PER_M: f64 = 10_000.0;
/// Smaller rings are dust of the computation, square metres.
const MIN_AREA_M2: f64 = 0.01;

/// An area in one piece: its outer ring anticlockwise, then its holes, clockwise.
pub(super) type Shape = Vec<Vec<Vec2>>;
/// Several of them, as the library knows them.
type Library = Vec<Vec<Vec<[f64; 2]>>>;

/// A polygon's rings in the directions of a shape.
pub(super) fn rings_of(area: &Polygon) -> Shape {
    let mut rings = vec![area.outer().to_vec()];
    rings.extend_from_slice(area.holes());
    for (i, ring) in rings.iter_mut().enumerate() {
        if (signed_area_m2(ring) > 0.0) != (i == 0) {
            ring.reverse();
        }
    }
    rings
}

/// Square metres, without the holes.
pub(super) fn area_m2(shape: &Shape) -> f64 {
    shape.iter().map(|ring| signed_area_m2(ring)).sum()
}

/// Whether a shape lies inside another; they do not cross.
pub(super) fn contains(shape: &Shape, other: &Shape) -> bool {
    let corner = other.first().and_then(|ring| ring.first());
    corner.is_some_and(|&c| crate::polygon::contains(shape, c))
}

/// Shapes grown by a distance (negative: shrunk), metres; corners are rounded to a tolerance.
pub(super) fn grown(shapes: &[Shape], by_m: f64, tolerance_m: f64) -> Result<Vec<Shape>, PatternError> {
    if by_m == 0.0 {
        return Ok(shapes.to_vec());
    }
    let step_rad = Flattening::Inscribed.step_rad(by_m.abs(), tolerance_m);
    let style = OutlineStyle::new(by_m).line_join(LineJoin::Round(step_rad));
    let grown = to_library(shapes).outline_fixed_scale_as::<i64>(&style, UNITS_PER_M);
    grown.map(from_library).map_err(|_| PatternError::Offset)
}

/// What is in one and not in the other.
pub(super) fn minus(shapes: &[Shape], others: &[Shape]) -> Result<Vec<Shape>, PatternError> {
    let (shapes, others) = (to_library(shapes), to_library(others));
    let left = shapes.overlay_with_fixed_scale_as::<i64>(
        &others,
        OverlayRule::Difference,
        FillRule::NonZero,
        UNITS_PER_M,
    );
    left.map(from_library).map_err(|_| PatternError::Offset)
}

fn to_library(shapes: &[Shape]) -> Library {
    let ring = |ring: &Vec<Vec2>| ring.iter().map(|c| [c.e, c.n]).collect();
    shapes.iter().map(|shape| shape.iter().map(ring).collect()).collect()
}

fn from_library(shapes: Library) -> Vec<Shape> {
    let ring =
        |ring: Vec<[f64; 2]>| -> Vec<Vec2> { ring.into_iter().map(|[e, n]| Vec2::new(e, n)).collect() };
    let shapes = shapes.into_iter().map(|shape| without_dust(shape.into_iter().map(ring).collect()));
    shapes.filter(|shape| !shape.is_empty()).collect()
}

/// Without rings that are none; nothing if the outer one is none.
fn without_dust(mut shape: Shape) -> Shape {
    let dust = |ring: &Vec<Vec2>| signed_area_m2(ring).abs() < MIN_AREA_M2;
    if shape.first().is_none_or(dust) {
        return Shape::new();
    }
    shape.retain(|ring| !dust(ring));
    shape
}
