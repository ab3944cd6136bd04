//! What works without a window: check, expand and preview a plan. For scripts and continuous checks.
//!
//! Exit status: 0 the plan is good (warnings allowed), 1 it has errors or can't be flown, 2 wrong usage or files.

mod check;
mod source;

pub use source::Source;

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
    /// Draw what would be flown.
    Preview {
        /// The plan.
        file: PathBuf,
    },
    /// List the waypoints that would be sent.
    Expand {
        /// The plan.
        file: PathBuf,
    },
}

/// Carries a command out.
///
/// # Errors
/// Files that can't be read or written, options that make no sense (exit status 2).
pub fn run(command: &Command) -> anyhow::Result<ExitCode> {
    match command {
        Command::Check { source, json } => check::run(source, *json),
        _ => Ok(ExitCode::from(2)),
    }
}
