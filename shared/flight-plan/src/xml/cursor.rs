//! A bounded walk over the elements of a document.

use super::attributes::{Attributes, Memory};
use crate::{Location, Problem};
use memchr::{memchr, memchr_iter, memrchr};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// Largest document, bytes.
pub const MAX_BYTES: usize = 64 << 20;
/// Deepest nesting of elements.
pub const MAX_DEPTH: usize = 64;
/// Most attributes of an element.
pub const MAX_ATTRIBUTES: usize = 64;
/// Most elements of a document (what bounds the memory of the plan).
pub const MAX_ELEMENTS: usize = 500_000;
/// Most problems that are reported.
pub const MAX_PROBLEMS: usize = 1_000;
/// Longest tag, bytes.
const MAX_TAG: usize = 1 << 20;

/// An element whose start was just read.
pub(super) struct Element<'a> {
    pub name: &'a str,
    pub attributes: Attributes<'a>,
    pub location: Location,
    /// Written as `<name/>`: it has no children.
    empty: bool,
}

/// Where the walk is.
pub(super) struct Cursor<'a> {
    text: &'a str,
    reader: Reader<&'a [u8]>,
    place: Place<'a>,
    problems: Vec<Problem>,
    depth: usize,
    elements: usize,
    /// Of attributes that are done with.
    memory: Memory<'a>,
    /// Nothing more is read: the end, or a fault that can't be read past.
    stopped: bool,
}

impl<'a> Cursor<'a> {
    pub fn new(text: &'a str) -> Self {
        Self {
            text,
            reader: Reader::from_str(text),
            place: Place { text, offset: 0, line: 1, column: 1 },
            problems: Vec::new(),
            depth: 0,
            elements: 0,
            memory: Memory::default(),
            stopped: false,
        }
    }

    /// Notes a problem; beyond the limit reading ends.
    pub fn report(&mut self, problem: Problem) {
        if self.problems.len() + 1 < MAX_PROBLEMS {
            self.problems.push(problem);
        } else if self.problems.len() < MAX_PROBLEMS {
            self.problems.push(Problem::error(
                "too-many-problems",
                "correct the problems above first: reading ended here",
            ));
            self.stopped = true;
        }
    }

    pub fn into_problems(self) -> Vec<Problem> {
        self.problems
    }

    /// The next child of the element whose children are being read; `None` at its end.
    pub fn child(&mut self, parent: &Element<'a>) -> Option<Element<'a>> {
        if parent.empty { None } else { self.element() }
    }

    /// The document's root.
    pub fn root(&mut self) -> Option<Element<'a>> {
        self.element()
    }

    /// Says that an element is not known here, and reads past it.
    pub fn unknown(&mut self, element: Element<'a>, parent: &str, allowed: &str) {
        let message = format!(
            "<{}> does not belong in <{parent}>: remove it or correct its name (allowed: {allowed})",
            shown(element.name)
        );
        self.refuse(element, &message);
    }

    /// Says why an element can't be here, and reads past it.
    pub fn refuse(&mut self, element: Element<'a>, message: &str) {
        self.report(Problem::error("unknown-element", message).at(element.location));
        self.skip(element);
    }

    /// Reports what was left over of an element that has no children, and reads past its end.
    pub fn close(&mut self, element: Element<'a>) {
        while let Some(child) = self.child(&element) {
            self.unknown(child, element.name, "nothing");
        }
        self.end(element);
    }

    /// As [`Cursor::finish`], for an element whose content is not needed.
    pub fn end(&mut self, element: Element<'a>) {
        self.finish(&element);
        self.memory = element.attributes.into_memory();
    }

    /// Reports the attributes that were never taken.
    pub fn finish(&mut self, element: &Element<'a>) {
        for (attribute, location) in element.attributes.unused() {
            let message = format!(
                "<{}> has no attribute `{}`: remove it or correct its name",
                element.name,
                shown(attribute)
            );
            self.report(Problem::error("unknown-attribute", message).at(location));
        }
    }

    fn skip(&mut self, element: Element<'a>) {
        if element.empty {
            return;
        }
        let outside = self.depth - 1;
        while self.depth > outside && !self.stopped {
            // `None` is the end of some element inside, or of this one
            let _ = self.element();
        }
    }

