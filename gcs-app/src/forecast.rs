//! What will be flown, as map, profile and table need it; and the worker that finds it out.
//!
//! The worker checks, compiles, previews, hashes and reviews the newest plan on threads of its own; from edit to edit only what has
//! changed, and a newer plan always wins.

mod aboard;
mod beginning;
mod bench;
mod coverage;
mod left_out;
mod line;
mod outline;
mod preview;
mod reviewer;
mod told;
mod underway;
mod worker;

pub use aboard::Aboard;
pub use coverage::{Coverage, Ending};
pub use left_out::LeftOut;
pub use line::Line;
pub use outline::{Heights, Outline, Places};
pub use told::{Clearance, clearance, told, until_touch_down};
pub use underway::Underway;
pub use worker::{Analysis, Question, Worker};

use flight_exec::rehearse::WhatIf;
use flight_exec::{PlacePointer, Waypoint};
use flight_plan::create::Approach;
use flight_plan::{Cause, Id};
use geometry::LatLon;
use std::sync::Arc;

/// An alarm that is raised in a preview.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alarm {
    /// Seconds since the start.
    pub time_s: f64,
    /// Why.
    pub cause: Cause,
}

/// A forecast and the world that it is for.
#[derive(Debug, Clone)]
struct Flown {
    /// The last one that could be made.
    forecast: Shared,
    forecast_version: u64,
    no_forecast: Option<String>,
    what_if: WhatIf,
}

/// A point of the path that will be flown.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Seconds since the start.
    pub time_s: f64,
    /// Metres flown over the ground since the start.
    pub distance_m: f64,
    /// Where.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Ground below, metres AMSL, where it is known.
    pub ground_amsl_m: Option<f64>,
    /// Which of the forecast's passages it belongs to.
    pub passage: usize,
}

/// One passage of a leg.
#[derive(Debug, Clone, PartialEq)]
pub struct Passage {
    /// The leg.
    pub leg: Id,
    /// Its stage.
    pub stage: Id,
    /// Pass of each loop around it, from 1, outermost first.
    pub passes: Vec<u64>,
    /// It is flown backwards.
    pub reverse: bool,
    /// Index of its first point.
    pub first: usize,
    /// Index after its last point.
    pub end: usize,
    /// Share of the energy that is left at its end, 0..1.
    pub energy_left: f64,
    /// Least height above the ground, metres, where the ground is known.
    pub clearance_m: Option<f64>,
}

/// A flight ahead of time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Forecast {
    /// The path.
    pub points: Vec<Point>,
    /// Its passages, in order.
    pub passages: Vec<Passage>,
    /// Legs of the plan that are not flown, in its order.
    pub left_out: Vec<LeftOut>,
    /// The waypoints that will be sent.
    pub waypoints: Vec<Waypoint>,
    /// Share of the energy left at the end, 0..1.
    pub battery_left: Option<f64>,
    /// How often it stands between two flights of the plan.
    pub stops: usize,
    /// Why it ends early, if it does.
    pub cut_short: Option<String>,
    /// It is the beginning of a plan with errors: as far as that can be flown.
    pub is_beginning: bool,
    /// What is drawn of points and waypoints; whoever changes those begins with a new one.
    pub outline: Outline,
}

