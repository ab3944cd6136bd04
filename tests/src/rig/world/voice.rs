//! Pure: a second voice on the autopilot's link, as of a ground station beside the agent. Each order is said until it is answered.

use super::told::{Order, Simulation, Wish};
use autopilot_link::frame::{Sender, encode};
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::*;
use sim::core::visitor::visitors_list;
use std::collections::VecDeque;
use std::time::Duration;

/// Who speaks: what ground stations call themselves.
const OWN_SYSTEM: u8 = 255;
const OWN: Sender = Sender { system: OWN_SYSTEM, component: MavComponent::MAV_COMP_ID_MISSIONPLANNER as u8 };
/// Said again after this.
const AGAIN: Duration = Duration::from_millis(500);
/// Given up after this.
const PATIENCE: Duration = Duration::from_secs(15);

/// What is said, and what became of it.
#[derive(Debug, Default)]
pub struct Voice {
    autopilot: Option<(Sender, Simulation)>,
    wishes: VecDeque<Wish>,
    orders: VecDeque<Order>,
    /// When the present order was said first, and when last.
    said: Option<(Duration, Duration)>,
    sequence: u8,
    /// The item of its list that the autopilot wants.
    wanted: Option<u16>,
    trouble: Option<String>,
}

impl Voice {
    /// Has it told to the autopilot's simulation, after what was wished before.
    pub fn wish(&mut self, wish: Wish) {
        self.wishes.push_back(wish);
    }

    /// All was told, and the autopilot has confirmed it.
    pub fn is_done(&self) -> bool {
        self.wishes.is_empty() && self.orders.is_empty()
    }

    /// What can't be had.
    pub fn trouble(&self) -> Option<&str> {
        self.trouble.as_deref()
    }

    /// Listens to what the autopilot says.
    pub fn hear(&mut self, sender: Sender, message: &MavMessage) {
        match message {
            MavMessage::HEARTBEAT(heartbeat) => {
                if let Some(simulation) = Simulation::of(heartbeat) {
                    self.autopilot.get_or_insert((sender, simulation));
                }
            }
            MavMessage::PARAM_VALUE(said) => {
                let Some(Order::Set(name, value, kind)) = self.orders.front() else { return };
                if said.param_id.to_str() == Ok(name) && is_same(said.param_value, *value, *kind) {
                    self.answered();
                }
            }
            MavMessage::COMMAND_ACK(said) => {
                let Some(Order::Do(command, _)) = self.orders.front() else { return };
                // over a router what is answered to the agent is heard, too
                let is_ours = matches!(said.target_system, 0 | OWN_SYSTEM);
                if is_ours && said.command == *command && said.result != MavResult::MAV_RESULT_IN_PROGRESS {
                    if said.result != MavResult::MAV_RESULT_ACCEPTED {
                        self.trouble = Some(format!("the autopilot answers {command:?}: {:?}", said.result));
                    }
                    self.answered();
                }
            }
            _ => self.hear_of_list(message),
        }
    }

    /// What is answered to others is none of ours. A transfer that somebody else's is in the way of is begun again.
    #[expect(deprecated, reason = "ArduPilot asks by the deprecated message")]
    fn hear_of_list(&mut self, message: &MavMessage) {
        if !matches!(self.orders.front(), Some(Order::Upload(..))) {
            return;
        }
        let is_ours = |system, component| (system, component) == (OWN.system, OWN.component);
        match message {
            MavMessage::MISSION_REQUEST(r) if is_ours(r.target_system, r.target_component) => {
                self.wanted = Some(r.seq);
            }
            MavMessage::MISSION_REQUEST_INT(r) if is_ours(r.target_system, r.target_component) => {
                self.wanted = Some(r.seq);
            }
            MavMessage::MISSION_ACK(ack)
                if is_ours(ack.target_system, ack.target_component)
                    && ack.mavtype == MavMissionResult::MAV_MISSION_ACCEPTED =>
            {
                self.answered();
            }
            _ => {}
        }
    }

    fn answered(&mut self) {
        self.wanted = None;
        self.orders.pop_front();
        self.said = None;
    }

