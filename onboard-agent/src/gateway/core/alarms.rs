//! Alarms: raised when something has been wrong for a while, cleared when it is right again.

mod climb;
mod watches;

use super::off_path::{Beside, OFF_PATH_M};
use super::telemetry::{FRESH, Telemetry};
use crate::gateway::order::Time;
use aircraft::GRAVITY_MPS2;
use climb::Climb;
use geometry::LatLon;
use std::time::Duration;
use usal::contract::{Alarm, Cause, GatewayEvent};
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
/// So long does an engine seem to have failed whose autopilot says so.
const TOLD: Duration = Duration::from_secs(2);
/// A height that changes by less than this has become less, with what the airspeed is worth, m/s.
const LOSING_MPS: f64 = -0.5;
/// An engine that has failed, or seems to.
const ENGINE: [Watch; 2] = [Watch::EngineOut, Watch::EngineSuspected];
/// The autopilot did not follow an order for so long.
const DISOBEYS: Duration = Duration::from_secs(4);

/// What the alarms need beside telemetry.
#[derive(Debug, Clone, Copy, Default)]
pub struct AlarmInputs {
    /// Since when the autopilot has not followed an order.
    pub disobeys_since: Option<Time>,
    /// It is below the waypoint that it steers to, and sinks: the engine ought to work.
    pub sinks_below_target: bool,
    /// It sinks below the altitude that it was told to fly at; `None`: that is not known.
    pub sinks: Option<bool>,
    /// It flies far slower than it was told to.
    pub slow: bool,
    /// It flies far faster than it was told to.
    pub fast: bool,
    /// It is far from the altitude that it was told to fly at, and comes no nearer; `None`: that is not known.
    pub off_altitude: Option<bool>,
    /// Where it is beside its way; `None`: that is not known.
    pub beside_path: Option<Beside>,
    /// It ought to fly, and does not move; `None`: that is not known.
    pub stands_still: Option<bool>,
    /// It circles at a waypoint, and comes no nearer to its altitude.
    pub no_further: bool,
    /// It flies, and is not armed.
    pub disarmed: bool,
    /// It was ended by force, and is armed.
    pub flies_on: bool,
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
    /// What may be raised or cleared soon, and since when.
    changing: Vec<(Watch, Time)>,
    /// What it shows of its engine by climbing, or by staying up.
    climb: Climb,
    /// Where it stood when it was found to stand still.
    stands_at: Option<LatLon>,
    /// Messages of another FP Manager that were ignored.
    ignored: u64,
    /// What the autopilot no longer says.
    stopped: Vec<&'static str>,
    /// How it is set up otherwise than a flight needs.
    set_up: Vec<String>,
    /// It is known to be on the ground.
    stands: bool,
}

impl Alarms {
    /// Alarms that are raised now.
    pub fn raised(&self) -> Vec<Alarm> {
        self.raised.iter().map(|w| self.alarm(*w)).collect()
    }

    /// The engine has failed, or seems to have.
    pub fn engine_has_failed(&self) -> bool {
        self.raised.iter().any(|watch| watch.alarm().cause == Some(Cause::Engine))
    }

