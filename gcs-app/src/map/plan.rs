//! The plan's areas, runways and emergency plans.

use super::kin::Kin;
use super::names::{self, Ground, Name, Rank};
use super::polyline::Style;
use super::sheet::Sheet;
use super::sketch::{Circle, Line};
use super::text;
use crate::command::Selection;
use crate::panels::Scene;
use egui::{Pos2, Shape, Stroke, vec2};
use flight_plan::Id;

/// Areas to be scanned and orbits.
pub fn draw_areas(sheet: &Sheet<'_>, kin: &Kin) {
    let points_per_metre = sheet.view.points_per_metre();
    for circle in &sheet.sketch.circles {
        let radius = (circle.radius_m * points_per_metre) as f32;
        let is_selected = is_selected(sheet.scene, &circle.leg);
        // the handle in its middle covers it
        if radius >= LEAST || is_selected {
            draw_circle(&sheet.with(&kin.painter(sheet, &circle.leg)), circle, (radius, is_selected));
        }
    }
    for (leg, rings) in &sheet.sketch.polygons {
        let width = if is_selected(sheet.scene, leg) { 2.2 } else { 1.4 };
        let painter = kin.painter(sheet, leg);
        for ring in rings {
            let closed = ring.iter().chain(ring.first()).copied();
            sheet.with(&painter).line(closed, Stroke::new(width, sheet.p.text), Style::Dashed);
        }
    }
}

fn is_selected(scene: &Scene<'_>, leg: &Id) -> bool {
    scene.is_selected(&Selection::Leg(leg.clone()))
}

/// Smaller circles are not drawn, screen points.
const LEAST: f32 = 5.0;

fn draw_circle(sheet: &Sheet<'_>, circle: &Circle, (radius, selected): (f32, bool)) {
    let Sheet { painter, view, p, .. } = *sheet;
    let centre = view.place(circle.centre);
    if !view.rect.expand(radius).contains(centre) || radius > 20_000.0 {
        return;
    }
    let stroke = Stroke::new(if selected { 2.2 } else { 1.4 }, p.text);
    if circle.is_area {
        painter.circle_filled(centre, radius, p.text.gamma_multiply(0.07));
    }
    let steps = (radius.sqrt() * 8.0).clamp(24.0, 256.0) as usize;
    let on = |i: usize| centre + egui::Vec2::angled(i as f32 / steps as f32 * std::f32::consts::TAU) * radius;
    let ring: Vec<Pos2> = (0..=steps).map(on).collect();
    painter.extend(Shape::dashed_line(&ring, stroke, 8.0, 6.0));
}

/// The ways on from forks, each with its name; the flown path is drawn over the one that is taken.
pub fn draw_ways(sheet: &Sheet<'_>, kin: &Kin) {
    let Sheet { view, sketch, scene, p, .. } = *sheet;
    for way in &sketch.ways {
        let selected = is_selected(scene, &way.fork);
        let of = way.lines.iter().map(|line| &line.leg).find(|leg| kin.has(leg)).unwrap_or(&way.fork);
        let painter = kin.painter(sheet, of);
        let sheet = sheet.with(&painter);
        sheet.line(way.places(), Stroke::new(if selected { 2.2 } else { 1.4 }, p.accent), Style::Dashed);
        // of the fork itself what leads to the first leg of the way, not what leads back from the last
        let is_meant = |(number, line): &(usize, &Line)| match line.leg == way.fork {
            true => false,
            false => is_looked_at(scene, &line.leg) || (selected && *number == 0),
        };
        for (_, line) in way.lines.iter().enumerate().filter(is_meant) {
            sheet.line([line.from, line.to], Stroke::new(3.2, p.text), Style::Dashed);
        }
        let Some(first) = way.lines.first() else { continue };
        let (from, to) = (view.place(first.from), view.place(first.to));
        let at = from + (to - from) * 0.5;
        if (selected || from.distance(to) > 140.0) && view.is_near(at) {
            let text = if way.is_default { format!("{} (default)", way.label) } else { way.label.clone() };
            let (rank, spots) = (Rank::Way.or_selected(selected), names::below(at, 6.0));
            sheet.ask(Name { rank, spots, text, size: 11.5, colour: p.text, ground: Ground::Halo });
        }
    }
}

