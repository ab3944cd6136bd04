//! What another program's file becomes, and what becomes of the plan in another program's format: a list of what was assumed,
//! changed or left out, before anything is replaced or written.

mod runway;

use super::counted::{contents, listed, number};
use super::{Scene, dialog, primary_button};
use crate::command::{DocumentCommand, Queue, ViewCommand};
use crate::export::Exported;
use crate::files::{Choices, Imported, Lines};
use crate::map::drawings;
use crate::{formats, theme};
use egui::style::ScrollStyle;
use egui::{Key, Label, Rect, RichText, ScrollArea, Ui};
use flight_plan::{FlightPlan, Id};
use interchange::{Areas, Note};

const WIDTH: f32 = 560.0;
const LIST_HEIGHT: f32 = 220.0;
const ROW: f32 = 20.0;
/// More notes than these have a line each, cut where it ends, and are whole in a tooltip.
const MOST_WRAPPED: usize = 200;

/// Draws it, while there is something to be decided.
pub fn show(ui: &mut Ui, room: Rect, scene: &Scene<'_>, queue: &mut Queue) {
    // one question at a time
    if scene.view.browsing.is_some() {
        return;
    }
    let is_given_up = |id: &str, add: &mut dyn FnMut(&mut Ui)| {
        dialog::show(ui, room, scene, id, |ui| {
            ui.set_width(WIDTH);
            add(ui);
        })
    };
    if let Some(imported) = &scene.view.imported {
        if is_given_up("import", &mut |ui| import(ui, imported, scene, queue)) {
            queue.view(ViewCommand::PutImportAside);
        }
    } else if let Some(exported) = &scene.view.exported
        && is_given_up("export", &mut |ui| export(ui, exported, scene, queue))
    {
        queue.view(ViewCommand::PutExportAside);
    }
}

fn import(ui: &mut Ui, imported: &Imported, scene: &Scene<'_>, queue: &mut Queue) {
    let name = imported.path.file_name().unwrap_or_default().to_string_lossy();
    ui.strong(format!("Import “{name}” ({})", formats::label(imported.format)));
    let adds = may_be_added(imported, scene);
    ui.label(as_new(imported, scene, adds));
    if adds {
        ui.label(as_addition(imported, scene));
    }
    if imported.import.has_areas() {
        areas(ui, imported, queue);
    }
    if adds && drawings::has_lines(&imported.features) {
        lines(ui, imported, queue);
    }
    runway::choose(ui, imported, scene, queue);
    let title =
        if adds { "As a new plan: assumed, changed or left out" } else { "Assumed, changed or left out" };
    notes(ui, title, &imported.import.notes, &imported.import.plan);
    ui.horizontal(|ui| {
        let text = if adds { "As a new plan" } else { "Import the plan" };
        if main_button(ui, text) {
            queue.document(DocumentCommand::TakeImport);
        }
        if adds {
            into_plan(ui, imported, queue);
        }
        if ui.button("Cancel").clicked() {
            queue.view(ViewCommand::PutImportAside);
        }
    });
}

/// What comes of it in the place of the plan that is open.
fn as_new(imported: &Imported, scene: &Scene<'_>, adds: bool) -> String {
    let has = contents(&imported.import.plan);
    let mut text =
        if adds { format!("As a new plan it has {has}.") } else { format!("It becomes a plan with {has}.") };
    if !scene.document.is_nobodys() {
        let name = &scene.document.plan().name;
        text.push_str(&format!(" It takes the place of “{name}”; undo brings that back."));
    }
    text
}

/// What comes of it in the plan that is open.
fn as_addition(imported: &Imported, scene: &Scene<'_>) -> String {
    let counts = drawings::counts(&imported.features, &imported.choices);
    let is_flown =
        counts.iter().any(|(count, what)| *count > 0 && ["corridor", "leg", "scan"].contains(what));
    let whereto = drawings::whereto(scene.document.plan(), scene.view.selection.as_ref());
    let whereto =
        whereto.filter(|_| is_flown).map_or_else(String::new, |place| format!(", what is flown {place}"));
    format!("Into this plan, as one step, {}{whereto}.", coming(&counts))
}

/// `come 2 fixes and 1 zone`, `comes 1 corridor`.
fn coming(parts: &[(usize, &str)]) -> String {
    let is_one = parts.iter().map(|(count, _)| count).sum::<usize>() <= 1;
    format!("{} {}", if is_one { "comes" } else { "come" }, listed(parts))
}

/// It is a drawing, and there is a plan to draw it into.
fn may_be_added(imported: &Imported, scene: &Scene<'_>) -> bool {
    !imported.features.is_empty() && !scene.document.plan().stages.is_empty()
}

fn into_plan(ui: &mut Ui, imported: &Imported, queue: &mut Queue) {
    let possible = drawings::may_add(&imported.features, &imported.choices);
    let response = ui.add_enabled(possible.is_ok(), egui::Button::new("Into this plan"));
    let what = "Points become fixes, lines and areas what is chosen above";
    if response.on_hover_text(what).on_disabled_hover_text(possible.err().unwrap_or_default()).clicked() {
        queue.document(DocumentCommand::AddImport);
    }
}

/// The main thing to do here, which Enter does too.
fn main_button(ui: &mut Ui, text: &str) -> bool {
    let button = ui.add(primary_button(text, theme::of(ui)));
    // Enter on another button is for that
    let nothing_else = ui.memory(|m| m.focused().is_none());
    button.clicked() || (nothing_else && ui.input(|i| i.key_pressed(Key::Enter)))
}

