//! `turn-too-tight`: a circle or another turn that the wind given doesn't let the aircraft fly, not even with its steepest bank.
//!
//! In still air the check of the plan has checked each radius. With the wind behind an aircraft needs the radius that belongs to its
//! speed over the ground (guidance: r = V² / (g · tan φ) with V + W). Holdings, turn-rounds and the turns between parallel tracks
//! are laid out for the wind that is measured, so they are no matter of this.

use super::View;
use super::flown::Flown;
use super::layout::LaidOut;
use crate::api::Action;
use crate::layout::path::distance_and_course;
use aircraft::glide::turn_rad;
use flight_plan::{Edit, Id, LegKind, Pattern, Problem, Value};
use geometry::LatLon;
use geometry::turn::radius_m;
use std::collections::HashMap;

/// Turns from here on are not flown within the corner but around it (guidance: no fly-by for more), radians.
const STEEPEST_FLY_BY_RAD: f64 = 2.6;
/// What is so little too tight is none, as a share: circles become polygons within a tolerance.
const ROUNDING: f64 = 0.02;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    if view.conditions.wind.speed_mps() <= 0.0 {
        return;
    }
    let mut worst: HashMap<&Id, Turn> = HashMap::new();
    let mut order = Vec::new();
    for (leg, turn) in view.flights.all().flat_map(|flown| turns(view, flown)) {
        if worst.get(leg).is_none_or(|old| turn.excess() > old.excess()) && worst.insert(leg, turn).is_none()
        {
            order.push(leg);
        }
    }
    problems.extend(order.into_iter().filter_map(|leg| worst.get(leg)?.problem(view, leg)));
}

/// A stretch between two turns.
struct Turn {
    at: LatLon,
    ground_mps: f64,
    airspeed_mps: f64,
    /// The radius that fits.
    fits_m: f64,
    /// The aircraft's smallest one at that speed over the ground.
    needed_m: f64,
    /// It belongs to an arc and not to a corner.
    circle: bool,
}

/// What a leg's turns belong to: `Some(true)` to circles, `None`: nobody reviews them here.
fn is_circle(view: &View, leg: &Id) -> Option<bool> {
    match &view.program.leg(leg)?.kind {
        LegKind::Rf { .. } | LegKind::Orbit { .. } | LegKind::Pattern(Pattern::FigureEight { .. }) => {
            Some(true)
        }
        LegKind::Pattern(
            Pattern::Sector { .. } | Pattern::Spiral { .. } | Pattern::ExpandingSquare { .. },
        ) => Some(false),
        _ => None,
    }
}

/// The stretches of a flight that lie between two turns of one leg, as the waypoints make them.
fn turns<'a>(view: &'a View, flown: &'a Flown) -> impl Iterator<Item = (&'a Id, Turn)> {
    flown.waypoints.windows(4).filter_map(|four| {
        let [before, from, to, after] = four else { return None };
        let leg = &to.waypoint.leg;
        let circle = is_circle(view, leg)?;
        let joined = |w: &LaidOut| w.passage == to.passage && matches!(w.waypoint.action, Action::Fly);
        // an arc to a fix begins where the leg before it ends
        let begun = joined(before) || matches!(view.program.leg(leg)?.kind, LegKind::Rf { .. });
        let turn = (begun && joined(from) && joined(to) && joined(after)).then(|| {
            let places = [before, from, to, after].map(|w| w.waypoint.position);
            turn(view, places, to.waypoint.airspeed_mps, circle)
        })??;
        Some((leg, turn))
    })
}

/// The stretch from the second of four places to the third: r · tan(A/2) at each end have to fit.
fn turn(
    view: &View,
    [before, from, to, after]: [LatLon; 4],
    airspeed_mps: f64,
    circle: bool,
) -> Option<Turn> {
    let (_, first_deg) = distance_and_course(before, from);
    let (length_m, course_deg) = distance_and_course(from, to);
    let (_, last_deg) = distance_and_course(to, after);
    let angles = [turn_rad(first_deg, course_deg), turn_rad(course_deg, last_deg)];
    if angles.iter().any(|a| *a > STEEPEST_FLY_BY_RAD) {
        return None;
    }
    let tangents: f64 = angles.iter().map(|a| (a / 2.0).tan()).sum();
    let wind = view.conditions.wind;
    // a wind that it can't fly across carries it along
    let ground_mps =
        wind.ground_speed_mps(airspeed_mps, course_deg).unwrap_or(airspeed_mps + wind.speed_mps());
    Some(Turn {
        at: from,
        ground_mps,
        airspeed_mps,
        fits_m: length_m / tangents,
        needed_m: radius_m(ground_mps, view.profile.max_bank_deg),
        circle,
    })
}

impl Turn {
    /// How many times too tight it is.
    fn excess(&self) -> f64 {
        self.needed_m / self.fits_m
    }

    fn problem(&self, view: &View, leg: &Id) -> Option<Problem> {
        if self.excess() <= 1.0 + ROUNDING {
            return None;
        }
        let (lat, lon) = (self.at.lat_deg, self.at.lon_deg);
        let slower_mps = self.slower_mps();
        let flies = slower_mps >= view.profile.min_airspeed_mps && view.program.written(leg).is_some();
        let slower =
            if flies { format!("fly no faster than {slower_mps:.1} m/s, or ") } else { String::new() };
        let message = format!(
            "{slower}widen its turns by {:.0} m: at {lat:.5}, {lon:.5} the wind makes it {:.0} m/s over the ground, at which its steepest bank of {:.0}° gives a radius of {:.0} m; there is room for {:.0} m",
            self.needed_m - self.fits_m,
            self.ground_mps,
            view.profile.max_bank_deg,
            self.needed_m,
            self.fits_m
        );
        let problem = if self.circle { Problem::error } else { Problem::warning };
        let speed_mps = Some(Value::Constant(slower_mps));
        let fix = flies.then(|| Edit::SetSpeed { of: leg.clone(), speed_mps });
        Some(problem("turn-too-tight", message).of(leg).perhaps_fixed_by(fix))
    }

    /// The airspeed with which the same wind lets it turn as tightly, to tenths of m/s.
    fn slower_mps(&self) -> f64 {
        let ground_mps = self.ground_mps * self.excess().sqrt().recip();
        let wind_mps = self.ground_mps - self.airspeed_mps;
        (((ground_mps - wind_mps) * 10.0).floor() / 10.0).max(0.0)
    }
}
