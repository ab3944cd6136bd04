//! Variables have changed: the leg being flown, and everything beyond it, with the values of now.

use super::Executor;
use crate::api::Output;
use crate::layout::cursor::{Cursor, LayoutError};
use crate::layout::path::PathEnd;
use crate::layout::stretch::IssuedWaypoint;

impl Executor {
    /// The leg that a cursor is in is over, though no other one was entered yet: it circled at that leg's end when it was sent on, or
    /// nothing is left ahead of what was beyond it.
    fn is_over(&self, cursor: &Cursor) -> bool {
        let entered = || self.flight.horizon.entered().is_some_and(|(passage, _)| *passage == cursor.passage);
        let points = || cursor.expansion.as_ref().and_then(|e| e.count());
        match self.flight.horizon.front() {
            Some(front) => front.passage != cursor.passage && entered(),
            None => points().is_some_and(|all| cursor.given >= all),
        }
    }

    /// Waypoint number `index` is the first one of the leg being flown, and from the bookmark `before` it the values of now make no
    /// such leg: why, and the number of the first waypoint behind it.
    pub(super) fn would_leave_out_the_leg_begun(
        &self,
        index: usize,
        before: &Cursor,
    ) -> Option<(LayoutError, usize)> {
        let first = self.flight.horizon.get(index).filter(|first| self.flight.horizon.is_entered(first))?;
        let before = Some(before).filter(|before| before.passage != first.passage)?;
        let error = before.clone().error_with(&first.place.leg, &self.world())?;
        // whether it is circled at its end is the present plan's business
        let is_of_it = |h: &&IssuedWaypoint| h.passage == first.passage && !h.is_loiter();
        let of_leg = self.flight.horizon.iter().skip(index).take_while(is_of_it);
        Some((error, index + of_leg.count()))
    }

    /// Brings the leg that a bookmark is in to the values of now (see [`Cursor::refresh_leg`]). If nothing is kept before it, it is
    /// joined from where the aircraft is, as far as it can be: not from the waypoint behind.
    pub(super) fn refreshed(&self, keep: usize, cursor: &mut Cursor) -> Result<bool, LayoutError> {
        let from_here = self.brought_here(keep, cursor);
        let changed = cursor.refresh_leg(&self.world())?;
        let joined =
            |mut here: Cursor| here.refresh_leg(&self.world()).is_ok_and(|other| other).then_some(here);
        if let Some(here) = from_here.filter(|_| changed).and_then(joined) {
            *cursor = here;
        }
        Ok(changed)
    }

    /// The bookmark before the current waypoint with the end of its path where the aircraft is, on the way of its leg.
    fn brought_here(&self, keep: usize, cursor: &Cursor) -> Option<Cursor> {
        let front = self.flight.horizon.front_entered()?;
        let on_the_way = keep == 0 && front.passage == cursor.passage && !self.is_muted();
        let mut brought = cursor.clone();
        let mut here = self.here();
        here.last = PathEnd { position: here.last.position, ..cursor.path.last };
        brought.move_path_to(here);
        (on_the_way && self.life.aircraft().is_some()).then_some(brought)
    }

    /// The variables have changed: lays out the leg being flown anew, and everything beyond it.
    ///
    /// The current waypoint of a pattern stays, and those nearer than the stopping distance; values that make no such leg
    /// are refused by an event while the old one goes on.
    pub(crate) fn refresh(&mut self, out: &mut Vec<Output>) {
        self.life.clock.refreshed();
        // the leg at whose end it circles is over: its new values are for the next time
        if self.flight.overrides.wait().is_some() {
            return self.replan(out);
        }
        let near = self.alterable_from();
        let after_current = near.max(1).min(self.flight.horizon.len());
        let keep = if self.bookmark(after_current).is_in_a_pattern() { after_current } else { near };
        // a pattern that is over is not to be flown once more
        let begun = self.at_the_leg_begun(keep, &self.world());
        if let Some((error, behind)) = self.would_leave_out_the_leg_begun(keep, &self.bookmark(keep)) {
            self.flight.reported.report(error, out);
            return self.replan_from(behind, false, out);
        }
        let over = begun.as_ref().is_some_and(|begun| self.leads_elsewhere(keep, begun));
        let mut cursor = begun.unwrap_or_else(|| self.bookmark(keep));
        if keep == 0 && self.is_over(&cursor) {
            return self.replan(out);
        }
        match self.refreshed(keep, &mut cursor) {
            Ok(false) if over => self.replan_with(keep, cursor, false, out),
            Ok(true) => {
                self.flight.horizon.pin(keep);
                self.replan_with(keep, cursor, false, out);
            }
            Ok(false) => self.replan(out),
            Err(error) => {
                self.flight.reported.report(error, out);
                self.replan_from(keep, false, out);
            }
        }
    }
}
