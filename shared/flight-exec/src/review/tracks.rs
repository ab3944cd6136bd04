//! `tracks-too-close`: of parallel tracks one begins while the aircraft, which has turned into it from another one nearby, is still beside
//! it.
//!
//! Tracks that are too near to be turned between are interleaved. Where there are too few of them for that (a narrow area, an arm of a
//! concave one, a narrow corridor) it swings wide, and an overshoot gives it room to come back. Whether it does is seen as it is flown.

use super::View;
use super::flown::{Flown, Point};
use super::layout::LaidOut;
use crate::layout::path::distance_and_course;
use crate::layout::world::turn_radius_m;
use aircraft::DESIGN_WIND_MPS;
use aircraft::glide::turn_rad;
use flight_plan::{Edit, Id, LegKind, Pattern, Problem, ScanOrder, Value};
use geometry::LatLon;
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

/// A turn round is made of two right angles, give or take this, radians.
const RIGHT_ANGLE_RAD: f64 = 0.05;
/// So far beside a track the aircraft is on it, metres.
const ON_TRACK_M: f64 = 10.0;
/// So far apart the flight's points are, and a little more, metres.
const POINTS_M: f64 = 30.0;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let mut worst: HashMap<&Id, Late> = HashMap::new();
    let mut order = Vec::new();
    for (leg, late) in view.flights.all().flat_map(|flown| late_ones(view, flown)) {
        if worst.get(leg).is_none_or(|old| late.needed_m > old.needed_m) && worst.insert(leg, late).is_none()
        {
            order.push(leg);
        }
    }
    problems.extend(order.into_iter().filter_map(|leg| Some(worst.get(leg)?.problem(view, leg))));
}

/// A track into which the aircraft turns from another one.
struct Track {
    /// Where the turn is.
    at: LatLon,
    course_deg: f64,
    /// How far beside the other one it is, metres.
    aside_m: f64,
    /// Where its area begins, metres behind the turn.
    room_m: f64,
}

/// One that it comes onto late.
struct Late {
    track: Track,
    /// How far beside it the aircraft is where its area begins, metres.
    beside_m: f64,
    /// How far behind the turn it is on the track, metres.
    needed_m: f64,
}

fn late_ones<'a>(view: &'a View, flown: &'a Flown) -> impl Iterator<Item = (&'a Id, Late)> {
    flown.waypoints.windows(3).zip(2..).filter_map(|(three, steered_to)| {
        let [before, from, to] = three else { return None };
        let track = Track::of(view, [before, from, to])?;
        let first = flown.points.partition_point(|p| p.waypoint < steered_to);
        let on_it = flown.points.iter().skip(first).take_while(|p| p.waypoint == steered_to);
        Some((&to.waypoint.leg, track.late(on_it)?))
    })
}

impl Track {
    fn of(view: &View, [before, from, to]: [&LaidOut; 3]) -> Option<Self> {
        if before.passage != to.passage || from.passage != to.passage {
            return None;
        }
        let (overshoot_m, led_out) = match &view.program.leg(&to.waypoint.leg)?.kind {
            LegKind::Scan(scan) => (view.number(&scan.overshoot_m)?, scan.order == ScanOrder::Interleaved),
            LegKind::Pattern(Pattern::Corridor { .. }) => (0.0, true),
            _ => return None,
        };
        let [before_at, at, to_at] = [before, from, to].map(|w| w.waypoint.position);
        let (aside_m, aside_deg) = distance_and_course(before_at, at);
        let (length_m, course_deg) = distance_and_course(at, to_at);
        let wind_mps = view.conditions.wind.speed_mps();
        let turn_m = turn_radius_m(view.profile, to.waypoint.airspeed_mps, wind_mps, DESIGN_WIND_MPS);
        let room_m = if led_out { turn_m.max(overshoot_m) } else { overshoot_m };
        let track = Self { at, course_deg, aside_m, room_m };
        let turns_round = (turn_rad(aside_deg, course_deg) - FRAC_PI_2).abs() < RIGHT_ANGLE_RAD;
        (turns_round && length_m > 2.0 * track.room_m).then_some(track)
    }

    /// How the aircraft comes onto it, if it does so late.
    fn late<'a>(self, flown: impl Iterator<Item = &'a Point> + Clone) -> Option<Late> {
        let seen = flown.map(|point| self.along_and_beside_m(point.position));
        let (_, beside_m) = seen.clone().find(|(along_m, _)| *along_m >= self.room_m)?;
        let (needed_m, _) = seen.filter(|(_, beside_m)| *beside_m > ON_TRACK_M).last()?;
        (beside_m > ON_TRACK_M).then_some(Late { track: self, beside_m, needed_m })
    }

    /// Where a position is, metres behind the turn and to a side.
    fn along_and_beside_m(&self, position: LatLon) -> (f64, f64) {
        let (distance_m, course_deg) = distance_and_course(self.at, position);
        let (sin, cos) = (course_deg - self.course_deg).to_radians().sin_cos();
        (distance_m * cos, (distance_m * sin).abs())
    }
}

impl Late {
    fn problem(&self, view: &View, leg: &Id) -> Problem {
        // to the next point that was reviewed, and to full tens of metres
        let overshoot_m = ((self.needed_m + POINTS_M) / 10.0).ceil() * 10.0;
        let scan = view.program.leg(leg).filter(|leg| matches!(leg.kind, LegKind::Scan(_)));
        let advice = match scan {
            Some(_) => format!("give it an overshoot of {overshoot_m:.0} m"),
            None => "make it wider, with more tracks, or space them more".to_owned(),
        };
        let begins = self.track.at.destination(self.track.course_deg, self.track.room_m);
        let message = format!(
            "{advice}: at {:.5}, {:.5} a track begins, and the aircraft, which comes from one that is {:.0} m aside, is still {:.0} m beside it",
            begins.lat_deg, begins.lon_deg, self.track.aside_m, self.beside_m
        );
        let fix = view.program.written(leg).and_then(|written| {
            let mut with = written.leg.clone();
            let LegKind::Scan(scan) = &mut with.kind else { return None };
            scan.overshoot_m = Value::Constant(overshoot_m);
            Some(Edit::ReplaceLeg { leg: leg.clone(), with: with.into() })
        });
        Problem::warning("tracks-too-close", message).of(leg).perhaps_fixed_by(fix)
    }
}
