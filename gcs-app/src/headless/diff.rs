//! `legwork diff`: what changed between two plans, and where an aircraft would go.

use super::source::{Loaded, Source};
use super::{check, forecast, select};
use aircraft::Wind;
use anyhow::{anyhow, bail};
use flight_exec::ProposalReport;
use flight_exec::preview::{Act, Scenario, Trigger, When};
use flight_plan::{Difference, FlightPlan, Id};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Where the aircraft is when the new plan comes.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Moment {
    /// Say where an aircraft that begins this leg of the old plan would go.
    #[arg(long, value_name = "LEG")]
    pub at: Option<String>,
    /// In this pass of the innermost loop around the leg, from 1.
    #[arg(long, value_name = "N", requires = "at")]
    pub pass: Option<u64>,
}

/// Prints the differences; 0 if there are none, else 1 (also when the new plan can't take over there).
///
/// # Errors
/// A file can't be read, or there is no such leg.
pub fn run(old: &Source, new: &Path, moment: &Moment, wind: Wind, json: bool) -> anyhow::Result<ExitCode> {
    let new = Source { file: new.to_owned(), ..old.clone() };
    let (before, after) = (readable(old)?, readable(&new)?);
    let changes = Changes::between(&before.reading.plan, &after.reading.plan);
    let report = match &moment.at {
        Some(leg) => match proposed(&old.file, (&before, &after), leg, moment.pass, wind)? {
            Some(report) => Some(report),
            None => return Ok(ExitCode::from(1)),
        },
        None => None,
    };
    match json {
        true => say!("{:#}", serde_json::json!({"changes": changes, "takeover": report})),
        false => changes.print(report.as_ref()),
    }
    let same = changes.is_empty() && report.is_none_or(|r| r.acceptable);
    Ok(ExitCode::from(u8::from(!same)))
}

/// A plan whose document is one.
fn readable(source: &Source) -> anyhow::Result<Loaded> {
    let loaded = source.load()?;
    super::foreign::tell(&source.file, &loaded.notes);
    if loaded.reading.has_errors() {
        loaded.reading.problems.iter().for_each(|p| eprintln!("{}:{p}", source.file.display()));
        bail!("{} is no plan that can be compared", source.file.display());
    }
    Ok(loaded)
}

/// What is different.
#[derive(Debug, serde::Serialize)]
struct Changes {
    added: Vec<Id>,
    removed: Vec<Id>,
    changed: Vec<Id>,
    /// Parts of the document besides legs.
    other: Vec<&'static str>,
}

impl Changes {
    fn between(old: &FlightPlan, new: &FlightPlan) -> Self {
        let Difference { added, removed, changed } = Difference::between(old, new);
        let mut changes = Self { added, removed, changed, other: other(old, new) };
        if changes.is_empty() && flight_plan::write(old) != flight_plan::write(new) {
            changes.other.push("names and stages");
        }
        changes
    }

    fn is_empty(&self) -> bool {
        self.added.is_empty() && self.removed.is_empty() && self.changed.is_empty() && self.other.is_empty()
    }

    fn print(&self, report: Option<&ProposalReport>) {
        if self.is_empty() {
            say!("no difference");
        }
        for (word, legs) in [("added", &self.added), ("removed", &self.removed), ("changed", &self.changed)] {
            legs.iter().for_each(|leg| say!("{word} {leg}"));
        }
        self.other.iter().for_each(|part| say!("changed {part}"));
        if let Some(report) = report {
            takeover(report).iter().for_each(|line| say!("{line}"));
        }
    }
}

fn other(old: &FlightPlan, new: &FlightPlan) -> Vec<&'static str> {
    let parts = [
        ("the aircraft", old.aircraft != new.aircraft),
        ("fixes", old.fixes != new.fixes),
        ("runways", old.runways != new.runways),
        ("variables", old.variables != new.variables),
        ("zones", old.zones != new.zones),
        ("procedures", old.procedures != new.procedures),
        ("the emergency plan in force", old.emergency != new.emergency),
    ];
    parts.into_iter().filter(|(_, differs)| *differs).map(|(part, _)| part).collect()
}

