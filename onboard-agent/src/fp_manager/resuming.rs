//! Who has the plan flown on is answered when the gateway has agreed to fly it, or has said why not: the executor alone can't know.

use super::command_review::Asked;
use super::service::Out;
use flight_exec::Refusal;
use service::Time;
use std::time::Duration;

/// A gateway that has not agreed within this time may yet do so; a window waits for five seconds.
const AGREES_WITHIN: Duration = Duration::from_secs(3);
/// Most that wait.
const MAX_WAITING: usize = 16;

/// Those who wait, and since when.
#[derive(Default)]
pub struct Resuming(Vec<(Asked, Time)>);

impl Resuming {
    /// The gateway is to be asked for it; where too many wait, nobody else does.
    pub fn wait(&mut self, now: Time, asked: Asked, out: &mut Out) {
        if self.0.len() >= MAX_WAITING {
            return asked.answer(Err(not_granted(OPEN)), out);
        }
        self.0.push((asked, now));
    }

    /// The gateway has agreed, or has not.
    pub fn answered(&mut self, answer: &Result<(), String>, out: &mut Out) {
        for (asked, _) in self.0.drain(..) {
            let refused = |reason: &String| {
                not_granted(&format!("the gateway does not fly the plan on: {reason} {ONCE}"))
            };
            asked.answer(answer.as_ref().copied().map_err(refused), out);
        }
    }

    /// Time has passed. `wanted`: the gateway is still to be asked for it.
    pub fn tick(&mut self, now: Time, wanted: bool, out: &mut Out) {
        let over = |since: Time| !wanted || now.saturating_sub(since) >= AGREES_WITHIN;
        for (asked, _) in self.0.extract_if(.., |(_, since)| over(*since)) {
            let reason = if wanted {
                OPEN
            } else {
                "something else was wanted of the gateway meanwhile, or the pilot took over"
            };
            asked.answer(Err(not_granted(reason)), out);
        }
    }
}

/// What comes of a refusal.
const ONCE: &str = "It is not asked again: resume once that has changed.";
/// Why it is not known yet.
const OPEN: &str =
    "the gateway has not agreed yet to fly the plan on, and goes on being asked: look at its state";

fn not_granted(reason: &str) -> Refusal {
    Refusal { code: "not-granted".into(), reason: reason.into() }
}
