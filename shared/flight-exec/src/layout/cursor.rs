//! Where the expansion is in the program: a small value that gives waypoint after waypoint.
//!
//! A clone of a cursor is a bookmark: the same cursor in the same [`World`] gives the same waypoints. The executor keeps one
//! before each waypoint it hands out, and goes back to it when something beyond must change.

pub(crate) mod control;
mod corner;
mod emit;
mod enter;
mod log;
mod place;
mod refresh;

pub use log::{CursorLog, LayoutError, SilentLeg};

use crate::api::Action;
use crate::layout::expand::trail::Trail;
use crate::layout::expand::{Expansion, Point};
use crate::layout::path::{Level, PathEnd, PathState};
use crate::layout::world::World;
use flight_plan::{AltitudeReference, Id, Leg, Stage};
use geometry::LatLon;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// So many steps without a single waypoint: a loop that flies nothing.
const MAX_SILENT_STEPS: usize = 2000;

/// A place in the program and the end of the path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cursor {
    /// `None`: main plan; else the emergency plan's index.
    pub section: Option<usize>,
    /// The stage's index.
    pub stage: usize,
    /// Loops around the leg, outermost first.
    pub loops: Vec<LoopFrame>,
    /// The leg's index in the innermost list.
    pub index: usize,
    /// What it is doing there.
    pub doing: CursorPhase,
    /// The end of the path.
    pub path: PathState,
    /// The end of the path when this passage began.
    pub leg_start: PathState,
    /// Altitude of this passage.
    pub level: Level,
    /// Airspeed of this passage, m/s.
    pub airspeed_mps: f64,
    /// Number of this passage; unique in a flight.
    pub passage: u64,
    /// Points of the expansion that have been given out.
    pub given: u64,
    /// Of what is left by a choice: the points given when it was read last, and whether it leaves. What was chosen there is not
    /// chosen once more when the path is laid out anew from behind it.
    pub left_or_not: Option<(u64, bool)>,
    /// What the points of this passage were laid out from.
    pub origin: Option<Origin>,
    /// The path where the hold was given on the way to the next point, if that is gone on with, or where the way was led elsewhere: the
    /// way and the climb to that point begin there, though its leg is laid out from where the path comes from.
    pub rejoined: Option<Box<PathState>>,
    /// The points of this passage (kept aside in a snapshot).
    #[serde(skip)]
    pub expansion: Option<Arc<Expansion>>,
    /// How often each intersection was passed.
    pub crossings: Vec<(Id, u64)>,
    /// Those that are not listed any more were passed at most so often.
    pub uncounted: u64,
    /// The runway that the present flight took off from; `None`: that of the plan's first take-off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub home: Option<Id>,
}

/// What a leg was laid out from, to know whether its own values have changed since.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// The end of the path.
    pub path: PathState,
    /// The wind that its turns are wide enough for, m/s.
    pub wind_mps: f64,
}

/// What a cursor is doing at its leg.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum CursorPhase {
    /// About to begin it.
    Arriving,
    /// Giving out its points.
    Flying,
    /// Done with them by a choice that has been made: it is left, when it has waited.
    Leaving,
    /// On the full turn at the end of a pass of the innermost loop.
    Turning,
    /// Circling, for a decision or a time.
    Waiting,
    /// The plan is over.
    Ended,
    /// It has landed at the end of a flight, before the stage that begins the next one.
    Grounded,
}

/// One loop around the cursor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoopFrame {
    /// Index of the iterative leg in its own list.
    pub index: usize,
    /// The pass being flown, from 1: arrivals so far plus one.
    pub iteration: u64,
    /// This pass goes backwards.
    pub reverse: bool,
    /// The loop as a whole is flown backwards: its passes end at the body's start.
    pub mirrored: bool,
    /// Legs of the body passed on the last forward pass, in order (kept aside in a snapshot).
    #[serde(skip)]
    pub trail: Trail,
    /// On a pass back: how many of the trail's legs are still to be flown.
    pub back: usize,
    /// Patterns of the body as they were flown last, by their index: flown again where the values of now make none
    /// (kept aside in a snapshot).
    #[serde(skip)]
    pub patterns: rpds::HashTrieMapSync<usize, Arc<Expansion>>,
    /// Where the path was when the loop was entered.
    pub entered: PathEnd,
    /// Number of the last passage before this activation: tells activations of the loop apart.
    pub activation: u64,
    /// Where the leg being flown leads on the way back, if not to where it began: an update has moved or removed the leg before it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub back_to: Option<PathEnd>,
}

