//! The core alone: what it says and orders upon what is reported to it.

mod by_hand;
mod climb_out;
mod disarmed;
mod down;
mod ended;
mod launching;
mod let_loose;
pub mod losses;
mod met;
mod moments;
mod no_further;
mod random;
mod refused;
mod replaced;
mod returning;
mod taken;

use super::*;
use crate::gateway::order::{Fix, Kind, Target};
use crate::gateway::tests::fp_manager;
use usal::contract::{Air, Feed, FeedAnswer, GatewayRequest, Gps, Join, JoinAnswer};

/// What is flown here.
const PLANE: Kind = Kind { name: "a plane", habits: None, landing_deg: None, version: None };

/// A core, and what came out of it.
struct Core {
    gateway: Gateway,
    now: Time,
    out: Vec<Output>,
    beats: u64,
}

impl Core {
    fn new() -> Self {
        Self::started_anew(None)
    }

    fn started_anew(restored: Option<Snapshot>) -> Self {
        let gateway = Gateway::new(crate::gateway::tests::flights::settings(), restored);
        Self { gateway, now: Time::ZERO, out: vec![], beats: 0 }
    }

    fn step(&mut self, input: Input) {
        self.gateway.step(self.now, input, &mut self.out);
    }

    /// So many seconds, in each tenth of which this is reported; the FP Manager lives.
    fn run(&mut self, seconds: u64, reports: &[Report]) {
        for _ in 0..10 * seconds {
            self.now += Duration::from_millis(100);
            self.beats += 1;
            let (count, plan, from) = (self.beats, Some("plan".into()), fp_manager());
            self.step(Input::Heartbeat { count, plan, from });
            reports.iter().for_each(|report| self.step(Input::Report(report.clone())));
            self.step(Input::Tick);
        }
    }

    /// Everything that was ordered is done.
    fn done(&mut self) {
        let ordered = self.orders().into_iter().map(|(id, _)| id).collect::<Vec<_>>();
        self.out.clear();
        ordered.into_iter().for_each(|id| self.step(Input::Report(Report::Done(id))));
    }

    fn orders(&self) -> Vec<(OrderId, Order)> {
        let order = |output: &Output| match output {
            Output::Order(id, order) => Some((*id, order.clone())),
            _ => None,
        };
        self.out.iter().filter_map(order).collect()
    }

    /// What is answered to this.
    fn answer(&mut self, input: Input) -> Answer {
        self.step(input);
        let answer = |output: &Output| match output {
            Output::Answer(_, answer) => Some(answer.clone()),
            _ => None,
        };
        self.out.iter().rev().find_map(answer).expect("each is answered")
    }

    fn join(&mut self) -> JoinAnswer {
        let join = Join { plan: Some("plan".into()), earlier: vec![], last_token: Token(10) };
        let Answer::Join(answer) = self.answer(Input::Join(1, join, fp_manager())) else { panic!() };
        answer
    }

    fn was_ordered(&self, wanted: &Order) -> bool {
        self.orders().iter().any(|(_, order)| order == wanted)
    }

    fn raised(&self, id: &str) -> bool {
        self.gateway.alarms.raised().iter().any(|alarm| alarm.id == id)
    }

    /// On the ground, with waypoints to be flown.
    fn in_stop_with_a_plan() -> Self {
        Self::in_stop_with(crate::gateway::tests::flights::zigzag(0, 10, 300.0))
    }

    fn in_stop_with(waypoints: Vec<Waypoint>) -> Self {
        let mut core = Self::new();
        let gps = Gps { fix_3d: true, satellites: Some(12), hdop: 0.8, unix_s: None };
        let ground = [beat(Mode::Hold, false), Report::OnGround(true), fix(0.0), Report::Gps(gps)];
        core.step(Input::Report(Report::Capability(Ok(PLANE))));
        core.run(1, &ground);
        let join = Join { plan: Some("plan".into()), earlier: vec![], last_token: Token(0) };
        core.step(Input::Join(1, join, fp_manager()));
        let number = |(i, w): (usize, Waypoint)| Waypoint { token: Token(i as u64 + 1), ..w };
        let waypoints = waypoints.into_iter().enumerate().map(number);
        let feed = Feed { cancel_after: None, waypoints: waypoints.collect() };
        core.step(Input::Feed(2, feed, fp_manager()));
        core
    }

    /// It flies the first of some waypoints.
    fn in_nav() -> Self {
        let mut core = Self::in_stop_with_a_plan();
        core.step(Input::Request(3, GatewayRequest::Launch));
        core.step(Input::Report(Report::Course(course(true))));
        core.run(1, &flying(25.0, 25.0));
        core.done();
        assert_eq!(core.gateway.state(), GatewayState::Nav);
        core
    }
}

