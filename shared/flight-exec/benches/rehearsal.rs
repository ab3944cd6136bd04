//! The promise of editing: one edit in a plan of 10,000 legs to fresh preview waypoints in less than 10 ms, beside the whole
//! preview that it saves.
#![expect(clippy::unwrap_used, reason = "a bench ends where it can't go on")]

use aircraft::{Profile, Wind};
use divan::Bencher;
use flight_exec::rehearse::{Options, Rehearsal, Scenario, Start, preview};
use flight_plan::{Edit, FlightPlan, IncrementalCache, compile, compile_again};
use geometry::LatLon;
use std::sync::Arc;
use terrain::{Flat, Terrain};

const LEGS: [usize; 3] = [1_000, 10_000, 30_000];

fn main() {
    divan::main();
}

/// Turns of seventy degrees, three hundred metres apart, in a square spiral of such zigzags.
fn plan(legs: usize) -> FlightPlan {
    let mut at = LatLon::new(36.52, -84.18);
    let (mut fixes, mut list) = (String::new(), String::new());
    for i in 0..legs {
        let side_deg = 90.0 * ((i / 500) % 4) as f64;
        at = at.destination(side_deg + if i % 2 == 0 { 35.0 } else { -35.0 }, 300.0);
        fixes += &format!(r#"<fix id="F{i}" lat="{}" lon="{}"/>"#, at.lat_deg, at.lon_deg);
        list += &format!(r#"<TF id="l{i}" fix="F{i}"/>"#);
    }
    let text = format!(
        r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="bench" aircraft="trainer"><fixes>{fixes}</fixes>
        <runways><runway id="R" lat="36.5" lon="-84.2" elevation="300" heading="90" length="600" priority="1"/></runways>
        <mainPlan><stage id="to" type="take-off" runway="R" altitude="100" altitudeReference="agl"/>
          <stage id="m" type="mission" altitude="200" altitudeReference="agl">{list}</stage>
          <stage id="land" type="land" runway="R"/></mainPlan></flightPlan>"#
    );
    let reading = flight_plan::read(text.as_bytes());
    assert!(!reading.has_errors());
    reading.plan
}

struct Bench {
    profile: Profile,
    terrain: Arc<dyn Terrain>,
    options: Options,
    plan: Arc<FlightPlan>,
}

impl Bench {
    fn new(legs: usize) -> Self {
        let profile = Profile { energy_j: 3e9, ..Profile::default() };
        let options = Options { most_s: 1e6, ..Options::default() };
        Self { profile, terrain: Arc::new(Flat(300.0)), options, plan: Arc::new(plan(legs)) }
    }

    fn rehearsal(&self) -> Rehearsal {
        Rehearsal::new(self.profile.clone(), self.terrain.clone(), Wind::CALM, self.options.clone())
    }

    /// The plan with a fix in its middle moved.
    fn moved(&self, number: usize) -> FlightPlan {
        let fix = &self.plan.fixes[self.plan.fixes.len() / 2];
        let to = fix.position.destination(20.0 * number as f64, 30.0);
        Edit::MoveFix { fix: fix.id.clone(), to }.apply(&self.plan).unwrap()
    }
}

#[divan::bench(args = LEGS, sample_count = 3, sample_size = 1)]
fn whole_preview(bencher: Bencher, legs: usize) {
    let bench = Bench::new(legs);
    let program = Arc::new(compile(bench.plan.clone(), &bench.profile, &Flat(300.0)).unwrap());
    bencher.bench_local(|| {
        let (scenario, options, start) = (Scenario::default(), &bench.options, Start::Runway);
        preview(&program, &bench.profile, &bench.terrain, Wind::CALM, start, &scenario, options).unwrap()
    });
}

/// What the above takes when a fix of the program has moved.
#[divan::bench(args = LEGS, sample_count = 100, sample_size = 1)]
fn preview_after_one_edit(bencher: Bencher, legs: usize) {
    let bench = Bench::new(legs);
    let mut memory = IncrementalCache::new(bench.profile.clone(), bench.terrain.clone());
    let mut compiled = |plan: FlightPlan| Arc::new(compile_again(plan, &mut memory).unwrap());
    let programs = [compiled(bench.moved(1)), compiled(bench.moved(2))];
    let mut rehearsal = bench.rehearsal();
    rehearsal.fly(&programs[0], Start::Runway, &mut |_| true).unwrap();
    let mut turn = 0;
    bencher.bench_local(|| {
        turn += 1;
        rehearsal.fly(&programs[turn % 2], Start::Runway, &mut |_| true).unwrap();
        rehearsal.preview().unwrap().waypoints.len()
    });
}

/// The promise: a fix is moved, the plan is checked and compiled, and flown as far as that changes anything.
#[divan::bench(args = LEGS, sample_count = 100, sample_size = 1)]
fn edit_to_preview_waypoints(bencher: Bencher, legs: usize) {
    let bench = Bench::new(legs);
    let mut memory = IncrementalCache::new(bench.profile.clone(), bench.terrain.clone());
    let mut rehearsal = bench.rehearsal();
    let mut turn = 0;
    let mut edit = || {
        turn += 1;
        let program = Arc::new(compile_again(bench.moved(turn), &mut memory).unwrap());
        rehearsal.fly(&program, Start::Runway, &mut |_| true).unwrap();
        rehearsal.preview().unwrap().waypoints.len()
    };
    edit();
    bencher.bench_local(edit);
}
