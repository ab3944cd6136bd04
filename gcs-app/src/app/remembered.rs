//! What is remembered from one run to the next.

use super::App;
use crate::connections::Connections;
use crate::layers::Kept;
use crate::map::furniture::Edge;
use crate::panels::ViewState;
use crate::recent::Recent;
use crate::theme;
use crate::units::Units;
use serde::{Deserialize, Serialize};

const STORAGE_KEY: &str = "legwork";

/// What one run leaves to the next.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Remembered {
    pub units: Units,
    #[serde(default)]
    pub layers: Vec<Kept>,
    #[serde(default)]
    pub tour_seen: bool,
    #[serde(default)]
    pub edge: Edge,
    #[serde(default)]
    pub recent: Recent,
    #[serde(default)]
    pub connections: Connections,
    #[serde(default)]
    pub theme: egui::ThemePreference,
    #[serde(default)]
    pub scale: theme::Scale,
}

impl Remembered {
    /// Of an earlier run; what can't be read is as in the first one.
    pub fn read(storage: &dyn eframe::Storage) -> Self {
        eframe::get_value(storage, STORAGE_KEY).unwrap_or_default()
    }

    /// Of this window.
    pub fn of(app: &App) -> Self {
        Self {
            units: app.view.units,
            tour_seen: app.tour_seen,
            layers: app.layers.kept(),
            edge: app.view.edge,
            recent: app.recent.clone(),
            connections: app.connections.clone(),
            theme: app.view.theme,
            scale: app.view.scale,
        }
    }

    /// For the next run.
    pub fn store(&self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, STORAGE_KEY, self);
    }

    /// What the operator looks at when the window opens.
    pub fn view(&self) -> ViewState {
        // what is stored may be damaged
        let scale = theme::Scale::new(self.scale.get()).unwrap_or_default();
        ViewState { units: self.units, edge: self.edge, theme: self.theme, scale, ..ViewState::default() }
    }
}
