//! The beginning of a plan: a card over the map of an empty document. A few answers give a plan that can be flown.

use super::inspector::parse_position;
use super::{Scene, field, primary_button};
use crate::command::{DocumentCommand, Queue, Replacement, ViewCommand};
use crate::map::furniture::NARROW;
use crate::map::text;
use crate::map::view::View;
use crate::theme::{self, Palette};
use crate::units::{self, Unit};
use egui::{Align2, DragValue, Painter, Pos2, Rect, RichText, Stroke, Ui, vec2};
use flight_plan::Runway;
use flight_plan::template::{Outline, Template};
use geometry::LatLon;
use std::ops::RangeInclusive;

/// Width of the card, and the height that it needs, screen points.
pub const WIDTH: f32 = 280.0;
/// Its width where it is not to reach over the panels on the left.
pub const NARROW_WIDTH: f32 = 252.0;
/// See [`WIDTH`].
pub const HEIGHT: f32 = 470.0;

/// The mission lies so far beside the runway, metres from its nearer edge.
const ASIDE_M: f64 = 2000.0;

/// What is filled in.
#[derive(Debug, Clone)]
struct Form {
    template: Template,
    /// `None`: in the middle of what the card leaves free of the map.
    runway_at: Option<LatLon>,
    /// `None`: beside the runway.
    mission_at: Option<LatLon>,
    heading_deg: f64,
    length_m: f64,
    radius_m: f64,
    height_m: f64,
}

impl Default for Form {
    fn default() -> Self {
        Self {
            template: Template::Survey,
            runway_at: None,
            mission_at: None,
            heading_deg: 52.0,
            length_m: 600.0,
            radius_m: 800.0,
            height_m: 150.0,
        }
    }
}

/// The document has nothing in it yet.
pub fn is_wanted(scene: &Scene<'_>) -> bool {
    scene.document.plan().stages.is_empty() && scene.vehicle.aboard.is_none()
}

/// Draws the card. `here`: where the runway is unless it is placed.
pub fn show(ui: &mut Ui, here: LatLon, scene: &Scene<'_>, queue: &mut Queue) {
    let id = form_id();
    let mut form: Form = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    let p = theme::of(ui);
    ui.label(RichText::new("New mission").strong().size(16.0));
    ui.label(
        RichText::new("Make a plan that can be flown as it is, then change it on the map.").color(p.weak),
    );
    ui.add_space(4.0);
    templates(ui, &mut form);
    ui.add_space(4.0);
    answers(ui, &mut form, here, scene, queue);
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        if ui.add(primary_button("Create", p)).clicked() {
            queue.document(DocumentCommand::Create(Box::new(form.outline(here))));
        }
        if ui.button("Open a plan…").clicked() {
            queue.document(DocumentCommand::Replace(Replacement::AskOpen));
        }
    });
    ui.data_mut(|d| d.insert_temp(id, form));
}

/// Draws on the map where runway and mission would be.
pub fn draw(painter: &Painter, view: &View, scene: &Scene<'_>, p: &Palette) {
    if !is_wanted(scene) {
        return;
    }
    let form: Form = painter.ctx().data(|d| d.get_temp(form_id())).unwrap_or_default();
    let outline = form.outline(view.geo(runway_on_screen(view.rect)));
    let runway = &outline.runway;
    let ends = [runway.threshold, runway.threshold.destination(runway.heading_deg, runway.length_m)];
    let [threshold, end] = ends.map(|at| view.place(at));
    for (width, colour) in [(6.0, p.halo), (3.0, p.text)] {
        painter.line_segment([threshold, end], Stroke::new(width, colour));
    }
    let below = vec2(0.0, 8.0);
    text::haloed(painter, threshold + below, Align2::CENTER_TOP, runway.id.as_str(), 12.0, p.text, p);
    if outline.template != Template::Circuit {
        let (at, radius) = (view.place(outline.centre), outline.radius_m * view.points_per_metre());
        painter.circle_stroke(at, radius as f32, Stroke::new(1.5, p.accent));
        text::haloed(painter, at, Align2::CENTER_CENTER, outline.template.name(), 12.0, p.accent, p);
    }
}

/// Where on the screen the runway is unless it is placed: beside the card, where there is room.
pub fn runway_on_screen(map: Rect) -> Pos2 {
    let aside = if map.width() < NARROW { 0.0 } else { WIDTH / 2.0 };
    map.center() + vec2(aside, 0.0)
}

fn form_id() -> egui::Id {
    egui::Id::unique("new mission")
}

fn templates(ui: &mut Ui, form: &mut Form) {
    ui.horizontal_wrapped(|ui| {
        for template in Template::ALL {
            let chosen = form.template == template;
            if ui.selectable_label(chosen, template.name()).on_hover_text(template.about()).clicked() {
                form.template = template;
            }
        }
    });
    ui.label(RichText::new(form.template.about()).color(theme::of(ui).weak));
}

