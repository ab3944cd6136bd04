use super::*;

fn assert_in_order(progress: &[Option<u64>], last: u64) {
    let tokens: Vec<u64> = progress.iter().flatten().copied().collect();
    assert!(tokens.windows(2).all(|w| w[0] < w[1]), "{tokens:?}");
    assert_eq!(tokens.last(), Some(&last));
}

#[test]
fn a_flight_of_more_waypoints_than_the_ring_holds_is_flown_from_take_off_to_landing() {
    let mut flight = Flight::new(1, &[]);
    let mut plan = vec![take_off()];
    plan.extend(zigzag(0, 60, 150.0));
    plan.extend(zigzag(0, 59, 150.0).into_iter().rev());
    plan.extend(landing());
    let last = plan.len() as u64;
    flight.launch(plan);
    flight.run_until(1800.0, "landing", |f| f.state() == GatewayState::Stop);
    let progress = flight.progress();
    assert_eq!(progress.last(), Some(&None));
    assert_in_order(&progress, last);
    assert_eq!(progress.len() as u64, last + 1, "every waypoint was steered to");
    let states: Vec<_> = flight.changes().into_iter().map(|c| c.1).collect();
    use GatewayState::*;
    assert_eq!(states, [Stop, TakeOff, Nav, Approach, Land, Stop]);
    assert!(flight.join_knowing("plan", last).finished, "its landing was the plan's");
}

#[test]
fn packets_lost_0_to_30_percent_the_same_waypoints_are_flown() {
    for (seed, loss) in [(11, 0.0), (12, 0.1), (13, 0.2), (14, 0.3)] {
        println!("seed {seed}, loss {loss}");
        let fault = format!("packet-loss={loss}");
        let mut flight = Flight::new(seed, &[&fault, "duplicate=0.1", "reorder=0.1"]);
        let mut plan = vec![take_off()];
        plan.extend(zigzag(0, 50, 250.0));
        flight.launch(plan.clone());
        flight.run_until(1500.0, "the 45th waypoint", |f| f.has_reached(45));
        assert_in_order(&flight.progress(), *flight.progress().iter().flatten().last().unwrap());
        let wanted: Vec<LatLon> = plan.iter().map(|w| w.position).collect();
        let known = |p: &LatLon| wanted.iter().any(|w| w.distance_m(*p) < 1.0);
        assert!(flight.steered.iter().all(known), "it steered to something that was never fed");
    }
}

