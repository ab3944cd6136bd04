//! The preview's timeline: play and pause, what the preview comes to, and a strip with its stages along which the cursor is moved.

use super::field::List;
use super::{Scene, what_if};
use crate::command::{PreviewCommand, Queue, ViewCommand};
use crate::document::Document;
use crate::forecast::Forecast;
use crate::theme::{self, Palette};
use crate::units;
use egui::{Align2, FontId, Key, Painter, Rect, RichText, Sense, Stroke, Ui, pos2, vec2};
use flight_plan::{Id, Leg, Stage};

/// A row that is narrower has no room for everything in words, screen points.
const NARROW: f32 = 420.0;
/// How many times as fast as the flight the cursor may run.
pub const SPEEDS: [f64; 9] = [1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 50.0, 100.0, 200.0];

/// Play and pause of the preview, and what it comes to.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let forecast = scene.forecast();
    let is_narrow = is_narrow(ui);
    play(ui, scene, is_narrow, queue);
    speed(ui, scene, queue);
    let hover = "What if: other winds, values and branches, and alarms at the cursor";
    if ui.button("What if").on_hover_text(hover).clicked() {
        queue.view(ViewCommand::ShowPanel(what_if::ID, true));
    }
    if scene.view.cursor_s.is_some() && ui.button("✖").on_hover_text("Hide the cursor").clicked() {
        queue.preview(PreviewCommand::Scrub(None));
    }
    let p = theme::of(ui);
    let sum = sum(scene);
    if let (Some(why), false) = (scene.out_of_date(), forecast.points.is_empty()) {
        // what follows is not of the plan that is shown
        let text = if is_narrow { "◌" } else { "◌ Out of date" };
        ui.label(RichText::new(text).color(p.caution)).on_hover_text(why);
    }
    let why_none = scene.analysis.no_forecast.as_ref();
    // beside the reason why there is none, noughts say nothing
    if why_none.is_none() || !forecast.points.is_empty() {
        ui.add(egui::Label::new(RichText::new(&sum).color(p.weak)).truncate()).on_hover_text(sum);
    }
    if scene.is_behind() {
        ui.add(egui::Spinner::new().size(14.0));
    }
    if let Some(why) = why_none.or(forecast.cut_short.as_ref()) {
        // a sentence that is cut is none
        let said = match (is_narrow, why_none) {
            (true, Some(_)) => "no preview",
            (true, None) => "ends early",
            (false, _) => why,
        };
        ui.add(egui::Label::new(RichText::new(format!("⚠ {said}")).color(p.caution)).truncate())
            .on_hover_text(why);
    }
}

/// There is no room for everything in words.
pub fn is_narrow(ui: &Ui) -> bool {
    ui.max_rect().width() < NARROW
}

/// Where there is little room the symbol has to do.
fn play(ui: &mut Ui, scene: &Scene<'_>, is_narrow: bool, queue: &mut Queue) {
    let (symbol, name) = if scene.view.playing { ("⏸", "Pause") } else { ("▶", "Preview") };
    let whole = format!("{symbol} {name}");
    let text = if is_narrow { symbol } else { whole.as_str() };
    let is_possible = !scene.forecast().points.is_empty();
    let button = ui.add_enabled(is_possible, egui::Button::new(text));
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, is_possible, &whole));
    if button.on_hover_text(format!("{name} (Space)")).clicked() {
        queue.preview(PreviewCommand::Play(!scene.view.playing));
    }
}

/// What the flight comes to; what is asked for first stands first, the rest may be cut.
fn sum(scene: &Scene<'_>) -> String {
    let forecast = scene.forecast();
    let flights = (forecast.stops > 0).then(|| format!("{} flights", forecast.stops + 1));
    let way = scene.units().distance().show(forecast.length_m());
    let energy = forecast.battery_left.map(|left| format!("{:.0} % energy left", left * 100.0));
    let waypoints = format!("{} waypoints", forecast.waypoints.len());
    let parts = flights.into_iter().chain([way, units::duration(forecast.duration_s())]);
    parts.chain(energy).chain([waypoints]).collect::<Vec<_>>().join(" · ")
}

fn speed(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let now = scene.view.speed.0;
    let shown = format!("{now:.0}×");
    let name = format!("Play speed: {shown}");
    let list = List { salt: "play speed", name: &name, shown: &shown, look: |combo| combo.width(58.0) };
    let (taken, button) = list.show(ui, SPEEDS.iter().position(|speed| *speed == now), || {
        SPEEDS.map(|speed| format!("{speed:.0}×")).to_vec()
    });
    if let Some(speed) = taken.and_then(|taken| SPEEDS.get(taken)) {
        queue.preview(PreviewCommand::Speed(*speed));
    }
    button.on_hover_text("How many times as fast as the flight the cursor runs");
}

/// Height of the strip, screen points.
const STRIP: f32 = 20.0;
/// The arrow keys move the cursor so far, as a share of the flight.
const KEY_SHARE: f64 = 0.01;
/// Most actions of a stage that are listed.
const MOST_ACTIONS: usize = 8;

