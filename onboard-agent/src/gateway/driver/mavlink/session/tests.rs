//! Whom a session listens to, and what it makes of single messages.

use super::*;
use crate::gateway::order::OrderId;

const AUTOPILOT: Sender = Sender { system: 1, component: 1 };
const GROUND: Sender = Sender { system: 255, component: 190 };
const ORDER: Client = Client::Order(OrderId(1));

struct Talk {
    session: Session,
    now: Time,
    events: Vec<SessionEvent>,
}

impl Talk {
    fn new() -> Self {
        Self { session: Session::new(&Setup::default()), now: Duration::from_secs(1), events: vec![] }
    }

    /// With an autopilot.
    fn bound() -> Self {
        let mut talk = Self::new();
        talk.hear(AUTOPILOT, &beat(false));
        assert_eq!(talk.session.peer(), Some(AUTOPILOT));
        talk.events.clear();
        talk
    }

    fn hear(&mut self, from: Sender, message: &MavMessage) {
        // the same message again is a copy
        self.now += Duration::from_millis(700);
        self.session.on_message(self.now, 0, from, message, &mut self.events);
    }

    /// What it is answered with when it asks for the time.
    fn times(&mut self) -> Vec<(i64, i64)> {
        let time = |message| match message {
            MavMessage::TIMESYNC(sync) => Some((sync.tc1, sync.ts1)),
            _ => None,
        };
        self.session.out.drain(..).filter_map(time).collect()
    }

    fn said(&self, event: &SessionEvent) -> bool {
        self.events.contains(event)
    }
}

fn beat(armed: bool) -> MavMessage {
    let base_mode = if armed { MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED } else { MavModeFlag::empty() };
    let autopilot = MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA;
    MavMessage::HEARTBEAT(HEARTBEAT_DATA { autopilot, base_mode, ..HEARTBEAT_DATA::DEFAULT })
}

fn sync(tc1: i64, ts1: i64) -> MavMessage {
    MavMessage::TIMESYNC(TIMESYNC_DATA { tc1, ts1, ..TIMESYNC_DATA::DEFAULT })
}

#[test]
fn it_binds_to_the_first_autopilot_and_to_nothing_else() {
    let mut talk = Talk::new();
    let station =
        HEARTBEAT_DATA { autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID, ..HEARTBEAT_DATA::DEFAULT };
    talk.hear(GROUND, &MavMessage::HEARTBEAT(station));
    talk.hear(Sender { system: 0, component: 1 }, &beat(false));
    assert_eq!((talk.session.peer(), talk.session.others), (None, 2));
    talk.hear(AUTOPILOT, &beat(false));
    talk.hear(Sender { system: 2, component: 1 }, &beat(false));
    assert_eq!((talk.session.peer(), talk.session.others), (Some(AUTOPILOT), 3));
}

/// It may stand on the bench, with people beside it.
#[test]
fn what_is_ordered_before_an_autopilot_is_heard_is_not_sent_to_the_next_one() {
    let mut talk = Talk::new();
    talk.session.command(talk.now, ORDER, Command::Terminate, &mut talk.events);
    assert!(matches!(&talk.events[..], [SessionEvent::Command(ORDER, Err(_))]), "{:?}", talk.events);
    (0..5).for_each(|_| talk.hear(AUTOPILOT, &beat(false)));
    let ends = |message: &MavMessage| matches!(message, MavMessage::COMMAND_LONG(c) if c.command == MavCmd::MAV_CMD_DO_FLIGHTTERMINATION);
    assert!(!talk.session.out.iter().any(ends));
}

#[test]
fn a_clock_that_asks_is_answered_before_it_has_said_whose_it_is() {
    let mut talk = Talk::new();
    talk.hear(AUTOPILOT, &sync(5, 40));
    assert_eq!(talk.times(), [], "that is an answer");
    talk.hear(AUTOPILOT, &sync(0, 41));
    let times = talk.times();
    assert!(matches!(times[..], [(own, 41)] if own > 0), "{times:?}");
    let mut talk = Talk::bound();
    talk.times();
    talk.hear(AUTOPILOT, &sync(0, 42));
    assert!(talk.times().iter().any(|(own, theirs)| *own > 0 && *theirs == 42));
    talk.hear(AUTOPILOT, &sync(7, 43));
    assert!(talk.times().iter().all(|(_, theirs)| *theirs != 43));
}

