//! What a list and commands do in flight.

use super::lists::waypoint;
use super::station::{FLIGHT, Station, heartbeat, same};
use super::{ARDUPLANE, Autopilot, BOTH, PX4, Quirk, parameters};
use MavCmd::{
    MAV_CMD_COMPONENT_ARM_DISARM as ARM_DISARM, MAV_CMD_DO_CHANGE_SPEED as CHANGE_SPEED,
    MAV_CMD_DO_REPOSITION as REPOSITION, MAV_CMD_DO_SET_MISSION_CURRENT as SET_CURRENT,
    MAV_CMD_DO_SET_MODE as DO_SET_MODE,
};
use MavMissionResult::MAV_MISSION_ERROR as ERROR;
use MavResult::{
    MAV_RESULT_ACCEPTED as ACCEPTED, MAV_RESULT_FAILED as FAILED, MAV_RESULT_TEMPORARILY_REJECTED as REJECTED,
};
use anyhow::ensure;
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::*;

const RTL: u32 = 11;
const LOITER: u32 = 12;
const GUIDED: u32 = 15;
const AUTO: u32 = 10;
const PX4_HOLD: u32 = 0x0304_0000;
const PX4_MISSION: u32 = 0x0404_0000;
/// Between waypoints, metres.
const LEG_M: f64 = 1000.0;
/// In the air from here on, metres.
const AIRBORNE_M: f64 = 30.0;

