//! Storage, the flight recorder: everything that is said on the network, as MCAP files.
//!
//! Three parts: the core (`recording`, pure) says what is written when; `writer` is a thread of its own around it and the
//! `disk`; this service follows the network and puts what it hears into the writer's queue. Nobody waits for it: what finds
//! no room is counted, and the count stands in the recording.

pub(crate) mod disk;
mod follow;
mod mend;
mod plan_drawing;
#[cfg(test)]
mod tests;
mod writer;

pub use disk::SyncCost;
pub use follow::Monitor;
pub use recording::{Limits, Payload};
pub use writer::{Inlet, Progress};

use aircraft::Profile;
use recording::Schema;
use service::{Adapter, Beginning, Out, Service, Shutdown, Tasks, Time, Wiring};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use terrain::Terrain;
use usal::contract::{Empty, PlanDocument, Recording};
use usal::topics::{FP_MANAGER, fp_manager, storage::RECORDING};
use usal::{CallError, Key, Kind, Spec};
use writer::Writer;

/// The plan's document is there within this time.
const ANSWER_WITHIN: Duration = Duration::from_secs(5);

/// So many files have room in the quota at least.
const FILES_MIN: u64 = 4;

/// What it is started with.
#[derive(Clone)]
pub struct Config {
    /// The vehicle's name, part of every key.
    pub vehicle: String,
    /// The gateway's endpoint.
    pub connect: String,
    /// Where the files go.
    pub folder: PathBuf,
    /// How much may be kept.
    pub limits: Limits,
    /// Time is the simulator's: read, not taken part in.
    pub simulated: bool,
    /// The aircraft, for the drawing of the plan.
    pub profile: Profile,
    /// The ground, likewise.
    pub terrain: Arc<dyn Terrain>,
}

impl Config {
    /// The trainer over an unknown ground, with the usual limits: 4 GiB of recordings, 512 MiB left free.
    pub fn new(vehicle: &str, connect: &str, folder: PathBuf) -> Self {
        Self {
            vehicle: vehicle.into(),
            connect: connect.into(),
            folder,
            limits: Limits { quota_bytes: 4 << 30, reserve_bytes: 512 << 20 },
            simulated: false,
            profile: Profile::default(),
            terrain: Arc::new(terrain::Tiles::new()),
        }
    }
}

/// Records until `shutdown`; `monitor` tells others in this process how far it is.
///
/// # Errors
/// Another storage runs, or the session can't be had.
pub async fn run(config: Config, monitor: Monitor, shutdown: Shutdown) -> anyhow::Result<()> {
    let mut of_service = service::Config::client(&config.vehicle, &config.connect);
    of_service.state_dir = Some(config.folder.clone());
    let made = async move |beginning: Beginning| begin(config, &monitor, &beginning);
    // whatever goes wrong, it may be tried again, and the flight goes on: it is nobody's wrong start
    service::run(of_service, shutdown, made).await.map_err(|error| anyhow::anyhow!("{error:#}"))
}

fn begin(config: Config, monitor: &Monitor, beginning: &Beginning) -> anyhow::Result<(Storage, Recorder)> {
    let mut how = recording::Config::new(&config.vehicle);
    // so that the quota holds several files, however small it is
    how.file_bytes = how.file_bytes.min(config.limits.quota_bytes / FILES_MIN);
    let clock = if config.simulated { "simulated" } else { "machine" };
    how.about = vec![
        ("program".into(), concat!("legwork ", env!("CARGO_PKG_VERSION")).into()),
        ("clock".into(), clock.into()),
    ];
    let writer = Writer::start(&config.folder, how, config.limits, schemas(), config.simulated)?;
    let inlet = writer.inlet();
    mend::begin(&config.folder, inlet.clone());
    let everything = follow::everything(beginning, inlet.clone(), monitor)?;
    monitor.begin(inlet.clone());
    Ok((
        Storage { config, inlet, recorded: None, asked: false },
        Recorder { writer: Some(writer), everything: Some(everything) },
    ))
}

