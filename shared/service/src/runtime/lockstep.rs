//! Simulated time: led from here, or followed.

use super::Runtime;
use crate::{Adapter, Service, Time};
use std::time::{Duration, Instant};

/// In lockstep, answers on their way are waited for so long (wall-clock) before time goes on.
const ANSWER_PATIENCE: Duration = Duration::from_secs(2);
/// Exchanges with other services within one step of time.
const EXCHANGES_MAX: usize = 16;

impl<S: Service, A: Adapter<S>> Runtime<S, A> {
    /// The simulated time that is led from here stands still.
    pub(super) async fn wait(&mut self) {
        let waited = self.led.elapsed();
        if let Some(input) = self.wiring.waiting.as_ref().map(|waiting| waiting(waited)) {
            self.step(input).await;
        }
    }

    /// In lockstep the network takes no time: what was asked at this instant is answered at it.
    pub(super) async fn await_answers(&mut self) {
        for _ in 0..EXCHANGES_MAX {
            match tokio::time::timeout(ANSWER_PATIENCE, self.calls.join_next()).await {
                Ok(Some(Ok(input))) => drop(self.step(input).await),
                Ok(None | Some(Err(_))) | Err(_) => return,
            }
        }
    }

    /// One step of the simulated time that is led from here: everything due, here and at everybody who takes part.
    pub(super) async fn lead(&mut self, time: Time) -> Option<Time> {
        if self.clock.lead(time).is_none() {
            tracing::error!("this service doesn't lead the time");
            return None;
        }
        self.led = Instant::now();
        self.sample().await;
        self.tick().await;
        self.publish();
        let now_s = self.clock.now().as_secs_f64();
        if let Some(conductor) = self.clock.lead(time) {
            conductor.start(now_s);
        }
        while let Some(conductor) = self.clock.lead(time) {
            let notify = self.notify.clone();
            let settled = tokio::select! {
                biased;
                () = notify.notified() => false,
                _ = conductor.settle() => true,
            };
            self.network().await;
            self.publish();
            if settled {
                break;
            }
        }
        self.sample().await;
        self.tick().await;
        self.publish();
        self.look_after_folder().await;
        let input = self.wiring.stepped.as_ref().map(|stepped| stepped(time))?;
        self.step(input).await
    }
}