pub(super) const QUIRKS: &[Quirk] = &[
    Quirk {
        name: "clear_is_refused_while_the_mission_is_flown",
        of: ARDUPLANE,
        does: "`MISSION_CLEAR_ALL` in AUTO: ERROR; in LOITER it is accepted",
        check: |s| {
            airborne(s, 3)?;
            same("in AUTO", s.clear()?, ERROR)?;
            set_mode(s, LOITER)?;
            same("in LOITER", s.clear()?, MavMissionResult::MAV_MISSION_ACCEPTED)
        },
        flies: true,
    },
    Quirk {
        name: "clear_in_flight_ends_in_holding",
        of: PX4,
        does: "`MISSION_CLEAR_ALL` in mission mode is accepted, and it holds",
        check: |s| {
            airborne(s, 3)?;
            same("the answer", s.clear()?, MavMissionResult::MAV_MISSION_ACCEPTED)?;
            s.shows(PX4_HOLD)
        },
        flies: true,
    },
    Quirk {
        name: "item_reached_is_told_once",
        of: ARDUPLANE,
        does: "`MISSION_ITEM_REACHED` comes once for an item",
        check: |s| same("told", reached(s, 2)?, 1),
        flies: true,
    },
    Quirk {
        name: "item_reached_is_told_again_and_again",
        of: PX4,
        does: "`MISSION_ITEM_REACHED` comes every second for the last item that was reached",
        check: |s| same("more than thrice", reached(s, 1)? > 3, true),
        flies: true,
    },
    Quirk {
        name: "list_that_runs_out_ends_in_return",
        of: ARDUPLANE,
        does: "behind the last item: RTL",
        check: |s| {
            airborne(s, 1)?;
            s.shows(RTL)
        },
        flies: true,
    },
    Quirk {
        name: "list_that_runs_out_ends_in_holding",
        of: PX4,
        does: "behind the last item: hold",
        check: |s| {
            airborne(s, 1)?;
            s.shows(PX4_HOLD)
        },
        flies: true,
    },
    Quirk {
        name: "list_keeps_its_place_in_an_upload",
        of: BOTH,
        does: "another list in flight: the number of the current item stays",
        check: |s| {
            let mut items = airborne(s, 4)?;
            let current = first_waypoint(s) + 1;
            jump(s, current)?;
            for item in &mut items {
                item.z += 20.0;
            }
            s.send_list(&items)?;
            let seqs = s.answers(current_of)?;
            let later = s.hear("MISSION_CURRENT", |m| current_of(m).filter(|seq| *seq != u16::MAX))?;
            same("other numbers", seqs.into_iter().find(|seq| ![current, u16::MAX].contains(seq)), None)?;
            same("current", later, current)
        },
        flies: true,
    },
    Quirk {
        name: "marked_item_becomes_the_current_one",
        of: PX4,
        does: "another list with an item that has `current` = 1: that is flown to",
        check: |s| {
            let mut items = airborne(s, 4)?;
            for item in &mut items {
                item.z += 20.0;
            }
            if let Some(item) = items.get_mut(3) {
                item.current = 1;
            }
            s.send_list(&items)?;
            s.hear("item 3 is current", |m| current_of(m).filter(|seq| *seq == 3).map(drop))
        },
        flies: true,
    },
    Quirk {
        name: "shorter_list_is_flown_at_its_last_item",
        of: PX4,
        does: "a list that is shorter than the current number: its last item is flown to",
        check: |s| {
            let items = airborne(s, 4)?;
            jump(s, 4)?;
            s.send_list(&items[..3])?;
            s.hear("item 2 is current", |m| current_of(m).filter(|seq| *seq == 2).map(drop))
        },
        flies: true,
    },
    Quirk {
        name: "speeds_out_of_range_have_failed",
        of: ARDUPLANE,
        does: "`DO_CHANGE_SPEED` 500 m/s in AUTO: FAILED; 22 m/s and −2 (its own) are accepted",
        check: |s| {
            airborne(s, 3)?;
            for (mps, answer) in [(500., FAILED), (22., ACCEPTED), (-2., ACCEPTED)] {
                s.expect(CHANGE_SPEED, [0., mps, -1., 0., 0., 0., 0.], answer)?;
            }
            Ok(())
        },
        flies: true,
    },
    Quirk {
        name: "disarming_in_flight_has_failed",
        of: ARDUPLANE,
        does: "`COMPONENT_ARM_DISARM` 0 in flight: FAILED",
        check: |s| {
            airborne(s, 3)?;
            s.expect(ARM_DISARM, [0.; 7], FAILED)
        },
        flies: true,
    },
    Quirk {
        name: "disarming_in_flight_is_rejected",
        of: PX4,
        does: "`COMPONENT_ARM_DISARM` 0 in flight: TEMPORARILY_REJECTED",
        check: |s| {
            airborne(s, 3)?;
            s.expect(ARM_DISARM, [0.; 7], REJECTED)
        },
        flies: true,
    },
    Quirk {
        name: "arrival_in_guided_is_told_of_item_0",
        of: ARDUPLANE,
        does: "`DO_REPOSITION` with leave to change the mode: GUIDED, and `MISSION_ITEM_REACHED` 0 on arrival",
        check: |s| {
            airborne(s, 3)?;
            let command = COMMAND_INT_DATA { param2: 1., ..ahead(s)? };
            same("the answer", s.command_int(command)?, ACCEPTED)?;
            s.shows(GUIDED)?;
            s.hear_within(FLIGHT, "an arrival", reached_of).and_then(|seq| same("item", seq, 0))
        },
        flies: true,
    },
    Quirk {
        name: "reposition_comes_in_floats_too",
        of: PX4,
        does: "`DO_REPOSITION` is accepted in flight as COMMAND_INT and as COMMAND_LONG, and it holds",
        check: |s| {
            airborne(s, 3)?;
            let to = COMMAND_INT_DATA { param2: 1., ..ahead(s)? };
            let (lat, lon) = (f64::from(to.x) * 1e-7, f64::from(to.y) * 1e-7);
            same("in integers", s.command_int(to)?, ACCEPTED)?;
            s.shows(PX4_HOLD)?;
            let long = [-1., 1., 0., f32::NAN, lat as f32, lon as f32, f32::NAN];
            s.expect(REPOSITION, long, ACCEPTED)
        },
        flies: true,
    },
    Quirk {
        name: "place_ahead_is_climbed_to_at_once",
        of: ARDUPLANE,
        does: "`DO_REPOSITION` 3 km ahead and 60 m up: it is there after a third of the way",
        check: |s| {
            let share = climbed_in_a_third_of_the_way(s)?;
            ensure!(share > 0.8, "it climbed {share:.2} of that");
            Ok(())
        },
        flies: true,
    },
    Quirk {
        name: "place_ahead_is_climbed_to_all_the_way",
        of: PX4,
        does: "`DO_REPOSITION` 3 km ahead and 60 m up: after a third of the way it has climbed a third",
        check: |s| {
            let share = climbed_in_a_third_of_the_way(s)?;
            ensure!((0.2..0.5).contains(&share), "it climbed {share:.2} of that");
            Ok(())
        },
        flies: true,
    },
    Quirk {
        name: "altitude_of_a_place_is_amsl_whatever_the_frame",
        of: PX4,
        does: "`DO_REPOSITION` with an altitude above home, as its frame says: it sinks to that altitude AMSL",
        check: |s| {
            airborne(s, 5)?;
            let (_, from_m) = here(s)?;
            let to = COMMAND_INT_DATA { param2: 1., ..ahead(s)? };
            same("the answer", s.command_int(to)?, ACCEPTED)?;
            s.hear_within(FLIGHT, "it sinks", |message| match message {
                MavMessage::GLOBAL_POSITION_INT(p) => {
                    (f64::from(p.alt) / 1000.0 < from_m - 15.0).then_some(())
                }
                _ => None,
            })
        },
        flies: true,
    },
    Quirk {
        name: "return_flies_the_landing_of_the_list",
        of: ARDUPLANE,
        does: "RTL with RTL_AUTOLAND 2 and `DO_LAND_START` in the list: AUTO, behind that item",
        check: |s| {
            let mut items = airborne(s, 3)?;
            let last = items[4].clone();
            let marker =
                MISSION_ITEM_INT_DATA { command: MavCmd::MAV_CMD_DO_LAND_START, x: 0, y: 0, ..last.clone() };
            let land =
                MISSION_ITEM_INT_DATA { command: MavCmd::MAV_CMD_NAV_LAND, z: 0.0, ..items[2].clone() };
            items.extend([marker, last, land]);
            s.send_list(&items)?;
            parameters::set(s, "RTL_AUTOLAND", 2.0, MavParamType::MAV_PARAM_TYPE_INT8)?;
            s.expect(DO_SET_MODE, [1., RTL as f32, 0., 0., 0., 0., 0.], ACCEPTED)?;
            let landing =
                s.hear("the landing", |m| current_of(m).filter(|seq| *seq > 4)).and_then(|_| s.shows(AUTO));
            parameters::set(s, "RTL_AUTOLAND", 0.0, MavParamType::MAV_PARAM_TYPE_INT8)?;
            landing
        },
        flies: true,
    },
];

