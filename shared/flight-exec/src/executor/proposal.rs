//! A plan put forward: whether it may be committed, what it changes, and where the aircraft would go.

use super::Executor;
use crate::api::{Answer, Command, EntryReport, FARTHEST_M, ProposalReport, Refusal};
use crate::flight::refusal;
use flight_plan::diff::changes;
use flight_plan::{Change, ChangeKind, Id, Problem, Program};
use std::sync::Arc;

/// Problems that a report lists.
const PROBLEMS_MAX: usize = 50;
/// Who asks when it is only tried what a proposal would do.
const NOBODY: &str = "trial";
/// So many legs are tried that might be entered.
const MAX_ENTRIES: usize = 24;

impl Executor {
    /// Keeps a proposal that may be committed, and reports what it would do. One that may not takes the place of an earlier
    /// one as well: what is committed is what was reported on last.
    pub(super) fn propose(
        &mut self,
        program: &Arc<Program>,
        based_on: Option<u64>,
        objections: Vec<Problem>,
    ) -> Result<Answer, Refusal> {
        let revision = self.life.revision.number();
        if let Some(seen) = based_on.filter(|seen| *seen != revision) {
            let advice = "another plan was committed meanwhile; look at it and propose again";
            let reason =
                format!("the proposal is based on revision {seen}, the flight is at {revision}: {advice}");
            return Err(refusal("stale-revision", reason));
        }
        self.proposed = Some(program.clone());
        let report = self.report(program, &objections);
        if !report.acceptable {
            self.proposed = None;
        }
        Ok(Answer::Proposal(Box::new(report)))
    }

    fn report(&self, program: &Arc<Program>, objections: &[Problem]) -> ProposalReport {
        let problems = listed(program.warnings.iter().chain(objections));
        let forbidden = objections.iter().any(Problem::is_error);
        let mut report = ProposalReport {
            hash: program.hash().clone(),
            acceptable: !forbidden,
            problems,
            entry_needed: false,
            ..differences(&self.setup.program, program)
        };
        match self.outcome(program, None) {
            Ok(after) => {
                self.report_outcome(&after, &mut report);
                if let Some(reason) = self.begins_out_of_reach(&after) {
                    report.acceptable = false;
                    report.problems.push(reason);
                }
            }
            Err(refused) => {
                report.entry_needed = refused.code == "entry-needed";
                report.entries = self.entries(program);
                report.problems.push(refused.reason);
            }
        }
        report
    }

    /// What a commit now would lead to: tried on a copy.
    fn outcome(&self, program: &Arc<Program>, entry: Option<&Id>) -> Result<Executor, Refusal> {
        let mut copy = self.clone();
        let mut unused = Vec::new();
        copy.commit(program.hash(), entry, &mut unused)?;
        if !copy.is_flying() {
            copy.command(Command::Start, NOBODY, &mut unused)?;
        }
        Ok(copy)
    }

    /// Where each leg of the plan being flown that can be entered would lead; of very many, the first.
    fn entries(&self, program: &Arc<Program>) -> Vec<EntryReport> {
        let plan = self.flight.emergencies.plan();
        let section = plan.and_then(|id| program.plan.emergency_plans.iter().position(|p| p.id == *id));
        let legs = program.stages(section).iter().flat_map(|stage| &stage.legs).take(MAX_ENTRIES);
        let tried = legs.filter_map(|leg| {
            let after = self.outcome(program, Some(&leg.id)).ok()?;
            let position = after.flight.horizon.front()?.waypoint.position;
            let in_m = after.path_ahead().left_to_current_m();
            Some(EntryReport { leg: leg.id.clone(), position, in_m, in_s: in_m / self.ground_speed_mps() })
        });
        tried.collect()
    }

    /// Why the gateway would not take the first waypoint of what follows, if it is a new one that is too far from the aircraft.
    fn begins_out_of_reach(&self, after: &Executor) -> Option<String> {
        let first = &after.flight.horizon.front()?.waypoint;
        let far_m = self.life.aircraft()?.position.distance_m(first.position);
        (self.is_flying() && first.token > self.last_token() && far_m > FARTHEST_M).then(|| too_far(far_m))
    }

    fn ground_speed_mps(&self) -> f64 {
        let aircraft = self.life.aircraft();
        aircraft.map_or(0.0, |a| a.ground_speed_mps).max(self.setup.profile.min_airspeed_mps)
    }

