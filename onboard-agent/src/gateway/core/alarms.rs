//! Alarms: raised when something has been wrong for a while, cleared when it is right again.

mod watches;

use super::telemetry::{FRESH, Telemetry};
use crate::gateway::order::Time;
use geometry::LatLon;
use std::time::Duration;
use usal::contract::{Alarm, GatewayEvent};
use watches::{WATCHES, Watch};

/// Nothing was received from the autopilot for so long.
const SILENT: Duration = Duration::from_secs(3);
/// The position did not change for so long although the aircraft flies.
const STALE: Duration = Duration::from_secs(1);
/// Slower than this, a position may stand still, m/s.
const FLYING_MPS: f64 = 5.0;
/// Share of energy below which it is low, and above which it is well again.
const ENERGY_LOW: (f64, f64) = (0.20, 0.23);
/// An engine that turns slower than this while it is given throttle has stopped, 1/min.
const STOPPED_RPM: f64 = 300.0;
/// Throttle above which an engine has to turn, 0..1.
const THROTTLE: f64 = 0.1;
/// Throttle at which an aircraft that sinks does all it can, 0..1.
const FULL_THROTTLE: f64 = 0.9;
/// An aircraft that climbs faster than this has an engine, m/s.
const CLIMBING_MPS: f64 = 0.5;
/// The autopilot did not follow an order for so long.
const DISOBEYS: Duration = Duration::from_secs(4);

/// What the alarms need beside telemetry.
#[derive(Debug, Clone, Copy, Default)]
pub struct AlarmInputs {
    /// Since when the autopilot has not followed an order.
    pub disobeys_since: Option<Time>,
    /// It is below the waypoint that it steers to, and sinks: the engine ought to work.
    pub sinks_below_target: bool,
    /// It sinks below the altitude that it was told to fly at.
    pub sinks: bool,
    /// It flies far slower than it was told to.
    pub slow: bool,
    /// It flies far faster than it was told to.
    pub fast: bool,
    /// It is far from the altitude that it was told to fly at, and comes no nearer.
    pub off_altitude: bool,
    /// It ought to fly, and does not move.
    pub stands_still: bool,
    /// It flies, and is not armed.
    pub disarmed: bool,
    /// Another station put its list aboard, which is not flown.
    pub list_replaced: bool,
    /// Somebody else steers the flying aircraft.
    pub not_in_command: bool,
    /// Safe mode needed a runway and found none.
    pub no_safe_runway: bool,
    /// It listens where strangers can connect.
    pub exposed: bool,
    /// A log is played.
    pub replay: bool,
    /// So many messages of another program than the FP Manager that joined were ignored, and they go on.
    pub other_fp_manager: u64,
    /// A plan is to be flown, and Safe mode would have no runway.
    pub no_runway_stored: bool,
    /// What must survive a restart can't be written.
    pub not_stored: bool,
    /// Somebody floods the port that everybody reaches.
    pub flooded: bool,
}

/// The alarms, and what may become one.
#[derive(Debug, Clone, Default)]
pub struct Alarms {
    raised: Vec<Watch>,
    suspected: Vec<(Watch, Time)>,
    /// Where it stood when it was found to stand still.
    stands_at: Option<LatLon>,
    /// Messages of another FP Manager that were ignored.
    ignored: u64,
    /// What the autopilot no longer says.
    stopped: Vec<&'static str>,
}

impl Alarms {
    /// Alarms that are raised now.
    pub fn raised(&self) -> Vec<Alarm> {
        self.raised.iter().map(|w| self.alarm(*w)).collect()
    }

    /// The engine has failed, or seems to have.
    pub fn engine_has_failed(&self) -> bool {
        self.raised.iter().any(|watch| matches!(watch, Watch::EngineOut | Watch::EngineSuspected | Watch::Disarmed))
    }