/// Selected, or pointed out; where it is flown, the path shows it, too.
fn is_looked_at(scene: &Scene<'_>, leg: &Id) -> bool {
    is_selected(scene, leg) || scene.view.pointed.as_ref() == Some(leg)
}

/// Emergency plans: grey and dotted; the one in force is named.
pub fn draw_emergencies(sheet: &Sheet<'_>, kin: &Kin) {
    let Sheet { sketch, scene, p, .. } = *sheet;
    let in_force = scene.vehicle.status.as_ref().and_then(|s| s.value.emergency_in_force.as_ref());
    for (id, line) in &sketch.emergencies {
        let emphasised =
            in_force == Some(id) || matches!(&scene.view.selection, Some(Selection::Emergency(e)) if e == id);
        let painter = if in_force == Some(id) { sheet.painter.clone() } else { kin.painter(sheet, id) };
        let sheet = sheet.with(&painter);
        let width = if emphasised { 3.0 } else { 2.0 };
        sheet.line(line.iter().copied(), Stroke::new(width, p.contingency), Style::Dotted);
        if let (true, Some(first)) = (emphasised, line.first()) {
            let (rank, spots) = (Rank::Selected, names::corners_above(sheet.place(*first), vec2(8.0, 8.0)));
            let text = format!("⚑ {}", scene.document.plan().label(id));
            let colour = p.contingency;
            sheet.ask(Name { rank, spots, text, size: 12.0, colour, ground: Ground::Halo });
        }
    }
}

/// The procedure that is open, where it is defined, and the point that calls put at their anchor.
pub fn draw_procedure(sheet: &Sheet<'_>) {
    let Sheet { sketch, scene, p, .. } = *sheet;
    let Some(inside) = sketch.open_procedure(scene.view.selection.as_ref()) else { return };
    let stroke = Stroke::new(2.0, p.accent);
    sheet.line(inside.line.iter().copied(), stroke, Style::Dashed);
    for ring in &inside.rings {
        sheet.line(ring.iter().chain(ring.first()).copied(), stroke, Style::Dashed);
    }
    let points_per_metre = sheet.view.points_per_metre();
    for circle in &inside.circles {
        draw_circle(sheet, circle, ((circle.radius_m * points_per_metre) as f32, true));
    }
    let Some(at) = inside.reference.or(inside.line.first().copied()).map(|at| sheet.place(at)) else {
        return;
    };
    text::disc(sheet.painter, at, 4.0, p.halo, stroke);
    let text = format!("§ {}, as it is defined", scene.document.plan().label(&inside.procedure));
    let (rank, spots) = (Rank::Selected, names::corners_above(at, vec2(8.0, 8.0)));
    sheet.ask(Name { rank, spots, text, size: 12.0, colour: p.text, ground: Ground::Halo });
}

/// Runways: their true length and direction, with the threshold and the name.
pub fn draw_runways(sheet: &Sheet<'_>) {
    let Sheet { painter, view, scene, p, .. } = *sheet;
    let runways = &scene.document.plan().runways;
    for runway in runways.iter().filter(|r| r.threshold.is_valid() && r.heading_deg.is_finite()) {
        let (start, end) = (
            view.place(runway.threshold),
            view.place(
                runway.threshold.destination(runway.heading_deg, runway.length_m.clamp(1.0, 10_000.0)),
            ),
        );
        if !view.is_near(start) && !view.is_near(end) {
            continue;
        }
        // never shorter than can be seen
        let way = end - start;
        let end = if way.length() < 14.0 { start + way.normalized() * 14.0 } else { end };
        painter.line_segment([start, end], Stroke::new(7.0, p.halo));
        painter.line_segment([start, end], Stroke::new(4.0, p.text));
        let across = (end - start).normalized().rot90() * 7.0;
        painter.line_segment([start - across, start + across], Stroke::new(2.0, p.text));
        let at = start - (end - start).normalized() * 8.0;
        let (rank, spots, text) = (Rank::Place, names::below(at, 0.0), runway.id.as_str().into());
        sheet.ask(Name { rank, spots, text, size: 12.0, colour: p.text, ground: Ground::Halo });
    }
}
