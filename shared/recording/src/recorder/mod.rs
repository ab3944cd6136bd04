//! The recorder: what is said in, what the disk has to do out.

mod io;

pub use io::{Config, Input, Output, Report, Schema, Status};

use crate::file::{Channel, File, Refused};
use crate::foxglove::{self, Kind};
use crate::path::{Path, Point};
use crate::{Frame, Level, Payload, json, names};
use serde::Deserialize;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::time::Duration;

/// After a failure it is tried again after so long.
const RETRY: Duration = Duration::from_secs(5);
/// What was missed is told so often at most.
const TELL_EVERY: Duration = Duration::from_secs(1);
/// A clock that is off by more was set.
const JUMP: Duration = Duration::from_secs(1);
/// A file this young is not ended because the clock was set: a clock gone mad doesn't flood the disk with files.
const YOUNG: Duration = Duration::from_secs(60);
/// Documents that are repeated in each file.
const DOCUMENTS_MAX: usize = 16;
/// Who tells what the recorder tells.
const NAME: &str = "storage";

/// The recorder's state.
pub struct Recorder {
    config: Config,
    /// By `<service>/<kind>/<name>`: name and text.
    schemas: HashMap<String, (String, Vec<u8>)>,
    /// The latest of each key, as JSON.
    documents: BTreeMap<String, Vec<u8>>,
    plan: Option<String>,
    path: Path,
    /// When path and plan are drawn again, on the clock of the flight.
    map_due: Duration,
    /// The latest time on the clock of the flight.
    at: Duration,
    /// Time of day at the beginning of the clock; as the clock says now.
    origin: Duration,
    clock: Option<Duration>,
    file: Option<File>,
    name: Option<String>,
    began: Duration,
    files: u32,
    failure: Option<(String, Duration)>,
    messages: u64,
    /// Messages of what was put out last: the disk may fail at it.
    underway: u64,
    missing: Missing,
}

/// What is not in the recording.
#[derive(Default)]
struct Missing {
    total: u64,
    /// Since it was told last.
    untold: u64,
    why: String,
    told: Option<Duration>,
}

