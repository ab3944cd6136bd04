//! Whatever comes, in whatever order: the aircraft has an owner, the state is true, it steers to nothing stale, and nothing is begun with
//! a list that is not whole.

mod autopilot;

use super::super::states::{TRIGGERS, next};
use super::*;
use crate::gateway::order::Aim;
use crate::gateway::tests::flights;
use autopilot::{Autopilot, Fate};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::collections::BTreeMap;
use usal::contract::{Action, SafeParameters};

const TICK: Duration = Duration::from_millis(200);
/// What is not so is told, or so again, within this.
const LATE: Duration = Duration::from_secs(8);
/// An aircraft that is met in flight has an owner within this.
const MET_WITHIN: Duration = Duration::from_secs(70);
/// Orders that follow from nothing but time: so many a second, in all lanes together.
const ORDERS_A_SECOND: u64 = 4;
/// Orders that follow from one thing that happens.
const ORDERS_EACH: u64 = 8;
/// An FP Manager that finds a gateway which it has not joined does so at every so many of its heartbeats.
const JOINS_EVERY: u64 = 5;
/// Kinds of things that happen.
const KINDS: u8 = 27;
/// Number of every request: each is answered before the next.
const REQUEST: u64 = 1;

/// What is asked of the gateway.
fn request(kind: u8, how: u8) -> GatewayRequest {
    let (t1_s, t2_s) = if how == 0 { (0.5, 0.0) } else { (3.0, 20.0) };
    match kind {
        0 => GatewayRequest::Hold,
        1 => GatewayRequest::Resume,
        2 => GatewayRequest::Direct { heading_deg: 90.0, altitude_amsl_m: 500.0, airspeed_mps: 24.0 },
        3 => GatewayRequest::Safe,
        4 => GatewayRequest::Recover,
        5 => GatewayRequest::Launch,
        6 => GatewayRequest::SetRunways { runways: vec![flights::runway_at(LatLon::new(36.3190, -84.1730))] },
        _ => GatewayRequest::SetSafe(SafeParameters { t1_s, t2_s, ..SafeParameters::default() }),
    }
}

/// The gateway's core, what flies with it, and what it must not do.
struct World {
    core: Core,
    autopilot: Autopilot,
    /// The FP Manager lives.
    alive: bool,
    /// What it has sent and not cancelled, by its tokens.
    sent: BTreeMap<u64, Waypoint>,
    token: u64,
    /// It sends some just now, and they are not ordered yet.
    feeds: bool,
    /// What the gateway has stored last.
    stored: Option<Snapshot>,
    state: GatewayState,
    last_order: u64,
    orders: u64,
    happened: u64,
    /// The operator wanted it to be flown again since the pilot took it.
    is_had_back: bool,
    /// The pilot took it, and that was not heard yet.
    is_taken: bool,
    wrong_since: [Option<Time>; 3],
    heard_since: Time,
}

impl World {
    /// In the air on its way along a few waypoints.
    fn in_nav() -> Self {
        let mut world = Self {
            core: Core::new(),
            autopilot: Autopilot::new(),
            alive: true,
            sent: BTreeMap::new(),
            token: 0,
            feeds: false,
            stored: None,
            state: GatewayState::Off,
            last_order: 0,
            orders: 0,
            happened: 0,
            is_had_back: false,
            is_taken: false,
            wrong_since: [None; 3],
            heard_since: Time::ZERO,
        };
        world.step(Input::Report(Report::Capability(Ok(PLANE))));
        world.ticks(3);
        world.join("plan", 0);
        world.feed(None, 6);
        world.ticks(10);
        world.ask(request(5, 0));
        world.ticks(40);
        assert_eq!(world.state, GatewayState::Nav);
        world
    }

    /// Whatever follows from it at once follows.
    fn step(&mut self, input: Input) {
        self.core.step(input);
        self.settle();
    }

