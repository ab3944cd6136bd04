//! What lies on the map's edge: scale, sources, legend, and the buttons.

use super::graticule::{Round, round_length};
use super::names::Names;
use super::polyline::{self, Style};
use super::tools::{Card, Toolbox};
use super::view::View;
use super::{chips, text, tool_chip};
use crate::assets;
use crate::command::{Queue, ViewCommand};
use crate::panels::{Scene, tour};
use crate::theme::{self, Palette};
use crate::units::{self, Units};
use egui::{Align2, Painter, Popup, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, pos2, vec2};
use serde::{Deserialize, Serialize};
use walkers::MapMemory;

/// What lies on the map's edge and over it, besides what always does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Edge {
    /// Lines of latitude and longitude.
    pub graticule: bool,
    /// Rings around the aircraft, or else around home.
    pub rings: bool,
    /// The legend was put away: it is behind a button, as where there is no room for it.
    #[serde(default)]
    pub no_legend: bool,
}

/// On a map that is narrower the legend is behind a button: the commands take several lines there, screen points.
pub const NARROW: f32 = 600.0;

/// From one tool to the next, screen points.
const TOOL: f32 = 36.0;
/// What the legend takes of the map's lower edge, besides its lines, screen points.
const LEGEND: f32 = 36.0;
/// Height of the line that names the map's sources, screen points.
const SOURCES: f32 = 16.0;
/// Length of the scale bar with its label, screen points.
const SCALE: f32 = 170.0;

/// Draws scale bar, legend and sources, and keeps names clear of them and of the buttons; there are so many tools.
pub fn draw(painter: &Painter, view: &View, scene: &Scene<'_>, tools: usize, names: &mut Names, p: &Palette) {
    let corner = view.rect.right_bottom() - vec2(6.0, 4.0);
    let sources = std::iter::once(assets::ATTRIBUTION.to_owned()).chain(scene.layers.attributions());
    let sources = sources.collect::<Vec<_>>().join(" · ");
    let named = text::haloed(painter, corner, Align2::RIGHT_BOTTOM, &sources, 10.0, p.weak, p);
    // above the sources where these reach over to it
    let lift = if named.left() < view.rect.left() + SCALE { SOURCES } else { 0.0 };
    let map = view.rect.with_max_y(view.rect.bottom() - lift);
    let scale = scale(painter, view, map, scene.units(), p);
    let (toolbar, buttons) = (toolbar_at(view.rect, tools, scene), buttons_at(view.rect, scene));
    // also while the pointer is elsewhere: no name moves for it
    for taken in [named, scale, toolbar, buttons, pointer_at(view.rect, buttons)] {
        names.keep_clear(taken);
    }
    let plate = legend_at(view.rect, lift, tools, scene);
    painter.ctx().data_mut(|data| data.insert_temp(legend_id(), plate));
    if let Some(plate) = plate {
        painter.rect_filled(plate, 4.0, p.panel.gamma_multiply(0.8));
        draw_lines(painter, plate.min + LEGEND_EDGE, &lines(scene), p);
        names.keep_clear(plate);
    }
    let needle = view.rect.right_bottom() - vec2(26.0, 44.0);
    let north_at = Rect::from_min_max(needle - vec2(8.0, 30.0), needle + vec2(8.0, 0.0));
    let said = tool_chip::shown(painter.ctx(), view.rect);
    // up is north, with or without it: the buttons and what the tool says are needed more
    if !north_at.intersects(buttons) && said.is_none_or(|said| !north_at.intersects(said)) {
        north(painter, needle, p);
        names.keep_clear(north_at);
    }
    let over_map = [said, chips::shown(painter.ctx())];
    over_map.into_iter().flatten().for_each(|rect| names.keep_clear(rect));
}

/// What the tools take of the map: all of their columns.
fn toolbar_at(map: Rect, tools: usize, scene: &Scene<'_>) -> Rect {
    columns(map, tools, scene).fold(Rect::NOTHING, Rect::union)
}

/// Their columns, from the left.
fn columns(map: Rect, tools: usize, scene: &Scene<'_>) -> impl Iterator<Item = Rect> {
    let shown = if are_folded(map, tools, scene) { 1 } else { tools };
    let most = in_column(map);
    (0..shown.div_ceil(most)).map(move |index| {
        let rows = (shown - index * most).min(most);
        let corner = map.left_top() + vec2(12.0 + TOOL * index as f32, 12.0);
        Rect::from_min_size(corner, TOOL * vec2(1.0, rows as f32))
    })
}