    fn report_outcome(&self, after: &Executor, report: &mut ProposalReport) {
        let speed_mps = self.ground_speed_mps();
        let next = after.flight.horizon.front();
        report.next_leg = next.map(|h| h.place.leg.clone());
        report.next_position = next.map(|h| h.waypoint.position);
        report.next_in_m = next.map(|_| after.path_ahead().left_to_current_m());
        report.next_in_s = report.next_in_m.map(|metres| metres / speed_mps);
        report.differs_in_m = self.differs_in_m(after);
        report.differs_in_s = report.differs_in_m.map(|metres| metres / speed_mps);
    }

    /// How much of the present path would still be flown.
    fn differs_in_m(&self, after: &Executor) -> Option<f64> {
        let token = |e: &Executor, i: usize| e.flight.horizon.get(i).map(|h| h.waypoint.token);
        let both = self.flight.horizon.len().max(after.flight.horizon.len());
        let first = (0..both).find(|i| token(self, *i) != token(after, *i))?;
        let kept = first.checked_sub(1).and_then(|i| self.flight.horizon.get(i));
        Some(kept.map_or(0.0, |h| self.path_ahead().path_left_m(h.end_m)))
    }
}

/// As people read them, with code and place; not all of very many.
fn listed<'a>(problems: impl Iterator<Item = &'a Problem>) -> Vec<String> {
    let mut problems = problems.map(ToString::to_string);
    let mut listed: Vec<String> = problems.by_ref().take(PROBLEMS_MAX).collect();
    let more = problems.count();
    if more > 0 {
        listed.push(format!("and {more} more"));
    }
    listed
}

/// A report that knows only which legs and stages differ, calls being the legs they stand for: those only in the new plan, only
/// in the old one, and those that are another leg, at another place, or over fixes that moved (a loop's body counts for itself).
fn differences(old: &Program, new: &Program) -> ProposalReport {
    let (mut added, mut removed, mut changed) = (Vec::new(), Vec::new(), Vec::new());
    for Change { part, id, fate, .. } in changes(old.flown(), new.flown()) {
        let list = match (part, fate) {
            ("leg", ChangeKind::Added) => &mut added,
            ("leg", ChangeKind::Removed) => &mut removed,
            ("leg" | "stage", ChangeKind::Changed | ChangeKind::Moved) => &mut changed,
            _ => continue,
        };
        // not the legs of procedures: what is flown are their calls
        list.extend(id.filter(|id| new.path(id).or(old.path(id)).is_some()));
    }
    // those of whole emergency plans too
    let stages = |of: &Program, but: &Program| -> Vec<Id> {
        let ids = of.flown().all_stages().map(|(_, stage)| &stage.id);
        ids.filter(|id| but.path(id).is_none()).cloned().collect()
    };
    added.extend(stages(new, old));
    removed.extend(stages(old, new));
    let parts = new.flown().all_stages().count() + new.flown().all_legs().len();
    ProposalReport {
        hash: "".into(),
        acceptable: false,
        problems: Vec::new(),
        unchanged: parts.saturating_sub(added.len() + changed.len()),
        added,
        removed,
        changed,
        next_leg: None,
        next_position: None,
        next_in_m: None,
        next_in_s: None,
        differs_in_m: None,
        differs_in_s: None,
        entry_needed: false,
        entries: Vec::new(),
    }
}

/// Why a way is not begun.
pub(super) fn too_far(far_m: f64) -> String {
    let (far, most) = (far_m / 1e3, FARTHEST_M / 1e3);
    format!(
        "it begins {far:.0} km from the aircraft and the gateway takes at most {most:.0} km: enter at a nearer leg, or put one on the way"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_plan::Location;

    #[test]
    fn problem_names_its_code_place_and_leg_and_a_flood_of_them_is_cut() {
        let problem = |line| {
            Problem::warning("no-emergency", "name an emergency plan here")
                .of(&Id::new("side2"))
                .at(Location { line, column: 5 })
        };
        let few = [problem(7)];
        assert_eq!(listed(few.iter()), ["7:5: warning [no-emergency] side2: name an emergency plan here"]);
        let many: Vec<Problem> = (1..=200).map(problem).collect();
        let listed = listed(many.iter());
        assert_eq!(
            (listed.len(), listed.last().map(String::as_str)),
            (PROBLEMS_MAX + 1, Some("and 150 more"))
        );
    }
}
