//! An emergency plan that is being flown.

use super::considering::foresight;
use super::flying::{connected, fly_its_plan, flying, flying_its_plan, navigation};
use super::vehicle::{engine_out, gateway_status, place, position, status};
use super::{SQUARE, Window};
use egui_kittest::kittest::Queryable;
use flight_exec::{Branching, Command, Event, Foresight, PathPoint, Phase};
use flight_plan::Cause;
use gcs_app::link::{Call, LinkEvent, Numbered, Reply, Telemetry};
use gcs_app::state::{ActivePlan, Ticket};
use geometry::LatLon;
use std::sync::Arc;
use usal::contract::{GatewayEvent, GatewayState, GatewayStatus, Navigation, Position, Stamped};

const START: &str = "Start and take off with the plan aboard (hold)";

/// Flying the emergency plan of the square; when it lands is not known.
pub fn in_emergency() -> Window {
    let (mut window, landing) = raised();
    window.answer(landing, Err("it is not known".into()));
    window.leave_open();
    window
}

/// It was raised on side3 because of the engine; the ticket of the question when it lands.
pub fn raised() -> (Window, Ticket) {
    raised_for(Cause::Engine)
}

fn raised_for(cause: Cause) -> (Window, Ticket) {
    let (mut window, mut value) = flying();
    let plan = Arc::new(flight_plan::read(SQUARE.as_bytes()).plan);
    let hash = Arc::<str>::from("the plan that is aboard");
    value.plan = Some(hash.clone());
    value.emergency = Some("return".into());
    value.place = Some(place("r-arrival", "r1"));
    if let Some(place) = &mut value.place {
        place.plan = Branching::Emergency("return".into());
    }
    window.steps(60 * 4);
    window.receive_position(false);
    window.receive_status(value);
    let asked: Vec<_> = std::iter::from_fn(|| window.asked()).collect();
    let ticket_of = |wanted: Call| asked.iter().find(|(_, call)| *call == wanted).unwrap().0;
    let (ticket, landing) = (ticket_of(Call::PlanAboard), ticket_of(Call::Foresee(None)));
    window.answer(ticket, Ok(Reply::Plan(Some(ActivePlan { hash, plan }))));
    let started = Event::EmergencyStarted { cause, plan: "return".into(), from_leg: Some("side3".into()) };
    let event = Stamped { time_s: 3.0, validity_s: f64::MAX, value: started };
    window.send(LinkEvent::Telemetry(Telemetry::PlanEvent(Numbered { sequence: 1, event })));
    (window, landing)
}

#[test]
fn banner_says_which_plan_why_where_to_and_the_way_back() {
    let (mut window, ticket) = raised_for(Cause::Link);
    for text in ["EMERGENCY: flying", "because the link was lost", "to runway R05"] {
        assert!(window.shows(text), "{text}");
    }
    assert!(window.shows("Arrival ▸ r1"), "the stage has no name, but a kind");
    assert!(
        window.shows("Emergency: flying return")
            && !window.shows("(hold)")
            && !window.shows("Emergency: fly return")
    );
    assert!(
        window.paints("Emergency: flying return") && !window.paints("returnhold\u{a0}1"),
        "it asks for nothing"
    );
    window.answer(ticket, Ok(Reply::Foresight(Box::new(gliding()))));
    window.steps(20);
    assert!(window.shows("touches down in 5:00"));
    window.steps(60 * 3);
    assert!(window.shows("EMERGENCY: flying") && !window.shows("touches down"), "it is no longer heard");
    window.click("Return to the main plan at side3");
    let back = Command::ReturnToMain { leg: "side3".into() };
    let (ticket, call) = window.asked().unwrap();
    assert_eq!(call, Call::Foresee(Some(back)));
    let without_landing = Foresight { left_out: vec!["r-land".into()], ..foresight() };
    window.answer(ticket, Ok(Reply::Foresight(Box::new(without_landing))));
    assert!(window.shows("Left out of return: Landing"), "not by its identifier, nor as the main plan's");
    assert!(window.shows("Left out: nothing"));
}

