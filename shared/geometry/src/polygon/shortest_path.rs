//! The shortest path inside an area between two of its places.
//!
//! A* over the reflex corners of the area (those that stick into it), with the straight distance to the goal as the estimate.
//! Each visibility test counts the edges it compares against an [`EdgeBudget`], so that no area can cost more than was
//! allowed; a search that runs out of budget gives `None`.

use super::measure::foot;
use super::{Polygon, ring_edges, signed_area_m2};
use crate::Vec2;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A place this near to an edge counts as inside, metres: rounding puts places on edges on either side.
const ON_EDGE_M: f64 = 1e-3;

/// An area, prepared for shortest paths.
///
/// The shortest path inside a polygon turns only at its reflex corners (Lozano-Pérez and Wesley 1979).
#[derive(Debug, Clone)]
pub struct Interior {
    area: Polygon,
    corners: Vec<Corner>,
}

/// A reflex corner (it sticks into the area), and its neighbours.
#[derive(Debug, Clone, Copy)]
struct Corner {
    at: Vec2,
    before: Vec2,
    after: Vec2,
}

/// How many edges a search may still compare: bounds its cost.
#[derive(Debug, Clone, Copy)]
pub struct EdgeBudget(u64);

impl EdgeBudget {
    /// A budget of so many edges; 40 million take about a quarter of a second.
    pub fn new(edges: u64) -> Self {
        Self(edges)
    }
    fn take(&mut self, edges: usize) -> Option<()> {
        self.0 = self.0.checked_sub(edges as u64)?;
        Some(())
    }
}

/// A corner that has been reached and not yet expanded; ordered by `whole_m`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Open {
    /// Lower bound of the whole path through this corner, metres.
    whole_m: f64,
    corner: usize,
}

impl Eq for Open {}
impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Open {
    /// Reversed: the heap returns its greatest element, which must be the shortest path.
    fn cmp(&self, other: &Self) -> Ordering {
        other.whole_m.total_cmp(&self.whole_m).then(other.corner.cmp(&self.corner))
    }
}

/// The shortest path to a corner found so far.
#[derive(Debug, Clone, Copy)]
struct Reached {
    length_m: f64,
    /// The corner before it; `None`: straight from the start.
    from: Option<usize>,
    /// Already expanded.
    closed: bool,
}

impl Interior {
    /// Of an area.
    pub fn of(area: Polygon) -> Self {
        let outer_side = signed_area_m2(area.outer()).signum();
        let rings = area.rings.iter().enumerate();
        let corners = rings.flat_map(|(number, ring)| {
            // the side of the ring on which the area lies: left of an anticlockwise outer ring, the other side for holes
            let side = if number == 0 { outer_side } else { -signed_area_m2(ring).signum() };
            reflex_corners(ring, side)
        });
        Self { corners: corners.collect(), area }
    }

    /// The area itself.
    pub fn area(&self) -> &Polygon {
        &self.area
    }

    /// The corners of the shortest path inside between two places, without the two. A place outside is moved to the nearest
    /// place on the edge. `None`: the budget did not last.
    pub fn shortest_path(&self, from: Vec2, to: Vec2, budget: &mut EdgeBudget) -> Option<Vec<Vec2>> {
        let (from, to) = (self.nearest_inside(from), self.nearest_inside(to));
        Search { inside: self, from, to, reached: vec![None; self.corners.len()], open: BinaryHeap::new() }
            .run(budget)
    }

    /// Whether the straight line between two places stays inside; places outside are moved to the edge first. `None`: the
    /// budget did not last.
    pub fn is_straight(&self, from: Vec2, to: Vec2, budget: &mut EdgeBudget) -> Option<bool> {
        self.sees(self.nearest_inside(from), self.nearest_inside(to), budget)
    }

    fn nearest_inside(&self, p: Vec2) -> Vec2 {
        if self.area.contains(p) {
            return p;
        }
        let feet = self.area.edges().map(|(a, b)| foot(a, b, p));
        feet.min_by(|a, b| (*a - p).length().total_cmp(&(*b - p).length())).unwrap_or(p)
    }

    /// Whether the straight line between two places of the area stays in it.
    fn sees(&self, a: Vec2, b: Vec2, budget: &mut EdgeBudget) -> Option<bool> {
        budget.take(self.area.edges().count())?;
        let length_m = (b - a).length();
        if length_m <= ON_EDGE_M {
            return Some(true);
        }
        let line = Line { from: a, along: (b - a) * length_m.recip(), length_m };
        let mut meetings_m = vec![0.0, length_m];
        for (c, d) in self.area.edges() {
            if line.is_crossed_by(c, d, &mut meetings_m) {
                return Some(false);
            }
        }
        meetings_m.sort_unstable_by(f64::total_cmp);
        let middles = meetings_m.windows(2).filter_map(|pair| match pair {
            [low, high] if high - low > 2.0 * ON_EDGE_M => Some(line.at(f64::midpoint(*low, *high))),
            _ => None,
        });
        for middle in middles {
            budget.take(2 * self.area.edges().count())?;
            if self.area.distance_outside_m(middle) > ON_EDGE_M {
                return Some(false);
            }
        }
        Some(true)
    }
}

