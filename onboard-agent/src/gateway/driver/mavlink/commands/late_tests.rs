//! Orders whose number an order that is over had before them.

use super::*;

const PEER: Peer = Peer { system: 1, component: 1 };
const FIRST: Client = Client::Order(OrderId(1));
const SECOND: Client = Client::Order(OrderId(2));
const MODE: u32 = 10;
const ARMING: MavCmd = MavCmd::MAV_CMD_COMPONENT_ARM_DISARM;

/// One order after another, 100 ms at a time.
#[derive(Default)]
struct Talk {
    commands: Commands,
    now: Time,
    sent: usize,
    ended: Vec<Ended>,
}

impl Talk {
    /// To arm is sent, and taken back; to disarm is sent, and lost.
    fn stood_down() -> Self {
        let mut talk = Self::default();
        (0..20).for_each(|_| talk.commands.rto.sample(Duration::ZERO));
        talk.shows(false);
        assert_eq!(talk.commands.give(FIRST, Command::Arm), None);
        talk.pass(1);
        talk.commands.take_back(FIRST);
        assert_eq!(talk.commands.give(SECOND, Command::Disarm), None);
        talk.pass(1);
        assert_eq!(std::mem::take(&mut talk.sent), 2);
        talk
    }

    fn pass(&mut self, steps: u32) {
        for _ in 0..steps {
            self.now += Duration::from_millis(100);
            let mut out = vec![];
            let ended = self.commands.tick(self.now, PEER, &mut out);
            self.ended.extend(ended);
            self.sent += out.len();
        }
    }

    fn shows(&mut self, armed: bool) {
        let ended = self.commands.shown(self.now, Shown::Mode(MODE, armed));
        self.ended.extend(ended);
    }

    fn answers(&mut self, result: MavResult) {
        self.answers_to(ARMING, result);
    }

    fn answers_to(&mut self, command: MavCmd, result: MavResult) {
        let ack = COMMAND_ACK_DATA { command, result, ..COMMAND_ACK_DATA::DEFAULT };
        let ended = self.commands.acked(self.now, &ack);
        self.ended.extend(ended);
    }
}

#[test]
fn the_answer_to_an_order_that_was_taken_back_is_not_the_next_ones() {
    for result in [MavResult::MAV_RESULT_ACCEPTED, MavResult::MAV_RESULT_DENIED] {
        let mut talk = Talk::stood_down();
        talk.answers(result);
        talk.shows(false);
        assert_eq!(talk.ended, [], "{result:?}: that it is not armed yet says nothing");
        talk.pass(10);
        assert!(talk.sent > 0, "{result:?}: it is ordered again");
        // it was armed late, and disarmed
        talk.shows(true);
        talk.pass(10);
        talk.shows(false);
        talk.pass(60);
        talk.answers(MavResult::MAV_RESULT_ACCEPTED);
        talk.shows(false);
        assert_eq!(talk.ended, [(SECOND, Ok(()))], "{result:?}");
    }
}

/// On a quick link all its tries would be over before an answer counts.
#[test]
fn what_no_answer_counts_for_yet_is_not_given_up() {
    let mut talk = Talk::stood_down();
    talk.pass(52);
    assert_eq!(talk.ended, []);
    talk.answers(MavResult::MAV_RESULT_DENIED);
    assert!(matches!(&talk.ended[..], [(SECOND, Err(refusal))] if refusal.is_answer), "{:?}", talk.ended);
}

#[test]
fn an_engine_is_not_believed_to_be_stopped_by_the_answer_to_another_order() {
    let mut talk = Talk::default();
    talk.shows(false);
    assert_eq!(talk.commands.give(FIRST, Command::Arm), None);
    talk.pass(1);
    talk.ended.extend(talk.commands.give(SECOND, Command::ForceDisarm));
    talk.pass(1);
    assert!(matches!(&talk.ended[..], [(FIRST, Err(_))]), "{:?}", talk.ended);
    talk.answers(MavResult::MAV_RESULT_ACCEPTED);
    talk.shows(false);
    assert_eq!(talk.ended.len(), 1, "it may be armed yet");
    talk.pass(60);
    talk.answers(MavResult::MAV_RESULT_ACCEPTED);
    talk.shows(false);
    assert_eq!(talk.ended.last(), Some(&(SECOND, Ok(()))));
}