fn course(ready: bool) -> Course {
    Course { aboard: true, ready, target: Target::Waypoint(crate::gateway::order::Serial(1)) }
}

fn beat(mode: Mode, armed: bool) -> Report {
    Report::Heartbeat { mode, name: format!("{mode:?}").into(), armed, failsafe: false }
}

fn fix(north_mps: f64) -> Report {
    let (position, altitude_amsl_m) = (LatLon::new(36.32, -84.17), 470.0);
    let (altitude_home_m, east_mps, down_mps) = (120.0, 0.0, 0.0);
    Report::Fix(Fix { position, altitude_amsl_m, altitude_home_m, north_mps, east_mps, down_mps })
}

fn air(airspeed_mps: f64) -> Report {
    let (wind_east_mps, wind_north_mps) = (0.0, 0.0);
    Report::Air(Air { airspeed_mps, wind_east_mps, wind_north_mps, pressure_hpa: 960.0, temperature_c: 15.0 })
}

/// In the air by its waypoints, at a speed over the ground and an airspeed, m/s.
fn flying(ground_mps: f64, airspeed_mps: f64) -> [Report; 4] {
    [beat(Mode::Waypoints, true), Report::OnGround(false), fix(ground_mps), air(airspeed_mps)]
}

/// Each second faster by so much, up to the end, m/s.
fn accelerate(core: &mut Core, from: f64, by: f64, to: f64, throttle: f64) -> bool {
    let (mut mps, mut raised) = (from, false);
    while mps < to {
        let mut reports = flying(mps, mps).to_vec();
        reports.push(Report::Throttle(throttle));
        core.run(1, &reports);
        raised |= core.raised("slow") || core.raised("engine-suspected");
        mps += by;
    }
    raised
}

#[test]
fn an_aircraft_that_still_gains_speed_is_not_slow() {
    let mut core = Core::in_nav();
    core.gateway.order_speed(54.0, &mut core.out);
    core.done();
    assert!(!accelerate(&mut core, 25.0, 1.0, 54.0, 1.0), "it does what it can");
    let mut core = Core::in_nav();
    core.run(15, &[&flying(15.0, 15.0)[..], &[Report::Throttle(1.0)]].concat());
    assert!(core.raised("slow") && core.raised("engine-suspected"));
}

#[test]
fn an_airspeed_that_is_no_longer_told_makes_nobody_slow() {
    let mut core = Core::in_nav();
    core.run(2, &flying(15.0, 15.0));
    core.run(20, &flying(15.0, 15.0)[..3]);
    assert!(!core.raised("slow"));
}

/// It circles at a speed of its own, if it forgets the one that it was told.
#[test]
fn in_a_hold_slow_is_slower_than_it_may_fly() {
    for (airspeed_mps, slow) in [(18.0, false), (12.0, true)] {
        let mut core = Core::in_nav();
        core.gateway.order_speed(30.0, &mut core.out);
        core.done();
        core.step(Input::Request(4, GatewayRequest::Hold));
        let mut reports = flying(airspeed_mps, airspeed_mps);
        reports[0] = beat(Mode::Hold, true);
        core.run(15, &reports);
        assert_eq!(core.gateway.state(), GatewayState::Hold);
        assert_eq!(core.raised("slow"), slow, "{airspeed_mps}");
    }
}

/// A write to the list that was under way failed, and is done again only by hands that may.
#[test]
fn an_aircraft_that_is_to_be_taken_back_is_written_to_again() {
    let mut core = Core::in_nav();
    let mut by_pilot = flying(25.0, 25.0);
    by_pilot[0] = beat(Mode::Other(5), true);
    core.run(1, &by_pilot);
    assert_eq!(core.gateway.state(), GatewayState::Manual);
    assert!(core.was_ordered(&Order::HandsOff(true)));
    core.step(Input::Report(Report::Course(course(false))));
    core.run(5, &by_pilot);
    assert!(!core.was_ordered(&Order::HandsOff(false)));
    core.step(Input::Request(4, GatewayRequest::Resume));
    assert!(core.was_ordered(&Order::HandsOff(false)), "the list is written anew");
    core.step(Input::Report(Report::Course(course(true))));
    core.run(1, &by_pilot);
    assert!(core.was_ordered(&Order::Steer(crate::gateway::order::Aim::Waypoints)));
    core.run(1, &flying(25.0, 25.0));
    assert_eq!(core.gateway.state(), GatewayState::Nav);
}

