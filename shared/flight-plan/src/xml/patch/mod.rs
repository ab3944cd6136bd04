//! Saving a plan into the text that it was read from: comments, layout and wording of what was not edited stay.
//!
//! The canonical documents before and after the edits are compared, and what differs is carried over to the text. An element is found
//! again by its identifier, also where it moved; a new one is indented as its neighbours. What comes out is read: if it isn't the plan
//! (a text may say things in ways that no rule here knows), the canonical document takes its place.

mod carry;
mod layout;
mod pairs;
mod tree;

use super::{read, write};
use crate::FlightPlan;
use carry::Carry;
use layout::Layout;
use pairs::{Pairs, places};
use tree::Tree;

/// The text of a document, changed as little as possible so that it reads as `plan`. It has no problem that the text had not;
/// where that can't be, it is the canonical document. A plan that was not edited gives the very text.
pub fn patch(original: &str, plan: &FlightPlan) -> String {
    let before = read(original);
    let (old, new) = (write(&before.plan), write(plan));
    if old == new {
        return original.into();
    }
    let says_it = |text: &String| {
        let after = read(text);
        after.losses().count() <= before.losses().count() && write(&after.plan) == new
    };
    carried(original, &old, &new).filter(says_it).unwrap_or(new)
}

fn carried(original: &str, old: &str, new: &str) -> Option<String> {
    let (mark, text) = original.strip_prefix('\u{feff}').map_or(("", original), |text| ("\u{feff}", text));
    let (o, a, b) = (Tree::parse(text)?, Tree::parse(old)?, Tree::parse(new)?);
    let (pairs, places) = (Pairs::of(&a, &b), places(&o, &a));
    let carry = Carry { o: &o, a: &a, b: &b, pairs, places, layout: Layout::of(&o) };
    carry.text().map(|text| format!("{mark}{text}"))
}
