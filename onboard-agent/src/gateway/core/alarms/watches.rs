//! What the gateway watches, and what it says of each.

use std::time::Duration;
use usal::contract::{Alarm, Cause, Severity};

/// Something that may be wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Watch {
    /// No position fix.
    GpsLost,
    /// The engine does not turn.
    EngineOut,
    /// It sinks at full throttle, and says nothing of its engine.
    EngineSuspected,
    /// Little energy is left.
    EnergyLow,
    /// Nothing is heard.
    AutopilotSilent,
    /// The position does not change.
    PositionStale,
    /// Something that it used to say no longer comes.
    StreamStopped,
    /// Its parameters are in the way of a flight.
    SetUp,
    /// An order is not followed.
    Disobeys,
    /// It sinks below what was commanded.
    Sinks,
    /// It is far slower than what was commanded.
    Slow,
    /// It is far faster than what was commanded.
    Fast,
    /// It is far above or below what was commanded.
    OffAltitude,
    /// It is far beside the way that was commanded.
    OffPath,
    /// It ought to fly and does not move.
    StandsStill,
    /// It does not get past a waypoint.
    NoFurther,
    /// It flies, and its engine may not run.
    Disarmed,
    /// It does not end its flight.
    FliesOn,
    /// Somebody else wrote a list.
    ListReplaced,
    /// Somebody else steers.
    NotInCommand,
    /// Safe mode found no runway.
    NoSafeRunway,
    /// Safe mode would have no runway.
    NoRunwayStored,
    /// Two FP Managers.
    OtherFpManager,
    /// Strangers can connect.
    Exposed,
    /// A log is played.
    Replay,
    /// The state directory can not be written.
    NotStored,
    /// Somebody opens connections without end.
    Flooded,
}

/// What is said of a watch, and how long it has to be wrong before that is said.
struct Words {
    watch: Watch,
    id: &'static str,
    severity: Severity,
    source: &'static str,
    advice: &'static str,
    /// The emergency that it is.
    cause: Option<Cause>,
    patience: Duration,
}

/// All of them, in the order in which they are looked at.
pub const WATCHES: [Watch; 27] = [
    Watch::GpsLost,
    Watch::EngineOut,
    Watch::EngineSuspected,
    Watch::EnergyLow,
    Watch::AutopilotSilent,
    Watch::PositionStale,
    Watch::StreamStopped,
    Watch::SetUp,
    Watch::Disobeys,
    Watch::Sinks,
    Watch::Slow,
    Watch::Fast,
    Watch::OffAltitude,
    Watch::OffPath,
    Watch::StandsStill,
    Watch::NoFurther,
    Watch::Disarmed,
    Watch::FliesOn,
    Watch::ListReplaced,
    Watch::NotInCommand,
    Watch::NoSafeRunway,
    Watch::NoRunwayStored,
    Watch::OtherFpManager,
    Watch::Exposed,
    Watch::Replay,
    Watch::NotStored,
    Watch::Flooded,
];