#[test]
fn what_is_no_longer_heard_on_the_ground_is_not_in_flight() {
    let mut core = Core::in_nav();
    assert!(core.gateway.is_in_flight());
    let mut landed = flying(0.0, 0.0);
    landed[1] = Report::OnGround(true);
    core.run(1, &landed);
    core.run(11, &[]);
    assert!(!core.gateway.is_in_flight(), "its battery was pulled, perhaps");
}

/// An agent that is told to end waits for it, and must be there when the link is.
#[test]
fn what_is_no_longer_heard_in_the_air_is_in_flight_until_it_must_have_come_down() {
    let mut core = Core::in_nav();
    core.run(1, &flying(25.0, 25.0));
    core.run(300, &[]);
    assert!(core.gateway.is_in_flight());
    core.run(3400, &[]);
    assert!(!core.gateway.is_in_flight());
}

#[test]
fn what_was_just_met_in_the_air_is_in_flight() {
    let mut core = Core::new();
    core.run(1, &flying(25.0, 25.0));
    assert_eq!(core.gateway.state(), GatewayState::Off, "what it has aboard is not known yet");
    assert!(core.gateway.is_in_flight());
}

/// The autopilot's word for it may be lost on a bad link.
#[test]
fn what_moves_does_not_stand_though_it_does_not_say_that_it_flies() {
    let mut core = Core::new();
    let [beat, _, fix, air] = flying(20.0, 25.0);
    core.run(8, &[beat, fix, air]);
    assert_eq!(core.gateway.state(), GatewayState::Off);
    assert!(core.orders().iter().any(|(_, order)| matches!(order, Order::Adopt(_))), "it was met in flight");
    let mut core = Core::new();
    core.run(8, &[self::beat(Mode::Hold, true), self::fix(0.0)]);
    assert_eq!(core.gateway.state(), GatewayState::Stop);
}

#[test]
fn an_aircraft_whose_list_cannot_be_read_is_in_somebody_elses_hands() {
    let mut core = Core::new();
    for second in 0..65 {
        core.run(1, &flying(25.0, 25.0));
        for (id, _) in core.orders() {
            core.step(Input::Report(Report::Failed(id, "no answer".into())));
        }
        core.out.clear();
        assert_eq!(core.gateway.state() == GatewayState::Manual, second >= 60, "{second} s");
    }
    core.run(1, &flying(25.0, 25.0));
    assert!(core.raised("not-in-command"));
}

/// What was taken before would be lost when the flight is taken over.
#[test]
fn nobody_joins_or_feeds_before_it_is_known_what_the_aircraft_flies() {
    let mut core = Core::started_anew(Some(Core::in_nav().gateway.snapshot()));
    let next =
        || Feed { cancel_after: None, waypoints: crate::gateway::tests::flights::zigzag(10, 1, 300.0) };
    for heard in [false, true] {
        let answer = core.join();
        assert!(!answer.accepted && answer.reason.contains("not heard") != heard, "{answer:?}");
        let fed = core.answer(Input::Feed(2, next(), fp_manager()));
        assert!(matches!(fed, Answer::Feed(FeedAnswer::NotNow(_))), "{fed:?}");
        core.run(1, &flying(25.0, 25.0));
        assert_eq!(core.gateway.state(), GatewayState::Off);
    }
    let (adopt, order) =
        core.orders().into_iter().rfind(|(_, order)| matches!(order, Order::Adopt(_))).unwrap();
    let Order::Adopt(known) = order else { unreachable!() };
    core.step(Input::Report(Report::Adopted(adopt, Some(known.len()))));
    core.step(Input::Report(Report::Course(course(true))));
    let answer = core.join();
    let has = (answer.accepted, answer.current, answer.last, answer.highest);
    assert_eq!(has, (true, Some(Token(1)), Some(Token(10)), Token(10)), "{answer:?}");
    let mut feed = next();
    feed.waypoints[0].token = Token(11);
    assert_eq!(core.answer(Input::Feed(2, feed, fp_manager())), Answer::Feed(FeedAnswer::Accepted));
    assert_eq!(core.gateway.navigation().last, Some(Token(11)));
}

#[test]
fn a_position_that_is_not_known_yet_is_no_runway_out_of_reach() {
    let set = |runways| Input::Request(4, GatewayRequest::SetRunways { runways });
    let home = crate::gateway::tests::flights::runway_at(LatLon::new(36.3190, -84.1730));
    let mut core = Core::in_nav();
    assert_eq!(core.answer(set(vec![home.clone()])), Answer::Request(Ok(())));
    let mut core = Core::started_anew(Some(core.gateway.snapshot()));
    core.run(1, &flying(25.0, 25.0)[..2]);
    assert_eq!(core.answer(set(vec![home.clone()])), Answer::Request(Ok(())), "they are stored");
    let other = SafeRunway { id: "R23".into(), ..home };
    let Answer::Request(Err(why)) = core.answer(set(vec![other.clone()])) else { panic!() };
    assert!(why.contains("Without a position"), "{why}");
    core.run(1, &flying(25.0, 25.0));
    assert_eq!(core.answer(set(vec![other])), Answer::Request(Ok(())));
}

