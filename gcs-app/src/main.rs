//! Command line of `legwork`.

use anyhow::Context;
use clap::{Args, Parser, Subcommand};
use gcs_app::app::{self, Options, Screenshot};
use gcs_app::{demo, headless};
use std::path::PathBuf;
use std::process::ExitCode;

/// Program a UAV's flight instead of placing waypoints.
///
/// Without a command, opens the ground station's window. `legwork COMMAND --help` has examples.
#[derive(Debug, Parser)]
#[command(name = "legwork", version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Task>,
    #[command(flatten)]
    window: Window,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Open the ground station's window.
    Fly(Window),
    /// Fly the fire-watch mission with an embedded simulator and agent.
    Demo(demo::Args),
    #[command(flatten)]
    Headless(headless::Command),
}

/// How the window opens.
#[derive(Debug, Args)]
struct Window {
    /// A plan to open: ours (XML), or one of another program.
    file: Option<PathBuf>,
    /// Connect to a vehicle's gateway at once, as tcp/127.0.0.1:7447.
    #[arg(long, value_name = "ENDPOINT")]
    connect: Option<String>,
    /// The vehicle's name.
    #[arg(long, default_value = "uav1")]
    vehicle: String,
    /// Begin with the light theme.
    #[arg(long)]
    light: bool,
    /// Keep the aircraft in the middle of the map.
    #[arg(long)]
    follow: bool,
    /// Write a picture of the window (PNG) and close it.
    #[arg(long, value_name = "FILE")]
    screenshot: Option<PathBuf>,
    /// Seconds until that picture is taken.
    #[arg(long, value_name = "SECONDS", default_value_t = 3.0, requires = "screenshot")]
    after: f64,
}

/// What is logged unless RUST_LOG says otherwise. Zenoh reports each connection that is tried in vain or torn down, winit
/// each setting the desktop lacks, rfd a desktop without dialogs; what matters of it reaches the user as a link's state or as an error.
const LOG: &str = "warn,zenoh=off,winit=error,rfd=off";

fn main() -> ExitCode {
    tracing_subscriber::fmt()
        .with_env_filter(tracing_subscriber::EnvFilter::try_from_default_env().unwrap_or_else(|_| LOG.into()))
        .with_writer(std::io::stderr)
        .init();
    let cli = match stdio::arguments::<Cli>() {
        Ok(cli) => cli,
        Err(status) => return status,
    };
    status(match cli.command {
        Some(Task::Demo(args)) => demo::run(&args),
        Some(Task::Headless(command)) => headless::run(&command),
        Some(Task::Fly(window)) => open(window),
        None => open(cli.window),
    })
}

fn open(window: Window) -> anyhow::Result<ExitCode> {
    // what is misspelt is said here; the window reads the file without being held up by it
    if let Some(path) = &window.file {
        std::fs::File::open(path).with_context(|| format!("{} can't be opened", path.display()))?;
    }
    let vehicle = window.vehicle;
    app::run(Options {
        file: window.file,
        recover: window.screenshot.is_none(),
        tour: window.screenshot.is_none(),
        connect: window.connect.map(|endpoint| (vehicle, endpoint)),
        screenshot: window.screenshot.map(|file| Screenshot::new(file, window.after)),
        follow: window.follow,
        theme: window.light.then_some(eframe::egui::Theme::Light),
        ..Options::default()
    })?;
    Ok(ExitCode::SUCCESS)
}

fn status(result: anyhow::Result<ExitCode>) -> ExitCode {
    result.unwrap_or_else(|error| {
        eprintln!("legwork: {}", flight_plan::legible(&format!("{error:#}")));
        ExitCode::from(stdio::USAGE)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }
}