#[test]
fn in_lockstep_a_question_for_the_time_is_a_step() {
    let mut session = Session::new(&Setup { lockstep: true, ..Setup::default() });
    let mut events = vec![];
    session.on_message(Time::ZERO, 0, AUTOPILOT, &sync(0, 100), &mut events);
    assert_eq!((session.take_step(), session.take_step()), (Some(100), None));
    session.answer_step(0);
    let answer = session.out.iter().find_map(|message| match message {
        MavMessage::TIMESYNC(sync) => Some((sync.tc1, sync.ts1)),
        _ => None,
    });
    assert_eq!(answer, Some((1, 0)), "0 would be a question");
}

#[test]
fn answers_to_another_station_are_not_ours() {
    for (target_system, target_component, ours) in [
        (1, 191, true),
        (0, 0, true),
        (1, 0, true),
        (0, 191, true),
        (255, 190, false),
        (1, 190, false),
        (255, 0, false),
    ] {
        let mut talk = Talk::bound();
        let now = talk.now;
        talk.session.command(now, ORDER, Command::Speed(25.0), &mut talk.events);
        let (command, result) = (MavCmd::MAV_CMD_DO_CHANGE_SPEED, MavResult::MAV_RESULT_ACCEPTED);
        let ack = COMMAND_ACK_DATA {
            command,
            result,
            target_system,
            target_component,
            ..COMMAND_ACK_DATA::DEFAULT
        };
        talk.hear(AUTOPILOT, &MavMessage::COMMAND_ACK(ack));
        let done = talk.said(&SessionEvent::Command(ORDER, Ok(())));
        assert_eq!(done, ours, "to {target_system}/{target_component}");
    }
}

fn current(seq: u16, total: u16, mission_state: MissionState) -> MavMessage {
    MavMessage::MISSION_CURRENT(MISSION_CURRENT_DATA {
        seq,
        total,
        mission_state,
        ..MISSION_CURRENT_DATA::DEFAULT
    })
}

#[test]
fn a_current_entry_that_is_none_is_not_told() {
    let mut talk = Talk::bound();
    talk.hear(AUTOPILOT, &current(u16::MAX, 0, MissionState::MISSION_STATE_UNKNOWN));
    assert!(!talk.events.iter().any(|event| matches!(event, SessionEvent::Current(_))));
    talk.hear(AUTOPILOT, &current(4, 0, MissionState::MISSION_STATE_UNKNOWN));
    assert!(talk.said(&SessionEvent::Current(4)));
}

#[test]
fn a_list_that_is_there_and_not_accepted_is_told_once_and_so_is_its_end() {
    use MissionState::{MISSION_STATE_ACTIVE as FLOWN, MISSION_STATE_NO_MISSION as NONE};
    let mut talk = Talk::bound();
    let mut told = |total, state| {
        talk.events.clear();
        talk.hear(AUTOPILOT, &current(0, total, state));
        let unfit = |event: &SessionEvent| match event {
            SessionEvent::Telemetry(Report::ListUnfit(unfit)) => Some(*unfit),
            _ => None,
        };
        talk.events.iter().find_map(unfit)
    };
    assert_eq!((told(0, NONE), told(1, NONE), told(u16::MAX, NONE)), (None, None, None), "it has none");
    assert_eq!(
        (told(5, FLOWN), told(5, NONE), told(5, NONE), told(5, FLOWN)),
        (None, Some(true), None, Some(false))
    );
}

