//! Pure: the flight plan document: model, XML, problems and checks, edits, compilation to a program.

pub mod checks;
pub mod edit;
pub mod expression;
pub mod model;
pub mod problem;
pub mod program;
pub mod variables;
pub mod walk;
pub mod xml;

pub use checks::check;
pub use edit::Edit;
pub use expression::{Env, EvalError, Expression, FlightState};
pub use model::*;
pub use problem::{Location, Problem, Severity};
pub use program::{LegPath, Program, Use, compile, compile_document};
pub use variables::{VariableError, Variables};
pub use walk::{LegContext, Section};
pub use xml::{Places, Reading, hash, read, write};
