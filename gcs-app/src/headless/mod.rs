//! What works without a window: check, expand and preview a plan. For scripts and continuous checks.
//!
//! Exit status: 0 the plan is good (warnings allowed), 1 it has errors or can't be flown, 2 wrong usage or files.

mod check;
mod expand;
pub mod forecast;
mod preview;
mod source;
pub mod wind;

pub use source::{Loaded, Source};

use aircraft::Wind;
use std::path::PathBuf;
use std::process::ExitCode;

/// A headless command.
#[derive(Debug, Clone, clap::Subcommand)]
pub enum Command {
    /// Say what is wrong with a plan.
    Check {
        /// The plan and its surroundings.
        #[command(flatten)]
        source: Source,
        /// One JSON document instead of lines.
        #[arg(long)]
        json: bool,
    },
    /// Draw what would be flown: map, profile and leg table.
    Preview {
        /// The plan and its surroundings.
        #[command(flatten)]
        source: Source,
        /// Where the pictures and tables go.
        #[arg(long, value_name = "DIR", default_value = "legwork-preview")]
        out: PathBuf,
        /// Where the wind comes from (degrees true) and its speed (m/s).
        #[arg(long, value_name = "DIRECTION,SPEED", value_parser = wind::parse, default_value = "0,0")]
        wind: Wind,
    },
    /// List the waypoints that would be sent.
    Expand {
        /// The plan and its surroundings.
        #[command(flatten)]
        source: Source,
        /// One JSON document instead of CSV.
        #[arg(long)]
        json: bool,
        /// CSV (what comes without options, too).
        #[arg(long, conflicts_with = "json")]
        csv: bool,
        /// Where the wind comes from (degrees true) and its speed (m/s).
        #[arg(long, value_name = "DIRECTION,SPEED", value_parser = wind::parse, default_value = "0,0")]
        wind: Wind,
    },
}

/// Carries a command out.
///
/// # Errors
/// Files that can't be read or written, options that make no sense (exit status 2).
pub fn run(command: &Command) -> anyhow::Result<ExitCode> {
    match command {
        Command::Check { source, json } => check::run(source, *json),
        Command::Preview { source, out, wind } => preview::run(source, *wind, out),
        Command::Expand { source, json, csv: _, wind } => expand::run(source, *wind, *json),
    }
}
