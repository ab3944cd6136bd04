//! Ways on from a fork, drawn leg by leg; and legs put between others without losing where those lead.

use super::arrange::list_of;
use super::kind::LegChoice;
use super::leave::Leaving;
use super::leg::{Drawn, leg as new_leg};
use super::rearrange::lead_to;
use super::ways::ways;
use crate::{Branch, Edit, FlightPlan, Id, Leg, LegKind, Spot};
use aircraft::Profile;
use std::sync::Arc;

/// What the name of a branch begins with that leads past legs, and its identifier.
pub(super) const SKIP: &str = "Skip ";
pub(super) const SKIP_ID: &str = "skip";

/// Which way on from a fork.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Way {
    /// One of its branches.
    Branch(Id),
    /// A branch that is made for it.
    New,
}

impl Leg {
    /// Some way from it leads to what follows it in its list.
    pub fn falls_through(&self) -> bool {
        let ways = self.as_fork().map_or(&[][..], |fork| fork.branches);
        ways.iter().any(|way| way.next.is_none()) || (ways.is_empty() && self.next.is_none())
    }
}

/// Puts a leg where it goes. Behind a leg that says what follows it, the new one leads there instead; before one that is only led
/// to by name, those ways lead to the new one.
pub fn insert(plan: &FlightPlan, mut leg: Leg, at: Spot) -> Edit {
    let mut edits = match &at {
        Spot::After(id) => match plan.any_leg(id).filter(|before| before.next.is_some()) {
            Some(before) => {
                leg.next.clone_from(&before.next);
                let freed = Box::new(Leg { next: None, ..before.clone() });
                vec![Edit::ReplaceLeg { leg: before.id.clone(), with: freed }]
            }
            None => Vec::new(),
        },
        Spot::Before(id) => lead_to(plan, id, &leg.id, &|_| false),
        Spot::EndOf(_) => Vec::new(),
    };
    let insert = Edit::InsertLeg { leg: Box::new(leg), at };
    if edits.is_empty() {
        return insert;
    }
    edits.push(insert);
    Edit::All(edits)
}

/// Takes a leg out. What led to it leads to what followed it.
pub fn delete_leg(plan: &FlightPlan, id: &Id) -> Edit {
    let delete = Edit::DeleteLeg { leg: id.clone() };
    let Some(leaving) = Leaving::of(plan, [id]) else { return delete };
    let mut edits = leaving.heal().edits;
    edits.push(delete);
    Edit::All(edits)
}

/// A leg at the beginning of a way on from a fork; behind any other leg, a fork is made for it. A new way leads back to where
/// the flight goes on without a decision. `None`: there is no such leg or branch.
pub fn begin_way(plan: &FlightPlan, from: &Id, way: &Way, mut leg: Leg) -> Option<Edit> {
    let (list, index) = list_of(plan, from)?;
    let (before, behind) = (list.get(index)?, list.get(index + 1).map(|leg| leg.id.clone()));
    let (mut fork, mut edits) = (before.as_ref().clone(), Vec::new());
    if fork.as_fork().is_none() {
        fork = new_leg(plan, &Profile::default(), LegChoice::Intersection, &Drawn::Nothing, None, None)?;
        edits.push(insert(plan, fork.clone(), Spot::After(from.clone())));
    }
    fork.next = None;
    // where a branch leads that names nothing: ways that end with the list meet in a merge
    let follower = before.next.clone().or(behind.clone()).unwrap_or_else(|| plan.unique_id("merge"));
    let ways = ways_of(&mut fork, &follower)?;
    let is_empty = |branch: &Branch| !has_own_legs(list, index, branch);
    let target = turn_to((&mut *ways.0, ways.1), way, &leg, is_empty)?;
    let merges = ways.0.iter().any(|branch| branch.next.as_ref() == Some(&follower)) || target == follower;
    let merge =
        (behind.is_none() && before.next.is_none() && merges).then(|| merge(plan, follower)).flatten();
    // it stands right behind the fork, before what followed that
    let behind = behind.or_else(|| merge.as_ref().map(|merge| merge.id.clone()));
    leg.next = Some(target).filter(|target| Some(target) != behind.as_ref());
    let (fork_id, leg_id) = (fork.id.clone(), leg.id.clone());
    edits.push(Edit::ReplaceLeg { leg: fork_id.clone(), with: Box::new(fork) });
    edits.push(Edit::InsertLeg { leg: Box::new(leg), at: Spot::After(fork_id) });
    edits.extend(merge.map(|merge| Edit::InsertLeg { leg: Box::new(merge), at: Spot::After(leg_id) }));
    Some(Edit::All(edits))
}

