//! The way to an intersection: how far, how long, and beyond what is issued.
//!
//! A circle or a racetrack takes a waypoint every few seconds: what is issued may end long before an intersection whose decision
//! is due soon. So the path is looked along as far as a question can be near, without handing anything out.

use crate::api::{DecisionRequest, Event, Output};
use crate::executor::Executor;
use crate::layout::cursor::{Cursor, Emission, Step};
use crate::layout::path::distance_and_course;
use crate::layout::stretch::Continuation;
use crate::layout::world::World;
use crate::value::Choice;
use aircraft::Wind;
use flight_plan::{DecideBefore, Id, Leg};
use geometry::LatLon;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Looked along at most so many waypoints.
const MOST_WAYPOINTS: usize = 2000;
/// Over the ground a way is never made slower, m/s: against a wind that nobody can fly in.
const LEAST_GROUND_MPS: f64 = 1.0;

/// A question about an intersection beyond what is issued.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Ahead {
    pub request: DecisionRequest,
    pub crossing: u64,
}

/// A piece of way: metres along the path, seconds in the present wind.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Way {
    pub metres: f64,
    pub seconds: f64,
}

impl Way {
    /// What is left of the way to an intersection until its decision is due; nothing, if it was due before.
    pub fn until_due(self, lead: DecideBefore) -> Way {
        let share = match lead {
            DecideBefore::Distance(metres) => 1.0 - metres / self.metres.max(f64::MIN_POSITIVE),
            DecideBefore::Time(seconds) => 1.0 - seconds / self.seconds.max(f64::MIN_POSITIVE),
        };
        let share = share.max(0.0);
        Way { metres: self.metres * share, seconds: self.seconds * share }
    }
}

/// An intersection seen from afar.
struct Sighted {
    leg: Id,
    crossing: u64,
    /// Before the intersection.
    before: Cursor,
    way: Way,
}

impl Executor {
    /// Looks along the path behind what is issued for a question that is due soon, and asks it.
    pub(crate) fn look_ahead(&mut self, out: &mut Vec<Output>) {
        self.state.ahead = self.sight().and_then(|sighted| self.soon(&sighted));
        let Some(Ahead { request, crossing }) = self.state.ahead.clone() else { return };
        let key = (request.leg.clone(), crossing);
        if !self.state.requested.contains(&key) && !self.has_decision(&key.0, crossing) {
            self.state.requested.push(key);
            out.push(Output::Event(Event::DecisionRequested(request)));
        }
    }

    fn soon(&self, sighted: &Sighted) -> Option<Ahead> {
        let fork = self.program.leg(&sighted.leg)?.as_fork()?;
        let left = sighted.way.until_due(fork.decide_before);
        // one that comes into sight after its deadline is asked when it is issued
        if left.seconds > self.config.ask_ahead_s || left.seconds <= 0.0 {
            return None;
        }
        let request = self.request(&sighted.leg, sighted.crossing, &sighted.before, left)?;
        Some(Ahead { request, crossing: sighted.crossing })
    }

    /// The first intersection behind what is issued, if it may be asked about now.
    fn sight(&self) -> Option<Sighted> {
        if !self.program.has_forks() {
            return None;
        }
        let (mut cursor, waited) = self.onward_cursor()?;
        let stages = self.program.stages(cursor.section).iter().skip(cursor.stage);
        let lead_s = stages.filter_map(|s| self.longest_lead_s(&s.legs)).reduce(f64::max)?;
        let mut world = World { waited, ..self.world() };
        let mut way = self.way_along(self.state.issued.len());
        for _ in 0..MOST_WAYPOINTS {
            if way.seconds > lead_s + self.config.ask_ahead_s {
                return None;
            }
            let before = cursor.clone();
            let (notes, emission) = match cursor.next(&world) {
                Step::Waypoint(emission) => (emission.notes.clone(), Some(emission)),
                Step::Ended { notes } => (notes, None),
                Step::Waiting | Step::Stalled { .. } => return None,
            };
            let fork = notes.choices.iter().find_map(|choice| match choice {
                Choice::Branch { leg, crossing, .. } => Some((leg.clone(), *crossing)),
                _ => None,
            });
            if let Some((leg, crossing)) = fork {
                return Some(Sighted { leg, crossing, before, way });
            }
            let emission = emission?;
            let from = before.path.last.position;
            way = self.along(way, from, emission.position, emission.airspeed_mps);
            way.seconds += emission.wait_s.unwrap_or(0.0);
            if emission.wait_s.is_some() {
                (cursor, world.waited) = waited_out(*emission, before);
            }
        }
        None
    }

    /// Where the path goes on behind what is issued, a wait there being over.
    fn onward_cursor(&self) -> Option<(Cursor, Option<u64>)> {
        match (self.state.continuation, self.state.issued.back()) {
            (Continuation::Open, _) => Some((self.state.tail.clone()?, self.state.waited)),
            (Continuation::Waiting, Some(last)) if last.wait_s.is_some() => {
                let before = last.sealed.as_deref().unwrap_or(&last.before).clone();
                Some((before, Some(last.passage)))
            }
            _ => None,
        }
    }

    /// The earliest that any of these legs wants a decision, seconds before its intersection.
    fn longest_lead_s(&self, legs: &[Arc<Leg>]) -> Option<f64> {
        let slowest_mps = self.profile.min_airspeed_mps.max(LEAST_GROUND_MPS);
        let of = |leg: &Arc<Leg>| match leg.as_fork() {
            Some(fork) if fork.branches.len() > 1 => Some(match fork.decide_before {
                DecideBefore::Distance(metres) => metres / slowest_mps,
                DecideBefore::Time(seconds) => seconds,
            }),
            _ => self.longest_lead_s(leg.body()),
        };
        legs.iter().filter_map(of).reduce(f64::max)
    }

    /// From the aircraft along the first waypoints issued.
    pub(super) fn way_along(&self, waypoints: usize) -> Way {
        let mut at = self.state.aircraft.as_ref().map(|a| a.position);
        let mut way = Way::default();
        for waypoint in self.state.issued.iter().take(waypoints).map(|h| &h.waypoint) {
            if let Some(from) = at {
                way = self.along(way, from, waypoint.position, waypoint.airspeed_mps);
            }
            at = Some(waypoint.position);
        }
        way
    }

    /// One straight piece more, at the speed over the ground.
    fn along(&self, way: Way, from: LatLon, to: LatLon, airspeed_mps: f64) -> Way {
        let (metres, course_deg) = distance_and_course(from, to);
        let wind = self
            .state
            .aircraft
            .as_ref()
            .map_or(Wind::CALM, |a| Wind { east_mps: a.wind_east_mps, north_mps: a.wind_north_mps });
        let mps = wind.ground_speed_mps(airspeed_mps, course_deg).unwrap_or(LEAST_GROUND_MPS);
        Way { metres: way.metres + metres, seconds: way.seconds + metres / mps.max(LEAST_GROUND_MPS) }
    }
}

/// The cursor that leaves the place where it has circled, and the passage of which that is true.
fn waited_out(emission: Emission, before: Cursor) -> (Cursor, Option<u64>) {
    let before = emission.sealed.map_or(before, |sealed| *sealed);
    let passage = before.passage;
    (before, Some(passage))
}
