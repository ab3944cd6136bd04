//! What the gateway does, or what is lost on the way from it, in a flight whose FP Manager does not die.

use super::asks::{What, asks};
use super::*;
use crate::fp_manager::manager::Manager;
use flight_exec::Phase;
use flight_plan::Id;
use usal::contract::{Alarm, Cause, GatewayEvent, GatewayRequest, Position, Severity};

/// In the air, so many waypoints flown; nothing but these first requests is asked.
fn flown(waypoints: usize, requests: usize) -> Flight {
    let mut flight = Flight::new(1, false, false);
    flight.asks.truncate(requests);
    run_until(&mut flight, "flown", |f| f.gateway.flown.len() >= waypoints);
    flight
}

fn run_until(flight: &mut Flight, what: &str, done: impl Fn(&Flight) -> bool) {
    for _ in 0..STEPS_MAX {
        if done(flight) {
            return;
        }
        flight.step();
    }
    panic!("never: {what}; asked {:?}, heard {:?}", flight.gateway.requests, flight.events);
}

fn run(flight: &mut Flight, steps: usize) {
    (0..steps).for_each(|_| flight.step());
}

fn emergencies(flight: &Flight) -> usize {
    flight.events.iter().filter(|e| matches!(e, Event::EmergencyStarted { .. })).count()
}

fn in_emergency(flight: &Flight) -> bool {
    flight.process.manager.executor().status().emergency.is_some()
}

/// Proposes, commits and starts.
const STARTED: usize = 3;

#[test]
fn events_lost_an_alarm_among_them_is_found_and_answered() {
    let mut flight = flown(10, STARTED);
    flight.gateway.alarm("energy-low", Cause::Energy);
    flight.gateway.events.clear();
    run(&mut flight, 4);
    assert!(!in_emergency(&flight), "it waits for the event");
    flight.with_manager(|manager, now, out| manager.events_lost(now, 1, out));
    run(&mut flight, 2);
    assert!(in_emergency(&flight), "{:?}", flight.events);
}

#[test]
fn events_lost_the_landing_among_them_is_noticed() {
    let mut flight = flown(10, STARTED);
    // found: the loop is left
    flight.asks.extend(asks(false).pop_back());
    run_until(&mut flight, "the end is aboard", |f| f.gateway.end_is_aboard());
    while !flight.gateway.finished() {
        flight.gateway.fly();
    }
    flight.gateway.events.clear();
    run(&mut flight, 4);
    assert_eq!(flight.process.manager.executor().status_phase(), Phase::Flying);
    flight.with_manager(|manager, now, out| manager.events_lost(now, 9, out));
    run(&mut flight, 4);
    assert_eq!(flight.process.manager.executor().status_phase(), Phase::Finished);
}

#[test]
fn alarm_raised_on_the_ground_is_answered_in_the_air() {
    for steps in [1, 10] {
        let mut flight = Flight::new(1, false, false);
        flight.asks.truncate(STARTED);
        flight.gateway.refuse_launch = Some("not yet".into());
        run(&mut flight, steps);
        assert_eq!(flight.asks.is_empty(), steps > 1, "the second time, it was started before");
        flight.gateway.alarm("energy-low", Cause::Energy);
        run(&mut flight, 10);
        flight.gateway.refuse_launch = None;
        run_until(&mut flight, "in the air", |f| f.gateway.state == GatewayState::Nav);
        assert_eq!(emergencies(&flight), 0, "it is not for the ground");
        run(&mut flight, 3);
        assert_eq!(emergencies(&flight), 1, "{:?}", flight.events);
    }
}

