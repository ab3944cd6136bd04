//! Shell: the links to the autopilot, together.

use super::service::Input;
use super::tlog::Tlog;
use autopilot_link::{Event, Link, Outbox};
use std::future::{Future, poll_fn};
use std::task::Poll;

/// Says of a datagram whether it is from the autopilot; one for each link.
pub type Recognises = Box<dyn FnMut(&[u8]) -> bool + Send + Sync>;

/// The links, each with who recognises its partner, and what it brought last.
pub struct Links {
    links: Vec<(Link, Recognises, Vec<u8>)>,
    /// The one that is looked at first, next time: none has to wait for the others.
    first: usize,
    tlog: Option<Tlog>,
}

impl Links {
    /// Around links.
    pub fn new(links: Vec<Link>, recognises: impl Fn() -> Recognises, tlog: Option<Tlog>) -> Self {
        let links = links.into_iter().map(|link| (link, recognises(), Vec::new())).collect();
        Self { links, first: 0, tlog }
    }

    /// What happens next on any of them. May be dropped and called again at any time.
    pub async fn event(&mut self) -> Input {
        let (number, event) = self.first_event().await;
        // the bytes go on to the driver as they are, and the next ones get a buffer of their own
        let bytes = self.links.get_mut(number).map(|(.., bytes)| std::mem::take(bytes)).unwrap_or_default();
        if let Some(tlog) = &mut self.tlog {
            tlog.received(number, event, &bytes);
        }
        Input::Received(number, event, bytes)
    }

    async fn first_event(&mut self) -> (usize, Event) {
        if let [(link, recognises, bytes)] = &mut self.links[..] {
            return (0, link.next(bytes, recognises).await);
        }
        let count = self.links.len().max(1);
        let first = self.first % count;
        self.first = first + 1;
        let links = self.links.iter_mut();
        let mut waits: Vec<_> =
            links.map(|(link, recognises, bytes)| Box::pin(link.next(bytes, recognises))).collect();
        poll_fn(|context| {
            for number in (first..count).chain(0..first) {
                let Some(wait) = waits.get_mut(number) else { continue };
                if let Poll::Ready(event) = wait.as_mut().poll(context) {
                    return Poll::Ready((number, event));
                }
            }
            Poll::Pending
        })
        .await
    }

    /// Sends frames, each over its link.
    pub fn send(&mut self, outbox: &Outbox) {
        for (number, (link, ..)) in self.links.iter_mut().enumerate() {
            link.send_all(number, outbox);
            if let Some(tlog) = &mut self.tlog {
                tlog.sent(number, outbox.frames_over(number));
            }
        }
    }
}
