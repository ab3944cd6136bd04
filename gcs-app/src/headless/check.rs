//! `legwork check`: everything that is wrong with a plan.

use super::source::Loaded;
use super::{Source, foreign, progress};
use crate::say;
use flight_exec::Conditions;
use flight_plan::{Edit, FlightPlan, Problem, Verdict, diff};
use interchange::Note;
use std::path::Path;
use std::process::ExitCode;

/// Most edits that are described: for each the plan is edited and compared with the old one.
const MAX_FIXES: usize = 100;
/// How the progress is shown.
const PROGRESS: &str =
    "{spinner} check {bar:30} flight {pos} of {len} with other values of variables, {elapsed}";

/// The conditions of the review.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Circumstances {
    /// Wind and time.
    #[command(flatten)]
    pub air: super::wind::Air,
    /// The plan only, not the path.
    #[arg(long)]
    pub quick: bool,
}

/// Prints the problems, as lines `file:line:column: severity [code] subject: message` or as one JSON document; 0
/// if the plan may be flown, else 1.
///
/// # Errors
/// A file can't be read, or standard output not written.
pub fn run(source: &Source, circumstances: &Circumstances, json: bool) -> anyhow::Result<ExitCode> {
    let (loaded, mut problems) = progress::busy("reading and checking the plan", || {
        let loaded = source.load()?;
        circumstances.air.suits(&loaded.reading.plan)?;
        let problems = loaded.problems();
        anyhow::Ok((loaded, problems))
    })?;
    if !circumstances.quick {
        problems.extend(reviewed(&loaded, circumstances.air.conditions()));
    }
    if json {
        say::document(&document(&source.file, &loaded.reading.plan, &problems, &loaded.notes))?;
    } else {
        foreign::print_notes(&source.file, &loaded.notes);
        print(&source.file, &problems)?;
    }
    Ok(status(&problems))
}

/// What a review of the path finds, with a bar that counts the values of variables that are tried.
fn reviewed(loaded: &Loaded, conditions: Conditions) -> Vec<Problem> {
    let bar = progress::bar(PROGRESS);
    progress::shown(&bar, || {
        loaded.review_changes(conditions, &mut |done, all| {
            bar.set_length(all as u64);
            bar.set_position(done as u64);
        })
    })
}

/// Prints problems for people, and what they come to.
fn print(file: &Path, problems: &[Problem]) -> std::io::Result<()> {
    problems.iter().try_for_each(|problem| say!("{}", line(file, problem)))?;
    say!("{}: {}", file.display(), Verdict::of(problems))
}

/// A problem as one line.
pub fn line(file: &Path, problem: &Problem) -> String {
    format!("{}:{}{problem}", file.display(), if problem.location.is_some() { "" } else { " " })
}

/// Complains about problems where something else is printed; gives the exit status.
pub fn print_errors(file: &Path, problems: &[Problem]) -> ExitCode {
    problems.iter().for_each(|problem| complain!("{}", line(file, problem)));
    status(problems)
}

/// 0 if none of them forbids flying, else 1.
pub fn status(problems: &[Problem]) -> ExitCode {
    ExitCode::from(u8::from(problems.iter().any(Problem::is_error)))
}

/// What a remedy would do to the plan: a sentence, and its parts as data; null if it can't be applied (to a leg that only a call
/// makes).
fn fix(plan: &FlightPlan, edit: &Edit) -> serde_json::Value {
    let changes = diff::of_edit(plan, edit);
    if changes.is_empty() {
        return serde_json::Value::Null;
    }
    let sentence = changes.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ");
    serde_json::json!({"message": sentence, "changes": changes})
}

fn document(file: &Path, plan: &FlightPlan, problems: &[Problem], notes: &[Note]) -> serde_json::Value {
    let mut remedies = 0;
    let rows: Vec<_> = problems
        .iter()
        .map(|p| {
            remedies += usize::from(p.fix.is_some());
            let told = p.fix.as_ref().filter(|_| remedies <= MAX_FIXES);
            serde_json::json!({
                "code": p.code,
                "severity": p.severity,
                "subject": p.subject,
                "zone": p.zone,
                "line": p.location.map(|l| l.line),
                "column": p.location.map(|l| l.column),
                "message": p.message,
                "fix": told.map(|edit| fix(plan, edit)),
            })
        })
        .collect();
    let good = !problems.iter().any(Problem::is_error);
    serde_json::json!({
        "file": file.display().to_string(),
        "good": good,
        "problems": rows,
        "fixes_left_out": remedies.saturating_sub(MAX_FIXES),
        "notes": notes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::headless::source::tests::source;
    use flight_plan::Value;

    #[test]
    fn a_bad_plan_has_status_1_and_places() {
        let (_file, source) = source(b"<flightPlan xmlns=\"urn:legwork:flight-plan:1\" name=\"x\" aircraft=\"trainer\">\n<oops/>\n</flightPlan>");
        let loaded = source.load().unwrap();
        let problems = loaded.problems();
        assert_eq!(format!("{:?}", status(&problems)), format!("{:?}", ExitCode::from(1)));
        let json = document(&source.file, &loaded.reading.plan, &problems, &[]);
        assert!(json["problems"][0]["fix"].is_null(), "{json:#}");
        assert_eq!(json["good"], false);
        assert!(json["problems"].as_array().unwrap().iter().any(|p| p["line"] == 2), "{json:#}");
        assert_eq!(
            format!("{:?}", run(&source, &Circumstances::default(), true).unwrap()),
            format!("{:?}", ExitCode::from(1))
        );
    }

    #[test]
    fn a_remedy_is_told_with_what_it_changes() {
        let (_file, source) = source(include_bytes!("../../../assets/plans/bad/bad-count.xml"));
        let loaded = source.load().unwrap();
        let json = document(&source.file, &loaded.reading.plan, &loaded.problems(), &[]);
        let fix = &json["problems"][0]["fix"];
        let said = fix["message"].as_str().unwrap();
        assert!(said.starts_with("leg ") && said.contains(" changed: count "), "{json:#}");
        assert_eq!(fix["changes"][0]["fate"], "changed");
    }

    /// For each the plan is edited and compared: a long list of them would take a minute.
    #[test]
    fn of_very_many_remedies_the_first_are_told_and_the_rest_counted() {
        let plan = flight_plan::read(include_bytes!("../../../assets/plans/square.xml")).plan;
        let fix = flight_plan::Edit::SetSpeed { of: "side1".into(), speed_mps: Some(Value::Constant(20.0)) };
        let problem = Problem { fix: Some(fix.into()), ..Problem::warning("too-slow", "slow") };
        let json = document(Path::new("a"), &plan, &vec![problem; 10_000], &[]);
        let told = json["problems"].as_array().unwrap().iter().filter(|p| !p["fix"].is_null()).count();
        assert_eq!((told, &json["fixes_left_out"]), (100, &9_900.into()));
    }
}
