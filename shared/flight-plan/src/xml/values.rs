//! Attribute values: identifiers, numbers, positions, expressions.

use super::cursor::{Element, shown};
use super::read::Document;
use crate::{Id, Problem, Value, unread};
use geometry::LatLon;
use std::sync::Arc;

/// Attributes, each with its problems.
impl<'a> Document<'a> {
    pub fn text(&mut self, element: &Element<'a>, name: &str) -> String {
        element.attributes.take(name).map_or_else(String::new, |v| v.as_ref().into())
    }

    /// An identifier of this element: required, and its place is kept.
    pub fn id(&mut self, element: &Element<'a>, name: &str) -> Id {
        let id = self.reference(element, name).unwrap_or_else(|| self.missing(element, name));
        self.places.insert(&id, element.location);
        id
    }

    /// An identifier of something else.
    pub fn reference(&mut self, element: &Element<'a>, name: &str) -> Option<Id> {
        element.attributes.take(name).map(|v| Id::new(v.trim()))
    }

    /// Reports that an attribute is missing, and stands in for it.
    pub fn missing(&mut self, element: &Element<'a>, name: &str) -> Id {
        self.require(element, name);
        Id::new("")
    }

    pub fn require(&mut self, element: &Element<'a>, name: &str) {
        if !element.attributes.has(name) {
            self.report_missing(element, name);
        }
    }

    fn report_missing(&mut self, element: &Element<'a>, name: &str) {
        let message = format!("give <{}> the attribute `{name}`", element.name);
        self.cursor.report(Problem::error("missing-attribute", message).at(element.location));
    }

    /// An attribute through a parser; what it refuses is a problem.
    pub fn parsed<T>(
        &mut self,
        element: &Element<'a>,
        name: &str,
        wanted: &str,
        parse: fn(&str) -> Option<T>,
    ) -> Option<T> {
        self.parsed_text(element, (name, element.attributes.take(name)?), wanted, parse)
    }

    /// As [`Document::parsed`], of an attribute that was taken: its name and text.
    fn parsed_text<T>(
        &mut self,
        element: &Element<'a>,
        (name, text): (&str, &str),
        wanted: &str,
        parse: fn(&str) -> Option<T>,
    ) -> Option<T> {
        let parsed = parse(text.trim());
        if parsed.is_none() {
            let message = format!("`{name}` must be {wanted}, not \"{}\"", shown(text));
            let location = element.attributes.location(name).unwrap_or(element.location);
            self.cursor.report(Problem::error("bad-value", message).at(location));
        }
        parsed
    }

    pub fn choice<T: Copy>(&mut self, element: &Element<'a>, name: &str, allowed: &[(&str, T)]) -> Option<T> {
        let text = element.attributes.take(name)?;
        let found = allowed.iter().find(|(word, _)| *word == text.trim()).map(|(_, value)| *value);
        if found.is_none() {
            let words: Vec<&str> = allowed.iter().map(|(word, _)| *word).collect();
            let message = format!("`{name}` must be one of {}, not \"{}\"", words.join(", "), shown(text));
            let location = element.attributes.location(name).unwrap_or(element.location);
            self.cursor.report(Problem::error("bad-value", message).at(location));
        }
        found
    }

    pub fn flag(&mut self, element: &Element<'a>, name: &str) -> bool {
        self.choice(element, name, &[("true", true), ("1", true), ("false", false), ("0", false)])
            .unwrap_or(false)
    }

    pub fn number(&mut self, element: &Element<'a>, name: &str) -> Option<f64> {
        self.parsed(element, name, "a finite number", number)
    }

    pub fn required_number(&mut self, element: &Element<'a>, name: &str) -> f64 {
        self.require(element, name);
        self.number(element, name).unwrap_or(f64::NAN)
    }

    pub fn whole<T: std::str::FromStr>(&mut self, element: &Element<'a>, name: &str) -> Option<T> {
        self.parsed(element, name, "a whole number", |text| text.parse().ok())
    }

