//! What is wrong with a plan: one sentence each, with its place and often its remedy.

use crate::{Edit, Id, legible};
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

/// A place in a document, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Location {
    /// Line.
    pub line: usize,
    /// Column, characters.
    pub column: usize,
}

impl std::fmt::Display for Location {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
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
    /// Where in the document, if the plan was read from one.
    pub location: Option<Location>,
    /// For people; says what to do.
    pub message: String,
    /// An edit that removes the problem, where there is an obvious one.
    pub fix: Option<Box<Edit>>,
}

impl Problem {
    /// A problem that forbids flying, at no place yet.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: Severity::Error,
            subject: None,
            location: None,
            message: legible(&message.into()).into_owned(),
            fix: None,
        }
    }

    /// A problem that does not forbid flying, at no place yet.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, message) }
    }

    /// The same problem, of this subject.
    pub fn of(self, subject: &Id) -> Self {
        Self { subject: Some(subject.clone()), ..self }
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
