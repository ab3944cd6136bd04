//! The schema of the document, as far as it says which elements have which attributes and which elements inside them.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::{BTreeMap, BTreeSet};

const SCHEMA: &str = include_str!("../../../../assets/schema/flight-plan-1.xsd");

/// A tag of the schema with what is in it.
#[derive(Debug, Default)]
struct Node {
    tag: String,
    attributes: BTreeMap<String, String>,
    children: Vec<Node>,
}

/// What an element may have.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Element {
    pub attributes: BTreeSet<String>,
    pub children: BTreeSet<String>,
}

pub struct Schema {
    root: Node,
    elements: BTreeMap<String, Element>,
}

impl Schema {
    pub fn read() -> Self {
        let mut reader = Reader::from_str(SCHEMA);
        let mut open = vec![Node::default()];
        loop {
            match reader.read_event().unwrap() {
                Event::Start(tag) => open.push(node(&tag)),
                Event::Empty(tag) => open.last_mut().unwrap().children.push(node(&tag)),
                Event::End(_) => {
                    let done = open.pop().unwrap();
                    open.last_mut().unwrap().children.push(done);
                }
                Event::Eof => break,
                _ => {}
            }
        }
        let root = open.pop().unwrap().children.pop().unwrap();
        let mut schema = Self { root, elements: BTreeMap::new() };
        let mut found = BTreeMap::new();
        schema.collect(&schema.root, &mut found);
        // the main plan's association is the plan's own
        let main: Element = found["mainPlan"].clone();
        let plan: &mut Element = found.get_mut("flightPlan").unwrap();
        plan.attributes.extend(main.attributes);
        plan.children.extend(main.children);
        schema.elements = found;
        schema
    }

    pub fn element(&self, name: &str) -> &Element {
        &self.elements[name]
    }

    /// Every element's name.
    pub fn elements(&self) -> BTreeSet<String> {
        self.elements.keys().cloned().collect()
    }

    pub fn legs(&self) -> Vec<String> {
        let mut found = Element::default();
        self.inside(self.named("group", "leg"), &mut found);
        found.children.into_iter().collect()
    }

    /// Elements with an identifier by which they can be selected, and the plan.
    pub fn parts(&self) -> Vec<String> {
        let things = [
            "flightPlan",
            "fix",
            "runway",
            "variable",
            "keepIn",
            "keepOut",
            "procedure",
            "emergencyPlan",
            "stage",
        ];
        things.map(String::from).into_iter().chain(self.legs()).collect()
    }

    pub fn is_part(&self, name: &str) -> bool {
        self.parts().iter().any(|part| part == name)
    }

    /// Every element that is declared anywhere.
    fn collect(&self, node: &Node, into: &mut BTreeMap<String, Element>) {
        if let ("element", Some(name)) = (node.tag.as_str(), node.attributes.get("name")) {
            let mut element = Element::default();
            match node.attributes.get("type") {
                Some(kind) => self.inside(self.named("complexType", local(kind)), &mut element),
                None => self.inside(node, &mut element),
            }
            let before = into.insert(name.clone(), element.clone());
            assert!(before.is_none_or(|before| before == element), "<{name}> is always the same");
        }
        node.children.iter().for_each(|child| self.collect(child, into));
    }

    fn named(&self, tag: &str, name: &str) -> &Node {
        let is_it = |n: &&Node| n.tag == tag && n.attributes.get("name").is_some_and(|n| n == name);
        self.root.children.iter().find(is_it).unwrap_or_else(|| panic!("{tag} {name}"))
    }

    /// What a type, a group or an extension says.
    fn inside(&self, node: &Node, into: &mut Element) {
        if let Some(base) = node.attributes.get("base").filter(|_| node.tag == "extension") {
            self.inside(self.named("complexType", local(base)), into);
        }
        for child in &node.children {
            let name = child.attributes.get("name");
            let refers = child.attributes.get("ref").map(|r| local(r));
            match (child.tag.as_str(), name, refers) {
                ("attribute", Some(name), _) => drop(into.attributes.insert(name.clone())),
                ("element", Some(name), _) => drop(into.children.insert(name.clone())),
                ("attributeGroup" | "group", _, Some(other)) => {
                    self.inside(self.named(&child.tag, other), into)
                }
                ("complexType" | "complexContent" | "extension" | "sequence" | "all" | "choice", ..) => {
                    self.inside(child, into)
                }
                ("annotation" | "unique" | "key" | "keyref", ..) => {}
                other => panic!("the schema has something that this test does not know: {other:?}"),
            }
        }
    }
}

fn node(tag: &BytesStart) -> Node {
    let attribute = |a: quick_xml::events::attributes::Attribute| {
        (a.key.0.to_owned(), a.normalized_value(quick_xml::XmlVersion::Implicit1_0).unwrap().into_owned())
    };
    Node {
        tag: local(tag.name().0).to_owned(),
        attributes: tag.attributes().map(|a| attribute(a.unwrap())).collect(),
        children: Vec::new(),
    }
}

fn local(name: &str) -> &str {
    name.rsplit(':').next().unwrap()
}
