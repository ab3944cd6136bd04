//! What lies over the map on request: lines of latitude and longitude, and rings of equal distance.

use super::names::{Ground, Name, Rank, Spot};
use super::sheet::Sheet;
use crate::theme::Palette;
use crate::units::{Unit, Units};
use egui::{Align2, Color32, Pos2, Shape, Stroke, pos2};
use geometry::LatLon;

/// Between two lines, screen points at least.
const APART: f64 = 90.0;
/// Steps of the graticule, seconds of arc.
const STEPS_S: [f64; 16] = [
    1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1200.0, 1800.0, 3600.0, 7200.0, 18_000.0,
    36_000.0,
];
/// So many rings.
const RINGS: u32 = 5;
/// Clear of the tools at the left edge, screen points.
const TOOLS: f32 = 50.0;

/// Lines of latitude and longitude, with their numbers at the edges.
pub fn draw(sheet: &Sheet<'_>) {
    let Sheet { painter, view, p, .. } = *sheet;
    let step_s = step_s(view.degrees_per_point());
    let stroke = Stroke::new(1.0, faint(p));
    let (from, to) = (view.geo(view.rect.left_bottom()), view.geo(view.rect.right_top()));
    for lon_s in lines(from.lon_deg.max(-180.0), to.lon_deg.min(180.0), step_s) {
        let x = view.place(LatLon::new(0.0, lon_s / 3600.0)).x;
        painter.vline(x, view.rect.y_range(), stroke);
        let name = arc(lon_s, step_s, ['E', 'W']);
        // the next one where something else lies on the edge
        let from_top = |y: f32| (pos2(x, view.rect.top() + y), Align2::CENTER_TOP);
        ask(sheet, [2.0, 18.0, 34.0, 50.0].map(from_top), name, p.text);
    }
    for lat_s in lines(from.lat_deg, to.lat_deg, step_s) {
        let y = view.place(LatLon::new(lat_s / 3600.0, 0.0)).y;
        painter.hline(view.rect.x_range(), y, stroke);
        let name = arc(lat_s, step_s, ['N', 'S']);
        let from_left = |x: f32| (pos2(view.rect.left() + TOOLS + x, y), Align2::LEFT_CENTER);
        ask(sheet, [0.0, 44.0, 96.0, 140.0].map(from_left), name, p.text);
    }
}

/// Asks for a number of the grid.
fn ask(sheet: &Sheet<'_>, spots: [Spot; 4], text: String, colour: Color32) {
    sheet.ask(Name { rank: Rank::Grid, spots, text, size: 10.0, colour, ground: Ground::Halo });
}

fn faint(p: &Palette) -> Color32 {
    p.weak.gamma_multiply(0.45)
}

/// The smallest step whose lines are far enough apart.
fn step_s(degrees_per_point: f64) -> f64 {
    let least_s = APART * degrees_per_point * 3600.0;
    STEPS_S.into_iter().find(|step| *step >= least_s).unwrap_or(30.0 * 3600.0)
}

/// Multiples of the step between two angles in degrees, seconds of arc; never more than a screen has room for.
fn lines(from_deg: f64, to_deg: f64, step_s: f64) -> impl Iterator<Item = f64> {
    let first = (from_deg * 3600.0 / step_s).ceil();
    let last = (to_deg * 3600.0 / step_s).floor();
    (0..200).map(move |i| first + f64::from(i)).take_while(move |n| *n <= last).map(move |n| n * step_s)
}

/// `36°20′30″ N`, as fine as the step is.
fn arc(seconds: f64, step_s: f64, [plus, minus]: [char; 2]) -> String {
    let all = seconds.abs().round() as u64;
    let (degrees, minutes, rest) = (all / 3600, all / 60 % 60, all % 60);
    let angle = match step_s {
        s if s < 60.0 => format!("{degrees}°{minutes:02}′{rest:02}″"),
        s if s < 3600.0 => format!("{degrees}°{minutes:02}′"),
        _ => format!("{degrees}°"),
    };
    match seconds {
        0.0 => angle,
        s if s > 0.0 => format!("{angle} {plus}"),
        _ => format!("{angle} {minus}"),
    }
}

