//! Identifiers, values and causes of a plan.

use crate::{Convert, same_variants};
use flight_plan as domain;

impl Convert<contract::Id> for domain::Id {
    fn convert(self) -> contract::Id {
        contract::Id::new(self.as_str())
    }
}

impl Convert<domain::Id> for contract::Id {
    fn convert(self) -> domain::Id {
        domain::Id::new(self.as_str())
    }
}

same_variants!(domain::VariableValue = contract::VariableValue {
    Bool(value),
    Number(value),
    Text(value),
    Position(value),
    Polygon(value),
});

same_variants!(domain::Cause = contract::Cause { Operator, Payload, Traffic, Link, Gps, Energy, Engine });
