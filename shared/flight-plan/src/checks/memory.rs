//! What one check leaves for the next: after an edit nearly every line of a plan is where it was.

use super::inspection::Path;
use geometry::LatLon;

/// The lines of the plan that was checked last, in its order. Finding the geodesic between two positions is most of what checking
/// costs, and depends on nothing else; so it does not matter which plan, aircraft or ground they are from.
#[derive(Debug, Default)]
pub struct Memory(Vec<Line>);

#[derive(Debug, Clone, Copy)]
struct Line {
    from: LatLon,
    to: LatLon,
    path: Path,
}

/// A memory in use.
pub(super) struct Recall<'m> {
    memory: &'m mut Memory,
    /// Where the old lines go on.
    next: usize,
    /// How many old lines the next search looks at: more after each one in vain.
    ahead: usize,
    /// How many may still be looked at: the search costs no more than the plan.
    left: usize,
    lines: Vec<Line>,
}

/// Looked at first: what a few deleted legs leave over.
const AHEAD: usize = 8;

impl<'m> Recall<'m> {
    pub fn new(memory: &'m mut Memory) -> Self {
        let left = 4 * memory.0.len();
        let lines = Vec::with_capacity(memory.0.len());
        Self { memory, next: 0, ahead: AHEAD, left, lines }
    }

    /// [`Path::line`], remembered or computed.
    pub fn line(&mut self, from: LatLon, to: LatLon) -> Path {
        let old = self.memory.0.get(self.next..).unwrap_or_default();
        let ahead = self.ahead.min(self.left);
        let found = old.iter().take(ahead).position(|line| line.from == from && line.to == to);
        let line = match found.and_then(|n| old.get(n).map(|line| (n, *line))) {
            Some((n, line)) => {
                self.next += n + 1;
                self.ahead = AHEAD;
                line
            }
            None => {
                self.left -= ahead.min(old.len());
                self.ahead = self.ahead.saturating_mul(2);
                Line { from, to, path: Path::line(from, to) }
            }
        };
        self.lines.push(line);
        line.path
    }

    /// Keeps this check's lines for the next.
    pub fn finish(self) {
        self.memory.0 = self.lines;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn lines(recall: &mut Recall, positions: &[u8]) -> Vec<f64> {
        let at = |n: u8| LatLon::new(f64::from(n) / 100.0, 0.0);
        positions.windows(2).map(|pair| recall.line(at(pair[0]), at(pair[1])).length_m()).collect()
    }

    /// Legs edited, as `(position, removed, put in)`.
    fn edited(plan: &[u8], edits: &[(usize, usize, Vec<u8>)]) -> Vec<u8> {
        let mut plan = plan.to_vec();
        for (at, removed, put_in) in edits {
            let at = at % (plan.len() + 1);
            let end = (at + removed).min(plan.len());
            plan.splice(at..end, put_in.iter().copied());
        }
        plan
    }

    #[test]
    fn after_an_edit_of_one_leg_two_lines_are_computed() {
        let plan: Vec<u8> = (0..200).collect();
        let mut memory = Memory::default();
        let mut recall = Recall::new(&mut memory);
        lines(&mut recall, &plan);
        recall.finish();
        let moved = edited(&plan, &[(100, 1, vec![250])]);
        let mut recall = Recall::new(&mut memory);
        lines(&mut recall, &moved);
        // what was looked at in vain: eight, then sixteen
        assert_eq!(recall.left, 4 * 199 - AHEAD - 2 * AHEAD);
        assert_eq!(recall.next, 199);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Whatever was checked before, the lines are those that there are.
        #[test]
        fn a_remembered_line_is_the_line(
            plan in prop::collection::vec(any::<u8>(), 0..60),
            edits in prop::collection::vec((any::<usize>(), 0..30_usize, prop::collection::vec(any::<u8>(), 0..4)), 0..5),
        ) {
            let mut memory = Memory::default();
            for plan in [plan.clone(), edited(&plan, &edits)] {
                let fresh = lines(&mut Recall::new(&mut Memory::default()), &plan);
                let mut recall = Recall::new(&mut memory);
                let remembered = lines(&mut recall, &plan);
                recall.finish();
                prop_assert_eq!(remembered, fresh);
            }
        }
    }
}
