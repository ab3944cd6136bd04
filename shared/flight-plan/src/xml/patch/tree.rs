//! A document as a tree that loses nothing: each element and attribute by where it stands in the text.

use super::super::cursor::MAX_DEPTH;
use super::super::legs::is_leg;
use quick_xml::Reader;
use quick_xml::XmlVersion::Implicit1_0;
use quick_xml::events::attributes::{Attribute as Raw, Attributes};
use quick_xml::events::{BytesStart, Event};
use quick_xml::name::QName;
use std::borrow::Cow;
use std::ops::Range;

/// Elements of which a document has one each.
const LISTS: [&str; 7] =
    ["fixes", "runways", "variables", "zones", "procedures", "mainPlan", "emergencyPlans"];

/// The elements in the order of the text.
pub(super) struct Tree<'t> {
    pub text: &'t str,
    pub nodes: Vec<Node>,
    attributes: Vec<Attribute>,
}

/// An element; all ranges are bytes of the text.
pub(super) struct Node {
    /// From its `<` to behind its end tag.
    pub span: Range<usize>,
    pub name: Range<usize>,
    /// Between its tags; of an empty element, nothing at its end.
    pub inside: Range<usize>,
    /// Written as `<name/>`.
    pub is_empty: bool,
    attributes: Range<usize>,
    /// The index behind its last descendant.
    last: usize,
    /// Of the root, itself.
    pub parent: usize,
}

/// An attribute; ranges of the text.
pub(super) struct Attribute {
    pub name: Range<usize>,
    /// Between the quotes.
    pub value: Range<usize>,
}

impl Attribute {
    /// Behind the closing quote.
    pub fn end(&self) -> usize {
        self.value.end + 1
    }
}

impl<'t> Tree<'t> {
    /// `None`: not a whole document with one root, or nested deeper than a plan may be.
    pub fn parse(text: &'t str) -> Option<Self> {
        let mut tree = Self { text, nodes: Vec::new(), attributes: Vec::new() };
        let mut reader = Reader::from_str(text);
        let mut open = Vec::new();
        loop {
            let start = reader.buffer_position() as usize;
            let event = reader.read_event().ok()?;
            let end = reader.buffer_position() as usize;
            match event {
                Event::Start(tag) if open.len() < MAX_DEPTH => {
                    tree.open(&tag, start..end, open.last(), false)?;
                    open.push(tree.nodes.len() - 1);
                }
                Event::Start(_) | Event::DocType(_) => return None,
                Event::Empty(tag) => tree.open(&tag, start..end, open.last(), true)?,
                Event::End(_) => tree.close(open.pop()?, start..end),
                Event::Eof => break,
                _ => {}
            }
        }
        let one_root = tree.nodes.first().is_some_and(|root| root.last == tree.nodes.len());
        (one_root && open.is_empty()).then_some(tree)
    }

    fn open(
        &mut self,
        tag: &BytesStart,
        span: Range<usize>,
        parent: Option<&usize>,
        is_empty: bool,
    ) -> Option<()> {
        let name = span.start + 1..span.start + 1 + tag.name().0.len();
        let list_end = span.end - if is_empty { 2 } else { 1 };
        let first = self.attributes.len();
        let text = self.text;
        for raw in Attributes::new(text.get(name.end..list_end)?, 0).with_checks(false) {
            let Raw { key: QName(key), value: Cow::Borrowed(value) } = raw.ok()? else { return None };
            self.attributes.push(Attribute { name: range_in(text, key)?, value: range_in(text, value)? });
        }
        self.nodes.push(Node {
            inside: span.end..span.end,
            attributes: first..self.attributes.len(),
            last: self.nodes.len() + 1,
            parent: parent.copied().unwrap_or(0),
            span,
            name,
            is_empty,
        });
        Some(())
    }

    fn close(&mut self, node: usize, tag: Range<usize>) {
        let last = self.nodes.len();
        let node = &mut self.nodes[node];
        node.inside.end = tag.start;
        node.span.end = tag.end;
        node.last = last;
    }

    /// A piece of the text.
    pub fn slice(&self, range: Range<usize>) -> &'t str {
        self.text.get(range).unwrap_or("")
    }

    /// An element with everything in it.
    pub fn whole(&self, node: usize) -> &'t str {
        self.slice(self.nodes[node].span.clone())
    }

    pub fn name(&self, node: usize) -> &'t str {
        self.slice(self.nodes[node].name.clone())
    }

    pub fn start_tag(&self, node: usize) -> &'t str {
        let node = &self.nodes[node];
        self.slice(node.span.start..node.inside.start)
    }

    pub fn children(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let last = self.nodes[node].last;
        let next = move |child: &usize| Some(self.nodes[*child].last).filter(|next| *next < last);
        std::iter::successors(Some(node + 1).filter(|first| *first < last), next)
    }

    /// An element and its descendants.
    pub fn below(&self, node: usize) -> Range<usize> {
        node..self.nodes[node].last
    }

    pub fn attributes(&self, node: usize) -> &[Attribute] {
        &self.attributes[self.nodes[node].attributes.clone()]
    }

    pub fn attribute(&self, node: usize, name: &str) -> Option<&Attribute> {
        self.attributes(node).iter().find(|a| self.slice(a.name.clone()) == name)
    }

    /// The value of an attribute as it is written.
    pub fn value(&self, node: usize, name: &str) -> Option<&'t str> {
        self.attribute(node, name).map(|a| self.slice(a.value.clone()))
    }

    /// What distinguishes an element from others, as far as it has an identifier.
    pub fn key(&self, node: usize) -> Option<Key<'t>> {
        let name = self.name(node);
        if LISTS.contains(&name) {
            return Some(Key { class: name, id: Cow::Borrowed("") });
        }
        let attribute = if matches!(name, "variable" | "parameter" | "argument") { "name" } else { "id" };
        let raw = self.value(node, attribute)?;
        let plain = Raw { key: QName(attribute), value: Cow::Borrowed(raw) };
        let id = plain.normalized_value(Implicit1_0).ok()?;
        let class = match name {
            _ if is_leg(name) => "leg",
            "keepIn" | "keepOut" => "zone",
            _ => name,
        };
        Some(Key { class, id: if id.trim() == id { id } else { Cow::Owned(id.trim().into()) } })
    }
}

/// An identifier among the elements of one sort: a leg stays the same leg when its kind changes.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) struct Key<'t> {
    class: &'t str,
    id: Cow<'t, str>,
}

/// Where a slice of a text stands in it.
fn range_in(text: &str, slice: &str) -> Option<Range<usize>> {
    let start = (slice.as_ptr() as usize).checked_sub(text.as_ptr() as usize)?;
    Some(start..start + slice.len()).filter(|range| range.end <= text.len())
}
