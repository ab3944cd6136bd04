//! One command after the other: sent until it is answered, done when its effect is shown.

use super::*;

const PEER: Peer = Peer { system: 1, component: 1 };
const ORDER: Client = Client::Order(OrderId(1));
const OTHER: Client = Client::Order(OrderId(2));
const LOITER: Command = Command::Mode(ModeNumber { shown: 12, main: 12, sub: 0 });

/// The commands, and what they say.
#[derive(Default)]
struct Talk {
    commands: Commands,
    now: Time,
    out: Vec<MavMessage>,
}

impl Talk {
    fn giving(command: Command) -> Self {
        let mut talk = Self::default();
        assert_eq!(talk.commands.give(ORDER, command), None);
        assert_eq!(talk.pass(0), None);
        talk
    }

    /// So many seconds pass.
    fn pass(&mut self, seconds: u64) -> Option<Ended> {
        self.now += Duration::from_secs(seconds);
        self.commands.tick(self.now, PEER, &mut self.out)
    }

    fn ack(&mut self, command: MavCmd, result: MavResult) -> Option<Ended> {
        let ack = COMMAND_ACK_DATA { command, result, ..COMMAND_ACK_DATA::DEFAULT };
        self.commands.acked(self.now, &ack)
    }

    fn accept(&mut self, command: Command) -> Option<Ended> {
        self.ack(number(command), MavResult::MAV_RESULT_ACCEPTED)
    }

    fn show(&mut self, shown: Shown) -> Option<Ended> {
        self.commands.shown(self.now, shown)
    }

    #[expect(deprecated, reason = "PX4 takes an entry by the deprecated message only")]
    fn sent(&mut self) -> Vec<MavCmd> {
        let number = |message| match message {
            MavMessage::COMMAND_LONG(data) => data.command,
            MavMessage::COMMAND_INT(data) => data.command,
            MavMessage::MISSION_SET_CURRENT(_) => MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT,
            other => panic!("{other:?}"),
        };
        self.out.drain(..).map(number).collect()
    }
}

fn why(ended: Option<Ended>) -> String {
    let Some((_, Err(refusal))) = ended else { panic!("{ended:?}") };
    refusal.why
}

#[test]
fn each_command_is_done_when_its_own_effect_is_shown() {
    let go = Command::GoTo { place: None, shows: Some(15) };
    let cases = [
        (Command::Current(7), Shown::Current(7), Shown::Current(6)),
        (LOITER, Shown::Mode(12, true), Shown::Mode(10, true)),
        (go, Shown::Mode(15, true), Shown::Mode(10, true)),
        (Command::Arm, Shown::Mode(10, true), Shown::Mode(10, false)),
        (Command::Disarm, Shown::Mode(10, false), Shown::Mode(10, true)),
        (Command::ForceDisarm, Shown::Mode(10, false), Shown::Mode(10, true)),
    ];
    for (command, effect, other) in cases {
        let mut talk = Talk::giving(command);
        assert_eq!(talk.show(effect), None, "{command:?}: it was not answered yet");
        assert_eq!(talk.accept(command), None);
        assert_eq!(talk.show(other), None, "{command:?}");
        assert_eq!(talk.show(effect), Some((ORDER, Ok(()))), "{command:?}");
        let mut talk = Talk::giving(command);
        talk.accept(command);
        talk.pass(3);
        assert!(why(talk.show(other)).contains("did not do it"), "{command:?}");
    }
    let mut talk = Talk::giving(LOITER);
    talk.accept(LOITER);
    talk.pass(5);
    assert_eq!(talk.show(Shown::Current(3)), None, "that is no mode");
}

#[test]
fn what_nobody_answers_is_said_until_its_effect_is_shown_and_not_for_ever() {
    let mut talk = Talk::giving(Command::Select(7));
    assert_eq!((talk.show(Shown::Current(6)), talk.pass(4)), (None, None));
    assert!(!talk.sent().is_empty(), "it is sent again");
    assert_eq!(talk.show(Shown::Current(7)), Some((ORDER, Ok(()))));
    let mut talk = Talk::giving(Command::Select(7));
    assert!(why((0..100).find_map(|_| talk.pass(4))).contains("did not answer"));
}

#[test]
fn what_shows_no_effect_is_done_when_it_is_accepted() {
    for command in [Command::Speed(25.0), Command::GoTo { place: None, shows: None }] {
        assert_eq!(Talk::giving(command).accept(command), Some((ORDER, Ok(()))), "{command:?}");
    }
}

#[test]
fn an_unanswered_command_is_sent_again_and_not_for_ever() {
    let mut talk = Talk::giving(Command::Arm);
    let ended = (0..100).find_map(|_| talk.pass(4));
    assert!(why(ended).contains("did not answer"));
    let sent = talk.sent().len();
    assert_eq!(sent, 1 + 2 * (TRIES as usize - 1), "twice each once the link has lost something");
}

#[test]
fn an_accepted_command_is_waited_for_where_nothing_is_shown() {
    let mut talk = Talk::giving(LOITER);
    talk.accept(LOITER);
    talk.sent();
    assert_eq!((talk.pass(14), talk.sent()), (None, vec![]), "it is not sent again");
    assert!(why(talk.pass(1)).contains("has not shown since whether it did it"));
}

