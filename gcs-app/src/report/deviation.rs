//! How far from the previewed path it was flown.

use super::record::{Passage, PassageKey, Record, Track, TrackPoint};
use super::{authored, flights};
use geometry::{LocalFrame, Vec2};
use std::collections::HashMap;
use std::ops::Range;

/// Points this long before and after a passage belong to it as well, for the ends of a passage are
/// announced at slightly different places. Seconds.
const NEIGHBOUR_S: f64 = 30.0;

/// Type of the passage that ends on a runway.
const LAND: &str = "land";
/// The direction of a roll-out is that of so much of it: the last points may be of one that stands, metres.
const ROLLED_M: f64 = 20.0;
/// Longer than a roll-out, metres.
const ROLLS_ON_M: f64 = 2000.0;

/// Deviations of one passage, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    /// Root of the mean square.
    pub rms_m: f64,
    /// Not exceeded by 95 % of the points.
    pub p95_m: f64,
    /// The greatest.
    pub max_m: f64,
}

impl Statistics {
    /// Of absolute deviations; `None` without any.
    pub fn of(mut metres: Vec<f64>) -> Option<Self> {
        metres.sort_by(f64::total_cmp);
        let count = metres.len();
        let rank = ((count as f64 * 0.95).ceil() as usize).clamp(1, count.max(1)) - 1;
        let square: f64 = metres.iter().map(|m| m * m).sum();
        Some(Self {
            rms_m: (square / count as f64).sqrt(),
            p95_m: *metres.get(rank)?,
            max_m: *metres.last()?,
        })
    }
}

/// A row of the leg table.
#[derive(Debug, Clone, PartialEq)]
pub struct PassageReport {
    /// Which leg, which time.
    pub passage: Passage,
    /// When it was entered, seconds since the flight began.
    pub start_s: f64,
    /// Seconds flown.
    pub time_s: f64,
    /// Metres flown over the ground.
    pub distance_m: f64,
    /// Seconds it should have taken, if it was planned at all.
    pub planned_time_s: Option<f64>,
    /// Against the previewed path of the same passage; `None` if that was not planned.
    pub cross_track: Option<Statistics>,
    /// Against the path as authored (see [`authored`]); `None` if the leg has none.
    pub from_authored: Option<Statistics>,
}

impl PassageReport {
    /// How much longer it took than previewed, as a share of that; `None` where it was not, or took no time.
    pub fn time_off(&self) -> Option<f64> {
        let planned_s = self.planned_time_s.filter(|planned_s| *planned_s > 0.0)?;
        Some((self.time_s - planned_s) / planned_s)
    }

    /// The greatest deviation, metres; 0 where none could be measured.
    pub fn worst_m(&self) -> f64 {
        self.cross_track.map_or(0.0, |s| s.max_m)
    }
}

/// For each flown point its distance from the planned path of the same passage, metres, positive to
/// the right; `None` where the passage was not planned.
pub fn signed(planned: &Track, flown: &Track) -> Vec<Option<f64>> {
    let Some(origin) = planned.points().first() else {
        return vec![None; flown.points().len()];
    };
    let frame = LocalFrame::new(origin.position);
    let by_key: HashMap<&PassageKey, usize> =
        planned.passages().iter().enumerate().map(|(i, p)| (&p.key, i)).collect();
    let mut result = vec![None; flown.points().len()];
    for (i, passage) in flown.passages().iter().enumerate() {
        let Some(twin) = by_key.get(&passage.key) else { continue };
        let mut path: Vec<Vec2> =
            with_neighbours(planned, *twin).iter().map(|p| frame.to_local(p.position)).collect();
        if passage.kind == LAND {
            path.extend(rolled_on(&path));
        }
        for index in flown.range(i) {
            result[index] = offset_m(&path, frame.to_local(flown.points()[index].position));
        }
    }
    result
}

/// The points of a passage and those shortly before and after it.
fn with_neighbours(track: &Track, passage: usize) -> &[TrackPoint] {
    let points = track.points();
    let range = track.range(passage);
    let (Some(first), Some(last)) = (points.get(range.start), points.get(range.end.saturating_sub(1))) else {
        return &[];
    };
    let from = points.partition_point(|p| p.time_s < first.time_s - NEIGHBOUR_S);
    let to = points.partition_point(|p| p.time_s <= last.time_s + NEIGHBOUR_S);
    points.get(from..to.max(from)).unwrap_or(&[])
}

