//! A policy: a name, a sentence, and a checker over a trace.

use crate::trace::{Step, Trace};

pub struct Policy {
    pub name: &'static str,
    pub says: &'static str,
    pub check: fn(&Trace, &mut Findings),
}

pub const fn policy(name: &'static str, says: &'static str, check: fn(&Trace, &mut Findings)) -> Policy {
    Policy { name, says, check }
}

/// What a checker found: the moments at which the policy applied, and where it was broken.
#[derive(Default)]
pub struct Findings {
    pub applied: Vec<usize>,
    pub broken: Vec<(usize, String)>,
}

impl Findings {
    /// The policy applies at this moment, and must hold.
    pub fn expect(&mut self, step: Step, holds: bool, what: impl FnOnce() -> String) {
        self.applied.push(step.at);
        if !holds {
            self.broken.push((step.at, what()));
        }
    }
}

/// Every policy, by subject.
pub fn all() -> impl Iterator<Item = &'static Policy> {
    use crate::{
        actions, answers, decisions, emergencies, feeding, heights, holdings, horizon, loops, model, place,
        restart, updates,
    };
    [
        feeding::POLICIES,
        horizon::POLICIES,
        place::POLICIES,
        loops::POLICIES,
        decisions::POLICIES,
        emergencies::POLICIES,
        updates::POLICIES,
        actions::POLICIES,
        holdings::POLICIES,
        heights::POLICIES,
        restart::POLICIES,
        answers::POLICIES,
        model::POLICIES,
    ]
    .into_iter()
    .flatten()
}
