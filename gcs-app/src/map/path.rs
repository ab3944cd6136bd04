//! The path that will be flown and the waypoints that will be sent.

use super::kept::Kept;
use super::names::{self, Ground, Name, Rank};
use super::polyline::{self, Style};
use super::sheet::Sheet;
use super::view::{Mercator, View};
use crate::command::{PreviewCommand, Queue, Selection};
use crate::forecast::{Coverage, Line, Passage};
use crate::jobs::{Taken, Task};
use crate::map::coverage;
use crate::panels::{Scene, decision};
use crate::theme::Palette;
use egui::{Color32, Pos2, Rect, Shape, Stroke, Vec2, vec2};
use flight_plan::{Id, Problem};
use std::collections::{BTreeSet, HashSet};

/// The layer; keeps what it drew of the path until scale or forecast change.
#[derive(Debug, Default)]
pub struct Layer {
    /// Of the sketch as it is, in which look.
    draft: Kept<Look>,
    /// Of which path and octave, in which look.
    path: Kept<(u64, Option<i32>, Look)>,
    /// Of which path, as far as what was known of its alarms.
    covered: Kept<(u64, u64, Color32)>,
    /// Of which path, with which errors.
    faulty: Kept<(u64, u64, u64, Color32)>,
    looked_at: Kept<LookedAt>,
    waypoints: Kept<(u64, Color32)>,
    /// The line that is worked out on another thread.
    line: Option<Task<()>>,
}

/// Colours of a line and of its halo.
type Look = (Color32, Color32);

/// Screen points per metre from which single waypoints are drawn.
const WAYPOINTS_FROM: f64 = 0.015;
/// Of the stronger line, over a path and below its coverage, screen points.
const ABOVE: f32 = 3.2;
const BELOW: f32 = 9.0;
/// About the width of a waypoint, screen points.
const MARK: f32 = 7.0;
/// The line of a path with no more points is worked out within a frame.
const AT_ONCE: usize = 10_000;

impl Layer {
    /// A line is being worked out on another thread.
    pub fn is_busy(&self) -> bool {
        self.line.is_some()
    }

    /// Draws the forecast; where there is none, the plan's places as a draft.
    pub fn draw(&mut self, sheet: &Sheet<'_>) {
        let Sheet { view, scene, p, .. } = *sheet;
        let forecast = scene.forecast();
        self.tend(view, scene);
        if forecast.points.is_empty() || forecast.is_beginning {
            self.draw_draft(sheet);
        }
        if forecast.points.is_empty() {
            return;
        }
        let covered = scene.analysis.coverage();
        let covered = covered.filter(|_| scene.view.coverage && scene.out_of_date().is_none());
        // what is selected lies below what may be red: who selects a leg there asks why it is
        let is_below = covered.is_some() || scene.problems().any(Problem::is_error);
        if is_below {
            self.draw_looked_at(sheet, BELOW);
        }
        match covered {
            Some(known) => self.draw_covered(sheet, known),
            None => self.draw_path(sheet),
        }
        if !is_below {
            self.draw_looked_at(sheet, ABOVE);
        }
        let analysis = scene.analysis;
        if view.points_per_metre() > WAYPOINTS_FROM {
            let of = (analysis.forecast_version, p.accent);
            self.waypoints.draw(
                sheet.painter,
                view,
                |made| *made == of,
                |wide| (of, waypoints(wide, scene, p)),
            );
        }
        // over the waypoints: those of an orbit lie close together
        self.draw_faulty(sheet);
    }

    /// A stronger line along what is wrong, or is being checked and may be.
    fn draw_faulty(&mut self, sheet: &Sheet<'_>) {
        let Sheet { scene, p, .. } = *sheet;
        let analysis = scene.analysis;
        let of = (analysis.forecast_version, scene.document.version(), analysis.found, p.warning);
        self.faulty.draw(
            sheet.painter,
            sheet.view,
            |made| *made == of,
            |wide| {
                let (faulty, perhaps) = (scene.faulty(), scene.perhaps_faulty());
                let stroke = |colour| Stroke::new(ABOVE, colour);
                let mut shapes =
                    highlight(wide, scene, (stroke(p.weak), p), |passage| perhaps.contains(&passage.leg));
                let wanted = |passage: &Passage| faulty.contains(&passage.leg);
                shapes.extend(highlight(wide, scene, (stroke(p.warning), p), wanted));
                (of, shapes)
            },
        );
    }

    /// The plan's places are others than before.
    pub fn forget_draft(&mut self) {
        self.draft = Kept::default();
    }

    fn draw_draft(&mut self, sheet: &Sheet<'_>) {
        let look = (colour(sheet.scene, sheet.p), sheet.p.halo);
        self.draft.draw(
            sheet.painter,
            sheet.view,
            |made| *made == look,
            |wide| {
                let (parts, (colour, halo)) = (polyline::visible_parts(&sheet.sketch.draft, wide), look);
                (look, polyline::shapes(&parts, Stroke::new(2.0, colour), Style::Dashed, halo))
            },
        );
    }

