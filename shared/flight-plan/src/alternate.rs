//! Which emergency plan is in force for each cause, and who names it.

use crate::{Cause, EmergencyChoice, Id};

/// What is flown for a cause.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InForce {
    /// The emergency plan.
    pub plan: Id,
    /// The leg or stage that names it; `None`: the document as a whole.
    pub from: Option<Id>,
}

/// What is in force at one place of a plan, by cause. The same rule as [`crate::Program::emergency_for`], for a plan that need not be
/// compiled.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Alternates([Option<InForce>; Cause::ALL.len()]);

impl Alternates {
    /// In what has these around it and names this itself: a name from nearer wins, and so does its fallback for every cause.
    pub fn within(&self, choice: &EmergencyChoice, of: Option<&Id>) -> Self {
        let mut inner = self.clone();
        for (cause, slot) in Cause::ALL.into_iter().zip(&mut inner.0) {
            if let Some(plan) = choice.plan_for(cause) {
                *slot = Some(InForce { plan: plan.clone(), from: of.cloned() });
            }
        }
        inner
    }

    /// With their causes, the most severe first.
    pub fn iter(&self) -> impl Iterator<Item = (Cause, Option<&InForce>)> {
        Cause::ALL.into_iter().zip(self.0.iter().map(Option::as_ref))
    }

    /// For a cause.
    pub fn get(&self, cause: Cause) -> Option<&InForce> {
        self.iter().find(|(other, _)| *other == cause).and_then(|(_, in_force)| in_force)
    }

    /// There is none for any cause.
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(Option::is_none)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile_document;
    use aircraft::Profile;
    use terrain::Flat;

    const FIRE_WATCH: &str = include_str!("../../../assets/plans/fire-watch.xml");

    #[test]
    fn every_leg_has_what_its_program_would_fly() {
        let program = compile_document(FIRE_WATCH.as_bytes(), &Profile::default(), &Flat(300.0)).unwrap();
        let whole = Alternates::default().within(&program.plan.emergency, None);
        for context in program.plan.all_legs() {
            let stage = whole.within(&context.stage.emergency, Some(&context.stage.id));
            let around = context.loops.iter().copied().chain([context.leg]);
            let leg = around.fold(stage, |outer, leg| outer.within(&leg.emergency, Some(&leg.id)));
            for (cause, in_force) in leg.iter() {
                let flown = program.emergency_for(&context.leg.id, cause).map(|plan| &plan.id);
                assert_eq!(in_force.map(|f| &f.plan), flown, "{} {cause:?}", context.leg.id);
            }
        }
    }

    #[test]
    fn it_is_said_who_names_it() {
        let choice = |cause, plan: &str| EmergencyChoice { by_cause: vec![(cause, plan.into())] };
        let whole = Alternates::default().within(&choice(None, "home"), None);
        let stage = whole.within(&choice(Some(Cause::Link), "field"), Some(&"watch".into()));
        let from = |cause| stage.get(cause).and_then(|f| f.from.as_ref()).map(Id::as_str);
        assert_eq!((from(Cause::Link), from(Cause::Engine)), (Some("watch"), None));
        assert_eq!(stage.get(Cause::Engine).unwrap().plan.as_str(), "home");
        assert!(Alternates::default().is_empty() && !stage.is_empty());
    }
}
