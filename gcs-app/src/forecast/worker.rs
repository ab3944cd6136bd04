//! The worker: newest question in, analysis out.
//!
//! Two threads. The bench (`bench.rs`) checks, compiles and previews, and keeps from plan to plan what the next edit doesn't reach, so
//! that a plan can be dragged about; what takes longer and can wait follows. The reviewer (`reviewer.rs`) judges the path of a
//! plan that was left alone.

use super::bench::Bench;
use super::reviewer::Reviewer;
use super::{Alarm, Coverage, Flown, Forecast, Shared};
use aircraft::Autopilot;
use flight_exec::rehearse::{Diversion, WhatIf};
use flight_exec::review::put_remedies;
use flight_plan::{FlightPlan, Problem};
use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use terrain::Terrain;

/// A plan to be analysed.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// Which document it is of.
    pub document: u64,
    /// The document's version.
    pub version: u64,
    /// The plan.
    pub plan: Arc<FlightPlan>,
    /// The world that it is flown in.
    pub what_if: WhatIf,
    /// Which autopilot the vehicle has, if its habits are known.
    pub autopilot: Option<Autopilot>,
    /// What would happen then?
    pub alarm: Option<Alarm>,
    /// How would alarms all along the path end?
    pub coverage: bool,
}

impl Question {
    /// The same question, without looking into the plan.
    fn is(&self, other: &Self) -> bool {
        let what = |q: &Self| (q.document, q.version, q.autopilot, q.alarm, q.coverage);
        what(self) == what(other) && self.what_if == other.what_if
    }
}

/// What was found out about a version of the plan.
#[derive(Debug, Clone, Default)]
pub struct Analysis {
    /// Which document it is of; 0: of none.
    pub document: u64,
    /// The document's version it belongs to.
    pub version: u64,
    /// Differs whenever anything of it does, and is never used twice in a run; 0: nothing was found out.
    pub found: u64,
    /// The plan's hash; empty until it is known.
    pub hash: String,
    /// What the checks found, and the review of the path if it was made. The review is made in calm air, whatever the forecast is.
    pub problems: Vec<Problem>,
    /// What the last review found, be it of an earlier version.
    pub last_review: Arc<[Problem]>,
    /// What the review of an earlier version found, until it is known whether that is still so.
    pub unsettled: Arc<[Problem]>,
    /// The path was reviewed, or there is none.
    pub reviewed: bool,
    /// Nothing more will be found of this version: the extremes of its variables were reviewed, too.
    pub is_complete: bool,
    /// What will be flown; that of the document's last version that could be flown, if this one can't.
    pub forecast: Shared,
    /// Differs whenever the forecast does.
    pub forecast_version: u64,
    /// Why there is no forecast of this version.
    pub no_forecast: Option<String>,
    /// The world of the forecast.
    pub what_if: WhatIf,
    /// What the review of the forecast finds in a world that is not the standard one, with the forecast it belongs to.
    pub what_if_problems: Option<(u64, Vec<Problem>)>,
    /// What would happen after the last alarm, with the forecast it belongs to.
    pub diversion: Option<(u64, Arc<Diversion>)>,
    /// How alarms along the path end, with the forecast it belongs to.
    pub coverage: Option<(u64, Arc<Coverage>)>,
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
    /// What would happen after the last alarm, if that belongs to the present forecast.
    pub fn diversion(&self) -> Option<&Diversion> {
        let (of, diversion) = self.diversion.as_ref()?;
        (*of == self.forecast_version).then_some(diversion)
    }
    /// How alarms along the path end, as far as is known of the present forecast.
    pub fn coverage(&self) -> Option<&Coverage> {
        let (of, coverage) = self.coverage.as_ref()?;
        (*of == self.forecast_version).then_some(coverage)
    }
    /// What the review finds in the world of the present forecast, if that is not the standard one.
    pub fn what_if_problems(&self) -> Option<&[Problem]> {
        let (of, problems) = self.what_if_problems.as_ref()?;
        (*of == self.forecast_version).then_some(problems)
    }

    fn take_forecast(&mut self, flown: Flown) {
        self.forecast = flown.forecast;
        self.forecast_version = flown.forecast_version;
        self.no_forecast = flown.no_forecast;
        self.what_if = flown.what_if;
    }

