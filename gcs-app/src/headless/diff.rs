//! `legwork diff`: what changed between two plans, and where an aircraft would go.

use super::output::DASH;
use super::source::{Loaded, Source};
use super::wind::Air;
use super::{check, forecast, select};
use crate::say;
use anyhow::{anyhow, bail};
use flight_exec::ProposalReport;
use flight_exec::rehearse::{Act, Scenario, Trigger, When};
use flight_plan::{Change, FlightPlan, Id, Problem};
use std::path::Path;
use std::process::ExitCode;

/// Where the aircraft is when the new plan comes.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Moment {
    /// Say where an aircraft that begins this leg of the old plan (in a call: CALL.LEG) would go.
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
pub fn run(old: &Source, new: &Path, moment: &Moment, air: Air, json: bool) -> anyhow::Result<ExitCode> {
    if old.file.as_os_str() == DASH && new.as_os_str() == DASH {
        bail!("standard input can be only one of the plans: name a file for the other");
    }
    let new = Source { file: new.to_owned(), ..old.clone() };
    let (Some(before), Some(after)) = (readable(old)?, readable(&new)?) else { return Ok(ExitCode::from(1)) };
    let changes = flight_plan::diff::changes(&before.reading.plan, &after.reading.plan);
    let takeover = match &moment.at {
        Some(leg) => Some(takeover((old, &before), (&new, &after), leg, moment.pass, air)?),
        None => None,
    };
    match json {
        true => say::document(&document(&changes, takeover.as_ref())),
        false => lines(&changes, takeover.as_ref()).iter().try_for_each(|line| say!("{line}")),
    }?;
    let acceptable = takeover.is_none_or(|takeover| takeover.is_ok_and(|report| report.acceptable));
    Ok(ExitCode::from(u8::from(!(changes.is_empty() && acceptable))))
}

/// A plan without errors of reading; otherwise prints its problems.
fn readable(source: &Source) -> anyhow::Result<Option<Loaded>> {
    let loaded = source.load()?;
    super::foreign::print_notes(&source.file, &loaded.notes);
    if loaded.reading.has_errors() {
        check::print_errors(&source.file, &loaded.reading.problems);
        complain!("{} can't be compared: correct its errors first", source.file.display());
        return Ok(None);
    }
    Ok(Some(loaded))
}

/// What the executor says when the new plan comes, or the problems for which one of the plans can't be flown.
type Takeover = Result<ProposalReport, Vec<String>>;

fn document(changes: &[Change], takeover: Option<&Takeover>) -> serde_json::Value {
    let report = takeover.and_then(|takeover| takeover.as_ref().ok());
    let problems = takeover.and_then(|takeover| takeover.as_ref().err());
    serde_json::json!({"changes": changes, "takeover": report, "problems": problems})
}

fn lines(changes: &[Change], takeover: Option<&Takeover>) -> Vec<String> {
    let mut lines: Vec<String> = changes.iter().map(Change::to_string).collect();
    if changes.is_empty() {
        lines.push("no difference".into());
    }
    match takeover {
        None => {}
        Some(Ok(report)) => lines.extend(takeover_lines(report)),
        Some(Err(problems)) => {
            lines.extend(problems.iter().cloned());
            lines.push("the update would be refused".into());
        }
    }
    lines
}

