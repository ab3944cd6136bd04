//! Which of several processes something comes from: two that have the same name are two instances.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;
use zenoh::sample::SourceInfo;
use zenoh::session::{EntityGlobalId, ZenohId};

/// A session as others know it, from its opening to its end. A claim, not a proof: who means harm may take another's.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Instance(ZenohId);

/// A text that names no instance.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` names no instance: write it as hexadecimal digits, as it was told")]
pub struct NoInstance(String);

impl Instance {
    /// That of a session.
    pub(crate) fn of(session: &zenoh::Session) -> Self {
        Self(session.zid())
    }

    /// That of a publisher, as the network names it.
    pub(crate) fn of_entity(entity: EntityGlobalId) -> Self {
        Self(entity.zid())
    }

    /// Where a sample or a query comes from; a stranger's plain put or get doesn't say.
    pub(crate) fn behind(source: Option<&SourceInfo>) -> Option<Self> {
        source.map(|info| Self::of_entity(*info.source_id()))
    }
}

/// Says whether what comes from a session counts. It is asked where a message comes in: what doesn't count neither takes the
/// place of what does, nor a place in its queue. It is called by the network's threads and must not wait.
pub type Gate = Arc<dyn Fn(Option<Instance>) -> bool + Send + Sync>;

/// Everybody counts.
pub(crate) fn anybody() -> Gate {
    Arc::new(|_| true)
}

impl fmt::Display for Instance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Debug for Instance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl FromStr for Instance {
    type Err = NoInstance;

    fn from_str(text: &str) -> Result<Self, NoInstance> {
        ZenohId::from_str(text).map(Self).map_err(|_| NoInstance(text.chars().take(64).collect()))
    }
}
