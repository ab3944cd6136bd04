//! The flights of a plan that lands and takes off again: when, how far, and with how much energy.

use super::record::{Record, Track, TrackPoint};
use flight_exec::rehearse::Preview;
use std::ops::Range;

/// Nearer than this to where it stands at last it is at rest, metres.
const AT_REST_M: f64 = 2.0;

/// The energy of one flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energy {
    /// Joules.
    pub used_j: f64,
    /// Share that was left at its end, 0..1.
    pub left: f64,
}

/// A row of the table of flights.
#[derive(Debug, Clone, PartialEq)]
pub struct FlightReport {
    /// From 1.
    pub number: usize,
    /// Its passages, by their numbers in the track.
    pub passages: Range<usize>,
    /// When it began, seconds since the first one did.
    pub start_s: f64,
    /// Seconds until it stood.
    pub time_s: f64,
    /// Metres over the ground.
    pub distance_m: f64,
    /// `None`: not known.
    pub energy: Option<Energy>,
}

/// A part of a track from a take-off to where it came to rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Flight {
    /// Numbers of its passages.
    pub passages: Range<usize>,
    /// Numbers of its points.
    pub points: Range<usize>,
}

/// The flights of a record's main track.
pub fn reports(record: &Record) -> Vec<FlightReport> {
    let track = record.main_track();
    let report = |(index, Flight { passages, points }): (usize, Flight)| {
        let flown = track.points().get(points.clone()).unwrap_or_default();
        let start_s = flown.first().map_or(0.0, |point| point.time_s);
        FlightReport {
            number: index + 1,
            passages,
            start_s,
            time_s: flown.last().map_or(0.0, |point| point.time_s - start_s),
            distance_m: track.distance_m(points),
            energy: record.energy.get(index).copied(),
        }
    };
    of(track).into_iter().enumerate().map(report).collect()
}

/// The flights of a track: each but the first begins with a take-off.
pub fn of(track: &Track) -> Vec<Flight> {
    let takes_off = track.passages().iter().enumerate().skip(1).filter(|(_, p)| p.kind == "take-off");
    let begins: Vec<(usize, usize)> =
        [(0, 0)].into_iter().chain(takes_off.map(|(index, passage)| (index, passage.first))).collect();
    let end = (track.passages().len(), track.points().len());
    let ends = begins.iter().skip(1).copied().chain([end]);
    let flight = |((passage, point), (next_passage, next_point)): ((usize, usize), (usize, usize))| {
        let points = track.points().get(point..next_point).unwrap_or_default();
        Flight { passages: passage..next_passage, points: point..point + until_rest(points) }
    };
    begins.iter().copied().zip(ends).map(flight).collect()
}

/// How many of these points there are until it stands for good: what is behind them is no flight.
pub fn until_rest(points: &[TrackPoint]) -> usize {
    let Some(rest) = points.last().map(|point| point.position) else { return 0 };
    let last = points.iter().rposition(|point| point.position.distance_m(rest) > AT_REST_M);
    last.map_or(1, |last| last + 2).min(points.len())
}

/// What the flights of a preview take.
pub fn previewed(preview: &Preview) -> Vec<Energy> {
    let ends = preview.stops.iter().map(|stop| (stop.legs, stop.battery_left));
    let ends = ends.chain([(preview.legs.len(), preview.battery_left)]);
    let flights = ends.scan(0, |begin, (end, left)| {
        let legs = preview.legs.get(std::mem::replace(begin, end)..end).unwrap_or_default();
        Some(Energy { used_j: legs.iter().map(|leg| leg.energy_j).sum(), left })
    });
    flights.collect()
}

