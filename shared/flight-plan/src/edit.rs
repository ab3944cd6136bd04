//! Edits as values: what a person did to a plan, to be applied, undone, or offered as a remedy.

use crate::Id;
use geometry::LatLon;

/// A change of a plan.
#[derive(Debug, Clone, PartialEq)]
pub enum Edit {
    /// Moves a fix, and with it every leg that goes there.
    MoveFix {
        /// The fix.
        fix: Id,
        /// Where to.
        to: LatLon,
    },
}
