//! What people call the parts of a plan: their names before their identifiers.

use crate::create::every_leg;
use crate::{FlightPlan, Id};

impl FlightPlan {
    /// The name of a leg, stage, emergency plan, procedure, zone or fix, if it has one.
    pub fn name_of(&self, id: &Id) -> Option<&str> {
        let fix = || self.fix(id).map(|fix| fix.name.as_str());
        let zone = || self.zone(id).map(|zone| zone.name.as_str());
        let procedure = || self.procedure(id).map(|procedure| procedure.name.as_str());
        let emergency = || self.emergency_plan(id).map(|emergency| emergency.name.as_str());
        let leg = || self.any_leg(id).map(|leg| leg.name.as_str());
        let stage = self.stage(id).map(|stage| stage.name.as_str());
        let name = stage.or_else(emergency).or_else(procedure).or_else(zone).or_else(fix).or_else(leg)?;
        (!name.is_empty()).then_some(name)
    }

    /// Everything that has a name, with it: what [`FlightPlan::name_of`] finds one by one.
    pub fn named(&self) -> impl Iterator<Item = (&Id, &str)> {
        let stages = self.stages.iter().chain(self.emergency_plans.iter().flat_map(|plan| &plan.stages));
        let stages = stages.map(|stage| (&stage.id, stage.name.as_str()));
        let emergencies = self.emergency_plans.iter().map(|plan| (&plan.id, plan.name.as_str()));
        let procedures = self.procedures.iter().map(|procedure| (&procedure.id, procedure.name.as_str()));
        let zones = self.zones.iter().map(|zone| (&zone.id, zone.name.as_str()));
        let fixes = self.fixes.iter().map(|fix| (&fix.id, fix.name.as_str()));
        let legs = every_leg(self).into_iter().map(|leg| (&leg.id, leg.name.as_str()));
        let all = stages.chain(emergencies).chain(procedures).chain(zones).chain(fixes).chain(legs);
        all.filter(|(_, name)| !name.is_empty())
    }

    /// What a branch of a fork is called, or else its identifier.
    pub fn branch_label<'a>(&'a self, fork: &Id, branch: &'a Id) -> &'a str {
        let fork = self.any_leg(fork).and_then(|leg| leg.as_fork());
        let found = fork.and_then(|fork| fork.branches.iter().find(|other| other.id == *branch));
        found.map(|found| found.label.as_str()).filter(|label| !label.is_empty()).unwrap_or(branch.as_str())
    }

    /// Its name, or else its identifier.
    pub fn label<'a>(&'a self, id: &'a Id) -> &'a str {
        self.name_of(id).unwrap_or(id.as_str())
    }

    /// A sentence about the plan, with names in the place of the identifiers that stand in it as `` `id` ``; what else stands there
    /// is quoted alike.
    pub fn in_names(&self, sentence: &str) -> String {
        in_names(sentence, |id| self.name_of(id))
    }
}

/// As [`FlightPlan::in_names`], for who keeps the names at hand.
pub fn in_names<'a>(sentence: &str, name_of: impl Fn(&Id) -> Option<&'a str>) -> String {
    let mut told = String::with_capacity(sentence.len());
    let mut rest = sentence;
    while let Some((before, id, after)) = quoted(rest) {
        told.push_str(before);
        match name_of(&Id::new(id)) {
            Some(name) => told.extend(["“", name, "”"]),
            None => told.extend(["“", id, "”"]),
        }
        rest = after;
    }
    told.push_str(rest);
    told
}

/// What stands before, between and after the first two backticks.
fn quoted(text: &str) -> Option<(&str, &str, &str)> {
    let (before, rest) = text.split_once('`')?;
    let (id, after) = rest.split_once('`')?;
    Some((before, id, after))
}

#[cfg(test)]
mod tests {

    #[test]
    fn names_stand_in_the_place_of_identifiers() {
        let plan = crate::read(
            r#"<flightPlan version="1" id="p"><fixes><fix id="A" name="Tower" at="46.0 8.0"/></fixes>
              <mainPlan><stage id="s" type="mission" name="Round the tower"><TF id="a" fix="A"/></stage></mainPlan></flightPlan>"#,
        )
        .plan;
        assert_eq!((plan.label(&"s".into()), plan.label(&"a".into())), ("Round the tower", "a"));
        let told = plan.in_names("`a` of `s` goes to `A`, set `altitude`, and a single ` stays");
        assert_eq!(told, "“a” of “Round the tower” goes to “Tower”, set “altitude”, and a single ` stays");
    }
}
