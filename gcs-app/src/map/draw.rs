//! What the map shows in a frame, from the ground up.

use super::names::Names;
use super::sheet::Sheet;
use super::tools::{self, Canvas};
use super::view::View;
use super::{
    MapState, acts, aircraft, chips, clipboard, footprints, foreseen, furniture, graticule, held, kin,
    left_out, marks, path, plan, variables, zones,
};
use crate::command::Queue;
use crate::panels::{Scene, start};
use crate::theme;
use egui::layers::ShapeIdx;
use egui::{Pos2, Role, Shape, Ui};
use std::cell::RefCell;

impl MapState {
    /// Draws everything and takes what the operator does on it. The pointer is there, if it is over the map.
    pub(super) fn draw(
        &mut self,
        ui: &mut Ui,
        response: &egui::Response,
        (view, pointer): (&View, Option<Pos2>),
        scene: &Scene<'_>,
        queue: &mut Queue,
    ) {
        response.widget_info(|| egui::WidgetInfo::labeled(Role::Canvas, true, "Map"));
        let p = theme::of(ui);
        let painter = ui.painter_at(view.rect);
        let names = RefCell::new(Names::default());
        let sheet = Sheet { painter: &painter, view, sketch: &self.sketch, scene, names: &names, p };
        self.ground.draw(&sheet, ui.visuals().dark_mode);
        let ground_names = draw_grid(&sheet);
        draw_plan(&sheet, &mut self.path, &mut self.aircraft);
        marks::draw_faults(&sheet);
        path::move_cursor(response, view, scene, queue);
        let snaps = !ui.input(|i| i.modifiers.alt);
        let near = tools::near(view, &self.sketch, scene);
        let canvas = Canvas { view, sketch: &self.sketch, scene, near: &near, pointer, snaps, names: &names };
        self.items.run(ui, &canvas, !self.tools.offers_handles(), queue);
        let asked = self.tools.run(ui, response, &canvas, queue, p);
        self.menu.run(ui, asked, &canvas, queue);
        variables::take_dropped(ui, &canvas, queue);
        if let Some(clip) = self.clip.take() {
            clipboard::carry_out(clip, ui, &canvas, queue);
        }
        clipboard::run(ui, &mut self.menu, &mut self.pastes, &canvas, queue);
        path::draw_cursor(&sheet);
        start::draw(&painter, view, scene, p);
        aircraft::draw(&sheet);
        let mut names = names.take();
        furniture::draw(&painter, view, scene, self.tools.cards().count(), &mut names, p);
        let mut written = names.write(&painter, p);
        painter.set(ground_names, Shape::Vec(self.ground.names(&sheet, &mut written)));
        chips::show(ui, view, scene, queue);
        // over what can be grabbed, too
        let over = ui.rect_contains_pointer(view.rect).then(|| ui.ctx().pointer_hover_pos()).flatten();
        furniture::pointer(ui, view, over, scene);
    }
}

/// What lies over the ground on request. Returns where the names of the ground are painted when all others have their places: below
/// that and the plan.
fn draw_grid(sheet: &Sheet<'_>) -> ShapeIdx {
    let names = sheet.painter.add(Shape::Noop);
    if sheet.scene.view.edge.graticule {
        graticule::draw(sheet);
    }
    if sheet.scene.view.edge.rings {
        graticule::draw_rings(sheet);
    }
    names
}

/// The plan, the paths that will be, would be and were flown.
fn draw_plan(sheet: &Sheet<'_>, path: &mut path::Layer, aircraft: &mut aircraft::Layer) {
    let kin = kin::Kin::of(sheet.scene);
    zones::draw(sheet, &kin);
    variables::draw_areas(sheet);
    plan::draw_areas(sheet, &kin);
    variables::draw(sheet);
    plan::draw_emergencies(sheet, &kin);
    footprints::draw(sheet);
    plan::draw_ways(sheet, &kin);
    plan::draw_procedure(sheet);
    path.draw(sheet);
    left_out::draw(sheet);
    acts::draw(sheet, &kin);
    aircraft.draw_trail(sheet);
    foreseen::draw(sheet);
    aircraft::draw_ahead(sheet);
    held::draw(sheet);
    path::draw_decision(sheet);
    plan::draw_runways(sheet);
    marks::draw_diversion(sheet);
}
