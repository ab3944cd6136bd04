//! One transfer, message by message: what counts as a proof, and what is gone through again.

use super::*;
use MavMissionResult::*;

const PEER: Peer = Peer { system: 1, component: 1 };
const RULES: Rules = Rules { same: is_same, id: None, reads_in_order: false };
/// Of an autopilot that gives its list only in order.
const IN_ORDER: Rules = Rules { reads_in_order: true, ..RULES };
/// Longer than any timeout.
const LONG: Time = Time::from_secs(4);

fn is_same(one: &Entry, other: &Entry) -> bool {
    one == other
}

fn entry(seq: u16) -> Entry {
    Entry { seq, x: i32::from(seq), ..Entry::DEFAULT }
}

fn entries(count: u16) -> Vec<Entry> {
    (0..count).map(entry).collect()
}

/// A transfer and what it says.
struct Talk {
    transfer: Transfer,
    now: Time,
    out: Vec<MavMessage>,
}

impl Talk {
    fn upload(count: u16, rules: &'static Rules) -> Self {
        let mut out = vec![];
        let transfer = Transfer::upload(Time::ZERO, entries(count), rules, Rto::default(), PEER, &mut out);
        Self { transfer, now: Time::ZERO, out }
    }

    /// All entries came through, and it is asked what is aboard.
    fn reading_back(count: u16, rules: &'static Rules) -> Self {
        let mut talk = Self::upload(count, rules);
        talk.request(count - 1);
        assert_eq!(talk.ack(MAV_MISSION_ACCEPTED), None);
        talk
    }

    fn reading(rules: &'static Rules) -> Self {
        let mut out = vec![];
        let transfer = Transfer::read_list(Time::ZERO, rules, Rto::default(), PEER, &mut out);
        Self { transfer, now: Time::ZERO, out }
    }

    fn request(&mut self, seq: u16) {
        self.transfer.requested(self.now, seq, &mut self.out);
    }

    fn ack(&mut self, result: MavMissionResult) -> Option<Outcome> {
        self.transfer.acked(self.now, result, PEER, &mut self.out)
    }

    fn count(&mut self, count: u16) -> Option<Outcome> {
        self.transfer.counted(self.now, count, PEER, &mut self.out)
    }

    fn item(&mut self, entry: &Entry) -> Option<Outcome> {
        self.transfer.item(self.now, entry, PEER, &mut self.out)
    }

    /// A timeout passes.
    fn timeout(&mut self) -> Option<Outcome> {
        self.now += LONG;
        self.transfer.tick(self.now, PEER, &mut self.out)
    }

    /// What was said since the last call, each in a word; what is said twice in a row, as on a link that loses frames, once.
    fn said(&mut self) -> String {
        let word = |message: &MavMessage| match message {
            MavMessage::MISSION_COUNT(_) => "count".to_owned(),
            MavMessage::MISSION_ITEM_INT(item) => item.seq.to_string(),
            MavMessage::MISSION_REQUEST_INT(request) => format!("{}?", request.seq),
            MavMessage::MISSION_REQUEST_LIST(_) => "list?".to_owned(),
            MavMessage::MISSION_ACK(_) => "thanks".to_owned(),
            other => panic!("{other:?}"),
        };
        let mut words: Vec<_> = self.out.drain(..).map(|message| word(&message)).collect();
        words.dedup();
        words.join(" ")
    }
}

fn failed(outcome: Option<Outcome>) -> String {
    let Some(Outcome::Failed(why)) = outcome else { panic!("{outcome:?}") };
    why
}

#[test]
fn a_list_is_verified_when_every_entry_has_read_back_as_written() {
    let mut talk = Talk::reading_back(3, &RULES);
    assert_eq!(talk.said(), "count 0 1 2 0? 1? 2?");
    assert_eq!((talk.item(&entry(2)), talk.item(&entry(0)), talk.item(&entry(0))), (None, None, None));
    assert_eq!(talk.item(&entry(1)), Some(Outcome::Verified));
    assert_eq!(talk.said(), "thanks");
}

