//! What a right click on a row of the tree offers. What cannot be done there is shown, but cannot be chosen.

use super::alternates;
use crate::command::{Command, DocumentCommand, Queue, Selection, ViewCommand};
use crate::map::footprints;
use crate::panels::{Scene, binding};
use aircraft::Profile;
use egui::{Button, Ui};
use flight_plan::create::{self, LegChoice, Shape};
use flight_plan::{Edit, FlightPlan, Id, Leg, LegKind};

/// One row of the menu; `edit` is `None` where it cannot be done.
#[derive(Debug)]
pub struct Entry {
    /// For people.
    pub name: &'static str,
    /// The key of the action that does the same; empty: there is none.
    pub keys: &'static str,
    edit: Option<Edit>,
    /// What is selected after it.
    selects: Option<Selection>,
}

impl Entry {
    fn new(name: &'static str, keys: &'static str, edit: Option<Edit>) -> Self {
        Self { name, keys, edit, selects: None }
    }

    /// An entry that makes something, which is selected then.
    fn making(name: &'static str, made: Option<(Id, Edit)>, select: fn(Id) -> Selection) -> Self {
        let (id, edit) = made.unzip();
        Self { name, keys: "", edit, selects: id.map(select) }
    }

    /// What it asks for; `None`: it cannot be done.
    pub fn command(self) -> Option<Command> {
        let select = self.selects.map(|made| Command::View(ViewCommand::Select(Some(made))));
        let edit = Command::Document(DocumentCommand::Edit(self.edit?));
        Some(Command::Each([edit].into_iter().chain(select).collect()))
    }
}

/// The menu of what a row stands for.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, of: &Selection, queue: &mut Queue) {
    let plan = scene.document.plan();
    if let Selection::Runway(runway) = of
        && ui.button("Emergency plan that lands here").clicked()
    {
        queue.document(DocumentCommand::BringHome { runway: runway.clone(), outwards: Vec::new() });
    }
    if let Selection::Leg(id) = of
        && let Some(context) = plan.leg(id)
        && is_flown_itself(LegChoice::of(&context.leg.kind))
        && scene.selected_legs().len() < 2
    {
        ui.menu_button("Change its kind", |ui| kinds(ui, scene, context.leg, queue));
    }
    if let Selection::Leg(_) | Selection::Stage(_) = of {
        alternates::submenu(ui, plan, &alternates::together(scene, of.id()), queue);
    }
    if let Selection::Emergency(alternate) = of {
        ui.menu_button("Use for the whole plan", |ui| {
            alternates::causes_menu(ui, plan, &[None], alternate, queue);
        });
    }
    if ui.add(Button::new("Rename").shortcut_text("F2")).clicked() {
        queue.view(ViewCommand::Rename(of.clone()));
    }
    on_map(ui, scene, of, queue);
    for entry in entries(scene, of) {
        let button = Button::new(entry.name).shortcut_text(entry.keys);
        if ui.add_enabled(entry.edit.is_some(), button).clicked() {
            entry.command().into_iter().for_each(|command| queue.push(command));
        }
    }
}

/// What is done on the map, with it or beside it.
fn on_map(ui: &mut Ui, scene: &Scene<'_>, of: &Selection, queue: &mut Queue) {
    if let Selection::Leg(leg) = of
        && scene.selected_legs().len() < 2
    {
        let button = Button::new("Draw a new way from it").shortcut_text("W");
        let way = ui.add(button).on_hover_text("A branch, drawn on the map leg by leg");
        if way.clicked() {
            queue.view(ViewCommand::DrawWay(leg.clone()));
        }
        binding::of_leg(ui, scene, leg, queue);
    }
    if let Selection::Procedure(_) = of
        && ui.button("Place it on the map").clicked()
    {
        queue.view(ViewCommand::Select(Some(of.clone())));
        queue.view(ViewCommand::Tool("procedure"));
    }
}

/// It is neither a loop nor a fork, which are put around or before other legs.
fn is_flown_itself(choice: LegChoice) -> bool {
    choice.shape() != Shape::Nothing
}

