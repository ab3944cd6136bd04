//! What is selected, and all that can be changed about it: drawn from the description of the plan's language
//! (`flight_plan::describe`), whatever it is. Every change is an edit of the document, and one undo step.

mod aboard;
mod bind;
mod datum;
mod fixes;
mod form;
mod formula;
pub mod inherited;
mod landing;
mod level;
mod list;
mod page;
mod raise;
mod runway;
mod together;
mod value;

use super::field;
use super::{Panel, PanelId, Place, Scene, group_title};
use crate::command::{BranchId, Queue, Selection};
use crate::theme;
use crate::units;
use egui::{RichText, ScrollArea, Ui};
use flight_plan::Edit;
use flight_plan::describe::{Draft, Subject};
use page::Page;
pub use raise::focus as focus_raise;

/// The panel.
#[derive(Debug)]
pub struct Inspector;

/// Of the panel.
pub const ID: PanelId = "inspector";

impl Panel for Inspector {
    fn id(&self) -> PanelId {
        ID
    }
    fn name(&self) -> &'static str {
        "Inspector"
    }
    fn place(&self) -> Place {
        Place::Right { height: 290.0 }
    }
    /// All that there is to say of a plan.
    fn least_height(&self) -> f32 {
        300.0
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        ScrollArea::vertical().id_salt("inspector").auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 5.0;
            ui.set_width(ui.available_width());
            selected(ui, scene, queue);
        });
    }
}

fn selected(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let plan = scene.document.plan();
    let legs = scene.selected_legs();
    let set = scene.selected_set();
    if set.len() > 1 && (set.len() > legs.len() || set.len() > together::MOST) {
        together::mixed(ui, scene, &set, queue);
        if set.len() <= together::MOST {
            together::sorts(scene).into_iter().for_each(|sort| common(ui, scene, &sort, queue));
        }
        return;
    }
    if legs.len() > 1 {
        together::head(ui, scene, &legs, queue);
        let subjects: Vec<Subject> = legs.iter().cloned().map(Subject::Leg).collect();
        several(ui, scene, "leg", &subjects, queue);
        together::foot(ui, plan, &legs, queue);
        return;
    }
    let subject = scene.view.selection.as_ref().map_or(Subject::Plan, Selection::subject);
    match Draft::of(plan, &subject) {
        Some(draft) => ui.push_id(&subject, |ui| part(ui, scene, draft, queue)).inner,
        None => drop(ui.label("It is no longer in the plan.")),
    }
}

/// What holds for each of one sort, below what they are.
fn common(ui: &mut Ui, scene: &Scene<'_>, sort: &together::Sort, queue: &mut Queue) {
    ui.separator();
    group_title(ui, &sort.counted());
    several(ui, scene, sort.name, &sort.subjects, queue);
}

/// What holds for each of them.
fn several(ui: &mut Ui, scene: &Scene<'_>, sort: &str, subjects: &[Subject], queue: &mut Queue) {
    let plan = scene.document.plan();
    let drafts: Vec<Draft> = subjects.iter().filter_map(|subject| Draft::of(plan, subject)).collect();
    ui.push_id(("several", sort), |ui| form(ui, scene, &drafts, queue));
}

fn part(ui: &mut Ui, scene: &Scene<'_>, draft: Draft, queue: &mut Queue) {
    branch(ui, scene, &draft, queue);
    heading(ui, scene, &draft);
    match draft.subject() {
        Subject::Plan => summary(ui, scene),
        Subject::Leg(id) | Subject::Stage(id) => aboard::leg(ui, scene, id, queue),
        _ => {}
    }
    form(ui, scene, std::slice::from_ref(&draft), queue);
    if let Subject::Leg(id) | Subject::Procedure(id) = draft.subject() {
        fixes::of_procedure(ui, scene, id, queue);
    }
    match draft.subject() {
        Subject::Plan => hint(ui),
        Subject::Variable(name) => aboard::variable(ui, scene, name, queue),
        Subject::Runway(id) => runway::other_direction(ui, scene, id, queue),
        Subject::Stage(id) => landing::without_approach(ui, scene, id, queue),
        Subject::Leg(id) if ui.button("Delete this leg").clicked() => {
            queue.edit(Edit::DeleteLeg { leg: id.clone() });
        }
        _ => {}
    }
}

