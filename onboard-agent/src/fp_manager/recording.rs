//! Shell: what the loop does with the journal.

use super::Config;
use super::journal::{Folder, Job, JournalHandle, Limits, Log, Writer, encode};
use super::manager::{Effect, Manager};
use super::restart::{Restart, restart};
use super::shell::Shell;
use crate::clock::Time;
use flight_exec::Executor;

/// The journal, and the flight it leads up to.
pub(super) fn open(config: &Config) -> anyhow::Result<(Option<JournalHandle>, Restart)> {
    let base = if config.simulated { Time::ZERO } else { time_since_boot() };
    let Some(folder) = config.state_dir.clone() else {
        let executor = Executor::new(config.executor.clone(), config.terrain.clone(), config.profile.clone());
        let past = Restart { manager: Manager::new(executor, base), troubles: Vec::new() };
        return Ok((None, past));
    };
    let (mut log, found) = Log::open(Folder::new(folder), Limits::default());
    let past = restart(&mut log, found.as_deref().unwrap_or_default(), config, base);
    let mut journal = JournalHandle::start(Writer::new(log, found.as_ref().err()))?;
    let (saved, plans) = past.manager.saved();
    journal.give(Job::State(Box::new(saved), plans));
    Ok((Some(journal), past))
}

/// Time since the machine was started, as far as the system tells; else zero.
fn time_since_boot() -> Time {
    let uptime = std::fs::read_to_string("/proc/uptime").unwrap_or_default();
    let seconds = uptime.split(' ').next().and_then(|text| text.parse().ok());
    seconds.and_then(|s| Time::try_from_secs_f64(s).ok()).unwrap_or_default()
}

impl Shell {
    /// Records a turn, before the rest of its effects is carried out; gives that.
    pub(super) async fn record(&mut self, effects: Vec<Effect>) -> Vec<Effect> {
        let Some(journal) = &mut self.journal else { return effects };
        let (mut entries, mut others, mut sync) = (Vec::new(), Vec::new(), false);
        for effect in effects {
            match effect {
                Effect::Record(entry) => entries.push(entry),
                Effect::Keep(program) => journal.give(Job::Plan(program)),
                Effect::Sync => sync = true,
                other => others.push(other),
            }
        }
        if entries.is_empty() {
            return others;
        }
        match encode(&entries) {
            Ok(payload) => journal.give(Job::Turn { payload, sync }),
            Err(error) => {
                tracing::error!("a turn cannot be recorded: {error}");
                journal.lose();
            }
        }
        if sync || !others.is_empty() {
            journal.done().await;
        }
        others
    }

    /// Hands in a state when one is wanted, and tells people what they have to know of the disk.
    pub(super) fn look_after_journal(&mut self) {
        let Some(journal) = &mut self.journal else { return };
        let wants_state = journal.wants_state();
        if let Some(event) = journal.news() {
            self.publishers.event(self.clock.now(), event);
        }
        if wants_state {
            self.save_state();
        }
    }

    pub(super) fn save_state(&mut self) {
        let (saved, plans) = self.manager.saved();
        if let Some(journal) = &mut self.journal {
            journal.give(Job::State(Box::new(saved), plans));
        }
    }
}
