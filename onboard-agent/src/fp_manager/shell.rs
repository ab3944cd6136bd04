//! Shell: the FP Manager as it is run, with the journal as its adapter.

use super::Config;
use super::journal::{Folder, Job, JournalHandle, Limits, Log, Writer, encode};
use super::manager::Manager;
use super::restart::{Restart, restart};
use super::service::{FpManager, Input, Output};
use flight_exec::Executor;
use service::{Adapter, Shutdown, Tasks, Time, Timing};
use std::future::{Future, pending, ready};
use usal::Role;

/// Runs the FP Manager until `shutdown`.
///
/// # Errors
/// The session or the state directory can't be had, or the plan it was started with can't be flown.
pub async fn run(config: Config, shutdown: Shutdown) -> anyhow::Result<()> {
    let runs = service::Config {
        vehicle: config.vehicle.clone(),
        role: Role::Client { connect: config.connect.clone() },
        state_dir: config.state_dir.clone(),
        timing: if config.simulated { Timing::Follows } else { Timing::Machine },
    };
    let make = async move |_| {
        let (journal, past) = open(&config)?;
        Ok((FpManager::new(config, past.manager, past.troubles), journal))
    };
    service::run(runs, shutdown, make).await
}

/// The journal; none without a state directory.
pub struct Journal(Option<JournalHandle>);

/// The journal, and the flight it leads up to.
fn open(config: &Config) -> anyhow::Result<(Journal, Restart)> {
    let base = if config.simulated { Time::ZERO } else { time_since_boot() };
    let Some(folder) = config.state_dir.clone() else {
        let executor = Executor::new(config.executor.clone(), config.terrain.clone(), config.profile.clone());
        let past = Restart { manager: Manager::new(executor, base), troubles: Vec::new() };
        return Ok((Journal(None), past));
    };
    let (mut log, found) = Log::open(Folder::new(folder), Limits::default());
    let past = restart(&mut log, found.as_deref().unwrap_or_default(), config, base);
    let mut journal = JournalHandle::start(Writer::new(log, found.as_ref().err()))?;
    let (saved, plans) = past.manager.saved();
    journal.give(Job::State(Box::new(saved), plans));
    Ok((Journal(Some(journal)), past))
}

/// Time since the machine was started, as far as the system says; else zero.
fn time_since_boot() -> Time {
    let uptime = std::fs::read_to_string("/proc/uptime").unwrap_or_default();
    let seconds = uptime.split(' ').next().and_then(|text| text.parse().ok());
    seconds.and_then(|s| Time::try_from_secs_f64(s).ok()).unwrap_or_default()
}

impl Adapter<FpManager> for Journal {
    fn next(&mut self) -> impl Future<Output = Input> + Send {
        pending()
    }

    async fn perform(&mut self, _: Time, outputs: Vec<Output>, leaves: bool, tasks: &mut Tasks<Input>) {
        let Some(journal) = &mut self.0 else { return without(outputs, tasks) };
        let mut wait = false;
        for output in outputs {
            match output {
                Output::Plan(program) => journal.give(Job::Plan(program)),
                Output::State(saved, plans) => journal.give(Job::State(saved, plans)),
                Output::PollJournal => poll_journal(journal, tasks),
                Output::Document { hash, xml } => {
                    let kept = journal.keep(hash, xml);
                    tasks.wait(async move {
                        kept.await;
                        Input::ProposalKept
                    });
                }
                Output::Turn { entries, sync } => {
                    wait |= sync || leaves;
                    match encode(&entries) {
                        Ok(payload) => journal.give(Job::Turn { payload, sync }),
                        Err(error) => {
                            tracing::error!("a turn cannot be recorded: {error}");
                            journal.lose();
                        }
                    }
                }
            }
        }
        if wait {
            journal.done().await;
        }
    }

    async fn finish(&mut self) {
        if let Some(journal) = &mut self.0 {
            journal.done().await;
        }
    }
}

/// Nothing is kept: who waits for that need not.
fn without(outputs: Vec<Output>, tasks: &mut Tasks<Input>) {
    if outputs.iter().any(|output| matches!(output, Output::Document { .. })) {
        tasks.wait(ready(Input::ProposalKept));
    }
}

/// Asks for a state when one is wanted, and reports a disk that fails, or works again.
fn poll_journal(journal: &mut JournalHandle, tasks: &mut Tasks<Input>) {
    let wants_state = journal.wants_state();
    if let Some(event) = journal.state_event() {
        tasks.wait(ready(Input::Journal(event)));
    }
    if wants_state {
        tasks.wait(ready(Input::StateWanted));
    }
}
