//! The elevations as the window's own thread asks for them: what is in memory at once, the rest once a thread has read it.

use geometry::LatLon;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::task::Poll;
use terrain::Terrain;

/// Places that may wait to be read. Others are asked for again by the next frame.
const MOST_WAITING: usize = 16;

/// Elevations for which nobody waits. What is not in memory is unknown until it is read.
pub(super) struct AtHand {
    ground: Arc<dyn Terrain>,
    wanted: SyncSender<LatLon>,
}

impl AtHand {
    /// Of this ground; `wake` is called when something was read. The thread ends with the value.
    pub fn of(ground: Arc<dyn Terrain>, wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        let (wanted, inbox) = sync_channel(MOST_WAITING);
        let from = ground.clone();
        let work = move || read(&inbox, from.as_ref(), wake.as_ref());
        if let Err(error) = std::thread::Builder::new().name("elevations".into()).spawn(work) {
            tracing::warn!(%error, "no thread to read elevations");
        }
        Self { ground, wanted }
    }
}

/// What was read stays in memory for who asks next.
fn read(wanted: &Receiver<LatLon>, ground: &dyn Terrain, wake: &dyn Fn()) {
    for place in wanted {
        if ground.at_once_m(place).is_pending() {
            ground.elevation_m(place);
            wake();
        }
    }
}

impl Terrain for AtHand {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        match self.ground.at_once_m(p) {
            Poll::Ready(elevation_m) => elevation_m,
            Poll::Pending => {
                // where many wait, the next frame asks again
                let _ = self.wanted.try_send(p);
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use std::sync::mpsc::{Sender, channel};

    /// Ground that is on a disk: whoever reads it waits until he is let.
    struct Stored {
        may_read: Mutex<Receiver<()>>,
        read: Mutex<Option<f64>>,
    }

    impl Stored {
        fn new() -> (Arc<Self>, Sender<()>) {
            let (let_read, may_read) = channel();
            (Arc::new(Self { may_read: Mutex::new(may_read), read: Mutex::default() }), let_read)
        }
    }

    impl Terrain for Stored {
        fn elevation_m(&self, _: LatLon) -> Option<f64> {
            self.may_read.lock().unwrap().recv().unwrap();
            *self.read.lock().unwrap() = Some(300.0);
            Some(300.0)
        }

        fn at_once_m(&self, _: LatLon) -> Poll<Option<f64>> {
            self.read.lock().unwrap().map_or(Poll::Pending, |metres| Poll::Ready(Some(metres)))
        }
    }

    #[test]
    fn what_is_on_the_disk_is_unknown_until_it_was_read_and_nobody_waits_for_it() {
        let (stored, let_read) = Stored::new();
        let (woken, wakes) = channel();
        let ground = AtHand::of(stored, Arc::new(move || woken.send(()).unwrap()));
        let at = LatLon::new(46.0, 9.0);
        for _ in 0..3 * MOST_WAITING {
            assert_eq!(ground.elevation_m(at), None);
        }
        let_read.send(()).unwrap();
        wakes.recv().unwrap();
        assert_eq!(ground.elevation_m(at), Some(300.0));
        drop(ground);
        assert!(
            wakes.recv().is_err(),
            "one that was asked for again is not read again, and the thread has ended"
        );
    }
}
