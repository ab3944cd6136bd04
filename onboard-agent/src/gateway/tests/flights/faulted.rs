//! Whatever goes wrong in whatever state, on either autopilot: the aircraft has an owner, the state is true, it steers to nothing
//! stale, and what must be told is told by its alarm.

use super::*;
use Fault::*;
use GatewayState as S;
use sim::Mode;
use std::collections::{BTreeMap, BTreeSet};

/// What goes wrong.
#[derive(Debug, Clone, Copy)]
enum Fault {
    /// In the words of the simulator, with the seconds in which the autopilot is not heard for certain.
    Simulated(&'static str, u64),
    FpManagerSilent,
    DiskFull,
    /// Somebody switches the mode.
    Switched(Mode),
    ListReplaced,
    /// It comes back over what it left, and the FP Manager joins it.
    GatewayRestarted,
}

const FAULTS: [Fault; 20] = [
    Simulated("gps-loss+30", 0),
    Simulated("engine-out", 0),
    Simulated("no-rpm", 0),
    Simulated("ice+30", 0),
    Simulated("low-battery", 0),
    Simulated("silence+1", 1),
    Simulated("silence+5", 5),
    Simulated("silence+30", 30),
    Simulated("packet-loss=0.2+60", 0),
    Simulated("duplicate=0.3+60", 0),
    Simulated("reorder=0.3+60", 0),
    Simulated("no-stream=33+30", 0),
    Simulated("crash", 0),
    Simulated("reboot", 0),
    FpManagerSilent,
    DiskFull,
    Switched(Mode::Manual),
    Switched(Mode::ReturnToLaunch),
    ListReplaced,
    GatewayRestarted,
];

impl Fault {
    /// In this state an order or a list of ours is on its way when it comes, and may hide it.
    fn may_be_hidden(self, state: S) -> bool {
        match self {
            Switched(_) => state == S::SafeReturn,
            ListReplaced => matches!(state, S::TakeOff | S::Nav | S::Hold | S::Directed | S::SafeReturn),
            _ => false,
        }
    }

    /// The alarms of which one has to tell it in this state; none: it is no matter for an alarm there.
    fn alarms(self, state: S) -> &'static [&'static str] {
        let is_up = state != S::Stop;
        // before it rolls it is not in the air, and before it stands nothing is asked of its engine
        let is_near_ground = matches!(state, S::Stop | S::TakeOff | S::Land | S::SafeLand);
        let is_level = matches!(state, S::Nav | S::Hold | S::Directed);
        let is_pilots = state == S::Manual;
        match self {
            Simulated("gps-loss+30", _) => &["gps-lost"],
            // it descends with hardly any power there, and sinks too fast before it is suspected
            Simulated("engine-out", _) if state == S::SafeApproach => {
                &["engine-out", "engine-suspected", "off-altitude"]
            }
            Simulated("engine-out", _) if !is_near_ground && !is_pilots => {
                &["engine-out", "engine-suspected"]
            }
            Simulated("ice+30", _) if is_level => &["slow", "sinks", "off-altitude", "engine-suspected"],
            Simulated("low-battery", _) => &["energy-low"],
            Simulated("silence+5" | "silence+30", _) => &["autopilot-silent"],
            Simulated("no-stream=33+30", _) if is_up => &["stream-stopped"],
            Simulated("crash", _) if !is_near_ground => &["stands-still"],
            DiskFull => &["not-stored"],
            Switched(_) if is_up && !is_pilots => &["not-in-command"],
            ListReplaced if is_up && !is_pilots => &["list-replaced", "not-in-command"],
            _ => &[],
        }
    }
}

/// After so many seconds nothing of ours is on its way any more.
const SETTLED_S: f64 = 5.0;
/// How long a fault is looked at, seconds.
const WATCHED_S: f64 = 100.0;
/// What is said may be late by so much: heartbeats come once a second, and some are lost.
const LATE: Duration = Duration::from_secs(8);
/// So long after a change, or after the end of a silence, what was cancelled may still be steered to.
const CHANGED: Duration = Duration::from_secs(10);

/// A flight to which something happens.
struct Trial {
    flight: Flight,
    /// For a failure's message.
    what: String,
    /// What was fed, by its tokens.
    fed: BTreeMap<u64, Waypoint>,
    cancelled: Vec<LatLon>,
    /// From then on nothing of that is steered to.
    settled: Option<Time>,
    /// Until then, the autopilot is not heard.
    silent_until: Time,
    /// Since when something is not so.
    wrong_since: [Option<Time>; 3],
    joins: bool,
    /// The alarms that were raised since the fault.
    told: BTreeSet<String>,
}

