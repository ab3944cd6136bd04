//! A bounded tree of XML elements, for formats whose schemas are wide and whose files are sloppy.
//!
//! Own, on top of quick-xml: the `kml` crate panics on an empty `<Point>` and never returns from a file that is cut off
//! inside a placemark, the `gpx` crate gives up at the first odd coordinate and drops extensions without a word, and neither
//! says on which line something stands.

use crate::Error;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, escape};

/// Deepest nesting; Google Earth's own files stay below 20.
const MAX_DEPTH: usize = 64;
/// Most elements.
const MAX_ELEMENTS: usize = 1_000_000;
/// Most attributes of an element.
const MAX_ATTRIBUTES: usize = 64;

/// An element.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Element {
    /// Its name without a namespace's prefix.
    pub name: String,
    /// The line it begins on, from 1.
    pub line: usize,
    /// Names (without prefix) and values.
    pub attributes: Vec<(String, String)>,
    /// Text directly inside, trimmed.
    pub text: String,
    /// Elements inside.
    pub children: Vec<Element>,
}

impl Element {
    /// The first child of a name.
    pub fn child(&self, name: &str) -> Option<&Element> {
        self.children.iter().find(|c| c.name == name)
    }

    /// Text of the first child of a name; empty if there is none.
    pub fn text_of(&self, name: &str) -> &str {
        self.child(name).map_or("", |c| &c.text)
    }

    /// An attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(n, _)| n == name).map(|(_, value)| value.as_str())
    }

    /// For notes: `line 7`.
    pub fn place(&self) -> String {
        format!("line {}", self.line)
    }
}

/// The root element of a document.
///
/// # Errors
/// Not well-formed XML, a document type, or beyond the limits.
pub fn parse(text: &str) -> Result<Element, Error> {
    let mut builder = Builder { text, counted: (0, 1), elements: 0, open: vec![Element::default()] };
    let mut reader = Reader::from_str(text);
    loop {
        let at = offset(reader.buffer_position());
        match reader.read_event() {
            Ok(Event::Eof) => return builder.finish(at),
            Ok(event) => builder.take(at, event)?,
            Err(error) => {
                let at = offset(reader.error_position());
                return Err(builder.malformed(at, format!("correct the XML here: {error}")));
            }
        }
    }
}

/// Places in a text are no longer than what holds it.
fn offset(bytes: u64) -> usize {
    usize::try_from(bytes).unwrap_or(usize::MAX)
}

struct Builder<'a> {
    text: &'a str,
    /// Offset up to which lines were counted, and the line there.
    counted: (usize, usize),
    elements: usize,
    /// The document, and the elements that are open.
    open: Vec<Element>,
}

