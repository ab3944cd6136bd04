//! The demo: simulator, agent and window in one process, talking over loopback.

mod judge;
mod mission;
mod progress;
mod recorder;

use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `legwork demo`.
#[derive(Debug, Clone, clap::Args)]
pub struct Args {
    /// Fly without a window, as fast as the machine allows.
    #[arg(long)]
    pub headless: bool,
    /// Where the report goes.
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
}

/// Flies the demo; the status is a success only if the mission was flown as planned.
pub fn run(_args: &Args) -> anyhow::Result<ExitCode> {
    Ok(ExitCode::FAILURE)
}
