//! What a client asks in the course of a flight.

use flight_exec::Command;
use flight_plan::{Id, VariableValue};
use std::collections::VecDeque;
use usal::contract::Cause;

pub const MISSION: &str = include_str!("mission.xml");

/// What the client asks, once so many waypoints are flown and so many steps after the last answer.
pub struct Ask {
    pub flown: usize,
    pub steps: usize,
    pub what: What,
}

/// What is asked.
pub enum What {
    Propose(String),
    Commit,
    Command(Command),
    /// The gateway raises an alarm.
    Alarm(Cause),
}

fn set(name: &str, value: VariableValue) -> What {
    What::Command(Command::SetVariable { name: Id::new(name), value })
}

/// Everything that is asked of a flight.
pub fn asks(emergency: bool) -> VecDeque<Ask> {
    let decide = Command::Decide { leg: Id::new("ask"), branch: Id::new("look") };
    let changed = MISSION.replace("radius=\"250\" turns=\"1\"", "radius=\"260\" turns=\"1\"");
    let list = vec![
        (0, 0, What::Propose(MISSION.into())),
        (0, 1, What::Commit),
        (0, 1, What::Command(Command::Start)),
        (8, 0, set("reach", VariableValue::Number(300.0))),
        (12, 0, What::Command(decide)),
        (30, 2, What::Command(Command::SkipLeg)),
        (34, 0, What::Command(Command::Hold)),
        (0, 5, What::Command(Command::Resume)),
        (40, 0, What::Propose(changed)),
        (0, 2, What::Commit),
        (47, 0, if emergency { What::Alarm(Cause::Energy) } else { set("found", VariableValue::Bool(true)) }),
    ];
    list.into_iter().map(|(flown, steps, what)| Ask { flown, steps, what }).collect()
}
