//! Marks on the path: where a preview ends early, where a plan is wrong, and the way out after an alarm.

use super::names::{self, Ground, Name, Rank, Spot};
use super::polyline::Style;
use super::reveal::place_or_begin;
use super::sheet::Sheet;
use super::sketch::{Line, Way};
use crate::panels::what_if::reach_name;
use crate::panels::{Scene, problems};
use crate::theme::Palette;
use egui::{Pos2, Shape, Stroke, vec2};
use flight_exec::rehearse::Diversion;
use flight_exec::review::Margins;
use flight_plan::{FlownAt, Id, Problem};
use geometry::LatLon;
use std::collections::HashSet;

/// Longest text beside a mark, characters.
const LONGEST: usize = 110;

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
fn draw_off_plan(sheet: &Sheet<'_>) {
    let errors = sheet.scene.problems().filter(|problem| problem.is_error() && problem.is_off_plan());
    for spot in errors.filter_map(|problem| problem.place.as_deref()).take(MOST) {
        if let Some(line) = piece(&sheet.sketch.ways, spot) {
            sheet.line([line.from, line.to], Stroke::new(3.2, sheet.p.warning), Style::Dashed);
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

/// What is wrong with the plan, where it is.
pub fn draw_faults(sheet: &Sheet<'_>) {
    draw_off_plan(sheet);
    let others = off_path(sheet.scene).filter_map(|problem| place_of_problem(problem, sheet));
    others.for_each(|at| cross(sheet, sheet.place(at)));
    draw_failures(sheet);
}

/// Where something is wrong: the place that is named, or else where that is, or begins, whose problem it is. `None`: nowhere, as
/// what goes through a number that could not be read.
fn place_of_problem(problem: &Problem, sheet: &Sheet<'_>) -> Option<LatLon> {
    let Sheet { sketch, scene, .. } = *sheet;
    let at = match &problem.place {
        Some(spot) => Some(spot.position),
        None => place_or_begin(&selection_of(problem, scene)?, scene.document.plan(), sketch),
    };
    at.filter(|at| at.is_valid())
}

/// A cross where the path ends too early, and one where the plan is wrong.
fn draw_failures(sheet: &Sheet<'_>) {
    let scene = sheet.scene;
    let end = scene.forecast().points.last().zip(scene.forecast().cut_short.as_ref());
    if let Some((end, why)) = end.filter(|_| scene.analysis.no_forecast.is_none()) {
        failure(sheet, end.position, why);
    }
    let wrong = first_error(scene).and_then(|problem| Some((problem, place_of_problem(problem, sheet)?)));
    if let Some((problem, at)) = wrong {
        failure(sheet, at, &scene.document.plan().in_names(&problem.message));
    }
}

/// Where a problem is, as something that can be found on the map.
pub fn selection_of(problem: &Problem, scene: &Scene<'_>) -> Option<crate::command::Selection> {
    problems::find(scene.document, problem.subject.as_ref()?)
}

fn failure(sheet: &Sheet<'_>, at: LatLon, why: &str) {
    let at = sheet.place(at);
    cross(sheet, at);
    ask_words(sheet, at, shortened(why));
}

/// Below the name of what is there.
fn ask_words(sheet: &Sheet<'_>, at: Pos2, text: String) {
    let (rank, spots, colour) = (Rank::Fault, names::corners(at, vec2(8.0, 9.0)), sheet.p.text);
    sheet.ask(Name { rank, spots, text, size: 11.5, colour, ground: Ground::Plate });
}

fn cross(sheet: &Sheet<'_>, at: Pos2) {
    let Sheet { painter, p, .. } = *sheet;
    let colour = p.warning;
    painter.circle(at, 9.0, p.halo, Stroke::new(2.0, colour));
    for d in [vec2(1.0, 1.0), vec2(1.0, -1.0)] {
        painter.add(Shape::line_segment([at - d * 4.0, at + d * 4.0], Stroke::new(2.5, colour)));
    }
}

/// The beginning of a text that is too long to stand beside a mark.
pub fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}

/// The way out after the alarm: after an engine failure the glide, else the alternate; and fainter the other one.
pub fn draw_diversion(sheet: &Sheet<'_>) {
    let Sheet { scene, p, .. } = *sheet;
    let Some(found) = scene.diversion() else { return };
    let [chosen, other] = found.ways().map(|way| Vec::from_iter(way.iter().map(|point| point.position)));
    let (stroke, style) = way_out(found, p);
    sheet.line(other, Stroke::new(1.2, p.weak), Style::Dashed);
    sheet.line(chosen.iter().copied(), stroke, style);
    if let Some(end) = chosen.last() {
        let at = sheet.place(*end);
        if !reaches(found) {
            cross(sheet, at);
        }
        let way: Vec<Pos2> = chosen.iter().map(|at| sheet.place(*at)).collect();
        let (rank, spots, colour) = (Rank::Fault, spots_beyond(&way, at), sheet.p.text);
        sheet.ask(Name { rank, spots, text: label(found), size: 11.5, colour, ground: Ground::Plate });
    }
}

/// A way says where it comes from by its last piece that is so long, screen points.
const PIECE: f32 = 24.0;

/// Beside the end of a way, where it would go on first: words lie on no way that they tell of.
fn spots_beyond(way: &[Pos2], end: Pos2) -> [Spot; 4] {
    let from = way.iter().rev().find(|at| at.distance(end) > PIECE).or(way.first());
    let course = from.map_or(vec2(0.0, 0.0), |from| end - *from);
    let mut spots = names::corners(end, vec2(8.0, 9.0));
    let ahead = |(at, _): &Spot| (*at - end).dot(course);
    spots.sort_by(|a, b| ahead(b).total_cmp(&ahead(a)));
    spots
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

/// `R05: just reached`; after which alarm is said in the map's corner, all else in the panel.
fn label(found: &Diversion) -> String {
    let margins = Margins::default();
    let reach = reach_name(found.reach(margins.glide_m, margins.energy_share));
    let runway = found.plan.as_ref().map_or("no plan", |(_, runway)| runway.as_str());
    format!("{runway}: {reach}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::sketch::Sketch;

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
    fn the_words_of_a_way_out_lie_beyond_its_end() {
        let end = egui::pos2(100.0, 100.0);
        for (from, beyond) in [
            (vec2(-90.0, -80.0), vec2(8.0, 9.0)),
            (vec2(90.0, -80.0), vec2(-8.0, 9.0)),
            (vec2(60.0, 90.0), vec2(-8.0, -9.0)),
        ] {
            let (at, _) = spots_beyond(&[end + from, end + vec2(1.0, 0.0), end], end)[0];
            assert_eq!(at, end + beyond, "it comes from {from}");
        }
    }

    #[test]
    fn a_long_reason_is_shortened_between_characters() {
        assert_eq!(shortened("short"), "short");
        let long = shortened(&"ü".repeat(LONGEST + 5));
        assert_eq!(long.chars().count(), LONGEST + 1);
        assert!(long.ends_with('…'));
    }
}
