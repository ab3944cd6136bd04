//! Beginning a leg.

use super::{Cursor, CursorLog, CursorPhase, LayoutError, LoopFrame, Origin, Step};
use crate::layout::expand::track::{Approach, expand};
use crate::layout::expand::trail::{Trail, Visit};
use crate::layout::expand::{ExpandError, Expansion, runway};
use crate::layout::path::PathState;
use crate::layout::world::World;
use flight_plan::{Id, Leg, LegKind, Stage, StageKind};
use geometry::LatLon;
use std::sync::Arc;

impl Cursor {
    /// At the beginning of a stage or a leg: what is it?
    pub(super) fn arrive(&mut self, world: &World, notes: &mut CursorLog) {
        self.note_seen(world);
        if let Some(stage) = self.performed_stage(world) {
            return self.perform_stage(stage, world, notes);
        }
        if let Some(frame) = self.loops.last().filter(|f| f.reverse) {
            let visit = frame.back.checked_sub(1).and_then(|i| frame.trail.get(i)).cloned();
            match visit.and_then(|visit| Some((self.list(world).get(visit.index)?, visit))) {
                Some((leg, visit)) => self.begin_backward(leg, &visit, world, notes),
                None => self.end_of_list(world, notes),
            }
            return;
        }
        let Some(leg) = self.leg(world) else {
            return self.end_of_list(world, notes);
        };
        match (&leg.kind, leg.as_fork()) {
            (LegKind::Iterative { .. }, _) => self.enter_loop(false, Trail::default()),
            (_, Some(fork)) => self.cross(leg, fork, world, notes),
            _ => self.begin(leg, None, world, notes),
        }
    }

    /// Takes down the stage and the legs from the outermost loop on.
    fn note_seen(&self, world: &World) {
        let Some(seen) = world.seen else { return };
        self.current_stage(world).iter().for_each(|stage| seen.note(&stage.id));
        self.chain(world).iter().for_each(|leg| seen.note(&leg.id));
    }

    fn begin_backward(&mut self, leg: &Leg, visit: &Visit, world: &World, notes: &mut CursorLog) {
        self.index = visit.index;
        self.note_seen(world);
        match (&leg.kind, &visit.inner) {
            (LegKind::Iterative { .. }, Some(inner)) if !inner.is_empty() => {
                self.enter_loop(true, inner.clone());
            }
            // nothing in it was flown on the way out
            (LegKind::Iterative { .. }, _) => self.leave(world, notes),
            _ => self.begin(leg, Some(visit), world, notes),
        }
    }

    fn enter_loop(&mut self, mirrored: bool, trail: Trail) {
        let back_to = self.loops.last().and_then(|around| around.back_to);
        self.loops.push(LoopFrame {
            index: self.index,
            iteration: 1,
            reverse: mirrored,
            mirrored,
            back: trail.len(),
            trail,
            patterns: rpds::HashTrieMapSync::default(),
            entered: self.path.last,
            activation: self.passage,
            back_to,
        });
        self.index = 0;
    }

    fn perform_stage(&mut self, stage: &Stage, world: &World, notes: &mut CursorLog) {
        let points = match stage.kind {
            StageKind::TakeOff => runway::take_off(stage, world),
            _ => runway::land(stage, &self.path, world),
        };
        self.airspeed_mps = world.airspeed_mps(&[], Some(stage));
        self.fly_or_refuse(&stage.id, points.map(Expansion::Points), notes);
    }

    fn begin(&mut self, leg: &Leg, visit: Option<&Visit>, world: &World, notes: &mut CursorLog) {
        let inside = self.inside(world);
        self.set_level_and_speed(leg, visit, &inside);
        let continuation = self.continuation(leg, world);
        let approach = Approach { reversed: visit, continuation, ..self.approach(&self.path) };
        self.origin = Some(Origin { path: self.path, wind_mps: world.flight.wind_mps });
        let expansion = expand(leg, &approach, &inside);
        self.fly_or_refuse(&leg.id, expansion, notes);
    }

    /// How it comes to its leg, forwards, the path ending at `path`.
    pub(super) fn approach<'a>(&self, path: &'a PathState) -> Approach<'a> {
        let (level, airspeed_mps) = (self.level, self.airspeed_mps);
        Approach { path, level, airspeed_mps, reversed: None, continuation: None }
    }

    /// A leg that can't be flown is passed without an expansion; a pattern of a loop as on the pass before.
    fn fly_or_refuse(&mut self, id: &Id, expansion: Result<Expansion, ExpandError>, notes: &mut CursorLog) {
        let refused = |why: ExpandError| {
            notes.errors.push(LayoutError::Leg { leg: id.clone(), reason: why.to_string() });
        };
        let last = || self.loops.last().filter(|frame| !frame.reverse)?.patterns.get(&self.index).cloned();
        self.expansion = expansion.map(Arc::new).map_err(refused).ok().or_else(last);
        self.begin_passage(CursorPhase::Flying);
    }

    /// Altitude and speed belong to the waypoint that is flown to: backwards, what is made of many waypoints keeps those it
    /// was flown with, up to the one that the way out came from.
    fn set_level_and_speed(&mut self, leg: &Leg, visit: Option<&Visit>, world: &World) {
        if let Some(visit) = visit {
            let (own, start) = ((visit.level, visit.airspeed_mps), &visit.start);
            let as_flown = if has_own_waypoints(leg) { own } else { (start.level, start.airspeed_mps) };
            (self.level, self.airspeed_mps) = as_flown;
        } else {
            let (chain, stage) = (self.chain(world), self.current_stage(world));
            self.level = world.level(&chain, stage, self.path.last.level);
            self.airspeed_mps = world.airspeed_mps(&chain, stage);
        }
    }

    /// Loops around the leg and the leg itself, outermost first.
    pub(crate) fn chain<'a>(&self, world: &World<'a>) -> Vec<&'a Leg> {
        let mut list = self.current_stage(world).map_or(&[][..], |s| &s.legs);
        let mut chain: Vec<&Leg> = Vec::with_capacity(self.loops.len() + 1);
        for index in self.loops.iter().map(|f| f.index).chain([self.index]) {
            let Some(leg) = list.get(index) else { break };
            chain.push(leg);
            list = leg.body();
        }
        chain
    }

    /// For an orbit: where the path goes afterwards. Looked up by a cursor that skips it; an orbit after an orbit is
    /// approached as it comes.
    pub(super) fn continuation(&self, leg: &Leg, world: &World) -> Option<LatLon> {
        if world.looking_ahead || !matches!(leg.kind, LegKind::Orbit { .. }) {
            return None;
        }
        let mut ahead = self.clone();
        ahead.doing = CursorPhase::Flying;
        ahead.expansion = None;
        let world = World { looking_ahead: true, ..*world };
        match ahead.next(&world) {
            Step::Waypoint(emission) => Some(emission.position),
            _ => None,
        }
    }
}

/// It is more than the way to one waypoint: a pattern, a holding, a track on from its fix.
pub(super) fn has_own_waypoints(leg: &Leg) -> bool {
    use LegKind::{Fa, Ha, Hf, Hm, Orbit, Pattern, Scan};
    matches!(leg.kind, Scan(_) | Orbit { .. } | Pattern(_) | Hf(_) | Ha(_) | Hm { .. } | Fa { .. })
}
