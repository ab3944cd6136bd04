//! How many of what a plan has, in words.

use flight_plan::FlightPlan;

/// What is in a plan, in a few words.
pub fn contents(plan: &FlightPlan) -> String {
    listed(&parts(plan))
}

fn parts(plan: &FlightPlan) -> [(usize, &'static str); 4] {
    [
        (plan.all_legs().len() + plan.procedure_legs().len(), "leg"),
        (plan.fixes.len(), "fix"),
        (plan.runways.len(), "runway"),
        (plan.zones.len(), "zone"),
    ]
}

/// What an edit took out of a plan, if that is more than one part of it: nobody overlooks a single one that he deletes.
pub fn removed(before: &FlightPlan, now: &FlightPlan) -> Option<String> {
    let gone = parts(before).into_iter().zip(parts(now));
    let gone: Vec<_> = gone.map(|((was, what), (is, _))| (was.saturating_sub(is), what)).collect();
    let is_much = gone.iter().map(|(count, _)| count).sum::<usize>() > 1;
    is_much.then(|| format!("Removed {}", listed(&gone)))
}

/// `4 legs, 1 fix and 2 zones`; what there is none of is left out.
pub fn listed(parts: &[(usize, &str)]) -> String {
    let parts: Vec<String> =
        parts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| number(*count, what)).collect();
    match parts.as_slice() {
        [] => "nothing that can be flown".into(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// `1 leg`, `2 legs`, `3 fixes`.
pub fn number(count: usize, what: &str) -> String {
    let plural = match (count, what.ends_with('x')) {
        (1, _) => "",
        (_, true) => "es",
        (_, false) => "s",
    };
    format!("{count} {what}{plural}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_went_out_of_a_plan_is_counted_if_it_is_much() {
        let before = flight_plan::read(include_str!("../../../assets/plans/square.xml")).plan;
        let without = |legs: usize| {
            let all: Vec<_> = before.all_legs().iter().map(|context| context.leg.id.clone()).collect();
            flight_plan::create::delete_legs(&before, all.get(..legs).unwrap()).apply(&before).unwrap()
        };
        assert_eq!(removed(&before, &without(1)), None);
        assert_eq!(removed(&before, &without(3)).unwrap(), "Removed 3 legs");
        assert_eq!(removed(&without(3), &before), None);
    }

    #[test]
    fn what_is_in_a_plan_is_said_in_words() {
        let mut plan = FlightPlan::default();
        assert_eq!(contents(&plan), "nothing that can be flown");
        plan = flight_plan::read(include_str!("../../../assets/plans/square.xml")).plan;
        assert!(
            contents(&plan).contains("legs, ") && contents(&plan).contains(" and "),
            "{}",
            contents(&plan)
        );
        assert_eq!((number(1, "fix"), number(2, "fix")), ("1 fix".into(), "2 fixes".into()));
    }
}
