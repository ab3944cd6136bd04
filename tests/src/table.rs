//! The programme's table in the documents: a row for each scenario, a column for each real autopilot that has flown it.

use super::{Scenario, scenarios};
use std::collections::BTreeMap;

const BEGIN: &str = "<!-- the table: made by the programme -->";
const END: &str = "<!-- end of the table -->";
/// Columns before those of the autopilots.
const OWN: [&str; 3] = ["Scenario", "What happens", "What must come of it"];
/// In a cell of a scenario that this autopilot has not flown.
const NOT_FLOWN: &str = "not flown";

/// What came of scenarios, by their names.
pub type Outcomes = BTreeMap<String, String>;

/// The document with its table made anew: what it says of other autopilots is kept. `None`: it has no place for a table.
pub fn renewed(document: &str, autopilot: Option<(&str, &Outcomes)>) -> Option<String> {
    let (before, rest) = document.split_once(BEGIN)?;
    let (old, after) = rest.split_once(END)?;
    let mut columns = read(old);
    if let Some((name, outcomes)) = autopilot {
        match columns.iter_mut().find(|(of, _)| of == name) {
            Some((_, known)) => known.extend(outcomes.clone()),
            None => columns.push((name.to_owned(), outcomes.clone())),
        }
    }
    Some(format!("{before}{BEGIN}\n{}{END}{after}", written(&columns)))
}

fn cells(line: &str) -> Vec<&str> {
    line.trim().trim_matches('|').split('|').map(str::trim).collect()
}

/// The autopilots' columns.
fn read(table: &str) -> Vec<(String, Outcomes)> {
    let mut lines = table.lines().filter(|line| line.starts_with('|')).map(cells);
    let header = lines.next().unwrap_or_default();
    let names = header.iter().skip(OWN.len()).map(|name| ((*name).to_owned(), Outcomes::new()));
    let mut columns: Vec<_> = names.collect();
    for row in lines.skip(1) {
        let name = row.first().unwrap_or(&"").trim_matches('`');
        for ((_, outcomes), cell) in columns.iter_mut().zip(row.iter().skip(OWN.len())) {
            outcomes.insert(name.to_owned(), (*cell).to_owned());
        }
    }
    columns
}

fn written(columns: &[(String, Outcomes)]) -> String {
    let names = OWN.into_iter().chain(columns.iter().map(|(name, _)| name.as_str()));
    let header = line(names);
    let rule = line(std::iter::repeat_n("---", OWN.len() + columns.len()));
    let rows = scenarios().map(|scenario| row(scenario, columns));
    [header, rule].into_iter().chain(rows).collect()
}

fn row(scenario: &Scenario, columns: &[(String, Outcomes)]) -> String {
    let outcomes = columns.iter().map(|(_, of)| of.get(scenario.name).map_or(NOT_FLOWN, String::as_str));
    let name = format!("`{}`", scenario.name);
    line([name.as_str(), scenario.happens, scenario.expected].into_iter().chain(outcomes))
}

fn line<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    let cells: Vec<_> = cells.collect();
    format!("| {} |\n", cells.join(" | "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcomes(name: &str, outcome: &str) -> Outcomes {
        [(name.to_owned(), outcome.to_owned())].into()
    }

    #[test]
    fn one_autopilots_results_leave_the_others_alone() {
        let document = format!("before\n{BEGIN}\n{END}\nafter\n");
        let first = renewed(&document, Some(("A 1", &outcomes("nominal", "passed")))).unwrap();
        let second = renewed(&first, Some(("B 2", &outcomes("bad_radio", "failed")))).unwrap();
        let third = renewed(&second, Some(("A 1", &outcomes("strong_wind", "passed")))).unwrap();
        let of = |name: &str| {
            cells(third.lines().find(|l| l.contains(&format!("`{name}`"))).unwrap())[3..].to_vec()
        };
        assert_eq!(of("nominal"), ["passed", NOT_FLOWN]);
        assert_eq!(of("bad_radio"), [NOT_FLOWN, "failed"]);
        assert_eq!(of("strong_wind"), ["passed", NOT_FLOWN]);
        assert!(third.starts_with("before\n") && third.ends_with("\nafter\n"));
        assert_eq!(renewed(&third, None).unwrap(), third);
        assert_eq!(renewed("no table", None), None);
    }

    #[test]
    fn the_documents_have_the_table_of_these_scenarios() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/docs/flight-tests.md");
        let document = std::fs::read_to_string(path).unwrap();
        let fresh = renewed(&document, None).unwrap();
        if std::env::var_os("LEGWORK_BLESS").is_some() {
            std::fs::write(path, fresh).unwrap();
            return;
        }
        assert!(fresh == document, "{path}: run this test once with LEGWORK_BLESS=1");
    }
}
