//! What people call the parts of a plan.

use flight_plan::{FlightPlan, Id};

/// The names in the plan aboard; while that is not known, identifiers.
#[derive(Debug, Clone, Copy)]
pub struct Names<'a>(pub Option<&'a FlightPlan>);

impl Names<'_> {
    /// Of a leg, a stage, an emergency plan. A stage without a name is called by its kind.
    pub fn of(self, id: &Id) -> String {
        self.known(id).unwrap_or(id.as_str()).to_owned()
    }

    /// A sentence with names in the place of the identifiers that it quotes.
    pub fn told(self, sentence: &str) -> String {
        flight_plan::in_names(sentence, |id| self.known(id))
    }

    /// Of a branch. Its identifier may be that of a leg, too.
    pub fn of_branch(self, fork: &Id, branch: &Id) -> String {
        self.0.map_or(branch.as_str(), |plan| plan.branch_label(fork, branch)).to_owned()
    }
}

impl<'a> Names<'a> {
    fn known(self, id: &Id) -> Option<&'a str> {
        self.0.and_then(|plan| plan.name_of(id).or_else(|| Some(plan.stage(id)?.kind.name())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_without_a_name_is_called_by_its_kind_and_everything_else_by_its_identifier() {
        let text = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><mainPlan>
            <stage id="m" name="Round" type="mission"><TF id="a" name="Out" lat="46" lon="9"/><TF id="b" lat="46.1" lon="9"/></stage>
            </mainPlan><emergencyPlans><emergencyPlan id="return" runway="R05"><stage id="r-land" type="land"/></emergencyPlan>
            </emergencyPlans></flightPlan>"#;
        let plan = flight_plan::read(text.as_bytes()).plan;
        let called = |id: &str| Names(Some(&plan)).of(&id.into());
        assert_eq!(
            ["m", "a", "b", "r-land", "return"].map(called),
            ["Round", "Out", "b", "Landing", "return"]
        );
        assert_eq!(Names(None).of(&"r-land".into()), "r-land");
        let told = |names: Names<'_>| names.told("straight to `r-land`");
        assert_eq!(
            (told(Names(Some(&plan))), told(Names(None))),
            ("straight to “Landing”".into(), "straight to “r-land”".into())
        );
    }
}
