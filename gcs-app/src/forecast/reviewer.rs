//! The thread that reviews paths: the newest one of a plan that was left alone, then remedies that have to be tried and the extremes of
//! its variables; the others can wait for ever.

use super::bench::profile_of;
use super::worker::{Found, Outbox};
use flight_exec::review::{
    Conditions, bring_within_glide, leave_zones_out, put_remedies, review, review_extremes,
};
use flight_plan::{Problem, Program};
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use terrain::Terrain;

/// A path to be reviewed.
pub(super) struct Path {
    pub version: u64,
    /// Of which analysis: one that is made again, as for a document that comes back, knows nothing of a review.
    pub analysis: u64,
    pub program: Arc<Program>,
    /// The same plan in another world.
    pub trial: Option<Trial>,
}

/// A forecast in another world than the standard one.
pub(super) struct Trial {
    pub forecast_version: u64,
    pub program: Arc<Program>,
    pub conditions: Conditions,
}

/// What it knows of the version that it reviewed last.
pub(super) struct Reviewer {
    terrain: Arc<dyn Terrain>,
    known: Option<(u64, Vec<Problem>)>,
    /// The analysis that was told of it.
    told: u64,
    /// The version whose extremes were tried.
    tried: Option<u64>,
}

impl Reviewer {
    pub fn new(terrain: Arc<dyn Terrain>) -> Self {
        Self { terrain, known: None, told: 0, tried: None }
    }

    pub fn work(mut self, paths: &Receiver<Path>, outbox: &Outbox) {
        let mut next = paths.recv().ok();
        while let Some(path) = next.take() {
            let path = paths.try_iter().last().unwrap_or(path);
            if !self.standard(&path, outbox) || !self.trial(&path, outbox) {
                return;
            }
            let Some(interrupted) = self.trials(&path, paths, outbox) else { return };
            next = interrupted.or_else(|| paths.recv().ok());
        }
    }

    /// In the standard world, once a version. False: nobody listens.
    fn standard(&mut self, path: &Path, outbox: &Outbox) -> bool {
        let is_news = std::mem::replace(&mut self.told, path.analysis) != path.analysis;
        if let Some((_, found)) = self.known.as_ref().filter(|(version, _)| *version == path.version) {
            return !is_news || outbox.send(Found::Problems(path.version, found.clone()));
        }
        let profile = profile_of(&path.program.plan);
        let found = review(&path.program, &profile, &self.terrain, Conditions::default());
        self.known = Some((path.version, found.clone()));
        outbox.send(Found::Problems(path.version, found))
    }

    fn trial(&self, path: &Path, outbox: &Outbox) -> bool {
        let Some(trial) = &path.trial else { return true };
        let profile = profile_of(&trial.program.plan);
        let found = review(&trial.program, &profile, &self.terrain, trial.conditions);
        outbox.send(Found::WhatIfProblems(trial.forecast_version, found))
    }

    /// Remedies and extremes, once a version. Gives the path that interrupted it, if one did; `None`: nobody listens.
    fn trials(&mut self, path: &Path, paths: &Receiver<Path>, outbox: &Outbox) -> Option<Option<Path>> {
        let mut next = None;
        if self.tried == Some(path.version) {
            return outbox.send(Found::Everything(path.version)).then_some(None);
        }
        let profile = profile_of(&path.program.plan);
        let conditions = Conditions::default();
        let known = self.known.as_mut().map(|(_, found)| found)?;
        let mut go_on = || {
            next = next.take().or_else(|| paths.try_recv().ok());
            next.is_none()
        };
        let (program, terrain) = (&path.program, &self.terrain);
        let mut remedied = leave_zones_out(program, &profile, terrain, conditions, known, &mut go_on);
        remedied.extend(bring_within_glide(program, &profile, terrain, conditions, known, &mut go_on));
        if !remedied.is_empty() {
            put_remedies(known, remedied.clone());
            if !outbox.send(Found::Remedies(path.version, remedied)) {
                return None;
            }
        }
        if next.is_some() {
            return Some(next);
        }
        let more = {
            let mut go_on = |_, _| {
                next = paths.try_recv().ok();
                next.is_none()
            };
            review_extremes(&path.program, &profile, &self.terrain, conditions, known, &mut go_on)
        };
        if next.is_some() {
            return Some(next);
        }
        self.tried = Some(path.version);
        known.extend_from_slice(&more);
        let told = more.is_empty() || outbox.send(Found::Problems(path.version, more));
        (told && outbox.send(Found::Everything(path.version))).then_some(None)
    }
}