/// What the buttons at the right edge take of it.
fn buttons_at(map: Rect, scene: &Scene<'_>) -> Rect {
    let more = usize::from(is_legend_folded(map, scene)) + usize::from(scene.vehicle.position.is_some());
    Rect::from_min_size(map.right_top() + vec2(-44.0, 12.0), vec2(34.0, TOOL * (3 + more) as f32))
}

/// In flight a map is for looking: on a small one, where the tools need more than one column, they are behind one button.
fn are_folded(map: Rect, tools: usize, scene: &Scene<'_>) -> bool {
    scene.vehicle.is_airborne() && map.width() < NARROW && tools > in_column(map)
}

/// North is up.
fn north(painter: &Painter, at: Pos2, p: &Palette) {
    let needle = vec![at + vec2(0.0, -16.0), at + vec2(5.0, 0.0), at + vec2(0.0, -4.0), at + vec2(-5.0, 0.0)];
    painter.add(Shape::closed_line(needle.clone(), Stroke::new(3.0, p.halo)));
    painter.add(Shape::closed_line(needle, Stroke::new(1.2, p.text)));
    text::haloed(painter, at + vec2(0.0, -17.0), Align2::CENTER_BOTTOM, "N", 10.0, p.text, p);
}

/// Where what is below the pointer is told: left of the buttons, where these reach down to it.
fn pointer_at(map: Rect, buttons: Rect) -> Rect {
    let corner = map.right_bottom() - vec2(6.0, 18.0);
    let low = Rect::from_min_max(corner - vec2(270.0, 16.0), corner);
    let beside = if low.intersects(buttons) { low.right() - buttons.left() + 4.0 } else { 0.0 };
    low.translate(vec2(-beside, 0.0))
}

/// Where the pointer is, and how high the ground is there.
pub fn pointer(ui: &mut Ui, view: &View, at: Option<Pos2>, scene: &Scene<'_>) {
    let Some(at) = at.map(|at| view.geo(at)).filter(|at| at.is_valid()) else { return };
    let ground = scene.layers.ground().elevation_m(at).map(|m| scene.units().altitude().show(m));
    let ground = ground.map_or_else(|| "elevation unknown".into(), |m| format!("ground {m} AMSL"));
    let text = format!("{} · {ground}", units::position(at));
    let rect = pointer_at(view.rect, buttons_at(view.rect, scene));
    let mut line = ui.new_child(
        egui::UiBuilder::new().max_rect(rect).layout(egui::Layout::right_to_left(egui::Align::Center)),
    );
    let p = theme::of(&line);
    let text =
        egui::RichText::new(text).size(11.0).color(p.text).background_color(p.panel.gamma_multiply(0.8));
    line.add(egui::Label::new(text).selectable(false));
}

/// A bar of a round length, up to 90 points long. Returns where it is.
fn scale(painter: &Painter, view: &View, map: Rect, units: Units, p: &Palette) -> Rect {
    let (unit, length) = round_length(units, 90.0 / view.points_per_metre(), Round::Down);
    let points = (unit.to_si(length) * view.points_per_metre()) as f32;
    let start = map.left_bottom() + vec2(12.0, -12.0);
    let end = start + vec2(points, 0.0);
    for (width, colour) in [(5.0, p.halo), (2.0, p.text)] {
        painter.line_segment([start, end], Stroke::new(width, colour));
    }
    let label = format!("{length} {}", unit.symbol);
    let named = text::haloed(painter, end + vec2(6.0, 0.0), Align2::LEFT_CENTER, &label, 11.0, p.text, p);
    named | Rect::from_two_pos(start, end)
}

/// Draws a line of some style from here to there.
type Line = fn(&Painter, Pos2, Pos2, &Palette);

/// The plan that is shown, by what it is beside the one that is flown.
const PLANNED: Line = |painter, a, b, p| {
    painter.line_segment([a, b], Stroke::new(2.0, p.accent));
};

/// The plan aboard, where another one is shown.
const ABOARD: Line = |painter, a, b, p| {
    painter.extend(Shape::dashed_line(&[a, b], Stroke::new(2.4, p.contingency), 8.0, 5.0));
};

/// What would follow a command that is considered.
const FORESEEN: Line = |painter, a, b, p| {
    polyline::draw(painter, &[vec![a, b]], Stroke::new(5.0, p.text), Style::Double, p.halo);
};

