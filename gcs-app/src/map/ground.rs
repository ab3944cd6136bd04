//! What lies below the plan: the bundled world, the shaded ground, and the maps that users brought.

use super::basemap;
use super::rasters::Raster;
use super::sheet::Sheet;
use crate::chart::labels::Labels;
use crate::layers::Opened;
use crate::tiles::{Reader, Relief};
use egui::Shape;
use std::collections::BTreeMap;
use std::sync::Arc;
use terrain::Terrain;

/// The layers of the ground.
#[derive(Debug, Default)]
pub struct Ground {
    basemap: basemap::Layer,
    relief: Option<Raster>,
    /// Maps that users brought, by the number of their layer.
    rasters: BTreeMap<u64, Raster>,
}

impl Ground {
    /// Shades this ground, or none.
    pub fn shade(&mut self, ground: Option<&Arc<dyn Terrain>>, ctx: &egui::Context) {
        let relief = ground.map(|ground| Box::new(Relief::new(ground.clone())) as Box<dyn Reader>);
        self.relief = relief.map(|relief| Raster::new(vec![relief], Relief::about(), &Arc::default(), ctx));
    }

    /// It is shaded.
    pub fn is_shaded(&self) -> bool {
        self.relief.is_some()
    }

    /// Shows a map's tiles from now on, as long as its layer is there.
    pub fn add_raster(&mut self, opened: Opened, ctx: &egui::Context) {
        let raster = Raster::new(opened.readers, opened.about, &opened.health, ctx);
        self.rasters.insert(opened.id, raster);
    }

    /// So many pictures of a layer's tiles are here.
    pub fn pictures_of(&self, layer: u64) -> usize {
        self.rasters.get(&layer).map_or(0, Raster::pictures)
    }

    /// No tile of what was drawn last is on its way.
    pub fn is_whole(&self) -> bool {
        self.relief.iter().chain(self.rasters.values()).all(Raster::is_whole)
    }

    /// Draws the world, the relief, then the maps from the lowest to the uppermost.
    pub fn draw(&mut self, sheet: &Sheet<'_>, dark: bool) {
        let Sheet { painter, view, scene, .. } = *sheet;
        self.basemap.draw(sheet);
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

    /// The names of the ground, where there is room beside what is written already.
    pub fn names(&self, sheet: &Sheet<'_>, placed: &mut Labels) -> Vec<Shape> {
        self.basemap.names(sheet, placed)
    }
}
