//! What is done on the way: a mark where it is, and what it is on the leg that is selected.

use super::kin::Kin;
use super::marks::shortened;
use super::names::{self, Ground, Name, Rank};
use super::sheet::Sheet;
use super::sketch::Acting;
use crate::command::Selection;
use crate::forecast::{Forecast, Point};
use egui::{Pos2, Shape, Stroke, vec2};
use flight_plan::Id;
use geometry::LatLon;
use std::collections::HashMap;

/// Most marks that are drawn.
const MOST: usize = 300;
/// From the middle of a mark to its corners, screen points.
const SIZE: f32 = 5.0;

/// Draws them where the path of the preview leads.
pub fn draw(sheet: &Sheet<'_>, kin: &Kin) {
    let Sheet { view, sketch, scene, p, .. } = *sheet;
    if sketch.acts.is_empty() {
        return;
    }
    let places = places(scene.forecast(), &sketch.acts);
    let near = places.into_iter().map(|(acts, at)| (acts, view.place(at)));
    for (acts, at) in near.filter(|(_, at)| view.is_near(*at)).take(MOST) {
        let Some(first) = acts.first() else { continue };
        let painter = kin.painter(sheet, &first.leg);
        let sheet = sheet.with(&painter);
        let selected = scene.is_selected(&Selection::Leg(first.leg.clone()));
        mark(&sheet, at, selected);
        if selected {
            let (rank, spots) = (Rank::Selected, names::corners(at, vec2(8.0, 8.0)));
            sheet.ask(Name {
                rank,
                spots,
                text: words(&acts),
                size: 11.5,
                colour: p.text,
                ground: Ground::Halo,
            });
        }
    }
}

/// What is done at each place of the path, in the order of the flight.
fn places<'a>(forecast: &Forecast, acts: &'a [Acting]) -> Vec<(Vec<&'a Acting>, LatLon)> {
    let mut of_leg: HashMap<&Id, Vec<&Acting>> = HashMap::new();
    acts.iter().for_each(|act| of_leg.entry(&act.leg).or_default().push(act));
    let mut places: Vec<(Vec<&Acting>, LatLon)> = Vec::new();
    for passage in &forecast.passages {
        let Some((acts, part)) = of_leg.get(&passage.leg).zip(forecast.part(passage)) else { continue };
        for act in acts {
            let Some(at) = act.at.distance_m(part).and_then(|metres| along(part, metres)) else { continue };
            match places.last_mut() {
                Some((here, last)) if *last == at && here.iter().all(|other| other.leg == act.leg) => {
                    here.push(act)
                }
                _ => places.push((vec![act], at)),
            }
        }
        if places.len() >= MOST {
            break;
        }
    }
    places
}

/// An upright square that stands on its corner, half filled: no waypoint, and no handle of a number.
fn mark(sheet: &Sheet<'_>, at: Pos2, selected: bool) {
    let p = sheet.p;
    let size = if selected { SIZE + 1.5 } else { SIZE };
    let corners = [vec2(0.0, -1.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(-1.0, 0.0)].map(|d| at + d * size);
    sheet.painter.add(Shape::convex_polygon(corners.to_vec(), p.halo, Stroke::new(1.4, p.text)));
    let [top, right, bottom, _] = corners;
    sheet.painter.add(Shape::convex_polygon(vec![top, right, bottom], p.text, Stroke::NONE));
}

/// What is done on a leg, in words, if anything is.
pub fn on(leg: &Id, acts: &[Acting]) -> Option<String> {
    let acts: Vec<&Acting> = acts.iter().filter(|act| act.leg == *leg).collect();
    (!acts.is_empty()).then(|| words(&acts))
}

/// `picture, fire_seen = true`.
fn words(acts: &[&Acting]) -> String {
    let all: Vec<&str> = acts.iter().map(|act| act.words.as_str()).collect();
    shortened(&all.join(", "))
}

/// The place on a part of a path that is so far from the start of the flight; none beyond its end.
fn along(part: &[Point], metres: f64) -> Option<LatLon> {
    let after = part.partition_point(|point| point.distance_m < metres - EXACT_M);
    let to = part.get(after)?;
    let from = after.checked_sub(1).and_then(|before| part.get(before)).unwrap_or(to);
    let share = (metres - from.distance_m) / (to.distance_m - from.distance_m).max(EXACT_M);
    Some(from.position.interpolate(to.position, share.clamp(0.0, 1.0)))
}

/// What a sum of distances may be off, metres.
const EXACT_M: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;

    fn point(east_m: f64) -> Point {
        Point {
            time_s: east_m / 20.0,
            distance_m: east_m,
            position: LatLon::new(46.0, 8.0).destination(90.0, east_m),
            altitude_amsl_m: 500.0,
            ground_amsl_m: None,
            passage: 0,
        }
    }

    #[test]
    fn what_is_done_is_where_it_is_done_and_nowhere_beyond_the_leg() {
        let part = [100.0, 200.0, 400.0].map(point);
        for metres in [100.0, 130.0, 200.0, 390.0, 400.0] {
            let at = along(&part, metres).unwrap();
            assert!(at.distance_m(point(metres).position) < 0.5, "{metres}");
        }
        assert_eq!(along(&part, 401.0), None);
        assert_eq!(along(&[], 0.0), None);
    }
}
