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
#[derive(Debug, Default, Clone, PartialEq, Serialize, Deserialize)]
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
            theme: app.theme_of_old.unwrap_or(app.view.theme),
            scale: app.view.scale,
        }
    }

    /// For the next run.
    pub fn store(&self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, STORAGE_KEY, self);
    }

    /// For the next run at once, if it is not what is `stored` already: who is ended by force has no time for it later. True: it is
    /// written.
    pub fn keep(self, stored: &mut Self, storage: &mut dyn eframe::Storage) -> bool {
        let is_new = self != *stored;
        if is_new {
            self.store(storage);
            storage.flush();
            *stored = self;
        }
        is_new
    }

    /// What the operator looks at when the window opens.
    pub fn view(&self) -> ViewState {
        // what is stored may be damaged
        let scale = theme::Scale::new(self.scale.get()).unwrap_or_default();
        ViewState { units: self.units, edge: self.edge, theme: self.theme, scale, ..ViewState::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    /// What is on the disk, and what will be.
    #[derive(Default)]
    struct Disk {
        written: HashMap<String, String>,
        waiting: HashMap<String, String>,
        times: usize,
    }

    impl eframe::Storage for Disk {
        fn get_string(&self, key: &str) -> Option<String> {
            self.written.get(key).cloned()
        }
        fn set_string(&mut self, key: &str, value: String) {
            self.waiting.insert(key.into(), value);
        }
        fn remove_string(&mut self, key: &str) {
            self.waiting.remove(key);
        }
        fn flush(&mut self) {
            self.times += 1;
            self.written.extend(self.waiting.drain());
        }
    }

    /// Light was chosen, the program was ended twenty seconds later, and the next one was dark.
    #[test]
    fn a_theme_that_was_chosen_is_on_the_disk_at_once_and_once() {
        let (mut disk, mut stored) = (Disk::default(), Remembered::default());
        let light = Remembered { theme: egui::ThemePreference::Light, ..Remembered::default() };
        for _ in 0..3 {
            light.clone().keep(&mut stored, &mut disk);
        }
        assert_eq!((Remembered::read(&disk), disk.times), (light, 1));
    }
}