/// It may be left over from another transfer.
#[test]
fn an_answer_before_the_last_entry_was_asked_for_proves_nothing() {
    for result in [MAV_MISSION_ACCEPTED, MAV_MISSION_ERROR, MAV_MISSION_INVALID_SEQUENCE] {
        let mut talk = Talk::upload(3, &RULES);
        talk.said();
        assert_eq!((talk.ack(result), talk.said().as_str()), (None, ""), "{result:?}");
    }
    let mut talk = Talk::upload(30, &RULES);
    talk.request(3);
    talk.said();
    for result in [MAV_MISSION_ACCEPTED, MAV_MISSION_ERROR] {
        assert_eq!((talk.ack(result), talk.said().as_str()), (None, ""), "{result:?}: not all was sent");
    }
}

#[test]
fn not_receiving_any_more_is_asked_what_it_has() {
    let mut talk = Talk::upload(3, &RULES);
    talk.request(1);
    talk.said();
    assert_eq!((talk.ack(MAV_MISSION_ERROR), talk.said().as_str()), (None, "0? 1? 2?"));
}

/// More would only wait before a narrow link, for longer than an answer is waited for.
#[test]
fn less_is_sent_at_once_each_time_that_nothing_is_answered_and_more_again_for_what_is_taken() {
    let mut talk = Talk::upload(100, &RULES);
    talk.request(1);
    assert_eq!(
        talk.said().split(' ').count(),
        1 + WINDOW + 1,
        "the opening, a window, and one more for the one taken"
    );
    for at_once in [WINDOW / 2, LEAST_WINDOW, LEAST_WINDOW] {
        assert_eq!(talk.timeout(), None);
        assert_eq!(talk.said().split(' ').count(), at_once);
    }
    talk.request(4);
    assert_eq!(talk.said(), "7 8 9 10 11 12", "three were taken: so many more than the least");
}

#[test]
fn what_it_will_never_take_is_given_up_and_what_another_station_does_is_waited_for() {
    let mut talk = Talk::upload(3, &RULES);
    assert!(failed(talk.ack(MAV_MISSION_NO_SPACE)).contains("refused the list"));
    for result in [MAV_MISSION_DENIED, MAV_MISSION_OPERATION_CANCELLED] {
        assert_eq!(Talk::upload(3, &RULES).ack(result), None, "{result:?}");
        assert_eq!(Talk::reading_back(3, &RULES).ack(result), None, "{result:?}");
    }
}

/// Each of a window's remaining entries is answered with the same complaint: it goes back when it is asked for again.
#[test]
fn complaints_alone_send_nothing_again() {
    let mut talk = Talk::upload(5, &RULES);
    talk.request(2);
    talk.said();
    talk.ack(MAV_MISSION_INVALID_SEQUENCE);
    talk.ack(MAV_MISSION_INVALID_SEQUENCE);
    assert_eq!(talk.said(), "");
    talk.now += LONG;
    talk.request(2);
    assert_eq!(talk.said(), "2 3 4", "asked for again, later");
}

#[test]
fn requests_for_what_it_has_and_for_what_is_not_there_are_passed_over() {
    let mut talk = Talk::upload(30, &RULES);
    talk.request(10);
    talk.said();
    [9, 30, 65_535].into_iter().for_each(|seq| talk.request(seq));
    assert_eq!(talk.said(), "");
    let mut talk = Talk::reading_back(3, &RULES);
    talk.said();
    talk.request(1);
    assert_eq!(talk.said(), "", "it is read by now");
}

