//! What was reported already.

use crate::api::{Event, Output};
use crate::layout::cursor::LayoutError;
use serde::{Deserialize, Serialize};

/// Most errors remembered so that they are reported once.
const MAX_REMEMBERED: usize = 16;

/// What could not be laid out lately, the latest first.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Reported(Vec<LayoutError>);

impl Reported {
    /// Reports what can't be laid out, once as long as nothing is done about it.
    pub fn report(&mut self, error: LayoutError, out: &mut Vec<Output>) {
        if self.0.contains(&error) {
            return;
        }
        self.0.truncate(MAX_REMEMBERED - 1);
        self.0.insert(0, error.clone());
        out.push(Output::Event(match error {
            LayoutError::Leg { leg, reason } | LayoutError::Ground { leg, reason } => {
                Event::PatternRefused { leg, reason }
            }
            LayoutError::Expression { leg, reason } => Event::ExpressionFailed { leg, reason },
        }));
    }

    /// Something was done about it: what is still wrong is reported again.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    pub fn is_equivalent(&self, other: &Self) -> bool {
        let Self(errors) = self;
        *errors == other.0
    }
}
