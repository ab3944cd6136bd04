//! The core as a ground station sees it: transcripts, flights and faults, without a socket.

mod arcs;
mod arduplane;
mod px4;

use super::item::degrees_e7;
use super::*;
use crate::config::Config;
use crate::frame::{Decoder, Sender};
use aircraft::{Profile, Wind};
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::*;
use proptest::prelude::*;

const GROUND: Sender = Sender { system: 255, component: 190 };
const PEER: Peer = Peer(1);

/// A ground station and the simulator it talks to.
struct Ground {
    sim: Simulator,
    decoder: Decoder,
    received: Vec<MavMessage>,
}

impl Ground {
    fn of(personality: Personality, wind: Wind) -> Self {
        let mut sim = Simulator::of(personality, Profile::default(), Config::default().home, wind, 1);
        assert!(sim.connect(PEER));
        Self { sim, decoder: Decoder::default(), received: Vec::new() }
    }

    fn home(&self) -> LatLon {
        self.sim.autopilot.home.position
    }

    fn listen(&mut self) {
        for outgoing in self.sim.take_outgoing() {
            self.decoder.push(&outgoing.bytes);
            for frame in frame::take_frames(&mut self.decoder) {
                if let Body::Known(message) = frame.body {
                    self.received.push(*message);
                }
            }
        }
    }

    /// Says something and returns what is answered at once.
    fn say(&mut self, message: MavMessage) -> Vec<MavMessage> {
        self.listen();
        let before = self.received.len();
        self.sim.receive(PEER, Frame::new(GROUND, message));
        self.listen();
        self.received[before..].to_vec()
    }

    /// Steps until `done`, at most `limit_s`; false if it never was.
    fn fly_until(&mut self, limit_s: f64, mut done: impl FnMut(&Simulator) -> bool) -> bool {
        for _ in 0..(limit_s * 10.0) as usize {
            self.sim.step();
            self.listen();
            if done(&self.sim) {
                return true;
            }
        }
        false
    }

    fn command(&mut self, command: MavCmd, params: [f32; 7]) -> MavResult {
        let [param1, param2, param3, param4, param5, param6, param7] = params;
        let long = COMMAND_LONG_DATA {
            param1,
            param2,
            param3,
            param4,
            param5,
            param6,
            param7,
            command,
            target_system: 1,
            target_component: 1,
            confirmation: 0,
        };
        self.say(MavMessage::COMMAND_LONG(long))
            .iter()
            .find_map(|m| match m {
                MavMessage::COMMAND_ACK(ack) if ack.command == command => Some(ack.result),
                _ => None,
            })
            .unwrap()
    }