fn first_waypoint(s: &Station) -> u16 {
    match s.autopilot {
        Autopilot::ArduPlane => 2,
        Autopilot::Px4 => 1,
    }
}

/// In the air, on the way to the first of so many waypoints that stand in a row ahead; the list.
fn airborne(s: &mut Station, waypoints: usize) -> anyhow::Result<Vec<MISSION_ITEM_INT_DATA>> {
    let (lat, lon, height_m) = s.place()?;
    let here = LatLon::new(f64::from(lat) * 1e-7, f64::from(lon) * 1e-7);
    let course_deg = s.hear("a heading", |message| match message {
        MavMessage::VFR_HUD(hud) => Some(f64::from(hud.heading)),
        _ => None,
    })?;
    let at = |along_m: f64| {
        let place = here.destination(course_deg, along_m);
        let e7 = |degrees: f64| (degrees * 1e7).round() as i32;
        waypoint((e7(place.lat_deg), e7(place.lon_deg)))
    };
    let take_off = MISSION_ITEM_INT_DATA { command: MavCmd::MAV_CMD_NAV_TAKEOFF, z: 60.0, ..at(400.0) };
    let row = (1..=waypoints).map(|i| at(500.0 + LEG_M * i as f64));
    let home = (s.autopilot == Autopilot::ArduPlane).then(|| at(0.0));
    let mut items: Vec<_> = home.into_iter().chain([take_off]).chain(row).collect();
    let first = first_waypoint(s);
    let is_flying = height_m > AIRBORNE_M;
    match s.autopilot {
        // what is being flown can't be exchanged as a whole
        Autopilot::ArduPlane if is_flying => set_mode(s, LOITER)?,
        Autopilot::Px4 if is_flying => items[usize::from(first)].current = 1,
        _ => {}
    }
    s.send_list(&items)?;
    items[usize::from(first)].current = 0;
    let mission = if s.autopilot == Autopilot::Px4 { PX4_MISSION } else { AUTO };
    if is_flying {
        if s.autopilot == Autopilot::ArduPlane {
            s.expect(SET_CURRENT, [first.into(), 0., 0., 0., 0., 0., 0.], ACCEPTED)?;
        }
        set_mode(s, mission)?;
    } else {
        set_mode(s, mission)?;
        arm(s)?;
    }
    s.hear_within(FLIGHT, "the first waypoint", |m| current_of(m).filter(|seq| *seq == first))?;
    s.hear_within(FLIGHT, "in the air", |message| match message {
        MavMessage::GLOBAL_POSITION_INT(p) => (p.relative_alt > 30_000).then_some(()),
        _ => None,
    })?;
    Ok(items)
}

/// It may be refused while the list is looked at, or while it has started a moment ago.
fn arm(s: &mut Station) -> anyhow::Result<()> {
    for _ in 0..20 {
        if s.command(ARM_DISARM, [1., 0., 0., 0., 0., 0., 0.])? == ACCEPTED {
            return Ok(());
        }
        s.hear("a heartbeat", heartbeat)?;
    }
    s.expect(ARM_DISARM, [1., 0., 0., 0., 0., 0., 0.], ACCEPTED)
}

