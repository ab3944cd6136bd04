//! The journal: every input of the executor, recorded before it takes effect, so that after a crash at any instant
//! a new process stands where the old one stood.
//!
//! # What is recorded
//!
//! A **turn** is one call of the [`Manager`](super::Manager): the inputs of the executor it leads to, with the executor's time,
//! what the FP Manager remembers beside it ([`ManagerState`]: what is wanted of the gateway, alarms answered, the plans of the
//! flight), and answers to commands ([`Reply`]). A turn is written as one frame: after a restart all of it happened or none. A proposal's document
//! is kept in a file of its own, under its hash, before the turn that names it: piece by piece between the turns of the
//! flight, which does not wait for it.
//!
//! # When
//!
//! A turn is written before anything that it leads to leaves the process. Whatever makes the executor put something
//! out (waypoints, an answer, an event, a hold) and every change of the notes is also **synced** before; positions and
//! ticks that lead to nothing are synced within a second. So no waypoint reaches the gateway, no command is answered and no
//! action is triggered that a restart would not know of, not even after a loss of power. What a replayed input puts out is
//! dropped: it was done once, or its process died before and the join with the gateway puts it right. An action is
//! therefore triggered at most once.
//!
//! The flight waits for the disk for half a second at most. A disk that is full, fails or is slow is reported as
//! [`NotJournalled`](flight_exec::Event::NotJournalled) and flown on without; a new state is tried every second, and when it is written
//! recording goes on ([`Journalled`](flight_exec::Event::Journalled)). What is killed between the two begins where the
//! record ends, and may announce again what has happened since.
//!
//! # Files
//!
//! | name | content |
//! |---|---|
//! | `segment-00000042.journal` | a state ([`Saved`]) and the turns since |
//! | `segment-00000041.journal` | the segment before, in case the state of the newest cannot be read |
//! | `segment-00000042.stopped` | a segment that failed while the flight went on: something is missing behind it |
//! | `segment-00000042.unusable` | set aside by a restart; the last three are kept |
//! | `plan-HASH.xml` | documents that these segments name |
//! | `segment.tmp`, `plan.tmp`, `document.tmp` | not finished, of no meaning |
//!
//! A new segment is begun after 2000 turns or 2 MiB: written to a temporary file, synced, renamed, the
//! folder synced; then what is older than the segment before is removed. Two states, two tails and at most 22 plans is all
//! the space it takes.
//!
//! What a segment looks like: the crate `journal`.
//!
//! # Recovery
//!
//! The newest segment is read up to the first frame that is not sound. Are there no sound ones behind it, the tail was **torn** by the
//! crash and is dropped: nothing of it had taken effect. Are there, the segment is **corrupt**: replay stops before it, and
//! that is reported as an event, as something that took effect may be missing. The executor is restored from the state, and the
//! turns are replayed through `Executor::step` at their recorded times. Then a new segment is begun. A segment whose state cannot be
//! used is set aside, and the one before it, which leads up to the same state, is taken.
//!
//! Whatever is missing, the gateway knows the highest token it was given: if that is beyond the journal's, the place is an old
//! one, and the FP Manager holds and says so instead of flying a part of the plan twice.

mod entries;
#[cfg(test)]
pub(super) mod faulty;
mod handle;
mod log;
mod storage;
#[cfg(test)]
mod tests;
mod writer;

pub use ::journal::{Reply, encode};
pub use entries::{Chapter, Entry, ManagerState, Record, Saved};
pub use handle::JournalHandle;
pub use log::{Found, Limits, Log};
pub use storage::{Folder, Storage};
pub use writer::{Job, Report, Writer};
