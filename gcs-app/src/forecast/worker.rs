//! The worker: newest plan in, analysis out.

use super::Shared;
use aircraft::Profile;
use flight_exec::review::{Conditions, review, review_extremes};
use flight_plan::{FlightPlan, Problem, Program};
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
    /// What the checks found, and the review of the path if it was made.
    pub problems: Vec<Problem>,
    /// The path was reviewed, or there is none.
    pub reviewed: bool,
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
    let tell = |analysis: &Analysis| {
        let told = outbox.send(analysis.clone());
        wake();
        told
    };
    let mut last = Analysis::default();
    let mut newer = None;
    while let Some(question) = newest(newer.take(), inbox) {
        let (analysis, program) = analyse(&question, terrain, last);
        last = analysis;
        if tell(&last).is_err() {
            return;
        }
        newer = inbox.try_recv().ok();
        // the path takes longer to be looked at than the plan: not while the plan is being changed
        if let Some(program) = program.filter(|_| newer.is_none()) {
            let profile = profile_of(&program.plan);
            let conditions = Conditions::default();
            let found = review(&program, &profile, terrain, conditions);
            last.problems.extend(found.iter().cloned());
            last.reviewed = true;
            if tell(&last).is_err() {
                return;
            }
            let more = review_extremes(&program, &profile, terrain, conditions, &found, &mut |_, _| {
                newer = inbox.try_recv().ok();
                newer.is_none()
            });
            last.problems.extend(more.iter().cloned());
            if !more.is_empty() && tell(&last).is_err() {
                return;
            }
        }
    }
}

fn profile_of(plan: &FlightPlan) -> Profile {
    Profile::by_name(&plan.aircraft).unwrap_or_default()
}

/// The newest question once there was a rest; `None` when nobody asks any more.
fn newest(first: Option<Question>, inbox: &Receiver<Question>) -> Option<Question> {
    let mut question = match first {
        Some(question) => question,
        None => inbox.recv().ok()?,
    };
    loop {
        match inbox.recv_timeout(REST) {
            Ok(newer) => question = newer,
            Err(RecvTimeoutError::Timeout) => return Some(question),
            Err(RecvTimeoutError::Disconnected) => return None,
        }
    }
}

/// Everything but the review of the path, and the program if the plan can be flown.
fn analyse(
    question: &Question,
    terrain: &Arc<dyn Terrain>,
    last: Analysis,
) -> (Analysis, Option<Arc<Program>>) {
    let plan = &question.plan;
    let profile = profile_of(plan);
    let (program, problems, hash) = match flight_plan::compile(plan.clone(), &profile, terrain.as_ref()) {
        Ok(program) => {
            let (problems, hash) = (program.warnings.clone(), program.hash().to_string());
            (Some(Arc::new(program)), problems, hash)
        }
        Err(problems) => (None, problems, flight_plan::hash(plan)),
    };
    let flown = match &program {
        Some(program) => super::preview::fly(program, &profile, terrain),
        None => Err("This plan can't be flown yet: see its problems.".into()),
    };
    let (forecast, no_forecast) = match flown {
        Ok(forecast) => (Arc::new(forecast), None),
        Err(why) => (last.forecast, Some(why)),
    };
    let version = question.version;
    let reviewed = program.is_none();
    let analysis =
        Analysis { version, hash, problems, reviewed, forecast, forecast_version: version, no_forecast };
    (analysis, program)
}