#[test]
fn answers_to_something_else_and_second_answers_are_passed_over() {
    let mut talk = Talk::default();
    assert_eq!(talk.accept(LOITER), None, "nothing is in flight");
    let mut talk = Talk::giving(LOITER);
    assert_eq!(talk.accept(Command::Arm), None);
    assert_eq!(talk.ack(number(LOITER), MavResult::MAV_RESULT_IN_PROGRESS), None);
    assert_eq!(talk.show(Shown::Mode(12, true)), None, "not accepted yet");
    assert_eq!(talk.accept(LOITER), None);
    assert_eq!(talk.ack(number(LOITER), MavResult::MAV_RESULT_DENIED), None, "it has accepted it");
    assert_eq!(talk.show(Shown::Mode(12, true)), Some((ORDER, Ok(()))));
}

#[test]
fn a_refusal_says_whether_it_is_one_for_now() {
    for (result, for_now) in
        [(MavResult::MAV_RESULT_TEMPORARILY_REJECTED, true), (MavResult::MAV_RESULT_DENIED, false)]
    {
        let ended = Talk::giving(Command::Arm).ack(number(Command::Arm), result);
        let Some((ORDER, Err(refusal))) = ended else { panic!("{ended:?}") };
        assert!(refusal.for_now == for_now && refusal.why.contains("refused Arm"), "{refusal:?}");
    }
}

/// Not every autopilot is set up for it.
#[test]
fn a_termination_that_is_refused_stops_the_engine() {
    let mut talk = Talk::giving(Command::Terminate);
    talk.sent();
    assert_eq!(talk.ack(number(Command::Terminate), MavResult::MAV_RESULT_UNSUPPORTED), None);
    assert_eq!(talk.pass(4), None);
    assert!(talk.sent().contains(&MavCmd::MAV_CMD_COMPONENT_ARM_DISARM));
    talk.accept(Command::ForceDisarm);
    assert_eq!(talk.show(Shown::Mode(10, false)), Some((ORDER, Ok(()))));
}

/// Its circuit breaker is set, or it only writes that down.
#[test]
fn a_termination_that_is_accepted_and_not_done_stops_the_engine_and_is_no_deed() {
    for obeys in [true, false] {
        let mut talk = Talk::giving(Command::Terminate);
        assert_eq!(talk.accept(Command::Terminate), None);
        assert_eq!((talk.pass(1), talk.show(Shown::Mode(10, true))), (None, None));
        talk.sent();
        assert_eq!((talk.pass(2), talk.show(Shown::Mode(10, true)), talk.pass(1)), (None, None, None));
        assert!(talk.sent().contains(&MavCmd::MAV_CMD_COMPONENT_ARM_DISARM));
        assert_eq!(talk.accept(Command::ForceDisarm), None);
        talk.pass(3);
        let ended = talk.show(Shown::Mode(10, !obeys));
        assert_eq!(ended.map(|(_, result)| result.is_ok()), Some(obeys));
    }
}

#[test]
fn a_termination_waits_for_nothing_but_another_one() {
    let mut talk = Talk::giving(LOITER);
    let (client, result) = talk.commands.give(OTHER, Command::Terminate).expect("the other one ends");
    assert!(client == ORDER && result.unwrap_err().why.contains("came before"));
    talk.sent();
    talk.pass(0);
    assert_eq!(talk.sent(), [MavCmd::MAV_CMD_DO_FLIGHTTERMINATION]);
    assert_eq!(talk.commands.give(ORDER, Command::ForceDisarm), None, "what is as urgent goes on");
    assert_eq!(talk.accept(Command::Terminate), None);
    assert_eq!(talk.show(Shown::Mode(10, false)), Some((OTHER, Ok(()))));
}

#[test]
fn what_is_taken_back_is_not_sent_again() {
    let mut talk = Talk::giving(Command::Arm);
    talk.commands.give(OTHER, LOITER);
    talk.commands.give(ORDER, Command::Speed(25.0));
    talk.commands.take_back(ORDER);
    talk.sent();
    talk.pass(4);
    assert_eq!(talk.sent().first(), Some(&MavCmd::MAV_CMD_DO_SET_MODE));
    talk.commands.take_back(ORDER);
    assert_eq!(talk.accept(LOITER), None);
    assert_eq!(talk.show(Shown::Mode(12, true)), Some((OTHER, Ok(()))), "another's goes on");
}

#[test]
fn a_queue_that_nobody_empties_does_not_grow() {
    let mut commands = Commands::default();
    let refused = (0..40).filter(|_| commands.give(ORDER, LOITER).is_some()).count();
    assert_eq!((refused, commands.queue.len()), (40 - LONGEST_QUEUE, LONGEST_QUEUE));
}

#[test]
fn where_it_is_is_no_place_on_the_wire() {
    let encoded = |place| match encode(Command::GoTo { place, shows: None }, 0, PEER) {
        MavMessage::COMMAND_INT(data) => (data.x, data.y, data.z.is_nan(), data.param4.is_nan()),
        other => panic!("{other:?}"),
    };
    assert_eq!(encoded(None), (i32::MAX, i32::MAX, true, true));
    let place = (LatLon::new(36.5, -84.25), 500.0);
    assert_eq!(encoded(Some(place)), (365_000_000, -842_500_000, false, false));
}
