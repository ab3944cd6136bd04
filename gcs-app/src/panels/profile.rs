//! Altitude along the path, with the ground below, stages as bands, a cursor on the timeline, and altitudes to be dragged.

mod flown;
mod levels;

pub use flown::{is_elsewhere, lands_in_s};

use super::{Panel, PanelId, Place, Scene, timeline};
use crate::command::{PreviewCommand, Queue, ViewCommand};
use crate::forecast::{Forecast, Heights, Passage, Point};
use crate::map::coverage;
use crate::theme::{self, Palette};
use crate::units;
use egui::text::{LayoutJob, TextWrapping};
use egui::{
    Align2, FontId, Mesh, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2,
};
use flight_exec::rehearse::GlidePoint;

/// The panel.
#[derive(Debug, Default)]
pub struct Profile {
    /// Show what was flown already, too.
    whole: bool,
    levels: levels::Levels,
    columns: Columns,
}

impl Panel for Profile {
    fn id(&self) -> PanelId {
        "profile"
    }
    fn name(&self) -> &'static str {
        "Profile"
    }
    fn place(&self) -> Place {
        Place::Below
    }
    fn header(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        let is_flown = [
            flown::on_preview(scene).is_some(),
            flown::told(scene).is_some(),
            flown::unknown(scene).is_some(),
        ];
        if is_flown.contains(&true) {
            let text = if timeline::is_narrow(ui) { "All" } else { "Whole flight" };
            let whole = ui.checkbox(&mut self.whole, text);
            let on = self.whole;
            whole.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, on, "Whole flight"));
            whole.on_hover_text("The whole flight; else from now to landing");
        }
        timeline::show(ui, scene, queue);
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        plot(ui, scene, self, queue);
    }
}

/// The profile; dragging on it moves the cursor, a click on the path selects its leg, dragging a leg's mark its altitude.
fn plot(ui: &mut Ui, scene: &Scene<'_>, profile: &mut Profile, queue: &mut Queue) {
    let Profile { whole, levels, columns } = profile;
    let whole = *whole;
    let size = ui.available_size().max(vec2(120.0, 80.0));
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    if let Some(why) = flown::unknown(scene).filter(|_| !whole) {
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, format!("Vertical profile: {why}")));
        return nothing(ui, rect, &why);
    }
    let told = flown::told(scene).filter(|_| !whole);
    let (forecast, from) = match told {
        Some((way, here)) => (way, Some(here)),
        None => (scene.forecast(), flown::on_preview(scene).filter(|_| !whole)),
    };
    let description = description(scene, forecast, from, told.is_some());
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, &description));
    let painter = ui.painter_at(rect);
    let p = theme::of(ui);
    if forecast.points.len() < 2 {
        return nothing(ui, rect, &scene.analysis.why_no_forecast());
    }
    let mut axes = Axes::new(rect, forecast, from.map_or(0.0, |point| point.time_s));
    if let Some((low_m, high_m)) = levels.held_m() {
        (axes.low_m, axes.high_m) = (low_m, high_m);
    }
    if told.is_some() {
        axes.include_aircraft(scene);
    }
    draw_axes(&painter, &axes, scene, p);
    // what was flown before is left of the plot
    let shown = Rect::everything_right_of(axes.plot.left() - 8.0);
    let painter = painter.with_clip_rect(shown.intersect(rect));
    if told.is_some() {
        return flown::draw(ui, &painter, &axes, forecast, scene, p);
    }
    draw_preview(ui, &painter, &axes, columns.refresh(&axes, scene), scene, p);
    levels.run(ui, &painter, &axes, scene, queue);
    draw_cursor(&painter, &axes, scene, p);
    if let Some(pointer) =
        response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked())
    {
        queue.preview(PreviewCommand::Scrub(Some(axes.time_at(pointer))));
        if response.clicked()
            && scene.out_of_date().is_none()
            && let Some(passage) = passage_at(&axes, forecast, pointer)
        {
            queue.view(ViewCommand::Select(Some(scene.document.part_of(&passage.leg))));
        }
    }
}

