//! What differs between two canonical documents, as changes to the text that was read to the first.

use super::layout::{Layout, indent, indented, line_tail, lines_of, with_comments};
use super::pairs::Pairs;
use super::tree::{Attribute, Tree};
use std::ops::Range;

/// What ways there are to say a place: who changes one of them may have to take another away.
const PLACES: [&str; 5] = ["fix", "lat", "lon", "at", "centre"];

/// Something that stands in the place of a piece of text.
pub(super) struct Change {
    span: Range<usize>,
    text: String,
}

/// The three documents: what the user wrote (`o`), and the canonical ones before (`a`) and after (`b`).
pub(super) struct Carry<'c, 't> {
    pub o: &'c Tree<'t>,
    pub a: &'c Tree<'t>,
    pub b: &'c Tree<'t>,
    pub pairs: Pairs,
    /// Where each element of `a` stands in `o`.
    pub places: Vec<Option<usize>>,
    pub layout: Layout,
}

/// Where the children of an element go on: elements of `o`, and the changes so far.
struct Run<'r> {
    parent: usize,
    /// The last child that stays.
    last: Option<usize>,
    /// New children of an element that had none.
    first: String,
    changes: &'r mut Vec<Change>,
}

impl Carry<'_, '_> {
    /// The user's text as it says what `b` does. `None`: it can't be carried over.
    pub fn text(&self) -> Option<String> {
        let mut changes = Vec::new();
        self.element(0, &mut changes)?;
        changed(self.o, 0..self.o.text.len(), changes)
    }

    /// An element of `b` that stays where it was in `o`.
    fn element(&self, b: usize, changes: &mut Vec<Change>) -> Option<()> {
        let a = self.pairs.before[b]?;
        if self.a.whole(a) == self.b.whole(b) {
            return Some(());
        }
        let o = self.places[a]?;
        self.rename(o, a, b, changes);
        self.attributes(o, a, b, changes);
        self.children(o, a, b, changes)
    }

    fn rename(&self, o: usize, a: usize, b: usize, changes: &mut Vec<Change>) {
        let (old, new) = (self.a.name(a), self.b.name(b));
        if old == new {
            return;
        }
        let node = &self.o.nodes[o];
        changes.push(Change { span: node.name.clone(), text: new.into() });
        if !node.is_empty {
            let name = node.inside.end + 2..node.inside.end + 2 + old.len();
            changes.push(Change { span: name, text: new.into() });
        }
    }

    fn attributes(&self, o: usize, a: usize, b: usize, changes: &mut Vec<Change>) {
        let differs = |name: &str| self.a.value(a, name) != self.b.value(b, name);
        let place_differs = PLACES.iter().any(|name| differs(name));
        let mut end_of_last = self.o.nodes[o].name.end;
        for attribute in self.o.attributes(o) {
            let name = self.o.slice(attribute.name.clone());
            let another_way = place_differs && PLACES.contains(&name) && self.a.value(a, name).is_none();
            if self.b.value(b, name).is_none() && (another_way || self.a.value(a, name).is_some()) {
                changes.push(Change { span: end_of_last..attribute.end(), text: String::new() });
            }
            end_of_last = attribute.end();
        }
        let mut behind = self.o.nodes[o].name.end;
        for attribute in self.b.attributes(b) {
            let name = self.b.slice(attribute.name.clone());
            let there = self.o.attribute(o, name);
            if differs(name) || (place_differs && PLACES.contains(&name) && there.is_none()) {
                changes.push(self.set(o, name, self.b.slice(attribute.value.clone()), behind));
            }
            behind = there.map_or(behind, Attribute::end);
        }
    }

    /// An attribute with a new value, in its own quotes; a new one behind another.
    fn set(&self, o: usize, name: &str, value: &str, behind: usize) -> Change {
        let Some(there) = self.o.attribute(o, name) else {
            let last = self.o.attributes(o).last();
            let before = last.map_or("", |last| self.o.slice(0..last.name.start));
            let space = before.get(before.trim_end().len()..).filter(|s| s.contains('\n')).unwrap_or(" ");
            return Change { span: behind..behind, text: format!("{space}{name}=\"{value}\"") };
        };
        let is_single = self.o.slice(there.value.end..there.end()) == "'";
        let text = if is_single { value.replace('\'', "&apos;") } else { value.into() };
        Change { span: there.value.clone(), text }
    }