    fn settle(&mut self) {
        self.carry_out();
        while let Some(course) = self.autopilot.new_course() {
            self.core.step(Input::Report(course));
            self.carry_out();
        }
    }

    /// What came out of the core.
    fn carry_out(&mut self) {
        for output in std::mem::take(&mut self.core.out) {
            match output {
                Output::Order(id, order) => {
                    assert!(id.0 > self.last_order, "{id:?} was given before");
                    (self.last_order, self.orders) = (id.0, self.orders + 1);
                    self.judge(&order);
                    self.autopilot.take(id, order);
                }
                Output::Event(GatewayEvent::StateChanged { from, to, .. }) => {
                    assert_eq!(from, self.state, "a change that nobody was told of");
                    assert!(
                        TRIGGERS.iter().any(|trigger| next(from, *trigger) == Some(to)),
                        "{from:?} to {to:?}"
                    );
                    (self.state, self.is_had_back) = (to, false);
                    // each state has its time to become true
                    self.wrong_since[1] = None;
                }
                Output::Save => self.stored = Some(self.core.gateway.snapshot()),
                Output::Event(_) | Output::Answer(..) => {}
            }
        }
        assert_eq!(self.core.gateway.state(), self.state);
    }

    /// An order that must not be given now.
    fn judge(&mut self, order: &Order) {
        let is_let_loose = matches!(order, Order::Steer(Aim::Waypoints) | Order::Arm);
        let may_be = self.autopilot.is_whole() || self.autopilot.shown == Mode::Waypoints;
        assert!(!is_let_loose || may_be, "{order:?} with a list that is not whole: {:?}", self.autopilot);
        let steers = matches!(order, Order::Steer(_) | Order::Arm | Order::Speed(_) | Order::Feed { .. });
        let is_ours = match self.core.gateway.state() {
            GatewayState::Terminate => false,
            GatewayState::Manual => self.is_had_back,
            _ => true,
        };
        assert!(!steers || is_ours, "{order:?} in {:?}", self.core.gateway.state());
        let stops_engine = *order == Order::StandDown && !self.autopilot.shown_on_ground;
        assert!(!stops_engine, "{order:?} in the air, {:?}", self.core.gateway.state());
        // of the plan nothing is left, but where its own waypoints are fed; Safe mode may replace those at once
        let feeds = matches!(order, Order::Feed { .. });
        if *order == Order::Forget || feeds && !std::mem::take(&mut self.feeds) {
            self.sent.clear();
        }
    }

    /// The one answer to an input.
    fn answer(&mut self, input: Input) -> Answer {
        self.core.step(input);
        let answers = self.core.out.iter().filter_map(|output| match output {
            Output::Answer(REQUEST, answer) => Some(answer.clone()),
            _ => None,
        });
        let answers: Vec<_> = answers.collect();
        let [answer] = &answers[..] else { panic!("answered {} times", answers.len()) };
        answer.clone()
    }

    fn ask(&mut self, asked: GatewayRequest) {
        let resumes = asked == GatewayRequest::Resume;
        let answer = self.answer(Input::Request(REQUEST, asked));
        self.is_had_back |= resumes && answer == Answer::Request(Ok(()));
        self.settle();
    }

    fn join(&mut self, plan: &str, last_token: u64) {
        let join = Join { plan: Some(plan.into()), earlier: vec![], last_token: Token(last_token) };
        self.answer(Input::Join(REQUEST, join, fp_manager()));
        self.settle();
    }