/// That none of its waypoints is known is no reason to leave it to nobody: Safe mode sees to it, until the FP Manager is back.
#[test]
fn an_aircraft_whose_list_is_ours_after_all_is_taken_back() {
    let mut core = Core::new();
    core.run(62, &flying(25.0, 25.0));
    assert_eq!(core.gateway.state(), GatewayState::Manual);
    let (adopt, _) = core.orders().into_iter().find(|(_, order)| matches!(order, Order::Adopt(_))).unwrap();
    core.step(Input::Report(Report::Adopted(adopt, Some(0))));
    core.step(Input::Report(Report::Course(Course { aboard: true, ready: true, target: Target::End })));
    core.run(1, &flying(25.0, 25.0));
    assert_ne!(core.gateway.state(), GatewayState::Manual);
}

/// What was asked to be read.
fn adoption(core: &Core) -> OrderId {
    core.orders().into_iter().rev().find(|(_, order)| matches!(order, Order::Adopt(_))).unwrap().0
}

fn was_steered(core: &Core) -> bool {
    core.orders().iter().any(|(_, order)| matches!(order, Order::Steer(_)))
}

#[test]
fn a_pilot_who_takes_over_while_the_list_is_read_keeps_the_aircraft() {
    for mode in [Mode::Other(5), Mode::Return, Mode::Hold] {
        let mut core = Core::new();
        core.run(2, &flying(25.0, 25.0));
        let adopt = adoption(&core);
        let mut by_pilot = flying(25.0, 25.0);
        by_pilot[0] = beat(mode, true);
        core.run(2, &by_pilot);
        core.step(Input::Report(Report::Adopted(adopt, Some(0))));
        core.step(Input::Report(Report::Course(Course { aboard: true, ready: true, target: Target::End })));
        core.run(5, &by_pilot);
        assert_eq!(core.gateway.state(), GatewayState::Manual, "{mode:?}");
        assert!(!was_steered(&core), "{mode:?}");
        core.run(2, &flying(25.0, 25.0));
        assert_ne!(core.gateway.state(), GatewayState::Manual, "{mode:?}: he gave it back");
    }
}

#[test]
fn a_pilot_who_gives_back_and_takes_again_while_the_list_is_read_keeps_the_aircraft() {
    let mut core = Core::new();
    let mut by_pilot = flying(25.0, 25.0);
    by_pilot[0] = beat(Mode::Other(5), true);
    core.gateway.adopting = Some(Snapshot { intent: Intent::Fly, ..core.gateway.snapshot() });
    core.run(2, &by_pilot);
    core.run(2, &flying(25.0, 25.0));
    let adopt = adoption(&core);
    core.run(1, &by_pilot);
    core.step(Input::Report(Report::Adopted(adopt, Some(0))));
    core.step(Input::Report(Report::Course(Course { aboard: true, ready: true, target: Target::End })));
    core.run(5, &by_pilot);
    assert_eq!(core.gateway.state(), GatewayState::Manual);
    assert!(!was_steered(&core));
}

/// In the air by its waypoints at 470 m, so far above that, and sinking so fast.
fn at_height(above_m: f64, down_mps: f64) -> [Report; 4] {
    let Report::Fix(fix) = fix(25.0) else { panic!() };
    let mut reports = flying(25.0, 25.0);
    reports[2] = Report::Fix(Fix { altitude_amsl_m: fix.altitude_amsl_m + above_m, down_mps, ..fix });
    reports
}

#[test]
fn far_above_or_below_its_altitude_and_no_nearer_is_told_and_a_lag_is_not() {
    for (above_m, down_mps, told) in [
        (120.0, 0.0, true),
        (-120.0, 0.0, true),
        (120.0, -0.5, true),
        (-120.0, 0.5, true),
        (120.0, 2.0, false),
        (-120.0, -2.0, false),
        (-40.0, 0.0, false),
        (40.0, 0.0, false),
    ] {
        let mut core = Core::in_nav();
        core.run(8, &at_height(above_m, down_mps));
        assert!(!core.raised("off-altitude"));
        core.run(5, &at_height(above_m, down_mps));
        assert_eq!(core.raised("off-altitude"), told, "{above_m} m, {down_mps} m/s");
    }
}

