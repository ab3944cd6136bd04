//! Legs and stages that are there, taken elsewhere, several at once: what a drag in the tree of the plan does.

use super::arrange::list_of;
use super::leave::Leaving;
use super::{every_leg, legs_in};
use crate::clipboard::outermost;
use crate::{Branch, Edit, FlightPlan, Id, Leg, LegKind, Spot};
use std::collections::HashSet;
use std::sync::Arc;

/// A place in a list of stages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StageSpot {
    /// Before a stage.
    Before(Id),
    /// At the end of an emergency plan; `None`: of the main plan.
    EndOf(Option<Id>),
}

/// Takes legs elsewhere in one step, in their order in the plan; those in a loop that is one of them go with it. `None`: they are there
/// already.
///
/// # Errors
/// A sentence that says why they can't be there, and what to do.
pub fn relocate(plan: &FlightPlan, legs: &[Id], at: &Spot) -> Result<Option<Edit>, String> {
    let moved = in_order(plan, legs);
    let (list, index) = list_at(plan, at).ok_or("There is no such place any more: choose another.")?;
    if let Some(around) = moved.iter().find(|leg| is_inside(leg, at)) {
        return Err(into_itself(around));
    }
    let ids: HashSet<&Id> = moved.iter().map(|leg| &leg.id).collect();
    let stays = |leg: &&Arc<Leg>| !ids.contains(&leg.id);
    let (before, after) = list.split_at(index.min(list.len()));
    let order = before.iter().filter(stays).chain(moved.iter().copied()).chain(after.iter().filter(stays));
    if order.map(|leg| &leg.id).eq(list.iter().map(|leg| &leg.id)) {
        return Ok(None);
    }
    let mut edits = leave(plan, &moved, list)?;
    let healed = Edit::All(edits.clone()).apply(plan).map_err(|error| error.to_string())?;
    edits.extend(join(&healed, &moved, at));
    let next = after.iter().find(stays).map(|leg| Spot::Before(leg.id.clone()));
    let last = || before.iter().rfind(stays).map(|leg| Spot::After(leg.id.clone()));
    edits.extend(moves(&moved, next.or_else(last).unwrap_or_else(|| at.clone())));
    Ok(Some(Edit::All(edits)))
}

/// Takes legs to a place, one behind the other.
fn moves(moved: &[&Arc<Leg>], at: Spot) -> Vec<Edit> {
    let mut spot = at;
    let mut edits = Vec::new();
    for leg in moved {
        let behind = Spot::After(leg.id.clone());
        edits.push(Edit::MoveLeg { leg: leg.id.clone(), at: std::mem::replace(&mut spot, behind) });
    }
    edits
}

/// What follows at a place: behind a leg that says what follows it, the last of those that come leads there instead; and to a leg
/// that is only led to by name, those ways lead to the first of them.
fn join(plan: &FlightPlan, moved: &[&Arc<Leg>], at: &Spot) -> Vec<Edit> {
    let is_moved = |id: &Id| moved.iter().any(|leg| leg.id == *id);
    match at {
        Spot::EndOf(_) => Vec::new(),
        Spot::After(id) => {
            let before = plan.any_leg(id).filter(|leg| leg.next.is_some() && !is_moved(id));
            let last = moved.last().and_then(|last| plan.any_leg(&last.id));
            let Some((before, last)) = before.zip(last.filter(|last| last.as_fork().is_none())) else {
                return Vec::new();
            };
            let (freed, led) = (Leg { next: None, ..before.clone() }, before.next.clone());
            vec![replaced(freed), replaced(Leg { next: led, ..last.clone() })]
        }
        Spot::Before(id) => moved.first().map_or(Vec::new(), |first| lead_to(plan, id, &first.id, &is_moved)),
    }
}

