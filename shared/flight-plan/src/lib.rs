//! Pure: the flight plan document: model, XML, problems and checks, edits, compilation to a program.

pub mod model;
pub mod program;

pub use model::*;
pub use program::Program;
