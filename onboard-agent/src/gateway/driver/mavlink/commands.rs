//! Commands: sent until acknowledged, and done when the autopilot shows that it obeyed.
//!
//! Whoever takes over right after one must not be overruled by its repetition. So an order that changes the mode is sent again only
//! where the autopilot still shows the mode before it: one that shows the ordered mode has obeyed, whatever became of its answer, and
//! one that shows a third mode has been given another order by somebody else.

mod frames;
mod late;
#[cfg(test)]
mod late_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod word_by_word_tests;

use super::Peer;
use super::rto::Rto;
use crate::gateway::order::{OrderId, Time};
use frames::{encode, number};
use geometry::LatLon;
use late::LateAnswers;
use mavlink::dialects::ardupilotmega::*;
use std::collections::VecDeque;
use std::time::Duration;

/// Times that a command is sent.
const TRIES: u32 = 16;
/// An acknowledged command has to show its effect within this, as soon as the autopilot shows anything.
const EFFECT: Duration = Duration::from_secs(3);
/// On a link that loses so much that nothing is shown, it is waited for so long.
const UNSEEN: Duration = Duration::from_secs(15);
/// A mode that was not shown for so long is ordered again blindly: heartbeats come once a second.
const BLIND: Duration = Duration::from_millis(1600);
/// Commands that wait; more than the core ever gives.
const LONGEST_QUEUE: usize = 32;

/// Who gets the result of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Client {
    /// The core, which gave this order.
    Order(OrderId),
    /// The driver itself, for the list.
    List,
    /// Nobody: the driver said again what the autopilot had forgotten.
    Nobody,
    /// Nobody: it makes what does not take off stand, and is taken back with that.
    Standing,
}

/// A command to be given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Steer to an entry of the list.
    Current(u16),
    /// The same for an autopilot that is told so by a message, and does not answer that.
    Select(u16),
    /// Change mode.
    Mode(ModeNumber),
    /// Arm.
    Arm,
    /// Disarm; in flight it refuses that.
    Disarm,
    /// Airspeed, m/s.
    Speed(f64),
    /// Go to a place, metres AMSL, and circle there; `None`: where it is. `shows`: the mode in which it does so, if it
    /// has to be entered.
    GoTo {
        /// Where.
        place: Option<(LatLon, f64)>,
        /// What it shows then.
        shows: Option<u32>,
    },
    /// End the flight by the autopilot's own means.
    Terminate,
    /// Stop the engine, whatever the state.
    ForceDisarm,
}

/// A mode, as it is ordered and as it is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModeNumber {
    /// In a heartbeat.
    pub shown: u32,
    /// In a command: the mode.
    pub main: u8,
    /// In a command: what kind of it; 0: there are no kinds.
    pub sub: u8,
}

/// What the autopilot shows that may be the effect of a command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shown {
    /// The entry it steers to.
    Current(u16),
    /// Mode and arming.
    Mode(u32, bool),
}

#[derive(Debug, Clone)]
struct Given {
    client: Client,
    command: Command,
    /// How often it was sent, in one copy or two: only what was sent once measures the way there and back.
    rounds: u32,
    /// How often that was in vain or may be, since its answer would count: not for ever.
    tries: u32,
    /// Answers that may still come: one to each copy.
    owed: u32,
    acked: Option<Time>,
    /// When it was sent first.
    sent: Time,
    /// When it was sent last.
    sent_last: Time,
    /// Mode and arming as they were shown before it.
    before: Option<(u32, bool)>,
    /// The mode before was shown since then.
    is_as_before: bool,
    /// The opposite of its effect was shown before it, or since: what is shown now came of it, though its answer was not heard.
    was_otherwise: bool,
}

impl Given {
    fn new(client: Client, command: Command, before: Option<(u32, bool)>, now: Time) -> Self {
        let (rounds, tries, owed, acked, sent, sent_last) = (0, 0, 0, None, now, now);
        let (is_as_before, was_otherwise) = (false, false);
        let mut given = Self {
            client,
            command,
            rounds,
            tries,
            owed,
            acked,
            sent,
            sent_last,
            before,
            is_as_before,
            was_otherwise,
        };
        before.into_iter().for_each(|(mode, armed)| given.notes(Shown::Mode(mode, armed)));
        given
    }

    /// Once more. `counts`: its answer would be told from those to other orders.
    fn send(&mut self, now: Time, peer: Peer, copies: usize, counts: bool, out: &mut Vec<MavMessage>) {
        let message = encode(self.command, u8::try_from(self.rounds).unwrap_or(u8::MAX), peer);
        for _ in 0..copies {
            out.push(message.clone());
            self.owed += u32::from(is_answered(self.command));
        }
        self.rounds += 1;
        self.tries += u32::from(counts);
        (self.sent_last, self.is_as_before) = (now, false);
    }

