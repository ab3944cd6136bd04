//! Emergencies: an alternative plan at once, more severe causes only, back to the main plan by command.

use crate::api::{Event, Output, Phase, Refusal};
use crate::executor::state::Emergency;
use crate::executor::{Executor, refusal};
use crate::layout::cursor::Cursor;
use flight_plan::{Cause, EmergencyPlan, Id, Program};

impl Executor {
    pub(crate) fn emergency(
        &mut self,
        cause: Cause,
        plan: Option<Id>,
        out: &mut Vec<Output>,
    ) -> Result<(), Refusal> {
        self.flying_program()?;
        self.check_taken_off()?;
        self.check_escalation(cause)?;
        let from_leg = match &self.state.emergency {
            Some(running) => running.from_leg.clone(),
            None => self.main_leg(),
        };
        let Some((index, plan)) = self.resolve(cause, plan.as_ref(), from_leg.as_ref())? else {
            out.push(Output::Event(Event::EmergencyUnanswered { cause }));
            let reason = "no emergency plan applies here: the gateway's Safe mode decides, or name a plan";
            return Err(refusal("no-emergency-plan", reason));
        };
        self.switch_to(index, Emergency { cause, plan, from_leg }, out);
        Ok(())
    }

    /// During an emergency only a more severe cause counts.
    fn check_escalation(&self, cause: Cause) -> Result<(), Refusal> {
        match &self.state.emergency {
            Some(running) if cause <= running.cause => {
                let reason = format!(
                    "emergency plan `{}` is being flown for {:?}: only a more severe cause replaces it",
                    running.plan, running.cause
                );
                Err(refusal("not-more-severe", reason))
            }
            _ => Ok(()),
        }
    }

    /// The emergency plan and its index: the named one, else the one in force for the leg and the cause.
    fn resolve(
        &self,
        cause: Cause,
        named: Option<&Id>,
        leg: Option<&Id>,
    ) -> Result<Option<(usize, Id)>, Refusal> {
        let program = self.flying_program()?;
        let index_of = |id: &Id| {
            let index = program.plan.emergency_plans.iter().position(|p| p.id == *id)?;
            Some((index, id.clone()))
        };
        if let Some(id) = named {
            let reason = || format!("the plan has no emergency plan `{id}`: name one that it has");
            return index_of(id).map(Some).ok_or_else(|| refusal("unknown-plan", reason()));
        }
        Ok(emergency_coverage(&program, leg, cause).and_then(|plan| index_of(&plan.id)))
    }

    fn switch_to(&mut self, index: usize, emergency: Emergency, out: &mut Vec<Output>) {
        let goes_on = self.state.emergency.as_ref().is_some_and(|running| running.plan == emergency.plan);
        let Emergency { cause, plan, from_leg } = emergency.clone();
        out.push(Output::Event(Event::EmergencyStarted { cause, plan, from_leg }));
        self.state.emergency = Some(emergency);
        if goes_on {
            if self.state.phase == Phase::Holding {
                self.leave_hold(out);
                self.refeed(out);
            }
            return;
        }
        let mut cursor = Cursor::start(Some(index), self.here(), self.state.last_passage);
        // crossings are counted on, so that a decision for the next one is not taken for another after the return
        let before = self.bookmark(0);
        (cursor.crossings, cursor.uncounted) = (before.crossings, before.uncounted);
        self.leave_hold(out);
        self.jump(cursor, out);
    }

    /// An emergency doesn't wait for a resume.
    fn leave_hold(&mut self, out: &mut Vec<Output>) {
        self.state.held_at = None;
        self.enter_phase(Phase::Flying, out);
    }

    pub(crate) fn return_to_main(&mut self, leg: &Id, out: &mut Vec<Output>) -> Result<(), Refusal> {
        self.flying_program()?;
        if self.state.emergency.is_none() {
            return Err(refusal("no-emergency", "the main plan is being flown: use go-to for another leg"));
        }
        let cursor = self.cursor_at(leg, None)?;
        self.state.emergency = None;
        self.jump(cursor, out);
        Ok(())
    }

    /// Leg (or stage) of the main plan that is being flown; where nothing is issued, or only what an earlier plan had, the
    /// one that comes next.
    fn main_leg(&self) -> Option<Id> {
        let world = self.world();
        let tail = self.state.tail.as_ref().map(|t| t.place(&world).leg);
        let legs = self.state.issued.iter().map(|h| h.place.leg.clone()).chain(tail);
        legs.into_iter().find(|leg| world.program.path(leg).is_some())
    }

    /// The plan an emergency without a particular cause would fly now.
    pub(crate) fn emergency_in_force(&self) -> Option<Id> {
        let leg = match &self.state.emergency {
            Some(running) => running.from_leg.clone(),
            None => self.main_leg(),
        };
        Some(emergency_coverage(&self.program, leg.as_ref(), Cause::Operator)?.id.clone())
    }
}

/// The plan that answers a cause on a leg (or stage); on none that the plan has, the one that the document names for all.
fn emergency_coverage<'p>(program: &'p Program, leg: Option<&Id>, cause: Cause) -> Option<&'p EmergencyPlan> {
    match leg.filter(|leg| program.path(leg).is_some()) {
        Some(leg) => program.emergency_for(leg, cause),
        None => program.flown().emergency_plan(program.plan.emergency.plan_for(cause)?),
    }
}
