//! What can be typed into the table: names, altitudes and airspeeds, of all legs that are selected together.

use super::rows::Said;
use crate::panels::inspector::inherited::reference_name;
use crate::units::{Unit, Units};
use flight_plan::{Altitude, AltitudeReference, Edit, Id, Value, unread_number};

/// A column that can be changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Column {
    Name,
    Altitude,
    Airspeed,
}

impl Column {
    /// Of the table, the other ones too.
    pub const COUNT: usize = 14;
    /// They are the first ones.
    pub const ALL: [Self; 3] = [Self::Name, Self::Altitude, Self::Airspeed];

    pub fn name(self) -> &'static str {
        match self {
            Self::Name => "Name",
            Self::Altitude => "Altitude",
            Self::Airspeed => "Airspeed",
        }
    }

    pub fn beside(self, by: isize) -> Option<Self> {
        let index = Self::ALL.iter().position(|column| *column == self)?;
        Self::ALL.get(index.checked_add_signed(by)?).copied()
    }

    /// What the field begins with: `1400 AMSL`.
    pub(super) fn text(self, name: &str, said: &Said, units: Units) -> String {
        match self {
            Self::Name => name.to_owned(),
            Self::Altitude => said.altitude.as_ref().map_or_else(String::new, |said| {
                let Altitude { metres, reference } = &said.value;
                format!("{} {}", number_text(metres, units.altitude()), reference_name(*reference))
            }),
            Self::Airspeed => said
                .speed_mps
                .as_ref()
                .map_or_else(String::new, |said| number_text(&said.value, units.speed())),
        }
    }

    /// The edit that a text asks for, of all these legs; or what is wrong with it.
    pub(super) fn edit(self, text: &str, legs: &[Id], said: &Said, units: Units) -> Result<Edit, String> {
        let text = text.trim();
        Ok(match self {
            Self::Name => {
                // each leg has a name of its own
                let own = |id: &Id| Edit::Rename { id: id.clone(), name: name_of(text, id) };
                Edit::All(legs.iter().take(1).map(own).collect())
            }
            Self::Altitude => {
                let reference = said.altitude.as_ref().map(|said| said.value.reference);
                let altitude =
                    altitude(text, reference.unwrap_or(AltitudeReference::Amsl), units.altitude())?;
                set_altitudes(legs.iter(), &altitude)
            }
            Self::Airspeed => {
                let speed_mps = number(text, units.speed())?;
                let set = |of: &Id| Edit::SetSpeed { of: of.clone(), speed_mps: speed_mps.clone() };
                Edit::All(legs.iter().map(set).collect())
            }
        })
    }
}

/// The same altitude for all of these.
pub fn set_altitudes<'a>(of: impl Iterator<Item = &'a Id>, altitude: &Option<Altitude>) -> Edit {
    Edit::All(of.map(|of| Edit::SetAltitude { of: of.clone(), altitude: altitude.clone() }).collect())
}

/// What stands for a name that it has not is not one.
fn name_of(text: &str, id: &Id) -> String {
    if text == id.as_str() { String::new() } else { text.to_owned() }
}

/// A number in the unit that is shown, or a formula.
fn number_text(value: &Value<f64>, unit: Unit) -> String {
    match value {
        Value::Constant(si) => unit.number(*si),
        Value::Expression(formula) => unread_number(formula).unwrap_or_else(|| format!("= {formula}")),
    }
}

/// An altitude with what it is measured from, if that is said; nothing: it is inherited.
pub fn altitude(text: &str, usual: AltitudeReference, unit: Unit) -> Result<Option<Altitude>, String> {
    let (rest, said) = referenced(text);
    Ok(number(rest, unit)?.map(|metres| Altitude { metres, reference: said.unwrap_or(usual) }))
}

