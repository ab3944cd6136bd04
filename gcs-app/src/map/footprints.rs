//! What is seen on the pictures that are taken along legs: a footprint for each, and how much of it the next one shows again.

use super::names::{self, Ground, Name, Rank};
use super::sheet::Sheet;
use super::sketch::photos::{Photos, Spot};
use crate::command::Selection;
use crate::forecast::{Forecast, Point};
use crate::panels::Scene;
use crate::units::Units;
use egui::{Pos2, Shape, Stroke, vec2};
use flight_plan::template::USUAL_ACROSS_DEG;
use flight_plan::{Act, Edit, Id, Leg, LegAction, Trigger, Value};
use geometry::LatLon;
use std::collections::HashMap;

/// A picture is as long as this share of its width: 4 to 3, its long side across the track.
const LONG: f64 = 0.75;
/// Most footprints that are drawn.
const MOST: usize = 600;
/// Smaller ones could not be told apart, screen points: of a selected leg, and of others.
const LEAST: [f64; 2] = [5.0, 60.0];

/// Pictures that are taken from the map have so much in common with the next.
const OVERLAP: f64 = 0.6;
/// Metres between pictures: at least, and where it is not known how high they are taken.
const EVERY_M: [f64; 2] = [5.0, 50.0];

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

/// The edit that lets a leg take pictures all along it, overlapping at its least height above the ground; of a leg that takes some, the
/// one that ends that. True: it takes some.
pub fn toggled(scene: &Scene<'_>, leg: &Leg) -> (bool, Edit) {
    let is_picture = |action: &LegAction| {
        matches!(
            (&action.trigger, &action.act),
            (Trigger::Every(_), Act::Photo) | (_, Act::PhotoSeries { .. })
        )
    };
    let mut actions = leg.actions.clone();
    actions.retain(|action| !is_picture(action));
    let takes = actions.len() < leg.actions.len();
    if !takes {
        let every_m = Value::Constant(every_m(scene.forecast(), &leg.id));
        actions.push(LegAction { trigger: Trigger::Every(every_m), act: Act::Photo });
    }
    (takes, Edit::SetActions { leg: leg.id.clone(), actions })
}

/// Whole metres between pictures of a leg.
fn every_m(forecast: &Forecast, leg: &Id) -> f64 {
    let passages = forecast.passages.iter().filter(|passage| passage.leg == *leg);
    let height_m = passages.filter_map(|passage| passage.clearance_m).reduce(f64::min);
    let [least_m, usual_m] = EVERY_M;
    height_m.map_or(usual_m, |height_m| {
        let long_m = 2.0 * height_m * (USUAL_ACROSS_DEG / 2.0).to_radians().tan() * LONG;
        (long_m * (1.0 - OVERLAP)).round().max(least_m)
    })
}

/// Draws them, where they are large enough to be seen.
pub fn draw(sheet: &Sheet<'_>) {
    let Sheet { view, sketch, scene, p, .. } = *sheet;
    let mut left = MOST;
    for photos in &sketch.photos {
        let selected = scene.is_selected(&Selection::Leg(photos.leg.clone()));
        let least = if selected { LEAST[0] } else { LEAST[1] };
        let mut first = None;
        for stretch in stretches(scene.forecast(), photos, &sketch.photo_ends) {
            for footprint in along(&stretch, photos) {
                let is_seen = footprint.width_m * view.points_per_metre() > least;
                if left == 0 || !is_seen || !view.is_near(view.place(footprint.at)) {
                    continue;
                }
                left -= 1;
                first = first.or(Some(footprint));
                paint(sheet, &footprint, selected);
            }
        }
        if let Some(footprint) = first.filter(|_| selected) {
            let (text, is_covered) = words(photos, &footprint, scene.units());
            let colour = if is_covered { p.text } else { p.caution };
            let (rank, spots) = (Rank::Selected, names::corners(view.place(footprint.at), vec2(14.0, 14.0)));
            sheet.ask(Name { rank, spots, text, size: 12.0, colour, ground: Ground::Halo });
        }
    }
}

fn paint(sheet: &Sheet<'_>, footprint: &Footprint, selected: bool) {
    let corners: Vec<Pos2> = footprint.corners().iter().map(|at| sheet.place(*at)).collect();
    let p = sheet.p;
    let fill = p.accent.gamma_multiply(if selected { 0.04 } else { 0.02 });
    let stroke = Stroke::new(if selected { 1.2 } else { 0.7 }, p.accent.gamma_multiply(0.8));
    sheet.painter.add(Shape::convex_polygon(corners, fill, stroke));
}

/// A part of the path on which pictures are taken.
struct Stretch<'a> {
    points: &'a [Point],
    /// Where the first one is taken, and up to where, metres from the start of the flight.
    from_m: f64,
    to_m: f64,
}

