//! Fields: numbers with units, expressions, and buttons that must be held.

mod hold;
mod list;

pub use hold::{HOLD_HEIGHT, held_already, hold_button};
pub use list::{About, List};

use crate::theme;
use crate::units::Unit;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Context, DragValue, Id, IdSalt, Key, Response, RichText, Ui, vec2};
use std::cell::RefCell;
use std::ops::RangeInclusive;

/// What happened to a field.
#[derive(Debug, Clone, PartialEq)]
pub enum Change<T> {
    /// Nothing.
    None,
    /// It is being dragged and has this value for now.
    Moving(T),
    /// It has this value.
    Set(T),
    /// The drag is over.
    Ended,
}

impl<T> Change<T> {
    /// The same, for something made of the value.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Change<U> {
        match self {
            Self::None => Change::None,
            Self::Moving(value) => Change::Moving(f(value)),
            Self::Set(value) => Change::Set(f(value)),
            Self::Ended => Change::Ended,
        }
    }
}

/// A row with a name on the left and a field on the right.
pub fn row<R>(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        self::name(ui, name, 74.0);
        add(ui)
    })
    .inner
}

/// The same; what the value is stands in the name's tooltip.
pub fn row_with_help<R>(ui: &mut Ui, name: &str, help: &str, add: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let label = ui.scope(|ui| self::name(ui, name, 92.0)).response;
        if !help.is_empty() {
            label.on_hover_text(format!("{name}: {help}"));
        }
        add(ui)
    })
    .inner
}

/// The name of a value, in a column of its own.
pub fn name(ui: &mut Ui, name: &str, width: f32) {
    let p = theme::of(ui);
    let height = ui.spacing().interact_size.y.min(ui.available_height());
    let layout = egui::Layout::left_to_right(egui::Align::Center);
    ui.allocate_ui_with_layout(vec2(width, height), layout, |ui| {
        ui.set_min_width(width);
        ui.add(egui::Label::new(RichText::new(name).color(p.weak)).truncate());
    });
}

fn focus_asked() -> Id {
    Id::unique("the next number gets the keyboard")
}

/// More than any number has in its field.
const MOST_DIGITS: usize = 64;

/// In the place of a number that could not be read.
const UNREADABLE: &str = "?";

/// The number that is drawn next gets the keyboard.
pub fn focus_next(ctx: &Context) {
    ctx.data_mut(|d| d.insert_temp(focus_asked(), true));
}

/// This number gets the keyboard: what is typed takes its place.
pub fn focus(number: &Response) {
    number.request_focus();
    let mut state = TextEditState::default();
    let whole = CCursorRange::two(CCursor::new(0), CCursor::new(MOST_DIGITS));
    state.cursor.set_char_range(Some(whole));
    state.store(&number.ctx, number.id);
}

/// A number in a unit, stored in SI.
pub fn number(ui: &mut Ui, name: &str, si: f64, unit: Unit, least_si: f64) -> Change<f64> {
    number_between(ui, name, si, unit, least_si..=f64::MAX)
}

/// The same with a greatest value too.
pub fn number_between(
    ui: &mut Ui,
    name: &str,
    si: f64,
    unit: Unit,
    range_si: RangeInclusive<f64>,
) -> Change<f64> {
    numbered(ui, name, si, unit, range_si).0
}

/// A number that Return does something with: whether that was pressed in it now.
pub fn number_to_enter(ui: &mut Ui, name: &str, si: f64, unit: Unit) -> (Change<f64>, bool) {
    let (change, field) = numbered(ui, name, si, unit, f64::MIN..=f64::MAX);
    (change, field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter)))
}

/// The same with what it is drawn as.
pub fn numbered(
    ui: &mut Ui,
    name: &str,
    si: f64,
    unit: Unit,
    range_si: RangeInclusive<f64>,
) -> (Change<f64>, Response) {
    numbered_as(ui, name, si, unit, range_si, |text| unit.read(text))
}

