//! A plan laid out as waypoints, with the ways to be reviewed chosen beforehand.

use crate::api::{Action, Token, Waypoint};
use crate::executor::Executor;
use crate::layout::cursor::{Cursor, CursorPhase, LayoutError, Step};
use crate::layout::world::World;
use crate::value::{By, Choice, Decision, LoopCount};
use flight_plan::{Id, LegKind, Program};
use std::collections::{HashMap, HashSet};

/// Passes of each loop: the first is entered from outside, the second from the loop's own end.
const PASSES: u64 = 2;
/// Passings of each intersection for which a branch is chosen beforehand.
const CROSSINGS: u64 = 8;
/// Longest path, waypoints and seconds without wind.
const MAX_WAYPOINTS: usize = 50_000;
const MAX_S: f64 = 6.0 * 3600.0;

/// A waypoint with what it was made for.
pub(super) struct LaidOut {
    pub waypoint: Waypoint,
    /// Altitude that its leg asks for there, metres AMSL; the waypoint's may be short of it in a climb.
    pub wanted_amsl_m: f64,
    /// The passage of a leg that it belongs to.
    pub passage: u64,
}

/// A way through the plan.
#[derive(Default)]
pub(super) struct Layout {
    pub waypoints: Vec<LaidOut>,
    /// Branches taken, with their intersections.
    pub taken: HashSet<(Id, Id)>,
    /// Legs that can't be flown, and why.
    pub refused: Vec<(Id, String)>,
    /// Legs that are left because nothing is known of the ground from which their altitude counts, and what to do about it.
    pub without_ground: Vec<(Id, String)>,
    /// It came to the plan's end, or to that of one of its flights.
    pub complete: bool,
    /// Where the flight behind that begins.
    pub next: Option<Cursor>,
    /// What `home` altitudes count from in it: its take-off runway, and how high that is, metres AMSL.
    pub home: Option<Id>,
    pub home_m: f64,
    /// So many of the waypoints are aboard already.
    pub kept: usize,
    /// Index of the first waypoint that a real flight may come to later than this one: a loop was left early, a holding or a wait.
    pub hurried_from: Option<usize>,
}

/// Every leg of a program.
fn legs(program: &Program) -> impl Iterator<Item = &flight_plan::Leg> {
    program.flown().all_legs().into_iter().map(|context| context.leg)
}

/// Where a way begins: behind waypoints that are flown anyway.
pub(super) struct StartPoint {
    pub kept: Vec<LaidOut>,
    pub cursor: Cursor,
}

/// Counts for every loop; those that it begins in go on to the end of their next pass.
pub(super) fn counts(executor: &Executor, from: &Cursor) -> Vec<LoopCount> {
    let world = executor.world();
    let going_on = from.loops.iter().zip(from.chain(&world)).filter_map(|(frame, leg)| {
        let set = world.count_of(&leg.id, frame.activation).map(|n| n as f64);
        let most = match leg.as_loop()?.count {
            Some(flight_plan::Value::Constant(n)) => set.unwrap_or(*n),
            _ => set.unwrap_or(f64::INFINITY),
        };
        let count = most.min(frame.iteration as f64 + 1.0) as u64;
        Some(LoopCount { leg: leg.id.clone(), activation: Some(frame.activation), count })
    });
    going_on.chain(first_counts(world.program)).collect()
}

/// Counts for every loop that is entered.
fn first_counts(program: &Program) -> Vec<LoopCount> {
    let is_loop = |leg: &&flight_plan::Leg| matches!(leg.kind, LegKind::Iterative { .. });
    let count = |leg: &flight_plan::Leg| {
        let LegKind::Iterative { count: Some(flight_plan::Value::Constant(n)), .. } = &leg.kind else {
            return PASSES;
        };
        PASSES.min(n.max(1.0) as u64)
    };
    let count_of =
        |leg: &flight_plan::Leg| LoopCount { leg: leg.id.clone(), activation: None, count: count(leg) };
    legs(program).filter(is_loop).map(count_of).collect()
}

/// Loops that are flown less often here than they may be in flight.
fn shortened(program: &Program) -> HashSet<Id> {
    let is_cut = |leg: &&flight_plan::Leg| match &leg.kind {
        LegKind::Iterative { count: Some(flight_plan::Value::Constant(n)), .. } => *n > PASSES as f64,
        LegKind::Iterative { .. } => true,
        _ => false,
    };
    legs(program).filter(is_cut).map(|leg| leg.id.clone()).collect()
}

/// A way through the plan's intersections: the number of the branch that is taken at the first crossing of each.
#[derive(Clone, Default)]
pub(super) struct Way {
    /// Of those that are not named.
    pub others: u64,
    pub named: HashMap<Id, u64>,
}

impl Way {
    /// The same number for all.
    pub fn all(number: u64) -> Self {
        Self { others: number, named: HashMap::new() }
    }
}

