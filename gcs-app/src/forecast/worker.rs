//! The worker: newest plan in, analysis out.
//!
//! Two threads: one checks, compiles and previews, and keeps from plan to plan what the next edit doesn't reach, so that a
//! plan can be dragged about; the other reviews the path of a plan that was left alone, which takes longer.

use super::Shared;
use super::preview::Forecaster;
use aircraft::Profile;
use flight_exec::review::{Conditions, review, review_extremes};
use flight_plan::{FlightPlan, IncrementalCache, Problem, Program};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;
use terrain::Terrain;

/// A plan to be analysed.
#[derive(Debug, Clone)]
pub struct Question {
    /// Which document it is of.
    pub document: u64,
    /// The document's version.
    pub version: u64,
    /// The plan.
    pub plan: Arc<FlightPlan>,
}

/// What was found out about a version of the plan.
#[derive(Debug, Clone, Default)]
pub struct Analysis {
    /// Which document it is of; 0: of none.
    pub document: u64,
    /// The document's version it belongs to.
    pub version: u64,
    /// The plan's hash; empty until it is known.
    pub hash: String,
    /// What the checks found, and the review of the path if it was made.
    pub problems: Vec<Problem>,
    /// The path was reviewed, or there is none.
    pub reviewed: bool,
    /// What will be flown; that of the document's last version that could be flown, if this one can't.
    pub forecast: Shared,
    /// Differs whenever the forecast does.
    pub forecast_version: u64,
    /// Why there is no forecast of this version.
    pub no_forecast: Option<String>,
}