/// What the executor says when the new plan is put forward there; `None` if a plan can't be flown, after that was said.
fn proposed(
    file: &Path,
    (before, after): (&Loaded, &Loaded),
    leg: &str,
    pass: Option<u64>,
    wind: Wind,
) -> anyhow::Result<Option<ProposalReport>> {
    let leg = select::known_leg(&before.reading.plan, leg)?;
    let mut programs = Vec::new();
    for loaded in [before, after] {
        match loaded.compile() {
            Ok(compiled) => programs.push(compiled),
            Err(problems) => {
                check::print(file, &problems);
                return Ok(None);
            }
        }
    }
    let (Some((new, _)), Some((old, profile))) = (programs.pop(), programs.pop()) else { return Ok(None) };
    let at = When::Entering { leg: leg.clone(), iteration: pass };
    let then = vec![Act::Propose { program: Arc::new(new) }, Act::End];
    let scenario = Scenario { triggers: vec![Trigger { at, then }] };
    let mut preview = forecast::fly(&Arc::new(old), &profile, &before.terrain, wind, &scenario)?;
    if let Some((_, refusal)) = preview.refusals.first() {
        bail!("the new plan is refused there: {refusal}");
    }
    // the first one put the old plan itself forward
    let last = preview.proposals.pop().filter(|_| preview.not_fired.is_empty());
    let (_, report) = last.ok_or_else(|| anyhow!("the old plan never comes to leg `{leg}`"))?;
    Ok(Some(report))
}

fn takeover(report: &ProposalReport) -> Vec<String> {
    let mut lines = report.problems.clone();
    match (&report.next_leg, report.next_position) {
        _ if report.entry_needed => {
            lines.push("its leg is gone: the update must name the leg to enter".into())
        }
        (Some(leg), Some(position)) => {
            let (lat, lon) = (position.lat_deg, position.lon_deg);
            let when = report.next_in_m.zip(report.next_in_s);
            let when = when.map_or(String::new(), |(m, s)| format!(", in {m:.0} m and {s:.0} s"));
            lines.push(format!("the aircraft would go on leg {leg} to {lat:.6} {lon:.6}{when}"));
        }
        _ => lines.push("the aircraft would have nowhere to go".into()),
    }
    match report.differs_in_m.zip(report.differs_in_s) {
        Some((m, s)) => lines.push(format!("its way differs in {m:.0} m and {s:.0} s")),
        None => lines.push("its way is the same, as far ahead as it is laid out".into()),
    }
    if !report.acceptable {
        lines.push("the update can't be committed there".into());
    }
    lines
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::headless::source::tests::source;

    const SQUARE: &str = include_str!("../../../assets/plans/square.xml");

    fn status(old: &str, new: &str, moment: &Moment) -> anyhow::Result<String> {
        let (_old, old) = source(old.as_bytes());
        let (_new, new) = source(new.as_bytes());
        run(&old, &new.file, moment, Wind::default(), true).map(|status| format!("{status:?}"))
    }

    #[test]
    fn a_difference_has_status_1() {
        let (same, other) = (format!("{:?}", ExitCode::SUCCESS), format!("{:?}", ExitCode::from(1)));
        let renamed = SQUARE.replace("Square circuit", "Round circuit");
        let slower = SQUARE.replace("id=\"side3\"", "id=\"side3\" speed=\"20\"");
        let nowhere = Moment::default();
        assert_eq!(status(SQUARE, SQUARE, &nowhere).unwrap(), same);
        assert_eq!(status(SQUARE, &renamed, &nowhere).unwrap(), other);
        assert_eq!(status(SQUARE, &slower, &nowhere).unwrap(), other);
        assert!(status(SQUARE, "<oops/>", &nowhere).is_err());
        let at = |leg: &str| Moment { at: Some(leg.into()), pass: None };
        assert_eq!(status(SQUARE, SQUARE, &at("side2")).unwrap(), same);
        assert!(status(SQUARE, SQUARE, &at("side9")).is_err());
    }

    #[test]
    fn parts_besides_legs() {
        let plan = |text: &str| flight_plan::read(text).plan;
        let moved = SQUARE.replace("length=\"600\"", "length=\"700\"");
        let changes = Changes::between(&plan(SQUARE), &plan(&moved));
        // the landing legs of that runway are other ones, too
        assert!(changes.other.contains(&"runways"), "{changes:?}");
    }

    #[test]
    fn the_takeover_is_told() {
        let (_old, old) = source(SQUARE.as_bytes());
        let (_new, new) = source(SQUARE.replace("id=\"side2\"", "id=\"other\"").as_bytes());
        let (old, new) = (readable(&old).unwrap(), readable(&new).unwrap());
        let report =
            |leg| proposed(Path::new("old"), (&old, &new), leg, None, Wind::default()).unwrap().unwrap();
        let lines = takeover(&report("side2"));
        assert!(lines.iter().any(|l| l.contains("name the leg to enter")), "{lines:?}");
        let lines = takeover(&report("side3"));
        assert!(lines.iter().any(|l| l.starts_with("the aircraft would go on leg side3")), "{lines:?}");
    }
}
