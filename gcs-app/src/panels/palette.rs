//! The command palette: everything that can be done, found by a few letters.

use super::{Scene, field};
use crate::actions::fuzzy::Score;
use crate::actions::{
    Action, Fittings, Kind, aliases, all, alternates, answers, bindings, flight, fuzzy, layers, offers,
    places,
};
use crate::command::{Queue, ViewCommand};
use crate::theme;
use egui::text::{CCursor, CCursorRange, LayoutJob, TextFormat};
use egui::text_edit::TextEditState;
use egui::{Align2, Area, FontId, Id, Key, Modifiers, Order, RichText, ScrollArea, TextStyle, Ui, vec2};
use std::cmp::Reverse;

const WIDTH: f32 = 460.0;
const ROW_HEIGHT: f32 = 26.0;
/// So many are shown of what was found.
const MOST: usize = 100;

/// The palette, and what is typed into it.
#[derive(Debug, Default)]
pub struct CommandPalette {
    query: String,
    /// The row that Enter takes.
    current: usize,
    /// That row was chosen with the arrows.
    walked: bool,
    /// An action that must be held.
    held: Option<Action>,
    is_open: bool,
}

impl CommandPalette {
    /// Draws it, while it is open.
    pub fn show(&mut self, ui: &Ui, scene: &Scene<'_>, fittings: &Fittings, queue: &mut Queue) {
        let Some(begins) = scene.view.palette else {
            *self = Self::default();
            return;
        };
        if !std::mem::replace(&mut self.is_open, true) {
            self.begin(ui, begins);
        }
        let window = ui.ctx().content_rect();
        let area = Area::new(Id::unique("palette")).order(Order::Foreground);
        let area = area.pivot(Align2::CENTER_TOP).fixed_pos(window.center_top() + vec2(0.0, 52.0));
        let frame = theme::card(ui).shadow(ui.visuals().popup_shadow);
        let shown = area.show(ui.ctx(), |ui| {
            ui.set_width(WIDTH.min(window.width() - 40.0));
            frame.show(ui, |ui| self.contents(ui, scene, fittings, queue));
        });
        let escaped = ui.input(|i| i.key_pressed(Key::Escape));
        if escaped || shown.response.clicked_elsewhere() {
            queue.view(ViewCommand::Palette(None));
        }
    }

    /// With a text in its field, to be typed on.
    fn begin(&mut self, ui: &Ui, text: &str) {
        text.clone_into(&mut self.query);
        let mut state = TextEditState::default();
        state.cursor.set_char_range(Some(CCursorRange::one(CCursor::new(text.chars().count()))));
        state.store(ui.ctx(), field_id());
        // before it is drawn: what was typed since the palette was asked for is for the field
        ui.memory_mut(|m| m.request_focus(field_id()));
    }

    fn contents(&mut self, ui: &mut Ui, scene: &Scene<'_>, fittings: &Fittings, queue: &mut Queue) {
        if let Some(action) = self.held.clone() {
            hold(ui, &action, queue);
            return;
        }
        let (down, up) = ui.input_mut(|i| {
            let mut times = |key| i.count_and_consume_key(Modifiers::NONE, key);
            (times(Key::ArrowDown), times(Key::ArrowUp))
        });
        let entered = ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Enter));
        let field = egui::TextEdit::singleline(&mut self.query)
            .id(field_id())
            .hint_text("What do you want to do?  A few letters are enough")
            .desired_width(f32::INFINITY);
        let typed = ui.add(field);
        let text = self.query.clone();
        typed.widget_info(|| {
            let mut info = egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Search commands");
            info.current_text_value = Some(text.clone());
            info
        });
        typed.request_focus();
        if typed.changed() {
            (self.current, self.walked) = (0, false);
        }
        self.walked |= up + down > 0;
        let found = find(&self.query, scene, fittings);
        self.current = (self.current + down).saturating_sub(up).min(found.len().saturating_sub(1));
        let clicked = self.rows(ui, &found, up + down > 0 || typed.changed());
        // nobody has asked for what happens to stand first
        let means_it = self.walked || !self.query.trim().is_empty();
        let chosen = clicked.or((entered && means_it).then_some(self.current)).and_then(|i| found.get(i));
        if let Some(action) = chosen {
            self.choose(action, queue);
        }
    }

    /// Draws what was found, and says which row was clicked.
    fn rows(&self, ui: &mut Ui, found: &[Action], moved: bool) -> Option<usize> {
        if found.is_empty() {
            ui.label("Nothing has these letters. Fewer letters find more.");
        }
        let height = (ui.ctx().content_rect().height() - 160.0).clamp(ROW_HEIGHT, 14.0 * ROW_HEIGHT);
        let mut clicked = None;
        ScrollArea::vertical()
            .max_height(height)
            .min_scrolled_height(height)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 1.0;
                for (i, action) in found.iter().enumerate() {
                    let row = row(ui, action, i == self.current);
                    if i == self.current && moved {
                        row.scroll_to_me(None);
                    }
                    if row.clicked() {
                        clicked = Some(i);
                    }
                }
            });
        clicked
    }

    fn choose(&mut self, action: &Action, queue: &mut Queue) {
        let Ok(command) = &action.command else { return };
        if action.kind == Kind::Hold {
            self.held = Some(action.clone());
            return;
        }
        // first, for what was chosen may open it again
        queue.view(ViewCommand::Palette(None));
        queue.push(command.clone());
        // with another text then
        *self = Self::default();
    }
}

