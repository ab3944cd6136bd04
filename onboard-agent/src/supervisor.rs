//! The supervisor: every service in a process of its own; what dies is said and restarted.

use crate::Shutdown;
use anyhow::Context;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitStatus;
use std::time::{Duration, Instant};
use tokio::process::{Child, Command};
use tokio::task::JoinSet;

/// First pause before a restart: short, as the gateway acts after two seconds without FP Manager.
const PAUSE_MIN: Duration = Duration::from_millis(200);
/// Longest pause before a restart.
const PAUSE_MAX: Duration = Duration::from_secs(5);
/// Who lived so long starts afresh with the shortest pause.
const STABLE: Duration = Duration::from_secs(10);
/// Who does not end in this time after being asked is killed.
const GRACE: Duration = Duration::from_secs(3);
/// Exit status of a service that was started wrongly: a restart would not help.
pub const USAGE: i32 = 2;

/// A service's process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Process {
    /// Subcommand, and name in the log.
    pub name: &'static str,
    /// Its options.
    pub arguments: Vec<OsString>,
}

impl Process {
    /// Of a subcommand with options.
    pub fn new(name: &'static str, arguments: Vec<OsString>) -> Self {
        Self { name, arguments }
    }
}

/// Runs the processes until `shutdown`, restarting what dies.
///
/// # Errors
/// A process can't be started, or says that it was started wrongly.
pub async fn run(program: &Path, processes: &[Process], shutdown: Shutdown) -> anyhow::Result<()> {
    let mut supervised = JoinSet::new();
    for process in processes {
        supervised.spawn(keep(program.to_owned(), process.clone(), shutdown.clone()));
    }
    let mut outcome = Ok(());
    while let Some(ended) = supervised.join_next().await {
        let ended = ended.context("the supervision of a process failed").flatten();
        if ended.is_err() && outcome.is_ok() {
            outcome = ended;
            // dropping the others' children kills them
            supervised.abort_all();
        }
    }
    outcome
}

/// Keeps one process running.
async fn keep(program: PathBuf, process: Process, mut shutdown: Shutdown) -> anyhow::Result<()> {
    let mut pause = PAUSE_MIN;
    loop {
        let started = Instant::now();
        let mut child = start(&program, &process)?;
        let status = tokio::select! {
            () = shutdown.requested() => return end(process.name, &mut child).await,
            status = child.wait() => status.with_context(|| format!("waiting for {}", process.name))?,
        };
        anyhow::ensure!(
            status.code() != Some(USAGE),
            "{} was started wrongly: see its message above",
            process.name
        );
        if started.elapsed() >= STABLE {
            pause = PAUSE_MIN;
        }
        tracing::error!(
            "{} died ({}); restarting it in {} ms",
            process.name,
            describe(status),
            pause.as_millis()
        );
        tokio::select! {
            () = shutdown.requested() => return Ok(()),
            () = tokio::time::sleep(pause) => {}
        }
        pause = (pause * 2).min(PAUSE_MAX);
    }
}

fn start(program: &Path, process: &Process) -> anyhow::Result<Child> {
    let child = Command::new(program)
        .arg(process.name)
        .args(&process.arguments)
        .kill_on_drop(true)
        .spawn()
        .with_context(|| format!("starting {} {}", program.display(), process.name))?;
    tracing::info!(pid = child.id(), "{} started", process.name);
    Ok(child)
}

/// Asks a process to end, and makes it.
async fn end(name: &str, child: &mut Child) -> anyhow::Result<()> {
    ask_to_end(child).await;
    if tokio::time::timeout(GRACE, child.wait()).await.is_err() {
        tracing::warn!("{name} does not end; killing it");
        child.kill().await.with_context(|| format!("killing {name}"))?;
    }
    Ok(())
}

/// SIGTERM by the system's own `kill`, as we have no unsafe code; without one the child is killed after the grace.
#[cfg(unix)]
async fn ask_to_end(child: &Child) {
    let Some(pid) = child.id() else { return };
    let asked = Command::new("kill").arg("-TERM").arg(pid.to_string()).status().await;
    if !asked.is_ok_and(|status| status.success()) {
        tracing::debug!(pid, "could not be asked to end");
    }
}

#[cfg(not(unix))]
async fn ask_to_end(_: &Child) {}

fn describe(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("signal {signal}");
    }
    status.code().map_or_else(|| "unknown status".into(), |code| format!("exit status {code}"))
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;
    use crate::shutdown;
    use std::os::unix::fs::PermissionsExt;

    /// A program that notes its start in a file and then does `then`.
    fn program(directory: &Path, then: &str) -> PathBuf {
        let path = directory.join("service");
        let text = format!("#!/bin/sh\necho started >> {}/log\n{then}\n", directory.display());
        std::fs::write(&path, text).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
        path
    }

    fn starts(directory: &Path) -> usize {
        std::fs::read_to_string(directory.join("log")).map_or(0, |log| log.lines().count())
    }

    async fn started(directory: &Path, count: usize) {
        let waited = async {
            while starts(directory) < count {
                tokio::time::sleep(Duration::from_millis(2)).await;
            }
        };
        tokio::time::timeout(Duration::from_secs(30), waited).await.expect("started in time");
    }

    #[tokio::test]
    async fn process_that_dies_is_restarted() {
        let directory = tempfile::tempdir().unwrap();
        let path = program(directory.path(), "exit 1");
        let (trigger, shutdown) = shutdown();
        let processes = [Process::new("gateway", vec![])];
        let supervisor = tokio::spawn(async move { run(&path, &processes, shutdown).await });
        started(directory.path(), 3).await;
        trigger.shut_down();
        supervisor.await.unwrap().unwrap();
    }

    #[tokio::test]
    async fn children_end_with_the_supervisor() {
        let directory = tempfile::tempdir().unwrap();
        let ended = directory.path().join("ended");
        let path = program(
            directory.path(),
            &format!("trap 'touch {}; exit 0' TERM\nwhile :; do sleep 0.02; done", ended.display()),
        );
        let (trigger, shutdown) = shutdown();
        let processes = [Process::new("gateway", vec![])];
        let supervisor = tokio::spawn(async move { run(&path, &processes, shutdown).await });
        started(directory.path(), 1).await;
        trigger.shut_down();
        supervisor.await.unwrap().unwrap();
        assert!(ended.exists());
    }

    #[tokio::test]
    async fn process_started_wrongly_is_not_restarted_for_ever() {
        let directory = tempfile::tempdir().unwrap();
        let path = program(directory.path(), "exit 2");
        let (_trigger, shutdown) = shutdown();
        let error = run(&path, &[Process::new("gateway", vec![])], shutdown).await.unwrap_err();
        assert!(error.to_string().contains("started wrongly"), "{error}");
        assert_eq!(starts(directory.path()), 1);
    }

    #[tokio::test]
    async fn program_that_is_not_there_is_an_error() {
        let (_trigger, shutdown) = shutdown();
        let error =
            run(Path::new("/nowhere/agent"), &[Process::new("gateway", vec![])], shutdown).await.unwrap_err();
        assert!(error.to_string().contains("/nowhere/agent"), "{error}");
    }
}
