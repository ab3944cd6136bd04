//! The path that will be flown and the waypoints that will be sent.

use super::polyline::{self, Cached, Style};
use super::sketch::Sketch;
use super::text;
use super::view::{Mercator, View};
use crate::chart::Point;
use crate::chart::labels::{self, Labels};
use crate::command::{PreviewCommand, Queue, Selection};
use crate::map::coverage;
use crate::panels::{Scene, bar, decision};
use crate::theme::Palette;
use egui::{Align2, Color32, FontId, Painter, Pos2, Shape, Stroke, pos2, vec2};
use flight_plan::Id;

/// The layer; keeps the decimated line until view or forecast change.
#[derive(Debug, Default)]
pub struct Layer {
    line: Cached,
}

/// Screen points per metre from which single waypoints are drawn.
const WAYPOINTS_FROM: f64 = 0.015;
/// Most waypoints drawn at once.
const MAX_WAYPOINTS: usize = 3000;

impl Layer {
    /// Draws the forecast; where there is none, the plan's places as a draft.
    pub fn draw(&mut self, painter: &Painter, view: &View, scene: &Scene<'_>, sketch: &Sketch, p: &Palette) {
        let forecast = scene.forecast();
        let (_, standing) = bar::plan_state(scene);
        if forecast.points.is_empty() || forecast.is_beginning {
            draft(painter, view, sketch, colour(scene, p), p);
        }
        if forecast.points.is_empty() {
            return;
        }
        let line = || forecast.points.iter().map(|point| point.position.into()).collect();
        let parts = self.line.parts(line, scene.analysis.forecast_version, view);
        // a draft that differs from what is aboard is dashed
        let is_draft = standing == bar::Standing::Draft && scene.vehicle.active_hash().is_some();
        let style = if is_draft { Style::Dashed } else { Style::Solid };
        match scene.analysis.coverage().filter(|_| scene.view.coverage) {
            Some(known) if scene.out_of_date().is_none() => {
                for (reach, part) in coverage::parts(&forecast.points, known) {
                    let line: Vec<Mercator> = part.iter().map(|q| q.position.into()).collect();
                    let (stroke, style) = coverage::look(reach, p);
                    polyline::draw(painter, &polyline::visible_parts(&line, view), stroke, style, p.halo);
                }
            }
            _ => polyline::draw(painter, parts, Stroke::new(2.0, colour(scene, p)), style, p.halo),
        }
        let faulty = scene.faulty();
        highlight(painter, view, scene, (p.warning, p), |leg, _| faulty.contains(leg));
        highlight(painter, view, scene, (p.text, p), |leg, stage| is_looked_at(scene, leg, stage));
        if view.points_per_metre() > WAYPOINTS_FROM {
            waypoints(painter, view, scene, p);
        }
    }
}

/// Grey, when it is out of date.
fn colour(scene: &Scene<'_>, p: &Palette) -> Color32 {
    if scene.out_of_date().is_some() { p.weak } else { p.accent }
}

fn draft(painter: &Painter, view: &View, sketch: &Sketch, colour: Color32, p: &Palette) {
    let line: Vec<Mercator> = sketch.main.iter().flatten().map(|at| (*at).into()).collect();
    let parts = polyline::visible_parts(&line, view);
    polyline::draw(painter, &parts, Stroke::new(2.0, colour), Style::Dashed, p.halo);
}

/// Selected, or pointed out.
fn is_looked_at(scene: &Scene<'_>, leg: &Id, stage: &Id) -> bool {
    let pointed = scene.view.pointed.as_ref();
    let selected = match &scene.view.selection {
        Some(selected) if selected.is_in_sets() => {
            scene.is_selected(&Selection::Leg(leg.clone()))
                || scene.is_selected(&Selection::Stage(stage.clone()))
        }
        _ => false,
    };
    selected || pointed == Some(leg) || pointed == Some(stage)
}

/// A stronger line along passages of some legs (and their stages).
fn highlight(
    painter: &Painter,
    view: &View,
    scene: &Scene<'_>,
    (colour, p): (Color32, &Palette),
    wanted: impl Fn(&Id, &Id) -> bool,
) {
    let forecast = scene.forecast();
    for passage in forecast.passages.iter().filter(|passage| wanted(&passage.leg, &passage.stage)) {
        let line: Vec<Mercator> =
            forecast.part(passage).unwrap_or_default().iter().map(|q| q.position.into()).collect();
        let parts = polyline::visible_parts(&line, view);
        polyline::draw(painter, &parts, Stroke::new(3.2, colour), Style::Solid, p.halo);
    }
}

fn waypoints(painter: &Painter, view: &View, scene: &Scene<'_>, p: &Palette) {
    let near = scene
        .forecast()
        .waypoints
        .iter()
        .map(|w| (w, view.place(w.position)))
        .filter(|(_, at)| view.is_near(*at));
    let mut last: Option<Pos2> = None;
    for (waypoint, at) in near.take(MAX_WAYPOINTS) {
        if last.is_some_and(|l| l.distance(at) < 7.0) {
            continue;
        }
        last = Some(at);
        if waypoint.fly_over {
            painter.circle(at, 3.4, p.halo, Stroke::new(1.6, p.accent));
        } else {
            painter.circle(at, 2.4, p.accent, Stroke::new(1.0, p.halo));
        }
    }
}