/// Five minutes down to the runway, then it rolls out.
fn gliding() -> Foresight {
    let point = |i: i32| PathPoint {
        time_s: 20.0 * f64::from(i),
        position: THRESHOLD.destination(90.0, 400.0 * f64::from(i)),
        altitude_amsl_m: 349.0 + 10.0 * f64::from((15 - i).max(0)),
    };
    Foresight { path: (0..20).map(point).collect(), ..foresight() }
}

/// The banner said 1:42 and counted by a clock, the profile 1:06, and it touched down after 1:08.
#[test]
fn banner_profile_and_panel_say_the_same_touch_down_by_where_the_aircraft_is() {
    let (mut window, ticket) = raised();
    window.answer(ticket, Ok(Reply::Foresight(Box::new(gliding()))));
    window.steps(20);
    for (time_s, along_m, left) in [(61.0, 2000.0, "3:20"), (181.0, 4000.0, "1:40"), (221.0, 4000.0, "1:40")]
    {
        let Telemetry::Position(mut here) = position(time_s, 500.0, false) else { unreachable!() };
        here.value.position = THRESHOLD.destination(90.0, along_m);
        here.value.track_deg = 90.0;
        window.receive(Telemetry::Position(here));
        window.steps(20);
        assert!(window.shows(&format!("touches down in {left}")), "{left}");
        assert!(window.shows(&format!("as it is flown: {} in {left}", km(6000.0 - along_m))), "{left}");
    }
}

fn km(metres: f64) -> String {
    format!("{:.1} km", metres / 1000.0)
}

/// Only Safe mode said so.
#[test]
fn banner_says_that_a_landing_is_from_the_runways_other_end() {
    for (course_deg, said) in
        [(52.0, "to runway R05, because"), (232.0, "to runway R05, from its other end, because")]
    {
        let (mut window, ticket) = raised();
        let out_m = |n: i32| 400.0 - 100.0 * f64::from(n);
        let at = |n| THRESHOLD.destination(52.0, 200.0).destination(course_deg + 180.0, out_m(n));
        let path =
            (0..5).map(|n| PathPoint { time_s: f64::from(n), position: at(n), altitude_amsl_m: 349.0 });
        let foresight = Foresight { path: path.collect(), ..foresight() };
        window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight))));
        window.steps(30);
        assert!(window.shows(said), "{course_deg}");
    }
}

/// It is not that plan that is flown then: a time would be of another flight.
#[test]
fn banner_says_who_leads_the_aircraft_and_no_time_of_another_flight() {
    let (mut window, ticket) = raised();
    window.answer(ticket, Ok(Reply::Foresight(Box::new(gliding()))));
    window.steps(20);
    assert!(
        window.shows("EMERGENCY: flying return, touches down in 5:00"),
        "the glide is foreseen without the engine"
    );
    for (state, cause, said) in [
        (GatewayState::SafeReturn, "gliding to runway R05", "EMERGENCY: Safe mode: gliding to runway R05"),
        (GatewayState::Manual, "the pilot has it", "EMERGENCY: not in command: the pilot has it"),
    ] {
        let value = GatewayStatus { cause: cause.into(), ..gateway_status(state) };
        window.receive(Telemetry::Gateway(Stamped { time_s: 4.0, validity_s: 2.0, value }.into()));
        assert!(
            window.shows(said) && !window.shows("EMERGENCY: flying") && !window.shows("touches down"),
            "{said}"
        );
        let button = ["Emergency: fly the", "Emergency: flying"].map(|label| window.shows(label));
        assert_eq!(button, [true, false], "the button says no more than the banner");
    }
}

/// Who is about to press something presses that: the banner has its room before.
#[test]
fn nothing_moves_when_an_emergency_begins_and_its_red_banner_changes() {
    for size in [egui::vec2(960.0, 600.0), egui::vec2(1280.0, 800.0)] {
        let (mut window, mut value) = flying();
        window.harness.set_size(size);
        value.emergency_in_force = Some("return".into());
        window.receive_status(value.clone());
        assert!(window.shows("Flying circuit ▸ side2 · alternate: return"), "the plan aboard is not known");
        let where_it_is = |window: &Window| {
            let display = window.harness.get_by_label_contains("Primary flight display").rect();
            let others = ["Map", "Zoom in", "⏸ Hold", "⏭ Skip leg", "TF side3", "Hide Flight"]
                .map(|label| window.harness.get_by_label(label).rect());
            (display, others)
        };
        let before = where_it_is(&window);
        value.emergency = Some("return".into());
        window.receive_status(value);
        assert_eq!(where_it_is(&window), before);
        let p = gcs_app::theme::palette(true);
        let words = window.harness.get_by_label_contains("EMERGENCY: flying return").rect();
        assert_eq!(window.fill_around(words), Some(p.warning), "it is red");
        for label in ["⏸ Hold", "Emergency: flying return"] {
            assert!(window.is_enabled(label), "{label}");
        }
    }
}

