//! What can be selected on the map, as widgets that draw nothing: screen readers, the keyboard and tests find them by their
//! names. The pointer does not meet them: what is under it is found by the lines themselves.

use super::tools::Canvas;
use super::tools::pick::selection;
use super::view::View;
use super::{acts, polyline};
use super::{sketch::Handled, variables, zones};
use crate::chart::zones as chart;
use crate::command::{Queue, Selection, ViewCommand};
use crate::forecast::{Forecast, Passage};
use crate::panels::tree::title;
use crate::units::{self, Units};
use egui::accesskit::Action;
use egui::{Key, Pos2, Rect, Role, Sense, Ui, Vec2, WidgetInfo};
use geometry::LatLon;
use std::collections::HashSet;

/// Most of them; more could not be told apart.
const MOST: usize = 150;
/// So many legs are looked at for those in view.
const MOST_LEGS: usize = 5000;
/// The side of a widget, screen points.
const SIDE: f32 = 18.0;

/// A thing on the map.
#[derive(Debug, Clone, PartialEq)]
struct Item {
    name: String,
    /// A place of it on the screen.
    at: Pos2,
    what: Selection,
}

/// What the list was made of.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Made {
    view: View,
    version: u64,
    forecast: u64,
    units: Units,
    fixes: bool,
}

/// What is in view; looked for again when the view or the plan changes.
#[derive(Debug, Default)]
pub struct Items {
    made: Option<Made>,
    list: Vec<Item>,
}

impl Items {
    /// Offers what is in view to be selected. `fixes`: the tool in use offers no handles of fixes and waypoints.
    pub fn run(&mut self, ui: &Ui, canvas: &Canvas<'_>, fixes: bool, queue: &mut Queue) {
        let scene = canvas.scene;
        let made = Made {
            view: *canvas.view,
            version: scene.document.version(),
            forecast: scene.analysis.forecast_version,
            units: scene.units(),
            fixes,
        };
        if self.made != Some(made) {
            self.made = Some(made);
            self.list = in_view(canvas, fixes);
        }
        for item in &self.list {
            let selected = scene.is_selected(&item.what);
            if offer(ui, item, selected) {
                queue.view(ViewCommand::Select(Some(item.what.clone())));
            }
        }
        aircraft(ui, canvas);
    }
}

/// True: it was chosen by key or by a screen reader.
fn offer(ui: &Ui, item: &Item, selected: bool) -> bool {
    let id = ui.scope_id().with(("map item", &item.what));
    let rect = Rect::from_center_size(item.at, Vec2::splat(SIDE));
    let response = ui.interact(rect, id, Sense::focusable_noninteractive());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, selected, &item.name));
    ui.ctx().accesskit_node_builder(response.id, |node| node.add_action(Action::Click));
    let has_focus = response.has_focus();
    ui.input(|i| {
        let pressed = i.key_pressed(Key::Enter) || i.key_pressed(Key::Space);
        (has_focus && pressed) || i.has_accesskit_action_request(response.id, Action::Click)
    })
}

/// The aircraft that is shown; there is nothing to be selected of it.
fn aircraft(ui: &Ui, canvas: &Canvas<'_>) {
    let scene = canvas.scene;
    let (Some(position), Some(name)) = (&scene.vehicle.position, scene.vehicles.shown_name()) else { return };
    let (at, here) = (canvas.view.place(position.value.position), position.value.position.is_valid());
    if !here || !canvas.view.rect.contains(at) {
        return;
    }
    let (height, age_s) = (position.value.altitude_amsl_m, position.age_s(scene.now_s));
    let state = match position.is_expired(scene.now_s) {
        true => format!("last seen {} ago", units::age(age_s)),
        false => format!("{} AMSL", scene.units().altitude().show(height)),
    };
    let rect = Rect::from_center_size(at, Vec2::splat(2.0 * SIDE));
    let response = ui.interact(rect, ui.scope_id().with("aircraft"), Sense::focusable_noninteractive());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, format!("Aircraft {name}, {state}")));
}

