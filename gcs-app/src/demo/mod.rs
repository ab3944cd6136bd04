//! The demo: simulator, agent and window in one process, talking over loopback as they always do.
//!
//! `mission` is what a service above the plan does, `flight` does it in step with the simulated clock, `components`
//! starts and watches the rest, `judge` says whether the mission was really flown as planned.

mod by_hand;
pub mod components;
mod flight;
mod judge;
mod mission;
mod plan;
mod progress;
mod recorded;
mod recording;
mod summary;
mod watcher;

use crate::app;
use crate::document::Document;
use crate::headless::wind;
use crate::report::{self, Findings, Record};
use crate::story::{End, Story};
use aircraft::Wind;
use anyhow::Context;
use components::{Components, Setup, VEHICLE};
use flight::{Ending, Flight};
use plan::Prepared;
use progress::Progress;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};
use watcher::Watcher;

/// Simulated seconds per second beside a window, unless told otherwise: slow enough to watch.
const WATCHABLE_SPEED: f64 = 20.0;
/// Wall-clock seconds that a demo may take besides its flight.
const SPARE_S: f64 = 180.0;
/// The slowest pace at which a flight "as fast as possible" is still waited for, × real time.
const LEAST_PACE: f64 = 5.0;
/// The recordings' folder inside of the report's.
const RECORDINGS: &str = "recordings";
/// Exit status of a demo that came to no end.
const FAILED: u8 = 2;
/// When the window is closed, everything else must have ended after this, wall-clock.
const CLOSING: Duration = Duration::from_secs(60);

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
    /// Which autopilot the simulator behaves as: arduplane, px4 or px4-vtol.
    #[arg(long, value_name = "AUTOPILOT", default_value_t = sim::Personality::ArduPlane)]
    pub autopilot: sim::Personality,
    /// Simulated seconds per second; 0: as fast as possible. [default: 20 with a window, else 0]
    #[arg(long, value_name = "FACTOR", value_parser = speed)]
    pub speed: Option<f64>,
    /// Begin with the light theme.
    #[arg(long, conflicts_with = "headless")]
    pub light: bool,
    /// Write a picture of the window (PNG) and close it.
    #[arg(long, value_name = "FILE", conflicts_with = "headless")]
    pub screenshot: Option<PathBuf>,
    /// Seconds until that picture is taken.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, requires = "screenshot")]
    pub after: f64,
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
        complain!("no display here: flying without a window");
    }
    let speed = args.speed.unwrap_or(if windowed { WATCHABLE_SPEED } else { 0.0 });
    if windowed { with_window(args, prepared, speed) } else { without_window(args, &prepared, speed) }
}

/// Longer than this no flight takes that nobody holds, wall-clock.
fn limit(planned_s: f64, speed: f64) -> Duration {
    let pace = if speed > 0.0 { speed.min(LEAST_PACE) } else { LEAST_PACE };
    Duration::from_secs_f64(planned_s / pace + SPARE_S)
}

/// Ends the process when what this gives is still held then: a demo never hangs.
fn give_up_after(limit: Duration) -> Sender<()> {
    let (held, dropped) = channel::<()>();
    std::thread::spawn(move || {
        if dropped.recv_timeout(limit) == Err(RecvTimeoutError::Timeout) {
            complain!("legwork: the demo has not ended after {} s: given up", limit.as_secs());
            std::process::exit(2);
        }
    });
    held
}

fn without_window(args: &Args, prepared: &Prepared, speed: f64) -> anyhow::Result<ExitCode> {
    let _held = give_up_after(limit(prepared.planned.duration_s(), speed));
    let (endpoint, _) = channel();
    runtime()?.block_on(fly(args, prepared, speed, &endpoint, &Watcher::nobody()))
}

/// The flight on a thread of its own, the window on this one.
fn with_window(args: &Args, prepared: Prepared, speed: f64) -> anyhow::Result<ExitCode> {
    let watcher = Arc::new(Watcher::someone());
    let (sender, endpoint) = channel();
    let document = Document::new(prepared.program.plan.as_ref().clone(), None, Vec::new());
    let planned_s = prepared.planned.duration_s();
    let (for_flight, beside) = (args.clone(), watcher.clone());
    let flight = std::thread::Builder::new()
        .name("demo".into())
        .spawn(move || runtime()?.block_on(fly(&for_flight, &prepared, speed, &sender, &beside)))
        .context("can't start a thread for the flight")?;
    open_window(args, document, &endpoint, &watcher);
    let held = give_up_after(if watcher.has_left() { CLOSING } else { limit(planned_s, speed) });
    let ended = flight.join().unwrap_or_else(|_| Err(anyhow::anyhow!("the flight's thread has crashed")));
    drop(held);
    if watcher.story.is_wanted_again() { again() } else { ended }
}

