//! Emergency plans as ways out: where they are entered, what they take from there, and what gets an aircraft there.

use super::View;
use super::flown::Flown;
use aircraft::{Profile, Wind};
use flight_plan::{EmergencyPlan, Id, Runway};
use geometry::LatLon;

/// An emergency plan.
pub(super) struct Alternate<'a> {
    pub plan: &'a EmergencyPlan,
    pub runway: &'a Runway,
    /// Where it is entered, and how high, metres AMSL.
    pub entry: LatLon,
    pub entry_amsl_m: f64,
    /// Energy from the entry to the landing, joules.
    pub energy_j: f64,
    /// How high the home is from which it was flown, metres AMSL.
    home_m: f64,
}

impl Alternate<'_> {
    /// It is the way out from there: in a flight from another home it is another one.
    pub fn is_from(&self, view: &View, from: &Origin) -> bool {
        view.home_m(&from.leg) == self.home_m
    }
}

/// A place of the flight from which a way out is sought.
#[derive(Debug, Clone)]
pub(super) struct Origin {
    pub leg: Id,
    pub position: LatLon,
    pub altitude_amsl_m: f64,
    pub course_deg: f64,
    /// Since the start of the main plan, seconds.
    pub time_s: f64,
    /// Energy used until here, joules.
    pub used_j: f64,
}

impl std::fmt::Display for Origin {
    /// Which leg and where.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let LatLon { lat_deg, lon_deg } = self.position;
        write!(f, "leg `{}` at {lat_deg:.5}, {lon_deg:.5}, {:.0} m AMSL", self.leg, self.altitude_amsl_m)
    }
}

/// The emergency plans that were flown, each with its index.
pub(super) fn alternates<'a>(view: &'a View) -> impl Iterator<Item = (usize, Alternate<'a>)> {
    view.flights.emergencies.iter().filter_map(|flown| {
        let index = flown.emergency?;
        Some((index, alternate(view, index, flown)?))
    })
}

fn alternate<'a>(view: &'a View, index: usize, flown: &Flown) -> Option<Alternate<'a>> {
    let plan = view.program.flown().emergency_plans.get(index)?;
    let runway = view.program.plan.runway(&plan.runway)?;
    let first = flown.waypoints.first()?.passage;
    let at = flown.waypoints.iter().rposition(|w| w.passage == first)?;
    let entry = flown.waypoints.get(at)?;
    let (entered, landed) = (flown.reached.get(at)?, flown.points.last()?);
    Some(Alternate {
        plan,
        runway,
        entry: entry.waypoint.position,
        entry_amsl_m: entry.wanted_amsl_m,
        energy_j: landed.used_j - entered.used_j,
        home_m: flown.home_m,
    })
}

/// Seconds on the straight way from one place to another at the cruise speed; `None` if the wind doesn't let it.
pub(super) fn flying_s(profile: &Profile, from: LatLon, to: LatLon, wind: Wind) -> Option<f64> {
    let (distance_m, course_deg) = crate::layout::path::distance_and_course(from, to);
    Some(distance_m / wind.ground_speed_mps(profile.cruise_airspeed_mps, course_deg)?)
}
