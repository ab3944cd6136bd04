//! Where a thing of the tree may be dropped: between rows, or onto one.

use super::keyboard::parent;
use super::make::Group;
use super::rows::Row;
use crate::command::{BranchId, Selection};
use flight_plan::create::StageSpot;
use flight_plan::{Id, Spot};

/// A place that the pointer means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct At {
    /// The row below the pointer.
    pub row: usize,
    /// How far down in it, 0..1.
    pub down: f32,
    /// How far to the right, in steps of the indentation.
    pub depth: usize,
}

/// How it is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    /// A line above a row.
    Above { row: usize, depth: usize },
    /// A line below a row.
    Below { row: usize, depth: usize },
    /// The whole row.
    Onto(usize),
}

/// Where legs go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum LegSpot {
    At(Spot),
    Branch { fork: Id, branch: Id },
}

/// A place and how it is shown; or why there is none.
pub(super) type Found<T> = Result<(Mark, T), &'static str>;

/// For legs.
pub(super) fn for_legs(rows: &[Row], at: At) -> Found<LegSpot> {
    const NOWHERE: &str = "Legs go into a stage, a loop, a branch or a procedure.";
    let row = rows.get(at.row).ok_or(NOWHERE)?;
    let selection = row.selection.as_ref().ok_or(NOWHERE)?;
    if let Some(branch) = &row.branch {
        let fork = selection.id().clone();
        let is_open = end(rows, at.row) > at.row + 1;
        return match is_last(rows, at.row) && !is_open && at.down > 0.75 {
            true => Ok(behind(rows, parent(rows, at.row).ok_or(NOWHERE)?, at.depth)),
            false => Ok((Mark::Onto(at.row), LegSpot::Branch { fork, branch: branch.clone() })),
        };
    }
    let is_leg = row.leg().is_some();
    if !is_leg && !row.nests {
        return Err(NOWHERE);
    }
    let first_inside = rows.get(at.row + 1).filter(|next| next.depth > row.depth).and_then(Row::leg);
    let onto = || (Mark::Onto(at.row), LegSpot::At(Spot::EndOf(selection.id().clone())));
    let edge = if row.nests { 0.3 } else { 0.5 };
    Ok(match (at.down < edge, at.down > 1.0 - edge) {
        (true, _) if is_leg => {
            let mark = Mark::Above { row: at.row, depth: row.depth };
            (mark, LegSpot::At(Spot::Before(selection.id().clone())))
        }
        (_, true) if row.nests && first_inside.is_some() => {
            let mark = Mark::Above { row: at.row + 1, depth: row.depth + 1 };
            (mark, first_inside.map_or_else(onto, |first| (mark, LegSpot::At(Spot::Before(first.clone())))).1)
        }
        (_, true) if is_leg => behind(rows, at.row, at.depth),
        _ => onto(),
    })
}

/// For a branch: before which one of its fork; `None`: at the end.
pub(super) fn for_branch(rows: &[Row], at: At, of: &BranchId) -> Found<Option<Id>> {
    const NOWHERE: &str = "A branch goes among those of its fork.";
    let alike = |row: usize| rows.get(row)?.as_branch().filter(|other| other.fork == of.fork);
    // over a leg in it, a branch is meant
    let mut row = at.row;
    while alike(row).is_none() {
        row = parent(rows, row).ok_or(NOWHERE)?;
    }
    let depth = rows.get(row).ok_or(NOWHERE)?.depth;
    if row == at.row && at.down < 0.5 {
        return Ok((Mark::Above { row, depth }, alike(row).map(|other| other.branch)));
    }
    let next = end(rows, row);
    Ok((Mark::Below { row: next - 1, depth }, alike(next).map(|other| other.branch)))
}

