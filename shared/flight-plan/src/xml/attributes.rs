//! Attributes of an element, taken by name; what nobody takes is a problem.

use super::cursor::{MAX_ATTRIBUTES, Place, shown};
use crate::{Location, Problem};
use quick_xml::XmlVersion;
use quick_xml::events::attributes::{Attribute, Attributes as RawAttributes};
use std::borrow::Cow;
use std::cell::Cell;

/// The attributes of one element.
pub(super) struct Attributes<'a> {
    list: Vec<Entry<'a>>,
    /// Just behind the element's name.
    place: Place<'a>,
}

struct Entry<'a> {
    name: &'a str,
    value: Cow<'a, str>,
    taken: Cell<bool>,
}

impl<'a> Attributes<'a> {
    /// Reads what stands behind an element's name.
    pub fn parse(text: &'a str, place: Place<'a>, problems: &mut Vec<Problem>) -> Self {
        let mut list: Vec<Entry<'a>> = Vec::new();
        let mut raw = RawAttributes::new(text, 0);
        for attribute in raw.with_checks(false) {
            if list.len() >= MAX_ATTRIBUTES {
                let message = format!("remove attributes: an element may have {MAX_ATTRIBUTES}");
                problems.push(Problem::error("too-many-attributes", message).at(place.of(text)));
                break;
            }
            match attribute.map_err(|e| ("not-xml", e.to_string())).and_then(|a| entry(&a, &list)) {
                Ok(entry) => list.push(entry),
                Err((code, message)) => {
                    problems.push(
                        Problem::error(code, format!("correct this element's attributes: {message}"))
                            .at(place.of(text)),
                    );
                }
            }
        }
        Self { list, place }
    }

    /// The value of an attribute, if it is there.
    pub fn take(&self, name: &str) -> Option<&Cow<'a, str>> {
        let entry = self.list.iter().find(|e| e.name == name)?;
        entry.taken.set(true);
        Some(&entry.value)
    }

    /// Where an attribute stands.
    pub fn location(&self, name: &str) -> Option<Location> {
        self.list.iter().find(|e| e.name == name).map(|e| self.place.of(e.name))
    }

    /// Attributes that were not taken; namespace declarations and schema hints need not be.
    pub fn unused(&self) -> impl Iterator<Item = (&'a str, Location)> {
        let housekeeping = |name: &str| name.starts_with("xmlns:") || name.starts_with("xsi:");
        let left = self.list.iter().filter(move |e| !e.taken.get() && !housekeeping(e.name));
        left.map(|e| (e.name, self.place.of(e.name)))
    }
}

fn entry<'a>(attribute: &Attribute<'a>, list: &[Entry<'a>]) -> Result<Entry<'a>, (&'static str, String)> {
    let name = attribute.key.0;
    if list.iter().any(|e| e.name == name) {
        return Err(("duplicate-attribute", format!("`{}` is there twice", shown(name))));
    }
    let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|e| ("entity", e.to_string()))?;
    match value.chars().find(|c| !allowed(*c)) {
        Some(_) => {
            Err(("bad-character", format!("`{}` contains a character that XML does not allow", shown(name))))
        }
        None => Ok(Entry { name, value, taken: Cell::new(false) }),
    }
}

/// Characters of XML 1.0.
pub(super) fn allowed(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r' | '\u{20}'..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..)
}
