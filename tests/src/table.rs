//! A table in the documents that the tests make: a row for each thing that is tried, a column for each real autopilot that it was
//! tried on.

use anyhow::Context;
use std::collections::BTreeMap;

/// What came of each row, by its name.
pub type Outcomes = BTreeMap<String, String>;

/// Where it stands, and what it says whatever the autopilot.
pub struct Table {
    /// The line before it.
    pub begin: &'static str,
    /// The line behind it.
    pub end: &'static str,
    /// Heads of the columns before those of the autopilots.
    pub own: &'static [&'static str],
    /// In a cell of what was not tried on this autopilot.
    pub untried: &'static str,
    /// The rows as far as they are its own: a name, and the other cells.
    pub rows: Vec<(&'static str, Vec<&'static str>)>,
}

impl Table {
    /// The document with this table made anew: what it says of other autopilots is kept. `None`: it has no place for it.
    pub fn renewed(&self, document: &str, autopilot: Option<(&str, &Outcomes)>) -> Option<String> {
        let (before, rest) = document.split_once(self.begin)?;
        let (old, after) = rest.split_once(self.end)?;
        let mut columns = self.read(old);
        if let Some((name, outcomes)) = autopilot {
            match columns.iter_mut().find(|(of, _)| of == name) {
                Some((_, known)) => known.extend(outcomes.clone()),
                None => columns.push((name.to_owned(), outcomes.clone())),
            }
        }
        Some(format!("{before}{}\n{}{}{after}", self.begin, self.written(&columns), self.end))
    }

    /// Writes what came of an autopilot into the document at a path.
    ///
    /// # Errors
    /// It can't be read or written, or has no place for the table.
    pub fn write(&self, path: &str, autopilot: &str, outcomes: &Outcomes) -> anyhow::Result<()> {
        let document = std::fs::read_to_string(path).with_context(|| path.to_owned())?;
        let renewed =
            self.renewed(&document, Some((autopilot, outcomes))).context("no place for the table")?;
        std::fs::write(path, renewed).with_context(|| path.to_owned())
    }

    /// The autopilots' columns.
    fn read(&self, table: &str) -> Vec<(String, Outcomes)> {
        let mut lines = table.lines().filter(|line| line.starts_with('|')).map(cells);
        let header = lines.next().unwrap_or_default();
        let names = header.iter().skip(self.own.len()).map(|name| ((*name).to_owned(), Outcomes::new()));
        let mut columns: Vec<_> = names.collect();
        for row in lines.skip(1) {
            let name = row.first().unwrap_or(&"").trim_matches('`');
            for ((_, outcomes), cell) in columns.iter_mut().zip(row.iter().skip(self.own.len())) {
                outcomes.insert(name.to_owned(), (*cell).to_owned());
            }
        }
        columns
    }

    fn written(&self, columns: &[(String, Outcomes)]) -> String {
        let names = self.own.iter().copied().chain(columns.iter().map(|(name, _)| name.as_str()));
        let header = line(names);
        let rule = line(std::iter::repeat_n("---", self.own.len() + columns.len()));
        let rows = self.rows.iter().map(|(name, cells)| {
            let outcomes = columns.iter().map(|(_, of)| of.get(*name).map_or(self.untried, String::as_str));
            let name = format!("`{name}`");
            line(std::iter::once(name.as_str()).chain(cells.iter().copied()).chain(outcomes))
        });
        [header, rule].into_iter().chain(rows).collect()
    }
}

fn cells(line: &str) -> Vec<&str> {
    line.trim().trim_matches('|').split('|').map(str::trim).collect()
}

fn line<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    let cells: Vec<_> = cells.collect();
    format!("| {} |\n", cells.join(" | "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{programme, quirks};

    const TABLE: Table =
        Table { begin: "<begin>", end: "<end>", own: &["Name", "What"], untried: "not tried", rows: vec![] };

    fn outcomes(name: &str, outcome: &str) -> Outcomes {
        [(name.to_owned(), outcome.to_owned())].into()
    }

    #[test]
    fn one_autopilots_results_leave_the_others_alone() {
        let table = Table { rows: vec![("a", vec!["1"]), ("b", vec!["2"])], ..TABLE };
        let first = table
            .renewed("before\n<begin>\n<end>\nafter\n", Some(("A 1", &outcomes("a", "passed"))))
            .unwrap();
        let second = table.renewed(&first, Some(("B 2", &outcomes("b", "failed")))).unwrap();
        let third = table.renewed(&second, Some(("A 1", &outcomes("c", "passed")))).unwrap();
        let of = |name: &str| {
            cells(third.lines().find(|l| l.contains(&format!("`{name}`"))).unwrap())[2..].to_vec()
        };
        assert_eq!(of("a"), ["passed", "not tried"]);
        assert_eq!(of("b"), ["not tried", "failed"]);
        assert!(third.starts_with("before\n") && third.ends_with("\nafter\n"));
        assert_eq!(table.renewed(&third, None).unwrap(), third);
        assert_eq!(table.renewed("no table", None), None);
    }

    #[test]
    fn the_documents_have_the_tables_of_what_is_tried() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/docs/flight-tests.md");
        let document = std::fs::read_to_string(path).unwrap();
        let tables = [programme::table(), quirks::table()];
        let fresh = tables.iter().fold(document.clone(), |text, table| table.renewed(&text, None).unwrap());
        if std::env::var_os("LEGWORK_BLESS").is_some() {
            std::fs::write(path, fresh).unwrap();
            return;
        }
        assert!(fresh == document, "{path}: run this test once with LEGWORK_BLESS=1");
    }
}
