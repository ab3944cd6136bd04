//! Waypoints, flown by the simulated aircraft in the wind: the path as it will be.

use super::layout::{LaidOut, Layout};
use super::prepared::When;
use crate::api::Action;
use aircraft::{Aircraft, Guidance, Profile, Target, Wind};
use flight_plan::Id;
use geometry::LatLon;
use std::f64::consts::TAU;

/// Time step of the dynamics, seconds.
const STEP_S: f64 = 0.2;
/// Steps between two points of the track: 25 m at 25 m/s.
const STEPS_A_POINT: u64 = 5;
/// Longest flight, seconds.
const MAX_S: f64 = 8.0 * 3600.0;
/// Energy that no flight uses up: how much it takes is another question than where it leads.
const PLENTY: f64 = 1e3;

/// A point of the track.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// Since the start of this flight, seconds.
    pub time_s: f64,
    pub position: LatLon,
    pub altitude_amsl_m: f64,
    /// Direction of travel, degrees true.
    pub course_deg: f64,
    /// Energy used since the start of this flight, joules.
    pub used_j: f64,
    /// Index of the waypoint (of [`Flown::waypoints`]) that is steered to.
    pub waypoint: usize,
}

/// One flight.
pub(super) struct Flown {
    pub waypoints: Vec<LaidOut>,
    pub points: Vec<Point>,
    /// Where each waypoint was reached, as far as it was.
    pub reached: Vec<Point>,
    /// `None`: the main plan; else which emergency plan.
    pub emergency: Option<usize>,
    /// Of an emergency plan: the leg from which it is entered here.
    pub entered_from: Option<Id>,
    /// The runway that it took off from (see [`Layout::home`]), and how high that is, metres AMSL.
    pub home: Option<Id>,
    pub home_m: f64,
    /// When it starts, seconds since the start of the main plan.
    pub start_s: f64,
    /// So many of the waypoints are aboard already.
    pub kept: usize,
    /// Index of the first waypoint that a real flight may come to later than this one.
    pub hurried_from: Option<usize>,
}

impl Flown {
    /// On the way into an emergency plan, from where it was flown: another rule reviews the ways from everywhere.
    pub fn enters(&self, point: &Point) -> bool {
        let passage = |index: usize| self.waypoints.get(index).map(|w| w.passage);
        self.emergency.is_some() && passage(point.waypoint) == passage(0)
    }

    /// In the air, where the aircraft is when its first waypoint is put to the gateway.
    pub fn begins_at(&self) -> Option<LatLon> {
        let first = self.waypoints.first().filter(|_| self.kept == 0)?;
        let takes_off = matches!(first.waypoint.action, Action::TakeOff { .. });
        self.points.first().filter(|_| !takes_off).map(|point| point.position)
    }

    /// When a real flight is at a point.
    pub fn when(&self, point: &Point) -> When {
        let time_s = self.start_s + point.time_s;
        // an emergency comes when it likes
        let later =
            self.emergency.is_some() || self.hurried_from.is_some_and(|first| point.waypoint >= first);
        if later { When::From(time_s) } else { When::At(time_s) }
    }

    /// The altitude that the leg asks for at the waypoint that is steered to at a point, metres AMSL.
    pub fn wanted_amsl_m(&self, point: &Point) -> Option<f64> {
        self.waypoints.get(point.waypoint).map(|w| w.wanted_amsl_m)
    }

    /// What is flown before the leg at a point, and the altitude that it asks for at its end, metres AMSL.
    pub fn before(&self, point: &Point) -> Option<(&Id, f64)> {
        let passage = self.waypoints.get(point.waypoint)?.passage;
        let behind = self.waypoints.get(..point.waypoint)?;
        let last = behind.iter().rfind(|w| w.passage != passage)?;
        Some((&last.waypoint.leg, last.wanted_amsl_m))
    }