/// For seconds nothing moves after the start, and who is impatient holds the same place once more.
#[test]
fn no_emergency_comes_where_the_start_was_held_and_none_is_armed_before_it_flies() {
    for size in [egui::vec2(960.0, 600.0), egui::vec2(1280.0, 800.0)] {
        let (mut window, hash) = connected();
        window.harness.set_size(size);
        let mut value = status(Phase::Idle);
        (value.plan, value.emergency_in_force) = (Some(hash.into()), Some("return".into()));
        window.receive_status(value.clone());
        let emergency = "Emergency: fly return (hold)";
        let start = window.harness.get_by_label("Start and take off (hold)").rect();
        window.leave_open();
        window.harness.hover_at(window.centre(emergency));
        window.steps(60);
        assert!(window.shows("The aircraft is on the ground"), "why it can't be pressed");
        window.hold("Start and take off (hold)", 90);
        assert_eq!(window.asked().map(|(_, call)| call), Some(Call::Plan(Command::Start)));
        (value.phase, value.place) = (Phase::Flying, Some(place("departure", "climb")));
        for (state, on_ground) in
            [(GatewayState::Stop, true), (GatewayState::TakeOff, true), (GatewayState::TakeOff, false)]
        {
            window.receive_status(value.clone());
            window.receive_gateway_state(state);
            window.receive_position(on_ground);
            assert_eq!(window.is_enabled(emergency), !on_ground, "{state:?}");
            let there = window.harness.get_by_label(emergency).rect();
            assert!(!there.intersects(start), "{state:?} at {size}: {there} {start}");
            window.leave_open();
            window.press_for(start.center(), 90);
            let is_other = |call: &Call| matches!(call, Call::Plan(command) if *command != Command::Start);
            let given = std::iter::from_fn(|| window.asked()).map(|(_, call)| call).find(is_other);
            assert!(!on_ground || given.is_none(), "{state:?} at {size}: {given:?}");
        }
    }
}

/// They stood beside it, and everything else moved aside.
#[test]
fn the_map_and_the_values_of_the_flight_stay_where_they_are_while_a_question_is_read() {
    for size in [egui::vec2(960.0, 600.0), egui::vec2(1280.0, 800.0)] {
        let (mut window, _) = flying();
        window.harness.set_size(size);
        window.steps(3);
        let where_it_is = |window: &Window| {
            ["Map", "Zoom in", "⏸ Hold", "Hide Flight", "Push"]
                .map(|label| window.harness.get_by_label(label).rect())
        };
        let before = where_it_is(&window);
        window.click("⏭ Skip leg");
        assert!(window.shows("Looking ahead"));
        assert_eq!(where_it_is(&window), before, "{size}");
        window.click("Cancel");
        assert_eq!(where_it_is(&window), before, "{size}");
    }
}

#[test]
fn what_came_down_beside_the_runway_is_said_to_be_on_the_ground_and_offers_nothing_but_to_rewind() {
    let (mut window, _) = raised();
    window.stand_at(THRESHOLD.destination(142.0, 2500.0));
    window.receive_gateway_state(GatewayState::Stop);
    assert!(window.shows("ended on the ground, 2.5 km from runway R05"));
    assert!(!window.shows("touches down") && !window.shows("Return to the main plan"));
    for out in ["⏸ Hold", "▶ Resume", "⏭ Skip leg", START, "Emergency: flying return"] {
        assert!(!window.is_enabled(out), "{out}");
    }
    assert!(window.is_enabled("Rewind (hold)"));
}

