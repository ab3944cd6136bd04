//! The document: XML in and out.
//!
//! Reading never fails as a whole: it gives a plan, as far as one can be made out, and the problems it met.
//! Writing is canonical: the same plan gives the same bytes, and their SHA-256 is the plan's identity.

mod actions;
mod attributes;
mod cursor;
mod element;
mod legs;
mod patch;
mod patterns;
mod read;
mod values;
mod write;
mod write_legs;
mod zone;

pub(crate) use cursor::shown;
pub use cursor::{MAX_ATTRIBUTES, MAX_BYTES, MAX_DEPTH, MAX_ELEMENTS, MAX_PROBLEMS};
pub use patch::patch;
pub use read::{Places, Reading, read};
pub use write::write;

use crate::{FlightPlan, Leg};
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// The document's namespace.
pub const NAMESPACE: &str = "urn:legwork:flight-plan:1";

pub use element::Element;
pub(crate) use read::part::{Part, read_part};
pub(crate) use write::{Piece, text};

/// How long legs are when they are written, bytes.
pub(crate) fn size(legs: &[Arc<Leg>]) -> usize {
    write::legs(legs).len()
}

/// Hex SHA-256 of the plan's canonical document: its identity aboard and on the ground.
pub fn hash(plan: &FlightPlan) -> String {
    use std::fmt::Write;
    Sha256::digest(write(plan)).iter().fold(String::with_capacity(64), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}