/// The branches of a fork and its default.
type Ways<'a> = (&'a mut Vec<Branch>, Option<&'a Id>);

/// Every branch says where it leads; there is one at least.
fn ways_of<'a>(fork: &'a mut Leg, follower: &Id) -> Option<Ways<'a>> {
    let LegKind::Intersection { branches, default, .. } = &mut fork.kind else { return None };
    if branches.is_empty() {
        branches.push(Branch { id: Id::new("on"), label: "Go on".into(), next: None, when: None });
        *default = Some(Id::new("on"));
    }
    for branch in branches.iter_mut() {
        branch.next.get_or_insert_with(|| follower.clone());
    }
    Some((branches, default.as_ref()))
}

/// Lets a way begin with a leg; gives where that leg leads. The first leg of a branch that nobody has named gives it its name.
fn turn_to(
    (branches, default): Ways<'_>,
    way: &Way,
    leg: &Leg,
    is_empty: impl Fn(&Branch) -> bool,
) -> Option<Id> {
    if let Way::Branch(id) = way {
        let branch = branches.iter_mut().find(|branch| branch.id == *id)?;
        if is_unnamed(branch) && is_empty(branch) {
            branch.label = called_after(leg);
        }
        return branch.next.replace(leg.id.clone());
    }
    let on = branches.iter().find(|branch| Some(&branch.id) == default).or(branches.first())?;
    let target = on.next.clone();
    branches.push(other_way(branches, leg.id.clone()));
    target
}

/// The leg's name, or else what it is: its identifier stands beside the branch, which leads there.
fn called_after(leg: &Leg) -> String {
    if leg.name.is_empty() { LegChoice::of(&leg.kind).label().into() } else { leg.name.clone() }
}

/// One more way on from a fork, to there.
pub(super) fn other_way(branches: &[Branch], to: Id) -> Branch {
    let is_free = |n: &usize| branches.iter().all(|branch| branch.id != way_id(*n));
    // one more candidate than there are branches: one of them is free
    let first = branches.len() + 1;
    let number = (first..=2 * first).find(is_free).unwrap_or(first);
    Branch { id: way_id(number), label: way_name(number), next: Some(to), when: None }
}

fn way_id(number: usize) -> Id {
    Id::new(&format!("way{number}"))
}

fn way_name(number: usize) -> String {
    format!("Way {number}")
}

/// It has the name that it was made with.
fn is_unnamed(branch: &Branch) -> bool {
    let number = branch.id.as_str().strip_prefix("way").and_then(|number| number.parse().ok());
    number.is_some_and(|number| branch.label == way_name(number))
        || (branch.id.as_str() == SKIP_ID && branch.label.starts_with(SKIP))
}

/// Legs are flown on it alone.
fn has_own_legs(list: &[Arc<Leg>], fork: usize, branch: &Branch) -> bool {
    let branches = list.get(fork).and_then(|leg| leg.as_fork()).map_or(&[][..], |fork| fork.branches);
    let number = branches.iter().position(|other| other.id == branch.id);
    number.is_some_and(|number| ways(list).contains(&Some((fork, number))))
}

