//! Command line of `onboard-agent`.

use onboard_agent::cli::{Cli, Task};
use onboard_agent::config::{self, Options, environment};
use onboard_agent::inside::Inside;
use onboard_agent::registry::SERVICES;
use onboard_agent::single_instance::AlreadyRunning;
use onboard_agent::{Shutdown, Trigger, doctor, gateway, shutdown, supervisor};
use std::path::Path;
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
    match cli.task {
        Task::Describe => describe(),
        Task::CheckConfig(file) => check_config(&file),
        // what is wrong is better said once than by every child
        Task::Run(options) => with(options, async |options, shutdown| match options.check() {
            Ok(()) => status(run(options, shutdown).await),
            Err(error) => failed(STARTED_WRONGLY, &error),
        }),
        Task::Service(entry, options) => {
            with(options, async |options, shutdown| match (entry.start)(&options, shutdown) {
                Ok(running) => status(running.await),
                Err(error) => failed(STARTED_WRONGLY, &error),
            })
        }
        Task::Doctor(options) => with(options, async |options, shutdown| match options.gateway() {
            Ok(config) => see_doctor(&config, shutdown).await,
            Err(error) => failed(STARTED_WRONGLY, &error),
        }),
    }
}

/// Does the work with the completed options, until a signal.
fn with(options: Options, work: impl AsyncFnOnce(Options, Shutdown) -> ExitCode) -> ExitCode {
    let options = match options.completed() {
        Ok(options) => options,
        Err(error) => return failed(STARTED_WRONGLY, &error),
    };
    service::logging::init("info,zenoh=error", options.log_format.unwrap_or_default().into());
    match tokio::runtime::Builder::new_multi_thread().enable_all().build() {
        Ok(runtime) => runtime.block_on(async {
            let (trigger, shutdown) = shutdown();
            tokio::spawn(end_on_signals(trigger));
            work(options, shutdown).await
        }),
        Err(error) => failed(FAILED, &error.into()),
    }
}

fn check_config(file: &Path) -> ExitCode {
    let checked = environment::options(|name| std::env::var_os(name))
        .and_then(|environment| config::check_file(file, &environment));
    match checked {
        Ok(()) => said(&[format!("{}: nothing is wrong with it", file.display())], ExitCode::SUCCESS),
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::from(STARTED_WRONGLY)
        }
    }
}

async fn see_doctor(config: &gateway::Config, shutdown: Shutdown) -> ExitCode {
    let (mut lines, mut is_ready) = (vec![], true);
    let outcome = doctor::examine(config, shutdown, |address, diagnosis| {
        if config.autopilots.len() > 1 {
            lines.push(format!("By {address}:"));
        }
        lines.extend(diagnosis.lines());
        is_ready &= diagnosis.is_ready();
    });
    let code = match outcome.await {
        Ok(()) if is_ready => ExitCode::SUCCESS,
        Ok(()) => ExitCode::from(FAILED),
        Err(error) => failed(FAILED, &error),
    };
    said(&lines, code)
}

/// Lines on standard output; a result that can't be written is a failure.
fn said(lines: &[String], code: ExitCode) -> ExitCode {
    match lines.iter().try_for_each(|line| stdio::line(format_args!("{line}"))) {
        Ok(()) => code,
        Err(error) => failed(stdio::USAGE, &error.into()),
    }
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
        Ok(text) => said(&[text], ExitCode::SUCCESS),
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

/// The first signal asks to end; in flight the gateway then stays until the aircraft is on the ground. The second insists.
async fn end_on_signals(trigger: Trigger) {
    next_signal().await;
    trigger.shut_down();
    next_signal().await;
    trigger.insist();
}

/// Ctrl-C and, on Unix, the signals by which the supervisor, the system and a terminal that is closed ask to end.
async fn next_signal() {
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        if let (Ok(mut terminate), Ok(mut hangup)) =
            (signal(SignalKind::terminate()), signal(SignalKind::hangup()))
        {
            tokio::select! {
                _ = terminate.recv() => {}
                _ = hangup.recv() => {}
                _ = tokio::signal::ctrl_c() => {}
            }
            return;
        }
    }
    drop(tokio::signal::ctrl_c().await);
}
