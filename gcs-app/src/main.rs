//! Command line of `legwork`.

use clap::{Parser, Subcommand};
use gcs_app::{demo, headless};
use std::process::ExitCode;

/// Program a UAV's flight instead of placing waypoints.
#[derive(Debug, Parser)]
#[command(name = "legwork", version, about, subcommand_precedence_over_arg = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Task>,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Fly the fire-watch mission with an embedded simulator and agent.
    Demo(demo::Args),
    #[command(flatten)]
    Headless(headless::Command),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    match cli.command {
        Some(Task::Demo(args)) => status(demo::run(&args)),
        Some(Task::Headless(command)) => status(headless::run(&command)),
        None => ExitCode::SUCCESS,
    }
}

fn status(result: anyhow::Result<ExitCode>) -> ExitCode {
    result.unwrap_or_else(|error| {
        eprintln!("legwork: {error:#}");
        ExitCode::from(2)
    })
}
