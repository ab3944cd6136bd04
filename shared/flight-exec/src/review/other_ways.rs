//! The ways of a plan that the flight as planned does not take: what goes wrong only there is told of them.

use super::View;
use flight_plan::{Branch, FlownAt, Id, Leg, LegContext};
use geometry::LatLon;
use std::collections::{HashMap, HashSet};

/// What the flight as planned comes to, and the branches that it leaves out.
pub(super) struct OtherWays<'a> {
    planned: HashSet<&'a Id>,
    /// Legs that it flies one after the other.
    pairs: HashSet<(&'a Id, &'a Id)>,
    /// Of legs that it does not fly: the fork and the branch that lead there.
    branches: HashMap<&'a Id, (&'a Id, &'a Branch)>,
    /// Of legs that it flies: the only fork with a branch that leads straight there.
    heads: HashMap<&'a Id, Option<(&'a Id, &'a Branch)>>,
}

/// A way that the flight as planned does not take.
pub(super) struct OtherWay<'a> {
    /// The leg before, where the leg itself is planned, but behind another one.
    after: Option<&'a Id>,
    branch: Option<(&'a Id, &'a Branch)>,
}

impl<'a> OtherWays<'a> {
    /// `None`: there are none, or it is not known what is planned.
    pub fn of(view: &'a View) -> Option<Self> {
        let flown = view.flights.planned.as_ref().ok().filter(|_| view.program.has_forks())?;
        let legs = || flown.waypoints.iter().map(|at| &at.waypoint.leg);
        let planned: HashSet<&Id> = legs().collect();
        let pairs = legs().zip(legs().skip(1)).collect();
        let mut ways = Self { planned, pairs, branches: HashMap::new(), heads: HashMap::new() };
        for context in view.program.flown().all_legs() {
            let branches = context.leg.as_fork().map_or(&[][..], |fork| fork.branches);
            branches.iter().for_each(|branch| ways.follow(&context, branch));
        }
        Some(ways)
    }

    /// Takes in the legs of a branch, to where the flight as planned goes on.
    fn follow(&mut self, fork: &LegContext<'a>, branch: &'a Branch) {
        let of = (&fork.leg.id, branch);
        let list = fork.siblings;
        let at = |id: &Id| list.iter().position(|leg| leg.id == *id);
        let mut index = branch.next.as_ref().map_or(Some(fork.index + 1), at);
        let mut is_head = true;
        while let Some(leg) = index.and_then(|index| list.get(index)) {
            let first = &leg.first_flown().id;
            if self.planned.contains(first) {
                if is_head {
                    self.heads.entry(first).and_modify(|known| *known = None).or_insert(Some(of));
                }
                return;
            }
            let is_fork = leg.as_fork().is_some_and(|fork| !fork.branches.is_empty());
            if is_fork || self.branches.contains_key(&leg.id) {
                return;
            }
            self.add(leg, of);
            is_head &= leg.as_fork().is_some();
            index = leg.next.as_ref().map_or(index.map(|index| index + 1), at);
        }
    }

    fn add(&mut self, leg: &'a Leg, of: (&'a Id, &'a Branch)) {
        self.branches.insert(&leg.id, of);
        leg.body().iter().for_each(|inner| self.add(inner, of));
    }

    /// By which way a leg is come to behind another one; `None`: as planned.
    pub fn to(&self, leg: &Id, before: Option<&'a Id>) -> Option<OtherWay<'a>> {
        if !self.planned.contains(leg) {
            return Some(OtherWay { after: None, branch: self.branches.get(leg).copied() });
        }
        let after = before.filter(|before| !self.pairs.contains(&(*before, leg)))?;
        let straight = || self.heads.get(leg).copied().flatten();
        Some(OtherWay { after: Some(after), branch: self.branches.get(after).copied().or_else(straight) })
    }
}

impl OtherWay<'_> {
    /// Behind what a leg should do: ` where it follows `y` (branch “away”)`.
    pub fn told(&self) -> String {
        let after = self.after.map(|after| format!(" where it follows `{after}`")).unwrap_or_default();
        let name = |branch: &Branch| match branch.label.as_str() {
            "" => branch.id.to_string(),
            label => label.to_owned(),
        };
        let branch = self.branch.map(|(_, branch)| format!(" (branch “{}”)", name(branch)));
        after + &branch.unwrap_or_default()
    }

    /// A place on it.
    pub fn spot(&self, position: LatLon) -> FlownAt {
        let branch = self.branch.map(|(fork, branch)| (fork.clone(), branch.id.clone()));
        FlownAt { position, is_off_plan: true, branch }
    }
}
