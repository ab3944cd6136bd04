//! A text that is typed where it stands: Enter or a click elsewhere takes it, Escape leaves it as it was.

use egui::text::CCursorRange;
use egui::{FontId, Id, Key, Margin, Rect, TextEdit, Ui};

/// What is being typed.
#[derive(Debug, Clone)]
pub struct InPlace {
    text: String,
    begun: bool,
}

/// How it ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Typed {
    /// With this text.
    Text(String),
    /// It stays as it was.
    Cancelled,
}

impl InPlace {
    /// Begins with a text, all of it selected.
    pub fn new(text: &str) -> Self {
        Self { text: text.to_owned(), begun: false }
    }

    /// Draws the field; says once how it ended.
    pub fn show(&mut self, ui: &mut Ui, rect: Rect, name: &str) -> Option<Typed> {
        let id = Id::unique(("in place", name));
        let edit = TextEdit::singleline(&mut self.text)
            .id(id)
            .font(FontId::proportional(13.0))
            .margin(Margin::symmetric(3, 1))
            .desired_width(rect.width() - 8.0);
        let output = ui.scope_builder(egui::UiBuilder::new().max_rect(rect), |ui| {
            // no higher than its row
            ui.spacing_mut().interact_size.y = rect.height() - 4.0;
            edit.show(ui)
        });
        let output = output.inner;
        let response = output.response.response;
        let text = self.text.clone();
        response.widget_info(|| {
            let mut info = egui::WidgetInfo::labeled(egui::Role::TextInput, true, name);
            info.current_text_value = Some(text.clone());
            info
        });
        if !self.begun {
            self.begun = true;
            response.request_focus();
            let mut state = output.state;
            let all = CCursorRange::select_all_str(&self.text);
            state.cursor.set_char_range(Some(all));
            state.store(ui.ctx(), id);
            return None;
        }
        if !response.lost_focus() {
            return None;
        }
        Some(match ui.input(|i| i.key_pressed(Key::Escape)) {
            true => Typed::Cancelled,
            false => Typed::Text(std::mem::take(&mut self.text)),
        })
    }
}
