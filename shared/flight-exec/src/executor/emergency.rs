//! Emergencies: an alternative plan at once, more severe causes only, back to the main plan by command.

use super::Executor;
use crate::api::{Event, Output, Phase, Refusal};
use crate::flight::{Emergency, emergencies, refusal};
use crate::layout::cursor::Cursor;
use flight_plan::{Cause, Id};

impl Executor {
    pub(super) fn emergency(
        &mut self,
        cause: Cause,
        plan: Option<Id>,
        out: &mut Vec<Output>,
    ) -> Result<(), Refusal> {
        let program = self.flying_program()?;
        self.check_taken_off()?;
        self.flight.emergencies.check_escalation(cause)?;
        let (from_leg, is_named) =
            (self.flight.emergencies.leg_of_main_plan(|| self.main_leg()), plan.is_some());
        let found = emergencies::resolve(&program, cause, plan.as_ref(), from_leg.as_ref())?;
        let Some((index, plan)) = found else {
            let reason = "no emergency plan applies here: the gateway's Safe mode decides, or name a plan";
            return Err(unanswered(cause, None, refusal("no-emergency-plan", reason), out));
        };
        if let Err(refused) = self.check_glide(index, is_named) {
            return Err(unanswered(cause, Some(plan), refused, out));
        }
        self.switch_to(index, Emergency { cause, plan, from_leg }, out);
        Ok(())
    }

    fn switch_to(&mut self, index: usize, emergency: Emergency, out: &mut Vec<Output>) {
        let Emergency { cause, plan, from_leg } = emergency.clone();
        out.push(Output::Event(Event::EmergencyStarted { cause, plan, from_leg }));
        if self.flight.emergencies.begin(emergency) {
            if self.life.mode.is_holding() {
                self.leave_hold(out);
                self.refeed(out);
            }
            return;
        }
        let mut cursor = Cursor::start(Some(index), self.here(), self.life.numbers.passage());
        // crossings are counted on, so that a decision for the next one is not taken for another after the return
        let before = self.bookmark(0);
        (cursor.crossings, cursor.uncounted) = (before.crossings, before.uncounted);
        cursor.home = before.home;
        self.leave_hold(out);
        let cursor = self.begun_in_reach(cursor, out);
        self.jump(cursor, out);
    }

    /// An emergency doesn't wait for a resume.
    fn leave_hold(&mut self, out: &mut Vec<Output>) {
        self.life.mode.forget_place();
        self.enter_phase(Phase::Flying, out);
    }

    pub(super) fn return_to_main(&mut self, leg: &Id, out: &mut Vec<Output>) -> Result<(), Refusal> {
        self.flying_program()?;
        if self.flight.emergencies.plan().is_none() {
            return Err(refusal("no-emergency", "the main plan is being flown: use go-to for another leg"));
        }
        let cursor = self.cursor_at(leg, None)?;
        self.check_may_turn(&cursor)?;
        self.flight.emergencies.end();
        self.jump(cursor, out);
        Ok(())
    }

    /// Leg (or stage) of the main plan that is being flown; where nothing is issued, or only what an earlier plan had, the
    /// one that comes next.
    pub(super) fn main_leg(&self) -> Option<Id> {
        let world = self.world();
        let tail = self.flight.horizon.tail().map(|t| t.place(&world).leg);
        let legs = self.flight.horizon.iter().map(|h| h.place.leg.clone()).chain(tail);
        legs.into_iter().find(|leg| world.program.path(leg).is_some())
    }

    /// The plan an emergency without a particular cause would fly now.
    pub(super) fn emergency_in_force(&self) -> Option<Id> {
        let leg = self.flight.emergencies.leg_of_main_plan(|| self.main_leg());
        Some(emergencies::in_force(&self.setup.program, leg.as_ref(), Cause::Operator)?.id.clone())
    }
}

/// Nobody but the one who raised it reads its refusal: the gateway raises most.
fn unanswered(cause: Cause, plan: Option<Id>, refused: Refusal, out: &mut Vec<Output>) -> Refusal {
    let Refusal { code, reason } = refused.clone();
    out.push(Output::Event(Event::EmergencyUnanswered { cause, plan, code, reason }));
    refused
}
