//! A place that is typed for the tool in use, instead of clicked.

use super::pen::Mark;
use crate::coordinates::{self, Known};
use crate::panels::{Scene, table};
use crate::theme;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Context, Event, Key, RichText, Role, TextEdit, Ui, WidgetInfo};
use geometry::LatLon;

/// The field.
#[derive(Debug, Default)]
pub struct Typed {
    text: String,
    /// Why it could not be read.
    fault: Option<String>,
    /// Places that the tool has not seen yet.
    places: Vec<Mark>,
    /// When a minus was typed that may be the sign of what follows, seconds.
    minus_s: Option<f64>,
}

impl Typed {
    /// Draws the field. True: Enter was pressed with nothing in it, so what is drawn ends.
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene<'_>, from: Option<LatLon>) -> bool {
        let hint = if from.is_some() { "045° 800 m" } else { "type a place" };
        let begun = self.begun(ui);
        self.text.push_str(&begun);
        let edit = TextEdit::singleline(&mut self.text).hint_text(hint).desired_width(120.0);
        let response = ui.add(edit).on_hover_text(
            "Coordinates, a name of the plan, or a bearing and a distance: 045° 800 m from A. Enter takes it.",
        );
        if !begun.is_empty() {
            response.request_focus();
            self.go_on_at_the_end(ui.ctx(), response.id);
        }
        let text = self.text.clone();
        response.widget_info(move || {
            let mut info = WidgetInfo::labeled(Role::TextInput, true, "Place to draw");
            info.current_text_value = Some(text.clone());
            info
        });
        let mut ends = false;
        if response.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter)) {
            ends = self.text.trim().is_empty();
            if !ends {
                self.read(scene, from);
                response.request_focus();
            }
        }
        if let Some(fault) = &self.fault {
            ui.label(RichText::new(fault).color(theme::of(ui).warning));
        }
        ends
    }

    /// The field may have been left with its cursor elsewhere.
    fn go_on_at_the_end(&self, ctx: &Context, field: egui::Id) {
        let mut state = TextEditState::load(ctx, field).unwrap_or_default();
        let end = CCursor::new(self.text.chars().count());
        state.cursor.set_char_range(Some(CCursorRange::one(end)));
        state.store(ctx, field);
    }

    /// From the first digit on what is typed is a place: whoever chose the tool by its key goes on typing. A minus alone zooms, too.
    fn begun(&mut self, ui: &Ui) -> String {
        let strays = strays(ui);
        let now_s = ui.input(|i| i.time);
        let had_minus = self.minus_s.is_some_and(|typed_s| now_s - typed_s < SIGN_S);
        let Some(first) = strays.find(|c: char| c.is_ascii_digit()) else {
            if !strays.is_empty() {
                self.minus_s = strays.ends_with('-').then_some(now_s);
            }
            return String::new();
        };
        let (before, digits) = strays.split_at(first);
        let is_negative = before.ends_with('-') || (before.is_empty() && had_minus);
        self.minus_s = None;
        format!("{}{digits}", if is_negative { "-" } else { "" })
    }

    fn read(&mut self, scene: &Scene<'_>, from: Option<LatLon>) {
        let plan = scene.document.plan();
        let aircraft = scene.vehicle.position.as_ref().map(|position| position.value.position);
        let near = from.or(aircraft).or_else(|| plan.home().map(|home| home.threshold));
        let known = Known { plan: Some(plan), aircraft, near, ..Known::default() };
        let text = self.text.trim();
        let read = coordinates::read(text, &known).or_else(|why| {
            let from = from.ok_or_else(|| why.clone())?;
            let text = format!("{text} from {:.8}, {:.8}", from.lat_deg, from.lon_deg);
            coordinates::read(&text, &known).map_err(|_| why)
        });
        match read {
            Ok(at) => {
                let mark = Mark::at(at);
                let thing = coordinates::named(text, plan).ok().flatten().filter(|thing| thing.at == at);
                self.places.push(match thing {
                    Some(thing) => Mark { place: thing.place, ..mark },
                    None => mark,
                });
                *self = Self { places: std::mem::take(&mut self.places), ..Self::default() };
            }
            Err(why) => self.fault = Some(why),
        }
    }

    /// What was typed; asked for once.
    pub fn take(&mut self) -> Vec<Mark> {
        std::mem::take(&mut self.places)
    }
}

/// A minus so long before a digit is its sign, seconds.
const SIGN_S: f64 = 2.0;

/// Letters that are typed while nothing has the keyboard that takes them.
fn strays(ui: &Ui) -> String {
    if ui.ctx().text_edit_focused() || table::has_focus(ui.ctx()) {
        return String::new();
    }
    let text = |event: &Event| match event {
        Event::Text(text) => Some(text.clone()),
        _ => None,
    };
    ui.input(|i| i.events.iter().filter_map(text).collect())
}
