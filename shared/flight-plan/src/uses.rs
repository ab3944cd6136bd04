//! Where a plan has values and expressions, and as what.

mod slots;

pub(crate) use slots::{Slot, SlotMut};

use crate::create::every_leg;
use crate::{FlightPlan, Id, Leg, Place, Stage, Value, expression};
use geometry::LatLon;
use std::collections::BTreeSet;
use std::sync::Arc;

/// What an expression is used as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Use {
    /// A number.
    Number,
    /// A condition.
    Condition,
    /// A position.
    Position,
    /// A polygon.
    Polygon,
    /// A value whose type the place decides: a variable's, a parameter's.
    Any,
}

/// Something in a leg or stage that has a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Part<'a> {
    /// A number.
    Number(&'a Value<f64>),
    /// A position.
    Place(&'a Place),
    /// A position that can only be a constant.
    Corner(LatLon),
    /// An expression that can't be a constant, with what it is used as.
    Source(&'a Arc<str>, Use),
}

impl<'a> Part<'a> {
    /// The expression, if it is one.
    fn expression(self) -> Option<(&'a Arc<str>, Use)> {
        match self {
            Part::Number(Value::Expression(source)) => Some((source, Use::Number)),
            Part::Place(Place::Position(Value::Expression(source))) => Some((source, Use::Position)),
            Part::Source(source, used) => Some((source, used)),
            _ => None,
        }
    }
}

/// Takes every part that it is shown.
type Visitor<'a> = dyn FnMut(Part) + 'a;

impl<'a> Slot<'a> {
    fn part(self) -> Option<Part<'a>> {
        Some(match self {
            Slot::Number(_, value) => Part::Number(value),
            Slot::Optional(_, value) => Part::Number(value.as_ref()?),
            Slot::Place(place) => Part::Place(place),
            Slot::Corner(corner) => Part::Corner(*corner),
            Slot::Source(source, used) => Part::Source(source, used),
        })
    }
}

impl Leg {
    /// Every expression of the leg itself (not of the legs inside it), with what it is used as.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(&Arc<str>, Use)) {
        self.for_each_part(&mut |part| {
            if let Some((source, used)) = part.expression() {
                visit(source, used);
            }
        });
    }

    /// Every expression that its waypoints depend on: those of [`Leg::for_each_expression`] without its actions'.
    pub fn for_each_geometric_expression(&self, visit: &mut dyn FnMut(&Arc<str>, Use)) {
        slots::shared::geometry(self, &mut |slot| {
            if let Some((source, used)) = slot.part().and_then(Part::expression) {
                visit(source, used);
            }
        });
    }

    /// Everything that has a value in the leg itself (not in the legs inside it).
    pub fn for_each_part(&self, visit: &mut Visitor) {
        slots::shared::leg(self, &mut |slot| {
            if let Some(part) = slot.part() {
                visit(part);
            }
        });
    }

    /// Its numbers (not those of its actions) by their names in the document; an optional one that is not given is
    /// `None`. What `Edit::SetNumber` sets.
    pub fn numbers(&self) -> Vec<(&'static str, Option<&Value<f64>>)> {
        let mut numbers = Vec::new();
        slots::shared::geometry(self, &mut |slot| match slot {
            Slot::Number(name, value) => numbers.push((name, Some(value))),
            Slot::Optional(name, value) => numbers.push((name, value.as_ref())),
            Slot::Place(_) | Slot::Corner(_) | Slot::Source(..) => {}
        });
        numbers
    }

    /// The attribute of a number that is this very expression, also of an action.
    pub(crate) fn attribute_of(&self, source: &Arc<str>) -> Option<&'static str> {
        let mut found = None;
        let is_it =
            |value: &Value<f64>| matches!(value, Value::Expression(other) if Arc::ptr_eq(source, other));
        slots::shared::leg(self, &mut |slot| match slot {
            Slot::Number(name, value) if is_it(value) => found = Some(name),
            Slot::Optional(name, Some(value)) if is_it(value) => found = Some(name),
            _ => {}
        });
        found
    }

    /// Every number of [`Leg::numbers`], to be changed (and other values).
    pub(crate) fn for_each_number_mut(&mut self, visit: &mut dyn FnMut(SlotMut)) {
        slots::exclusive::geometry(self, visit);
    }

    /// Every value in the leg itself, to be changed.
    pub(crate) fn for_each_slot_mut(&mut self, visit: &mut dyn FnMut(SlotMut)) {
        slots::exclusive::leg(self, visit);
    }
}

impl FlightPlan {
    /// Fixes that no leg goes to and no expression names.
    pub fn unused_fixes(&self) -> BTreeSet<&Id> {
        let mut unused: BTreeSet<&Id> = self.fixes.iter().map(|fix| &fix.id).collect();
        let mut named = |source: &Arc<str>, _: Use| {
            let fixes = expression::compile(source, self).map(|compiled| compiled.fixes).unwrap_or_default();
            fixes.iter().for_each(|fix| _ = unused.remove(fix));
        };
        self.all_stages().for_each(|(_, stage)| stage.for_each_expression(&mut named));
        for leg in every_leg(self) {
            leg.for_each_expression(&mut named);
        }
        for leg in every_leg(self) {
            leg.for_each_part(&mut |part| {
                if let Part::Place(Place::Fix(fix)) = part {
                    unused.remove(fix);
                }
            });
        }
        unused
    }
}

impl Stage {
    /// Every expression of the stage itself (not of its legs), with what it is used as.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(&Arc<str>, Use)) {
        let numbers = self.altitude.iter().map(|a| &a.metres).chain(&self.speed_mps);
        numbers.filter_map(|x| Part::Number(x).expression()).for_each(|(source, used)| visit(source, used));
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{document_with, plan_with};
    use crate::{Edit, Id};

    #[test]
    fn a_fix_is_used_by_a_leg_or_a_formula_and_unused_once_they_are_gone() {
        let legs = r#"<TF id="t" fix="B"/>
            <HM id="o" fix="B" course="90" turn="left" length="900" until="distance_to('C') &lt; 300.0"/>"#;
        let plan = crate::read(plan_with(legs)).plan;
        let unused = |plan: &crate::FlightPlan| plan.unused_fixes().into_iter().cloned().collect::<Vec<Id>>();
        assert_eq!(unused(&plan), [Id::new("GATE")]);
        let edit = Edit::All(vec![Edit::DeleteLeg { leg: "o".into() }]);
        assert!(edit.removes());
        assert_eq!(unused(&edit.apply(&plan).unwrap()), [Id::new("C"), Id::new("GATE")]);
        let empty = crate::read(document_with("", "", "")).plan;
        assert_eq!(unused(&empty).len(), empty.fixes.len());
    }
}
