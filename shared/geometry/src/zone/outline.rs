//! Polygons: in a frame around the zone, paths and edges are chords short enough to be straight there.

use super::ball::Ball;
use super::plate::Plate;
use super::{Stretch, Worst, ZoneError};
use crate::polygon::{PolygonError, distance_to_segment_m};
use crate::{Flattening, LatLon, LocalFrame, PathElement, Polygon, Vec2};

/// Chords of geodesics are no longer, metres. In an azimuthal frame a geodesic a distance p from the origin bends by about
/// 2p / 3R² per metre: at 100 km that bows 10 km by 2 cm.
const CHORD_M: f64 = 10_000.0;
/// Chords of arcs stay within this, metres.
const ARC_TOLERANCE_M: f64 = 0.1;
/// The worst point is found to this, metres.
const FOUND_TO_M: f64 = 0.05;
/// Most parts into which a chord is divided; each division halves the error where it matters.
const MAX_PARTS: usize = 400;

/// A polygon in its frame.
#[derive(Debug, Clone)]
pub(super) struct Outline {
    frame: LocalFrame,
    area: Polygon,
    edges: Vec<(Vec2, Vec2)>,
    plate: Plate,
    /// Greatest distance of a corner from the frame's origin, metres.
    radius_m: f64,
}

/// A straight piece of path in the frame.
#[derive(Debug, Clone, Copy)]
struct Chord {
    from: Vec2,
    to: Vec2,
    /// Way along the element where it begins and ends, metres.
    begins_m: f64,
    ends_m: f64,
}

impl Chord {
    fn at(&self, share: f64) -> Vec2 {
        self.from + (self.to - self.from) * share
    }
    fn along_m(&self, share: f64) -> f64 {
        self.begins_m + (self.ends_m - self.begins_m) * share
    }
}

impl Outline {
    pub fn new(outer: &[LatLon], holes: &[Vec<LatLon>]) -> Result<Self, ZoneError> {
        let none = PolygonError::TooFewCorners { ring: 0, corners: 0 };
        let frame = LocalFrame::around(outer).ok_or(none)?;
        // culprits are named by the corners that were given, before there are more of them
        Polygon::from_geo(&frame, outer, holes)?;
        let holes: Vec<Vec<LatLon>> = holes.iter().map(|hole| chords_of_ring(hole)).collect();
        let area = Polygon::from_geo(&frame, &chords_of_ring(outer), &holes)?;
        let radius_m = area.outer().iter().map(|c| c.length()).fold(0.0, f64::max);
        let edges = area.edges().collect();
        let plate = Plate::around(frame.origin(), area.outer());
        Ok(Self { frame, area, edges, plate, radius_m })
    }

    pub fn ball(&self) -> Ball {
        Ball::new(self.frame.origin(), self.radius_m)
    }

    /// Whether something in a ball may be nearer than a margin.
    pub fn may_be_near(&self, ball: &Ball, margin_m: f64) -> bool {
        self.plate.may_be_near(ball, margin_m)
    }

    /// The deepest point inside, or nearer to it than a margin.
    pub fn deepest(&self, element: &PathElement, margin_m: f64) -> Option<Worst> {
        let chords = self.chords(element, self.radius_m + margin_m);
        self.worst(&chords, margin_m, true)
    }

    /// The farthest point outside, or nearer to the edge than a margin.
    pub fn farthest(&self, element: &PathElement, margin_m: f64) -> Option<Worst> {
        let near = self.worst(&self.chords(element, self.frame.radius_m()), margin_m, false);
        let length_m = element.length_m();
        let ends = [(0.0, element.start()), (length_m, element.end())];
        let far = ends.into_iter().filter(|(_, p)| self.frame.origin().distance_m(*p) > self.radius_m);
        let outside =
            far.map(|(along_m, p)| Worst { along_m, wrong_m: self.geodesic_distance_m(p) + margin_m });
        near.into_iter().chain(outside).reduce(Worst::or)
    }

