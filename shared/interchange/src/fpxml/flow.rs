//! Where the legs of a flat list lead, as far as they name it.

use super::Reader;
use super::leg::kind_of;
use super::listed::spaced;
use super::stage::{Flat, next_of};
use crate::xml::Element;
use std::collections::HashSet;

/// Most legs of a branch that are looked at, one after the other.
const MAX_BRANCH: usize = 1000;

impl Flat<'_> {
    /// The leg of this stage that a leg names as the one that comes after it.
    fn next(&self, leg: usize) -> Option<usize> {
        self.index.get(&spaced(next_of(self.legs.get(leg)?))).copied()
    }
}

impl Reader<'_> {
    /// The legs that the branches of a fork begin with; none if it is no fork.
    pub(super) fn heads(&self, flat: &Flat<'_>, leg: usize) -> Vec<usize> {
        let fork = flat.legs.get(leg).copied().filter(|leg| kind_of(leg) == "intersection");
        self.found(flat, fork, "nextList").into_iter().flatten().collect()
    }

    /// A stage that doesn't say where it begins, and to whose first leg another one leads, is not written in the order in which it
    /// is flown: it begins with a leg that nobody leads to, and what an earlier one would follow on by itself, ends it.
    pub(super) fn begin_by_next(&mut self, flat: &mut Flat<'_>, list: &mut [usize], stage: &Element) {
        let mut led_to: HashSet<usize> = list.iter().filter_map(|leg| flat.next(*leg)).collect();
        if !list.first().is_some_and(|first| led_to.contains(first)) {
            return;
        }
        led_to.extend(list.iter().flat_map(|leg| self.heads(flat, *leg)));
        let begins = |leg: &usize| flat.next(*leg).is_some() && !led_to.contains(leg);
        let Some(begin) = list.iter().copied().find(begins) else { return };
        let from_behind = list.iter().filter_map(|leg| flat.next(*leg).filter(|next| next < leg));
        let ends: Vec<usize> = from_behind.filter(|leg| flat.next(*leg).is_none()).collect();
        flat.last.extend(ends);
        let name = flat.names.get(begin).cloned();
        let message = format!(
            "the stage doesn't say where it begins: it begins with leg `{}`, which no other leads to",
            name.as_deref().unwrap_or_default()
        );
        self.notes.push("order-assumed", stage.place(), message);
        self.first(flat, list, name.as_ref());
    }

    /// The body of a loop with the branches that its forks have outside of it, if they lead back into it, or to the leg that it ends
    /// with.
    pub(super) fn with_branches(
        &self,
        flat: &Flat<'_>,
        members: Vec<usize>,
        last: Option<usize>,
    ) -> Vec<usize> {
        let mut inside: HashSet<usize> = members.iter().copied().collect();
        let mut outside = HashSet::new();
        let (mut whole, mut ends) = (Vec::new(), None);
        // the next one at the end
        let mut waiting: Vec<usize> = members.into_iter().rev().collect();
        while let Some(member) = waiting.pop() {
            whole.push(member);
            let mut branches = Vec::new();
            for head in self.heads(flat, member) {
                let Some((way, back)) = self.way_back(flat, head, &inside, last, &mut outside) else {
                    continue;
                };
                inside.extend(&way);
                branches.extend(way);
                ends = ends.or(last.filter(|last| *last == back && !inside.contains(last)));
            }
            waiting.extend(branches.into_iter().rev());
        }
        whole.extend(ends.filter(|last| !inside.contains(last)));
        whole
    }

    /// The legs from a branch's first up to a leg of the body or to a fork, and that leg or fork; `None`: it leads elsewhere, as do the
    /// legs `outside`.
    fn way_back(
        &self,
        flat: &Flat<'_>,
        head: usize,
        inside: &HashSet<usize>,
        last: Option<usize>,
        outside: &mut HashSet<usize>,
    ) -> Option<(Vec<usize>, usize)> {
        let (mut way, mut seen, mut at) = (Vec::new(), HashSet::new(), Some(head));
        while let Some(leg) = at.filter(|leg| !outside.contains(leg) && seen.insert(*leg)) {
            if way.len() > MAX_BRANCH {
                break;
            }
            if inside.contains(&leg) || Some(leg) == last {
                return Some((way, leg));
            }
            way.push(leg);
            if !self.heads(flat, leg).is_empty() {
                return Some((way, leg));
            }
            at = flat.next(leg);
        }
        outside.extend(seen);
        None
    }
}
