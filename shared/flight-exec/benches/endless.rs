//! The promise of memory: an endless loop of everything costs as much after ten million waypoints as after a hundred
//! thousand. Prints what the process holds at each step, and fails if it grows (where the system tells, as Linux does).
#![expect(clippy::expect_used, clippy::panic, reason = "a bench ends where it can't go on")]

use aircraft::Profile;
use flight_exec::{AircraftState, Command, Config, Executor, Input, Output, RequestId, Time};
use flight_plan::compile_document;
use geometry::LatLon;
use std::sync::Arc;
use terrain::Flat;

const PLAN: &str = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="bench" aircraft="trainer">
    <fixes><fix id="A" lat="36.52" lon="-84.18"/><fix id="B" lat="36.55" lon="-84.18"/><fix id="C" lat="36.53" lon="-84.22"/></fixes>
    <runways><runway id="R" lat="36.5" lon="-84.2" elevation="300" heading="90" length="600" priority="1"/></runways>
    <variables><variable name="n" type="number" initial="0"/></variables>
    <mainPlan>
      <stage id="to" type="take-off" runway="R" altitude="100" altitudeReference="agl"/>
      <stage id="m" type="mission" altitude="200" altitudeReference="agl">
        <iterative id="for-ever" form="forward" until="battery &lt; 0.0">
          <TF id="a" fix="A"><action on="start"><set variable="n" to="= n + 1.0"/></action><action every="500"><photo/></action></TF>
          <iterative id="to-and-fro" form="reverse" count="2">
            <TF id="b" fix="B"/>
            <scan id="s" spacing="150" heading="0"><area fix="C" radius="500"/></scan>
          </iterative>
          <intersection id="x" default="on" decideBefore="10s">
            <branch id="on" label="On" next="h"/><branch id="back" label="Back" next="b2" when="n &lt; 0.0"/>
          </intersection>
          <TF id="b2" fix="B"/>
          <HM id="h" fix="C" course="0" turn="right" length="500" maxLaps="2"/>
          <expandingSquare id="q" spacing="300" radius="900" turn="left"><centre fix="B"/></expandingSquare>
        </iterative>
      </stage>
      <stage id="land" type="land" runway="R"/>
    </mainPlan></flightPlan>"#;

fn main() {
    let program = compile_document(PLAN.as_bytes(), &Profile::default(), &Flat(300.0));
    let program = Arc::new(program.unwrap_or_else(|problems| panic!("{problems:?}")));
    let mut executor = Executor::new(Config::default(), Arc::new(Flat(300.0)), Profile::default());
    let mut out: Vec<Output> = Vec::new();
    let hash = program.hash().clone();
    let objections = Vec::new();
    let mut step = |executor: &mut Executor, input| {
        out.clear();
        let now = executor.last_step().unwrap_or_default() + Time::from_millis(100);
        executor.step(now, input, &mut out);
    };
    let command =
        |request, command| Input::Command { request: RequestId(request), by: "operator".into(), command };
    step(&mut executor, Input::Propose { request: RequestId(1), program, based_on: None, objections });
    step(&mut executor, command(2, Command::Commit { hash, entry: None }));
    step(&mut executor, command(3, Command::Start));
    let mut alive = Vec::new();
    for flown in 1..=10_000_000_u64 {
        let next = executor.ahead().nth(1).cloned().expect("an endless plan");
        step(&mut executor, Input::Aircraft(state(next.position)));
        step(&mut executor, Input::Progress { current: Some(next.token) });
        if matches!(flown, 100_000 | 1_000_000 | 10_000_000) {
            alive.push(resident_kb());
            println!("{flown:>9} waypoints: {} kB resident", alive[alive.len() - 1]);
        }
    }
    // a byte a waypoint would be ten thousand; a page or two is the allocator's own business
    assert!(alive.iter().all(|kb| *kb <= alive[0] + 512), "memory grows: {alive:?} kB");
}

/// What the process holds in memory; 0 where nobody tells.
fn resident_kb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmRSS:"));
    line.and_then(|l| l.trim_end_matches("kB").trim().parse().ok()).unwrap_or(0)
}

fn state(position: LatLon) -> AircraftState {
    AircraftState {
        position,
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
    }
}
