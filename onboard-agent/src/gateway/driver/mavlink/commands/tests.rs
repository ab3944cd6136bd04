use super::*;

const PEER: Peer = Peer { system: 1, component: 1 };
const OLD: u32 = 10;
const WANTED: ModeNumber = ModeNumber { shown: 12, main: 12, sub: 0 };
const PILOTS: u32 = 5;
const ID: Client = Client::Order(OrderId(1));

fn at(ms: u64) -> Time {
    Time::from_millis(ms)
}

/// One command in flight, and how often it was sent.
struct Talk {
    commands: Commands,
    sent: usize,
    ended: Option<Result<(), Refusal>>,
}

impl Talk {
    /// Given at the first instant, with this shown before.
    fn begun(command: Command, armed: bool) -> Self {
        let mut talk = Self { commands: Commands::default(), sent: 0, ended: None };
        talk.shows(0, OLD, armed);
        assert_eq!(talk.commands.give(ID, command), None);
        talk.run(0..=0);
        assert_eq!(talk.sent, 1);
        talk
    }

    /// Ticks each 50 ms of these.
    fn run(&mut self, ms: impl Iterator<Item = u64>) {
        for ms in ms.filter(|ms| ms.is_multiple_of(50)) {
            let mut out = vec![];
            self.note(|commands| commands.tick(at(ms), PEER, &mut out));
            self.sent += out.len();
        }
    }

    fn note(&mut self, what: impl FnOnce(&mut Commands) -> Option<Ended>) {
        self.ended = what(&mut self.commands).map(|(_, result)| result).or(self.ended.take());
    }

    fn shows(&mut self, ms: u64, mode: u32, armed: bool) {
        self.note(|commands| commands.shown(at(ms), Shown::Mode(mode, armed)));
    }

    fn answers(&mut self, ms: u64, command: MavCmd) {
        let ack = COMMAND_ACK_DATA { command, ..COMMAND_ACK_DATA::DEFAULT };
        self.note(|commands| commands.acked(at(ms), &ack));
    }
}

/// What changes the mode: as it is ordered on ArduPlane, and as on PX4.
fn changes() -> [Command; 2] {
    [Command::Mode(WANTED), Command::GoTo { place: None, shows: Some(WANTED.shown) }]
}

#[test]
fn a_mode_that_is_shown_is_not_ordered_again_though_its_answer_was_lost() {
    for command in changes() {
        let mut talk = Talk::begun(command, true);
        talk.shows(200, WANTED.shown, true);
        assert_eq!(talk.ended, Some(Ok(())), "{command:?}");
        talk.shows(500, PILOTS, true);
        let sent = talk.sent;
        talk.run(500..=20_000);
        assert_eq!(talk.sent, sent, "{command:?}: the pilot keeps it");
    }
}

#[test]
fn a_third_mode_is_the_pilots_whether_the_order_was_answered_or_not() {
    let changes = changes().into_iter().chain([Command::GoTo { place: None, shows: None }]);
    for (command, answered) in changes.flat_map(|command| [(command, false), (command, true)]) {
        let mut talk = Talk::begun(command, true);
        if answered && is_seen(command) {
            talk.answers(20, number(command));
        }
        talk.shows(300, PILOTS, true);
        let why = talk.ended.clone().unwrap().unwrap_err().why;
        assert!(why.contains("somebody else"), "{why}");
        talk.answers(310, number(command));
        let sent = talk.sent;
        talk.run(300..=20_000);
        assert_eq!(talk.sent, sent, "{command:?}");
    }
}

#[test]
fn a_change_of_mode_is_sent_again_only_where_the_old_one_is_still_shown_or_nothing_is() {
    let mut talk = Talk::begun(Command::Mode(WANTED), true);
    talk.run(50..=900);
    assert_eq!(talk.sent, 1, "somebody may have taken over meanwhile");
    talk.shows(900, OLD, true);
    talk.run(950..=2000);
    assert_eq!(talk.sent, 3, "once, in two copies, for the link has lost something");
    let mut blind = Talk::begun(Command::Mode(WANTED), true);
    blind.run(50..=60_000);
    let why = blind.ended.unwrap().unwrap_err().why;
    assert!(blind.sent > 20 && why.contains("did not answer"), "{} {why}", blind.sent);
}

#[test]
fn what_does_not_change_the_mode_is_sent_again_at_once() {
    let mut talk = Talk::begun(Command::Speed(25.0), true);
    talk.run(50..=900);
    assert!(talk.sent > 1);
}

#[test]
fn who_is_shown_armed_is_not_armed_again() {
    let mut talk = Talk::begun(Command::Arm, false);
    talk.shows(200, OLD, true);
    assert_eq!(talk.ended, Some(Ok(())));
    talk.shows(500, OLD, false);
    let sent = talk.sent;
    talk.run(500..=20_000);
    assert_eq!(talk.sent, sent, "he who disarmed it is not overruled");
}

/// It was in that mode before: only its answer says that it got the order.
#[test]
fn what_was_so_before_is_no_effect() {
    let mut talk = Talk::begun(Command::Mode(ModeNumber { shown: OLD, main: 10, sub: 0 }), true);
    talk.shows(200, OLD, true);
    assert_eq!(talk.ended, None);
    talk.answers(300, MavCmd::MAV_CMD_DO_SET_MODE);
    talk.shows(400, OLD, true);
    assert_eq!(talk.ended, Some(Ok(())));
}