    /// A newer version; what belongs to the former forecast is kept until it is known anew.
    fn succeed(&mut self, newer: Self) {
        let former = std::mem::replace(self, newer);
        if former.document == self.document {
            self.diversion = former.diversion;
            self.coverage = former.coverage;
            self.what_if_problems = former.what_if_problems;
            self.last_review = former.last_review;
            let unreviewed = || missing(&self.last_review, &self.problems);
            self.unsettled = if self.reviewed { Arc::default() } else { unreviewed() };
        }
    }

    /// What the last review found of this version.
    fn settled(&self) -> Vec<Problem> {
        missing(&self.last_review, &self.unsettled).to_vec()
    }

    fn take(&mut self, found: Found) {
        match found {
            Found::Analysis(analysis) => self.succeed(analysis),
            Found::Forecast(version, flown) if version == self.version => self.take_forecast(flown),
            Found::Hash(version, hash) if version == self.version => self.hash = hash,
            Found::Problems(version, problems) if version == self.version => {
                let so_far = if self.reviewed { self.settled() } else { Vec::new() };
                self.problems.extend(problems.iter().cloned());
                self.reviewed = true;
                // of the extremes of its variables, there are more to come: what they alone show is not settled before
                self.unsettled = missing(&self.unsettled, &self.problems);
                self.last_review =
                    so_far.into_iter().chain(problems).chain(self.unsettled.to_vec()).collect();
            }
            Found::Everything(version) if version == self.version => {
                self.is_complete = true;
                self.last_review = self.settled().into();
                self.unsettled = Arc::default();
            }
            Found::Remedies(version, remedied) if version == self.version => {
                put_remedies(&mut self.problems, remedied);
            }
            Found::WhatIfProblems(forecast, problems) => self.what_if_problems = Some((forecast, problems)),
            Found::Diversion(forecast, diversion) => {
                self.diversion = diversion.map(|diversion| (forecast, Arc::new(diversion)));
            }
            Found::Coverage(forecast, coverage) => self.coverage = Some((forecast, Arc::new(coverage))),
            // of a version that is history
            Found::Forecast(..)
            | Found::Hash(..)
            | Found::Problems(..)
            | Found::Remedies(..)
            | Found::Everything(_) => {}
        }
    }
}

/// What the threads find out.
pub(super) enum Found {
    Analysis(Analysis),
    /// Of this version, in another world.
    Forecast(u64, Flown),
    /// Of this version.
    Hash(u64, String),
    /// Of the path of this version.
    Problems(u64, Vec<Problem>),
    /// Of this version: the review is at its end.
    Everything(u64),
    /// For errors of the path of this version that have none yet.
    Remedies(u64, Vec<Problem>),
    /// Of this forecast.
    WhatIfProblems(u64, Vec<Problem>),
    /// From this forecast.
    Diversion(u64, Option<Diversion>),
    /// Of this forecast.
    Coverage(u64, Coverage),
}

/// The window's end of the worker. Dropping it ends the worker.
#[derive(Debug)]
pub struct Worker {
    questions: Sender<Question>,
    answers: Receiver<Found>,
    asked: Option<Question>,
    known: Analysis,
}

impl Worker {
    /// Starts the threads; `wake` is called when there is an answer.
    pub fn spawn(terrain: Arc<dyn Terrain>, wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let (questions, inbox) = channel();
        let (outbox, answers) = channel();
        let (paths, to_review) = channel();
        let (reviewer, ground) = (Outbox { found: outbox.clone(), wake: wake.clone() }, terrain.clone());
        let review = move || Reviewer::new(ground).work(&to_review, &reviewer);
        std::thread::Builder::new().name("review".into()).spawn(review)?;
        let work = move || Bench::new(terrain).work(&inbox, &Outbox { found: outbox, wake }, &paths);
        std::thread::Builder::new().name("forecast".into()).spawn(work)?;
        Ok(Self { questions, answers, asked: None, known: Analysis::default() })
    }

