//! What changed in one part, as phrases: its attributes, then what stands inside it.

use crate::xml::{self, Piece};
use std::collections::BTreeMap;

/// Empty: nothing.
pub(super) fn between(old: &Piece, new: &Piece) -> Vec<String> {
    let (old, new) = (xml::text(old), xml::text(new));
    if old == new {
        return Vec::new();
    }
    let (old, new) = (Element::of(&old), Element::of(&new));
    let mut words = Vec::new();
    if old.name != new.name {
        words.push(format!("{} → {}", old.name, new.name));
    }
    for (name, value) in &new.attributes {
        match old.attribute(name) {
            None => words.push(format!("{name} {value} added")),
            Some(was) if was != value => words.push(format!("{name} {was} → {value}")),
            Some(_) => {}
        }
    }
    let gone = old.attributes.iter().filter(|(name, _)| new.attribute(name).is_none());
    words.extend(gone.map(|(name, value)| format!("{name} {value} removed")));
    let mut names: Vec<&str> = old.children.keys().chain(new.children.keys()).copied().collect();
    names.sort_unstable();
    names.dedup();
    words.extend(
        names.into_iter().filter_map(|name| children(name, old.children.get(name), new.children.get(name))),
    );
    words
}

fn children(name: &str, old: Option<&Vec<&str>>, new: Option<&Vec<&str>>) -> Option<String> {
    if old == new {
        return None;
    }
    // an element's first line begins it, deeper ones are what is in it
    let count = |lines: Option<&Vec<&str>>| {
        lines
            .into_iter()
            .flatten()
            .filter(|line| line.starts_with("  <") && !line.starts_with("  </"))
            .count()
    };
    Some(match (count(old), count(new)) {
        (0, _) => format!("{name} added"),
        (_, 0) => format!("{name} removed"),
        (before, now) if before == now => format!("{name} changed"),
        (before, now) => format!("{name}: {now} instead of {before}"),
    })
}

/// A canonical element, taken apart.
struct Element<'a> {
    name: &'a str,
    attributes: Vec<(&'a str, String)>,
    /// Lines by the name of the child that they are of.
    children: BTreeMap<&'a str, Vec<&'a str>>,
}

impl<'a> Element<'a> {
    fn of(text: &'a str) -> Self {
        let mut lines = text.lines();
        let first =
            lines.next().unwrap_or("").trim_start_matches('<').trim_end_matches('>').trim_end_matches('/');
        let (name, attributes) = first.split_once(' ').unwrap_or((first, ""));
        let mut children: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        let mut child = "";
        for line in lines.filter(|line| line.starts_with("  ")) {
            if let Some(tag) = line.strip_prefix("  <").filter(|tag| !tag.starts_with('/')) {
                child = tag.split([' ', '>', '/']).next().unwrap_or("");
            }
            children.entry(child).or_default().push(line);
        }
        Self { name, attributes: xml::attributes(attributes), children }
    }

    fn attribute(&self, name: &str) -> Option<&String> {
        self.attributes.iter().find(|(n, _)| *n == name).map(|(_, value)| value)
    }
}
