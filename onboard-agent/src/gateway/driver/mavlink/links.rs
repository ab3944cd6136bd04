//! The links to the autopilot: what comes over them, how they do, and over which it is spoken.

use super::Peer;
use super::statistics::Statistics;
use crate::gateway::driver::FromLink;
use crate::gateway::order::Time;
use autopilot_link::Outbox;
use autopilot_link::frame::{Decoder, encode_into};
use mavlink::dialects::ardupilotmega::{MavMessage, TIMESYNC_DATA};
use std::time::Duration;
use usal::contract::{AutopilotLink, AutopilotLinks};

/// A link is alive when the autopilot was heard over it within this.
const ALIVE: Duration = Duration::from_secs(2);

/// A link.
#[derive(Debug, Default)]
struct Link {
    /// Its address, as it was given.
    address: String,
    decoder: Decoder,
    statistics: Statistics,
    /// When the autopilot was heard over it.
    heard: Option<Time>,
    /// Number of the next frame over it.
    sequence: u8,
    /// The autopilot is to be asked for its time with this.
    question: Option<i64>,
}

impl Link {
    fn is_alive(&self, now: Time) -> bool {
        self.heard.is_some_and(|heard| now.saturating_sub(heard) < ALIVE)
    }

    fn send(&mut self, own: Peer, message: &MavMessage, outbox: &mut Outbox) {
        outbox.push(|bytes| {
            let before = bytes.len();
            encode_into(own, self.sequence, message, bytes);
            self.statistics.sent(bytes.len() - before);
        });
        self.sequence = self.sequence.wrapping_add(1);
    }
}

/// The links. See the module's text.
#[derive(Debug)]
pub struct Links(Vec<Link>);

impl Default for Links {
    fn default() -> Self {
        Self::new(&[])
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
    pub fn new(addresses: &[String]) -> Self {
        let link = |address: &String| Link { address: address.clone(), ..Link::default() };
        let mut links: Vec<Link> = addresses.iter().map(link).collect();
        if links.is_empty() {
            links.push(Link::default());
        }
        Self(links)
    }

    /// Takes in what a link brought.
    pub fn receive(&mut self, link: usize, from: FromLink<'_>) {
        let Some(Link { decoder, .. }) = self.0.get_mut(link) else { return };
        match from {
            FromLink::Connected => decoder.restart(),
            FromLink::Stream(bytes) => decoder.push(bytes),
            FromLink::Datagram(bytes) => decoder.push_datagram(bytes),
        }
    }

    /// The next message of what was received.
    pub fn next(&mut self) -> Option<Received> {
        for (number, link) in self.0.iter_mut().enumerate() {
            if let Some(frame) = link.decoder.next_frame() {
                link.statistics.received(&frame);
                return Some(Received { link: number, sender: frame.sender, message: frame.message() });
            }
        }
        None
    }

    /// The autopilot was heard.
    pub fn heard(&mut self, now: Time, link: usize) {
        if let Some(link) = self.0.get_mut(link) {
            link.heard = Some(now);
        }
    }

    /// The autopilot answered a question for its time.
    pub fn time_answered(&mut self, now: Time, link: usize, asked: i64) {
        if let Some(link) = self.0.get_mut(link) {
            link.statistics.time_answered(now, asked);
        }
    }

    /// Asks the autopilot for its time over each: the answers tell how long they take.
    pub fn ask_time(&mut self, now: Time) {
        for (number, link) in self.0.iter_mut().enumerate() {
            link.question = Some(link.statistics.ask_time(now, number));
        }
    }

    /// Hands over the frames of messages to be sent, and of questions. `own`: who we are.
    pub fn send(&mut self, own: Peer, to: Option<Peer>, messages: &mut Vec<MavMessage>, outbox: &mut Outbox) {
        for message in messages.drain(..) {
            if let Some(link) = self.0.first_mut() {
                link.send(own, &message, outbox);
            }
        }
        for link in &mut self.0 {
            if let (Some(question), Some(to)) = (link.question.take(), to) {
                link.send(own, &ask_time(question, to), outbox);
            }
        }
    }

    /// How each does; once a second.
    pub fn figures(&mut self, now: Time) -> AutopilotLinks {
        let figures = |(number, link): (usize, &mut Link)| AutopilotLink {
            address: link.address.clone(),
            alive: link.is_alive(now),
            in_use: number == 0,
            ..link.statistics.figures(now, link.decoder.bad_frames)
        };
        AutopilotLinks { links: self.0.iter_mut().enumerate().map(figures).collect() }
    }

    /// Bytes that were no frames.
    pub fn ignored_bytes(&self) -> u64 {
        self.0.iter().map(|link| link.decoder.ignored_bytes).sum()
    }
}

fn ask_time(question: i64, to: Peer) -> MavMessage {
    let (target_system, target_component) = (to.system, to.component);
    MavMessage::TIMESYNC(TIMESYNC_DATA { tc1: 0, ts1: question, target_system, target_component })
}
