//! A plan update in flight: committed by hash, taken over at the place where the aircraft is.

use super::Executor;
use super::plan_before::PlanBefore;
use crate::api::{Event, Output, Phase, Refusal};
use crate::flight::refusal;
use crate::layout::cursor::{Cursor, CursorPhase};
use crate::layout::translate::translated;
use crate::layout::world::World;
use flight_plan::suggest::did_you_mean_leg;
use flight_plan::{Id, LegPath, Program};
use std::sync::Arc;

impl Executor {
    /// Makes the proposal the active plan.
    pub(crate) fn commit(
        &mut self,
        hash: &str,
        entry: Option<&Id>,
        out: &mut Vec<Output>,
    ) -> Result<(), Refusal> {
        let proposed = self.proposed.clone().filter(|p| **p.hash() == *hash).ok_or_else(|| {
            let advice = "was not the last acceptable one proposed: propose it first";
            refusal("not-proposed", format!("plan {hash} {advice}"))
        })?;
        if self.life.mode.is_grounded() {
            return self.commit_between_flights(proposed, entry, out);
        }
        if !self.is_flying() {
            self.activate(proposed, out);
            self.flight.horizon.clear_path();
            self.enter_phase(Phase::Idle, out);
            return Ok(());
        }
        let (carried, before, put_out) =
            (self.carried_over(&proposed, entry)?, PlanBefore::of(self), out.len());
        carried.check_home(&self.setup.program, &proposed)?;
        match carried {
            Carried::Enter(cursor) => {
                self.activate(proposed, out);
                self.jump(*cursor, out);
            }
            Carried::On { bookmarks, sealed, keep } => {
                self.flight.horizon.set_sealed(sealed);
                self.go_on_in(proposed, &bookmarks, keep, out);
            }
        }
        self.plan_before = before.until_taken(out.get(put_out..).unwrap_or_default());
        Ok(())
    }

    /// On the ground between two flights: the next one begins with the same stage, or with the one named, in the new plan.
    fn commit_between_flights(
        &mut self,
        new: Arc<Program>,
        entry: Option<&Id>,
        out: &mut Vec<Output>,
    ) -> Result<(), Refusal> {
        let Some(before) = self.grounded().cloned() else { return Ok(()) };
        let stage = entry.cloned().unwrap_or_else(|| before.place(&self.world()).stage);
        let begins = |path: &LegPath| {
            let is_stage = path.emergency_plan.is_none() && path.indices.is_empty();
            is_stage && new.flown().flights().any(|first| first == path.stage)
        };
        let Some(target) = new.path(&stage).filter(begins) else {
            let reason = format!(
                "no flight of the new plan begins with `{stage}`: name the stage that the next flight begins with in the commit, or rewind first to begin anew"
            );
            return Err(refusal("entry-needed", reason));
        };
        let cursor = before.placed_at(&target, &[], &new);
        self.activate(new, out);
        self.flight.horizon.cut(0, cursor);
        Ok(())
    }

    fn activate(&mut self, program: Arc<Program>, out: &mut Vec<Output>) {
        self.life.values.carry_over(&program.plan, out);
        let revision = self.life.revision.activate(self.is_under_way());
        let event = Event::PlanActivated { hash: program.hash().clone(), revision };
        let before = std::mem::replace(&mut self.setup.program, program);
        self.proposed = None;
        // what couldn't be flown in the old plan may come to be reported again in the new one
        self.flight.reported.clear();
        let distance_flown_m = self.path_ahead().distance_flown_m();
        self.flight.acting.carry_over(&before, &self.setup.program, distance_flown_m);
        self.flight.questions.forget_branches_gone(&self.setup.program);
        out.push(Output::Event(event));
    }

