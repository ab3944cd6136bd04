//! The promises of speed: executor step (goal < 2 µs), a million waypoints of a scan through the cursor, preview of two
//! hours (goal < 200 ms).
#![expect(clippy::unwrap_used, reason = "a bench ends where it can't go on")]

#[path = "../tests/common/small.rs"]
mod small;

use aircraft::{Profile, Wind};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use flight_exec::rehearse::{Options, Scenario, Start};
use flight_exec::{AircraftState, Command, Config, Executor, Input, Output, RequestId, Time, preview};
use flight_plan::{Program, compile_document};
use geometry::LatLon;
use std::sync::Arc;
use terrain::{Flat, Terrain};

fn main() {
    divan::main();
}

fn program(legs: &str) -> Arc<Program> {
    let profile = Profile { energy_j: 3e7, ..Profile::default() };
    Arc::new(compile_document(small::document(legs).as_bytes(), &profile, &Flat(300.0)).unwrap())
}

const LOOP: &str = r#"<TF id="a" fix="A"/><iterative id="l" form="reverse" count="1000000"><TF id="b" fix="B"/><TF id="c" fix="C"/></iterative>"#;

struct Flying {
    executor: Executor,
    now: Time,
    out: Vec<Output>,
    at: LatLon,
}

impl Flying {
    fn start(legs: &str) -> Self {
        let executor = Executor::new(Config::default(), Arc::new(Flat(300.0)), Profile::default());
        let at = LatLon::new(36.5, -84.2);
        let mut flying = Self { executor, now: Time::ZERO, out: Vec::new(), at };
        let program = program(legs);
        let hash = program.hash().clone();
        flying.step(Input::Propose {
            request: RequestId(1),
            program,
            based_on: None,
            objections: Vec::new(),
        });
        flying.command(2, Command::Commit { hash, entry: None });
        flying.command(3, Command::Start);
        flying
    }
    fn command(&mut self, request: u64, command: Command) {
        self.step(Input::Command { request: RequestId(request), by: "operator".into(), command });
    }
    fn step(&mut self, input: Input) {
        self.out.clear();
        self.executor.step(self.now, input, &mut self.out);
    }
    fn aircraft(&mut self) {
        self.now += Time::from_millis(100);
        let state = AircraftState {
            position: self.at,
            altitude_amsl_m: 500.0,
            track_deg: 90.0,
            ground_speed_mps: 25.0,
            airspeed_mps: 25.0,
            wind_east_mps: 0.0,
            wind_north_mps: 0.0,
            battery: 1.0,
            fuel: None,
            on_ground: false,
            engine_out: false,
            heading_deg: None,
        };
        self.step(Input::Aircraft(state));
    }
    fn progress(&mut self) {
        let next = self.executor.ahead().nth(1).cloned();
        if let Some(next) = next {
            self.at = next.position;
            self.step(Input::Progress { current: Some(next.token) });
        }
    }
}

/// One report of the aircraft at 10 Hz, reviews of provisional choices included.
#[divan::bench]
fn executor_step_aircraft(bencher: Bencher) {
    let mut flying = Flying::start(LOOP);
    flying.progress();
    bencher.bench_local(|| {
        flying.aircraft();
        black_box(flying.out.len())
    });
}

/// A waypoint flown and the next one laid out, in an endless loop.
#[divan::bench]
fn executor_step_progress(bencher: Bencher) {
    let mut flying = Flying::start(LOOP);
    flying.progress();
    bencher.bench_local(|| {
        flying.progress();
        black_box(flying.out.len())
    });
}

/// A million waypoints of a scan, through the cursor: six times round one of nearly 100,000 tracks, the most a plan may have.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn million_waypoints_of_a_scan(bencher: Bencher) {
    use flight_exec::layout::cursor::{Cursor, Step};
    let scan = r#"<iterative id="l" form="forward" count="6">
        <scan id="s" spacing="0.05" heading="0" overshoot="0"><area fix="A" radius="2490"/></scan></iterative>"#;
    let executor = Flying::start(scan).executor;
    bencher.counter(ItemsCount::new(1_000_000_u64)).bench_local(|| {
        let world = executor.world();
        let mut cursor = Cursor::start(None, executor.here(), 0);
        let mut last = None;
        for _ in 0..1_000_000 {
            match cursor.next(&world) {
                Step::Waypoint(waypoint) => last = Some(waypoint.position),
                _ => break,
            }
        }
        last
    });
}

/// Two hours of loops and turns, flown by the simulated aircraft.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn preview_of_two_hours(bencher: Bencher) {
    let legs = LOOP.replace("1000000", "12");
    let program = program(&legs);
    let profile = Profile { energy_j: 3e7, ..Profile::default() };
    let terrain: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let fly = || {
        let (wind, options) = (Wind::from_direction(250.0, 5.0), Options::default());
        preview(&program, &profile, &terrain, wind, Start::Runway, &Scenario::default(), &options).unwrap()
    };
    println!("previewed flight: {:.0} s, {} waypoints", fly().time_s, fly().waypoints.len());
    bencher.bench_local(fly);
}

/// A plan of two hours with everything that a review looks at: each loop twice, both branches, a zone, the emergency plans.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn review_a_plan_of_two_hours(bencher: Bencher) {
    let plan = include_str!("../../../assets/plans/fire-watch.xml");
    let zone = r#"<zones><keepOut id="z" lat="36.26" lon="-84.10" radius="900"/></zones><mainPlan"#;
    let plan = plan.replace("<mainPlan", zone).replace(r#"count="3""#, r#"count="12""#);
    let profile = Profile { energy_j: 3e7, ..Profile::default() };
    let program = Arc::new(compile_document(plan.as_bytes(), &profile, &Flat(300.0)).unwrap());
    let terrain: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let (start, options) = (Start::Runway, Options::default());
    let planned = preview(&program, &profile, &terrain, Wind::CALM, start, &Scenario::default(), &options);
    println!("reviewed flight: {:.0} s", planned.unwrap().time_s);
    let conditions = flight_exec::Conditions::default();
    bencher.bench_local(|| flight_exec::review(&program, &profile, &terrain, conditions));
}

/// Out and back over many legs, a leg of it. Beside the figure for a tenth of them: a long trail must not cost more than a short one.
#[divan::bench(args = [1_000, 10_000], sample_count = 5, sample_size = 1)]
fn out_and_back_over_legs(bencher: Bencher, legs: usize) {
    let fix = ["A", "B", "C"];
    let body: String = (0..legs).map(|n| format!(r#"<TF id="t{n}" fix="{}"/>"#, fix[n % 3])).collect();
    let plan = format!(r#"<iterative id="l" form="reverse" count="1000000">{body}</iterative>"#);
    let mut flying = Flying::start(&plan);
    bencher.counter(ItemsCount::new(2 * legs)).bench_local(|| (0..2 * legs).for_each(|_| flying.progress()));
}
