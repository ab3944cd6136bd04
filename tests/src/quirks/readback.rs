//! What a list reads back as.

use super::lists::{Answer, answer_to, northward};
use super::station::{OWN, Station, same};
use super::{ARDUPLANE, BOTH, PX4, Quirk};
use MavMissionResult::{MAV_MISSION_ERROR as ERROR, MAV_MISSION_INVALID_SEQUENCE as INVALID_SEQUENCE};
use anyhow::Context;
use mavlink::dialects::ardupilotmega::*;

pub(super) const QUIRKS: &[Quirk] = &[
    Quirk {
        name: "heights_are_kept_to_the_centimetre",
        of: ARDUPLANE,
        does: "100.004 m reads back as 100.00 m",
        check: |s| {
            let kept = kept(s, |item| item.z = 100.004)?;
            same("height, cm", (kept.z * 1000.0).round(), 100_000.0)
        },
        flies: false,
    },
    Quirk {
        name: "heights_are_kept_as_they_are",
        of: PX4,
        does: "100.004 m reads back as 100.004 m",
        check: |s| same("height", kept(s, |item| item.z = 100.004)?.z, 100.004),
        flies: false,
    },
    Quirk {
        name: "waypoint_keeps_its_distances_in_a_byte",
        of: ARDUPLANE,
        does: "params 30, 63.7, 999, 45 of a waypoint read back as 0, 63, 255, 0",
        check: |s| {
            let kept = kept(s, |item| {
                (item.param1, item.param2, item.param3, item.param4) = (30.0, 63.7, 999.0, 45.0);
            })?;
            same("params", [kept.param1, kept.param2, kept.param3, kept.param4], [0.0, 63.0, 255.0, 0.0])
        },
        flies: false,
    },
    Quirk {
        name: "waypoint_keeps_its_parameters",
        of: PX4,
        does: "params 30, 63.5, 0, 45 of a waypoint read back as sent",
        check: |s| {
            let kept = kept(s, |item| (item.param1, item.param2, item.param4) = (30.0, 63.5, 45.0))?;
            let degrees = (kept.param4 * 1000.0).round() / 1000.0;
            same("params", [kept.param1, kept.param2, kept.param3, degrees], [30.0, 63.5, 0.0, 45.0])
        },
        flies: false,
    },
    Quirk {
        name: "landing_reads_back_as_one_that_may_be_broken_off",
        of: ARDUPLANE,
        does: "param 4 of a landing reads back as 1",
        check: |s| same("param 4", kept(s, |item| item.command = MavCmd::MAV_CMD_NAV_LAND)?.param4, 1.0),
        flies: false,
    },
    Quirk {
        name: "frames_read_back_without_integers",
        of: ARDUPLANE,
        does: "a frame for integers reads back as the one without",
        check: |s| {
            let int = MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT;
            same("frame", kept(s, |item| item.frame = int)?.frame, MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT)
        },
        flies: false,
    },
    Quirk {
        name: "frames_read_back_with_integers",
        of: PX4,
        does: "a frame without integers reads back as the one for them",
        check: |s| same("frame", kept(s, |_| ())?.frame, MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT),
        flies: false,
    },
    Quirk {
        name: "items_are_given_without_a_list",
        of: ARDUPLANE,
        does: "an item is given although the list was not asked for, in any order",
        check: |s| {
            let items = northward(s, 3)?;
            s.send_list(&items)?;
            for seq in [2, 1] {
                let given = asked(s, seq)?;
                same("item", given, Some(items[usize::from(seq)].x))?;
            }
            Ok(())
        },
        flies: false,
    },
    Quirk {
        name: "items_are_not_given_without_a_list",
        of: PX4,
        does: "an item is not given unless the list was asked for",
        check: |s| {
            let items = northward(s, 3)?;
            s.send_list(&items)?;
            s.ask(1);
            let given = s.answers(|m| matches!(m, MavMessage::MISSION_ITEM_INT(_)).then_some(()))?;
            same("items given", given.len(), 0)
        },
        flies: false,
    },
    Quirk {
        name: "item_behind_the_list_has_an_invalid_number",
        of: ARDUPLANE,
        does: "asked for an item behind the list: INVALID_SEQUENCE",
        check: |s| same("the answer", behind(s)?, Answer::Ack(INVALID_SEQUENCE)),
        flies: false,
    },
    Quirk {
        name: "item_out_of_turn_is_an_error",
        of: PX4,
        does: "asked for an item that is not the next: ERROR",
        check: |s| same("the answer", behind(s)?, Answer::Ack(ERROR)),
        flies: false,
    },
    Quirk {
        name: "nobody_reads_while_somebody_uploads",
        of: ARDUPLANE,
        does: "`MISSION_REQUEST_LIST` during an upload is DENIED",
        check: |s| {
            same("the answer", s.count(2)?, Answer::Wants(0))?;
            s.say_list_request();
            let answer = s.hear("an answer", |m| answer_to(OWN, m).filter(|a| *a != Answer::Wants(0)))?;
            same("the answer", answer, Answer::Ack(MavMissionResult::MAV_MISSION_DENIED))
        },
        flies: false,
    },
    Quirk {
        name: "places_are_kept_to_the_last_digit",
        of: BOTH,
        does: "latitude and longitude read back as they were sent, 1e-7 degrees",
        check: |s| {
            let mut sent = (0, 0);
            let kept = kept(s, |item| {
                (item.x, item.y) = (item.x + 7, item.y + 3);
                sent = (item.x, item.y);
            })?;
            same("place", (kept.x, kept.y), sent)
        },
        flies: false,
    },
];

/// How the second of two waypoints reads back once it is changed so.
fn kept(
    s: &mut Station,
    change: impl FnOnce(&mut MISSION_ITEM_INT_DATA),
) -> anyhow::Result<MISSION_ITEM_INT_DATA> {
    let mut items = northward(s, 2)?;
    let item = items.last_mut().context("an item")?;
    change(item);
    same("the answer", s.send_list(&items)?.mavtype, MavMissionResult::MAV_MISSION_ACCEPTED)?;
    s.list()?.pop().context("the list is empty")
}

/// The place of an item that is given, or none.
fn asked(s: &mut Station, seq: u16) -> anyhow::Result<Option<i32>> {
    s.forget();
    s.ask(seq);
    s.hear("an item", |message| match message {
        MavMessage::MISSION_ITEM_INT(item) => Some((item.seq == seq).then_some(item.x)),
        _ => None,
    })
}

/// How it answers when an item behind the list is asked for.
fn behind(s: &mut Station) -> anyhow::Result<Answer> {
    let items = northward(s, 3)?;
    s.send_list(&items)?;
    s.list_count()?;
    s.ask(5);
    s.hear("an answer", |message| answer_to(OWN, message))
}
