//! The plan as it will be flown, one row per passage of a leg. Only the rows in view are laid out.

use super::{Panel, PanelId, Place, Scene, timeline};
use crate::command::{Queue, Selection, ViewCommand};
use crate::forecast::{Passage, Point};
use crate::theme;
use crate::units;
use egui::{RichText, ScrollArea, Sense, Ui};
use egui_extras::{Column, TableBuilder};

/// The panel.
#[derive(Debug)]
pub struct Table;

impl Panel for Table {
    fn id(&self) -> PanelId {
        "table"
    }
    fn name(&self) -> &'static str {
        "Table"
    }
    fn place(&self) -> Place {
        Place::Below
    }
    fn header(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        timeline::show(ui, scene, queue);
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        timeline::strip(ui, scene, queue);
        // where the columns have no room
        ScrollArea::horizontal().id_salt("columns").auto_shrink(false).show(ui, |ui| rows(ui, scene, queue));
    }
}

fn rows(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let u = scene.units();
    let heads = [
        "Leg".into(),
        "Type".into(),
        "Pass".into(),
        "Track".into(),
        format!("Distance, {}", u.distance().symbol),
        format!("Total, {}", u.distance().symbol),
        format!("Altitude AMSL, {}", u.altitude().symbol),
        "ETE".into(),
        "Elapsed".into(),
        format!("Speed, {}", u.speed().symbol),
        "Energy left".into(),
        format!("Above ground, {}", u.altitude().symbol),
    ];
    let passages = &scene.forecast().passages;
    let p = theme::of(ui);
    TableBuilder::new(ui)
        .id_salt("plan table")
        .striped(true)
        .sense(Sense::click())
        .cell_layout(egui::Layout::left_to_right(egui::Align::Center))
        .column(Column::initial(120.0).at_least(60.0).clip(true))
        .columns(Column::initial(60.0).at_least(40.0), 3)
        .columns(Column::remainder().at_least(60.0), 8)
        .header(20.0, |mut header| {
            for head in &heads {
                header.col(|ui| {
                    ui.label(RichText::new(head).size(11.0).color(p.weak));
                });
            }
        })
        .body(|body| {
            body.rows(22.0, passages.len(), |mut row| {
                let Some(passage) = passages.get(row.index()) else { return };
                row.set_selected(scene.is_selected(&Selection::Leg(passage.leg.clone())));
                for text in cells(scene, passage) {
                    row.col(|ui| {
                        ui.add(egui::Label::new(text).truncate().selectable(false));
                    });
                }
                if row.response().clicked() {
                    queue.view(ViewCommand::Select(Some(Selection::Leg(passage.leg.clone()))));
                }
            });
        });
}

fn cells(scene: &Scene<'_>, passage: &Passage) -> [String; 12] {
    let forecast = scene.forecast();
    let kind = scene.document.kind_name(&passage.leg);
    let pass = passage.passes.last().map_or_else(String::new, u64::to_string);
    let points = forecast.part(passage).unwrap_or_default();
    let name = scene.document.leg_label(&passage.leg).to_owned();
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        let mut cells = [(); 12].map(|()| "–".to_owned());
        cells[..3].clone_from_slice(&[name, kind.into(), pass]);
        return cells;
    };
    let u = scene.units();
    [
        name,
        kind.into(),
        pass,
        track(first, last),
        u.distance().number(last.distance_m - first.distance_m),
        u.distance().number(last.distance_m),
        u.altitude().number(last.altitude_amsl_m),
        units::duration(last.time_s - first.time_s),
        units::duration(last.time_s),
        u.speed().number((last.distance_m - first.distance_m) / (last.time_s - first.time_s)),
        format!("{:.0} %", 100.0 * passage.energy_left),
        passage.clearance_m.map_or_else(|| "–".into(), |metres| u.altitude().number(metres)),
    ]
}

/// Direction from start to end, where that means something.
fn track(first: &Point, last: &Point) -> String {
    let way = first.position.inverse(last.position);
    let straight = way.distance_m > 0.8 * (last.distance_m - first.distance_m);
    if straight && way.distance_m > 1.0 { units::bearing(way.bearing_start_deg) } else { "–".into() }
}