/// Rings of equal distance around the aircraft, or else around the runway of departure.
pub fn draw_rings(sheet: &Sheet<'_>) {
    let Sheet { painter, view, scene, p, .. } = *sheet;
    let aircraft = scene.vehicle.position.as_ref().map(|position| position.value.position);
    let Some(middle) = aircraft.or_else(|| scene.document.plan().home().map(|runway| runway.threshold))
    else {
        return;
    };
    let (unit, step) = round_length(scene.units(), 70.0 / view.points_per_metre(), Round::Up);
    for ring in 1..=RINGS {
        let radius_m = unit.to_si(step * f64::from(ring));
        // beyond a quarter of the Earth a ring is none on the map
        if radius_m > 5e6 {
            return;
        }
        let at = |bearing: f64| view.place(middle.destination(bearing, radius_m));
        let line: Vec<Pos2> = (0..72).map(|i| at(f64::from(i) * 5.0)).collect();
        painter.add(Shape::closed_line(line, Stroke::new(1.0, p.text.gamma_multiply(0.5))));
        let name = format!("{} {}", step * f64::from(ring), unit.symbol);
        let towards = |bearing: f64| (at(bearing), Align2::CENTER_CENTER);
        ask(sheet, [0.0, 90.0, 180.0, 270.0].map(towards), name, p.text);
    }
}

/// Which way a length becomes round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Round {
    /// At least as long.
    Up,
    /// At most as long.
    Down,
}

/// A unit and a round number of it near a length: 1, 2 or 5 with zeros. Short lengths are in the smaller unit.
pub fn round_length(units: Units, metres: f64, round: Round) -> (Unit, f64) {
    let long = units.distance();
    let unit = if long.from_si(metres) < 1.0 { units.length() } else { long };
    let number = unit.from_si(metres).max(1e-9);
    let decade = 10f64.powf(number.log10().floor());
    let digits = number / decade;
    let round = match round {
        Round::Up => [1.0, 2.0, 5.0, 10.0].into_iter().find(|k| *k >= digits - 1e-9),
        Round::Down => [5.0, 2.0, 1.0].into_iter().find(|k| *k <= digits + 1e-9),
    };
    (unit, round.unwrap_or(1.0) * decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_and_names_follow_the_scale() {
        assert_eq!(step_s(0.1), 36_000.0);
        assert_eq!(step_s(1e-4), 60.0);
        assert_eq!(arc(36.0 * 3600.0 + 20.0 * 60.0, 600.0, ['N', 'S']), "36°20′ N");
        assert_eq!(arc(-(84.0 * 3600.0 + 630.0), 30.0, ['E', 'W']), "84°10′30″ W");
        assert_eq!(arc(0.0, 3600.0, ['E', 'W']), "0°");
        assert_eq!(lines(-0.6, 1.2, 1800.0).collect::<Vec<_>>(), [-1800.0, 0.0, 1800.0, 3600.0]);
        assert_eq!(lines(f64::NAN, 1.0, 60.0).count(), 0);
    }

    #[test]
    fn lengths_are_round_and_short_ones_in_the_smaller_unit() {
        for (units, metres, expected) in [
            (Units::Si, 740.0, (500.0, "m")),
            (Units::Si, 3_700.0, (2.0, "km")),
            (Units::Si, 1.3, (1.0, "m")),
            (Units::Aviation, 740.0, (2000.0, "ft")),
            (Units::Aviation, 9_500.0, (5.0, "NM")),
        ] {
            let (unit, number) = round_length(units, metres, Round::Down);
            assert_eq!((number, unit.symbol), expected);
        }
        assert_eq!(round_length(Units::Si, 740.0, Round::Up).1, 1000.0);
    }
}
