//! The engine is out, and an emergency plan is flown: as much of it as the height allows. Where it does not suffice for the rest of the
//! plan, what lies between is left out; a holding is left when the way home from there takes what is left. Where it is more than the way
//! to the landing can lose, that is said in time.

use super::Executor;
use crate::api::{AircraftState, Event, Output};
use crate::layout::cursor::Cursor;
use crate::layout::homeward::{Arrival, GlideIn, Halt, halts};
use crate::layout::touch_down::TouchDown;
use aircraft::glide::GlideStart;
use flight_plan::{Id, Runway};

/// A part of the plan that is gone to at once.
struct Shortcut {
    to: Id,
    arrival: Option<Arrival>,
    /// It lands on the runway from its other end.
    from_other_end: bool,
}

impl Executor {
    /// The aircraft reports where it is.
    pub(super) fn aircraft_reported(&mut self, state: AircraftState, out: &mut Vec<Output>) {
        let was_out = self.life.aircraft().is_some_and(|before| before.engine_out);
        self.life.put_aircraft(Some(state));
        if state.engine_out != was_out {
            self.flight.emergencies.engine_changes(state.engine_out);
        }
        if !state.engine_out || self.flight.emergencies.plan().is_none() || self.is_muted() {
            return;
        }
        // perhaps a while ago: it was held, or somebody else flew
        let stopped_since = self.flight.emergencies.is_laid_out();
        match self.shortcut(&state) {
            Some(shortcut) => self.take(shortcut, out),
            None if stopped_since => self.replan(out),
            None => {}
        }
        self.tell_long_landing(&state, out);
    }

    /// The way down that is laid out up to its landing ends beyond the runway, whatever is left out of it: told once, until another way is
    /// laid out.
    fn tell_long_landing(&mut self, state: &AircraftState, out: &mut Vec<Output>) {
        let Some((leg, runway, end)) = self.long_landing(state) else { return };
        if !self.flight.emergencies.first_told_long() {
            return;
        }
        let TouchDown { over_m, behind_m, beyond_m } = end;
        let reason = format!(
            "the engine is out, and the height can't be lost on the way ahead: it comes over the threshold of `{runway}` at least \
             {over_m:.0} m high, touches down {behind_m:.0} m behind it, and comes to rest about {beyond_m:.0} m beyond the runway's end"
        );
        let code = "glide-long".into();
        out.push(Output::Event(Event::ProblemAhead { leg: Some(leg), code, reason }));
    }

    /// The landing ahead, its runway, and where it ends if that is beyond it.
    fn long_landing(&self, state: &AircraftState) -> Option<(Id, Id, TouchDown)> {
        let horizon = &self.flight.horizon;
        let (landing, section) = (horizon.back()?, horizon.tail()?.section?);
        let plan = self.setup.program.flown().emergency_plans.get(section)?;
        let runway = self.setup.program.plan.runway(&plan.runway)?;
        let ahead = horizon.iter().map(|issued| &issued.waypoint);
        let end = TouchDown::of(&self.setup.profile, state, ahead, runway)?;
        (end.beyond_m > 0.0).then(|| (landing.place.leg.clone(), runway.id.clone(), end))
    }

    /// The beginning of an emergency plan, or with the engine out the first part of it that the height suffices for: what is out of reach
    /// is not handed out.
    pub(super) fn begun_in_reach(&self, begin: Cursor, out: &mut Vec<Output>) -> Cursor {
        let glides = self.life.aircraft().filter(|state| state.engine_out && !self.is_muted());
        let shortcut =
            glides.zip(begin.section).and_then(|(s, section)| self.shortcut_from(s, section, (0, 0), false));
        let target = shortcut.as_ref().and_then(|shortcut| self.setup.program.path(&shortcut.to));
        let Some((shortcut, target)) = shortcut.zip(target) else { return begin };
        out.push(shortcut.told());
        begin.moved_to(&target, &self.world())
    }

