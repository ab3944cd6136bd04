//! What a right click on a row of the tree offers. What cannot be done there is shown, but cannot be chosen.

use super::{Renamed, alternates};
use crate::command::{BranchId, Command, DocumentCommand, Queue, Selection, ViewCommand};
use crate::map::footprints;
use crate::panels::{Scene, binding, leading};
use crate::runways;
use aircraft::Profile;
use egui::{Button, Ui};
use flight_plan::create::{self, LegChoice, Shape};
use flight_plan::{Edit, FlightPlan, Id, Leg, LegKind};

/// One row of the menu.
#[derive(Debug)]
pub struct Entry {
    /// For people.
    pub name: &'static str,
    /// The key of the action that does the same; empty: there is none.
    pub keys: &'static str,
    /// What it does, or why it can't be done.
    edit: Result<Edit, &'static str>,
    /// What is selected after it.
    selects: Option<Selection>,
}

const NO_NEIGHBOUR: &str = "It has no neighbour there";
const GONE: &str = "It is no longer in the plan";
const IS_FORK: &str = "It is a fork: draw a new way from it (W)";
/// Why several can't be moved, or put into something, together.
pub const NOT_ONE_LIST: &str = "They are in several stages or loops: select legs of one";
const NOT_IN_A_ROW: &str = "They do not follow each other in one list: select legs that do";

/// What lets the fixes of a procedure move with it.
pub const MOVE_FIXES: &str = "Move its fixes along with the procedure";

impl Entry {
    fn new(name: &'static str, keys: &'static str, edit: Edit) -> Self {
        Self { name, keys, edit: Ok(edit), selects: None }
    }

    /// Among its neighbours, one up or down.
    fn shifting(name: &'static str, keys: &'static str, edit: Option<Edit>) -> Self {
        Self { name, keys, edit: edit.ok_or(NO_NEIGHBOUR), selects: None }
    }

    /// An entry that makes something, which is selected then; or why it can't.
    fn making(
        name: &'static str,
        made: Option<(Id, Edit)>,
        select: fn(Id) -> Selection,
        why_not: &'static str,
    ) -> Self {
        let (id, edit) = made.unzip();
        Self { name, keys: "", edit: edit.ok_or(why_not), selects: id.map(select) }
    }

    /// What it asks for.
    ///
    /// # Errors
    /// Why it can't be done.
    pub fn command(self) -> Result<Command, &'static str> {
        let select = self.selects.map(|made| Command::View(ViewCommand::Select(Some(made))));
        let edit = Command::Document(DocumentCommand::Edit(self.edit?));
        Ok(Command::Each([edit].into_iter().chain(select).collect()))
    }
}

/// The menu of what a row stands for.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, of: &Selection, queue: &mut Queue) {
    let plan = scene.document.plan();
    if let Selection::Leg(id) | Selection::Stage(id) = of
        && leading::button(ui, scene, id, queue)
    {
        ui.close();
    }
    if let Selection::Runway(runway) = of
        && ui.button("Emergency plan that lands here").clicked()
    {
        queue.document(DocumentCommand::BringHome {
            runway: runway.clone(),
            outwards: Vec::new(),
            from: None,
        });
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
        queue.view(ViewCommand::Rename(Renamed::Part(of.clone())));
    }
    on_map(ui, scene, of, queue);
    entries(scene, of).into_iter().for_each(|entry| show_entry(ui, entry, queue));
}

/// One that can't be done says why.
fn show_entry(ui: &mut Ui, entry: Entry, queue: &mut Queue) {
    let button = Button::new(entry.name).shortcut_text(entry.keys);
    let response = ui.add_enabled(entry.edit.is_ok(), button);
    match entry.command() {
        Ok(command) if response.clicked() => queue.push(command),
        Ok(_) => {}
        Err(why_not) => drop(response.on_disabled_hover_text(why_not)),
    }
}

/// The menu of a branch of a fork.
pub fn of_branch(ui: &mut Ui, plan: &FlightPlan, of: BranchId, queue: &mut Queue) {
    let BranchId { fork, branch } = &of;
    let delete =
        create::delete_branch(plan, fork, branch).ok_or("A fork keeps its last branch: delete the fork");
    let entries = [
        Entry::shifting("Move up", "Ctrl+Up", create::shift_branch(plan, fork, branch, -1)),
        Entry::shifting("Move down", "Ctrl+Down", create::shift_branch(plan, fork, branch, 1)),
        Entry { name: "Delete it and its legs", keys: "Del", edit: delete, selects: None },
    ];
    if ui.add(Button::new("Rename").shortcut_text("F2")).clicked() {
        queue.view(ViewCommand::Rename(Renamed::Branch(of)));
    }
    entries.into_iter().for_each(|entry| show_entry(ui, entry, queue));
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
        let button = button.on_hover_text(choice.about()).on_disabled_hover_text(NOT_THAT);
        if let Some(edit) = changed.filter(|_| button.clicked()) {
            queue.edit(edit);
            ui.close();
        }
    }
}

