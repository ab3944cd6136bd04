//! The tree by keyboard: where the arrows lead.

use super::rows::Row;
use egui::{InputState, Key, Modifiers};
use std::collections::BTreeSet;

/// What a key does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    /// To another row; `true`: what is on the way is selected, too.
    To(usize, bool),
    /// Opens or closes the row.
    Fold,
    /// Opens the row's menu.
    Menu,
}

/// Takes the keys for the row with the keyboard; `page` rows are in view.
pub(super) fn read(
    input: &mut InputState,
    rows: &[Row],
    at: usize,
    folded: &BTreeSet<String>,
    page: usize,
) -> Option<Step> {
    const KEYS: [Key; 8] = [
        Key::ArrowUp,
        Key::ArrowDown,
        Key::ArrowLeft,
        Key::ArrowRight,
        Key::Home,
        Key::End,
        Key::PageUp,
        Key::PageDown,
    ];
    if input.consume_key(Modifiers::NONE, Key::Menu) || input.consume_key(Modifiers::SHIFT, Key::F10) {
        return Some(Step::Menu);
    }
    for key in KEYS {
        // first, for a key without Shift is part of the same with it
        for extends in [true, false] {
            let modifiers = if extends { Modifiers::SHIFT } else { Modifiers::NONE };
            if input.consume_key(modifiers, key) {
                return step(rows, at, key, extends, folded, page);
            }
        }
    }
    None
}

fn step(
    rows: &[Row],
    at: usize,
    key: Key,
    extends: bool,
    folded: &BTreeSet<String>,
    page: usize,
) -> Option<Step> {
    let row = rows.get(at)?;
    let last = rows.len() - 1;
    let is_open = row.folds && !folded.contains(&row.key);
    let to = match key {
        Key::ArrowUp => at.saturating_sub(1),
        Key::ArrowDown => (at + 1).min(last),
        Key::PageUp => at.saturating_sub(page),
        Key::PageDown => (at + page).min(last),
        Key::Home => 0,
        Key::End => last,
        Key::ArrowLeft if is_open => return Some(Step::Fold),
        Key::ArrowLeft => parent(rows, at)?,
        Key::ArrowRight if row.folds && !is_open => return Some(Step::Fold),
        Key::ArrowRight => Some(at + 1).filter(|to| rows.get(*to).is_some_and(|r| r.depth > row.depth))?,
        _ => return None,
    };
    (to != at).then_some(Step::To(to, extends))
}

/// The row that one is inside of.
pub(super) fn parent(rows: &[Row], at: usize) -> Option<usize> {
    let depth = rows.get(at)?.depth;
    rows.get(..at)?.iter().rposition(|row| row.depth < depth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_walk_open_and_close() {
        let row = |key: &str, depth, folds| Row { key: key.into(), depth, folds, ..Row::default() };
        let rows = [row("plan", 0, true), row("stage", 1, true), row("a", 2, false), row("b", 2, false)];
        let open = BTreeSet::new();
        let closed = BTreeSet::from(["stage".to_owned()]);
        let to = |index| Some(Step::To(index, false));
        let cases = [
            (0, Key::ArrowUp, &open, None),
            (0, Key::ArrowDown, &open, to(1)),
            (3, Key::ArrowDown, &open, None),
            (3, Key::ArrowLeft, &open, to(1)),
            (1, Key::ArrowLeft, &open, Some(Step::Fold)),
            (1, Key::ArrowRight, &open, to(2)),
            (1, Key::ArrowRight, &closed, Some(Step::Fold)),
            (1, Key::ArrowLeft, &closed, to(0)),
            (2, Key::ArrowRight, &open, None),
            (3, Key::Home, &open, to(0)),
            (0, Key::PageDown, &open, to(2)),
            (0, Key::End, &open, to(3)),
        ];
        for (at, key, folded, expected) in cases {
            assert_eq!(step(&rows, at, key, false, folded, 2), expected, "{at} {key:?}");
        }
    }
}
