//! The parts of what the executor remembers.
//!
//! Each part is the only writer of its own fields. It takes what it needs of the others as an argument, appends or returns what comes
//! of it, and knows nothing of the executor. Each says whether another one is equivalent but for a shift in numbers and time
//! ([`Offset`]); it names all of its fields there, so that a new one cannot be forgotten.

mod acting;
mod clock;
pub(crate) mod emergencies;
mod horizon;
mod mode;
mod numbers;
mod offset;
mod overrides;
mod path_ahead;
mod questions;
mod refused_start;
mod reported;
mod revision;
mod values;

pub(crate) use acting::{Acting, Moment, Scene};
pub(crate) use clock::Clock;
pub(crate) use emergencies::{Emergencies, Emergency};
pub(crate) use horizon::{Horizon, Replaced};
pub(crate) use mode::Mode;
pub(crate) use numbers::Numbers;
pub(crate) use offset::{Offset, all_equivalent, both_or_none};
pub(crate) use overrides::Overrides;
pub(crate) use path_ahead::PathAhead;
pub(crate) use questions::Questions;
pub(crate) use refused_start::RefusedStart;
pub(crate) use reported::Reported;
pub(crate) use revision::Revision;
pub(crate) use values::Values;

use crate::api::{AircraftState, Refusal};
use serde::{Deserialize, Serialize};

/// What outlasts a flight.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Life {
    pub mode: Mode,
    pub clock: Clock,
    pub numbers: Numbers,
    pub revision: Revision,
    pub values: Values,
    #[serde(default)]
    pub refused_start: RefusedStart,
    aircraft: Option<AircraftState>,
}

/// One flight of a plan. Before the start nothing is in it, and each start begins with an empty one.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Flight {
    pub horizon: Horizon,
    pub questions: Questions,
    pub acting: Acting,
    pub overrides: Overrides,
    pub emergencies: Emergencies,
    pub reported: Reported,
}

impl Life {
    /// The aircraft's last sound report.
    pub fn aircraft(&self) -> Option<&AircraftState> {
        self.aircraft.as_ref()
    }

    /// The aircraft is there from now on; in a trial it may be nowhere.
    pub fn put_aircraft(&mut self, aircraft: Option<AircraftState>) {
        self.aircraft = aircraft;
    }

    pub fn is_equivalent(&self, other: &Self, offset: &Offset) -> bool {
        // the last report repeats the motion, which is compared where the aircraft is; the energy in it makes no difference. Nor does a start
        // that was refused, once it flies
        let Self { mode, clock, numbers, revision, values, refused_start: _, aircraft: _ } = self;
        mode.is_equivalent(&other.mode)
            && revision.is_equivalent(&other.revision)
            && clock.is_equivalent(&other.clock, offset)
            && numbers.is_equivalent(&other.numbers, offset)
            && values.is_equivalent(&other.values)
    }
}

impl Flight {
    pub fn is_equivalent(&self, other: &Self, offset: &Offset) -> bool {
        let Self { horizon, questions, acting, overrides, emergencies, reported } = self;
        overrides.is_equivalent(&other.overrides, offset)
            && emergencies.is_equivalent(&other.emergencies)
            && reported.is_equivalent(&other.reported)
            && questions.is_equivalent(&other.questions)
            && acting.is_equivalent(&other.acting, offset)
            && horizon.is_equivalent(&other.horizon, offset)
    }
}

/// A refusal.
pub(crate) fn refusal(code: &str, reason: impl Into<String>) -> Refusal {
    Refusal { code: code.into(), reason: reason.into() }
}
