//! Marks on the path: where a preview ends early, where a plan is wrong, and the way out after an alarm.

use super::polyline::{self, Style};
use super::text;
use super::view::{Mercator, View};
use crate::panels::what_if::{cause_name, reach_name};
use crate::panels::{Scene, problems};
use crate::theme::Palette;
use egui::{Color32, Painter, Pos2, Shape, Stroke, vec2};
use flight_exec::rehearse::Diversion;
use flight_exec::review::Margins;
use flight_plan::{FlightPlan, Id, Problem};
use geometry::LatLon;
use std::collections::HashSet;

/// Longest text beside a mark, characters.
const LONGEST: usize = 70;

/// The first error of a plan that can't be flown.
pub fn first_error<'a>(scene: &Scene<'a>) -> Option<&'a Problem> {
    scene.analysis.no_forecast.as_ref()?;
    scene.problems().find(|problem| problem.is_error())
}

/// Most crosses at places of legs in error.
const MOST: usize = 50;

/// The errors of what the path, as it is drawn, does not come to: where it does, it is red itself.
pub fn off_path<'a>(scene: &Scene<'a>) -> impl Iterator<Item = &'a Problem> {
    let (forecast, mut seen) = (scene.forecast(), HashSet::new());
    let errors = scene.problems().filter(|problem| problem.is_error());
    // gone through once, and only where something is wrong
    let passages =
        scene.problems().any(Problem::is_error).then_some(&forecast.passages).into_iter().flatten();
    let flown: HashSet<&Id> = passages.flat_map(|passage| [&passage.leg, &passage.stage]).collect();
    let is_flown = move |id: &Id| flown.contains(id);
    errors.filter(move |p| p.subject.as_ref().is_some_and(|id| seen.insert(id) && !is_flown(id))).take(MOST)
}

/// A cross where the path ends too early, and one where the plan is wrong. `error_at`: where that is; `others`: where else.
pub fn draw_failures(
    painter: &Painter,
    view: &View,
    scene: &Scene<'_>,
    (error_at, others): (Option<LatLon>, &[LatLon]),
    p: &Palette,
) {
    others.iter().for_each(|at| cross(painter, view.place(*at), p.warning, p));
    let end = scene.forecast().points.last().zip(scene.forecast().cut_short.as_ref());
    if let Some((end, why)) = end.filter(|_| scene.analysis.no_forecast.is_none()) {
        failure(painter, view.place(end.position), why, p);
    }
    // what has no place of its own is wrong where the path ends
    let ends = scene.forecast().points.last().filter(|_| scene.forecast().is_beginning);
    if let Some((problem, at)) = first_error(scene).zip(error_at.or(ends.map(|end| end.position))) {
        let why = scene.document.plan().in_names(&problem.message);
        failure(painter, view.place(at), &why, p);
    }
}

/// Where a problem is, as something that can be found on the map.
pub fn selection_of(problem: &Problem, scene: &Scene<'_>) -> Option<crate::command::Selection> {
    problems::find(scene.document, problem.subject.as_ref()?)
}

fn failure(painter: &Painter, at: Pos2, why: &str, p: &Palette) {
    cross(painter, at, p.warning, p);
    // below the name of what is there
    text::on_plate(painter, at + vec2(12.0, 10.0), &shortened(why), 11.5, p);
}

fn cross(painter: &Painter, at: Pos2, colour: Color32, p: &Palette) {
    painter.circle(at, 9.0, p.halo, Stroke::new(2.0, colour));
    for d in [vec2(1.0, 1.0), vec2(1.0, -1.0)] {
        painter.add(Shape::line_segment([at - d * 4.0, at + d * 4.0], Stroke::new(2.5, colour)));
    }
}

fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}

/// The way out after the alarm: after an engine failure the glide, and fainter the plan as it would be flown with an engine.
pub fn draw_diversion(painter: &Painter, view: &View, scene: &Scene<'_>, p: &Palette) {
    let Some(found) = scene.diversion() else { return };
    let [chosen, other] = found.ways().map(|way| Vec::from_iter(way.iter().map(|point| point.position)));
    way(painter, view, &other, Stroke::new(1.2, p.weak), p);
    way(painter, view, &chosen, Stroke::new(2.6, p.text), p);
    if let Some(end) = chosen.last() {
        let at = view.place(*end);
        if !reaches(found) {
            cross(painter, at, p.warning, p);
        }
        text::on_plate(painter, at + vec2(12.0, 6.0), &label(found, scene.document.plan()), 11.5, p);
    }
}

fn reaches(found: &Diversion) -> bool {
    found.reach(0.0, 0.0) != flight_exec::rehearse::Reach::Out
}

fn label(found: &Diversion, flown: &FlightPlan) -> String {
    let margins = Margins::default();
    let reach = reach_name(found.reach(margins.glide_m, margins.energy_share));
    let plan = found.plan.as_ref().map_or("no plan", |(plan, _)| flown.label(plan));
    format!("{}: {plan}, {reach}", cause_name(found.cause))
}

fn way(painter: &Painter, view: &View, places: &[LatLon], stroke: Stroke, p: &Palette) {
    let line: Vec<Mercator> = places.iter().map(|at| (*at).into()).collect();
    polyline::draw(painter, &polyline::visible_parts(&line, view), stroke, Style::Dashed, p.halo);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_reason_is_shortened_between_characters() {
        assert_eq!(shortened("short"), "short");
        let long = shortened(&"ü".repeat(LONGEST + 5));
        assert_eq!(long.chars().count(), LONGEST + 1);
        assert!(long.ends_with('…'));
    }
}
