//! Panels that are drawn by themselves.

use gcs_app::app::App;
use gcs_app::connections::Connections;
use gcs_app::document::Document;
use gcs_app::forecast::Analysis;
use gcs_app::jobs::Jobs;
use gcs_app::panels::{Elevations, Scene};
use gcs_app::recent::Recent;
use gcs_app::shelf::Shelf;
use std::sync::Arc;
use terrain::Terrain;

/// What such a panel borrows besides a window's state.
pub struct Alone {
    shelf: Shelf,
    jobs: Jobs,
    recent: Recent,
    connections: Connections,
    terrain: Arc<dyn Terrain>,
}

impl Default for Alone {
    fn default() -> Self {
        let (shelf, jobs, recent, connections) = Default::default();
        Self { shelf, jobs, recent, connections, terrain: gcs_app::assets::demo_terrain() }
    }
}

impl Alone {
    /// A document and what is known of it, with a window's vehicles, view and layers.
    pub fn scene<'a>(&'a self, app: &'a App, document: &'a Document, analysis: &'a Analysis) -> Scene<'a> {
        Scene {
            shelf: &self.shelf,
            jobs: &self.jobs,
            toasts: app.toasts(),
            story: None,
            can_undo: (false, false),
            document,
            analysis,
            vehicle: app.vehicle(),
            aboard: None,
            vehicles: app.vehicles(),
            view: app.view(),
            layers: app.layers(),
            recent: &self.recent,
            connections: &self.connections,
            left_behind: None,
            ground: Elevations(self.terrain.as_ref()),
            now_s: 1.0,
            utc: Default::default(),
        }
    }
}
