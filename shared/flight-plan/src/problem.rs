//! What is wrong with a plan: one sentence each, with its place and often its remedy.

use crate::{AtSource, Edit, Id, legible};
use geometry::LatLon;
use serde::Serialize;

/// How bad a problem is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// The plan can be flown; a person should consider this first.
    Warning,
    /// The plan can't be flown.
    Error,
}

/// What may be the cause of all others stands before them, errors too.
const CAUSE: &str = "far-away";
/// What stands before others, the gravest first: what ends in the ground, how the flight ends, what becomes of it after a failure,
/// and what was not looked at.
const GRAVE: [&str; 8] = [
    "below-terrain",
    "no-landing",
    "glide-out-of-reach",
    "glide-into-terrain",
    "glide-just-reached",
    "no-emergency-plan",
    "low-clearance",
    "not-reviewed",
];

/// What the problems of a plan come to, in the same words everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Verdict {
    /// Problems that forbid flying.
    pub errors: usize,
    /// Problems that a person should consider.
    pub warnings: usize,
}

impl Verdict {
    /// Of these problems.
    pub fn of<'a>(problems: impl IntoIterator<Item = &'a Problem>) -> Self {
        let (mut errors, mut all) = (0, 0);
        for problem in problems {
            errors += usize::from(problem.is_error());
            all += 1;
        }
        Self { errors, warnings: all - errors }
    }
}

impl std::fmt::Display for Verdict {
    /// `can be flown, 2 warnings`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let counted =
            |number: usize, what: &str| format!("{number} {what}{}", if number == 1 { "" } else { "s" });
        match (self.errors, self.warnings) {
            (0, 0) => f.write_str("can be flown, no problems"),
            (0, warnings) => write!(f, "can be flown, {}", counted(warnings, "warning")),
            (errors, 0) => write!(f, "can't be flown, {}", counted(errors, "error")),
            (errors, warnings) => {
                write!(f, "can't be flown, {}, {}", counted(errors, "error"), counted(warnings, "warning"))
            }
        }
    }
}

/// A place in a document, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Location {
    /// Line.
    pub line: u32,
    /// Column, characters.
    pub column: u32,
}

impl Location {
    /// What does not fit is the last one that does.
    pub fn new(line: usize, column: usize) -> Self {
        let fitting = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
        Self { line: fitting(line), column: fitting(column) }
    }
}

impl std::fmt::Display for Location {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// Where a flight goes wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct FlownAt {
    /// The place.
    pub position: LatLon,
    /// The flight as planned does not come there this way: another branch does.
    pub is_off_plan: bool,
    /// That branch with its fork, where it is known: fork, branch.
    pub branch: Option<(Id, Id)>,
}

impl From<LatLon> for FlownAt {
    /// The flight as planned comes there.
    fn from(position: LatLon) -> Self {
        Self { position, is_off_plan: false, branch: None }
    }
}

/// Something wrong with a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// Short and stable, for programs and tests: `rf-not-tangent`, `unknown-fix`, …
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// Whose problem: a leg, stage, fix, runway, variable or emergency plan.
    pub subject: Option<Id>,
    /// A zone that the subject comes into conflict with.
    pub zone: Option<Box<Id>>,
    /// Where it is flown, if that is wrong at one place.
    pub place: Option<Box<FlownAt>>,
    /// Where in the document, if the plan was read from one.
    pub location: Option<Location>,
    /// For people; says what to do. Its first sentence is short, details come behind it: see [`Problem::headline`].
    pub message: String,
    /// An edit that removes the problem, where there is an obvious one.
    pub fix: Option<Box<Edit>>,
    /// Another choice: what is wrong is inherited, by other legs too, and can be changed for all of them.
    pub at_source: Option<Box<AtSource>>,
}

