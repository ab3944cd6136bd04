//! A place that is typed for the tool in use, instead of clicked.

use super::pen::Mark;
use crate::coordinates::{self, Known};
use crate::panels::Scene;
use crate::theme;
use egui::{Key, RichText, Role, TextEdit, Ui, WidgetInfo};
use flight_plan::{Id, Place};
use geometry::LatLon;

/// The field.
#[derive(Debug, Default)]
pub struct Typed {
    text: String,
    /// Why it could not be read.
    fault: Option<String>,
    /// Places that the tool has not seen yet.
    places: Vec<Mark>,
}

impl Typed {
    /// Draws the field. True: Enter was pressed with nothing in it, so what is drawn ends.
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene<'_>, from: Option<LatLon>) -> bool {
        let hint = if from.is_some() { "045° 800 m" } else { "type a place" };
        let edit = TextEdit::singleline(&mut self.text).hint_text(hint).desired_width(120.0);
        let response = ui.add(edit).on_hover_text(
            "Coordinates, a name of the plan, or a bearing and a distance: 045° 800 m from A. Enter takes it.",
        );
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
                let fix = plan.fix(&Id::new(text)).map(|fix| Place::Fix(fix.id.clone()));
                let mark = Mark::at(at);
                self.places.push(Mark { place: fix.unwrap_or_else(|| mark.place.clone()), ..mark });
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
