//! Places: where a cursor is, for people, and a cursor at a given leg.

use super::enter::has_own_waypoints;
use super::{Cursor, CursorPhase, LoopFrame};
use crate::api::{Branching, IterationPlace, PlacePointer};
use crate::layout::expand::trail::Trail;
use crate::layout::path::PathState;
use crate::layout::world::World;
use flight_plan::{Id, LegPath, Program};

/// Most legs in a row that were left out and are passed over when one behind them is gone on with.
const MAX_LEFT_OUT: usize = 100;

impl Cursor {
    /// Where it is, for people; the distance is left at zero.
    pub fn place(&self, world: &World) -> PlacePointer {
        let stage = self.current_stage(world).map_or_else(|| Id::new(""), |s| s.id.clone());
        let chain = self.chain(world);
        let turning = self.doing == CursorPhase::Turning;
        let innermost = chain.get(self.loops.len().saturating_sub(1)).filter(|_| turning);
        let leg = innermost.or(chain.get(self.loops.len())).map_or_else(|| stage.clone(), |l| l.id.clone());
        PlacePointer {
            plan: self.branching(world.program),
            stage,
            leg,
            iterations: self.iterations(world),
            reverse: self.is_reverse(),
            distance_m: 0.0,
        }
    }

    /// Main plan or which emergency plan.
    pub fn branching(&self, program: &Program) -> Branching {
        let plan = self.section.and_then(|i| program.plan.emergency_plans.get(i));
        plan.map_or(Branching::Main, |p| Branching::Emergency(p.id.clone()))
    }

    fn iterations(&self, world: &World) -> Vec<IterationPlace> {
        let chain = self.chain(world);
        let of = |frame: &LoopFrame, leg: &flight_plan::Leg| {
            let count = leg.as_loop().and_then(|l| l.count);
            let inside = world.in_iteration(frame.iteration);
            let own = count.and_then(|c| inside.number(c).ok()).map(|n| n.max(1.0) as u64);
            world.count_of(&leg.id, frame.activation).or(own)
        };
        let named = self.loops.iter().zip(chain);
        named
            .map(|(frame, leg)| IterationPlace {
                leg: leg.id.clone(),
                iteration: frame.iteration,
                of: of(frame, leg),
                reverse: frame.reverse,
            })
            .collect()
    }

    /// Goes over legs that were left out when a leg was reached (their values made nothing to fly) and could be flown by now, though the
    /// path ended at `path`: they belong to the past. False: the leg is not behind such legs.
    pub fn passes_over_to(&mut self, leg: &Id, path: PathState, world: &World) -> bool {
        let mut passed = 0;
        while self.place(world).leg != *leg {
            let left_out =
                self.doing == CursorPhase::Flying && self.leg(world).is_some_and(has_own_waypoints);
            if !left_out || passed == MAX_LEFT_OUT {
                return false;
            }
            (self.path, self.leg_start) = (path, path);
            self.abandon_leg(self.passage);
            self.next(world);
            passed += 1;
        }
        true
    }

    /// The activations of its loops, outermost first.
    pub fn activations(&self) -> Vec<u64> {
        self.loops.iter().map(|frame| frame.activation).collect()
    }

    /// The innermost-first identifiers of its loops, with their frames.
    pub fn loop_ids(&self, world: &World) -> Vec<Id> {
        self.chain(world).into_iter().take(self.loops.len()).map(|leg| leg.id.clone()).collect()
    }

    /// The same path, at the beginning of another leg (or stage). Loops that stay around it keep their counters, the
    /// others begin with their first pass.
    pub fn moved_to(&self, target: &LegPath, world: &World) -> Cursor {
        let known = self.loop_ids(world);
        self.placed_at(target, &known, world.program)
    }

    /// As [`Cursor::moved_to`] in a program that may be another one: `known` names this cursor's loops.
    pub fn placed_at(&self, target: &LegPath, known: &[Id], program: &Program) -> Cursor {
        let chain = program.chain(target);
        let outer = target.indices.split_last().map_or(&[][..], |(_, outer)| outer);
        let same_section = self.section == target.emergency_plan;
        let loops = outer.iter().zip(chain).map(|(index, leg)| {
            let old = known.iter().position(|id| *id == leg.id).filter(|_| same_section);
            let old = old.and_then(|i| self.loops.get(i));
            LoopFrame {
                index: *index,
                iteration: old.map_or(1, |f| f.iteration),
                reverse: false,
                mirrored: false,
                trail: Trail::default(),
                patterns: rpds::HashTrieMapSync::default(),
                back: 0,
                entered: self.path.last,
                activation: old.map_or(self.passage, |f| f.activation),
                back_to: None,
            }
        });
        // an emergency plan is flown from the home of the flight in which it came
        let home = match target.emergency_plan {
            None => home_of(program, target.stage),
            Some(_) => self.home.clone(),
        };
        Cursor {
            home,
            section: target.emergency_plan,
            stage: target.stage,
            loops: loops.collect(),
            index: target.indices.last().copied().unwrap_or(0),
            doing: CursorPhase::Arriving,
            expansion: None,
            given: 0,
            leg_start: self.path,
            ..self.clone()
        }
    }
}

/// What [`Cursor::home`] is at a stage of the main plan.
pub(super) fn home_of(program: &Program, stage: usize) -> Option<Id> {
    let first = program.plan.home().map(|runway| &runway.id);
    program.plan.home_at(stage).map(|runway| &runway.id).filter(|id| first != Some(*id)).cloned()
}
