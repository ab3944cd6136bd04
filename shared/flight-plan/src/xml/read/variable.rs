//! Variables of a document.

use super::super::cursor::Element;
use super::super::values::{position, positions};
use super::{Document, NOWHERE};
use crate::{Variable, VariableValue};

impl<'a> Document<'a> {
    pub(super) fn variable(&mut self, element: Element<'a>) -> Variable {
        let variable = Variable {
            name: self.id(&element, "name"),
            initial: self.initial(&element),
            unit: self.text(&element, "unit"),
            min: self.number(&element, "min"),
            max: self.number(&element, "max"),
            max_length: self.whole(&element, "maxLength"),
            writers: self.references(&element, "writers"),
        };
        self.cursor.close(element);
        variable
    }

    fn initial(&mut self, element: &Element<'a>) -> VariableValue {
        const TYPES: [(&str, u8); 5] =
            [("bool", 0), ("number", 1), ("text", 2), ("position", 3), ("polygon", 4)];
        let kind = self.choice(element, "type", &TYPES);
        self.require(element, "type");
        self.require(element, "initial");
        match kind {
            Some(0) => VariableValue::Bool(self.flag(element, "initial")),
            Some(1) => VariableValue::Number(self.number(element, "initial").unwrap_or(f64::NAN)),
            Some(3) => {
                let wanted = "a position: latitude and longitude in degrees";
                VariableValue::Position(self.parsed(element, "initial", wanted, position).unwrap_or(NOWHERE))
            }
            Some(4) => {
                let wanted = "positions with commas between them: latitude and longitude in degrees";
                let corners = self.parsed(element, "initial", wanted, positions);
                VariableValue::Polygon(corners.unwrap_or_default())
            }
            _ => VariableValue::Text(self.text(element, "initial")),
        }
    }
}
