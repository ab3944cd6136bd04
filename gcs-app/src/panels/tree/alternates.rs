//! Emergency plans of legs, stages and the whole plan: what is in force where, and the menu that chooses the cause.

use crate::command::{Queue, Selection};
use crate::panels::Scene;
use crate::theme;
use egui::{RichText, Ui};
use flight_plan::{Alternates, Cause, Edit, EmergencyChoice, FlightPlan, Id, InForce};
use std::collections::BTreeSet;

/// What a cause is called in a menu; `None` stands for every cause that has no plan of its own there.
pub fn name_of(cause: Option<Cause>) -> &'static str {
    cause.map_or("Any cause", Cause::name)
}

/// All of them, in the order of a menu.
pub fn causes() -> impl Iterator<Item = Option<Cause>> {
    std::iter::once(None).chain(Cause::ALL.map(Some))
}

/// Associates an emergency plan, or nothing, with legs, stages or (`None`) the whole plan.
pub fn associated(of: &[Option<Id>], cause: Option<Cause>, plan: Option<&Id>) -> Edit {
    let one = |of: &Option<Id>| Edit::SetEmergency { of: of.clone(), cause, plan: plan.cloned() };
    Edit::All(of.iter().map(one).collect())
}

/// What something names itself.
pub fn choice<'a>(plan: &'a FlightPlan, of: Option<&Id>) -> Option<&'a EmergencyChoice> {
    let Some(id) = of else { return Some(&plan.emergency) };
    plan.any_leg(id).map(|leg| &leg.emergency).or_else(|| plan.stage(id).map(|stage| &stage.emergency))
}

/// Which causes an emergency plan is for; the ones that it is for already are marked, and taken back by a click.
pub fn causes_menu(ui: &mut Ui, plan: &FlightPlan, of: &[Option<Id>], alternate: &Id, queue: &mut Queue) {
    let choice = of.first().and_then(|of| choice(plan, of.as_ref()));
    for cause in causes() {
        let now =
            choice.and_then(|choice| choice.by_cause.iter().find(|(c, _)| *c == cause)).map(|(_, id)| id);
        let is_it = now == Some(alternate);
        let inherited = choice.and_then(|choice| answers_already(choice, cause, alternate));
        let label = egui::Button::selectable(is_it, name_of(cause));
        let response = ui.add_enabled(inherited.is_none(), label);
        let response = match inherited {
            Some(why_not) => response.on_disabled_hover_text(why_not),
            None => response,
        };
        let response = match now.filter(|_| !is_it) {
            Some(other) => response.on_hover_text(format!("Now: {}", plan_name(plan, other))),
            None => response,
        };
        if response.clicked() {
            queue.edit(associated(of, cause, Some(alternate).filter(|_| !is_it)));
            ui.close();
        }
    }
}

/// Why it changes nothing to name an emergency plan for a cause: it is the one for every cause there, and no other is named for this one.
pub fn answers_already(
    choice: &EmergencyChoice,
    cause: Option<Cause>,
    alternate: &Id,
) -> Option<&'static str> {
    let names = |of| choice.by_cause.iter().find(|(cause, _)| *cause == of).map(|(_, plan)| plan);
    let is_so = cause.is_some() && names(cause).is_none() && names(None) == Some(alternate);
    is_so.then_some("It is that already: it is the plan for any cause, and no other is named for this one")
}

/// A leg stands for all that are selected with it.
pub fn together(scene: &Scene<'_>, of: &Id) -> Vec<Option<Id>> {
    match scene.selected_legs() {
        legs if legs.contains(of) => legs.into_iter().map(Some).collect(),
        _ => vec![Some(of.clone())],
    }
}

/// Of a row: which emergency plan for which cause.
pub fn submenu(ui: &mut Ui, plan: &FlightPlan, of: &[Option<Id>], queue: &mut Queue) {
    if plan.emergency_plans.is_empty() {
        return;
    }
    ui.menu_button("Emergency plan", |ui| {
        for alternate in &plan.emergency_plans {
            let name = plan_name(plan, &alternate.id);
            ui.menu_button(name, |ui| causes_menu(ui, plan, of, &alternate.id, queue));
        }
        let named: BTreeSet<Option<Cause>> = of
            .iter()
            .filter_map(|of| choice(plan, of.as_ref()))
            .flat_map(|choice| choice.by_cause.iter().map(|(cause, _)| *cause))
            .collect();
        let text = if of == [None] { "None" } else { "As around it" };
        let none = ui.add_enabled(!named.is_empty(), egui::Button::new(text));
        if none.on_disabled_hover_text("It names no emergency plan of its own").clicked() {
            queue.edit(Edit::All(named.into_iter().map(|cause| associated(of, cause, None)).collect()));
        }
    });
}

