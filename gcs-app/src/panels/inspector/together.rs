//! What can be done to several legs at once, beside what each property offers.

use super::page::Page;
use super::{raise, value};
use crate::command::{Queue, Selection, ViewCommand};
use crate::document::Document;
use crate::panels::{Scene, field};
use crate::theme;
use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{PopupCloseBehavior, RichText, Ui};
use flight_plan::describe::{Draft, Kind, Property, Range, Subject, add as add_to};
use flight_plan::{FlightPlan, Id, Stage, create};

/// Of more than so many together the properties are not shown.
pub const MOST: usize = 300;
/// So many are named.
const NAMED: usize = 40;

/// Above the properties that they have in common.
pub fn head(ui: &mut Ui, scene: &Scene<'_>, legs: &[Id], queue: &mut Queue) {
    let count = if legs.len() == 1 { "1 leg".to_owned() } else { format!("{} legs", legs.len()) };
    ui.label(RichText::new(count).size(15.0).strong());
    ui.add(named(ui, scene, legs).truncate());
    ui.add_space(4.0);
    raise::show(ui, scene, legs, queue);
}

fn named(ui: &Ui, scene: &Scene<'_>, set: &[Id]) -> egui::Label {
    let mut names: Vec<String> = set.iter().take(NAMED).map(|id| whose(scene.document, id)).collect();
    names.extend((set.len() > NAMED).then(|| "…".into()));
    egui::Label::new(RichText::new(names.join(", ")).color(theme::of(ui).weak))
}

/// A name; of a part of an emergency plan, which may be called as one of the main plan, with that.
pub(super) fn whose(document: &Document, id: &Id) -> String {
    let plan = document.plan();
    let is_its = |stage: &Stage| stage.id == *id || plan.leg(id).is_some_and(|leg| leg.stage.id == stage.id);
    let of = plan.emergency_plans.iter().find(|emergency| emergency.stages.iter().any(is_its));
    let name = document.label(id);
    of.map_or_else(|| name.to_owned(), |of| format!("{name} of {}", document.label(&of.id)))
}

/// Of legs, stages, fixes, zones, runways and variables, or of very many legs.
pub fn mixed(ui: &mut Ui, scene: &Scene<'_>, set: &[Id], queue: &mut Queue) {
    let plan = scene.document.plan();
    let legs = scene.selected_legs().len();
    let stages = set.iter().filter(|id| plan.stage(id).is_some()).count();
    ui.label(RichText::new(counted(set.len(), legs, stages)).size(15.0).strong());
    ui.add(named(ui, scene, set).wrap());
    if legs + stages > 0 {
        raise::show(ui, scene, set, queue);
    }
    // away from what is pressed often
    ui.add_space(10.0);
    ui.separator();
    if ui.button("Delete them").clicked() {
        queue.edit(create::delete_set(plan, set));
    }
}

/// Several parts of one sort: what holds for each of them is changed together.
pub(super) struct Sort {
    /// What one is called.
    pub name: &'static str,
    pub subjects: Vec<Subject>,
}

impl Sort {
    /// `2 stages`.
    pub fn counted(&self) -> String {
        let many = match (self.subjects.len(), self.name) {
            (1, _) => "",
            (_, "fix") => "es",
            _ => "s",
        };
        format!("{} {}{many}", self.subjects.len(), self.name)
    }
}

/// The sorts that are selected. A thing that is the only one of its sort is changed when it alone is selected; legs come with stages.
pub(super) fn sorts(scene: &Scene<'_>) -> Vec<Sort> {
    let plan = scene.document.plan();
    let selected: Vec<Subject> =
        scene.view.selection.iter().chain(&scene.view.also).map(Selection::subject).collect();
    let legs = scene.selected_legs().into_iter().map(Subject::Leg).collect::<Vec<_>>();
    let of =
        |is_it: fn(&Subject) -> bool| selected.iter().filter(|subject| is_it(subject)).cloned().collect();
    let things: [(&'static str, Vec<Subject>); 4] = [
        ("stage", of(|subject| matches!(subject, Subject::Stage(_)))),
        ("fix", of(|subject| matches!(subject, Subject::Fix(_)))),
        ("zone", of(|subject| matches!(subject, Subject::Zone(_)))),
        ("runway", of(|subject| matches!(subject, Subject::Runway(_)))),
    ];
    let things = things.into_iter().map(|(name, subjects)| {
        let there: Vec<Subject> = subjects.into_iter().filter(|s| Draft::of(plan, s).is_some()).collect();
        (name, there)
    });
    let several = things.filter(|(_, subjects)| subjects.len() > 1);
    let legs = Some(("leg", legs)).filter(|(_, legs)| !legs.is_empty());
    several.chain(legs).map(|(name, subjects)| Sort { name, subjects }).collect()
}

/// `2 stages and 5 legs`.
fn counted(all: usize, legs: usize, stages: usize) -> String {
    let stages = if stages == 1 { "1 stage".into() } else { format!("{stages} stages") };
    match (all - legs, stages) {
        (0, _) => format!("{legs} legs"),
        (others, stages) if stages.starts_with(&format!("{others} ")) && legs == 0 => stages,
        (others, stages) if stages.starts_with(&format!("{others} ")) => {
            format!("{stages} and {legs} leg{}", if legs == 1 { "" } else { "s" })
        }
        _ => format!("{all} together"),
    }
}

/// Below them.
pub fn foot(ui: &mut Ui, plan: &FlightPlan, legs: &[Id], queue: &mut Queue) {
    ui.add_space(2.0);
    if ui.button("Delete them").clicked() {
        queue.edit(create::delete_legs(plan, legs));
    }
}

/// Adds something to a number of each.
pub fn add(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property) {
    let (Kind::Value(range) | Kind::Number(range)) = property.kind else { return };
    let id = egui::Id::unique(("add to", property.attribute));
    let mut by = ui.data(|d| d.get_temp::<f64>(id)).unwrap_or(0.0);
    // the number in it is typed before the button in it is pressed
    let stays = MenuConfig::default().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let button = MenuButton::new("±").config(stays);
    let (response, _) = button.ui(ui, |ui| adding(ui, page, property, range, &mut by));
    let name = format!("Add to {}", property.label);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    response.on_hover_text("So much more or less for each of them");
    ui.data_mut(|d| d.insert_temp(id, by));
}

fn adding(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property, range: Range, by: &mut f64) {
    let unit = value::unit(range.quantity, page.scene.units());
    ui.horizontal(|ui| {
        let name = format!("To be added to {}", property.label);
        match field::number(ui, &name, *by, unit, f64::MIN) {
            field::Change::Moving(si) | field::Change::Set(si) => *by = si,
            field::Change::None | field::Change::Ended => {}
        }
        if ui.button("Add to each").clicked() {
            match add_to(page.plan(), page.drafts(), property, *by) {
                Ok(edit) => page.queue.edit(edit),
                Err(why) => page.queue.view(ViewCommand::Notice(why)),
            }
            ui.close();
        }
    });
}