fn answers(ui: &mut Ui, form: &mut Form, here: LatLon, scene: &Scene<'_>, queue: &mut Queue) {
    let u = scene.units();
    let hint = "Its landing threshold; until then it moves with the map";
    let mut refused = place(ui, ("Runway at", hint), &mut form.runway_at, here);
    number(ui, "Heading", &mut form.heading_deg, DEGREES, 0.0..=359.9);
    number(ui, "Length", &mut form.length_m, u.length(), 50.0..=5000.0);
    if form.template != Template::Circuit {
        let beside = form.beside(here);
        let hint = "Its middle; until then beside the runway";
        refused = refused.or(place(ui, ("Mission at", hint), &mut form.mission_at, beside));
        number(ui, "Reaches", &mut form.radius_m, u.length(), 200.0..=20_000.0);
    }
    number(ui, "Height", &mut form.height_m, u.altitude(), 30.0..=4000.0);
    ui.label(RichText::new("above the runway; more where the ground asks for it").color(theme::of(ui).weak));
    if let Some(typed) = refused {
        let text = format!("“{typed}” is no position: write it like 36.31900, -84.17300.");
        queue.view(ViewCommand::Notice(text));
    }
}

const DEGREES: Unit = Unit { symbol: "°", per_si: 1.0, decimals: 0 };

/// A position, typed; gives what was typed if it is none.
fn place(
    ui: &mut Ui,
    (name, hint): (&str, &str),
    at: &mut Option<LatLon>,
    otherwise: LatLon,
) -> Option<String> {
    let shown = units::position(at.unwrap_or(otherwise));
    let row = ui.scope(|ui| field::row(ui, name, |ui| field::text(ui, name, &shown, false)));
    row.response.on_hover_text(hint);
    let typed = row.inner?;
    *at = Some(match parse_position(&typed) {
        Some(position) => position,
        None => return Some(typed),
    });
    None
}

fn number(ui: &mut Ui, name: &str, si: &mut f64, unit: Unit, range_si: RangeInclusive<f64>) {
    field::row(ui, name, |ui| {
        let mut shown = unit.from_si(*si);
        let range = unit.from_si(*range_si.start())..=unit.from_si(*range_si.end());
        let value = DragValue::new(&mut shown).range(range).suffix(format!(" {}", unit.symbol));
        let response = ui.add(value.max_decimals(0));
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, name));
        if response.changed() {
            *si = unit.to_si(shown);
        }
    });
}

impl Form {
    fn runway(&self, here: LatLon) -> LatLon {
        self.runway_at.unwrap_or(here)
    }

    /// Abeam of the runway, clear of it.
    fn beside(&self, here: LatLon) -> LatLon {
        let half_way = self.runway(here).destination(self.heading_deg, self.length_m / 2.0);
        half_way.destination(self.heading_deg + 90.0, self.radius_m + ASIDE_M)
    }

    /// The elevation is looked up when the plan is made.
    fn outline(&self, here: LatLon) -> Outline {
        let runway = Runway {
            id: runway_name(self.heading_deg).as_str().into(),
            threshold: self.runway(here),
            elevation_amsl_m: 0.0,
            heading_deg: self.heading_deg,
            length_m: self.length_m,
            priority: 1,
            approach_entry: None,
        };
        Outline {
            template: self.template,
            aircraft: "trainer".into(),
            runway,
            centre: self.mission_at.unwrap_or_else(|| self.beside(here)),
            radius_m: self.radius_m,
            height_m: self.height_m,
        }
    }
}

/// As runways are called: a tenth of the heading, 01 to 36.
fn runway_name(heading_deg: f64) -> String {
    let tenth = (heading_deg / 10.0).round().rem_euclid(36.0);
    format!("R{:02}", if tenth < 1.0 { 36.0 } else { tenth })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runways_are_called_by_their_heading() {
        for (heading_deg, name) in [(0.0, "R36"), (4.0, "R36"), (52.0, "R05"), (90.0, "R09"), (358.0, "R36")]
        {
            assert_eq!(runway_name(heading_deg), name, "{heading_deg}");
        }
    }

    #[test]
    fn mission_lies_beside_the_runway_until_it_is_placed() {
        let here = LatLon::new(36.3, -84.2);
        let mut form = Form::default();
        let outline = form.outline(here);
        assert_eq!(outline.runway.threshold, here);
        let away_m = outline.centre.distance_m(here);
        assert!((2700.0..3000.0).contains(&away_m), "{away_m}");
        form.mission_at = Some(LatLon::new(36.4, -84.1));
        assert_eq!(form.outline(here).centre, LatLon::new(36.4, -84.1));
    }
}
