//! The recording of the demo, made by the same service as in any flight. The report is made from it.

use super::components::{Setup, VEHICLE};
use super::recorded::{Recorded, TRUTH, Truth};
use crate::report::TrackPoint;
use anyhow::Context;
use onboard_agent::services::storage::{self, Limits, Monitor, Payload};
use onboard_agent::{Trigger, shutdown};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tokio::task::JoinHandle;
use usal::contract::Stamped;

/// Recordings of this and earlier demos: the oldest go when they take more.
const LIMITS: Limits = Limits { quota_bytes: 512 << 20, reserve_bytes: 64 << 20 };
/// What was said is recorded within this time, wall-clock.
const RECORDED_WITHIN: Duration = Duration::from_secs(10);
/// So often it is looked whether it is, wall-clock.
const LOOK_EVERY: Duration = Duration::from_millis(10);
/// The recording is closed within this time, wall-clock.
const CLOSED_WITHIN: Duration = Duration::from_secs(30);

/// The running recorder.
pub struct Recording {
    monitor: Monitor,
    trigger: Trigger,
    service: JoinHandle<anyhow::Result<()>>,
}

/// How many events were heard of a stream, by its key.
pub type Count = (String, u64);

impl Recording {
    /// Starts the recorder beside the gateway at `endpoint`; inside a runtime.
    pub fn start(setup: &Setup, endpoint: &str, folder: &Path) -> Self {
        let mut config = storage::Config::new(VEHICLE, endpoint, folder.to_owned());
        config.limits = LIMITS;
        config.simulated = true;
        config.profile = setup.profile.clone();
        config.terrain = setup.terrain.clone();
        let (trigger, shutdown) = shutdown();
        let monitor = Monitor::default();
        let service = tokio::spawn(storage::run(config, monitor.clone(), shutdown));
        Self { monitor, trigger, service }
    }

    /// What is said from now on is recorded.
    pub fn has_begun(&self) -> bool {
        self.monitor.inlet().is_some()
    }

    /// The service has ended; nobody asked it to.
    pub fn has_ended(&self) -> bool {
        self.service.is_finished()
    }

    /// Why it has ended; waits until it has.
    pub async fn why_ended(&mut self) -> String {
        super::components::why_ended("recorder", (&mut self.service).await)
    }

    /// Where the aircraft really is, which only the simulator knows.
    pub fn truth(&self, point: &TrackPoint) {
        let Some(inlet) = self.monitor.inlet() else { return };
        let value = Truth { position: point.position, altitude_amsl_m: point.altitude_amsl_m };
        let stamped = Stamped { time_s: point.time_s, validity_s: 1.0, value };
        if let Ok(text) = serde_json::to_vec(&stamped) {
            inlet.say(TRUTH.to_owned(), Payload::Json(text));
        }
    }

    /// Ends the recording once it has the events that were heard, and reads it.
    ///
    /// # Errors
    /// The recorder has failed, or the recording can't be read.
    pub async fn finish(mut self, events: &[Count]) -> anyhow::Result<Recorded> {
        self.wait_for(events).await;
        self.trigger.shut_down();
        let Ok(ended) = tokio::time::timeout(CLOSED_WITHIN, &mut self.service).await else {
            self.service.abort();
            anyhow::bail!("the recorder does not end");
        };
        ended.context("the recorder has crashed")?.context("the recorder has failed")?;
        let progress = self.monitor.inlet().context("the recording never began")?.progress();
        if let Some(why) = progress.status.failure {
            anyhow::bail!("the flight could not be recorded: {why}");
        }
        let mut recorded = read(&progress.files)?;
        recorded.lost(progress.status.missed, "messages were not recorded");
        for (key, count) in events {
            let missing = count.saturating_sub(self.monitor.events(key));
            recorded.lost(missing, &format!("events of {key} were not recorded"));
        }
        Ok(recorded)
    }

    async fn wait_for(&self, events: &[Count]) {
        let deadline = Instant::now() + RECORDED_WITHIN;
        let is_recorded = |(key, count): &Count| self.monitor.events(key) >= *count;
        while !events.iter().all(is_recorded) && !self.has_ended() && Instant::now() < deadline {
            tokio::time::sleep(LOOK_EVERY).await;
        }
    }
}

fn read(files: &[PathBuf]) -> anyhow::Result<Recorded> {
    let mut recorded = Recorded::default();
    for path in files {
        let cannot = || format!("can't read the recording {}", path.display());
        let file = File::open(path).with_context(cannot)?;
        let source = BufReader::with_capacity(1 << 16, file);
        let contents = recording::scan(source, &mut |message| recorded.message(message));
        for finding in contents.with_context(cannot)?.findings {
            recorded.refusals.push(format!("{}: {finding}", path.display()));
        }
    }
    Ok(recorded)
}