/// What stands before the words for what an altitude is measured from, if there are such words: `150 m AGL`.
pub fn referenced(text: &str) -> (&str, Option<AltitudeReference>) {
    const WORDS: [(&str, AltitudeReference); 6] = [
        ("above home", AltitudeReference::Home),
        ("home", AltitudeReference::Home),
        ("above ground", AltitudeReference::Agl),
        ("agl", AltitudeReference::Agl),
        ("amsl", AltitudeReference::Amsl),
        ("msl", AltitudeReference::Amsl),
    ];
    let text = text.trim();
    let lower = text.to_ascii_lowercase();
    let said = WORDS.iter().find_map(|(word, reference)| {
        let rest = text.get(..lower.strip_suffix(word)?.len())?;
        Some((rest, *reference))
    });
    // a formula may end in a variable of that name, but not behind a space
    let is_apart = |rest: &str| rest.ends_with(|c: char| c.is_whitespace() || c.is_ascii_digit());
    match said {
        Some((rest, reference)) if is_apart(rest) => (rest.trim_end(), Some(reference)),
        _ => (text, None),
    }
}

/// A number in a unit or in another of its kind, or a formula behind `=`; nothing: it is inherited.
fn number(text: &str, unit: Unit) -> Result<Option<Value<f64>>, String> {
    if text.is_empty() {
        return Ok(None);
    }
    if let Some(formula) = text.strip_prefix('=') {
        return Ok(Some(Value::Expression(formula.trim().into())));
    }
    let number =
        unit.read(text).map_err(|why| format!("{why}, a formula behind =, or nothing to inherit it."))?;
    Ok(Some(Value::Constant(unit.to_si(number))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn altitudes_are_read_with_what_they_are_measured_from() {
        use AltitudeReference::{Agl, Amsl, Home};
        let read = |text: &str| altitude(text, Home, Units::Si.altitude());
        let constant =
            |metres: f64, reference| Ok(Some(Altitude { metres: Value::Constant(metres), reference }));
        for (text, expected) in [
            ("150", constant(150.0, Home)),
            ("150 m", constant(150.0, Home)),
            ("150 m AGL", constant(150.0, Agl)),
            ("0.15 km AGL", constant(150.0, Agl)),
            ("150AGL", constant(150.0, Agl)),
            ("1400 amsl", constant(1400.0, Amsl)),
            ("80 above home", constant(80.0, Home)),
            ("12,5", constant(12.5, Home)),
            ("", Ok(None)),
        ] {
            assert_eq!(read(text), expected, "{text}");
        }
        let formula = |text: &str| match read(text) {
            Ok(Some(Altitude { metres: Value::Expression(source), reference })) => {
                (source.to_string(), reference)
            }
            other => panic!("{text}: {other:?}"),
        };
        assert_eq!(formula("= base + 30.0 AGL"), ("base + 30.0".into(), Agl));
        assert_eq!(formula("= from_home"), ("from_home".into(), Home), "a variable");
        for text in ["high", "1e999", "NaN", "AGL", "150 kt", "é home"] {
            assert!(read(text).unwrap_err().contains("no number in m"), "{text}");
        }
    }

    #[test]
    fn speeds_are_read_in_the_unit_that_is_shown() {
        let legs = ["a".into(), "b".into()];
        let said = Said::default();
        let edit = Column::Airspeed.edit("36 kt", &legs, &said, Units::Aviation).unwrap();
        let Edit::All(edits) = edit else { panic!() };
        let Edit::SetSpeed { speed_mps: Some(Value::Constant(mps)), .. } = &edits[1] else { panic!() };
        assert!((mps - 18.52).abs() < 1e-9, "{mps}");
        assert!(Column::Airspeed.edit("fast", &legs, &said, Units::Si).unwrap_err().contains("m/s"));
        let Ok(Edit::All(names)) = Column::Name.edit("Leg", &legs, &said, Units::Si) else { panic!() };
        assert_eq!(names.len(), 1, "no two legs get one name");
    }
}