    /// The frame that is to be sent now; none any more after something could not be had: it may be no simulation.
    pub fn speak(&mut self, now: Duration) -> Option<Vec<u8>> {
        let (autopilot, simulation) = self.autopilot.filter(|_| self.trouble.is_none())?;
        while self.orders.is_empty() {
            let wish = self.wishes.pop_front()?;
            match simulation.orders(wish) {
                Some(orders) => self.orders.extend(orders),
                None => {
                    self.trouble = Some(format!("not to be had from {simulation:?}: {wish:?}"));
                    return None;
                }
            }
        }
        let order = *self.orders.front()?;
        let (first, last) = self.said.unwrap_or((now, now));
        let wanted = self.wanted.take();
        if self.said.is_some() && wanted.is_none() && now < last + AGAIN {
            return None;
        }
        if now > first + PATIENCE {
            self.trouble =
                Some(format!("the autopilot does not answer {order:?}: is it in its own simulation?"));
            return None;
        }
        self.said = Some((first, now));
        self.sequence = self.sequence.wrapping_add(1);
        let said = match (order, wanted) {
            (Order::Upload(around, has_home), Some(seq)) => item(autopilot, around, has_home, seq)?,
            _ => message(autopilot, order),
        };
        Some(encode(OWN, self.sequence, &said))
    }
}

/// An item of the list; `None`: there is none.
fn item(to: Sender, around: LatLon, has_home: bool, seq: u16) -> Option<MavMessage> {
    let item = visitors_list(around, has_home).into_iter().nth(seq.into())?;
    let (target_system, target_component) = (to.system, to.component);
    Some(MavMessage::MISSION_ITEM_INT(MISSION_ITEM_INT_DATA { target_system, target_component, ..item }))
}

/// Real numbers may come back rounded; of a whole one these are its bits.
fn is_same(said: f32, meant: f32, kind: MavParamType) -> bool {
    match kind {
        MavParamType::MAV_PARAM_TYPE_INT32 => said.to_bits() == meant.to_bits(),
        _ => (said - meant).abs() < 1e-3,
    }
}

