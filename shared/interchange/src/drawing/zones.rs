//! Areas as zones. A zone has no holes itself: those of an area to stay inside of are zones to keep out of, inside it.

use super::{Feature, Shape};
use flight_plan::{ZoneKind, ZoneShape};

/// A zone of an area that was drawn; what else it has is for the plan that it goes into.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnZone {
    /// What people call it; may be empty.
    pub name: String,
    /// What it is for.
    pub kind: ZoneKind,
    /// Where.
    pub shape: ZoneShape,
    /// It is a hole of the one before.
    pub is_hole: bool,
}

/// An area as zones of a kind: what is drawn around, then its holes. Those of an area to keep out of are left out, for nobody flies
/// inside of them either. Of a point or a line there are none.
pub fn of(feature: &Feature, kind: ZoneKind) -> Vec<DrawnZone> {
    let Shape::Area { outer, holes, .. } = &feature.shape else { return Vec::new() };
    let centre = feature.position("centre_lat", "centre_lon");
    let shape = match (centre, feature.number("radius_m").filter(|r| *r > 0.0)) {
        (Some(centre), Some(radius_m)) => ZoneShape::Circle { centre, radius_m },
        _ => ZoneShape::Polygon(outer.clone()),
    };
    // those of ours have the identifier as name, and the name as description
    let ours = feature.mark("legwork").is_some();
    let name = if ours { &feature.description } else { &feature.name }.clone();
    let around = DrawnZone { name, kind, shape, is_hole: false };
    let holes = holes.iter().filter(|_| kind == ZoneKind::KeepIn).map(|hole| DrawnZone {
        name: if feature.name.is_empty() { String::new() } else { format!("{}, hole", feature.name) },
        kind: ZoneKind::KeepOut,
        shape: ZoneShape::Polygon(hole.clone()),
        is_hole: true,
    });
    std::iter::once(around).chain(holes).collect()
}