#[test]
fn alarm_less_severe_than_the_emergency_is_answered_when_that_is_left() {
    let mut flight = flown(10, STARTED);
    flight.gateway.alarm("energy-low", Cause::Energy);
    flight.gateway.alarm("gps-lost", Cause::Gps);
    run(&mut flight, 4);
    assert_eq!(emergencies(&flight), 1);
    flight.ask_once(&What::Command(Command::ReturnToMain { leg: Id::new("back") }), "return").unwrap();
    run(&mut flight, 2);
    assert_eq!(emergencies(&flight), 2);
    let starts = flight.events.iter().rev();
    let last = starts.filter(|e| matches!(e, Event::EmergencyStarted { .. })).take(1);
    assert!(format!("{:?}", last.collect::<Vec<_>>()).contains("Gps"));
    // that of the energy was answered, and so is this now
    run(&mut flight, 4);
    assert_eq!(emergencies(&flight), 2);
    assert!(!flight.gateway.requests.contains(&GatewayRequest::Safe));
}

#[test]
fn clients_that_use_the_same_names_get_their_own_answers() {
    let mut flight = flown(10, STARTED);
    let mut ask = |by: &str, command: Command| {
        flight
            .process
            .manager
            .command(flight.time, command, by, Some("1"), &mut Vec::new())
            .map_err(|r| r.code)
    };
    assert_eq!(ask("a", Command::Hold), Ok(()));
    assert_eq!(ask("a", Command::Hold), Ok(()), "repeated");
    assert_eq!(ask("b", Command::Hold).unwrap_err(), "already-holding");
    assert_eq!(ask("b", Command::Resume), Ok(()));
}

