//! The options of a list that is open, by pointer and by keyboard: up and down, Home and End and first letters go through them, Enter
//! or Space takes one, Escape none.

use egui::{ComboBox, Event, EventFilter, Id, IdSalt, Key, Modifiers, Response, Role, Ui, WidgetInfo};

/// An option, and what there is to say of it.
pub type About<'a> = (&'a str, &'a str);

/// A list: what it is called by those who can't see it, what stands on its button, and how that looks.
pub struct List<'a> {
    /// No two lists in a place have the same.
    pub salt: &'static str,
    /// For screen readers.
    pub name: &'a str,
    /// On the button.
    pub shown: &'a str,
    /// Its width and height, for instance.
    pub look: fn(ComboBox) -> ComboBox,
}

impl List<'_> {
    /// Draws its button, and its options while it is open. The option that was taken now, and the button.
    pub fn show<S: AsRef<str>>(
        self,
        ui: &mut Ui,
        now: Option<usize>,
        options: impl FnOnce() -> Vec<S>,
    ) -> (Option<usize>, Response) {
        self.drop_down(ui, |ui, button| {
            let options = options();
            let plain: Vec<About<'_>> = options.iter().map(|option| (option.as_ref(), "")).collect();
            show(ui, button, &plain, now)
        })
    }

    /// The same with more to say of each option.
    pub fn show_with_help(
        self,
        ui: &mut Ui,
        now: Option<usize>,
        options: &[About<'_>],
    ) -> (Option<usize>, Response) {
        self.drop_down(ui, |ui, button| show(ui, button, options, now))
    }

    fn drop_down(
        self,
        ui: &mut Ui,
        options: impl FnOnce(&mut Ui, Id) -> Option<usize>,
    ) -> (Option<usize>, Response) {
        let button = ui.make_persistent_id(IdSalt::new(self.salt));
        let combo = (self.look)(ComboBox::from_id_salt(self.salt)).selected_text(self.shown);
        let list = combo.show_ui(ui, |ui| options(ui, button));
        let enabled = ui.is_enabled();
        list.response.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::ComboBox, enabled, self.name);
            info.current_text_value = Some(self.shown.to_owned());
            info
        });
        (list.inner.flatten(), list.response)
    }
}

/// Draws them. The keyboard comes from the button that opened the list, and goes back there. The index of the one that was taken now.
pub(super) fn show(ui: &mut Ui, button: Id, options: &[About<'_>], now: Option<usize>) -> Option<usize> {
    let draw = |(index, (option, about)): (usize, &About<'_>)| {
        let response = ui.selectable_label(now == Some(index), *option);
        if about.is_empty() { response } else { response.on_hover_text(*about) }
    };
    let all: Vec<Response> = options.iter().enumerate().map(draw).collect();
    // before they have their places nothing can have the keyboard
    if ui.memory(|m| m.has_focus(button))
        && !ui.is_sizing_pass()
        && let Some(first) = all.get(now.unwrap_or_default())
    {
        first.request_focus();
    }
    if let Some(at) = all.iter().position(Response::has_focus) {
        walk(ui, &all, options, at, button);
    }
    let taken = all.iter().position(Response::clicked)?;
    ui.memory_mut(|m| m.request_focus(button));
    ui.close();
    Some(taken)
}

/// From the option that has the keyboard.
fn walk(ui: &Ui, all: &[Response], options: &[About<'_>], at: usize, button: Id) {
    let arrows = EventFilter { vertical_arrows: true, escape: true, ..EventFilter::default() };
    if let Some(option) = all.get(at) {
        ui.memory_mut(|m| m.set_focus_lock_filter(option.id, arrows));
    }
    let to = ui.input_mut(|i| {
        let mut times = |key| i.count_and_consume_key(Modifiers::NONE, key);
        let (down, up) = (times(Key::ArrowDown), times(Key::ArrowUp));
        let (home, end) = (times(Key::Home) > 0, times(Key::End) > 0);
        let from = if home {
            0
        } else if end {
            all.len()
        } else {
            at
        };
        let walked = (from + down).saturating_sub(up).min(all.len().saturating_sub(1));
        i.events.iter().filter_map(typed).fold(walked, |at, letter| begins_with(options, at, letter))
    });
    if let Some(option) = all.get(to).filter(|_| to != at) {
        option.request_focus();
        option.scroll_to_me(None);
    }
    if ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape)) {
        ui.memory_mut(|m| m.request_focus(button));
        ui.close();
    }
}

/// The letter or digit that was typed.
fn typed(event: &Event) -> Option<char> {
    let Event::Text(text) = event else { return None };
    text.chars().next().filter(|letter| letter.is_alphanumeric())
}

/// The next option that begins with a letter, from the one behind `at` on and round; `at` where there is none.
fn begins_with(options: &[About<'_>], at: usize, letter: char) -> usize {
    let begins = |(option, _): &About<'_>| {
        let first = option.chars().find(|letter| letter.is_alphanumeric());
        first.is_some_and(|first| first.to_lowercase().eq(letter.to_lowercase()))
    };
    let round = (1..=options.len()).map(|step| (at + step) % options.len().max(1));
    round.into_iter().find(|index| options.get(*index).is_some_and(begins)).unwrap_or(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_go_round_the_options_that_begin_with_them() {
        let options = ["Any", "ArduPlane", "PX4", "⚠ another"].map(|option| (option, ""));
        let to = |at, letter| begins_with(&options, at, letter);
        assert_eq!([to(0, 'a'), to(1, 'A'), to(3, 'a'), to(2, 'p'), to(0, 'z')], [1, 3, 0, 2, 0]);
        assert_eq!(begins_with(&[], 0, 'a'), 0);
    }
}