/// An intersection where ways meet again.
pub(super) fn merge(plan: &FlightPlan, id: Id) -> Option<Leg> {
    let mut made = new_leg(plan, &Profile::default(), LegChoice::Intersection, &Drawn::Nothing, None, None)?;
    if let LegKind::Intersection { branches, default, .. } = &mut made.kind {
        branches.clear();
        *default = None;
    }
    Some(Leg { id, ..made })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{check, read};
    use terrain::Flat;

    fn plan(legs: &str) -> FlightPlan {
        let text = format!(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><fixes><fix id="A" lat="36" lon="-84"/><fix id="B" lat="36.03" lon="-84"/>
            <fix id="C" lat="36.03" lon="-84.03"/></fixes><mainPlan><stage id="s" type="mission" altitude="600" altitudeReference="amsl">{legs}</stage></mainPlan></flightPlan>"#
        );
        let reading = read(&text);
        assert!(!reading.has_errors(), "{:?}", reading.problems);
        reading.plan
    }

    fn drawn(id: &str) -> Leg {
        let mut leg = plan(r#"<TF id="x" fix="C"/>"#).leg(&"x".into()).unwrap().leg.clone();
        leg.id = id.into();
        leg
    }

    /// The legs in their order, each with where it says that it leads.
    fn ways(plan: &FlightPlan) -> Vec<String> {
        let said = |next: &Option<Id>| next.as_ref().map_or(String::new(), |next| format!(">{next}"));
        let leg = |leg: &std::sync::Arc<Leg>| {
            let branches = leg.as_fork().map_or(&[][..], |fork| fork.branches);
            let branches: String = branches.iter().map(|b| format!(" {}{}", b.id, said(&b.next))).collect();
            format!("{}{}{branches}", leg.id, said(&leg.next))
        };
        plan.stages[0].legs.iter().map(leg).collect()
    }

    fn errors(plan: &FlightPlan) -> Vec<String> {
        let problems = check(plan, &Profile::default(), &Flat(200.0));
        let ours = ["unknown-", "duplicate", "unreachable", "next"];
        let is_ours = |p: &&crate::Problem| p.is_error() && ours.iter().any(|code| p.code.contains(code));
        problems.iter().filter(is_ours).map(ToString::to_string).collect()
    }

    const ROUTE: &str = r#"<IF id="a" fix="A"/><TF id="b" fix="B"/><TF id="c" fix="A"/>"#;

    #[test]
    fn a_new_way_leaves_behind_a_leg_and_meets_the_old_one_again() {
        let plan = plan(ROUTE);
        let forked = begin_way(&plan, &"b".into(), &Way::New, drawn("n1")).unwrap().apply(&plan).unwrap();
        assert_eq!(ways(&forked), ["a", "b", "fork1 on>c way2>n1", "n1", "c"]);
        let longer = insert(&forked, drawn("n2"), Spot::After("n1".into())).apply(&forked).unwrap();
        let third = begin_way(&longer, &"fork1".into(), &Way::New, drawn("m1")).unwrap();
        let third = third.apply(&longer).unwrap();
        assert_eq!(ways(&third), ["a", "b", "fork1 on>c way2>n1 way3>m1", "m1>c", "n1", "n2", "c"]);
        let longer = insert(&third, drawn("m2"), Spot::After("m1".into())).apply(&third).unwrap();
        assert_eq!(ways(&longer)[3..], ["m1", "m2>c", "n1", "n2", "c"], "the last one leads back");
        assert_eq!(errors(&longer), Vec::<String>::new());
    }

    #[test]
    fn a_leg_is_put_at_the_beginning_of_a_way() {
        let plan = plan(ROUTE);
        let forked = begin_way(&plan, &"b".into(), &Way::New, drawn("n1")).unwrap().apply(&plan).unwrap();
        let way = Way::Branch("on".into());
        let both = begin_way(&forked, &"fork1".into(), &way, drawn("o1")).unwrap().apply(&forked).unwrap();
        assert_eq!(ways(&both), ["a", "b", "fork1 on>o1 way2>n1", "o1>c", "n1", "c"]);
        assert_eq!(errors(&both), Vec::<String>::new());
        assert!(begin_way(&both, &"fork1".into(), &Way::Branch("no".into()), drawn("x1")).is_none());
    }

    fn label(plan: &FlightPlan, fork: &str, branch: &str) -> String {
        let branch = Id::new(branch);
        plan.branch_label(&fork.into(), &branch).to_owned()
    }

    /// Until somebody names it; what is drawn before its first leg is no reason to call it otherwise.
    #[test]
    fn a_branch_is_called_after_the_first_leg_that_is_drawn_into_it() {
        let plan = plan(ROUTE);
        let (fork, edit) = super::super::fork_around(&plan, &["b".into()]).unwrap();
        let forked = edit.apply(&plan).unwrap();
        assert_eq!(label(&forked, fork.as_str(), "skip"), "Skip b");
        let skip = Way::Branch("skip".into());
        let close = Leg { name: "Close look".into(), ..drawn("n1") };
        let drawn_into = begin_way(&forked, &fork, &skip, close).unwrap().apply(&forked).unwrap();
        assert_eq!(label(&drawn_into, fork.as_str(), "skip"), "Close look");
        let more = begin_way(&drawn_into, &fork, &skip, drawn("n2")).unwrap().apply(&drawn_into).unwrap();
        assert_eq!(label(&more, fork.as_str(), "skip"), "Close look");
        let named = super::super::rename_branch(&forked, &fork, &"skip".into(), "Past").unwrap();
        let named = named.apply(&forked).unwrap();
        let kept = begin_way(&named, &fork, &skip, drawn("n1")).unwrap().apply(&named).unwrap();
        assert_eq!(label(&kept, fork.as_str(), "skip"), "Past");
    }

    #[test]
    fn a_fork_behind_a_leg_leads_on_as_before_until_something_is_drawn_into_its_other_way() {
        let plan = plan(ROUTE);
        for (leg, forked, drawn_into) in [
            ("b", "a b fork1 on>c way2>c c", "a b fork1 on>c way2>n1 n1 c"),
            ("c", "a b c fork1 on>merge way2>merge merge", "a b c fork1 on>merge way2>n1 n1 merge"),
        ] {
            let (fork, edit) = super::super::fork_behind(&plan, &leg.into()).unwrap();
            let made = edit.apply(&plan).unwrap();
            assert_eq!(ways(&made).join(" "), forked);
            assert_eq!(errors(&made), Vec::<String>::new());
            assert_eq!(label(&made, "fork1", "way2"), "Way 2");
            let way = Way::Branch("way2".into());
            let drawn = begin_way(&made, &fork, &way, drawn("n1")).unwrap().apply(&made).unwrap();
            assert_eq!(ways(&drawn).join(" "), drawn_into);
            assert_eq!(errors(&drawn), Vec::<String>::new());
            assert_eq!(label(&drawn, "fork1", "way2"), "Track to a fix");
            assert!(super::super::fork_behind(&made, &fork).is_none(), "it is a fork itself");
        }
    }

    #[test]
    fn a_leg_before_the_first_of_a_way_becomes_the_first() {
        let plan = plan(ROUTE);
        let forked = begin_way(&plan, &"b".into(), &Way::New, drawn("n1")).unwrap().apply(&plan).unwrap();
        let third = begin_way(&forked, &"fork1".into(), &Way::New, drawn("m1")).unwrap();
        let third = third.apply(&forked).unwrap();
        let longer = insert(&third, drawn("x1"), Spot::Before("n1".into())).apply(&third).unwrap();
        assert_eq!(ways(&longer)[2..], ["fork1 on>c way2>x1 way3>m1", "m1>c", "x1", "n1", "c"]);
        assert_eq!(errors(&longer), Vec::<String>::new());
    }

    #[test]
    fn ways_from_the_last_leg_meet_in_a_merge() {
        let plan = plan(ROUTE);
        let forked = begin_way(&plan, &"c".into(), &Way::New, drawn("n1")).unwrap().apply(&plan).unwrap();
        assert_eq!(ways(&forked), ["a", "b", "c", "fork1 on>merge way2>n1", "n1", "merge"]);
        assert_eq!(errors(&forked), Vec::<String>::new());
    }

    #[test]
    fn what_led_to_a_leg_that_is_taken_out_leads_on() {
        let plan = plan(ROUTE);
        let forked = begin_way(&plan, &"b".into(), &Way::New, drawn("n1")).unwrap().apply(&plan).unwrap();
        let without = delete_leg(&forked, &"n1".into()).apply(&forked).unwrap();
        assert_eq!(ways(&without), ["a", "b", "fork1 on>c way2>c", "c"]);
        assert_eq!(errors(&without), Vec::<String>::new());
        // the last leg of a way, with another way behind it in the list
        let third = begin_way(&forked, &"fork1".into(), &Way::New, drawn("m1")).unwrap();
        let third = third.apply(&forked).unwrap();
        let longer = insert(&third, drawn("m2"), Spot::After("m1".into())).apply(&third).unwrap();
        let without = delete_leg(&longer, &"m2".into()).apply(&longer).unwrap();
        assert_eq!(ways(&without)[2..], ["fork1 on>c way2>n1 way3>m1", "m1>c", "n1", "c"]);
    }
}
