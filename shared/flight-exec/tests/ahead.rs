//! A flight under way, and what is ahead of it: changes are held against the rules from where the aircraft is.
#![cfg(test)]

#[path = "common/grid.rs"]
mod grid;

use aircraft::Profile;
use flight_exec::{
    AircraftState, Command, Conditions, Config, Executor, Input, RequestId, Time, compile_and_review_ahead,
    review_ahead, review_command, review_turn,
};
use flight_plan::{Cause, Problem, VariableValue};
use geometry::LatLon;
use grid::{GROUND_M, HOME, compiled, document_with, fix};
use std::sync::Arc;
use terrain::Terrain;

/// Flat, but north of the grid's fourth row, where it rises to 800 m.
struct Ridge;

impl Terrain for Ridge {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        Some(if p.lat_deg > fix("A4").lat_deg - 0.005 { 800.0 } else { GROUND_M })
    }
}

/// A scan whose place is written in flight, in a plan with a zone about D3.
const SCAN: &str = r#"<TF id="a" fix="A1"/><TF id="b" fix="B1"/>
    <scan id="s" spacing="300" heading="90" overshoot="0" altitude="= h" altitudeReference="amsl"><area centre="= c" radius="500"/></scan>
    <TF id="d" fix="C1"/>"#;

fn document(legs: &str, active: &str) -> String {
    let (c, zone) = (fix("B2"), fix("D3"));
    let variables = format!(
        r#"<variable name="c" type="position" initial="{} {}"/><variable name="h" type="number" unit="m" initial="500"/>
           <variable name="seen" type="number" initial="0"/><variable name="shift" type="number" initial="0"/>"#,
        c.lat_deg, c.lon_deg
    );
    let zones = format!(
        r#"</variables><zones><keepOut id="z" lat="{}" lon="{}" radius="1200">{active}</keepOut></zones>"#,
        zone.lat_deg, zone.lon_deg
    );
    document_with(legs, &variables, "").replace("</variables>", &zones)
}

/// A flight by an autopilot that is at once where it is sent.
struct Flight {
    executor: Executor,
    seconds: u64,
    battery: f64,
}

impl Flight {
    /// Started, and flown until it steers to the first waypoint of a leg.
    fn on(leg: &str, document: &str) -> Self {
        let executor = Executor::new(Config::default(), Arc::new(Ridge), Profile::default());
        let mut flight = Self { executor, seconds: 0, battery: 1.0 };
        flight.report(HOME, 300.0, true);
        flight.commit(document);
        flight.command(Command::Start);
        while flight.executor.ahead().next().unwrap().leg.as_str() != leg {
            let next: Vec<_> = flight.executor.ahead().take(2).cloned().collect();
            flight.report(next[0].position, next[0].altitude_amsl_m, false);
            flight.step(Input::Progress { current: next.get(1).map(|w| w.token) });
        }
        flight
    }

    fn step(&mut self, input: Input) {
        self.seconds += 60;
        self.executor.step(Time::from_secs(self.seconds), input, &mut Vec::new());
    }

    fn command(&mut self, command: Command) {
        self.step(Input::Command { request: RequestId(2), by: "operator".into(), command });
    }

    /// Proposes and commits.
    fn commit(&mut self, document: &str) {
        let program = compiled(document).unwrap_or_else(|why| panic!("{why}"));
        let hash = program.hash().clone();
        let (request, based_on, objections) = (RequestId(1), None, Vec::new());
        self.step(Input::Propose { request, program, based_on, objections });
        self.command(Command::Commit { hash: hash.clone(), entry: None });
        assert_eq!(self.executor.program().map(|p| p.hash()), Some(&hash));
    }

    fn report(&mut self, position: LatLon, altitude_amsl_m: f64, on_ground: bool) {
        self.step(Input::Aircraft(AircraftState {
            position,
            altitude_amsl_m,
            track_deg: 90.0,
            ground_speed_mps: 25.0,
            airspeed_mps: 25.0,
            wind_east_mps: 0.0,
            wind_north_mps: 0.0,
            battery: self.battery,
            fuel: None,
            on_ground,
            engine_out: false,
            heading_deg: None,
        }));
    }