    /// So many waypoints more; of eight the last one lands, of five the second is circled.
    fn feed(&mut self, cancel_after: Option<u64>, count: usize) {
        let kept = self.sent.range(..=cancel_after.unwrap_or(u64::MAX)).next_back();
        if kept.is_some_and(|(_, waypoint)| waypoint.end_of_plan) {
            return;
        }
        let first = self.token;
        let mut waypoints = flights::zigzag(first as usize, count, 300.0);
        if let [_, circled, ..] = &mut waypoints[..]
            && count == 5
        {
            circled.action = Action::Loiter { radius_m: 100.0 };
        }
        if let [.., before, last] = &mut waypoints[..]
            && count == 8
        {
            before.altitude_amsl_m -= 60.0;
            let place = last.position;
            *last =
                flights::waypoint(place, before.altitude_amsl_m - 60.0, Action::Land { heading_deg: 52.0 });
        }
        (first + 1..).zip(&mut waypoints).for_each(|(token, waypoint)| waypoint.token = Token(token));
        let feed = Feed { cancel_after: cancel_after.map(Token), waypoints: waypoints.clone() };
        if self.answer(Input::Feed(REQUEST, feed, fp_manager())) == Answer::Feed(FeedAnswer::Accepted) {
            (self.token, self.feeds) = (self.token + count as u64, true);
            if self.autopilot.unknown {
                // what an earlier gateway was sent belongs to a flight that ended unheard
                self.sent.clear();
            }
            self.sent.retain(|token, _| cancel_after.is_none_or(|after| *token <= after));
            self.sent.extend(waypoints.into_iter().map(|waypoint| (waypoint.token.0, waypoint)));
        }
        self.settle();
        self.feeds = false;
    }

    fn ticks(&mut self, count: u32) {
        (0..count).for_each(|_| self.tick());
    }

    fn tick(&mut self) {
        self.core.now += TICK;
        if self.alive {
            self.core.beats += 1;
            let (count, plan, from) = (self.core.beats, Some("plan".into()), fp_manager());
            self.step(Input::Heartbeat { count, plan, from });
            if self.core.gateway.fp_manager().is_none() && self.core.beats.is_multiple_of(JOINS_EVERY) {
                self.join("plan", self.token);
            }
        }
        let reports = self.autopilot.tick();
        self.see_pilot();
        for report in reports {
            if let Report::Adopted(..) = report {
                let aboard = self.autopilot.list.iter().map(|fed| fed.waypoint.token.0);
                let aboard: Vec<_> = aboard.collect();
                self.sent.retain(|token, _| aboard.contains(token));
                self.autopilot.unknown = false;
            }
            self.step(Input::Report(report));
        }
        self.step(Input::Tick);
        if self.autopilot.silent {
            self.heard_since = self.core.now;
        }
        self.check();
    }

    fn happen(&mut self, kind: u8, how: u8) {
        self.happened += 1;
        let pick = usize::from(how);
        match kind {
            0..3 => self.autopilot.reach(),
            3 => self.feed(None, [1, 3, 5, 8][pick]),
            4 => {
                let first = self.sent.keys().find(|token| **token > self.autopilot.flown).copied();
                self.feed(Some(first.map_or(0, |first| first + u64::from(how) - 1)), 4);
            }
            5..13 => self.ask(request(kind - 5, how)),
            13 => self.alive = !self.alive,
            14 => self
                .join(["plan", "plan", "other", "plan"][pick], [self.token, self.token, self.token, 0][pick]),
            15 => self.take_by_hand([Mode::Other(5), Mode::Hold, Mode::Waypoints, Mode::Return][pick]),
            16 => self.autopilot.silent = !self.autopilot.silent,
            17 => self.autopilot.fate = [Fate::Done(1), Fate::Done(30), Fate::Failed, Fate::PutOff][pick],
            18 => self.autopilot.engine_runs = !self.autopilot.engine_runs,
            19 | 20 => self.lose_list(kind == 19),
            21 => self.restart_gateway(),
            22 => {
                let (count, plan, from) = (u64::from(how), Some("other".into()), "b2".parse().ok());
                self.step(Input::Heartbeat { count, plan, from });
            }
            23 => self.autopilot.armed = self.autopilot.on_ground && !self.autopilot.armed || how > 0,
            24 => (self.autopilot.on_ground, self.autopilot.armed) = (true, false),
            25 => self.autopilot.fate = Fate::Unanswered([0, 1, 10, 60][pick]),
            _ => self.say(how),
        }
    }