/// To a leg that is only led to by name, those ways lead to another one from then on.
pub(super) fn lead_to(plan: &FlightPlan, leg: &Id, first: &Id, is_moved: &dyn Fn(&Id) -> bool) -> Vec<Edit> {
    let Some((list, index)) = list_of(plan, leg) else { return Vec::new() };
    let mut before = list.iter().take(index).filter(|other| !is_moved(&other.id));
    if before.next_back().is_none_or(|other| other.falls_through()) {
        return Vec::new();
    }
    let leading = list.iter().filter(|other| !is_moved(&other.id) && leads_to(other).contains(&leg));
    leading.map(|other| replaced(led_to(other, leg, first))).collect()
}

pub(super) fn replaced(with: Leg) -> Edit {
    Edit::ReplaceLeg { leg: with.id.clone(), with: Box::new(with) }
}

/// A leg whose ways lead to another one than they did.
pub(super) fn led_to(leg: &Leg, from: &Id, to: &Id) -> Leg {
    let mut led = leg.clone();
    let lead = |next: &mut Option<Id>| {
        if next.as_ref() == Some(from) {
            *next = Some(to.clone());
        }
    };
    if let LegKind::Intersection { branches, .. } = &mut led.kind {
        branches.iter_mut().for_each(|way| lead(&mut way.next));
    }
    lead(&mut led.next);
    led
}

/// The same to the beginning of a fork's branch, which leads on as before; the other ways stay as they are.
///
/// # Errors
/// As for [`relocate`].
pub fn into_branch(plan: &FlightPlan, legs: &[Id], fork: &Id, branch: &Id) -> Result<Option<Edit>, String> {
    let moved = in_order(plan, legs);
    let is_moved = |leg: &Leg| moved.iter().any(|moved| moved.id == leg.id);
    let (Some((list, index)), Some(first)) = (list_of(plan, fork), moved.first()) else { return Ok(None) };
    let Some(whole) = list.get(index).filter(|leg| !is_moved(leg)) else {
        return Err("A fork can't be put into its own branch: choose another place.".into());
    };
    if let Some(around) = moved.iter().find(|leg| is_inside(leg, &Spot::Before(fork.clone()))) {
        return Err(into_itself(around));
    }
    let on = list.get(index + 1).map(|leg| &leg.id);
    let Some(way) = way_of(whole, branch) else { return Ok(None) };
    if way.next.as_ref().or(on).is_some_and(|target| moved.iter().any(|leg| leg.id == *target)) {
        return Ok(None);
    }
    let mut edits = leave(plan, &moved, list)?;
    let healed = Edit::All(edits.clone()).apply(plan).map_err(|error| error.to_string())?;
    // they are still where they were, but nothing leads to them
    let Some((list, index)) = list_of(&healed, fork) else { return Ok(None) };
    let Some((whole, way)) = list.get(index).and_then(|whole| Some((whole, way_of(whole, branch)?))) else {
        return Ok(None);
    };
    let on = list.iter().skip(index + 1).find(|leg| !is_moved(leg)).map(|leg| &leg.id);
    let Some(target) = way.next.as_ref().or(on) else {
        edits.extend(moves(&moved, Spot::After(fork.clone())));
        return Ok(Some(Edit::All(edits)));
    };
    let Some(at) = list.iter().position(|leg| leg.id == *target) else {
        return Err("The branch leads nowhere: give it a leg first.".into());
    };
    // what came to the branch's leg from before it in the list says so, or it would come to the new one
    let before = list.get(..at).and_then(|before| before.iter().rfind(|leg| !is_moved(leg)));
    if let Some(before) = before.filter(|before| before.id != *fork) {
        edits.extend(pinned(before, target, None));
    }
    edits.extend(pinned(whole, on.unwrap_or(target), Some((branch, &first.id))));
    edits.extend(moves(&moved, Spot::Before(target.clone())));
    Ok(Some(Edit::All(edits)))
}

fn way_of<'a>(fork: &'a Leg, branch: &Id) -> Option<&'a Branch> {
    fork.as_fork()?.branches.iter().find(|way| way.id == *branch)
}

