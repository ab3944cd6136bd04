//! What a scenario and the one who asks for a preview tell the executor: commands, proposals and new plans.

use super::Flight;
use crate::api::{Command, Input, RequestId};
use crate::rehearse::scenario::Act;
use flight_plan::{Id, Program};
use std::sync::Arc;

impl Flight<'_> {
    /// Triggers whose time has come.
    pub(super) fn fire(&mut self) {
        for index in 0..self.at.fired.len() {
            let Some(trigger) = self.given.scenario.triggers.get(index) else { continue };
            let due = self.at.fired.get(index) == Some(&false) && trigger.at.is_now(&self.at.moment);
            if !due {
                continue;
            }
            if let Some(fired) = self.at.fired.get_mut(index) {
                *fired = true;
            }
            for act in &trigger.then {
                match act {
                    Act::Command(command) => self.command(command.clone()),
                    Act::Update { program, entry } => self.update(program, entry.clone()),
                    Act::Propose { program } => self.propose(program),
                    Act::FailEngine => self.at.aircraft.set_engine_healthy(false),
                    Act::End => self.at.ended = true,
                }
            }
        }
    }

    pub(super) fn update(&mut self, program: &Arc<Program>, entry: Option<Id>) {
        self.propose(program);
        self.command(Command::Commit { hash: program.hash().clone(), entry });
    }

    fn propose(&mut self, program: &Arc<Program>) {
        self.at.requests += 1;
        let request = RequestId(self.at.requests);
        self.input(Input::Propose {
            request,
            program: program.clone(),
            based_on: None,
            objections: Vec::new(),
        });
    }

    pub(super) fn command(&mut self, command: Command) {
        self.at.requests += 1;
        let request = RequestId(self.at.requests);
        self.input(Input::Command { request, by: "operator".into(), command });
    }
}