    /// A number or `= expression`; of what can't be read the text is kept.
    pub fn value(&mut self, element: &Element<'a>, name: &str) -> Option<Value<f64>> {
        let wanted = "a finite number, or = and an expression";
        let given = (name, element.attributes.take(name)?.as_ref());
        let value = self.parsed_text(element, given, wanted, |text| value(text, number));
        Some(value.unwrap_or_else(|| {
            let kept = unread::kept(given.1);
            if matches!(kept, Value::Expression(_)) {
                self.kept.push(element.attributes.location(name).unwrap_or(element.location));
            }
            kept
        }))
    }

    pub fn required_value(&mut self, element: &Element<'a>, name: &str) -> Value<f64> {
        self.require(element, name);
        self.value(element, name).unwrap_or(Value::Constant(f64::NAN))
    }

    /// A condition: CEL source.
    pub fn condition(&mut self, element: &Element<'a>, name: &str) -> Option<Arc<str>> {
        element.attributes.take(name).map(|source| source.trim().into())
    }

    /// A text that must be there.
    pub fn required_text(&mut self, element: &Element<'a>, name: &str) -> String {
        self.require(element, name);
        self.text(element, name)
    }

    /// `= expression`.
    pub fn source(&mut self, element: &Element<'a>, name: &str) -> Option<Arc<str>> {
        self.parsed(element, name, "= and an expression", |text| {
            text.strip_prefix('=').map(|s| s.trim().into())
        })
    }

    /// `= expression`; nothing becomes one that the checks refuse.
    pub fn required_source(&mut self, element: &Element<'a>, name: &str) -> Arc<str> {
        self.require(element, name);
        self.source(element, name).unwrap_or_else(|| "".into())
    }

    /// Identifiers with spaces between them.
    pub fn references(&mut self, element: &Element<'a>, name: &str) -> Vec<Id> {
        let list = element.attributes.take(name);
        list.map_or_else(Vec::new, |list| list.split_whitespace().map(Id::new).collect())
    }

    /// A position as `lat lon`, or `= expression`.
    pub fn position_value(&mut self, element: &Element<'a>, name: &str) -> Option<Value<LatLon>> {
        let wanted = "latitude and longitude in degrees, or = and an expression";
        self.parsed(element, name, wanted, |text| value(text, position))
    }

    /// A position in two attributes, both required.
    pub fn lat_lon(&mut self, element: &Element<'a>, lat: &str, lon: &str) -> Option<LatLon> {
        let [lat, lon] = [lat, lon].map(|name| {
            let text = element.attributes.take(name);
            if text.is_none() {
                self.report_missing(element, name);
            }
            text.map(|text| (name, text.as_ref()))
        });
        let mut degrees = |given: Option<_>, wanted, parse| self.parsed_text(element, given?, wanted, parse);
        let latitude = degrees(lat, "a latitude in degrees, −90 to 90", |text| {
            number(text).filter(|x| x.abs() <= 90.0)
        });
        let longitude = degrees(lon, "a longitude in degrees, −180 to 180", |text| {
            number(text).filter(|x| x.abs() <= 180.0)
        });
        Some(LatLon::new(latitude?, longitude?))
    }
}

/// The text that an expression stands for, as it stood in the place of a number; `None`: it is a formula.
pub(super) fn as_it_stood(source: &Arc<str>) -> Option<String> {
    let is_it = |text: &String| {
        let kept = unread::kept(text);
        value(text, number).is_none() && matches!(kept, Value::Expression(other) if other == *source)
    };
    unread::unread_number(source).filter(is_it)
}

/// A finite number (not `inf`, not `NaN`).
pub(super) fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|x: &f64| x.is_finite())
}

/// `lat lon`, degrees.
pub(super) fn position(text: &str) -> Option<LatLon> {
    let (lat, lon) = text.split_once([' ', ','])?;
    Some(LatLon::new(number(lat.trim())?, number(lon.trim())?)).filter(|p| p.is_valid())
}

/// `lat lon, lat lon, …`, degrees.
pub(super) fn positions(text: &str) -> Option<Vec<LatLon>> {
    if text.is_empty() {
        return Some(Vec::new());
    }
    text.split(',').map(|p| position(p.trim())).collect()
}

/// `= expression` or a constant.
fn value<T>(text: &str, constant: fn(&str) -> Option<T>) -> Option<Value<T>> {
    match text.strip_prefix('=') {
        Some(source) => Some(Value::Expression(source.trim().into())),
        None => constant(text).map(Value::Constant),
    }
}