    /// The pilot changes the mode, which is seen when it is heard next.
    fn take_by_hand(&mut self, mode: Mode) {
        self.autopilot.mode = mode;
        self.is_taken = mode != self.autopilot.shown;
    }

    /// What the pilot chose is heard, if it is. What a *Resume* orders is that order's doing, for all that anybody can tell.
    fn see_pilot(&mut self) {
        if self.autopilot.silent || !std::mem::take(&mut self.is_taken) {
            return;
        }
        self.is_had_back &= matches!(self.autopilot.mode, Mode::Hold | Mode::Waypoints);
    }

    /// It started anew, or another station's list is aboard.
    fn lose_list(&mut self, reboots: bool) {
        if self.autopilot.silent {
            return;
        }
        self.autopilot.replace_list();
        self.settle();
        self.step(Input::Report(if reboots { Report::Rebooted } else { Report::ListReplaced }));
    }

    fn restart_gateway(&mut self) {
        let (now, beats) = (self.core.now, self.core.beats);
        self.core = Core { now, beats, ..Core::started_anew(self.stored.clone()) };
        self.autopilot.start_driver_anew();
        if self.autopilot.on_ground {
            self.sent.clear();
        }
        (self.state, self.last_order, self.is_had_back, self.is_taken) = (GatewayState::Off, 0, false, false);
        (self.wrong_since, self.heard_since) = ([None; 3], now);
        self.step(Input::Report(Report::Capability(Ok(PLANE))));
    }

    fn say(&mut self, how: u8) {
        match how {
            0 => self.ask(GatewayRequest::Terminate { confirm: "test".into() }),
            1 => self.step(Input::Stored(false)),
            2 => self.step(Input::Flooded(true)),
            _ => self.step(Input::Report(Report::ListUnfit(true))),
        }
    }

    fn check(&mut self) {
        let now = self.core.now;
        let told = self.core.gateway.navigation().current;
        assert!(told.is_none() || told == self.autopilot.said_token, "{told:?} is not what it says");
        let most = ORDERS_A_SECOND * (now.as_secs() + 2) + ORDERS_EACH * self.happened;
        assert!(self.orders <= most, "{} orders", self.orders);
        let heard = now > self.heard_since + LATE;
        let wrong = [!self.has_owner(), heard && !self.is_true(), !self.has_what_was_sent()];
        let within = if self.state == GatewayState::Off { MET_WITHIN } else { LATE };
        for ((wrong, since), what) in
            wrong.into_iter().zip(&mut self.wrong_since).zip(["owner", "state", "list"])
        {
            *since = since.or(Some(now)).filter(|_| wrong);
            let lasts = since.map_or(Time::ZERO, |since| now - since);
            assert!(lasts <= within, "{what}: {:?} at {now:?}, {:?}", self.state, self.autopilot);
        }
    }

    /// Somebody flies it, or everybody is told that nobody does.
    fn has_owner(&self) -> bool {
        let heard = self.core.now > self.heard_since + LATE;
        match self.state {
            // what still stands needs nobody
            GatewayState::Nav | GatewayState::Hold | GatewayState::Directed => {
                self.alive || self.autopilot.shown_on_ground
            }
            GatewayState::Manual => self.core.raised("not-in-command"),
            GatewayState::Off | GatewayState::Stop => self.autopilot.on_ground || !heard,
            _ => true,
        }
    }

    /// It does what the state says, or it is told that it does not.
    fn is_true(&self) -> bool {
        use GatewayState::*;
        let does = match self.state {
            TakeOff | Nav | Approach | Land | SafeApproach | SafeLand => {
                self.autopilot.shown == Mode::Waypoints
            }
            SafeReturn => matches!(self.autopilot.shown, Mode::Waypoints | Mode::Return),
            Hold | SafeHold => self.autopilot.shown == Mode::Hold,
            Directed => self.autopilot.shown == Mode::Direct,
            Off | Stop | Manual | Terminate => true,
        };
        does || self.core.raised("autopilot-disobeys")
    }

