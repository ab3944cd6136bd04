//! Between the map and the threads that read tiles: what is wanted lies on a desk, what is done goes back in a short queue.

use super::{Answer, Health, Reader, Wanted};
use std::collections::HashSet;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};

/// So many tiles wait to be shown; who reads more waits.
const QUEUE: usize = 8;

/// A tile that was wanted.
#[derive(Debug)]
pub struct Done {
    /// Which.
    pub wanted: Wanted,
    /// What became of it.
    pub answer: Answer,
}

/// What is wanted, the most urgent first.
#[derive(Debug, Default)]
struct Orders {
    wanted: Vec<Wanted>,
    /// A thread is at it.
    taken: HashSet<Wanted>,
    closed: bool,
}

#[derive(Debug, Default)]
struct Shared {
    orders: Mutex<Orders>,
    changed: Condvar,
}

impl Shared {
    fn orders(&self) -> std::sync::MutexGuard<'_, Orders> {
        // whoever panicked with it left a list that is a list all the same
        self.orders.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next tile to be read; waits for one. `None`: nobody wants any more.
    fn next(&self) -> Option<Wanted> {
        let mut orders = self.orders();
        loop {
            if orders.closed {
                return None;
            }
            let first = orders.wanted.iter().position(|wanted| !orders.taken.contains(wanted));
            if let Some(first) = first {
                let wanted = orders.wanted.remove(first);
                orders.taken.insert(wanted);
                return Some(wanted);
            }
            orders = self.changed.wait(orders).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// The map's end. Dropping it ends the threads.
#[derive(Debug)]
pub struct Desk {
    shared: Arc<Shared>,
    done: Receiver<Done>,
}

impl Desk {
    /// A thread for each reader; `wake` is called when a tile is done.
    pub fn open(
        readers: Vec<Box<dyn Reader>>,
        health: &Arc<Health>,
        wake: &Arc<dyn Fn() + Send + Sync>,
    ) -> Self {
        let shared = Arc::<Shared>::default();
        let (outbox, done) = sync_channel(QUEUE);
        for reader in readers {
            let (shared, outbox) = (shared.clone(), outbox.clone());
            let (health, wake) = (health.clone(), wake.clone());
            let work = move || work(reader, &shared, &outbox, &health, wake.as_ref());
            if let Err(error) = std::thread::Builder::new().name("tiles".into()).spawn(work) {
                tracing::warn!(%error, "no thread for map tiles; the map goes without");
            }
        }
        Self { shared, done }
    }

    /// Wants these tiles, the most urgent first, and no others any more.
    pub fn want(&self, wanted: Vec<Wanted>) {
        let mut orders = self.shared.orders();
        if orders.wanted != wanted {
            orders.wanted = wanted;
            self.shared.changed.notify_all();
        }
    }

    /// The next tile that is done, if there is one.
    pub fn done(&self) -> Option<Done> {
        self.done.try_recv().ok()
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        self.shared.orders().closed = true;
        self.shared.changed.notify_all();
    }
}

fn work(
    mut reader: Box<dyn Reader>,
    shared: &Shared,
    outbox: &SyncSender<Done>,
    health: &Health,
    wake: &(dyn Fn() + Send + Sync),
) {
    while let Some(wanted) = shared.next() {
        let answer = reader.read(wanted);
        health.note(&answer);
        if outbox.send(Done { wanted, answer }).is_err() {
            return;
        }
        shared.orders().taken.remove(&wanted);
        wake();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiles::TileId;
    use std::time::{Duration, Instant};

    struct Counting(Arc<Mutex<Vec<u32>>>);
    impl Reader for Counting {
        fn read(&mut self, wanted: Wanted) -> Answer {
            self.0.lock().unwrap().push(wanted.tile.x);
            if wanted.tile.x == 3 { Answer::Unreadable } else { Answer::Nothing }
        }
    }

    fn wanted(x: u32) -> Wanted {
        Wanted { tile: TileId { zoom: 9, x, y: 1 }, dark: true }
    }

    #[test]
    fn what_is_wanted_is_read_in_order_and_a_full_queue_holds_the_reader() {
        let read = Arc::<Mutex<Vec<u32>>>::default();
        let health = Arc::new(Health::default());
        let wake: Arc<dyn Fn() + Send + Sync> = Arc::new(|| {});
        let desk = Desk::open(vec![Box::new(Counting(read.clone()))], &health, &wake);
        desk.want((0..100).map(wanted).collect());
        let first = desk.done.recv_timeout(Duration::from_secs(10)).unwrap();
        assert_eq!(first.wanted, wanted(0));
        // nothing takes the others: the thread waits with the queue full, and one more in its hand
        let held = QUEUE + 2;
        let deadline = Instant::now() + Duration::from_secs(10);
        while read.lock().unwrap().len() < held && Instant::now() < deadline {
            std::thread::yield_now();
        }
        desk.want(vec![wanted(200)]);
        let rest: Vec<Done> =
            std::iter::from_fn(|| desk.done.recv_timeout(Duration::from_secs(1)).ok()).collect();
        assert_eq!(rest.len(), held, "the first was taken, the last is wanted now");
        assert_eq!(rest.last().map(|done| done.wanted), Some(wanted(200)));
        assert_eq!(read.lock().unwrap()[..4], [0, 1, 2, 3]);
        assert_eq!(health.unreadable(), 1);
    }
}
