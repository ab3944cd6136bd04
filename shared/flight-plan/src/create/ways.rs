//! The branches of a fork: which legs are flown on one of them alone, and the fork with a branch called otherwise, moved or taken out.

use super::arrange::list_of;
use crate::{Branch, Edit, FlightPlan, Id, Leg, LegKind};
use std::collections::HashMap;
use std::sync::Arc;

/// Steps through lists of legs that are taken at most; a list that needs more is seen as flat.
const MOST_STEPS: usize = 2_000_000;

/// Of each leg of a list the fork and its branch, by their indices, that every way to it leads over: the innermost one. A fork whose
/// branches don't all lead on has no legs of its own, and what no way leads to is no branch's.
pub fn ways(list: &[Arc<Leg>]) -> Vec<Option<(usize, usize)>> {
    if !list.iter().any(|leg| leg.as_fork().is_some_and(|fork| fork.branches.len() > 1)) {
        return vec![None; list.len()];
    }
    let index: HashMap<&Id, usize> = list.iter().enumerate().map(|(i, leg)| (&leg.id, i)).collect();
    let onwards: Vec<Vec<Option<usize>>> =
        list.iter().enumerate().map(|(i, leg)| targets(leg, i, list.len(), &index)).collect();
    let forks = onwards.iter().enumerate().filter(|(fork, ways)| parts(*fork, ways));
    let branches: Vec<(usize, usize)> =
        forks.flat_map(|(fork, ways)| (0..ways.len()).map(move |branch| (fork, branch))).collect();
    let mut owners = vec![(None, usize::MAX); list.len()];
    if branches.len().saturating_mul(list.len()) > MOST_STEPS {
        return vec![None; list.len()];
    }
    let flown = reached(&onwards, Some(0), None);
    for (fork, branch) in branches {
        let own = own(&onwards, &flown, fork, branch);
        for leg in &own {
            // the smaller one is inside the other
            if let Some(owner) = owners.get_mut(*leg).filter(|(_, size)| own.len() < *size) {
                *owner = (Some((fork, branch)), own.len());
            }
        }
    }
    owners.into_iter().map(|(owner, _)| owner).collect()
}

/// Where a leg leads; a way that ends the list leads nowhere.
fn targets(leg: &Leg, at: usize, len: usize, index: &HashMap<&Id, usize>) -> Vec<Option<usize>> {
    let behind = Some(at + 1).filter(|next| *next < len);
    let target = |next: &Option<Id>| next.as_ref().map_or(behind, |next| index.get(next).copied());
    match leg.as_fork().map(|fork| fork.branches) {
        Some(branches) if !branches.is_empty() => branches.iter().map(|way| target(&way.next)).collect(),
        _ => vec![target(&leg.next)],
    }
}

/// Several ways lead on from it, and none back.
fn parts(fork: usize, ways: &[Option<usize>]) -> bool {
    ways.len() > 1 && ways.iter().all(|way| way.is_none_or(|to| to > fork))
}

/// Of the legs that are `flown`, those that are so only after that branch, in the order of the list.
fn own(onwards: &[Vec<Option<usize>>], flown: &[bool], fork: usize, branch: usize) -> Vec<usize> {
    let without = reached(onwards, Some(0), Some((fork, branch)));
    let both = flown.iter().zip(without).enumerate();
    both.filter(|(_, (flown, without))| **flown && !without).map(|(index, _)| index).collect()
}

/// What is flown from a leg on, without one branch.
fn reached(
    onwards: &[Vec<Option<usize>>],
    from: Option<usize>,
    without: Option<(usize, usize)>,
) -> Vec<bool> {
    let mut reached = vec![false; onwards.len()];
    let mut open: Vec<usize> = from.into_iter().collect();
    while let Some(at) = open.pop() {
        let Some(seen) = reached.get_mut(at).filter(|seen| !**seen) else { continue };
        *seen = true;
        let ways = onwards.get(at).into_iter().flatten().enumerate();
        open.extend(ways.filter(|(branch, _)| without != Some((at, *branch))).filter_map(|(_, to)| *to));
    }
    reached
}