/// What the flights of a track took, by the shares of the energy that were reported, each with its time. `full_j`: what the aircraft
/// holds. Empty: of one of them nothing is known.
pub fn reported(track: &Track, battery: &[(f64, f64)], full_j: f64) -> Vec<Energy> {
    let energy = |flight: Flight| {
        let points = track.points().get(flight.points)?;
        let (from_s, until_s) = (points.first()?.time_s, points.last()?.time_s);
        let after = |time_s: f64| battery.partition_point(|(at_s, _)| *at_s <= time_s);
        let begun = battery.get(after(from_s).saturating_sub(1))?.1;
        let left = battery.get(after(until_s).checked_sub(1)?)?.1;
        Some(Energy { used_j: (begun - left) * full_j, left })
    };
    of(track).into_iter().map(energy).collect::<Option<_>>().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::PassageKey;
    use geometry::LatLon;

    const FIELD: LatLon = LatLon::new(36.3, -84.2);

    /// East for ten minutes at 10 m/s, half an hour on the ground, and from another field five minutes north.
    fn twice() -> Track {
        let mut track = Track::default();
        let key = |leg: &str| PassageKey {
            leg: leg.into(),
            iterations: String::new(),
            reverse: false,
            occurrence: 0,
        };
        let point = |time_s: f64, position| TrackPoint { time_s, position, altitude_amsl_m: 400.0 };
        track.begin(key("to"), "take-off", "to".into());
        (0..=600).for_each(|s| track.push(point(f64::from(s), FIELD.destination(90.0, f64::from(s) * 10.0))));
        track.begin(key("land"), "land", "land".into());
        (601..2400).for_each(|s| track.push(point(f64::from(s), FIELD.destination(90.0, 6010.0))));
        let other = FIELD.destination(180.0, 50_000.0);
        track.begin(key("to2"), "take-off", "to2".into());
        (0..=300).for_each(|s| {
            track.push(point(2400.0 + f64::from(s), other.destination(0.0, f64::from(s) * 10.0)))
        });
        track
    }

    #[test]
    fn flights_have_their_own_times_and_ways_and_what_lies_between_counts_for_none() {
        let energy = vec![Energy { used_j: 2e5, left: 0.5 }, Energy { used_j: 1e5, left: 0.7 }];
        let record = Record { flown: twice(), energy: energy.clone(), ..crate::report::made_up_record() };
        let found = reports(&record);
        let rounded: Vec<_> = found
            .iter()
            .map(|f| {
                (f.number, f.passages.clone(), f.start_s, f.time_s.round(), f.distance_m.round(), f.energy)
            })
            .collect();
        let expected = [
            (1, 0..2, 0.0, 601.0, 6010.0, Some(energy[0])),
            (2, 2..3, 2400.0, 300.0, 3000.0, Some(energy[1])),
        ];
        assert_eq!(rounded, expected);
    }

    #[test]
    fn who_stands_flies_no_more() {
        let mut points = twice().points().to_vec();
        let flown = points.len();
        let last = points[flown - 1];
        assert_eq!(until_rest(&points), flown);
        points.extend((1..90).map(|s| TrackPoint { time_s: last.time_s + f64::from(s), ..last }));
        assert_eq!(until_rest(&points), flown);
        assert_eq!((until_rest(&points[flown..]), until_rest(&[])), (1, 0));
    }

    #[test]
    fn a_track_without_another_take_off_is_one_flight() {
        let record = crate::report::made_up_record();
        let [only] = &reports(&record)[..] else { panic!() };
        assert_eq!((only.passages.clone(), only.energy), (0..record.flown.passages().len(), None));
        assert_eq!(only.time_s, record.flown.duration_s());
    }

    #[test]
    fn energy_is_what_was_reported_at_both_ends_of_a_flight() {
        let battery: Vec<(f64, f64)> = (0..270)
            .map(|i| {
                (f64::from(i) * 10.0, 1.0 - f64::from(i.min(60)) * 0.005 - f64::from((i - 240).max(0)) * 0.01)
            })
            .collect();
        let [first, second] = reported(&twice(), &battery, 1e6)[..] else { panic!() };
        assert!((first.used_j - 3e5).abs() < 1.0 && (first.left - 0.7).abs() < 1e-9, "{first:?}");
        assert!((second.used_j - 2.9e5).abs() < 1e4 + 1.0, "{second:?}");
        assert_eq!(reported(&twice(), &[], 1e6), []);
    }
}
