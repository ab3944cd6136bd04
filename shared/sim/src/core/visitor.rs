//! Another ground station beside ours, which brings a list of its own aboard.

use super::item::degrees_e7;
use super::personality::Party;
use super::{Peer, Simulator};
use crate::frame::Sender;
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::*;

/// Who it is: what ground stations call themselves.
const VISITOR: Sender = Sender { system: 255, component: 190 };
/// How far around a place its list leads, and how high over home, metres.
const AWAY_M: f64 = 500.0;
const HEIGHT_M: f32 = 100.0;

/// Its list: once round a place. `has_home`: the first item stands for the autopilot's home.
pub fn visitors_list(around: LatLon, has_home: bool) -> Vec<MISSION_ITEM_INT_DATA> {
    let corners = [45.0, 135.0, 225.0, 315.0].map(|bearing_deg| around.destination(bearing_deg, AWAY_M));
    let places = has_home.then_some(around).into_iter().chain(corners);
    let item = |(seq, place): (u16, LatLon)| MISSION_ITEM_INT_DATA {
        x: degrees_e7(place.lat_deg),
        y: degrees_e7(place.lon_deg),
        z: HEIGHT_M,
        seq,
        command: MavCmd::MAV_CMD_NAV_WAYPOINT,
        frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        autocontinue: 1,
        ..MISSION_ITEM_INT_DATA::DEFAULT
    };
    (0..).zip(places).map(item).collect()
}

impl Simulator {
    /// Another ground station puts its list in the place of the one aboard, and lets it be flown from the first waypoint on if it
    /// `starts` it. What it is answered is of no interest.
    pub fn is_visited(&mut self, around: LatLon, starts: bool) {
        let first = self.rules.first_item;
        let items = visitors_list(around, first > 0);
        let count = MISSION_COUNT_DATA { count: items.len() as u16, ..MISSION_COUNT_DATA::DEFAULT };
        let party = Party { peer: Peer(u32::MAX), sender: VISITOR };
        let (now_ns, mut out) = (self.now_ns, vec![]);
        let items = items.into_iter().map(MavMessage::MISSION_ITEM_INT);
        let start = MISSION_SET_CURRENT_DATA { seq: first, ..MISSION_SET_CURRENT_DATA::DEFAULT };
        let start = starts.then_some(MavMessage::MISSION_SET_CURRENT(start));
        for message in std::iter::once(MavMessage::MISSION_COUNT(count)).chain(items).chain(start) {
            self.behaviour.mission(&mut self.autopilot, party, &message, now_ns, &mut out);
        }
        self.post(out.into_iter().filter(|(to, _)| to.is_none()).collect());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::personality::Personality;

    #[test]
    fn its_list_takes_the_place_of_ours() {
        for (personality, has_home) in [(Personality::ArduPlane, true), (Personality::Px4, false)] {
            let c = crate::Config::default();
            let mut sim = Simulator::of(personality, c.profile, c.home, c.wind, 1);
            let around = c.home.position.destination(90.0, 1000.0);
            sim.is_visited(around, true);
            let aboard = sim.autopilot.mission.items();
            assert_eq!(aboard.len(), visitors_list(around, has_home).len(), "{personality}");
            let away_m = aboard.last().unwrap().position.distance_m(around);
            assert!((away_m - AWAY_M).abs() < 1.0, "{personality}: {away_m} m");
            assert_eq!(sim.autopilot.run.current, u16::from(has_home), "{personality}");
        }
    }
}
