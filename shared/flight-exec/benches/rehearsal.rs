//! The promise of editing: one edit in a plan of 10,000 legs to fresh preview waypoints in less than 10 ms, beside the whole
//! preview that it saves. What checking and compiling again takes is measured by `flight-plan`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use aircraft::{Profile, Wind};
use divan::Bencher;
use flight_exec::preview::{Options, Rehearsal, Scenario, Start, preview};
use flight_plan::{Edit, FlightPlan, Program, compile};
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
    /// The plan, and the same with a fix in its middle moved.
    programs: [Arc<Program>; 2],
}

impl Bench {
    fn new(legs: usize) -> Self {
        let profile = Profile { energy_j: 3e9, ..Profile::default() };
        let options = Options { most_s: 1e6, ..Options::default() };
        let plan = plan(legs);
        let fix = &plan.fixes[legs / 2];
        let edit = Edit::MoveFix { fix: fix.id.clone(), to: fix.position.destination(20.0, 30.0) };
        let programs = [plan.clone(), edit.apply(&plan).unwrap()]
            .map(|plan| Arc::new(compile(plan, &profile, &Flat(300.0)).unwrap()));
        Self { profile, terrain: Arc::new(Flat(300.0)), options, programs }
    }
}

#[divan::bench(args = LEGS, sample_count = 3, sample_size = 1)]
fn whole_preview(bencher: Bencher, legs: usize) {
    let bench = Bench::new(legs);
    bencher.bench_local(|| {
        let (scenario, options) = (Scenario::default(), &bench.options);
        preview(
            &bench.programs[0],
            &bench.profile,
            &bench.terrain,
            Wind::CALM,
            Start::Runway,
            &scenario,
            options,
        )
        .unwrap()
    });
}

/// A fix is moved, and moved back.
#[divan::bench(args = LEGS, sample_count = 100, sample_size = 1)]
fn preview_after_one_edit(bencher: Bencher, legs: usize) {
    let bench = Bench::new(legs);
    let Bench { profile, terrain, options, .. } = &bench;
    let mut rehearsal = Rehearsal::new(profile.clone(), terrain.clone(), Wind::CALM, options.clone());
    rehearsal.fly(&bench.programs[0], Start::Runway, &mut |_| true).unwrap();
    let mut turn = 0;
    bencher.bench_local(|| {
        turn += 1;
        rehearsal.fly(&bench.programs[turn % 2], Start::Runway, &mut |_| true).unwrap();
        rehearsal.preview().unwrap().waypoints.len()
    });
}