/// Nothing is waited for: what it answered is over with it.
#[test]
fn an_order_whose_predecessor_was_answered_is_believed_at_once() {
    let mut talk = Talk::default();
    talk.shows(false);
    for (client, command, armed) in [(FIRST, Command::Arm, true), (SECOND, Command::Disarm, false)] {
        assert_eq!(talk.commands.give(client, command), None);
        talk.pass(1);
        talk.answers(MavResult::MAV_RESULT_ACCEPTED);
        talk.shows(armed);
        assert_eq!(talk.ended.pop(), Some((client, Ok(()))));
    }
}

/// It stopped the program that ends a flight by force.
#[test]
fn an_end_that_is_refused_while_an_order_to_arm_may_be_answered_stops_the_engine() {
    let mut talk = Talk::default();
    talk.shows(false);
    assert_eq!(talk.commands.give(FIRST, Command::Arm), None);
    talk.pass(1);
    talk.ended.extend(talk.commands.give(SECOND, Command::Terminate));
    talk.pass(1);
    talk.answers_to(MavCmd::MAV_CMD_DO_FLIGHTTERMINATION, MavResult::MAV_RESULT_DENIED);
    talk.sent = 0;
    talk.pass(1);
    assert_eq!(talk.sent, 1, "at once");
    talk.pass(20);
    assert!(talk.sent > 1, "and again");
    talk.shows(true);
    talk.shows(false);
    assert_eq!(talk.ended.last(), Some(&(SECOND, Ok(()))));
}

/// All that it was sent since may have been answered.
#[test]
fn what_was_sent_more_than_once_measures_no_way_there_and_back() {
    let mut talk = Talk::stood_down();
    talk.pass(52);
    let before = talk.commands.rto.timeout();
    talk.answers(MavResult::MAV_RESULT_ACCEPTED);
    assert_eq!(talk.commands.rto.timeout(), before);
}

/// Whoever arms it next has it.
#[test]
fn what_was_seen_to_be_disarmed_is_not_disarmed_again() {
    let mut talk = Talk::stood_down();
    for armed in [true, false] {
        talk.pass(5);
        talk.shows(armed);
    }
    assert_eq!(talk.ended, [(SECOND, Ok(()))]);
    talk.sent = 0;
    talk.pass(5);
    talk.shows(true);
    talk.pass(60);
    assert_eq!(talk.sent, 0);
}

#[test]
fn the_answer_to_a_second_copy_is_not_the_next_ones() {
    let mut talk = Talk::default();
    talk.commands.rto.start(Time::ZERO);
    assert!(talk.commands.rto.expired(Duration::from_secs(60)) && talk.commands.rto.copies() == 2);
    talk.now = Duration::from_secs(60);
    talk.shows(false);
    for (client, command) in [(FIRST, Command::Arm), (SECOND, Command::Disarm)] {
        assert_eq!(talk.commands.give(client, command), None);
        talk.pass(1);
        talk.answers(MavResult::MAV_RESULT_DENIED);
    }
    assert!(matches!(&talk.ended[..], [(FIRST, Err(_))]), "{:?}", talk.ended);
    talk.answers(MavResult::MAV_RESULT_DENIED);
    assert!(matches!(&talk.ended[..], [_, (SECOND, Err(_))]), "its own: {:?}", talk.ended);
}

/// A launch is put off each second: each order in two copies, of which one is not answered.
#[test]
fn answers_that_were_lost_are_not_waited_for_as_long_as_orders_follow_each_other() {
    let mut late = LateAnswers::default();
    (1..=20).for_each(|second| late.expect(ARMING, Duration::from_secs(second), 1));
    let now = Duration::from_secs(21);
    let owed = (0..30).take_while(|_| late.takes(now, ARMING, true)).count();
    assert_eq!(owed, 4, "those of the last five seconds");
}
