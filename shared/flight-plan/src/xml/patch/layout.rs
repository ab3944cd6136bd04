//! How a document is laid out: indentation, line ends, and what belongs to the line of an element.

use super::tree::Tree;
use std::ops::Range;

/// The habits of a text.
pub(super) struct Layout {
    /// How its lines end.
    pub newline: &'static str,
    /// What each level is indented by.
    unit: String,
}

impl Layout {
    pub fn of(tree: &Tree) -> Self {
        let newline = if tree.text.contains("\r\n") { "\r\n" } else { "\n" };
        let steps = (0..tree.nodes.len()).filter_map(|parent| step(tree, parent));
        Self { newline, unit: steps.take(1).next().unwrap_or("  ").into() }
    }

    /// One level deeper.
    pub fn deeper(&self, indent: &str) -> String {
        format!("{indent}{}", self.unit)
    }

    /// How a new child of an element is indented beside this one, or alone. `None`: it stands in its parent's line.
    pub fn of_child(&self, tree: &Tree, parent: usize, beside: Option<usize>) -> Option<String> {
        match beside.or_else(|| tree.children(parent).next()) {
            Some(sibling) => indent(tree, sibling).map(str::to_owned),
            None => indent(tree, parent).map(|indent| self.deeper(indent)),
        }
    }
}

/// By how much the first child of an element is indented more than itself.
fn step<'t>(tree: &Tree<'t>, parent: usize) -> Option<&'t str> {
    let child = tree.children(parent).next()?;
    indent(tree, child)?.strip_prefix(indent(tree, parent)?).filter(|step| !step.is_empty())
}

/// The indentation of an element that begins its line.
pub(super) fn indent<'t>(tree: &Tree<'t>, node: usize) -> Option<&'t str> {
    let before = tree.slice(0..tree.nodes[node].span.start);
    let indent = before.trim_end_matches([' ', '\t']).len();
    let begins_line = indent == 0 || before.get(..indent)?.ends_with('\n');
    if begins_line { before.get(indent..) } else { None }
}

/// The end of the line behind a place, if nothing but spaces and comments stand there; else the place itself.
pub(super) fn line_tail(text: &str, place: usize) -> usize {
    let mut rest = text.get(place..).unwrap_or("");
    loop {
        rest = rest.trim_start_matches([' ', '\t']);
        if rest.is_empty() || rest.starts_with(['\n', '\r']) {
            return text.len() - rest.len();
        }
        let comment = rest.strip_prefix("<!--").and_then(|inside| inside.split_once("-->"));
        match comment {
            Some((said, behind)) if !said.contains('\n') => rest = behind,
            _ => return place,
        }
    }
}

/// What goes when a piece is taken out: its lines, where it has lines of its own.
pub(super) fn lines_of(tree: &Tree, span: &Range<usize>) -> Range<usize> {
    let behind = tree.slice(span.end..tree.text.len());
    let spaces = behind.len() - behind.trim_start_matches([' ', '\t']).len();
    let ends_line =
        behind.get(spaces..).is_some_and(|rest| rest.is_empty() || rest.starts_with(['\n', '\r']));
    let before = tree.slice(0..span.start).trim_end_matches([' ', '\t']);
    match before.strip_suffix('\n') {
        Some(line) if ends_line => line.strip_suffix('\r').unwrap_or(line).len()..span.end + spaces,
        // spaces in a line go with what they are before
        Some(_) => span.clone(),
        None => before.len()..span.end,
    }
}

/// An element with the comments directly above it, each in lines of its own.
pub(super) fn with_comments(tree: &Tree, node: usize) -> Range<usize> {
    let (span, parent) = (tree.nodes[node].span.clone(), tree.nodes[node].parent);
    // the element before stands in the sibling before, unless it is the parent
    let mut before =
        std::iter::successors(Some(node - usize::from(node > 0)), |n| Some(tree.nodes[*n].parent));
    let sibling = before.find(|n| tree.nodes[*n].parent == parent || *n == parent).filter(|n| *n != parent);
    let from = sibling.map_or(tree.nodes[parent].inside.start, |sibling| tree.nodes[sibling].span.end);
    let mut start = span.start;
    while let Some(comment) = comment_above(tree.slice(from..start)) {
        start = from + comment;
    }
    start..span.end
}

/// Where the comment begins that ends in the line above.
fn comment_above(before: &str) -> Option<usize> {
    let above = before.trim_end_matches([' ', '\t']).strip_suffix('\n')?;
    let said = above.trim_end_matches([' ', '\t', '\r']).strip_suffix("-->")?;
    let start = said.rfind("<!--")?;
    before.get(..start)?.trim_end_matches([' ', '\t']).ends_with('\n').then_some(start)
}

/// Lines that began at one indentation, now at another.
pub(super) fn indented(text: &str, old: &str, new: &str) -> String {
    let mut lines = text.split_inclusive('\n');
    let first = lines.next().unwrap_or("").to_owned();
    lines.fold(first, |mut out, line| {
        match line.strip_prefix(old) {
            Some(rest) if !rest.trim().is_empty() => out.extend([new, rest]),
            _ => out.push_str(line),
        }
        out
    })
}
