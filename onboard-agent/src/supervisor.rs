//! The supervisor: every service in a process of its own; what dies is said and restarted.

use crate::Shutdown;
use crate::config::environment;
use anyhow::Context;
use std::ffi::{OsStr, OsString};
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
/// Who died so often in a row without having lived for [`STABLE`] will not learn any more whether an aircraft needs it: asked to end,
/// nobody waits for it.
const HOPELESS: u32 = 5;
/// Exit status of a service that was started wrongly. At its first start nothing helps but to correct that; later something that
/// it needs was taken away, as a file on a stick, and may come back.
pub const USAGE: i32 = 2;

/// A service's process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Process {
    /// Subcommand, and name in the log.
    pub name: &'static str,
    /// Its options.
    pub arguments: Vec<OsString>,
    /// Asked to end, it may stay for as long as an aircraft needs it; the others are asked once it has ended.
    pub may_stay: bool,
}

impl Process {
    /// Of a subcommand with options, which ends when it is asked to.
    pub fn new(name: &'static str, arguments: Vec<OsString>) -> Self {
        Self { name, arguments, may_stay: false }
    }
}

/// Runs the processes until `shutdown`, restarting what dies. Those that may stay are asked to end first.
///
/// # Errors
/// A process can't be started for the first time, or says then that it was started wrongly.
pub async fn run(program: &Path, processes: &[Process], mut shutdown: Shutdown) -> anyhow::Result<()> {
    let (trigger, others) = crate::shutdown();
    let (mut supervised, mut staying) = (JoinSet::new(), 0_usize);
    for process in processes {
        staying += usize::from(process.may_stay);
        let (may_stay, told) = (process.may_stay, if process.may_stay { &shutdown } else { &others });
        let kept = keep(program.to_owned(), process.clone(), told.clone());
        supervised.spawn(async move { (may_stay, kept.await) });
    }
    let (mut outcome, mut asked, mut told) = (Ok(()), shutdown.clone(), false);
    loop {
        tokio::select! {
            ended = supervised.join_next() => {
                let Some(ended) = ended else { return outcome };
                let (stayed, ended) = match ended {
                    Ok(ended) => ended,
                    Err(error) => (false, Err(error).context("the supervision of a process failed")),
                };
                staying -= usize::from(stayed);
                if ended.is_err() && outcome.is_ok() {
                    outcome = ended;
                    // dropping the others' children kills them
                    supervised.abort_all();
                }
            }
            () = asked.requested(), if staying == 0 && !told => {
                trigger.shut_down();
                told = true;
            }
            () = shutdown.insisted(), if !told => {
                trigger.insist();
                told = true;
            }
        }
    }
}

/// Keeps one process running.
async fn keep(program: PathBuf, process: Process, mut shutdown: Shutdown) -> anyhow::Result<()> {
    let (mut pause, mut is_first, mut in_a_row) = (PAUSE_MIN, true, 0);
    loop {
        let started = Instant::now();
        let died = match start(&program, &process) {
            Ok(mut child) => {
                let learns_until = (!is_first && process.may_stay).then(|| started + STABLE);
                match watch(&process, &mut child, &mut shutdown, learns_until).await? {
                    None => return Ok(()),
                    Some(status) if is_first && status.code() == Some(USAGE) => {
                        anyhow::bail!("{} was started wrongly: see its message above", process.name)
                    }
                    Some(status) => format!("died ({})", describe(status)),
                }
            }
            Err(error) if is_first => return Err(error),
            Err(error) => format!("can't be started ({error:#})"),
        };
        in_a_row += 1;
        if started.elapsed() >= STABLE {
            (pause, in_a_row) = (PAUSE_MIN, 0);
        }
        tracing::error!("{} {died}; restarting it in {} ms", process.name, pause.as_millis());
        let mut asked = shutdown.clone();
        tokio::select! {
            () = asked.requested(), if !process.may_stay || in_a_row >= HOPELESS => return Ok(()),
            () = shutdown.insisted() => return Ok(()),
            () = tokio::time::sleep(pause) => {}
        }
        pause = (pause * 2).min(PAUSE_MAX);
        is_first = false;
    }
}