impl LoopFrame {
    /// How many legs of its trail were passed before the one being flown: the path ends behind them.
    pub(crate) fn passed_before(&self) -> usize {
        if self.reverse { self.back.saturating_sub(1) } else { self.trail.len() }
    }
}

/// A waypoint on its way out.
#[derive(Debug, Clone, PartialEq)]
pub struct Emission {
    /// Where, how high (AMSL, metres), how fast (m/s), what.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Airspeed towards it, m/s.
    pub airspeed_mps: f64,
    /// What to do there.
    pub action: Action,
    /// Cross it before turning.
    pub fly_over: bool,
    /// A corner of the polygon around an arc.
    pub on_arc: bool,
    /// Circled for so many seconds, then left by itself (a loiter without it waits for a decision).
    pub wait_s: Option<f64>,
    /// What happened since the waypoint before it.
    pub notes: CursorLog,
    /// If something did: the cursor after it.
    pub sealed: Option<Box<Cursor>>,
}

/// What comes next.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// A waypoint.
    Waypoint(Box<Emission>),
    /// Nothing: the plan is over, or it stands on the ground until its next flight is started.
    Ended {
        /// What happened since the last waypoint.
        notes: CursorLog,
    },
    /// Nothing: it circles, for a decision or a time.
    Waiting,
    /// Nothing: a loop flies no waypoint at all, or a thousand legs one after the other.
    Stalled {
        /// What happened since the last waypoint.
        notes: CursorLog,
    },
}

impl Cursor {
    /// At the beginning of the main plan (`None`) or an emergency plan, the path ending at `path`.
    pub fn start(section: Option<usize>, path: PathState, passage: u64) -> Self {
        Self {
            section,
            stage: 0,
            loops: Vec::new(),
            index: 0,
            doing: CursorPhase::Arriving,
            path,
            leg_start: path,
            level: path.last.level,
            airspeed_mps: path.last.airspeed_mps,
            passage,
            given: 0,
            left_or_not: None,
            origin: None,
            rejoined: None,
            expansion: None,
            crossings: Vec::new(),
            uncounted: 0,
            home: None,
        }
    }

    /// The next waypoint.
    pub fn next(&mut self, world: &World) -> Step {
        let mut notes = CursorLog::default();
        for _ in 0..MAX_SILENT_STEPS {
            if let Some((point, amsl_m)) = self.point_over_known_ground(world, &mut notes) {
                let sealed = (!notes.is_empty()).then(|| Box::new(self.clone()));
                let mut emission = Box::new(self.emit(point, amsl_m, world));
                (emission.notes, emission.sealed) = (notes, sealed);
                return Step::Waypoint(emission);
            }
            match self.doing {
                CursorPhase::Ended | CursorPhase::Grounded => return Step::Ended { notes },
                CursorPhase::Waiting => return Step::Waiting,
                CursorPhase::Arriving => self.arrive(world, &mut notes),
                CursorPhase::Flying | CursorPhase::Leaving => match self.wait_due(world, &mut notes) {
                    Some(seconds) => return self.wait(seconds, notes, world),
                    None => self.leave(world, &mut notes),
                },
                CursorPhase::Turning => self.doing = CursorPhase::Arriving,
            }
        }
        Step::Stalled { notes }
    }

    /// The next point and its altitude, metres AMSL; where the ground is not known from which that counts, the leg is left instead:
    /// the altitude is not guessed.
    fn point_over_known_ground(&mut self, world: &World, notes: &mut CursorLog) -> Option<(Point, f64)> {
        let point = self.peek_point(world, notes)?;
        let amsl_m = world.amsl_m(point.level.unwrap_or(self.level), point.position, self.home.as_ref());
        if amsl_m.is_none() {
            notes.errors.push(LayoutError::unknown_ground(self.place(world).leg, point.position));
            self.expansion = None;
        }
        Some((point, amsl_m?))
    }

