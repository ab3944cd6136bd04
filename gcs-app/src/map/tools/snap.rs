//! What is near means what it is near to: fixes, variables, runways, corners, waypoints, and the lines of runways.

use super::Canvas;
use super::pen::Mark;
use super::pick::handles_near;
use crate::map::sketch::{AreaPart, Handled};
use crate::map::text;
use crate::theme::Palette;
use egui::{Align2, Painter, Pos2, Stroke, vec2};
use flight_plan::{FlightPlan, Id, Place, Runway, Value, figures};
use geometry::LatLon;
use geometry::geodesy::normalise_180;

/// A place so near to something means that, screen points.
const SNAP: f32 = 12.0;
/// The line of a runway goes on so far beyond its threshold, metres.
const LINE_M: f64 = 15_000.0;

/// What a place on the line of a runway is called, before that.
const CENTRE_LINE: &str = "centre line of ";

/// What a place is called is one on the line of a runway.
pub fn is_line(on: &str) -> bool {
    on.starts_with(CENTRE_LINE)
}

/// The place under the pointer: what is near there, or the ground.
pub fn snap(at: Pos2, canvas: &Canvas<'_>) -> Mark {
    snap_but(at, canvas, &|_, _| false)
}

/// The same, without what `not` says; it gets what the place would be called, and where it is.
pub fn snap_but(at: Pos2, canvas: &Canvas<'_>, not: &dyn Fn(&str, LatLon) -> bool) -> Mark {
    let ground = || Mark::at(canvas.view.geo(at));
    if !canvas.snaps {
        return ground();
    }
    let far = |mark: &Mark| canvas.view.place(mark.at).distance(at);
    let is_near = |mark: &Mark| far(mark) < SNAP && mark.on.as_ref().is_none_or(|on| !not(on, mark.at));
    let points = things(canvas).chain(runway_ends(canvas)).chain(corners(at, canvas)).find(is_near);
    let lines = || {
        let runways = canvas.scene.document.plan().runways.iter();
        let on_line = runways.filter_map(|runway| line_of(runway, canvas.view.geo(at)));
        on_line.filter(is_near).min_by(|a, b| far(a).total_cmp(&far(b)))
    };
    points.or_else(lines).unwrap_or_else(ground)
}

/// Fixes and variables: a leg that is drawn there goes where they are.
fn things<'a>(canvas: &Canvas<'a>) -> impl Iterator<Item = Mark> + use<'a> {
    let fixes = canvas.sketch.handles.iter().filter_map(|handle| match &handle.what {
        Handled::Fix(id) => {
            Some(Mark { place: Place::Fix(id.clone()), at: handle.at, on: Some(format!("fix {id}")) })
        }
        _ => None,
    });
    let variables = canvas.sketch.variables.iter().map(|variable| Mark {
        place: Place::Position(Value::Expression(variable.name.as_str().into())),
        at: variable.at,
        on: Some(format!("variable {}", variable.name)),
    });
    fixes.chain(variables)
}

/// How everything of a runway is called at the end, and of its other direction, which lies there, too.
pub fn of_runway(plan: &FlightPlan, id: &Id) -> Vec<String> {
    let runway = plan.runway(id);
    let both = runway.into_iter().chain(runway.and_then(|runway| plan.opposite(runway)));
    both.map(|runway| of(&runway.id)).collect()
}

fn of(runway: &Id) -> String {
    format!(" of {runway}")
}

fn runway_ends<'a>(canvas: &Canvas<'a>) -> impl Iterator<Item = Mark> + use<'a> {
    canvas.scene.document.plan().runways.iter().flat_map(|runway| {
        let end = figures::place(runway.threshold.destination(runway.heading_deg, runway.length_m));
        [(runway.threshold, "threshold"), (end, "end")]
            .map(|(at, what)| Mark { on: Some(format!("{what}{}", of(&runway.id))), ..Mark::at(at) })
    })
}

fn corners<'a>(at: Pos2, canvas: &Canvas<'a>) -> impl Iterator<Item = Mark> + use<'a> {
    let scene = canvas.scene;
    handles_near(at, SNAP, canvas).filter_map(move |handle| match &handle.what {
        Handled::Corner { .. }
        | Handled::Area(_, AreaPart::Corner(_))
        | Handled::Waypoint(_)
        | Handled::Centre(_) => {
            Some(Mark { on: Some(handle.what.name(scene.document)), ..Mark::at(handle.at) })
        }
        _ => None,
    })
}

/// The nearest place on a runway's line and beyond both ends.
fn line_of(runway: &Runway, at: LatLon) -> Option<Mark> {
    if !runway.threshold.is_valid() || !runway.heading_deg.is_finite() || !at.is_valid() {
        return None;
    }
    let way = runway.threshold.inverse(at);
    let off_rad = normalise_180(way.bearing_start_deg - runway.heading_deg).to_radians();
    let along_m = way.distance_m * off_rad.cos();
    if along_m.abs() > LINE_M {
        return None;
    }
    let back_deg = if along_m < 0.0 { 180.0 } else { 0.0 };
    let on = runway.threshold.destination(runway.heading_deg + back_deg, along_m.abs());
    Some(Mark { on: Some(format!("{CENTRE_LINE}{}", runway.id)), ..Mark::at(figures::place(on)) })
}

/// A ring around what a click would take, and its name; along a line, the line.
pub fn paint(painter: &Painter, mark: &Mark, canvas: &Canvas<'_>, p: &Palette) {
    let Some(on) = &mark.on else { return };
    let at = canvas.view.place(mark.at);
    let runway = on.strip_prefix(CENTRE_LINE);
    let runway = runway.and_then(|id| canvas.scene.document.plan().runway(&id.into()));
    if let Some(runway) = runway {
        let from = canvas.view.place(runway.threshold);
        painter.line_segment([from, at], Stroke::new(1.0, p.accent));
    }
    painter.circle_stroke(at, 10.0, Stroke::new(2.0, p.accent));
    text::haloed(painter, at + vec2(10.0, 12.0), Align2::LEFT_TOP, on, 12.0, p.accent, p);
}
