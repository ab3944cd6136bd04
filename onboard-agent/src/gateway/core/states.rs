//! The states and their one transition table.

use usal::contract::GatewayState;

/// What can make the state change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Trigger {
    /// The autopilot is heard.
    Heartbeat,
    /// The autopilot was silent for long, standing on the ground.
    Lost,
    /// It flies the list, and steers to a take-off.
    Departing,
    /// It flies the list, and steers to a waypoint.
    Cruising,
    /// It flies the list, and a landing follows the waypoint steered to.
    Approaching,
    /// It flies the list, and steers to a landing.
    Landing,
    /// On the ground, disarmed.
    Landed,
    /// It circles, as we asked, or an earlier gateway did.
    HoldConfirmed,
    /// It follows our direct command, or an earlier gateway's.
    DirectConfirmed,
    /// Its mode was changed, and not by us.
    PilotTook,
    /// Safe mode has to act.
    SafeNeeded,
    /// Safe.Hold has lasted T2, or the engine has failed.
    ReturnDue,
    /// It returns by its own means, as an earlier gateway told it.
    ReturnMet,
    /// The FP Manager is back and has waypoints aboard.
    Recovered,
    /// The FP Manager is back and has to send waypoints first.
    RecoveredDry,
    /// The flight is to be ended by force.
    Terminated,
}

/// All triggers, for exhaustive tests.
#[cfg(test)]
pub const TRIGGERS: [Trigger; 16] = [
    Trigger::Heartbeat,
    Trigger::Lost,
    Trigger::Departing,
    Trigger::Cruising,
    Trigger::Approaching,
    Trigger::Landing,
    Trigger::Landed,
    Trigger::HoldConfirmed,
    Trigger::DirectConfirmed,
    Trigger::PilotTook,
    Trigger::SafeNeeded,
    Trigger::ReturnDue,
    Trigger::ReturnMet,
    Trigger::Recovered,
    Trigger::RecoveredDry,
    Trigger::Terminated,
];

/// All states, for exhaustive tests.
#[cfg(test)]
pub const STATES: [GatewayState; 14] = [
    GatewayState::Off,
    GatewayState::Stop,
    GatewayState::TakeOff,
    GatewayState::Nav,
    GatewayState::Hold,
    GatewayState::Directed,
    GatewayState::Manual,
    GatewayState::Approach,
    GatewayState::Land,
    GatewayState::SafeHold,
    GatewayState::SafeReturn,
    GatewayState::SafeApproach,
    GatewayState::SafeLand,
    GatewayState::Terminate,
];

/// The state that follows; `None`: the trigger means nothing there.
pub fn next(from: GatewayState, trigger: Trigger) -> Option<GatewayState> {
    use GatewayState::*;
    use Trigger::*;
    let to = match (from, trigger) {
        // ended by force: nothing follows but a new start of the gateway
        (Terminate, _) => return None,
        (_, Terminated) => Terminate,

        (Off, Heartbeat) => Stop,
        (Stop, Lost) => Off,

        // the ground, and how the flight begins (an autopilot may be met in flight)
        (Off | Stop, Departing) => TakeOff,
        (Off | Stop, Cruising) => Nav,
        (Off | Stop, Approaching) => Approach,
        (Off | Stop, Landing) => Land,
        (Off | Stop, HoldConfirmed) => Hold,
        (Off | Stop, DirectConfirmed) => Directed,
        (Off | Stop, PilotTook) => Manual,
        (Off | Stop, ReturnMet) => SafeReturn,
        (Off | Stop, _) => return None,

        // the end of the flight; the human pilot; both from anywhere in the air
        (_, Landed) => Stop,
        (Manual, PilotTook) => return None,
        (_, PilotTook) => Manual,

        // flying the FP Manager's waypoints
        (Hold | Directed | Manual, Departing) => TakeOff,
        (TakeOff | Hold | Directed | Manual | Approach | Land, Cruising) => Nav,
        (TakeOff | Nav | Hold | Directed | Manual | Land, Approaching) => Approach,
        (TakeOff | Nav | Hold | Directed | Manual | Approach, Landing) => Land,
        (TakeOff | Nav | Directed | Manual | Approach | Land, HoldConfirmed) => Hold,
        (TakeOff | Nav | Hold | Approach | Land, DirectConfirmed) => Directed,

        // Safe mode; a landing is finished first, and a take-off until clear of the ground
        (TakeOff | Nav | Hold | Directed | Approach, SafeNeeded) => SafeHold,
        (SafeHold, ReturnDue) => SafeReturn,
        (SafeReturn, Approaching) => SafeApproach,
        (SafeReturn | SafeApproach, Landing) => SafeLand,
        (SafeHold, Recovered) => Nav,
        (SafeHold | SafeReturn, RecoveredDry) => Hold,
        _ => return None,
    };
    Some(to)
}