/// The reflex corners of a ring whose area lies to the left (`side` 1) or to the right (−1) of it.
fn reflex_corners(ring: &[Vec2], side: f64) -> Vec<Corner> {
    let next = ring_edges(ring).skip(1).chain(ring_edges(ring));
    let corner = |((before, at), (_, after)): ((Vec2, Vec2), (Vec2, Vec2))| Corner { at, before, after };
    let turns = |c: &Corner| side * (c.at - c.before).cross(c.after - c.at);
    ring_edges(ring).zip(next).map(corner).filter(|c| turns(c) < 0.0).collect()
}

impl Corner {
    /// Whether a taut line in this direction can bend here: both edges of the corner lie on one side of it.
    fn is_tangent_along(&self, direction: Vec2) -> bool {
        let along = direction * direction.length().max(ON_EDGE_M).recip();
        let off_m = [self.before, self.after].map(|neighbour| along.cross(neighbour - self.at));
        off_m.iter().all(|m| *m >= -ON_EDGE_M) || off_m.iter().all(|m| *m <= ON_EDGE_M)
    }
}

/// A straight piece.
struct Line {
    from: Vec2,
    along: Vec2,
    length_m: f64,
}

impl Line {
    fn at(&self, along_m: f64) -> Vec2 {
        self.from + self.along * along_m
    }

    /// Whether an edge crosses it; where it only touches it is added.
    fn is_crossed_by(&self, c: Vec2, d: Vec2, touches_m: &mut Vec<f64>) -> bool {
        let (c_m, d_m) = (self.along.cross(c - self.from), self.along.cross(d - self.from));
        if c_m.min(d_m) > ON_EDGE_M || c_m.max(d_m) < -ON_EDGE_M {
            return false;
        }
        let within = |m: &f64| (ON_EDGE_M..=self.length_m - ON_EDGE_M).contains(m);
        if c_m.min(d_m) < -ON_EDGE_M && c_m.max(d_m) > ON_EDGE_M {
            let at = c + (d - c) * (c_m / (c_m - d_m));
            return within(&(at - self.from).dot(self.along));
        }
        let on = [(c, c_m), (d, d_m)].into_iter().filter(|(_, off_m)| off_m.abs() <= ON_EDGE_M);
        touches_m.extend(on.map(|(p, _)| (p - self.from).dot(self.along)).filter(within));
        false
    }
}

/// One search.
struct Search<'a> {
    inside: &'a Interior,
    from: Vec2,
    to: Vec2,
    reached: Vec<Option<Reached>>,
    open: BinaryHeap<Open>,
}

