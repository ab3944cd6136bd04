//! Where a service touches the world.

use crate::{Never, Service, Tasks, Time};
use std::future::{Future, pending, ready};

/// The part of a service that touches the world: a link, a camera, a journal.
pub trait Adapter<S: Service>: Send + 'static {
    /// The next thing that the world does; never, if there is nothing. May be cancelled without loss.
    fn next(&mut self) -> impl Future<Output = S::Input> + Send {
        pending()
    }

    /// Does what one step of the service wants. Nothing else of that step (events, calls, answers) leaves before this is
    /// done; `leaves` tells whether there is any.
    fn perform(
        &mut self,
        now: Time,
        outputs: Vec<S::Output>,
        leaves: bool,
        tasks: &mut Tasks<S::Input>,
    ) -> impl Future<Output = ()> + Send;

    /// The service ends.
    fn finish(&mut self) -> impl Future<Output = ()> + Send {
        ready(())
    }
}

/// Of a service that only knows the network.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoAdapter;

impl<S: Service<Output = Never>> Adapter<S> for NoAdapter {
    fn perform(
        &mut self,
        _: Time,
        _: Vec<Never>,
        _: bool,
        _: &mut Tasks<S::Input>,
    ) -> impl Future<Output = ()> + Send {
        ready(())
    }
}