/// Where a path that ends on a runway would lead on. Whoever rolls farther is no more off the centre line for that.
fn rolled_on(path: &[Vec2]) -> Option<Vec2> {
    let last = *path.last()?;
    let before = path.iter().rev().find(|p| (last - **p).length() > ROLLED_M)?;
    let ahead = last - *before;
    Some(last + ahead * (ROLLS_ON_M / ahead.length()))
}

/// Signed distance from a polyline, positive to the right of its direction.
fn offset_m(path: &[Vec2], p: Vec2) -> Option<f64> {
    path.windows(2)
        .map(|ends| segment_offset_m(ends[0], ends[1], p))
        .min_by(|a, b| a.abs().total_cmp(&b.abs()))
        .or_else(|| path.first().map(|only| (p - *only).length()))
}

fn segment_offset_m(a: Vec2, b: Vec2, p: Vec2) -> f64 {
    let (along, to_p) = (b - a, p - a);
    let length2 = along.dot(along);
    let t = if length2 > 0.0 { (to_p.dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    let distance = (to_p - along * t).length();
    // counter-clockwise (positive cross product) is to the left
    if along.cross(to_p) > 0.0 { -distance } else { distance }
}

/// One row per flown passage.
pub fn by_passage(record: &Record, deviations: &[Option<f64>]) -> Vec<PassageReport> {
    let track = record.main_track();
    let (rests, planned_rests) = (rests(track), rests(&record.planned));
    let planned: HashMap<&PassageKey, f64> = record
        .planned
        .passages()
        .iter()
        .enumerate()
        .map(|(i, p)| (&p.key, times(&record.planned, i, &planned_rests).1))
        .collect();
    track
        .passages()
        .iter()
        .enumerate()
        .map(|(i, passage)| {
            let (start_s, time_s) = times(track, i, &rests);
            let range = track.range(i);
            let rest = rest(&rests, range.clone());
            let range = range.start..range.end.min(rest);
            let metres = deviations.get(range.clone()).unwrap_or(&[]);
            PassageReport {
                start_s,
                time_s,
                distance_m: track.distance_m(range.start..(range.end + 1).min(rest)),
                planned_time_s: planned.get(&passage.key).copied(),
                cross_track: Statistics::of(metres.iter().flatten().map(|m| m.abs()).collect()),
                from_authored: record
                    .authored
                    .get(&passage.key)
                    .and_then(|path| authored::deviation(path, track.points().get(range)?)),
                passage: passage.clone(),
            }
        })
        .collect()
}

/// Where each flight of a track comes to rest, as the index behind its last point.
fn rests(track: &Track) -> Vec<usize> {
    flights::of(track).iter().map(|flight| flight.points.end).collect()
}

/// The rest after a passage: what is behind it is another flight's, or no flight at all.
fn rest(rests: &[usize], range: Range<usize>) -> usize {
    rests.iter().copied().find(|rest| range.start < *rest).unwrap_or(range.end)
}

/// Start and duration of a passage, seconds; it lasts until the next one begins, or the aircraft has come to rest.
fn times(track: &Track, passage: usize, rests: &[usize]) -> (f64, f64) {
    let range = track.range(passage);
    let points = track.points();
    let end = points.get(range.end).or(points.last()).map_or(0.0, |p| p.time_s);
    let start = points.get(range.start).map_or(end, |p| p.time_s);
    let rest_s = points.get(rest(rests, range).saturating_sub(1)).map_or(f64::INFINITY, |p| p.time_s);
    (start, (end.min(rest_s) - start).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::record::PlaceKind;
    use geometry::LatLon;

    const HOME: LatLon = LatLon::new(36.3, -84.2);

    fn key(leg: &str) -> PassageKey {
        PassageKey { leg: leg.into(), iterations: String::new(), reverse: false, occurrence: 0 }
    }

    /// Legs along the given bearings, 60 points of 25 m each, shifted to the right of the first bearing.
    fn track(legs: &[(&str, f64)], shift_right_m: f64) -> Track {
        let mut track = Track::default();
        let mut p = HOME.destination(legs[0].1 + 90.0, shift_right_m);
        for (i, (leg, bearing)) in legs.iter().enumerate() {
            track.begin(key(leg), "TF", "stage".into());
            for k in 0..60 {
                track.push(TrackPoint { time_s: (i * 60 + k) as f64, position: p, altitude_amsl_m: 500.0 });
                p = p.destination(*bearing, 25.0);
            }
        }
        track
    }

    #[test]
    fn a_shift_to_the_right_is_positive_and_measured() {
        let planned = track(&[("a", 40.0), ("b", 40.0)], 0.0);
        for shift in [7.0, -3.0, 0.0] {
            let flown = track(&[("a", 40.0), ("b", 40.0)], shift);
            for offset in signed(&planned, &flown) {
                assert!((offset.unwrap() - shift).abs() < 0.05, "{offset:?} for {shift}");
            }
        }
    }

    #[test]
    fn each_passage_is_compared_with_its_own() {
        // forth and back 10 m beside: without passages the way back would look like the way out
        let planned = track(&[("out", 90.0), ("back", 270.0)], 0.0);
        let flown = track(&[("out", 90.0), ("other", 270.0)], 0.0);
        let offsets = signed(&planned, &flown);
        assert!(offsets[..60].iter().all(|o| o.unwrap().abs() < 0.1));
        assert!(offsets[60..].iter().all(Option::is_none), "not planned");
    }

    #[test]
    fn an_early_announcement_at_a_corner_is_no_deviation() {
        let planned = track(&[("a", 0.0), ("b", 90.0)], 0.0);
        let mut flown = Track::default();
        flown.begin(key("a"), "TF", String::new());
        for (i, p) in planned.points().iter().enumerate() {
            if i == 57 {
                flown.begin(key("b"), "TF", String::new());
            }
            flown.push(*p);
        }
        assert!(signed(&planned, &flown).iter().all(|o| o.unwrap().abs() < 0.1));
    }

    #[test]
    fn a_longer_roll_out_is_judged_by_the_centre_line_of_the_runway() {
        let landing = |seconds: usize, aside_m: f64| {
            let mut track = Track::default();
            track.begin(key("land"), LAND, "Landing".into());
            let touch_down = HOME.destination(142.0, aside_m);
            for k in 0..seconds + 30 {
                let along_m = 25.0 * k.min(seconds) as f64;
                let position = touch_down.destination(52.0, along_m);
                track.push(TrackPoint { time_s: k as f64, position, altitude_amsl_m: 349.0 });
            }
            track
        };
        let planned = landing(20, 0.0);
        for (seconds, aside_m) in [(40, 0.0), (40, 3.0), (40, -3.0), (15, 3.0)] {
            for offset in signed(&planned, &landing(seconds, aside_m)) {
                assert!((offset.unwrap() - aside_m).abs() < 0.05, "{offset:?} for {seconds} s, {aside_m} m");
            }
        }
    }

    #[test]
    fn statistics() {
        let s = Statistics::of((1..=100).map(f64::from).collect()).unwrap();
        assert_eq!((s.p95_m, s.max_m), (95.0, 100.0));
        assert!((s.rms_m - 58.17).abs() < 0.01);
        assert_eq!(Statistics::of(vec![]), None);
        assert_eq!(Statistics::of(vec![4.0]).unwrap(), Statistics { rms_m: 4.0, p95_m: 4.0, max_m: 4.0 });
    }

    #[test]
    fn the_rows_of_the_table() {
        let mut record = crate::report::record::tests::record();
        record.planned = track(&[("a", 0.0), ("b", 90.0)], 0.0);
        record.flown = track(&[("a", 0.0), ("b", 90.0), ("b", 90.0)], 2.0);
        let rows = by_passage(&record, &signed(&record.planned, &record.flown));
        assert_eq!(rows.len(), 3);
        assert_eq!((rows[0].start_s, rows[0].time_s, rows[0].planned_time_s), (0.0, 60.0, Some(60.0)));
        assert!((rows[0].distance_m - 1500.0).abs() < 0.1);
        assert_eq!((rows[0].time_off(), rows[2].time_off()), (Some(0.0), None));
        assert!(rows[1].worst_m() < 2.1 && rows[1].cross_track.is_some());
        assert_eq!((rows[2].passage.key.occurrence, rows[2].cross_track), (1, None));
        assert!(record.places.iter().any(|p| matches!(p.kind, PlaceKind::Runway { .. })));
    }
}