/// Behind a leg; where it is the last in its loop, behind the loop if the pointer is that far to the left.
fn behind(rows: &[Row], row: usize, depth: usize) -> (Mark, LegSpot) {
    let mut leg = row;
    while let Some(around) = parent(rows, leg)
        && rows.get(leg).is_some_and(|row| depth < row.depth)
        && is_last(rows, leg)
        && rows.get(around).is_some_and(|row| row.leg().is_some())
    {
        leg = around;
    }
    let depth = rows.get(leg).map_or(0, |row| row.depth);
    let id = rows.get(leg).and_then(|row| row.selection.as_ref()).map(Selection::id);
    let spot = Spot::After(id.cloned().unwrap_or_else(|| Id::new("")));
    (Mark::Below { row: end(rows, leg) - 1, depth }, LegSpot::At(spot))
}

/// For a stage.
pub(super) fn for_stage(rows: &[Row], at: At) -> Found<StageSpot> {
    const NOWHERE: &str = "Stages go between stages, or to the end of an emergency plan.";
    let row = rows.get(at.row).ok_or(NOWHERE)?;
    match (&row.selection, row.group) {
        (Some(Selection::Emergency(id)), _) => {
            return Ok((Mark::Onto(at.row), StageSpot::EndOf(Some(id.clone()))));
        }
        (_, Some(Group::Stages)) => return Ok((Mark::Onto(at.row), StageSpot::EndOf(None))),
        _ => {}
    }
    let mut stage = at.row;
    while !matches!(rows.get(stage).and_then(|row| row.selection.as_ref()), Some(Selection::Stage(_))) {
        stage = parent(rows, stage).ok_or(NOWHERE)?;
    }
    let row = rows.get(stage).ok_or(NOWHERE)?;
    let id = row.selection.as_ref().map(Selection::id).ok_or(NOWHERE)?;
    if stage == at.row && at.down < 0.5 {
        return Ok((Mark::Above { row: stage, depth: row.depth }, StageSpot::Before(id.clone())));
    }
    let next = end(rows, stage);
    let mark = Mark::Below { row: next - 1, depth: row.depth };
    let spot = match rows.get(next).and_then(|next| next.selection.as_ref()) {
        Some(Selection::Stage(next)) => StageSpot::Before(next.clone()),
        _ => match parent(rows, stage).and_then(|around| rows.get(around)?.selection.as_ref()) {
            Some(Selection::Emergency(id)) => StageSpot::EndOf(Some(id.clone())),
            _ => StageSpot::EndOf(None),
        },
    };
    Ok((mark, spot))
}

/// For an emergency plan: what it is to be the alternate of; `None`: of the whole plan.
pub(super) fn for_alternate(rows: &[Row], at: At) -> Found<Option<Id>> {
    const NOWHERE: &str = "Drop it on the main plan, a stage or a leg: it becomes the alternate there.";
    const NESTED: &str = "An emergency plan has no alternate of its own.";
    let row = rows.get(at.row).ok_or(NOWHERE)?;
    if row.group == Some(Group::Stages) {
        return Ok((Mark::Onto(at.row), None));
    }
    match &row.selection {
        Some(Selection::Emergency(_)) => Err(NESTED),
        Some(Selection::Leg(id) | Selection::Stage(id)) => {
            // a branch stands for its fork
            let of = if row.branch.is_some() { parent(rows, at.row).unwrap_or(at.row) } else { at.row };
            let has_any = rows.get(of).is_some_and(|row| row.alternates.is_some());
            if has_any { Ok((Mark::Onto(of), Some(id.clone()))) } else { Err(NESTED) }
        }
        _ => Err(NOWHERE),
    }
}

/// For a thing that has a list of its own, a fix or a zone: before which one of its list; `None`: to its end.
pub(super) fn for_thing(rows: &[Row], at: At, thing: &Selection) -> Found<Option<Id>> {
    const NOWHERE: &str = "It goes among those of its own list.";
    let is_alike = |row: &Row| {
        let same = |other: &Selection| std::mem::discriminant(other) == std::mem::discriminant(thing);
        row.selection.as_ref().is_some_and(same)
    };
    let row = rows.get(at.row).filter(|row| is_alike(row)).ok_or(NOWHERE)?;
    if at.down < 0.5 {
        let mark = Mark::Above { row: at.row, depth: row.depth };
        return Ok((mark, row.selection.as_ref().map(|selection| selection.id().clone())));
    }
    let next = end(rows, at.row);
    let before = rows.get(next).filter(|row| is_alike(row)).and_then(|row| row.selection.as_ref());
    Ok((Mark::Below { row: next - 1, depth: row.depth }, before.map(|selection| selection.id().clone())))
}

