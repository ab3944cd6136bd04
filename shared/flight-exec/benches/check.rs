//! What `legwork check` does to the largest plans, beside a bare quick-xml pass over the same bytes: half a million legs that are all
//! in the ground, and sixty variables whose bounds are tried among a thousand zones. Ratios hold on any machine; times don't.
#![expect(clippy::panic, reason = "a bench ends where it can't go on")]

use aircraft::Profile;
use flight_exec::{Conditions, review, review_extremes};
use flight_plan::{Problem, compile_document};
use quick_xml::{Reader, events::Event};
use std::fmt::Write;
use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrain::{Flat, Terrain};

/// Height of the ground, metres AMSL.
const GROUND_M: f64 = 300.0;
/// Legs of the long plan: as many as a plan may have, nearly.
const LEGS: usize = 499_000;
/// Variables of the other one.
const VARIABLES: usize = 60;
/// Its zones.
const ZONES: usize = 1000;
/// The least time of so many passes counts.
const PASSES: usize = 5;

fn main() {
    compare(&format!("{LEGS} legs in the ground"), &long(LEGS));
    let without_zones = compare(&format!("{VARIABLES} variables, no zone"), &wide(0));
    let with_zones = compare(&format!("{VARIABLES} variables, {ZONES} zones"), &wide(ZONES));
    println!("{ZONES} zones make the check {:.1} times as long", with_zones / without_zones);
}

/// Prints a check beside its limit; gives its time, seconds.
fn compare(what: &str, document: &str) -> f64 {
    let mut least = [Duration::MAX; 2];
    let mut problems = 0;
    // by turns, so that a busy machine is busy for both
    for _ in 0..PASSES {
        let bare = timed(|| bare_pass(document)).0;
        let (checked, found) = timed(|| check(document));
        problems = found;
        least = [least[0].min(bare), least[1].min(checked)];
    }
    let [bare_s, checked_s] = least.map(|time| time.as_secs_f64());
    println!(
        "{what}: {:.1} MB, {problems} problems, checked in {:.1} times a bare quick-xml pass ({bare_s:.3} s)",
        document.len() as f64 / 1e6,
        checked_s / bare_s,
    );
    checked_s
}

#[expect(clippy::disallowed_methods, reason = "a bench reads the clock")]
fn timed<T>(pass: impl FnOnce() -> T) -> (Duration, T) {
    let start = Instant::now();
    let made = black_box(pass());
    (start.elapsed(), made)
}

/// Every event, and every attribute of every element.
fn bare_pass(text: &str) -> usize {
    let mut reader = Reader::from_str(text);
    let mut attributes = 0;
    loop {
        match reader.read_event() {
            Ok(Event::Start(tag) | Event::Empty(tag)) => {
                attributes += tag.attributes().filter(Result::is_ok).count();
            }
            Ok(Event::Eof) | Err(_) => return attributes,
            Ok(_) => {}
        }
    }
}

/// The whole check; gives how many problems it found.
fn check(document: &str) -> usize {
    let (profile, ground) = (Profile::default(), Arc::new(Flat(GROUND_M)) as Arc<dyn Terrain>);
    let program = match compile_document(document.as_bytes(), &profile, ground.as_ref()) {
        Ok(program) => Arc::new(program),
        Err(problems) => return problems.iter().filter(|problem| is_expected(problem)).count(),
    };
    let found = review(&program, &profile, &ground, Conditions::default());
    let go_on = &mut |_, _| true;
    let more = review_extremes(&program, &profile, &ground, Conditions::default(), &found, go_on);
    program.warnings.len() + found.len() + more.len()
}

/// Anything else would make the check shorter than it is.
fn is_expected(problem: &Problem) -> bool {
    if problem.is_error() && !["below-terrain", "too-steep"].contains(&problem.code) {
        panic!("the plan is not as it is meant: {problem}");
    }
    true
}

/// Tracks of a kilometre, to and fro, 200 m under the ground.
fn long(legs: usize) -> String {
    let mut text = String::new();
    for i in 0..legs {
        let lat = 36.35 + 0.005 * (i / 2 % 40) as f64;
        let lon = -84.2 + 0.011 * (i.div_ceil(2) % 2) as f64;
        let _ = writeln!(text, r#"<TF id="leg-{i}" lat="{lat:.6}" lon="{lon:.6}"/>"#);
    }
    plan("", "100", &text)
}

/// Legs whose altitudes are variables, and zones to keep out of around them.
fn wide(zones: usize) -> String {
    let (mut head, mut legs) = (String::from("<zones>"), String::new());
    for i in 0..zones {
        let (lat, lon) = (36.3 + 0.01 * (i / 32) as f64, -84.15 + 0.01 * (i % 32) as f64);
        let _ = writeln!(head, r#"<keepOut id="z{i}" lat="{lat:.6}" lon="{lon:.6}" radius="300"/>"#);
    }
    head += "</zones><variables>";
    for i in 0..VARIABLES {
        let _ = writeln!(head, r#"<variable name="v{i}" type="number" initial="500" min="480" max="520"/>"#);
        let (lat, lon) = (36.35 + 0.01 * (i / 2) as f64, -84.2 + 0.02 * (i.div_ceil(2) % 2) as f64);
        let _ = writeln!(
            legs,
            r#"<TF id="leg-{i}" lat="{lat:.6}" lon="{lon:.6}" altitude="= v{i}" altitudeReference="amsl"/>"#
        );
    }
    plan(&(head + "</variables>"), "500", &legs)
}

fn plan(head: &str, altitude: &str, legs: &str) -> String {
    format!(
        r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="large" aircraft="trainer">
        <runways><runway id="R" lat="36.29" lon="-84.2" elevation="300" heading="0" length="600"/></runways>{head}
        <mainPlan><stage id="to" type="take-off" runway="R" altitude="100" altitudeReference="home"/>
        <stage id="s" type="en-route" altitude="{altitude}" altitudeReference="amsl">{legs}</stage>
        <stage id="l" type="land" runway="R"/></mainPlan></flightPlan>"#
    )
}
