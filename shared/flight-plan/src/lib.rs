//! Pure: the flight plan document: model, XML, problems and checks, edits, compilation to a program.

pub mod alternate;
pub mod checks;
pub mod clipboard;
pub mod create;
pub mod describe;
pub mod diff;
pub mod edit;
pub mod expression;
pub mod history;
mod ids;
pub mod model;
mod names;
pub mod problem;
pub mod procedure;
pub mod program;
pub mod template;
pub mod transform;
pub mod uses;
pub mod variables;
pub mod walk;
pub mod xml;

pub use alternate::{Alternates, InForce};
pub use checks::{IncrementalCache, check, check_again};
pub use diff::{Change, ChangeKind, Difference};
pub use edit::{Edit, EditError, Spot, Thing};
pub use expression::{Env, EvalError, Expression, FlightState};
pub use history::History;
pub use model::*;
pub use problem::{Location, Problem, Severity};
pub use procedure::instantiate;
pub use program::{LegPath, Program, compile, compile_again, compile_document, compile_reading};
pub use uses::{Part, Use};
pub use variables::{VariableError, Variables};
pub use walk::{Fork, LegContext, Loop, Section};
pub use xml::{Element, Places, Reading, hash, read, write};