/// The JSON Schemas of all services that this program knows, and of what the runtime tells of each.
fn schemas() -> Vec<Schema> {
    let schema = |service: &str, kind: Kind, name: &str, text: &serde_json::Value| {
        let key = Key::new("any", service, kind, name).ok()?;
        Some(Schema {
            key: key.to_string(),
            name: format!("legwork.{service}.{name}"),
            text: text.to_string().into_bytes(),
        })
    };
    let (audit, log) = (follow::audit_schema(), follow::log_schema());
    let mut schemas = Vec::new();
    for described in usal::spec::SERVICES.iter().map(|spec| spec.describe()) {
        let service = described.service.as_str();
        schemas
            .extend(described.primitives.iter().filter_map(|p| schema(service, p.kind, &p.name, &p.schema)));
        schemas.extend(schema(service, Kind::Event, "audit", &audit));
        schemas.extend(schema(service, Kind::Event, "log", &log));
    }
    schemas
}

/// The service: everything but the plan goes past it, straight into the queue.
struct Storage {
    config: Config,
    inlet: Inlet,
    /// Hash of the plan whose document is recorded.
    recorded: Option<String>,
    /// Its document was asked for; the answer is not there yet.
    asked: bool,
}

/// All that can happen to it.
enum Input {
    /// The active plan's hash.
    Plan(Option<String>),
    Document(Result<PlanDocument, CallError>),
    Drawn(Result<String, String>),
}

impl Service for Storage {
    type Input = Input;
    type Output = service::Never;
    const SPEC: Spec = usal::spec::STORAGE;

    fn wire(wiring: &mut Wiring<Input>) {
        wiring.follow(fp_manager::PLAN, |received| Input::Plan(received.stamped.value.hash.clone()));
    }

    fn step(&mut self, _: Time, input: Input, out: &mut Out<Input>) {
        match input {
            // told every second: what changes while it is asked for is asked for then
            Input::Plan(hash) if hash.is_none() || hash == self.recorded || self.asked => {}
            Input::Plan(_) => {
                self.asked = true;
                out.call(fp_manager::PLAN_DOCUMENT, Empty {}, ANSWER_WITHIN, Input::Document);
            }
            Input::Document(answer) => self.document(answer, out),
            Input::Drawn(Ok(geojson)) => self.inlet.plan(geojson),
            Input::Drawn(Err(why)) => tracing::warn!("the plan is recorded, but not drawn: {why}"),
        }
    }

    fn publish(&mut self, _: Time, board: &mut service::Board) {
        let Progress { status, cost, .. } = self.inlet.progress();
        board.changing(RECORDING, (status.file.clone(), status.failure.clone()), |_| Recording {
            file: status.file,
            file_bytes: status.file_bytes,
            messages: status.messages,
            missed: status.missed,
            failure: status.failure,
            longest_sync_ms: u64::try_from(cost.longest.as_millis()).unwrap_or(u64::MAX),
        });
    }
}

impl Storage {
    fn document(&mut self, answer: Result<PlanDocument, CallError>, out: &mut Out<Input>) {
        self.asked = false;
        let document = match answer {
            Ok(document) => document,
            Err(error) => {
                return tracing::warn!("the plan's document can't be had, it is asked for again: {error}");
            }
        };
        let Ok(text) = serde_json::to_vec(&document) else { return };
        self.recorded.clone_from(&document.info.hash);
        if let Some(key) = follow::document_key(&self.config.vehicle, FP_MANAGER, "plan") {
            self.inlet.document(key, Payload::Json(text));
        }
        let (profile, terrain) = (self.config.profile.clone(), self.config.terrain.clone());
        out.work(
            move || plan_drawing::draw(&document.xml, &profile, &terrain),
            |drawn| Input::Drawn(drawn.flatten()),
        );
    }
}

/// The service's hold on thread and network; both end with it.
struct Recorder {
    writer: Option<Writer>,
    everything: Option<usal::Everything>,
}

impl Adapter<Storage> for Recorder {
    async fn perform(&mut self, _: Time, _: Vec<service::Never>, _: bool, _: &mut Tasks<Input>) {}

    async fn finish(&mut self) {
        self.everything = None;
        if let Some(writer) = self.writer.take() {
            let closed = tokio::task::spawn_blocking(move || writer.close()).await;
            if let Ok(Progress { status, cost, .. }) = closed {
                tracing::info!(
                    messages = status.messages,
                    missed = status.missed,
                    syncs = cost.count,
                    "recording ended"
                );
            }
        }
    }
}
