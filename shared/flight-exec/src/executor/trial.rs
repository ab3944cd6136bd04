//! What a rehearsal or a review needs of an executor that it flies on its own: never in flight.

use super::Executor;
use crate::api::{AircraftState, Time};
use crate::flight::{Horizon, Numbers, Offset, Values};
use crate::layout::world::ReadSet;
use crate::value::Config;
use aircraft::Profile;
use flight_plan::{Id, Program};
use std::sync::Arc;
use terrain::Terrain;

impl Executor {
    /// One on the ground with a plan, its variables having their initial values.
    pub(crate) fn with_program(
        program: &Arc<Program>,
        config: Config,
        terrain: Arc<dyn Terrain>,
        profile: Profile,
    ) -> Self {
        let mut executor = Self::new(config, terrain, profile);
        executor.life.values = Values::initial(program.flown());
        executor.setup.program = program.clone();
        executor
    }

    /// The active plan, or [`Program::default`].
    pub(crate) fn active(&self) -> &Arc<Program> {
        &self.setup.program
    }

    /// Another plan, or none, takes the place of the active one: nothing else changes.
    pub(crate) fn swap_program(&mut self, program: Arc<Program>) {
        self.setup.program = program;
    }

    /// A plan may be committed, or none.
    pub(crate) fn set_proposed(&mut self, proposed: Option<Arc<Program>>) {
        self.proposed = proposed;
    }

    pub(crate) fn profile(&self) -> &Profile {
        &self.setup.profile
    }

    pub(crate) fn terrain(&self) -> &Arc<dyn Terrain> {
        &self.setup.terrain
    }

    /// The last report of the aircraft.
    pub(crate) fn aircraft(&self) -> Option<AircraftState> {
        self.life.aircraft().copied()
    }

    /// The aircraft is somewhere else.
    pub(crate) fn put_aircraft(&mut self, aircraft: Option<AircraftState>) {
        self.life.put_aircraft(aircraft);
    }

    /// The emergency that is being flown is none: another one may follow, whatever its cause.
    pub(crate) fn forget_emergency(&mut self) {
        self.flight.emergencies.end();
    }

    pub(crate) fn horizon(&self) -> &Horizon {
        &self.flight.horizon
    }

    /// To bring the bookmarks to another plan.
    pub(crate) fn horizon_mut(&mut self) -> &mut Horizon {
        &mut self.flight.horizon
    }

    pub(crate) fn numbers(&self) -> &Numbers {
        &self.life.numbers
    }

    /// Legs and loops whose actions are due in turn.
    pub(crate) fn acting_legs(&self) -> impl Iterator<Item = &Id> {
        self.flight.acting.legs()
    }

    /// Values were written that are not flown yet.
    pub(crate) fn has_refresh_due(&self) -> bool {
        self.life.clock.refresh_due_s().is_some()
    }

    /// The active plan came in flight: only what was ahead then was reviewed.
    pub(crate) fn is_reviewed_ahead_only(&self) -> bool {
        self.life.revision.is_reviewed_ahead_only()
    }

    /// The clock that it is stepped by is another one from now on; its own goes on.
    pub(crate) fn set_last_step(&mut self, last_step: Option<Time>) {
        self.last_step = last_step;
    }

    /// Begins or ends to take down what is read of the plan.
    pub(crate) fn watch(&mut self, watches: bool) {
        self.setup.seen = watches.then(ReadSet::default);
    }

    /// What has been read of the plan, if that is taken down.
    pub(crate) fn seen(&self) -> Option<&ReadSet> {
        self.setup.seen.as_ref()
    }

    /// By how much the numbers of this flight are ahead of those of another one; `None`: one of them has no path.
    pub(crate) fn offset_from(&self, other: &Self) -> Option<Offset> {
        Offset::between(
            (&self.life, &self.flight),
            (&other.life, &other.flight),
            self.setup.config.debounce_s,
        )
    }

    /// From here on it goes on as another one does, but for an offset in numbers and time.
    pub(crate) fn is_equivalent(&self, other: &Self, offset: &Offset) -> bool {
        // a rehearsal flies plan after plan with the same settings; its instants are compared where it is stepped
        let Self { setup: _, proposed: _, plan_before: _, life, flight, last_step: _ } = self;
        life.is_equivalent(&other.life, offset) && flight.is_equivalent(&other.flight, offset)
    }
}
