//! The path of the plan aboard, to be compared with that of a proposal; found out on a thread of its own.

use super::preview::Forecaster;
use super::{Forecast, Shared};
use crate::state::ActivePlan;
use aircraft::{Autopilot, Profile};
use flight_exec::rehearse::WhatIf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use terrain::Terrain;

/// The window's end of the thread. Dropping it ends the thread.
#[derive(Debug)]
pub struct Aboard {
    questions: Sender<(ActivePlan, Option<Autopilot>)>,
    answers: Receiver<(Arc<str>, Shared)>,
    asked: Option<(Arc<str>, Option<Autopilot>)>,
    known: Option<(Arc<str>, Shared)>,
}

impl Aboard {
    /// Starts the thread; `wake` is called when there is an answer.
    ///
    /// # Errors
    /// There is no thread.
    pub fn spawn(terrain: Arc<dyn Terrain>, wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let (questions, inbox) = channel::<(ActivePlan, Option<Autopilot>)>();
        let (outbox, answers) = channel();
        let work = move || {
            while let Ok(first) = inbox.recv() {
                let (ActivePlan { hash, plan }, autopilot) = inbox.try_iter().last().unwrap_or(first);
                let profile = Profile::by_name(&plan.aircraft).unwrap_or_default();
                let program = flight_plan::compile(plan.as_ref().clone(), &profile, terrain.as_ref());
                let world = WhatIf { autopilot, ..WhatIf::default() };
                let flown = program.ok().and_then(|program| {
                    Forecaster::new(profile, terrain.clone()).fly(&Arc::new(program), &world).ok()
                });
                if outbox.send((hash, flown.unwrap_or_default())).is_err() {
                    return;
                }
                wake();
            }
        };
        std::thread::Builder::new().name("aboard".into()).spawn(work)?;
        Ok(Self { questions, answers, asked: None, known: None })
    }

    /// Asks for the path of a plan, flown by the vehicle's autopilot, unless that was the last thing asked.
    pub fn ask(&mut self, plan: &ActivePlan, autopilot: Option<Autopilot>) {
        let asked = Some((plan.hash.clone(), autopilot));
        if self.asked != asked {
            self.asked = asked;
            // without the thread there is nothing to compare with
            let _ = self.questions.send((plan.clone(), autopilot));
        }
    }

    /// Takes in what the thread found out.
    pub fn receive(&mut self) {
        self.known = self.answers.try_iter().last().or(self.known.take());
    }

    /// The path of a plan, if it is known.
    pub fn path_of(&self, hash: &str) -> Option<&Forecast> {
        self.known.as_ref().filter(|(of, _)| **of == *hash).map(|(_, path)| path.as_ref())
    }
}
