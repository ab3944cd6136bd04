//! How commands are answered on the ground.

use super::lists::northward;
use super::station::{Station, same};
use super::{ARDUPLANE, BOTH, PX4, Quirk};
use MavCmd::{
    MAV_CMD_DO_CHANGE_SPEED as CHANGE_SPEED, MAV_CMD_DO_REPOSITION as REPOSITION,
    MAV_CMD_DO_SET_MISSION_CURRENT as SET_CURRENT, MAV_CMD_GET_HOME_POSITION as GET_HOME,
    MAV_CMD_NAV_SPLINE_WAYPOINT as NO_COMMAND, MAV_CMD_REQUEST_MESSAGE as REQUEST_MESSAGE,
};
use MavResult::{
    MAV_RESULT_ACCEPTED as ACCEPTED, MAV_RESULT_DENIED as DENIED, MAV_RESULT_FAILED as FAILED,
    MAV_RESULT_UNSUPPORTED as UNSUPPORTED,
};
use mavlink::dialects::ardupilotmega::*;

const AUTOPILOT_VERSION: f32 = 148.0;
/// A message that nobody has.
const NO_MESSAGE: f32 = 9999.0;

fn first(param: f32) -> [f32; 7] {
    [param, 0., 0., 0., 0., 0., 0.]
}

fn airspeed(mps: f32) -> [f32; 7] {
    [0., mps, -1., 0., 0., 0., 0.]
}