const WORDS: [Words; WATCHES.len()] = [
    Words {
        watch: Watch::GpsLost,
        id: "gps-lost",
        severity: Severity::Warning,
        source: "gps",
        advice: "Position is not known. Be ready to take over by hand; fly the emergency plan.",
        cause: Some(Cause::Gps),
        patience: Duration::from_secs(1),
    },
    Words {
        watch: Watch::EngineOut,
        id: "engine-out",
        severity: Severity::Warning,
        source: "engine",
        advice: "The engine does not turn. Land at the nearest runway within gliding reach.",
        cause: Some(Cause::Engine),
        patience: Duration::from_secs(1),
    },
    Words {
        watch: Watch::EngineSuspected,
        id: "engine-suspected",
        severity: Severity::Warning,
        source: "engine",
        advice: "The aircraft sinks or slows down as without an engine, at full throttle: the engine may have failed. Land at the nearest runway within gliding reach.",
        cause: Some(Cause::Engine),
        patience: Duration::from_secs(5),
    },
    Words {
        watch: Watch::EnergyLow,
        id: "energy-low",
        severity: Severity::Warning,
        source: "power",
        advice: "Little energy is left. Return and land.",
        cause: Some(Cause::Energy),
        patience: Duration::from_secs(2),
    },
    Words {
        watch: Watch::AutopilotSilent,
        id: "autopilot-silent",
        severity: Severity::Warning,
        source: "link",
        advice: "Nothing is heard from the autopilot; it flies on by itself. Check the link.",
        cause: None,
        patience: Duration::from_secs(0),
    },
    Words {
        watch: Watch::PositionStale,
        id: "position-stale",
        severity: Severity::Caution,
        source: "gps",
        advice: "The position no longer changes. Do not trust the map.",
        cause: None,
        patience: Duration::from_secs(0),
    },
    Words {
        watch: Watch::StreamStopped,
        id: "stream-stopped",
        severity: Severity::Caution,
        source: "link",
        advice: "The autopilot no longer says all that it used to, although it was asked again: what is shown of it is old, and what it would warn of is not seen. Check its parameters and the link's load.",
        cause: None,
        // after a silence all comes again, one after the other
        patience: Duration::from_secs(2),
    },
    Words {
        watch: Watch::SetUp,
        id: "set-up",
        severity: Severity::Caution,
        source: "autopilot",
        advice: "The autopilot's parameters are in the way of a flight. Set them as is said here, on the ground.",
        cause: None,
        patience: Duration::from_secs(0),
    },
    Words {
        watch: Watch::Disobeys,
        id: "autopilot-disobeys",
        severity: Severity::Warning,
        source: "autopilot",
        advice: "The autopilot has not confirmed what it was told; it is told again. Be ready to take over by hand.",
        cause: None,
        patience: Duration::from_secs(0),
    },
    Words {
        watch: Watch::Sinks,
        id: "sinks",
        severity: Severity::Warning,
        source: "autopilot",
        advice: "The aircraft sinks below the altitude that it was told to fly at. Look at airspeed, engine and ice; be ready to take over by hand.",
        cause: None,
        patience: Duration::from_secs(5),
    },
    Words {
        watch: Watch::Slow,
        id: "slow",
        severity: Severity::Warning,
        source: "autopilot",
        advice: "The aircraft flies far slower than it was told to. Look at engine, airspeed sensor and ice; be ready to take over by hand.",
        cause: None,
        patience: Duration::from_secs(5),
    },
    Words {
        watch: Watch::Fast,
        id: "fast",
        severity: Severity::Warning,
        source: "autopilot",
        advice: "The aircraft flies far faster than it was told to. Look at airspeed sensor, engine and descent; be ready to take over by hand.",
        cause: None,
        patience: Duration::from_secs(10),
    },
    Words {
        watch: Watch::OffAltitude,
        id: "off-altitude",
        severity: Severity::Warning,
        source: "autopilot",
        advice: "The aircraft is more than 50 m above or below the altitude that it was told to fly at, and comes no nearer. Look at engine, ice and altimeter; be ready to take over by hand.",
        cause: None,
        patience: Duration::from_secs(10),
    },
    Words {
        watch: Watch::OffPath,
        id: "off-path",
        severity: Severity::Warning,
        source: "autopilot",
        advice: "The aircraft is more than 100 m beside the way that it was told to fly, and comes no nearer. Look at wind, controls and compass; be ready to take over by hand.",
        cause: None,
        patience: Duration::from_secs(10),
    },
    Words {
        watch: Watch::StandsStill,
        id: "stands-still",
        severity: Severity::Warning,
        source: "autopilot",
        advice: "It is armed and ought to fly, but does not move: it may be down. Disarm it before anybody goes near.",
        cause: None,
        patience: Duration::from_secs(10),
    },
    Words {
        watch: Watch::NoFurther,
        id: "no-further",
        severity: Severity::Warning,
        source: "autopilot",
        advice: "The aircraft circles at a waypoint and does not come to its altitude, so it gets no further. Look at engine and ice; go to a leg that is lower, or bring it home.",
        cause: None,
        patience: Duration::from_secs(0),
    },
    Words {
        watch: Watch::Disarmed,
        id: "disarmed-in-flight",
        severity: Severity::Warning,
        source: "autopilot",
        advice: "The aircraft flies and is not armed: its engine does not run. Arm it again, or take over by hand and land at the nearest runway within gliding reach.",
        cause: Some(Cause::Engine),
        // a heartbeat or two may be wrong, and one that does not say whether it stands may still roll
        patience: Duration::from_secs(3),
    },
    Words {
        watch: Watch::FliesOn,
        id: "not-terminated",
        severity: Severity::Warning,
        source: "autopilot",
        advice: "The flight was ended by force, and the autopilot has not done it: the engine may run. It is told again each second, as soon as it is heard. Keep everybody away; end it by hand if you can.",
        cause: None,
        // as long as it takes to tell it, and to see that it is done
        patience: Duration::from_secs(3),
    },
    Words {
        watch: Watch::ListReplaced,
        id: "list-replaced",
        severity: Severity::Caution,
        source: "autopilot",
        advice: "Another station put its own list in the place of the plan's. It is not flown, and the plan's is written again. Find out who did that.",
        cause: None,
        patience: Duration::from_secs(0),
    },
    Words {
        watch: Watch::NotInCommand,
        id: "not-in-command",
        severity: Severity::Warning,
        source: "autopilot",
        advice: "A pilot, another station or a failsafe of the autopilot decides what is flown, and not the plan. When it is safe to, resume takes the aircraft back.",
        cause: None,
        patience: Duration::from_secs(0),
    },
    Words {
        watch: Watch::NoSafeRunway,
        id: "no-safe-runway",
        severity: Severity::Warning,
        source: "safe",
        advice: "Safe mode knows no runway within reach; the autopilot returns by its own means. Store runways before flight.",
        cause: None,
        patience: Duration::from_secs(0),
    },
    Words {
        watch: Watch::NoRunwayStored,
        id: "no-runway-stored",
        severity: Severity::Caution,
        source: "safe",
        advice: "Safe mode has no runway to return to. Commit or start a plan that has one, or store runways by hand.",
        cause: None,
        // those of a plan come a moment after it
        patience: Duration::from_secs(3),
    },
    Words {
        watch: Watch::OtherFpManager,
        id: "other-fp-manager",
        severity: Severity::Caution,
        source: "fp-manager",
        advice: "Another program than the FP Manager that joined sends its heartbeats; they do not count. Find it and stop it.",
        cause: None,
        // a new process has heartbeats before it joins
        patience: Duration::from_secs(3),
    },
    Words {
        watch: Watch::Exposed,
        id: "exposed",
        severity: Severity::Caution,
        source: "gateway",
        advice: "The agent listens where strangers can connect, and nothing protects it: whoever does can read everything, commit plans and give every command.",
        cause: None,
        patience: Duration::from_secs(0),
    },
    Words {
        watch: Watch::Replay,
        id: "replay",
        severity: Severity::Caution,
        source: "gateway",
        advice: "This is a replay: a telemetry log is played, and no aircraft is at the other end. Nothing can be commanded.",
        cause: None,
        patience: Duration::from_secs(0),
    },
    Words {
        watch: Watch::NotStored,
        id: "not-stored",
        severity: Severity::Caution,
        source: "gateway",
        advice: "Runways and the state of the flight can't be stored: a gateway that starts anew forgets them. Check the disk of the state directory.",
        cause: None,
        patience: Duration::from_secs(0),
    },
    Words {
        watch: Watch::Flooded,
        id: "port-flooded",
        severity: Severity::Caution,
        source: "gateway",
        advice: "Somebody opens connections to the agent's port and says nothing, or more than an address may have. They are closed; a new ground station may need several tries. The gateway's log says from where.",
        cause: None,
        patience: Duration::from_secs(0),
    },
];

