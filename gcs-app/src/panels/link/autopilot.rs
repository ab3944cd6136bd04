//! How the links between the vehicle's gateway and its autopilot do, in words.

use crate::state::Vehicle;
use usal::contract::AutopilotLink;

/// A loss of less than this is not worth a word on the chip, share.
const WORTH_A_WORD: f64 = 0.05;

/// The links, as long as what is known of them is to be believed.
fn links(vehicle: &Vehicle, now_s: f64) -> &[AutopilotLink] {
    let known = vehicle.links.as_ref().filter(|known| !known.is_expired(now_s));
    known.map_or(&[][..], |known| known.value.links.as_slice())
}

/// For the chip: what is wrong with them; nothing, if nothing is.
pub(super) fn short(vehicle: &Vehicle, now_s: f64) -> String {
    wrong(links(vehicle, now_s)).map_or_else(String::new, |wrong| format!(" · {wrong}"))
}

fn wrong(links: &[AutopilotLink]) -> Option<String> {
    let heard = links.iter().any(|link| link.received > 0);
    let dead = links.iter().filter(|link| !link.alive).count();
    let in_use = links.iter().find(|link| link.in_use)?;
    match (dead, links.len()) {
        _ if !heard => None,
        (dead, all) if dead == all => Some("autopilot silent".into()),
        (dead, all) if dead > 0 => Some(format!("{} of {all} autopilot links", all - dead)),
        _ if in_use.loss >= WORTH_A_WORD => {
            Some(format!("autopilot link loses {:.0} %", 100.0 * in_use.loss))
        }
        _ => None,
    }
}

/// For the tooltip: each of them, on lines of their own.
pub(super) fn in_full(vehicle: &Vehicle, now_s: f64) -> String {
    links(vehicle, now_s).iter().map(|link| format!("\n\n{}", describe(link))).collect()
}

fn describe(link: &AutopilotLink) -> String {
    let state = match (link.alive, link.in_use) {
        (true, true) => "in use",
        (true, false) => "stands by",
        (false, _) => "silent",
    };
    let refused = if link.refused > 0 { format!(", {} refused", link.refused) } else { String::new() };
    let round_trip = link.round_trip_ms.map_or_else(String::new, |ms| format!(", {ms:.0} ms there and back"));
    format!(
        "Autopilot at {}: {state}\n{:.0} messages/s, {:.1} kB/s in, {:.1} kB/s out{round_trip}\n{} received, {} lost \
         ({:.1} % now), {} twice, {} bad{refused}",
        link.address,
        link.messages_per_s,
        link.received_bytes_per_s / 1e3,
        link.sent_bytes_per_s / 1e3,
        link.received,
        link.lost,
        100.0 * link.loss,
        link.duplicates,
        link.bad,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link() -> AutopilotLink {
        AutopilotLink {
            address: "udp:127.0.0.1:14550".into(),
            alive: true,
            in_use: true,
            received: 1234,
            lost: 5,
            messages_per_s: 45.4,
            received_bytes_per_s: 2100.0,
            sent_bytes_per_s: 90.0,
            round_trip_ms: Some(12.3),
            ..AutopilotLink::default()
        }
    }

    #[test]
    fn chip_tells_what_is_wrong_and_nothing_else() {
        let dead = || AutopilotLink { alive: false, in_use: false, ..link() };
        let lossy = AutopilotLink { loss: 0.124, ..link() };
        let never = AutopilotLink { received: 0, alive: false, ..link() };
        for (links, expected) in [
            (vec![], None),
            (vec![link()], None),
            (vec![never], None),
            (vec![link(), dead()], Some("1 of 2 autopilot links")),
            (vec![AutopilotLink { alive: false, ..link() }], Some("autopilot silent")),
            (vec![lossy], Some("autopilot link loses 12 %")),
        ] {
            assert_eq!(wrong(&links).as_deref(), expected, "{links:?}");
        }
    }

    #[test]
    fn tooltip_has_the_figures() {
        let text = describe(&link());
        for part in ["udp:127.0.0.1:14550: in use", "45 messages/s", "2.1 kB/s in", "12 ms", "5 lost"] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }
}