impl Trial {
    /// In this state.
    fn in_state(personality: Personality, state: S) -> Self {
        let mut trial = Self {
            flight: Flight::on_ground(personality, 81, &[]),
            what: String::new(),
            fed: BTreeMap::new(),
            cancelled: vec![],
            settled: None,
            silent_until: Time::ZERO,
            wrong_since: [None; 3],
            joins: false,
            told: BTreeSet::new(),
        };
        let lands = matches!(state, S::Approach | S::Land);
        let rest = if lands { [zigzag(0, 3, 300.0), landing()].concat() } else { zigzag(0, 30, 300.0) };
        let plan: Vec<_> = std::iter::once(take_off()).chain(rest).collect();
        trial.fed = (1..).zip(plan.iter().cloned()).collect();
        trial.flight.store_runway();
        trial.flight.load(plan);
        trial.lead_to(state);
        trial
    }

    fn lead_to(&mut self, state: S) {
        let flight = &mut self.flight;
        if state == S::Stop {
            return;
        }
        flight.ask(GatewayRequest::Launch).unwrap();
        if state != S::TakeOff {
            flight.run_until(120.0, "Nav", |f| f.state() == S::Nav);
            flight.run(20.0);
        }
        match state {
            S::Hold => flight.ask(GatewayRequest::Hold).unwrap(),
            S::Directed => flight.ask(direct()).unwrap(),
            S::Manual => assert!(flight.sim.autopilot.set_mode(Mode::Manual)),
            _ => flight.alive = !matches!(state, S::SafeHold | S::SafeReturn | S::SafeApproach | S::SafeLand),
        }
        flight.run_until(900.0, &format!("{state:?}"), |f| f.state() == state);
        if matches!(state, S::Hold | S::Directed | S::Manual | S::SafeHold) {
            // an order that was not seen to be obeyed yet is given again
            flight.run(3.0);
        }
    }

    fn suffers(&mut self, fault: Fault) {
        let flight = &mut self.flight;
        match fault {
            Simulated(words, silent_s) => {
                assert!(flight.sim.inject(words.parse().unwrap()));
                self.silent_until = flight.now + Duration::from_secs(silent_s);
            }
            FpManagerSilent => flight.alive = false,
            DiskFull => {
                flight.station.input(flight.now, Input::Stored(false));
            }
            Switched(mode) => {
                flight.sim.autopilot.set_mode(mode);
            }
            ListReplaced => flight.sim.is_visited(HOME.destination(300.0, 2000.0), true),
            GatewayRestarted => {
                flight.station = station(Some(flight.station.gateway().snapshot()));
                (self.joins, self.silent_until) = (true, flight.now + Duration::from_secs(5));
            }
        }
    }

    /// Beyond the waypoint after the one steered to, the plan is changed.
    fn change(&mut self) {
        let Some(current) = self.flight.station.gateway().navigation().current else { return };
        let keep = current.0 + 1;
        let Some(from) = self.fed.get(&keep).cloned() else { return };
        let place = |i: u32| from.position.destination(HEADING_DEG + 25.0, 350.0 * f64::from(i));
        let others: Vec<_> = (1..=12).map(|i| waypoint(place(i), GROUND_M + 120.0, Action::Fly)).collect();
        let first = self.flight.next;
        if self.flight.feed(Some(keep), others.clone()) == FeedAnswer::Accepted {
            self.cancelled = self.fed.split_off(&(keep + 1)).into_values().map(|w| w.position).collect();
            self.fed.extend((first..).zip(others));
            self.settled = Some(self.flight.now.max(self.silent_until) + CHANGED);
        }
    }

    fn step(&mut self) {
        let steered = self.flight.steered.len();
        self.flight.step();
        let now = self.flight.now;
        self.told.extend(self.alarms());
        if self.joins && now.as_millis().is_multiple_of(1000) {
            let last = self.flight.next - 1;
            self.joins = !self.flight.join_knowing("plan", last).accepted;
        }
        let is_stale = |p: &LatLon| self.cancelled.iter().any(|c| c.distance_m(*p) < 1.0);
        let stale = self.flight.steered[steered..].iter().any(is_stale);
        assert!(!stale || self.settled.is_none_or(|at| now < at), "{}: a stale target", self.what);
        let heard = now > self.silent_until + LATE;
        let wrong = [!self.has_owner(), heard && !self.is_true(), heard && !self.steers_as_told()];
        for ((wrong, since), what) in wrong.into_iter().zip(&mut self.wrong_since).zip([
            "no owner",
            "an untrue state",
            "an untrue target",
        ]) {
            if !wrong {
                *since = None;
            } else if now.saturating_sub(*since.get_or_insert(now)) > LATE {
                panic!(
                    "{}: {what}; {:?}\n{}",
                    self.what,
                    self.flight.sim.autopilot.mode(),
                    self.flight.report()
                );
            }
        }
    }

