//! Intersections beyond what is issued.
//!
//! A circle or a racetrack takes a waypoint every few seconds: what is issued may end long before an intersection whose decision
//! is due soon. So the path is followed as far as a question can be near, without handing anything out.

use super::Questions;
use crate::api::{DecisionRequest, Event, Output};
use crate::flight::path_ahead::{MIN_GROUND_MPS, PathAhead, Way};
use crate::layout::cursor::{Cursor, Emission, Step};
use crate::layout::stretch::Continuation;
use crate::layout::world::World;
use crate::value::Choice;
use flight_plan::{DecideBefore, Id, Leg};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The path is followed for at most so many waypoints.
const MAX_WAYPOINTS: usize = 2000;

/// A question about an intersection beyond what is issued.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct DistantQuestion {
    pub request: DecisionRequest,
    pub crossing: u64,
}

impl DistantQuestion {
    pub fn is_equivalent(&self, other: &Self) -> bool {
        let Self { request, crossing } = self;
        // how far it is to the intersection is a sum over the way, and what its branches look like follows from the place
        (&request.leg, crossing) == (&other.request.leg, &other.crossing)
    }
}

/// An intersection some way ahead.
struct Upcoming {
    leg: Id,
    crossing: u64,
    /// Before the intersection.
    before: Cursor,
    way: Way,
}

impl Questions {
    /// Follows the path behind what is issued to a question that is due soon, and asks it.
    pub fn ask_ahead(&mut self, path: &PathAhead, world: &World, out: &mut Vec<Output>) {
        self.distant =
            self.next_intersection(path, world).and_then(|upcoming| self.soon(&upcoming, path, world));
        let Some(DistantQuestion { request, crossing }) = self.distant.clone() else { return };
        let key = (request.leg.clone(), crossing);
        if !self.requested.contains(&key) && !self.has_decision(&key.0, crossing) {
            self.requested.push(key);
            out.push(Output::Event(Event::DecisionRequested(request)));
        }
    }

    fn soon(&self, upcoming: &Upcoming, path: &PathAhead, world: &World) -> Option<DistantQuestion> {
        let fork = world.program.leg(&upcoming.leg)?.as_fork()?;
        let left = upcoming.way.until_due(fork.decide_before);
        // one that is found after its deadline is asked when it is issued
        if left.seconds > path.config.ask_ahead_s || left.seconds <= 0.0 {
            return None;
        }
        let request = self.request((&upcoming.leg, upcoming.crossing), &upcoming.before, left, world)?;
        Some(DistantQuestion { request, crossing: upcoming.crossing })
    }

    /// The first intersection behind what is issued, if it may be asked about now.
    fn next_intersection(&self, path: &PathAhead, world: &World) -> Option<Upcoming> {
        if !world.program.has_forks() {
            return None;
        }
        let (mut cursor, waited) = onward_cursor(path, world)?;
        let stages = world.program.stages(cursor.section).iter().skip(cursor.stage);
        let lead_s = stages.filter_map(|s| longest_lead_s(&s.legs, path)).reduce(f64::max)?;
        let mut world = World { waited, decisions: &self.decisions, ..*world };
        let mut way = path.way_along(path.horizon.len());
        for _ in 0..MAX_WAYPOINTS {
            if way.seconds > lead_s + path.config.ask_ahead_s {
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
                return Some(Upcoming { leg, crossing, before, way });
            }
            let emission = emission?;
            let from = before.path.last.position;
            way = path.along(way, from, emission.position, emission.airspeed_mps);
            way.seconds += emission.wait_s.unwrap_or(0.0);
            if emission.wait_s.is_some() {
                (cursor, world.waited) = waited_out(*emission, before);
            }
        }
        None
    }
}

/// Where the path goes on behind what is issued, a wait there being over.
fn onward_cursor(path: &PathAhead, world: &World) -> Option<(Cursor, Option<u64>)> {
    match (path.horizon.continuation(), path.horizon.back()) {
        (Continuation::Open, _) => Some((path.horizon.tail()?.clone(), world.waited)),
        (Continuation::Waiting, Some(last)) if last.wait_s.is_some() => {
            let before = last.sealed.as_deref().unwrap_or(&last.before).clone();
            Some((before, Some(last.passage)))
        }
        _ => None,
    }
}

/// The earliest that any of these legs wants a decision, seconds before its intersection.
fn longest_lead_s(legs: &[Arc<Leg>], path: &PathAhead) -> Option<f64> {
    let slowest_mps = path.profile.min_airspeed_mps.max(MIN_GROUND_MPS);
    let of = |leg: &Arc<Leg>| match leg.as_fork() {
        Some(fork) if fork.branches.len() > 1 => Some(match fork.decide_before {
            DecideBefore::Distance(metres) => metres / slowest_mps,
            DecideBefore::Time(seconds) => seconds,
        }),
        _ => longest_lead_s(leg.body(), path),
    };
    legs.iter().filter_map(of).reduce(f64::max)
}

/// The cursor that leaves the place where it has circled, and the passage of which that is true.
fn waited_out(emission: Emission, before: Cursor) -> (Cursor, Option<u64>) {
    let before = emission.sealed.map_or(before, |sealed| *sealed);
    let passage = before.passage;
    (before, Some(passage))
}