/// The branch for each of the next crossings of each intersection: after the way's own the others in turn.
pub(super) fn decisions(program: &Program, way: &Way, from: &Cursor) -> Vec<Decision> {
    let mut decisions = Vec::new();
    for leg in legs(program) {
        let LegKind::Intersection { branches, .. } = &leg.kind else { continue };
        let first = way.named.get(&leg.id).copied().unwrap_or(way.others);
        for next in 0..CROSSINGS {
            let crossing = from.crossings_of(&leg.id) + next + 1;
            let which = (first + next) % (branches.len() as u64).max(1);
            let branch = branches.get(which as usize).map(|b| b.id.clone());
            let decision = |branch| Decision {
                leg: leg.id.clone(),
                crossing,
                branch,
                by: By::Somebody("review".into()),
            };
            decisions.extend(branch.map(decision));
        }
    }
    decisions
}

/// The waypoints from an start_point to the end of its plan.
pub(super) fn lay_out(
    executor: &Executor,
    StartPoint { kept, mut cursor }: StartPoint,
    counts: &[LoopCount],
    decisions: &[Decision],
) -> Layout {
    let mut layout = Layout { kept: kept.len(), waypoints: kept, ..Layout::default() };
    let mut world = World { counts, decisions, ..executor.world() };
    (layout.home, layout.home_m) = (cursor.home.clone(), world.home_m(cursor.home.as_ref()));
    let from_s = cursor.path.time_s;
    let endless = shortened(world.program);
    while layout.waypoints.len() < MAX_WAYPOINTS && cursor.path.time_s - from_s < MAX_S {
        let released = release(&mut world, &cursor);
        let loops = cursor.place(&world).iterations;
        if released || loops.iter().any(|iteration| endless.contains(&iteration.leg)) {
            layout.hurry();
        }
        match cursor.next(&world) {
            Step::Waypoint(emission) => {
                let waits = emission.wait_s.is_some();
                layout.take(*emission, &cursor, &world);
                if waits {
                    layout.hurry();
                    go_on(&mut world, &mut cursor);
                }
            }
            Step::Ended { notes } => {
                layout.note(notes);
                layout.complete = true;
                layout.next = cursor.next_flight(&world);
                break;
            }
            Step::Stalled { notes } => {
                layout.note(notes);
                break;
            }
            Step::Waiting => break,
        }
    }
    layout
}

/// A wait is over: the leg is at its end once more, as before its circle was given out.
fn go_on(world: &mut World, cursor: &mut Cursor) {
    world.waited = Some(cursor.passage);
    cursor.doing = CursorPhase::Flying;
    cursor.given = cursor.given.saturating_sub(1);
}

/// A holding that only its condition or a command ends is left after [`PASSES`] laps; true: now.
fn release(world: &mut World, cursor: &Cursor) -> bool {
    let open = cursor.leg(world).is_some_and(|leg| matches!(leg.kind, LegKind::Hm { .. }));
    let lap = cursor.expansion.as_ref().filter(|_| open).and_then(|e| e.crossing(cursor.given));
    let enough = lap.is_some_and(|lap| lap >= PASSES);
    if enough {
        world.released = Some(cursor.passage);
    }
    enough
}

impl Layout {
    /// From here on a real flight may be later.
    fn hurry(&mut self) {
        self.hurried_from.get_or_insert(self.waypoints.len());
    }

    fn take(&mut self, emission: crate::layout::cursor::Emission, cursor: &Cursor, world: &World) {
        let leg = cursor.place(world).leg;
        let last = &cursor.path.last;
        let waypoint = Waypoint {
            token: Token(self.waypoints.len() as u64 + 1),
            position: emission.position,
            altitude_amsl_m: emission.altitude_amsl_m,
            airspeed_mps: emission.airspeed_mps,
            action: emission.action,
            fly_over: emission.fly_over,
            on_arc: emission.on_arc,
            leg,
            end_of_plan: false,
        };
        let wanted_amsl_m = match emission.action {
            Action::TakeOff { .. } | Action::Land { .. } => emission.altitude_amsl_m,
            Action::Fly | Action::Loiter { .. } => world
                .amsl_m(last.level, last.position, cursor.home.as_ref())
                .unwrap_or(emission.altitude_amsl_m),
        };
        let passage = cursor.passage;
        self.waypoints.push(LaidOut { waypoint, wanted_amsl_m, passage });
        self.note(emission.notes);
    }

    fn note(&mut self, notes: crate::layout::cursor::CursorLog) {
        for choice in notes.choices {
            if let Choice::Branch { leg, branch: Some(branch), .. } = choice {
                self.taken.insert((leg, branch));
            }
        }
        for trouble in notes.errors {
            match trouble {
                LayoutError::Leg { leg, reason } => self.refused.push((leg, reason)),
                LayoutError::Ground { leg, reason } => self.without_ground.push((leg, reason)),
                LayoutError::Expression { .. } => {}
            }
        }
    }
}
