//! A field for an expression or a condition: what it gives stands below, or what is wrong with it, marked where it is wrong
//! while it is typed; what may come next is offered.

use super::page::Page;
use crate::panels::field;
use crate::theme;
use egui::text::{CCursor, CCursorRange, LayoutJob};
use egui::text_edit::TextEditState;
use egui::{FontSelection, Id, Key, Modifiers, RichText, Stroke, TextEdit, TextFormat, TextStyle, Ui};
use flight_plan::describe::{Completion, Formula, completions, look};
use flight_plan::{Use, VariableValue};

/// So many words are offered.
const OFFERED: usize = 6;

/// The field as it stands.
pub struct Typing {
    id: Id,
    text: String,
    /// Bytes before the cursor.
    cursor: usize,
    focused: bool,
    /// It was left in this frame.
    left: bool,
    used: Use,
}

/// Of the field that is drawn next, if it is one.
pub fn id(ui: &Ui, name: &str) -> Id {
    ui.auto_id_with(("formula", name))
}

/// Gives a field that is drawn from the next frame on the keyboard, all of its text selected.
pub fn begin(ui: &Ui, id: Id, text: &str) {
    let mut state = TextEditState::default();
    let all = CCursorRange::two(CCursor::default(), CCursor::new(text.chars().count()));
    state.cursor.set_char_range(Some(all));
    state.store(ui.ctx(), id);
    ui.memory_mut(|m| m.request_focus(id));
}

/// Width of a small button with its gap, screen points.
const BUTTON: f32 = 30.0;

/// Draws the field itself, with room for so many small buttons beside it; [`Typing::finish`] draws what belongs below it.
pub fn field(
    ui: &mut Ui,
    page: &Page<'_, '_>,
    (name, source): (&str, &str),
    used: Use,
    buttons: usize,
) -> Typing {
    let id = id(ui, name);
    let mut text = ui.data(|d| d.get_temp::<String>(id)).unwrap_or_else(|| source.to_owned());
    if ui.memory(|m| m.has_focus(id)) {
        choose_by_key(ui, page, id, &mut text);
    }
    let column = look(page.plan(), page.subject(), &text, used).err().map(|fault| fault.column);
    let mut layouter = |ui: &Ui, text: &dyn egui::TextBuffer, _: f32| {
        let job = marked(ui, text.as_str(), column.filter(|_| !text.as_str().is_empty()));
        ui.fonts_mut(|fonts| fonts.layout_job(job))
    };
    let width = ui.available_width() - buttons as f32 * BUTTON;
    let edit = TextEdit::singleline(&mut text).id(id).desired_width(width).layouter(&mut layouter);
    let output = edit.show(ui);
    let (response, cursor) = (output.response.response.clone(), output.cursor_range);
    let (label, value) = (name.to_owned(), text.clone());
    response.widget_info(move || {
        let mut info = egui::WidgetInfo::labeled(egui::Role::TextInput, true, &label);
        info.current_text_value = Some(value.clone());
        info
    });
    let cursor = cursor.map_or(text.len(), |range| bytes_before(&text, range.primary.index.0));
    let (focused, left) = (response.has_focus(), response.lost_focus());
    match focused {
        true => ui.data_mut(|d| {
            d.insert_temp(id, text.clone());
        }),
        false => ui.data_mut(|d| d.remove::<String>(id)),
    }
    Typing { id, text, cursor, focused, left, used }
}

fn bytes_before(text: &str, characters: usize) -> usize {
    text.char_indices().nth(characters).map_or(text.len(), |(at, _)| at)
}

/// The text, underlined where it is wrong.
fn marked(ui: &Ui, text: &str, column: Option<usize>) -> LayoutJob {
    let p = theme::of(ui);
    let font = FontSelection::from(TextStyle::Monospace).resolve(ui.style());
    let plain = TextFormat::simple(font, p.text);
    let wrong = TextFormat { underline: Stroke::new(2.0, p.warning), ..plain.clone() };
    let from = column.map_or(text.len(), |column| bytes_before(text, column.saturating_sub(1)));
    // behind the end: the last character
    let last = text.char_indices().next_back().map_or(0, |(at, _)| at);
    let from = if column.is_some() { from.min(last) } else { from };
    let (before, rest) = text.split_at(from);
    let word = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
    let first = rest.chars().next().map_or(0, char::len_utf8);
    let (word, behind) = rest.split_at(word.max(first));
    let mut job = LayoutJob::default();
    job.append(before, 0.0, plain.clone());
    job.append(word, 0.0, wrong);
    job.append(behind, 0.0, plain);
    job
}

