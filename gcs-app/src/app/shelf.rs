//! Documents that gave way to others. Undo and redo reach them for as long as the window lives.

use crate::document::Document;

/// So many are kept.
const MOST: usize = 20;

/// The documents before and after the one that is shown, the nearest last.
#[derive(Debug, Default)]
pub(super) struct Shelf {
    before: Vec<Document>,
    after: Vec<Document>,
}

impl Shelf {
    /// Puts another document in the place of this one. One that nobody worked on is not kept.
    pub fn open(&mut self, shown: &mut Document, next: Document) {
        let old = std::mem::replace(shown, next);
        if !old.is_nobodys() {
            self.before.push(old);
        }
        if self.before.len() > MOST {
            self.before.remove(0);
        }
    }

    /// The document takes its last step back; one without steps gives way to the one before it. True: another is shown.
    pub fn undo(&mut self, shown: &mut Document) -> bool {
        if shown.can_undo() {
            shown.undo();
            return false;
        }
        turn(&mut self.before, shown, &mut self.after)
    }

    /// The other way.
    pub fn redo(&mut self, shown: &mut Document) -> bool {
        if shown.can_redo() {
            shown.redo();
            return false;
        }
        turn(&mut self.after, shown, &mut self.before)
    }

    /// There is something to undo.
    pub fn can_undo(&self, shown: &Document) -> bool {
        shown.can_undo() || !self.before.is_empty()
    }

    /// There is something to redo.
    pub fn can_redo(&self, shown: &Document) -> bool {
        shown.can_redo() || !self.after.is_empty()
    }

    /// A document by its number, wherever it is.
    pub fn find<'d>(&'d mut self, shown: &'d mut Document, id: u64) -> Option<&'d mut Document> {
        let kept = self.before.iter_mut().chain(&mut self.after);
        std::iter::once(shown).chain(kept).find(|document| document.id() == id)
    }
}

fn turn(from: &mut Vec<Document>, shown: &mut Document, to: &mut Vec<Document>) -> bool {
    let Some(next) = from.pop() else { return false };
    to.push(std::mem::replace(shown, next));
    true
}