    /// Asks about a plan, unless that was the last thing asked.
    pub fn ask(&mut self, question: Question) {
        if self.asked.as_ref().is_none_or(|asked| !asked.is(&question)) {
            self.asked = Some(question.clone());
            // a worker that died has said so in its own words
            let _ = self.questions.send(question);
        }
    }

    /// What is known now, if that is more than before.
    pub fn answer(&mut self) -> Option<Analysis> {
        let mut changed = false;
        while let Ok(found) = self.answers.try_recv() {
            changed = true;
            self.known.take(found);
        }
        changed.then(|| {
            self.known.found = next_found();
            self.known.clone()
        })
    }

    /// Puts a path in the place of the one that was found out. What else is found out of this version leaves it there.
    pub fn put_path(&mut self, path: Forecast) -> Analysis {
        // no thread counts so far
        (self.known.forecast, self.known.forecast_version) = (Arc::new(path), u64::MAX);
        self.known.found = next_found();
        self.known.clone()
    }
}

fn next_found() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

/// Where answers go.
pub(super) struct Outbox {
    found: Sender<Found>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Outbox {
    /// False: nobody listens any more.
    pub fn send(&self, found: Found) -> bool {
        let told = self.found.send(found).is_ok();
        (self.wake)();
        told
    }
}

/// Those that are not among others.
fn missing(problems: &[Problem], others: &[Problem]) -> Arc<[Problem]> {
    let key = |problem: &Problem| (problem.code, problem.subject.clone());
    let known: HashSet<_> = others.iter().map(key).collect();
    problems.iter().filter(|old| !known.contains(&key(old))).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_version(version: u64, problems: Vec<Problem>) -> Found {
        Found::Analysis(Analysis { document: 1, version, problems, ..Analysis::default() })
    }

    #[test]
    fn what_a_review_found_is_unsettled_from_a_newer_version_to_its_review() {
        let low = || Problem::error("below-terrain", "raise it").of(&"a".into());
        let zone = || Problem::error("keep-out", "fly around it").of(&"b".into());
        let mut known = Analysis::default();
        let unsettled = |known: &Analysis| known.unsettled.iter().map(|p| p.code).collect::<Vec<_>>();
        known.take(of_version(1, Vec::new()));
        known.take(Found::Problems(1, vec![low()]));
        // the extremes of its variables are reviewed after that
        known.take(Found::Problems(1, vec![zone()]));
        assert_eq!(unsettled(&known), [""; 0]);
        known.take(of_version(2, Vec::new()));
        assert_eq!(unsettled(&known), ["below-terrain", "keep-out"]);
        known.take(of_version(3, vec![low()]));
        assert_eq!(unsettled(&known), ["keep-out"], "the check has found the other one already");
        known.take(Found::Problems(3, Vec::new()));
        assert_eq!(
            unsettled(&known),
            ["keep-out"],
            "it may be one of the extremes, which are reviewed after that"
        );
        known.take(of_version(4, Vec::new()));
        assert_eq!(unsettled(&known), ["keep-out"], "and was not known when the next version came");
        known.take(Found::Problems(4, vec![low()]));
        known.take(Found::Everything(4));
        assert_eq!(unsettled(&known), [""; 0], "the newer review did not find it");
        known.take(of_version(5, Vec::new()));
        assert_eq!(unsettled(&known), ["below-terrain"]);
    }
    #[test]
    fn a_path_that_was_put_there_stays_until_the_plan_is_another() {
        let (questions, _inbox) = channel();
        let (outbox, answers) = channel();
        let mut worker = Worker { questions, answers, asked: None, known: Analysis::default() };
        let answer = |worker: &mut Worker, found| {
            outbox.send(found).unwrap();
            worker.answer().unwrap()
        };
        answer(&mut worker, of_version(1, Vec::new()));
        let path = Forecast { stops: 3, ..Forecast::default() };
        assert_eq!(*worker.put_path(path.clone()).forecast, path);
        for found in [Found::Hash(1, "of it".into()), Found::Problems(1, Vec::new()), Found::Everything(1)] {
            assert_eq!(*answer(&mut worker, found).forecast, path);
        }
        assert_ne!(*answer(&mut worker, of_version(2, Vec::new())).forecast, path);
    }
}
