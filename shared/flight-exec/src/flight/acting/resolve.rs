//! What an action does, with the values of now.

use crate::api::{Event, Output, ResolvedAct};
use crate::executor::Executor;
use flight_plan::{Act, EvalError, Id};

/// Who writes a variable when the plan itself does.
const PLAN: &str = "plan";
/// A loop or an intersection has no end of its own to circle at, and where a leg has one the path itself circles there.
const WAIT_INSIDE: &str = "a wait is flown at the end of a leg: put it on the last leg inside this one";

impl Executor {
    /// Does an action once, or tells why it can't be done.
    pub(super) fn perform(
        &mut self,
        leg: Id,
        passage: u64,
        iteration: u64,
        act: &Act,
        out: &mut Vec<Output>,
    ) {
        let done = self.resolved(act, iteration).and_then(|act| {
            if let ResolvedAct::Set { variable, value } = &act {
                let set = self.write_variable(variable, value.clone(), PLAN, out);
                set.map_err(|refusal| refusal.reason)?;
            }
            Ok(act)
        });
        match done {
            Ok(act) => {
                out.push(Output::Act { leg: leg.clone(), passage, act: act.clone() });
                out.push(Output::Event(Event::ActionDone { leg, passage, act }));
            }
            Err(reason) => out.push(Output::Event(Event::ActionRefused { leg, passage, reason })),
        }
    }

    fn resolved(&self, act: &Act, iteration: u64) -> Result<ResolvedAct, String> {
        let world = self.world().in_iteration(iteration);
        let why = |error: EvalError| error.to_string();
        Ok(match act {
            Act::Photo => ResolvedAct::Photo,
            Act::PhotoSeries { every_m } => {
                ResolvedAct::PhotoSeries { every_m: world.number(every_m).map_err(why)? }
            }
            Act::PhotoStop => ResolvedAct::PhotoStop,
            Act::VideoStart => ResolvedAct::VideoStart,
            Act::VideoStop => ResolvedAct::VideoStop,
            Act::Set { variable, to } => {
                ResolvedAct::Set { variable: variable.clone(), value: world.value(to).map_err(why)? }
            }
            Act::Invoke { service, operation, argument } => ResolvedAct::Invoke {
                service: service.clone(),
                operation: operation.clone(),
                argument: argument.clone(),
            },
            Act::Wait { .. } => return Err(WAIT_INSIDE.into()),
        })
    }
}
