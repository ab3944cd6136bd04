//! What is seen on the pictures that are taken along legs: a footprint for each, and how much of it the next one shows again.

use super::sketch::Sketch;
use super::sketch::photos::{Photos, USUAL_ACROSS_DEG};
use super::text;
use super::view::View;
use crate::command::Selection;
use crate::forecast::Point;
use crate::panels::Scene;
use crate::theme::Palette;
use crate::units::Units;
use egui::{Align2, Painter, Pos2, Shape, Stroke, vec2};
use geometry::LatLon;

/// A picture is as long as this share of its width: 4 to 3, its long side across the track.
const LONG: f64 = 0.75;
/// Most footprints that are drawn.
const MOST: usize = 600;
/// Smaller ones could not be told apart, screen points: of a selected leg, and of others.
const LEAST: [f64; 2] = [5.0, 60.0];

/// One picture on the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Footprint {
    at: LatLon,
    track_deg: f64,
    width_m: f64,
}

impl Footprint {
    fn corners(&self) -> [LatLon; 4] {
        let (along_m, across_m) = (self.width_m * LONG / 2.0, self.width_m / 2.0);
        [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)].map(|(along, across)| {
            let ahead = self.at.destination(self.track_deg, along_m * along);
            ahead.destination(self.track_deg + 90.0, across_m * across)
        })
    }
}

/// Draws them, where they are large enough to be seen.
pub fn draw(painter: &Painter, view: &View, sketch: &Sketch, scene: &Scene<'_>, p: &Palette) {
    let mut left = MOST;
    for photos in &sketch.photos {
        let selected = scene.is_selected(&Selection::Leg(photos.leg.clone()));
        let least = if selected { LEAST[0] } else { LEAST[1] };
        let mut first = None;
        for part in scene.forecast().passages_of(&photos.leg) {
            for footprint in along(part, photos) {
                let is_seen = footprint.width_m * view.points_per_metre() > least;
                if left == 0 || !is_seen || !view.is_near(view.place(footprint.at)) {
                    continue;
                }
                left -= 1;
                first = first.or(Some(footprint));
                paint(painter, view, &footprint, selected, p);
            }
        }
        if let Some(footprint) = first.filter(|_| selected) {
            let (words, is_covered) = words(photos, &footprint, scene.units());
            let colour = if is_covered { p.text } else { p.caution };
            let at = view.place(footprint.at) + vec2(14.0, 14.0);
            text::haloed(painter, at, Align2::LEFT_TOP, &words, 12.0, colour, p);
        }
    }
}

fn paint(painter: &Painter, view: &View, footprint: &Footprint, selected: bool, p: &Palette) {
    let corners: Vec<Pos2> = footprint.corners().iter().map(|at| view.place(*at)).collect();
    let fill = p.accent.gamma_multiply(if selected { 0.04 } else { 0.02 });
    let stroke = Stroke::new(if selected { 1.2 } else { 0.7 }, p.accent.gamma_multiply(0.8));
    painter.add(Shape::convex_polygon(corners, fill, stroke));
}

/// The pictures of one passage of a leg; those over ground of which no elevation is known are left out.
fn along<'a>(part: &'a [Point], photos: &'a Photos) -> impl Iterator<Item = Footprint> + 'a {
    let begin_m = part.first().map_or(0.0, |point| point.distance_m) + photos.from_m;
    let half_rad = (photos.across_deg.unwrap_or(USUAL_ACROSS_DEG) / 2.0).to_radians();
    part.windows(2).flat_map(move |ends| {
        let [from, to] = [&ends[0], &ends[1]];
        let before = ((from.distance_m - begin_m) / photos.every_m).ceil().max(0.0);
        let track_deg = from.position.bearing_deg(to.position);
        (0..MOST)
            .map(move |i| begin_m + (before + i as f64) * photos.every_m)
            .take_while(|m| *m < to.distance_m)
            .filter_map(move |at_m| {
                let share = (at_m - from.distance_m) / (to.distance_m - from.distance_m).max(1e-6);
                let height_m = from.altitude_amsl_m - from.ground_amsl_m?;
                let width_m = 2.0 * height_m * half_rad.tan();
                let at = from.position.interpolate(to.position, share.clamp(0.0, 1.0));
                (width_m > 0.0).then_some(Footprint { at, track_deg, width_m })
            })
    })
}

/// `Picture every 80 m: 173 × 130 m, 38 % overlap`; false: there are gaps between them.
fn words(photos: &Photos, footprint: &Footprint, units: Units) -> (String, bool) {
    let unit = units.length();
    let long_m = footprint.width_m * LONG;
    let overlap = 1.0 - photos.every_m / long_m;
    let shown = match overlap >= 0.0 {
        true => format!("{:.0} % overlap", overlap * 100.0),
        false => format!("gaps of {}", unit.show(photos.every_m - long_m)),
    };
    let camera = match photos.across_deg {
        Some(_) => String::new(),
        None => format!(" (camera taken as {USUAL_ACROSS_DEG:.0}°, 4:3)"),
    };
    let (every, width, long) = (unit.show(photos.every_m), unit.number(footprint.width_m), unit.show(long_m));
    (format!("Picture every {every}: {width} × {long}, {shown}{camera}"), overlap >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn photos(every_m: f64, from_m: f64) -> Photos {
        Photos { leg: "a".into(), every_m, from_m, across_deg: Some(90.0) }
    }

    /// 1000 m to the east, 100 m above the ground, a point each 200 m.
    fn part() -> Vec<Point> {
        let from = LatLon::new(46.0, 8.0);
        let point = |i: u32| Point {
            time_s: f64::from(i) * 10.0,
            distance_m: 500.0 + f64::from(i) * 200.0,
            position: from.destination(90.0, f64::from(i) * 200.0),
            altitude_amsl_m: 600.0,
            ground_amsl_m: Some(500.0),
            passage: 0,
        };
        (0..=5).map(point).collect()
    }

    #[test]
    fn pictures_lie_along_the_path_at_equal_distances() {
        let part = part();
        for (every_m, from_m, expected) in
            [(300.0, 300.0, 3), (300.0, 0.0, 4), (90.0, 90.0, 11), (5000.0, 5000.0, 0)]
        {
            let photos = photos(every_m, from_m);
            let found: Vec<Footprint> = along(&part, &photos).collect();
            assert_eq!(found.len(), expected, "{every_m} {from_m}");
            for pair in found.windows(2) {
                assert!((pair[0].at.distance_m(pair[1].at) - every_m).abs() < 0.5);
            }
            assert!(
                found.iter().all(|f| (f.width_m - 200.0).abs() < 1e-6 && (f.track_deg - 90.0).abs() < 0.1)
            );
        }
    }

    #[test]
    fn overlap_and_gaps_are_said() {
        let footprint = Footprint { at: LatLon::new(46.0, 8.0), track_deg: 0.0, width_m: 200.0 };
        let (text, covered) = words(&photos(60.0, 0.0), &footprint, Units::Si);
        assert!(covered && text.contains("60 % overlap") && text.contains("200 × 150 m"), "{text}");
        let (text, covered) = words(&photos(200.0, 0.0), &footprint, Units::Si);
        assert!(!covered && text.contains("gaps of 50 m"), "{text}");
    }
}