impl Search<'_> {
    fn run(mut self, budget: &mut EdgeBudget) -> Option<Vec<Vec2>> {
        if self.inside.sees(self.from, self.to, budget)? {
            return Some(Vec::new());
        }
        self.expand(None, budget)?;
        while let Some(Open { corner, .. }) = self.open.pop() {
            let Some(reached) = self.reached.get_mut(corner)?.as_mut().filter(|r| !r.closed) else {
                continue;
            };
            reached.closed = true;
            // the straight line is the shortest possible rest, so no other open corner can do better
            if self.inside.sees(self.inside.corners.get(corner)?.at, self.to, budget)? {
                return Some(self.corners_to(corner));
            }
            self.expand(Some(corner), budget)?;
        }
        None
    }

    /// Expands a corner: every corner visible from it may now be reached through it.
    fn expand(&mut self, from: Option<usize>, budget: &mut EdgeBudget) -> Option<()> {
        let (start, so_far_m) = match from {
            None => (self.from, 0.0),
            Some(i) => (self.inside.corners.get(i)?.at, self.reached.get(i)?.as_ref()?.length_m),
        };
        for (i, corner) in self.inside.corners.iter().enumerate() {
            let step = corner.at - start;
            let length_m = so_far_m + step.length();
            let known = self.reached.get(i).copied().flatten();
            if known.is_some_and(|k| k.length_m <= length_m) || !corner.is_tangent_along(step) {
                continue;
            }
            if self.inside.sees(start, corner.at, budget)? {
                *self.reached.get_mut(i)? = Some(Reached { length_m, from, closed: false });
                self.open.push(Open { whole_m: length_m + (self.to - corner.at).length(), corner: i });
            }
        }
        Some(())
    }

    fn corners_to(&self, last: usize) -> Vec<Vec2> {
        let reached = |i: usize| self.reached.get(i).copied().flatten();
        let back = std::iter::successors(Some(last), |i| reached(*i)?.from);
        let mut corners: Vec<Vec2> = back.filter_map(|i| Some(self.inside.corners.get(i)?.at)).collect();
        corners.reverse();
        corners
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polygon::tests::any_area;
    use proptest::prelude::*;

    fn plenty() -> EdgeBudget {
        EdgeBudget::new(u64::MAX)
    }

    /// A bay between two arms, open to the north, and a hole in the western arm; in either direction.
    fn areas() -> [Interior; 2] {
        let corners =
            [(0, 0), (900, 0), (900, 600), (600, 600), (600, 200), (300, 200), (300, 600), (0, 600)];
        let hole = [(100, 300), (100, 400), (200, 400), (200, 300)];
        let ring = |corners: &[(i32, i32)]| -> Vec<Vec2> {
            corners.iter().map(|&(e, n)| Vec2::new(e.into(), n.into())).collect()
        };
        let turned = |mut ring: Vec<Vec2>| {
            ring.reverse();
            ring
        };
        let (outer, hole) = (ring(&corners), ring(&hole));
        [(outer.clone(), hole.clone()), (turned(outer), turned(hole))]
            .map(|(outer, hole)| Interior::of(Polygon::new(outer, vec![hole]).unwrap()))
    }

    #[test]
    fn the_shortest_path_goes_round_bays_and_holes() {
        for area in areas() {
            let path = |from: (f64, f64), to: (f64, f64)| {
                let (from, to) = (Vec2::new(from.0, from.1), Vec2::new(to.0, to.1));
                let path = area.shortest_path(from, to, &mut plenty()).unwrap();
                path.iter().map(|p| (p.e as i32, p.n as i32)).collect::<Vec<_>>()
            };
            assert_eq!(path((250.0, 590.0), (650.0, 590.0)), [(300, 200), (600, 200)]);
            assert_eq!(path((250.0, 590.0), (800.0, 100.0)), [(300, 200)]);
            assert_eq!(path((10.0, 10.0), (890.0, 10.0)), []);
            // along an edge, and past a corner that is touched
            assert_eq!(path((300.0, 600.0), (300.0, 200.0)), []);
            assert_eq!(path((300.0, 600.0), (300.0, 0.0)), []);
            // round the shorter side of the hole
            assert_eq!(path((140.0, 410.0), (140.0, 290.0)), [(100, 400), (100, 300)]);
            assert_eq!(path((160.0, 410.0), (160.0, 290.0)), [(200, 400), (200, 300)]);
            // from outside: from the nearest place of the edge
            assert_eq!(path((-50.0, 10.0), (950.0, 10.0)), []);
            assert_eq!(path((350.0, 500.0), (650.0, 500.0)), [(300, 200), (600, 200)]);
        }
    }

    #[test]
    fn what_takes_too_many_looks_is_not_found() {
        let [area, _] = areas();
        let (from, to) = (Vec2::new(250.0, 590.0), Vec2::new(650.0, 590.0));
        assert_eq!(area.shortest_path(from, to, &mut EdgeBudget::new(20)), None);
        assert_eq!(area.is_straight(from, to, &mut EdgeBudget::new(12)), Some(false));
        assert_eq!(area.is_straight(from, to, &mut EdgeBudget::new(11)), None);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn a_path_stays_inside_and_no_corner_of_it_can_be_left_out(
            area in any_area(), places in [(-1500.0..1500.0, -1500.0..1500.0), (-1500.0..1500.0, -1500.0..1500.0)],
        ) {
            let inside = Interior::of(area.clone());
            let [from, to] = places.map(|(e, n)| inside.nearest_inside(Vec2::new(e, n)));
            let mut path = vec![from];
            path.extend(inside.shortest_path(from, to, &mut plenty()).unwrap());
            path.push(to);
            for pair in path.windows(2) {
                for share in 0..=50 {
                    let p = pair[0] + (pair[1] - pair[0]) * (f64::from(share) / 50.0);
                    // along an edge that is nearly parallel it may be 2 mm outside
                    prop_assert!(area.distance_outside_m(p) <= 2.0 * ON_EDGE_M, "{:?} of {:?}", p, path);
                }
            }
            for three in path.windows(3) {
                let straight = inside.sees(three[0], three[2], &mut plenty()).unwrap();
                let detour_m = (three[1] - three[0]).length() + (three[2] - three[1]).length()
                    - (three[2] - three[0]).length();
                prop_assert!(!straight || detour_m < 1e-3, "{:?}", path);
            }
        }
    }
}
