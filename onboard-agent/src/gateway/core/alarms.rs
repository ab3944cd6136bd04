//! Alarms: raised when something has been wrong for a while, cleared when it is right again.

use super::telemetry::Telemetry;
use crate::gateway::order::Time;
use std::time::Duration;
use usal::contract::{Alarm, Cause, GatewayEvent, Severity};

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
/// The autopilot did not follow an order for so long.
const DISOBEYS: Duration = Duration::from_secs(4);

/// What the gateway watches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Watch {
    GpsLost,
    EngineOut,
    EnergyLow,
    AutopilotSilent,
    PositionStale,
    Disobeys,
    NoSafeRunway,
    NoRunwayStored,
    OtherFpManager,
    Exposed,
    NotStored,
}

const WATCHES: [Watch; 11] = [
    Watch::GpsLost,
    Watch::EngineOut,
    Watch::EnergyLow,
    Watch::AutopilotSilent,
    Watch::PositionStale,
    Watch::Disobeys,
    Watch::NoSafeRunway,
    Watch::NoRunwayStored,
    Watch::OtherFpManager,
    Watch::Exposed,
    Watch::NotStored,
];

impl Watch {
    fn alarm(self) -> Alarm {
        let (id, severity, source, advice, cause) = match self {
            Watch::GpsLost => (
                "gps-lost",
                Severity::Warning,
                "gps",
                "Position is not known. Be ready to take over by hand; fly the emergency plan.",
                Some(Cause::Gps),
            ),
            Watch::EngineOut => (
                "engine-out",
                Severity::Warning,
                "engine",
                "The engine does not turn. Land at the nearest runway within gliding reach.",
                Some(Cause::Engine),
            ),
            Watch::EnergyLow => (
                "energy-low",
                Severity::Warning,
                "power",
                "Little energy is left. Return and land.",
                Some(Cause::Energy),
            ),
            Watch::AutopilotSilent => (
                "autopilot-silent",
                Severity::Warning,
                "link",
                "Nothing is heard from the autopilot; it flies on by itself. Check the link.",
                None,
            ),
            Watch::PositionStale => (
                "position-stale",
                Severity::Caution,
                "gps",
                "The position no longer changes. Do not trust the map.",
                None,
            ),
            Watch::Disobeys => (
                "autopilot-disobeys",
                Severity::Warning,
                "autopilot",
                "The autopilot has not confirmed what it was told; it is told again. Be ready to take over by hand.",
                None,
            ),
            Watch::NoSafeRunway => (
                "no-safe-runway",
                Severity::Warning,
                "safe",
                "Safe mode knows no runway within reach; the autopilot returns by its own means. Store runways before flight.",
                None,
            ),
            Watch::NoRunwayStored => (
                "no-runway-stored",
                Severity::Caution,
                "safe",
                "Safe mode has no runway to return to. Commit or start a plan that has one, or store runways by hand.",
                None,
            ),
            Watch::OtherFpManager => (
                "other-fp-manager",
                Severity::Caution,
                "fp-manager",
                "Another program than the FP Manager that joined sends its heartbeats; they do not count. Find it and stop it.",
                None,
            ),
            Watch::Exposed => (
                "exposed",
                Severity::Caution,
                "gateway",
                "The agent listens where strangers can connect, and nothing protects it: whoever does can read everything, commit plans and give every command.",
                None,
            ),
            Watch::NotStored => (
                "not-stored",
                Severity::Caution,
                "gateway",
                "Runways and the state of the flight can't be stored: a gateway that starts anew forgets them. Check the disk of the state directory.",
                None,
            ),
        };
        Alarm { id: id.into(), severity, source: source.into(), advice: advice.into(), cause }
    }

    /// How long it has to be wrong before the alarm is raised.
    fn patience(self) -> Duration {
        match self {
            Watch::GpsLost | Watch::EngineOut => Duration::from_secs(1),
            Watch::EnergyLow => Duration::from_secs(2),
            // those of a plan come a moment after it
            Watch::NoRunwayStored => Duration::from_secs(3),
            // a new process has heartbeats before it joins
            Watch::OtherFpManager => Duration::from_secs(3),
            _ => Duration::ZERO,
        }
    }
}

/// What the alarms need beside telemetry.
#[derive(Debug, Clone, Copy, Default)]
pub struct AlarmInputs {
    /// Since when the autopilot has not followed an order.
    pub disobeys_since: Option<Time>,
    /// It is below the waypoint that it steers to, and sinks: the engine ought to work.
    pub sinks_below_target: bool,
    /// Safe mode needed a runway and found none.
    pub no_safe_runway: bool,
    /// It listens where strangers can connect.
    pub exposed: bool,
    /// Heartbeats come from another program than the one that joined.
    pub other_fp_manager: bool,
    /// A plan is to be flown, and Safe mode would have no runway.
    pub no_runway_stored: bool,
    /// What must survive a restart can't be written.
    pub not_stored: bool,
}

/// The alarms, and what may become one.
#[derive(Debug, Clone, Default)]
pub struct Alarms {
    raised: Vec<Watch>,
    suspected: Vec<(Watch, Time)>,
}

impl Alarms {
    /// Alarms that are raised now.
    pub fn raised(&self) -> Vec<Alarm> {
        self.raised.iter().map(|w| w.alarm()).collect()
    }

    /// Looks at everything once; events go to `out`.
    pub fn update(&mut self, now: Time, t: &Telemetry, inputs: AlarmInputs, out: &mut Vec<GatewayEvent>) {
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
            out.push(GatewayEvent::AlarmRaised(watch.alarm()));
        }
    }
}

fn is_wrong(watch: Watch, now: Time, t: &Telemetry, inputs: AlarmInputs, raised: bool) -> bool {
    let age = |since: Option<Time>| since.map(|s| now.saturating_sub(s));
    match watch {
        Watch::GpsLost => t.gps.is_some_and(|(_, g)| !g.fix_3d),
        Watch::EngineOut => {
            let needed = raised || inputs.sinks_below_target;
            t.is_airborne() && t.engine.is_some_and(|(_, e)| has_stopped(e, needed))
        }
        Watch::EnergyLow => {
            let limit = if raised { ENERGY_LOW.1 } else { ENERGY_LOW.0 };
            t.power.is_some_and(|(_, p)| p.battery < limit)
        }
        Watch::AutopilotSilent => age(t.last_received).is_some_and(|a| a > SILENT),
        Watch::PositionStale => t.is_airborne() && is_stale(now, t),
        Watch::Disobeys => age(inputs.disobeys_since).is_some_and(|a| a > DISOBEYS),
        Watch::NoSafeRunway => inputs.no_safe_runway,
        Watch::NoRunwayStored => inputs.no_runway_stored,
        Watch::OtherFpManager => inputs.other_fp_manager,
        Watch::Exposed => inputs.exposed,
        Watch::NotStored => inputs.not_stored,
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
    use geometry::LatLon;
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
            Report::Heartbeat { mode: Mode::Waypoints, name: "AUTO".into(), armed: true },
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
