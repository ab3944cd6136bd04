//! How alarms would end, as the look of a path: the style says as much as the colour.

use super::polyline::Style;
use crate::forecast::{Coverage, Point};
use crate::panels::what_if::reach_name;
use crate::theme::{self, Palette};
use egui::{Label, Painter, Pos2, RichText, Sense, Shape, Stroke, Ui, vec2};
use flight_exec::rehearse::Reach;
use flight_plan::Cause;

/// All of them, the best first.
const REACHES: [Reach; 3] = [Reach::Good, Reach::Tight, Reach::Out];

/// How a part of the path looks; `None`: not judged.
pub fn look(reach: Option<Reach>, p: &Palette) -> (Stroke, Style) {
    match reach {
        Some(Reach::Good) => (Stroke::new(2.4, p.good), Style::Solid),
        Some(Reach::Tight) => (Stroke::new(2.8, p.caution), Style::Dashed),
        Some(Reach::Out) => (Stroke::new(3.4, p.warning), Style::Dotted),
        None => (Stroke::new(1.4, p.weak), Style::Solid),
    }
}

/// The path in parts that end alike, each with the first point of the next so that the line has no gap.
pub fn parts<'a>(points: &'a [Point], coverage: &Coverage) -> Vec<(Option<Reach>, &'a [Point])> {
    let reach = |point: &Point| coverage.at(point.time_s).map(|ending| ending.reach);
    let reaches: Vec<Option<Reach>> = points.iter().map(reach).collect();
    let mut first = 0;
    let parts = reaches.chunk_by(|a, b| a == b).filter_map(|same| {
        let end = first + same.len();
        let with_next = points.get(first..(end + 1).min(points.len()));
        first = end;
        same.first().copied().zip(with_next)
    });
    parts.collect()
}

/// A line of some look, in a picture without a halo.
pub fn line(painter: &Painter, path: &[Pos2], (stroke, style): (Stroke, Style)) {
    match style {
        Style::Solid | Style::Double => drop(painter.add(Shape::line(path.to_vec(), stroke))),
        Style::Dashed => painter.extend(Shape::dashed_line(path, stroke, 9.0, 6.0)),
        Style::Dotted => painter.extend(Shape::dotted_line(path, stroke.color, 6.0, stroke.width * 0.75)),
    }
}

/// What the looks mean, and on how much of the path once all of it is worked out: shares of a few points would say nothing of it.
pub fn legend(ui: &mut Ui, coverage: &Coverage) {
    let p = theme::of(ui);
    // nothing there is clicked: rows hardly higher than their text
    ui.spacing_mut().item_spacing.y = 1.0;
    ui.spacing_mut().interact_size.y = 14.0;
    for reach in REACHES {
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(34.0, 12.0), Sense::hover());
            let ends = [rect.left_center(), rect.right_center()];
            line(ui.painter(), &ends, look(Some(reach), p));
            ui.add(Label::new(RichText::new(words(coverage, reach)).size(11.5).color(p.text)).wrap());
        });
    }
}

/// `not reached: 10 % (engine failure), all of it on departure and approach`: there no problem is told of it, for nothing helps.
fn words(coverage: &Coverage, reach: Reach) -> String {
    if !coverage.is_complete() {
        return reach_name(reach).into();
    }
    let share = coverage.share(reach);
    let percent = percents(REACHES.map(|reach| coverage.share(reach)));
    let percent = REACHES.iter().zip(percent).find(|(of, _)| **of == reach).map_or(0, |(_, percent)| percent);
    let (near, kinds) = coverage.near_runway(reach);
    let of_all = format!("{}: {percent} %", reach_name(reach));
    let causes: Vec<String> = coverage.causes(reach).into_iter().map(in_text).collect();
    if reach == Reach::Good || causes.is_empty() {
        return of_all;
    }
    let of_all = format!("{of_all} ({})", in_a_row(&causes));
    if kinds.is_empty() {
        return of_all;
    }
    let names: Vec<String> = kinds.into_iter().map(|kind| kind.name().to_lowercase()).collect();
    let (names, elsewhere) = (in_a_row(&names), share - near);
    match elsewhere > 1e-9 {
        true => format!("{of_all}, {:.0} % of it not on {names}", 100.0 * elsewhere / share),
        false => format!("{of_all}, all of it on {names}"),
    }
}

/// Shares that are all there is as whole percentages that sum to 100: rounded down, and what is left goes to those that lost most.
fn percents(shares: [f64; 3]) -> [u32; 3] {
    let exact = shares.map(|share| share.clamp(0.0, 1.0) * 100.0);
    let mut whole = exact.map(|percent| (percent + EXACT).floor() as u32);
    let mut lost: Vec<usize> = (0..exact.len()).collect();
    lost.sort_by(|a, b| (exact[*b] - f64::from(whole[*b])).total_cmp(&(exact[*a] - f64::from(whole[*a]))));
    let all = exact.iter().sum::<f64>().round() as usize;
    let left = all.saturating_sub(whole.iter().sum::<u32>() as usize);
    for index in lost.into_iter().take(left) {
        whole[index] += 1;
    }
    whole
}