/// Until the process has died, which gives how, or has ended because it was asked to.
async fn watch(
    process: &Process,
    child: &mut Child,
    shutdown: &mut Shutdown,
    learns_until: Option<Instant>,
) -> anyhow::Result<Option<ExitStatus>> {
    tokio::select! {
        () = time_to_end(shutdown, learns_until) => end(process, child, shutdown).await,
        status = child.wait() => Ok(Some(status.with_context(|| format!("waiting for {}", process.name))?)),
    }
}

/// A process that has just come back learns what it is about before it is asked whether it may end.
async fn time_to_end(shutdown: &mut Shutdown, learns_until: Option<Instant>) {
    shutdown.requested().await;
    if let Some(until) = learns_until {
        tokio::select! {
            () = tokio::time::sleep_until(until.into()) => {}
            () = shutdown.insisted() => {}
        }
    }
}

fn start(program: &Path, process: &Process) -> anyhow::Result<Child> {
    let mut command = Command::new(program);
    command.arg(process.name).args(&process.arguments).kill_on_drop(true);
    // what the environment says is in the arguments, and stays as it was when the agent was started
    for (name, _) in std::env::vars_os().filter(|(name, _)| is_option(name)) {
        command.env_remove(name);
    }
    // a terminal's Ctrl-C is for the supervisor, which knows who ends first
    #[cfg(unix)]
    command.process_group(0);
    let child =
        command.spawn().with_context(|| format!("starting {} {}", program.display(), process.name))?;
    tracing::info!(pid = child.id(), "{} started", process.name);
    Ok(child)
}

fn is_option(name: &OsStr) -> bool {
    name.to_str().is_some_and(|name| name.starts_with(environment::PREFIX))
}

/// Asks a process to end, and makes it. One that may stay is waited for; gives how it died instead, if it did.
async fn end(
    process: &Process,
    child: &mut Child,
    shutdown: &mut Shutdown,
) -> anyhow::Result<Option<ExitStatus>> {
    let name = process.name;
    ask_to_end(child).await;
    if process.may_stay {
        tokio::select! {
            status = tokio::time::timeout(GRACE, child.wait()) => match status {
                Ok(status) => return ended(name, status),
                Err(_) => tracing::warn!(
                    "{name} has not ended: in flight it stays until the aircraft is on the ground; a second signal ends it now"
                ),
            },
            () = shutdown.insisted() => {}
        }
        tokio::select! {
            status = child.wait() => return ended(name, status),
            () = shutdown.insisted() => ask_to_end(child).await,
        }
    }
    if tokio::time::timeout(GRACE, child.wait()).await.is_err() {
        tracing::warn!("{name} does not end; killing it");
        child.kill().await.with_context(|| format!("killing {name}"))?;
    }
    Ok(None)
}

