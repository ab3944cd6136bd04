//! Whole flights on a simulated PX4, whose list is replaced whole.

use super::*;

fn flight(personality: Personality, seed: u64, faults: &[&str]) -> Flight {
    let mut flight = Flight::of(personality, seed, faults);
    assert!(flight.sim.autopilot.params.set("MIS_TKO_LAND_REQ", 0.0));
    // it is asked for its parameter first
    while !flight.ask(GatewayRequest::Launch).unwrap_err().contains("nothing to fly") {
        flight.step();
    }
    flight
}

fn tokens(flight: &Flight) -> Vec<u64> {
    flight.progress().into_iter().flatten().collect()
}

#[test]
fn a_flight_of_more_waypoints_than_the_ring_holds_is_flown_from_take_off_to_landing() {
    for personality in [Personality::Px4, Personality::Px4Vtol] {
        let mut flight = flight(personality, 1, &[]);
        let mut plan = vec![take_off()];
        plan.extend(zigzag(0, 60, 150.0));
        plan.extend(zigzag(0, 59, 150.0).into_iter().rev());
        plan.extend(landing());
        let last = plan.len() as u64;
        flight.launch(plan);
        flight.run_until(2400.0, "landing", |f| f.state() == GatewayState::Stop);
        assert_eq!(tokens(&flight), (1..=last).collect::<Vec<_>>());
        let states: Vec<_> = flight.changes().into_iter().map(|c| c.1).collect();
        use GatewayState::*;
        assert_eq!(states, [Stop, TakeOff, Nav, Approach, Land, Stop]);
    }
}

#[test]
fn packets_lost_0_to_20_percent_the_same_waypoints_are_flown() {
    for (seed, loss) in [(11, 0.0), (12, 0.1), (13, 0.2)] {
        println!("seed {seed}, loss {loss}");
        let fault = format!("packet-loss={loss}");
        let mut flight = flight(Personality::Px4, seed, &[&fault, "duplicate=0.1"]);
        let mut plan = vec![take_off()];
        plan.extend(zigzag(0, 50, 250.0));
        flight.launch(plan);
        flight.run_until(1500.0, "the 45th waypoint", |f| f.has_reached(45));
        let tokens = tokens(&flight);
        assert!(tokens.windows(2).all(|w| w[0] < w[1]), "{tokens:?}");
    }
}

#[test]
fn cancelled_waypoints_are_not_flown_and_a_hold_and_a_heading_are_what_they_are() {
    let mut flight = flight(Personality::Px4, 3, &[]);
    flight.launch(std::iter::once(take_off()).chain(zigzag(0, 20, 300.0)).collect());
    flight.run_until(120.0, "the fifth", |f| f.has_reached(5));
    let other = zigzag(8, 6, 280.0);
    let first = flight.next;
    assert_eq!(flight.feed(Some(5), other), FeedAnswer::Accepted);
    flight.run_until(120.0, "the new ones", |f| f.has_reached(first + 1));
    assert!(tokens(&flight).iter().all(|t| *t <= 5 || *t >= first), "{:?}", tokens(&flight));
    flight.ask(GatewayRequest::Hold).unwrap();
    flight.run_until(5.0, "Hold", |f| f.state() == GatewayState::Hold);
    let altitude_amsl_m = GROUND_M + 150.0;
    let direct = GatewayRequest::Direct { heading_deg: 90.0, altitude_amsl_m, airspeed_mps: 24.0 };
    flight.ask(direct).unwrap();
    flight.run_until(5.0, "Directed", |f| f.state() == GatewayState::Directed);
    flight.run(20.0);
    assert_eq!(flight.state(), GatewayState::Directed);
    flight.ask(GatewayRequest::Resume).unwrap();
    flight.run_until(5.0, "Nav", |f| f.state() == GatewayState::Nav);
    flight.run_until(300.0, "the last one", |f| f.has_reached(first + 5));
}

/// Corners of a square right of the runway, 1.2 km a side.
fn corner(n: usize) -> Waypoint {
    let (ahead_m, right_m) = [(1800.0, 0.0), (1800.0, 1200.0), (600.0, 1200.0), (600.0, 0.0)][n % 4];
    let position = HOME.destination(HEADING_DEG, ahead_m).destination(HEADING_DEG + 90.0, right_m);
    waypoint(position, GROUND_M + 120.0, Action::Fly)
}