/// Down and up go through what is offered, Enter takes it.
fn choose_by_key(ui: &Ui, page: &Page<'_, '_>, id: Id, text: &mut String) {
    let Some(state) = TextEditState::load(ui.ctx(), id) else { return };
    let Some(range) = state.cursor.char_range() else { return };
    let cursor = bytes_before(text, range.primary.index.0);
    let (begun, offers) = offers(page, text, cursor);
    let last = offers.len().checked_sub(1);
    let picked = id.with("picked");
    let pick = ui.data(|d| d.get_temp::<usize>(picked)).filter(|_| last.is_some());
    let consume = |key| ui.input_mut(|i| i.consume_key(Modifiers::NONE, key));
    let pick = match (last, pick) {
        (Some(last), pick) if consume(Key::ArrowDown) => Some(pick.map_or(0, |p| p + 1).min(last)),
        (Some(_), pick) if consume(Key::ArrowUp) => pick.and_then(|p| p.checked_sub(1)),
        (_, pick) => pick,
    };
    match pick.and_then(|p| offers.get(p)) {
        Some(offer) if consume(Key::Enter) => {
            take(ui, id, text, cursor, begun, offer);
            ui.data_mut(|d| d.remove::<usize>(picked));
        }
        Some(_) => ui.data_mut(|d| {
            d.insert_temp(picked, pick.unwrap_or(0));
        }),
        None => ui.data_mut(|d| d.remove::<usize>(picked)),
    }
}

/// How much of a word was begun, bytes, and what it may become.
fn offers(page: &Page<'_, '_>, text: &str, cursor: usize) -> (usize, Vec<Completion>) {
    let before = text.get(..cursor).unwrap_or("");
    let (begun, mut offers) = completions(page.plan(), page.subject(), before);
    // after a whole word nothing is begun
    if begun == 0 && !before.trim().is_empty() && !before.ends_with('\'') {
        offers.clear();
    }
    offers.truncate(OFFERED);
    (begun, offers)
}

/// Puts an offered word in the place of the one that was begun, and the cursor behind it.
fn take(ui: &Ui, id: Id, text: &mut String, cursor: usize, begun: usize, offer: &Completion) {
    text.replace_range(cursor.saturating_sub(begun)..cursor, &offer.word);
    let end = cursor.saturating_sub(begun) + offer.word.len();
    let characters = text.get(..end).map_or(0, |t| t.chars().count());
    let mut state = TextEditState::load(ui.ctx(), id).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::one(CCursor::new(characters))));
    state.store(ui.ctx(), id);
    ui.data_mut(|d| d.insert_temp(id, text.clone()));
}

impl Typing {
    /// Draws what it gives or what is wrong, and what is offered. The new source, once the field was left.
    pub fn finish(
        mut self,
        ui: &mut Ui,
        page: &Page<'_, '_>,
        unit: Option<crate::units::Unit>,
    ) -> Option<String> {
        self.say(ui, page, unit);
        if (self.focused || self.left) && self.offer(ui, page) {
            ui.memory_mut(|m| m.request_focus(self.id));
            return None;
        }
        self.left.then(|| self.text.trim().trim_start_matches('=').trim().to_owned())
    }

    fn say(&self, ui: &mut Ui, page: &Page<'_, '_>, unit: Option<crate::units::Unit>) {
        let p = theme::of(ui);
        let has_its_unit = unit.is_some_and(|unit| unit.read(&self.text).is_ok())
            && self.text.trim().parse::<f64>().is_err();
        if self.text.trim().is_empty() || has_its_unit {
            return;
        }
        let (text, colour) = match look(page.plan(), page.subject(), &self.text, self.used) {
            Ok(Formula::Value(VariableValue::Number(n))) if let Some(unit) = unit => {
                (format!("= {}", unit.show(n)), p.weak)
            }
            Ok(Formula::Value(value)) => {
                (format!("= {} at the start", crate::state::log::variable(&value)), p.weak)
            }
            Ok(Formula::Nothing(why)) => (why, p.caution),
            Err(fault) => (format!("⚠ Column {}: {}", fault.column, fault.message), p.warning),
        };
        field::row_with_help(ui, "", "", |ui| {
            ui.add(egui::Label::new(RichText::new(text).size(12.0).color(colour)).wrap());
        });
    }

    /// True when one was taken.
    fn offer(&mut self, ui: &mut Ui, page: &Page<'_, '_>) -> bool {
        let (begun, offers) = offers(page, &self.text, self.cursor);
        let pick = ui.data(|d| d.get_temp::<usize>(self.id.with("picked")));
        let mut taken = false;
        for (index, offer) in offers.iter().enumerate() {
            ui.horizontal(|ui| {
                let word = RichText::new(&offer.word).monospace();
                if ui.selectable_label(pick == Some(index), word).clicked() {
                    take(ui, self.id, &mut self.text, self.cursor, begun, offer);
                    taken = true;
                }
                let about = RichText::new(&offer.about).size(12.0).color(theme::of(ui).weak);
                ui.add(egui::Label::new(about).truncate());
            });
        }
        taken
    }
}
