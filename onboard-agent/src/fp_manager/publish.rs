//! What the FP Manager publishes: a few times a second, and at once when it matters.

use flight_exec::Executor;
use service::Board;
use std::time::Duration;
use usal::contract::*;
use usal::topics::fp_manager as topic;
use wire::Convert;

/// What there is to be published is compared so often, and when something happened.
const PACE: Duration = Duration::from_millis(200);

/// Shows what is due; `heartbeats` counts up.
pub fn show(executor: &Executor, heartbeats: &mut u64, board: &mut Board) {
    if !board.is_turn(PACE) {
        return;
    }
    let program = executor.program();
    // before the status: who learns of a plan from it can fetch it
    if let Some(program) = program {
        board.file(topic::PLAN_FILE, program.hash(), || flight_plan::write(&program.plan).into());
    }
    board.current(topic::HEARTBEAT, || {
        *heartbeats += 1;
        Heartbeat { count: *heartbeats, plan: program.map(|p| p.hash().to_string()) }
    });
    board.current(topic::STATUS, || executor.status().convert());
    let mut tokens = executor.ahead().map(|w| w.token);
    let ends = tokens.next().map(|first| (first, tokens.last().unwrap_or(first)));
    board.changing(topic::AHEAD, (ends, executor.ahead().count()), |_| Ahead {
        waypoints: executor.ahead().cloned().map(Convert::convert).collect(),
    });
    board.changing(topic::VARIABLES, plan_variables(executor), Clone::clone);
    board.changing(topic::PLAN, plan_info(executor), Clone::clone);
}

/// Which plan is active.
pub fn plan_info(executor: &Executor) -> PlanInfo {
    let program = executor.program();
    PlanInfo {
        name: program.map(|p| p.plan.name.clone()).unwrap_or_default(),
        hash: program.map(|p| p.hash().to_string()),
        revision: executor.status().revision,
    }
}

fn plan_variables(executor: &Executor) -> PlanVariables {
    let Some(program) = executor.program() else { return PlanVariables::default() };
    let variables = program.plan.variables.iter().map(|v| PlanVariable {
        name: v.name.clone().convert(),
        value: executor.variables().get(&v.name).unwrap_or(&v.initial).clone().convert(),
        unit: v.unit.clone(),
        min: v.min,
        max: v.max,
    });
    PlanVariables { variables: variables.collect() }
}