/// The same demo once more, in a process of its own: a desktop gives a process one window system, and everything begins anew.
fn again() -> anyhow::Result<ExitCode> {
    let program = std::env::current_exe().context("the demo can't be begun again")?;
    let status = std::process::Command::new(program).args(std::env::args_os().skip(1)).status();
    let status = status.context("the demo can't be begun again")?;
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Ok(ExitCode::from(code.unwrap_or(FAILED)))
}

/// Returns when the window is closed; without a window the flight goes on.
fn open_window(args: &Args, document: Document, endpoint: &Receiver<String>, watcher: &Watcher) {
    // no endpoint: the flight has failed already and says why
    let Ok(endpoint) = endpoint.recv() else { return };
    let options = app::Options {
        document: Some(document),
        connect: Some((VEHICLE.to_owned(), endpoint)),
        story: Some(watcher.story.clone()),
        theme: args.light.then_some(eframe::egui::Theme::Light),
        screenshot: args.screenshot.clone().map(|file| app::Screenshot::new(file, args.after)),
        ..app::Options::default()
    };
    match app::run(options) {
        Ok(()) => watcher.leave(),
        Err(error) => {
            complain!("{error}\ngoing on without a window");
            watcher.give_up();
        }
    }
}

fn runtime() -> anyhow::Result<tokio::runtime::Runtime> {
    tokio::runtime::Builder::new_multi_thread().enable_all().build().context("can't start the runtime")
}

/// Starts the components and flies. The gateway's endpoint is sent as soon as it is known.
async fn fly(
    args: &Args,
    prepared: &Prepared,
    speed: f64,
    endpoint: &Sender<String>,
    watcher: &Watcher,
) -> anyhow::Result<ExitCode> {
    std::fs::create_dir_all(&args.report).with_context(|| {
        format!("can't make the report folder {}: choose another with --report", args.report.display())
    })?;
    let recordings = args.report.join(RECORDINGS);
    let components = Components::start(&setup(args, prepared, speed, &recordings))?;
    // without a window nobody listens
    let _ = endpoint.send(components.endpoint.clone());
    fly_with(args, prepared, components, watcher).await
}

fn setup<'a>(args: &Args, prepared: &'a Prepared, speed: f64, recordings: &'a Path) -> Setup<'a> {
    Setup {
        home: &prepared.home,
        profile: prepared.profile.clone(),
        wind: args.wind,
        autopilot: args.autopilot,
        speed,
        terrain: prepared.terrain.clone(),
        recordings,
    }
}

/// Flies, writes the report, prints the summary, and stops the components: with a window, when that is closed.
async fn fly_with(
    args: &Args,
    prepared: &Prepared,
    mut components: Components,
    watcher: &Watcher,
) -> anyhow::Result<ExitCode> {
    let began = Instant::now();
    let progress = Progress::new(prepared.planned.duration_s());
    let script = mission::Script::new(prepared.steps.clone());
    let plan = prepared.program.plan.as_ref().clone();
    let mut flight =
        Flight::join(&components, plan, script, prepared.planned.duration_s(), &progress, watcher).await?;
    let flown = flight.fly(&mut components).await;
    progress.end();
    let ending = ending(&flight, &mut components, prepared).await;
    flight.leave().await;
    let wall_s = began.elapsed().as_secs_f64();
    let good = ending.and_then(|ending| conclude(args, prepared, &ending, wall_s, &watcher.story));
    let failure = flown.as_ref().err().or(good.as_ref().err());
    watcher.story.end(&last_words(failure, good.as_ref().ok()), end(args, &good));
    stay_open(watcher, flown.as_ref().err()).await;
    components.stop().await;
    // why the flight failed says more than why its report did
    flown?;
    let good = good?.is_good;
    Ok(ExitCode::from(u8::from(!good)))
}

/// What came of a flight.
struct Conclusion {
    /// It was flown as planned.
    is_good: bool,
    /// The operator took part.
    is_by_hand: bool,
    /// Its report was made.
    is_reported: bool,
}

