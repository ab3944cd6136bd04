//! What each painter of the map is given.

use super::names::{Name, Names};
use super::polyline::{self, Style};
use super::sketch::Sketch;
use super::view::{Mercator, View};
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{Painter, Pos2, Stroke};
use geometry::LatLon;
use std::cell::RefCell;

/// The map in one frame: what is drawn on, where things are there, and what there is to be drawn.
#[derive(Clone, Copy)]
pub struct Sheet<'a> {
    /// What is drawn on.
    pub painter: &'a Painter,
    /// Where things are on the screen.
    pub view: &'a View,
    /// The plan's places.
    pub sketch: &'a Sketch,
    /// Everything else there is to know.
    pub scene: &'a Scene<'a>,
    /// Where names are asked for.
    pub names: &'a RefCell<Names>,
    /// The colours.
    pub p: &'a Palette,
}

impl<'a> Sheet<'a> {
    /// The same for another painter, that paints fainter.
    pub fn with<'b>(&'b self, painter: &'b Painter) -> Sheet<'b> {
        Sheet { painter, ..*self }
    }

    /// A position on the screen.
    pub fn place(&self, at: LatLon) -> Pos2 {
        self.view.place(at)
    }

    /// Draws a line from place to place, as much of it as is near the screen.
    pub fn line(&self, places: impl IntoIterator<Item = LatLon>, stroke: Stroke, style: Style) {
        let line: Vec<Mercator> = places.into_iter().map(Mercator::from).collect();
        let parts = polyline::visible_parts(&line, self.view);
        polyline::draw(self.painter, &parts, stroke, style, self.p.halo);
    }

    /// Asks for a name, as opaque as what is drawn.
    pub fn ask(&self, name: Name) {
        self.names.borrow_mut().ask(self.painter, name);
    }
}