#[test]
fn fp_manager_killed_holds_at_t1_returns_at_t2_and_lands() {
    let mut flight = Flight::on_zigzag(2, &[], 30, 300.0);
    flight.store_runway();
    flight.run(30.0);
    flight.alive = false;
    let killed = flight.now.as_secs_f64();
    flight.run_until(5.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
    assert!(flight.now.as_secs_f64() - killed < 2.2, "T1 is 2 s after the last heartbeat");
    let held = flight.now.as_secs_f64();
    flight.run_until(30.0, "Safe.Return", |f| f.state() == GatewayState::SafeReturn);
    let waited = flight.now.as_secs_f64() - held;
    assert!((19.9..20.3).contains(&waited), "T2 is 20 s, not {waited}");
    flight.run_until(900.0, "landed", |f| f.state() == GatewayState::Stop);
    let states: Vec<_> = flight.changes().into_iter().map(|c| c.1).collect();
    use GatewayState::*;
    assert_eq!(states[3..], [SafeHold, SafeReturn, SafeApproach, SafeLand, Stop]);
    let place = flight.station.gateway().telemetry().position().unwrap().1.position;
    assert!(place.distance_m(HOME) < 700.0, "{} m from the runway", place.distance_m(HOME));
    assert!(!flight.progress().contains(&None), "the plan's waypoints were not flown");
    assert!(!flight.join_knowing("plan", flight.next).finished);
}

/// The gateway may not end before.
#[test]
fn it_is_in_flight_until_it_stands_in_safe_mode_too() {
    let in_flight = |flight: &Flight| flight.station.gateway().is_in_flight();
    let mut flight = Flight::new(2, &[]);
    flight.run(20.0);
    assert!(!in_flight(&flight), "on the ground");
    let mut flight = Flight::on_zigzag(2, &[], 30, 300.0);
    flight.store_runway();
    assert!(in_flight(&flight));
    flight.alive = false;
    flight.run_until(900.0, "landed", |f| {
        assert!(in_flight(f) || f.state() == GatewayState::Stop, "{:?}", f.state());
        f.state() == GatewayState::Stop
    });
    assert!(!in_flight(&flight), "it stands");
}

#[test]
fn fp_manager_back_in_time_gets_the_aircraft_back() {
    let mut flight = Flight::on_zigzag(3, &[], 30, 300.0);
    flight.run(20.0);
    flight.alive = false;
    flight.run_until(5.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
    assert!(matches!(flight.feed(None, zigzag(30, 1, 300.0)), FeedAnswer::NotNow(_)));
    assert!(!flight.join("another plan").accepted);
    flight.run(10.0);
    flight.alive = true;
    let answer = flight.join("plan");
    assert!(answer.accepted, "{answer:?}");
    let current = answer.current.unwrap().0;
    flight.run_until(20.0, "Nav", |f| {
        f.state() == GatewayState::Nav && f.station.gateway().status(f.now).autopilot_mode == "AUTO"
    });
    flight.run_until(120.0, "further", |f| f.has_reached(current + 3));
}

#[test]
fn fp_manager_back_during_the_return_gets_the_aircraft_back_too() {
    let mut flight = Flight::in_safe_return(4);
    flight.alive = true;
    let answer = flight.join("plan");
    assert!(answer.accepted && answer.current.is_none(), "{answer:?}");
    flight.run_until(10.0, "Hold", |f| f.state() == GatewayState::Hold);
    let first = answer.highest.0 + 1;
    assert_eq!(flight.feed(None, zigzag(10, 12, 300.0)), FeedAnswer::Accepted);
    flight.run_until(200.0, "Nav", |f| f.has_reached(first + 4));
    assert_eq!(flight.state(), GatewayState::Nav);
    assert!(flight.progress().iter().flatten().all(|t| *t < 32 || *t >= first));
}

#[test]
fn fp_manager_that_does_not_know_the_flight_does_not_stop_the_return() {
    for (plan, forgets) in [("plan", true), ("another plan", false)] {
        let mut flight = Flight::in_safe_return(18);
        flight.restart_fp_manager(plan);
        let last_token = if forgets { 0 } else { flight.next - 1 };
        let answer = flight.join_knowing(plan, last_token);
        assert!(!answer.accepted && answer.reason.contains("recover"), "{plan}: {answer:?}");
        flight.run(5.0);
        assert_eq!(flight.state(), GatewayState::SafeReturn, "{plan}");
    }
}

#[test]
fn fp_manager_back_with_an_update_that_the_gateway_has_not_heard_of_gets_the_aircraft_back() {
    let mut flight = Flight::in_safe_return(24);
    flight.restart_fp_manager("second update");
    let last = flight.next - 1;
    let refused = [(vec![], last), (vec!["another plan", "update"], last), (vec!["plan", "update"], 0)];
    for (earlier, last_token) in refused {
        let answer = flight.join_after(&earlier, "second update", last_token);
        assert!(!answer.accepted && answer.reason.contains("recover"), "{earlier:?}: {answer:?}");
        assert_eq!(flight.state(), GatewayState::SafeReturn, "{earlier:?}");
    }
    let answer = flight.join_after(&["plan", "update"], "second update", last);
    assert!(answer.accepted, "{answer:?}");
    flight.run_until(10.0, "Hold", |f| f.state() == GatewayState::Hold);
    assert_eq!(flight.feed(None, zigzag(10, 12, 300.0)), FeedAnswer::Accepted);
    flight.run_until(20.0, "Nav", |f| f.state() == GatewayState::Nav);
    assert_eq!(flight.station.gateway().snapshot().plan.as_deref(), Some("second update"));
}

#[test]
fn gateway_and_fp_manager_killed_the_next_gateway_knows_the_plan_of_the_flight() {
    let mut flight = Flight::on_zigzag(23, &[], 30, 300.0);
    flight.run(25.0);
    let snapshot = flight.station.gateway().snapshot();
    flight.station = station(Some(snapshot));
    flight.alive = false;
    flight.run_until(15.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
    flight.restart_fp_manager("another plan");
    assert!(!flight.join("another plan").accepted);
    assert!(flight.join("plan").accepted);
}

#[test]
fn fp_manager_back_without_waypoints_goes_home_after_t2_and_only_a_command_stops_that() {
    let mut flight = Flight::in_safe_return(19);
    flight.restart_fp_manager("plan");
    assert!(flight.join("plan").accepted);
    flight.run_until(10.0, "Hold", |f| f.state() == GatewayState::Hold);
    let held = flight.now.as_secs_f64();
    flight.run_until(30.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
    let waited = flight.now.as_secs_f64() - held;
    assert!((19.0..20.3).contains(&waited), "T2 is 20 s, not {waited}");
    let answer = flight.join("plan");
    assert!(!answer.accepted && answer.reason.contains("recover"), "{answer:?}");
    flight.run_until(30.0, "Safe.Return", |f| f.state() == GatewayState::SafeReturn);
    flight.ask(GatewayRequest::Recover).unwrap();
    assert_eq!(flight.feed(None, zigzag(10, 12, 300.0)), FeedAnswer::Accepted);
    flight.run_until(20.0, "Nav", |f| f.state() == GatewayState::Nav);
}

#[test]
fn join_answer_lost_or_killed_before_the_feed_the_waypoints_after_the_second_join_are_flown() {
    for killed in [false, true] {
        let mut flight = Flight::in_safe_return(20);
        flight.restart_fp_manager("plan");
        assert!(flight.join("plan").accepted);
        flight.run_until(10.0, "Hold", |f| f.state() == GatewayState::Hold);
        if killed {
            flight.restart_fp_manager("plan");
        }
        let answer = flight.join("plan");
        assert!(answer.accepted, "{answer:?}");
        assert_eq!(flight.feed(None, zigzag(10, 12, 300.0)), FeedAnswer::Accepted);
        flight.run_until(20.0, "Nav", |f| f.state() == GatewayState::Nav);
        flight.run_until(200.0, "further", |f| f.has_reached(answer.highest.0 + 4));
    }
}

#[test]
fn hold_asked_for_after_the_return_is_not_ended_by_waypoints_nor_by_t2() {
    let mut flight = Flight::in_safe_return(21);
    flight.restart_fp_manager("plan");
    assert!(flight.join("plan").accepted);
    flight.run_until(10.0, "Hold", |f| f.state() == GatewayState::Hold);
    flight.ask(GatewayRequest::Hold).unwrap();
    assert_eq!(flight.feed(None, zigzag(10, 12, 300.0)), FeedAnswer::Accepted);
    flight.run(40.0);
    assert_eq!(flight.state(), GatewayState::Hold);
    flight.ask(GatewayRequest::Resume).unwrap();
    flight.run_until(20.0, "Nav", |f| f.state() == GatewayState::Nav);
}

#[test]
fn safe_mode_commanded_while_it_lasts_already_is_not_ended_by_a_join() {
    let mut flight = Flight::on_zigzag(22, &[], 30, 300.0);
    flight.store_runway();
    flight.run(60.0);
    flight.alive = false;
    for state in [GatewayState::SafeHold, GatewayState::SafeReturn] {
        flight.run_until(40.0, "Safe", |f| f.state() == state);
        flight.ask(GatewayRequest::Safe).unwrap();
        flight.restart_fp_manager("plan");
        let answer = flight.join("plan");
        assert!(!answer.accepted && answer.reason.contains("recover"), "{answer:?}");
        flight.ask(GatewayRequest::Recover).unwrap();
        flight.run_until(20.0, "given back", |f| matches!(f.state(), GatewayState::Nav | GatewayState::Hold));
        flight.alive = false;
    }
}

/// Seconds until the gateway steers to an emergency's first waypoint.
fn switched_after_s(seed: u64, loss: &str) -> f64 {
    let mut flight = Flight::on_zigzag(seed, &[loss], 60, 250.0);
    flight.run(45.0 + (seed % 8) as f64);
    let place = flight.station.gateway().telemetry().position().unwrap().1.position;
    let away = |m: f64| waypoint(place.destination(320.0, m), GROUND_M + 150.0, Action::Fly);
    let replacement: Vec<_> = (1..=20).map(|i| away(f64::from(i) * 400.0)).collect();
    let (at, first) = (flight.now, flight.next);
    assert_eq!(flight.feed(Some(0), replacement.clone()), FeedAnswer::Accepted);
    let done = |f: &Flight| f.progress().iter().flatten().any(|t| *t == first);
    flight.run_until(10.0, "the emergency's first waypoint", done);
    let switched_s = (flight.now - at).as_secs_f64();
    flight.steered.clear();
    flight.run(100.0);
    let known = |p: &LatLon| replacement.iter().any(|w| w.position.distance_m(*p) < 1.0);
    assert!(flight.steered.iter().all(known), "seed {seed}: {:?}", flight.steered);
    switched_s
}

#[test]
fn an_emergency_replaces_everything_at_once_and_no_stale_waypoint_is_steered_to() {
    for (loss, within_s, share) in [("packet-loss=0", 0.6, 1.0), ("packet-loss=0.2", 3.0, 0.95)] {
        let mut times_s: Vec<f64> = (0..60).map(|seed| switched_after_s(seed, loss)).collect();
        times_s.sort_by(f64::total_cmp);
        println!("{loss}: switched after {times_s:.1?}");
        let in_time = times_s.iter().filter(|s| **s <= within_s).count() as f64;
        assert!(in_time >= share * times_s.len() as f64, "{loss}: {times_s:.1?}");
    }
}

/// Heartbeats that show what an order did may be lost as well, and orders of how often something is to be sent.
#[test]
fn at_a_fifth_of_packets_lost_every_launch_succeeds_and_nothing_is_alarming() {
    for seed in 0..60 {
        println!("seed {seed}");
        let mut flight = Flight::new(seed, &["packet-loss=0.2"]);
        flight.store_runway();
        let mut plan = vec![take_off()];
        plan.extend(zigzag(0, 8, 250.0));
        plan.extend(landing());
        flight.launch(plan);
        flight.run_until(900.0, "landing", |f| f.state() == GatewayState::Stop);
        let alarms = flight.events.iter().filter(|(_, e)| matches!(e, GatewayEvent::AlarmRaised(_)));
        assert_eq!(alarms.collect::<Vec<_>>(), Vec::<&(f64, GatewayEvent)>::new());
    }
}

#[test]
fn dry_buffer_without_an_end_holds_and_new_waypoints_heal_it() {
    let mut flight = Flight::on_zigzag(6, &[], 4, 300.0);
    flight.run_until(200.0, "dry", |f| f.state() == GatewayState::SafeHold);
    assert!(flight.events.iter().any(|(_, e)| matches!(e, GatewayEvent::BufferLow { .. })));
    assert_eq!(flight.feed(None, zigzag(4, 6, 300.0)), FeedAnswer::Accepted);
    flight.run_until(100.0, "further", |f| f.progress().iter().flatten().any(|t| *t == 8));
    assert_eq!(flight.state(), GatewayState::Nav);
}

#[test]
fn the_pilot_has_priority_and_gives_back() {
    let mut flight = Flight::on_zigzag(7, &[], 30, 300.0);
    flight.run(10.0);
    assert!(flight.sim.autopilot.set_mode(sim::Mode::FlyByWireA));
    flight.run_until(3.0, "Manual", |f| f.state() == GatewayState::Manual);
    assert!(matches!(flight.feed(None, zigzag(30, 1, 300.0)), FeedAnswer::NotNow(_)));
    flight.run(10.0);
    assert_eq!(flight.sim.autopilot.mode(), sim::Mode::FlyByWireA, "the gateway keeps its hands off");
    assert!(flight.sim.autopilot.set_mode(sim::Mode::Auto));
    flight.run_until(3.0, "Nav", |f| f.state() == GatewayState::Nav);
}

#[test]
fn a_pilot_who_gave_back_may_take_over_again_and_is_seen() {
    let mut flight = Flight::on_zigzag(7, &[], 30, 300.0);
    flight.run(10.0);
    for mode in [sim::Mode::ReturnToLaunch, sim::Mode::Manual, sim::Mode::Guided, sim::Mode::Loiter] {
        assert!(flight.sim.autopilot.set_mode(mode));
        flight.run_until(3.0, "Manual", |f| f.state() == GatewayState::Manual);
        flight.run(5.0);
        assert!(flight.sim.autopilot.set_mode(sim::Mode::Auto));
        flight.run_until(3.0, "Nav", |f| f.state() == GatewayState::Nav);
        flight.run(5.0);
    }
    // and what watches over a flight of the plan does so again
    flight.alive = false;
    flight.run_until(10.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
}

#[test]
fn hold_resume_direct_and_terminate_are_confirmed_by_the_autopilot() {
    let mut flight = Flight::on_zigzag(8, &[], 40, 300.0);
    flight.ask(GatewayRequest::Hold).unwrap();
    assert_eq!(flight.state(), GatewayState::Nav, "nothing is claimed yet");
    flight.run_until(4.0, "Hold", |f| f.state() == GatewayState::Hold);
    assert_eq!(flight.sim.autopilot.mode(), sim::Mode::Loiter);
    flight.run(20.0);
    let direct = GatewayRequest::Direct { heading_deg: 90.0, altitude_amsl_m: 500.0, airspeed_mps: 25.0 };
    flight.ask(direct).unwrap();
    flight.run_until(4.0, "Directed", |f| f.state() == GatewayState::Directed);
    flight.run(60.0);
    let position = flight.station.gateway().telemetry().position().unwrap().1;
    assert!((position.track_deg - 90.0).abs() < 10.0, "{}", position.track_deg);
    assert!((position.altitude_amsl_m - 500.0).abs() < 15.0, "{}", position.altitude_amsl_m);
    flight.ask(GatewayRequest::Resume).unwrap();
    flight.run_until(4.0, "Nav", |f| f.state() == GatewayState::Nav);
    assert!(flight.ask(GatewayRequest::Terminate { confirm: "other".into() }).is_err());
    flight.ask(GatewayRequest::Terminate { confirm: "test".into() }).unwrap();
    flight.run_until(5.0, "disarmed", |f| !f.sim.autopilot.is_armed());
    assert_eq!(flight.state(), GatewayState::Terminate);
}

#[test]
fn a_flight_ended_by_force_stays_ended_when_the_gateway_starts_anew() {
    let mut flight = Flight::on_zigzag(15, &[], 30, 300.0);
    flight.ask(GatewayRequest::Terminate { confirm: "test".into() }).unwrap();
    let json = serde_json::to_string(&flight.station.gateway().snapshot()).unwrap();
    // killed before anything was sent
    flight.station = station(Some(serde_json::from_str(&json).unwrap()));
    flight.run_until(5.0, "disarmed", |f| !f.sim.autopilot.is_armed());
    assert_eq!(flight.state(), GatewayState::Terminate);
    flight.run_until(300.0, "down", |f| f.sim.autopilot.aircraft.state().on_ground);
    let snapshot = flight.station.gateway().snapshot();
    flight.station = station(Some(snapshot));
    flight.run(10.0);
    assert_eq!(flight.state(), GatewayState::Stop, "the next flight is free");
    assert!(!flight.station.gateway().snapshot().terminated);
}

#[test]
fn fp_manager_killed_during_the_take_off_holds_once_clear_of_the_ground() {
    let mut flight = Flight::new(16, &[]);
    flight.run_until(20.0, "heard", |f| {
        f.state() == GatewayState::Stop && f.station.gateway().telemetry().gps.is_some()
    });
    assert!(flight.join("plan").accepted);
    assert_eq!(flight.feed(None, vec![take_off()]), FeedAnswer::Accepted);
    flight.ask(GatewayRequest::Launch).unwrap();
    flight.run_until(20.0, "TakeOff", |f| f.state() == GatewayState::TakeOff);
    flight.alive = false;
    flight.run_until(60.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
    let height_m = flight.station.gateway().telemetry().position().unwrap().1.altitude_home_m;
    assert!((40.0..50.0).contains(&height_m), "{height_m}");
}

/// A plan that is rewound on the ground takes its waypoints back: the take-off that was granted is not begun.
#[test]
fn a_take_off_whose_waypoints_are_taken_back_on_the_ground_is_not_begun() {
    let mut flight = Flight::new(18, &[]);
    flight.run_until(20.0, "heard", |f| {
        f.state() == GatewayState::Stop && f.station.gateway().telemetry().gps.is_some()
    });
    assert!(flight.join("plan").accepted);
    let mut plan = vec![take_off()];
    plan.extend(zigzag(0, 10, 300.0));
    assert_eq!(flight.feed(None, plan), FeedAnswer::Accepted);
    flight.ask(GatewayRequest::Launch).unwrap();
    assert_eq!(flight.feed(Some(0), vec![]), FeedAnswer::Accepted);
    flight.run(60.0);
    assert_eq!(flight.state(), GatewayState::Stop);
    assert!(!flight.sim.autopilot.is_armed());
    assert!(flight.ask(GatewayRequest::Launch).is_err(), "there is nothing to fly");
    // and the next flight is free
    flight.launch(vec![take_off(), zigzag(0, 1, 300.0).remove(0)]);
}

#[test]
fn a_landing_cancelled_on_the_approach_does_not_circle_for_ever() {
    let mut flight = Flight::new(17, &[]);
    let mut plan = vec![take_off()];
    plan.extend(zigzag(0, 2, 300.0));
    plan.extend(landing());
    flight.launch(plan);
    flight.run_until(900.0, "Approach", |f| f.state() == GatewayState::Approach);
    assert_eq!(flight.feed(Some(5), vec![]), FeedAnswer::Accepted);
    flight.run_until(200.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
}

#[test]
fn state_that_cannot_be_stored_is_an_alarm_until_it_can() {
    let mut flight = Flight::new(24, &[]);
    for (stored, alarms) in [(false, 1), (true, 0)] {
        flight.station.input(flight.now, Input::Stored(stored));
        let raised = flight.station.gateway().status(flight.now).alarms;
        assert_eq!(raised.iter().filter(|a| a.id == "not-stored").count(), alarms, "{raised:?}");
    }
}

fn has_raised(flight: &Flight, id: &str) -> bool {
    flight.events.iter().any(|(_, e)| matches!(e, GatewayEvent::AlarmRaised(a) if a.id == id))
}

/// As ArduPlane, which says nothing of an engine that fails.
#[test]
fn an_engine_that_fails_and_has_no_rpm_reading_is_suspected_before_the_ground() {
    let mut flight = Flight::on_zigzag(10, &["no-rpm", "engine-out@90"], 40, 300.0);
    flight.run_until(150.0, "engine-suspected", |f| has_raised(f, "engine-suspected"));
    assert!(has_raised(&flight, "sinks") && !has_raised(&flight, "engine-out"));
    assert!(flight.sim.autopilot.aircraft.state().altitude_amsl_m > 400.0);
}

/// As PX4, whose detector tells of it.
#[test]
fn an_engine_that_its_autopilot_warns_of_is_suspected_before_much_height_is_lost() {
    let mut flight = Flight::on_ground(Personality::Px4, 10, &["no-rpm"]);
    flight.launch(std::iter::once(take_off()).chain(zigzag(0, 40, 300.0)).collect());
    flight.run(60.0);
    let from_m = flight.sim.autopilot.aircraft.state().altitude_amsl_m;
    assert!(flight.sim.inject("engine-out".parse().unwrap()));
    flight.run_until(12.0, "engine-suspected", |f| has_raised(f, "engine-suspected"));
    assert!(!has_raised(&flight, "sinks") && !has_raised(&flight, "engine-out"));
    assert!(flight.sim.autopilot.aircraft.state().altitude_amsl_m > from_m - 20.0);
}

/// ArduPlane forgets what it was told with each change of its mode.
#[test]
fn after_a_hold_the_airspeed_of_the_plan_is_flown_again() {
    let mut flight = Flight::new(61, &[]);
    let slow = zigzag(0, 20, 400.0).into_iter().map(|w| Waypoint { airspeed_mps: 20.0, ..w });
    flight.launch(std::iter::once(take_off()).chain(slow).collect());
    flight.run_until(60.0, "slow", |f| f.sim.autopilot.airspeed_mps() == 20.0);
    flight.ask(GatewayRequest::Hold).unwrap();
    flight.run_until(10.0, "Hold", |f| f.state() == GatewayState::Hold);
    flight.ask(GatewayRequest::Resume).unwrap();
    flight.run_until(10.0, "Nav", |f| f.state() == GatewayState::Nav);
    flight.run_until(5.0, "slow again", |f| f.sim.autopilot.airspeed_mps() == 20.0);
}

/// As ArduPlane does with a stopped engine: it pulls up to keep the altitude, and gives away its speed first.
#[test]
fn an_aircraft_that_gets_slow_at_full_throttle_is_told_and_its_engine_suspected() {
    let mut flight = Flight::on_zigzag(10, &["no-rpm", "ice@90"], 40, 300.0);
    let raised = |f: &Flight, id: &str| {
        f.events.iter().any(|(_, e)| matches!(e, GatewayEvent::AlarmRaised(a) if a.id == id))
    };
    flight.run_until(110.0, "slow", |f| raised(f, "slow") && raised(f, "engine-suspected"));
    assert!(!raised(&flight, "sinks"), "it has lost no height yet");
}

#[test]
fn somebody_else_in_command_is_an_alarm_until_the_plan_is_flown_again() {
    let mut flight = Flight::on_zigzag(7, &[], 30, 300.0);
    flight.run(10.0);
    assert!(flight.sim.autopilot.set_mode(sim::Mode::ReturnToLaunch));
    flight.run_until(3.0, "Manual", |f| f.state() == GatewayState::Manual);
    flight.run(0.2);
    let told = |e: &GatewayEvent| matches!(e, GatewayEvent::AlarmRaised(a) if a.id == "not-in-command");
    assert!(flight.events.iter().any(|(_, e)| told(e)));
    assert!(flight.sim.autopilot.set_mode(sim::Mode::Auto));
    flight.run_until(3.0, "Nav", |f| f.state() == GatewayState::Nav);
    flight.run(0.2);
    let over = |e: &GatewayEvent| matches!(e, GatewayEvent::AlarmCleared { id } if id == "not-in-command");
    assert!(flight.events.iter().any(|(_, e)| over(e)));
}

#[test]
fn alarms_of_the_simulators_faults_reach_the_events() {
    for (fault, id, within_s) in [
        ("gps-loss@90", "gps-lost", 2.0),
        ("engine-out@90", "engine-out", 4.0),
        ("low-battery@90", "energy-low", 3.0),
        ("silence@90+8", "autopilot-silent", 4.0),
    ] {
        let mut flight = Flight::on_zigzag(10, &[fault], 40, 300.0);
        let raised = |f: &Flight| {
            f.events.iter().any(|(_, e)| matches!(e, GatewayEvent::AlarmRaised(a) if a.id == id))
        };
        flight.run_until(100.0, id, raised);
        let after_s = flight.now.as_secs_f64() - 90.0;
        assert!((0.0..within_s).contains(&after_s), "{id} after {after_s} s");
    }
}
