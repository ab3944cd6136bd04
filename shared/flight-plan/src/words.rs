//! What causes, stages and values are called, in the document and to people: one table for every place that names them. Legs have theirs in
//! [`LegChoice`](crate::create::LegChoice).

use crate::model::{Cause, StageKind, VariableValue};

impl Cause {
    /// In the document.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Engine => "engine",
            Self::Energy => "energy",
            Self::Gps => "gps",
            Self::Link => "link",
            Self::Traffic => "traffic",
            Self::Payload => "payload",
            Self::Operator => "operator",
        }
    }

    /// To people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Engine => "Engine failure",
            Self::Energy => "Energy low",
            Self::Gps => "GPS lost",
            Self::Link => "Link lost",
            Self::Traffic => "Traffic",
            Self::Payload => "Payload failure",
            Self::Operator => "Operator",
        }
    }

    /// The first word of its name, where there is room for no more.
    pub fn short_name(self) -> &'static str {
        self.name().split(' ').next().unwrap_or_default()
    }
}

impl StageKind {
    /// In the document.
    pub const fn word(self) -> &'static str {
        match self {
            Self::TakeOff => "take-off",
            Self::Departure => "departure",
            Self::EnRoute => "en-route",
            Self::Mission => "mission",
            Self::Arrival => "arrival",
            Self::Approach => "approach",
            Self::Land => "land",
        }
    }
}

/// Kinds of variables, to people.
pub const NUMBER: &str = "Number";
/// One that is true or false.
pub const YES_OR_NO: &str = "Yes or no";
/// Characters.
pub const TEXT: &str = "Text";
/// A place.
pub const POSITION: &str = "Position";
/// Corners.
pub const AREA: &str = "Area";

impl VariableValue {
    /// What kind it is, to people; in the document it is its [`type_name`](VariableValue::type_name).
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Number(_) => NUMBER,
            Self::Bool(_) => YES_OR_NO,
            Self::Text(_) => TEXT,
            Self::Position(_) => POSITION,
            Self::Polygon(_) => AREA,
        }
    }
}

/// A value that is true or false, to people.
pub const fn yes_or_no(value: bool) -> &'static str {
    if value { "yes" } else { "no" }
}

#[cfg(test)]
mod tests {
    use crate::create::LegChoice;
    use crate::describe;

    #[test]
    fn each_kind_of_leg_is_called_alike_where_it_is_chosen_and_where_it_is_changed() {
        let described: Vec<&str> = describe::all().map(|leg| leg.label).collect();
        // two styles of the one scan
        let of_scan = [LegChoice::CreepingLine, LegChoice::CrissCross];
        for choice in LegChoice::ALL.into_iter().filter(|choice| !of_scan.contains(choice)) {
            assert!(described.contains(&choice.label()), "{} is none of {described:?}", choice.label());
        }
        assert_eq!(LegChoice::Hm.name(), "HM hold until released");
    }
}
