//! The path that will be flown and the waypoints that will be sent.

use super::polyline::{self, Style};
use super::sketch::Sketch;
use super::text;
use super::view::{Mercator, View};
use crate::chart;
use crate::chart::labels::{self, Labels};
use crate::command::{PreviewCommand, Queue, Selection};
use crate::forecast::{Forecast, Point};
use crate::map::coverage;
use crate::panels::{Scene, bar, decision};
use crate::theme::Palette;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, Vec2, pos2, vec2};
use flight_plan::Id;
use std::collections::HashSet;

/// The layer; keeps what it drew of the path until view or forecast change.
#[derive(Debug, Default)]
pub struct Layer {
    of: Option<(u64, View)>,
    parts: Vec<Vec<Pos2>>,
}

/// Screen points per metre from which single waypoints are drawn.
const WAYPOINTS_FROM: f64 = 0.015;
/// About the width of a waypoint, screen points.
const MARK: f32 = 7.0;

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
        let of = Some((scene.analysis.forecast_version, *view));
        if self.of != of {
            (self.of, self.parts) = (of, visible(forecast, view));
        }
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
            _ => polyline::draw(painter, &self.parts, Stroke::new(2.0, colour(scene, p)), style, p.halo),
        }
        let faulty = scene.faulty();
        highlight(painter, view, scene, (p.warning, p), |leg, _| faulty.contains(leg));
        highlight(painter, view, scene, (p.text, p), |leg, stage| is_looked_at(scene, leg, stage));
        if view.points_per_metre() > WAYPOINTS_FROM {
            waypoints(painter, view, scene, p);
        }
    }
}

/// A line so far out of view may still be seen, screen points.
const BESIDE: f32 = 20.0;

fn visible(forecast: &Forecast, view: &View) -> Vec<Vec<Pos2>> {
    let parts = forecast.line(view.octave()).map(|line| line.parts(view.area(view.rect.expand(BESIDE))));
    parts.into_iter().flatten().flat_map(|part| polyline::visible_parts(part, view)).collect()
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
    let forecast = scene.forecast();
    let places = forecast.waypoint_places();
    let mut taken: HashSet<(i32, i32)> = HashSet::new();
    let mut last: Option<Pos2> = None;
    for index in places.within(view.area(view.rect.expand(MARK))) {
        let (Some(waypoint), Some(at)) = (forecast.waypoints.get(index), places.at.get(index)) else {
            continue;
        };
        let at = view.screen(*at);
        // one in each square: more could not be told apart
        let is_beside = last.is_some_and(|last| last.distance(at) < MARK);
        if is_beside || !taken.insert(((at.x / MARK) as i32, (at.y / MARK) as i32)) {
            continue;
        }
        last = Some(at);
        if waypoint.fly_over {
            text::disc(painter, at, 3.4, p.halo, Stroke::new(1.6, p.accent));
        } else {
            text::disc(painter, at, 2.4, p.accent, Stroke::new(1.0, p.halo));
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
    let line: Vec<chart::Point> = way.iter().map(|at| (at.x, at.y)).collect();
    let room = (size.x, size.y);
    let others = labels::along(&line, room).into_iter().chain(labels::beside((middle.x, middle.y), room));
    let middles: Vec<chart::Point> = std::iter::once((beside.x, beside.y)).chain(others).collect();
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
    let near = points_near(at, view, scene).min_by(|(_, a), (_, b)| a.total_cmp(b));
    near.map(|(point, _)| point.time_s)
}

/// The pointer reaches so far, screen points.
const REACH: f32 = 9.0;

/// The points of the path under the pointer, each with its distance from there, screen points.
fn points_near<'a>(at: Pos2, view: &'a View, scene: &Scene<'a>) -> impl Iterator<Item = (&'a Point, f32)> {
    let (forecast, places) = (scene.forecast(), scene.forecast().places());
    let around = Rect::from_center_size(at, Vec2::splat(2.0 * REACH));
    let near = places.within(view.area(around)).filter_map(move |index| {
        Some((forecast.points.get(index)?, view.screen(*places.at.get(index)?).distance(at)))
    });
    near.filter(|(_, far)| *far < REACH)
}

/// The legs whose path is under the pointer, the nearest first.
pub fn legs_near(at: Pos2, view: &View, scene: &Scene<'_>) -> Vec<Id> {
    let forecast = scene.forecast();
    let mut near: Vec<(f32, usize)> = Vec::new();
    for (point, far) in points_near(at, view, scene) {
        match near.last_mut() {
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
