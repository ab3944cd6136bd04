//! A start that was refused for where the aircraft stands, or how it is turned: what is known of that may be wrong, as without a compass.

use serde::{Deserialize, Serialize};

/// Who was refused and starts again within this means it, seconds.
const INSISTS_WITHIN_S: f64 = 60.0;

/// The last one.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct RefusedStart(Option<(String, f64)>);

impl RefusedStart {
    /// Someone was refused now, by the executor's clock.
    pub fn of(by: &str, now_s: f64) -> Self {
        Self(Some((by.into(), now_s)))
    }

    /// Whoever starts now was told why not to a moment ago.
    pub fn is_insisted_on(&self, by: &str, now_s: f64) -> bool {
        self.0.as_ref().is_some_and(|(who, at_s)| who == by && now_s - at_s <= INSISTS_WITHIN_S)
    }
}