    /// How much of what its leg is raised by arrives at a point, 0..=1: on the way to the leg's first waypoint the altitude changes
    /// evenly, behind that all of it does.
    pub fn share_of_leg(&self, point: &Point) -> f64 {
        let waypoint = |index: usize| self.waypoints.get(index);
        let ends = point.waypoint.checked_sub(1).and_then(waypoint).zip(waypoint(point.waypoint));
        let Some((before, to)) = ends.filter(|(before, to)| before.passage != to.passage) else { return 1.0 };
        let whole_m = before.waypoint.position.distance_m(to.waypoint.position);
        let left_m = point.position.distance_m(to.waypoint.position);
        if whole_m > 0.0 { (1.0 - left_m / whole_m).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// The leg that is flown before the first passage of one.
    pub fn leg_before(&self, leg: &Id) -> Option<&Id> {
        let first = self.waypoints.iter().position(|w| w.waypoint.leg == *leg)?;
        self.waypoints.get(first.checked_sub(1)?).map(|w| &w.waypoint.leg)
    }

    /// The leg that is flown at a point.
    pub fn leg(&self, point: &Point) -> Option<&Id> {
        self.waypoints.get(point.waypoint).map(|w| &w.waypoint.leg)
    }
}

/// The profile of an aircraft whose energy no flight uses up.
pub(super) fn tireless(profile: &Profile) -> Profile {
    Profile { energy_j: profile.energy_j * PLENTY, ..profile.clone() }
}

/// Flies waypoints from where the aircraft is to the last of them.
pub(super) fn fly(
    aircraft: Aircraft,
    layout: Layout,
    wind: Wind,
    emergency: Option<usize>,
    start_s: f64,
) -> Flown {
    let Layout { waypoints, hurried_from, kept, home, home_m, .. } = layout;
    let (points, reached) = (Vec::new(), Vec::new());
    let entered_from = None;
    let flown = Flown {
        waypoints,
        points,
        reached,
        emergency,
        entered_from,
        home,
        home_m,
        start_s,
        kept,
        hurried_from,
    };
    let guidance = Guidance::new(aircraft.profile().clone());
    Flight { aircraft, guidance, wind, steps: 0, steered_s: 0.0, flown }.flown()
}

struct Flight {
    aircraft: Aircraft,
    guidance: Guidance,
    wind: Wind,
    steps: u64,
    /// When the present waypoint began to be steered to.
    steered_s: f64,
    flown: Flown,
}

impl Flight {
    fn flown(mut self) -> Flown {
        let mut current = 0;
        let Some(first) = self.target(current) else { return self.flown };
        self.guidance.direct(self.aircraft.state(), first);
        while current < self.flown.waypoints.len() && self.time_s() < MAX_S {
            if self.steps.is_multiple_of(STEPS_A_POINT) {
                let point = self.point(current);
                self.flown.points.push(point);
            }
            let next = self.target(current + 1);
            let guided = self.guidance.step(self.aircraft.state(), next.as_ref());
            if guided.reached || self.circled(current) {
                let point = self.point(current);
                self.flown.reached.push(point);
                current += 1;
                self.steered_s = self.time_s();
                if let Some(next) = next {
                    self.guidance.proceed(self.aircraft.state(), next);
                }
            } else {
                self.aircraft.step(STEP_S, &guided.demand, &self.wind);
                self.steps += 1;
            }
        }
        let last = self.point(current.saturating_sub(1));
        self.flown.points.push(last);
        self.flown
    }

    fn target(&self, index: usize) -> Option<Target> {
        self.flown.waypoints.get(index).map(|w| Target::from(&w.waypoint))
    }

    fn time_s(&self) -> f64 {
        self.steps as f64 * STEP_S
    }

    fn point(&self, waypoint: usize) -> Point {
        let state = self.aircraft.state();
        let battery = self.aircraft.battery();
        Point {
            time_s: self.time_s(),
            position: state.position,
            altitude_amsl_m: state.altitude_amsl_m,
            course_deg: state.track_deg(),
            used_j: battery.capacity_j - battery.energy_left_j,
            waypoint,
        }
    }

    /// A loiter has no end of its own: the way there and one circle show where it leads.
    fn circled(&self, current: usize) -> bool {
        let Some(waypoint) = self.flown.waypoints.get(current).map(|w| &w.waypoint) else { return false };
        let Action::Loiter { radius_m } = waypoint.action else { return false };
        let speed_mps = waypoint.airspeed_mps.max(1.0);
        let from = match current.checked_sub(1).and_then(|i| self.flown.waypoints.get(i)) {
            Some(before) => before.waypoint.position,
            None => waypoint.position,
        };
        let way_m = from.distance_m(waypoint.position) + 2.0 * TAU * radius_m.abs();
        self.time_s() - self.steered_s > way_m / speed_mps
    }
}
