//! Plain values of a flight: they know the plan's identifiers and nothing of how it is flown.

mod choice;
mod config;
mod decision;
mod loop_count;

pub use choice::{By, Choice};
pub use config::Config;
pub use decision::Decision;
pub use loop_count::LoopCount;
