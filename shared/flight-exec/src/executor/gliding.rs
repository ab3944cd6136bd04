//! The engine is out, and an emergency plan is flown: as much of it as the height allows. Where it does not suffice for the rest of the
//! plan, what lies between is left out; a holding is left when the way home from there takes what is left.

use super::Executor;
use crate::api::{AircraftState, Event, Output};
use crate::layout::homeward::{Arrival, Halt, halts};
use aircraft::glide::GlideStart;
use flight_plan::{Id, Runway};

/// A part of the plan that is gone to at once.
struct Shortcut {
    to: Id,
    arrival: Option<Arrival>,
}

impl Executor {
    /// The aircraft reports where it is.
    pub(super) fn aircraft_reported(&mut self, state: AircraftState, out: &mut Vec<Output>) {
        let ran = self.life.aircraft().is_none_or(|before| !before.engine_out);
        self.life.put_aircraft(Some(state));
        if !state.engine_out || self.flight.emergencies.plan().is_none() || self.is_muted() {
            return;
        }
        if ran {
            self.replan(out);
        }
        if let Some(shortcut) = self.shortcut(&state) {
            self.take(shortcut, out);
        }
    }

    /// Where to go at once, if the height does not suffice for all that is ahead: the first part from which it does, else the landing.
    fn shortcut(&self, state: &AircraftState) -> Option<Shortcut> {
        let front = self.flight.horizon.front()?;
        let path = self.setup.program.path(&front.place.leg)?;
        let section = path.emergency_plan?;
        let plan = self.setup.program.flown().emergency_plans.get(section)?;
        let runway = self.setup.program.plan.runway(&plan.runway)?;
        let halts = halts(&self.world(), section, (path.stage, path.indices.first().copied().unwrap_or(0)));
        let spare_m = |from: usize| {
            let arrival = self.arrival(state, halts.get(from..)?, runway);
            Some((arrival, arrival.map_or(f64::NEG_INFINITY, |a| a.spare_m())))
        };
        let last = halts.len().checked_sub(1)?;
        // on the final approach nothing can be left out but the circles before it
        if spare_m(0)?.1 >= 0.0 || (last == 0 && !front.waypoint.on_arc) {
            return None;
        }
        let enough = (1..last).find(|from| spare_m(*from).is_some_and(|(_, spare_m)| spare_m >= 0.0));
        let chosen = enough.unwrap_or(last);
        Some(Shortcut { to: halts.get(chosen)?.id.clone(), arrival: spare_m(chosen)?.0 })
    }

    /// The glide from here by way of what is ahead.
    fn arrival(&self, state: &AircraftState, halts: &[Halt], runway: &Runway) -> Option<Arrival> {
        let from = GlideStart {
            position: state.position,
            altitude_amsl_m: state.altitude_amsl_m,
            course_deg: state.track_deg,
        };
        let places = halts.iter().filter_map(|halt| halt.place);
        Arrival::of(&self.world(), state.wind(), from, places, runway)
    }

    fn take(&mut self, Shortcut { to, arrival }: Shortcut, out: &mut Vec<Output>) {
        let section = self.flight.horizon.tail().and_then(|tail| tail.section);
        let Ok(cursor) = self.cursor_at(&to, section) else { return };
        let outcome = match arrival {
            Some(Arrival { height_m, .. }) if height_m >= 0.0 => {
                format!("there it is {height_m:.0} m above the threshold")
            }
            Some(Arrival { height_m, .. }) => {
                format!("even so {:.0} m are lacking: be ready to land elsewhere", -height_m)
            }
            None => "even so it does not get there against the wind: be ready to land elsewhere".into(),
        };
        let reason = format!(
            "the engine is out, and the height does not suffice for all that is ahead: straight to `{to}`, {outcome}"
        );
        out.push(Output::Event(Event::ProblemAhead {
            leg: Some(to),
            code: "glide-shortened".into(),
            reason,
        }));
        self.jump(cursor, out);
    }
}