/// There is no path, and why.
fn nothing(ui: &Ui, rect: Rect, why: &str) {
    let font = FontId::proportional(13.0);
    ui.painter_at(rect).text(rect.center(), Align2::CENTER_CENTER, why, font, theme::of(ui).weak);
}

/// A click means the path so near to it, screen points.
const NEAR: f32 = 8.0;

/// What is flown where the path is under the pointer.
fn passage_at<'a>(axes: &Axes, forecast: &'a Forecast, pointer: Pos2) -> Option<&'a Passage> {
    let time_s = axes.time_at(pointer);
    let after = forecast.points.partition_point(|point| point.time_s < time_s);
    let before = forecast.points.get(after.saturating_sub(1))?;
    let after = forecast.points.get(after).unwrap_or(before);
    let [from, to] = [before, after].map(|point| axes.place(point));
    let share = if to.x > from.x { (pointer.x - from.x) / (to.x - from.x) } else { 1.0 };
    let is_near = (from.lerp(to, share.clamp(0.0, 1.0)).y - pointer.y).abs() < NEAR;
    forecast.passages.get(after.passage).filter(|_| is_near)
}

/// `Vertical profile from now: 12.4 km in 8:10`.
fn description(scene: &Scene<'_>, forecast: &Forecast, from: Option<&Point>, is_told: bool) -> String {
    let (from_m, from_s) = from.map_or((0.0, 0.0), |point| (point.distance_m, point.time_s));
    format!(
        "Vertical profile{}{}: {} in {}",
        if from.is_some() { " from now" } else { "" },
        if is_told { ", as it is flown" } else { "" },
        scene.units().distance().show(forecast.length_m() - from_m),
        units::duration(forecast.duration_s() - from_s)
    )
}