/// What a sum of shares may be off, percent.
const EXACT: f64 = 1e-9;

/// What an alarm is called inside of a sentence: `engine failure`, `GPS lost`.
fn in_text(cause: Cause) -> String {
    let name = cause.name();
    let is_word = name.chars().nth(1).is_some_and(char::is_lowercase);
    if is_word { name.to_lowercase() } else { name.to_owned() }
}

/// `departure, arrival and approach`.
fn in_a_row(names: &[String]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => names.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forecast::Ending;
    use crate::forecast::Forecast;
    use flight_plan::StageKind;

    fn point(time_s: f64) -> Point {
        Point {
            time_s,
            distance_m: 0.0,
            position: geometry::LatLon::new(0.0, time_s * 1e-4),
            altitude_amsl_m: 0.0,
            ground_amsl_m: None,
            passage: 0,
        }
    }

    #[test]
    fn percentages_sum_to_a_hundred() {
        for (shares, expected) in [
            ([0.934, 0.014, 0.052], [94, 1, 5]),
            ([1.0, 0.0, 0.0], [100, 0, 0]),
            ([1.0 / 3.0; 3], [34, 33, 33]),
            ([0.935, 0.006, 0.059], [93, 1, 6]),
        ] {
            assert_eq!(percents(shares), expected);
        }
    }

    fn out(stage: StageKind) -> Option<Ending> {
        Some(Ending { reach: Reach::Out, cause: Cause::Engine, stage })
    }

    /// A green plan showed a path that is partly red, and nobody said why.
    #[test]
    fn what_is_out_of_reach_near_the_runway_is_said_apart() {
        let said = |endings: [Option<Ending>; 4]| {
            let points = vec![point(0.0), point(19.0)];
            let mut coverage = Coverage::of(&Forecast { points, ..Forecast::default() });
            endings.into_iter().for_each(|ending| coverage.push(ending));
            words(&coverage, Reach::Out)
        };
        let good = |stage| Some(Ending { reach: Reach::Good, cause: Cause::Link, stage });
        let (mission, leaves, comes) = (StageKind::Mission, StageKind::Departure, StageKind::Approach);
        assert_eq!(said([good(mission), None, good(comes), good(leaves)]), "not reached: 0 %");
        let all = said([good(mission), out(leaves), out(comes), good(mission)]);
        assert_eq!(all, "not reached: 50 % (engine failure), all of it on departure and approach");
        let some = said([out(mission), out(leaves), out(comes), out(StageKind::Arrival)]);
        assert_eq!(
            some,
            "not reached: 100 % (engine failure), 25 % of it not on departure, arrival and approach"
        );
        assert_eq!(said([out(mission); 4]), "not reached: 100 % (engine failure)");
        let link = Some(Ending { reach: Reach::Out, cause: Cause::Link, stage: leaves });
        assert_eq!(said([link; 4]), "not reached: 100 % (link lost)", "that is no engine failure");
        let gps = Some(Ending { reach: Reach::Out, cause: Cause::Gps, stage: leaves });
        assert_eq!(said([gps, link, gps, gps]), "not reached: 100 % (GPS lost and link lost)");
    }

    #[test]
    fn shares_are_said_when_all_is_worked_out() {
        let points = vec![point(0.0), point(19.0)];
        let mut coverage = Coverage::of(&Forecast { points, ..Forecast::default() });
        while !coverage.is_complete() {
            assert_eq!(words(&coverage, Reach::Out), "not reached");
            coverage.push(out(StageKind::Mission));
        }
        assert_eq!(words(&coverage, Reach::Out), "not reached: 100 % (engine failure)");
    }

    #[test]
    fn the_path_falls_into_parts_without_gaps() {
        let points: Vec<Point> = (0..16).map(|n| point(f64::from(n))).collect();
        let mut coverage = Coverage::of(&Forecast { points: points.clone(), ..Forecast::default() });
        // three points: the first, then the last
        coverage.push(None);
        coverage.push(out(StageKind::Mission));
        let parts = parts(&points, &coverage);
        let found: Vec<_> = parts.iter().map(|(reach, part)| (*reach, part.len())).collect();
        assert_eq!(found, [(None, 11), (Some(Reach::Out), 6)]);
        for pair in parts.windows(2) {
            assert_eq!(pair[0].1.last(), pair[1].1.first());
        }
        let p = theme::palette(true);
        let looks = REACHES.map(|reach| look(Some(reach), p));
        assert!(looks[0].1 != looks[1].1 && looks[1].1 != looks[2].1 && looks[0].1 != looks[2].1);
    }
}
