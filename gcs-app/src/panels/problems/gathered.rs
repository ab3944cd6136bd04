//! Problems inside of procedures: each call has them anew, and each is listed once, with the calls that have it. What is said of one
//! call in other words or figures is a problem of its own.

use super::folds::Alike;
use crate::document::Document;
use flight_plan::{Id, Problem, Severity, Verdict};
use std::collections::HashMap;

/// So many calls are named.
const MOST: usize = 3;

/// A problem that is listed.
#[derive(Debug, Clone, PartialEq)]
pub struct Gathered {
    /// Its number among all problems; of several that are one, the first.
    pub number: usize,
    /// The calls that have it; none, where it is of no procedure.
    pub calls: Vec<Id>,
    /// The others of its sort, where it is the entry of many.
    pub alike: Option<Alike>,
}

/// What is said of a leg: what is wrong, how badly, and in which words; its call is not named in them.
type Said = (&'static str, Severity, String);

/// What is one problem: the leg as it is written, what is said of it, and which of several such problems it is.
type Kind = (Id, Said, usize);

/// Each problem once.
pub fn gather(document: &Document, problems: &[&Problem]) -> Vec<Gathered> {
    let mut gathered: Vec<Gathered> = Vec::with_capacity(problems.len());
    let mut known: HashMap<Kind, usize> = HashMap::new();
    let mut times: HashMap<(&Id, Said), usize> = HashMap::new();
    for (number, problem) in problems.iter().enumerate() {
        let made = problem.subject.as_ref().and_then(|flown| Some((flown, document.call_of(flown)?)));
        let Some((flown, call)) = made else {
            gathered.push(Gathered { number, calls: Vec::new(), alike: None });
            continue;
        };
        let said = (problem.code, problem.severity, problem.message.replace(&format!("{call}."), ""));
        let time = times.entry((flown, said.clone())).or_default();
        let kind = (document.written(flown), said, *time);
        *time += 1;
        let index = *known.entry(kind).or_insert(gathered.len());
        match gathered.get_mut(index) {
            Some(one) if !one.calls.contains(&call) => one.calls.push(call),
            Some(_) => {}
            None => gathered.push(Gathered { number, calls: vec![call], alike: None }),
        }
    }
    gathered
}

/// What the problems come to that are listed.
pub fn verdict(gathered: &[Gathered], problems: &[&Problem]) -> Verdict {
    Verdict::of(gathered.iter().filter_map(|one| problems.get(one.number)).copied())
}

/// Whose problem it is: `Up (in West and East)`.
pub fn whose(document: &Document, subject: &Id, calls: &[Id]) -> String {
    let written = document.written(subject);
    let name = document.label(&written);
    if calls.is_empty() {
        return name.to_owned();
    }
    let named: Vec<&str> = calls.iter().take(MOST).map(|call| document.label(call)).collect();
    let (last, before) = match (named.split_last(), calls.len().saturating_sub(MOST)) {
        (Some((last, before)), 0) => ((*last).to_owned(), before),
        (_, 1) => ("1 more call".to_owned(), named.as_slice()),
        (_, more) => (format!("{more} more calls"), named.as_slice()),
    };
    match before {
        [] => format!("{name} (in {last})"),
        before => format!("{name} (in {} and {last})", before.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAN: &str = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><procedures>
        <procedure id="look" reference="46 9"><TF id="up" name="Up" lat="46" lon="9"/><call id="deep" procedure="turn"/></procedure>
        <procedure id="turn" reference="46 9"><TF id="round" lat="46" lon="9"/></procedure></procedures><mainPlan>
        <stage id="m" type="mission"><call id="west" name="West" procedure="look"/><call id="east" name="East" procedure="look"/>
        <call id="c3" procedure="look"/><call id="c4" procedure="look"/><call id="c5" procedure="look"/>
        <TF id="n.1" lat="46" lon="9"/></stage></mainPlan></flightPlan>"#;

    fn listed(found: &[(&'static str, &str)]) -> Vec<String> {
        let document = Document::read(PLAN.as_bytes(), None);
        let problems: Vec<Problem> =
            found.iter().map(|(code, of)| Problem::warning(code, *of).of(&(*of).into())).collect();
        told(&document, &problems)
    }

    fn told(document: &Document, problems: &[Problem]) -> Vec<String> {
        let problems: Vec<&Problem> = problems.iter().collect();
        let gathered = gather(document, &problems);
        assert_eq!(verdict(&gathered, &problems).warnings, gathered.len());
        gathered
            .iter()
            .map(|one| {
                let problem = problems[one.number];
                let whose = whose(document, problem.subject.as_ref().unwrap(), &one.calls);
                format!("{} {whose}", problem.code)
            })
            .collect()
    }

    #[test]
    fn a_problem_of_a_procedure_is_one_with_the_calls_that_have_it() {
        let found = [
            ("steep", "west.up"),
            ("near", "west.up"),
            ("steep", "n.1"),
            ("steep", "east.up"),
            ("steep", "west.deep.round"),
            ("steep", "c3.deep.round"),
        ];
        let told =
            ["steep Up (in West and East)", "near Up (in West)", "steep n.1", "steep round (in West and c3)"];
        assert_eq!(listed(&found), told);
    }

    #[test]
    fn two_problems_of_one_leg_stay_two_and_of_many_calls_few_are_named() {
        let found = ["west.up", "west.up", "east.up", "east.up"].map(|of| ("steep", of));
        assert_eq!(listed(&found), ["steep Up (in West and East)"; 2]);
        let all = ["west.up", "east.up", "c3.up", "c4.up", "c5.up"].map(|of| ("steep", of));
        assert_eq!(listed(&all), ["steep Up (in West, East, c3 and 2 more calls)"]);
        assert_eq!(listed(&all[..4]), ["steep Up (in West, East, c3 and 1 more call)"]);
    }

    #[test]
    fn what_is_said_in_other_figures_is_a_problem_of_its_own() {
        let document = Document::read(PLAN.as_bytes(), None);
        let low = |of: &str, by_m| {
            Problem::warning("low", format!("raise `{of}`: {by_m} m above the ground")).of(&of.into())
        };
        let problems = [low("west.up", 5), low("east.up", 400), low("c3.up", 5)];
        assert_eq!(told(&document, &problems), ["low Up (in West and c3)", "low Up (in East)"]);
    }
}
