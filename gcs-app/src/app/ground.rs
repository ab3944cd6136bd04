//! The maps and elevations that users bring: what is asked of them, and what follows when the ground becomes another.

use super::App;
use crate::forecast::{Aboard, Worker};
use crate::layers::LayerCommand;
use egui::Context;

impl App {
    /// Shows the ground's relief on the map.
    pub fn shade_ground(&mut self, ctx: &Context) {
        self.map.shade(Some(self.layers.elevations()), ctx);
    }

    pub(super) fn change_layers(&mut self, command: LayerCommand) {
        match command {
            LayerCommand::Add(source) => {
                let added = self.layers.add(source);
                self.tell(added);
            }
            LayerCommand::Ask { folder } => self.files.ask_map(folder),
            LayerCommand::GoTo(id) => {
                let bounds = self.layers.iter().find(|layer| layer.id == id).and_then(|layer| layer.bounds());
                if let Some((south_west, north_east)) = bounds {
                    self.view.follow = false;
                    self.map.fit_to([south_west, north_east]);
                }
            }
            change => self.layers.change(&change),
        }
    }

    /// Takes what was opened; where the ground has changed, plan and relief are looked at again.
    pub(super) fn drain_layers(&mut self, ctx: &Context) {
        while let Some(opened) = self.layers.opened() {
            match opened {
                Ok(opened) => self.map.add_raster(opened, ctx),
                Err(why) => self.view.notice = Some(why),
            }
        }
        if self.layers.take_ground_changed() {
            // what was asked and found over the former ground ends with its worker
            if let Err(error) = self.begin_anew() {
                tracing::warn!(%error, "no thread to look at the plan over the new ground");
            }
            if self.map.is_shaded() {
                self.shade_ground(ctx);
            }
        }
    }

    fn begin_anew(&mut self) -> std::io::Result<()> {
        let ground = self.layers.elevations();
        self.worker = Worker::spawn(ground.clone(), self.wake.clone())?;
        self.aboard = Aboard::spawn(ground.clone(), self.wake.clone())?;
        Ok(())
    }
}
