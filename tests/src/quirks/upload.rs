//! How a list is taken.

use super::lists::{Answer, answer_to, northward};
use super::station::{OTHER, OWN, Station, same, text};
use super::{ARDUPLANE, BOTH, PX4, Quirk};
use MavMissionResult::{
    MAV_MISSION_ACCEPTED as ACCEPTED, MAV_MISSION_DENIED as DENIED, MAV_MISSION_ERROR as ERROR,
    MAV_MISSION_INVALID_PARAM2 as INVALID_PARAM2, MAV_MISSION_INVALID_SEQUENCE as INVALID_SEQUENCE,
    MAV_MISSION_NO_SPACE as NO_SPACE, MAV_MISSION_OPERATION_CANCELLED as CANCELLED,
    MAV_MISSION_UNSUPPORTED as UNSUPPORTED,
};
use mavlink::dialects::ardupilotmega::*;

pub(super) const QUIRKS: &[Quirk] = &[
    Quirk {
        name: "list_begins_with_home",
        of: ARDUPLANE,
        does: "item 0 of a list is home, whatever is sent for it",
        check: |s| {
            let items = northward(s, 3)?;
            same("the answer", s.send_list(&items)?.mavtype, ACCEPTED)?;
            let list = s.list()?;
            same("items", list.len(), 3)?;
            let is_kept = |i: usize| list.get(i).map(|item| item.x) == items.get(i).map(|item| item.x);
            same("kept", [is_kept(0), is_kept(1), is_kept(2)], [false, true, true])
        },
        flies: false,
    },
    Quirk {
        name: "list_begins_with_the_first_item",
        of: PX4,
        does: "item 0 of a list is the first that is flown",
        check: |s| {
            let items = northward(s, 3)?;
            same("the answer", s.send_list(&items)?.mavtype, ACCEPTED)?;
            let kept: Vec<_> = s.list()?.iter().map(|item| item.x).collect();
            same("places", kept, items.iter().map(|item| item.x).collect())
        },
        flies: false,
    },
    Quirk {
        name: "items_are_asked_for_in_floats",
        of: ARDUPLANE,
        does: "it asks by `MISSION_REQUEST`, on MAVLink 2 too",
        check: |s| same("asked by the old message", asked_in_floats(s)?, true),
        flies: false,
    },
    Quirk {
        name: "items_are_asked_for_in_integers",
        of: PX4,
        does: "it asks by `MISSION_REQUEST_INT`",
        check: |s| same("asked by the old message", asked_in_floats(s)?, false),
        flies: false,
    },
    Quirk {
        name: "unanswered_request_is_repeated",
        of: BOTH,
        does: "it asks for an item again and again",
        check: |s| {
            same("the answer", s.count(2)?, Answer::Wants(0))?;
            for _ in 0..3 {
                let again = s.hear("the same request again", |m| answer_to(OWN, m))?;
                same("again", again, Answer::Wants(0))?;
            }
            Ok(())
        },
        flies: false,
    },
    Quirk {
        name: "upload_left_half_way_is_cancelled",
        of: ARDUPLANE,
        does: "after 8 s it answers OPERATION_CANCELLED; the list is half new, half old",
        check: |s| {
            let old = northward(s, 5)?;
            s.send_list(&old)?;
            let new = [old[0].clone(), MISSION_ITEM_INT_DATA { z: 77.0, ..old[1].clone() }];
            same("the answer", s.count(4)?, Answer::Wants(0))?;
            same("the answer", s.item(0, &new[0])?, Answer::Wants(1))?;
            same("the answer", s.item(1, &new[1])?, Answer::Wants(2))?;
            same("the end", s.ack()?.mavtype, CANCELLED)?;
            let heights: Vec<_> = s.list()?.iter().skip(1).map(|item| item.z).collect();
            same("heights", heights, vec![77.0, 100.0, 100.0])
        },
        flies: false,
    },
    Quirk {
        name: "upload_left_half_way_ends_in_words",
        of: PX4,
        does: "after 5 s it says that, and answers nothing; the old list stays",
        check: |s| {
            let old = northward(s, 5)?;
            let id = s.send_list(&old)?.opaque_id;
            // its links learn of a list one by one, and one that has not yet may write over it
            s.hear("that list is aboard", |m| {
                matches!(m, MavMessage::MISSION_CURRENT(current) if current.mission_id == id).then_some(())
            })?;
            let new = MISSION_ITEM_INT_DATA { z: 77.0, ..old[0].clone() };
            same("the answer", s.count(4)?, Answer::Wants(0))?;
            same("the answer", s.item(0, &new)?, Answer::Wants(1))?;
            s.says("timeout")?;
            let acks = s.answers(|m| answer_to(OWN, m).filter(|answer| matches!(answer, Answer::Ack(_))))?;
            same("answers", acks, vec![])?;
            let heights: Vec<_> = s.list()?.iter().map(|item| item.z).collect();
            same("heights", heights, vec![100.0; 5])
        },
        flies: false,
    },
    Quirk {
        name: "list_has_room_for_655",
        of: ARDUPLANE,
        does: "a list of 656 items is refused with NO_SPACE, one of 655 is asked for",
        check: |s| {
            same("656", s.count(656)?, Answer::Ack(NO_SPACE))?;
            same("655", s.count(655)?, Answer::Wants(0))
        },
        flies: false,
    },
    Quirk {
        name: "list_of_65535_has_no_space",
        of: BOTH,
        does: "a list of 65535 items is refused with NO_SPACE",
        check: |s| same("the answer", s.count(u16::MAX)?, Answer::Ack(NO_SPACE)),
        flies: false,
    },
    Quirk {
        name: "list_of_none_clears",
        of: BOTH,
        does: "a list of 0 items is accepted at once; nothing is left",
        check: |s| {
            let items = northward(s, 4)?;
            s.send_list(&items)?;
            same("the answer", s.count(0)?, Answer::Ack(ACCEPTED))?;
            same("items", s.list_count()?, 0)
        },
        flies: false,
    },
    Quirk {
        name: "item_out_of_order_is_refused",
        of: ARDUPLANE,
        does: "INVALID_SEQUENCE, and the upload goes on",
        check: |s| {
            let items = northward(s, 2)?;
            same("the answer", s.count(2)?, Answer::Wants(0))?;
            same("item 1 first", s.item(1, &items[1])?, Answer::Ack(INVALID_SEQUENCE))?;
            same("item 0", s.item(0, &items[0])?, Answer::Wants(1))?;
            same("item 1", s.item(1, &items[1])?, Answer::Ack(ACCEPTED))
        },
        flies: false,
    },
    Quirk {
        name: "item_out_of_order_is_passed_over",
        of: PX4,
        does: "no answer, and the upload goes on",
        check: |s| {
            let items = northward(s, 2)?;
            same("the answer", s.count(2)?, Answer::Wants(0))?;
            s.put(1, &items[1]);
            let acks = s.answers(|m| answer_to(OWN, m).filter(|answer| *answer != Answer::Wants(0)))?;
            same("answers to item 1", acks, vec![])?;
            same("item 0", s.item(0, &items[0])?, Answer::Wants(1))?;
            same("item 1", s.item(1, &items[1])?, Answer::Ack(ACCEPTED))
        },
        flies: false,
    },
    Quirk {
        name: "last_item_again_is_accepted_again",
        of: PX4,
        does: "the last item of an upload that is done is accepted once more, any other is an ERROR",
        check: |s| {
            let items = northward(s, 2)?;
            s.send_list(&items)?;
            same("item 1 again", s.item(1, &items[1])?, Answer::Ack(ACCEPTED))?;
            same("item 0 again", s.item(0, &items[0])?, Answer::Ack(ERROR))
        },
        flies: false,
    },
    Quirk {
        name: "item_without_an_upload_is_an_error",
        of: ARDUPLANE,
        does: "an item after the end of an upload is answered with ERROR",
        check: |s| {
            let items = northward(s, 2)?;
            s.send_list(&items)?;
            same("item 1 again", s.item(1, &items[1])?, Answer::Ack(ERROR))
        },
        flies: false,
    },
    Quirk {
        name: "unknown_item_ends_the_upload",
        of: BOTH,
        does: "UNSUPPORTED, and the next item is an ERROR",
        check: |s| {
            let items = northward(s, 2)?;
            let unknown =
                MISSION_ITEM_INT_DATA { command: MavCmd::MAV_CMD_REQUEST_MESSAGE, ..items[0].clone() };
            same("the answer", s.count(2)?, Answer::Wants(0))?;
            same("the item", s.item(0, &unknown)?, Answer::Ack(UNSUPPORTED))?;
            same("the next", s.item(0, &items[0])?, Answer::Ack(ERROR))
        },
        flies: false,
    },
    Quirk {
        name: "acceptance_radius_that_is_no_number_is_refused",
        of: ARDUPLANE,
        does: "a NaN in param2 of a waypoint: INVALID_PARAM2",
        check: |s| same("the answer", nan_in_param2(s)?, Answer::Ack(INVALID_PARAM2)),
        flies: false,
    },
    Quirk {
        name: "acceptance_radius_that_is_no_number_is_none",
        of: PX4,
        does: "a NaN in param2 of a waypoint is accepted",
        check: |s| same("the answer", nan_in_param2(s)?, Answer::Ack(ACCEPTED)),
        flies: false,
    },
    Quirk {
        name: "upload_is_denied_to_another_component",
        of: ARDUPLANE,
        does: "while one uploads, another component's list is DENIED",
        check: |s| {
            same("the answer", s.count(2)?, Answer::Wants(0))?;
            same("to the other", s.count_as(OTHER, 3)?, Answer::Ack(DENIED))
        },
        flies: false,
    },
    Quirk {
        name: "upload_is_an_error_to_another_component",
        of: PX4,
        does: "while one uploads, another component's list is an ERROR",
        check: |s| {
            same("the answer", s.count(2)?, Answer::Wants(0))?;
            same("to the other", s.count_as(OTHER, 3)?, Answer::Ack(ERROR))
        },
        flies: false,
    },
    Quirk {
        name: "same_list_again_is_no_news",
        of: PX4,
        does: "an answer names the list that is aboard by a number, which is the same for the same list",
        check: |s| {
            let items = northward(s, 3)?;
            let higher: Vec<_> =
                items.iter().map(|item| MISSION_ITEM_INT_DATA { z: 120.0, ..item.clone() }).collect();
            let (first, again, other) = (s.send_list(&items)?, s.send_list(&items)?, s.send_list(&higher)?);
            let ids = [first.opaque_id, again.opaque_id, other.opaque_id];
            same("given, same, another", [ids[0] != 0, ids[1] == ids[0], ids[2] != ids[0]], [true; 3])
        },
        flies: false,
    },
    Quirk {
        name: "upload_is_confirmed_in_words",
        of: ARDUPLANE,
        does: "it says `Flight plan received`",
        check: |s| {
            let items = northward(s, 2)?;
            s.forget();
            same("the answer", s.count(2)?, Answer::Wants(0))?;
            for (seq, item) in (0..).zip(&items) {
                s.put(seq, item);
            }
            s.says("Flight plan received").map(drop)
        },
        flies: false,
    },
    Quirk {
        name: "clear_leaves_nothing",
        of: BOTH,
        does: "`MISSION_CLEAR_ALL` is accepted on the ground; nothing is left, not even home",
        check: |s| {
            let items = northward(s, 4)?;
            s.send_list(&items)?;
            same("the answer", s.clear()?, ACCEPTED)?;
            same("items", s.list_count()?, 0)
        },
        flies: false,
    },
    Quirk {
        name: "clear_ends_ones_own_upload",
        of: ARDUPLANE,
        does: "`MISSION_CLEAR_ALL` while one uploads is accepted, and ends that",
        check: |s| {
            let items = northward(s, 1)?;
            same("the answer", s.count(2)?, Answer::Wants(0))?;
            same("clear", s.clear()?, ACCEPTED)?;
            same("an item", s.item(0, &items[0])?, Answer::Ack(ERROR))
        },
        flies: false,
    },
    Quirk {
        name: "clear_is_ignored_while_uploading",
        of: PX4,
        does: "`MISSION_CLEAR_ALL` while one uploads is answered in words only",
        check: |s| {
            same("the answer", s.count(2)?, Answer::Wants(0))?;
            s.say_clear();
            s.says("Busy")?;
            let acks = s.answers(|m| answer_to(OWN, m).filter(|answer| matches!(answer, Answer::Ack(_))))?;
            same("answers", acks, vec![])
        },
        flies: false,
    },
    Quirk {
        name: "upload_is_given_up_by_an_answer",
        of: PX4,
        does: "`MISSION_ACK` with OPERATION_CANCELLED from who uploads ends that",
        check: |s| {
            let items = northward(s, 1)?;
            same("the answer", s.count(2)?, Answer::Wants(0))?;
            s.give_up();
            same("an item", s.item(0, &items[0])?, Answer::Ack(ERROR))
        },
        flies: false,
    },
    Quirk {
        name: "upload_is_not_given_up_by_an_answer",
        of: ARDUPLANE,
        does: "`MISSION_ACK` from who uploads changes nothing",
        check: |s| {
            let items = northward(s, 1)?;
            same("the answer", s.count(2)?, Answer::Wants(0))?;
            s.give_up();
            same("an item", s.item(0, &items[0])?, Answer::Wants(1))
        },
        flies: false,
    },
    Quirk {
        name: "partial_write_gets_no_answer",
        of: PX4,
        does: "`MISSION_WRITE_PARTIAL_LIST` is not answered at all, not even in words",
        check: |s| {
            let items = northward(s, 3)?;
            s.send_list(&items)?;
            s.write_partial(1, 1);
            let said = s.answers(|m| answer_to(OWN, m).map(|a| format!("{a:?}")).or_else(|| text(m)))?;
            same("answers", said, vec![])
        },
        flies: false,
    },
    Quirk {
        name: "partial_write_overwrites",
        of: ARDUPLANE,
        does: "`MISSION_WRITE_PARTIAL_LIST` overwrites a range and leaves the rest",
        check: |s| {
            let items = northward(s, 4)?;
            s.send_list(&items)?;
            let higher = MISSION_ITEM_INT_DATA { z: 120.0, ..items[2].clone() };
            same("the answer", partial(s, 2, 2)?, Answer::Wants(2))?;
            same("the item", s.item(2, &higher)?, Answer::Ack(ACCEPTED))?;
            let heights: Vec<_> = s.list()?.iter().skip(1).map(|item| item.z).collect();
            same("heights", heights, vec![100.0, 120.0, 100.0])
        },
        flies: false,
    },
    Quirk {
        name: "partial_write_appends_one",
        of: ARDUPLANE,
        does: "its last item may be one behind the list; two, none (−1) or a range that ends before it begins is an ERROR",
        check: |s| {
            let items = northward(s, 4)?;
            s.send_list(&items)?;
            for (first, last) in [(4, 5), (5, 5), (2, -1), (3, 2)] {
                same(&format!("{first} to {last}"), partial(s, first, last)?, Answer::Ack(ERROR))?;
            }
            same("4 to 4", partial(s, 4, 4)?, Answer::Wants(4))?;
            same("the item", s.item(4, &items[3])?, Answer::Ack(ACCEPTED))?;
            same("items", s.list_count()?, 5)
        },
        flies: false,
    },
];

fn asked_in_floats(s: &mut Station) -> anyhow::Result<bool> {
    same("the answer", s.count(2)?, Answer::Wants(0))?;
    s.hear("a request", |message| match message {
        MavMessage::MISSION_REQUEST(_) => Some(true),
        MavMessage::MISSION_REQUEST_INT(_) => Some(false),
        _ => None,
    })
}

fn nan_in_param2(s: &mut Station) -> anyhow::Result<Answer> {
    let items = northward(s, 1)?;
    let strange = MISSION_ITEM_INT_DATA { param2: f32::NAN, ..items[0].clone() };
    same("the answer", s.count(1)?, Answer::Wants(0))?;
    s.item(0, &strange)
}

fn partial(s: &mut Station, first: i16, last: i16) -> anyhow::Result<Answer> {
    s.write_partial(first, last);
    s.hear("an answer to a partial write", |message| answer_to(OWN, message))
}
