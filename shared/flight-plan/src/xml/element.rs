//! A canonical element as a small tree, to be compared and to be changed.

use super::write::Escaped;
use quick_xml::XmlVersion::Implicit1_0;
use std::fmt::Write;

/// An element of a document.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Element {
    /// Its name.
    pub name: String,
    /// Its attributes, in the order of the document.
    pub attributes: Vec<(String, String)>,
    /// What stands in it.
    pub children: Vec<Element>,
}

impl Element {
    /// From its canonical text: one tag a line, what is in it deeper.
    pub(crate) fn of(text: &str) -> Option<Self> {
        let mut lines = text.lines().map(str::trim_start);
        let first = lines.next()?;
        let mut element = Self::opened(first);
        if !first.ends_with("/>") {
            element.read(&mut lines);
        }
        Some(element)
    }

    /// By its start tag.
    fn opened(tag: &str) -> Self {
        let tag = tag.trim_start_matches('<').trim_end_matches('>').trim_end_matches('/');
        let (name, attributes) = tag.split_once(' ').unwrap_or((tag, ""));
        Self { name: name.into(), attributes: attributes_in(attributes), children: Vec::new() }
    }

    /// What stands in it, up to its end tag. (Documents nest few elements.)
    fn read(&mut self, lines: &mut dyn Iterator<Item = &str>) {
        while let Some(line) = lines.next().filter(|line| !line.starts_with("</")) {
            let mut child = Self::opened(line);
            if !line.ends_with("/>") {
                child.read(lines);
            }
            self.children.push(child);
        }
    }

    /// An attribute's value.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(n, _)| n == name).map(|(_, value)| value.as_str())
    }

    /// Gives an attribute a value, or takes it away.
    pub(crate) fn set(&mut self, name: &str, value: Option<String>) {
        let place = self.attributes.iter().position(|(n, _)| n == name);
        match (place.and_then(|at| self.attributes.get_mut(at)), value) {
            (Some(attribute), Some(value)) => attribute.1 = value,
            (None, Some(value)) => self.attributes.push((name.into(), value)),
            (_, None) => self.attributes.retain(|(n, _)| n != name),
        }
    }

    /// The element at the end of a path of indices among children; the empty path is this one.
    pub fn at(&self, path: &[usize]) -> Option<&Element> {
        path.iter().try_fold(self, |element, index| element.children.get(*index))
    }

    /// As [`Element::at`], to be changed.
    pub(crate) fn at_mut(&mut self, path: &[usize]) -> Option<&mut Element> {
        path.iter().try_fold(self, |element, index| element.children.get_mut(*index))
    }

    /// Its text, as a reader takes it.
    pub(crate) fn text(&self) -> String {
        let mut out = String::new();
        self.write(&mut out);
        out
    }

    fn write(&self, out: &mut String) {
        out.push('<');
        out.push_str(&self.name);
        for (name, value) in &self.attributes {
            out.push(' ');
            out.push_str(name);
            out.push_str("=\"");
            let _ = Escaped(out).write_str(value);
            out.push('"');
        }
        out.push('>');
        self.children.iter().for_each(|child| child.write(out));
        out.push_str("</");
        out.push_str(&self.name);
        out.push('>');
    }
}

/// The attributes of a canonical element: what stands behind its name.
fn attributes_in(text: &str) -> Vec<(String, String)> {
    let raw = quick_xml::events::attributes::Attributes::new(text, 0);
    let plain = |a: quick_xml::events::attributes::Attribute| {
        a.normalized_value(Implicit1_0).map_or_else(|_| String::new(), Into::into)
    };
    raw.filter_map(Result::ok).map(|a| (a.key.0.to_owned(), plain(a))).collect()
}
