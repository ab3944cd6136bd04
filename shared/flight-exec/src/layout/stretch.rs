//! Waypoints issued and not flown yet, each with the bookmark it was made from.

use crate::api::{Action, PlacePointer, Token, Waypoint};
use crate::layout::cursor::{Cursor, CursorLog, CursorPhase, Emission, LayoutError, SilentLeg, Step};
use crate::layout::path::distance_m;
use crate::layout::world::World;
use crate::value::Choice;
use flight_plan::Id;
use serde::{Deserialize, Serialize};

/// Two waypoints this close are the same for the autopilot, metres.
const SAME_M: f64 = 0.5;

/// One waypoint issued.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IssuedWaypoint {
    /// As it was sent.
    pub waypoint: Waypoint,
    /// Where it is in the plan.
    pub place: PlacePointer,
    /// The cursor before it, and before the choices that led to it while they are provisional.
    pub before: Cursor,
    /// Choices between the waypoint before it and this one; emptied when they are final.
    pub choices: Vec<Choice>,
    /// Legs passed there without a waypoint of their own; emptied with the choices.
    pub silent_legs: Vec<SilentLeg>,
    /// Circled here for so many seconds, then left by itself.
    pub wait_s: Option<f64>,
    /// The cursor after those choices.
    #[serde(skip)]
    pub sealed: Option<Box<Cursor>>,
    /// Passage of its leg.
    pub passage: u64,
    /// Activations of the loops around it, as its place lists them.
    pub activations: Vec<u64>,
    /// Path length at the beginning of that passage, metres since the start of the flight.
    pub leg_start_m: f64,
    /// Path length at this waypoint, metres.
    pub end_m: f64,
    /// Flying time at this waypoint, seconds.
    pub end_s: f64,
    /// The bookmark no longer gives this waypoint (its pattern was regenerated behind it): never regenerate it.
    pub pinned: bool,
}

/// How the path goes on after the last waypoint issued.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Continuation {
    /// More can be issued.
    Open,
    /// The last one ends the plan.
    Ended,
    /// The last one is circled, for a decision or a time.
    Waiting,
    /// A loop flies nothing.
    Stalled,
}

/// A stretch of path, laid out.
#[derive(Debug, Clone)]
pub struct Stretch {
    /// Its waypoints, without tokens (all zero).
    pub issued: Vec<IssuedWaypoint>,
    /// The cursor after the last.
    pub tail: Cursor,
    /// How it goes on.
    pub continuation: Continuation,
    /// What happens after the last waypoint.
    pub tail_notes: CursorLog,
    /// What went wrong on the way.
    pub errors: Vec<LayoutError>,
}

/// Lays out path from a cursor, as long as `more(count, end of path)` asks for it.
///
/// `arriving`: the first step is taken at the aircraft's own place (see [`World::arriving`]). `marked`: the waypoint before it
/// has the mark of the plan's end already.
pub fn lay_out(
    from: &Cursor,
    world: &World,
    arriving: bool,
    marked: bool,
    mut more: impl FnMut(usize, &Cursor) -> bool,
) -> Stretch {
    let mut stretch = Stretch {
        issued: Vec::new(),
        tail: from.clone(),
        continuation: Continuation::Open,
        tail_notes: CursorLog::default(),
        errors: Vec::new(),
    };
    let mut world = World { arriving, ..*world };
    while stretch.continuation == Continuation::Open && more(stretch.issued.len(), &stretch.tail) {
        let before = stretch.tail.clone();
        let step = stretch.tail.next(&world);
        world.arriving = false;
        stretch.take(step, before, marked, &world);
    }
    if stretch.continuation == Continuation::Open && stretch.tail.at_the_end_of_its_leg() {
        stretch.find_end(&world);
    }
    stretch
}

impl Stretch {
    fn take(&mut self, step: Step, before: Cursor, marked: bool, world: &World) {
        match step {
            Step::Waypoint(emission) => {
                self.issued.push(issued(*emission, before, &self.tail, world, &mut self.errors))
            }
            Step::Ended { mut notes } => {
                self.tail = before;
                self.errors.append(&mut notes.errors);
                self.tail_notes = notes;
                self.end(marked, world);
            }
            Step::Waiting => self.continuation = Continuation::Waiting,
            Step::Stalled { .. } => {
                self.tail = before;
                self.continuation = Continuation::Stalled;
            }
        }
    }