/// The stages in the order in which they are flown, with their names, and the cursor: click, drag, or arrow keys.
pub fn strip(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let size = vec2(ui.available_width().max(80.0), STRIP);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let forecast = scene.forecast();
    let duration_s = forecast.duration_s();
    let cursor_s = scene.view.cursor_s.unwrap_or(0.0);
    response.widget_info(|| {
        let mut info = egui::WidgetInfo::labeled(egui::Role::Slider, true, "Timeline");
        info.value = Some(cursor_s);
        info
    });
    if duration_s <= 0.0 {
        return;
    }
    let p = theme::of(ui);
    draw_strip(&ui.painter_at(rect), rect, scene, p);
    if response.has_focus() {
        let pressed = |key| ui.input_mut(|i| i.consume_key(egui::Modifiers::NONE, key));
        let by = f64::from(i8::from(pressed(Key::ArrowRight)) - i8::from(pressed(Key::ArrowLeft)));
        if by != 0.0 {
            let to = (cursor_s + by * KEY_SHARE * duration_s).clamp(0.0, duration_s);
            queue.preview(PreviewCommand::Scrub(Some(to)));
        }
    }
    let share = |x: f32| f64::from(((x - rect.left()) / rect.width()).clamp(0.0, 1.0));
    let moved = response.dragged() || response.clicked();
    if let Some(at) = response.interact_pointer_pos().filter(|_| moved) {
        queue.preview(PreviewCommand::Scrub(Some(share(at.x) * duration_s)));
    }
    let hovered = response.hover_pos().map(|at| share(at.x) * duration_s);
    response.on_hover_ui_at_pointer(|ui| {
        if let Some(stage) = hovered.and_then(|time_s| stage_at(forecast, time_s)) {
            ui.label(whole(scene.document, stage));
        }
    });
}

fn stage_at(forecast: &Forecast, time_s: f64) -> Option<&Id> {
    stages(forecast).into_iter().find(|(_, _, to_s)| time_s <= *to_s).map(|(stage, ..)| stage)
}

/// A stage's name, which its band may have no room for, and what is done in it, with the leg.
fn whole(document: &Document, stage: &Id) -> String {
    let legs = document.plan().stage(stage).into_iter().flat_map(legs);
    let acts = legs.flat_map(|leg| leg.actions.iter().map(move |action| (leg, action.act.name())));
    let mut said: Vec<String> = vec![document.label(stage).to_owned()];
    said.extend(acts.take(MOST_ACTIONS + 1).map(|(leg, act)| format!("{act} ({})", document.label(&leg.id))));
    if said.len() > MOST_ACTIONS + 1 {
        said.truncate(MOST_ACTIONS + 1);
        said.push("…".into());
    }
    said.join("\n")
}

/// Its legs with those inside of them, as the document has them.
fn legs(stage: &Stage) -> impl Iterator<Item = &Leg> {
    let mut left: Vec<_> = stage.legs.iter().rev().collect();
    std::iter::from_fn(move || {
        let leg = left.pop()?;
        left.extend(leg.body().iter().rev());
        Some(leg.as_ref())
    })
}

fn draw_strip(painter: &Painter, rect: Rect, scene: &Scene<'_>, p: &Palette) {
    let forecast = scene.forecast();
    let duration_s = forecast.duration_s();
    let x = |time_s: f64| rect.left() + (time_s / duration_s) as f32 * rect.width();
    for (stage, from_s, to_s) in stages(forecast) {
        let name = scene.document.label(stage);
        let band = Rect::from_x_y_ranges(x(from_s) + 1.0..=x(to_s) - 1.0, rect.y_range());
        painter.rect_filled(band, 2.0, p.line);
        let galley = painter.layout_no_wrap(name.into(), FontId::proportional(11.0), p.text);
        if galley.size().x + 4.0 < band.width() {
            painter.galley(
                Align2::CENTER_CENTER.anchor_size(band.center(), galley.size()).min,
                galley,
                p.text,
            );
        }
    }
    if let Some(cursor_s) = scene.view.cursor_s {
        let at = x(cursor_s.min(duration_s));
        painter.vline(at, rect.y_range(), Stroke::new(2.0, p.accent));
        painter.circle_filled(pos2(at, rect.center().y), 4.0, p.accent);
    }
}

/// Each stage with when it begins and ends, seconds.
pub fn stages(forecast: &Forecast) -> Vec<(&flight_plan::Id, f64, f64)> {
    let time =
        |index: usize| forecast.points.get(index).map_or_else(|| forecast.duration_s(), |point| point.time_s);
    let parts = forecast.passages.chunk_by(|a, b| a.stage == b.stage);
    let ends = parts.filter_map(|part| Some((part.first()?, part.last()?)));
    ends.map(|(first, last)| (&first.stage, time(first.first), time(last.end))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_is_told_by_its_whole_name_with_what_is_done_in_it() {
        let leg = |number: usize| {
            format!(
                r#"<TF id="t{number}" lat="1" lon="{number}"><action on="start"><videoStart/></action></TF>"#
            )
        };
        let told = |more: usize| {
            let more: String = (0..more).map(leg).collect();
            let text = format!(
                r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><mainPlan>
                <stage id="s" name="Along the northern ridge" type="mission"><iterative id="l" form="forward" count="2">
                <TF id="a" name="Gap" lat="1" lon="1"><action every="50"><photo/></action></TF></iterative>{more}</stage>
                </mainPlan></flightPlan>"#
            );
            whole(&Document::read(text.as_bytes(), None), &"s".into())
        };
        assert_eq!(told(0), "Along the northern ridge\nTake photos (Gap)");
        let long = told(20);
        assert!(long.contains("Start the video (t0)") && long.ends_with("(t6)\n…"), "{long}");
    }
}
