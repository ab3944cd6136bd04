//! Many problems of one sort are one entry of the list, until it is unfolded; a remedy of all of them is one step.

use super::gathered::Gathered;
use crate::document::Document;
use flight_plan::{Edit, Id, Problem, Thing};
use std::collections::{BTreeSet, HashMap, HashSet};

/// So many problems of one sort are one entry of the list.
const MANY: usize = 6;

/// What is wrong, and whether it forbids to fly.
type Sort = (&'static str, bool);

fn sort(problem: &Problem) -> Sort {
    (problem.code, problem.is_error())
}

/// The other problems of an entry's sort.
#[derive(Debug, Clone, PartialEq)]
pub struct Alike {
    /// Their numbers among all problems.
    pub numbers: Vec<usize>,
    /// The remedy of the entry's own problem and of these at once.
    pub remedy: Option<Edit>,
}

/// The sorts of which all problems are listed, however many there are.
#[derive(Debug, Default)]
pub struct Unfolded(BTreeSet<Sort>);

impl Unfolded {
    /// All of this problem's sort are listed.
    pub fn has(&self, problem: &Problem) -> bool {
        self.0.contains(&sort(problem))
    }

    /// Unfolds what is folded, and the other way round.
    pub fn turn(&mut self, problem: &Problem) {
        if !self.0.remove(&sort(problem)) {
            self.0.insert(sort(problem));
        }
    }

    /// Unfolds each entry that hides a problem that is wanted. False: none does.
    pub fn reveal(
        &mut self,
        listed: &[Gathered],
        problems: &[&Problem],
        is_wanted: impl Fn(&Problem) -> bool,
    ) -> bool {
        let before = self.0.len();
        let hidden = listed.iter().filter_map(|one| one.alike.as_ref()).flat_map(|alike| &alike.numbers);
        let hidden = hidden.filter_map(|number| problems.get(*number));
        let wanted: Vec<Sort> =
            hidden.filter(|problem| !self.has(problem) && is_wanted(problem)).map(|one| sort(one)).collect();
        self.0.extend(wanted);
        self.0.len() > before
    }

    /// Of many problems of one sort the first alone, with the others as those that are alike; where that sort is unfolded, they
    /// are listed, too.
    pub fn listed(
        &self,
        document: &Document,
        gathered: Vec<Gathered>,
        problems: &[&Problem],
    ) -> Vec<Gathered> {
        let mut sorts: HashMap<Sort, Vec<usize>> = HashMap::new();
        for one in &gathered {
            let problem = problems.get(one.number);
            problem.into_iter().for_each(|problem| sorts.entry(sort(problem)).or_default().push(one.number));
        }
        sorts.retain(|_, numbers| numbers.len() >= MANY);
        let mut listed = Vec::with_capacity(gathered.len());
        for mut one in gathered {
            let Some(problem) = problems.get(one.number) else { continue };
            let first = sorts.get(&sort(problem)).and_then(|numbers| numbers.split_first());
            match first {
                Some((first, others)) if *first == one.number => {
                    let all = std::iter::once(first).chain(others).filter_map(|number| problems.get(*number));
                    let remedy = remedy(document, all.copied());
                    one.alike = Some(Alike { numbers: others.to_vec(), remedy });
                }
                Some(_) if !self.has(problem) => continue,
                _ => {}
            }
            listed.push(one);
        }
        listed
    }
}

/// The remedies of all of them, where each has one and no two are of the same thing. What several miss is made once.
fn remedy<'a>(document: &Document, problems: impl Iterator<Item = &'a Problem>) -> Option<Edit> {
    let mut subjects: HashSet<Id> = HashSet::new();
    let mut made: HashSet<&Id> = HashSet::new();
    let mut edits = Vec::new();
    for problem in problems {
        if !subjects.insert(document.written(problem.subject.as_ref()?)) {
            return None;
        }
        let edit = problem.fix.as_deref()?;
        if adds(edit).is_none_or(|id| made.insert(id)) {
            edits.push(edit.clone());
        }
    }
    Some(Edit::All(edits))
}

