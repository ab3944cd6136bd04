//! Any number of a leg, by its name in the document.

use super::{EditError, not_applicable};
use crate::uses::SlotMut;
use crate::{Leg, Value};

/// Sets it; `None` leaves it out.
pub(super) fn set(leg: &mut Leg, name: &str, value: Option<&Value<f64>>) -> Result<(), EditError> {
    let mut outcome = Err("has no such number: choose one that it has");
    leg.for_each_number_mut(&mut |slot| match slot {
        SlotMut::Number(at, number) if at == name => match value {
            Some(value) => {
                number.clone_from(value);
                outcome = Ok(());
            }
            None => outcome = Err("needs this number: set it instead"),
        },
        SlotMut::Optional(at, number) if at == name => {
            *number = value.cloned();
            outcome = Ok(());
        }
        _ => {}
    });
    outcome.map_err(|reason| not_applicable(&leg.id, reason))
}