    /// The worst emergency of those that are raised, in words.
    pub fn emergency(&self) -> Option<&'static str> {
        let worst = self.raised.iter().filter_map(|watch| watch.alarm().cause).max()?;
        // of the other causes the gateway knows nothing
        let words = [
            (Cause::Engine, "the engine is out, or seems to be"),
            (Cause::Energy, "little energy is left"),
            (Cause::Gps, "the position is not known"),
        ];
        words.into_iter().find(|(cause, _)| *cause == worst).map(|(_, words)| words)
    }

    /// The alarm of an engine that has failed, or seems to, for a gateway that follows this one: on the way down nothing else shows it.
    pub fn of_engine(&self) -> Option<String> {
        ENGINE.into_iter().find(|watch| self.raised.contains(watch)).map(|watch| watch.alarm().id)
    }

    /// Takes that up again, until it is seen to be over.
    pub fn take_up(&mut self, id: &str, out: &mut Vec<GatewayEvent>) {
        let was = ENGINE.into_iter().find(|watch| watch.alarm().id == id && !self.raised.contains(watch));
        if let Some(watch) = was {
            self.raised.push(watch);
            out.push(GatewayEvent::AlarmRaised(self.alarm(watch)));
        }
    }

    /// What is down has to be found: that alarm says where. What is ignored is counted.
    fn alarm(&self, watch: Watch) -> Alarm {
        let mut alarm = watch.alarm();
        if let Some(advice) = watch.advice_on_ground().filter(|_| self.stands) {
            alarm.advice = advice.into();
        }
        if let (Watch::StandsStill, Some(place)) = (watch, self.stands_at) {
            alarm.advice += &format!(" It is at {:.5}, {:.5}.", place.lat_deg, place.lon_deg);
        }
        if watch == Watch::StreamStopped {
            alarm.advice += &format!(" Missing: {}.", self.stopped.join(", "));
        }
        if watch == Watch::SetUp {
            alarm.advice += &self.set_up.iter().map(|what| format!(" {what}.")).collect::<String>();
        }
        if watch == Watch::OtherFpManager {
            alarm.advice += &format!(" Ignored since the join: {}.", self.ignored);
        }
        alarm
    }

    /// What is known of the engine counts no more: a person has started the autopilot anew, or takes off with one that does not tell how its
    /// engine turns.
    pub fn forget_engine(&mut self, out: &mut Vec<GatewayEvent>) {
        let forgotten = self.raised.extract_if(.., |watch| ENGINE.contains(watch));
        out.extend(forgotten.map(|watch| GatewayEvent::AlarmCleared { id: watch.alarm().id }));
    }

    /// Looks at everything once; events go to `out`.
    pub fn update(&mut self, now: Time, t: &Telemetry, inputs: AlarmInputs, out: &mut Vec<GatewayEvent>) {
        if !self.raised.contains(&Watch::StandsStill) {
            self.stands_at = t.fix.map(|(_, fix)| fix.position);
        }
        self.ignored = inputs.other_fp_manager;
        self.stands = t.stands(now);
        self.stopped.clone_from(&t.stopped);
        self.set_up.clone_from(&t.set_up);
        self.climb.take(now, t);
        let is_up = t.is_up(now);
        for watch in WATCHES {
            let wrong = self.is_wrong(watch, now, t, inputs);
            let patience = match wrong {
                true if watch == Watch::EngineSuspected && t.warns_of_engine(now) => TOLD,
                true => watch.patience(),
                false if is_up => watch.clears_after(),
                false => Duration::ZERO,
            };
            self.follow(now, watch, (wrong, patience), out);
        }
    }

    fn is_wrong(&self, watch: Watch, now: Time, t: &Telemetry, inputs: AlarmInputs) -> bool {
        let raised = self.raised.contains(&watch);
        let age = |since: Option<Time>| since.map(|s| now.saturating_sub(s));
        match watch {
            Watch::GpsLost => t.gps.is_some_and(|(_, g)| !g.fix_3d),
            // come down, nothing mends it until it is seen to run; one that was well is stopped there
            Watch::EngineOut if !t.is_up(now) => raised && !is_seen_to_run(now, t),
            Watch::EngineOut => {
                let needed = raised || inputs.sinks_below_target;
                let stands = |e| has_stopped(e, needed);
                // one that stood when it was last told of stands
                t.engine(now).map_or(raised, stands)
            }
            Watch::EngineSuspected if !t.is_up(now) => raised && !is_seen_to_run(now, t),
            Watch::EngineSuspected => self.is_engine_doubtful(now, t, inputs, raised),
            // if nothing comes at all, that is another alarm
            Watch::StreamStopped => {
                // some say of the wind, or of an engine, only what they measure in the air
                let flies = t.armed || t.is_up(now);
                flies && !t.stopped.is_empty() && age(t.last_received).is_some_and(|a| a < SILENT)
            }
            Watch::SetUp => !t.set_up.is_empty(),
            Watch::Sinks => inputs.sinks.unwrap_or(raised),
            Watch::Slow => inputs.slow,
            Watch::Fast => inputs.fast,
            Watch::OffAltitude => inputs.off_altitude.unwrap_or(raised),
            Watch::OffPath => inputs.beside_path.map_or(raised, |beside| match raised {
                true => beside.metres > OFF_PATH_M.1,
                false => beside.metres > OFF_PATH_M.0 && !beside.returns,
            }),
            Watch::StandsStill => inputs.stands_still.unwrap_or(raised),
            Watch::NoFurther => inputs.no_further,
            Watch::Disarmed => inputs.disarmed,
            Watch::FliesOn => inputs.flies_on,
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

    /// It sinks or slows down at full throttle, far from what it was told, and does not tell how its engine turns; of one whose autopilot
    /// warned of it, it need not be far from that yet. Words alone are never enough, nor is full throttle in a climb.
    /// Once that was seen, until it has flown as nothing does without an engine, or tells that it turns: on the way down nothing else
    /// shows it. An autopilot that pulls up to keep the altitude gives away its speed first.
    fn is_engine_doubtful(&self, now: Time, t: &Telemetry, inputs: AlarmInputs, raised: bool) -> bool {
        let full = |(at, throttle): (Time, f64)| now.saturating_sub(at) < FRESH && throttle > FULL_THROTTLE;
        match t.engine(now) {
            // that it stands is an alarm of its own
            Some(engine) => raised && engine.rpm < STOPPED_RPM && !self.raised.contains(&Watch::EngineOut),
            None if raised => inputs.slow || !self.climb.shows_an_engine(now, t),
            None if !t.throttle.is_some_and(full) => false,
            None if t.warns_of_engine(now) => energy_mps(now, t).is_some_and(|mps| mps < LOSING_MPS),
            None => inputs.sinks == Some(true) || inputs.slow,
        }
    }

    /// Raised or cleared, once it has been so for long enough.
    fn follow(
        &mut self,
        now: Time,
        watch: Watch,
        (wrong, patience): (bool, Duration),
        out: &mut Vec<GatewayEvent>,
    ) {
        let known = self.changing.iter().position(|(w, _)| *w == watch);
        if wrong == self.raised.contains(&watch) {
            known.map(|at| self.changing.swap_remove(at));
            return;
        }
        let since = known.and_then(|at| self.changing.get(at)).map_or(now, |(_, since)| *since);
        if now.saturating_sub(since) < patience {
            if known.is_none() {
                self.changing.push((watch, now));
            }
            return;
        }
        self.changing.retain(|(w, _)| *w != watch);
        if wrong {
            self.raised.push(watch);
            out.push(GatewayEvent::AlarmRaised(self.alarm(watch)));
        } else {
            self.raised.retain(|w| *w != watch);
            out.push(GatewayEvent::AlarmCleared { id: watch.alarm().id });
        }
    }
}

/// Not every autopilot's throttle is what was asked for, so that a stopped engine is also known by
/// the height that is missing. An engine that idles on a descent is well.
fn has_stopped(engine: usal::contract::Engine, needed: bool) -> bool {
    engine.rpm < STOPPED_RPM && (needed || engine.throttle > THROTTLE)
}

fn is_seen_to_run(now: Time, t: &Telemetry) -> bool {
    t.engine(now).is_some_and(|engine| engine.rpm >= STOPPED_RPM)
}

/// How fast its height grows, with that which its airspeed is worth, m/s. `None`: where it is, is not known.
fn energy_mps(now: Time, t: &Telemetry) -> Option<f64> {
    let airspeed_mps = t.air.map_or(0.0, |(_, air)| air.airspeed_mps);
    t.fix_now(now).map(|fix| airspeed_mps * t.airspeed.gains_mps2() / GRAVITY_MPS2 - fix.down_mps)
}

fn is_stale(now: Time, t: &Telemetry) -> bool {
    let fast = t.fix.is_some_and(|(_, f)| f.north_mps.hypot(f.east_mps) > FLYING_MPS);
    let late = t.fix.is_some_and(|(at, _)| now.saturating_sub(at) > STALE);
    let frozen = t.moved.is_some_and(|at| now.saturating_sub(at) > STALE);
    late || (fast && frozen)
}

#[cfg(test)]
mod tests;