    /// The expansion's next point, if there is one; an open-ended one is left here when its choice says so.
    fn peek_point(&mut self, world: &World, notes: &mut CursorLog) -> Option<Point> {
        if self.doing != CursorPhase::Flying && self.doing != CursorPhase::Turning {
            return None;
        }
        if let Some(lap) = self.expansion.as_ref()?.crossing(self.given)
            && self.leaves(lap, world, notes)
        {
            return None;
        }
        let (expansion, number) = (self.expansion.as_ref()?, self.given);
        let point = expansion.point(number)?;
        let sharp = || {
            expansion
                .point(number + 1)
                .is_some_and(|next| self.is_to_be_crossed(point.position, next.position, world))
        };
        Some(Point { fly_over: point.fly_over || (expansion.may_turn_sharply(number) && sharp()), ..point })
    }

    /// A corner of a pattern that is not flown by (see [`corner`]).
    fn is_to_be_crossed(&self, at: LatLon, next: LatLon, world: &World) -> bool {
        let from = self.end_of_path().last.position;
        corner::is_to_be_crossed([from, at, next], world.profile.turn_radius_m(self.airspeed_mps))
    }

    /// It is left at this crossing: as was chosen here before, else by a choice.
    fn leaves(&mut self, lap: u64, world: &World, notes: &mut CursorLog) -> bool {
        if let Some((_, leaves)) = self.left_or_not.filter(|(given, _)| *given == self.given) {
            return leaves;
        }
        let (choice, leaves) = self.leave_open_end(lap, world, notes);
        notes.choices.push(choice);
        self.left_or_not = Some((self.given, leaves));
        leaves
    }

    /// The stages it is in.
    fn stages<'a>(&self, world: &World<'a>) -> &'a [Stage] {
        world.program.stages(self.section)
    }

    /// The stage it is in.
    pub fn current_stage<'a>(&self, world: &World<'a>) -> Option<&'a Stage> {
        self.stages(world).get(self.stage)
    }

    /// The innermost list of legs.
    pub fn list<'a>(&self, world: &World<'a>) -> &'a [Arc<Leg>] {
        let mut list = self.current_stage(world).map_or(&[][..], |s| &s.legs);
        for frame in &self.loops {
            list = list.get(frame.index).map_or(&[][..], |leg| leg.body());
        }
        list
    }

    /// The leg it is at; `None` at a take-off, a landing or the end of a list.
    pub fn leg<'a>(&self, world: &World<'a>) -> Option<&'a Leg> {
        self.list(world).get(self.index).map(Arc::as_ref)
    }

    /// True while it gives out points backwards.
    pub fn is_reverse(&self) -> bool {
        self.loops.last().is_some_and(|f| f.reverse)
    }

    /// True if no point of the present passage is left, so that the next step decides what follows.
    pub fn at_the_end_of_its_leg(&self) -> bool {
        self.expansion.as_ref().is_none_or(|e| e.count().is_none_or(|n| self.given >= n))
    }

    /// Moves the end of the path to where the aircraft is: what follows is flown from there, and what lay ahead counts as not flown.
    pub fn move_path_to(&mut self, here: PathState) {
        self.path = here;
        self.rejoined = None;
    }

    /// The same at the end of a climb: what legs without an altitude and a speed of their own inherit stays, but not what lies below.
    pub fn climb_first(&mut self, climb: PathState) {
        let mut last = PathEnd { position: climb.last.position, ..self.path.last };
        if last.level.reference == AltitudeReference::Amsl {
            last.level.metres = last.level.metres.max(climb.commanded_amsl_m);
        }
        self.move_path_to(PathState { last, ..climb });
    }

    /// The same, the way to its next point beginning at `here`, though its leg is laid out from where the path comes from.
    pub fn going_on_from(&self, here: PathState) -> Self {
        Self { rejoined: Some(Box::new(here)), ..self.clone() }
    }

    /// Where the way to its next point begins.
    pub fn end_of_path(&self) -> &PathState {
        self.rejoined.as_deref().unwrap_or(&self.path)
    }

    /// How often an intersection has been passed.
    pub fn crossings_of(&self, leg: &Id) -> u64 {
        self.crossings.iter().find(|(id, _)| id == leg).map_or(self.uncounted, |(_, n)| *n)
    }
}