fn into_itself(around: &Leg) -> String {
    format!("{} can't be put into itself: choose a place outside it.", label(around))
}

/// Takes legs of one list past their neighbour: up (`-1`) or down (`1`). `None`: there is none, or they are of several lists.
pub fn shift_legs(plan: &FlightPlan, legs: &[Id], by: isize) -> Option<Edit> {
    let moved = in_order(plan, legs);
    let (list, _) = list_of(plan, &moved.first()?.id)?;
    let places = moved.iter().map(|leg| list.iter().position(|other| other.id == leg.id));
    let places: Vec<usize> = places.collect::<Option<_>>()?;
    let edge = if by < 0 { places.first() } else { places.last() };
    let neighbour = list.get(edge?.checked_add_signed(by)?)?.id.clone();
    relocate(plan, legs, &if by < 0 { Spot::Before(neighbour) } else { Spot::After(neighbour) }).ok()?
}

/// Legs that can be moved among their neighbours together: all of them are in one stage, loop or procedure.
pub fn are_neighbours(plan: &FlightPlan, legs: &[Id]) -> bool {
    let moved = in_order(plan, legs);
    let list = moved.first().and_then(|first| list_of(plan, &first.id));
    list.is_some_and(|(list, _)| moved.iter().all(|leg| list.iter().any(|other| other.id == leg.id)))
}

/// Takes a stage elsewhere. `None`: it is there already.
pub fn relocate_stage(plan: &FlightPlan, stage: &Id, at: &StageSpot) -> Option<Edit> {
    let mut lists = std::iter::once(&plan.stages).chain(plan.emergency_plans.iter().map(|e| &e.stages));
    let (list, index) = lists.find_map(|l| Some((l, l.iter().position(|s| s.id == *stage)?)))?;
    let next = list.get(index + 1);
    match at {
        StageSpot::Before(other) if other == stage || next.is_some_and(|next| next.id == *other) => None,
        StageSpot::Before(before) => Some(Edit::MoveStage { stage: stage.clone(), before: before.clone() }),
        StageSpot::EndOf(to) => {
            let there = match to {
                None => &plan.stages,
                Some(id) => &plan.emergency_plan(id)?.stages,
            };
            let is_last = there.last().is_some_and(|last| last.id == *stage);
            let moved = Box::new(list.get(index)?.clone());
            let append = Edit::AppendStage { to: to.clone(), stage: moved };
            (!is_last).then(|| Edit::All(vec![Edit::Remove { id: stage.clone() }, append]))
        }
    }
}

/// Takes a fix, runway, variable, zone, procedure or emergency plan before another one of its list, or (`None`) to its end.
/// `None`: it is there already, or the other is not of its list.
pub fn relocate_thing(plan: &FlightPlan, id: &Id, before: Option<&Id>) -> Option<Edit> {
    let list = list_of_things(plan, id)?;
    let index = list.iter().position(|other| *other == id)?;
    let next = list.get(index + 1).copied();
    let is_there = before == Some(id) || before == next;
    let is_possible = before.is_none_or(|before| list.contains(&before));
    (is_possible && !is_there).then(|| Edit::MoveThing { id: id.clone(), before: before.cloned() })
}

/// The same past its neighbour: up (`-1`) or down (`1`).
pub fn shift_thing(plan: &FlightPlan, id: &Id, by: isize) -> Option<Edit> {
    let list = list_of_things(plan, id)?;
    let to = list.iter().position(|other| *other == id)?.checked_add_signed(by)?;
    list.get(to)?;
    let before = if by < 0 { to } else { to + 1 };
    relocate_thing(plan, id, list.get(before).copied())
}