    /// Whether a stretch is certainly inside (true) or outside (false): its ball does not reach the edge.
    pub fn side(&self, stretch: &Stretch, margin_m: f64) -> Option<bool> {
        let middle = match stretch.element {
            PathElement::Line { from, .. } => from,
            PathElement::Arc { centre, .. } => centre,
        };
        // a line's ball is around its middle: from an end it reaches twice as far
        let reach_m = 2.0 * stretch.ball.radius_m() + margin_m;
        if reach_m > self.radius_m {
            return None;
        }
        let middle = self.frame.to_local(middle);
        // frames stretch distances by less than a ten-thousandth
        let is_clear =
            middle.length() < self.frame.radius_m() && self.area.distance_to_edge_m(middle) > 1.001 * reach_m;
        is_clear.then(|| self.area.contains(middle))
    }

    /// How far a position is outside, metres; 0 inside.
    pub fn outside_m(&self, p: LatLon) -> f64 {
        self.area.distance_outside_m(self.frame.to_local(p))
    }

    /// Distance from a position outside to the edge along geodesics, for where the frame does not reach.
    fn geodesic_distance_m(&self, p: LatLon) -> f64 {
        let edge = |&(a, b): &(Vec2, Vec2)| PathElement::Line {
            from: self.frame.to_geo(a),
            to: self.frame.to_geo(b),
        };
        self.edges.iter().map(|e| edge(e).nearest(p).separation_m).fold(f64::INFINITY, f64::min)
    }

    /// The chords of an element's part that is nearer to the origin than a distance.
    fn chords(&self, element: &PathElement, within_m: f64) -> Vec<Chord> {
        let (begins_m, ends_m) = match element {
            PathElement::Line { .. } => self.part_near(element, within_m),
            PathElement::Arc { .. } => (0.0, element.length_m()),
        };
        let longest_m = match *element {
            PathElement::Line { .. } => CHORD_M,
            PathElement::Arc { radius_m, .. } => {
                radius_m * Flattening::Inscribed.step_rad(radius_m, ARC_TOLERANCE_M)
            }
        };
        let count = ((ends_m - begins_m) / longest_m).ceil().clamp(1.0, crate::arc::MAX_SEGMENTS as f64);
        let along_m = |i: f64| begins_m + (ends_m - begins_m) * i / count;
        let mut from = self.frame.to_local(element.point_at(begins_m));
        (0..count as usize)
            .map(|i| {
                let (begins_m, ends_m) = (along_m(i as f64), along_m(i as f64 + 1.0));
                let to = self.frame.to_local(element.point_at(ends_m));
                let chord = Chord { from, to, begins_m, ends_m };
                from = to;
                chord
            })
            .collect()
    }

    /// Where a line comes and leaves nearer to the origin than a distance, with a little to spare.
    fn part_near(&self, line: &PathElement, within_m: f64) -> (f64, f64) {
        let near = line.nearest(self.frame.origin());
        let aside_m = near.separation_m.min(near.cross_track_m.abs());
        let half_m = 1.001 * (within_m * within_m - aside_m * aside_m).max(0.0).sqrt() + 1.0;
        ((near.distance_m - half_m).max(0.0), (near.distance_m + half_m).min(line.length_m()))
    }

    /// The point farthest on the wrong side (`inside` or not); else, with a margin, the one nearest to the edge.
    fn worst(&self, chords: &[Chord], margin_m: f64, inside: bool) -> Option<Worst> {
        let mut worst: Option<Worst> = None;
        let mut take = |found: Worst| worst = Some(worst.map_or(found, |w| w.or(found)));
        for chord in chords {
            for (from, to) in self.parts(chord) {
                let wrong = self.area.contains(chord.at((from + to) / 2.0)) == inside;
                if wrong {
                    let found = self.deepest_between(chord, from, to);
                    take(Worst { wrong_m: found.wrong_m + margin_m, ..found });
                } else if margin_m > 0.0 {
                    let near = self.nearest_to_edge(chord);
                    take(Worst { wrong_m: margin_m - near.wrong_m, ..near });
                }
            }
        }
        worst.filter(|w| w.wrong_m > 0.0)
    }