/// What the drawn areas are: nobody but the user can say.
fn areas(ui: &mut Ui, imported: &Imported, queue: &mut Queue) {
    ui.horizontal(|ui| {
        ui.label("Its areas are");
        for (label, areas) in [
            ("scanned", Areas::Scan),
            ("zones to stay inside of", Areas::KeepIn),
            ("zones to keep out of", Areas::KeepOut),
        ] {
            let chosen = imported.choices.areas == areas;
            if ui.radio(chosen, label).clicked() && !chosen {
                let choices = Choices { areas, ..imported.choices.clone() };
                queue.document(DocumentCommand::ImportAs(Box::new(choices)));
            }
        }
    });
}

/// What the drawn lines are in this plan.
fn lines(ui: &mut Ui, imported: &Imported, queue: &mut Queue) {
    ui.horizontal(|ui| {
        ui.label("In this plan its lines are");
        for (label, lines) in [("corridors", Lines::Corridors), ("legs from point to point", Lines::Tracks)] {
            let chosen = imported.choices.lines == lines;
            if ui.radio(chosen, label).clicked() && !chosen {
                let choices = Choices { lines, ..imported.choices.clone() };
                queue.document(DocumentCommand::ImportAs(Box::new(choices)));
            }
        }
    });
}

fn export(ui: &mut Ui, exported: &Exported, scene: &Scene<'_>, queue: &mut Queue) {
    ui.strong(format!("Export “{}” as {}", exported.name, formats::label(exported.format)));
    ui.label(format!(
        "{}, as they are flown in calm air when nobody decides otherwise. Altitudes are above mean sea level there.",
        number(exported.waypoints, "waypoint")
    ));
    notes(ui, "Not in the file, or not as in the plan", &exported.notes, scene.document.plan());
    ui.horizontal(|ui| {
        if main_button(ui, "Save as…") {
            queue.document(DocumentCommand::AskExport);
        }
        if ui.button("Cancel").clicked() {
            queue.view(ViewCommand::PutExportAside);
        }
    });
}

/// `plan`: what the notes name is in it.
fn notes(ui: &mut Ui, title: &str, notes: &[Note], plan: &FlightPlan) {
    ui.add_space(4.0);
    if notes.is_empty() {
        ui.label(RichText::new("✔ Nothing is lost or changed.").color(theme::of(ui).good));
        ui.add_space(8.0);
        return;
    }
    super::group_title(ui, &format!("{title} ({})", notes.len()));
    ui.separator();
    // that there is more is seen before the pointer is there
    ui.spacing_mut().scroll = ScrollStyle::solid();
    let area = ScrollArea::vertical().auto_shrink([false, true]).max_height(LIST_HEIGHT);
    if notes.len() <= MOST_WRAPPED {
        area.show(ui, |ui| notes.iter().for_each(|note| drop(ui.add(Label::new(text(note, plan)).wrap()))));
    } else {
        area.show_rows(ui, ROW - ui.spacing().item_spacing.y, notes.len(), |ui, shown| {
            for note in notes.get(shown).unwrap_or_default() {
                let text = text(note, plan);
                ui.add(Label::new(&text).truncate()).on_hover_text(&text);
            }
        });
    }
    ui.separator();
    ui.add_space(4.0);
}

fn text(note: &Note, plan: &FlightPlan) -> String {
    let remedy = if note.code == "aircraft-assumed" {
        "; choose it in the inspector of the plan, under Aircraft"
    } else {
        ""
    };
    format!("{}: {}{remedy}", place(note, plan), plan.in_names(&note.message))
}

/// By its name, and of which procedure it is: that stands elsewhere in the tree.
fn place(note: &Note, plan: &FlightPlan) -> String {
    let id = Id::new(&note.place);
    let name = plan.label(&id);
    match plan.procedure_leg(&id) {
        Some((procedure, _)) => format!("{name} (in procedure {})", plan.label(&procedure.id)),
        None => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_thing_comes_and_several_come() {
        assert_eq!(coming(&[(0, "fix"), (1, "corridor")]), "comes 1 corridor");
        assert_eq!(coming(&[(1, "fix"), (1, "zone")]), "come 1 fix and 1 zone");
        assert_eq!(coming(&[(0, "fix")]), "comes nothing that can be flown");
    }

    #[test]
    fn a_note_on_a_leg_of_a_procedure_says_so() {
        let text = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><procedures>
            <procedure id="look" name="Look around" reference="46 9"><TF id="up" name="Up" lat="46" lon="9"/></procedure>
            </procedures></flightPlan>"#;
        let plan = flight_plan::read(text).plan;
        let of = |place: &str| Note { code: "flattened", place: place.into(), message: "lost".into() };
        assert_eq!(super::text(&of("up"), &plan), "Up (in procedure Look around): lost");
        assert_eq!(super::text(&of("line 7"), &plan), "line 7: lost");
    }

    #[test]
    fn a_note_names_parts_of_the_plan_as_problems_do() {
        let plan = flight_plan::read(include_str!("../../../assets/plans/square.xml")).plan;
        let note = Note {
            code: "runway-assumed",
            place: "item 4".into(),
            message: "runway `R05` is taken to be short, and `nothing` is left out".into(),
        };
        let told = text(&note, &plan);
        assert_eq!(told, "item 4: runway “R05” is taken to be short, and “nothing” is left out");
    }
}