/// The same where more than a number and its unit may be typed; `read` gives the number in the unit, or why it is none.
pub fn numbered_as(
    ui: &mut Ui,
    name: &str,
    si: f64,
    unit: Unit,
    range_si: RangeInclusive<f64>,
    read: impl Fn(&str) -> Result<f64, String>,
) -> (Change<f64>, Response) {
    let typed = Typed::of(ui);
    let is_known = si.is_finite();
    // one that is not equal to itself would be a change in every frame
    let before = if is_known { unit.from_si(si) } else { f64::INFINITY };
    let decimals = unit.decimals.max(1);
    let mut shown = before;
    let drag = DragValue::new(&mut shown)
        .suffix(format!(" {}", unit.symbol))
        .max_decimals(decimals)
        // what is not known can't be dragged from there
        .speed(if is_known { unit.from_si(1.0).max(0.05) } else { 0.0 })
        .range(unit.from_si(*range_si.start())..=unit.from_si(*range_si.end()))
        // what is only looked at stays as it is, however wrong
        .clamp_existing_to_range(false)
        .update_while_editing(false)
        .custom_parser(|text| if text.trim() == UNREADABLE { None } else { typed.take(read(text)) });
    let drag = if is_known { drag } else { drag.custom_formatter(|_, _| UNREADABLE.to_owned()) };
    let (usual, warning) = (ui.visuals().override_text_color, theme::of(ui).warning);
    ui.visuals_mut().override_text_color = if is_known { usual } else { Some(warning) };
    let response = ui.add_sized([78.0, 24.0], drag);
    ui.visuals_mut().override_text_color = usual;
    if ui.data_mut(|d| d.remove_temp::<bool>(focus_asked())).is_some() {
        focus(&response);
    }
    named(&response, name, shown);
    typed.tell(ui, &response);
    // a field that was only entered and left gives the number back as it is shown
    let is_rounded = !response.dragged() && (shown - before).abs() < 0.5 * 0.1_f64.powi(decimals as i32);
    let change =
        if response.changed() && is_rounded { Change::None } else { outcome(&response, unit.to_si(shown)) };
    (change, response)
}

/// What was typed into a field of a number, and why it could not be read.
#[derive(Debug)]
pub struct Typed {
    refused: RefCell<Option<String>>,
    /// The same in the next frame, whichever part of the field has the keyboard.
    id: Id,
}

/// Seconds for which it is said why a number was not taken.
const REFUSED_S: f64 = 8.0;

impl Typed {
    /// For the field that is drawn next.
    pub fn of(ui: &Ui) -> Self {
        Self { refused: RefCell::default(), id: ui.next_auto_id().with("refused") }
    }

    /// In this unit; for the parser of a field.
    pub fn read(&self, unit: Unit, text: &str) -> Option<f64> {
        self.take(unit.read(text))
    }

    /// The same for what has been read already.
    pub fn take(&self, read: Result<f64, String>) -> Option<f64> {
        read.map_err(|why| *self.refused.borrow_mut() = Some(why)).ok()
    }

    /// Says at the field why what was typed was not taken, until something else is typed or some time has passed.
    pub fn tell(self, ui: &Ui, field: &Response) {
        let id = self.id;
        let now = ui.input(|i| i.time);
        if let Some(why) = self.refused.into_inner() {
            ui.data_mut(|d| d.insert_temp(id, (why, now)));
        } else if field.gained_focus() {
            ui.data_mut(|d| d.remove::<(String, f64)>(id));
        }
        let Some((why, since)) = ui.data(|d| d.get_temp::<(String, f64)>(id)) else { return };
        let left_s = since + REFUSED_S - now;
        if left_s > 0.0 {
            ui.ctx().request_repaint_after_secs(left_s as f32);
            field.show_tooltip_text(format!("⚠ {why}. Nothing was changed."));
        }
    }
}

/// Gives a spin button a name, which its text alone is not.
fn named(response: &Response, name: &str, value: f64) {
    let (name, enabled) = (name.to_owned(), response.enabled());
    response.widget_info(move || {
        let mut info = egui::WidgetInfo::labeled(egui::Role::SpinButton, enabled, &name);
        info.value = Some(value);
        info
    });
}

fn outcome<T>(response: &Response, value: T) -> Change<T> {
    match (response.changed(), response.dragged(), response.drag_stopped()) {
        (true, true, _) => Change::Moving(value),
        (true, false, _) => Change::Set(value),
        (_, _, true) => Change::Ended,
        _ => Change::None,
    }
}

/// A choice among several: the index of the one that was chosen now. A text that is too long is cut, and whole in the tooltip.
pub fn choice(ui: &mut Ui, name: &str, options: &[&str], now: Option<usize>) -> Option<usize> {
    let shown = now.and_then(|now| options.get(now)).copied().unwrap_or("choose …");
    let button = ui.make_persistent_id(IdSalt::new(("choice", name)));
    let width = (ui.available_width() - 8.0).clamp(40.0, 170.0);
    let combo = egui::ComboBox::from_id_salt(("choice", name)).width(width).truncate().selected_text(shown);
    let options: Vec<About<'_>> = options.iter().map(|option| (*option, "")).collect();
    let response = combo.show_ui(ui, |ui| list::show(ui, button, &options, now));
    let chosen = response.inner.flatten().filter(|chosen| now != Some(*chosen));
    let (name, enabled) = (name.to_owned(), ui.is_enabled());
    response.response.on_hover_text(shown).widget_info(move || {
        let mut info = egui::WidgetInfo::labeled(egui::Role::ComboBox, enabled, &name);
        info.current_text_value = Some(shown.to_owned());
        info
    });
    chosen
}