impl Analysis {
    /// The hash of this version of the document, when it is known.
    pub fn hash_of(&self, version: u64) -> Option<&str> {
        Some(self.hash.as_str()).filter(|hash| self.version == version && !hash.is_empty())
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

/// The plan has to be left alone for so long before its path is reviewed.
const REST: Duration = Duration::from_millis(80);

/// What the threads find out.
enum Found {
    Analysis(Analysis),
    /// Of this version.
    Hash(u64, String),
    /// Of the path of this version.
    Problems(u64, Vec<Problem>),
}

/// A path to be reviewed.
struct Path {
    version: u64,
    program: Arc<Program>,
}

/// The window's end of the worker. Dropping it ends the worker.
#[derive(Debug)]
pub struct Worker {
    questions: Sender<Question>,
    answers: Receiver<Found>,
    asked: u64,
    known: Analysis,
}

impl Worker {
    /// Starts the threads; `wake` is called when there is an answer.
    pub fn spawn(terrain: Arc<dyn Terrain>, wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let (questions, inbox) = channel();
        let (outbox, answers) = channel();
        let (paths, to_review) = channel();
        let (reviewer, ground) = (Outbox { found: outbox.clone(), wake: wake.clone() }, terrain.clone());
        let review = move || review_paths(&to_review, &reviewer, &ground);
        std::thread::Builder::new().name("review".into()).spawn(review)?;
        let work = move || Bench::new(terrain).work(&inbox, &Outbox { found: outbox, wake }, &paths);
        std::thread::Builder::new().name("forecast".into()).spawn(work)?;
        Ok(Self { questions, answers, asked: 0, known: Analysis::default() })
    }

    /// Asks about a plan, unless that was the last thing asked.
    pub fn ask(&mut self, question: Question) {
        if question.version != self.asked {
            self.asked = question.version;
            // a worker that died has said so in its own words
            let _ = self.questions.send(question);
        }
    }

    /// What is known now, if that is more than before.
    pub fn answer(&mut self) -> Option<Analysis> {
        let mut changed = false;
        while let Ok(found) = self.answers.try_recv() {
            changed = true;
            match found {
                Found::Analysis(analysis) => self.known = analysis,
                Found::Hash(version, hash) if version == self.known.version => self.known.hash = hash,
                Found::Problems(version, problems) if version == self.known.version => {
                    self.known.problems.extend(problems);
                    self.known.reviewed = true;
                }
                // of a version that is history
                Found::Hash(..) | Found::Problems(..) => {}
            }
        }
        changed.then(|| self.known.clone())
    }
}

/// Where answers go.
struct Outbox {
    found: Sender<Found>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Outbox {
    /// False: nobody listens any more.
    fn send(&self, found: Found) -> bool {
        let told = self.found.send(found).is_ok();
        (self.wake)();
        told
    }
}

/// What the forecasting thread keeps from plan to plan.
struct Bench {
    terrain: Arc<dyn Terrain>,
    /// For which aircraft.
    aircraft: Option<String>,
    memory: IncrementalCache,
    forecaster: Forecaster,
    /// The last forecast, and of which document.
    last: Shared,
    document: u64,
}

impl Bench {
    fn new(terrain: Arc<dyn Terrain>) -> Self {
        let profile = Profile::default();
        Self {
            memory: IncrementalCache::new(profile.clone(), terrain.clone()),
            forecaster: Forecaster::new(profile, terrain.clone()),
            terrain,
            aircraft: None,
            last: Shared::default(),
            document: 0,
        }
    }

    /// Answers the newest question. What takes long, and is of no use while the plan is being changed, comes later: its hash,
    /// and what there is to be said about its path.
    fn work(mut self, inbox: &Receiver<Question>, outbox: &Outbox, paths: &Sender<Path>) {
        let mut next = inbox.recv().ok();
        while let Some(question) = next.take() {
            let question = inbox.try_iter().last().unwrap_or(question);
            let (analysis, program) = self.analyse(&question);
            if !outbox.send(Found::Analysis(analysis)) {
                return;
            }
            next = inbox.try_recv().ok();
            if next.is_none() {
                let hash = program
                    .as_ref()
                    .map_or_else(|| flight_plan::hash(&question.plan), |p| p.hash().to_string());
                outbox.send(Found::Hash(question.version, hash));
                next = match inbox.recv_timeout(REST) {
                    Ok(newer) => Some(newer),
                    Err(RecvTimeoutError::Disconnected) => return,
                    Err(RecvTimeoutError::Timeout) => {
                        let path = program.map(|program| Path { version: question.version, program });
                        // without a reviewer the path stays unreviewed, which is shown
                        path.into_iter().for_each(|path| drop(paths.send(path)));
                        inbox.recv().ok()
                    }
                };
            }
        }
    }

    /// Everything but the hash and the review of the path, and the program if the plan can be flown.
    fn analyse(&mut self, question: &Question) -> (Analysis, Option<Arc<Program>>) {
        let plan = &question.plan;
        if self.document != question.document {
            // what another document would do is nothing to be seen under this one
            (self.document, self.last) = (question.document, Shared::default());
        }
        if self.aircraft.as_ref() != Some(&plan.aircraft) {
            let profile = profile_of(plan);
            self.memory = IncrementalCache::new(profile.clone(), self.terrain.clone());
            self.forecaster = Forecaster::new(profile, self.terrain.clone());
            self.aircraft = Some(plan.aircraft.clone());
        }
        let (program, problems) = match flight_plan::compile_again(plan.clone(), &mut self.memory) {
            Ok(program) => (Some(Arc::new(program)), None),
            Err(problems) => (None, Some(problems)),
        };
        let problems = problems.or_else(|| program.as_ref().map(|p| p.warnings.clone())).unwrap_or_default();
        let flown = match &program {
            Some(program) => self.forecaster.fly(program),
            None => Err("This plan can't be flown yet: see its problems.".into()),
        };
        let no_forecast = flown.map(|forecast| self.last = forecast).err();
        let version = question.version;
        let analysis = Analysis {
            document: question.document,
            version,
            hash: String::new(),
            problems,
            reviewed: program.is_none(),
            forecast: self.last.clone(),
            forecast_version: version,
            no_forecast,
        };
        (analysis, program)
    }
}

fn profile_of(plan: &FlightPlan) -> Profile {
    Profile::by_name(&plan.aircraft).unwrap_or_default()
}

/// Looks at the path of the newest plan that was left alone, then at the extremes of its variables; the others can wait for ever.
fn review_paths(paths: &Receiver<Path>, outbox: &Outbox, terrain: &Arc<dyn Terrain>) {
    let mut next = paths.recv().ok();
    while let Some(path) = next.take() {
        let Path { version, program } = paths.try_iter().last().unwrap_or(path);
        let (profile, conditions) = (profile_of(&program.plan), Conditions::default());
        let found = review(&program, &profile, terrain, conditions);
        if !outbox.send(Found::Problems(version, found.clone())) {
            return;
        }
        let more = review_extremes(&program, &profile, terrain, conditions, &found, &mut |_, _| {
            next = paths.try_recv().ok();
            next.is_none()
        });
        if !more.is_empty() && !outbox.send(Found::Problems(version, more)) {
            return;
        }
        next = next.or_else(|| paths.recv().ok());
    }
}
