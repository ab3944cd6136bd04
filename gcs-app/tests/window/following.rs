//! The profile of a flight shows what is flown: the preview, or the way that the vehicle tells.

use super::Window;
use super::considering::foresight;
use super::emergency::raised;
use super::flying::{flying, flying_its_plan};
use super::vehicle::{engine_out, place, position};
use egui_kittest::kittest::{NodeT, Queryable};
use flight_exec::{Command, Foresight, PathPoint};
use gcs_app::link::{Call, Reply, Telemetry};
use gcs_app::state::Ticket;
use geometry::LatLon;
use usal::contract::{Action, Ahead, GatewayState, Stamped, Token, Waypoint};

const PREVIEW: &str = "Vertical profile from now: ";
const TOLD: &str = "Vertical profile from now, as it is flown: ";

fn waypoint(leg: &str, position: LatLon) -> Waypoint {
    Waypoint {
        token: Token(7),
        position,
        altitude_amsl_m: 500.0,
        airspeed_mps: 25.0,
        action: Action::Fly,
        fly_over: false,
        on_arc: false,
        leg: leg.into(),
        end_of_plan: false,
    }
}

impl Window {
    /// What it has next, on this leg; and it is at this place, going along side2.
    fn receive_course(&mut self, leg: &str, at: LatLon) {
        self.receive_at(2.0, at, 142.0);
        self.receive_next(leg, at);
    }

    fn receive_at(&mut self, time_s: f64, at: LatLon, track_deg: f64) {
        let Telemetry::Position(mut here) = position(time_s, 500.0, false) else { unreachable!() };
        (here.value.position, here.value.track_deg) = (at, track_deg);
        self.receive(Telemetry::Position(here));
    }

    fn receive_next(&mut self, leg: &str, at: LatLon) {
        let value = Ahead { waypoints: vec![waypoint(leg, at.destination(0.0, 300.0))] };
        self.receive(Telemetry::Ahead(Stamped { time_s: 2.0, validity_s: 5.0, value }));
        // it is looked at a few times a second
        self.steps(20);
    }

    /// The question which way it flies.
    fn asked_which_way(&mut self) -> Option<Ticket> {
        std::iter::from_fn(|| self.asked()).find_map(|(t, call)| (call == Call::Foresee(None)).then_some(t))
    }
}

/// Halfway from A to B, on side2.
fn on_side2() -> LatLon {
    LatLon::new(36.3241, -84.1567)
}

#[test]
fn profile_follows_the_preview_while_the_aircraft_does() {
    let (mut window, _) = flying();
    window.receive_course("side3", on_side2());
    assert!(window.shows(PREVIEW) && window.asked_which_way().is_none());
}

#[test]
fn on_the_way_to_a_leg_or_on_another_branch_the_profile_shows_the_way_that_the_vehicle_tells() {
    let far = on_side2().destination(90.0, 3000.0);
    for (leg, at) in [("side2", far), ("another branch", on_side2())] {
        let (mut window, _) = flying();
        window.receive_course(leg, at);
        let ticket = window.asked_which_way().unwrap();
        assert!(!window.shows(PREVIEW), "that is not what is flown");
        window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
        assert!(window.shows(TOLD), "{leg}");
        window.click("Whole flight");
        assert!(window.shows("Vertical profile: "));
        window.click("Whole flight");
        window.receive_course("side3", on_side2());
        assert!(window.shows(PREVIEW), "it is back on the preview");
    }
}