/// The fix or variable that an edit adds.
fn adds(edit: &Edit) -> Option<&Id> {
    let Edit::Add(thing) = edit else { return None };
    match thing.as_ref() {
        Thing::Fix(fix) => Some(&fix.id),
        Thing::Variable(variable) => Some(&variable.name),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::gathered::gather;
    use super::*;

    const PLAN: &str = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><mainPlan>
        <stage id="m" type="mission"/></mainPlan></flightPlan>"#;

    fn found(codes: &[&'static str]) -> Vec<Problem> {
        codes.iter().map(|code| Problem::warning(code, *code)).collect()
    }

    fn listed(unfolded: &Unfolded, problems: &[Problem]) -> Vec<Gathered> {
        let problems: Vec<&Problem> = problems.iter().collect();
        let document = Document::read(PLAN.as_bytes(), None);
        unfolded.listed(&document, gather(&document, &problems), &problems)
    }

    /// The numbers of what is listed, and how many are alike to each.
    fn rows(unfolded: &Unfolded, problems: &[Problem]) -> Vec<(usize, usize)> {
        let rows = listed(unfolded, problems).into_iter();
        rows.map(|one| (one.number, one.alike.map_or(0, |alike| alike.numbers.len()))).collect()
    }

    #[test]
    fn of_many_problems_of_one_sort_the_first_has_the_others() {
        let problems = found(&["low", "steep", "low", "low", "near", "low", "low", "low"]);
        let mut unfolded = Unfolded::default();
        assert_eq!(rows(&unfolded, &problems), [(0, 5), (1, 0), (4, 0)]);
        unfolded.turn(&problems[3]);
        let all = [(0, 5), (1, 0), (2, 0), (3, 0), (4, 0), (5, 0), (6, 0), (7, 0)];
        assert_eq!(rows(&unfolded, &problems), all);
        unfolded.turn(&problems[0]);
        assert_eq!(rows(&unfolded, &problems), [(0, 5), (1, 0), (4, 0)]);
        assert_eq!(rows(&unfolded, &problems[..7]).len(), 7, "five are not many");
    }

    #[test]
    fn an_entry_unfolds_when_it_hides_what_is_wanted_only() {
        let problems = found(&["low", "steep", "low", "low", "near", "low", "low", "low"]);
        let mut unfolded = Unfolded::default();
        let folded = listed(&unfolded, &problems);
        let all: Vec<&Problem> = problems.iter().collect();
        let mut is_revealed = |number: usize| {
            unfolded.reveal(&folded, &all, |problem| std::ptr::eq(problem, &problems[number]))
        };
        assert!(!is_revealed(0) && !is_revealed(1), "they are listed");
        assert!(is_revealed(3));
        assert!(unfolded.has(&problems[3]) && !unfolded.has(&problems[1]));
    }

    #[test]
    fn a_fix_that_several_legs_miss_is_made_once_by_their_remedy() {
        let legs: String = (0..4).map(|n| format!(r#"<TF id="l{n}" fix="LAKE"/>"#)).collect();
        let legs = format!(r#"{legs}<TF id="l4" fix="SHORE"/><TF id="l5" fix="RIVER"/>"#);
        let plan = PLAN
            .replace(r#"mission"/>"#, &format!(r#"mission"><IF id="a" lat="46" lon="9"/>{legs}</stage>"#));
        let document = Document::read(plan.as_bytes(), None);
        let found = flight_plan::check(document.plan(), &aircraft::Profile::default(), &terrain::Flat(300.0));
        let problems: Vec<&Problem> = found.iter().filter(|problem| problem.code == "unknown-fix").collect();
        let listed = Unfolded::default().listed(&document, gather(&document, &problems), &problems);
        let alike = listed[0].alike.clone().unwrap();
        assert_eq!((listed.len(), alike.numbers.len()), (1, 5));
        let Some(Edit::All(edits)) = alike.remedy else { panic!("no remedy") };
        let made: Vec<&str> = edits.iter().filter_map(adds).map(Id::as_str).collect();
        assert_eq!(made, ["LAKE", "SHORE", "RIVER"]);
    }
}