/// For each passage of the leg on which they begin: that passage, or for a series all until it ends.
fn stretches<'a>(
    forecast: &'a Forecast,
    photos: &'a Photos,
    ends: &'a HashMap<Id, Vec<Spot>>,
) -> impl Iterator<Item = Stretch<'a>> {
    let begun = forecast.passages.iter().enumerate().filter(|(_, passage)| passage.leg == photos.leg);
    begun.filter_map(move |(index, passage)| {
        let part = forecast.part(passage)?;
        let from_m = photos.from.distance_m(part)?;
        let to_m = match photos.is_series {
            true => series_end_m(forecast, index, from_m, ends),
            false => part.last()?.distance_m,
        };
        let behind = forecast.points.get(passage.first..)?;
        let end = behind.partition_point(|point| point.distance_m < to_m) + 1;
        Some(Stretch { points: behind.get(..end).unwrap_or(behind), from_m, to_m })
    })
}

/// Where a series that begins on a passage ends, metres from the start of the flight.
fn series_end_m(forecast: &Forecast, index: usize, from_m: f64, ends: &HashMap<Id, Vec<Spot>>) -> f64 {
    let passages = forecast.passages.iter().skip(index);
    let mut found = passages.filter_map(|passage| {
        let part = forecast.part(passage)?;
        let ends = ends.get(&passage.leg)?.iter().filter_map(|spot| spot.distance_m(part));
        // it does not end where it begins
        ends.filter(|end_m| *end_m > from_m).reduce(f64::min)
    });
    found.next().unwrap_or_else(|| forecast.length_m())
}

/// The pictures of a stretch; those over ground of which no elevation is known are left out.
fn along<'a>(stretch: &Stretch<'a>, photos: &'a Photos) -> impl Iterator<Item = Footprint> + use<'a> {
    let (begin_m, to_m) = (stretch.from_m, stretch.to_m);
    let half_rad = (photos.across_deg.unwrap_or(USUAL_ACROSS_DEG) / 2.0).to_radians();
    stretch.points.windows(2).flat_map(move |ends| {
        let [from, to] = [&ends[0], &ends[1]];
        let before = ((from.distance_m - begin_m) / photos.every_m).ceil().max(0.0);
        let track_deg = from.position.bearing_deg(to.position);
        (0..MOST)
            .map(move |i| begin_m + (before + i as f64) * photos.every_m)
            .take_while(move |m| *m < to.distance_m.min(to_m))
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
    use crate::forecast::Passage;

    fn photos(every_m: f64, from_m: f64) -> Photos {
        let from = Spot::Metres(from_m);
        Photos { leg: "a".into(), every_m, from, is_series: false, across_deg: Some(90.0) }
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
            let to_m = part.last().unwrap().distance_m;
            let from_m = photos.from.distance_m(&part).unwrap();
            let stretch = Stretch { points: &part, from_m, to_m };
            let found: Vec<Footprint> = along(&stretch, &photos).collect();
            assert_eq!(found.len(), expected, "{every_m} {from_m}");
            for pair in found.windows(2) {
                assert!((pair[0].at.distance_m(pair[1].at) - every_m).abs() < 0.5);
            }
            assert!(
                found.iter().all(|f| (f.width_m - 200.0).abs() < 1e-6 && (f.track_deg - 90.0).abs() < 0.1)
            );
        }
    }

    /// Four legs of 200 m each and one of 200 m more; each with its pictures at every 100 m.
    fn flight() -> Forecast {
        let points = part();
        let passage = |n: usize, leg: &str| Passage {
            leg: leg.into(),
            stage: "s".into(),
            passes: Vec::new(),
            reverse: false,
            first: n,
            end: n + 1,
            energy_left: 1.0,
            clearance_m: None,
        };
        let passages = ["before", "a", "b", "c", "a"].into_iter().enumerate();
        let passages = passages.map(|(n, leg)| passage(n, leg)).collect();
        Forecast { points, passages, ..Forecast::default() }
    }

    #[test]
    fn a_series_goes_on_along_the_legs_behind_until_it_is_ended() {
        let forecast = flight();
        let begun = Photos { is_series: true, ..photos(100.0, 0.0) };
        let stretches_m = |photos: &Photos, ends: &[(&str, Spot)]| -> Vec<(f64, f64)> {
            let ends = ends.iter().map(|(leg, spot)| ((*leg).into(), vec![*spot])).collect();
            let found = stretches(&forecast, photos, &ends);
            found.map(|stretch| (stretch.from_m - 500.0, stretch.to_m - 500.0)).collect()
        };
        let alone = Photos { is_series: false, ..begun.clone() };
        assert_eq!(stretches_m(&alone, &[]), [(200.0, 400.0), (800.0, 1000.0)], "pictures of the leg only");
        // it begins anew where the leg is flown again
        let again = ("a", Spot::Metres(0.0));
        assert_eq!(stretches_m(&begun, &[again]), [(200.0, 800.0), (800.0, 1000.0)]);
        for (spot, end_m) in [
            (Spot::Metres(0.0), 600.0),
            (Spot::Metres(50.0), 650.0),
            (Spot::End, 800.0),
            (Spot::Seconds(10.0), 800.0),
        ] {
            assert_eq!(stretches_m(&begun, &[again, ("c", spot)])[0], (200.0, end_m), "{spot:?}");
        }
        let ends = HashMap::from([("c".into(), vec![Spot::Metres(0.0)])]);
        let first = stretches(&forecast, &begun, &ends).next().unwrap();
        assert_eq!(along(&first, &begun).count(), 4, "at 200, 300, 400 and 500 m");
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
