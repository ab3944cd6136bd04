//! The gateway as a whole.

mod flights;
mod shell;