/// The lines that are always drawn alike, and what they mean.
const LINES: [(&str, Line); 6] = [
    ("active", |painter, a, b, p| {
        painter.line_segment([a, b], Stroke::new(3.6, p.active));
    }),
    ("flown", |painter, a, b, p| {
        painter.line_segment([a, b], Stroke::new(2.6, p.flown));
    }),
    ("alternate", |painter, a, b, p| {
        painter.extend(Shape::dotted_line(&[a, b], p.contingency, 6.0, 1.5));
    }),
    ("glide", |painter, a, b, p| {
        painter.extend(Shape::dashed_line(&[a, b], Stroke::new(2.2, p.text), 8.0, 5.0));
    }),
    ("other way out", |painter, a, b, p| {
        painter.extend(Shape::dashed_line(&[a, b], Stroke::new(1.2, p.weak), 8.0, 5.0));
    }),
    ("branch", |painter, a, b, p| {
        painter.extend(Shape::dashed_line(&[a, b], Stroke::new(1.4, p.accent), 8.0, 5.0));
    }),
];

/// All of them, as they are drawn now.
fn lines(scene: &Scene<'_>) -> Vec<(&'static str, Line)> {
    let plans = match scene.path_aboard() {
        Some(_) => vec![("edited plan", PLANNED), ("plan aboard", ABOARD)],
        None => vec![("planned", PLANNED)],
    };
    let considered = scene.vehicle.outlook.considered().and_then(|considered| considered.foresight.as_ref());
    let foreseen = considered.filter(|foresight| foresight.is_ok()).map(|_| ("would be flown", FORESEEN));
    plans.into_iter().chain(foreseen).chain(LINES).collect()
}

/// Size of what so many of them take, screen points.
fn size_of(lines: usize) -> Vec2 {
    vec2(112.0, 16.0 * lines as f32)
}

/// Around the lines, screen points.
const LEGEND_EDGE: Vec2 = vec2(6.0, 2.0);

/// Where the legend lies on the map, above its scale; `None`: there is no room for it, or it was put away.
fn legend_at(map: Rect, lift: f32, tools: usize, scene: &Scene<'_>) -> Option<Rect> {
    if is_legend_folded(map, scene) {
        return None;
    }
    let (toolbar, bottom) = (toolbar_at(map, tools, scene), map.bottom() - lift);
    let size = size_of(lines(scene).len());
    // beside the tools where they reach down to it
    let left = if toolbar.bottom() > bottom - LEGEND - size.y { toolbar.right() - 4.0 } else { map.left() };
    let origin = pos2(left + 12.0, bottom - 30.0 - size.y);
    Some(Rect::from_min_size(origin, size).expand2(LEGEND_EDGE))
}

/// Where the legend lies on a map with so many tools, if it does.
pub fn legend(map: Rect, tools: usize, scene: &Scene<'_>) -> Option<Rect> {
    legend_at(map, 0.0, tools, scene)
}

fn legend_id() -> egui::Id {
    egui::Id::unique("legend of the map")
}

fn is_legend_folded(map: Rect, scene: &Scene<'_>) -> bool {
    map.width() < NARROW || scene.view.edge.no_legend
}

/// What lies under the legend can't be seen, and so not be clicked. Its mark puts it away.
fn legend_over(ui: &mut Ui, plate: Rect, scene: &Scene<'_>, queue: &mut Queue) {
    ui.interact(plate, legend_id(), Sense::click());
    let mark = Rect::from_min_size(plate.right_top() - vec2(18.0, 0.0), vec2(18.0, 18.0));
    let close = ui.put(mark, egui::Button::new(egui::RichText::new("✖").size(10.0)).frame(false));
    let name = "Put the legend away";
    close.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
    if close.on_hover_text(name).clicked() {
        queue.view(ViewCommand::Edge(Edge { no_legend: true, ..scene.view.edge }));
    }
}

fn draw_lines(painter: &Painter, origin: Pos2, lines: &[(&str, Line)], p: &Palette) {
    for (i, (name, line)) in lines.iter().enumerate() {
        let y = origin.y + 8.0 + 16.0 * i as f32;
        line(painter, pos2(origin.x, y), pos2(origin.x + 30.0, y), p);
        let (at, font) = (pos2(origin.x + 38.0, y), egui::FontId::proportional(11.0));
        painter.text(at, Align2::LEFT_CENTER, name, font, p.text);
    }
}

/// Where the legend does not lie on the map it is behind a button.
fn legend_button(ui: &mut Ui, has_room: bool, scene: &Scene<'_>, queue: &mut Queue) {
    let response = button(ui, "☰", "What the lines mean", false);
    Popup::menu(&response).show(|ui| {
        if has_room && ui.button("Leave it on the map").clicked() {
            queue.view(ViewCommand::Edge(Edge { no_legend: false, ..scene.view.edge }));
        }
        let lines = lines(scene);
        let (rect, shown) = ui.allocate_exact_size(size_of(lines.len()), Sense::hover());
        draw_lines(ui.painter(), rect.min, &lines, theme::of(ui));
        let names = lines.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
        shown.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, format!("Lines: {names}")));
    });
}

