//! What is drawn in the table's cells.

use super::cursor_id;
use super::rows::Why;
use super::typed::Column;
use crate::command::{Queue, Selection, ViewCommand};
use crate::panels::Scene;
use crate::panels::tree::menu;
use crate::theme;
use egui::{Align2, FontId, Id as WidgetId, Rect, Response, Role, Sense, Stroke, StrokeKind, Ui};
use egui_extras::TableRow;

/// A cell that can be typed into.
pub(super) fn cell(ui: &mut Ui, at: (usize, Column), is_current: bool, text: String, name: &str) -> Response {
    let rect = ui.max_rect();
    let (id, sense) = match is_current {
        true => (cursor_id(), Sense::click_and_drag()),
        // one stop of the Tab key; from there the arrows go on
        false => (WidgetId::unique(("table cell", at.0, at.1.name())), Sense::CLICK | Sense::DRAG),
    };
    ui.add_space(4.0);
    ui.add(egui::Label::new(&text).truncate().selectable(false));
    let response = ui.interact(rect, id, sense);
    response.widget_info(|| egui::WidgetInfo::labeled(Role::Button, true, name));
    if response.has_focus() {
        let stroke = Stroke::new(1.0, theme::of(ui).accent);
        ui.painter().rect_stroke(rect.shrink(0.5), 3.0, stroke, StrokeKind::Inside);
    }
    response.on_hover_text(format!("{text}\nDouble-click or F2 to change it"))
}

/// Why a leg is not flown: over all columns that would say how it is.
pub(super) fn not_flown(ui: &mut Ui, whole: Rect, scene: &Scene<'_>, why: Why<'_>) {
    let rect = ui.max_rect();
    let text = why.told(scene);
    let painter = ui.painter().with_clip_rect(whole.intersect(rect.with_max_x(f32::INFINITY)));
    let p = theme::of(ui);
    let colour = match why {
        Why::LeftOut(_) => p.caution,
        Why::NotForeseen | Why::Aside(_) => p.weak,
    };
    painter.text(rect.left_center(), Align2::LEFT_CENTER, &text, FontId::proportional(12.5), colour);
    let response = ui.response();
    response.widget_info(|| egui::WidgetInfo::labeled(Role::Label, true, &text));
    response.on_hover_text(text);
}

/// Where a stage begins, an emergency plan or a procedure: its name over all columns. True: it is grabbed.
pub(super) fn heading(
    row: &mut TableRow<'_, '_>,
    whole: Rect,
    scene: &Scene<'_>,
    part: &Selection,
    queue: &mut Queue,
) -> bool {
    row.set_selected(scene.is_selected(part));
    let name = scene.document.label(part.id());
    let (kind, shown) = match part {
        Selection::Emergency(_) => ("Emergency plan", format!("Emergency plan: {name}")),
        Selection::Procedure(_) => ("Procedure", format!("Procedure: {name}")),
        _ => ("Stage", name.to_owned()),
    };
    row.col(|ui| {
        let rect = ui.max_rect();
        let painter = ui.painter().with_clip_rect(whole.intersect(rect.with_max_x(f32::INFINITY)));
        let at = rect.left_center();
        painter.text(at, Align2::LEFT_CENTER, shown, FontId::proportional(12.5), theme::of(ui).accent);
        let response = ui.response();
        response.widget_info(|| egui::WidgetInfo::labeled(Role::Label, true, format!("{kind} {name}")));
    });
    for _ in 1..Column::COUNT {
        row.col(|_| {});
    }
    let response = row.response();
    response.context_menu(|ui| menu::show(ui, scene, part, queue));
    if response.clicked() {
        queue.view(ViewCommand::Select(Some(part.clone())));
    }
    response.drag_started() && matches!(part, Selection::Stage(_))
}