fn ended(name: &str, status: std::io::Result<ExitStatus>) -> anyhow::Result<Option<ExitStatus>> {
    let status = status.with_context(|| format!("waiting for {name}"))?;
    Ok((!status.success()).then_some(status))
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

    fn staying(name: &'static str) -> Process {
        Process { may_stay: true, ..Process::new(name, vec![]) }
    }

    /// Its second start finds the plan gone, its third one finds it again.
    #[tokio::test]
    async fn what_is_taken_away_after_the_start_ends_nobody() {
        let directory = tempfile::tempdir().unwrap();
        let log = directory.path().join("log");
        let text = format!(
            "case $(wc -l < {}) in 1) exit 1;; 2) exit 2;; esac\ntrap 'exit 0' TERM\nwhile :; do sleep 0.02; done",
            log.display()
        );
        let path = program(directory.path(), &text);
        let (trigger, shutdown) = shutdown();
        let supervisor =
            tokio::spawn(async move { run(&path, &[Process::new("fp-manager", vec![])], shutdown).await });
        started(directory.path(), 3).await;
        trigger.shut_down();
        tokio::time::timeout(Duration::from_secs(30), supervisor).await.unwrap().unwrap().unwrap();
    }

    #[tokio::test]
    async fn a_program_that_vanishes_and_comes_back_is_started_again() {
        let directory = tempfile::tempdir().unwrap();
        let path = program(directory.path(), "mv \"$0\" \"$0.gone\"; exit 1");
        let (trigger, shutdown) = shutdown();
        let (there, gone) = (path.clone(), path.with_extension("gone"));
        let supervisor =
            tokio::spawn(async move { run(&path, &[Process::new("storage", vec![])], shutdown).await });
        appears(&gone, 1).await;
        assert!(!supervisor.is_finished());
        std::fs::rename(gone, there).unwrap();
        started(directory.path(), 2).await;
        trigger.shut_down();
        tokio::time::timeout(Duration::from_secs(30), supervisor).await.unwrap().unwrap().unwrap();
    }

    /// The gateway ignores the first request, as in flight, and ends by the file `landed`; it notes who had ended before it.
    #[tokio::test]
    async fn the_others_stay_for_as_long_as_the_one_that_may() {
        let directory = tempfile::tempdir().unwrap();
        let there = |name: &str| directory.path().join(name);
        let text = format!(
            "if [ \"$1\" = gateway ]; then trap 'touch {0}/asked' TERM; echo up >> {0}/up; until [ -e {0}/landed ]; do sleep 0.02; done; ls {0} > {0}/there; exit 0; fi\n\
             trap 'touch {0}/ended; exit 0' TERM; echo up >> {0}/up; while :; do sleep 0.02; done",
            directory.path().display()
        );
        let path = program(directory.path(), &text);
        let (trigger, shutdown) = shutdown();
        let processes = [staying("gateway"), Process::new("fp-manager", vec![])];
        let supervisor = tokio::spawn(async move { run(&path, &processes, shutdown).await });
        appears(&there("up"), 2).await;
        trigger.shut_down();
        appears(&there("asked"), 0).await;
        assert!(!there("ended").exists() && !supervisor.is_finished());
        std::fs::write(there("landed"), "").unwrap();
        tokio::time::timeout(Duration::from_secs(30), supervisor).await.unwrap().unwrap().unwrap();
        assert!(there("ended").exists());
        assert!(
            !std::fs::read_to_string(there("there")).unwrap().contains("ended"),
            "the gateway was the first"
        );
    }

    #[tokio::test]
    async fn who_stays_ends_when_somebody_insists() {
        let directory = tempfile::tempdir().unwrap();
        let (asked, up) = (directory.path().join("asked"), directory.path().join("up"));
        let text = format!(
            "trap 'echo asked >> {}' TERM\necho up >> {}\nwhile :; do sleep 0.02; done",
            asked.display(),
            up.display()
        );
        let path = program(directory.path(), &format!("{text}\n"));
        let (trigger, shutdown) = shutdown();
        let supervisor = tokio::spawn(async move { run(&path, &[staying("gateway")], shutdown).await });
        appears(&up, 1).await;
        trigger.shut_down();
        appears(&asked, 1).await;
        trigger.insist();
        tokio::time::timeout(Duration::from_secs(30), supervisor).await.unwrap().unwrap().unwrap();
    }

    /// With a configuration that it can't live with, it could not be stopped either.
    #[tokio::test]
    async fn who_may_stay_and_dies_again_and_again_ends_when_asked() {
        let directory = tempfile::tempdir().unwrap();
        let path = program(directory.path(), "exit 1");
        let (trigger, shutdown) = shutdown();
        let supervisor = tokio::spawn(async move { run(&path, &[staying("gateway")], shutdown).await });
        started(directory.path(), 2).await;
        trigger.shut_down();
        tokio::time::timeout(Duration::from_secs(60), supervisor).await.unwrap().unwrap().unwrap();
        assert!(starts(directory.path()) >= HOPELESS as usize, "it has its chances: an aircraft may need it");
    }

    /// A file with so many lines.
    async fn appears(path: &Path, lines: usize) {
        let waited = async {
            while !std::fs::read_to_string(path).is_ok_and(|text| text.lines().count() >= lines) {
                tokio::time::sleep(Duration::from_millis(2)).await;
            }
        };
        tokio::time::timeout(Duration::from_secs(30), waited).await.expect("in time");
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
