//! Searching the plan: names, identifiers, kinds (also by the words of other programs), what stands beside them, and every
//! expression and condition.

use super::rows::Row;
use crate::actions::aliases;
use crate::command::{Queue, ViewCommand};
use crate::theme;
use egui::{Context, Id, Key, TextEdit, Ui};

fn id() -> Id {
    Id::unique("search the plan")
}

/// Puts the cursor into the field.
pub fn focus(ctx: &Context) {
    ctx.memory_mut(|m| m.request_focus(id()));
}

/// What was done in the field.
pub(super) struct Typed {
    pub changed: bool,
    pub entered: bool,
}

/// The field.
pub(super) fn field(ui: &mut Ui, sought: &mut String) -> Typed {
    let edit =
        TextEdit::singleline(sought).id(id()).hint_text("Search (Ctrl+F)").desired_width(f32::INFINITY);
    let response = ui.add(edit);
    let text = sought.clone();
    response.widget_info(|| {
        let mut info = egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Search the plan");
        info.current_text_value = Some(text.clone());
        info
    });
    let ended_by = |key| response.lost_focus() && ui.input(|i| i.key_pressed(key));
    let is_left = ended_by(Key::Escape);
    if is_left {
        sought.clear();
    }
    Typed { changed: is_left || response.changed(), entered: ended_by(Key::Enter) }
}

/// Says when nothing was found; Enter goes to the first thing that was.
pub(super) fn outcome(ui: &mut Ui, sought: &str, entered: bool, rows: &[Row], queue: &mut Queue) {
    if sought.trim().is_empty() {
        return;
    }
    let first = rows.iter().find(|row| is_match(row, &sought.trim().to_lowercase()));
    let Some(first) = first else {
        ui.colored_label(theme::of(ui).weak, format!("Nothing in the plan has “{}”.", sought.trim()));
        return;
    };
    if let Some(selection) = first.selection.clone().filter(|_| entered) {
        queue.view(ViewCommand::JumpTo(selection));
    }
}

/// The rows that match, and those that they are inside of.
pub(super) fn matching(rows: Vec<Row>, sought: &str) -> Vec<Row> {
    let sought = sought.to_lowercase();
    // from below: a row is kept for the sake of a deeper one after it
    let mut wanted_depth = 0;
    let mut kept: Vec<Row> = Vec::new();
    for row in rows.into_iter().rev() {
        if is_match(&row, &sought) || row.depth < wanted_depth {
            wanted_depth = row.depth;
            kept.push(row);
        }
    }
    kept.reverse();
    kept
}

/// Headings are not searched for.
fn is_match(row: &Row, sought: &str) -> bool {
    let Some(selection) = &row.selection else { return false };
    let is_said = [row.text.as_str(), selection.id().as_str(), row.tag, row.detail.as_str()]
        .into_iter()
        .chain(row.expressions.iter().map(|source| &**source))
        .any(|text| text.to_lowercase().contains(sought));
    is_said || aliases::means(sought, row.tag)
}

#[cfg(test)]
mod tests {
    use super::super::rows::rows;
    use crate::actions::aliases;
    use std::collections::BTreeSet;

    #[test]
    fn words_of_other_programs_mean_rows_that_there_are() {
        let everything = include_bytes!("../../../../shared/flight-plan/tests/data/everything.xml");
        let plan = flight_plan::read(everything).plan;
        let rows = rows(&plan, &BTreeSet::new());
        let there: BTreeSet<&str> = rows.iter().map(|row| row.tag).collect();
        for tag in aliases::tags() {
            assert!(there.contains(tag), "{tag} is not among {there:?}");
        }
    }
}
