//! Mission lists: sent item by item, whole, and read back.

use super::Autopilot;
use super::station::{OWN, Station, heartbeat};
use anyhow::{Context, ensure};
use autopilot_link::frame::Sender;
use mavlink::dialects::ardupilotmega::*;

/// Something that answers a step of an upload.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer {
    /// It wants an item.
    Wants(u16),
    /// It is done with it.
    Ack(MavMissionResult),
}

/// A waypoint at a place in whole numbers, 100 m above home.
pub fn waypoint((lat, lon): (i32, i32)) -> MISSION_ITEM_INT_DATA {
    MISSION_ITEM_INT_DATA {
        x: lat,
        y: lon,
        z: 100.0,
        command: MavCmd::MAV_CMD_NAV_WAYPOINT,
        frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        autocontinue: 1,
        ..MISSION_ITEM_INT_DATA::DEFAULT
    }
}

/// Waypoints north of where it stands, 0.01 degrees apart.
pub fn northward(station: &mut Station, count: usize) -> anyhow::Result<Vec<MISSION_ITEM_INT_DATA>> {
    let (lat, lon, _) = station.place()?;
    Ok((1..).map(|i| waypoint((lat + i * 100_000, lon))).take(count).collect())
}

impl Station {
    /// `MISSION_COUNT`, and what is answered.
    ///
    /// # Errors
    /// Nothing is.
    pub fn count(&mut self, count: u16) -> anyhow::Result<Answer> {
        self.count_as(OWN, count)
    }

    /// The same of somebody else.
    ///
    /// # Errors
    /// Nothing is answered.
    pub fn count_as(&mut self, sender: Sender, count: u16) -> anyhow::Result<Answer> {
        self.forget();
        self.say_as(sender, &self.mission_count(count));
        self.hear(&format!("an answer to MISSION_COUNT {count}"), |message| answer_to(sender, message))
    }