/// While it flew out along the final, the profile was that of the way in: 101 m above the runway it stood on the ground, 0 s before the
/// end.
#[test]
fn on_the_way_out_to_the_final_the_profile_is_that_of_the_way_out() {
    let threshold = LatLon::new(36.3190, -84.1730);
    let out = |out_m: f64| threshold.destination(232.0, out_m);
    let (mut window, mut value) = flying();
    value.place = Some(place("land", "land"));
    window.receive_status(value);
    window.receive_at(2.0, out(700.0), 232.0);
    window.receive_next("land", out(1400.0));
    let ticket = window.asked_which_way().unwrap();
    assert!(!window.shows(PREVIEW), "the preview lands from there");
    let point = |time_s, position| PathPoint { time_s, position, altitude_amsl_m: 450.0 };
    // beside the way in
    let outbound = [out(700.0), out(1700.0)].map(|at| at.destination(142.0, 30.0));
    let path = vec![
        point(0.0, outbound[0]),
        point(40.0, outbound[1]),
        point(50.0, out(1700.0)),
        point(118.0, threshold),
    ];
    window.answer(ticket, Ok(Reply::Foresight(Box::new(Foresight { path, ..foresight() }))));
    window.receive_at(32.0, out(1400.0), 232.0);
    window.steps(20);
    let left = |window: &Window| {
        let shown = window.harness.get_by_label_contains(TOLD).accesskit_node().label().unwrap();
        shown.rsplit(' ').next().unwrap().to_owned()
    };
    assert!(["1:29", "1:30"].contains(&left(&window).as_str()), "{}: it flies out still", left(&window));
    window.receive_at(62.0, out(1400.0), 52.0);
    window.steps(20);
    assert!(window.shows(PREVIEW), "now it is on the final");
}

#[test]
fn after_a_command_the_way_is_asked_for_anew_at_once() {
    let mut window = flying_its_plan();
    window.receive_course("side2", on_side2().destination(90.0, 3000.0));
    let ticket = window.asked_which_way().unwrap();
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    window.click("⏸ Hold");
    let (ticket, call) = window.asked().unwrap();
    assert_eq!(call, Call::Plan(Command::Hold));
    window.answer(ticket, Ok(Reply::Done));
    assert!(window.asked_which_way().is_some() && !window.shows(TOLD), "what was told is of before");
}

/// It showed a level flight, then a climb, up to a runway that was out of reach.
#[test]
fn a_glide_that_ends_before_the_runway_says_so_in_profile_and_banner_and_no_landing() {
    let (mut window, ticket) = raised();
    let end = "without its engine it comes down 870 m from runway";
    let short = Foresight { landed: false, cut_short: Some(format!("{end} `R05`")), ..foresight() };
    window.answer(ticket, Ok(Reply::Foresight(Box::new(short))));
    window.steps(30);
    assert!(window.shows(TOLD) && window.shows(&format!("Emergency: return: {end}")));
    assert!(window.shows(&format!("EMERGENCY: flying return, {end}")) && !window.shows("to runway R05"));
}

/// The way that was told with an engine is not flown any more.
#[test]
fn when_the_engine_stops_the_way_is_asked_for_anew_at_once() {
    let (mut window, ticket) = raised();
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    window.steps(30);
    assert!(window.shows(TOLD) && window.asked_which_way().is_none());
    window.receive_gateway(vec![engine_out()]);
    window.steps(30);
    assert!(window.asked_which_way().is_some() && !window.shows(TOLD));
}

/// It showed the survey that would be flown after it, for 17 minutes, 18 m above the ground.
#[test]
fn in_safe_mode_neither_profile_nor_map_shows_the_plan_as_what_is_flown() {
    let p = gcs_app::theme::palette(true);
    let (mut window, _) = flying();
    window.receive_course("side2", on_side2().destination(90.0, 600.0));
    let ticket = window.asked_which_way().unwrap();
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    let ahead = window.lines_within("Map", p.active);
    assert!(window.shows(TOLD) && ahead > 0);
    window.receive_gateway_state(GatewayState::SafeReturn);
    window.steps(20);
    assert!(window.shows("Vertical profile: Safe mode: for the test. Which way it flies is not told"));
    assert!(!window.shows(TOLD) && window.lines_within("Map", p.active) < ahead);
    window.click("Whole flight");
    assert!(window.shows("Vertical profile: ") && !window.shows("is not told"));
}

#[test]
fn profile_of_an_emergency_is_that_of_its_plan() {
    let (mut window, ticket) = raised();
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    // it is looked at a few times a second
    window.steps(30);
    assert!(window.shows(TOLD));
    assert!(window.shows("Emergency: return, as it is flown"));
}