/// Where each branch of the decision that is asked for leads; the default's is the stronger line.
pub fn draw_decision(painter: &Painter, view: &View, scene: &Scene<'_>, p: &Palette) {
    let Some((request, _)) = decision::open(scene) else { return };
    let mut named = Labels::new(view.rect.into());
    for (number, option) in (1..).zip(&request.options) {
        let line: Vec<Mercator> = option.preview.iter().map(|at| (*at).into()).collect();
        let is_default = request.default.as_ref() == Some(&option.branch);
        let stroke = Stroke::new(if is_default { 2.6 } else { 1.8 }, p.active);
        let style = if is_default { Style::Solid } else { Style::Dashed };
        polyline::draw(painter, &polyline::visible_parts(&line, view), stroke, style, p.halo);
        let places: Vec<Pos2> = option.preview.iter().map(|at| view.place(*at)).collect();
        name_branch(painter, &places, &format!("{number} {}", option.label), &mut named, p);
    }
}

/// Beside the middle of its way (at its end is the name of a fix), or where no other branch has its name.
fn name_branch(painter: &Painter, way: &[Pos2], name: &str, named: &mut Labels, p: &Palette) {
    const SIZE: f32 = 12.0;
    let Some(middle) = polyline::middle(way) else { return };
    let size = painter.layout_no_wrap(name.into(), FontId::proportional(SIZE), p.active).size();
    let beside = middle + vec2(6.0 + size.x / 2.0, -6.0 - size.y / 2.0);
    let line: Vec<Point> = way.iter().map(|at| (at.x, at.y)).collect();
    let room = (size.x, size.y);
    let others = labels::along(&line, room).into_iter().chain(labels::beside((middle.x, middle.y), room));
    let middles: Vec<Point> = std::iter::once((beside.x, beside.y)).chain(others).collect();
    if let Some((x, y)) = named.best(&middles, room) {
        let rect = text::haloed(painter, pos2(x, y), Align2::CENTER_CENTER, name, SIZE, p.active, p);
        named.take(rect.into());
    }
}

/// The preview's cursor.
pub fn draw_cursor(painter: &Painter, view: &View, scene: &Scene<'_>, p: &Palette) {
    let Some(point) = scene.view.cursor_s.and_then(|t| scene.forecast().at(t)) else { return };
    let at = view.place(point.position);
    painter.circle_stroke(at, 7.0, Stroke::new(4.0, p.halo));
    painter.circle_stroke(at, 7.0, Stroke::new(2.0, p.text));
    for d in [vec2(0.0, 1.0), vec2(0.0, -1.0), vec2(1.0, 0.0), vec2(-1.0, 0.0)] {
        painter.add(Shape::line_segment([at + d * 7.0, at + d * 12.0], Stroke::new(2.0, p.text)));
    }
}

/// While an alarm is raised, a click on the path puts the cursor there.
pub fn move_cursor(response: &egui::Response, view: &View, scene: &Scene<'_>, queue: &mut Queue) {
    let at = response.interact_pointer_pos().filter(|_| scene.view.alarm.is_some() && response.clicked());
    if let Some(time_s) = at.and_then(|at| time_near(at, view, scene)) {
        queue.preview(PreviewCommand::Scrub(Some(time_s)));
    }
}

/// When the path comes to where the pointer is, seconds from its start; `None`: it is not there.
pub fn time_near(at: Pos2, view: &View, scene: &Scene<'_>) -> Option<f64> {
    let point = point_near(at, view, scene).and_then(|index| scene.forecast().points.get(index))?;
    Some(point.time_s)
}

/// The index of the point of the path under the pointer.
fn point_near(at: Pos2, view: &View, scene: &Scene<'_>) -> Option<usize> {
    const REACH: f32 = 9.0;
    scene.forecast().nearest_index(|point| view.place(point.position).distance(at), REACH)
}

/// The legs whose path is under the pointer, the nearest first.
pub fn legs_near(at: Pos2, view: &View, scene: &Scene<'_>) -> Vec<Id> {
    const REACH: f32 = 9.0;
    let forecast = scene.forecast();
    let mut near: Vec<(f32, usize)> = Vec::new();
    for point in &forecast.points {
        let far = view.place(point.position).distance(at);
        match near.last_mut() {
            _ if far >= REACH => {}
            Some((least, passage)) if *passage == point.passage => *least = least.min(far),
            _ => near.push((far, point.passage)),
        }
    }
    // where one leg follows another, the nearer is meant
    let follows = |a: usize, b: usize| a.abs_diff(b) == 1;
    let all = near.clone();
    near.retain(|(far, passage)| !all.iter().any(|(other, b)| follows(*passage, *b) && other < far));
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    near.iter().filter_map(|(_, passage)| forecast.passages.get(*passage)).map(|p| p.leg.clone()).collect()
}