    fn mission_count(&self, count: u16) -> MavMessage {
        MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
            count,
            target_system: self.target.system,
            target_component: self.target.component,
            ..MISSION_COUNT_DATA::DEFAULT
        })
    }

    /// Says an item with its number.
    pub fn put(&mut self, seq: u16, item: &MISSION_ITEM_INT_DATA) {
        let (target_system, target_component) = (self.target.system, self.target.component);
        let item = MISSION_ITEM_INT_DATA { seq, target_system, target_component, ..item.clone() };
        self.say(&MavMessage::MISSION_ITEM_INT(item));
    }

    /// An item with its number, and what is answered.
    ///
    /// # Errors
    /// Nothing is.
    pub fn item(&mut self, seq: u16, item: &MISSION_ITEM_INT_DATA) -> anyhow::Result<Answer> {
        self.forget();
        self.put(seq, item);
        self.hear(&format!("an answer to item {seq}"), |message| answer_to(OWN, message))
    }

    /// The end of a transfer.
    ///
    /// # Errors
    /// It never comes.
    pub fn ack(&mut self) -> anyhow::Result<MISSION_ACK_DATA> {
        self.hear("MISSION_ACK", |message| match message {
            MavMessage::MISSION_ACK(ack) => Some(ack.clone()),
            _ => None,
        })
    }

    /// A whole list as it is, streamed; how it is answered.
    ///
    /// # Errors
    /// It is not.
    pub fn send_list(&mut self, items: &[MISSION_ITEM_INT_DATA]) -> anyhow::Result<MISSION_ACK_DATA> {
        let count = u16::try_from(items.len())?;
        let answer = self.count(count)?;
        ensure!(answer == Answer::Wants(0), "a list of {count}: {answer:?}");
        for (seq, item) in (0..).zip(items) {
            self.put(seq, item);
        }
        self.ack()
    }

    /// The list that is aboard.
    ///
    /// # Errors
    /// It does not tell.
    pub fn list(&mut self) -> anyhow::Result<Vec<MISSION_ITEM_INT_DATA>> {
        let count = self.list_count()?;
        let items = (0..count).map(|seq| self.read(seq));
        let items = items.collect::<anyhow::Result<Vec<_>>>()?;
        self.acknowledge(MavMissionResult::MAV_MISSION_ACCEPTED);
        Ok(items)
    }

    /// How long the list aboard is.
    ///
    /// # Errors
    /// It does not tell.
    pub fn list_count(&mut self) -> anyhow::Result<u16> {
        self.say_list_request();
        self.hear("MISSION_COUNT", |message| match message {
            MavMessage::MISSION_COUNT(c) => Some(c.count),
            _ => None,
        })
    }

    /// `MISSION_REQUEST_LIST`.
    pub fn say_list_request(&mut self) {
        self.forget();
        self.say(&MavMessage::MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA {
            target_system: self.target.system,
            target_component: self.target.component,
            ..MISSION_REQUEST_LIST_DATA::DEFAULT
        }));
    }

    /// Asks for an item.
    pub fn ask(&mut self, seq: u16) {
        self.say(&MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
            seq,
            target_system: self.target.system,
            target_component: self.target.component,
            ..MISSION_REQUEST_INT_DATA::DEFAULT
        }));
    }

    fn read(&mut self, seq: u16) -> anyhow::Result<MISSION_ITEM_INT_DATA> {
        self.ask(seq);
        let item = self.hear("an item", |message| match message {
            MavMessage::MISSION_ITEM_INT(item) if item.seq == seq => Some(item.clone()),
            _ => None,
        });
        item.with_context(|| format!("item {seq}"))
    }

    /// Clears the list, and how that is answered.
    ///
    /// # Errors
    /// It is not.
    pub fn clear(&mut self) -> anyhow::Result<MavMissionResult> {
        self.say_clear();
        Ok(self.ack()?.mavtype)
    }

    /// `MISSION_CLEAR_ALL`.
    pub fn say_clear(&mut self) {
        self.forget();
        self.say(&MavMessage::MISSION_CLEAR_ALL(MISSION_CLEAR_ALL_DATA {
            target_system: self.target.system,
            target_component: self.target.component,
            ..MISSION_CLEAR_ALL_DATA::DEFAULT
        }));
    }

    /// Says that it gives up a transfer.
    pub fn give_up(&mut self) {
        self.acknowledge(MavMissionResult::MAV_MISSION_OPERATION_CANCELLED);
    }

    fn acknowledge(&mut self, mavtype: MavMissionResult) {
        self.say(&MavMessage::MISSION_ACK(MISSION_ACK_DATA {
            mavtype,
            target_system: self.target.system,
            target_component: self.target.component,
            ..MISSION_ACK_DATA::DEFAULT
        }));
    }

    /// Leaves neither a transfer nor a list.
    ///
    /// # Errors
    /// The list can't be cleared.
    pub fn tidy(&mut self) -> anyhow::Result<()> {
        self.give_up();
        let answer = self.clear()?;
        ensure!(answer == MavMissionResult::MAV_MISSION_ACCEPTED, "clear: {answer:?}");
        if self.autopilot == Autopilot::Px4 {
            // its links learn of that one by one, and one that has not yet undoes what follows at once
            self.hear("a heartbeat", heartbeat)?;
        }
        Ok(())
    }

    /// `MISSION_WRITE_PARTIAL_LIST`.
    pub fn write_partial(&mut self, start_index: i16, end_index: i16) {
        self.forget();
        self.say(&MavMessage::MISSION_WRITE_PARTIAL_LIST(MISSION_WRITE_PARTIAL_LIST_DATA {
            start_index,
            end_index,
            target_system: self.target.system,
            target_component: self.target.component,
            ..MISSION_WRITE_PARTIAL_LIST_DATA::DEFAULT
        }));
    }
}

/// A step of an upload of `sender`'s.
pub fn answer_to(sender: Sender, message: &MavMessage) -> Option<Answer> {
    let is_for = |system, component| (system, component) == (sender.system, sender.component);
    match message {
        MavMessage::MISSION_REQUEST(r) if is_for(r.target_system, r.target_component) => {
            Some(Answer::Wants(r.seq))
        }
        MavMessage::MISSION_REQUEST_INT(r) if is_for(r.target_system, r.target_component) => {
            Some(Answer::Wants(r.seq))
        }
        MavMessage::MISSION_ACK(ack) if is_for(ack.target_system, ack.target_component) => {
            Some(Answer::Ack(ack.mavtype))
        }
        _ => None,
    }
}