impl Forecast {
    /// Where the points are on the map.
    pub fn places(&self) -> &Places {
        self.outline.places(&self.points)
    }
    /// Where the waypoints are on the map.
    pub fn waypoint_places(&self) -> &Places {
        self.outline.waypoints(self.waypoints.iter().map(|waypoint| waypoint.position.into()))
    }
    /// The path as it is drawn in views of an octave, as soon as that is worked out.
    pub fn line(&self, octave: i32) -> Option<&Line> {
        self.outline.line(octave)
    }
    /// The nearest octave for which it is worked out, and the path for that.
    pub fn line_near(&self, octave: i32) -> Option<(i32, &Line)> {
        self.outline.line_near(octave)
    }
    /// Works out the line for an octave: of a long path that takes longer than a frame.
    pub fn work_out_line(&self, octave: i32) {
        self.outline.work_out_line(&self.points, octave);
    }
    /// Between which heights path and ground are from a time on.
    pub fn heights_from(&self, from_s: f64) -> Heights {
        let first = self.points.partition_point(|point| point.time_s < from_s);
        let block = first / outline::BLOCK + 1;
        let rest = (block * outline::BLOCK).min(self.points.len());
        let rest = Heights::of(self.points.get(first..rest).unwrap_or_default());
        let blocks = self.outline.heights(&self.points).iter().skip(block);
        blocks.fold(rest, |found, heights| found.with(*heights))
    }
    /// The first point behind another one that is not before a time.
    pub fn next_at(&self, behind: usize, time_s: f64) -> usize {
        let is_before = |index: usize| self.points.get(index).is_some_and(|point| point.time_s < time_s);
        // it is near: farther and farther steps find it soon
        let mut step = 1;
        while is_before(behind + step) {
            step *= 2;
        }
        let from = behind + step / 2 + 1;
        let rest = self.points.get(from..(behind + step).min(self.points.len())).unwrap_or_default();
        from + rest.partition_point(|point| point.time_s < time_s)
    }
    /// Works out what was drawn of the former forecast, so that no frame has to wait for it.
    fn prepare(&self, former: &Self) {
        if self.outline.prepare(&self.points, &former.outline) {
            self.waypoint_places();
        }
    }
    /// Seconds from start to end.
    pub fn duration_s(&self) -> f64 {
        self.points.last().map_or(0.0, |p| p.time_s)
    }
    /// Metres from start to end.
    pub fn length_m(&self) -> f64 {
        self.points.last().map_or(0.0, |p| p.distance_m)
    }
    /// The point at a time, or the nearest there is.
    pub fn at(&self, time_s: f64) -> Option<&Point> {
        let after = self.points.partition_point(|p| p.time_s < time_s);
        self.points.get(after).or(self.points.last())
    }
    /// Where it is at a time: between two points on the way from one to the other.
    pub fn position_at(&self, time_s: f64) -> Option<LatLon> {
        let next = self.at(time_s)?;
        let after = self.points.partition_point(|point| point.time_s < time_s);
        let before = after.checked_sub(1).and_then(|before| self.points.get(before));
        let share = |before: &Point| (time_s - before.time_s) / (next.time_s - before.time_s);
        let between = before.filter(|before| before.time_s < next.time_s && time_s < next.time_s);
        Some(
            between.map_or(next.position, |before| before.position.interpolate(next.position, share(before))),
        )
    }
    /// The points from a time to another.
    pub fn between(&self, from_s: f64, to_s: f64) -> &[Point] {
        let before = |time_s: f64| self.points.partition_point(|point| point.time_s < time_s);
        self.points.get(before(from_s)..before(to_s)).unwrap_or_default()
    }
    /// Where the path is before the first passage of a leg, and which way it goes there.
    pub fn start_of(&self, leg: &Id) -> Option<Approach> {
        let passage = self.passages.iter().find(|passage| passage.leg == *leg)?;
        self.towards(passage.first)
    }
    /// Where the path is after the last passage of a leg, and which way it goes there.
    pub fn end_of(&self, leg: &Id) -> Option<Approach> {
        // of a call, what it has made: that is called by it and a dot
        let is_its = |flown: &Id| {
            let rest = flown.as_str().strip_prefix(leg.as_str());
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let passage = self.passages.iter().rfind(|passage| is_its(&passage.leg))?;
        self.towards(passage.end)
    }
    /// Where the path is at a time, and which way it goes there.
    pub fn approach_at(&self, time_s: f64) -> Option<Approach> {
        self.towards(self.points.partition_point(|point| point.time_s < time_s))
    }
    /// Half the time of the first passage of a leg or stage, seconds from the start; `None`: it is not flown.
    pub fn middle_of_s(&self, what: &Id) -> Option<f64> {
        let is_its = |passage: &&Passage| passage.leg == *what || passage.stage == *what;
        let part = self.part(self.passages.iter().find(is_its)?)?;
        Some((part.first()?.time_s + part.last()?.time_s) / 2.0)
    }
    /// At a point, coming from the point before it.
    fn towards(&self, index: usize) -> Option<Approach> {
        let at = |i: usize| self.points.get(i).map(|point| point.position);
        let index = index.min(self.points.len().checked_sub(1)?);
        let from = at(index)?;
        let before = index.checked_sub(1).and_then(at).filter(|before| before.distance_m(from) > 0.5);
        Some(Approach { from, course_deg: before.map(|before| before.inverse(from).bearing_end_deg) })
    }
    /// Points of the passages of a leg, part by part.
    pub fn passages_of<'a>(&'a self, leg: &'a Id) -> impl Iterator<Item = &'a [Point]> {
        self.passages.iter().filter(move |p| p.leg == *leg).filter_map(|p| self.part(p))
    }
    /// The points of a passage, with the first point of the next so that the line has no gap.
    pub fn part(&self, passage: &Passage) -> Option<&[Point]> {
        self.points.get(passage.first..(passage.end + 1).min(self.points.len()))
    }
    /// The point that an aircraft has come to on the leg that is being flown, in the same pass of the loops around it; if there is no
    /// such pass, in any.
    pub fn nearest(&self, aircraft: Underway, place: &PlacePointer) -> Option<&Point> {
        let nearest = |passages: &mut dyn Iterator<Item = &Passage>| {
            aircraft.nearest(passages.filter_map(|passage| self.part(passage)))
        };
        let passes = place.iterations.iter().map(|pass| pass.iteration);
        let of_leg = || self.passages.iter().filter(|passage| passage.leg == place.leg);
        let of_pass = |passage: &&Passage| passage.passes.iter().copied().eq(passes.clone());
        nearest(&mut of_leg().filter(of_pass)).or_else(|| nearest(&mut of_leg()))
    }
}

/// A forecast that is shared between threads.
pub type Shared = Arc<Forecast>;

#[cfg(test)]
mod tests {
    use super::*;
    use flight_exec::{Branching, IterationPlace};

