//! What is ahead of a flight under way, judged by the same rules as a whole plan: from the aircraft's position, with the
//! present values of the variables, the energy that is left, the wind and the time of day.
//!
//! A change is tried on a copy of the executor first, which is then flown ahead:
//!
//! - A proposal, when it is put forward ([`compile_and_review_ahead`]) and again when it is committed, because the flight has gone on
//!   meanwhile.
//! - A variable that some leg is laid out from, or from which an action computes such a one, when it is written
//!   ([`review_command`]).
//!
//! The FP Manager does this on a thread (`fp_manager/command_review`), one command after the other. Only what passes becomes an input
//! of the executor, so the journal knows nothing of the rest. An error refuses the command with its code; value and path stay. An error
//! that the present flight has as well, word for word, is no reason to refuse: it becomes a warning. If another command turns the
//! flight meanwhile, the review is repeated.
//!
//! A go-to, a skip and a return to the main plan take effect at once, because the operator may be in a hurry to get out of
//! somewhere. The direct track that they take is reviewed right afterwards ([`review_turn`], `fp_manager/background_review`), and what is
//! wrong with it is reported as an event. Variables that no leg is laid out from take effect at once; the review before the flight has
//! flown what the plan's own actions write. A plan that was reviewed only ahead, or that came between a start without effect and
//! the next start, is reviewed whole before it is started on the ground.

use super::flights::Flights;
use super::{Conditions, View, reviewed};
use crate::api::Command;
use crate::executor::Executor;
use flight_plan::{Act, Id, Problem, Program, Severity, Use};
use std::collections::HashSet;
use std::sync::Arc;

/// Every problem of the path ahead of a flight under way, each once for a leg; none if nothing is being flown, or nothing is
/// known of the aircraft.
///
/// The present plan is flown to its end, and so are the emergency plans from the points of that path that are worst for them.
/// [`Conditions::start_unix_s`] is now; the path up to the waypoints that can't be altered any more counts as well.
pub fn review_ahead(flight: &Executor, conditions: Conditions) -> Vec<Problem> {
    let Some(flights) = Flights::ahead(flight, conditions.wind) else { return Vec::new() };
    let (program, terrain) = (flight.active().as_ref(), flight.terrain().as_ref());
    let variables = flight.variables().clone();
    View::new(program, flight.profile(), terrain, conditions, variables, flights).problems()
}

/// What a command of `by` would bring about (see [`Executor::changes_what_is_flown`]): errors forbid it. None, if the executor
/// itself refuses it.
pub fn review_command(
    flight: &Executor,
    by: &str,
    command: &Command,
    conditions: Conditions,
) -> Vec<Problem> {
    if *command == Command::Start {
        return super::review(flight.active(), flight.profile(), flight.terrain(), conditions);
    }
    let mut changed = flight.clone();
    match changed.command(command.clone(), by, &mut Vec::new()) {
        Ok(()) => brought_about(flight, &changed, conditions),
        Err(_) => Vec::new(),
    }
}

/// What is wrong with the way of a flight after a command that it took at once (see [`Executor::takes_its_own_way`]), and was not
/// before: errors only.
pub fn review_turn(before: &Executor, after: &Executor, conditions: Conditions) -> Vec<Problem> {
    brought_about(before, after, conditions).into_iter().filter(Problem::is_error).collect()
}

/// As [`super::compile_and_review`], for a plan that would take over a flight under way where that is. A plan in which the leg to enter has
/// still to be named is checked, and reviewed with that leg by [`review_command`] when it is committed.
///
/// # Errors
/// As [`super::compile_and_review`].
pub fn compile_and_review_ahead(
    document: &[u8],
    flight: &Executor,
    conditions: Conditions,
) -> Result<Arc<Program>, Vec<Problem>> {
    reviewed(document, flight.profile(), flight.terrain(), |program| {
        let mut changed = flight.clone();
        changed.set_proposed(Some(program.clone()));
        match changed.commit(program.hash(), None, &mut Vec::new()) {
            Ok(()) => brought_about(flight, &changed, conditions),
            Err(_) => Vec::new(),
        }
    })
}

/// The problems of a changed flight; those that the present one has as well are warnings.
fn brought_about(present: &Executor, changed: &Executor, conditions: Conditions) -> Vec<Problem> {
    let mut found = review_ahead(changed, conditions);
    if found.iter().any(Problem::is_error) {
        let known = review_ahead(present, conditions);
        for problem in found.iter_mut().filter(|problem| known.contains(problem)) {
            problem.severity = Severity::Warning;
        }
    }
    found
}

impl Executor {
    /// A command that leads along a path that was not reviewed: in flight another plan, or a value that legs are laid out from; on the
    /// ground the start of a plan that came in flight, or after a start of which nothing came. It is for [`review_command`] before it is given.
    pub fn changes_what_is_flown(&self, command: &Command) -> bool {
        let anew = *command == Command::Start && self.is_reviewed_ahead_only() && self.may_start();
        let otherwise = self.is_under_way()
            && match command {
                Command::Commit { .. } => true,
                Command::SetVariable { name, .. } => laid_out_from(self.active()).contains(name),
                _ => false,
            };
        anew || otherwise
    }

    /// In flight, a command that leads along the plan as it is, but by a way that the plan does not have: straight to a leg. It is for people
    /// to give at once, and for [`review_turn`] afterwards.
    pub fn takes_its_own_way(&self, command: &Command) -> bool {
        let straight =
            matches!(command, Command::GoTo { .. } | Command::SkipLeg | Command::ReturnToMain { .. });
        self.is_under_way() && straight
    }
}

/// Variables that some leg's place, size, altitude, speed or count depends on.
pub(super) fn read_by_geometry(program: &Program) -> HashSet<&Id> {
    let mut names: HashSet<&Id> = HashSet::new();
    let mut read = |source: &Arc<str>, used: Use| {
        if let (true, Ok(expression)) = (used != Use::Condition, program.expression(source)) {
            names.extend(&expression.variables);
        }
    };
    let flown = program.flown();
    flown.all_stages().for_each(|(_, stage)| stage.for_each_expression(&mut read));
    flown.all_legs().iter().for_each(|context| context.leg.for_each_geometric_expression(&mut read));
    names
}

/// These, and those that actions of the plan work them out from.
fn laid_out_from(program: &Program) -> HashSet<&Id> {
    let mut names = read_by_geometry(program);
    let legs = program.flown().all_legs();
    let acts: Vec<&Act> = legs.iter().flat_map(|c| &c.leg.actions).map(|action| &action.act).collect();
    loop {
        let known = names.len();
        for act in &acts {
            let Act::Set { variable, to } = act else { continue };
            if let (true, Ok(expression)) = (names.contains(variable), program.expression(to)) {
                names.extend(&expression.variables);
            }
        }
        if names.len() == known {
            return names;
        }
    }
}
