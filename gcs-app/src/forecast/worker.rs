//! The worker: newest plan in, analysis out.

use super::Shared;
use aircraft::Profile;
use flight_plan::{FlightPlan, Problem};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;
use terrain::Terrain;

/// A plan to be looked into.
#[derive(Debug, Clone)]
pub struct Question {
    /// The document's version.
    pub version: u64,
    /// The plan.
    pub plan: Arc<FlightPlan>,
}

/// What was found out about a version of the plan.
#[derive(Debug, Clone, Default)]
pub struct Analysis {
    /// The document's version it belongs to.
    pub version: u64,
    /// The plan's hash.
    pub hash: String,
    /// What the checks found.
    pub problems: Vec<Problem>,
    /// What will be flown; that of the last plan that could be flown, if this one can't.
    pub forecast: Shared,
    /// Differs whenever the forecast does.
    pub forecast_version: u64,
    /// Why there is no forecast of this version.
    pub no_forecast: Option<String>,
}

impl Analysis {
    /// The hash of this version of the document, when it is known.
    pub fn hash_of(&self, version: u64) -> Option<&str> {
        (self.version == version).then_some(self.hash.as_str())
    }
    /// Why there is nothing to be drawn, as a sentence.
    pub fn why_no_forecast(&self) -> String {
        match &self.no_forecast {
            Some(why) => why.clone(),
            None if self.version == 0 => "The preview is being computed…".into(),
            None => "Nothing to be flown yet: add stages and legs to the plan.".into(),
        }
    }
}

/// Rest between edits before the worker begins.
const REST: Duration = Duration::from_millis(80);

/// The window's end of the worker. Dropping it ends the worker.
#[derive(Debug)]
pub struct Worker {
    questions: Sender<Question>,
    answers: Receiver<Analysis>,
    asked: u64,
}

impl Worker {
    /// Starts the thread; `wake` is called when there is an answer.
    pub fn spawn(terrain: Arc<dyn Terrain>, wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let (questions, inbox) = channel();
        let (outbox, answers) = channel();
        let work = move || work(&inbox, &outbox, &terrain, wake.as_ref());
        std::thread::Builder::new().name("forecast".into()).spawn(work)?;
        Ok(Self { questions, answers, asked: 0 })
    }

    /// Asks about a plan, unless that was the last thing asked.
    pub fn ask(&mut self, question: Question) {
        if question.version != self.asked {
            self.asked = question.version;
            // a worker that died has said so in its own words
            let _ = self.questions.send(question);
        }
    }

    /// The newest answer, if there is one.
    pub fn answer(&self) -> Option<Analysis> {
        self.answers.try_iter().last()
    }

    /// Something is still being worked out, given the version last answered.
    pub fn is_busy(&self, answered: u64) -> bool {
        self.asked != answered
    }
}

fn work(
    inbox: &Receiver<Question>,
    outbox: &Sender<Analysis>,
    terrain: &Arc<dyn Terrain>,
    wake: &(dyn Fn() + Send + Sync),
) {
    let mut last = Analysis::default();
    while let Some(question) = newest(inbox) {
        last = analyse(&question, terrain, last);
        if outbox.send(last.clone()).is_err() {
            return;
        }
        wake();
    }
}

/// The newest question once there was a rest; `None` when nobody asks any more.
fn newest(inbox: &Receiver<Question>) -> Option<Question> {
    let mut question = inbox.recv().ok()?;
    loop {
        match inbox.recv_timeout(REST) {
            Ok(newer) => question = newer,
            Err(RecvTimeoutError::Timeout) => return Some(question),
            Err(RecvTimeoutError::Disconnected) => return None,
        }
    }
}

fn analyse(question: &Question, terrain: &Arc<dyn Terrain>, last: Analysis) -> Analysis {
    let plan = &question.plan;
    let profile = Profile::by_name(&plan.aircraft).unwrap_or_default();
    let problems = flight_plan::check(plan, &profile, terrain.as_ref());
    let hash = flight_plan::hash(plan);
    let (forecast, no_forecast) = match super::preview::fly(plan, &profile, terrain) {
        Ok(forecast) => (Arc::new(forecast), None),
        Err(why) => (last.forecast, Some(why)),
    };
    Analysis {
        version: question.version,
        hash,
        problems,
        forecast,
        forecast_version: question.version,
        no_forecast,
    }
}
