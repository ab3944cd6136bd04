//! The options of a list that is open, by pointer and by keyboard: up and down go through them, Enter or Space takes one, Escape none.

use egui::{EventFilter, Id, Key, Modifiers, Response, Ui};

/// Draws them. The keyboard comes from the button that opened the list, and goes back there. The index of the one that was taken now.
pub fn show(ui: &mut Ui, button: Id, options: &[&str], now: Option<usize>) -> Option<usize> {
    let is_now = |index: usize| now == Some(index);
    let all: Vec<Response> = options
        .iter()
        .enumerate()
        .map(|(index, option)| ui.selectable_label(is_now(index), *option))
        .collect();
    // before they have their places nothing can have the keyboard
    if ui.memory(|m| m.has_focus(button))
        && !ui.is_sizing_pass()
        && let Some(first) = all.get(now.unwrap_or_default())
    {
        first.request_focus();
    }
    if let Some(at) = all.iter().position(Response::has_focus) {
        walk(ui, &all, at, button);
    }
    let taken = all.iter().position(Response::clicked)?;
    ui.memory_mut(|m| m.request_focus(button));
    ui.close();
    Some(taken)
}

/// From the option that has the keyboard.
fn walk(ui: &Ui, all: &[Response], at: usize, button: Id) {
    let arrows = EventFilter { vertical_arrows: true, escape: true, ..EventFilter::default() };
    if let Some(option) = all.get(at) {
        ui.memory_mut(|m| m.set_focus_lock_filter(option.id, arrows));
    }
    let [down, up] = [Key::ArrowDown, Key::ArrowUp]
        .map(|key| ui.input_mut(|i| i.count_and_consume_key(Modifiers::NONE, key)));
    let to = (at + down).saturating_sub(up).min(all.len().saturating_sub(1));
    if let Some(option) = all.get(to).filter(|_| to != at) {
        option.request_focus();
        option.scroll_to_me(None);
    }
    if ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape)) {
        ui.memory_mut(|m| m.request_focus(button));
        ui.close();
    }
}