/// The kinds that a leg can become; it keeps its place, as far as that can be.
fn kinds(ui: &mut Ui, scene: &Scene<'_>, leg: &Leg, queue: &mut Queue) {
    for (choice, changed) in other_kinds(scene, leg) {
        let button = ui.add_enabled(changed.is_some(), Button::new(choice.name()));
        let button = button.on_hover_text(choice.about());
        if let Some(edit) = changed.filter(|_| button.clicked()) {
            queue.edit(edit);
            ui.close();
        }
    }
}

/// Each other kind that a leg may have, with the edit; without one, it can't become that.
pub fn other_kinds(scene: &Scene<'_>, leg: &Leg) -> Vec<(LegChoice, Option<Edit>)> {
    let plan = scene.document.plan();
    let profile = Profile::by_name(&plan.aircraft).unwrap_or_default();
    let at = scene.forecast().start_of(&leg.first_flown().id);
    let now = LegChoice::of(&leg.kind);
    let replace = |with| Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(with) };
    let others = LegChoice::ALL
        .into_iter()
        .filter(|choice| is_flown_itself(now) && *choice != now && is_flown_itself(*choice));
    others.map(|choice| (choice, create::convert(plan, &profile, leg, choice, at).map(replace))).collect()
}

/// What can be done to it by one edit.
pub fn entries(scene: &Scene<'_>, of: &Selection) -> Vec<Entry> {
    let plan = scene.document.plan();
    let together = scene.selected_legs();
    match of {
        Selection::Leg(_) if together.len() > 1 && scene.is_selected(of) => of_legs(plan, &together),
        Selection::Leg(leg) => of_leg(plan, leg).into_iter().chain(pictures(scene, leg)).collect(),
        Selection::Stage(stage) => vec![
            Entry::new("Move up", "Ctrl+Up", create::shift_stage(plan, stage, -1)),
            Entry::new("Move down", "Ctrl+Down", create::shift_stage(plan, stage, 1)),
            Entry::new("Delete", "Del", Some(create::remove(plan, stage))),
        ],
        other => vec![
            Entry::new("Move up", "Ctrl+Up", create::shift_thing(plan, other.id(), -1)),
            Entry::new("Move down", "Ctrl+Down", create::shift_thing(plan, other.id(), 1)),
            Entry::new("Delete", "Del", Some(create::remove(plan, other.id()))),
        ],
    }
}

/// Of several legs that are selected together.
fn of_legs(plan: &FlightPlan, legs: &[Id]) -> Vec<Entry> {
    vec![
        Entry::making("Put them into a loop", create::loop_around(plan, legs), Selection::Leg),
        Entry::making("Put a fork around them", create::fork_around(plan, legs), Selection::Leg),
        Entry::making("Make a procedure of them", create::procedure_of(plan, legs), Selection::Procedure),
        Entry::new("Delete them", "Del", Some(create::delete_legs(plan, legs))),
    ]
}

/// Of a leg that is flown.
fn pictures(scene: &Scene<'_>, leg: &Id) -> Option<Entry> {
    let leg = scene.document.plan().any_leg(leg)?;
    let choice = LegChoice::of(&leg.kind);
    let (takes, edit) = footprints::toggled(scene, leg);
    let name = if takes { "Take no pictures along it" } else { "Take pictures along it" };
    let is_flown = is_flown_itself(choice) && choice != LegChoice::Call;
    is_flown.then(|| Entry::new(name, "", Some(edit)))
}

fn of_leg(plan: &FlightPlan, leg: &Id) -> Vec<Entry> {
    let one = std::slice::from_ref(leg);
    let is_loop = plan.leg(leg).is_some_and(|c| matches!(c.leg.kind, LegKind::Iterative { .. }));
    let mut entries = vec![
        Entry::new("Duplicate", "Ctrl+D", create::duplicate(plan, leg)),
        Entry::new("Move up", "Ctrl+Up", create::shift(plan, leg, -1)),
        Entry::new("Move down", "Ctrl+Down", create::shift(plan, leg, 1)),
        Entry::making("Put into a loop", create::loop_around(plan, one), Selection::Leg),
        Entry::making("Fork before it", create::fork_around(plan, one), Selection::Leg),
        Entry::making("Make a procedure of it", create::procedure_of(plan, one), Selection::Procedure),
    ];
    if is_loop {
        entries.push(Entry::new("Take its legs out of the loop", "", create::unloop(plan, leg)));
    }
    entries.push(Entry::new("Delete", "Del", Some(create::delete_leg(plan, leg))));
    entries
}
