//! Pure: what somebody else's autopilot does by its own words, whatever the gateway says of it. It hears both ends of the radio.

use super::told::Simulation;
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::*;

/// Longest list that is kept.
const MOST_ITEMS: u16 = 10_000;

/// What an autopilot says of itself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Heard {
    /// Its engine is armed.
    pub armed: bool,
    /// What it flies; `None`: a mode that is none of these.
    pub flies: Option<Flies>,
    /// Where the item of its list lies that it steers to; `None`: it has no place, or is not known.
    pub item: Option<LatLon>,
    /// Its height above home, metres.
    pub above_home_m: f64,
}

/// What an autopilot flies by its mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flies {
    /// Its list; take-off and landing belong to that.
    List,
    /// A circle, or to a place that it was sent to.
    Place,
    /// Home.
    Return,
}

/// A listener.
#[derive(Debug, Default)]
pub struct Witness {
    heard: Option<Heard>,
    list: Vec<Option<LatLon>>,
    /// A list that is being sent; it counts when it was accepted.
    incoming: Option<Vec<Option<LatLon>>>,
    current: Option<u16>,
}

impl Witness {
    /// What is known; `None`: nothing was heard yet.
    pub fn heard(&self) -> Option<Heard> {
        let item = self.current.and_then(|seq| *self.list.get(usize::from(seq))?);
        self.heard.map(|heard| Heard { item, ..heard })
    }

    /// Listens to the autopilot.
    pub fn hear_autopilot(&mut self, message: &MavMessage) {
        match message {
            MavMessage::HEARTBEAT(heartbeat) => {
                let Some(simulation) = Simulation::of(heartbeat) else { return };
                let heard = self.heard.get_or_insert_default();
                heard.armed = heartbeat.base_mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
                heard.flies = flies(simulation, heartbeat.custom_mode);
            }
            MavMessage::GLOBAL_POSITION_INT(position) => {
                if let Some(heard) = &mut self.heard {
                    heard.above_home_m = f64::from(position.relative_alt) / 1000.0;
                }
            }
            MavMessage::MISSION_CURRENT(current) => self.current = Some(current.seq),
            MavMessage::MISSION_ACK(ack) if ack.mavtype == MavMissionResult::MAV_MISSION_ACCEPTED => {
                if let Some(list) = self.incoming.take() {
                    self.list = list;
                }
            }
            _ => {}
        }
    }

    /// Listens to the agent.
    pub fn hear_agent(&mut self, message: &MavMessage) {
        match message {
            MavMessage::MISSION_COUNT(count) => {
                self.incoming = Some(vec![None; usize::from(count.count.min(MOST_ITEMS))]);
            }
            MavMessage::MISSION_ITEM_INT(item) => self.put(item),
            MavMessage::MISSION_CLEAR_ALL(_) => self.list.clear(),
            _ => {}
        }
    }

    /// One that is no part of a whole list counts at once.
    fn put(&mut self, item: &MISSION_ITEM_INT_DATA) {
        let place = LatLon::new(f64::from(item.x) / 1e7, f64::from(item.y) / 1e7);
        let list = self.incoming.as_mut().unwrap_or(&mut self.list);
        if let Some(known) = list.get_mut(usize::from(item.seq)) {
            *known = (item.x != 0 || item.y != 0).then_some(place);
        }
    }
}

/// By the modes of ArduPlane (modes/mode.h) and PX4 (commander/px4_custom_mode.h).
fn flies(simulation: Simulation, custom_mode: u32) -> Option<Flies> {
    let (main, sub) = (custom_mode >> 16 & 0xFF, custom_mode >> 24);
    match (simulation, custom_mode) {
        (Simulation::ArduPlane, 10) => Some(Flies::List),
        (Simulation::ArduPlane, 11) => Some(Flies::Return),
        (Simulation::ArduPlane, 12 | 15) => Some(Flies::Place),
        (Simulation::ArduPlane, _) => None,
        (Simulation::Px4, _) if main != 4 => None,
        (Simulation::Px4, _) => match sub {
            2 | 4 | 6 => Some(Flies::List),
            3 => Some(Flies::Place),
            5 => Some(Flies::Return),
            _ => None,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heartbeat(autopilot: MavAutopilot, custom_mode: u32) -> MavMessage {
        let base_mode = MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED;
        MavMessage::HEARTBEAT(HEARTBEAT_DATA { autopilot, custom_mode, base_mode, ..Default::default() })
    }

    fn item(seq: u16, lat_deg: i32) -> MavMessage {
        let x = lat_deg * 10_000_000;
        MavMessage::MISSION_ITEM_INT(MISSION_ITEM_INT_DATA { seq, x, y: 1, ..Default::default() })
    }

    fn count(count: u16) -> MavMessage {
        MavMessage::MISSION_COUNT(MISSION_COUNT_DATA { count, ..Default::default() })
    }

    fn steers_to(witness: &Witness) -> Option<f64> {
        witness.heard().unwrap().item.map(|item| item.lat_deg.round())
    }

    #[test]
    fn a_list_counts_when_it_was_accepted_and_an_item_at_once() {
        let mut witness = Witness::default();
        assert_eq!(witness.heard(), None);
        witness.hear_autopilot(&heartbeat(MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA, 10));
        let current = MISSION_CURRENT_DATA { seq: 1, ..Default::default() };
        witness.hear_autopilot(&MavMessage::MISSION_CURRENT(current));
        [count(2), item(0, 10), item(1, 11)].iter().for_each(|said| witness.hear_agent(said));
        assert_eq!(steers_to(&witness), None);
        witness.hear_autopilot(&MavMessage::MISSION_ACK(MISSION_ACK_DATA::default()));
        assert_eq!(steers_to(&witness), Some(11.0));
        witness.hear_agent(&item(1, 12));
        assert_eq!(steers_to(&witness), Some(12.0));
        witness.hear_agent(&item(7, 13));
        assert_eq!(steers_to(&witness), Some(12.0));
    }

    #[test]
    fn each_ones_modes_are_known() {
        let of = |autopilot, mode| {
            let mut witness = Witness::default();
            witness.hear_autopilot(&heartbeat(autopilot, mode));
            let heard = witness.heard().unwrap();
            assert!(heard.armed);
            heard.flies
        };
        let plane = [10, 11, 12, 15, 5].map(|mode| of(MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA, mode));
        assert_eq!(
            plane,
            [Some(Flies::List), Some(Flies::Return), Some(Flies::Place), Some(Flies::Place), None]
        );
        let px4 = [4, 5, 3, 2, 6].map(|sub| of(MavAutopilot::MAV_AUTOPILOT_PX4, sub << 24 | 4 << 16));
        assert_eq!(
            px4,
            [
                Some(Flies::List),
                Some(Flies::Return),
                Some(Flies::Place),
                Some(Flies::List),
                Some(Flies::List)
            ]
        );
        assert_eq!(of(MavAutopilot::MAV_AUTOPILOT_PX4, 1 << 16), None);
    }
}
