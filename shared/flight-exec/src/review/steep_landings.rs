//! `landing-too-steep`: the final approach begins so high that the aircraft, or an autopilot, does not come down to the threshold.
//!
//! A landing has no altitude of its own: the leg before it decides. What is too steep for autopilots only is a warning; so is one of an
//! emergency plan, which is entered from anywhere, and one of a flight under way.

use super::View;
use super::alternates::flying_s;
use super::flown::{Flown, Point};
use super::layout::LaidOut;
use crate::api::Action;
use flight_plan::{Edit, Problem};

/// Steepest final approach where the autopilot has not told it, degrees: PX4, as it is delivered (`FW_LND_ANG`), flies no mission with a
/// steeper one.
const STEEPEST_DEG: f64 = 5.0;
/// So much higher it may begin, metres: the aircraft turns before it reaches a waypoint.
const TOLERANCE_M: f64 = 10.0;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let finals = view.flights.all().filter_map(|flown| Some((flown, Final::of(view, flown)?)));
    problems.extend(
        finals.filter(|(_, last)| last.is_too_steep(view)).map(|(flown, last)| last.problem(view, flown)),
    );
}

fn steepest_deg(view: &View) -> f64 {
    view.conditions.landing_deg.unwrap_or(STEEPEST_DEG)
}

/// The last part of a landing, as it is flown.
struct Final<'a> {
    touch_down: &'a LaidOut,
    begins: &'a LaidOut,
    at: &'a Point,
    /// What is flown before the landing, and where its end was reached.
    before: Option<(&'a LaidOut, &'a Point)>,
    /// The same of the leg before that.
    earlier: Option<(&'a LaidOut, &'a Point)>,
    length_m: f64,
    /// Where it begins, above the threshold, metres.
    height_m: f64,
    /// What the aircraft descends on it, metres.
    descent_m: f64,
}

impl<'a> Final<'a> {
    fn of(view: &View, flown: &'a Flown) -> Option<Self> {
        let mut reached = flown.waypoints.iter().zip(&flown.reached).rev();
        let (touch_down, _) = reached.next().filter(|_| flown.reached.len() == flown.waypoints.len())?;
        if !matches!(touch_down.waypoint.action, Action::Land { .. }) {
            return None;
        }
        let (begins, at) = reached.next().filter(|(begins, _)| begins.passage == touch_down.passage)?;
        let before = reached.find(|(laid_out, _)| laid_out.passage != touch_down.passage);
        let threshold = &touch_down.waypoint;
        let time_s = flying_s(view.profile, at.position, threshold.position, view.conditions.wind)?;
        Some(Self {
            touch_down,
            begins,
            at,
            before,
            earlier: reached
                .find(|(laid_out, _)| Some(&laid_out.passage) != before.map(|(it, _)| &it.passage)),
            length_m: at.position.distance_m(threshold.position),
            height_m: at.altitude_amsl_m - threshold.altitude_amsl_m,
            descent_m: view.profile.max_descent_mps * time_s,
        })
    }

    fn is_too_steep(&self, view: &View) -> bool {
        self.height_m > self.granted_m(view).min(self.descent_m) + TOLERANCE_M
    }

    /// So high it may begin for the autopilot.
    fn granted_m(&self, view: &View) -> f64 {
        self.length_m * steepest_deg(view).to_radians().tan()
    }

    /// It is laid out more steeply than the autopilot is set to take: no leg before it changes that.
    fn is_beyond_autopilot(&self, view: &View) -> bool {
        let laid_out_m = self.begins.wanted_amsl_m - self.touch_down.waypoint.altitude_amsl_m;
        laid_out_m > self.granted_m(view)
    }

    /// The highest that the leg before it may end, whole metres AMSL: from there the final begins on its slope.
    fn highest_amsl_m(&self, view: &View) -> Option<f64> {
        let (before, from) = self.before?;
        let highest_m = (self.begins.wanted_amsl_m + comes_down_m(view, from, self.at)).floor();
        (before.waypoint.action == Action::Fly && highest_m < before.wanted_amsl_m).then_some(highest_m)
    }

    /// Ends the leg before it there; and the one before that as much lower as the aircraft does not come down between them: raised again
    /// for its slope, and lowered for this one, it would go on for ever.
    fn lowered(&self, view: &View, highest_m: f64) -> Option<Edit> {
        let lower = |laid_out: &LaidOut, by_m: f64| {
            view.relevelled(&laid_out.waypoint.leg, laid_out.wanted_amsl_m, -by_m)
        };
        let (before, from) = self.before?;
        let last = lower(before, before.wanted_amsl_m - highest_m)?;
        let Some((earlier, at)) = self.earlier else { return Some(last) };
        let missing_m = (earlier.wanted_amsl_m - comes_down_m(view, at, from) - highest_m).ceil();
        if missing_m <= 0.0 {
            return Some(last);
        }
        let first = lower(earlier, missing_m).filter(|_| earlier.waypoint.action == Action::Fly)?;
        Some(Edit::All(vec![first, last]))
    }

    fn problem(&self, view: &View, flown: &Flown) -> Problem {
        let highest_m = self.highest_amsl_m(view).filter(|_| !self.is_beyond_autopilot(view));
        let lower = highest_m.zip(self.before).map_or_else(String::new, |(highest_m, (before, _))| {
            format!("end `{}` at {highest_m:.0} m AMSL at most, or ", before.waypoint.leg)
        });
        let remedy = match self.is_beyond_autopilot(view) {
            true => "set the autopilot to take a steeper landing (PX4's `FW_LND_ANG`)".to_owned(),
            false => format!("{lower}put an `HA` before this landing"),
        };
        let degrees = |height_m: f64| (height_m / self.length_m.max(1.0)).atan().to_degrees();
        let who =
            if view.conditions.landing_deg.is_some() { "this autopilot flies" } else { "autopilots fly" };
        let message = format!(
            "{remedy}: its final approach begins {:.0} m above the threshold, {:.0} m before it, and is {:.1}° steep; {who} at most {:.1}°, the aircraft {:.1}°",
            self.height_m,
            self.length_m,
            degrees(self.height_m),
            steepest_deg(view),
            degrees(self.descent_m),
        );
        // its own numbers are told beside it: what is steeper than the aircraft's most is no mere warning
        let cannot = self.height_m > self.descent_m;
        let say = match cannot && flown.emergency.is_none() && !view.flights.under_way {
            true => Problem::error,
            false => Problem::warning,
        };
        let fix = highest_m.and_then(|highest_m| self.lowered(view, highest_m));
        say("landing-too-steep", message).of(&self.touch_down.waypoint.leg).perhaps_fixed_by(fix)
    }
}

/// So much the aircraft comes down from one to the other at its most, metres.
fn comes_down_m(view: &View, from: &Point, to: &Point) -> f64 {
    view.profile.max_descent_mps * (to.time_s - from.time_s)
}
