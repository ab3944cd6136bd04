//! What a session's servers answered, and to whom, for whoever keeps the books.

use crate::Format;
use crate::codec;

/// Larger requests and answers are told by their size only, bytes.
const DOCUMENT_MAX: usize = 64 << 10;

/// Takes what was answered, on whatever thread that was.
pub(crate) type AuditHook = Box<dyn Fn(Audited) + Send + Sync>;

/// A request that has been answered. A repetition that is answered from memory isn't told again.
#[derive(Debug, Clone, PartialEq)]
pub struct Audited {
    /// Name of the invocation.
    pub invocation: String,
    /// Who asked, if it said so. Of a refused request: the name it gave, which may be none that we allow.
    pub caller: Option<String>,
    /// The request's own name.
    pub id: Option<String>,
    /// What was asked.
    pub request: Document,
    /// An answer, not a refusal.
    pub accepted: bool,
    /// The answer, or the refusal.
    pub answer: Document,
}

/// A request or an answer as it was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Document {
    /// How it was written.
    pub format: Format,
    /// How long it was, bytes.
    pub size_bytes: usize,
    /// What was written; `None`, if that was much.
    pub bytes: Option<Vec<u8>>,
}

impl Document {
    pub(crate) fn new(format: Format, bytes: &[u8]) -> Self {
        let kept = (bytes.len() <= DOCUMENT_MAX).then(|| bytes.to_vec());
        Self { format, size_bytes: bytes.len(), bytes: kept }
    }

    /// What it says; null, if it was long or can't be understood.
    pub fn to_json(&self) -> serde_json::Value {
        let bytes = self.bytes.as_deref().unwrap_or_default();
        codec::decode_bytes(bytes, self.format).unwrap_or_default()
    }
}