fn message(to: Sender, order: Order) -> MavMessage {
    match order {
        Order::Set(name, param_value, param_type) => MavMessage::PARAM_SET(PARAM_SET_DATA {
            param_value,
            target_system: to.system,
            target_component: to.component,
            param_id: name.into(),
            param_type,
        }),
        Order::Do(command, [param1, param2, param3]) => MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            param1,
            param2,
            param3,
            command,
            target_system: to.system,
            target_component: to.component,
            ..Default::default()
        }),
        Order::Upload(around, has_home) => MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
            count: visitors_list(around, has_home).len() as u16,
            target_system: to.system,
            target_component: to.component,
            ..Default::default()
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use autopilot_link::frame::Decoder;

    const AUTOPILOT: Sender = Sender { system: 1, component: 1 };

    fn heartbeat(autopilot: MavAutopilot) -> MavMessage {
        MavMessage::HEARTBEAT(HEARTBEAT_DATA { autopilot, ..Default::default() })
    }

    fn met(wishes: &[Wish]) -> Voice {
        let mut voice = Voice::default();
        wishes.iter().for_each(|wish| voice.wish(*wish));
        voice.hear(AUTOPILOT, &heartbeat(MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA));
        voice
    }

    fn said(voice: &mut Voice, at_ms: u64) -> Option<MavMessage> {
        let mut decoder = Decoder::default();
        decoder.push(&voice.speak(Duration::from_millis(at_ms))?);
        decoder.next_frame()?.message()
    }

    fn value(name: &str, param_value: f32) -> MavMessage {
        MavMessage::PARAM_VALUE(PARAM_VALUE_DATA { param_id: name.into(), param_value, ..Default::default() })
    }

    fn ack(command: MavCmd, result: MavResult) -> MavMessage {
        MavMessage::COMMAND_ACK(COMMAND_ACK_DATA { command, result, ..Default::default() })
    }

    #[test]
    fn each_order_is_said_until_it_is_confirmed() {
        let mut voice = met(&[Wish::Gps(false), Wish::Battery(15.0)]);
        assert!(matches!(said(&mut voice, 0), Some(MavMessage::PARAM_SET(set)) if set.param_value == 0.0));
        assert_eq!(said(&mut voice, 400), None);
        // what it was before, and another parameter, are no confirmation
        voice.hear(AUTOPILOT, &value("SIM_GPS1_ENABLE", 1.0));
        voice.hear(AUTOPILOT, &value("SIM_GPS2_ENABLE", 0.0));
        assert!(matches!(said(&mut voice, 500), Some(MavMessage::PARAM_SET(_))));
        voice.hear(AUTOPILOT, &value("SIM_GPS1_ENABLE", 0.0));
        assert!(matches!(said(&mut voice, 510), Some(MavMessage::COMMAND_LONG(long)) if long.param2 == 15.0));
        assert!(!voice.is_done());
        voice.hear(AUTOPILOT, &ack(MavCmd::MAV_CMD_BATTERY_RESET, MavResult::MAV_RESULT_ACCEPTED));
        assert!(voice.is_done());
        assert_eq!(said(&mut voice, 5000), None);
        assert_eq!(voice.trouble(), None);
    }

    /// As real numbers they are all nearly zero.
    #[test]
    fn a_whole_number_of_px4_is_confirmed_by_no_other() {
        let mut voice = Voice::default();
        voice.wish(Wish::Gps(false));
        voice.hear(AUTOPILOT, &heartbeat(MavAutopilot::MAV_AUTOPILOT_PX4));
        said(&mut voice, 0).unwrap();
        voice.hear(AUTOPILOT, &value("SIM_GPS_USED", f32::from_bits(10)));
        assert!(!voice.is_done(), "it is refused: what it was before");
        voice.hear(AUTOPILOT, &value("SIM_GPS_USED", f32::from_bits(0)));
        assert!(voice.is_done());
    }

    #[test]
    fn what_is_answered_to_the_agent_is_no_answer() {
        for (target_system, is_ours) in [(1, false), (255, true), (0, true)] {
            let mut voice = met(&[Wish::Mode(sim::Mode::Auto)]);
            said(&mut voice, 0).unwrap();
            voice.hear(
                AUTOPILOT,
                &MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
                    command: MavCmd::MAV_CMD_DO_SET_MODE,
                    result: MavResult::MAV_RESULT_ACCEPTED,
                    target_system,
                    ..Default::default()
                }),
            );
            assert_eq!(voice.is_done(), is_ours, "{target_system}");
        }
    }

    #[test]
    fn a_list_is_given_item_by_item_to_who_asks_us_for_it() {
        let around = LatLon::new(36.5, -84.2);
        let mut voice = met(&[Wish::List(around), Wish::FlyList]);
        let count = said(&mut voice, 0);
        assert!(matches!(count, Some(MavMessage::MISSION_COUNT(count)) if count.count == 5));
        let asks = |seq, target: Sender| {
            MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
                seq,
                target_system: target.system,
                target_component: target.component,
                ..Default::default()
            })
        };
        voice.hear(AUTOPILOT, &asks(0, Sender { system: 1, component: 191 }));
        assert_eq!(said(&mut voice, 50), None, "another was asked");
        for seq in 0..5 {
            voice.hear(AUTOPILOT, &asks(seq, OWN));
            let item = said(&mut voice, 100);
            assert!(matches!(item, Some(MavMessage::MISSION_ITEM_INT(item)) if item.seq == seq));
        }
        let ack = MISSION_ACK_DATA { target_system: 255, target_component: 190, ..Default::default() };
        voice.hear(AUTOPILOT, &MavMessage::MISSION_ACK(ack));
        assert!(matches!(said(&mut voice, 150), Some(MavMessage::COMMAND_LONG(long)) if long.param1 == 1.0));
    }

    #[test]
    fn nothing_is_said_before_it_is_known_to_whom() {
        let mut voice = Voice::default();
        voice.wish(Wish::Gps(false));
        voice.hear(AUTOPILOT, &heartbeat(MavAutopilot::MAV_AUTOPILOT_INVALID));
        assert_eq!(said(&mut voice, 0), None);
        assert!(!voice.is_done());
    }

    #[test]
    fn refusals_and_silence_are_told() {
        let mut voice = met(&[Wish::Mode(sim::Mode::Auto)]);
        said(&mut voice, 0).unwrap();
        voice.hear(AUTOPILOT, &ack(MavCmd::MAV_CMD_DO_SET_MODE, MavResult::MAV_RESULT_DENIED));
        assert!(voice.trouble().unwrap().contains("DENIED"), "{voice:?}");

        let mut voice = met(&[Wish::Gps(false)]);
        for at_ms in (0..20_000).step_by(100) {
            said(&mut voice, at_ms);
        }
        assert!(voice.trouble().unwrap().contains("SIM_GPS1_ENABLE"), "{voice:?}");
        // what follows would be heard by an aircraft that is none of a simulation
        voice.wish(Wish::Battery(100.0));
        assert_eq!(said(&mut voice, 30_000), None);

        let mut voice = met(&[Wish::Mode(sim::Mode::Manual)]);
        assert_eq!(said(&mut voice, 0), None);
        assert!(voice.trouble().unwrap().contains("Manual"), "{voice:?}");
    }
}
