//! Pure: the FP Manager's journal as bytes: frames and what is recorded in them. When what is recorded, where it is kept and how a flight is gone on with:
//! `onboard-agent`, `fp_manager/journal`.
//!
//! # A segment
//!
//! All numbers little-endian.
//!
//! ```text
//! header  "LEGWORKJ" | version u32 = 2 | CRC-32 of magic, version and number | number u64
//! frame   length u32 | !length u32 | index u32 | CRC-32 of number, index and payload | payload (CBOR)
//! ```
//!
//! The complement makes every damaged length evident, the index every frame that is missing or in a wrong place. The
//! first payload is a [`Saved`], each further one a turn, a list of [`Entry`]. What its owner notes beside the executor is its
//! own affair: the type `N`.

pub mod frame;
mod record;

pub use frame::{End, NoSegment, Scan, scan};
pub use record::{Chapter, Entry, Record, Reply, Saved, Unusable, encode, read};
