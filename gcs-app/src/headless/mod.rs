//! Commands without a window: check, expand, convert, preview and compare plans. For scripts and continuous checks.
//!
//! Exit status: 0 all is well (warnings and notes allowed), 1 the plan has errors, can't be flown, or plans differ,
//! 2 wrong usage, or a file that can't be read or written.

mod check;
mod convert;
mod diff;
mod expand;
pub mod forecast;
mod foreign;
mod help;
mod log;
mod log_export;
mod output;
mod preview;
mod progress;
mod select;
mod source;
mod tiles;
pub mod wind;

pub use source::{Loaded, Source};

use std::path::PathBuf;
use std::process::ExitCode;

/// A headless command.
#[derive(Debug, Clone, clap::Subcommand)]
pub enum Command {
    /// Report what is wrong with a plan.
    ///
    /// Prints a line for each problem: file:line:column: severity [code] subject: message. A plan without errors
    /// is also flown ahead of time, with every branch and every emergency plan, and the path is reviewed: zones, terrain, climbs,
    /// energy, reach of the runways.
    ///
    /// With --json each problem also has a `fix`: null, or the edit that the ground station offers, as a sentence
    /// (`message`) and part by part (`changes`, as `legwork diff --json` lists them). At most a hundred edits are described;
    /// `fixes_left_out` counts the others.
    #[command(after_help = help::CHECK)]
    Check {
        /// The plan and its surroundings.
        #[command(flatten)]
        source: Box<Source>,
        /// The conditions of the review.
        #[command(flatten, next_help_heading = "Review of the path")]
        circumstances: check::Circumstances,
        /// One JSON document instead of lines.
        #[arg(long, help_heading = None::<&str>)]
        json: bool,
    },
    /// Draw what would be flown: map, profile and leg table.
    #[command(after_help = help::PREVIEW)]
    Preview {
        /// The plan and its surroundings.
        #[command(flatten)]
        source: Box<Source>,
        /// What is flown.
        #[command(flatten, next_help_heading = "What is flown")]
        selection: select::Selection,
        /// Where the report goes.
        #[command(flatten, next_help_heading = "What is written")]
        target: preview::Target,
        /// Wind and time.
        #[command(flatten, next_help_heading = "What is flown")]
        air: wind::Air,
    },
    /// List the waypoints that would be sent.
    ///
    /// The executor flies the plan with the simulated aircraft: these are the waypoints that the autopilot would receive.
    #[command(after_help = help::EXPAND)]
    Expand {
        /// The plan and its surroundings.
        #[command(flatten)]
        source: Box<Source>,
        /// What is flown.
        #[command(flatten, next_help_heading = "What is flown")]
        selection: select::Selection,
        /// Where and how they are written.
        #[command(flatten, next_help_heading = "What is written")]
        written: expand::Written,
        /// Wind and time.
        #[command(flatten, next_help_heading = "What is flown")]
        air: wind::Air,
    },
    /// Convert a plan from and to other programs' formats.
    ///
    /// To XML, the plan is written; to any other format, the waypoints that are flown and what else the format can hold. What was
    /// assumed or can't be carried over is listed on standard error.
    #[command(after_help = help::CONVERT)]
    Convert {
        /// The plan and its surroundings.
        #[command(flatten)]
        source: Box<Source>,
        /// What is written where.
        #[command(flatten, next_help_heading = "What is written")]
        target: convert::Target,
        /// What is flown.
        #[command(flatten, next_help_heading = "What is flown")]
        selection: select::Selection,
        /// Wind and time.
        #[command(flatten, next_help_heading = "What is flown")]
        air: wind::Air,
    },
    /// Report what differs between two plans, and where an aircraft would go.
    #[command(after_help = help::DIFF)]
    Diff {
        /// The old plan and its surroundings.
        #[command(flatten)]
        old: Box<Source>,
        /// The new plan.
        #[arg(value_name = "NEW", help_heading = None::<&str>)]
        new: PathBuf,
        /// Where the aircraft is.
        #[command(flatten, next_help_heading = "Where the aircraft is")]
        moment: diff::Moment,
        /// Wind and time.
        #[command(flatten, next_help_heading = "Where the aircraft is")]
        air: wind::Air,
        /// One JSON document instead of lines.
        #[arg(long, help_heading = None::<&str>)]
        json: bool,
    },
    /// Say what a flight recording holds, check it, and export track and events.
    #[command(after_help = help::LOG)]
    Log(log::Args),
}

/// Runs a command.
///
/// # Errors
/// Files that can't be read or written, options that make no sense (exit status 2).
pub fn run(command: &Command) -> anyhow::Result<ExitCode> {
    match command {
        Command::Check { source, circumstances, json } => check::run(source, circumstances, *json),
        Command::Preview { source, selection, target, air } => preview::run(source, *air, selection, target),
        Command::Expand { source, selection, written, air } => expand::run(source, *air, selection, written),
        Command::Convert { source, target, selection, air } => convert::run(source, *air, selection, target),
        Command::Log(args) => log::run(args),
        Command::Diff { old, new, moment, air, json } => diff::run(old, new, moment, *air, *json),
    }
}