    fn children(&self, o: usize, a: usize, b: usize, changes: &mut Vec<Change>) -> Option<()> {
        for child in self.a.children(a) {
            match self.pairs.after[child] {
                None => self.remove(self.places[child]?, changes),
                Some(b) if self.pairs.moved[b] => {
                    let piece = with_comments(self.o, self.places[child]?);
                    changes.push(self.without(&piece));
                }
                Some(_) => {}
            }
        }
        let mut run = Run { parent: o, last: None, first: String::new(), changes };
        for child in self.b.children(b) {
            let from = self.pairs.before[child].filter(|_| !self.pairs.moved[child]);
            match from {
                Some(from) => {
                    self.element(child, run.changes)?;
                    run.last = self.places[from].or(run.last);
                }
                None => self.insert(child, &mut run)?,
            }
        }
        self.fill(b, run);
        Some(())
    }

    /// A list that is emptied keeps the comments in it.
    fn remove(&self, o: usize, changes: &mut Vec<Change>) {
        let is_list = self.o.nodes[o].parent == 0 && self.o.children(o).next().is_some();
        if is_list && self.o.whole(o).contains("<!--") {
            changes.extend(self.o.children(o).map(|child| self.without(&self.o.nodes[child].span)));
        } else {
            changes.push(self.without(&self.o.nodes[o].span));
        }
    }

    fn without(&self, piece: &Range<usize>) -> Change {
        Change { span: lines_of(self.o, piece), text: String::new() }
    }

    /// A list that the user began and that was empty.
    fn begun(&self, b: usize) -> Option<usize> {
        let name = self.b.name(b);
        let mut empty = self.o.children(0).filter(|list| self.o.name(*list) == name);
        empty.find(|list| !self.places.contains(&Some(*list)))
    }

    /// Puts a new child behind the last one that stays.
    fn insert(&self, b: usize, run: &mut Run) -> Option<()> {
        if let Some(list) = Some(b).filter(|_| run.parent == 0).and_then(|b| self.begun(b)) {
            let mut inside = Run { parent: list, last: None, first: String::new(), changes: run.changes };
            self.b.children(b).try_for_each(|child| self.insert(child, &mut inside))?;
            self.fill(b, inside);
            return Some(());
        }
        let indent = self.layout.of_child(self.o, run.parent, run.last);
        let lead = indent.as_deref().map_or(String::new(), |i| format!("{}{i}", self.layout.newline));
        let text = lead + &self.render(b, indent.as_deref())?;
        let parent = &self.o.nodes[run.parent];
        if parent.is_empty {
            run.first += &text;
            return Some(());
        }
        let behind = run.last.map_or(parent.inside.start, |last| self.o.nodes[last].span.end);
        let at = if indent.is_some() { line_tail(self.o.text, behind) } else { behind };
        run.changes.push(Change { span: at..at, text });
        Some(())
    }

    /// An empty element that has children now.
    fn fill(&self, b: usize, run: Run) {
        if run.first.is_empty() {
            return;
        }
        let o = &self.o.nodes[run.parent];
        let head = self.o.attributes(run.parent).last().map_or(o.name.end, Attribute::end);
        let lead =
            indent(self.o, run.parent).map_or(String::new(), |i| format!("{}{i}", self.layout.newline));
        let text = format!(">{}{lead}</{}>", run.first, self.b.name(b));
        run.changes.push(Change { span: head..o.span.end, text });
    }

    /// An element for a new place: as the user wrote it where it only moved.
    fn render(&self, b: usize, at: Option<&str>) -> Option<String> {
        if let Some(a) = self.pairs.before[b] {
            return self.moved(self.places[a]?, b, at);
        }
        let mut text = self.b.start_tag(b).to_owned();
        if self.b.nodes[b].is_empty {
            return Some(text);
        }
        let deeper = at.map(|indent| self.layout.deeper(indent));
        let mut line = |indent: Option<&str>, content: &str| {
            text.extend(indent.iter().flat_map(|indent| [self.layout.newline, indent]));
            text.push_str(content);
        };
        for child in self.b.children(b) {
            line(deeper.as_deref(), &self.render(child, deeper.as_deref())?);
        }
        line(at, &format!("</{}>", self.b.name(b)));
        Some(text)
    }

    fn moved(&self, o: usize, b: usize, at: Option<&str>) -> Option<String> {
        let mut changes = Vec::new();
        self.element(b, &mut changes)?;
        let text = changed(self.o, with_comments(self.o, o), changes)?;
        Some(indented(&text, indent(self.o, o).unwrap_or(""), at.unwrap_or("")))
    }
}

/// A piece of the text with these changes in it. `None`: two of them touch the same.
fn changed(o: &Tree, piece: Range<usize>, mut changes: Vec<Change>) -> Option<String> {
    changes.sort_by_key(|change| (change.span.start, change.span.end));
    let mut text = String::with_capacity(piece.len());
    let mut at = piece.start;
    for change in &changes {
        if change.span.start < at {
            return None;
        }
        text.push_str(o.slice(at..change.span.start));
        text.push_str(&change.text);
        at = change.span.end;
    }
    text.push_str(o.slice(at..piece.end));
    Some(text)
}
