//! Emergency plans as actions: for what is selected, else for the whole plan, one a cause.

use super::{Action, Group, Kind};
use crate::command::{Command, DocumentCommand, Selection};
use crate::panels::Scene;
use crate::panels::tree::alternates::{
    answers_already, associated, causes, choice, name_of, plan_name, together,
};
use crate::panels::tree::title;
use flight_plan::Id;

/// So many emergency plans are offered.
const MOST: usize = 20;

/// `Alternate of side2 for Engine failure: Return home`.
pub fn of(scene: &Scene<'_>) -> Vec<Action> {
    let plan = scene.document.plan();
    let (of, whose) = subject(scene);
    let named = of.first().and_then(|of| choice(plan, of.as_ref()));
    let mut actions = Vec::new();
    for alternate in plan.emergency_plans.iter().take(MOST) {
        for cause in causes() {
            let is_it = named.is_some_and(|choice| choice.by_cause.contains(&(cause, alternate.id.clone())));
            let (for_cause, name) = (name_of(cause), plan_name(plan, &alternate.id));
            let why_not = named.and_then(|choice| answers_already(choice, cause, &alternate.id));
            let edit = associated(&of, cause, Some(&alternate.id).filter(|_| !is_it));
            actions.push(Action {
                id: format!("alternate-{}-{for_cause}", alternate.id).into(),
                name: format!("Alternate of {whose} for {for_cause}: {name}").into(),
                group: Group::Edit,
                kind: Kind::Switch(is_it),
                keys: Vec::new(),
                while_typing: false,
                caution: None,
                command: match why_not {
                    Some(why_not) => Err(why_not.into()),
                    None => Ok(Command::Document(DocumentCommand::Edit(edit))),
                },
            });
        }
    }
    actions
}

/// Whose it becomes, and what that is called.
fn subject(scene: &Scene<'_>) -> (Vec<Option<Id>>, String) {
    match &scene.view.selection {
        Some(Selection::Leg(leg)) => match together(scene, leg) {
            legs if legs.len() > 1 => (legs, "the selected legs".into()),
            one => (one, scene.document.label(leg).to_owned()),
        },
        Some(Selection::Stage(id)) => {
            let name = scene.document.plan().stage(id).map_or("", |stage| stage.name.as_str());
            (vec![Some(id.clone())], title(name, id.as_str()))
        }
        _ => (vec![None], "the plan".into()),
    }
}