    /// The end is marked on the last waypoint; a plan that turns out to be over where the aircraft is gets one there.
    fn end(&mut self, marked: bool, world: &World) {
        self.continuation = Continuation::Ended;
        if self.issued.is_empty() && marked {
            return;
        }
        if let Some(last) = self.issued.last_mut() {
            last.waypoint.end_of_plan = true;
            return;
        }
        let path = &self.tail.path;
        let emission = Emission {
            position: path.last.position,
            altitude_amsl_m: world
                .amsl_m(path.last.level, path.last.position, self.tail.home.as_ref())
                .unwrap_or(path.commanded_amsl_m),
            airspeed_mps: path.last.airspeed_mps,
            action: Action::Fly,
            fly_over: true,
            on_arc: false,
            wait_s: None,
            // what led to the end is reported there
            notes: CursorLog::default(),
            sealed: None,
        };
        let mut last = issued(emission, self.tail.clone(), &self.tail, world, &mut self.errors);
        last.waypoint.end_of_plan = true;
        last.pinned = true;
        self.issued.push(last);
    }

    /// The horizon may end just where the plan does; then the mark must not come too late.
    fn find_end(&mut self, world: &World) {
        let mut ahead = self.tail.clone();
        if let (Step::Ended { notes }, Some(last)) = (ahead.next(world), self.issued.last_mut()) {
            last.waypoint.end_of_plan = true;
            self.tail_notes = notes;
            self.continuation = Continuation::Ended;
        }
    }
}

fn issued(
    emission: Emission,
    before: Cursor,
    after: &Cursor,
    world: &World,
    errors: &mut Vec<LayoutError>,
) -> IssuedWaypoint {
    errors.extend(emission.notes.errors);
    let place = after.place(world);
    let waypoint = Waypoint {
        token: Token(0),
        position: emission.position,
        altitude_amsl_m: emission.altitude_amsl_m,
        airspeed_mps: emission.airspeed_mps,
        action: emission.action,
        fly_over: emission.fly_over,
        on_arc: emission.on_arc,
        leg: place.leg.clone(),
        end_of_plan: false,
    };
    IssuedWaypoint {
        waypoint,
        place,
        before,
        choices: emission.notes.choices,
        silent_legs: emission.notes.silent_legs,
        wait_s: emission.wait_s,
        sealed: emission.sealed,
        passage: after.passage,
        activations: after.activations(),
        leg_start_m: after.leg_start.distance_m,
        end_m: after.path.distance_m,
        end_s: after.path.time_s,
        pinned: false,
    }
}

impl IssuedWaypoint {
    /// It is what the other one is, for the autopilot and for the plan.
    pub fn is_same_as(&self, other: &IssuedWaypoint) -> bool {
        let (a, b) = (&self.waypoint, &other.waypoint);
        a.leg == b.leg
            && a.action == b.action
            && (a.fly_over, a.on_arc, a.end_of_plan) == (b.fly_over, b.on_arc, b.end_of_plan)
            && (a.altitude_amsl_m - b.altitude_amsl_m).abs() < SAME_M
            && (a.airspeed_mps - b.airspeed_mps).abs() < 0.05
            && self.passage == other.passage
            && self.wait_s == other.wait_s
            && self.is_where(other)
    }

    /// It is at the same place as the other one.
    pub fn is_where(&self, other: &IssuedWaypoint) -> bool {
        distance_m(self.waypoint.position, other.waypoint.position) < SAME_M
    }

    /// Makes what happens before it final.
    pub fn seal(&mut self) -> (Vec<Choice>, Vec<SilentLeg>) {
        if let Some(sealed) = self.sealed.take() {
            self.before = *sealed;
        }
        (std::mem::take(&mut self.choices), std::mem::take(&mut self.silent_legs))
    }

