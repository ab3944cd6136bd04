//! The links to the autopilot: what comes over them, how they do, and over which it is spoken.
//!
//! It is spoken over one, the first that is alive: an autopilot that gets parts of one transfer over two links mixes them up.
//! All are listened to, and a message that comes over several is taken once. But another link may be seconds slower, and what
//! it brings true no more: over it only answers are taken, and what says that it is newer than what was known.

use super::Peer;
use super::clocks::{Clock, Newest, stamp};
use super::statistics::Statistics;
use super::unknown::Unknown;
use crate::gateway::driver::FromLink;
use crate::gateway::order::Time;
use autopilot_link::Outbox;
use autopilot_link::frame::{Decoder, Frame, encode_into};
use autopilot_link::signing::Signing;
use mavlink::dialects::ardupilotmega::{MavMessage, TIMESYNC_DATA};
use std::collections::VecDeque;
use std::time::Duration;
use usal::contract::{AutopilotLink, AutopilotLinks};

/// A link over which the autopilot was not heard for so long is dead. Its heartbeat alone comes once a second.
const DEAD: Duration = Duration::from_millis(1600);
/// A preferred link has to be alive for so long before it is spoken over again.
const STEADY: Duration = Duration::from_secs(3);
/// The same message over another link comes within this.
const COPY: Duration = Duration::from_millis(500);
/// Messages that are remembered to know their copies.
const REMEMBERED: usize = 512;
/// Refused messages are logged at most this often.
const LOG_EVERY: Duration = Duration::from_secs(10);
/// A link that is slower than the one before it is waited for at most so long, until it brings what is newer.
const MOST_LAG: Duration = Duration::from_secs(5);

/// A link.
#[derive(Debug, Default)]
struct Link {
    /// Its address, as it was given.
    address: String,
    decoder: Decoder,
    statistics: Statistics,
    /// When the autopilot was heard over it.
    heard: Option<Time>,
    /// Since when it has been alive.
    alive_since: Option<Time>,
    /// The autopilot's clock as it came over it.
    clock: Clock,
    /// Messages that were not believed.
    refused: u64,
    /// Number of the next frame over it.
    sequence: u8,
    /// The autopilot is to be asked for its time with this.
    question: Option<i64>,
}

impl Link {
    fn is_alive(&self, now: Time) -> bool {
        self.heard.is_some_and(|heard| now.saturating_sub(heard) < DEAD)
    }

    fn hear(&mut self, now: Time, message: Option<&MavMessage>) {
        if !self.is_alive(now) {
            self.alive_since = Some(now);
        }
        self.heard = Some(now);
        if let Some(stamp) = message.and_then(stamp) {
            self.clock.read(stamp);
        }
    }

    fn is_steady(&self, now: Time) -> bool {
        self.is_alive(now) && self.alive_since.is_some_and(|since| now.saturating_sub(since) >= STEADY)
    }

    fn send(&mut self, to: &mut Sending<'_>, number: usize, message: &MavMessage) {
        let Sending { now, own, signing, outbox } = to;
        outbox.push_over(number, |bytes| {
            let before = bytes.len();
            encode_into(*own, self.sequence, message, bytes);
            if let Some(signing) = signing {
                signing.sign(*now, u8::try_from(number).unwrap_or(u8::MAX), bytes, before);
            }
            self.statistics.sent(bytes.len() - before);
        });
        self.sequence = self.sequence.wrapping_add(1);
    }
}

/// How and where to messages are sent.
struct Sending<'a> {
    now: Time,
    /// Who we are.
    own: Peer,
    signing: &'a mut Option<Signing>,
    outbox: &'a mut Outbox,
}

/// The links. See the module's text.
#[derive(Debug)]
pub struct Links {
    links: Vec<Link>,
    /// The one that is spoken over.
    used: usize,
    /// From then on it brings what is newer than what came over the one before.
    fresh_at: Time,
    /// What was taken of all of them.
    newest: Newest,
    /// Who is at their other end, once it was heard.
    autopilot: Option<Peer>,
    /// What came lately, of several links.
    copies: Copies,
    signing: Option<Signing>,
    unknown: Unknown,
    /// When refused messages were logged, and how many there were.
    logged: (Time, u64),
}

impl Default for Links {
    fn default() -> Self {
        Self::new(&[], None)
    }
}

/// A message that came.
#[derive(Debug, Clone, PartialEq)]
pub struct Received {
    /// Over which link.
    pub link: usize,
    /// Who sent it.
    pub sender: Peer,
    /// What it says; `None`: it has a value that the dialect does not know.
    pub message: Option<MavMessage>,
}

