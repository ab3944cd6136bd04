//! Very long flights round a circle: every waypoint is steered to once and in its turn, and memory stays. Run with `--release` and
//! `--test-threads 1`, for the memory is the process's. `LEGWORK_WAYPOINTS` says how many waypoints, `LEGWORK_SOAK_S` how many
//! simulated seconds.

use super::*;
use sim::Mode;

/// Radius of the circle, metres.
const RADIUS_M: f64 = 3000.0;
/// Each lap is so much wider than the one before, up to so many: no place is flown twice in a day.
const WIDER_M: f64 = 2.0;
const LAPS: u64 = 50;
/// Waypoints of a lap: one every 100 m.
const A_LAP: u64 = 188;
/// Fed when there is room for twice as many.
const A_FEED: usize = 40;
/// Memory that may be added after the first tenth, bytes: what the allocator keeps for itself.
const GROWTH: u64 = 8 << 20;

/// Waypoint `n` of the flight.
fn on_circle(n: u64) -> Waypoint {
    let centre = HOME.destination(HEADING_DEG, 1500.0).destination(HEADING_DEG + 90.0, RADIUS_M);
    let bearing_deg = HEADING_DEG - 90.0 + 360.0 * (n % A_LAP) as f64 / A_LAP as f64;
    let radius_m = RADIUS_M + WIDER_M * ((n / A_LAP) % LAPS) as f64;
    waypoint(centre.destination(bearing_deg, radius_m), GROUND_M + 120.0, Action::Fly)
}

/// What is resident, bytes.
fn resident() -> u64 {
    let pages = std::fs::read_to_string("/proc/self/statm").unwrap();
    pages.split(' ').nth(1).unwrap().parse::<u64>().unwrap() * 4096
}

fn asked(variable: &str, otherwise: u64) -> u64 {
    std::env::var(variable).map_or(otherwise, |number| number.parse().expect("a number"))
}

/// A flight that never ends, and how far it is.
struct Circling {
    flight: Flight,
    /// Waypoints of the circle that were fed.
    fed: u64,
    /// The one that the autopilot really steers to.
    steered: Option<u64>,
    /// The token last said to be steered to.
    told: u64,
    /// Resident memory when the first tenth was over.
    resident: Option<u64>,
}

impl Circling {
    fn new(personality: Personality, faults: &[&str]) -> Self {
        let mut flight = Flight::on_ground(personality, 95, faults);
        flight.store_runway();
        flight.launch(std::iter::once(take_off()).chain((0..A_FEED as u64).map(on_circle)).collect());
        Self { flight, fed: A_FEED as u64, steered: None, told: 0, resident: None }
    }

    /// 100 ms; nothing of it is kept.
    fn step(&mut self) {
        self.flight.step();
        for (_, event) in std::mem::take(&mut self.flight.events) {
            if let GatewayEvent::Progress { current: Some(token), .. } = event {
                // a gateway that starts anew says again where it is
                assert!(token.0 >= self.told, "told of {} after {}", token.0, self.told);
                self.told = token.0;
            }
        }
        self.flight.steered.clear();
        if self.flight.now.as_millis().is_multiple_of(1000) {
            // it flies for weeks
            self.flight.sim.autopilot.aircraft.set_battery_share(1.0);
            self.feed();
        }
    }

    fn feed(&mut self) {
        if self.flight.station.gateway().navigation().room < 2 * A_FEED {
            return;
        }
        let next: Vec<_> = (self.fed..self.fed + A_FEED as u64).map(on_circle).collect();
        if self.flight.feed(None, next) == FeedAnswer::Accepted {
            self.fed += A_FEED as u64;
        }
    }

    /// What it steers to is what it steered to before, or the one after that.
    fn check_target(&mut self) {
        let Some(item) = self.flight.sim.autopilot.run.active.as_ref() else { return };
        let is_at = |n: u64| on_circle(n).position.distance_m(item.position) < 0.5;
        let next = self.steered.map_or(0, |steered| steered + 1);
        if is_at(next) {
            self.steered = Some(next);
        } else if let Some(steered) = self.steered {
            assert!(is_at(steered), "after waypoint {steered} it steers to {:?}", item.position);
        }
        // token 1 is the take-off, and token 2 the first of the circle
        let ahead = self.told.saturating_sub(2);
        assert!(ahead <= self.steered.unwrap_or(0), "{} was told and is not steered to", self.told);
    }

    fn check_memory(&mut self, share: f64) {
        if share < 0.1 {
            return;
        }
        let first = *self.resident.get_or_insert_with(resident);
        assert!(resident() < first + GROWTH, "{} KiB, then {} KiB", first >> 10, resident() >> 10);
    }
}

fn flown_in_order(personality: Personality, loss: f64) {
    let (all, fault) = (asked("LEGWORK_WAYPOINTS", 10_000), format!("packet-loss={loss}"));
    let mut circling = Circling::new(personality, &[&fault]);
    while circling.steered.is_none_or(|n| n < all) {
        let end = circling.flight.now + Duration::from_secs(60);
        let before = circling.steered;
        while circling.flight.now < end {
            circling.step();
            circling.check_target();
        }
        assert_ne!(
            circling.steered,
            before,
            "{personality} at {loss}: it gets no further: {}",
            circling.flight.report()
        );
        assert_eq!(circling.flight.state(), GatewayState::Nav, "{personality} at {loss}");
        circling.check_memory(circling.steered.unwrap_or(0) as f64 / all as f64);
    }
    let hours = circling.flight.now.as_secs_f64() / 3600.0;
    let (first, last) = (circling.resident.unwrap_or(0) >> 10, resident() >> 10);
    println!(
        "{personality}, {loss} lost: {all} waypoints in {hours:.1} h, memory {first} KiB, then {last} KiB"
    );
}