    /// Where to go at once, if the height does not suffice for all that is ahead.
    fn shortcut(&self, state: &AircraftState) -> Option<Shortcut> {
        let front = self.flight.horizon.front()?;
        let path = self.setup.program.path(&front.place.leg)?;
        let leg = (path.stage, path.indices.first().copied().unwrap_or(0));
        self.shortcut_from(state, path.emergency_plan?, leg, front.waypoint.on_arc)
    }

    /// The same from a leg of an emergency plan on (indices of its stage and, in that, of the leg): the first part from which the height
    /// suffices, else the landing. `circles`: around a place on the final approach.
    fn shortcut_from(
        &self,
        state: &AircraftState,
        section: usize,
        leg: (usize, usize),
        circles: bool,
    ) -> Option<Shortcut> {
        let plan = self.setup.program.flown().emergency_plans.get(section)?;
        let runway = self.setup.program.plan.runway(&plan.runway)?;
        let halts = halts(&self.world(), section, leg);
        let last = halts.len().checked_sub(1)?;
        let spare_m = |from: usize| {
            // whoever leaves the circles of a landing need not go back to where its final begins
            let ahead = if last == 0 { &[] } else { halts.get(from..)? };
            let arrival = self.arrival(state, ahead, runway);
            Some((arrival, arrival.map_or(f64::NEG_INFINITY, |a| a.spare_m())))
        };
        // on the final approach nothing can be left out but the circles before it
        if spare_m(0)?.1 >= 0.0 || (last == 0 && !circles) {
            return None;
        }
        let enough = (1..last).find(|from| spare_m(*from).is_some_and(|(_, spare_m)| spare_m >= 0.0));
        let chosen = halts.get(enough.unwrap_or(last))?;
        let (arrival, from_other_end) = match enough {
            Some(from) => (spare_m(from)?.0, false),
            None => {
                let lands = GlideIn::of(&self.world(), state.wind(), glide_from(state), runway);
                (lands.arrival, lands.from_other_end)
            }
        };
        Some(Shortcut { to: chosen.id.clone(), arrival, from_other_end })
    }

    /// The glide from here by way of what is ahead.
    fn arrival(&self, state: &AircraftState, halts: &[Halt], runway: &Runway) -> Option<Arrival> {
        let places = halts.iter().filter_map(|halt| halt.place);
        Arrival::of(&self.world(), state.wind(), glide_from(state), places, runway)
    }

    fn take(&mut self, shortcut: Shortcut, out: &mut Vec<Output>) {
        let section = self.flight.horizon.tail().and_then(|tail| tail.section);
        let Ok(cursor) = self.cursor_at(&shortcut.to, section) else { return };
        out.push(shortcut.told());
        self.jump(cursor, out);
    }
}

impl Shortcut {
    fn told(&self) -> Output {
        let Self { to, arrival, from_other_end } = self;
        let outcome = match arrival {
            Some(Arrival { height_m, .. }) if *height_m >= 0.0 => {
                let end = if *from_other_end { "at the runway's other end" } else { "there" };
                format!("{end} it is {height_m:.0} m above the threshold")
            }
            Some(Arrival { height_m, .. }) => {
                format!("even so {:.0} m are lacking: be ready to land elsewhere", -height_m)
            }
            None => "even so it does not get there against the wind: be ready to land elsewhere".into(),
        };
        let reason = format!(
            "the engine is out, and the height does not suffice for all that is ahead: straight to `{to}`, {outcome}"
        );
        Output::Event(Event::ProblemAhead { leg: Some(to.clone()), code: "glide-shortened".into(), reason })
    }
}

fn glide_from(state: &AircraftState) -> GlideStart {
    let AircraftState { position, altitude_amsl_m, track_deg: course_deg, .. } = *state;
    GlideStart { position, altitude_amsl_m, course_deg }
}