/// What happens to an aircraft that begins a leg of the old plan when the new one is proposed. The new plan is reviewed as on board,
/// its path included.
fn takeover(
    (old, before): (&Source, &Loaded),
    (new, after): (&Source, &Loaded),
    leg: &str,
    pass: Option<u64>,
    air: Air,
) -> anyhow::Result<Takeover> {
    air.suits(&before.reading.plan)?;
    let (flown, _) = flight_plan::instantiate(&before.reading.plan);
    let leg = select::known_leg(&flown, leg)?;
    let refused = |file: &Source, problems: Vec<Problem>| {
        Err(problems.iter().map(|problem| check::line(&file.file, problem)).collect())
    };
    let (program, profile) = match before.compile() {
        Ok(compiled) => compiled,
        Err(problems) => return Ok(refused(old, problems)),
    };
    let (update, _) = match after.compile() {
        Ok(compiled) => compiled,
        Err(problems) => return Ok(refused(new, problems)),
    };
    let forbidden = after.forbidden(air.conditions());
    if !forbidden.is_empty() {
        return Ok(refused(new, forbidden));
    }
    let place = reached(&flown, &leg, pass)?;
    let at = When::Entering { leg, iteration: pass };
    let then = vec![Act::Propose { program: update }, Act::End];
    let scenario = Scenario { triggers: vec![Trigger { at, then }] };
    // the flight ends where it reaches the place; any other end comes before that
    let (terrain, scenario) = (&before.terrain, &scenario);
    let mut preview = forecast::Ahead { program: &program, profile, terrain, air, scenario }
        .fly()
        .map_err(|why| anyhow!("the old plan never reaches {place}: {why}"))?;
    if let Some((_, refusal)) = preview.refusals.first() {
        bail!("the new plan is refused there: {refusal}");
    }
    // the first proposal was the old plan itself
    let last = preview.proposals.pop().filter(|_| preview.not_fired.is_empty());
    let (_, report) = last.ok_or_else(|| anyhow!("the old plan never reaches {place}"))?;
    Ok(Ok(report))
}

/// A leg and its pass, for people.
///
/// # Errors
/// A pass of a leg that no loop is around.
fn reached(flown: &FlightPlan, leg: &Id, pass: Option<u64>) -> anyhow::Result<String> {
    let Some(pass) = pass else { return Ok(format!("leg `{leg}`")) };
    if flown.leg(leg).is_none_or(|context| context.loops.is_empty()) {
        bail!("`{leg}` is in no loop: leave --pass out");
    }
    Ok(format!("pass {pass} of leg `{leg}`"))
}

