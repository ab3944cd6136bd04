//! What works without a window: check, preview and expand a plan.

use std::path::PathBuf;
use std::process::ExitCode;

/// A headless command.
#[derive(Debug, Clone, clap::Subcommand)]
pub enum Command {
    /// Say what is wrong with a plan.
    Check {
        /// The plan.
        file: PathBuf,
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

/// Carries a command out; 0 good, 1 problems, 2 usage or files.
pub fn run(_command: &Command) -> anyhow::Result<ExitCode> {
    Ok(ExitCode::from(2))
}