/// A wave carries it up, or somebody turns a knob.
#[test]
fn a_hold_that_leaves_its_altitude_is_told() {
    for (above_m, told) in [(120.0, true), (-120.0, true), (40.0, false)] {
        let mut core = Core::in_nav();
        core.step(Input::Request(4, GatewayRequest::Hold));
        let holding = |above_m| {
            let mut reports = at_height(above_m, 0.0);
            reports[0] = beat(Mode::Hold, true);
            reports
        };
        core.run(15, &holding(0.0));
        assert_eq!(core.gateway.state(), GatewayState::Hold);
        assert!(!core.raised("off-altitude"), "it holds where it was told to");
        core.run(15, &holding(above_m));
        assert_eq!(core.raised("off-altitude"), told, "{above_m} m");
    }
}

/// It fell back to the height of its runway after the take-off, or flies over a valley: it rolls no more.
#[test]
fn far_too_low_is_told_where_that_is_no_higher_than_the_runway_too() {
    let mut core = Core::in_nav();
    let Report::Fix(fix) = fix(25.0) else { panic!() };
    let mut low = flying(25.0, 25.0);
    low[2] = Report::Fix(Fix { altitude_amsl_m: fix.altitude_amsl_m - 120.0, altitude_home_m: 0.0, ..fix });
    core.run(12, &low);
    assert!(core.raised("off-altitude"));
}

#[test]
fn far_faster_than_it_was_told_is_told_unless_it_slows_down() {
    let mut core = Core::in_nav();
    core.run(15, &flying(40.0, 40.0));
    assert!(core.raised("fast"));
    let mut core = Core::in_nav();
    core.run(15, &flying(30.0, 30.0));
    assert!(!core.raised("fast"));
}

/// A safety officer disarms it a moment after the start: it was armed anew, and took off.
#[test]
fn who_disarms_before_the_take_off_is_not_overruled() {
    let mut core = Core::in_stop_with_a_plan();
    core.step(Input::Request(3, GatewayRequest::Launch));
    core.step(Input::Report(Report::Course(course(true))));
    let ground = |armed| [beat(Mode::Hold, armed), Report::OnGround(true), fix(0.0)];
    core.run(1, &ground(false));
    assert!(core.was_ordered(&Order::Arm));
    core.done();
    core.run(1, &ground(true));
    core.out.clear();
    core.run(30, &ground(false));
    assert!(!core.was_ordered(&Order::Arm) && core.gateway.state() == GatewayState::Stop);
    let cause = core.gateway.status(core.now).cause;
    assert!(cause.contains("disarmed"), "{cause}");
    core.step(Input::Request(4, GatewayRequest::Launch));
    core.run(1, &ground(false));
    assert!(core.was_ordered(&Order::Arm), "started again it is");
}

/// Heartbeats without the armed bit ended the agent in the air, and a mode changed meanwhile was told by nobody.
#[test]
fn disarmed_in_the_air_it_still_flies() {
    for says in [true, false] {
        let mut core = Core::in_nav();
        let mut up = vec![beat(Mode::Waypoints, false), fix(25.0), air(25.0)];
        up.extend(says.then_some(Report::OnGround(false)));
        core.run(5, &up);
        assert!(core.gateway.is_in_flight() && core.gateway.state() == GatewayState::Nav);
        let mut manual = vec![beat(Mode::Other(0), false), fix(25.0), air(25.0)];
        manual.extend(says.then_some(Report::OnGround(false)));
        core.run(5, &manual);
        assert!(core.gateway.state() == GatewayState::Manual && core.raised("not-in-command"));
        core.run(5, &[beat(Mode::Other(0), false), Report::OnGround(true), fix(0.0)]);
        assert!(!core.gateway.is_in_flight(), "on the ground it is over");
    }
}

/// The list can't be brought aboard: it took off when that was mended.
#[test]
fn a_launch_that_does_not_begin_is_given_up() {
    let mut core = Core::in_stop_with_a_plan();
    core.step(Input::Request(3, GatewayRequest::Launch));
    core.step(Input::Report(Report::Course(course(false))));
    let ground = [beat(Mode::Hold, false), Report::OnGround(true), fix(0.0)];
    core.run(65, &ground);
    core.step(Input::Report(Report::Course(course(true))));
    core.run(5, &ground);
    assert!(!core.was_ordered(&Order::Arm), "nobody expects it any more");
    let cause = core.gateway.status(core.now).cause;
    assert!(cause.contains("start again"), "{cause}");
}
