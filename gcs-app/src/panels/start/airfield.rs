//! What is known of the ground and the airport where the runway of a new mission is to be.

use super::said;
use crate::airfields::{self, Ground};
use crate::guide::{Answer, Guide};
use crate::panels::{Scene, field};
use crate::theme;
use egui::{RichText, Ui};
use geometry::LatLon;

/// So many directions are offered.
const MOST: usize = 8;

/// The runways of an airport near by, to choose one with its direction, and the elevation with whoever says so.
pub fn offer(ui: &mut Ui, threshold: LatLon, guide: &mut Guide, scene: &Scene<'_>) {
    let p = theme::of(ui);
    // also where there is none: what is below keeps its place
    field::row(ui, "Known", |ui| {
        let near = airfields::near(threshold).filter(|(_, landings)| !landings.is_empty());
        let Some((airport, landings)) = near else {
            ui.label(RichText::new("no airport near").color(p.weak));
            return;
        };
        ui.horizontal_wrapped(|ui| {
            for landing in landings.into_iter().take(MOST) {
                let name = format!("Runway {}", landing.name);
                let chosen = ui
                    .selectable_label(guide.is(&landing), landing.name)
                    .on_hover_text(format!("{name} of {airport}"));
                chosen.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
                if chosen.clicked() {
                    guide.take(Answer::Runway(landing.threshold, landing.end));
                }
            }
        });
    });
    let ground = Ground::of(scene.layers.ground().as_ref(), threshold);
    let colour = if ground == Ground::Unknown { p.caution } else { p.text };
    field::row(ui, "Ground", |ui| {
        said(ui, &ground.words(scene.units()), colour);
    });
}