impl Links {
    /// Links at these addresses; one without, if there is none.
    pub fn new(addresses: &[String], signing: Option<Signing>) -> Self {
        let link = |address: &String| Link { address: address.clone(), ..Link::default() };
        let mut links: Vec<Link> = addresses.iter().map(link).collect();
        if links.is_empty() {
            links.push(Link::default());
        }
        Self {
            links,
            used: 0,
            fresh_at: Time::ZERO,
            newest: Newest::default(),
            autopilot: None,
            copies: Copies::default(),
            signing,
            unknown: Unknown::default(),
            logged: (Time::ZERO, 0),
        }
    }

    /// Takes in what a link brought.
    pub fn receive(&mut self, link: usize, from: FromLink<'_>) {
        let Some(Link { decoder, .. }) = self.links.get_mut(link) else { return };
        match from {
            FromLink::Connected => decoder.restart(),
            FromLink::Stream(bytes) => decoder.push(bytes),
            FromLink::Datagram(bytes) => decoder.push_datagram(bytes),
        }
    }

    /// The next message of what was received; `pass` is given its frame, and those of messages that the dialect does not have.
    pub fn next(&mut self, now: Time, mut pass: impl FnMut(&Frame<'_>)) -> Option<Received> {
        let several = self.links.len() > 1;
        for (number, link) in self.links.iter_mut().enumerate() {
            while let Some(frame) = link.decoder.next_frame() {
                let (sender, message) = (frame.sender, frame.message());
                // a copy has the stamp of the first, and is signed as well
                let signed = |signing: &Signing| signing.key().has_signed(&frame);
                if several
                    && self.copies.contains(now, number, &frame)
                    && self.signing.as_ref().is_none_or(signed)
                {
                    link.statistics.received(&frame);
                    if self.autopilot == Some(sender) {
                        link.hear(now, message.as_ref());
                    }
                    continue;
                }
                if self.signing.as_mut().is_some_and(|signing| !signing.believes(now, &frame)) {
                    link.refused += 1;
                    continue;
                }
                link.statistics.received(&frame);
                // what is not taken over this link must not stand in the way of its copy over the one in use
                let counts = number == self.used || message.as_ref().is_some_and(counts_over_any);
                if several && counts {
                    self.copies.add(now, number, &frame);
                }
                if counts {
                    pass(&frame);
                }
                if message.is_some() || !self.unknown.is(frame.id) {
                    return Some(Received { link: number, sender, message });
                }
            }
        }
        None
    }

    /// So many.
    pub fn count(&self) -> usize {
        self.links.len()
    }

    /// The autopilot was heard. True: what it said is to be taken in, as it is the newest that is known.
    pub fn heard(&mut self, now: Time, link: usize, autopilot: Peer, message: &MavMessage) -> bool {
        self.autopilot = Some(autopilot);
        let used = link == self.used;
        let Some(link) = self.links.get_mut(link) else { return false };
        link.hear(now, Some(message));
        match stamp(message) {
            Some(stamp) => self.newest.takes(stamp, &link.clock, used),
            None => counts_over_any(message) || (used && now >= self.fresh_at),
        }
    }

    /// The autopilot started anew; said once.
    pub fn take_reboot(&mut self) -> bool {
        self.newest.take_reboot()
    }

    /// Speaks over the first link that is alive. `busy`: something goes on that only a dead link may interrupt. True: another one
    /// than before.
    pub fn choose(&mut self, now: Time, busy: bool) -> bool {
        let used_alive = self.links.get(self.used).is_some_and(|link| link.is_alive(now));
        let best = if used_alive {
            self.links.iter().take(self.used).position(|link| !busy && link.is_steady(now))
        } else {
            self.links.iter().position(|link| link.is_alive(now))
        };
        let Some(best) = best.filter(|best| *best != self.used) else { return false };
        let address = |link: usize| self.links.get(link).map_or("", |link| link.address.as_str());
        tracing::warn!(
            from = address(self.used),
            to = address(best),
            "another link to the autopilot is used"
        );
        self.use_link(now, best);
        true
    }

    fn use_link(&mut self, now: Time, number: usize) {
        let before = self.links.get(self.used).map_or_else(Clock::default, |link| link.clock);
        self.used = number;
        if let Some(link) = self.links.get_mut(number) {
            self.fresh_at = now + link.clock.behind(&before).min(MOST_LAG);
            self.newest.follow(&mut link.clock);
        }
    }

    /// The autopilot answered a question for its time.
    pub fn time_answered(&mut self, now: Time, link: usize, asked: i64) {
        if let Some(link) = self.links.get_mut(link) {
            link.statistics.time_answered(now, asked);
        }
    }

    /// The autopilot's clock as it is known, ms since it started.
    pub fn clock_ms(&self) -> u32 {
        self.newest.ms()
    }

    /// How long it is there and back over the one that is spoken over.
    pub fn round_trip(&self) -> Option<Duration> {
        self.links.get(self.used).and_then(|link| link.statistics.round_trip())
    }

    /// Asks the autopilot for its time over each: the answers tell how long they take.
    pub fn ask_time(&mut self, now: Time) {
        for (number, link) in self.links.iter_mut().enumerate() {
            link.question = Some(link.statistics.ask_time(now, number));
        }
    }

    /// Hands over the frames of messages to be sent, and of questions; that we are here is said over each link. `own`: who we are.
    pub fn send(
        &mut self,
        now: Time,
        own: Peer,
        to: Option<Peer>,
        messages: &mut Vec<MavMessage>,
        outbox: &mut Outbox,
    ) {
        let mut sending = Sending { now, own, signing: &mut self.signing, outbox };
        for message in messages.drain(..) {
            let everywhere = matches!(message, MavMessage::HEARTBEAT(_));
            for (number, link) in self.links.iter_mut().enumerate() {
                if everywhere || number == self.used {
                    link.send(&mut sending, number, &message);
                }
            }
        }
        for (number, link) in self.links.iter_mut().enumerate() {
            if let (Some(question), Some(to)) = (link.question.take(), to) {
                link.send(&mut sending, number, &ask_time(question, to));
            }
        }
    }

    /// How each does; once a second.
    pub fn figures(&mut self, now: Time) -> AutopilotLinks {
        let used = self.used;
        let figures = |(number, link): (usize, &mut Link)| AutopilotLink {
            address: link.address.clone(),
            alive: link.is_alive(now),
            in_use: number == used,
            refused: link.refused,
            ..link.statistics.figures(now, link.decoder.bad_frames)
        };
        AutopilotLinks { links: self.links.iter_mut().enumerate().map(figures).collect() }
    }

    /// Tells in the log of messages that were refused.
    pub fn log_refused(&mut self, now: Time) {
        let refused = self.links.iter().map(|link| link.refused).sum();
        if refused > self.logged.1 && now >= self.logged.0 + LOG_EVERY {
            tracing::warn!(
                refused,
                "messages were refused: they are not signed with the key of --signing-key, or were sent before"
            );
            self.logged = (now, refused);
        }
    }

    /// Bytes that were no frames.
    pub fn ignored_bytes(&self) -> u64 {
        self.links.iter().map(|link| link.decoder.ignored_bytes).sum()
    }
}

/// The messages that came lately, to know those that come again over another link.
#[derive(Debug, Default)]
struct Copies(VecDeque<Seen>);

#[derive(Debug)]
struct Seen {
    at: Time,
    link: usize,
    /// Sender, number, checksum.
    frame: (Peer, u8, u16),
}

impl Copies {
    /// It came over another link a moment ago.
    fn contains(&mut self, now: Time, link: usize, frame: &Frame<'_>) -> bool {
        let young = |seen: &Seen| now.saturating_sub(seen.at) < COPY;
        while self.0.front().is_some_and(|seen| !young(seen)) || self.0.len() >= REMEMBERED {
            self.0.pop_front();
        }
        let frame = (frame.sender, frame.sequence, frame.checksum);
        self.0.iter().any(|seen| seen.link != link && seen.frame == frame)
    }