/// A small button with a symbol, named for what it does.
pub fn small_button(ui: &mut Ui, symbol: &str, name: &str) -> bool {
    small_button_response(ui, symbol, name).clicked()
}

/// The same, with all that happened to it.
pub fn small_button_response(ui: &mut Ui, symbol: &str, name: &str) -> Response {
    let response = ui.small_button(symbol).on_hover_text(name);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
    response
}

/// A text, taken when the field is left or Enter is pressed.
pub fn text(ui: &mut Ui, name: &str, current: &str) -> Option<String> {
    let width = ui.available_width() - 30.0;
    text_of_width(ui, name, current, "", width)
}

/// A text that may be refused: what was typed then stays, in red, with the reason below it.
pub fn text_unless(
    ui: &mut Ui,
    name: &str,
    current: &str,
    refuses: &dyn Fn(&str) -> Option<String>,
) -> Option<String> {
    let id = ui.scope_id().with(("refused", name));
    let refused = ui.data(|d| d.get_temp::<(String, String)>(id)).filter(|(of, _)| of == current);
    let shown = refused.as_ref().map_or(current, |(_, typed)| typed);
    let why = refused.as_ref().and_then(|(_, typed)| refuses(typed));
    let warning = crate::theme::of(ui).warning;
    let typed = ui.vertical(|ui| {
        let typed = ui.scope(|ui| {
            ui.visuals_mut().override_text_color = why.as_ref().map(|_| warning);
            text(ui, name, shown)
        });
        if let Some(why) = &why {
            ui.add(egui::Label::new(egui::RichText::new(why).size(12.0).color(warning)).wrap());
        }
        typed.inner
    });
    let typed = typed.inner?;
    if typed != current && refuses(&typed).is_some() {
        ui.data_mut(|d| d.insert_temp(id, (current.to_owned(), typed)));
        return None;
    }
    ui.data_mut(|d| d.remove::<(String, String)>(id));
    (typed != current).then_some(typed)
}

/// What is being typed into the field of a text that is drawn next.
pub fn draft(ui: &Ui, name: &str) -> Option<String> {
    let id = text_id(ui, name);
    ui.data(|d| d.get_temp(id))
}

fn text_id(ui: &Ui, name: &str) -> Id {
    ui.auto_id_with(("field", name))
}

/// The same, so many screen points wide.
pub fn text_of_width(ui: &mut Ui, name: &str, current: &str, hint: &str, width: f32) -> Option<String> {
    let id = text_id(ui, name);
    let mut draft = ui.data(|d| d.get_temp::<String>(id)).unwrap_or_else(|| current.to_owned());
    let edit = egui::TextEdit::singleline(&mut draft).id(id).hint_text(hint);
    let edit = edit.desired_width(width);
    let response = ui.add(edit);
    let label = name.to_owned();
    response.widget_info(|| {
        let mut info = egui::WidgetInfo::labeled(egui::Role::TextInput, true, &label);
        info.current_text_value = Some(draft.clone());
        info
    });
    if response.has_focus() {
        ui.data_mut(|d| d.insert_temp(id, draft));
        return None;
    }
    ui.data_mut(|d| d.remove::<String>(id));
    (response.lost_focus() && draft != current).then_some(draft)
}

/// Something is being typed, or was until this frame: Escape and a click elsewhere have taken the keyboard from the field
/// before anything is drawn, and mean that only.
pub fn is_typing(ctx: &Context) -> bool {
    ctx.text_edit_focused() || ctx.data(|d| d.get_temp(was_typing())).unwrap_or(false)
}

/// Notes at the end of a frame whether something is being typed.
pub fn note_typing(ctx: &Context) {
    let typing = ctx.text_edit_focused();
    ctx.data_mut(|d| d.insert_temp(was_typing(), typing));
}

fn was_typing() -> Id {
    Id::unique("something was being typed")
}

/// A button was pressed, however long: who has just held another one holds this one, too. By the primary button of the mouse only,
/// as a click.
pub fn is_pressed(button: &Response) -> bool {
    let id = button.id.with("is down");
    let is_primary = button.ctx.input(|i| i.pointer.primary_down());
    let is_down = button.enabled() && is_primary && button.is_pointer_button_down_on();
    let was_down = button.ctx.data(|d| d.get_temp::<bool>(id)).unwrap_or(false);
    if was_down != is_down {
        button.ctx.data_mut(|d| d.insert_temp(id, is_down));
    }
    button.clicked() || (was_down && !is_down && button.enabled() && button.contains_pointer())
}
