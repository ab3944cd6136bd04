//! Help: the topics on the left, the one that is read on the right.

use super::Scene;
use crate::command::{Queue, ViewCommand};
use crate::help::{PICTURES, Topic, search, topics};
use crate::theme;
use egui::{Rect, RichText, ScrollArea, Ui, Vec2, vec2};
use egui_commonmark::{CommonMarkCache, CommonMarkViewer};

/// Of the room, what is left around it with its title, screen points on each side.
const AROUND: Vec2 = vec2(16.0, 32.0);

/// The window with the documents.
#[derive(Default)]
pub struct Help {
    /// Empty until it is first opened.
    topics: &'static [Topic],
    words: String,
    cache: CommonMarkCache,
    /// The topic that was drawn last.
    shown: String,
}

impl Help {
    /// Draws it within this room, while a topic is wanted.
    pub fn show(&mut self, ui: &Ui, room: Rect, scene: &Scene<'_>, queue: &mut Queue) {
        let Some(key) = &scene.view.help else { return };
        if self.topics.is_empty() {
            self.open(ui);
        }
        let mut open = true;
        let most = room.shrink2(AROUND).size();
        egui::Window::new("Help")
            .open(&mut open)
            .constrain_to(room)
            .default_size(vec2(760.0, 560.0).min(most))
            .max_size(most)
            .min_size(vec2(420.0, 240.0).min(most))
            .show(ui.ctx(), |ui| {
                egui::Panel::left("help topics").exact_size(220.0).show(ui, |ui| self.list(ui, key, queue));
                egui::CentralPanel::default().show(ui, |ui| self.text(ui, key, queue));
            });
        if !open {
            queue.view(ViewCommand::Help(None));
        }
    }

    fn open(&mut self, ui: &Ui) {
        self.topics = topics();
        for topic in self.topics {
            self.cache.add_link_hook(&topic.key);
        }
        for (name, bytes) in PICTURES {
            ui.ctx().include_bytes(format!("bytes://{name}"), *bytes);
        }
    }

    fn list(&mut self, ui: &mut Ui, key: &str, queue: &mut Queue) {
        let field = egui::TextEdit::singleline(&mut self.words).hint_text("Search the help");
        let typed = ui.add(field.desired_width(f32::INFINITY));
        let text = self.words.clone();
        typed.widget_info(|| {
            let mut info = egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Search the help");
            info.current_text_value = Some(text.clone());
            info
        });
        let found = search(self.topics, &self.words);
        if found.is_empty() {
            ui.label("No topic has these words.");
        }
        let indented = self.words.trim().is_empty();
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 1.0;
            for (i, topic) in found.iter().enumerate() {
                let indent = if indented { topic.level.saturating_sub(1) * 2 } else { 0 };
                let title = RichText::new(format!("{}{}", " ".repeat(indent), topic.title));
                let title = if topic.level == 1 { title.strong() } else { title };
                let row =
                    egui::Button::new(title).selected(topic.key == key).frame_when_inactive(false).truncate();
                // parts of different chapters have the same titles
                if ui.push_id(i, |ui| ui.add(row)).inner.clicked() {
                    queue.view(ViewCommand::Help(Some(topic.key.clone())));
                }
            }
        });
    }

    fn text(&mut self, ui: &mut Ui, key: &str, queue: &mut Queue) {
        let Some(topic) = self.topics.iter().find(|topic| topic.key == key) else {
            ui.colored_label(theme::of(ui).weak, "There is no such topic. Choose one on the left.");
            return;
        };
        let mut scroll = ScrollArea::vertical().id_salt("help text").auto_shrink(false);
        if self.shown != key {
            self.shown = key.into();
            scroll = scroll.vertical_scroll_offset(0.0);
        }
        scroll.show(ui, |ui| {
            let viewer = CommonMarkViewer::new().default_implicit_uri_scheme("bytes://");
            viewer.max_image_width(Some(ui.available_width() as usize)).show(
                ui,
                &mut self.cache,
                &topic.text,
            );
        });
        if let Some((followed, _)) = self.cache.link_hooks().iter().find(|(_, clicked)| **clicked) {
            queue.view(ViewCommand::Help(Some(followed.clone())));
        }
    }
}