pub(super) const QUIRKS: &[Quirk] = &[
    Quirk {
        name: "what_is_no_command_is_unsupported",
        of: BOTH,
        does: "a mission item's number sent as a command: UNSUPPORTED",
        check: |s| s.expect(NO_COMMAND, [0.; 7], UNSUPPORTED),
        flies: false,
    },
    Quirk {
        name: "speeds_are_taken_in_auto_and_guided_only",
        of: ARDUPLANE,
        does: "`DO_CHANGE_SPEED` in MANUAL: FAILED, whatever the speed",
        check: |s| {
            s.expect(CHANGE_SPEED, airspeed(20.), FAILED)?;
            s.expect(CHANGE_SPEED, airspeed(-2.), FAILED)
        },
        flies: false,
    },
    Quirk {
        name: "speeds_are_accepted_whatever_they_are",
        of: PX4,
        does: "`DO_CHANGE_SPEED` 500 m/s, and −1: accepted",
        check: |s| {
            s.expect(CHANGE_SPEED, airspeed(500.), ACCEPTED)?;
            s.expect(CHANGE_SPEED, airspeed(-1.), ACCEPTED)
        },
        flies: false,
    },
    Quirk {
        name: "reposition_comes_in_integers_only",
        of: ARDUPLANE,
        does: "`DO_REPOSITION` as COMMAND_LONG: UNSUPPORTED",
        check: |s| s.expect(REPOSITION, [0.; 7], UNSUPPORTED),
        flies: false,
    },
    Quirk {
        name: "reposition_in_another_mode_needs_leave_to_change_it",
        of: ARDUPLANE,
        does: "`DO_REPOSITION` with param 2 = 0 outside GUIDED: FAILED",
        check: |s| {
            let command = reposition(s, MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT)?;
            same("the answer", s.command_int(command)?, FAILED)
        },
        flies: false,
    },
    Quirk {
        name: "reposition_needs_a_frame_of_places",
        of: ARDUPLANE,
        does: "`DO_REPOSITION` in a local frame: DENIED",
        check: |s| {
            let command = reposition(s, MavFrame::MAV_FRAME_LOCAL_NED)?;
            same("the answer", s.command_int(command)?, DENIED)
        },
        flies: false,
    },
    Quirk {
        name: "current_item_behind_the_list_is_denied",
        of: ARDUPLANE,
        does: "`DO_SET_MISSION_CURRENT` behind the list: DENIED; to an item of it: accepted, and told",
        check: |s| {
            let items = northward(s, 4)?;
            s.send_list(&items)?;
            s.expect(SET_CURRENT, first(9.), DENIED)?;
            s.expect(SET_CURRENT, first(2.), ACCEPTED)?;
            s.hear("item 2 is current", |message| current(message).filter(|seq| *seq == 2).map(drop))
        },
        flies: false,
    },
    Quirk {
        name: "current_item_has_no_command",
        of: PX4,
        does: "`DO_SET_MISSION_CURRENT`: UNSUPPORTED",
        check: |s| {
            let items = northward(s, 4)?;
            s.send_list(&items)?;
            s.expect(SET_CURRENT, first(2.), UNSUPPORTED)
        },
        flies: false,
    },
    Quirk {
        name: "current_item_behind_the_list_is_refused_in_words",
        of: PX4,
        does: "`MISSION_SET_CURRENT` behind the list: it says that it is not in the list",
        check: |s| {
            let items = northward(s, 4)?;
            s.send_list(&items)?;
            s.forget();
            s.say(&MavMessage::MISSION_SET_CURRENT(MISSION_SET_CURRENT_DATA {
                seq: 9,
                target_system: s.target.system,
                target_component: s.target.component,
            }));
            s.says("Not in list").map(drop)
        },
        flies: false,
    },
    Quirk {
        name: "messages_are_given_on_request",
        of: BOTH,
        does: "`REQUEST_MESSAGE` of AUTOPILOT_VERSION: accepted, and there it is",
        check: |s| {
            s.forget();
            s.say_command(REQUEST_MESSAGE, first(AUTOPILOT_VERSION));
            let (mut answer, mut version) = (None, false);
            s.hear("answer and version", |message| {
                match message {
                    MavMessage::COMMAND_ACK(ack) if ack.command == REQUEST_MESSAGE => {
                        answer = Some(ack.result)
                    }
                    MavMessage::AUTOPILOT_VERSION(_) => version = true,
                    _ => {}
                }
                answer.filter(|_| version)
            })
            .and_then(|answer| same("the answer", answer, ACCEPTED))
        },
        flies: false,
    },
    Quirk {
        name: "request_of_no_message_has_failed",
        of: ARDUPLANE,
        does: "`REQUEST_MESSAGE` 9999: FAILED",
        check: |s| s.expect(REQUEST_MESSAGE, first(NO_MESSAGE), FAILED),
        flies: false,
    },
    Quirk {
        name: "request_of_no_message_is_denied",
        of: PX4,
        does: "`REQUEST_MESSAGE` 9999: DENIED",
        check: |s| s.expect(REQUEST_MESSAGE, first(NO_MESSAGE), DENIED),
        flies: false,
    },
    Quirk {
        name: "home_has_a_command_of_its_own",
        of: ARDUPLANE,
        does: "`GET_HOME_POSITION`: accepted",
        check: |s| s.expect(GET_HOME, [0.; 7], ACCEPTED),
        flies: false,
    },
    Quirk {
        name: "home_has_no_command_of_its_own",
        of: PX4,
        does: "`GET_HOME_POSITION`: UNSUPPORTED",
        check: |s| s.expect(GET_HOME, [0.; 7], UNSUPPORTED),
        flies: false,
    },
    Quirk {
        name: "stray_parameter_is_denied",
        of: PX4,
        does: "a command with a parameter that it does not use: DENIED",
        check: |s| s.expect(MavCmd::MAV_CMD_DO_SET_MODE, [1., 4., 3., 1., 0., 0., 0.], DENIED),
        flies: false,
    },
];

/// There, without leave to change the mode.
fn reposition(s: &mut Station, frame: MavFrame) -> anyhow::Result<COMMAND_INT_DATA> {
    let (x, y, _) = s.place()?;
    Ok(COMMAND_INT_DATA {
        param1: -1.,
        x,
        y,
        z: 100.,
        command: REPOSITION,
        frame,
        ..COMMAND_INT_DATA::DEFAULT
    })
}

/// The item that it flies to.
fn current(message: &MavMessage) -> Option<u16> {
    match message {
        MavMessage::MISSION_CURRENT(current) => Some(current.seq),
        _ => None,
    }
}
