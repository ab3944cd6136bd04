//! Pure but for the journal's storage: going on with the flight of an earlier process.

use super::Config;
use super::gateway_session::GatewaySession;
use super::journal::{Chapter, Entry, Found, Log, ManagerState, Record, Saved, Storage};
use super::manager::{Effect, Manager};
use super::{alarms::Alarms, compile, listed};
use flight_exec::{Executor, Input};
use flight_plan::{Problem, Program};
use service::Time;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// What became of the earlier flight.
pub struct Restart {
    /// Goes on with it, or begins anew.
    pub manager: Manager,
    /// What people have to know about it.
    pub troubles: Vec<String>,
}

/// Goes on from the newest segment that can be used, or begins anew if there is none.
pub fn restart<S: Storage>(log: &mut Log<S>, found: &[Found], config: &Config, base: Time) -> Restart {
    let mut troubles = Vec::new();
    for found in found {
        match chapter(log, found).and_then(|chapter| resumed(log, &chapter, config, base, &mut troubles)) {
            Ok(manager) => {
                log.went_on_from(found);
                return Restart { manager, troubles };
            }
            Err(reason) => {
                let name = log.set_aside(found);
                tracing::error!("a segment of the journal cannot be used and is kept as {name}: {reason}");
                troubles.push(format!(
                    "a segment of the journal cannot be used ({reason}): it is kept as {name}"
                ));
            }
        }
    }
    let mut manager = Manager::new(fresh(config), base);
    manager.without_past = troubles.last().cloned();
    Restart { manager, troubles }
}

fn fresh(config: &Config) -> Executor {
    Executor::new(config.executor.clone(), config.terrain.clone(), config.profile.clone())
}

fn chapter<S: Storage>(log: &mut Log<S>, found: &Found) -> Result<Chapter, String> {
    let chapter = log.chapter(found)?;
    if let Some(dropped) = &chapter.dropped {
        tracing::warn!(segment = chapter.number, "{dropped}");
    }
    Ok(chapter)
}

fn resumed<S: Storage>(
    log: &mut Log<S>,
    chapter: &Chapter,
    config: &Config,
    base: Time,
    troubles: &mut Vec<String>,
) -> Result<Manager, String> {
    let mut plans = Plans { log, config, compiled: BTreeMap::new() };
    let (manager, stopped) = replayed(chapter, usize::MAX, config, base, &mut plans)?;
    tracing::info!(
        segment = chapter.number,
        turns = chapter.turns.len(),
        phase = ?manager.executor.status_phase(),
        "going on where the last FP Manager was"
    );
    let dropped = chapter.dropped.as_ref().filter(|_| chapter.incomplete);
    for reason in dropped.into_iter().chain(&stopped) {
        let trouble = format!("the journal did not lead up to the end of the last process: {reason}");
        tracing::error!("{trouble}");
        troubles.push(trouble);
    }
    Ok(manager)
}

/// Restores the state and replays at most so many turns; also why it stopped before the end, if it did.
fn replayed<S: Storage>(
    chapter: &Chapter,
    most: usize,
    config: &Config,
    base: Time,
    plans: &mut Plans<'_, S>,
) -> Result<(Manager, Option<String>), String> {
    let mut manager = restored(&chapter.saved, config, base, plans)?;
    for (index, turn) in chapter.turns.iter().enumerate().take(most) {
        // an input that the executor does not survive must not kill every process to come
        let outcome = catch_unwind(AssertUnwindSafe(|| replay(&mut manager, turn, plans)));
        let stopped = match outcome {
            Ok(Ok(())) => continue,
            Ok(Err(reason)) => reason,
            Err(_) if index == most.saturating_sub(1) => return Err("the executor fails on it".into()),
            Err(_) => "the executor fails on it (please report this as a bug)".to_owned(),
        };
        let stopped = format!("turn {} of {} cannot be replayed: {stopped}", index + 1, chapter.turns.len());
        let (manager, _) = replayed(chapter, index, config, base, plans)?;
        return Ok((manager, Some(stopped)));
    }
    Ok((manager, None))
}

fn restored<S: Storage>(
    saved: &Saved,
    config: &Config,
    base: Time,
    plans: &mut Plans<'_, S>,
) -> Result<Manager, String> {
    let program = saved.snapshot.plan.as_deref().map(|hash| plans.get(hash)).transpose()?;
    let proposed = saved.proposed.as_deref().map(|hash| plans.get(hash)).transpose()?;
    let (settings, terrain, profile) =
        (config.executor.clone(), config.terrain.clone(), config.profile.clone());
    let restored = Executor::restore(settings, terrain, profile, program, saved.snapshot.clone());
    let mut executor = restored.map_err(|e| e.to_string())?;
    executor.go_on(proposed, saved.last_step);
    let mut manager = Manager::new(executor, base);
    manager.steered = saved.steered;
    manager.last_request = saved.last_request;
    manager.replies = saved.replies.clone();
    manager.returning = true;
    manager.noted = saved.notes.clone();
    restore_parts(&mut manager);
    Ok(manager)
}

