//! What holds for every flight, whatever was done to it.

use crate::rig::{Rig, Seen};
use anyhow::ensure;
use usal::contract::{GatewayEvent, GatewayState, Token};

/// Whatever it did last, it stands within so many seconds, and that is told.
const ENDS_WITHIN_S: f64 = 180.0;

/// Its story is one, it never went back to what was flown, and in the end it stands, its engine is off, and nobody claims to steer.
/// Nothing was told of it that the autopilot itself says otherwise.
pub async fn judge(rig: &mut Rig) -> anyhow::Result<()> {
    rig.until("it stands, and nobody claims to fly it", ENDS_WITHIN_S, |rig, _| is_over(rig)).await?;
    is_one_story(&rig.seen)?;
    goes_forward(&rig.seen)?;
    let untrue = rig.doubts.found();
    ensure!(untrue.is_empty(), "it was told otherwise than it was: {untrue:#?}");
    Ok(())
}

fn is_over(rig: &Rig) -> bool {
    let Some(status) = rig.gateway_status().filter(|status| !status.armed) else { return false };
    let steers = rig.navigation().is_some_and(|navigation| navigation.current.is_some());
    match status.state {
        GatewayState::Stop => !steers,
        state => state == GatewayState::Terminate,
    }
}

/// Each change of state begins where the one before has led, but for a gateway that was started anew.
fn is_one_story(seen: &Seen) -> anyhow::Result<()> {
    let changes = seen.gateway.iter().filter_map(|event| match event {
        GatewayEvent::StateChanged { from, to, .. } => Some((*from, *to)),
        _ => None,
    });
    let mut last = None;
    for (from, to) in changes {
        let follows = last.is_none_or(|last| last == from) || from == GatewayState::Off;
        ensure!(follows, "it was {last:?}, and changed from {from:?} to {to:?}");
        last = Some(to);
    }
    Ok(())
}

/// It never steers to what was passed or cancelled before.
fn goes_forward(seen: &Seen) -> anyhow::Result<()> {
    let mut last = Token(0);
    for event in &seen.gateway {
        if let GatewayEvent::Progress { current: Some(current), .. } = event {
            ensure!(*current >= last, "it steered to {current:?} after {last:?}");
            last = *current;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(from: GatewayState, to: GatewayState) -> GatewayEvent {
        GatewayEvent::StateChanged { from, to, cause: String::new() }
    }

    fn steers_to(token: u64) -> GatewayEvent {
        GatewayEvent::Progress { current: Some(Token(token)), taken: Token(9) }
    }

    fn seen(gateway: Vec<GatewayEvent>) -> Seen {
        Seen { gateway, ..Seen::default() }
    }

    #[test]
    fn a_change_that_begins_elsewhere_is_no_story() {
        use GatewayState::*;
        let story = [(Off, Stop), (Stop, Nav), (Off, Nav), (Nav, Hold)].map(|(from, to)| changed(from, to));
        assert!(is_one_story(&seen(story.to_vec())).is_ok());
        assert!(is_one_story(&seen(vec![changed(Off, Stop), changed(Nav, Hold)])).is_err());
    }

    #[test]
    fn a_waypoint_that_was_passed_is_a_stale_one() {
        assert!(goes_forward(&seen([1, 1, 3, 4].map(steers_to).to_vec())).is_ok());
        assert!(goes_forward(&seen([1, 3, 2].map(steers_to).to_vec())).is_err());
    }
}