    fn arm(&mut self) -> MavResult {
        self.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [1., 0., 0., 0., 0., 0., 0.])
    }

    /// The ACK of an exchange, if one was sent.
    fn ack(messages: &[MavMessage]) -> Option<MavMissionResult> {
        messages.iter().find_map(|m| match m {
            MavMessage::MISSION_ACK(ack) => Some(ack.mavtype),
            _ => None,
        })
    }

    fn item(&mut self, wire: &MISSION_ITEM_INT_DATA) -> Option<MavMissionResult> {
        Self::ack(&self.say(MavMessage::MISSION_ITEM_INT(wire.clone())))
    }

    fn count(&mut self, count: u16) -> Option<MavMissionResult> {
        let count = MISSION_COUNT_DATA { count, target_system: 1, ..MISSION_COUNT_DATA::DEFAULT };
        Self::ack(&self.say(MavMessage::MISSION_COUNT(count)))
    }

    fn partial(&mut self, start_index: i16, end_index: i16) -> Option<MavMissionResult> {
        Self::ack(&self.say(MavMessage::MISSION_WRITE_PARTIAL_LIST(MISSION_WRITE_PARTIAL_LIST_DATA {
            start_index,
            end_index,
            ..MISSION_WRITE_PARTIAL_LIST_DATA::DEFAULT
        })))
    }

    fn texts(&self) -> Vec<String> {
        let text = |m: &MavMessage| match m {
            MavMessage::STATUSTEXT(t) => Some(t.text.to_str().unwrap().to_owned()),
            _ => None,
        };
        self.received.iter().filter_map(text).collect()
    }

    fn reached(&self) -> Vec<u16> {
        let seq = |m: &MavMessage| match m {
            MavMessage::MISSION_ITEM_REACHED(r) => Some(r.seq),
            _ => None,
        };
        self.received.iter().filter_map(seq).collect()
    }

    /// Payloads of messages that it takes, whatever is in them.
    fn endure(&mut self, payloads: Vec<(u16, Vec<u8>)>) {
        let ids = [11, 20, 21, 23, 37, 38, 39, 40, 41, 43, 44, 45, 47, 51, 66, 73, 75, 76, 86, 111];
        for (pick, mut payload) in payloads {
            let id = ids[usize::from(pick) % ids.len()];
            payload.resize(60, 1);
            let version = mavlink::MavlinkVersion::V2;
            let parsed = <MavMessage as mavlink::Message>::parse(version, id, &payload);
            let body = parsed.map_or(Body::Strange { id, payload }, |m| Body::Known(Box::new(m)));
            self.sim.receive(PEER, Frame { sender: GROUND, body });
            self.sim.step();
            self.listen();
        }
    }

    fn position(&self) -> LatLon {
        self.sim.autopilot.aircraft.state().position
    }
}

fn wire(command: MavCmd, position: LatLon, height_m: f32) -> MISSION_ITEM_INT_DATA {
    MISSION_ITEM_INT_DATA {
        x: degrees_e7(position.lat_deg),
        y: degrees_e7(position.lon_deg),
        z: height_m,
        command,
        frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        target_system: 1,
        target_component: 1,
        autocontinue: 1,
        ..MISSION_ITEM_INT_DATA::DEFAULT
    }
}

fn waypoint(position: LatLon) -> MISSION_ITEM_INT_DATA {
    wire(MavCmd::MAV_CMD_NAV_WAYPOINT, position, 120.0)
}

fn take_off() -> MISSION_ITEM_INT_DATA {
    wire(MavCmd::MAV_CMD_NAV_TAKEOFF, LatLon::new(0.0, 0.0), 60.0)
}

fn jump(to: u16, repeat: f32) -> MISSION_ITEM_INT_DATA {
    let base = wire(MavCmd::MAV_CMD_DO_JUMP, LatLon::new(0.0, 0.0), 0.0);
    MISSION_ITEM_INT_DATA { param1: to.into(), param2: repeat, ..base }
}

fn speed(mps: f32) -> MISSION_ITEM_INT_DATA {
    let base = wire(MavCmd::MAV_CMD_DO_CHANGE_SPEED, LatLon::new(0.0, 0.0), 0.0);
    MISSION_ITEM_INT_DATA { param2: mps, ..base }
}

/// A circuit that ends with a landing at home, in runway direction.
fn circuit(home: LatLon) -> Vec<MISSION_ITEM_INT_DATA> {
    let upwind = home.destination(52.0, 1500.0);
    let crosswind = upwind.destination(322.0, 700.0);
    let downwind = crosswind.destination(232.0, 4000.0);
    let last = home.destination(232.0, 1300.0);
    let mut final_fix = waypoint(last);
    final_fix.z = 90.0;
    vec![
        take_off(),
        waypoint(upwind),
        waypoint(crosswind),
        waypoint(downwind),
        waypoint(downwind.destination(142.0, 700.0)),
        final_fix,
        wire(MavCmd::MAV_CMD_NAV_LAND, home, 0.0),
    ]
}

fn hostile() -> impl Strategy<Value = Vec<(u16, Vec<u8>)>> {
    prop::collection::vec((any::<u16>(), prop::collection::vec(any::<u8>(), 0..60)), 1..60)
}