    /// What is down has to be found: that alarm says where. What is ignored is counted.
    fn alarm(&self, watch: Watch) -> Alarm {
        let mut alarm = watch.alarm();
        if let (Watch::StandsStill, Some(place)) = (watch, self.stands_at) {
            alarm.advice += &format!(" It is at {:.5}, {:.5}.", place.lat_deg, place.lon_deg);
        }
        if watch == Watch::StreamStopped {
            alarm.advice += &format!(" Missing: {}.", self.stopped.join(", "));
        }
        if watch == Watch::OtherFpManager {
            alarm.advice += &format!(" Ignored since the join: {}.", self.ignored);
        }
        alarm
    }

    /// Looks at everything once; events go to `out`.
    pub fn update(&mut self, now: Time, t: &Telemetry, inputs: AlarmInputs, out: &mut Vec<GatewayEvent>) {
        if !self.raised.contains(&Watch::StandsStill) {
            self.stands_at = t.fix.map(|(_, fix)| fix.position);
        }
        self.ignored = inputs.other_fp_manager;
        self.stopped.clone_from(&t.stopped);
        for watch in WATCHES {
            let raised = self.raised.contains(&watch);
            let wrong = is_wrong(watch, now, t, inputs, raised);
            self.follow(now, watch, wrong, raised, out);
        }
    }

    fn follow(&mut self, now: Time, watch: Watch, wrong: bool, raised: bool, out: &mut Vec<GatewayEvent>) {
        if !wrong {
            self.suspected.retain(|(w, _)| *w != watch);
            if raised {
                self.raised.retain(|w| *w != watch);
                out.push(GatewayEvent::AlarmCleared { id: watch.alarm().id });
            }
            return;
        }
        if raised {
            return;
        }
        let since = match self.suspected.iter().find(|(w, _)| *w == watch) {
            Some((_, since)) => *since,
            None => {
                self.suspected.push((watch, now));
                now
            }
        };
        if now.saturating_sub(since) >= watch.patience() {
            self.raised.push(watch);
            out.push(GatewayEvent::AlarmRaised(self.alarm(watch)));
        }
    }
}

fn is_wrong(watch: Watch, now: Time, t: &Telemetry, inputs: AlarmInputs, raised: bool) -> bool {
    let age = |since: Option<Time>| since.map(|s| now.saturating_sub(s));
    match watch {
        Watch::GpsLost => t.gps.is_some_and(|(_, g)| !g.fix_3d),
        Watch::EngineOut => {
            let needed = raised || inputs.sinks_below_target;
            let stands = |e| has_stopped(e, needed);
            // one that stood when it was last told of stands
            t.is_up(now) && t.engine(now).map_or(raised, stands)
        }
        Watch::EngineSuspected => {
            t.is_up(now) && t.engine(now).is_none() && strains(now, t, inputs, raised)
        }
        // if nothing comes at all, that is another alarm
        Watch::StreamStopped => {
            // some say of the wind, or of an engine, only what they measure in the air
            let flies = t.armed || t.is_up(now);
            flies && !t.stopped.is_empty() && age(t.last_received).is_some_and(|a| a < SILENT)
        }
        Watch::Sinks => inputs.sinks,
        Watch::Slow => inputs.slow,
        Watch::Fast => inputs.fast,
        Watch::OffAltitude => inputs.off_altitude,
        Watch::StandsStill => inputs.stands_still,
        Watch::Disarmed => inputs.disarmed,
        Watch::ListReplaced => inputs.list_replaced,
        Watch::NotInCommand => inputs.not_in_command,
        Watch::EnergyLow => {
            let limit = if raised { ENERGY_LOW.1 } else { ENERGY_LOW.0 };
            t.power.is_some_and(|(_, p)| p.battery < limit)
        }
        Watch::AutopilotSilent => age(t.last_received).is_some_and(|a| a > SILENT),
        Watch::PositionStale => t.is_up(now) && is_stale(now, t),
        Watch::Disobeys => age(inputs.disobeys_since).is_some_and(|a| a > DISOBEYS),
        Watch::NoSafeRunway => inputs.no_safe_runway,
        Watch::NoRunwayStored => inputs.no_runway_stored,
        Watch::OtherFpManager => inputs.other_fp_manager > 0,
        Watch::Exposed => inputs.exposed,
        Watch::Replay => inputs.replay,
        Watch::NotStored => inputs.not_stored,
        Watch::Flooded => inputs.flooded,
    }
}