/// In the take-off, of a plan without emergency plans, with an alarm; Safe mode is refused so often.
fn needs_safe(refusals: usize) -> Flight {
    let mut flight = Flight::new(1, false, false);
    let plan = asks::MISSION.replace(r#"<mainPlan emergency="home">"#, "<mainPlan>");
    flight.asks.truncate(STARTED);
    flight.asks[0].what = What::Propose(plan);
    flight.gateway.refuse_safe = refusals;
    run_until(&mut flight, "in the air", |f| f.gateway.state == GatewayState::Nav);
    flight.gateway.alarm("engine-hot", Cause::Engine);
    flight
}

#[test]
fn safe_mode_refused_below_the_height_for_it_is_asked_for_until_it_is_granted() {
    let mut flight = needs_safe(10);
    run(&mut flight, 30);
    assert_eq!(flight.gateway.state, GatewayState::SafeHold, "{:?}", flight.gateway.requests);
}

#[test]
fn safe_mode_never_granted_is_not_wanted_of_the_next_flight() {
    let mut flight = needs_safe(usize::MAX);
    run(&mut flight, 30);
    assert_eq!(flight.process.manager.gateway_session.wanted(), Some(&GatewayRequest::Safe));
    flight.gateway.state = GatewayState::Stop;
    run(&mut flight, 2);
    assert_eq!(flight.process.manager.gateway_session.wanted(), None);
}

#[test]
fn alarm_in_flight_without_a_plan_being_flown_asks_for_safe_mode() {
    let mut flight = Flight::new(1, false, false);
    flight.asks.clear();
    flight.gateway.state = GatewayState::Nav;
    run(&mut flight, 2);
    flight.gateway.alarm("energy-low", Cause::Energy);
    run(&mut flight, 3);
    assert_eq!(flight.gateway.requests, [GatewayRequest::Safe]);
}

fn clear_alarms(flight: &mut Flight) {
    for alarm in std::mem::take(&mut flight.gateway.alarms) {
        flight.gateway.events.push_back(GatewayEvent::AlarmCleared { id: alarm.id });
    }
}

/// It was asked for ten minutes later, for an alarm that was gone.
#[test]
fn safe_mode_for_an_alarm_while_the_pilot_flies_is_asked_for_only_if_that_is_still_raised_when_he_gives_back()
{
    for clears in [true, false] {
        let mut flight = Flight::new(1, false, false);
        flight.asks.clear();
        flight.gateway.state = GatewayState::Manual;
        run(&mut flight, 2);
        flight.gateway.alarm("energy-low", Cause::Energy);
        run(&mut flight, 3);
        assert_eq!(flight.process.manager.gateway_session.wanted(), None);
        if clears {
            clear_alarms(&mut flight);
            run(&mut flight, 2);
        }
        flight.gateway.state = GatewayState::Nav;
        run(&mut flight, 4);
        assert_eq!(flight.gateway.requests.contains(&GatewayRequest::Safe), !clears);
    }
}

#[test]
fn safe_mode_that_was_not_granted_yet_is_not_wanted_of_the_pilot_nor_for_an_alarm_that_is_gone() {
    let wanted = |flight: &Flight| flight.process.manager.gateway_session.wanted().cloned();
    let mut flight = needs_safe(usize::MAX);
    run(&mut flight, 5);
    assert_eq!(wanted(&flight), Some(GatewayRequest::Safe));
    flight.gateway.state = GatewayState::Manual;
    run(&mut flight, 2);
    assert_eq!(wanted(&flight), None);
    flight.gateway.state = GatewayState::Nav;
    run(&mut flight, 4);
    assert_eq!(wanted(&flight), Some(GatewayRequest::Safe), "it is still raised");
    clear_alarms(&mut flight);
    run(&mut flight, 2);
    assert_eq!(wanted(&flight), None);
}

#[test]
fn holding_when_safe_mode_ends_it_holds_again() {
    for home in [false, true] {
        let mut flight = flown(10, STARTED);
        flight.ask_once(&What::Command(Command::Hold), "hold").unwrap();
        run(&mut flight, 2);
        assert_eq!(flight.gateway.state, GatewayState::Hold);
        let held = flight.gateway.flown.len();
        if home {
            flight.gateway.safe_return()
        } else {
            flight.gateway.safe_hold()
        }
        run(&mut flight, 8);
        assert_eq!((flight.gateway.state, flight.gateway.flown.len()), (GatewayState::Hold, held));
        flight.ask_once(&What::Command(Command::Resume), "resume").unwrap();
        run(&mut flight, 4);
        assert!(flight.gateway.flown.len() > held);
    }
}

/// Its hold waited for the end of the climb, and a direct command had taken its place there.
#[test]
fn holding_while_the_gateway_could_not_do_what_it_had_granted_it_holds_again() {
    let mut flight = flown(10, STARTED);
    for hold_first in [false, true] {
        if hold_first {
            flight.ask_once(&What::Command(Command::Hold), "hold").unwrap();
            run(&mut flight, 2);
        }
        flight.gateway.state = GatewayState::Nav;
        let (request, reason) = ("direct".into(), "the position is not known".into());
        flight.gateway.events.push_back(GatewayEvent::NotDone { request, reason });
        run(&mut flight, 3);
        assert_eq!(flight.gateway.state == GatewayState::Hold, hold_first);
    }
}

#[test]
fn resume_is_one_word_whoever_led_the_aircraft_away() {
    for by in [GatewayState::Hold, GatewayState::Directed, GatewayState::Manual] {
        for held in [false, true] {
            let mut flight = flown(10, STARTED);
            if held {
                flight.ask_once(&What::Command(Command::Hold), "hold").unwrap();
            }
            run(&mut flight, 2);
            flight.gateway.state = by;
            run(&mut flight, 4);
            let before = flight.gateway.flown.len();
            flight.ask_once(&What::Command(Command::Resume), "resume").unwrap();
            run(&mut flight, 6);
            let reached = (flight.gateway.state, flight.gateway.flown.len() > before);
            assert_eq!(reached, (GatewayState::Nav, true), "{by:?}, held: {held}");
        }
    }
}

#[test]
fn a_command_to_lead_elsewhere_ends_a_direct_command_but_takes_nothing_from_the_pilot() {
    let home = Command::Emergency { cause: flight_plan::Cause::Operator, plan: None };
    for command in [Command::GoTo { leg: Id::new("back") }, home] {
        let led_away_and_told = |by| {
            let mut flight = flown(10, STARTED);
            flight.gateway.state = by;
            run(&mut flight, 4);
            flight.ask_once(&What::Command(command.clone()), "elsewhere").unwrap();
            flight
        };
        let mut directed = led_away_and_told(GatewayState::Directed);
        run_until(&mut directed, "Nav", |f| f.gateway.state == GatewayState::Nav);
        let mut piloted = led_away_and_told(GatewayState::Manual);
        run(&mut piloted, 6);
        assert_eq!(piloted.gateway.state, GatewayState::Manual, "{command:?}");
        piloted.ask_once(&What::Command(Command::Hold), "hold").unwrap();
        run(&mut piloted, 2);
        let leg = if matches!(command, Command::GoTo { .. }) { "back" } else { "home-land" };
        piloted.ask_once(&What::Command(Command::GoTo { leg: Id::new(leg) }), "on").unwrap();
        run(&mut piloted, 6);
        assert_eq!(piloted.gateway.state, GatewayState::Manual, "{command:?}, held");
    }
}

/// What is reported of legs and actions, and what is asked of services.
fn reports_of_plan(flight: &Flight) -> usize {
    use Event::*;
    let of_plan = |e: &&Event| {
        matches!(e, LegEntered { .. } | IterationFinished { .. } | DecisionTaken { .. } | ActionDone { .. })
    };
    flight.events.iter().filter(of_plan).count()
}

#[test]
fn brought_down_by_the_pilot_or_safe_mode_nothing_ahead_counts_as_flown() {
    for by in [GatewayState::Manual, GatewayState::SafeLand] {
        let mut flight = flown(10, STARTED);
        run(&mut flight, 2);
        let told = reports_of_plan(&flight);
        flight.gateway.state = by;
        run(&mut flight, 4);
        // down it has no waypoints
        flight.gateway.safe_return();
        flight.gateway.state = GatewayState::Stop;
        run(&mut flight, 4);
        assert_eq!(reports_of_plan(&flight), told, "{by:?}: {:?}", flight.events);
        assert_eq!(flight.process.manager.executor().status_phase(), Phase::Finished);
        let joins = flight.gateway.joins.len();
        run(&mut flight, 20);
        assert_eq!(flight.gateway.joins.len(), joins, "it has joined, and once is enough");
        flight.gateway.is_carried_back();
        run(&mut flight, 2);
        flight.ask_once(&What::Command(Command::Start), "again").unwrap();
        run_until(&mut flight, "in the air", |f| f.gateway.state == GatewayState::Nav);
    }
}

#[test]
fn start_of_which_nothing_came_is_given_again() {
    let mut flight = Flight::new(1, false, false);
    flight.asks.truncate(STARTED);
    flight.gateway.refuse_launch = Some("no GPS fix".into());
    run(&mut flight, 10);
    flight.ask_once(&What::Command(Command::Hold), "hold").unwrap();
    run(&mut flight, 20);
    flight.gateway.refuse_launch = None;
    run(&mut flight, 4);
    assert_eq!(flight.gateway.state, GatewayState::Stop, "it was to hold");
    flight.ask_once(&What::Command(Command::Start), "start").unwrap();
    run_until(&mut flight, "in the air", |f| f.gateway.state == GatewayState::Nav);
    assert_eq!(flight.process.manager.executor().status_phase(), Phase::Flying);
}

#[test]
fn alarm_less_severe_is_answered_when_another_plan_is_entered_as_well() {
    let mut flight = flown(10, STARTED);
    flight.gateway.alarm("energy-low", Cause::Energy);
    flight.gateway.alarm("gps-lost", Cause::Gps);
    run(&mut flight, 4);
    let changed = asks::MISSION.replace("name=\"Kills\"", "name=\"Changed\"");
    flight.ask_once(&What::Propose(changed), "propose").unwrap();
    let hash = flight.proposed.clone().unwrap();
    let command = Command::Commit { hash, entry: Some(Id::new("back")) };
    flight.ask_once(&What::Command(command), "commit").unwrap();
    run(&mut flight, 2);
    assert_eq!(emergencies(&flight), 2, "{:?}", flight.events);
}

/// It was laid out with power first, and 50 ms later for a glide: another transaction, on PX4 another list.
#[test]
fn the_plan_for_an_engine_that_is_out_is_laid_out_once() {
    let mut flight = flown(10, STARTED);
    let high = Position { altitude_amsl_m: 2000.0, ..flight.gateway.position() };
    let (now, manager) = (flight.time, &mut flight.process.manager);
    manager.aircraft().position(high);
    manager.tick(now, &mut Vec::new());
    let (severity, cause) = (Severity::Warning, Some(Cause::Engine));
    let alarm =
        Alarm { id: "engine-out".into(), severity, source: "gateway".into(), advice: "land".into(), cause };
    manager.gateway_event(now, GatewayEvent::AlarmRaised(alarm), &mut Vec::new());
    let ahead = |manager: &Manager| manager.executor().ahead().cloned().collect::<Vec<_>>();
    let laid_out = ahead(manager);
    manager.tick(now, &mut Vec::new());
    assert_eq!(ahead(manager), laid_out);
}

/// It ran dry; what it then took is not flown by what it says of before.
#[test]
fn everything_flown_told_before_more_was_taken_is_not_the_end() {
    let mut flight = flown(10, STARTED);
    let ahead = |f: &Flight| f.process.manager.executor().ahead().map(|w| w.token).collect::<Vec<_>>();
    let before = ahead(&flight);
    assert!(before.len() > 1);
    let taken = before[0].convert();
    flight.with_manager(|manager, now, out| {
        manager.gateway_event(now, GatewayEvent::Progress { current: None, taken }, out);
    });
    assert_eq!(ahead(&flight), before);
    let taken = before[before.len() - 1].convert();
    flight.with_manager(|manager, now, out| {
        manager.gateway_event(now, GatewayEvent::Progress { current: None, taken }, out);
    });
    assert_ne!(ahead(&flight), before, "everything that was taken");
}

fn phase(flight: &Flight) -> Phase {
    flight.process.manager.executor().status_phase()
}

/// The phase stayed `flying` on the ground, and neither `resume` nor `start` led on.
#[test]
fn a_take_off_that_the_gateway_gives_up_is_told_and_started_again() {
    let mut flight = Flight::new(1, false, false);
    flight.asks.truncate(STARTED);
    flight.gateway.refuse_launch = Some("not yet".into());
    run_until(&mut flight, "started", |f| f.asks.is_empty() && phase(f) == Phase::Flying);
    flight.events.clear();
    flight.gateway.events.push_back(GatewayEvent::NotLaunched { reason: "refused".into() });
    run(&mut flight, 2);
    let told = |event: &&Event| matches!(event, Event::NotGranted { request, reason } if request == "launch" && reason == "refused");
    assert_eq!(flight.events.iter().filter(told).count(), 1, "{:?}", flight.events);
    assert_eq!(phase(&flight), Phase::Idle);
    run(&mut flight, 4);
    assert_eq!(flight.gateway.launches(), 0, "it is not wanted any more");
    flight.gateway.refuse_launch = None;
    flight.ask_once(&What::Command(Command::Start), "again").unwrap();
    run_until(&mut flight, "in the air", |f| f.gateway.state == GatewayState::Nav);
}

/// As an autopilot that was switched off, or a pilot who landed without a mode of his own.
#[test]
fn brought_down_in_the_middle_the_flight_is_over() {
    let mut flight = flown(10, STARTED);
    flight.gateway.safe_return();
    flight.gateway.state = GatewayState::Stop;
    let (from, to, cause) = (GatewayState::Nav, GatewayState::Stop, "down".into());
    flight.gateway.events.push_back(GatewayEvent::StateChanged { from, to, cause });
    run(&mut flight, 4);
    assert_eq!(phase(&flight), Phase::Finished);
}
