//! A new plan in flight: where a cursor of the old plan is in the new one.

use super::cursor::control::is_control;
use super::cursor::{Cursor, CursorPhase, LoopFrame};
use super::path::PathEnd;
use super::stretch::IssuedWaypoint;
use super::way_back::{Moved, Worlds, remapped};
use super::world::World;
use flight_plan::{Id, Leg, LegPath, Program};

/// A bookmark of the old program in the new one: the same leg, the same loops with their counters and trails, found by their
/// identifiers. In the middle of a leg that has become another kind of leg, it is the beginning of that one, on the same passage. If
/// its leg is gone, or in another of the document's plans, it is the beginning of `current` (nothing kept before it) or the end of it.
/// Loops that the new plan puts around it were `entered` after that passage, whichever bookmark it is. Where a waypoint was `kept` of
/// a leg that had been taken away and is there again, it is the beginning of that one, on the passage of the waypoint.
pub(crate) fn translated(
    cursor: &Cursor,
    kept: Option<&IssuedWaypoint>,
    current: &LegPath,
    entered: u64,
    new: &Program,
    world: &World,
) -> Cursor {
    let known = cursor.loop_ids(world);
    let placed_at = |target: &LegPath, stand: Relation| {
        let entering = Cursor { passage: entered, ..cursor.clone() };
        let mut placed = Cursor { passage: cursor.passage, ..entering.placed_at(target, &known, new) };
        restore_trails(&mut placed, (cursor, &known, world), new, target, stand);
        placed
    };
    let same_plan = |path: &LegPath| path.emergency_plan == current.emergency_plan;
    let brought_back = kept.filter(|issued| world.program.path(&issued.place.leg).is_none());
    let brought_back =
        brought_back.and_then(|issued| Some((issued, new.path(&issued.place.leg).filter(same_plan)?)));
    // on the way back, what it is to fly is no longer known
    if let Some((issued, target)) = brought_back.filter(|_| !cursor.is_reverse()) {
        let passage = issued.passage.saturating_sub(1);
        return Cursor { passage, ..placed_at(&target, Relation::Before) };
    }
    let kept_leg = kept.map(|issued| &issued.place.leg);
    let Some(target) = same_place(cursor, &known, new, world).filter(same_plan) else {
        let unfinished = cursor.doing == CursorPhase::Flying && !cursor.at_the_end_of_its_leg();
        let other_form = cursor.leg(world).filter(|_| unfinished && kept_leg.is_some());
        let other_form = other_form.filter(|leg| new.leg(&leg.id).is_some_and(|leg| !is_control(leg)));
        if let Some(target) = other_form.and_then(|leg| new.path(&leg.id)).filter(same_plan) {
            let passage = cursor.passage.saturating_sub(1);
            return Cursor { passage, ..placed_at(&target, Relation::Before) };
        }
        let Some(kept_leg) = kept_leg else { return placed_at(current, Relation::Before) };
        let fallback = new.path(kept_leg).filter(same_plan);
        let mut behind = placed_at(fallback.as_ref().unwrap_or(current), Relation::Behind);
        behind.leave_behind(&World { program: new, ..*world });
        return behind;
    };
    Cursor {
        doing: cursor.doing,
        given: cursor.given,
        expansion: cursor.expansion.clone(),
        leg_start: cursor.leg_start,
        ..placed_at(&target, Relation::AsBefore)
    }
}

/// Where a cursor stands to its leg in the new plan.
#[derive(Clone, Copy, PartialEq)]
enum Relation {
    /// As in the old plan.
    AsBefore,
    /// At its beginning.
    Before,
    /// At its end.
    Behind,
}

/// Where the new plan has the leg (or stage) that a cursor is at; on the full turn of a loop, the beginning of that loop's body.
fn same_place(cursor: &Cursor, known: &[Id], new: &Program, world: &World) -> Option<LegPath> {
    let same_kind = |id: &&Id| kind_of(world.program, id) == kind_of(new, id);
    if let Some(turned) = known.last().filter(|_| cursor.doing == CursorPhase::Turning) {
        let mut path = new.path(Some(turned).filter(same_kind)?)?;
        path.indices.push(0);
        return Some(path);
    }
    let own = cursor.leg(world).map(|l| &l.id).or(cursor.current_stage(world).map(|s| &s.id));
    new.path(own.filter(same_kind)?)
}

/// Direction and trail of each loop that is still there.
fn restore_trails(
    moved: &mut Cursor,
    (old, known, world): (&Cursor, &[Id], &World),
    new: &Program,
    target: &LegPath,
    stand: Relation,
) {
    let old_chain = old.chain(world);
    let new_chain = new.chain(target);
    let innermost = moved.loops.len().saturating_sub(1);
    let worlds = Worlds { old: *world, new: World { program: new, ..*world } };
    let mut around = None;
    for (depth, (frame, leg)) in moved.loops.iter_mut().zip(new_chain).enumerate() {
        let place = known.iter().position(|id| *id == leg.id);
        let was = place.and_then(|i| old.loops.get(i).zip(old_chain.get(i)));
        let Some((before, old_leg)) = was else { continue };
        if old_leg.as_loop().map(|l| l.form) != leg.as_loop().map(|l| l.form) {
            // forth and back has become round and round, or the reverse: directions and trails mean nothing any more
            break;
        }
        let legs = (*old_leg, leg);
        let passed = before.passed_before();
        let still = before.trail.first(before.back).unwrap_or_else(|| before.trail.clone());
        let (still, _) = remapped(&still, passed, legs, around, &worlds);
        let (trail, _) = remapped(&before.trail, passed, legs, around, &worlds);
        let entered = Moved::applied(around, before.entered);
        let first = before.trail.first(passed).unwrap_or_default();
        (_, around) = remapped(&first, passed, legs, around, &worlds);
        let at_target = still.iter().position(|visit| visit.index == moved.index);
        let back = match stand {
            Relation::Behind if depth == innermost => at_target.unwrap_or(still.len()),
            Relation::Before if depth == innermost && before.reverse => match at_target {
                Some(visit) => visit + 1,
                // it was not passed on the way out
                None => break,
            },
            _ => still.len(),
        };
        let patterns = rpds::HashTrieMapSync::default();
        let back_to = back_to(before, old, around);
        *frame = LoopFrame { index: frame.index, trail, back, patterns, entered, back_to, ..before.clone() };
    }
}

/// Where the leg being flown forwards leads on the way back, if the end of the leg before it has `moved`.
fn back_to(frame: &LoopFrame, cursor: &Cursor, moved: Option<Moved>) -> Option<PathEnd> {
    let begun = cursor.doing == CursorPhase::Flying;
    let began = if begun { cursor.leg_start.last } else { cursor.path.last };
    let known = frame.back_to.unwrap_or(began);
    let leads = Moved::applied(moved, known);
    (!frame.reverse && leads != began).then_some(leads)
}

fn kind_of(program: &Program, id: &Id) -> Option<&'static str> {
    program.leg(id).map(Leg::kind_name).or(program.path(id).map(|_| "stage"))
}
