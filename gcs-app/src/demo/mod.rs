//! The demo: simulator, agent and window in one process, talking over loopback as they always do.
//!
//! `mission` is what a service above the plan does, `flight` does it in step with the simulated clock, `components`
//! starts and watches the rest, `judge` says whether the mission was really flown as planned.

mod components;
mod flight;
mod judge;
mod mission;
mod plan;
mod progress;
mod recorder;
mod summary;

use crate::app;
use crate::document::Document;
use crate::headless::wind;
use crate::report::{self, Findings, Record};
use aircraft::Wind;
use anyhow::Context;
use components::{Components, Setup, VEHICLE};
use flight::Flight;
use plan::Prepared;
use progress::Progress;
use recorder::Recorder;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// Simulated seconds per second beside a window, unless told otherwise: slow enough to watch.
const WATCHABLE_SPEED: f64 = 15.0;
/// Wall-clock seconds that a demo may take besides its flight.
const SPARE_S: f64 = 180.0;
/// The slowest pace at which a flight "as fast as possible" is still waited for, × real time.
const LEAST_PACE: f64 = 5.0;

/// Arguments of `legwork demo`.
#[derive(Debug, Clone, clap::Args)]
pub struct Args {
    /// Fly without a window, as fast as the machine allows.
    #[arg(long)]
    pub headless: bool,
    /// Where the report goes.
    #[arg(long, value_name = "DIR", default_value = "legwork-report")]
    pub report: PathBuf,
    /// Another plan than the fire watch (its intersections take their defaults).
    #[arg(long, value_name = "FILE")]
    pub plan: Option<PathBuf>,
    /// Where the wind comes from (degrees true) and its speed (m/s).
    #[arg(long, value_name = "DIRECTION,SPEED", value_parser = wind::parse, default_value = "270,5")]
    pub wind: Wind,
    /// Simulated seconds per second; 0: as fast as possible. [default: 15 with a window, else 0]
    #[arg(long, value_name = "FACTOR", value_parser = speed)]
    pub speed: Option<f64>,
}

fn speed(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(factor) if (0.0..=10_000.0).contains(&factor) => Ok(factor),
        _ => Err("write a number from 0 (as fast as possible) to 10000".into()),
    }
}

/// Flies the demo; the status is a success only if the mission was flown as planned.
///
/// # Errors
/// The plan can't be flown, the report can't be written, or a component fails (exit status 2).
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let prepared = plan::prepare(args)?;
    let windowed = !args.headless && app::has_display();
    if !windowed && !args.headless {
        eprintln!("no display here: flying without a window");
    }
    let speed = args.speed.unwrap_or(if windowed { WATCHABLE_SPEED } else { 0.0 });
    watch_over(&prepared, speed);
    if windowed { with_window(args, prepared, speed) } else { without_window(args, &prepared, speed) }
}

/// Ends the process when the flight takes longer than anything could explain: a demo never hangs.
fn watch_over(prepared: &Prepared, speed: f64) {
    let pace = if speed > 0.0 { speed.min(LEAST_PACE) } else { LEAST_PACE };
    let limit = Duration::from_secs_f64(prepared.planned.duration_s() / pace + SPARE_S);
    std::thread::spawn(move || {
        std::thread::sleep(limit);
        eprintln!("legwork: the demo has not ended after {} s: given up", limit.as_secs());
        std::process::exit(2);
    });
}

fn without_window(args: &Args, prepared: &Prepared, speed: f64) -> anyhow::Result<ExitCode> {
    let (endpoint, _) = channel();
    runtime()?.block_on(fly(args, prepared, speed, &endpoint, &AtomicBool::new(false)))
}

/// The flight on a thread of its own, the window on this one.
fn with_window(args: &Args, prepared: Prepared, speed: f64) -> anyhow::Result<ExitCode> {
    let ended = Arc::new(AtomicBool::new(false));
    let (sender, endpoint) = channel();
    let document = Document::new(prepared.program.plan.clone(), None, Vec::new());
    let (args, flag) = (args.clone(), ended.clone());
    let flight = std::thread::Builder::new()
        .name("demo".into())
        .spawn(move || runtime()?.block_on(fly(&args, &prepared, speed, &sender, &flag)))
        .context("can't start a thread for the flight")?;
    open_window(document, &endpoint, &ended);
    flight.join().unwrap_or_else(|_| Err(anyhow::anyhow!("the flight's thread has crashed")))
}

/// Returns when the window is closed; without a window the flight goes on.
fn open_window(document: Document, endpoint: &Receiver<String>, ended: &AtomicBool) {
    // no endpoint: the flight has failed already and says why
    let Ok(endpoint) = endpoint.recv() else { return };
    let options = app::Options {
        document: Some(document),
        connect: Some((VEHICLE.to_owned(), endpoint)),
        ..app::Options::default()
    };
    match app::run(options) {
        Ok(()) => ended.store(true, Ordering::Relaxed),
        Err(error) => eprintln!("{error}\ngoing on without a window"),
    }
}

fn runtime() -> anyhow::Result<tokio::runtime::Runtime> {
    tokio::runtime::Builder::new_multi_thread().enable_all().build().context("can't start the runtime")
}

/// Starts the components, flies, stops them, writes the report and prints the summary. The gateway's endpoint is sent
/// as soon as it is known.
async fn fly(
    args: &Args,
    prepared: &Prepared,
    speed: f64,
    endpoint: &Sender<String>,
    ended: &AtomicBool,
) -> anyhow::Result<ExitCode> {
    std::fs::create_dir_all(&args.report).with_context(|| {
        format!("can't make the report folder {}: choose another with --report", args.report.display())
    })?;
    let recorder = Recorder::new(&args.report.join("log.jsonl"))?;
    let mut components = Components::start(&Setup {
        home: &prepared.home,
        profile: prepared.profile.clone(),
        wind: args.wind,
        speed,
        terrain: prepared.terrain.clone(),
    })?;
    // without a window nobody listens
    let _ = endpoint.send(components.endpoint.clone());
    let began = Instant::now();
    let progress = Progress::new(prepared.planned.duration_s());
    let script = mission::Script::new(prepared.steps.clone());
    let plan = prepared.program.plan.clone();
    let mut flight =
        Flight::join(&components, plan, script, recorder, prepared.planned.duration_s(), &progress, ended)
            .await?;
    let flown = flight.fly(&mut components).await;
    progress.end();
    let ending = flight.ending(&components, &prepared.destination);
    flight.leave().await;
    components.stop().await;
    let wall_s = began.elapsed().as_secs_f64();
    let good = conclude(args, prepared, &ending, wall_s)?;
    flown?;
    Ok(ExitCode::from(u8::from(!good)))
}

/// Judges the flight, writes the report, prints the summary; gives whether everything is as planned.
fn conclude(args: &Args, prepared: &Prepared, ending: &flight::Ending, wall_s: f64) -> anyhow::Result<bool> {
    let mut record: Record = prepared.record(ending, &args.wind);
    record.verdict = judge::verdict(&record, &Findings::of(&record), &ending.outcome);
    if record.flown.points().is_empty() {
        return Ok(false);
    }
    let findings = report::write(&record, &args.report)?;
    summary::print(&record, &findings, wall_s, &args.report);
    Ok(record.verdict.iter().all(|(holds, _)| *holds))
}