/// It stood on the runway, and was said to be 0.4 km from it.
#[test]
fn what_came_down_on_the_runway_is_said_to_be_there_however_long_that_is() {
    let (mut window, _) = raised();
    window.receive_gateway_state(GatewayState::Stop);
    for along_m in [0.0, 400.0, 600.0] {
        window.stand_at(THRESHOLD.destination(52.0, along_m).destination(142.0, 10.0));
        assert!(window.shows("ended on runway R05"), "{along_m} m along it");
    }
    assert!(window.shows("ended on runway R05, because"), "it came along it");
    window.stand_at(THRESHOLD.destination(52.0, 300.0));
    assert!(window.shows("ended on runway R05 from its other end, because"), "it came back");
    // counted from where the runway is nearest
    window.stand_at(THRESHOLD.destination(52.0, 1600.0));
    assert!(window.shows("ended on the ground, 1.0 km from runway R05"));
}

/// Of the runway R05 of the square.
const THRESHOLD: LatLon = LatLon::new(36.3190, -84.1730);

impl Window {
    fn stand_at(&mut self, at: LatLon) {
        let value = Position { position: at, ..on_ground() };
        let before_s = self.app().vehicle().position.as_ref().map_or(100.0, |before| before.time_s);
        self.receive(Telemetry::Position(Stamped { time_s: before_s + 1.0, validity_s: 2.0, value }));
    }
}

#[test]
fn flight_that_did_not_end_as_planned_says_how_it_ended() {
    let far = LatLon::new(36.219, -84.173);
    let home = LatLon::new(36.319, -84.173);
    let instead = "The plan was not flown to its end: return was flown instead";
    let otherwise = "not flown to its end";
    for (emergency, at, text, chip) in [
        (Some("return"), home, format!("{instead}, landed on R05"), otherwise),
        (Some("return"), far, format!("{instead}, came down 11.1 km from R05"), otherwise),
        (None, far, "Landed 11.1 km from R05, where the plan ends".into(), otherwise),
        (None, home, "the plan was flown".into(), "◆ flown"),
    ] {
        let mut window = flying_its_plan();
        let mut value = status(Phase::Flying);
        value.plan = window.app().vehicle().active_hash();
        value.emergency = emergency.map(Into::into);
        window.receive_status(value.clone());
        let there = Position { position: at, ..on_ground() };
        let stamped = Stamped { time_s: 90.0, validity_s: 2.0, value: there };
        window.receive(Telemetry::Position(stamped));
        (value.phase, value.emergency) = (Phase::Finished, None);
        window.receive_status(value);
        assert!(window.shows(&text) && window.shows(chip), "{text}");
        let carried = Position { position: at.destination(0.0, 5000.0), ..on_ground() };
        window.receive(Telemetry::Position(Stamped { time_s: 200.0, validity_s: 2.0, value: carried }));
        assert!(window.shows(&text), "it is told wherever the aircraft is carried: {text}");
    }
}

/// Only the departure was flown, and the bar said that the plan was.
#[test]
fn flight_that_safe_mode_brought_down_was_not_flown_to_its_end() {
    let mut window = flying_its_plan();
    let mut value = status(Phase::Flying);
    value.plan = window.app().vehicle().active_hash();
    window.receive_status(value.clone());
    for state in [GatewayState::SafeReturn, GatewayState::SafeLand, GatewayState::Stop] {
        window.receive_gateway_state(state);
        window.steps(20);
    }
    window.stand_at(THRESHOLD.destination(52.0, 300.0));
    value.phase = Phase::Finished;
    window.receive_status(value.clone());
    assert!(window.shows("The plan was not flown to its end: Safe mode took over, landed on R05"));
    assert!(window.shows("not flown to its end") && !window.shows("◆ flown"));
    value.phase = Phase::Flying;
    window.receive_status(value.clone());
    window.receive_gateway_state(GatewayState::TakeOff);
    window.steps(20);
    window.receive_gateway_state(GatewayState::Stop);
    value.phase = Phase::Finished;
    window.receive_status(value);
    assert!(window.shows("the plan was flown"), "that of the next flight is its own");
}

