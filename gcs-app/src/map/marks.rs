//! Marks on the path: where a preview ends early, where a plan is wrong, and the way out after an alarm.

use super::names::{self, Ground, Name, Names, Rank};
use super::polyline::{self, Style};
use super::sketch::{Line, Sketch, Way};
use super::view::{Mercator, View};
use crate::panels::what_if::{cause_name, reach_name};
use crate::panels::{Scene, problems};
use crate::theme::Palette;
use egui::{Color32, Painter, Pos2, Shape, Stroke, vec2};
use flight_exec::rehearse::Diversion;
use flight_exec::review::Margins;
use flight_plan::{FlightPlan, FlownAt, Id, Problem};
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
    let is_off = move |p: &Problem, id| p.is_off_plan() || !is_flown(id);
    errors.filter(move |p| p.subject.as_ref().is_some_and(|id| seen.insert(id) && is_off(p, id))).take(MOST)
}

/// The pieces of ways on from forks on which a plan is wrong, where the flight as planned is not: they are red instead of it.
pub fn draw_off_plan(painter: &Painter, view: &View, scene: &Scene<'_>, sketch: &Sketch, p: &Palette) {
    let errors = scene.problems().filter(|problem| problem.is_error() && problem.is_off_plan());
    for spot in errors.filter_map(|problem| problem.place.as_deref()).take(MOST) {
        if let Some(line) = piece(&sketch.ways, spot) {
            let parts = polyline::visible_parts(&[line.from.into(), line.to.into()], view);
            polyline::draw(painter, &parts, Stroke::new(3.2, p.warning), Style::Dashed, p.halo);
        }
    }
}

/// The piece of a way that leads past a place: of the branch's fork, if that is known.
fn piece<'a>(ways: &'a [Way], spot: &FlownAt) -> Option<&'a Line> {
    let fork = spot.branch.as_ref().map(|(fork, _)| fork);
    let ways = ways.iter().filter(|way| !way.is_default && fork.is_none_or(|fork| way.fork == *fork));
    // the way that it is longer by when it leads over the place
    let detour_m = |line: &Line| {
        line.from.distance_m(spot.position) + spot.position.distance_m(line.to)
            - line.from.distance_m(line.to)
    };
    ways.flat_map(|way| &way.lines).min_by(|a, b| detour_m(a).total_cmp(&detour_m(b)))
}

/// A cross where the path ends too early, and one where the plan is wrong. `error_at`: where that is; `others`: where else.
pub fn draw_failures(
    painter: &Painter,
    view: &View,
    scene: &Scene<'_>,
    (error_at, others): (Option<LatLon>, &[LatLon]),
    names: &mut Names,
    p: &Palette,
) {
    others.iter().for_each(|at| cross(painter, view.place(*at), p.warning, p));
    let end = scene.forecast().points.last().zip(scene.forecast().cut_short.as_ref());
    if let Some((end, why)) = end.filter(|_| scene.analysis.no_forecast.is_none()) {
        failure(painter, view.place(end.position), why, names, p);
    }
    // what has no place of its own is wrong where the path ends
    let ends = scene.forecast().points.last().filter(|_| scene.forecast().is_beginning);
    if let Some((problem, at)) = first_error(scene).zip(error_at.or(ends.map(|end| end.position))) {
        let why = scene.document.plan().in_names(&problem.message);
        failure(painter, view.place(at), &why, names, p);
    }
}

/// Where a problem is, as something that can be found on the map.
pub fn selection_of(problem: &Problem, scene: &Scene<'_>) -> Option<crate::command::Selection> {
    problems::find(scene.document, problem.subject.as_ref()?)
}

fn failure(painter: &Painter, at: Pos2, why: &str, names: &mut Names, p: &Palette) {
    cross(painter, at, p.warning, p);
    ask_words(painter, at, shortened(why), names, p);
}

/// Below the name of what is there.
fn ask_words(painter: &Painter, at: Pos2, text: String, names: &mut Names, p: &Palette) {
    let (rank, spots) = (Rank::Fault, names::corners(at, vec2(8.0, 9.0)));
    names.ask(painter, Name { rank, spots, text, size: 11.5, colour: p.text, ground: Ground::Plate });
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

/// The way out after the alarm: after an engine failure the glide, else the alternate; and fainter the other one.
pub fn draw_diversion(painter: &Painter, view: &View, scene: &Scene<'_>, names: &mut Names, p: &Palette) {
    let Some(found) = scene.diversion() else { return };
    let [chosen, other] = found.ways().map(|way| Vec::from_iter(way.iter().map(|point| point.position)));
    way(painter, view, &other, (Stroke::new(1.2, p.weak), Style::Dashed), p);
    way(painter, view, &chosen, way_out(found, p), p);
    if let Some(end) = chosen.last() {
        let at = view.place(*end);
        if !reaches(found) {
            cross(painter, at, p.warning, p);
        }
        ask_words(painter, at, label(found, scene.document.plan()), names, p);
    }
}

/// As the legend has it: white dashes are a glide.
fn way_out(found: &Diversion, p: &Palette) -> (Stroke, Style) {
    match found.glided {
        Some(_) => (Stroke::new(2.6, p.text), Style::Dashed),
        None => (Stroke::new(3.0, p.contingency), Style::Dotted),
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

fn way(painter: &Painter, view: &View, places: &[LatLon], (stroke, style): (Stroke, Style), p: &Palette) {
    let line: Vec<Mercator> = places.iter().map(|at| (*at).into()).collect();
    polyline::draw(painter, &polyline::visible_parts(&line, view), stroke, style, p.halo);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The close look leads through a zone; what is flown without a decision does not.
    #[test]
    fn the_piece_of_the_branch_that_is_wrong_is_found() {
        let plan = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><mainPlan><stage id="m" type="mission">
            <TF id="a" lat="46.0" lon="9.0"/>
            <intersection id="f" default="on"><branch id="on" next="z"/><branch id="close" next="look"/></intersection>
            <TF id="look" lat="46.1" lon="9.1"/><TF id="z" lat="46.2" lon="9.0"/></stage></mainPlan></flightPlan>"#;
        let plan = flight_plan::read(plan).plan;
        let sketch = Sketch::new(&plan, &flight_plan::Variables::initial(&plan), &Sketch::default());
        let at = LatLon::new;
        let found = |lat, lon, fork: &str| {
            let branch = Some((fork.into(), "close".into()));
            let line = piece(&sketch.ways, &FlownAt { position: at(lat, lon), is_off_plan: true, branch })?;
            Some((line.from, line.to))
        };
        assert_eq!(found(46.05, 9.05, "f"), Some((at(46.0, 9.0), at(46.1, 9.1))));
        assert_eq!(
            found(46.15, 9.05, "f"),
            Some((at(46.1, 9.1), at(46.2, 9.0))),
            "back to the default's way"
        );
        assert_eq!(found(46.05, 9.05, "another"), None);
    }

    #[test]
    fn a_long_reason_is_shortened_between_characters() {
        assert_eq!(shortened("short"), "short");
        let long = shortened(&"ü".repeat(LONGEST + 5));
        assert_eq!(long.chars().count(), LONGEST + 1);
        assert!(long.ends_with('…'));
    }
}