    /// Makes what happens before a wait final, all but the choice that is waited for: that bookmark is at the intersection.
    pub fn seal_before_wait(&mut self) -> (Vec<Choice>, Vec<SilentLeg>) {
        let waiting = self.sealed.as_deref().unwrap_or(&self.before).clone();
        let passage = waiting.passage.saturating_sub(1);
        self.before = Cursor { doing: CursorPhase::Arriving, expansion: None, given: 0, passage, ..waiting };
        let open = self.choices.split_off(self.choices.len().saturating_sub(1));
        (std::mem::replace(&mut self.choices, open), std::mem::take(&mut self.silent_legs))
    }

    /// A loop that it is in will be flown so often, as its place says and the choice that led to it.
    pub fn set_count(&mut self, of_leg: &Id, count: u64) {
        let around = self.place.iterations.iter_mut().filter(|i| i.leg == *of_leg);
        around.for_each(|i| i.of = Some(count));
        for choice in &mut self.choices {
            if let Choice::Loop { leg, of, again: true, .. } = choice
                && leg == of_leg
            {
                *of = Some(count);
            }
        }
    }

    /// The aircraft circles here until something else is fed.
    pub fn is_loiter(&self) -> bool {
        matches!(self.waypoint.action, Action::Loiter { .. })
    }

    /// The aircraft circles here until somebody decides.
    pub fn waits_for_decision(&self) -> bool {
        self.is_loiter() && self.wait_s.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::path::{Level, PathEnd, PathState};
    use flight_plan::AltitudeReference;
    use geometry::LatLon;

    fn at_rest() -> IssuedWaypoint {
        let level = Level { metres: 500.0, reference: AltitudeReference::Amsl };
        let last = PathEnd { position: LatLon::new(36.5, -84.2), level, airspeed_mps: 25.0, fly_over: false };
        let path = PathState {
            last,
            course_deg: 0.0,
            predicted_amsl_m: 500.0,
            commanded_amsl_m: 500.0,
            distance_m: 0.0,
            time_s: 0.0,
        };
        let cursor = Cursor::start(None, path, 1);
        let waypoint = Waypoint {
            token: Token(1),
            position: last.position,
            altitude_amsl_m: 500.0,
            airspeed_mps: 25.0,
            action: Action::Fly,
            fly_over: false,
            on_arc: false,
            leg: "a".into(),
            end_of_plan: false,
        };
        let place = PlacePointer {
            plan: crate::api::Branching::Main,
            stage: "m".into(),
            leg: "a".into(),
            iterations: Vec::new(),
            reverse: false,
            distance_m: 0.0,
        };
        IssuedWaypoint {
            waypoint,
            place,
            before: cursor,
            choices: Vec::new(),
            silent_legs: Vec::new(),
            wait_s: None,
            sealed: None,
            passage: 1,
            activations: Vec::new(),
            leg_start_m: 0.0,
            end_m: 0.0,
            end_s: 0.0,
            pinned: false,
        }
    }

    /// Each of them is something that the autopilot or the plan would do otherwise; a token is no difference.
    #[test]
    fn one_difference_makes_another_waypoint() {
        type Change = fn(&mut IssuedWaypoint);
        let changes: [(&str, Change, bool); 11] = [
            ("token", |h| h.waypoint.token = Token(9), true),
            ("a hand's breadth", |h| h.waypoint.position.lat_deg += 1e-6, true),
            ("leg", |h| h.waypoint.leg = "b".into(), false),
            ("action", |h| h.waypoint.action = Action::Loiter { radius_m: 80.0 }, false),
            ("fly-over", |h| h.waypoint.fly_over = true, false),
            ("end of the plan", |h| h.waypoint.end_of_plan = true, false),
            ("altitude", |h| h.waypoint.altitude_amsl_m += 1.0, false),
            ("airspeed", |h| h.waypoint.airspeed_mps += 0.1, false),
            ("passage", |h| h.passage += 1, false),
            ("wait", |h| h.wait_s = Some(30.0), false),
            ("position", |h| h.waypoint.position.lat_deg += 1e-5, false),
        ];
        for (what, change, same) in changes {
            let mut other = at_rest();
            change(&mut other);
            assert_eq!(at_rest().is_same_as(&other), same, "{what}");
        }
    }
}