/// The cause, the runway and the time were in the agent's log only, and a click left Safe mode in the glide.
#[test]
fn safe_mode_in_the_air_is_red_and_says_why_whereto_and_when_and_is_left_by_a_hold() {
    let p = gcs_app::theme::palette(true);
    let (mut window, _) = flying();
    let says = |window: &mut Window, state, cause: &str| {
        let alarms = vec![engine_out()];
        let value = GatewayStatus { cause: cause.into(), alarms, ..gateway_status(state) };
        window.receive(Telemetry::Gateway(Stamped { time_s: 4.0, validity_s: 2.0, value }.into()));
        window.receive_position(false);
        let value = Navigation { buffer_s: 70.0, end_of_plan: true, ..navigation(200.0) };
        window.receive(Telemetry::Navigation(Stamped { time_s: 4.0, validity_s: 2.0, value }));
        window.steps(20);
    };
    says(&mut window, GatewayState::SafeReturn, "gliding to runway R05, straight in");
    let whole =
        "⛔ Safe mode: gliding to runway R05, straight in, touches down in 1:10, because the engine failed";
    assert!(window.shows(whole) && window.shows("none: Safe mode leads"));
    let banner = window.harness.get_by_label(whole).rect();
    assert_eq!(window.fill_around(banner), Some(p.warning), "as an emergency plan that is flown");
    for button in ["⏸ Hold", "⏭ Skip leg"] {
        assert!(!window.is_enabled(button), "{button} would do nothing");
    }
    window.leave_open();
    window.press_for(window.centre("Leave Safe mode (hold)"), 5);
    assert!(window.asked().is_none(), "not by a click");
    window.hold("Leave Safe mode (hold)", 90);
    assert!(matches!(window.asked(), Some((_, Call::Gateway(usal::contract::GatewayRequest::Recover)))));
    says(&mut window, GatewayState::SafeLand, "steering to the touch-down");
    assert!(window.shows("⛔ Safe mode: gliding to runway R05, straight in, steering to the touch-down"));
}

/// Why Safe mode leads was said until it told where it goes; why no emergency plan is flown, in the log alone.
#[test]
fn safe_mode_says_why_it_began_and_why_no_emergency_plan_is_flown() {
    let gateway = |window: &mut Window, state, cause: &str, alarms| {
        let value = GatewayStatus { cause: cause.into(), alarms, ..gateway_status(state) };
        window.receive(Telemetry::Gateway(Stamped { time_s: 4.0, validity_s: 2.0, value }.into()));
        window.receive_position(false);
        window.steps(20);
    };
    let changed = |window: &mut Window, sequence, from, to, cause: &str| {
        let value = GatewayEvent::StateChanged { from, to, cause: cause.into() };
        let event = Stamped { time_s: f64::from(sequence), validity_s: f64::MAX, value };
        window.send(LinkEvent::Telemetry(Telemetry::GatewayEvent(Numbered { sequence, event })));
    };
    let (mut window, _) = flying();
    changed(&mut window, 1, GatewayState::Nav, GatewayState::SafeHold, "the FP Manager is silent");
    gateway(&mut window, GatewayState::SafeHold, "the FP Manager is silent", Vec::new());
    assert!(window.shows("⛔ Safe mode: the FP Manager is silent") && !window.shows("· the FP Manager"));
    changed(&mut window, 2, GatewayState::SafeHold, GatewayState::SafeReturn, "returning to runway R05");
    gateway(&mut window, GatewayState::SafeReturn, "returning to runway R05", Vec::new());
    assert!(window.shows("⛔ Safe mode: returning to runway R05 · the FP Manager is silent"));

    let mut window = flying_its_plan();
    window.harness.set_size(egui::vec2(960.0, 600.0));
    let unanswered = |plan: Option<&str>, reason: &str| Event::EmergencyUnanswered {
        cause: Cause::Engine,
        plan: plan.map(Into::into),
        code: "any".into(),
        reason: reason.into(),
    };
    let told = |window: &mut Window, sequence, value| {
        let event = Stamped { time_s: f64::from(sequence), validity_s: f64::MAX, value };
        window.send(LinkEvent::Telemetry(Telemetry::PlanEvent(Numbered { sequence, event })));
    };
    let reason =
        "its runway is not reached without the engine, but runway `R34` is: the gateway's Safe mode decides";
    told(&mut window, 1, unanswered(Some("return"), reason));
    gateway(&mut window, GatewayState::SafeReturn, "gliding to runway R34", vec![engine_out()]);
    let whole = "⛔ Safe mode: gliding to runway R34, because the engine failed; return is not flown: \
                 its runway is not reached without the engine, but runway “R34” is";
    assert!(window.shows(whole) && window.paints_whole(whole), "nothing of it is cut in a small window");
    told(&mut window, 2, unanswered(None, "no emergency plan applies here"));
    window.steps(2);
    assert!(window.shows("because the engine failed; no emergency plan is named for that"));
}

