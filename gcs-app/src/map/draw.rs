//! What the map shows in a frame, from the ground up.

use super::names::Names;
use super::tools::Canvas;
use super::view::View;
use super::{
    MapState, aircraft, chips, clipboard, footprints, foreseen, furniture, graticule, kin, left_out, marks,
    path, plan, variables, zones,
};
use crate::command::{Queue, Selection};
use crate::panels::{Scene, start};
use crate::theme::{self, Palette};
use egui::layers::ShapeIdx;
use egui::{Painter, Pos2, Role, Shape, Ui};
use flight_plan::Id;
use geometry::LatLon;
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
        let ground_names = self.draw_ground(&painter, view, scene, ui.visuals().dark_mode, p);
        let mut names = Names::default();
        self.draw_plan(&painter, view, scene, &mut names, p);
        self.draw_faults(&painter, view, scene, &mut names, p);
        let names = RefCell::new(names);
        path::move_cursor(response, view, scene, queue);
        let snaps = !ui.input(|i| i.modifiers.alt);
        let canvas = Canvas { view, sketch: &self.sketch, scene, pointer, snaps, names: &names };
        self.items.run(ui, &canvas, !self.tools.offers_handles(), queue);
        let asked = self.tools.run(ui, response, &canvas, queue, p);
        self.menu.run(ui, asked, &canvas, queue);
        variables::take_dropped(ui, &canvas, queue);
        if let Some(clip) = self.clip.take() {
            clipboard::carry_out(clip, ui, &canvas, queue);
        }
        clipboard::run(ui, &mut self.menu, &mut self.pastes, &canvas, queue);
        path::draw_cursor(&painter, view, scene, p);
        start::draw(&painter, view, scene, p);
        let mut names = names.into_inner();
        aircraft::draw(&painter, view, scene, &mut names, p);
        furniture::draw(&painter, view, scene, self.tools.cards().count(), &mut names, p);
        let mut written = names.write(&painter, p);
        painter.set(ground_names, Shape::Vec(self.basemap.names(&painter, view, &mut written, p)));
        chips::show(ui, view, scene, queue);
        // over what can be grabbed, too
        let over = ui.rect_contains_pointer(view.rect).then(|| ui.ctx().pointer_hover_pos()).flatten();
        furniture::pointer(ui, view, over, scene);
    }

    /// Returns where the names of the ground are painted when all others have their places: below the plan.
    fn draw_ground(
        &mut self,
        painter: &Painter,
        view: &View,
        scene: &Scene<'_>,
        dark: bool,
        p: &Palette,
    ) -> ShapeIdx {
        self.basemap.draw(painter, view, p);
        self.draw_rasters(painter, view, scene, dark);
        let names = painter.add(Shape::Noop);
        if scene.view.edge.graticule {
            graticule::draw(painter, view, p);
        }
        if scene.view.edge.rings {
            graticule::draw_rings(painter, view, scene, p);
        }
        names
    }

    /// The plan, the paths that will be, would be and were flown.
    fn draw_plan(
        &mut self,
        painter: &Painter,
        view: &View,
        scene: &Scene<'_>,
        names: &mut Names,
        p: &Palette,
    ) {
        let kin = kin::Kin::of(scene);
        zones::draw(painter, view, (scene, &kin), names, p);
        plan::draw_areas(painter, view, &self.sketch, (scene, &kin), p);
        variables::draw(painter, view, &self.sketch, scene, names, p);
        plan::draw_emergencies(painter, view, &self.sketch, (scene, &kin), names, p);
        footprints::draw(painter, view, &self.sketch, scene, names, p);
        plan::draw_ways(painter, view, &self.sketch, (scene, &kin), names, p);
        self.path.draw(painter, view, scene, &self.sketch, p);
        let place_of_leg = |id: &Id| self.place_of(&Selection::Leg(id.clone()), scene.document.plan());
        left_out::draw(painter, view, scene, place_of_leg, names, p);
        self.aircraft.draw_trail(painter, view, scene, p);
        foreseen::draw(painter, view, scene, names, p);
        aircraft::draw_ahead(painter, view, scene, p);
        path::draw_decision(painter, view, scene, names, p);
        plan::draw_runways(painter, view, scene.document.plan(), names, p);
        marks::draw_diversion(painter, view, scene, names, p);
    }

    fn draw_faults(&self, painter: &Painter, view: &View, scene: &Scene<'_>, names: &mut Names, p: &Palette) {
        marks::draw_off_plan(painter, view, scene, &self.sketch, p);
        let place = |problem| self.place_of_problem(problem, scene);
        let error_at = marks::first_error(scene).and_then(place);
        let others: Vec<LatLon> = marks::off_path(scene).filter_map(place).collect();
        marks::draw_failures(painter, view, scene, (error_at, &others), names, p);
    }

    /// The relief, then the maps from the lowest to the uppermost.
    fn draw_rasters(&mut self, painter: &Painter, view: &View, scene: &Scene<'_>, dark: bool) {
        if let Some(relief) = &mut self.relief {
            relief.draw(painter, view, 1.0, dark);
        }
        self.rasters.retain(|id, _| scene.layers.iter().any(|layer| layer.id == *id));
        for layer in scene.layers.iter().rev().filter(|layer| layer.kept.shown) {
            if let Some(raster) = self.rasters.get_mut(&layer.id) {
                raster.draw(painter, view, layer.kept.opacity, dark);
            }
        }
    }
}