    fn notes(&mut self, shown: Shown) {
        let is_state = matches!(shown, Shown::Mode(..));
        self.was_otherwise |= is_state && self.is_obeyed(shown) == Some(false);
    }

    /// Before that it is not sent again: somebody might be overruled.
    fn waits_until(&self) -> Option<Time> {
        (changes_mode(self.command) && !self.is_as_before).then(|| self.sent_last + BLIND)
    }

    /// What is shown is its effect, or is not; `None`: says nothing of it.
    fn is_obeyed(&self, shown: Shown) -> Option<bool> {
        Some(match (self.command, shown) {
            (Command::Current(wanted) | Command::Select(wanted), Shown::Current(seq)) => wanted == seq,
            (Command::Mode(wanted), Shown::Mode(mode, _)) => wanted.shown == mode,
            (Command::GoTo { shows: Some(wanted), .. }, Shown::Mode(mode, _)) => wanted == mode,
            (Command::Arm, Shown::Mode(_, armed)) => armed,
            (Command::Disarm | Command::Terminate | Command::ForceDisarm, Shown::Mode(_, armed)) => !armed,
            _ => return None,
        })
    }

    /// It shows neither the mode before nor the one that was ordered: somebody else has chosen it.
    fn is_overruled(&self, shown: Shown) -> bool {
        let (Shown::Mode(mode, _), Some((before, _))) = (shown, self.before) else { return false };
        let wanted = match self.command {
            Command::Mode(wanted) => wanted.shown,
            Command::GoTo { shows, .. } => shows.unwrap_or(before),
            _ => return false,
        };
        mode != before && mode != wanted
    }
}

/// The queue of commands; one is in flight at a time.
#[derive(Debug, Clone, Default)]
pub struct Commands {
    queue: VecDeque<(Client, Command)>,
    flight: Option<Given>,
    late: LateAnswers,
    rto: Rto,
    /// Mode and arming as they were shown last.
    seen: Option<(u32, bool)>,
}

/// Why a command was not carried out.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// In words.
    pub why: String,
    /// The autopilot says that it may be carried out later.
    pub for_now: bool,
    /// The autopilot says so. If not, the command may still be carried out.
    pub is_answer: bool,
}

impl From<String> for Refusal {
    fn from(why: String) -> Self {
        Self { why, for_now: false, is_answer: false }
    }
}

/// How a command ended.
pub type Ended = (Client, Result<(), Refusal>);

impl Commands {
    /// Takes a command.
    pub fn give(&mut self, client: Client, command: Command) -> Option<Ended> {
        if self.queue.len() >= LONGEST_QUEUE && !is_urgent(command) {
            return Some((client, Err(Refusal::from("too many commands are waiting".to_string()))));
        }
        if !is_urgent(command) {
            self.queue.push_back((client, command));
            return None;
        }
        // it does not wait behind what is not, nor for the answer to that
        self.queue.push_front((client, command));
        let less = self.flight.take_if(|given| !is_urgent(given.command))?;
        self.expect_late(&less);
        let why = format!("{command:?} came before the autopilot had done {:?}", less.command);
        Some((less.client, Err(why.into())))
    }

    /// What is not to be carried out any more is not sent again.
    pub fn take_back(&mut self, client: Client) {
        self.queue.retain(|(of, _)| *of != client);
        if let Some(given) = self.flight.take_if(|given| given.client == client) {
            self.expect_late(&given);
        }
    }

    /// It is over, and may still be answered.
    fn expect_late(&mut self, given: &Given) {
        if given.owed > 0 {
            self.late.expect(number(given.command), given.sent_last, given.owed);
        }
    }

    /// Not every autopilot is set up to end a flight; the engine can be stopped on all. That is sent next.
    fn disarm_by_force(&mut self) -> Option<Ended> {
        let given = self.flight.take()?;
        self.expect_late(&given);
        self.queue.push_front((given.client, Command::ForceDisarm));
        None
    }

    /// How long it is there and back.
    pub fn knows_trip(&mut self, trip: Option<Duration>) {
        self.rto.knows_trip(trip);
    }

    /// Time passed: the next command, or the same again.
    pub fn tick(&mut self, now: Time, peer: Peer, out: &mut Vec<MavMessage>) -> Option<Ended> {
        let ended = self.check(now, peer, out);
        if self.flight.is_none()
            && let Some((client, command)) = self.queue.pop_front()
        {
            let counts = !self.late.may_be(now, number(command));
            let given = self.flight.insert(Given::new(client, command, self.seen, now));
            given.send(now, peer, self.rto.copies(), counts, out);
            self.rto.start(now);
        }
        ended
    }

