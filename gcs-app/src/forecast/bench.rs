//! The thread that checks, compiles and flies.
//!
//! It always has the newest question and does the most urgent part of it that is not done: first what is drawn, then what
//! happens after an alarm, then what is of no use while the plan is being changed.

use super::preview::Forecaster;
use super::reviewer::{Path, Trial};
use super::worker::{Analysis, Found, Outbox, Question};
use super::{Alarm, Coverage, Flown, Forecast, Shared, beginning};
use aircraft::{Autopilot, Profile};
use flight_exec::rehearse::WhatIf;
use flight_exec::review::Conditions;
use flight_plan::{FlightPlan, IncrementalCache, Problem, Program};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::Duration;
use terrain::Terrain;

/// The plan has to be left alone for so long before its path is reviewed.
const REST: Duration = Duration::from_millis(80);

/// A part of a question.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    /// What is wrong with the plan, and its forecast.
    Analyse,
    /// Only the forecast: the plan is the same.
    Fly,
    Divert(Alarm),
    Hash,
    Review,
    /// One more point of the coverage.
    Cover,
}

/// What it keeps from question to question.
pub(super) struct Bench {
    terrain: Arc<dyn Terrain>,
    /// For which aircraft.
    aircraft: Option<String>,
    memory: IncrementalCache,
    /// Of the plan with other values.
    trials: IncrementalCache,
    forecaster: Forecaster,
    /// The last forecast.
    last: Shared,
    forecast_version: u64,
    /// Document and version, and their program if it can be flown.
    analysed: Option<(u64, u64)>,
    /// How often it analysed.
    analyses: u64,
    program: Option<Arc<Program>>,
    /// What was flown, with its values, and in which world.
    flown: Option<Arc<Program>>,
    what_if: WhatIf,
    autopilot: Option<Autopilot>,
    diverted: Option<(u64, Alarm)>,
    hashed: bool,
    reviewed: bool,
    coverage: Option<(u64, Coverage)>,
}

impl Bench {
    pub fn new(terrain: Arc<dyn Terrain>) -> Self {
        let profile = Profile::default();
        Self {
            memory: IncrementalCache::new(profile.clone(), terrain.clone()),
            trials: IncrementalCache::new(profile.clone(), terrain.clone()),
            forecaster: Forecaster::new(profile, terrain.clone()),
            terrain,
            aircraft: None,
            last: Shared::default(),
            forecast_version: 0,
            analysed: None,
            analyses: 0,
            program: None,
            flown: None,
            what_if: WhatIf::default(),
            autopilot: None,
            diverted: None,
            hashed: true,
            reviewed: true,
            coverage: None,
        }
    }

    /// Answers the newest question until nobody asks any more.
    pub fn work(mut self, inbox: &Receiver<Question>, outbox: &Outbox, paths: &Sender<Path>) {
        let Ok(mut question) = inbox.recv() else { return };
        loop {
            question = inbox.try_iter().last().unwrap_or(question);
            let found = match self.next(&question) {
                Some(Step::Review) => match inbox.recv_timeout(REST) {
                    Ok(newer) => {
                        question = newer;
                        continue;
                    }
                    Err(RecvTimeoutError::Disconnected) => return,
                    Err(RecvTimeoutError::Timeout) => {
                        // without a reviewer the path stays unreviewed, which is shown
                        self.path(&question).into_iter().for_each(|path| drop(paths.send(path)));
                        continue;
                    }
                },
                Some(step) => self.take(step, &question),
                None => match inbox.recv() {
                    Ok(newer) => {
                        question = newer;
                        continue;
                    }
                    Err(_) => return,
                },
            };
            if !outbox.send(found) {
                return;
            }
        }
    }

    /// The most urgent part that is not done.
    fn next(&self, question: &Question) -> Option<Step> {
        let here = self.forecast_version;
        let alarm = question.alarm.filter(|alarm| self.diverted != Some((here, *alarm)));
        let covered = self.coverage.as_ref().is_some_and(|(of, c)| *of == here && c.is_complete());
        match () {
            () if self.analysed != Some((question.document, question.version)) => Some(Step::Analyse),
            () if self.what_if != question.what_if || self.autopilot != question.autopilot => Some(Step::Fly),
            () if alarm.is_some() => alarm.map(Step::Divert),
            () if !self.hashed => Some(Step::Hash),
            () if !self.reviewed => Some(Step::Review),
            () if question.coverage && !covered => Some(Step::Cover),
            () => None,
        }
    }

    fn take(&mut self, step: Step, question: &Question) -> Found {
        match step {
            Step::Analyse => Found::Analysis(self.analyse(question)),
            Step::Fly => Found::Forecast(question.version, self.fly(question)),
            Step::Divert(alarm) => {
                self.diverted = Some((self.forecast_version, alarm));
                // the forecaster keeps a flight that is of no plan any more
                let is_flown = !self.last.points.is_empty();
                let diversion = is_flown.then(|| self.forecaster.divert(alarm)).flatten();
                Found::Diversion(self.forecast_version, diversion)
            }
            Step::Hash | Step::Review => {
                self.hashed = true;
                let hash = || flight_plan::hash(&question.plan);
                let hash = self.program.as_ref().map_or_else(hash, |program| program.hash().to_string());
                Found::Hash(question.version, hash)
            }
            Step::Cover => self.cover(),
        }
    }