    /// The same place in the new plan; what is near stays, and what differs beyond is fed as one transaction.
    fn go_on_in(&mut self, program: Arc<Program>, bookmarks: &[Cursor], keep: usize, out: &mut Vec<Output>) {
        let before = self.setup.program.clone();
        let same = before == program;
        self.activate(program, out);
        // as it was laid out goes on what can't be laid out any more
        let left_out = bookmarks.get(keep).and_then(|at| self.would_leave_out_the_leg_begun(keep, at));
        let keep = left_out.as_ref().map_or(keep, |(_, behind)| *behind);
        if let Some((error, _)) = left_out {
            self.flight.reported.report(error, out);
        }
        let (kept, continuation) = bookmarks.split_at(keep.min(bookmarks.len()));
        let world = self.world();
        let places: Vec<_> =
            bookmarks.iter().skip(1).map(|at| (at.place(&world), at.activations())).collect();
        self.flight.horizon.carry_over(kept, places);
        self.follow_what_acts_now();
        self.forget_counts_of_loops_left(bookmarks.first());
        let Some(mut continuation) = continuation.first().cloned() else { return };
        let refreshed = if same { Ok(false) } else { self.refreshed(kept.len(), &mut continuation) };
        if let Err(error) = refreshed {
            self.flight.reported.report(error, out);
        }
        self.replan_with(kept.len(), continuation, false, out);
        self.wait_anew(&before);
    }

    /// A count belongs to an activation: a loop that the plan hasn't around the leg being flown has been left. On the way to a leg the
    /// loops around the one before it are still there.
    fn forget_counts_of_loops_left(&mut self, before: Option<&Cursor>) {
        let Some(front) = self.flight.horizon.front() else { return };
        let program = &self.setup.program;
        let path = program.path(&front.place.leg);
        let chain = path.iter().flat_map(|path| program.chain(path));
        let around = chain.filter(|leg| leg.as_loop().is_some()).map(|leg| leg.id.clone());
        let before = before.filter(|_| !self.flight.horizon.is_entered(front));
        let still_there = before.map_or(Vec::new(), |cursor| cursor.loop_ids(&self.world()));
        let loops: Vec<Id> = around.chain(still_there).collect();
        self.flight.overrides.retain_counts(|leg| loops.contains(leg));
    }

    fn carried_over(&self, new: &Arc<Program>, entry: Option<&Id>) -> Result<Carried, Refusal> {
        let world = self.world();
        let current = self.flight.horizon.front().map(|h| &h.place.leg);
        let current = current.filter(|leg| entry.is_none_or(|e| e == *leg)).and_then(|leg| new.path(leg));
        if let Some(current) = current.filter(|path| self.is_of_the_plan_flown(path, new)) {
            let keep = self.alterable_from();
            let entered = self.bookmark(0).passage;
            let translate = |i: usize| {
                let begun = self.at_the_leg_begun(i, &world);
                let kept = i.checked_sub(1).filter(|_| begun.is_none());
                let kept = kept.and_then(|i| self.flight.horizon.get(i));
                let bookmark = begun.unwrap_or_else(|| self.bookmark(i));
                translated(&bookmark, kept, &current, entered, new, &world)
            };
            let bookmarks = (0..=self.flight.horizon.len()).map(translate).collect();
            let sealed = self.flight.horizon.iter().map(|issued| {
                let sealed = issued.sealed.as_deref()?;
                Some(Box::new(translated(sealed, Some(issued), &current, entered, new, &world)))
            });
            let sealed = sealed.collect();
            return Ok(Carried::On { bookmarks, sealed, keep });
        }
        let Some(entry) = entry else {
            let reason =
                "the leg being flown is not there in the new plan: name the leg to enter in the commit";
            return Err(refusal("entry-needed", reason));
        };
        let target = new.path(entry).ok_or_else(|| {
            let meant = did_you_mean_leg(new.flown(), entry, |_| true);
            refusal("unknown-leg", format!("the new plan has no leg `{entry}`: name one of its legs{meant}"))
        })?;
        self.check_taken_off()?;
        self.check_not_a_take_off(new, &target)?;
        self.check_in_this_flight(new, &target)?;
        let now = self.place_reached();
        if target.emergency_plan.is_some() && !self.is_of_the_plan_flown(&target, new) {
            let reason =
                format!("leg `{entry}` is of an emergency plan that is not being flown: name another leg");
            return Err(refusal("unknown-leg", reason));
        }
        let mut cursor = now.placed_at(&target, &now.loop_ids(&world), new);
        cursor.move_path_to(self.here_at_level_of(&now));
        let mut values = self.life.values.clone();
        values.carry_over(&new.plan, &mut Vec::new());
        self.check_in_reach(&cursor, &World { program: new, variables: values.current(), ..world })?;
        Ok(Carried::Enter(Box::new(cursor)))
    }