/// A fork with a branch called otherwise. `None`: there is no such branch.
pub fn rename_branch(plan: &FlightPlan, fork: &Id, branch: &Id, label: &str) -> Option<Edit> {
    with_branches(plan, fork, |branches| {
        label.clone_into(&mut branches.iter_mut().find(|way| way.id == *branch)?.label);
        Some(())
    })
}

/// A fork with a branch one place up (`-1`) or down (`1`) among the others. `None`: there is no place for it.
pub fn shift_branch(plan: &FlightPlan, fork: &Id, branch: &Id, by: isize) -> Option<Edit> {
    with_branches(plan, fork, |branches| {
        let at = branches.iter().position(|way| way.id == *branch)?;
        let to = at.checked_add_signed(by).filter(|to| *to < branches.len())?;
        branches.swap(at, to);
        Some(())
    })
}

/// A fork with a branch before another one of its own, or at the end. `None`: it is there already, or there is no such branch.
pub fn relocate_branch(plan: &FlightPlan, fork: &Id, branch: &Id, before: Option<&Id>) -> Option<Edit> {
    with_branches(plan, fork, |branches| {
        let from = branches.iter().position(|way| way.id == *branch)?;
        let moved = branches.remove(from);
        let to = match before {
            Some(before) if before == branch => from,
            Some(before) => branches.iter().position(|way| way.id == *before)?,
            None => branches.len(),
        };
        branches.insert(to, moved);
        (to != from).then_some(())
    })
}

/// Takes a branch and the legs that are flown on it alone out. `None`: it is the only one.
pub fn delete_branch(plan: &FlightPlan, fork: &Id, branch: &Id) -> Option<Edit> {
    let (list, index) = list_of(plan, fork)?;
    let number = list.get(index)?.as_fork()?.branches.iter().position(|way| way.id == *branch)?;
    let rest = with_branches(plan, fork, |branches| {
        branches.remove(number);
        (!branches.is_empty()).then_some(())
    })?;
    let owners = ways(list);
    let is_inside = |leg: usize| {
        let outwards = std::iter::successors(owners.get(leg).copied().flatten(), |(fork, _)| {
            owners.get(*fork).copied().flatten()
        });
        outwards.take(list.len()).any(|owner| owner == (index, number))
    };
    let inside = list.iter().enumerate().filter(|(leg, _)| is_inside(*leg));
    let deletes = inside.map(|(_, leg)| Edit::DeleteLeg { leg: leg.id.clone() });
    Some(Edit::All(std::iter::once(rest).chain(deletes).collect()))
}

