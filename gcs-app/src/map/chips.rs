//! Chips at the map's lower right: in which world the path is flown, whether it is up to date, and what its colours mean.

use super::marks;
use crate::command::{PreviewCommand, Queue, ViewCommand};
use crate::forecast::Coverage;
use crate::map::{coverage, view::View};
use crate::panels::{Scene, problems, what_if};
use crate::theme::{self, Palette};
use egui::{Align2, Area, Id, Margin, Rect, RichText, Ui, vec2};
use flight_plan::Problem;

/// Widest chip, the room below for the sources of the map and the place of the pointer, and the one beside for the arrow to the north, screen points.
const WIDTH: f32 = 330.0;
const BELOW: f32 = 36.0;
const BESIDE: f32 = 44.0;

/// Draws them, the most urgent one lowest.
pub fn show(ui: &Ui, view: &View, scene: &Scene<'_>, queue: &mut Queue) {
    let corner = view.rect.right_bottom() - vec2(BESIDE, BELOW);
    let width = WIDTH.min(view.rect.width() - 170.0 - BESIDE).max(160.0);
    let area = Area::new(area_id()).fixed_pos(corner).pivot(Align2::RIGHT_BOTTOM);
    area.constrain_to(view.rect).show(ui.ctx(), |ui| {
        ui.set_max_width(width);
        let p = theme::of(ui);
        colours(ui, scene, queue);
        world(ui, scene, queue);
        standing(ui, scene, p, queue);
    });
}

fn area_id() -> Id {
    Id::unique("map chips")
}

/// Where they were in the last frame.
pub fn shown(ctx: &egui::Context) -> Option<Rect> {
    ctx.memory(|memory| memory.area_rect(area_id()))
}

fn chip(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    theme::card(ui).inner_margin(Margin::symmetric(8, 4)).show(ui, add);
}

fn row(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    chip(ui, |ui| drop(ui.horizontal(add)));
}

/// What is out of date says so, and a plan that is wrong where.
fn standing(ui: &mut Ui, scene: &Scene<'_>, p: &Palette, queue: &mut Queue) {
    let Some(why) = scene.out_of_date() else { return };
    let error = marks::first_error(scene);
    // on a small map the sentence takes several lines: cut, it would say nothing
    chip(ui, |ui| {
        ui.horizontal_wrapped(|ui| standing_words(ui, scene, (why, error), p, queue));
    });
}

fn standing_words(
    ui: &mut Ui,
    scene: &Scene<'_>,
    (why, error): (&str, Option<&Problem>),
    p: &Palette,
    queue: &mut Queue,
) {
    let place = error.and_then(|e| problems::find(scene.document, e.subject.as_ref()?));
    if let Some(place) = place
        && ui.small_button("Show the error").clicked()
    {
        queue.view(ViewCommand::JumpTo(place));
    }
    let text = RichText::new(format!("◌ {why}")).color(p.caution).size(12.0);
    ui.add(egui::Label::new(text).wrap());
}

fn world(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let words = what_if::in_words(&scene.view.what_if, scene.document.plan(), scene.units(), scene.utc);
    let alarm = scene.view.alarm_at_cursor().map(what_if::alarm_in_words);
    let words = [words].into_iter().filter(|words| !words.is_empty()).chain(alarm).collect::<Vec<_>>();
    if words.is_empty() {
        return;
    }
    let words = words.join(" · ");
    let behind = what_if::from_behind(&scene.view.what_if, scene.document.plan(), scene.units());
    if let Some(behind) = behind {
        let text = RichText::new(behind).color(theme::of(ui).caution).size(12.0);
        chip(ui, |ui| drop(ui.add(egui::Label::new(text).wrap())));
    }
    row(ui, |ui| {
        let button = ui.small_button("✖");
        button.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Button, true, "Back to the plan's own world")
        });
        if button.on_hover_text("Back to the plan's own world").clicked() {
            queue.preview(PreviewCommand::Reset);
        }
        // whole: it says what the whole map is about
        ui.add(egui::Label::new(RichText::new(format!("What if: {words}")).size(12.0)).wrap());
    });
}

fn colours(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(known) = scene.analysis.coverage().filter(|_| scene.view.coverage) else { return };
    chip(ui, |ui| {
        ui.horizontal(|ui| {
            let name = "Put the coverage away";
            let button = ui.small_button("✖");
            button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
            if button.on_hover_text(name).clicked() {
                queue.preview(PreviewCommand::Coverage(false));
            }
            ui.add(egui::Label::new(RichText::new(title(known)).size(11.5)).wrap());
        });
        coverage::legend(ui, known);
    });
}

/// What the colours tell; how far that has got is told until it is there.
fn title(known: &Coverage) -> String {
    let what = "How the worst alarm would end, as it is flown";
    match known.is_complete() {
        true => what.to_owned(),
        false => format!("{what}: {:.0} % worked out", known.progress() * 100.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forecast::{Forecast, Point};

    #[test]
    fn a_coverage_that_is_all_there_names_no_percentage_of_its_own() {
        let point = |time_s| Point {
            time_s,
            distance_m: 0.0,
            position: geometry::LatLon::new(0.0, 0.0),
            altitude_amsl_m: 0.0,
            ground_amsl_m: None,
            passage: 0,
        };
        let forecast = Forecast { points: vec![point(0.0), point(9.0)], ..Forecast::default() };
        let mut coverage = Coverage::of(&forecast);
        coverage.push(None);
        assert_eq!(title(&coverage), "How the worst alarm would end, as it is flown: 50 % worked out");
        coverage.push(None);
        assert_eq!(title(&coverage), "How the worst alarm would end, as it is flown");
    }
}
