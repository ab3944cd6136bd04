//! What goes with the selection. While something is selected, the rest is a little fainter.

use super::sheet::Sheet;
use super::tools::in_force;
use crate::command::Selection;
use crate::panels::Scene;
use egui::Painter;
use flight_plan::{EmergencyChoice, FlightPlan, Id, Leg, Stage};
use std::collections::HashSet;

/// How much is left of the rest.
const FAINT: f32 = 0.6;

/// The selection with what goes with it: the legs of a stage, the alternates of a leg, the legs inside a loop.
#[derive(Debug)]
pub struct Kin {
    /// `None`: nothing is selected.
    ids: Option<HashSet<Id>>,
}

impl Kin {
    /// What goes with the present selection.
    pub fn of(scene: &Scene<'_>) -> Self {
        let selected = scene.view.selection.iter().chain(&scene.view.also);
        let ids = scene.view.selection.is_some().then(|| around(scene.document.plan(), selected));
        Self { ids }
    }

    /// It is selected, goes with what is, or nothing is selected.
    pub fn has(&self, id: &Id) -> bool {
        self.ids.as_ref().is_none_or(|ids| ids.contains(id))
    }

    /// Paints it as it is, or fainter.
    pub fn painter(&self, sheet: &Sheet<'_>, id: &Id) -> Painter {
        let mut painter = sheet.painter.clone();
        if !self.has(id) {
            painter.multiply_opacity(FAINT);
        }
        painter
    }
}

/// Selected legs up to so many are looked for one by one: that needs no list of all.
const FEW: usize = 4;

/// These with what goes with them. The plan is gone through a few times, however many there are.
fn around<'a>(plan: &FlightPlan, selected: impl Iterator<Item = &'a Selection>) -> HashSet<Id> {
    let (mut ids, mut legs) = (HashSet::new(), HashSet::new());
    for what in selected {
        ids.insert(what.id().clone());
        match what {
            Selection::Leg(id) => drop(legs.insert(id)),
            Selection::Stage(id) => plan.stage(id).into_iter().for_each(|stage| add_stage(stage, &mut ids)),
            Selection::Emergency(id) => {
                let stages = plan.emergency_plan(id).map_or(&[][..], |emergency| &emergency.stages);
                stages.iter().for_each(|stage| add_stage(stage, &mut ids));
            }
            _ => {}
        }
    }
    let contexts = match legs.len() {
        ..=FEW => legs.iter().filter_map(|leg| plan.leg(leg)).collect(),
        _ => plan.all_legs(),
    };
    for context in contexts.iter().filter(|context| legs.contains(&context.leg.id)) {
        add_alternates(in_force(plan, context), &mut ids);
        add_legs(context.leg, &mut ids);
    }
    ids
}

fn add_stage(stage: &Stage, ids: &mut HashSet<Id>) {
    add_alternates(&stage.emergency, ids);
    stage.legs.iter().for_each(|leg| add_legs(leg, ids));
}

fn add_legs(leg: &Leg, ids: &mut HashSet<Id>) {
    ids.insert(leg.id.clone());
    leg.body().iter().for_each(|inner| add_legs(inner, ids));
}

fn add_alternates(choice: &EmergencyChoice, ids: &mut HashSet<Id>) {
    ids.extend(choice.by_cause.iter().map(|(_, plan)| plan.clone()));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assets;

    fn kin(what: &Selection) -> HashSet<Id> {
        around(&flight_plan::read(assets::FIRE_WATCH.as_bytes()).plan, std::iter::once(what))
    }

    #[test]
    fn a_stage_has_its_legs_and_a_leg_its_alternates() {
        let plan = flight_plan::read(assets::FIRE_WATCH.as_bytes()).plan;
        let look = kin(&Selection::Leg("look".into()));
        assert!(look.contains("return") && !look.contains("regroup"));
        let stage = plan.leg(&"look".into()).unwrap().stage.id.clone();
        let of_stage = kin(&Selection::Stage(stage));
        assert!(["look", "regroup"].iter().all(|leg| of_stage.contains(*leg)));
    }

    #[test]
    fn of_several_what_goes_with_any_of_them_goes_with_all() {
        let plan = flight_plan::read(assets::FIRE_WATCH.as_bytes()).plan;
        let all: Vec<Selection> =
            plan.all_legs().iter().map(|context| Selection::Leg(context.leg.id.clone())).collect();
        let each: HashSet<Id> = all.iter().flat_map(kin).collect();
        assert_eq!(around(&plan, all.iter()), each);
        assert!(each.len() > all.len(), "with alternates");
    }
}