/// A fork with other branches; its default is one of them.
fn with_branches(
    plan: &FlightPlan,
    fork: &Id,
    change: impl FnOnce(&mut Vec<Branch>) -> Option<()>,
) -> Option<Edit> {
    let mut changed = plan.any_leg(fork)?.clone();
    let LegKind::Intersection { branches, default, .. } = &mut changed.kind else { return None };
    change(branches)?;
    if let Some(gone) = default.as_ref().filter(|id| branches.iter().all(|way| way.id != **id)) {
        *default = branches.first().map(|first| first.id.clone()).filter(|first| first != gone);
    }
    Some(Edit::ReplaceLeg { leg: fork.clone(), with: Box::new(changed) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read;

    fn plan(legs: &str) -> FlightPlan {
        let text = format!(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="ways" aircraft="trainer"><fixes><fix id="A" lat="36" lon="-84"/></fixes>
            <mainPlan><stage id="s" type="mission">{legs}</stage></mainPlan></flightPlan>"#
        );
        let reading = read(&text);
        assert!(!reading.has_errors(), "{:?}", reading.problems);
        reading.plan
    }

    /// `leg<fork.branch` of each that is on one branch alone.
    fn owned(plan: &FlightPlan) -> String {
        let list = &plan.stages[0].legs;
        let named = |(leg, owner): (&Arc<Leg>, Option<(usize, usize)>)| {
            let (fork, branch) = owner?;
            let fork = &list[fork];
            Some(format!("{}<{}.{}", leg.id, fork.id, fork.as_fork().unwrap().branches[branch].id))
        };
        list.iter().zip(ways(list)).filter_map(named).collect::<Vec<_>>().join(" ")
    }

    const TWO: &str = r#"<TF id="a" fix="A"/><intersection id="f" default="on"><branch id="on" next="c"/><branch id="look" next="n"/></intersection>
        <TF id="n" fix="A"/><TF id="m" fix="A"/><TF id="c" fix="A"/>"#;

    #[test]
    fn legs_belong_to_the_branch_that_every_way_to_them_leads_over() {
        let fork =
            |id: &str, ways: &str| format!(r#"<intersection id="{id}" default="x">{ways}</intersection>"#);
        let leg = |id: &str| format!(r#"<TF id="{id}" fix="A"/>"#);
        assert_eq!(owned(&plan(TWO)), "n<f.look m<f.look");
        let back = leg("a") + &fork("f", r#"<branch id="x"/><branch id="again" next="a"/>"#) + &leg("b");
        assert_eq!(owned(&plan(&back)), "", "a way back is no other way on");
        let inner = fork("g", r#"<branch id="x" next="q"/><branch id="y" next="p"/>"#);
        let outer = fork("f", r#"<branch id="x" next="c"/><branch id="y" next="g"/>"#);
        let nested = leg("a") + &outer + &inner + &leg("p") + &leg("q") + &leg("c");
        assert_eq!(owned(&plan(&nested)), "g<f.y p<g.y q<f.y");
        let single = leg("a") + &fork("f", r#"<branch id="x"/>"#) + &leg("b");
        assert_eq!(owned(&plan(&single)), "");
    }

    /// It would be inside of itself, and in no tree.
    #[test]
    fn a_fork_that_nobody_comes_to_is_no_branch_of_its_own() {
        let unreached = r#"<TF id="a" fix="A" next="z"/>
            <intersection id="f" default="on"><branch id="on" next="n"/><branch id="look" next="m"/></intersection>
            <TF id="n" fix="A" next="f"/><TF id="m" fix="A" next="f"/><TF id="z" fix="A"/>"#;
        assert_eq!(owned(&plan(unreached)), "");
    }

    #[test]
    fn a_branch_goes_with_its_legs_and_the_only_one_stays() {
        let before = plan(TWO);
        let after = delete_branch(&before, &"f".into(), &"look".into()).unwrap().apply(&before).unwrap();
        let ids: Vec<&str> = after.stages[0].legs.iter().map(|leg| leg.id.as_str()).collect();
        assert_eq!(ids, ["a", "f", "c"]);
        assert_eq!(delete_branch(&after, &"f".into(), &"on".into()), None);
        let other = delete_branch(&before, &"f".into(), &"on".into()).unwrap().apply(&before).unwrap();
        let fork = other.any_leg(&"f".into()).unwrap().as_fork().unwrap();
        assert_eq!((fork.branches.len(), fork.default.unwrap().as_str()), (1, "look"));
    }

    #[test]
    fn a_branch_is_renamed_and_moved() {
        let before = plan(TWO);
        let apply = |edit: Option<Edit>| edit.unwrap().apply(&before).unwrap();
        let named = apply(rename_branch(&before, &"f".into(), &"look".into(), "Close look"));
        assert_eq!(named.branch_label(&"f".into(), &"look".into()), "Close look");
        let moved = apply(shift_branch(&before, &"f".into(), &"look".into(), -1));
        assert_eq!(moved.any_leg(&"f".into()).unwrap().as_fork().unwrap().branches[0].id.as_str(), "look");
        assert_eq!(shift_branch(&before, &"f".into(), &"look".into(), 1), None);
        let relocated = |branch: &str, to: Option<&str>| {
            relocate_branch(&before, &"f".into(), &branch.into(), to.map(Id::new).as_ref())
        };
        assert_eq!(apply(relocated("look", Some("on"))), moved);
        assert_eq!(apply(relocated("on", None)), moved);
        for (branch, to) in [("on", Some("look")), ("look", None), ("look", Some("look")), ("none", None)] {
            assert_eq!(relocated(branch, to), None, "{branch} {to:?}");
        }
    }
}
