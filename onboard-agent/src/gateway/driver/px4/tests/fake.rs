//! A small PX4: its mission protocol, modes and answers, as far as a driver meets them. It does not fly.

use super::super::items::checksum;
use autopilot_link::frame::Sender;
use mavlink::dialects::ardupilotmega::*;

pub const SENDER: Sender = Sender { system: 1, component: 1 };
const NONE: u16 = u16::MAX;
/// Silence after which a transfer is given up, steps of 100 ms.
const TIMEOUT: u32 = 50;
/// And asked for again.
const ASKS_AGAIN: u32 = 3;

#[derive(Debug, Default, PartialEq)]
enum Transfer {
    #[default]
    Idle,
    Receiving {
        count: u16,
        items: Vec<MISSION_ITEM_INT_DATA>,
    },
    Sending {
        next: u16,
    },
}

#[derive(Default)]
pub struct Px4 {
    pub kind: MavType,
    pub list: Vec<MISSION_ITEM_INT_DATA>,
    pub seq: Option<u16>,
    pub main: u8,
    pub sub: u8,
    pub armed: bool,
    /// Firmware that has no names for lists.
    pub nameless: bool,
    /// It heard a ground station: it gives reasons.
    pub hears_station: bool,
    /// Why it won't be armed.
    pub refuses_arming: Option<&'static str>,
    /// It says that it ends its flight, and does not.
    pub only_accepts_the_end: bool,
    /// So many changes of mode are refused.
    pub refuses_modes: u32,
    /// Lists that were taken into use.
    pub uses: u32,
    /// What its lists need to have.
    pub required: i32,
    /// `FW_LND_ANG`.
    pub landing_deg: f32,
    pub speeds: Vec<f32>,
    /// Places that it was sent to; `None`: hold here.
    pub sent_to: Vec<Option<(i32, i32)>>,
    pub out: Vec<MavMessage>,
    transfer: Transfer,
    silent: u32,
    steps: u32,
}

impl Px4 {
    pub fn new() -> Self {
        Self { kind: MavType::MAV_TYPE_FIXED_WING, main: 1, landing_deg: 5.0, ..Self::default() }
    }

    fn name(&self) -> u32 {
        if self.nameless { 0 } else { checksum(&self.list) }
    }

    pub fn mode(&mut self, main: u8, sub: u8) {
        (self.main, self.sub) = (main, sub);
    }

    pub fn beat(&self) -> HEARTBEAT_DATA {
        HEARTBEAT_DATA {
            custom_mode: u32::from(self.main) << 16 | u32::from(self.sub) << 24,
            mavtype: self.kind,
            autopilot: MavAutopilot::MAV_AUTOPILOT_PX4,
            base_mode: if self.armed {
                MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED
            } else {
                MavModeFlag::empty()
            },
            ..HEARTBEAT_DATA::DEFAULT
        }
    }

    fn current(&mut self) {
        let current = MISSION_CURRENT_DATA {
            seq: self.seq.unwrap_or(NONE),
            total: self.list.len() as u16,
            mission_id: self.name(),
            ..MISSION_CURRENT_DATA::DEFAULT
        };
        self.out.push(MavMessage::MISSION_CURRENT(current));
    }

    /// 100 ms; heartbeat and current entry come once a second.
    pub fn step(&mut self) {
        self.steps += 1;
        self.silent += 1;
        if self.steps % 10 == 1 {
            self.out.push(MavMessage::HEARTBEAT(self.beat()));
            self.current();
        }
        if let Transfer::Receiving { items, .. } = &self.transfer
            && self.silent.is_multiple_of(ASKS_AGAIN)
        {
            self.request(items.len() as u16);
        }
        if self.transfer != Transfer::Idle && self.silent > TIMEOUT {
            // no ack, only words
            self.transfer = Transfer::Idle;
            self.say("Mission sync timeout");
        }
    }

    pub fn say(&mut self, words: &str) {
        if !self.hears_station {
            return;
        }
        let text = STATUSTEXT_DATA {
            severity: MavSeverity::MAV_SEVERITY_CRITICAL,
            text: words.into(),
            ..STATUSTEXT_DATA::DEFAULT
        };
        self.out.push(MavMessage::STATUSTEXT(text));
    }

    fn ack(&mut self, result: MavMissionResult, opaque_id: u32) {
        self.out.push(MavMessage::MISSION_ACK(MISSION_ACK_DATA {
            target_system: 1,
            target_component: 191,
            mavtype: result,
            mission_type: MavMissionType::MAV_MISSION_TYPE_MISSION,
            opaque_id,
        }));
    }

    fn request(&mut self, seq: u16) {
        let data = MISSION_REQUEST_INT_DATA { seq, ..MISSION_REQUEST_INT_DATA::DEFAULT };
        self.out.push(MavMessage::MISSION_REQUEST_INT(data));
    }