    fn add(&mut self, now: Time, link: usize, frame: &Frame<'_>) {
        let frame = (frame.sender, frame.sequence, frame.checksum);
        self.0.push_back(Seen { at: now, link, frame });
    }
}

/// Over whichever link it comes: an answer is as good when it comes late, and what has a stamp is known for what it is.
fn counts_over_any(message: &MavMessage) -> bool {
    use MavMessage::*;
    matches!(message, COMMAND_ACK(_) | STATUSTEXT(_) | PARAM_VALUE(_) | TIMESYNC(_))
        || stamp(message).is_some()
}

fn ask_time(question: i64, to: Peer) -> MavMessage {
    let (target_system, target_component) = (to.system, to.component);
    MavMessage::TIMESYNC(TIMESYNC_DATA { tc1: 0, ts1: question, target_system, target_component })
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavlink::dialects::ardupilotmega::HEARTBEAT_DATA;

    const AUTOPILOT: Peer = Peer { system: 1, component: 1 };

    #[test]
    fn a_preferred_link_that_is_back_waits_until_it_is_steady_and_nothing_goes_on() {
        let mut links = Links::new(&["a".into(), "b".into()], None);
        let beat = MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT);
        let mut used = vec![];
        for second in 0..20 {
            let now = Time::from_secs(second);
            links.heard(now, 1, AUTOPILOT, &beat);
            // the first one is silent from 3 to 6
            if !(3..=6).contains(&second) {
                links.heard(now, 0, AUTOPILOT, &beat);
            }
            links.choose(now, second < 15);
            used.push(links.used);
        }
        let expected: Vec<usize> = (0..20).map(|second| usize::from((4..15).contains(&second))).collect();
        assert_eq!(used, expected);
    }
}