    fn draw_path(&mut self, sheet: &Sheet<'_>) {
        let Sheet { view, scene, p, .. } = *sheet;
        let (octave, line) = line(view, scene);
        let of = (scene.analysis.forecast_version, octave, (colour(scene, p), p.halo));
        self.path.draw(
            sheet.painter,
            sheet.view,
            |made| *made == of,
            |wide| {
                let (colour, halo) = of.2;
                let parts = line.map_or(Vec::new(), |line| polyline::parts_of(line, wide));
                (of, polyline::shapes(&parts, Stroke::new(2.0, colour), Style::Solid, halo))
            },
        );
    }

    /// Has the line for a view worked out, if it is not known: that of a long path on another thread.
    fn tend(&mut self, view: &View, scene: &Scene<'_>) {
        let (path, octave) = (&scene.analysis.forecast, view.octave());
        let ended = self.line.as_ref().map(Task::take).filter(|taken| *taken != Taken::NotYet);
        self.line.take_if(|_| ended.is_some());
        if path.line(octave).is_some() || self.line.is_some() {
            return;
        }
        // also where there was no thread for it
        if path.points.len() <= AT_ONCE || ended == Some(Taken::Failed) {
            return path.work_out_line(octave);
        }
        let path = path.clone();
        self.line = Some(Task::begin(scene.layers.wake(), move || path.work_out_line(octave)));
    }

    /// In the look of how alarms would end.
    fn draw_covered(&mut self, sheet: &Sheet<'_>, known: &Coverage) {
        let Sheet { scene, p, .. } = *sheet;
        let of = (scene.analysis.forecast_version, scene.analysis.found, p.halo);
        self.covered.draw(
            sheet.painter,
            sheet.view,
            |made| *made == of,
            |wide| {
                let mut shapes = Vec::new();
                for (reach, part) in coverage::parts(&scene.forecast().points, known) {
                    let line: Vec<Mercator> = part.iter().map(|q| q.position.into()).collect();
                    let (stroke, style) = coverage::look(reach, p);
                    shapes.extend(polyline::shapes(
                        &polyline::visible_parts(&line, wide),
                        stroke,
                        style,
                        p.halo,
                    ));
                }
                (of, shapes)
            },
        );
    }

    /// A stronger line along what is selected, or pointed out.
    fn draw_looked_at(&mut self, sheet: &Sheet<'_>, width: f32) {
        let Sheet { scene, p, .. } = *sheet;
        self.looked_at.draw(
            sheet.painter,
            sheet.view,
            |made| made.is_still(scene, p, width),
            |wide| {
                let looked_at = LookedAt::of(scene, p, width);
                let ids = looked_at.ids();
                let wanted = |passage: &Passage| {
                    ids.contains(&passage.stage)
                        || scene.document.is_wanted(&passage.leg, |id| ids.contains(id))
                };
                let look = (Stroke::new(width, p.text), p);
                let shapes = if ids.is_empty() { Vec::new() } else { highlight(wide, scene, look, wanted) };
                drop(ids);
                (looked_at, shapes)
            },
        );
    }
}

/// The line for a view, and its octave; until it is worked out, the nearest one that is.
fn line<'a>(view: &View, scene: &Scene<'a>) -> (Option<i32>, Option<&'a Line>) {
    scene.forecast().line_near(view.octave()).map_or((None, None), |(of, line)| (Some(of), Some(line)))
}

/// What is looked at of a path.
#[derive(Debug)]
struct LookedAt {
    forecast: u64,
    colour: Color32,
    width: f32,
    selection: Option<Selection>,
    also: BTreeSet<Selection>,
    pointed: Option<Id>,
}

impl LookedAt {
    fn of(scene: &Scene<'_>, p: &Palette, width: f32) -> Self {
        Self {
            forecast: scene.analysis.forecast_version,
            colour: p.text,
            width,
            selection: scene.view.selection.clone(),
            also: scene.view.also.clone(),
            pointed: scene.view.pointed.clone(),
        }
    }

    fn is_still(&self, scene: &Scene<'_>, p: &Palette, width: f32) -> bool {
        let view = scene.view;
        (self.forecast, self.colour, self.width) == (scene.analysis.forecast_version, p.text, width)
            && (&self.selection, &self.also, &self.pointed) == (&view.selection, &view.also, &view.pointed)
    }

    /// Of legs and stages.
    fn ids(&self) -> HashSet<&Id> {
        let together = self.selection.as_ref().is_some_and(Selection::is_in_sets);
        let selected = self.selection.iter().chain(&self.also).filter(|_| together);
        let flown = selected.filter(|what| matches!(what, Selection::Leg(_) | Selection::Stage(_)));
        flown.map(Selection::id).chain(&self.pointed).collect()
    }
}

/// Grey, when it is out of date.
fn colour(scene: &Scene<'_>, p: &Palette) -> Color32 {
    if scene.out_of_date().is_some() { p.weak } else { p.accent }
}

