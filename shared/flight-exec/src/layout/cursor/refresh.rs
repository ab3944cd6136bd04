//! The leg being flown with other values: a variable was written, or the plan is another one.

use super::{Cursor, CursorPhase, LayoutError, Origin, Step};
use crate::layout::expand::track::{Approach, SAME_PLACE_M, expand, passed};
use crate::layout::expand::trail::Visit;
use crate::layout::expand::{ExpandError, Expansion};
use crate::layout::path::distance_m;
use crate::layout::world::World;
use flight_plan::{FlightState, Id, Leg, LegKind};
use std::sync::Arc;

impl Cursor {
    /// Brings the leg it is in the middle of to the values of now: altitude, speed and geometry. `Ok(true)`: it is another one.
    ///
    /// A scan and the patterns like it begin anew where the path is, without what is flown and unmoved; what goes round and
    /// round (an orbit, a figure-eight) goes on at the same angle. An arc, a course, a track or a holding that has become another
    /// one is flown to from where the path is; laps flown count on. The wind alone changes nothing: turns stay as they were laid
    /// out. What is flown backwards stays as it was flown on the way out, but leads to where the leg before it ends now.
    ///
    /// # Errors
    /// The new values make no such leg; the old one stays.
    pub fn refresh_leg(&mut self, world: &World) -> Result<bool, LayoutError> {
        if self.is_reverse() {
            return Ok(self.lead_back(world));
        }
        let under_way = self.doing == CursorPhase::Flying;
        let leg = self.leg(world).filter(|leg| under_way && leg.as_fork().is_none());
        let (Some(leg), Some(old)) = (leg, self.expansion.clone()) else { return Ok(false) };
        if matches!(*old, Expansion::Points(_)) && self.at_the_end_of_its_leg() {
            return Ok(false);
        }
        let inside = self.inside(world);
        let (chain, stage) = (self.chain(world), self.current_stage(world));
        let mut fresh = self.clone();
        fresh.level = inside.level(&chain, stage, self.leg_start.last.level);
        fresh.airspeed_mps = inside.airspeed_mps(&chain, stage);
        let refused = |why: ExpandError| LayoutError::Leg { leg: leg.id.clone(), reason: why.to_string() };
        let other = fresh.regenerated(leg, &old, &inside).map_err(refused)?;
        let moved = (fresh.level, fresh.airspeed_mps) != (self.level, self.airspeed_mps);
        let changed = moved || other.is_some();
        if let Some((expansion, given)) = other {
            (fresh.expansion, fresh.given) = (Some(Arc::new(expansion)), given);
            fresh.left_or_not = None;
            fresh.origin = Some(Origin { path: self.path, wind_mps: inside.flight.wind_mps });
        }
        *self = fresh;
        Ok(changed)
    }

    /// A leg being flown backwards leads to another place, if the end of the leg before it has moved. True: it has.
    fn lead_back(&mut self, world: &World) -> bool {
        let under_way = self.doing == CursorPhase::Flying && !self.at_the_end_of_its_leg();
        let visit = self.loops.last().and_then(|frame| frame.trail.get(frame.passed_before())).cloned();
        let visit = visit.filter(|visit| under_way && visit.index == self.index);
        let (Some(visit), Some(leg), Some(old)) = (visit, self.leg(world), &self.expansion) else {
            return false;
        };
        if old.led_back_to().is_none_or(|end| distance_m(end, visit.start.position) < SAME_PLACE_M) {
            return false;
        }
        let (fresh, given) = match &leg.kind {
            LegKind::Rf { .. } => {
                let from_here = Visit { end: self.path.last, ..visit };
                let approach = Approach { reversed: Some(&from_here), ..self.approach(&self.path) };
                let Ok(arc) = expand(leg, &approach, world) else { return false };
                (arc, 0)
            }
            _ => (old.leading_back_to(passed(&visit.start)), self.given),
        };
        (self.expansion, self.given) = (Some(Arc::new(fresh)), given);
        true
    }

    /// Why a leg is passed over on the way to the next waypoint, if it is.
    pub(crate) fn error_with(mut self, leg: &Id, world: &World) -> Option<LayoutError> {
        let Step::Waypoint(emission) = self.next(world) else { return None };
        let passed = self.leg(world).is_none_or(|now| now.id != *leg);
        let of_leg = |error: &LayoutError| matches!(error, LayoutError::Leg { leg: of, .. } if of == leg);
        emission.notes.errors.into_iter().find(of_leg).filter(|_| passed)
    }

    /// It goes on with the current waypoint when its values change: its points are where they are whoever comes from where.
    pub fn is_in_a_pattern(&self) -> bool {
        let in_it = |e: &Arc<Expansion>| {
            matches!(**e, Expansion::Scan(_) | Expansion::Pattern(_) | Expansion::Orbit(_))
        };
        self.doing == CursorPhase::Flying && self.expansion.as_ref().is_some_and(in_it)
    }

    /// The leg's expansion with the values of now and the number of the point it goes on at, if it is another one.
    fn regenerated(
        &self,
        leg: &Leg,
        old: &Expansion,
        world: &World,
    ) -> Result<Option<(Expansion, u64)>, ExpandError> {
        let here = self.approach(&self.path);
        let fresh = match (old, &leg.kind) {
            (Expansion::Scan(sweeps), LegKind::Scan(scan)) => {
                sweeps.regenerated(scan, self.given, &here, world)?.map(Expansion::Scan)
            }
            (Expansion::Pattern(flight), LegKind::Pattern(pattern)) => {
                flight.regenerated(pattern, self.given, &here, world)?.map(Expansion::Pattern)
            }
            (Expansion::Orbit(_), _) => {
                // seen from where it was entered, so that the same values give the same circle
                let start = Cursor { path: self.leg_start, ..self.clone() };
                let approach = Approach {
                    continuation: start.continuation(leg, world),
                    ..self.approach(&self.leg_start)
                };
                Some(expand(leg, &approach, world)?)
            }
            _ => return self.joined_again(leg, old, world),
        };
        let fresh = fresh.filter(|fresh| fresh != old);
        Ok(fresh.map(|fresh| {
            let given = fresh.goes_on_at(self.given);
            (fresh, given)
        }))
    }

    /// A leg that leads to its place from anywhere: laid out again as it was, and from here if that gives another one.
    fn joined_again(
        &self,
        leg: &Leg,
        old: &Expansion,
        world: &World,
    ) -> Result<Option<(Expansion, u64)>, ExpandError> {
        let Some(origin) = &self.origin else { return Ok(None) };
        let flight = FlightState { wind_mps: origin.wind_mps, ..world.flight };
        let then = World { flight, ..*world };
        let again = expand(leg, &self.approach(&origin.path), &then)?;
        if again.as_flown_by(old, self.given) == *old {
            return Ok(None);
        }
        let fresh = expand(leg, &self.approach(&self.path), world)?;
        Ok(Some((fresh.after(old, self.given, self.path.last.position), 0)))
    }
}