fn list_of_things<'a>(plan: &'a FlightPlan, id: &Id) -> Option<Vec<&'a Id>> {
    let lists: [Vec<&Id>; 6] = [
        plan.fixes.iter().map(|f| &f.id).collect(),
        plan.runways.iter().map(|r| &r.id).collect(),
        plan.zones.iter().map(|z| &z.id).collect(),
        plan.procedures.iter().map(|p| &p.id).collect(),
        plan.emergency_plans.iter().map(|e| &e.id).collect(),
        plan.variables.iter().map(|v| &v.name).collect(),
    ];
    lists.into_iter().find(|list| list.contains(&id))
}

/// The legs that are meant, in the order of the plan.
fn in_order<'a>(plan: &'a FlightPlan, legs: &[Id]) -> Vec<&'a Arc<Leg>> {
    let outer: HashSet<&Id> = outermost(plan, legs).into_iter().collect();
    every_leg(plan).into_iter().filter(|leg| outer.contains(&leg.id)).collect()
}

/// The list of a place, and the index there.
fn list_at<'a>(plan: &'a FlightPlan, at: &Spot) -> Option<(&'a [Arc<Leg>], usize)> {
    match at {
        Spot::Before(id) => list_of(plan, id),
        Spot::After(id) => list_of(plan, id).map(|(list, index)| (list, index + 1)),
        Spot::EndOf(id) => {
            let list = match (plan.stage(id), plan.procedure(id)) {
                (Some(stage), _) => stage.legs.as_slice(),
                (None, Some(procedure)) => procedure.legs.as_slice(),
                (None, None) => plan.any_leg(id)?.body(),
            };
            Some((list, list.len()))
        }
    }
}

fn is_inside(leg: &Leg, at: &Spot) -> bool {
    let (Spot::Before(id) | Spot::After(id) | Spot::EndOf(id)) = at;
    let itself = matches!(at, Spot::EndOf(_)) && leg.id == *id;
    itself || legs_in(leg.body()).iter().any(|inner| inner.id == *id)
}

/// What must change for legs to leave their places: what led to them leads to what followed them, and they lead on from where they
/// come to. A way that would lead from one list into another is refused.
fn leave(plan: &FlightPlan, moved: &[&Arc<Leg>], to: &[Arc<Leg>]) -> Result<Vec<Edit>, String> {
    let is_moved = |id: &Id| moved.iter().any(|leg| leg.id == *id);
    let mut edits = Vec::new();
    let mut lists: Vec<&[Arc<Leg>]> =
        moved.iter().filter_map(|leg| Some(list_of(plan, &leg.id)?.0)).collect();
    lists.dedup_by(|a, b| std::ptr::eq(*a, *b));
    for from in lists {
        let going = from.iter().map(|leg| &leg.id).filter(|id| is_moved(id));
        let Some(left) = Leaving::of(plan, going).map(|leaving| leaving.heal()) else { continue };
        if let Some((other, target)) = left.astray.filter(|_| !std::ptr::eq(from, to)) {
            return Err(format!(
                "{} leads to {}, nothing follows that, and both must be in one list: lead it elsewhere first, or take both along.",
                label(other),
                plan.label(&target)
            ));
        }
        edits.extend(left.edits);
    }
    for leg in moved {
        let stays = list_of(plan, &leg.id).is_some_and(|(from, _)| std::ptr::eq(from, to));
        let ways = leg.as_fork().map_or(&[][..], |fork| fork.branches);
        let behind = ways.iter().find(|way| way.next.as_ref().is_some_and(|next| !is_moved(next)));
        if let Some(way) = behind.filter(|_| !stays) {
            return Err(format!(
                "The branch {} of {} leads to a leg that would stay behind: take it along.",
                if way.label.is_empty() { way.id.as_str() } else { &way.label },
                label(leg)
            ));
        }
        if leg.next.as_ref().is_some_and(|next| !is_moved(next)) {
            let with = Box::new(Leg { next: None, ..leg.as_ref().clone() });
            edits.push(Edit::ReplaceLeg { leg: leg.id.clone(), with });
        }
    }
    Ok(edits)
}