    fn check(&mut self, now: Time, peer: Peer, out: &mut Vec<MavMessage>) -> Option<Ended> {
        let given = self.flight.as_mut()?;
        match given.acked {
            Some(at) if now >= at + UNSEEN => {
                let why = format!(
                    "the autopilot accepted {:?} and has not shown since whether it did it",
                    given.command
                );
                self.end(Err(why.into()))
            }
            Some(_) => None,
            None if given.waits_until().is_some_and(|until| now < until) || !self.rto.expired(now) => None,
            None if given.tries >= TRIES => {
                let why = format!("the autopilot did not answer {:?}", given.command);
                self.end(Err(why.into()))
            }
            None => {
                // as long as its answers can't be told from another's, it is not given up for want of one
                let counts = !self.late.may_be(now, number(given.command));
                given.send(now, peer, self.rto.copies(), counts, out);
                None
            }
        }
    }

    fn end(&mut self, result: Result<(), Refusal>) -> Option<Ended> {
        let given = self.flight.take()?;
        self.expect_late(&given);
        Some((given.client, result))
    }

    /// The autopilot answers a command.
    pub fn acked(&mut self, now: Time, ack: &COMMAND_ACK_DATA) -> Option<Ended> {
        let is_last = ack.result != MavResult::MAV_RESULT_IN_PROGRESS;
        if self.late.takes(now, ack.command, is_last) {
            return None;
        }
        let given = self.flight.as_mut().filter(|given| ack.command == number(given.command))?;
        given.owed = given.owed.saturating_sub(u32::from(is_last));
        if given.acked.is_some() {
            return None;
        }
        if given.rounds == 1 {
            self.rto.sample(now.saturating_sub(given.sent));
        }
        match ack.result {
            MavResult::MAV_RESULT_IN_PROGRESS => None,
            MavResult::MAV_RESULT_ACCEPTED => {
                given.acked = Some(now);
                if is_seen(given.command) { None } else { self.end(Ok(())) }
            }
            refused if given.command == Command::Terminate => {
                tracing::warn!(?refused, "flight termination refused, disarming by force");
                self.disarm_by_force()
            }
            refused => {
                let why = format!("the autopilot refused {:?}: {refused:?}", given.command);
                let for_now = refused == MavResult::MAV_RESULT_TEMPORARILY_REJECTED;
                self.end(Err(Refusal { why, for_now, is_answer: true }))
            }
        }
    }

    /// The autopilot shows something that may be a command's effect.
    pub fn shown(&mut self, now: Time, shown: Shown) -> Option<Ended> {
        if let Shown::Mode(mode, armed) = shown {
            self.seen = Some((mode, armed));
        }
        let given = self.flight.as_mut()?;
        if given.is_overruled(shown) {
            let why = format!("the mode was changed by somebody else while {:?} was ordered", given.command);
            return self.end(Err(why.into()));
        }
        given.is_as_before |= matches!(shown, Shown::Mode(..));
        given.notes(shown);
        match (given.is_obeyed(shown)?, given.acked) {
            (true, acked) if acked.is_some() || given.was_otherwise || !is_answered(given.command) => {
                self.end(Ok(()))
            }
            (false, Some(at)) if now >= at + EFFECT && given.command == Command::Terminate => {
                tracing::warn!("flight termination accepted and not done, disarming by force");
                self.disarm_by_force()
            }
            (false, Some(at)) if now >= at + EFFECT => {
                let why = format!("the autopilot accepted {:?} and did not do it", given.command);
                self.end(Err(why.into()))
            }
            _ => None,
        }
    }
}

fn is_urgent(command: Command) -> bool {
    matches!(command, Command::Terminate | Command::ForceDisarm)
}

/// It takes the aircraft from whoever has chosen another mode.
fn changes_mode(command: Command) -> bool {
    matches!(command, Command::Mode(_) | Command::GoTo { .. })
}

/// The autopilot says whether it was taken.
fn is_answered(command: Command) -> bool {
    !matches!(command, Command::Select(_))
}

/// The command has an effect that the autopilot shows.
fn is_seen(command: Command) -> bool {
    matches!(
        command,
        Command::Current(_)
            | Command::Select(_)
            | Command::Mode(_)
            | Command::Arm
            | Command::Disarm
            | Command::Terminate
            | Command::ForceDisarm
            | Command::GoTo { shows: Some(_), .. }
    )
}