    /// The parts of a chord between its crossings of the edge, as shares of its length.
    fn parts(&self, chord: &Chord) -> Vec<(f64, f64)> {
        let mut cuts = vec![0.0];
        cuts.extend(self.edges.iter().filter_map(|&(a, b)| crossing(chord, a, b)));
        cuts.push(1.0);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        cuts.windows(2).filter_map(|w| Some((*w.first()?, *w.last()?))).collect()
    }

    fn edge_distance_m(&self, p: Vec2) -> f64 {
        self.edges.iter().map(|&(a, b)| distance_to_segment_m(a, b, p)).fold(f64::INFINITY, f64::min)
    }

    /// The point of a part of a chord that is farthest from the edge, by branch and bound: along a straight line the distance
    /// from each edge is convex, hence between two points nowhere greater than at the greater end.
    fn deepest_between(&self, chord: &Chord, from: f64, to: f64) -> Worst {
        let place = |share: f64| Worst {
            along_m: chord.along_m(share),
            wrong_m: self.edge_distance_m(chord.at(share)),
        };
        let mut best = place(from).or(place((from + to) / 2.0)).or(place(to));
        let mut open = vec![(from, to)];
        let mut looked_at = 0;
        while let Some((from, to)) = open.pop() {
            looked_at += 1;
            let at_most_m = self.bound_m(chord.at(from), chord.at(to));
            if at_most_m <= best.wrong_m + FOUND_TO_M || looked_at > MAX_PARTS {
                continue;
            }
            let middle = (from + to) / 2.0;
            best = best.or(place(middle));
            open.extend([(from, middle), (middle, to)]);
        }
        best
    }

    /// No point between two is farther than this from the edge.
    fn bound_m(&self, from: Vec2, to: Vec2) -> f64 {
        let farther_m =
            |&(a, b): &(Vec2, Vec2)| distance_to_segment_m(a, b, from).max(distance_to_segment_m(a, b, to));
        self.edges.iter().map(farther_m).fold(f64::INFINITY, f64::min)
    }

    /// The point of a chord nearest to the edge; how near is its `wrong_m`. It lies at an end of the chord, or abreast of a corner.
    fn nearest_to_edge(&self, chord: &Chord) -> Worst {
        let way = chord.to - chord.from;
        let abreast = |&(corner, _): &(Vec2, Vec2)| {
            let share = (corner - chord.from).dot(way) / way.dot(way);
            if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
        };
        let of_corner = |edge: &(Vec2, Vec2)| {
            let share = abreast(edge);
            Worst { along_m: chord.along_m(share), wrong_m: (edge.0 - chord.at(share)).length() }
        };
        let of_end =
            |share| Worst { along_m: chord.along_m(share), wrong_m: self.edge_distance_m(chord.at(share)) };
        let corners = self.edges.iter().map(of_corner);
        corners
            .chain([of_end(0.0), of_end(1.0)])
            .fold(of_end(0.0), |a, b| if b.wrong_m < a.wrong_m { b } else { a })
    }
}

/// A ring with corners added on its long edges.
fn chords_of_ring(ring: &[LatLon]) -> Vec<LatLon> {
    let next = ring.iter().cycle().skip(1);
    let mut corners = Vec::with_capacity(ring.len());
    for (&from, &to) in ring.iter().zip(next) {
        corners.push(from);
        let way = from.inverse(to);
        let pieces = (way.distance_m / CHORD_M).ceil();
        // a frame's radius bounds the length of an edge
        for i in 1..pieces as usize {
            corners.push(from.destination(way.bearing_start_deg, way.distance_m * i as f64 / pieces));
        }
    }
    corners
}

/// Share of a chord where it crosses an edge.
fn crossing(chord: &Chord, a: Vec2, b: Vec2) -> Option<f64> {
    let (way, edge) = (chord.to - chord.from, b - a);
    let cross = way.cross(edge);
    let share = (a - chord.from).cross(edge) / cross;
    let on_edge = (a - chord.from).cross(way) / cross;
    // parallel ones give no number
    ((0.0..=1.0).contains(&share) && (0.0..=1.0).contains(&on_edge)).then_some(share)
}