/// The legs that a leg names as what follows it.
pub(super) fn leads_to(leg: &Leg) -> Vec<&Id> {
    let ways = leg.as_fork().map_or(&[][..], |fork| fork.branches);
    ways.iter().filter_map(|way| way.next.as_ref()).chain(&leg.next).collect()
}

/// A leg of which every way that goes on in the list goes on to `target` by name; one branch to a leg of its own.
fn pinned(leg: &Arc<Leg>, target: &Id, branch: Option<(&Id, &Id)>) -> Option<Edit> {
    let mut pinned = leg.as_ref().clone();
    if let LegKind::Intersection { branches, .. } = &mut pinned.kind {
        for way in branches {
            match branch {
                Some((id, to)) if way.id == *id => way.next = Some(to.clone()),
                _ => drop(way.next.get_or_insert_with(|| target.clone())),
            }
        }
    } else {
        pinned.next.get_or_insert_with(|| target.clone());
    }
    (pinned != **leg).then(|| Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(pinned) })
}

/// What people call a leg.
fn label(leg: &Leg) -> &str {
    if leg.name.is_empty() { leg.id.as_str() } else { &leg.name }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAN: &str = r#"<flightPlan version="1" id="p">
      <fixes><fix id="A" at="46.0 8.0"/></fixes>
      <mainPlan>
        <stage id="one" type="mission">
          <TF id="a" fix="A"/><TF id="b" fix="A"/>
          <iterative id="loop" form="forward" count="2"><TF id="in1" fix="A"/><TF id="in2" fix="A"/></iterative>
          <TF id="c" fix="A"/>
        </stage>
        <stage id="two" type="mission">
          <intersection id="fork"><branch id="on"/><branch id="past" next="z"/></intersection>
          <TF id="x" fix="A"/><TF id="y" fix="A"/><TF id="z" fix="A"/>
        </stage>
        <stage id="empty" type="mission"></stage>
      </mainPlan></flightPlan>"#;

    fn plan() -> FlightPlan {
        let plan = crate::read(PLAN.as_bytes()).plan;
        assert_eq!(every_leg(&plan).len(), 10, "{plan:?}");
        plan
    }

    fn ids(legs: &[&str]) -> Vec<Id> {
        legs.iter().map(|id| Id::new(id)).collect()
    }

    /// The legs of every list after it, as `a b loop(in1 in2) c / fork …`; or why not.
    fn after(legs: &[&str], at: &Spot) -> String {
        shown(relocate(&plan(), &ids(legs), at))
    }

    fn shown(edit: Result<Option<Edit>, String>) -> String {
        fn list(legs: &[Arc<Leg>]) -> String {
            let leg = |leg: &Arc<Leg>| match leg.as_loop() {
                Some(_) => format!("{}({})", leg.id, list(leg.body())),
                None => leg.id.to_string(),
            };
            legs.iter().map(leg).collect::<Vec<_>>().join(" ")
        }
        match edit {
            Err(why) => why,
            Ok(None) => "nothing".into(),
            Ok(Some(edit)) => {
                let plan = edit.apply(&plan()).unwrap();
                plan.stages.iter().map(|stage| list(&stage.legs)).collect::<Vec<_>>().join(" / ")
            }
        }
    }

    #[test]
    fn legs_go_where_they_are_dropped_in_their_own_order() {
        let before = |id: &str| Spot::Before(id.into());
        let behind = |id: &str| Spot::After(id.into());
        let end = |id: &str| Spot::EndOf(id.into());
        let two = "fork x y z";
        let cases = [
            (&["c", "a"][..], before("b"), format!("a c b loop(in1 in2) / {two} / ")),
            (&["a", "b"], before("b"), "nothing".into()),
            (&["a"], before("a"), "nothing".into()),
            (&["a", "c"], behind("loop"), format!("b loop(in1 in2) a c / {two} / ")),
            (&["a", "b"], before("in2"), format!("loop(in1 a b in2) c / {two} / ")),
            (&["in1", "loop"], end("empty"), format!("a b c / {two} / loop(in1 in2)")),
            (&["in1", "in2"], end("one"), format!("a b loop() c in1 in2 / {two} / ")),
            (&["c"], end("one"), "nothing".into()),
            (&["fork", "x", "y", "z"], end("loop"), "a b loop(in1 in2 fork x y z) c /  / ".into()),
        ];
        for (legs, at, expected) in cases {
            assert_eq!(after(legs, &at), expected, "{legs:?} {at:?}");
        }
    }

    #[test]
    fn a_set_is_taken_past_its_neighbour() {
        let past = |legs: &[&str], by| Some(shown(Ok(Some(shift_legs(&plan(), &ids(legs), by)?))));
        assert_eq!(past(&["y", "z"], -1).as_deref(), Some("a b loop(in1 in2) c / fork y z x / "));
        assert_eq!(past(&["a", "b"], 1).as_deref(), Some("loop(in1 in2) a b c / fork x y z / "));
        assert_eq!(past(&["y", "z"], 1), None, "they are last");
        assert_eq!(past(&["a", "x"], 1), None, "of two lists");
    }

    #[test]
    fn a_drop_that_would_break_the_plan_says_why() {
        let into_itself = after(&["a", "loop"], &Spot::After("in1".into()));
        assert!(into_itself.contains("loop can't be put into itself"), "{into_itself}");
        let target = after(&["z"], &Spot::EndOf("one".into()));
        assert!(target.contains("fork leads to z"), "{target}");
        let fork = after(&["fork"], &Spot::EndOf("one".into()));
        assert!(fork.contains("branch past of fork"), "{fork}");
        assert!(after(&["a"], &Spot::Before("gone".into())).contains("choose another"));
    }

    #[test]
    fn a_branch_begins_with_what_is_dropped_on_it_and_the_other_ways_stay() {
        let plan = plan();
        let put =
            |legs: &[&str], branch: &str| into_branch(&plan, &ids(legs), &"fork".into(), &branch.into());
        assert_eq!(shown(put(&["a", "b"], "past")), "loop(in1 in2) c / fork x y a b z / ");
        let edited = put(&["a", "b"], "past").unwrap().unwrap().apply(&plan).unwrap();
        let next = |plan: &FlightPlan, leg: &str| {
            plan.leg(&leg.into()).unwrap().successor().map(|l| l.id.to_string())
        };
        assert_eq!(next(&edited, "y").as_deref(), Some("z"), "the other way does not come by");
        let ways = |plan: &FlightPlan| {
            let fork = plan.leg(&"fork".into()).unwrap().leg;
            leads_to(fork).iter().map(|id| id.to_string()).collect::<Vec<_>>()
        };
        assert_eq!(ways(&edited), ["x", "a"]);
        assert_eq!(next(&edited, "b").as_deref(), Some("z"));

        let edited = put(&["c"], "on").unwrap().unwrap().apply(&plan).unwrap();
        assert_eq!(ways(&edited), ["c", "z"]);
        assert_eq!(next(&edited, "c").as_deref(), Some("x"));
        assert_eq!(put(&["z"], "past"), Ok(None), "it is there");
        assert!(put(&["fork"], "on").unwrap_err().contains("its own branch"));
    }

    /// The legs of the first stage, each with where it says that it leads.
    fn ways(plan: &FlightPlan) -> String {
        let said = |next: &Option<Id>| next.as_ref().map_or(String::new(), |next| format!(">{next}"));
        let leg = |leg: &Arc<Leg>| {
            let branches = leg.as_fork().map_or(&[][..], |fork| fork.branches).iter();
            let branches: Vec<String> = branches.map(|b| format!("{}{}", b.id, said(&b.next))).collect();
            let branches =
                if branches.is_empty() { String::new() } else { format!("({})", branches.join(" ")) };
            format!("{}{}{branches}", leg.id, said(&leg.next))
        };
        plan.stages[0].legs.iter().map(leg).collect::<Vec<_>>().join(" ")
    }

    const TWO_WAYS: &str = r#"<flightPlan version="1" id="p"><fixes><fix id="A" at="46.0 8.0"/></fixes><mainPlan>
        <stage id="one" type="mission">
          <TF id="a" fix="A"/><TF id="b" fix="A"/>
          <intersection id="fork"><branch id="on" next="z"/><branch id="w" next="n1"/><branch id="v" next="m1"/></intersection>
          <TF id="m1" fix="A"/><TF id="m2" fix="A" next="z"/><TF id="n1" fix="A"/><TF id="n2" fix="A"/>
          <TF id="z" fix="A"/><TF id="y" fix="A"/>
        </stage><stage id="two" type="mission"/></mainPlan></flightPlan>"#;

    #[test]
    fn a_leg_goes_out_of_a_branch_and_back_and_each_way_leads_on() {
        let plan = crate::read(TWO_WAYS.as_bytes()).plan;
        let all = "a b fork(on>z w>n1 v>m1) m1 m2>z n1 n2 z y";
        assert_eq!(ways(&plan), all);
        let cases = [
            // the first of a way, the last of one, all of one
            (&["n1"][..], Spot::Before("b".into()), "a n1 b fork(on>z w>n2 v>m1) m1 m2>z n2 z y"),
            (&["m2"], Spot::After("z".into()), "a b fork(on>z w>n1 v>m1) m1>z n1 n2 z m2 y"),
            (&["m1", "m2"], Spot::Before("y".into()), "a b fork(on>z w>n1 v>z) n1 n2 z m1 m2 y"),
            (&["n1"], Spot::EndOf("two".into()), "a b fork(on>z w>n2 v>m1) m1 m2>z n2 z y"),
            // within its way
            (&["m1"], Spot::After("m2".into()), "a b fork(on>z w>n1 v>m2) m2 m1>z n1 n2 z y"),
            (&["n2"], Spot::Before("n1".into()), "a b fork(on>z w>n2 v>m1) m1 m2>z n2 n1 z y"),
        ];
        for (legs, at, expected) in cases {
            let out = relocate(&plan, &ids(legs), &at).unwrap().unwrap().apply(&plan).unwrap();
            assert_eq!(ways(&out), expected, "{legs:?} {at:?}");
        }
        for (leg, way) in [("n1", "w"), ("m1", "v")] {
            let out = relocate(&plan, &ids(&[leg]), &Spot::Before("b".into())).unwrap().unwrap();
            let out = out.apply(&plan).unwrap();
            let back = into_branch(&out, &ids(&[leg]), &"fork".into(), &way.into()).unwrap().unwrap();
            assert_eq!(ways(&back.apply(&out).unwrap()), all, "{leg} is back");
        }
    }

    #[test]
    fn stages_go_before_others_and_to_the_end() {
        let order = |stage: &str, at: StageSpot| {
            let edit = relocate_stage(&plan(), &stage.into(), &at)?;
            Some(
                edit.apply(&plan())
                    .unwrap()
                    .stages
                    .iter()
                    .map(|s| s.id.to_string())
                    .collect::<Vec<_>>()
                    .join(" "),
            )
        };
        let before = |id: &str| StageSpot::Before(id.into());
        assert_eq!(order("two", before("one")).as_deref(), Some("two one empty"));
        assert_eq!(order("one", StageSpot::EndOf(None)).as_deref(), Some("two empty one"));
        assert_eq!(order("one", before("two")), None);
        assert_eq!(order("one", before("one")), None);
        assert_eq!(order("empty", StageSpot::EndOf(None)), None);
        assert_eq!(order("gone", StageSpot::EndOf(None)), None);
    }
}