    /// The battery runs down to a share.
    fn with_battery(mut self, share: f64) -> Self {
        self.battery = share;
        let here = self.executor.ahead().next().unwrap().clone();
        self.report(here.position, here.altitude_amsl_m, false);
        self
    }

    /// Errors that writing a variable would bring about.
    fn errors_of_writing(&self, name: &str, value: VariableValue) -> Vec<(&'static str, String)> {
        let command = Command::SetVariable { name: name.into(), value };
        assert!(self.executor.changes_what_is_flown(&command), "{name}");
        errors(&review_command(&self.executor, "operator", &command, Conditions::default()))
    }

    /// Errors that keep it from being started.
    fn errors_of_starting(&self) -> Vec<(&'static str, String)> {
        assert!(self.executor.changes_what_is_flown(&Command::Start));
        errors(&review_command(&self.executor, "operator", &Command::Start, Conditions::default()))
    }

    /// Errors that a command brings about which takes effect at once.
    fn errors_after(&mut self, command: Command) -> Vec<(&'static str, String)> {
        let before = self.executor.clone();
        assert!(before.takes_its_own_way(&command) && !before.changes_what_is_flown(&command), "{command:?}");
        self.command(command);
        errors(&review_turn(&before, &self.executor, Conditions::default()))
    }

    /// Errors of a plan that would take over here.
    fn errors_of_plan(&self, document: &str, conditions: Conditions) -> Vec<(&'static str, String)> {
        match compile_and_review_ahead(document.as_bytes(), &self.executor, conditions) {
            Ok(_) => Vec::new(),
            Err(problems) => errors(&problems),
        }
    }
}

