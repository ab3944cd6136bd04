//! PX4, each of its ways by name.

mod commands;
mod flight;
mod link;
mod never;
mod transfer;

use super::*;
use crate::core::mode::Mode;
use crate::core::run::Phase;

const MISSION: [f32; 2] = [4.0, 4.0];
const HOLD: [f32; 2] = [4.0, 3.0];

impl Ground {
    fn px4() -> Self {
        Self::of(Personality::Px4, Wind::CALM)
    }

    fn enter(&mut self, [main, sub]: [f32; 2]) -> MavResult {
        self.command(MavCmd::MAV_CMD_DO_SET_MODE, [1., main, sub, 0., 0., 0., 0.])
    }

    /// Uploads a whole mission, streamed.
    fn px4_upload(&mut self, items: &[MISSION_ITEM_INT_DATA]) {
        self.count(items.len() as u16);
        let mut last = None;
        for (i, wire) in items.iter().enumerate() {
            last = self.item(&MISSION_ITEM_INT_DATA { seq: i as u16, ..wire.clone() });
        }
        assert_eq!(last, Some(MavMissionResult::MAV_MISSION_ACCEPTED), "{:?}", self.texts());
    }

    /// On its way to item 1 of a mission.
    fn px4_airborne(items: &[MISSION_ITEM_INT_DATA]) -> Self {
        let mut ground = Self::px4();
        ground.px4_upload(items);
        ground.settle();
        assert_eq!(ground.enter(MISSION), MavResult::MAV_RESULT_ACCEPTED);
        assert_eq!(ground.arm(), MavResult::MAV_RESULT_ACCEPTED, "{:?}", ground.all_texts());
        assert!(ground.fly_until(120.0, |sim| sim.autopilot.run.current == 1));
        ground
    }

    /// Tells it which item to go on at, by the message: it knows no command for that.
    fn select(&mut self, seq: u16) {
        self.say(MavMessage::MISSION_SET_CURRENT(MISSION_SET_CURRENT_DATA {
            seq,
            ..MISSION_SET_CURRENT_DATA::DEFAULT
        }));
    }

    /// Until it has started up and found out what it was given.
    fn settle(&mut self) {
        self.fly_until(4.5, |_| false);
    }

    fn all_texts(&mut self) -> Vec<String> {
        self.fly_until(0.1, |_| false);
        self.texts()
    }

    fn mission_state(&self) -> MissionState {
        let state = |m: &MavMessage| match m {
            MavMessage::MISSION_CURRENT(c) => Some(c.mission_state),
            _ => None,
        };
        self.received.iter().rev().find_map(state).unwrap()
    }

    fn current(&self) -> u16 {
        self.sim.autopilot.run.current
    }

    fn mode_now(&self) -> Mode {
        self.sim.autopilot.mode()
    }
}

fn marked(wire: MISSION_ITEM_INT_DATA) -> MISSION_ITEM_INT_DATA {
    MISSION_ITEM_INT_DATA { current: 1, ..wire }
}

/// Off the circle that is flown around a point, and its bank.
fn circling(ground: &mut Ground, around: LatLon, radius_m: f64) -> (f64, f64) {
    ground.fly_until(250.0, |_| false);
    let off = ground.position().distance_m(around) - radius_m;
    (off, ground.sim.autopilot.aircraft.state().bank_rad)
}
