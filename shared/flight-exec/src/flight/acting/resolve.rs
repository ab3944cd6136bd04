//! What an action does, with the values of now.

use super::{Passage, Scene};
use crate::api::{Event, Output, ResolvedAct};
use crate::flight::values::PLAN;
use flight_plan::{Act, EvalError};

/// A loop or an intersection has no end of its own to circle at, and where a leg has one the path itself circles there.
const WAIT_INSIDE: &str = "a wait is flown at the end of a leg: put it on the last leg inside this one";

impl Passage {
    /// Does an action once, or reports why it can't be done.
    pub(super) fn perform(&self, act: &Act, scene: &mut Scene, out: &mut Vec<Output>) {
        let (leg, passage) = (self.leg.clone(), self.number);
        let done = resolved(act, self.iteration, scene).and_then(|act| {
            if let ResolvedAct::Set { variable, value } = &act {
                let plan = &scene.program.plan;
                let set = scene.values.write(plan, (variable, value.clone()), PLAN, true, out);
                set.map_err(|why| why.to_string())?;
                scene.clock.ask_for_refresh(scene.debounce_s);
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
}

fn resolved(act: &Act, iteration: u64, scene: &Scene) -> Result<ResolvedAct, String> {
    let (program, env) = (scene.program, scene.env(iteration));
    let why = |error: EvalError| error.to_string();
    Ok(match act {
        Act::Photo => ResolvedAct::Photo,
        Act::PhotoSeries { every_m } => {
            ResolvedAct::PhotoSeries { every_m: program.eval_number(every_m, &env).map_err(why)? }
        }
        Act::PhotoStop => ResolvedAct::PhotoStop,
        Act::VideoStart => ResolvedAct::VideoStart,
        Act::VideoStop => ResolvedAct::VideoStop,
        Act::Set { variable, to } => {
            let value = program.expression(to).and_then(|expression| expression.value(&env));
            ResolvedAct::Set { variable: variable.clone(), value: value.map_err(why)? }
        }
        Act::Invoke { service, operation, argument } => ResolvedAct::Invoke {
            service: service.clone(),
            operation: operation.clone(),
            argument: argument.clone(),
        },
        Act::Wait { .. } => return Err(WAIT_INSIDE.into()),
    })
}
