//! The engine is out, and an emergency plan is flown: as much of it as the height allows. Where it does not suffice for the rest of the
//! plan, what lies between is left out; a holding is left when the way home from there takes what is left. A way that leads into the
//! ground is none; where the height suffices for no other, or only for another runway, the gateway's Safe mode decides. Where it is more
//! than the way to the landing can lose, that is said in time.

use super::Executor;
use crate::api::{Action, AircraftState, Event, Output, Refusal};
use crate::flight::refusal;
use crate::layout::cursor::Cursor;
use crate::layout::homeward::{self, GlideIn, Halt, halts, is_clear, safe_runways};
use crate::layout::touch_down::TouchDown;
use aircraft::glide::GlideStart;
use aircraft::glide_in::Arrival;
use flight_plan::{Id, Runway};
use geometry::geodesy::normalise_180;

/// How the rest of an emergency plan is glided.
enum Rest {
    /// As it is written.
    Whole,
    /// A part of it is gone to at once.
    Shortened(Shortcut),
    /// Each way that the height suffices for leads into the ground.
    Blocked,
    /// The height suffices for no way to its runway, but for one to this other runway; and what it suffices for all the same.
    Elsewhere(Id, Shortcut),
}

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
        if !self.is_gliding() || self.is_muted() {
            return;
        }
        // perhaps a while ago: it was held, or somebody else flew
        let stopped_since = self.flight.emergencies.takes_stopped_engine();
        let is_taken = match self.rest(&state, stopped_since) {
            Rest::Shortened(shortcut) => self.take(shortcut, out),
            Rest::Blocked | Rest::Elsewhere(..) if stopped_since => {
                out.push(Output::Safe);
                false
            }
            Rest::Whole | Rest::Blocked | Rest::Elsewhere(..) => false,
        };
        if stopped_since && !is_taken {
            self.replan(out);
        }
        self.tell_long_landing(&state, out);
    }

    /// An emergency plan is flown without an engine.
    pub(super) fn is_gliding(&self) -> bool {
        self.life.aircraft().is_some_and(|state| state.engine_out) && self.flight.emergencies.plan().is_some()
    }

    /// Where an aircraft without an engine lands: on the runway of the emergency plan that is flown, else at home. `None`: it has its engine, or
    /// stands.
    pub(crate) fn glides_to(&self) -> Option<&Runway> {
        self.life.aircraft().filter(|state| state.engine_out && !state.on_ground)?;
        let program = &self.setup.program;
        let flown = self.flight.emergencies.plan().and_then(|plan| program.flown().emergency_plan(plan));
        flown.map_or_else(|| program.plan.home(), |plan| program.plan.runway(&plan.runway))
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
             {over_m:.0} m above it, touches down {behind_m:.0} m behind it, and comes to rest about {beyond_m:.0} m beyond the runway's end"
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

    /// Why an emergency plan is not begun with the engine out, but left to the gateway's Safe mode, which knows all runways. One that is
    /// `named` by a person goes to its runway, however far that is.
    pub(super) fn check_glide(&self, section: usize, named: bool) -> Result<(), Refusal> {
        match self.rest_of(section) {
            Some(Rest::Blocked) => {
                let reason = "each glide to its runway that the height suffices for leads into the ground: the gateway's Safe mode decides";
                Err(refusal("glide-into-terrain", reason))
            }
            Some(Rest::Elsewhere(other, _)) if !named => {
                let reason = format!(
                    "its runway is not reached without the engine, but runway `{other}` is: the gateway's Safe mode decides"
                );
                Err(refusal("another-runway-reached", reason))
            }
            _ => Ok(()),
        }
    }

    /// The beginning of an emergency plan, or with the engine out the first part of it that the height suffices for: what is out of reach
    /// is not handed out.
    pub(super) fn begun_in_reach(&self, begin: Cursor, out: &mut Vec<Output>) -> Cursor {
        let rest = begin.section.and_then(|section| self.rest_of(section));
        let Some(Rest::Shortened(shortcut) | Rest::Elsewhere(_, shortcut)) = rest else { return begin };
        let Some(target) = self.setup.program.path(&shortcut.to) else { return begin };
        out.push(shortcut.told());
        begin.moved_to(&target, &self.world())
    }

    /// How an emergency plan that begins is glided, if the engine is out.
    fn rest_of(&self, section: usize) -> Option<Rest> {
        let state = self.life.aircraft().filter(|state| state.engine_out && !self.is_muted())?;
        self.rest_from(state, section, (0, 0), false, true)
    }

    /// How what is ahead is glided. `begins`: it is not flown yet, and may lead into the ground.
    fn rest(&self, state: &AircraftState, begins: bool) -> Rest {
        let ahead = || {
            let front = self.flight.horizon.front()?;
            let path = self.setup.program.path(&front.place.leg)?;
            let leg = (path.stage, path.indices.first().copied().unwrap_or(0));
            self.rest_from(state, path.emergency_plan?, leg, front.waypoint.on_arc, begins)
        };
        ahead().unwrap_or(Rest::Whole)
    }

    /// The same from a leg of an emergency plan on (indices of its stage and, in that, of the leg): the first part from which the height
    /// suffices and the way is clear, else the landing. `circles`: around a place on the final approach.
    fn rest_from(
        &self,
        state: &AircraftState,
        section: usize,
        leg: (usize, usize),
        circles: bool,
        begins: bool,
    ) -> Option<Rest> {
        let plan = self.setup.program.flown().emergency_plans.get(section)?;
        let runway = self.setup.program.plan.runway(&plan.runway)?;
        let halts = halts(&self.world(), section, leg);
        let last = halts.len().checked_sub(1)?;
        let runway = &if circles && last == 0 { self.landed_on(runway) } else { runway.clone() };
        // whoever leaves the circles of a landing need not go back to where its final begins
        let ahead = |from: usize| if last == 0 { &[] } else { halts.get(from..).unwrap_or_default() };
        let arrival = |from: usize| self.arrival(state, ahead(from), runway).filter(|a| a.spare_m() >= 0.0);
        let clears = |from: usize| self.clears(state, ahead(from), runway);
        // on the final approach nothing can be left out but the circles before it
        if (last == 0 && !circles) || (arrival(0).is_some() && (!begins || clears(0))) {
            return Some(Rest::Whole);
        }
        let enough =
            (1..last).filter_map(|from| Some((from, arrival(from)?))).find(|(from, _)| clears(*from));
        let chosen = halts.get(enough.map_or(last, |(from, _)| from))?;
        let to = chosen.id.clone();
        if let Some((_, arrival)) = enough {
            return Some(Rest::Shortened(Shortcut { to, arrival: Some(arrival), from_other_end: false }));
        }
        let lands = GlideIn::of(&self.world(), state.wind(), glide_from(state), runway);
        if lands.is_blocked() {
            return Some(Rest::Blocked);
        }
        let GlideIn { arrival, from_other_end, .. } = lands;
        let is_reached = arrival.is_some_and(|arrival| arrival.height_m >= 0.0);
        let shortcut = Shortcut { to, arrival, from_other_end };
        let other = if begins && !is_reached { self.reached_instead(state, runway) } else { None };
        Some(match other {
            Some(other) => Rest::Elsewhere(other, shortcut),
            None => Rest::Shortened(shortcut),
        })
    }

    /// Another runway of the plan that Safe mode would land on.
    fn reached_instead(&self, state: &AircraftState, than: &Runway) -> Option<Id> {
        let is_reached =
            |runway: &Runway| GlideIn::of(&self.world(), state.wind(), glide_from(state), runway).lands();
        let mut others =
            safe_runways(&self.setup.program.plan).into_iter().filter(|runway| runway.id != than.id);
        others.find(|runway| is_reached(runway)).map(|runway| runway.id.clone())
    }

    /// A runway, from the end that the way ahead lands at.
    fn landed_on(&self, runway: &Runway) -> Runway {
        let lands = self.flight.horizon.back().map(|last| last.waypoint.action);
        let off_deg = |heading_deg| normalise_180(heading_deg - runway.heading_deg).abs();
        match lands {
            Some(Action::Land { heading_deg }) if off_deg(heading_deg) > 90.0 => {
                homeward::from_other_end(&self.world(), runway)
            }
            _ => runway.clone(),
        }
    }

    fn clears(&self, state: &AircraftState, halts: &[Halt], runway: &Runway) -> bool {
        let places = halts.iter().filter_map(|halt| halt.place);
        is_clear(&self.world(), state.wind(), glide_from(state), places, runway)
    }

    /// The glide from here by way of what is ahead.
    fn arrival(&self, state: &AircraftState, halts: &[Halt], runway: &Runway) -> Option<Arrival> {
        let places = halts.iter().filter_map(|halt| halt.place);
        homeward::arrival(&self.world(), state.wind(), glide_from(state), places, runway)
    }

    /// True: that is flown now.
    fn take(&mut self, shortcut: Shortcut, out: &mut Vec<Output>) -> bool {
        let section = self.flight.horizon.tail().and_then(|tail| tail.section);
        let Ok(cursor) = self.cursor_at(&shortcut.to, section) else { return false };
        out.push(shortcut.told());
        self.jump(cursor, out);
        true
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