/// Zones, runways, emergency plans, legs and areas: what is in view of them.
fn in_view(canvas: &Canvas<'_>, fixes: bool) -> Vec<Item> {
    let Canvas { view, sketch, scene, .. } = *canvas;
    let plan = scene.document.plan();
    let outline = |line: &[LatLon], name: String, what: Selection| {
        on_outline(line, view).map(|at| Item { name, at, what })
    };
    let runways = plan.runways.iter().filter_map(|runway| {
        let end = runway.threshold.destination(runway.heading_deg, runway.length_m.clamp(1.0, 10_000.0));
        let (id, name) = (&runway.id, format!("Runway {}", runway.id));
        outline(&[runway.threshold, end], name, Selection::Runway(id.clone()))
    });
    let zones = plan.zones.iter().filter_map(|zone| {
        let name = zones::label(zone, scene.units());
        outline(&closed(&chart::outline(zone)), name, Selection::Zone(zone.id.clone()))
    });
    let variables = sketch.variables.iter().filter_map(|variable| {
        let (at, name) = (view.place(variable.at), format!("Variable {}", variables::name(&variable.name)));
        inside(at, view).then(|| Item { name, at, what: Selection::Variable(variable.name.clone()) })
    });
    let named = sketch.areas.iter().filter_map(|(variable, corners)| {
        let name = format!("Variable {}", variables::name(variable));
        outline(&closed(corners), name, Selection::Variable(variable.clone()))
    });
    let emergencies = sketch.emergencies.iter().filter_map(|(id, line)| {
        let name = plan.emergency_plan(id).map_or_else(|| id.to_string(), |e| title(&e.name, id.as_str()));
        outline(line, format!("Path of emergency plan {name}"), Selection::Emergency(id.clone()))
    });
    let areas = sketch.polygons.iter().filter_map(|(leg, rings)| {
        let name = format!("Area of {}", scene.document.label(leg));
        outline(&closed(rings.first()?), name, Selection::Leg(leg.clone()))
    });
    let handles = sketch.handles_there(scene.view.selection.as_ref()).filter(|(_, handle, _)| {
        fixes && matches!(handle.what, Handled::Fix(_) | Handled::Waypoint(_) | Handled::Centre(_))
    });
    let handles = handles.filter_map(|(_, handle, at)| {
        let (at, name) = (view.screen(at), || handle.what.name(scene.document));
        inside(at, view).then(|| Item { name: name(), at, what: selection(plan, &handle.what) })
    });
    let mut once = HashSet::new();
    let all = runways
        .chain(zones)
        .chain(variables)
        .chain(named)
        .chain(legs(canvas))
        .chain(legs_of_ways(canvas))
        .chain(areas)
        .chain(emergencies)
        .chain(handles);
    all.filter(|item| once.insert(item.what.clone())).take(MOST).collect()
}

/// Each leg where its path is in view.
fn legs<'a>(canvas: &Canvas<'a>) -> impl Iterator<Item = Item> + 'a {
    let Canvas { view, sketch, scene, .. } = *canvas;
    let forecast = scene.forecast();
    let mut flown = HashSet::new();
    let passages = forecast.passages.iter().take(MOST_LEGS).filter(move |passage| flown.insert(&passage.leg));
    passages.filter_map(move |passage| {
        let at = on_path(forecast, passage, view)?;
        let leg = scene.document.written(&passage.leg);
        let done = acts::on(&passage.leg, &sketch.acts).map(|words| format!(": {words}")).unwrap_or_default();
        let name = format!("Path of {}{done}", scene.document.label(&leg));
        Some(Item { name, at, what: Selection::Leg(leg) })
    })
}

/// Each leg of a way from a fork where its line is in view; those that are flown have been found by their path.
fn legs_of_ways<'a>(canvas: &Canvas<'a>) -> impl Iterator<Item = Item> + 'a {
    let Canvas { view, sketch, scene, .. } = *canvas;
    let lines = sketch.ways.iter().flat_map(|way| &way.lines).take(MOST_LEGS);
    lines.filter_map(move |line| {
        let at = on_outline(&[line.from, line.to], view)?;
        let name = format!("Path of {}", scene.document.label(&line.leg));
        Some(Item { name, at, what: Selection::Leg(line.leg.clone()) })
    })
}

/// A place of a path in view, in its middle if that is.
fn on_path(forecast: &Forecast, passage: &Passage, view: &View) -> Option<Pos2> {
    let places = forecast.places().at.get(passage.first..(passage.end + 1).min(forecast.points.len()))?;
    let place = |sixteenth: usize| places.get(places.len() * sixteenth / 16).map(|at| view.screen(*at));
    [8, 4, 12, 2, 6, 10, 14].into_iter().filter_map(place).find(|at| inside(*at, view))
}

/// A place of a line in view that is no corner of it, in its middle if that is.
fn on_outline(line: &[LatLon], view: &View) -> Option<Pos2> {
    let points: Vec<Pos2> = line.iter().filter(|at| at.is_valid()).map(|at| view.place(*at)).collect();
    let middles = points.windows(2).filter_map(polyline::middle);
    polyline::middle(&points).into_iter().chain(middles).find(|at| inside(*at, view))
}

fn closed(ring: &[LatLon]) -> Vec<LatLon> {
    ring.iter().chain(ring.first()).copied().collect()
}

fn inside(at: Pos2, view: &View) -> bool {
    view.rect.shrink(0.5 * SIDE).contains(at)
}