impl Recorder {
    /// A recorder; nothing is put out before there is something to be recorded.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            schemas: HashMap::new(),
            documents: BTreeMap::new(),
            plan: None,
            path: Path::default(),
            map_due: Duration::ZERO,
            at: Duration::ZERO,
            origin: Duration::ZERO,
            clock: None,
            file: None,
            name: None,
            began: Duration::ZERO,
            files: 0,
            failure: None,
            messages: 0,
            underway: 0,
            missing: Missing::default(),
        }
    }

    /// Something happens. `now`: time since the start, by a clock that is never set.
    pub fn step(&mut self, now: Duration, input: Input, out: &mut Vec<Output>) {
        if !matches!(input, Input::Failed { .. }) {
            self.written(now, out);
        }
        match input {
            Input::Clock(unix) => self.clock(now, unix, out),
            Input::Schema(schema) => {
                if let Some(of) = without_vehicle(&schema.key) {
                    self.schemas.insert(of.to_owned(), (schema.name, schema.text));
                }
            }
            Input::Frame(frame) => {
                self.frame(now, frame, out);
            }
            Input::Document(frame) => self.document(now, frame, out),
            Input::Plan(geojson) => {
                self.plan = Some(geojson);
                self.draw_plan(now, out);
            }
            Input::Line { level, message } => self.line(now, level, NAME, &message, out),
            Input::Missed { count, why } => self.miss(count, why),
            Input::Failed { why, is_taken } => self.failed(now, why, is_taken, out),
            Input::Wake => {}
            Input::Close => return self.close(out),
        }
        self.due(now, out);
    }

    /// When it wants to be stepped at the latest.
    pub fn deadline(&self) -> Option<Duration> {
        let since = self.file.as_ref()?.chunk().since?;
        Some(since + self.config.chunk_age)
    }

    /// How the recording goes.
    pub fn status(&self) -> Status {
        Status {
            file: self.name.clone(),
            file_bytes: self.file.as_ref().map_or(0, File::bytes),
            messages: self.messages,
            missed: self.missing.total,
            failure: self.failure.as_ref().map(|(why, _)| why.clone()),
        }
    }

    fn clock(&mut self, now: Duration, unix: Duration, out: &mut Vec<Output>) {
        let origin = unix.saturating_sub(now);
        let known = *self.clock.get_or_insert(origin);
        if self.files == 0 {
            self.origin = origin;
        }
        if origin.abs_diff(known) > JUMP {
            self.clock = Some(origin);
            let by_s = origin.as_secs_f64() - known.as_secs_f64();
            self.tell(now, Report::ClockJumped { by_s }, out);
        }
        let is_off = origin.abs_diff(self.origin) > JUMP;
        if is_off && (self.file.is_none() || now.saturating_sub(self.began) >= YOUNG) {
            self.close(out);
            self.origin = origin;
        }
    }

    fn frame(&mut self, now: Duration, frame: Frame, out: &mut Vec<Output>) -> Option<Vec<u8>> {
        self.at = frame.at;
        if frame.payload.len() > self.config.message_bytes {
            self.miss(1, "a message is too large");
            return None;
        }
        let text = match frame.payload {
            Payload::Json(text) => json::check(&text).map(|()| text),
            Payload::Cbor(bytes) => json::from_cbor(&bytes),
        };
        let text = match text {
            Ok(text) => text,
            Err(why) => {
                self.miss(1, &format!("{}: {why}", frame.key));
                return None;
            }
        };
        self.write(now, &frame.key, None, &text, out);
        self.derive(now, &frame.key, &text, out);
        Some(text)
    }

    fn document(&mut self, now: Duration, frame: Frame, out: &mut Vec<Output>) {
        let key = frame.key.clone();
        let Some(text) = self.frame(now, frame, out) else { return };
        if self.documents.contains_key(&key) || self.documents.len() < DOCUMENTS_MAX {
            self.documents.insert(key, text);
        }
    }

    /// What a message brings besides itself: a place on the map, a line of the log.
    fn derive(&mut self, now: Duration, key: &str, text: &[u8], out: &mut Vec<Output>) {
        match without_vehicle(key) {
            Some("gateway/variable/position") => self.located(now, text, out),
            Some(rest) if rest.ends_with("/event/log") => {
                let service = rest.split('/').next().unwrap_or_default();
                if let Ok(Logged { value }) = serde_json::from_slice(text) {
                    let message = format!("{}: {}", value.target, value.message);
                    self.line(now, Level::by_name(&value.level), service, &message, out);
                }
            }
            _ => {}
        }
        if self.at >= self.map_due {
            self.map_due = self.at + self.config.map_every;
            self.draw_path(now, out);
            self.draw_plan(now, out);
        }
    }

    fn located(&mut self, now: Duration, text: &[u8], out: &mut Vec<Output>) {
        let Some(point) = Point::of(text) else { return };
        self.path.add(self.at, point);
        let fix = foxglove::location(self.log_time(), &self.config.vehicle, &point);
        self.write_foxglove(now, "location", Kind::LocationFix, &fix, out);
    }

    fn draw_path(&mut self, now: Duration, out: &mut Vec<Output>) {
        if let Some(geojson) = self.path.geojson() {
            self.write_foxglove(now, "path", Kind::GeoJson, &foxglove::drawing(&geojson), out);
        }
    }

    fn draw_plan(&mut self, now: Duration, out: &mut Vec<Output>) {
        if let Some(geojson) = &self.plan {
            let drawing = foxglove::drawing(geojson);
            self.write_foxglove(now, "plan", Kind::GeoJson, &drawing, out);
        }
    }

    fn line(&mut self, now: Duration, level: Level, name: &str, message: &str, out: &mut Vec<Output>) {
        let line = foxglove::line(self.log_time(), level, name, message);
        self.write_foxglove(now, "log", Kind::Log, &line, out);
    }

    fn tell(&mut self, now: Duration, report: Report, out: &mut Vec<Output>) {
        self.line(now, report.level(), NAME, &report.to_string(), out);
        out.push(Output::Tell(report));
    }

    fn write_foxglove(
        &mut self,
        now: Duration,
        name: &str,
        kind: Kind,
        value: &Value,
        out: &mut Vec<Output>,
    ) {
        let topic = format!("foxglove/{}/{name}", self.config.vehicle);
        self.write(now, &topic, Some(kind), value.to_string().as_bytes(), out);
    }

    /// Into the file, which begins with its first message.
    fn write(&mut self, now: Duration, topic: &str, kind: Option<Kind>, text: &[u8], out: &mut Vec<Output>) {
        if self.file.is_none() && !self.begin(now, out) {
            return self.miss(1, "the disk can't be written");
        }
        self.append(now, topic, kind, text);
    }

    fn append(&mut self, now: Duration, topic: &str, kind: Option<Kind>, text: &[u8]) {
        let log = self.log_time();
        let Some(file) = &mut self.file else { return };
        let schemas = &self.schemas;
        let schema = || match kind {
            Some(kind) => Some((kind.name(), Cow::from(kind.schema().to_string().into_bytes()))),
            None => {
                let (name, text) = schemas.get(without_vehicle(topic)?)?;
                Some((name.as_str(), Cow::from(text)))
            }
        };
        match file.write(now, Channel { topic, schema: &schema }, log, text) {
            Ok(()) => self.messages += 1,
            Err(Refused::TooManyChannels) => self.miss(1, "there are too many channels"),
            Err(Refused::Writer(why)) => self.miss(1, &why),
        }
    }

    /// Begins a file, unless the last failure is too young. It begins with what every file has to know.
    fn begin(&mut self, now: Duration, out: &mut Vec<Output>) -> bool {
        if self.failure.as_ref().is_some_and(|(_, retry)| now < *retry) {
            return false;
        }
        self.files += 1;
        let unix = self.origin + now;
        let name = names::file_name(&self.config.vehicle, unix, self.files);
        let about = self.config.about.iter().cloned().chain([
            ("vehicle".to_owned(), self.config.vehicle.clone()),
            ("began_unix_s".to_owned(), format!("{:.3}", unix.as_secs_f64())),
        ]);
        self.file = File::new(about.collect()).ok();
        if self.file.is_none() {
            return false;
        }
        self.began = now;
        self.name = Some(name.clone());
        out.push(Output::Begin { name });
        for (key, text) in std::mem::take(&mut self.documents) {
            self.append(now, &key, None, &text);
            self.documents.insert(key, text);
        }
        self.draw_plan(now, out);
        self.draw_path(now, out);
        true
    }

    /// Whatever is due now.
    fn due(&mut self, now: Duration, out: &mut Vec<Output>) {
        self.tell_missing(now, out);
        let Some(file) = &mut self.file else { return };
        let chunk = file.chunk();
        let is_old = chunk.since.is_some_and(|since| now >= since + self.config.chunk_age);
        if !is_old && chunk.bytes < self.config.chunk_bytes {
            return;
        }
        match file.flush() {
            Ok(bytes) => {
                self.underway += chunk.messages;
                out.push(Output::Append { bytes });
            }
            Err(_) => self.miss(chunk.messages, "a chunk can't be written"),
        }
        if self.file.as_ref().is_some_and(|file| file.bytes() >= self.config.file_bytes) {
            self.close(out);
        }
    }

    fn close(&mut self, out: &mut Vec<Output>) {
        self.name = None;
        let Some(file) = self.file.take() else { return };
        let messages = file.chunk().messages;
        match file.finish() {
            Ok(bytes) => {
                self.underway += messages;
                out.extend([Output::Append { bytes }, Output::Finish]);
            }
            Err(_) => self.miss(messages, "the end of a file can't be written"),
        }
    }

    /// The disk has done what it was told last.
    fn written(&mut self, now: Duration, out: &mut Vec<Output>) {
        if std::mem::take(&mut self.underway) > 0 && self.failure.take().is_some() {
            let missed = std::mem::take(&mut self.missing.untold);
            self.tell(now, Report::Recovered { missed }, out);
        }
    }

    /// The disk did not do what it was told: the file is left as it is, and mended at the next start.
    fn failed(&mut self, now: Duration, why: String, is_taken: bool, out: &mut Vec<Output>) {
        self.name = None;
        let open = self.file.take().map_or(0, |file| file.chunk().messages);
        let lost = open + std::mem::take(&mut self.underway);
        self.messages = self.messages.saturating_sub(lost);
        if is_taken {
            // the next file has the next number
            return self.miss(lost, "the name of a file was taken");
        }
        self.miss(lost, "the disk can't be written");
        if self.failure.is_none() {
            out.push(Output::Tell(Report::Failed { why: why.clone() }));
        }
        self.failure = Some((why, now + RETRY));
    }

    fn miss(&mut self, count: u64, why: &str) {
        self.missing.total += count;
        self.missing.untold += count;
        if count > 0 && self.missing.why != why {
            why.clone_into(&mut self.missing.why);
        }
    }

    fn tell_missing(&mut self, now: Duration, out: &mut Vec<Output>) {
        let missing = &mut self.missing;
        let is_due = missing.told.is_none_or(|told| now >= told + TELL_EVERY);
        if missing.untold == 0 || !is_due || self.failure.is_some() {
            return;
        }
        missing.told = Some(now);
        let report = Report::Missed { count: std::mem::take(&mut missing.untold), why: missing.why.clone() };
        self.tell(now, report, out);
    }

    /// The flight's clock as a time of day.
    fn log_time(&self) -> Duration {
        self.origin.saturating_add(self.at)
    }
}

/// `<service>/<kind>/<name>` of a key.
fn without_vehicle(key: &str) -> Option<&str> {
    let (_vehicle, rest) = key.strip_prefix("legwork/")?.split_once('/')?;
    Some(rest)
}

/// What is read of a service's log line.
#[derive(Deserialize)]
struct Logged {
    value: LogLine,
}

#[derive(Deserialize)]
struct LogLine {
    level: String,
    #[serde(default)]
    target: String,
    message: String,
}
