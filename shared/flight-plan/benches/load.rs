//! How fast a large plan is read, beside a bare quick-xml pass over the same bytes; then checking it and an expression.

use aircraft::Profile;
use divan::{Bencher, black_box, counter::BytesCount};
use flight_plan::{Edit, Env, FlightState, Variables};
use geometry::LatLon;
use quick_xml::{Reader, events::Event};
use std::fmt::Write;
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrain::Flat;

/// Legs of the large plan.
const LEGS: usize = 50_000;

/// A plan of many tracks of 1 km, to and fro.
fn document(legs: usize) -> String {
    let mut text = String::from(
        r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="Large" aircraft="trainer"><fixes><fix id="A" lat="36.3" lon="-84.2"/></fixes><runways><runway id="R" lat="36.29" lon="-84.2" elevation="300" heading="0" length="600"/></runways><mainPlan emergency="home"><stage id="to" type="take-off" runway="R" altitude="100" altitudeReference="home"/><stage id="s" type="en-route" altitude="500" altitudeReference="amsl">"#,
    );
    for i in 0..legs {
        let lat = 36.3 + 0.005 * (i / 2 % 40) as f64;
        let lon = -84.2 + 0.011 * (i.div_ceil(2) % 2) as f64;
        let _ = writeln!(
            text,
            r#"  <TF id="leg-{i}" name="Track {i}" lat="{lat:.6}" lon="{lon:.6}" speed="24"/>"#
        );
    }
    text + r#"</stage><stage id="l" type="land" runway="R"/></mainPlan><emergencyPlans><emergencyPlan id="home" runway="R"><stage id="h" type="arrival"><DF id="d" fix="A" altitude="450" altitudeReference="amsl"/></stage><stage id="hl" type="land" runway="R"/></emergencyPlan></emergencyPlans></flightPlan>"#
}

/// Every event, and every attribute of every element.
fn bare_pass(text: &str) -> usize {
    let mut reader = Reader::from_str(text);
    let mut attributes = 0;
    loop {
        match reader.read_event() {
            Ok(Event::Start(tag) | Event::Empty(tag)) => {
                attributes += tag.attributes().filter(Result::is_ok).count()
            }
            Ok(Event::Eof) | Err(_) => return attributes,
            Ok(_) => {}
        }
    }
}

#[divan::bench]
fn bare_quick_xml(bencher: Bencher) {
    let text = document(LEGS);
    bencher.counter(BytesCount::of_str(&text)).bench_local(|| bare_pass(black_box(&text)));
}

#[divan::bench]
fn read(bencher: Bencher) {
    let text = document(LEGS);
    bencher.counter(BytesCount::of_str(&text)).bench_local(|| flight_plan::read(black_box(&text)));
}

/// Saving a plan in which every leg was turned around, into the text that it was read from.
#[divan::bench]
fn patch_reversed(bencher: Bencher) {
    let text = document(LEGS);
    let mut plan = flight_plan::read(&text).plan;
    plan.stages.iter_mut().for_each(|stage| stage.legs.reverse());
    let bytes = BytesCount::of_str(&text);
    bencher.counter(bytes).bench_local(|| flight_plan::xml::patch(black_box(&text), &plan));
}

#[divan::bench]
fn write(bencher: Bencher) {
    let plan = flight_plan::read(document(LEGS)).plan;
    bencher.counter(BytesCount::of_str(&document(LEGS))).bench_local(|| flight_plan::write(black_box(&plan)));
}

#[divan::bench(sample_count = 5)]
fn check_50_000_legs(bencher: Bencher) {
    let plan = flight_plan::read(document(LEGS)).plan;
    bencher.bench_local(|| flight_plan::check(black_box(&plan), &Profile::default(), &Flat(300.0)));
}

/// The limit is a second.
#[divan::bench(sample_count = 5)]
fn read_check_and_compile_100_000_legs(bencher: Bencher) {
    let text = document(100_000);
    bencher.bench_local(|| {
        flight_plan::compile_document(black_box(text.as_bytes()), &Profile::default(), &Flat(300.0)).is_ok()
    });
}