/// After a row and all that is in it.
pub(super) fn end(rows: &[Row], row: usize) -> usize {
    let depth = rows.get(row).map_or(0, |row| row.depth);
    let inside = rows.iter().skip(row + 1).take_while(|next| next.depth > depth).count();
    row + 1 + inside
}

/// Nothing comes after it in what it is inside of.
fn is_last(rows: &[Row], row: usize) -> bool {
    let depth = rows.get(row).map_or(0, |row| row.depth);
    rows.get(end(rows, row)).is_none_or(|next| next.depth < depth)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::panels::tree::rows::rows;
    use std::collections::BTreeSet;

    const PLAN: &str = r#"<flightPlan version="1" id="p">
      <fixes><fix id="A" at="46.0 8.0"/></fixes>
      <mainPlan>
        <stage id="one" type="mission">
          <TF id="a" fix="A"/>
          <iterative id="loop" form="forward" count="2"><TF id="in1" fix="A"/><TF id="in2" fix="A"/></iterative>
        </stage>
        <stage id="two" type="mission">
          <intersection id="fork"><branch id="on"/></intersection>
        </stage>
      </mainPlan>
      <emergencyPlans><emergencyPlan id="home" runway="R"><stage id="back" type="land" runway="R"/></emergencyPlan></emergencyPlans>
    </flightPlan>"#;

    fn found() -> Vec<Row> {
        let plan = flight_plan::read(PLAN.as_bytes()).plan;
        let mut rows = rows(&plan, &BTreeSet::new());
        let keys: Vec<&str> = rows.iter().map(|row| row.key.as_str()).collect();
        let expected = [
            "Main plan",
            "stage one",
            "leg a",
            "leg loop",
            "leg in1",
            "leg in2",
            "stage two",
            "leg fork",
            "branch on of fork",
            "Emergency plans",
            "emergency home",
            "stage back",
        ];
        assert_eq!(&keys[..expected.len()], expected);
        rows.truncate(expected.len());
        rows
    }

    #[test]
    fn legs_go_between_legs_into_loops_and_branches_and_out_of_them() {
        let rows = found();
        let spot = |row, down, depth| for_legs(&rows, At { row, down, depth }).unwrap();
        let at = |spot: Spot| LegSpot::At(spot);
        let cases = [
            ((2, 0.2, 9), Mark::Above { row: 2, depth: 2 }, at(Spot::Before("a".into()))),
            ((2, 0.8, 9), Mark::Below { row: 2, depth: 2 }, at(Spot::After("a".into()))),
            ((3, 0.1, 9), Mark::Above { row: 3, depth: 2 }, at(Spot::Before("loop".into()))),
            ((3, 0.5, 9), Mark::Onto(3), at(Spot::EndOf("loop".into()))),
            ((3, 0.9, 9), Mark::Above { row: 4, depth: 3 }, at(Spot::Before("in1".into()))),
            ((5, 0.9, 3), Mark::Below { row: 5, depth: 3 }, at(Spot::After("in2".into()))),
            ((5, 0.9, 2), Mark::Below { row: 5, depth: 2 }, at(Spot::After("loop".into()))),
            ((4, 0.9, 0), Mark::Below { row: 4, depth: 3 }, at(Spot::After("in1".into()))),
            ((1, 0.5, 9), Mark::Onto(1), at(Spot::EndOf("one".into()))),
            ((1, 0.9, 9), Mark::Above { row: 2, depth: 2 }, at(Spot::Before("a".into()))),
            ((8, 0.9, 9), Mark::Below { row: 8, depth: 2 }, at(Spot::After("fork".into()))),
        ];
        for ((row, down, depth), mark, expected) in cases {
            assert_eq!(spot(row, down, depth), (mark, expected), "{row} {down} {depth}");
        }
        let (mark, branch) = spot(8, 0.4, 9);
        assert_eq!(
            (mark, branch),
            (Mark::Onto(8), LegSpot::Branch { fork: "fork".into(), branch: "on".into() })
        );
        for row in [0, 9, 10, 99] {
            assert!(for_legs(&rows, At { row, down: 0.5, depth: 0 }).is_err(), "{row}");
        }
    }

    #[test]
    fn branches_go_among_those_of_their_fork() {
        let fork = r#"<intersection id="fork"><branch id="on"/><branch id="look"/>"#;
        let plan = PLAN.replace(r#"<intersection id="fork"><branch id="on"/>"#, fork);
        let rows = rows(&flight_plan::read(plan).plan, &BTreeSet::new());
        let row = |key: &str| rows.iter().position(|row| row.key == key).unwrap();
        let (on, look) = (row("branch on of fork"), row("branch look of fork"));
        let of = BranchId { fork: "fork".into(), branch: "look".into() };
        let spot = |row, down| for_branch(&rows, At { row, down, depth: 0 }, &of);
        assert_eq!(spot(on, 0.2), Ok((Mark::Above { row: on, depth: 3 }, Some("on".into()))));
        assert_eq!(spot(on, 0.8), Ok((Mark::Below { row: on, depth: 3 }, Some("look".into()))));
        assert_eq!(spot(look, 0.8), Ok((Mark::Below { row: look, depth: 3 }, None)));
        assert!(spot(row("leg a"), 0.5).is_err());
    }

    #[test]
    fn stages_go_between_stages() {
        let rows = found();
        let spot = |row, down| for_stage(&rows, At { row, down, depth: 0 });
        let before = |id: &str| StageSpot::Before(id.into());
        assert_eq!(spot(1, 0.2), Ok((Mark::Above { row: 1, depth: 1 }, before("one"))));
        assert_eq!(
            spot(4, 0.2),
            Ok((Mark::Below { row: 5, depth: 1 }, before("two"))),
            "of a leg: behind its stage"
        );
        assert_eq!(spot(7, 0.9), Ok((Mark::Below { row: 8, depth: 1 }, StageSpot::EndOf(None))));
        assert_eq!(
            spot(11, 0.9),
            Ok((Mark::Below { row: 11, depth: 2 }, StageSpot::EndOf(Some("home".into()))))
        );
        assert_eq!(spot(10, 0.5), Ok((Mark::Onto(10), StageSpot::EndOf(Some("home".into())))));
        assert!(spot(9, 0.5).is_err());
    }

    #[test]
    fn a_thing_goes_among_those_of_its_list() {
        let plan = PLAN.replace("</fixes>", r#"<fix id="B" at="46.0 8.1"/></fixes>"#);
        let rows = rows(&flight_plan::read(plan).plan, &BTreeSet::new());
        let row = |key: &str| rows.iter().position(|row| row.key == key).unwrap();
        let (a, b) = (row("FIX A"), row("FIX B"));
        let spot = |row, down| for_thing(&rows, At { row, down, depth: 0 }, &Selection::Fix("B".into()));
        assert_eq!(spot(a, 0.2), Ok((Mark::Above { row: a, depth: 1 }, Some("A".into()))));
        assert_eq!(spot(a, 0.8), Ok((Mark::Below { row: a, depth: 1 }, Some("B".into()))));
        assert_eq!(spot(b, 0.8), Ok((Mark::Below { row: b, depth: 1 }, None)));
        assert!(spot(1, 0.5).is_err());
    }

    #[test]
    fn an_emergency_plan_goes_to_the_plan_its_stages_and_legs() {
        let rows = found();
        let of = |row| for_alternate(&rows, At { row, down: 0.5, depth: 0 });
        assert_eq!(of(0), Ok((Mark::Onto(0), None)));
        assert_eq!(of(1), Ok((Mark::Onto(1), Some("one".into()))));
        assert_eq!(of(8), Ok((Mark::Onto(7), Some("fork".into()))));
        assert!(of(11).unwrap_err().contains("no alternate of its own"));
        assert!(of(9).unwrap_err().contains("Drop it on"));
    }
}