/// How far it is from the line between two positions, metres.
fn aside_m(flight: &Flight, from: LatLon, to: LatLon) -> f64 {
    let frame = geometry::LocalFrame::new(from);
    let line = frame.to_local(to);
    (line.cross(frame.to_local(flight.sim.autopilot.aircraft.state().position)) / line.length()).abs()
}

#[test]
fn legs_are_flown_along_their_lines_however_often_the_list_is_replaced() {
    let mut flight = flight(Personality::Px4, 1, &[]);
    flight.launch(std::iter::once(take_off()).chain((0..4).map(corner)).collect());
    for n in 1..12 {
        flight.run_until(120.0, "the next side", |f| f.has_reached(n as u64 + 2));
        // as a plan whose corners come one by one, each in the turn at another
        flight.feed(None, vec![corner(n + 3)]);
        let (from, to) = (corner(n - 1).position, corner(n).position);
        flight.run(25.0);
        assert!(aside_m(&flight, from, to) < 15.0, "side {n}: {:.0} m", aside_m(&flight, from, to));
    }
}

#[test]
fn a_failsafe_of_px4_is_left_alone_and_called_what_it_is() {
    let mut flight = flight(Personality::Px4, 1, &[]);
    assert!(flight.sim.autopilot.params.set("COM_LOW_BAT_ACT", 3.0));
    assert!(flight.sim.autopilot.params.set("BAT_CRIT_THR", 0.2));
    flight.launch(std::iter::once(take_off()).chain(zigzag(0, 20, 300.0)).collect());
    assert!(flight.sim.inject("low-battery".parse().unwrap()));
    flight.run_until(300.0, "Manual", |f| f.state() == GatewayState::Manual);
    let cause = flight.station.gateway().status(flight.now).cause;
    let (what, why) = ("the autopilot was switched to Hold, while a failsafe of it is active", "critical");
    assert!(cause.starts_with(what) && cause.contains(why), "{cause}");
    let returns = |f: &Flight| f.sim.autopilot.mode() == sim::Mode::ReturnToLaunch;
    flight.run_until(10.0, "its return", returns);
    flight.run(20.0);
    assert!(returns(&flight) && flight.state() == GatewayState::Manual);
    flight.ask(GatewayRequest::Resume).unwrap();
    flight.run_until(5.0, "Nav", |f| f.state() == GatewayState::Nav);
    flight.run(20.0);
    assert_eq!(flight.state(), GatewayState::Nav, "overruled once, it does not begin again");
}

/// PX4 accepts no list while the aircraft is outside of its fence, and judges none twice.
#[test]
fn a_list_that_came_while_the_fence_was_broken_is_brought_anew_when_it_is_to_be_flown() {
    let mut flight = Flight::in_flight(Personality::Px4, 5);
    flight.sim.autopilot.fence.radius_m = Some(300.0);
    flight.run_until(10.0, "its return", |f| f.state() == GatewayState::Manual);
    flight.ask(GatewayRequest::Resume).unwrap();
    flight.run_until(10.0, "Nav", |f| f.state() == GatewayState::Nav);
    let after = flight.station.gateway().navigation().current.unwrap().0;
    assert_eq!(flight.feed(Some(after), zigzag(12, 12, 300.0)), FeedAnswer::Accepted);
    flight.run_until(30.0, "its list is refused", |f| f.state() == GatewayState::Manual);
    let cause = flight.station.gateway().status(flight.now).cause;
    assert!(cause.contains("does not accept its list"), "{cause}");
    flight.sim.autopilot.fence.radius_m = None;
    flight.run(5.0);
    flight.ask(GatewayRequest::Resume).unwrap();
    flight.run_until(60.0, "Nav again", |f| f.state() == GatewayState::Nav);
    flight.run(20.0);
    assert_eq!(flight.state(), GatewayState::Nav);
}

#[test]
fn fp_manager_killed_the_gateway_returns_and_lands_by_itself() {
    let mut flight = flight(Personality::Px4, 2, &[]);
    flight.launch(std::iter::once(take_off()).chain(zigzag(0, 30, 300.0)).collect());
    flight.store_runway();
    flight.run(30.0);
    flight.alive = false;
    flight.run_until(900.0, "landed", |f| f.state() == GatewayState::Stop);
    let states: Vec<_> = flight.changes().into_iter().map(|c| c.1).collect();
    use GatewayState::*;
    assert_eq!(states[3..], [SafeHold, SafeReturn, SafeApproach, SafeLand, Stop]);
}