/// Whether it is armed only heartbeats say.
#[test]
fn a_summary_says_the_mode_while_no_heartbeats_come() {
    let summary = |custom_mode| {
        MavMessage::HIGH_LATENCY2(HIGH_LATENCY2_DATA { custom_mode, ..HIGH_LATENCY2_DATA::DEFAULT })
    };
    let modes =
        |talk: &Talk| talk.events.iter().filter(|event| matches!(event, SessionEvent::Mode(_))).count();
    let mut talk = Talk::bound();
    talk.hear(AUTOPILOT, &summary(10));
    assert_eq!(modes(&talk), 0, "a heartbeat came just now");
    talk.now += summary::BEATS_FOR;
    talk.hear(AUTOPILOT, &summary(11));
    assert!(talk.said(&SessionEvent::Mode(11)));
}

#[test]
fn nonsense_is_counted_and_logged_now_and_then() {
    let mut talk = Talk::bound();
    talk.session.ignored = 3;
    let seconds = |talk: &mut Talk, seconds: u64| {
        talk.now += Duration::from_secs(seconds);
        let now = talk.now;
        talk.session.tick(now, &mut talk.events);
        talk.session.logged_ignored.1
    };
    assert_eq!(seconds(&mut talk, 12), 3);
    talk.session.ignored = 5;
    assert_eq!(seconds(&mut talk, 2), 3, "not so soon again");
    assert_eq!(seconds(&mut talk, 9), 5);
    talk.session.receive(0, FromLink::Stream(&[0x55; 40]));
    let (now, mut events) = (talk.now, vec![]);
    assert!(!talk.session.process(now, &mut events));
    seconds(&mut talk, 12);
    let logged = talk.session.logged.1;
    assert!(logged > 0);
    talk.session.receive(0, FromLink::Stream(&[0x55; 40]));
    let now = talk.now;
    talk.session.process(now, &mut events);
    seconds(&mut talk, 2);
    assert_eq!(talk.session.logged.1, logged);
}

#[test]
fn a_datagram_with_an_autopilots_heartbeat_is_recognised() {
    use autopilot_link::frame::encode;
    let station = MavMessage::HEARTBEAT(heartbeat_of_ours());
    assert!(recognises(&encode(AUTOPILOT, 0, &beat(false)), None));
    assert!(!recognises(&encode(AUTOPILOT, 0, &station), None) && !recognises(b"hello", None));
    assert!(!recognises(&encode(AUTOPILOT, 0, &sync(0, 1)), None));
}

fn heartbeat_of_ours() -> HEARTBEAT_DATA {
    let MavMessage::HEARTBEAT(beat) = heartbeat(MavType::MAV_TYPE_GCS) else { panic!() };
    beat
}

/// Behind the one link of the autopilot comes the one of the other program.
#[test]
fn a_mirror_shows_what_the_autopilot_says_and_leads_nothing_to_it() {
    use autopilot_link::frame::encode;
    let mut session = Session::new(&Setup { mirror: true, ..Setup::default() });
    let mut events = vec![];
    let mut hear = |session: &mut Session, link, from, number: u8, message: &MavMessage| {
        session.receive(link, FromLink::Datagram(&encode(from, number, message)));
        while session.process(Time::ZERO, &mut events) {}
    };
    hear(&mut session, 0, AUTOPILOT, 0, &beat(false));
    hear(&mut session, 0, AUTOPILOT, 1, &beat(true));
    let mut outbox = Outbox::default();
    session.send(&mut outbox);
    // numbered anew: what came before it was not shown
    let shown = encode(AUTOPILOT, 0, &beat(true));
    assert!(outbox.frames_over(1).any(|frame| frame == shown));
    let arm =
        COMMAND_LONG_DATA { command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, ..COMMAND_LONG_DATA::DEFAULT };
    outbox.clear();
    hear(&mut session, 1, GROUND, 0, &MavMessage::COMMAND_LONG(arm.clone()));
    session.send(&mut outbox);
    let bytes = encode(GROUND, 0, &MavMessage::COMMAND_LONG(arm));
    assert!(outbox.frames_over(0).all(|frame| frame != bytes));
}

#[test]
fn out_of_turn_it_says_that_it_is_there() {
    let mut session = Session::new(&Setup::default());
    session.hello();
    assert!(matches!(session.out[..], [MavMessage::HEARTBEAT(_)]));
}