/// Gives the parts back what the entries say.
fn restore_parts(manager: &mut Manager) {
    manager.gateway_session =
        GatewaySession::restored(manager.noted.wanted.clone(), manager.noted.controlled);
    manager.alarms = Alarms::restored(manager.noted.answered_alarms.clone());
    manager.plan_history = manager.noted.plan_history.clone();
}

/// One turn again; what it puts out was done, or will be put right by the join.
fn replay<S: Storage>(manager: &mut Manager, turn: &[Entry], plans: &mut Plans<'_, S>) -> Result<(), String> {
    let mut ignored = Vec::new();
    for entry in turn {
        let input = match &entry.what {
            Record::Propose { request, plan, based_on, forbidden } => Input::Propose {
                request: *request,
                program: plans.get(plan)?,
                based_on: *based_on,
                objections: forbidden
                    .then(|| Problem::error("recorded", "forbidden before the restart"))
                    .into_iter()
                    .collect(),
            },
            Record::Input(input) => input.clone(),
            Record::NumberAfter(token) => {
                manager.executor.number_after(*token);
                continue;
            }
            Record::Notes(notes) => {
                manager.noted = notes.clone();
                restore_parts(manager);
                continue;
            }
            Record::Answered(reply) => {
                manager.remember(reply.clone());
                continue;
            }
        };
        manager.count(&input);
        manager.executor.step(entry.at, input, &mut ignored);
        ignored.clear();
    }
    Ok(())
}

/// The documents kept beside the journal, each compiled once.
struct Plans<'a, S> {
    log: &'a mut Log<S>,
    config: &'a Config,
    compiled: BTreeMap<String, Arc<Program>>,
}

impl<S: Storage> Plans<'_, S> {
    fn get(&mut self, hash: &str) -> Result<Arc<Program>, String> {
        if let Some(program) = self.compiled.get(hash) {
            return Ok(program.clone());
        }
        let xml = self.log.plan(hash).ok_or_else(|| format!("the document of plan {hash} is missing"))?;
        let program = compile(&xml, self.config).map_err(|p| format!("plan {hash}: {}", listed(&p)))?;
        if **program.hash() != *hash {
            return Err(format!("the document of plan {hash} is damaged"));
        }
        let program = Arc::new(program);
        self.compiled.insert(hash.to_owned(), program.clone());
        Ok(program)
    }
}

impl Manager {
    /// What a restart goes on from. A plan that the gateway may still refuse can't be gone back on by then, nor from now on.
    pub fn state_to_keep(&mut self) -> (Saved, Vec<Arc<Program>>) {
        self.executor.forget_plan_before();
        self.saved()
    }

    /// Everything needed to go on from here, and the plans it names.
    pub fn saved(&self) -> (Saved, Vec<Arc<Program>>) {
        let plans = [self.executor.program(), self.executor.proposed()];
        let saved = Saved {
            snapshot: self.executor.snapshot(),
            last_step: self.executor.last_step(),
            proposed: self.executor.proposed().map(|p| p.hash().clone()),
            steered: self.steered,
            last_request: self.last_request,
            notes: self.noted.clone(),
            replies: self.replies.clone(),
        };
        (saved, plans.into_iter().flatten().cloned().collect())
    }

    /// Records what is remembered beside the executor, if it has changed.
    pub(super) fn note(&mut self, now: Time, out: &mut Vec<Effect>) {
        if let Some(program) = self.executor.program() {
            self.plan_history.goes_on_with(program.hash());
        }
        let notes = ManagerState {
            wanted: self.gateway_session.wanted().cloned(),
            controlled: self.gateway_session.is_controlled(),
            answered_alarms: self.alarms.answered().clone(),
            plan_history: self.plan_history.clone(),
        };
        if notes != self.noted {
            self.noted = notes.clone();
            self.record(now, Record::Notes(notes), out);
        }
    }

    /// Keeps count of what went into the executor.
    pub(super) fn count(&mut self, input: &Input) {
        match input {
            Input::Progress { current: Some(current) } => self.steered = self.steered.max(*current),
            Input::Propose { request, .. } | Input::Command { request, .. } => {
                self.last_request = self.last_request.max(request.0);
            }
            _ => {}
        }
    }
}