/// Why a leg can't become another kind.
pub const NOT_THAT: &str = "Its place and course are not known: it can't be that here";

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
    let (together, set) = (scene.selected_legs(), scene.selected_set());
    let is_of_set = set.len() > 1 && scene.is_selected(of);
    match of {
        _ if is_of_set && set.len() > together.len() => {
            vec![Entry::new("Delete them", "Del", create::delete_set(plan, &set))]
        }
        Selection::Leg(_) if is_of_set => of_legs(plan, &together),
        Selection::Leg(leg) => {
            let more = pictures(scene, leg).into_iter().chain(own_places(plan, leg));
            of_leg(plan, leg).into_iter().chain(more).collect()
        }
        Selection::Stage(stage) => vec![
            Entry::shifting("Move up", "Ctrl+Up", create::shift_stage(plan, stage, -1)),
            Entry::shifting("Move down", "Ctrl+Down", create::shift_stage(plan, stage, 1)),
            Entry::new("Delete", "Del", create::remove(plan, stage)),
        ],
        Selection::Fix(fix) => {
            let made = create::variable_of_fix(plan, fix);
            let bind = Entry::making("Make its place a variable", made, Selection::Variable, GONE);
            std::iter::once(bind).chain(of_thing(plan, fix)).collect()
        }
        Selection::Runway(runway) => {
            let made = runways::add_other_direction(plan, runway, scene.ground.0);
            let why_not = made.as_ref().err().copied().unwrap_or(GONE);
            let other = Entry::making(runways::ADD_OTHER, made.ok(), Selection::Runway, why_not);
            std::iter::once(other).chain(of_thing(plan, runway)).collect()
        }
        Selection::Procedure(procedure) => {
            of_thing(plan, procedure).into_iter().chain(own_places(plan, procedure)).collect()
        }
        other => of_thing(plan, other.id()).into(),
    }
}

/// Of a procedure, or a leg of one, that goes to fixes.
fn own_places(plan: &FlightPlan, of: &Id) -> Option<Entry> {
    create::own_places(plan, of).map(|edit| Entry::new(MOVE_FIXES, "", edit))
}

/// Of what is in a list of the plan and is not flown itself.
fn of_thing(plan: &FlightPlan, thing: &Id) -> [Entry; 3] {
    [
        Entry::shifting("Move up", "Ctrl+Up", create::shift_thing(plan, thing, -1)),
        Entry::shifting("Move down", "Ctrl+Down", create::shift_thing(plan, thing, 1)),
        Entry::new("Delete", "Del", create::remove(plan, thing)),
    ]
}

/// Of several legs that are selected.
fn of_legs(plan: &FlightPlan, legs: &[Id]) -> Vec<Entry> {
    let (looped, forked) = (create::loop_around(plan, legs), create::fork_around(plan, legs));
    let procedure = create::procedure_of(plan, legs);
    vec![
        Entry::making("Put them into a loop", looped, Selection::Leg, NOT_ONE_LIST),
        Entry::making("Put a fork around them", forked, Selection::Leg, NOT_IN_A_ROW),
        Entry::making("Make a procedure of them", procedure, Selection::Leg, NOT_ONE_LIST),
        Entry::new("Delete them", "Del", create::delete_legs(plan, legs)),
    ]
}

/// What begins and ends the taking of pictures along a leg.
pub const PICTURES: [&str; 2] = ["Take pictures along it", "Take no pictures along it"];

/// Of a leg that is flown.
fn pictures(scene: &Scene<'_>, leg: &Id) -> Option<Entry> {
    let leg = scene.document.plan().any_leg(leg)?;
    let choice = LegChoice::of(&leg.kind);
    let (takes, edit) = footprints::toggled(scene, leg);
    let [take, take_none] = PICTURES;
    let name = if takes { take_none } else { take };
    let is_flown = is_flown_itself(choice) && choice != LegChoice::Call;
    is_flown.then(|| Entry::new(name, "", edit))
}

fn of_leg(plan: &FlightPlan, leg: &Id) -> Vec<Entry> {
    let one = std::slice::from_ref(leg);
    let is_loop = plan.leg(leg).is_some_and(|c| matches!(c.leg.kind, LegKind::Iterative { .. }));
    let made = |name, made, select| Entry::making(name, made, select, GONE);
    let duplicate = create::duplicate(plan, leg).ok_or(GONE);
    let mut entries = vec![
        Entry { name: "Duplicate", keys: "Ctrl+D", edit: duplicate, selects: None },
        Entry::shifting("Move up", "Ctrl+Up", create::shift(plan, leg, -1)),
        Entry::shifting("Move down", "Ctrl+Down", create::shift(plan, leg, 1)),
        made("Put into a loop", create::loop_around(plan, one), Selection::Leg),
        made("Fork before it", create::fork_around(plan, one), Selection::Leg),
        Entry::making("Fork behind it", create::fork_behind(plan, leg), Selection::Leg, IS_FORK),
        made("Make a procedure of it", create::procedure_of(plan, one), Selection::Leg),
    ];
    if is_loop {
        let edit = create::unloop(plan, leg).ok_or("The loop has no legs");
        entries.push(Entry { name: "Take its legs out of the loop", keys: "", edit, selects: None });
    }
    entries.push(Entry::new("Delete", "Del", create::delete_leg(plan, leg)));
    entries
}