#[test]
fn a_parameter_that_forbids_long_flights_is_named_before_the_launch() {
    let mut flight = Flight::of(Personality::Px4, 1, &[]);
    flight.run_until(20.0, "heard", |f| {
        f.state() == GatewayState::Stop && f.station.gateway().telemetry().gps.is_some()
    });
    assert!(flight.join("plan").accepted);
    flight.feed(None, std::iter::once(take_off()).chain(zigzag(0, 20, 300.0)).collect());
    flight.run(5.0);
    let unfit = |flight: &Flight| flight.station.gateway().status(flight.now).unfit;
    let why = flight.ask(GatewayRequest::Launch).unwrap_err();
    assert!(why.contains("MIS_TKO_LAND_REQ is 2"), "{why}");
    assert_eq!(unfit(&flight), Some(why), "also before anybody asks");
    assert!(flight.sim.autopilot.params.set("MIS_TKO_LAND_REQ", 0.0));
    flight.run(5.0);
    assert_eq!(unfit(&flight), None);
}

/// On the ground with a plan, and launched as soon as that is allowed.
fn launched_early() -> Flight {
    let mut flight = flight(Personality::Px4, 1, &[]);
    assert!(flight.join("plan").accepted);
    flight.feed(None, std::iter::once(take_off()).chain(zigzag(0, 20, 300.0)).collect());
    while flight.ask(GatewayRequest::Launch).is_err() {
        flight.step();
    }
    flight
}

#[test]
fn one_that_still_starts_up_is_asked_again_until_it_arms() {
    let mut flight = launched_early();
    assert!(flight.now.as_secs_f64() < 4.0, "{:?}", flight.now);
    flight.run_until(10.0, "take-off", |f| f.state() == GatewayState::TakeOff);
}

#[test]
fn one_that_never_arms_is_refused_in_the_end() {
    let mut flight = launched_early();
    assert!(flight.sim.autopilot.params.set("MIS_TKO_LAND_REQ", 2.0));
    flight.feed(None, std::iter::once(take_off()).chain(zigzag(0, 10, 300.0)).collect());
    flight.run(15.0);
    assert!(flight.report().contains("asked again"), "{}", flight.report());
    flight.run(15.0);
    assert!(flight.report().contains("launch refused by the autopilot"), "{}", flight.report());
    assert_eq!(flight.state(), GatewayState::Stop);
}

/// A gateway without memory took that for the end of its list, and the aircraft out of his Hold.
#[test]
fn a_hold_at_a_waypoint_is_the_pilots_whatever_the_gateway_remembers() {
    let mut flight = Flight::in_flight(Personality::Px4, 65);
    flight.run_until(120.0, "the third", |f| f.has_reached(3));
    assert!(flight.sim.autopilot.set_mode(sim::Mode::Loiter));
    let places =
        |f: &Flight| f.sim.autopilot.mission.items().iter().map(|item| item.position).collect::<Vec<_>>();
    let list = places(&flight);
    flight.station = station(None);
    flight.run_until(10.0, "Manual", |f| f.state() == GatewayState::Manual);
    flight.run(40.0);
    assert_eq!((flight.state(), flight.sim.autopilot.mode()), (GatewayState::Manual, sim::Mode::Loiter));
    assert_eq!(places(&flight), list, "it is not written over");
}

/// By itself it flies another one behind a take-off.
#[test]
fn the_departure_is_flown_at_the_airspeed_of_the_plan() {
    let mut flight = flight(Personality::Px4, 7, &[]);
    let slow = zigzag(0, 6, 900.0).into_iter().map(|w| Waypoint { airspeed_mps: 20.0, ..w });
    assert_ne!(flight.sim.autopilot.airspeed_mps(), 20.0);
    flight.launch(std::iter::once(take_off()).chain(slow).collect());
    flight.run_until(5.0, "slow", |f| f.sim.autopilot.airspeed_mps() == 20.0);
    assert!(!flight.has_reached(3), "on the first leg");
}