#[test]
fn only_a_list_that_was_asked_for_and_can_be_one_is_read() {
    let mut talk = Talk::reading(&RULES);
    assert!(failed(talk.count(MAX_ITEMS + 1)).contains("claims a list of 2001 entries"));
    assert_eq!(Talk::reading(&RULES).count(0), Some(Outcome::List(vec![])));
    let mut talk = Talk::reading(&RULES);
    assert_eq!(talk.item(&entry(0)), None, "nobody asked for it");
    assert_eq!((talk.count(2), talk.count(9)), (None, None));
    assert_eq!((talk.item(&entry(7)), talk.item(&entry(1))), (None, None));
    assert_eq!(talk.item(&entry(0)), Some(Outcome::List(entries(2))));
}

#[test]
fn a_list_that_reads_back_shorter_or_differently_is_written_again_and_not_for_ever() {
    let mut talk = Talk::upload(3, &IN_ORDER);
    for time in 0..=REWRITES {
        talk.request(2);
        talk.ack(MAV_MISSION_ACCEPTED);
        talk.count(2);
        talk.item(&entry(0));
        let outcome = talk.item(&entry(1));
        if time == REWRITES {
            assert!(failed(outcome).contains("entry 2 reads back differently"));
        } else {
            assert_eq!(outcome, None, "{time}");
        }
    }
    let mut talk = Talk::reading_back(1, &RULES);
    talk.said();
    assert_eq!(talk.item(&Entry { x: 99, ..entry(0) }), None);
    assert_eq!(talk.said(), "thanks count 0");
}

#[test]
fn an_autopilot_that_never_answers_is_given_up() {
    let mut talk = Talk::upload(3, &RULES);
    assert_eq!(talk.transfer.tick(talk.now, PEER, &mut talk.out), None, "it is not late yet");
    for _ in 0..PATIENCE {
        talk.said();
        assert_eq!(talk.timeout(), None);
        assert_eq!(talk.said(), "count 0 1 2");
    }
    assert!(failed(talk.timeout()).contains("does not answer"));
    let mut talk = Talk::reading(&RULES);
    assert_eq!((talk.timeout(), talk.said().as_str()), (None, "list?"));
}

/// An autopilot gives a transfer up when it is not answered for some seconds: no patience of ours helps.
#[test]
fn a_link_that_is_longer_than_the_autopilots_patience_is_named() {
    let (mut rto, mut out) = (Rto::default(), vec![]);
    rto.knows_trip(Some(Time::from_millis(4600)));
    let transfer = Transfer::upload(Time::ZERO, entries(3), &RULES, rto, PEER, &mut out);
    let mut talk = Talk { transfer, now: Time::ZERO, out };
    let given_up = std::iter::repeat_with(|| talk.timeout()).take(1000).find(Option::is_some).flatten();
    let why = failed(given_up);
    assert!(why.contains("takes 5 s there and back") && why.contains("faster"), "{why}");
}

/// On a bad link each new beginning has all the patience that there is.
#[test]
fn an_autopilot_that_takes_some_each_time_is_given_up_in_the_end() {
    let mut talk = Talk::upload(40, &RULES);
    let why = (0..1000).find_map(|_| {
        if talk.said().starts_with("count") {
            talk.request(3);
            talk.said();
        }
        talk.timeout()
    });
    assert!(failed(why).contains("loses too much"));
    assert_eq!(talk.transfer.restarts, RESTARTS + 1);
}

#[test]
fn what_is_silent_in_the_middle_gets_the_same_again_then_the_whole_and_near_the_end_is_asked() {
    let mut talk = Talk::upload(40, &RULES);
    talk.request(3);
    talk.said();
    let again: Vec<_> = (0..4).map(|_| (talk.timeout(), talk.said())).collect();
    assert!(again[..3].iter().all(|(_, said)| said.starts_with("3 4 5")), "{again:?}");
    assert!(again[3].1.starts_with("count 0 1"), "{again:?}");
    let mut talk = Talk::upload(3, &RULES);
    talk.request(2);
    talk.said();
    talk.timeout();
    assert_eq!(talk.said(), "2");
    talk.timeout();
    assert_eq!(talk.said(), "0? 1? 2?", "the end may have come through");
}