impl Builder<'_> {
    fn take(&mut self, at: usize, event: Event<'_>) -> Result<(), Error> {
        match event {
            Event::Start(tag) => self.start(at, &tag),
            Event::Empty(tag) => self.start(at, &tag).map(|()| self.end()),
            Event::End(_) => {
                self.end();
                Ok(())
            }
            Event::Text(text) => self.text(&text),
            Event::CData(text) => self.text(&text),
            Event::GeneralRef(reference) => self.reference(at, &reference),
            Event::DocType(_) => Err(self.malformed(at, "remove the <!DOCTYPE …>: it is not accepted")),
            Event::Decl(_) | Event::PI(_) | Event::Comment(_) | Event::Eof => Ok(()),
        }
    }

    fn start(&mut self, at: usize, tag: &BytesStart<'_>) -> Result<(), Error> {
        self.elements += 1;
        if self.elements > MAX_ELEMENTS {
            return Err(Error::TooMany { what: "elements", limit: MAX_ELEMENTS });
        }
        if self.open.len() > MAX_DEPTH {
            return Err(self
                .malformed(at, format!("elements are nested deeper than {MAX_DEPTH}: flatten the folders")));
        }
        let mut attributes = Vec::new();
        for attribute in tag.attributes().with_checks(false) {
            let attribute =
                attribute.map_err(|e| self.malformed(at, format!("correct the attributes here: {e}")))?;
            let value = escape::unescape(&attribute.value)
                .map_err(|e| self.malformed(at, format!("correct the attributes here: {e}")))?;
            attributes.push((local(attribute.key.0).to_owned(), value.into_owned()));
            if attributes.len() > MAX_ATTRIBUTES {
                return Err(self.malformed(at, format!("an element may have {MAX_ATTRIBUTES} attributes")));
            }
        }
        let (name, line) = (local(tag.name().0).to_owned(), self.line(at));
        self.open.push(Element { name, line, attributes, ..Element::default() });
        Ok(())
    }

    fn end(&mut self) {
        // the reader has checked that tags match; the document itself is never ended
        if self.open.len() > 1
            && let Some(mut element) = self.open.pop()
            && let Some(parent) = self.open.last_mut()
        {
            element.text = element.text.trim().to_owned();
            parent.children.push(element);
        }
    }

    fn text(&mut self, text: &str) -> Result<(), Error> {
        if let Some(element) = self.open.last_mut() {
            element.text += text;
        }
        Ok(())
    }

    fn reference(&mut self, at: usize, name: &str) -> Result<(), Error> {
        let known = escape::unescape(&format!("&{name};")).map(std::borrow::Cow::into_owned);
        match known {
            Ok(text) => self.text(&text),
            Err(_) => Err(self.malformed(at, format!("replace the entity &{name}; by its text"))),
        }
    }

    fn finish(mut self, at: usize) -> Result<Element, Error> {
        if self.open.len() > 1 {
            return Err(self.malformed(at, "the file ends inside an element: it is cut off, get it again"));
        }
        let root = self.open.pop().and_then(|document| document.children.into_iter().next());
        root.ok_or_else(|| Error::malformed("line 1", "there is no element in this file"))
    }

    fn malformed(&mut self, at: usize, reason: impl Into<String>) -> Error {
        Error::malformed(format!("line {}", self.line(at)), reason)
    }

    fn line(&mut self, at: usize) -> usize {
        let (from, line) = self.counted;
        let passed = self.text.as_bytes().get(from..at).unwrap_or_default();
        self.counted = (at.max(from), line + passed.iter().filter(|b| **b == b'\n').count());
        self.counted.1
    }
}

fn local(name: &str) -> &str {
    name.rsplit_once(':').map_or(name, |(_, local)| local)
}

/// Text without the characters that XML can't hold, nor a plan therefore.
pub fn held(text: &str) -> String {
    let held = |c: &char| matches!(c, '\t' | '\n' | '\r' | '\u{20}'..='\u{fffd}' | '\u{10000}'..);
    text.chars().filter(held).collect()
}

/// Text for between tags or into an attribute. Characters that XML can't hold are left out.
pub fn escaped(text: &str) -> String {
    escape::escape(held(text)).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree_with_lines_and_text() {
        let root = parse(
            "<?xml version='1.0'?>\n<a x:b='1 &amp; 2'>\n <k:c>x &lt; <![CDATA[y & z]]>&#33;</k:c>\n</a>",
        )
        .unwrap();
        assert_eq!((root.name.as_str(), root.line, root.attribute("b")), ("a", 2, Some("1 & 2")));
        assert_eq!((root.text_of("c"), root.children[0].line), ("x < y & z!", 3));
        assert_eq!(parse(&format!("<a>{}</a>", escaped("<\u{0}&'\">"))).unwrap().text, "<&'\">");
    }

    #[test]
    fn broken_documents_have_a_place() {
        let deep = "<a>".repeat(1000);
        let wide = format!("<a {}/>", (0..100).map(|i| format!("a{i}='' ")).collect::<String>());
        for (text, line) in [
            ("", "line 1"),
            ("<a>\n<b></a>", "line 2"),
            ("<a>\n", "line 2"),
            ("<a", "line 1"),
            ("</a>", "line 1"),
            ("<!DOCTYPE a [<!ENTITY x 'y'>]><a>&x;</a>", "line 1"),
            ("<a>\n\n&nbsp;</a>", "line 3"),
            (&deep, "line 1"),
            (&wide, "line 1"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.to_string().starts_with(line), "{}: {error}", text.get(..20).unwrap_or(text));
        }
    }
}