    fn element(&mut self) -> Option<Element<'a>> {
        while !self.stopped {
            let start = self.reader.buffer_position() as usize;
            match self.reader.read_event() {
                Ok(Event::Start(tag)) => return self.open(start, &tag, false),
                Ok(Event::Empty(tag)) => return self.open(start, &tag, true),
                Ok(Event::End(_)) => {
                    self.depth = self.depth.saturating_sub(1);
                    return None;
                }
                Ok(Event::Eof) => self.end_of_file(start),
                Ok(other) => self.between(start, &other),
                Err(error) => self.broken(&error),
            }
        }
        None
    }

    /// What is not an element: fine if it says nothing.
    fn between(&mut self, start: usize, event: &Event) {
        match event {
            Event::Text(text) if text.trim_ascii().is_empty() => {}
            Event::Comment(_) | Event::PI(_) => {}
            Event::Decl(declaration) => self.declaration(start, declaration),
            Event::DocType(_) => {
                self.stop(
                    start,
                    "doctype",
                    "remove the <!DOCTYPE …>: document types and entities are not accepted",
                );
            }
            Event::GeneralRef(_) => {
                self.stray(start, "entity", "remove the & reference: text does not belong here")
            }
            _ => self.stray(
                start,
                "unexpected-text",
                "remove this text: everything is said in elements and attributes",
            ),
        }
    }

    fn stray(&mut self, start: usize, code: &'static str, message: &str) {
        let location = self.place.advance(start);
        self.report(Problem::error(code, message).at(location));
    }

    fn declaration(&mut self, start: usize, declaration: &quick_xml::events::BytesDecl) {
        let utf8 = |name: &str| name.eq_ignore_ascii_case("utf-8") || name.eq_ignore_ascii_case("us-ascii");
        if declaration.encoding().is_some_and(|encoding| !encoding.is_ok_and(|name| utf8(&name))) {
            self.stray(start, "encoding", "save the document as UTF-8 and say so in its first line");
        }
    }

    fn open(&mut self, start: usize, tag: &BytesStart, empty: bool) -> Option<Element<'a>> {
        let location = self.place.advance(start);
        let end = self.reader.buffer_position() as usize;
        self.elements += 1;
        let too_deep = self.depth + 1 > MAX_DEPTH;
        if too_deep || self.elements > MAX_ELEMENTS || end - start > MAX_TAG {
            let message = format!(
                "split or simplify the plan: a document may nest {MAX_DEPTH} elements deep, have {MAX_ELEMENTS} elements, and tags of {MAX_TAG} bytes"
            );
            self.stop(start, if too_deep { "too-deep" } else { "too-large" }, &message);
            return None;
        }
        self.depth += usize::from(!empty);
        // between `<` and `>` or `/>`
        let inside = self.text.get(start + 1..end - if empty { 2 } else { 1 }).unwrap_or("");
        let (name, list) = inside.split_at_checked(tag.name().0.len()).unwrap_or((inside, ""));
        let mut problems = Vec::new();
        let memory = std::mem::take(&mut self.memory);
        let attributes = Attributes::parse(list, self.place, memory, &mut problems);
        problems.into_iter().for_each(|p| self.report(p));
        Some(Element { name, attributes, location, empty })
    }

    fn end_of_file(&mut self, start: usize) {
        self.stopped = true;
        if self.depth > 0 {
            let location = self.place.advance(start);
            let message =
                format!("the document ends inside {} open elements: it is cut off, get it again", self.depth);
            self.report(Problem::error("truncated", message).at(location));
        }
    }

    fn broken(&mut self, error: &quick_xml::Error) {
        let at = self.reader.error_position() as usize;
        let truncated = matches!(error, quick_xml::Error::Syntax(_));
        let code = if truncated { "truncated" } else { "not-xml" };
        self.stop(at, code, &format!("correct the XML here: {error}"));
    }

    fn stop(&mut self, at: usize, code: &'static str, message: &str) {
        let location = self.place.advance(at);
        self.report(Problem::error(code, message).at(location));
        self.stopped = true;
    }
}

/// A piece of the document for a message: short, without control characters.
pub(crate) fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    let clean = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let mut shown: String = text.chars().take(LONGEST).map(clean).collect();
    if text.chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    shown
}

/// Line and column, advanced with the reader so that every byte is counted once.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    text: &'a str,
    offset: usize,
    line: usize,
    column: usize,
}

impl Place<'_> {
    /// Moves on to a byte offset (an earlier one is answered with the present place).
    pub fn advance(&mut self, offset: usize) -> Location {
        let between = self.text.as_bytes().get(self.offset..offset).unwrap_or(b"");
        let last_line = match memrchr(b'\n', between) {
            Some(end) => {
                let one = memchr(b'\n', between) == Some(end);
                self.line += if one { 1 } else { memchr_iter(b'\n', between).count() };
                self.column = 1;
                between.get(end + 1..).unwrap_or(b"")
            }
            None => between,
        };
        // continuation bytes are part of the character before
        self.column += last_line.iter().filter(|b| !matches!(b, 0x80..=0xbf)).count();
        self.offset = self.offset.max(offset);
        Location::new(self.line, self.column)
    }

    /// The place of a slice of the document that lies further on.
    pub fn of(mut self, slice: &str) -> Location {
        let offset = (slice.as_ptr() as usize).wrapping_sub(self.text.as_ptr() as usize);
        self.advance(offset)
    }
}