/// A test for each autopilot and share of lost frames.
macro_rules! in_order {
    ($($name:ident: $personality:expr, $loss:expr;)*) => {
        $(#[test]
        #[ignore = "a very long flight: run with --release, --test-threads 1 and LEGWORK_WAYPOINTS=1000000"]
        fn $name() {
            flown_in_order($personality, $loss);
        })*
    };
}

in_order! {
    a_million_waypoints_on_arduplane: Personality::ArduPlane, 0.0;
    a_million_waypoints_on_arduplane_with_5_percent_lost: Personality::ArduPlane, 0.05;
    a_million_waypoints_on_arduplane_with_30_percent_lost: Personality::ArduPlane, 0.3;
    a_million_waypoints_on_px4: Personality::Px4, 0.0;
    a_million_waypoints_on_px4_with_5_percent_lost: Personality::Px4, 0.05;
    a_million_waypoints_on_px4_with_30_percent_lost: Personality::Px4, 0.3;
}

/// What is done every five minutes of the soak, one after the other; each time it flies on.
const DISTURBANCES: [fn(&mut Circling); 10] = [
    |c| c.suffers("silence+5"),
    |c| c.suffers("packet-loss=0.2+60"),
    |c| c.suffers("gps-loss+20"),
    |c| c.suffers("reboot"),
    |c| c.suffers("silence+20"),
    Circling::fp_manager_pauses,
    Circling::gateway_restarts,
    |c| c.goes_on_after(GatewayRequest::Hold, GatewayState::Hold),
    |c| {
        let (heading_deg, altitude_amsl_m) = (90.0, GROUND_M + 150.0);
        let direct = GatewayRequest::Direct { heading_deg, altitude_amsl_m, airspeed_mps: 24.0 };
        c.goes_on_after(direct, GatewayState::Directed);
    },
    Circling::pilot_gives_back,
];

impl Circling {
    fn run(&mut self, seconds: f64) {
        let end = self.flight.now + Duration::from_secs_f64(seconds);
        while self.flight.now < end {
            self.step();
        }
    }

    fn until(&mut self, state: GatewayState, within_s: f64) {
        let end = self.flight.now + Duration::from_secs_f64(within_s);
        while self.flight.state() != state {
            assert!(self.flight.now < end, "{state:?}: not within {within_s} s; {}", self.flight.report());
            self.step();
        }
    }

    fn suffers(&mut self, fault: &str) {
        self.flight.sim.clear_fault(fault.split(['+', '=']).next().unwrap_or(fault));
        assert!(self.flight.sim.inject(fault.parse().unwrap()));
        self.run(70.0);
    }

    fn fp_manager_pauses(&mut self) {
        self.flight.alive = false;
        self.run(10.0);
        self.flight.alive = true;
        self.rejoins();
    }

    fn gateway_restarts(&mut self) {
        self.flight.station = station(Some(self.flight.station.gateway().snapshot()));
        self.run(1.0);
        self.rejoins();
    }

    fn rejoins(&mut self) {
        for _ in 0..30 {
            if self.flight.join("plan").accepted {
                return;
            }
            self.run(1.0);
        }
        panic!("it is not let in: {}", self.flight.report());
    }

    fn goes_on_after(&mut self, request: GatewayRequest, state: GatewayState) {
        self.flight.ask(request).unwrap();
        self.until(state, 10.0);
        self.run(20.0);
        self.flight.ask(GatewayRequest::Resume).unwrap();
    }

    fn pilot_gives_back(&mut self) {
        assert!(self.flight.sim.autopilot.set_mode(Mode::ReturnToLaunch));
        self.until(GatewayState::Manual, 10.0);
        self.run(20.0);
        self.flight.ask(GatewayRequest::Resume).unwrap();
    }
}

fn soak(personality: Personality) {
    let all_s = asked("LEGWORK_SOAK_S", 24 * 3600) as f64;
    let mut circling = Circling::new(personality, &[]);
    for disturb in DISTURBANCES.iter().cycle() {
        let share = circling.flight.now.as_secs_f64() / all_s;
        circling.check_memory(share);
        if share >= 1.0 {
            break;
        }
        disturb(&mut circling);
        circling.until(GatewayState::Nav, 150.0);
        let told = circling.told;
        circling.run(200.0);
        assert!(circling.told > told, "{personality}: it gets no further: {}", circling.flight.report());
    }
    let (first, last) = (circling.resident.unwrap_or(0) >> 10, resident() >> 10);
    println!("{personality}: {all_s} s, {} waypoints, memory {first} KiB, then {last} KiB", circling.told);
}

#[test]
#[ignore = "a day of flight: run with --release and --test-threads 1"]
fn a_day_of_disturbances_on_arduplane() {
    soak(Personality::ArduPlane);
}

#[test]
#[ignore = "a day of flight: run with --release and --test-threads 1"]
fn a_day_of_disturbances_on_px4() {
    soak(Personality::Px4);
}
