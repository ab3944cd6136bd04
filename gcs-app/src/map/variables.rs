//! Variables of the plan that are a place or an area: where they are now, with their radius where they have one.

use super::names::{self, Ground, Name, Rank};
use super::polyline::Style;
use super::sheet::Sheet;
use super::sketch::PlacedVariable;
use super::tools::Canvas;
use super::tools::pick::things_near;
use crate::command::{Queue, Selection, ViewCommand};
use crate::panels::binding::DraggedVariable;
use crate::theme;
use egui::{Align2, DragAndDrop, Pos2, Rect, Shape, Stroke, Ui, vec2};
use flight_plan::Id;
use flight_plan::create::place_binding;

const NOWHERE: &str =
    "Drop a place or an area on a leg that goes there, and a number on its field in the inspector.";

/// From the middle of a mark to its corners, screen points.
const MARK: f32 = 6.0;
/// Greatest circle that is drawn, screen points.
const WIDEST: f32 = 20_000.0;

/// Every variable that is a place.
pub fn draw(sheet: &Sheet<'_>) {
    for variable in &sheet.sketch.variables {
        let selected = sheet.scene.is_selected(&Selection::Variable(variable.name.clone()));
        draw_one(sheet, variable, selected);
    }
}

fn draw_one(sheet: &Sheet<'_>, variable: &PlacedVariable, selected: bool) {
    let Sheet { painter, view, p, .. } = *sheet;
    let at = view.place(variable.at);
    let width = if selected { 2.4 } else { 1.6 };
    let radius = variable.radius_m.map_or(0.0, |radius_m| (radius_m * view.points_per_metre()) as f32);
    let is_in_view = view.rect.expand(radius + 40.0).contains(at);
    if !is_in_view || radius > WIDEST {
        return;
    }
    if radius > MARK {
        painter.circle(at, radius, p.caution.gamma_multiply(0.12), Stroke::new(width, p.caution));
    }
    let corner = |x: f32, y: f32| -> Pos2 { at + vec2(x, y) * MARK };
    let corners = vec![corner(0.0, -1.0), corner(1.0, 0.0), corner(0.0, 1.0), corner(-1.0, 0.0)];
    painter.add(Shape::convex_polygon(corners, p.caution, Stroke::new(width, p.halo)));
    // clear of what is flown around it
    let [right, left, above, below] = names::beside(at, radius.max(MARK) + 3.0);
    let (rank, spots, text) =
        (Rank::Place.or_selected(selected), [above, below, right, left], name(&variable.name));
    sheet.ask(Name { rank, spots, text, size: 11.5, colour: p.text, ground: Ground::Halo });
}

/// Every variable that is an area: its outline, and its name above or in it.
pub fn draw_areas(sheet: &Sheet<'_>) {
    let Sheet { view, p, .. } = *sheet;
    for (variable, corners) in &sheet.sketch.areas {
        let selected = sheet.scene.is_selected(&Selection::Variable(variable.clone()));
        let stroke = Stroke::new(if selected { 2.4 } else { 1.6 }, p.caution);
        sheet.line(corners.iter().chain(corners.first()).copied(), stroke, Style::Solid);
        let bounds = Rect::from_points(&corners.iter().map(|at| view.place(*at)).collect::<Vec<_>>());
        if !bounds.intersects(view.rect) {
            continue;
        }
        let seen = bounds.intersect(view.rect);
        let above = (seen.center_top() - vec2(0.0, 4.0), Align2::CENTER_BOTTOM);
        let below = (seen.center_bottom() + vec2(0.0, 4.0), Align2::CENTER_TOP);
        let top = (seen.center_top() + vec2(0.0, 4.0), Align2::CENTER_TOP);
        let middle = (seen.center(), Align2::CENTER_CENTER);
        // the name of the selected one is grabbed with its area
        let spots = if selected { [top, middle, above, below] } else { [above, below, top, middle] };
        let (rank, text) = (Rank::Place.or_selected(selected), name(variable));
        sheet.ask(Name { rank, spots, text, size: 11.5, colour: p.text, ground: Ground::Halo });
    }
}

/// A variable whose row is dragged onto a leg's place gives that place.
pub fn take_dropped(ui: &Ui, canvas: &Canvas<'_>, queue: &mut Queue) {
    let Some(dragged) = DragAndDrop::payload::<DraggedVariable>(ui.ctx()) else { return };
    let Some(at) = ui.input(|i| i.pointer.latest_pos()).filter(|at| canvas.view.rect.contains(*at)) else {
        return;
    };
    let plan = canvas.scene.document.plan();
    let binds = |thing: Selection| match thing {
        Selection::Leg(leg) => {
            let place = place_binding(plan, &leg)?;
            let edit =
                place.choices.into_iter().find(|(name, _)| *name == dragged.0).map(|(_, edit)| edit)?;
            Some((leg, edit))
        }
        _ => None,
    };
    let found = things_near(at, canvas).into_iter().find_map(binds);
    if found.is_some() {
        ui.painter().circle_stroke(at, 12.0, Stroke::new(2.0, theme::of(ui).accent));
    }
    match found {
        _ if !ui.input(|i| i.pointer.any_released()) => {}
        Some((leg, edit)) => {
            queue.edit(edit);
            queue.view(ViewCommand::Select(Some(Selection::Leg(leg))));
        }
        None => queue.view(ViewCommand::Notice(NOWHERE.into())),
    }
}

/// As people write it.
pub fn name(variable: &Id) -> String {
    variable.as_str().replace('_', " ")
}
