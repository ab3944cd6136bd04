//! Chips at the map's lower right: in which world the path is flown, whether it is up to date, and what its colours mean.

use super::furniture::NARROW;
use super::marks;
use crate::command::{PreviewCommand, Queue, ViewCommand};
use crate::map::{coverage, view::View};
use crate::panels::{Scene, problems, what_if};
use crate::theme::{self, Palette};
use egui::{Align2, Area, Id, Margin, Rect, RichText, Ui, vec2};

/// Widest chip, the room below for the sources of the map and the one beside for the arrow to the north, screen points.
const WIDTH: f32 = 330.0;
const BELOW: f32 = 22.0;
const BESIDE: f32 = 44.0;

/// Draws them, the most urgent one lowest.
pub fn show(ui: &Ui, view: &View, scene: &Scene<'_>, queue: &mut Queue) {
    let corner = view.rect.right_bottom() - vec2(BESIDE, BELOW);
    let width = WIDTH.min(view.rect.width() - 170.0 - BESIDE).max(160.0);
    let area = Area::new(area_id()).fixed_pos(corner).pivot(Align2::RIGHT_BOTTOM);
    area.constrain_to(view.rect).show(ui.ctx(), |ui| {
        ui.set_max_width(width);
        let p = theme::of(ui);
        colours(ui, scene, view.rect.width() < NARROW);
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
    row(ui, |ui| {
        let place = error.and_then(|e| problems::find(scene.document, e.subject.as_ref()?));
        if let Some(place) = place
            && ui.small_button("Show the error").clicked()
        {
            queue.view(ViewCommand::JumpTo(place));
        }
        let text = RichText::new(format!("◌ {why}")).color(p.caution).size(12.0);
        ui.add(egui::Label::new(text).truncate()).on_hover_text(why);
    });
}

fn world(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let words = what_if::in_words(&scene.view.what_if, scene.document.plan(), scene.units());
    let alarm = scene.view.alarm_at_cursor().map(what_if::alarm_in_words);
    let words = [words].into_iter().filter(|words| !words.is_empty()).chain(alarm).collect::<Vec<_>>();
    if words.is_empty() {
        return;
    }
    let words = words.join(" · ");
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

fn colours(ui: &mut Ui, scene: &Scene<'_>, is_narrow: bool) {
    let Some(known) = scene.analysis.coverage().filter(|_| scene.view.coverage) else { return };
    chip(ui, |ui| {
        // on a small map the lines say enough
        if !is_narrow {
            let title = format!("Coverage, worst alarm ({:.0} %)", known.progress() * 100.0);
            ui.label(RichText::new(title).size(11.5));
        }
        coverage::legend(ui, known);
    });
}