/// It was the largest button of the banner, all through the glide.
#[test]
fn way_back_without_an_engine_is_small_held_and_warns() {
    let (mut window, landing) = raised();
    window.answer(landing, Err("it is not known".into()));
    window.leave_open();
    window.receive_gateway(vec![engine_out()]);
    let name = "⚠ Main plan, no engine (hold)";
    assert!(!window.shows("Return to the main plan at") && window.shows(name));
    window.harness.hover_at(window.centre(name));
    window.steps(60);
    assert!(window.shows("Without its engine it comes down on the way of the main plan"));
    window.press_for(window.centre(name), 5);
    window.leave_open();
    assert!(!window.shows("Looking ahead"), "not by a click");
    window.hold(name, 90);
    assert!(window.shows("Looking ahead"));
    let wanted = Call::Foresee(Some(Command::ReturnToMain { leg: "side3".into() }));
    assert!(std::iter::from_fn(|| window.asked()).any(|(_, call)| call == wanted));
}

/// The bar said the one for any other cause, also while the engine was out.
#[test]
fn emergency_plan_of_the_engine_is_named_beside_the_one_for_other_causes() {
    let field = r#"<emergencyPlan id="field" name="To the field" runway="R05">
        <stage id="f-arrival" type="arrival"><DF id="f1" fix="C" altitude="150" altitudeReference="home"/></stage>
        <stage id="f-land" type="land" runway="R05"/></emergencyPlan></emergencyPlans>"#;
    let named = r#"<emergency cause="engine" plan="field"/><TF id="side1""#;
    let text = SQUARE.replacen(r#"<TF id="side1""#, named, 1).replace("</emergencyPlans>", field);
    let mut window = Window::open(&text);
    window.until_analysed();
    fly_its_plan(&mut window);
    let mut value = window.app().vehicle().status.as_ref().unwrap().value.clone();
    value.emergency_in_force = Some("return".into());
    window.receive_status(value.clone());
    assert!(window.shows("· alternate: return · engine: To the field"));
    assert!(window.shows("If engine") && window.shows("Emergency: fly return (hold)"));
    window.receive_gateway(vec![engine_out()]);
    window.leave_open();
    window.hold("Emergency: fly To the field (hold)", 90);
    let flown = Command::Emergency { cause: Cause::Operator, plan: Some("field".into()) };
    assert_eq!(window.asked().map(|(_, call)| call), Some(Call::Plan(flown)));
    value.place = Some(place("take-off", "take-off"));
    window.receive_status(value);
    assert!(!window.shows("engine: To the field"), "it is named on the circuit alone");
}

/// The square, with a runway R34 three kilometres east of R05, and a way to it.
fn with_r34() -> String {
    let at = THRESHOLD.destination(90.0, 3000.0);
    let (lat, lon) = (at.lat_deg, at.lon_deg);
    let runway = format!(
        r#"<runway id="R34" lat="{lat}" lon="{lon}" elevation="349" heading="52" length="600"/></runways>"#
    );
    let way = r#"<emergencyPlan id="east" name="To R34" runway="R34">
        <stage id="e-arrival" type="arrival"><DF id="e1" fix="B" altitude="150" altitudeReference="home"/></stage>
        <stage id="e-land" type="land" runway="R34"/></emergencyPlan></emergencyPlans>"#;
    SQUARE.replace("</runways>", &runway).replace("</emergencyPlans>", way)
}

/// These are the seconds that count: it was known aboard at once, and here the banner named the runway, the profile the main plan.
#[test]
fn engine_failure_says_at_once_what_is_in_reach_and_the_list_of_plans_does() {
    let mut window = Window::open(&with_r34());
    window.until_analysed();
    fly_its_plan(&mut window);
    let mut value = window.app().vehicle().status.as_ref().unwrap().value.clone();
    let Telemetry::Position(mut here) = position(1.0, 500.0, false) else { unreachable!() };
    here.value.position = THRESHOLD.destination(90.0, 2600.0);
    here.value.track_deg = 52.0;
    window.receive(Telemetry::Position(here.clone()));
    let list = |window: &mut Window| {
        window.click_role(egui::accesskit::Role::ComboBox, "Alternate");
    };
    list(&mut window);
    assert!(window.shows("To R34 · 0.4 km") && !window.shows("to spare"), "the engine runs");
    window.press(egui::Key::Escape);
    value.emergency = Some("return".into());
    window.receive_gateway(vec![engine_out()]);
    window.receive(Telemetry::Position(here.clone()));
    window.receive_status(value);
    window.steps(20);
    assert!(window.shows("to runway R05, straight 2.2 km, not reached: "));
    assert!(window.shows("return is flown: it was asked which way"), "not the profile of the main plan");
    list(&mut window);
    assert!(window.shows("return · 2.2 km, not reached: ") && window.shows("To R34 · 0.4 km, "));
    window.press(egui::Key::Escape);
    let asked: Vec<_> = std::iter::from_fn(|| window.asked()).collect();
    let (way, _) = asked.iter().rfind(|(_, call)| *call == Call::Foresee(None)).unwrap();
    let why = "without its engine it comes down 2000 m from runway `R05`";
    let short = Foresight { landed: false, cut_short: Some(why.into()), ..foresight() };
    window.receive(Telemetry::Position(here));
    window.answer(*way, Ok(Reply::Foresight(Box::new(short))));
    window.steps(20);
    assert!(
        window
            .shows("2000 m from runway “R05” · reached straight: R34 0.4 km, 81 m to spare at the threshold")
    );
}

/// The map had been moved to a push, and the aircraft flew out of it.
#[test]
fn emergency_that_begins_is_brought_into_view_once() {
    let mut window = flying_its_plan();
    let away = THRESHOLD.destination(0.0, 40_000.0);
    let Telemetry::Position(mut here) = position(1.0, 500.0, false) else { unreachable!() };
    here.value.position = away;
    let at = |window: &mut Window| {
        window.receive(Telemetry::Position(here.clone()));
        window.steps(40);
        window.app().map().middle().unwrap().distance_m(away)
    };
    let before_m = at(&mut window);
    assert!(before_m > 30_000.0, "nobody looks there");
    let mut value = window.app().vehicle().status.as_ref().unwrap().value.clone();
    value.emergency = Some("return".into());
    window.receive_status(value);
    let begun_m = at(&mut window);
    assert!(begun_m < before_m - 10_000.0, "{begun_m} of {before_m} m: between the aircraft and the runway");
    let map = window.centre("Map");
    window.drag(map, egui::vec2(0.0, -150.0));
    assert!(at(&mut window) > begun_m + 1000.0, "who looks elsewhere means to");
}

/// It said to land where nothing is in reach, and still when the aircraft stood.
#[test]
fn alarm_of_the_engine_says_what_can_be_done() {
    let mut window = flying_its_plan();
    let advice = |window: &mut Window, off_m: f64, on_ground: bool| {
        let Telemetry::Position(mut here) = position(1.0, 500.0, on_ground) else { unreachable!() };
        here.value.position = THRESHOLD.destination(90.0, off_m);
        window.receive(Telemetry::Position(here));
        window.receive_gateway(vec![engine_out()]);
        let none = "No runway of the plan is within a straight glide: look for a place to come down.";
        ["Fly the emergency plan", none, "It is down: look at the engine before another start."]
            .map(|said| window.shows(said))
    };
    assert_eq!(advice(&mut window, 300.0, false), [true, false, false]);
    assert_eq!(advice(&mut window, 9000.0, false), [false, true, false]);
    assert_eq!(advice(&mut window, 9000.0, true), [false, false, true]);
}

fn on_ground() -> Position {
    let Telemetry::Position(here) = position(0.0, 349.0, true) else { unreachable!() };
    here.value
}

#[test]
fn there_is_no_banner_without_an_emergency() {
    let (window, _) = flying();
    assert!(!window.shows("EMERGENCY: flying"));
}

/// Beside the button that is held, in a hurry: nothing happened, and nothing was said.
#[test]
fn who_holds_the_way_back_has_pressed_it() {
    let mut window = in_emergency();
    window.hold("Return to the main plan at side3", 120);
    assert!(window.shows("Looking ahead"), "a long press counts");
}