    #[expect(deprecated, reason = "PX4 takes an entry by the deprecated message only")]
    pub fn receive(&mut self, message: &MavMessage) {
        match message {
            MavMessage::HEARTBEAT(beat) => self.hears_station |= beat.mavtype == MavType::MAV_TYPE_GCS,
            MavMessage::PARAM_REQUEST_READ(r) if r.param_id.to_str() == Ok("FW_LND_ANG") => {
                let value = PARAM_VALUE_DATA {
                    param_value: self.landing_deg,
                    param_id: r.param_id,
                    param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
                    ..PARAM_VALUE_DATA::DEFAULT
                };
                self.out.push(MavMessage::PARAM_VALUE(value));
            }
            MavMessage::PARAM_REQUEST_READ(r) if r.param_id.to_str() == Ok("MIS_TKO_LAND_REQ") => {
                let value = PARAM_VALUE_DATA {
                    param_value: f32::from_bits(self.required as u32),
                    param_id: r.param_id,
                    param_type: MavParamType::MAV_PARAM_TYPE_INT32,
                    ..PARAM_VALUE_DATA::DEFAULT
                };
                self.out.push(MavMessage::PARAM_VALUE(value));
            }
            MavMessage::MISSION_COUNT(c) => self.on_count(c.count),
            MavMessage::MISSION_ITEM_INT(item) => self.on_item(item),
            // on the ground it keeps its own
            MavMessage::MISSION_SET_CURRENT(select) if self.armed => {
                self.seq = Some(select.seq);
                self.current();
            }
            MavMessage::MISSION_REQUEST_LIST(_) if !matches!(self.transfer, Transfer::Receiving { .. }) => {
                self.silent = 0;
                self.transfer = Transfer::Sending { next: 0 };
                let count = self.list.len() as u16;
                let data = MISSION_COUNT_DATA { count, ..MISSION_COUNT_DATA::DEFAULT };
                self.out.push(MavMessage::MISSION_COUNT(data));
            }
            MavMessage::MISSION_REQUEST_INT(r) => self.on_request(r.seq),
            MavMessage::MISSION_ACK(_) if matches!(self.transfer, Transfer::Sending { .. }) => {
                self.transfer = Transfer::Idle;
            }
            MavMessage::COMMAND_LONG(c) => self.on_command(c.command, c.param1, c.param2, c.param3),
            MavMessage::COMMAND_INT(c) => {
                let place = (c.x != i32::MAX).then_some((c.x, c.y));
                self.sent_to.push(place);
                assert!(place.is_some() || c.param4.is_nan(), "a heading alone keeps the old place");
                self.mode(4, 3);
                self.answer(c.command, MavResult::MAV_RESULT_ACCEPTED);
            }
            _ => {}
        }
    }

    fn on_count(&mut self, count: u16) {
        match &self.transfer {
            Transfer::Idle => {
                self.silent = 0;
                self.transfer = Transfer::Receiving { count, items: vec![] };
                self.request(0);
            }
            Transfer::Receiving { items, .. } if items.is_empty() => self.request(0),
            _ => self.ack(MavMissionResult::MAV_MISSION_ERROR, 0),
        }
    }

    fn on_item(&mut self, item: &MISSION_ITEM_INT_DATA) {
        let Transfer::Receiving { count, items } = &mut self.transfer else {
            return self.ack(MavMissionResult::MAV_MISSION_ERROR, 0);
        };
        self.silent = 0;
        // out of order: not a word
        if usize::from(item.seq) != items.len() {
            return;
        }
        items.push(item.clone());
        if items.len() < usize::from(*count) {
            let next = items.len() as u16;
            return self.request(next);
        }
        let items = std::mem::take(items);
        self.transfer = Transfer::Idle;
        self.take_into_use(items);
        let name = self.name();
        self.ack(MavMissionResult::MAV_MISSION_ACCEPTED, name);
    }

    fn take_into_use(&mut self, items: Vec<MISSION_ITEM_INT_DATA>) {
        let same = checksum(&items) == checksum(&self.list);
        let current = items.iter().find(|item| item.current == 1).map(|item| item.seq);
        self.list = items;
        if !same {
            self.uses += 1;
            self.seq = current;
            // until its navigator has looked, there is no current entry
            self.current();
            self.seq = current.or(Some(0));
        }
    }

    fn on_request(&mut self, seq: u16) {
        let Transfer::Sending { next } = &mut self.transfer else { return };
        self.silent = 0;
        if seq == *next {
            *next += 1;
        } else if seq + 1 != *next {
            self.transfer = Transfer::Idle;
            self.ack(MavMissionResult::MAV_MISSION_ERROR, 0);
            return self.say("WPM: REJ. CMD: Req. WP was unexpected");
        }
        if let Some(item) = self.list.get(usize::from(seq)).cloned() {
            let for_us = MISSION_ITEM_INT_DATA { target_system: 1, target_component: 191, ..item };
            self.out.push(MavMessage::MISSION_ITEM_INT(for_us));
        }
    }

    fn on_command(&mut self, command: MavCmd, p1: f32, p2: f32, p3: f32) {
        let mut result = MavResult::MAV_RESULT_ACCEPTED;
        match command {
            MavCmd::MAV_CMD_DO_SET_MODE if self.refuses_modes > 0 => {
                self.refuses_modes -= 1;
                result = MavResult::MAV_RESULT_TEMPORARILY_REJECTED;
            }
            MavCmd::MAV_CMD_DO_SET_MODE => self.mode(p2 as u8, p3 as u8),
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM => match self.refuses_arming {
                Some(words) => {
                    result = MavResult::MAV_RESULT_TEMPORARILY_REJECTED;
                    self.answer(command, result);
                    // its reasons come after its answer
                    return self.say(words);
                }
                None => self.armed = p1 > 0.5,
            },
            MavCmd::MAV_CMD_DO_FLIGHTTERMINATION if self.only_accepts_the_end => {}
            MavCmd::MAV_CMD_DO_CHANGE_SPEED => self.speeds.push(p2),
            _ => result = MavResult::MAV_RESULT_UNSUPPORTED,
        }
        self.answer(command, result);
    }

    fn answer(&mut self, command: MavCmd, result: MavResult) {
        let data = COMMAND_ACK_DATA { command, result, ..COMMAND_ACK_DATA::DEFAULT };
        self.out.push(MavMessage::COMMAND_ACK(data));
    }
}