    /// Everything but the hash and the review of the path.
    fn analyse(&mut self, question: &Question) -> Analysis {
        self.turn_to(question);
        let (program, problems) = match flight_plan::compile_again(question.plan.clone(), &mut self.memory) {
            Ok(program) => (Some(Arc::new(program)), None),
            Err(problems) => (None, Some(problems)),
        };
        let warnings = || program.as_ref().map(|p| p.warnings.clone()).unwrap_or_default();
        let problems = problems.unwrap_or_else(warnings);
        self.program = program;
        (self.hashed, self.reviewed) = (false, false);
        self.analyses += 1;
        let flown = self.fly(question);
        Analysis {
            document: question.document,
            version: question.version,
            problems,
            reviewed: self.program.is_none(),
            is_complete: self.program.is_none(),
            forecast: flown.forecast,
            forecast_version: flown.forecast_version,
            no_forecast: flown.no_forecast,
            what_if: flown.what_if,
            ..Analysis::default()
        }
    }

    /// From now on it is about this document and its aircraft.
    fn turn_to(&mut self, question: &Question) {
        if self.analysed.is_none_or(|(document, _)| document != question.document) {
            // what another document would do is nothing to be seen under this one
            self.last = Shared::default();
        }
        if self.aircraft.as_ref() != Some(&question.plan.aircraft) {
            let profile = profile_of(&question.plan);
            self.memory = IncrementalCache::new(profile.clone(), self.terrain.clone());
            self.trials = IncrementalCache::new(profile.clone(), self.terrain.clone());
            self.forecaster = Forecaster::new(profile, self.terrain.clone());
            self.aircraft = Some(question.plan.aircraft.clone());
        }
        self.analysed = Some((question.document, question.version));
    }

    fn fly(&mut self, question: &Question) -> Flown {
        self.what_if = question.what_if.clone();
        self.autopilot = question.autopilot;
        self.reviewed = false;
        self.forecast_version += 1;
        let no_forecast = match self.flight(question) {
            Ok(forecast) => {
                self.last = forecast;
                None
            }
            Err(why) => {
                if self.last.is_beginning || !flies_a_part_of(&self.last, &question.plan) {
                    self.last = self.beginning(question).unwrap_or_default();
                }
                Some(why)
            }
        };
        Flown {
            forecast: self.last.clone(),
            forecast_version: self.forecast_version,
            no_forecast,
            what_if: question.what_if.clone(),
        }
    }

    /// As far as a plan with errors can be flown.
    fn beginning(&mut self, question: &Question) -> Option<Shared> {
        if self.program.is_some() {
            return None;
        }
        let program = Arc::new(beginning::of(&question.plan, &mut self.trials)?);
        let what_if = question.what_if.for_plan(&question.plan).flown_by(question.autopilot);
        let forecast = self.forecaster.fly(&program, &what_if).ok()?;
        Some(Arc::new(Forecast { is_beginning: true, ..forecast.as_ref().clone() }))
    }

    fn flight(&mut self, question: &Question) -> Result<Shared, String> {
        self.flown = None;
        let program = self.program.clone().ok_or("This plan can't be flown yet: see its problems.")?;
        let what_if = question.what_if.for_plan(&question.plan);
        let program = match what_if.variables.is_empty() {
            true => program,
            false => {
                let changed = what_if.with_values(&question.plan);
                let compiled = flight_plan::compile_again(changed, &mut self.trials);
                Arc::new(compiled.map_err(|problems| with_these_values(&problems))?)
            }
        };
        self.flown = Some(program.clone());
        self.forecaster.fly(&program, &what_if.flown_by(question.autopilot))
    }

    /// To be reviewed.
    fn path(&mut self, question: &Question) -> Option<Path> {
        self.reviewed = true;
        let program = self.program.clone()?;
        let what_if = question.what_if.for_plan(&question.plan);
        let trial = self.flown.clone().filter(|_| !what_if.is_nothing()).map(|program| Trial {
            forecast_version: self.forecast_version,
            program,
            conditions: Conditions {
                wind: what_if.wind,
                start_unix_s: what_if.start_unix_s,
                ..Conditions::default()
            },
        });
        Some(Path { version: question.version, analysis: self.analyses, program, trial })
    }

    /// One more point.
    fn cover(&mut self) -> Found {
        let here = self.forecast_version;
        let known = self.coverage.take().filter(|(of, _)| *of == here).map(|(_, coverage)| coverage);
        let mut coverage = known.unwrap_or_else(|| Coverage::of(&self.last));
        if let Some(time_s) = coverage.next_s() {
            coverage.push(self.forecaster.worst(time_s));
        }
        self.coverage = Some((here, coverage.clone()));
        Found::Coverage(here, coverage)
    }
}

/// Some leg or stage of the path is in the plan. A path of which nothing is left (its creation was undone) is that of another plan.
fn flies_a_part_of(path: &Forecast, plan: &FlightPlan) -> bool {
    let mut parts = path.passages.iter().flat_map(|passage| [&passage.leg, &passage.stage]);
    parts.any(|id| plan.stage(id).is_some() || plan.leg(id).is_some())
}

/// Of an aircraft that nobody knows: the standard one.
pub(super) fn profile_of(plan: &FlightPlan) -> Profile {
    Profile::by_name(&plan.aircraft).unwrap_or_default()
}

fn with_these_values(problems: &[Problem]) -> String {
    let error = problems.iter().find(|problem| problem.is_error());
    let why = error.map_or_else(String::new, |problem| format!(": {}", problem.message));
    format!("With these values the plan can't be flown{why}.")
}