/// Of the branch that is selected, before its fork.
fn branch(ui: &mut Ui, scene: &Scene<'_>, draft: &Draft, queue: &mut Queue) {
    let Some(BranchId { fork, branch }) = scene.selected_branch() else { return };
    let label = scene.document.plan().branch_label(&fork, &branch);
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(RichText::new(label).size(15.0).strong()).truncate());
        let of = format!("branch of {}", scene.document.label(&fork));
        ui.add(egui::Label::new(RichText::new(of).color(theme::of(ui).weak)).truncate());
    });
    if let Some(mut page) = Page::of(scene, std::slice::from_ref(draft), queue) {
        list::alone(ui, &mut page, "branch", &branch);
    }
    ui.separator();
}

fn form(ui: &mut Ui, scene: &Scene<'_>, drafts: &[Draft], queue: &mut Queue) {
    if let Some(mut page) = Page::of(scene, drafts, queue) {
        form::show(ui, &mut page);
    }
}

/// The name, then what it is and its identifier.
fn heading(ui: &mut Ui, scene: &Scene<'_>, draft: &Draft) {
    let p = theme::of(ui);
    let element = draft.element();
    let id = element.attribute("id").unwrap_or("");
    let name = element.attribute("name").filter(|name| !name.is_empty()).unwrap_or(id);
    let mut kind = draft.description().label.to_lowercase();
    // what pilots know by two letters is told with them
    let is_code = element.name.chars().all(|letter| letter.is_ascii_uppercase());
    if is_code {
        kind = format!("{} {kind}", element.name);
    }
    if let Subject::Leg(leg) = draft.subject()
        && let Some((procedure, _)) = scene.document.plan().procedure_leg(leg)
    {
        kind = format!("{kind}, in procedure {}", procedure.id);
    }
    let rest = beside(name, &kind, id);
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(RichText::new(name).size(15.0).strong()).truncate());
        ui.add(egui::Label::new(RichText::new(rest).color(p.weak)).truncate());
    });
}

/// Each thing is said once: what it is, unless it is called so, and its identifier where that is neither.
fn beside(name: &str, kind: &str, id: &str) -> String {
    let kind = Some(kind).filter(|kind| !same_words(kind, name));
    let id =
        Some(id).filter(|id| !id.is_empty() && *id != name && kind.is_none_or(|kind| !same_words(kind, id)));
    kind.into_iter().chain(id).collect::<Vec<_>>().join(" · ")
}

/// The same but for capitals, spaces and dashes: `figureEight` is a figure eight.
fn same_words(one: &str, other: &str) -> bool {
    let letters = |text: &str| text.to_lowercase().replace([' ', '-', '_'], "");
    letters(one) == letters(other)
}

/// What will be flown, when nothing is selected.
fn summary(ui: &mut Ui, scene: &Scene<'_>) {
    let forecast = scene.forecast();
    if let (Some(why), false) = (scene.out_of_date(), forecast.points.is_empty()) {
        let text = RichText::new(format!("◌ {why}")).size(12.0).color(theme::of(ui).caution);
        ui.add(egui::Label::new(text).wrap());
    }
    let rows: [(&str, String); 4] = [
        ("Length", scene.units().distance().show(forecast.length_m())),
        ("Duration", units::duration(forecast.duration_s())),
        ("Waypoints", forecast.waypoints.len().to_string()),
        ("Energy left", forecast.battery_left.map_or_else(|| "–".into(), |b| format!("{:.0} %", b * 100.0))),
    ];
    for (name, value) in rows {
        field::row_with_help(ui, name, "", |ui| ui.label(value));
    }
    if let Some(why) = &forecast.cut_short {
        ui.label(RichText::new(format!("⚠ {why}")).color(theme::of(ui).caution));
    }
}

fn hint(ui: &mut Ui) {
    let text = "Select something in the tree or on the map to change it.";
    ui.label(RichText::new(text).size(12.0).color(theme::of(ui).weak));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_says_each_thing_once() {
        assert!(same_words("figureEight", "figure-eight") && !same_words("TF", "track to fix"));
        for (name, kind, id, expected) in [
            ("scan", "scan", "scan", ""),
            ("orbit1", "orbit", "orbit1", "orbit"),
            ("Power line", "corridor", "corridor1", "corridor · corridor1"),
            ("Scan the pylons", "scan", "scan", "scan"),
            ("side1", "TF track to fix", "side1", "TF track to fix"),
            ("Plan", "plan", "", ""),
        ] {
            assert_eq!(beside(name, kind, id), expected);
        }
    }
}
