//! Attributes of an element, taken by name; an attribute that is never taken is a problem.

use super::cursor::{MAX_ATTRIBUTES, Place, shown};
use crate::{Location, Problem};
use quick_xml::XmlVersion;
use quick_xml::events::attributes::{Attribute, Attributes as RawAttributes};
use std::borrow::Cow;
use std::cell::Cell;

/// The attributes of one element.
pub(super) struct Attributes<'a> {
    list: Vec<Entry<'a>>,
    /// The element's.
    place: Place<'a>,
    /// Which names may be there (see [`bit`]): most that are asked for are not.
    names: u64,
}

/// The memory of attributes that are done with: most elements need none of their own.
#[derive(Default)]
pub(super) struct Memory<'a>(Vec<Entry<'a>>);

struct Entry<'a> {
    name: &'a str,
    /// See [`bit`].
    bit: u64,
    value: Cow<'a, str>,
    taken: Cell<bool>,
}

impl<'a> Entry<'a> {
    fn new(name: &'a str, value: Cow<'a, str>) -> Self {
        Self { name, bit: bit(name), value, taken: Cell::new(false) }
    }

    fn is_called(&self, name: &str, bit: u64) -> bool {
        self.bit == bit && self.name == name
    }
}

impl<'a> Attributes<'a> {
    /// Reads what stands behind an element's name. `memory` is used again.
    pub fn parse(
        text: &'a str,
        place: Place<'a>,
        mut memory: Memory<'a>,
        problems: &mut Vec<Problem>,
    ) -> Self {
        memory.0.clear();
        let list = plain(text, memory.0).unwrap_or_else(|| Self::any(text, place, problems));
        let names = list.iter().fold(0, |names, entry| names | entry.bit);
        Self { list, place, names }
    }

    /// Whatever XML allows.
    fn any(text: &'a str, place: Place<'a>, problems: &mut Vec<Problem>) -> Vec<Entry<'a>> {
        let mut list: Vec<Entry<'a>> = Vec::new();
        let mut raw = RawAttributes::new(text, 0);
        for attribute in raw.with_checks(false) {
            if list.len() >= MAX_ATTRIBUTES {
                let message = format!("remove attributes: an element may have {MAX_ATTRIBUTES}");
                problems.push(Problem::error("too-many-attributes", message).at(place.of(text)));
                break;
            }
            if let Some(bracket) = attribute.as_ref().ok().and_then(|a| raw_bracket(a)) {
                let message = "write `&lt;` for `<` in an attribute's value: XML does not allow the character itself there";
                problems.push(Problem::error("not-xml", message).at(place.of(bracket)));
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
        list
    }

    /// What can be used again when nothing more will be asked.
    pub fn into_memory(self) -> Memory<'a> {
        Memory(self.list)
    }

    /// The value of an attribute, if it is there.
    pub fn take(&self, name: &str) -> Option<&Cow<'a, str>> {
        let entry = self.find(name)?;
        entry.taken.set(true);
        Some(&entry.value)
    }

    fn find(&self, name: &str) -> Option<&Entry<'a>> {
        let bit = bit(name);
        if self.names & bit == 0 {
            return None;
        }
        self.list.iter().find(|e| e.is_called(name, bit))
    }

    /// It is there (and still to be taken).
    pub fn has(&self, name: &str) -> bool {
        self.find(name).is_some()
    }

    /// Where an attribute stands.
    pub fn location(&self, name: &str) -> Option<Location> {
        self.find(name).map(|e| self.place.of(e.name))
    }

    /// Attributes that were not taken; namespace declarations and schema hints need not be.
    pub fn unused(&self) -> impl Iterator<Item = (&'a str, Location)> {
        let housekeeping = |name: &str| name.starts_with("xmlns:") || name.starts_with("xsi:");
        let left = self.list.iter().filter(move |e| !e.taken.get() && !housekeeping(e.name));
        left.map(|e| (e.name, self.place.of(e.name)))
    }
}

/// A bit for a name, from its length and first letter: it distinguishes most names.
#[inline]
fn bit(name: &str) -> u64 {
    let first = name.as_bytes().first().map_or(0, |b| usize::from(*b));
    1 << ((first + 7 * name.len()) % 64)
}

/// Attributes as nearly every document has them: `name="value"`, no references, no line breaks in values, no name twice.
/// `None`: something else.
fn plain<'a>(text: &'a str, mut list: Vec<Entry<'a>>) -> Option<Vec<Entry<'a>>> {
    let mut rest = text;
    loop {
        rest = rest.trim_ascii_start();
        if rest.is_empty() {
            return Some(list);
        }
        let (name, behind) = rest.split_at_checked(begins_with(rest, NAME))?;
        let behind = behind.strip_prefix("=\"")?;
        let (value, behind) = behind.split_at_checked(begins_with(behind, VALUE))?;
        rest = behind.strip_prefix('"')?;
        let separate = rest.is_empty() || rest.starts_with(' ');
        let entry = Entry::new(name, Cow::Borrowed(value));
        let again = list.iter().any(|e| e.is_called(name, entry.bit));
        if name.is_empty() || !separate || again || list.len() >= MAX_ATTRIBUTES {
            return None;
        }
        list.push(entry);
    }
}

/// A byte of a plain name.
const NAME: u8 = 1;
/// A byte of a plain value: no quote, no reference, nothing that XML makes a space.
const VALUE: u8 = 2;

/// What each byte may be part of: looked up, because nearly every byte of a document comes by here.
const PARTS: [u8; 256] = {
    let mut parts = [0; 256];
    let mut byte: u8 = 0;
    loop {
        let name = byte.is_ascii_alphanumeric() || matches!(byte, b':' | b'_' | b'-');
        let value = !matches!(byte, b'"' | b'&' | b'<' | b'\t' | b'\n' | b'\r');
        parts[byte as usize] = if name { NAME } else { 0 } | if value { VALUE } else { 0 };
        if byte == u8::MAX {
            break parts;
        }
        byte += 1;
    }
};

/// How many bytes at the beginning of a text are of a part.
fn begins_with(text: &str, part: u8) -> usize {
    text.bytes().take_while(|byte| PARTS[usize::from(*byte)] & part != 0).count()
}

/// From a `<` on that stands in a value as it is: that is no XML, although the parser takes it.
fn raw_bracket<'a>(attribute: &Attribute<'a>) -> Option<&'a str> {
    let Cow::Borrowed(value) = attribute.value else { return None };
    value.find('<').and_then(|at| value.get(at..))
}

fn entry<'a>(attribute: &Attribute<'a>, list: &[Entry<'a>]) -> Result<Entry<'a>, (&'static str, String)> {
    let name = attribute.key.0;
    if list.iter().any(|e| e.name == name) {
        return Err(("duplicate-attribute", format!("`{}` is there twice", shown(name))));
    }
    let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|e| ("entity", e.to_string()))?;
    // text without references was validated with the whole document
    let made = matches!(value, Cow::Owned(_)).then(|| value.chars().find(|c| !allowed(*c)));
    match made.flatten() {
        Some(_) => {
            Err(("bad-character", format!("`{}` contains a character that XML does not allow", shown(name))))
        }
        None => Ok(Entry::new(name, value)),
    }
}

/// Characters of XML 1.0.
pub(super) fn allowed(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r' | '\u{20}'..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..)
}