    /// It is to fly what was sent and not cancelled, and nothing else of the plan.
    fn has_what_was_sent(&self) -> bool {
        let of_plan = self.autopilot.list.iter().map(|fed| fed.waypoint.token.0).filter(|token| *token > 0);
        let sent = self.sent.keys().copied().filter(|token| *token > self.autopilot.flown);
        self.autopilot.unknown || of_plan.eq(sent)
    }

    /// Nothing happens any more but that waypoints are reached.
    fn calm_down(&mut self) {
        (self.alive, self.autopilot.silent, self.autopilot.fate) = (true, false, Fate::Done(1));
        self.autopilot.armed |= !self.autopilot.on_ground;
        for _ in 0..60 {
            self.join("plan", self.token);
            self.ticks(5);
            self.autopilot.reach();
        }
    }
}

fn config() -> ProptestConfig {
    let seed = std::env::var("LEGWORK_SEED").map_or(1, |seed| seed.parse().expect("a number"));
    println!("LEGWORK_SEED={seed}");
    let cases = if cfg!(debug_assertions) { 50 } else { 2000 };
    ProptestConfig {
        cases: std::env::var("LEGWORK_SEQUENCES").map_or(cases, |cases| cases.parse().expect("a number")),
        rng_seed: RngSeed::Fixed(seed),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// It is taken by a gateway that started anew, which finds nobody alive in the same moment and flies its own way home.
#[test]
fn what_is_sent_to_an_approach_of_which_nobody_is_in_charge_is_replaced_by_the_way_home() {
    let mut world = World::in_nav();
    world.alive = false;
    world.ask(request(6, 0));
    world.ask(request(7, 0));
    world.ticks(7);
    world.autopilot.reach();
    world.restart_gateway();
    world.ticks(6);
    assert_eq!(world.state, GatewayState::Approach);
    world.join("plan", world.token);
    world.ticks(3);
    world.feed(None, 1);
    assert_eq!(world.state, GatewayState::SafeReturn);
    assert!(world.sent.is_empty() && world.has_what_was_sent(), "{:?}", world.autopilot);
}

/// It holds in Safe mode, and then does nothing of what it is told; on the way home the engine stops and runs, and a way is chosen each
/// time. The alarm began anew with each.
#[test]
fn that_it_disobeys_is_not_told_later_for_a_way_that_is_chosen_anew() {
    let mut world = World::in_nav();
    world.alive = false;
    world.ask(request(6, 0));
    let until = |world: &mut World, state| {
        while world.state != state {
            world.ticks(1);
            assert!(world.core.now < Time::from_secs(120), "{:?}", world.state);
        }
    };
    until(&mut world, GatewayState::SafeHold);
    world.ticks(20);
    world.autopilot.fate = Fate::Failed;
    until(&mut world, GatewayState::SafeReturn);
    for _ in 0..3 {
        world.autopilot.engine_runs = !world.autopilot.engine_runs;
        world.ticks(13);
    }
    assert_eq!(world.state, GatewayState::SafeReturn);
    assert!(world.core.raised("autopilot-disobeys"));
}

proptest! {
    #![proptest_config(config())]
    /// What happens, how, and so many ticks until the next.
    #[test]
    fn whatever_happens_it_has_an_owner_a_true_state_and_no_stale_target(
        happens in proptest::collection::vec((0..KINDS, 0..4_u8, 0..25_u32), 1..60),
    ) {
        let mut world = World::in_nav();
        for (kind, how, ticks) in happens {
            world.happen(kind, how);
            world.ticks(ticks);
        }
        world.calm_down();
        let settled = world.wrong_since.iter().all(Option::is_none);
        prop_assert!(settled && world.is_true(), "{:?}, {:?}", world.state, world.autopilot);
    }
}
