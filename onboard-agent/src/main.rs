//! Command line of `onboard-agent`.

use onboard_agent::config::{Cli, Options, Task};
use onboard_agent::inside::Inside;
use onboard_agent::registry::SERVICES;
use onboard_agent::single_instance::AlreadyRunning;
use onboard_agent::{Shutdown, Trigger, shutdown, supervisor};
use std::process::ExitCode;

/// Started wrongly: a restart would not help.
const STARTED_WRONGLY: u8 = supervisor::USAGE as u8;
/// Something failed on the way.
const FAILED: u8 = 1;

fn main() -> ExitCode {
    let cli = match stdio::arguments::<Cli>() {
        Ok(cli) => cli,
        Err(status) => return status,
    };
    service::logging::init("info,zenoh=error");
    match tokio::runtime::Builder::new_multi_thread().enable_all().build() {
        Ok(runtime) => runtime.block_on(perform(cli.task)),
        Err(error) => failed(FAILED, &error.into()),
    }
}

async fn perform(task: Task) -> ExitCode {
    let (trigger, shutdown) = shutdown();
    tokio::spawn(end_on_signal(trigger));
    match task {
        Task::Describe => describe(),
        Task::Run(options) => match options.completed().and_then(|options| startable(options, &shutdown)) {
            Ok(options) => status(run(options, shutdown).await),
            Err(error) => failed(STARTED_WRONGLY, &error),
        },
        Task::Service(entry, options) => {
            match options.completed().and_then(|options| (entry.start)(&options, shutdown)) {
                Ok(running) => status(running.await),
                Err(error) => failed(STARTED_WRONGLY, &error),
            }
        }
    }
}

/// What is wrong is better said once than by every child.
fn startable(options: Options, shutdown: &Shutdown) -> anyhow::Result<Options> {
    for entry in SERVICES.iter().filter(|entry| (entry.is_wanted)(&options)) {
        drop((entry.start)(&options, shutdown.clone())?);
    }
    Ok(options)
}

async fn run(mut options: Options, shutdown: Shutdown) -> anyhow::Result<()> {
    let program = std::env::current_exe()?;
    let inside = Inside::new()?;
    options.inside = Some(inside.address().as_path().to_owned());
    supervisor::run(&program, &options.processes(), shutdown).await
}

fn describe() -> ExitCode {
    let descriptions: Vec<_> = SERVICES.iter().map(|entry| entry.spec.describe()).collect();
    match serde_json::to_string_pretty(&descriptions) {
        Ok(text) => match stdio::line(format_args!("{text}")) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => failed(stdio::USAGE, &error.into()),
        },
        Err(error) => failed(FAILED, &error.into()),
    }
}

fn status(outcome: anyhow::Result<()>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.is::<AlreadyRunning>() => failed(STARTED_WRONGLY, &error),
        Err(error) => failed(FAILED, &error),
    }
}

fn failed(code: u8, error: &anyhow::Error) -> ExitCode {
    eprintln!("onboard-agent: {error:#}");
    ExitCode::from(code)
}

/// Ctrl-C and, on Unix, the signal by which the supervisor and the system ask to end.
async fn end_on_signal(trigger: Trigger) {
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        match signal(SignalKind::terminate()) {
            Ok(mut terminate) => {
                tokio::select! {
                    _ = terminate.recv() => {}
                    _ = tokio::signal::ctrl_c() => {}
                }
            }
            Err(_) => drop(tokio::signal::ctrl_c().await),
        }
    }
    #[cfg(not(unix))]
    drop(tokio::signal::ctrl_c().await);
    trigger.shut_down();
}