    fn alarms(&self) -> Vec<String> {
        let alarms = self.flight.station.gateway().status(self.flight.now).alarms;
        alarms.into_iter().map(|alarm| alarm.id).collect()
    }

    /// Somebody flies it, or everybody is told that nobody does.
    fn has_owner(&self) -> bool {
        match self.flight.state() {
            S::Nav | S::Hold | S::Directed => self.flight.alive,
            S::Manual => self.alarms().iter().any(|id| id == "not-in-command"),
            S::Off => self.flight.now < self.silent_until + LATE,
            _ => true,
        }
    }

    fn is_true(&self) -> bool {
        let autopilot = &self.flight.sim.autopilot;
        let mode = autopilot.mode();
        match self.flight.state() {
            S::TakeOff | S::Nav | S::Approach | S::Land | S::SafeApproach | S::SafeLand => {
                autopilot.is_armed() && matches!(mode, Mode::Auto | Mode::TakeOff)
            }
            S::SafeReturn => autopilot.is_armed() && matches!(mode, Mode::Auto | Mode::ReturnToLaunch),
            S::Hold | S::SafeHold => matches!(mode, Mode::Loiter | Mode::Guided),
            S::Directed => matches!(mode, Mode::Guided | Mode::Loiter),
            S::Stop => !autopilot.is_armed(),
            S::Manual => autopilot.is_armed(),
            S::Off | S::Terminate => false,
        }
    }

    /// The waypoint that is said to be steered to is the one that is.
    fn steers_as_told(&self) -> bool {
        let autopilot = &self.flight.sim.autopilot;
        let told = self.flight.station.gateway().navigation().current;
        let flies = matches!(self.flight.state(), S::TakeOff | S::Nav | S::Approach | S::Land);
        let (Some(told), true, Mode::Auto) = (told, flies, autopilot.mode()) else { return true };
        let (Some(told), Some(item)) = (self.fed.get(&told.0), &autopilot.run.active) else { return false };
        match told.action {
            // it is told a place of its own for these
            Action::TakeOff { .. } | Action::Land { .. } => true,
            _ => told.position.distance_m(item.position) < 1.0,
        }
    }
}

fn direct() -> GatewayRequest {
    GatewayRequest::Direct { heading_deg: 90.0, altitude_amsl_m: GROUND_M + 150.0, airspeed_mps: 24.0 }
}

fn every_fault(personality: Personality, state: S) {
    // what may be hidden by what is ours comes in that moment, and once more when it can't be
    let moments = FAULTS.into_iter().flat_map(|fault| {
        let again = fault.may_be_hidden(state).then_some((fault, true));
        std::iter::once((fault, false)).chain(again)
    });
    let mut untold = vec![];
    for (fault, is_alone) in moments {
        let mut trial = Trial::in_state(personality, state);
        trial.what = format!("{personality} in {state:?}, {fault:?}, alone: {is_alone}");
        println!("{}", trial.what);
        if is_alone {
            trial.flight.run(SETTLED_S);
        }
        let begun = trial.flight.now;
        trial.suffers(fault);
        trial.step();
        if !is_alone && matches!(state, S::Stop | S::TakeOff | S::Nav | S::Hold | S::Directed) {
            trial.change();
        }
        while trial.flight.now < begun + Duration::from_secs_f64(WATCHED_S) {
            trial.step();
        }
        let is_hidden = fault.may_be_hidden(state) && !is_alone;
        let wanted = if is_hidden { &[] } else { fault.alarms(state) };
        if !wanted.is_empty() && !wanted.iter().any(|id| trial.told.contains(*id)) {
            untold.push(format!("{fault:?}: none of {wanted:?}, but {:?}", trial.told));
        }
        println!("  {:?}: {}", trial.flight.state(), trial.flight.station.gateway().status(begun).cause);
    }
    assert!(untold.is_empty(), "{personality} in {state:?}: {untold:#?}");
}

/// A test for each state and autopilot.
macro_rules! states {
    ($($name:ident: $state:expr;)*) => {
        states!(arduplane, Personality::ArduPlane; $($name: $state;)*);
        states!(px4, Personality::Px4; $($name: $state;)*);
    };
    ($module:ident, $personality:expr; $($name:ident: $state:expr;)*) => {
        mod $module {
            use super::*;
            $(
                #[test]
                #[cfg_attr(debug_assertions, ignore = "20 flights and more each: flown with --release")]
                fn $name() {
                    every_fault($personality, $state);
                }
            )*
        }
    };
}

states! {
    stop: S::Stop;
    take_off: S::TakeOff;
    nav: S::Nav;
    hold: S::Hold;
    directed: S::Directed;
    manual: S::Manual;
    approach: S::Approach;
    land: S::Land;
    safe_hold: S::SafeHold;
    safe_return: S::SafeReturn;
    safe_approach: S::SafeApproach;
    safe_land: S::SafeLand;
}
