//! The circle that is held: as it is seen to be flown, and until then as the agent says it.

use super::names::{self, Ground, Name, Rank};
use super::sheet::Sheet;
use crate::state::Circle;
use egui::{Shape, Stroke, vec2};
use usal::contract::Action;

/// Half of the cross at its centre, screen points.
const CROSS: f32 = 4.0;
/// Smaller ones are not drawn, screen points.
const LEAST: f32 = 6.0;

/// Draws it, with its radius.
pub fn draw(sheet: &Sheet<'_>) {
    let scene = sheet.scene;
    if !scene.vehicle.is_airborne() {
        return;
    }
    let seen = scene.vehicle.circling.circle();
    if let Some(circle) = seen.or_else(|| scene.vehicle.told_circle(scene.now_s)) {
        return circle_of(sheet, circle, "held");
    }
    let ahead = scene.vehicle.ahead.iter().flat_map(|ahead| &ahead.value.waypoints).enumerate();
    let told = ahead.filter(|(_, waypoint)| waypoint.position.is_valid()).find_map(|(index, waypoint)| {
        let Action::Loiter { radius_m } = waypoint.action else { return None };
        Some((index, Circle { centre: waypoint.position, radius_m: radius_m.abs() }))
    });
    if let Some((index, circle)) = told {
        circle_of(sheet, circle, if index == 0 { "held" } else { "to be held" });
    }
}

fn circle_of(sheet: &Sheet<'_>, circle: Circle, what: &str) {
    let Sheet { painter, view, scene, p, .. } = *sheet;
    let (centre, radius) = (view.place(circle.centre), (circle.radius_m * view.points_per_metre()) as f32);
    if radius < LEAST || !view.is_near(centre) {
        return;
    }
    for stroke in [Stroke::new(4.0, p.halo), Stroke::new(2.0, p.active)] {
        painter.circle_stroke(centre, radius, stroke);
        let arms = [vec2(CROSS, 0.0), vec2(0.0, CROSS)];
        painter.extend(arms.map(|arm| Shape::line_segment([centre - arm, centre + arm], stroke)));
    }
    let text = format!("{what} · radius {}", scene.units().length().show(circle.radius_m));
    let (rank, spots) = (Rank::Way, names::below(centre, radius + 4.0));
    sheet.ask(Name { rank, spots, text, size: 12.0, colour: p.active, ground: Ground::Halo });
}