/// It sinks or slows down at full throttle; once that was seen, until it climbs again: on the way down nothing else shows
/// it. An autopilot that pulls up to keep the altitude gives away its speed first.
fn strains(now: Time, t: &Telemetry, inputs: AlarmInputs, raised: bool) -> bool {
    match raised {
        true => inputs.slow || t.fix.is_none_or(|(_, fix)| fix.down_mps > -CLIMBING_MPS),
        false => {
            let full =
                |(at, throttle): (Time, f64)| now.saturating_sub(at) < FRESH && throttle > FULL_THROTTLE;
            (inputs.sinks || inputs.slow) && t.throttle.is_some_and(full)
        }
    }
}

/// Not every autopilot's throttle is what was asked for, so that a stopped engine is also known by
/// the height that is missing. An engine that idles on a descent is well.
fn has_stopped(engine: usal::contract::Engine, needed: bool) -> bool {
    engine.rpm < STOPPED_RPM && (needed || engine.throttle > THROTTLE)
}

fn is_stale(now: Time, t: &Telemetry) -> bool {
    let fast = t.fix.is_some_and(|(_, f)| f.north_mps.hypot(f.east_mps) > FLYING_MPS);
    let late = t.fix.is_some_and(|(at, _)| now.saturating_sub(at) > STALE);
    let frozen = t.moved.is_some_and(|at| now.saturating_sub(at) > STALE);
    late || (fast && frozen)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gateway::order::{Fix, Mode, Report};
    use usal::contract::{Engine, Gps, Power};

    /// Ten seconds of a good flight at 10 Hz, then ten with a fault, then ten good ones again.
    /// Returns the events with the tenths of a second since the fault began.
    fn check(fault: impl Fn(&mut Vec<Report>)) -> Vec<(i64, String)> {
        let (mut alarms, mut telemetry, mut events) = (Alarms::default(), Telemetry::default(), vec![]);
        for tenth in 0..300_i64 {
            let now = Duration::from_millis(100 * tenth as u64);
            let mut reports = good(tenth);
            if (100..200).contains(&tenth) {
                fault(&mut reports);
            }
            reports.iter().for_each(|r| telemetry.take(now, r));
            let mut out = vec![];
            alarms.update(now, &telemetry, AlarmInputs::default(), &mut out);
            events.extend(out.into_iter().map(|e| (tenth - 100, name(e))));
        }
        assert_eq!(alarms.raised(), vec![]);
        events
    }

    fn name(event: GatewayEvent) -> String {
        match event {
            GatewayEvent::AlarmRaised(a) => format!("+{}", a.id),
            GatewayEvent::AlarmCleared { id } => format!("-{id}"),
            other => panic!("{other:?}"),
        }
    }

    fn good(tenth: i64) -> Vec<Report> {
        let lat = 36.0 + tenth as f64 * 2e-5;
        vec![
            Report::Heartbeat { mode: Mode::Waypoints, name: "AUTO".into(), armed: true, failsafe: false },
            Report::OnGround(false),
            Report::Fix(Fix {
                position: LatLon::new(lat, -84.0),
                altitude_amsl_m: 500.0,
                altitude_home_m: 200.0,
                north_mps: 25.0,
                east_mps: 0.0,
                down_mps: 0.0,
            }),
            Report::Gps(Gps { fix_3d: true, satellites: 12, hdop: 0.8, unix_s: None }),
            Report::Engine(Engine { rpm: 5000.0, temperature_c: 80.0, throttle: 0.5 }),
            Report::Power(Power { voltage_v: 24.0, current_a: 12.0, battery: 0.8, fuel: None }),
        ]
    }

    #[test]
    fn each_fault_raises_its_alarm_in_time_and_clears_it() {
        type Spoil = fn(&mut Vec<Report>);
        let cases: [(&str, i64, Spoil); 5] = [
            ("gps-lost", 10, |r| {
                r[3] = Report::Gps(Gps { fix_3d: false, satellites: 0, hdop: 99.0, unix_s: None })
            }),
            ("engine-out", 10, |r| {
                r[4] = Report::Engine(Engine { rpm: 0.0, temperature_c: 80.0, throttle: 0.9 })
            }),
            ("energy-low", 20, |r| {
                r[5] = Report::Power(Power { voltage_v: 20.0, current_a: 12.0, battery: 0.1, fuel: None })
            }),
            ("autopilot-silent", 30, Vec::clear),
            ("position-stale", 10, |r| r.retain(|r| !matches!(r, Report::Fix(_)))),
        ];
        for (id, at_tenth, spoil) in cases {
            let about = |e: &(i64, String)| e.1.get(1..) == Some(id);
            let events: Vec<_> = check(spoil).into_iter().filter(about).collect();
            assert_eq!(events[0].1, format!("+{id}"));
            assert!((at_tenth - 1..=at_tenth + 1).contains(&events[0].0), "{id}: {events:?}");
            assert_eq!(events[1..], [(100, format!("-{id}"))], "{id}");
        }
    }

    /// Events while these inputs and reports go on for so many tenths of a second each.
    fn story(parts: &[(i64, AlarmInputs, Report)]) -> Vec<(i64, String)> {
        let (mut alarms, mut telemetry, mut events, mut tenth) =
            (Alarms::default(), Telemetry::default(), vec![], 0);
        for (tenths, inputs, report) in parts {
            for _ in 0..*tenths {
                let now = Duration::from_millis(100 * tenth as u64);
                let alive = good(tenth).into_iter().filter(|r| !matches!(r, Report::Engine(_)));
                alive.chain([report.clone()]).for_each(|r| telemetry.take(now, &r));
                let mut out = vec![];
                alarms.update(now, &telemetry, *inputs, &mut out);
                events.extend(out.into_iter().map(|e| (tenth, name(e))));
                tenth += 1;
            }
        }
        events
    }

    fn moving(down_mps: f64) -> Report {
        let position = LatLon::new(37.0, -84.0);
        let (altitude_amsl_m, altitude_home_m) = (500.0, 200.0);
        Report::Fix(Fix {
            position,
            altitude_amsl_m,
            altitude_home_m,
            north_mps: 25.0,
            east_mps: 0.0,
            down_mps,
        })
    }

    #[test]
    fn an_engine_that_says_nothing_is_suspected_at_full_throttle_until_it_climbs() {
        let sinks = AlarmInputs { sinks: true, ..AlarmInputs::default() };
        let well = AlarmInputs::default();
        let throttle = Report::Throttle;
        let events =
            story(&[(20, sinks, throttle(0.5)), (100, sinks, throttle(1.0)), (50, well, moving(3.0))]);
        assert_eq!(events, [(50, "+sinks".into()), (70, "+engine-suspected".into()), (120, "-sinks".into())]);
        let slow = AlarmInputs { slow: true, ..AlarmInputs::default() };
        let events = story(&[(20, slow, throttle(0.5)), (40, slow, throttle(1.0)), (20, slow, moving(-1.0))]);
        assert_eq!(events, [(50, "+slow".into()), (70, "+engine-suspected".into())]);
        let climbing = story(&[(100, sinks, throttle(1.0)), (5, well, moving(-1.0))]);
        assert!(climbing.contains(&(100, "-engine-suspected".into())), "{climbing:?}");
    }

    #[test]
    fn an_engine_that_is_no_longer_told_of_is_suspected_like_one_that_never_was() {
        let sinks = AlarmInputs { sinks: true, ..AlarmInputs::default() };
        let runs = Report::Engine(Engine { rpm: 5000.0, temperature_c: 80.0, throttle: 1.0 });
        let events = story(&[(20, AlarmInputs::default(), runs), (200, sinks, Report::Throttle(1.0))]);
        assert!(events.iter().any(|(_, name)| name == "+engine-suspected"), "{events:?}");
    }

    #[test]
    fn what_is_no_longer_said_is_named() {
        let (mut alarms, mut telemetry) = (Alarms::default(), Telemetry::default());
        telemetry.take(Duration::ZERO, &Report::Stopped(vec!["GPS", "battery"]));
        telemetry.take(Duration::ZERO, &Report::Alive);
        for second in [0, 2] {
            alarms.update(Duration::from_secs(second), &telemetry, AlarmInputs::default(), &mut vec![]);
        }
        assert_eq!(alarms.raised(), [], "on the ground, and not armed");
        good(0).iter().for_each(|report| telemetry.take(Duration::ZERO, report));
        for second in [0, 2] {
            alarms.update(Duration::from_secs(second), &telemetry, AlarmInputs::default(), &mut vec![]);
        }
        let raised = alarms.raised();
        let told = raised.iter().find(|a| a.id == "stream-stopped").unwrap();
        assert!(told.advice.ends_with("Missing: GPS, battery."), "{}", told.advice);
        alarms.update(Duration::from_secs(5), &telemetry, AlarmInputs::default(), &mut vec![]);
        assert_eq!(alarms.raised().iter().filter(|a| a.id == "stream-stopped").count(), 0, "all is silent");
    }

    #[test]
    fn what_stands_still_or_is_steered_by_another_is_told() {
        let still = AlarmInputs { stands_still: true, ..AlarmInputs::default() };
        let other = AlarmInputs { not_in_command: true, ..AlarmInputs::default() };
        let events = story(&[(150, still, moving(0.0)), (2, other, moving(0.0))]);
        let told = [(100, "+stands-still"), (150, "-stands-still"), (150, "+not-in-command")];
        assert_eq!(events, told.map(|(tenth, name)| (tenth, name.to_owned())));
    }

    #[test]
    fn a_flooded_port_is_told_and_its_end_too() {
        let flooded = AlarmInputs { flooded: true, ..AlarmInputs::default() };
        let events = story(&[(5, flooded, moving(0.0)), (2, AlarmInputs::default(), moving(0.0))]);
        assert_eq!(events, [(0, "+port-flooded".into()), (5, "-port-flooded".into())]);
    }

    #[test]
    fn what_stands_still_says_where_it_is() {
        let (mut alarms, mut telemetry) = (Alarms::default(), Telemetry::default());
        telemetry.take(Duration::ZERO, &moving(0.0));
        let still = AlarmInputs { stands_still: true, ..AlarmInputs::default() };
        for second in [0, 10] {
            alarms.update(Duration::from_secs(second), &telemetry, still, &mut vec![]);
        }
        let raised = alarms.raised();
        let told = raised.iter().find(|a| a.id == "stands-still").unwrap();
        assert!(told.advice.ends_with("It is at 37.00000, -84.00000."), "{}", told.advice);
    }

    #[test]
    fn a_frozen_position_is_stale_within_about_a_second() {
        let frozen = good(100)[2].clone();
        let events = check(move |r| r[2] = frozen.clone());
        assert_eq!(events[0].1, "+position-stale");
        assert!((9..=12).contains(&events[0].0), "{events:?}");
    }

    #[test]
    fn an_idling_engine_without_throttle_is_not_out() {
        let events =
            check(|r| r[4] = Report::Engine(Engine { rpm: 0.0, temperature_c: 80.0, throttle: 0.0 }));
        assert_eq!(events, vec![]);
    }
}