fn draw_preview(ui: &Ui, painter: &Painter, axes: &Axes, seen: &[Point], scene: &Scene<'_>, p: &Palette) {
    draw_stages(ui, painter, axes, scene, p);
    draw_ground(painter, axes, seen, p);
    draw_path(painter, axes, seen, scene, p);
    if scene.vehicle.outlook.is_elsewhere() && flown::told(scene).is_none() {
        flown::warn(ui, painter, axes);
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Axes {
    plot: Rect,
    /// What is before is not shown.
    from_s: f64,
    duration_s: f64,
    low_m: f64,
    high_m: f64,
}

impl Axes {
    fn new(rect: Rect, forecast: &Forecast, from_s: f64) -> Self {
        let plot = Rect::from_min_max(rect.min + vec2(48.0, 20.0), rect.max - vec2(10.0, 20.0));
        let Heights { low_m: low, high_m: high } = forecast.heights_from(from_s);
        let margin = ((high - low) * 0.08).max(20.0);
        let duration_s = (forecast.duration_s() - from_s).max(1.0);
        Self { plot, from_s, duration_s, low_m: low - margin, high_m: high + margin }
    }
    /// Has room for the aircraft.
    fn include_aircraft(&mut self, scene: &Scene<'_>) {
        if let Some(position) = &scene.vehicle.position {
            self.low_m = self.low_m.min(position.value.altitude_amsl_m);
            self.high_m = self.high_m.max(position.value.altitude_amsl_m);
        }
    }
    fn x(&self, time_s: f64) -> f32 {
        self.plot.left() + ((time_s - self.from_s) / self.duration_s) as f32 * self.plot.width()
    }
    fn y(&self, altitude_m: f64) -> f32 {
        self.plot.bottom()
            - ((altitude_m - self.low_m) / (self.high_m - self.low_m)) as f32 * self.plot.height()
    }
    fn place(&self, point: &Point) -> Pos2 {
        pos2(self.x(point.time_s), self.y(point.altitude_amsl_m))
    }
    fn time_at(&self, at: Pos2) -> f64 {
        let share = (at.x - self.plot.left()) / self.plot.width().max(1.0);
        self.from_s + f64::from(share.clamp(0.0, 1.0)) * self.duration_s
    }
}

/// A round step that gives about `marks` marks over `range`.
fn round_step(range: f64, marks: f64, steps: &[f64]) -> f64 {
    steps.iter().copied().find(|s| range / s <= marks).or(steps.last().copied()).unwrap_or(1.0)
}

/// The lowest mark that is not below `low`; never `-0`.
fn first_mark(low: f64, step: f64) -> f64 {
    (low / step).ceil() * step + 0.0
}

/// Marks of the altitude that are nearer to each other can't be read, screen points.
const LEAST_MARK: f32 = 16.0;

fn draw_axes(painter: &Painter, axes: &Axes, scene: &Scene<'_>, p: &Palette) {
    let font = FontId::proportional(10.5);
    let unit = scene.units().altitude();
    let (low, high) = (unit.from_si(axes.low_m), unit.from_si(axes.high_m));
    let marks = f64::from(axes.plot.height() / LEAST_MARK).clamp(1.0, 5.0);
    let step = round_step(high - low, marks, &[50., 100., 200., 250., 500., 1000., 2000., 5000., 10_000.]);
    let mut value = first_mark(low, step);
    while value < high {
        let y = axes.y(unit.to_si(value));
        painter.hline(axes.plot.x_range(), y, Stroke::new(1.0, p.line));
        painter.text(
            pos2(axes.plot.left() - 5.0, y),
            Align2::RIGHT_CENTER,
            format!("{value:.0}"),
            font.clone(),
            p.weak,
        );
        value += step;
    }
    let head = format!("{} AMSL", unit.symbol);
    painter.text(
        pos2(axes.plot.left() - 5.0, axes.plot.top() - 11.0),
        Align2::RIGHT_CENTER,
        head,
        font.clone(),
        p.weak,
    );
    let marks = f64::from(axes.plot.width() / 90.0).max(1.0);
    let step =
        round_step(axes.duration_s, marks, &[10., 30., 60., 120., 300., 600., 1200., 1800., 3600., 7200.]);
    for mark in 0..=(axes.duration_s / step) as usize {
        let time = mark as f64 * step;
        let at = pos2(axes.x(axes.from_s + time), axes.plot.bottom() + 3.0);
        let letters = painter.layout_no_wrap(units::duration(time), font.clone(), p.weak);
        // the last one is whole, too
        let most = painter.clip_rect().right() - letters.size().x;
        let left = (at.x - letters.size().x / 2.0).min(most);
        painter.galley(pos2(left, at.y), letters, p.weak);
    }
}

/// A band that is narrower has no name, screen points.
const LEAST_BAND: f32 = 24.0;

/// One band above the plot per stage, with its name where there is room.
fn draw_stages(ui: &Ui, painter: &Painter, axes: &Axes, scene: &Scene<'_>, p: &Palette) {
    let (forecast, document) = (scene.forecast(), scene.document);
    let mut band: Option<(&Passage, f32)> = None;
    for passage in &forecast.passages {
        if band.is_none_or(|(b, _)| b.stage != passage.stage) {
            let x = forecast.points.get(passage.first).map_or(axes.plot.left(), |point| axes.x(point.time_s));
            if let Some((before, from)) = band {
                draw_band(ui, painter, axes, document.label(&before.stage), from, x, p);
            }
            band = Some((passage, x));
        }
    }
    if let Some((last, from)) = band {
        draw_band(ui, painter, axes, document.label(&last.stage), from, axes.plot.right(), p);
    }
}

fn draw_band(ui: &Ui, painter: &Painter, axes: &Axes, name: &str, from: f32, to: f32, p: &Palette) {
    let from = from.max(axes.plot.left());
    if to < from {
        return;
    }
    let rect =
        Rect::from_min_max(pos2(from + 1.0, axes.plot.top() - 17.0), pos2(to - 1.0, axes.plot.top() - 3.0));
    painter.rect_filled(rect, 2.0, p.line);
    if rect.width() > LEAST_BAND {
        let mut job = LayoutJob::simple_singleline(name.into(), FontId::proportional(10.5), p.text);
        job.wrap = TextWrapping::truncate_at_width(rect.width() - 4.0);
        let galley = painter.layout_job(job);
        painter.galley(rect.center() - galley.size() / 2.0, galley, p.text);
        // all of it, where that is cut
        let band = ui.interact(rect, ui.scope_id().with(("band", from.to_bits())), Sense::hover());
        band.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Stage {name}")));
        band.on_hover_text(name);
    }
    painter.vline(from, axes.plot.y_range(), Stroke::new(1.0, p.line));
}

/// At most one point per screen point: the first of each column.
fn thinned<'a>(axes: &'a Axes, forecast: &'a Forecast) -> impl Iterator<Item = &'a Point> {
    let column_s = axes.duration_s / f64::from(axes.plot.width().max(1.0));
    // the line comes from the point before
    let first = forecast.points.partition_point(|point| point.time_s < axes.from_s).saturating_sub(1);
    std::iter::successors(Some(first), move |index| {
        let time_s = forecast.points.get(*index)?.time_s;
        Some(forecast.next_at(*index, time_s + column_s))
    })
    .map_while(|index| forecast.points.get(index))
}

/// The columns of the path that is foreseen; found again when path or axes are others.
#[derive(Debug, Default)]
struct Columns {
    of: Option<(u64, f64, f64, f32)>,
    points: Vec<Point>,
}

impl Columns {
    fn refresh(&mut self, axes: &Axes, scene: &Scene<'_>) -> &[Point] {
        let of = (scene.analysis.forecast_version, axes.from_s, axes.duration_s, axes.plot.width());
        if self.of != Some(of) {
            self.of = Some(of);
            self.points = thinned(axes, scene.forecast()).cloned().collect();
        }
        &self.points
    }
}

/// `seen`: a point in each column.
fn draw_ground(painter: &Painter, axes: &Axes, seen: &[Point], p: &Palette) {
    let fill = p.border.gamma_multiply(0.55);
    let mut mesh = Mesh::default();
    let mut edge: Vec<Pos2> = Vec::new();
    for point in seen {
        let Some(ground) = point.ground_amsl_m else { continue };
        let top = pos2(axes.x(point.time_s), axes.y(ground));
        let first = mesh.vertices.len() as u32;
        mesh.colored_vertex(top, fill);
        mesh.colored_vertex(pos2(top.x, axes.plot.bottom()), fill);
        if first >= 2 {
            mesh.add_triangle(first - 2, first - 1, first);
            mesh.add_triangle(first - 1, first, first + 1);
        }
        edge.push(top);
    }
    painter.add(Shape::mesh(mesh));
    painter.add(Shape::line(edge, Stroke::new(1.2, p.border)));
}

/// Of the stronger line along a leg, over the path and below its coverage, screen points.
const ABOVE: f32 = 2.6;
const BELOW: f32 = 8.0;

fn draw_path(painter: &Painter, axes: &Axes, seen: &[Point], scene: &Scene<'_>, p: &Palette) {
    let forecast = scene.forecast();
    let highlighted = |leg: &flight_plan::Id, stroke: Stroke| {
        let is_its = |passage: &&Passage| scene.document.is_wanted(&passage.leg, |id| id == leg);
        for part in forecast.passages.iter().filter(is_its).filter_map(|passage| forecast.part(passage)) {
            painter.add(Shape::line(part.iter().map(|q| axes.place(q)).collect(), stroke));
        }
    };
    let looked_at = || {
        let selected = match &scene.view.selection {
            Some(crate::command::Selection::Leg(leg)) => Some(leg),
            _ => None,
        };
        selected.into_iter().chain(&scene.view.pointed)
    };
    let covered = scene.analysis.coverage();
    let covered = covered.filter(|_| scene.view.coverage && scene.out_of_date().is_none());
    match covered {
        Some(known) => {
            // what is selected lies below: who selects a leg there asks why it is red
            looked_at().for_each(|leg| highlighted(leg, Stroke::new(BELOW, p.text)));
            // what is narrower than a column is not seen
            for (reach, part) in coverage::parts(seen, known) {
                let path: Vec<Pos2> = part.iter().map(|point| axes.place(point)).collect();
                coverage::line(painter, &path, coverage::look(reach, p));
            }
        }
        None => {
            let path: Vec<Pos2> = seen.iter().map(|point| axes.place(point)).collect();
            let colour = if scene.out_of_date().is_some() { p.weak } else { p.accent };
            painter.add(Shape::line(path, Stroke::new(1.8, colour)));
        }
    }
    draw_diversion(painter, axes, scene, p);
    scene.faulty().into_iter().for_each(|leg| highlighted(leg, Stroke::new(ABOVE, p.warning)));
    if covered.is_none() {
        looked_at().for_each(|leg| highlighted(leg, Stroke::new(ABOVE, p.text)));
    }
    if let (Some(leg), true) = (scene.vehicle.current_leg(), scene.vehicle.is_airborne()) {
        highlighted(leg, Stroke::new(ABOVE, p.active));
    }
    if let Some(near) = flown::on_preview(scene) {
        flown::aircraft(painter, axes, near.time_s, scene, p);
    }
}

/// The way out after the alarm: it goes on beyond the end of the flight, if need be.
fn draw_diversion(painter: &Painter, axes: &Axes, scene: &Scene<'_>, p: &Palette) {
    let Some(found) = scene.diversion() else { return };
    let place = |q: &GlidePoint| pos2(axes.x(found.time_s + q.time_s), axes.y(q.altitude_amsl_m));
    let [chosen, other] = found.ways().map(|way| Vec::from_iter(way.iter().map(place)));
    painter.extend(Shape::dashed_line(&other, Stroke::new(1.2, p.weak), 8.0, 5.0));
    // as on the map: white dashes are a glide
    painter.extend(match found.glided {
        Some(_) => Shape::dashed_line(&chosen, Stroke::new(2.2, p.text), 8.0, 5.0),
        None => Shape::dotted_line(&chosen, p.contingency, 6.0, 1.5),
    });
}

fn draw_cursor(painter: &Painter, axes: &Axes, scene: &Scene<'_>, p: &Palette) {
    let Some(point) = scene.view.cursor_s.and_then(|t| scene.forecast().at(t)) else { return };
    let at = axes.place(point);
    painter.vline(at.x, axes.plot.y_range(), Stroke::new(1.0, p.text));
    painter.circle(at, 4.0, p.text, Stroke::new(1.5, p.halo));
    let leg =
        scene.forecast().passages.get(point.passage).map_or("", |passage| scene.document.label(&passage.leg));
    let altitude = scene.units().altitude();
    let above = point
        .ground_amsl_m
        .map_or_else(String::new, |g| format!(" · {} AGL", altitude.show(point.altitude_amsl_m - g)));
    let numbers =
        format!("{} · {}{above}", units::duration(point.time_s), altitude.show(point.altitude_amsl_m));
    let room = axes.plot.width() - 12.0;
    let lines = |text: String| {
        let mut job = LayoutJob::simple(text, FontId::proportional(11.5), p.text, room);
        job.wrap.max_rows = 2;
        painter.layout_job(job)
    };
    // a name that is too long to stand before the numbers stands above them
    let galley = match lines(format!("{leg} · {numbers}")) {
        one if one.rows.len() == 1 => one,
        _ => lines(format!("{leg}\n{numbers}")),
    };
    let x = (at.x + 8.0).min(axes.plot.right() - galley.size().x - 6.0);
    let plate = Rect::from_min_size(pos2(x, axes.plot.top() + 4.0), galley.size()).expand2(vec2(5.0, 3.0));
    painter.rect(plate, 4.0, p.card, Stroke::new(1.0, p.line), egui::StrokeKind::Outside);
    painter.galley(plate.min + vec2(5.0, 3.0), galley, p.text);
}

#[cfg(test)]
mod tests {
    use super::first_mark;

    #[test]
    fn no_mark_of_the_axis_is_minus_nought() {
        for (low, mark) in [(-30.0, "0"), (0.0, "0"), (-60.0, "-50"), (20.0, "50")] {
            assert_eq!(format!("{:.0}", first_mark(low, 50.0)), mark, "{low}");
        }
    }
}