/// A stronger line along some passages.
fn highlight(
    view: &View,
    scene: &Scene<'_>,
    (stroke, p): (Stroke, &Palette),
    wanted: impl Fn(&Passage) -> bool,
) -> Vec<Shape> {
    let forecast = scene.forecast();
    let passages = forecast.passages.iter().filter(|passage| wanted(passage));
    let shapes = passages.flat_map(|passage| {
        let line: Vec<Mercator> =
            forecast.part(passage).unwrap_or_default().iter().map(|q| q.position.into()).collect();
        let parts = polyline::visible_parts(&line, view);
        polyline::shapes(&parts, stroke, Style::Solid, p.halo)
    });
    shapes.collect()
}

fn waypoints(view: &View, scene: &Scene<'_>, p: &Palette) -> Vec<Shape> {
    let forecast = scene.forecast();
    let places = forecast.waypoint_places();
    let mut taken: HashSet<(i32, i32)> = HashSet::new();
    let mut last: Option<Pos2> = None;
    let mut shapes = Vec::new();
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
        shapes.extend(match waypoint.fly_over {
            true => disc(at, 3.4, p.halo, Stroke::new(1.6, p.accent)),
            false => disc(at, 2.4, p.accent, Stroke::new(1.0, p.halo)),
        });
    }
    shapes
}

/// What [`disc`](super::text::disc) draws where nothing is faint.
fn disc(at: Pos2, radius: f32, fill: Color32, edge: Stroke) -> [Shape; 2] {
    let half = edge.width / 2.0;
    [Shape::circle_filled(at, radius + half, edge.color), Shape::circle_filled(at, radius - half, fill)]
}

/// Where each branch of the decision that is asked for leads; the default's is the stronger line.
pub fn draw_decision(sheet: &Sheet<'_>) {
    let Sheet { scene, p, .. } = *sheet;
    let Some((request, _)) = decision::open(scene) else { return };
    for (number, option) in (1..).zip(&request.options) {
        let is_default = request.default.as_ref() == Some(&option.branch);
        let stroke = Stroke::new(if is_default { 2.6 } else { 1.8 }, p.active);
        let style = if is_default { Style::Solid } else { Style::Dashed };
        sheet.line(option.preview.iter().copied(), stroke, style);
        let places: Vec<Pos2> = option.preview.iter().map(|at| sheet.place(*at)).collect();
        // beside the middle of its way: at its end is the name of a fix
        let Some(middle) = polyline::middle(&places) else { continue };
        let (rank, spots) = (Rank::Selected, names::corners_above(middle, vec2(6.0, 6.0)));
        let text = format!("{number} {}", option.label);
        sheet.ask(Name { rank, spots, text, size: 12.0, colour: p.active, ground: Ground::Halo });
    }
}

/// The preview's cursor.
pub fn draw_cursor(sheet: &Sheet<'_>) {
    let Sheet { painter, view, scene, p, .. } = *sheet;
    let Some(position) = scene.view.cursor_s.and_then(|t| scene.forecast().position_at(t)) else { return };
    let at = view.place(position);
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
    let near = ways_near(at, view, scene).min_by(|a, b| a.far.total_cmp(&b.far));
    near.map(|near| near.time_s)
}

/// The pointer reaches so far, screen points.
const REACH: f32 = 9.0;

/// Where the path comes near to the pointer on the way from one of its points to the next.
struct Near {
    passage: usize,
    /// When it is nearest, seconds from the start.
    time_s: f64,
    /// How far that is, screen points.
    far: f32,
}

/// The ways between points of the path that are under the pointer: on a near map its points lie far apart.
fn ways_near<'a>(at: Pos2, view: &'a View, scene: &Scene<'a>) -> impl Iterator<Item = Near> {
    let (forecast, places) = (scene.forecast(), scene.forecast().places());
    let around = Rect::from_center_size(at, Vec2::splat(2.0 * REACH));
    let near = places.ways_within(view.area(around)).filter_map(move |index| {
        let (from, to) = (forecast.points.get(index)?, forecast.points.get(index + 1)?);
        let [begin, end] =
            [places.at.get(index)?, places.at.get(index + 1)?].map(|place| view.screen(*place));
        let share = polyline::share_of_foot(at, begin, end);
        let time_s = egui::lerp(from.time_s..=to.time_s, f64::from(share));
        Some(Near { passage: from.passage, time_s, far: begin.lerp(end, share).distance(at) })
    });
    near.filter(|near| near.far < REACH)
}

/// The legs whose path is under the pointer, the nearest first.
pub fn legs_near(at: Pos2, view: &View, scene: &Scene<'_>) -> Vec<Id> {
    let forecast = scene.forecast();
    let mut near: Vec<(f32, usize)> = Vec::new();
    for Near { passage: of, far, .. } in ways_near(at, view, scene) {
        match near.last_mut() {
            Some((least, passage)) if *passage == of => *least = least.min(far),
            _ => near.push((far, of)),
        }
    }
    // where one leg follows another, the nearer is meant
    let follows = |a: usize, b: usize| a.abs_diff(b) == 1;
    let all = near.clone();
    near.retain(|(far, passage)| !all.iter().any(|(other, b)| follows(*passage, *b) && other < far));
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    near.iter().filter_map(|(_, passage)| forecast.passages.get(*passage)).map(|p| p.leg.clone()).collect()
}
