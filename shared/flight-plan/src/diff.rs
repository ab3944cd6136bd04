//! What changed between two plans.

use crate::{FlightPlan, Id, Leg, LegContext, LegKind};
use geometry::LatLon;
use std::collections::BTreeMap;

/// Where the fixes of a plan are.
type Fixes = BTreeMap<Id, LatLon>;

/// Identifiers of legs by what became of them, in document order.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Difference {
    /// Only in the new plan.
    pub added: Vec<Id>,
    /// Only in the old plan.
    pub removed: Vec<Id>,
    /// In both, but another leg, in another stage or loop, or over fixes or a runway that moved. A loop counts as
    /// changed only for its own properties and the order of its body, not for what changed inside a leg of it.
    pub changed: Vec<Id>,
}

impl Difference {
    /// From one plan to another.
    pub fn between(old: &FlightPlan, new: &FlightPlan) -> Self {
        let (before, after) = (old.all_legs(), new.all_legs());
        let by_id = |legs: &[LegContext<'_>]| -> BTreeMap<Id, usize> {
            legs.iter().enumerate().map(|(i, c)| (c.leg.id.clone(), i)).collect()
        };
        let fixes = |plan: &'_ FlightPlan| -> Fixes {
            plan.fixes.iter().map(|f| (f.id.clone(), f.position)).collect()
        };
        let (old, new) = (fixes(old), fixes(new));
        let (in_old, in_new) = (by_id(&before), by_id(&after));
        let mut difference = Difference::default();
        for context in &after {
            match in_old.get(&context.leg.id).and_then(|i| before.get(*i)) {
                None => difference.added.push(context.leg.id.clone()),
                Some(was) if differs((&old, was), (&new, context)) => {
                    difference.changed.push(context.leg.id.clone())
                }
                Some(_) => {}
            }
        }
        let gone = before.iter().filter(|c| !in_new.contains_key(&c.leg.id));
        difference.removed = gone.map(|c| c.leg.id.clone()).collect();
        difference
    }

    /// Nothing changed that legs can show.
    pub fn is_empty(&self) -> bool {
        self.added.is_empty() && self.removed.is_empty() && self.changed.is_empty()
    }
}

fn differs((old, was): (&Fixes, &LegContext), (new, is): (&Fixes, &LegContext)) -> bool {
    let around =
        |c: &LegContext| (c.stage.id.clone(), c.loops.iter().map(|l| l.id.clone()).collect::<Vec<_>>());
    let inherited = |c: &LegContext| (c.stage.altitude.clone(), c.stage.speed_mps.clone());
    around(was) != around(is)
        || inherited(was) != inherited(is)
        || fix_position(old, was.leg) != fix_position(new, is.leg)
        || shallow(was.leg) != shallow(is.leg)
}

fn fix_position(fixes: &Fixes, leg: &Leg) -> Option<LatLon> {
    match leg.place()? {
        crate::Place::Fix(id) => fixes.get(id).copied(),
        crate::Place::Position(_) => None,
    }
}

/// A leg with its body reduced to the identifiers in it.
fn shallow(leg: &Leg) -> (Leg, Vec<Id>) {
    let ids = leg.body().iter().map(|l| l.id.clone()).collect();
    let mut alone = leg.clone();
    if let LegKind::Iterative { body, .. } = &mut alone.kind {
        body.clear();
    }
    (alone, ids)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Edit, Spot, read};

    const FIRE_WATCH: &str = include_str!("../../../assets/plans/fire-watch.xml");

    #[test]
    fn legs_are_added_removed_and_changed() {
        let old = read(FIRE_WATCH).plan;
        let new_leg = Box::new(Leg { id: "new".into(), ..old.leg(&"o1".into()).unwrap().leg.clone() });
        let elsewhere = LatLon::new(36.3, -84.2);
        let cases = [
            (Edit::InsertLeg { leg: new_leg, at: Spot::After("o1".into()) }, ["new", "", ""]),
            (Edit::DeleteLeg { leg: "h1".into() }, ["", "h1", ""]),
            (Edit::DeleteLeg { leg: "patrol".into() }, ["", "patrol p1 p2 p3", ""]),
            (Edit::MoveFix { fix: "WATCH".into(), to: elsewhere }, ["", "", "o2 regroup"]),
            (
                Edit::SetSpeed { of: "p2".into(), speed_mps: Some(crate::Value::Constant(20.0)) },
                ["", "", "p2"],
            ),
            (Edit::SetCount { leg: "patrol".into(), count: None }, ["", "", "patrol"]),
            (Edit::MoveLeg { leg: "p3".into(), at: Spot::Before("p2".into()) }, ["", "", "patrol"]),
            (Edit::MoveLeg { leg: "h1".into(), at: Spot::EndOf("out".into()) }, ["", "", "h1"]),
            (Edit::Rename { id: "GAP".into(), name: "Another".into() }, ["", "", ""]),
        ];
        for (edit, expected) in cases {
            let difference = Difference::between(&old, &edit.apply(&old).unwrap());
            let words = |ids: &[Id]| ids.iter().map(Id::as_str).collect::<Vec<_>>().join(" ");
            let found = [words(&difference.added), words(&difference.removed), words(&difference.changed)];
            assert_eq!(found, expected, "{edit:?}");
        }
    }
}