    /// In the new plan too, a path is in the main plan, or in the emergency plan that is being flown.
    fn is_of_the_plan_flown(&self, path: &LegPath, new: &Program) -> bool {
        let plan = path.emergency_plan.and_then(|i| new.plan.emergency_plans.get(i)).map(|p| &p.id);
        plan == self.flight.emergencies.plan()
    }

    /// At the beginning of the leg being flown, when waypoint number `index` is its first and still ahead (after a
    /// resume it comes behind the place where the hold was given): that waypoint's bookmark is at the end of the leg before it, and a leg that a new
    /// plan puts in between belongs to the past.
    pub(super) fn at_the_leg_begun(&self, index: usize, world: &World) -> Option<Cursor> {
        let first = self.flight.horizon.get(index)?;
        let before = Some(self.bookmark(index)).filter(|c| c.passage != first.passage)?;
        let mut begun = before.clone();
        self.flight.horizon.is_entered(first).then(|| begun.next(world))?;
        if begun.place(world).leg != first.place.leg {
            // what it waits for is there: that choice is made, and reported, by laying the path out
            let to = &first.place.leg;
            let moves_on = !first.is_loiter() && begun.passes_over_to(to, before.path, world);
            moves_on.then_some(())?;
        }
        (begun.path, begun.rejoined) = (before.path, before.rejoined.clone());
        begun.given = 0;
        if begun.doing != CursorPhase::Turning {
            begun.doing = CursorPhase::Arriving;
            begun.expansion = None;
            begun.passage = first.passage.saturating_sub(1);
        }
        Some(begun)
    }

    /// From the bookmark of waypoint number `index` one would come to another leg by now: to one that was left out before `begun`.
    pub(super) fn leads_elsewhere(&self, index: usize, begun: &Cursor) -> bool {
        let (mut there, world) = (self.bookmark(index), self.world());
        there.next(&world);
        there.place(&world).leg != begun.place(&world).leg
    }
}

/// How a flight goes over to a new plan.
enum Carried {
    /// Directly to an entry leg.
    Enter(Box<Cursor>),
    /// Goes on where it is.
    On {
        /// Bookmarks before each waypoint ahead, and behind the last of them.
        bookmarks: Vec<Cursor>,
        /// Likewise, behind the choices that led to each.
        sealed: Vec<Option<Box<Cursor>>>,
        /// So many of the waypoints stay.
        keep: usize,
    },
}

impl Carried {
    /// In an emergency plan, altitudes go on to count from the field that the flight took off from: the new plan has to know it.
    fn check_home(&self, old: &Program, new: &Program) -> Result<(), Refusal> {
        let cursors = match self {
            Carried::Enter(cursor) => std::slice::from_ref(&**cursor),
            Carried::On { bookmarks, .. } => bookmarks.as_slice(),
        };
        // who took off from a plan's first runway does not name it
        let first = |program: &Program| program.plan.home().map(|runway| runway.id.clone());
        let moved = first(old).filter(|id| first(new).as_ref() != Some(id));
        let gone = cursors.iter().find_map(|cursor| match &cursor.home {
            Some(id) => Some(id).filter(|id| new.plan.runway(id).is_none()),
            None => moved.as_ref().filter(|_| cursor.section.is_some()),
        });
        gone.map_or(Ok(()), |id| {
            let reason = format!(
                "the flight took off from runway `{id}`, and the altitudes above home of its emergency plan count from there: keep that runway in the plan, and the take-off there"
            );
            Err(refusal("home-gone", reason))
        })
    }
}