    fn forecast() -> Forecast {
        let point = |i: usize, passage| Point {
            time_s: i as f64 * 2.0,
            distance_m: i as f64 * 50.0,
            position: LatLon::new(0.0, i as f64 * 1e-3),
            altitude_amsl_m: 500.0,
            ground_amsl_m: None,
            passage,
        };
        let passage = |leg: &str, pass, first, end| Passage {
            leg: leg.into(),
            stage: "s".into(),
            passes: vec![pass],
            reverse: false,
            first,
            end,
            energy_left: 1.0,
            clearance_m: None,
        };
        Forecast {
            points: vec![point(0, 0), point(1, 0), point(2, 1), point(3, 2), point(4, 2)],
            passages: vec![passage("a", 1, 0, 2), passage("b", 1, 2, 3), passage("a", 2, 3, 5)],
            ..Forecast::default()
        }
    }

    #[test]
    fn times_and_places_find_their_points() {
        let f = forecast();
        assert_eq!(f.duration_s(), 8.0);
        for (time, expected) in [(-1.0, 0.0), (3.0, 4.0), (4.0, 4.0), (99.0, 8.0)] {
            assert_eq!(f.at(time).map(|p| p.time_s), Some(expected), "{time}");
        }
        let at = |leg: &str, pass, track_deg| {
            let iterations =
                vec![IterationPlace { leg: "l".into(), iteration: pass, of: None, reverse: false }];
            let (plan, stage, leg) = (Branching::Main, "s".into(), leg.into());
            let place = PlacePointer { plan, stage, leg, iterations, reverse: false, distance_m: 0.0 };
            let aircraft = Underway { at: LatLon::new(0.0, 2.6e-3), track_deg };
            f.nearest(aircraft, &place).map(|p| p.time_s)
        };
        for track_deg in [None, Some(90.0)] {
            assert_eq!(at("a", 1, track_deg), Some(2.0), "the second pass is nearer");
            assert_eq!(at("a", 2, track_deg), Some(6.0));
            assert_eq!(at("a", 9, track_deg), Some(6.0), "a pass that was not foreseen");
            assert_eq!(at("c", 1, track_deg), None);
        }
        assert_eq!(at("a", 2, Some(270.0)), None, "the path goes nowhere that way");
        assert_eq!(f.passages_of(&"a".into()).map(<[Point]>::len).collect::<Vec<_>>(), [3, 2]);
        assert_eq!(Forecast::default().at(1.0), None);
    }

    #[test]
    fn between_two_points_it_is_on_the_way() {
        let f = forecast();
        for (time_s, lon_deg) in [(-1.0, 0.0), (0.0, 0.0), (3.0, 1.5e-3), (4.0, 2e-3), (99.0, 4e-3)] {
            let at = f.position_at(time_s).unwrap();
            assert!(at.distance_m(LatLon::new(0.0, lon_deg)) < 0.01, "{time_s}: {at:?}");
        }
        assert_eq!(Forecast::default().position_at(1.0), None);
    }

    #[test]
    fn a_leg_and_a_stage_have_their_middle_in_time_and_the_path_its_course_there() {
        let f = forecast();
        assert_eq!(f.middle_of_s(&"b".into()), Some(5.0), "to where the next one begins");
        assert_eq!(f.middle_of_s(&"s".into()), Some(2.0), "a stage begins with its first leg");
        assert_eq!(f.middle_of_s(&"z".into()), None);
        let there = f.approach_at(4.0).unwrap();
        assert_eq!(there.from, LatLon::new(0.0, 2e-3));
        assert!((there.course_deg.unwrap() - 90.0).abs() < 0.1, "{there:?}");
    }

    #[test]
    fn the_next_point_and_the_heights_are_found_without_looking_at_all() {
        let point = |i: u32| Point {
            time_s: f64::from(i),
            distance_m: f64::from(i),
            position: LatLon::new(0.0, 0.0),
            altitude_amsl_m: 500.0 + f64::from(i),
            ground_amsl_m: Some(f64::from(i % 7)),
            passage: 0,
        };
        let f = Forecast { points: (0..1000).map(point).collect(), ..Forecast::default() };
        for (behind, time_s) in
            [(0, 0.5), (0, 1.0), (0, 2.5), (10, 3.0), (10, 700.2), (998, 999.0), (5, 5000.0)]
        {
            let after = f.points.iter().enumerate().skip(behind + 1);
            let expected =
                after.map(|(i, p)| (i, p.time_s)).find(|(_, t)| *t >= time_s).map_or(1000, |(i, _)| i);
            assert_eq!(f.next_at(behind, time_s), expected, "{behind} {time_s}");
        }
        for from_s in [-1.0, 0.0, 127.0, 128.0, 130.5, 998.0, 2000.0] {
            let first = f.points.partition_point(|point| point.time_s < from_s);
            assert_eq!(f.heights_from(from_s), Heights::of(&f.points[first..]), "{from_s}");
        }
    }
}