impl Problem {
    /// A problem that forbids flying, at no place yet.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: Severity::Error,
            subject: None,
            zone: None,
            place: None,
            location: None,
            message: legible(&message.into()).into_owned(),
            fix: None,
            at_source: None,
        }
    }

    /// A problem that does not forbid flying, at no place yet.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, message) }
    }

    /// Says it in other words, as legible as the first ones.
    pub fn reword(&mut self, message: impl Into<String>) {
        self.message = legible(&message.into()).into_owned();
    }

    /// The same problem, of this subject.
    pub fn of(self, subject: &Id) -> Self {
        Self { subject: Some(subject.clone()), ..self }
    }

    /// The same problem, with this zone.
    pub fn with_zone(self, zone: &Id) -> Self {
        Self { zone: Some(Box::new(zone.clone())), ..self }
    }

    /// The same problem, at this place of the flight.
    pub fn with_place(self, place: impl Into<FlownAt>) -> Self {
        Self { place: Some(Box::new(place.into())), ..self }
    }

    /// The same problem, at this place of the document.
    pub fn at(self, location: Location) -> Self {
        Self { location: Some(location), ..self }
    }

    /// The same problem, with an edit that removes it.
    pub fn fixed_by(self, edit: Edit) -> Self {
        Self { fix: Some(Box::new(edit)), ..self }
    }

    /// The same problem, with an edit that removes it, if there is one.
    pub fn perhaps_fixed_by(self, edit: Option<Edit>) -> Self {
        match edit {
            Some(edit) => self.fixed_by(edit),
            None => self,
        }
    }

    /// Its place in a list for people: what may be the cause of the rest, what forbids flying, then the gravest warnings.
    pub fn rank(&self) -> (bool, bool, usize) {
        let grave = GRAVE.iter().position(|code| *code == self.code);
        (self.code != CAUSE, !self.is_error(), grave.unwrap_or(GRAVE.len()))
    }

    /// The flight as planned is not what is wrong: another branch leads there.
    pub fn is_off_plan(&self) -> bool {
        self.place.as_ref().is_some_and(|place| place.is_off_plan)
    }

    /// What it says first, in one sentence: the rest of its message is details.
    pub fn headline(&self) -> &str {
        self.message.split_once(". ").map_or(self.message.as_str(), |(first, _)| first)
    }

    /// Forbids flying.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

impl std::fmt::Display for Problem {
    /// `line:column: error [code] subject: message`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(location) = self.location {
            write!(f, "{location}: ")?;
        }
        let severity = if self.is_error() { "error" } else { "warning" };
        write!(f, "{severity} [{}] ", self.code)?;
        if let Some(subject) = &self.subject {
            write!(f, "{}: ", legible(subject.as_str()))?;
        }
        f.write_str(&self.message)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_says_what_there_is() {
        let (error, warning) = (Problem::error("a", "a"), Problem::warning("b", "b"));
        for (problems, said) in [
            (vec![], "can be flown, no problems"),
            (vec![&warning], "can be flown, 1 warning"),
            (vec![&warning, &error, &error], "can't be flown, 2 errors, 1 warning"),
            (vec![&error], "can't be flown, 1 error"),
        ] {
            assert_eq!(Verdict::of(problems).to_string(), said);
        }
    }

    #[test]
    fn the_first_sentence_is_the_headline() {
        for (message, headline) in [
            ("fly 12.5 m higher: it is low. That is at 36.3, -84.2", "fly 12.5 m higher: it is low"),
            ("give it a count", "give it a count"),
        ] {
            assert_eq!(Problem::warning("a", message).headline(), headline);
        }
    }

    #[test]
    fn errors_stand_before_warnings_and_the_end_of_the_flight_before_the_rest() {
        let mut problems = [
            Problem::warning("too-slow", ""),
            Problem::warning("not-reviewed", ""),
            Problem::warning("no-landing", ""),
            Problem::error("keep-out", ""),
            Problem::warning("far-away", ""),
        ];
        problems.sort_by_key(Problem::rank);
        let codes = ["far-away", "keep-out", "no-landing", "not-reviewed", "too-slow"];
        assert_eq!(problems.map(|p| p.code), codes);
    }
}