fn last_words(failure: Option<&anyhow::Error>, conclusion: Option<&Conclusion>) -> String {
    match (failure, conclusion) {
        (Some(failure), _) => format!(
            "The demo has failed: {failure:#}. Try again, on a busy machine with a lower --speed; or close this strip and fly on yourself while the vehicle is connected."
        ),
        (None, Some(conclusion)) if conclusion.is_good && conclusion.is_by_hand => {
            "The mission was flown as you commanded it: its report says how. Close the window to end the demo.".into()
        }
        (None, Some(conclusion)) if conclusion.is_good => {
            "The mission was flown as planned. Close the window to end the demo.".into()
        }
        (None, Some(conclusion)) if conclusion.is_reported => {
            "The mission was not flown as planned: its report says what was different.".into()
        }
        (None, _) => "The mission was not flown as planned.".into(),
    }
}

/// How it ended, with its report if one was written.
fn end(args: &Args, conclusion: &anyhow::Result<Conclusion>) -> End {
    let of = |what: fn(&Conclusion) -> bool| conclusion.as_ref().is_ok_and(what);
    let report = std::path::absolute(args.report.join("report.html")).ok();
    End { good: of(|c| c.is_good), report: report.filter(|path| of(|c| c.is_reported) && path.exists()) }
}

/// Ends the recording: what was recorded, and how the aircraft stands.
async fn ending(
    flight: &Flight<'_>,
    components: &mut Components,
    prepared: &Prepared,
) -> anyhow::Result<Ending> {
    let recording = components.recording.take().context("the recording is finished already")?;
    let recorded = recording.finish(&flight.counts()).await?;
    Ok(flight.ending(recorded, components, &prepared.destination))
}

/// The window shows where the aircraft stands, until it is closed.
async fn stay_open(watcher: &Watcher, failure: Option<&anyhow::Error>) {
    if !watcher.is_watching() {
        return;
    }
    if let Some(failure) = failure {
        complain!("legwork: {failure:#}");
    }
    complain!("Close the window to end the demo.");
    watcher.gone().await;
}

/// Judges the flight, writes the report unless that is cancelled, prints the summary.
fn conclude(
    args: &Args,
    prepared: &Prepared,
    ending: &Ending,
    wall_s: f64,
    story: &Story,
) -> anyhow::Result<Conclusion> {
    let mut record: Record = prepared.record(ending, &args.wind);
    record.verdict = judge::verdict(&record, &Findings::of(&record), &ending.outcome);
    let is_by_hand = !record.by_hand.is_empty();
    if record.flown.points().is_empty() {
        return Ok(Conclusion { is_good: false, is_by_hand, is_reported: false });
    }
    let work = story.work("Making the report");
    let findings = report::write(&record, &args.report, work.progress())?;
    if let Some(findings) = &findings {
        summary::print(&record, findings, wall_s, &args.report)?;
    }
    let is_good = record.verdict.iter().all(|(holds, _)| *holds);
    Ok(Conclusion { is_good, is_by_hand, is_reported: findings.is_some() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simulator_that_ends_fails_the_demo() {
        let folder = tempfile::tempdir().unwrap();
        let square = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/plans/square.xml");
        let args = Args {
            headless: true,
            report: folder.path().to_owned(),
            plan: Some(square.into()),
            wind: Wind::default(),
            autopilot: sim::Personality::default(),
            speed: None,
            light: false,
            screenshot: None,
            after: 0.0,
        };
        let prepared = plan::prepare(&args).unwrap();
        let result = runtime().unwrap().block_on(async {
            let components = Components::start(&setup(&args, &prepared, 0.0, folder.path())).unwrap();
            assert!(components.simulator.control(sim::Control::Stop));
            fly_with(&args, &prepared, components, &Watcher::nobody()).await
        });
        let why = result.map(|_| ()).unwrap_err().to_string();
        assert_eq!(why, "the simulator has ended");
    }

    #[test]
    fn a_failure_says_why_and_what_can_be_done() {
        let said = last_words(Some(&anyhow::anyhow!("the plan was not taken")), None);
        assert!(said.contains("the plan was not taken. Try again") && said.contains("--speed"), "{said}");
    }

    #[test]
    fn flights_are_given_up_later_than_they_can_take() {
        for (planned_s, speed) in [(3000.0, 0.0), (3000.0, 1.0), (3000.0, 20.0), (0.0, 0.0)] {
            let needs_s = if speed > 0.0 { planned_s / speed } else { 0.0 };
            assert!(limit(planned_s, speed).as_secs_f64() >= needs_s + SPARE_S, "{planned_s} {speed}");
        }
    }
}