/// In the air, or about to be.
pub fn is_flying(state: GatewayState) -> bool {
    !matches!(state, GatewayState::Off | GatewayState::Stop | GatewayState::Terminate)
}

/// Safe mode.
pub fn is_safe(state: GatewayState) -> bool {
    use GatewayState::{SafeApproach, SafeHold, SafeLand, SafeReturn};
    matches!(state, SafeHold | SafeReturn | SafeApproach | SafeLand)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// One line per state: the triggers that mean something and where they lead, in the order of
    /// [`TRIGGERS`]; `.` is nothing.
    const TABLE: &str = "
    Off          Stop . TakeOff Nav Approach Land . Hold Directed Manual . . SafeReturn . . Terminate
    Stop         . Off TakeOff Nav Approach Land . Hold Directed Manual . . SafeReturn . . Terminate
    TakeOff      . . . Nav Approach Land Stop Hold Directed Manual SafeHold . . . . Terminate
    Nav          . . . . Approach Land Stop Hold Directed Manual SafeHold . . . . Terminate
    Hold         . . TakeOff Nav Approach Land Stop . Directed Manual SafeHold . . . . Terminate
    Directed     . . TakeOff Nav Approach Land Stop Hold . Manual SafeHold . . . . Terminate
    Manual       . . TakeOff Nav Approach Land Stop Hold . . . . . . . Terminate
    Approach     . . . Nav . Land Stop Hold Directed Manual SafeHold . . . . Terminate
    Land         . . . Nav Approach . Stop Hold Directed Manual . . . . . Terminate
    SafeHold     . . . . . . Stop . . Manual . SafeReturn . Nav Hold Terminate
    SafeReturn   . . . . SafeApproach SafeLand Stop . . Manual . . . . Hold Terminate
    SafeApproach . . . . . SafeLand Stop . . Manual . . . . . Terminate
    SafeLand     . . . . . . Stop . . Manual . . . . . Terminate
    Terminate    . . . . . . . . . . . . . . . .
    ";

    #[test]
    fn every_pair_of_state_and_trigger_is_as_in_the_table() {
        let rows: Vec<Vec<&str>> = TABLE
            .lines()
            .map(|l| l.split_whitespace().collect::<Vec<_>>())
            .filter(|r| !r.is_empty())
            .collect();
        assert_eq!(rows.len(), STATES.len());
        for (state, row) in STATES.iter().zip(&rows) {
            assert_eq!(format!("{state:?}"), row[0]);
            assert_eq!(row.len(), TRIGGERS.len() + 1, "{state:?}");
            for (trigger, expected) in TRIGGERS.iter().zip(&row[1..]) {
                let to = next(*state, *trigger).map_or(".".to_owned(), |s| format!("{s:?}"));
                assert_eq!(&to, expected, "{state:?} on {trigger:?}");
            }
        }
    }

    /// A trigger in words.
    fn explained(trigger: Trigger) -> &'static str {
        match trigger {
            Trigger::Heartbeat => "the autopilot is heard",
            Trigger::Lost => "the autopilot is silent for 10 s",
            Trigger::Departing => "it steers to a take-off",
            Trigger::Cruising => "it steers to a waypoint",
            Trigger::Approaching => "a landing follows the waypoint it steers to",
            Trigger::Landing => "it steers to a landing",
            Trigger::Landed => "on the ground and disarmed",
            Trigger::HoldConfirmed => "it circles, as we asked, or as it is met",
            Trigger::DirectConfirmed => "it follows our direct command, or is met doing so",
            Trigger::PilotTook => "its mode was changed, or it took off, and not by us",
            Trigger::SafeNeeded => {
                "FP Manager silent (T1), waypoints run dry, its waypoints do not come (T2), or by command"
            }
            Trigger::ReturnDue => "Safe.Hold has lasted T2, or the engine has failed",
            Trigger::ReturnMet => "it is met on its way home by its own means, as an earlier gateway told it",
            Trigger::Recovered => "the FP Manager is back and has waypoints aboard",
            Trigger::RecoveredDry => "the FP Manager is back and has to send waypoints first",
            Trigger::Terminated => {
                "by command, confirmed with the vehicle's name; again after a restart, until it stands"
            }
        }
    }

    /// Where a trigger leads to, if that is the same wherever it means something in flight.
    fn common(trigger: Trigger) -> Option<GatewayState> {
        let to: Vec<_> = STATES.iter().filter_map(|from| next(*from, trigger)).collect();
        let same = to.windows(2).all(|w| w[0] == w[1]);
        to.first().copied().filter(|_| same && to.len() > STATES.len() / 2)
    }

    /// The table for people.
    fn markdown() -> String {
        let mut text = "# The gateway's states\n\nGenerated from the transition table of the gateway \
            (`onboard-agent/src/gateway/core/states.rs`).\n`LEGWORK_BLESS=1 cargo test -p onboard-agent --lib \
            gateway::core::states` writes it anew.\n\n## From almost everywhere\n\n\
            | when | to | not from |\n|---|---|---|\n"
            .to_owned();
        for (trigger, to) in TRIGGERS.iter().filter_map(|t| Some((*t, common(*t)?))) {
            let not: Vec<String> =
                STATES.iter().filter(|s| next(**s, trigger).is_none()).map(|s| format!("{s:?}")).collect();
            text += &format!("| {} | {to:?} | {} |\n", explained(trigger), not.join(", "));
        }
        text += "\n## Otherwise\n\n| from | when | to |\n|---|---|---|\n";
        for (from, trigger) in STATES.iter().flat_map(|s| TRIGGERS.map(|t| (*s, t))) {
            if let Some(to) = next(from, trigger).filter(|_| common(trigger).is_none()) {
                text += &format!("| {from:?} | {} | {to:?} |\n", explained(trigger));
            }
        }
        text + &crate::gateway::core::tests::losses::markdown()
    }

    #[test]
    fn the_table_for_people_is_this_table() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/docs/gateway-states.md");
        let text = markdown();
        if std::env::var_os("LEGWORK_BLESS").is_some() {
            std::fs::write(path, &text).unwrap();
        }
        let golden = std::fs::read_to_string(path).unwrap_or_default();
        assert!(golden == text, "{path} is out of date; write it anew with LEGWORK_BLESS=1");
    }

    #[test]
    fn every_state_can_be_reached_and_every_airborne_one_can_be_left_by_the_pilot() {
        let mut reached = BTreeSet::from(["Off".to_owned()]);
        for from in STATES {
            reached.extend(TRIGGERS.iter().filter_map(|t| next(from, *t)).map(|s| format!("{s:?}")));
            let to = next(from, Trigger::PilotTook);
            let free = !matches!(from, GatewayState::Manual | GatewayState::Terminate);
            assert_eq!(to == Some(GatewayState::Manual), free, "{from:?}");
        }
        assert_eq!(reached.len(), STATES.len());
    }

    #[test]
    fn no_trigger_leads_from_a_state_to_itself() {
        for (from, trigger) in STATES.iter().flat_map(|s| TRIGGERS.map(|t| (*s, t))) {
            assert_ne!(next(from, trigger), Some(from), "{trigger:?}");
        }
    }
}