/// What an edit costs in a plan of this size, step by step.
const EDITED_LEGS: usize = 10_000;

fn an_edit() -> Edit {
    Edit::MoveWaypoint { leg: "leg-5000".into(), to: LatLon::new(36.41, -84.21) }
}

#[divan::bench]
fn edit_one_of_10_000_legs(bencher: Bencher) {
    let plan = flight_plan::read(document(EDITED_LEGS)).plan;
    bencher.bench_local(|| an_edit().apply(black_box(&plan)));
}

/// From the edit to a program that can be flown in a preview: the limit, with the preview's waypoints, is 10 ms.
#[divan::bench]
fn edit_and_compile_10_000_legs_again(bencher: Bencher) {
    let mut plan = flight_plan::read(document(EDITED_LEGS)).plan;
    let ground = Arc::new(Flat(300.0));
    let (mut memory, mut lat_deg) = (flight_plan::IncrementalCache::new(Profile::default(), ground), 36.41);
    bencher.bench_local(|| {
        lat_deg += 0.00001;
        let edit = Edit::MoveWaypoint { leg: "leg-5000".into(), to: LatLon::new(lat_deg, -84.21) };
        if let Ok(edited) = edit.apply(&plan) {
            plan = edited;
        }
        flight_plan::compile_again(plan.clone(), &mut memory).is_ok()
    });
}

#[divan::bench]
fn check_10_000_legs(bencher: Bencher) {
    let plan = flight_plan::read(document(EDITED_LEGS)).plan;
    bencher.bench_local(|| flight_plan::check(black_box(&plan), &Profile::default(), &Flat(300.0)));
}

#[divan::bench]
fn compile_10_000_legs(bencher: Bencher) {
    let plan = flight_plan::read(document(EDITED_LEGS)).plan;
    bencher
        .with_inputs(|| plan.clone())
        .bench_local_values(|plan| flight_plan::compile(plan, &Profile::default(), &Flat(300.0)).is_ok());
}

#[divan::bench]
fn evaluate_a_condition(bencher: Bencher) {
    let fire_watch = include_bytes!("../../../assets/plans/fire-watch.xml");
    let Ok(program) = flight_plan::compile_document(fire_watch, &Profile::default(), &Flat(300.0)) else {
        return;
    };
    let variables = Variables::initial(&program.plan);
    let env = Env { variables: &variables, flight: FlightState::on_ground(LatLon::new(36.3, -84.2)) };
    bencher.bench_local(|| program.eval_bool(black_box("fire_out || battery < 0.35"), &env));
}

/// The least time of some passes over a document. What they make is thrown away outside of the time.
#[expect(clippy::disallowed_methods, reason = "a bench reads the clock")]
fn timed<T>(pass: impl FnOnce() -> T) -> Duration {
    let start = Instant::now();
    let made = black_box(pass());
    let time = start.elapsed();
    drop(made);
    time
}

/// Every limit over the same bytes, in one line: the ratios hold on any machine.
fn print_ratios() {
    let text = document(LEGS);
    let (profile, ground) = (Profile::default(), Flat(300.0));
    let mut least = [Duration::MAX; 4];
    // by turns, so that a busy machine is busy for all
    for _ in 0..25 {
        let times = [
            timed(|| text.bytes().filter(|byte| *byte == b'<').count()),
            timed(|| bare_pass(&text)),
            timed(|| flight_plan::read(&text)),
            timed(|| flight_plan::compile_document(text.as_bytes(), &profile, &ground)),
        ];
        least.iter_mut().zip(times).for_each(|(least, time)| *least = time.min(*least));
    }
    let mb_per_s = least.map(|time| text.len() as f64 / 1e6 / time.as_secs_f64());
    let [bytes, bare, read, checked] = mb_per_s;
    println!(
        "plan of {:.1} MB, {LEGS} legs: read {read:.0} MB/s, read with every check and compiled {checked:.0} MB/s; \
         bare quick-xml {bare:.0} MB/s, a look at every byte {bytes:.0} MB/s",
        text.len() as f64 / 1e6,
    );
}

fn main() {
    print_ratios();
    divan::main();
}