/// The same for a mode.
fn set_mode(s: &mut Station, shown: u32) -> anyhow::Result<()> {
    let [_, _, main, sub] = shown.to_le_bytes();
    let params = match s.autopilot {
        Autopilot::ArduPlane => [1., shown as f32, 0., 0., 0., 0., 0.],
        Autopilot::Px4 => [1., main.into(), sub.into(), 0., 0., 0., 0.],
    };
    for _ in 0..20 {
        if s.command(DO_SET_MODE, params)? == ACCEPTED {
            return s.shows(shown);
        }
        s.hear("a heartbeat", heartbeat)?;
    }
    s.expect(DO_SET_MODE, params, ACCEPTED)
}

/// To another item of the list.
fn jump(s: &mut Station, seq: u16) -> anyhow::Result<()> {
    s.say(&MavMessage::MISSION_SET_CURRENT(MISSION_SET_CURRENT_DATA {
        seq,
        target_system: s.target.system,
        target_component: s.target.component,
    }));
    s.hear("that item is current", |m| current_of(m).filter(|current| *current == seq).map(drop))
}

/// How often it says that an item is reached, until the next one is.
fn reached(s: &mut Station, seq: u16) -> anyhow::Result<usize> {
    airborne(s, 2)?;
    let mut told = 0;
    s.hear_within(FLIGHT, "the second waypoint", |message| {
        let reached = reached_of(message);
        told += usize::from(reached == Some(seq));
        reached.filter(|reached| *reached == seq + 1)
    })?;
    Ok(told)
}

/// Sent to a place straight ahead and above, the share of the height that it has after a third of the way.
fn climbed_in_a_third_of_the_way(s: &mut Station) -> anyhow::Result<f64> {
    const WAY_M: f64 = 3000.0;
    const UP_M: f64 = 60.0;
    airborne(s, 5)?;
    let (from, from_m) = here(s)?;
    let (behind, _) = here(s)?;
    let course_deg = if behind == from { 0.0 } else { from.bearing_deg(behind) };
    let place = from.destination(course_deg, WAY_M);
    let e7 = |degrees: f64| (degrees * 1e7).round() as i32;
    let to = COMMAND_INT_DATA {
        param2: 1.,
        x: e7(place.lat_deg),
        y: e7(place.lon_deg),
        z: (from_m + UP_M) as f32,
        // PX4 takes any altitude for one AMSL
        frame: MavFrame::MAV_FRAME_GLOBAL,
        ..ahead(s)?
    };
    same("the answer", s.command_int(to)?, ACCEPTED)?;
    let height_m = s.hear_within(FLIGHT, "a third of the way", |message| match message {
        MavMessage::GLOBAL_POSITION_INT(p) => {
            let now = LatLon::new(f64::from(p.lat) * 1e-7, f64::from(p.lon) * 1e-7);
            (from.distance_m(now) > WAY_M / 3.0).then(|| f64::from(p.alt) / 1000.0)
        }
        _ => None,
    })?;
    Ok((height_m - from_m) / UP_M)
}

/// Where it is, and its altitude, metres AMSL.
fn here(s: &mut Station) -> anyhow::Result<(LatLon, f64)> {
    s.hear("a position", |message| match message {
        MavMessage::GLOBAL_POSITION_INT(p) => {
            let place = LatLon::new(f64::from(p.lat) * 1e-7, f64::from(p.lon) * 1e-7);
            Some((place, f64::from(p.alt) / 1000.0))
        }
        _ => None,
    })
}

/// To a place a little ahead, as high as it is.
fn ahead(s: &mut Station) -> anyhow::Result<COMMAND_INT_DATA> {
    let (x, y, height_m) = s.place()?;
    Ok(COMMAND_INT_DATA {
        param1: -1.,
        x: x + 50_000,
        y,
        z: height_m as f32,
        command: REPOSITION,
        frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        ..COMMAND_INT_DATA::DEFAULT
    })
}

fn current_of(message: &MavMessage) -> Option<u16> {
    match message {
        MavMessage::MISSION_CURRENT(current) => Some(current.seq),
        _ => None,
    }
}

fn reached_of(message: &MavMessage) -> Option<u16> {
    match message {
        MavMessage::MISSION_ITEM_REACHED(reached) => Some(reached.seq),
        _ => None,
    }
}
