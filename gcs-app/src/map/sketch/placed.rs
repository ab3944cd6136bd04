//! Where the places of a sketch are on the map: projected once, for they are looked for in every frame.

use super::Sketch;
use crate::map::view::Mercator;
use geometry::{LatLon, LocalFrame, local};

/// In the order of the sketch.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Placed {
    /// Of the handles.
    pub handles: Vec<Mercator>,
    /// The ends of the lines.
    pub lines: Vec<[Mercator; 2]>,
}

impl Placed {
    /// Of a sketch; what is where it was in the former one is not projected again.
    pub(super) fn of(sketch: &Sketch, former: &Sketch) -> Self {
        let known = former.handles.iter().zip(&former.placed.handles).map(|(handle, at)| (handle.at, *at));
        let handles = sketch.handles.iter().zip(known.map(Some).chain(std::iter::repeat(None)));
        let known = former.lines.iter().zip(&former.placed.lines);
        let lines = sketch.lines.iter().zip(known.map(Some).chain(std::iter::repeat(None)));
        Self {
            handles: handles.map(|(handle, known)| place(handle.at, known)).collect(),
            lines: lines
                .map(|(line, known)| {
                    let ends = known.map(|(was, [from, to])| [(was.from, *from), (was.to, *to)]);
                    [place(line.from, ends.map(|[from, _]| from)), place(line.to, ends.map(|[_, to]| to))]
                })
                .collect(),
        }
    }
}

/// A place on the map, if that is known of a place: of the same one.
fn place(at: LatLon, known: Option<(LatLon, Mercator)>) -> Mercator {
    known.filter(|(was, _)| *was == at).map_or_else(|| at.into(), |(_, place)| place)
}

/// How far it is between two places, in metres, and the place in the middle.
pub fn middle(from: LatLon, to: LatLon) -> (f64, LatLon) {
    let frame = LocalFrame::new(from);
    let way = frame.to_local(to);
    // a flat frame is as good there, and ten thousand legs are done at once
    match way.length() {
        length_m if length_m < local::EXACT_RADIUS_M => (length_m, frame.to_geo(way * 0.5)),
        _ => (from.distance_m(to), from.interpolate(to, 0.5)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_a_leg_is_on_the_geodesic_however_long_that_is() {
        let from = LatLon::new(46.0, 179.99);
        for far_m in [0.0, 1.0, 300.0, 9_000.0, 11_000.0, 3_000_000.0] {
            let to = from.destination(73.0, far_m);
            let (length_m, at) = middle(from, to);
            assert!((length_m - far_m).abs() < 1e-3, "{length_m}");
            assert!(at.distance_m(from.interpolate(to, 0.5)) < 1e-2, "{far_m}");
        }
    }
}
