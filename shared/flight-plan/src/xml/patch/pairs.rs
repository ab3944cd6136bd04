//! Which element of a document is which of another.

use super::tree::{Key, Tree};
use std::collections::HashMap;

/// The elements of a plan's canonical documents, before and after.
pub(super) struct Pairs {
    /// Of each element after: the one before.
    pub before: Vec<Option<usize>>,
    /// Of each element before: the one after.
    pub after: Vec<Option<usize>>,
    /// Of each element after: it was elsewhere.
    pub moved: Vec<bool>,
}

/// What an element is found by among its siblings: its identifier or else a text; and how many like it come before.
type Mark<'t> = (Result<Key<'t>, &'t str>, usize);

struct Pairing<'p, 't> {
    a: &'p Tree<'t>,
    b: &'p Tree<'t>,
    keys_a: HashMap<Key<'t>, usize>,
    keys_b: HashMap<Key<'t>, usize>,
    pairs: Pairs,
}

impl Pairs {
    pub fn of<'t>(a: &Tree<'t>, b: &Tree<'t>) -> Self {
        let pairs = Self {
            before: vec![None; b.nodes.len()],
            after: vec![None; a.nodes.len()],
            moved: vec![false; b.nodes.len()],
        };
        let mut pairing = Pairing { a, b, keys_a: keys(a), keys_b: keys(b), pairs };
        pairing.tie(0, 0);
        pairing.find_moved();
        pairing.pairs
    }
}

fn keys<'t>(tree: &Tree<'t>) -> HashMap<Key<'t>, usize> {
    (0..tree.nodes.len()).rev().filter_map(|node| Some((tree.key(node)?, node))).collect()
}

impl<'t> Pairing<'_, 't> {
    fn tie(&mut self, a: usize, b: usize) {
        self.pairs.after[a] = Some(b);
        self.pairs.before[b] = Some(a);
        if self.a.whole(a) == self.b.whole(b) {
            for (a, b) in self.a.below(a).zip(self.b.below(b)) {
                self.pairs.after[a].get_or_insert(b);
                self.pairs.before[b].get_or_insert(a);
            }
        } else {
            self.tie_children(a, b);
        }
    }

    fn tie_children(&mut self, a: usize, b: usize) {
        let free = |node: &usize| self.pairs.after[*node].is_none();
        let list_a: Vec<usize> = self.a.children(a).filter(free).collect();
        let list_b: Vec<usize> = self.b.children(b).collect();
        let mut of_a: HashMap<Mark, usize> = HashMap::new();
        of_a.extend(marks(self.a, &list_a, Tree::whole).into_iter().enumerate().map(|(i, mark)| (mark, i)));
        let same = marks(self.b, &list_b, Tree::whole).into_iter().enumerate();
        let same: Vec<(usize, usize)> = same.filter_map(|(j, mark)| Some((*of_a.get(&mark)?, j))).collect();
        let (mut done_a, mut done_b) = (0, 0);
        for (i, j) in rising(&same).into_iter().chain([(list_a.len(), list_b.len())]) {
            self.tie_gap(&list_a[done_a..i], &list_b[done_b..j]);
            if let (Some(a), Some(b)) = (list_a.get(i), list_b.get(j)) {
                self.tie(*a, *b);
            }
            (done_a, done_b) = (i + 1, j + 1);
        }
    }

    /// Between two that stayed: what has the same name is the same thing, changed (or with another identifier).
    fn tie_gap(&mut self, list_a: &[usize], list_b: &[usize]) {
        let gone = |a: &&usize| self.a.key(**a).is_none_or(|key| !self.keys_b.contains_key(&key));
        let new = |b: &&usize| self.b.key(**b).is_none_or(|key| !self.keys_a.contains_key(&key));
        let list_a: Vec<usize> = list_a.iter().filter(gone).copied().collect();
        let list_b: Vec<usize> = list_b.iter().filter(new).copied().collect();
        let (mut i, mut j) = (0, 0);
        while let (Some(a), Some(b)) = (list_a.get(i), list_b.get(j)) {
            let alike = self.a.name(*a) == self.b.name(*b);
            let more_before = list_a.len() - i > list_b.len() - j;
            if alike {
                self.tie(*a, *b);
            }
            i += usize::from(alike || more_before);
            j += usize::from(alike || !more_before);
        }
    }

    fn find_moved(&mut self) {
        for b in 0..self.b.nodes.len() {
            if self.pairs.before[b].is_some() {
                continue;
            }
            let from = self.b.key(b).and_then(|key| self.keys_a.get(&key).copied());
            if let Some(a) = from.filter(|a| self.pairs.after[*a].is_none()) {
                self.pairs.moved[b] = true;
                self.tie(a, b);
            }
        }
    }
}

/// A mark for each of these siblings, no two the same; `else_by` tells those without an identifier apart.
fn marks<'t>(tree: &Tree<'t>, siblings: &[usize], else_by: fn(&Tree<'t>, usize) -> &'t str) -> Vec<Mark<'t>> {
    let mut seen: HashMap<Result<Key, &str>, usize> = HashMap::new();
    let mut mark = |node: &usize| {
        let what = tree.key(*node).ok_or_else(|| else_by(tree, *node));
        let count = seen.entry(what.clone()).or_default();
        *count += 1;
        (what, *count)
    };
    siblings.iter().map(&mut mark).collect()
}

/// The longest part of these pairs in which both sides rise; the second already does.
fn rising(pairs: &[(usize, usize)]) -> Vec<(usize, usize)> {
    // of the rising rows of each length: where the one with the lowest end ends
    let mut ends: Vec<usize> = Vec::new();
    let mut previous = vec![None; pairs.len()];
    for (at, (i, _)) in pairs.iter().enumerate() {
        let length = ends.partition_point(|end| pairs[*end].0 < *i);
        previous[at] = length.checked_sub(1).map(|shorter| ends[shorter]);
        ends.truncate(ends.len().max(length));
        if length == ends.len() { ends.push(at) } else { ends[length] = at }
    }
    let mut row: Vec<_> = std::iter::successors(ends.last().copied(), |at| previous[*at]).collect();
    row.reverse();
    row.into_iter().map(|at| pairs[at]).collect()
}

/// Where each element of a canonical document stands in the text that was read to the same plan. `None`: nowhere, or in a way that
/// can't be told.
pub(super) fn places(original: &Tree, canonical: &Tree) -> Vec<Option<usize>> {
    let mut places = vec![None; canonical.nodes.len()];
    place(original, canonical, (0, 0), &mut places);
    places
}

fn place(original: &Tree, canonical: &Tree, (o, a): (usize, usize), places: &mut [Option<usize>]) {
    places[a] = Some(o);
    let list: Vec<usize> = original.children(o).collect();
    let found: HashMap<_, usize> = marks(original, &list, Tree::name).into_iter().zip(list).collect();
    let list: Vec<usize> = canonical.children(a).collect();
    for (mark, a) in marks(canonical, &list, Tree::name).into_iter().zip(list) {
        if let Some(o) = found.get(&mark) {
            place(original, canonical, (*o, a), places);
        }
    }
}