/// It may still be waiting for entries: then it does not let us read.
#[test]
fn what_does_not_let_us_read_is_sent_the_list_anew() {
    for (rules, asks) in [(&RULES, "0? 1? 2?"), (&IN_ORDER, "list?")] {
        let mut talk = Talk::reading_back(3, rules);
        talk.said();
        for _ in 0..2 {
            talk.timeout();
            assert_eq!(talk.said(), asks);
        }
        talk.timeout();
        assert_eq!(talk.said(), "count 0 1 2");
    }
}

#[test]
fn a_list_that_is_given_in_order_is_asked_for_again_when_that_breaks_off() {
    let mut talk = Talk::reading(&IN_ORDER);
    talk.count(4);
    talk.item(&entry(0));
    talk.said();
    assert_eq!((talk.ack(MAV_MISSION_ERROR), talk.said().as_str()), (None, "list?"));
    talk.count(4);
    assert_eq!(talk.said(), "0?", "one after the other");
    talk.item(&entry(0));
    talk.said();
    for _ in 1..BROKEN_OFF {
        talk.timeout();
        assert_eq!(talk.said(), "1?");
    }
    talk.timeout();
    assert_eq!(talk.said(), "list?");
    assert_eq!(Talk::reading_back(3, &RULES).ack(MAV_MISSION_ERROR), None, "others have lost nothing");
}

#[test]
fn a_list_without_a_name_is_called_nothing() {
    const NAMED: Rules = Rules { id: Some(length), ..RULES };
    fn length(list: &[Entry]) -> u32 {
        list.len() as u32
    }
    assert_eq!(
        (Talk::upload(3, &NAMED).transfer.name(), Talk::upload(3, &RULES).transfer.name()),
        (Some(3), None)
    );
    assert!(Talk::upload(3, &NAMED).transfer.is_called(3) && !Talk::reading(&NAMED).transfer.is_called(0));
}

/// An entry that the link always drops, or a fault of its firmware: it was sent the same window six times a second, for ever.
#[test]
fn an_autopilot_that_complains_of_whatever_comes_and_asks_for_nothing_is_given_up_by_the_clock() {
    let mut talk = Talk::upload(10, &RULES);
    talk.request(3);
    let begun = talk.now;
    let ended = (0..2000).find_map(|_| {
        talk.now += Duration::from_millis(100);
        let answered = talk.ack(MAV_MISSION_INVALID_SEQUENCE);
        answered.or_else(|| talk.transfer.tick(talk.now, PEER, &mut talk.out))
    });
    assert!(matches!(&ended, Some(Outcome::Failed(why)) if why.contains("loses too much")), "{ended:?}");
    let lasted = talk.now - begun;
    assert!((COMPLAINS_FOR..COMPLAINS_FOR + Duration::from_secs(5)).contains(&lasted), "{lasted:?}");
}

/// The requests of a second ago still wait in the line, and each had the whole window sent once more, where answers seemed to take no
/// time: nothing else came through any more.
#[test]
fn what_is_missed_again_and_again_is_sent_ever_more_seldom_and_never_twice_at_once() {
    let mut talk = Talk::upload(60, &RULES);
    for seq in 1..=40 {
        talk.request(seq);
    }
    let mut sent_at: Vec<Time> = vec![];
    while talk.now < Time::from_secs(2) {
        talk.now += Duration::from_millis(1);
        talk.out.clear();
        (0..10).for_each(|_| talk.request(40));
        let words = talk.said();
        assert!(words.is_empty() || words.split(' ').count() <= WINDOW, "{words}");
        sent_at.extend((!words.is_empty()).then_some(talk.now));
    }
    let gaps: Vec<_> = sent_at.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(gaps.is_sorted() && gaps.first() < gaps.last(), "{gaps:?}");
    assert!((5..30).contains(&sent_at.len()), "{sent_at:?}");
}