/// What lies behind the aircraft when a plan comes in flight, nobody has reviewed: it is, before that is started on the ground.
#[test]
fn plan_that_came_in_flight_is_looked_at_whole_before_it_is_started() {
    let legs =
        |first: &str| format!(r#"<TF id="a" fix="{first}"/><TF id="b" fix="B1"/><TF id="c" fix="C1"/>"#);
    let mut flight = Flight::on("b", &document(&legs("A1"), ""));
    assert!(!flight.executor.changes_what_is_flown(&Command::Start));
    let other = document(&legs("D3"), "");
    assert_eq!(flight.errors_of_plan(&other, Conditions::default()), [], "it is behind");
    flight.commit(&other);
    assert!(!flight.executor.changes_what_is_flown(&Command::Start), "it is refused in the air");
    flight.step(Input::Landed);
    assert_eq!(first(flight.errors_of_starting()), on("keep-out", "a"));
}

/// A start of which nothing came can be given again, and that begins with the plan's own values, not with those it came to.
#[test]
fn plan_that_came_between_two_starts_is_looked_at_whole_before_the_second() {
    let plan = document(SCAN, "");
    let mut flight = Flight::on("to", &plan);
    let [near, in_the_zone] = [fix("B2"), fix("D3")].map(|c| format!("{} {}", c.lat_deg, c.lon_deg));
    let other = plan.replace(&near, &in_the_zone);
    assert_eq!(flight.errors_of_plan(&other, Conditions::default()), NONE, "the value is carried over");
    flight.commit(&other);
    assert_eq!(first(flight.errors_of_starting()), on("keep-out", "s"));
}

fn errors(problems: &[Problem]) -> Vec<(&'static str, String)> {
    let errors = problems.iter().filter(|p| p.is_error());
    errors.map(|p| (p.code, p.subject.as_ref().map(ToString::to_string).unwrap_or_default())).collect()
}

/// The first of them: what follows on the next leg is its consequence.
fn first(errors: Vec<(&'static str, String)>) -> Vec<(&'static str, String)> {
    errors.into_iter().take(1).collect()
}

fn on(code: &'static str, leg: &str) -> Vec<(&'static str, String)> {
    vec![(code, leg.to_owned())]
}

fn at(name: &str) -> VariableValue {
    VariableValue::Position(fix(name))
}

const NONE: [(&str, String); 0] = [];

#[test]
fn a_flight_as_it_goes_on_has_no_problems() {
    for leg in ["to", "a", "b", "s", "d", "land"] {
        let flight = Flight::on(leg, &document(SCAN, ""));
        let found = review_ahead(&flight.executor, Conditions::default());
        assert_eq!(errors(&found), NONE, "on {leg}");
    }
}

#[test]
fn place_written_into_a_zone_or_into_a_hill() {
    for leg in ["b", "s"] {
        let flight = Flight::on(leg, &document(SCAN, ""));
        assert_eq!(flight.errors_of_writing("c", at("C2")), NONE, "{leg}: elsewhere");
        assert_eq!(first(flight.errors_of_writing("c", at("D3"))), on("keep-out", "s"), "{leg}");
        assert_eq!(first(flight.errors_of_writing("c", at("B5"))), on("below-terrain", "s"), "{leg}");
        assert_eq!(
            first(flight.errors_of_writing("h", VariableValue::Number(250.0))),
            on("below-terrain", "s")
        );
    }
}

/// Nothing of what is flown already counts, whatever it would be now.
#[test]
fn place_of_a_leg_that_is_behind() {
    let flight = Flight::on("d", &document(SCAN, ""));
    assert_eq!(flight.errors_of_writing("c", at("D3")), NONE);
}

#[test]
fn value_that_makes_no_path() {
    let legs = SCAN.replace(r#"spacing="300""#, r#"spacing="= 300.0 + shift""#);
    let flight = Flight::on("s", &document(&legs, ""));
    assert_eq!(flight.errors_of_writing("shift", VariableValue::Number(-300.0)), on("leg-not-flyable", "s"));
    let flight = Flight::on("b", &document(&legs, ""));
    assert_eq!(flight.errors_of_writing("shift", VariableValue::Number(-300.0)), on("leg-not-flyable", "s"));
}

/// Round the zone about D3.
const AROUND: &str = r#"<TF id="a" fix="B1"/><TF id="b" fix="C3"/><TF id="c" fix="C1"/><TF id="d" fix="E1"/>
    <TF id="e" fix="E3"/><TF id="f" fix="E1"/>"#;

#[test]
fn straight_way_to_a_leg_through_a_zone_is_told_when_it_is_taken() {
    let go_to = |leg: &str| Command::GoTo { leg: leg.into() };
    let from_c3 = || Flight::on("c", &document(AROUND, ""));
    assert_eq!(errors(&review_ahead(&from_c3().executor, Conditions::default())), NONE);
    assert_eq!(from_c3().errors_after(go_to("e")), on("keep-out", "e"));
    assert_eq!(from_c3().errors_after(go_to("a")), NONE);
    assert_eq!(from_c3().errors_after(Command::SkipLeg), NONE);
    let mut flight = from_c3();
    flight.command(Command::Emergency { cause: Cause::Payload, plan: None });
    assert_eq!(flight.errors_after(Command::ReturnToMain { leg: "e".into() }), on("keep-out", "e"));
    // it was ahead before
    assert_eq!(flight.errors_after(go_to("e")), NONE);
}

#[test]
fn a_leg_skipped_leads_straight_through_a_zone() {
    let mut flight = Flight::on("c", &document(&AROUND.replace(r#"<TF id="d" fix="E1"/>"#, ""), ""));
    assert_eq!(flight.errors_after(Command::SkipLeg), on("keep-out", "e"));
}

#[test]
fn what_is_written_without_a_look() {
    let action = r#"<TF id="d" fix="C1"><action on="start"><set variable="c" to="= offset(c, 90.0, shift)"/></action></TF>"#;
    let legs = SCAN.replace(r#"<TF id="d" fix="C1"/>"#, action);
    let number = |name: &str| Command::SetVariable { name: name.into(), value: VariableValue::Number(1.0) };
    let flight = Flight::on("a", &document(&legs, ""));
    let looked_at = |name| flight.executor.changes_what_is_flown(&number(name));
    assert_eq!(["seen", "h", "c", "shift", "nothing"].map(looked_at), [false, true, true, true, false]);
    assert!(!flight.executor.changes_what_is_flown(&Command::SkipLeg));
    let hash = flight.executor.program().unwrap().hash().clone();
    assert!(flight.executor.changes_what_is_flown(&Command::Commit { hash, entry: None }));
    let idle = Executor::new(Config::default(), Arc::new(Ridge), Profile::default());
    assert!(!idle.changes_what_is_flown(&number("h")));
    assert_eq!(review_ahead(&idle, Conditions::default()), []);
}

/// Nobody can look at what the plan's own actions write when they do: the review before the flight has flown them.
#[test]
fn place_written_by_an_action_of_the_plan_is_looked_at_before_the_flight() {
    let p = fix("D3");
    let into = |lat: f64| {
        let action = format!(
            r#"<action afterDistance="800"><set variable="c" to="= lat_lon({lat}, {})"/></action><area"#,
            p.lon_deg
        );
        let legs = SCAN.replace("<area", &action);
        let program = compiled(&document(&legs, "")).unwrap_or_else(|why| panic!("{why}"));
        let flat: Arc<dyn Terrain> = Arc::new(terrain::Flat(GROUND_M));
        first(errors(&flight_exec::review(&program, &Profile::default(), &flat, Conditions::default())))
    };
    assert_eq!(into(p.lat_deg), on("keep-out", "s"));
    assert_eq!(into(fix("D1").lat_deg), NONE);
}

#[test]
fn energy_that_is_left_counts_and_not_that_of_a_full_battery() {
    let hour = r#"<iterative id="laps" form="forward" count="9"><TF id="l1" fix="E1"/><TF id="l2" fix="F1"/><TF id="l3" fix="F3"/><TF id="l4" fix="C1"/></iterative>"#;
    let longer =
        document(&SCAN.replace(r#"<TF id="d" fix="C1"/>"#, &format!(r#"<TF id="d" fix="C1"/>{hour}"#)), "");
    let full = Flight::on("b", &document(SCAN, ""));
    let full_errors = full.errors_of_plan(&longer, Conditions::default());
    assert_eq!(full_errors, NONE);
    let tired = full.with_battery(0.3);
    let found = tired.errors_of_plan(&longer, Conditions::default());
    assert!(found.iter().any(|(code, _)| *code == "energy"), "{found:?}");
    assert_eq!(tired.errors_of_plan(&document(SCAN, ""), Conditions::default()), NONE);
    let hardly = tired.with_battery(0.03);
    let found = hardly.errors_of_plan(&document(&SCAN.replace("C1", "D1"), ""), Conditions::default());
    assert!(found.iter().any(|(code, _)| *code == "alternate-out-of-reach"), "{found:?}");
}

#[test]
fn time_of_day_counts_from_where_the_aircraft_is() {
    let into = SCAN.replace(r#"fix="C1""#, r#"fix="D3""#);
    let morning = r#"<active from="2026-06-01T06:00:00Z" until="2026-06-01T06:40:00Z"/>"#;
    let flight = Flight::on("b", &document(SCAN, morning));
    let found = |start_unix_s| {
        flight.errors_of_plan(&document(&into, morning), Conditions { start_unix_s, ..Conditions::default() })
    };
    const SIX_O_CLOCK: i64 = 1_780_293_600;
    assert_eq!(first(found(Some(SIX_O_CLOCK))), on("keep-out", "d"));
    assert_eq!(found(Some(SIX_O_CLOCK + 2400)), NONE);
    assert_eq!(first(found(None)), on("keep-out", "d"), "not known: always");
}

/// A plan in the middle of which a value is present that its author never gave it.
#[test]
fn present_values_count_and_not_the_initial_ones() {
    let mut flight = Flight::on("b", &document(SCAN, ""));
    flight.command(Command::SetVariable { name: "h".into(), value: VariableValue::Number(900.0) });
    assert_eq!(flight.errors_of_writing("c", at("C2")), NONE);
    let lower = SCAN.replace("= h", "= h - 400.0").replace(r#"centre="= c""#, &{
        let p = fix("B5");
        format!(r#"lat="{}" lon="{}""#, p.lat_deg, p.lon_deg)
    });
    let found = flight.errors_of_plan(&document(&lower, ""), Conditions::default());
    assert_eq!(first(found), on("below-terrain", "s"));
}

/// Who is in trouble anyway may change something else: what is wrong all the same is not forbidden once more.
#[test]
fn trouble_that_is_there_already_forbids_no_change() {
    let through = SCAN.replace(
        r#"<TF id="b" fix="B1"/>"#,
        r#"<TF id="z1" fix="D3"/><TF id="z2" fix="F3"/><TF id="b" fix="B1"/>"#,
    );
    let flight = Flight::on("z1", &document(&through, ""));
    let now = review_ahead(&flight.executor, Conditions::default());
    assert_eq!(first(errors(&now)), on("keep-out", "z1"));
    assert_eq!(flight.errors_of_writing("c", at("C2")), NONE);
    assert_eq!(first(flight.errors_of_writing("c", at("B5"))), on("below-terrain", "s"));
}

#[test]
fn entry_into_a_plan_without_the_present_leg_is_looked_at_when_it_is_named() {
    let mut flight = Flight::on("b", &document(SCAN, ""));
    let other = document(r#"<TF id="x" fix="D3"/><TF id="y" fix="C1"/>"#, "");
    assert_eq!(flight.errors_of_plan(&other, Conditions::default()), NONE, "nobody knows where it goes on");
    let program = compiled(&other).unwrap();
    let hash = program.hash().clone();
    let (request, based_on, objections) = (RequestId(3), None, Vec::new());
    flight.step(Input::Propose { request, program, based_on, objections });
    let found = |leg: &str| {
        let command = Command::Commit { hash: hash.clone(), entry: Some(leg.into()) };
        errors(&review_command(&flight.executor, "operator", &command, Conditions::default()))
    };
    assert_eq!(first(found("x")), on("keep-out", "x"));
    assert_eq!(found("y"), NONE);
}

/// The flight ahead goes on whatever holds it up now, and with the loops, branches and emergencies that it is in.
#[test]
fn a_flight_that_holds_waits_or_answers_an_emergency_is_looked_at_to_its_end() {
    let d3 = at("D3");
    let mut held = Flight::on("b", &document(SCAN, ""));
    held.command(Command::Hold);
    assert_eq!(first(held.errors_of_writing("c", d3.clone())), on("keep-out", "s"));
    let mut flown_by_the_gateway = Flight::on("b", &document(SCAN, ""));
    flown_by_the_gateway.step(Input::GatewayControls(true));
    assert_eq!(first(flown_by_the_gateway.errors_of_writing("c", d3.clone())), on("keep-out", "s"));
    let fork = format!(
        r#"<TF id="f" fix="B0"/><intersection id="x" decideBefore="60s"><branch id="x1" label="1" next="a"/><branch id="x2" label="2" next="e"/></intersection>
           {SCAN}<TF id="e" fix="C2"/>"#
    );
    let waits = Flight::on("f", &document(&fork, ""));
    assert_eq!(
        first(waits.errors_of_writing("c", d3.clone())),
        on("keep-out", "s"),
        "by way of one of its branches"
    );
    let laps = format!(r#"<iterative id="loop" form="forward" count="6">{SCAN}</iterative>"#);
    let looping = Flight::on("d", &document(&laps, ""));
    assert_eq!(first(looping.errors_of_writing("c", d3.clone())), on("keep-out", "s"), "on its next pass");
    let mut homeward = Flight::on("b", &document(SCAN, ""));
    homeward.command(Command::Emergency { cause: flight_plan::Cause::Energy, plan: None });
    assert_eq!(homeward.errors_of_writing("c", d3), NONE, "there it doesn't go any more");
}

/// The gateway judges the first waypoint from where the aircraft is: so does the review.
#[test]
fn a_plan_that_leads_straight_to_where_the_gateway_refuses_to_go() {
    let direct = |to: LatLon| {
        let legs = format!(
            r#"<TF id="a" fix="A1"/><DF id="b" lat="{}" lon="{}"/><TF id="c" fix="C1"/>"#,
            to.lat_deg, to.lon_deg
        );
        document(&legs, "")
    };
    let flight = Flight::on("b", &direct(fix("B1")));
    assert_eq!(flight.errors_of_plan(&direct(fix("B2")), Conditions::default()), NONE);
    let far = direct(fix("B1").destination(180.0, 60_000.0));
    let found = flight.errors_of_plan(&far, Conditions::default());
    assert!(found.contains(&("gateway-refuses", "b".to_owned())), "{found:?}");
}