fn takeover_lines(report: &ProposalReport) -> Vec<String> {
    let mut lines = report.problems.clone();
    match (&report.next_leg, report.next_position) {
        _ if report.entry_needed => {
            lines.push("its leg is gone: the update must name the leg to enter".into());
            lines.extend(report.entries.iter().map(|entry| {
                let (lat, lon) = (entry.position.lat_deg, entry.position.lon_deg);
                let (leg, m, s) = (&entry.leg, entry.in_m, entry.in_s);
                format!("entering at {leg}, it would go to {lat:.6} {lon:.6}, in {m:.0} m and {s:.0} s")
            }));
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
        Some((m, s)) => lines.push(format!("its path differs in {m:.0} m and {s:.0} s")),
        None if report.entry_needed => {}
        None => lines.push("its path is the same, as far ahead as it is laid out".into()),
    }
    if !report.acceptable {
        lines.push("the update can't be committed there".into());
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::headless::source::tests::source;

    const SQUARE: &str = include_str!("../../../assets/plans/square.xml");

    fn status(old: &str, new: &str, moment: &Moment) -> anyhow::Result<String> {
        let (_old, old) = source(old.as_bytes());
        let (_new, new) = source(new.as_bytes());
        run(&old, &new.file, moment, Air::default(), true).map(|status| format!("{status:?}"))
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
        assert_eq!(status(SQUARE, "<oops/>", &nowhere).unwrap(), other);
        let at = |leg: &str| Moment { at: Some(leg.into()), pass: None };
        assert_eq!(status(SQUARE, SQUARE, &at("side2")).unwrap(), same);
        assert!(status(SQUARE, SQUARE, &at("side9")).is_err());
    }

    fn said(old: &str, new: &str, at: Option<&str>) -> Vec<String> {
        let (_old, old) = source(old.as_bytes());
        let (_new, new) = source(new.as_bytes());
        let (before, after) = (readable(&old).unwrap().unwrap(), readable(&new).unwrap().unwrap());
        let changes = flight_plan::diff::changes(&before.reading.plan, &after.reading.plan);
        let air = Air::default();
        let takeover = at.map(|leg| takeover((&old, &before), (&new, &after), leg, None, air).unwrap());
        lines(&changes, takeover.as_ref())
    }

    #[test]
    fn every_part_is_told_with_what_changed() {
        let longer = SQUARE.replace("length=\"600\"", "length=\"700\"");
        let higher = longer.replace("id=\"side3\"", "id=\"side3\" speed=\"20\"");
        let lines = said(SQUARE, &higher, None);
        assert!(lines.iter().any(|l| l.starts_with("runway ") && l.contains("600 → 700")), "{lines:?}");
        assert!(lines.iter().any(|l| l.starts_with("leg side3 changed")), "{lines:?}");
    }

    #[test]
    fn the_takeover_is_told() {
        let renamed = SQUARE.replace("id=\"side2\"", "id=\"other\"");
        let lines = said(SQUARE, &renamed, Some("side2"));
        assert!(lines.iter().any(|l| l.contains("name the leg to enter")), "{lines:?}");
        assert!(lines.iter().any(|l| l.starts_with("entering at side3, it would go to 36.")), "{lines:?}");
        let lines = said(SQUARE, &renamed, Some("side3"));
        assert!(lines.iter().any(|l| l.starts_with("the aircraft would go on leg side3")), "{lines:?}");
    }

    #[test]
    fn a_call_and_its_legs_are_places_too() {
        let navaid = include_str!("../../../assets/plans/navaid-inspection.xml");
        let slower = navaid.replace("default=\"= 24.0\"", "default=\"= 23.0\"");
        for at in ["radial-100", "radial-100.round"] {
            let lines = said(navaid, &slower, Some(at));
            assert!(
                lines.iter().any(|l| l.starts_with("the aircraft would go on leg radial-100.")),
                "{lines:?}"
            );
        }
    }

    /// ActivePlan it would be refused, and the file with the problem is named.
    #[test]
    fn an_update_into_a_zone_is_refused() {
        let zone =
            r#"<zones><keepOut id="z" lat="36.305396" lon="-84.178238" radius="200"/></zones><mainPlan"#;
        let (_old, old) = source(SQUARE.as_bytes());
        let (_new, new) = source(SQUARE.replacen("<mainPlan", zone, 1).as_bytes());
        let (before, after) = (readable(&old).unwrap().unwrap(), readable(&new).unwrap().unwrap());
        let problems =
            takeover((&old, &before), (&new, &after), "side2", None, Air::default()).unwrap().unwrap_err();
        let file = new.file.display().to_string();
        assert!(problems.iter().all(|p| p.starts_with(&file)), "{problems:?}");
        assert!(problems.iter().any(|p| p.contains("[keep-out]")), "{problems:?}");
    }

    #[test]
    fn a_place_that_is_never_reached_is_named_with_its_pass() {
        let stop = "<intersection id=\"ask\"><branch id=\"on\"/><branch id=\"by\" next=\"side3\"/></intersection><TF id=\"side2\"";
        let waits = SQUARE.replace("<TF id=\"side2\"", stop);
        let looped = SQUARE
            .replace("<TF id=\"side2\"", "<iterative id=\"l\" form=\"forward\" count=\"2\"><TF id=\"side2\"")
            .replace("<TF id=\"side4\"", "</iterative><TF id=\"side4\"");
        for (plan, leg, pass, said) in [
            (&looped, "side3", Some(7), "never reaches pass 7 of leg `side3`"),
            (&looped, "side1", Some(2), "`side1` is in no loop: leave --pass out"),
            (&waits, "side3", None, "never reaches leg `side3`: the energy is used up"),
        ] {
            let error = status(plan, SQUARE, &Moment { at: Some(leg.into()), pass }).unwrap_err();
            assert!(error.to_string().contains(said), "{error}");
        }
    }

    #[test]
    fn standard_input_is_one_plan() {
        let input = Source { file: "-".into(), ..Source::default() };
        let error = run(&input, Path::new("-"), &Moment::default(), Air::default(), true).unwrap_err();
        assert!(error.to_string().contains("standard input"), "{error}");
    }
}