/// What is named there itself, in a few words: `Return home`, `Return home +1`. What is inherited is no news on every row.
pub(super) fn own_in_short(plan: &FlightPlan, all: &Alternates, of: Option<&Id>) -> Option<String> {
    let own = || all.iter().filter_map(|(_, in_force)| in_force).filter(|f| f.from.as_ref() == of);
    // as the vehicle says it: what would be flown on the operator's word
    let usual = own().find(|f| all.get(Cause::Operator) == Some(f)).or_else(|| own().next())?;
    let others: BTreeSet<&Id> = own().map(|f| &f.plan).filter(|id| **id != usual.plan).collect();
    let more = if others.is_empty() { String::new() } else { format!(" +{}", others.len()) };
    Some(format!("{}{}{more}", only_for(all, usual), plan_name(plan, &usual.plan)))
}

/// `Engine, Link: `, where it is not for every cause.
fn only_for(all: &Alternates, usual: &InForce) -> String {
    if all.iter().all(|(_, in_force)| in_force.is_some_and(|f| f.from == usual.from)) {
        return String::new();
    }
    let causes = all.iter().filter(|(_, in_force)| *in_force == Some(usual));
    let causes: Vec<&str> = causes.map(|(cause, _)| cause.short_name()).collect();
    format!("{}: ", causes.join(", "))
}

/// The emergency plan for every cause, and who names it.
pub(super) fn explain(ui: &mut Ui, text: &str, plan: &FlightPlan, all: &Alternates, of: Option<&Selection>) {
    if !text.is_empty() {
        ui.label(RichText::new(text).strong());
    }
    if all.is_empty() {
        ui.label("No emergency plan is named here: drag one here, or choose it in the menu.");
        return;
    }
    let weak = theme::of(ui).weak;
    egui::Grid::new("alternates").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        for (cause, in_force) in all.iter() {
            ui.label(RichText::new(cause.name()).color(weak));
            ui.label(match in_force {
                None => "nothing".to_owned(),
                Some(f) if f.from.as_ref() == of.map(Selection::id) => plan_name(plan, &f.plan),
                Some(f) => format!("{}, from {}", plan_name(plan, &f.plan), origin(plan, f)),
            });
            ui.end_row();
        }
    });
}

/// Who names it.
fn origin(plan: &FlightPlan, in_force: &InForce) -> String {
    in_force.from.as_ref().map_or("the plan", |from| plan.label(from)).to_owned()
}

/// Of an emergency plan.
pub fn plan_name(plan: &FlightPlan, id: &Id) -> String {
    plan.label(id).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_change_nothing_is_not_offered() {
        let (home, field) = (Id::new("home"), Id::new("field"));
        let choice = |by_cause: &[(Option<Cause>, &Id)]| EmergencyChoice {
            by_cause: by_cause.iter().map(|(cause, plan)| (*cause, (*plan).clone())).collect(),
        };
        let any = choice(&[(None, &home)]);
        let is_offered = |choice, cause, plan| answers_already(choice, cause, plan).is_none();
        assert!(!is_offered(&any, Some(Cause::Link), &home));
        assert!(is_offered(&any, None, &home), "it can be taken back");
        assert!(is_offered(&any, Some(Cause::Link), &field));
        let both = choice(&[(None, &home), (Some(Cause::Link), &field)]);
        assert!(is_offered(&both, Some(Cause::Link), &home) && !is_offered(&both, Some(Cause::Gps), &home));
    }

    #[test]
    fn a_row_says_what_it_names_itself_and_not_what_it_inherits() {
        let choice = |by_cause: &[(Option<Cause>, &str)]| EmergencyChoice {
            by_cause: by_cause.iter().map(|(cause, plan)| (*cause, Id::new(plan))).collect(),
        };
        let plan = FlightPlan::default();
        let whole = Alternates::default().within(&choice(&[(None, "home")]), None);
        let leg = Id::new("leg");
        let said = |own: &[(Option<Cause>, &str)]| {
            own_in_short(&plan, &whole.within(&choice(own), Some(&leg)), Some(&leg)).unwrap_or_default()
        };
        assert_eq!(own_in_short(&plan, &whole, None).as_deref(), Some("home"), "the plan itself");
        assert_eq!(said(&[]), "");
        assert_eq!(said(&[(Some(Cause::Engine), "field")]), "Engine: field");
        assert_eq!(said(&[(None, "strip"), (Some(Cause::Engine), "field")]), "strip +1");
    }
}
