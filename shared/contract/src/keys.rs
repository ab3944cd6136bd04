//! Keys `legwork/<vehicle>/<service>/<kind>/<name>`: built and parsed here and nowhere else.

use std::fmt;
use std::str::FromStr;

const ROOT: &str = "legwork";
pub(crate) const SEGMENT_MAX: usize = 64;

/// What kind of primitive a key names.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Periodic data, latest value wins.
    Variable,
    /// Facts that must not be lost.
    Event,
    /// One request, one answer.
    Invocation,
    /// Complete or absent, checked by hash, in chunks.
    File,
    /// Who is there.
    Liveliness,
}

impl Kind {
    const ALL: [Self; 5] = [Self::Variable, Self::Event, Self::Invocation, Self::File, Self::Liveliness];

    fn as_str(self) -> &'static str {
        match self {
            Self::Variable => "variable",
            Self::Event => "event",
            Self::Invocation => "invocation",
            Self::File => "file",
            Self::Liveliness => "liveliness",
        }
    }
}

/// A key, taken apart.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Key {
    /// The vehicle's name.
    pub vehicle: String,
    /// The service on it.
    pub service: String,
    /// What kind of primitive.
    pub kind: Kind,
    /// The primitive's name.
    pub name: String,
}

/// Why a text is no key.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum KeyError {
    /// A segment is empty, too long or has other characters than letters, digits, `-`, `_`, `.`.
    #[error("`{0}` is no name: use 1 to 64 letters, digits, '-', '_' or '.'")]
    Segment(String),
    /// Not of the form `legwork/<vehicle>/<service>/<kind>/<name>`.
    #[error("`{0}` is no key: it should be legwork/<vehicle>/<service>/<kind>/<name>")]
    Shape(String),
}

impl Key {
    /// A key of its parts.
    ///
    /// # Errors
    /// [`KeyError::Segment`] for a part that cannot be a key segment.
    pub fn new(vehicle: &str, service: &str, kind: Kind, name: &str) -> Result<Self, KeyError> {
        Ok(Self { vehicle: segment(vehicle)?, service: segment(service)?, kind, name: segment(name)? })
    }
}

/// The pattern that matches this kind and name of every service of a vehicle.
///
/// # Errors
/// [`KeyError::Segment`] for a name that cannot be a key segment.
pub fn every_service(vehicle: &str, kind: Kind, name: &str) -> Result<String, KeyError> {
    Ok(format!("{ROOT}/{}/*/{}/{}", segment(vehicle)?, kind.as_str(), segment(name)?))
}

/// The pattern that matches every name of this kind of every service of a vehicle.
///
/// # Errors
/// [`KeyError::Segment`] for a name that cannot be a key segment.
pub fn every_name(vehicle: &str, kind: Kind) -> Result<String, KeyError> {
    Ok(format!("{ROOT}/{}/*/{}/*", segment(vehicle)?, kind.as_str()))
}

/// Could be a part of a key: a vehicle's, a service's or a primitive's name.
pub fn is_segment(text: &str) -> bool {
    segment(text).is_ok()
}

fn segment(text: &str) -> Result<String, KeyError> {
    let fits = (1..=SEGMENT_MAX).contains(&text.len());
    let clean = text.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'_' | b'.'));
    if fits && clean {
        Ok(text.to_owned())
    } else {
        Err(KeyError::Segment(text.chars().take(SEGMENT_MAX).collect()))
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{ROOT}/{}/{}/{}/{}", self.vehicle, self.service, self.kind.as_str(), self.name)
    }
}

impl FromStr for Key {
    type Err = KeyError;

    fn from_str(text: &str) -> Result<Self, KeyError> {
        let shape = || KeyError::Shape(text.chars().take(5 * SEGMENT_MAX).collect());
        let mut parts = text.split('/');
        let mut next = || parts.next().ok_or_else(shape);
        let (root, vehicle, service, kind, name) = (next()?, next()?, next()?, next()?, next()?);
        if root != ROOT || parts.next().is_some() {
            return Err(shape());
        }
        let kind = Kind::ALL.into_iter().find(|k| k.as_str() == kind).ok_or_else(shape)?;
        Self::new(vehicle, service, kind, name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_key_survives_writing_and_reading(
            vehicle in "[A-Za-z0-9_.-]{1,64}", service in "[a-z-]{1,20}", kind in 0usize..5, name in "[a-z0-9.-]{1,30}",
        ) {
            let key = Key::new(&vehicle, &service, Kind::ALL[kind], &name).unwrap();
            prop_assert_eq!(key.to_string().parse::<Key>().unwrap(), key);
        }

        #[test]
        fn any_text_is_a_key_or_an_error(text in ".{0,200}") {
            if let Ok(key) = text.parse::<Key>() {
                prop_assert_eq!(key.to_string(), text);
            }
        }
    }

    #[test]
    fn the_agreed_spelling() {
        let key = Key::new("uav1", "gateway", Kind::Variable, "position").unwrap();
        assert_eq!(key.to_string(), "legwork/uav1/gateway/variable/position");
    }

    #[test]
    fn wildcards_and_separators_are_no_names() {
        for bad in ["", "a/b", "*", "**", "a$*", "ä", "a b", &"x".repeat(65)] {
            assert!(Key::new(bad, "gateway", Kind::Event, "events").is_err(), "{bad}");
            assert!(every_service(bad, Kind::Event, "events").is_err(), "{bad}");
        }
    }

    #[test]
    fn other_peoples_keys_are_refused() {
        for bad in [
            "legwork/a/b/variable",
            "legwork/a/b/variable/c/d",
            "other/a/b/variable/c",
            "legwork/a/b/photo/c",
        ] {
            assert!(matches!(bad.parse::<Key>(), Err(KeyError::Shape(_))), "{bad}");
        }
    }
}
