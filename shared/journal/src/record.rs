//! What is recorded, and how it is written down (CBOR).

use crate::frame::{self, End, NoSegment};
use flight_exec::{Input, Refusal, RequestId, Snapshot, Time, Token};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::Arc;

/// Something that changes the flight, with the executor's time at which it does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry<N> {
    /// Executor's time.
    pub at: Time,
    /// What.
    pub what: Record<N>,
}

/// What is recorded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Record<N> {
    /// An input of the executor, but for a proposal.
    Input(Input),
    /// A proposal: the document is kept beside the journal, under its hash.
    Propose {
        /// As in the input.
        request: RequestId,
        /// Hash of the plan.
        plan: Arc<str>,
        /// As in the input.
        based_on: Option<u64>,
        /// There was an objection that forbids flying it.
        forbidden: bool,
    },
    /// The gateway has seen this token: the executor numbers on behind it.
    NumberAfter(Token),
    /// What its owner has to remember, whenever it changes.
    Notes(N),
    /// A command was answered.
    Answered(Reply),
}

/// The answer to a command: one that is repeated after a restart is not executed again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reply {
    /// By which the request is known: asker, own name and content.
    pub id: String,
    /// How it was answered.
    pub result: Result<(), Refusal>,
}

/// Everything needed to go on with a flight: what a segment begins with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Saved<N> {
    /// Where the executor was.
    pub snapshot: Snapshot,
    /// When it was last stepped, executor's time.
    pub last_step: Option<Time>,
    /// Hash of the plan that may be committed.
    pub proposed: Option<Arc<str>>,
    /// Highest token that the autopilot was seen steering to.
    pub steered: Token,
    /// Number of the last request to the executor.
    pub last_request: u64,
    /// Beside the executor.
    pub notes: N,
    /// The latest answers.
    pub replies: VecDeque<Reply>,
}

impl<N> Saved<N> {
    /// Hashes of the documents it needs.
    pub fn plans(&self) -> impl Iterator<Item = Arc<str>> + '_ {
        self.snapshot.plan.iter().chain(&self.proposed).cloned()
    }
}

/// A segment, understood: a state and what happened since, turn by turn.
#[derive(Debug, Clone, PartialEq)]
pub struct Chapter<N> {
    /// The segment's number.
    pub number: u64,
    /// The state it begins with.
    pub saved: Saved<N>,
    /// Each whole turn of its owner: all of it happened, or none.
    pub turns: Vec<Vec<Entry<N>>>,
    /// What was dropped behind them, for people.
    pub dropped: Option<String>,
    /// Something that took effect may be missing. A torn tail is not: what was not written whole had not taken effect.
    pub incomplete: bool,
}

/// Why a segment can't be used at all.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unusable {
    /// No segment.
    #[error(transparent)]
    NoSegment(#[from] NoSegment),
    /// The state it begins with is damaged or from another version of the program.
    #[error("the state it begins with cannot be read ({0})")]
    State(String),
}

/// Bytes of something recorded.
///
/// # Errors
/// It can't be written down; says why.
pub fn encode<T: Serialize>(value: &T) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    ciborium::into_writer(value, &mut bytes).map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// Reads a segment as far as it can be trusted and understood.
///
/// # Errors
/// Not even the state it begins with can be had.
pub fn read<N: DeserializeOwned>(bytes: &[u8]) -> Result<Chapter<N>, Unusable> {
    let scan = frame::scan(bytes)?;
    let mut payloads = scan.payloads.iter();
    let first = payloads.next().ok_or_else(|| Unusable::State("it is missing".into()))?;
    let saved = ciborium::from_reader(*first).map_err(|e| Unusable::State(e.to_string()))?;
    let mut chapter = Chapter {
        number: scan.number,
        saved,
        turns: Vec::new(),
        dropped: dropped(scan.end),
        incomplete: matches!(scan.end, End::Corrupt { .. }),
    };
    for payload in payloads {
        match ciborium::from_reader(*payload) {
            Ok(turn) => chapter.turns.push(turn),
            Err(error) => {
                let number = chapter.turns.len() + 1;
                chapter.dropped =
                    Some(format!("turn {number} cannot be understood ({error}): replay stops before it"));
                chapter.incomplete = true;
                break;
            }
        }
    }
    Ok(chapter)
}

fn dropped(end: End) -> Option<String> {
    match end {
        End::Clean => None,
        End::Torn { bytes } => Some(format!("a torn tail of {bytes} bytes was dropped")),
        End::Corrupt { at, bytes } => Some(format!(
            "the record at byte {at} is damaged: it and the {bytes} bytes from there on were dropped"
        )),
    }
}
