//! Is a batch of waypoints fit to be taken? Its length and its tokens are judged here, each waypoint by the rules that the
//! review of a plan shares ([`plausibility`]).

use super::buffer::CAPACITY;
use flight_exec::review::plausibility::{self, Context};
use usal::contract::{Token, Waypoint};
use wire::Convert;

/// A waypoint that is to blame: token, code for programs, sentence for people.
pub type Fault = (Token, String, String);

/// Everything that is wrong with a batch that follows on `previous`; `highest` is the highest token ever accepted.
/// Empty: it may be flown.
pub fn faults(
    context: &Context,
    highest: Token,
    previous: Option<&Waypoint>,
    batch: &[Waypoint],
) -> Vec<Fault> {
    if let Some(first) = batch.first().filter(|_| batch.len() > CAPACITY) {
        let sentence = format!("Send at most {CAPACITY} waypoints at once.");
        return vec![(first.token, "batch-too-long".into(), sentence)];
    }
    let mut found: Vec<Fault> = sequence(highest, batch).into_iter().collect();
    let mut before_last = None;
    let mut last: Option<flight_exec::Waypoint> = previous.cloned().convert();
    for waypoint in batch {
        let judged = waypoint.clone().convert();
        let broken = plausibility::faults(context, before_last, last.as_ref(), &judged);
        found.extend(broken.into_iter().map(|f| (waypoint.token, f.code.into(), f.sentence)));
        before_last = last.map(|w| w.position);
        last = Some(judged);
    }
    found
}

/// Tokens rise by one within a batch and are above every token accepted before.
fn sequence(highest: Token, batch: &[Waypoint]) -> Option<Fault> {
    let mut expected = None;
    for waypoint in batch {
        let token = waypoint.token;
        let repeated = token <= highest;
        if repeated || expected.is_some_and(|e| e != token) {
            let code = if repeated { "token-repeated" } else { "token-gap" };
            let text = format!("Number waypoints one by one from above {}; got {}.", highest.0, token.0);
            return Some((token, code.into(), text));
        }
        expected = Some(Token(token.0.saturating_add(1)));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use aircraft::Profile;
    use geometry::LatLon;
    use usal::contract::{Action, Id};

    fn waypoint(token: u64, east_m: f64, north_m: f64) -> Waypoint {
        Waypoint {
            token: Token(token),
            position: LatLon::new(36.49, -84.27).destination(90.0, east_m).destination(0.0, north_m),
            altitude_amsl_m: 600.0,
            airspeed_mps: 25.0,
            action: Action::Fly,
            fly_over: false,
            on_arc: false,
            leg: Id::from("leg"),
            end_of_plan: false,
        }
    }

    /// Tokens and codes of what is wrong with a batch.
    fn found(highest: u64, previous: Option<&Waypoint>, batch: &[Waypoint]) -> Vec<(u64, String)> {
        let profile = Profile::default();
        let terrain = terrain::Flat(300.0);
        let context = Context { profile: &profile, terrain: Some(&terrain), wind_mps: 5.0, glides: false };
        let faults = faults(&context, Token(highest), previous, batch);
        faults.into_iter().map(|(token, code, _)| (token.0, code)).collect()
    }

    fn fault(token: u64, code: &str) -> Vec<(u64, String)> {
        vec![(token, code.to_owned())]
    }

    #[test]
    fn a_good_batch_passes() {
        let batch = [waypoint(8, 0.0, 0.0), waypoint(9, 0.0, 500.0), waypoint(10, 300.0, 900.0)];
        assert_eq!(found(7, None, &batch), []);
    }

    #[test]
    fn every_waypoint_is_judged_after_the_two_before_it() {
        let [mut fast, mut high] = [waypoint(2, 0.0, 500.0), waypoint(1, 0.0, 500.0)];
        fast.airspeed_mps = 36.0;
        high.altitude_amsl_m = 900.0;
        let corner = [waypoint(1, 0.0, 0.0), waypoint(2, 0.0, 30.0), waypoint(3, -20.0, 30.0)];
        assert_eq!(found(0, None, &[waypoint(1, 0.0, 0.0), fast]), fault(2, "speed"));
        assert_eq!(found(0, Some(&waypoint(0, 0.0, 0.0)), &[high]), fault(1, "gradient"));
        assert_eq!(found(0, None, &corner), fault(3, "turn"));
    }

    #[test]
    fn repeated_and_missing_tokens_are_refused() {
        let numbered = |second| [waypoint(8, 0.0, 0.0), waypoint(second, 0.0, 400.0)];
        assert_eq!(found(7, None, &[waypoint(7, 0.0, 0.0)]), fault(7, "token-repeated"));
        assert_eq!(found(7, None, &numbered(8)), fault(8, "token-gap"));
        assert_eq!(found(7, None, &numbered(10)), fault(10, "token-gap"));
    }

    #[test]
    fn a_batch_larger_than_the_buffer_is_refused_at_once() {
        let last = CAPACITY as u64 + 1;
        let batch: Vec<_> = (1..=last).map(|i| waypoint(i, 0.0, i as f64 * 50.0)).collect();
        assert_eq!(found(0, None, &batch), fault(1, "batch-too-long"));
        assert_eq!(found(0, None, &batch[..CAPACITY]), []);
    }
}