/// Buttons at the map's right edge.
pub fn buttons(ui: &mut Ui, memory: &mut MapMemory, scene: &Scene<'_>, queue: &mut Queue) {
    let map = ui.min_rect();
    let area = buttons_at(map, scene);
    let mut column = ui.new_child(egui::UiBuilder::new().max_rect(area).id_salt("map buttons"));
    column.spacing_mut().item_spacing.y = 4.0;
    if button(&mut column, "+", "Zoom in", false).clicked() {
        // at the end of the range nothing happens
        let _ = memory.zoom_in();
    }
    if button(&mut column, "−", "Zoom out", false).clicked() {
        let _ = memory.zoom_out();
    }
    if button(&mut column, "⛶", "Show the whole plan (F)", false).clicked() {
        queue.view(ViewCommand::Fit);
    }
    if is_legend_folded(map, scene) {
        legend_button(&mut column, map.width() >= NARROW, scene, queue);
    }
    if let Some(plate) = ui.data(|data| data.get_temp::<Option<Rect>>(legend_id())).flatten() {
        legend_over(ui, plate, scene, queue);
    }
    let follow = |ui: &mut Ui| button(ui, "✈", "Follow the aircraft", scene.view.follow).clicked();
    if scene.vehicle.position.is_some() && follow(&mut column) {
        queue.view(ViewCommand::Follow(!scene.view.follow));
    }
}

/// The tools at the map's left edge, and what the one in use says.
pub fn toolbar(ui: &mut Ui, tools: &mut Toolbox, scene: &Scene<'_>, queue: &mut Queue) {
    let map = ui.min_rect();
    let cards: Vec<_> = tools.cards().collect();
    let columns: Vec<Rect> = columns(map, cards.len(), scene).collect();
    let mut shown = Rect::NOTHING;
    if are_folded(map, cards.len(), scene) {
        let area = toolbar_at(map, cards.len(), scene);
        let mut folded = ui.new_child(egui::UiBuilder::new().max_rect(area).id_salt("folded tools"));
        shown = folded_tools(&mut folded, &cards, queue);
    } else {
        for (index, (cards, area)) in cards.chunks(in_column(map)).zip(&columns).enumerate() {
            let salt = ("map tools", index);
            let mut column = ui.new_child(egui::UiBuilder::new().max_rect(*area).id_salt(salt));
            column.spacing_mut().item_spacing.y = 4.0;
            cards.iter().for_each(|card| tool_button(&mut column, card, queue));
            shown |= column.min_rect();
        }
    }
    tour::mark(ui.ctx(), tour::TOOLS, shown);
    tool_chip::show(ui, tools, &columns, scene, queue);
}

/// A tool's card, and whether it is in use.
type ToolCard = (&'static Card, bool);

fn tool_button(ui: &mut Ui, (card, in_use): &ToolCard, queue: &mut Queue) {
    let name = format!("{} ({})", card.name, card.key.name());
    if button(ui, card.symbol, &name, *in_use).clicked() {
        queue.view(ViewCommand::Tool(card.id));
    }
}

/// A button that shows the tool in use, and all of them when it is pressed. Returns where it is.
fn folded_tools(ui: &mut Ui, cards: &[ToolCard], queue: &mut Queue) -> Rect {
    /// So many are in a row.
    const ROW: usize = 4;
    let in_use = cards.iter().find(|(_, in_use)| *in_use).or(cards.first()).map(|(card, _)| *card);
    let symbol = in_use.map_or("", |card| card.symbol);
    let response = button(ui, symbol, "Tools of the map", false);
    Popup::menu(&response).show(|ui| {
        for row in cards.chunks(ROW) {
            ui.horizontal(|ui| row.iter().for_each(|card| tool_button(ui, card, queue)));
        }
    });
    response.rect
}

/// So many tools are in a column: there is a second one where the map is too low for one.
fn in_column(map: Rect) -> usize {
    (((map.height() - 12.0) / TOOL) as usize).max(1)
}

fn button(ui: &mut Ui, symbol: &str, name: &str, on: bool) -> Response {
    let p = theme::of(ui);
    let button = egui::Button::new(egui::RichText::new(symbol).size(16.0))
        .stroke(Stroke::new(1.0, p.line))
        .selected(on);
    ui.spacing_mut().button_padding.x = 0.0;
    let response = ui.add_sized([32.0, 32.0], button).on_hover_text(name);
    let name = name.to_owned();
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    response
}