fn field_id() -> Id {
    Id::unique("palette query")
}

/// A dangerous action is not done by Enter alone.
fn hold(ui: &mut Ui, action: &Action, queue: &mut Queue) {
    let p = theme::of(ui);
    ui.label("This can't be taken back. Hold the button, or the space bar on it; Escape leaves it.");
    if let Some(caution) = action.caution {
        ui.label(RichText::new(caution).color(p.caution));
    }
    if field::hold_button(ui, &action.name, p.warning, ui.available_width())
        && let Ok(command) = &action.command
    {
        queue.view(ViewCommand::Palette(None));
        queue.push(command.clone());
    }
}

/// What answers the query, the best first. The places of the plan are many: they are there when something is typed.
fn find(query: &str, scene: &Scene<'_>, fittings: &Fittings) -> Vec<Action> {
    let mut actions = all(scene, fittings);
    // what led here is here already
    let led_here = |action: &Action| {
        action.id == "palette"
            || (action.id == bindings::ID && query.starts_with(bindings::QUERY))
            || (action.id == flight::CONNECT_TO && query.starts_with(flight::QUERY))
            || (action.id == layers::ADD && query.starts_with(layers::QUERY))
    };
    actions.retain(|action| !led_here(action));
    if query.trim().is_empty() {
        return actions;
    }
    let bindings = bindings::of(scene);
    // nothing more is asked for: in their own order, the place first, and not the shortest name
    if query.trim_end() == bindings::QUERY.trim_end() && !bindings.is_empty() {
        return bindings;
    }
    actions.extend(of_the_moment(query, scene));
    let mut scored: Vec<(Score, Action)> =
        actions.into_iter().filter_map(|action| Some((score(query, &action)?, action))).collect();
    // what was meant before what happens to have the letters; then what is possible before what is not
    scored.sort_by_key(|(score, action)| (!score.is_whole, action.command.is_err(), Reverse(*score)));
    scored.into_iter().take(MOST).map(|(_, action)| action).collect()
}

/// What there is to be done with what is selected, flown and asked now, and the places of the plan.
fn of_the_moment(query: &str, scene: &Scene<'_>) -> Vec<Action> {
    let typed = flight::connect_to(query, scene).or_else(|| layers::add(query)).into_iter().collect();
    let plan = [alternates::of(scene), bindings::of(scene), offers::of(scene)].concat();
    let shown = [layers::of(scene), places::of(scene.document)].concat();
    [plan, flight::of(scene), typed, answers::of(scene), shown].concat()
}

/// All that one query or another finds.
pub fn everything(scene: &Scene<'_>, fittings: &Fittings) -> Vec<Action> {
    let with_address = format!("{}10.0.0.2:7447", flight::QUERY);
    let with_path = layers::add(&format!("{}map.mbtiles", layers::QUERY)).into_iter().collect();
    [all(scene, fittings), of_the_moment(&with_address, scene), with_path].concat()
}

/// By its name here, or another word for it.
fn score(query: &str, action: &Action) -> Option<Score> {
    let own = fuzzy::score_named(query, action.group.name(), &action.name);
    own.max(aliases::score(query, &action.id))
}

/// At the ends of a row, and between a name and what stands beside it, screen points.
const BETWEEN: f32 = 32.0;

fn width_of(ui: &Ui, text: &LayoutJob) -> f32 {
    ui.painter().layout_job(text.clone()).size().x
}

fn row(ui: &mut Ui, action: &Action, current: bool) -> egui::Response {
    let p = theme::of(ui);
    let colour = if action.command.is_ok() { p.text } else { p.weak };
    let on = matches!(action.kind, Kind::Switch(true) | Kind::Choice(true));
    let mark = if on { " ✔" } else { "" };
    let text = format!("{}  ▸  {}{mark}", action.group.name(), action.name);
    let aside = match &action.command {
        Ok(_) => action.caution.map(Into::into).or(action.key(ui.ctx())).unwrap_or_default(),
        Err(why_not) => why_not.to_string(),
    };
    let small = TextFormat::simple(FontId::proportional(11.5), p.weak);
    let mut text = LayoutJob::simple(text, TextStyle::Button.resolve(ui.style()), colour, f32::INFINITY);
    let beside = LayoutJob::single_section(aside.clone(), small.clone());
    let has_room = width_of(ui, &text) + width_of(ui, &beside) < ui.available_width() - BETWEEN;
    // else below it: neither pushes the other out
    if !has_room && !aside.is_empty() {
        text.append(&format!("\n{aside}"), 0.0, small);
    }
    let button = egui::Button::new(text).wrap().selected(current).frame_when_inactive(current);
    let button = if has_room { button.right_text(beside) } else { button };
    let response = ui.add(button.min_size(vec2(ui.available_width(), ROW_HEIGHT)));
    let name = format!("{} {}", action.group.name(), action.name);
    let enabled = action.command.is_ok();
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, enabled, current, &name));
    if aside.is_empty() { response } else { response.on_hover_text(aside) }
}
