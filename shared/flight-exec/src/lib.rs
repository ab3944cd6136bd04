//! Pure: the virtual machine that flies a compiled plan, and the preview that flies it ahead of time.
//!
//! [`api`] is the whole conversation: inputs and outputs are closed enums, time is an argument,
//! waypoints carry tokens and answers carry them back.
//!
//! The modules lie in layers, each of which uses only those before it (`tests/layers.rs`):
//! [`api`] and [`value`] (plain values), [`layout`] (a place in the plan gives a stretch of waypoints), `flight` (the parts of what is
//! remembered), the [`Executor`] (dispatches inputs to them), [`rehearse`] (flies it ahead of time), [`review`] (rules over flown paths).
//!
//! A [`layout::cursor`] walks the program and gives waypoint after waypoint; the [`Executor`] issues them a bounded way
//! ahead, each with the bookmark (a clone of the cursor) it was made from. Whatever changes (a variable, a decision, a count,
//! the plan) is answered in one way: go back to the first bookmark that may still be altered, lay the path out anew, and
//! feed what differs as one transaction. Choices made ahead (loops, intersections, holdings) are provisional: they are read again
//! while the aircraft approaches, and for the last time when it is there.

pub mod api;
mod executor;
mod flight;
pub mod layout;
pub mod rehearse;
pub mod review;
pub mod value;

pub use api::*;
pub use executor::{Executor, RestoreError, Snapshot};
pub use layout::above_ground::{clears_ground, clears_way_in};
pub use layout::homeward::safe_runways;
pub use rehearse::{Preview, PreviewError, preview};
pub use review::{
    Conditions, Margins, bring_within_glide, compile_and_review, compile_and_review_ahead, foresee,
    leave_zones_out, put_remedies, review, review_ahead, review_command, review_extremes, review_turn,
};
pub use value::Config;