impl Watch {
    fn words(self) -> &'static Words {
        WORDS.iter().find(|words| words.watch == self).unwrap_or(&WORDS[0])
    }

    /// Its alarm.
    pub fn alarm(self) -> Alarm {
        let Words { id, severity, source, advice, cause, .. } = self.words();
        Alarm {
            id: (*id).into(),
            severity: *severity,
            source: (*source).into(),
            advice: (*advice).into(),
            cause: *cause,
        }
    }

    /// What is to be done of it on the ground, where what is to be done in the air would be wrong.
    pub fn advice_on_ground(self) -> Option<&'static str> {
        Some(match self {
            Watch::GpsLost => "Position is not known. Do not take off.",
            Watch::EngineOut | Watch::EngineSuspected => {
                "It is down, and its engine failed in the air. Look at the engine before another start."
            }
            Watch::EnergyLow => "Little energy is left. Charge it before another start.",
            _ => return None,
        })
    }

    /// How long it has to be wrong before the alarm is raised.
    pub fn patience(self) -> Duration {
        self.words().patience
    }

    /// How long it has to be right in the air before the alarm is cleared. By whether an engine runs a way home is chosen: one heartbeat
    /// or one reading of a propeller that the wind turns is not believed.
    pub fn clears_after(self) -> Duration {
        match self {
            Watch::EngineOut | Watch::Disarmed => Duration::from_millis(1500),
            _ => Duration::ZERO,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_watch_has_words_of_its_own() {
        for watch in WATCHES {
            assert_eq!(WORDS.iter().filter(|words| words.watch == watch).count(), 1, "{watch:?}");
            assert_eq!(WORDS.iter().filter(|words| words.id == watch.words().id).count(), 1, "{watch:?}");
        }
    }
}
