//! What survives the process: everything the executor knows, without the plan itself.

mod shared;

use super::Executor;
use crate::api::Time;
use crate::flight::{Flight, Life};
use crate::layout::cursor::Cursor;
use crate::value::Config;
use aircraft::Profile;
use flight_plan::Program;
use serde::{Deserialize, Serialize};
use shared::{Holding, Shared};
use std::sync::Arc;
use terrain::Terrain;

/// An executor at rest. Restored with the same plan, configuration and profile it hands out the same waypoints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Hash of the active plan: restore with that one.
    pub plan: Option<Arc<str>>,
    life: Life,
    flight: Flight,
    /// What the bookmarks have in common, and which of it each has.
    shared: Shared,
    of_bookmarks: Vec<Holding>,
    sealed: Vec<Option<Box<Cursor>>>,
}

/// Why a snapshot can't be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RestoreError {
    /// Another plan.
    #[error("the snapshot belongs to plan {wanted}, not to {given}: load that plan and restore again")]
    OtherPlan {
        /// Its hash in the snapshot.
        wanted: String,
        /// The hash of what was given.
        given: String,
    },
    /// Its parts don't fit together.
    #[error("the snapshot is damaged: set it aside and start the plan anew")]
    Damaged,
}

impl Executor {
    /// Everything needed to come back to this very place.
    pub fn snapshot(&self) -> Snapshot {
        let mut shared = Shared::default();
        let Self { life, flight, .. } = self;
        let of_bookmarks = flight.horizon.bookmarks().map(|c| shared.take(c)).collect();
        let sealed = flight.horizon.iter().map(|h| h.sealed.clone()).collect();
        let plan = self.program().map(|p| p.hash().clone());
        Snapshot { plan, life: life.clone(), flight: flight.clone(), shared, of_bookmarks, sealed }
    }

    /// The executor as it was, with its plan.
    ///
    /// # Errors
    /// The plan is another one, or the snapshot is damaged.
    pub fn restore(
        config: Config,
        terrain: Arc<dyn Terrain>,
        profile: Profile,
        program: Option<Arc<Program>>,
        snapshot: Snapshot,
    ) -> Result<Self, RestoreError> {
        let given = program.as_ref().map(|p| p.hash().clone());
        if given != snapshot.plan {
            let name = |hash: Option<Arc<str>>| hash.map_or_else(|| "none".into(), |h| h.to_string());
            return Err(RestoreError::OtherPlan { wanted: name(snapshot.plan), given: name(given) });
        }
        let mut executor = Self::new(config, terrain, profile);
        executor.setup.program = program.unwrap_or_default();
        (executor.life, executor.flight) = revived(snapshot)?;
        Ok(executor)
    }

    /// What a snapshot leaves to its owner: the proposal that may still be committed, and when the executor was
    /// last stepped. With them a restored executor answers the inputs that followed as the original did.
    pub fn go_on(&mut self, proposed: Option<Arc<Program>>, last_step: Option<Time>) {
        self.proposed = proposed;
        self.last_step = last_step;
    }
}

fn revived(snapshot: Snapshot) -> Result<(Life, Flight), RestoreError> {
    let Snapshot { plan: _, life, mut flight, shared, of_bookmarks, sealed } = snapshot;
    if flight.horizon.len() != sealed.len() {
        return Err(RestoreError::Damaged);
    }
    flight.horizon.set_sealed(sealed);
    if flight.horizon.bookmarks().count() != of_bookmarks.len() {
        return Err(RestoreError::Damaged);
    }
    for (cursor, holding) in flight.horizon.bookmarks_mut().zip(of_bookmarks) {
        shared.give_back(&holding, cursor).ok_or(RestoreError::Damaged)?;
    }
    Ok((life, flight))
}
