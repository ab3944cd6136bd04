//! Documents that gave way to others. Undo and redo reach them for as long as the window lives.

use crate::document::Document;
use crate::jobs::discard;
use std::path::Path;

/// Documents on either side hold so much together, bytes; then the oldest without unsaved changes are forgotten.
const MOST_BYTES: usize = 512 << 20;

/// The documents before and after the one that is shown, the nearest last.
#[derive(Debug, Default)]
pub struct Shelf {
    before: Vec<Document>,
    after: Vec<Document>,
    /// The edits of the one that is shown when it was turned to: one more, and redo leads nowhere.
    edits: u64,
    /// Its changes had been given up, and this way it was come to.
    given_up: Option<Way>,
}

/// To which side.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    Back,
    On,
}

impl Shelf {
    /// Puts another document in the place of this one. One that nobody worked on is not kept.
    pub fn open(&mut self, shown: &mut Document, next: Document) {
        self.give_up_redo();
        let old = std::mem::replace(shown, next);
        (self.edits, self.given_up) = (shown.edits(), None);
        if !old.is_nobodys() {
            self.before.push(old);
        }
        forget_oldest(&mut self.before, MOST_BYTES);
        forget_oldest(&mut self.after, MOST_BYTES);
    }

    /// The document takes its last step back; one without steps gives way to the one before it. True: another is shown.
    pub fn undo(&mut self, shown: &mut Document) -> bool {
        if shown.can_undo() {
            shown.undo();
            return false;
        }
        self.settle(shown);
        let taken_back = shown.is_untouched_import();
        let turned = self.turn(shown, Way::Back);
        if let Some(import) = self.after.last_mut().filter(|_| turned && taken_back) {
            import.set_discarded(true);
        }
        turned
    }

    /// The other way.
    pub fn redo(&mut self, shown: &mut Document) -> bool {
        if shown.can_redo() {
            shown.redo();
            return false;
        }
        self.settle(shown);
        self.turn(shown, Way::On)
    }

    /// To the next document on a side. True: another is shown.
    fn turn(&mut self, shown: &mut Document, way: Way) -> bool {
        let from = match way {
            Way::Back => &mut self.before,
            Way::On => &mut self.after,
        };
        let Some(mut next) = from.pop() else {
            self.edits = shown.edits();
            return false;
        };
        // what is shown is wanted; but who goes on the same way, and did nothing to it, only came by
        let came_by = self.given_up == Some(way) && shown.edits() == self.edits;
        shown.set_discarded(came_by);
        (self.edits, self.given_up) = (next.edits(), next.is_discarded().then_some(way));
        next.set_discarded(false);
        let old = std::mem::replace(shown, next);
        match way {
            Way::Back => self.after.push(old),
            Way::On => self.before.push(old),
        }
        true
    }

    /// Who edits the document that is shown does not redo what came after it. Undo still leads there: nothing is lost.
    fn settle(&mut self, shown: &Document) {
        if shown.edits() != self.edits {
            self.give_up_redo();
        }
    }

    fn give_up_redo(&mut self) {
        self.before.append(&mut self.after);
    }

    /// There is something to undo.
    pub fn can_undo(&self, shown: &Document) -> bool {
        shown.can_undo() || !self.before.is_empty()
    }

    /// There is something to redo.
    pub fn can_redo(&self, shown: &Document) -> bool {
        shown.can_redo() || (!self.after.is_empty() && shown.edits() == self.edits)
    }

    /// Documents with unsaved changes, the one that is shown first; none of which the changes were discarded.
    pub fn unsaved<'d>(&'d self, shown: &'d Document) -> impl Iterator<Item = &'d Document> {
        let kept = self.before.iter().chain(&self.after).filter(|document| document.would_be_missed());
        std::iter::once(shown).filter(|document| document.is_dirty()).chain(kept)
    }

    /// Turns to the document with this number. True: another is shown.
    pub fn turn_to(&mut self, shown: &mut Document, id: u64) -> bool {
        let before = self.before.iter().rev().position(|document| document.id() == id);
        let after = self.after.iter().rev().position(|document| document.id() == id);
        let (steps, way) = match (before, after) {
            (Some(steps), _) => (steps, Way::Back),
            (_, Some(steps)) => (steps, Way::On),
            (None, None) => return false,
        };
        for _ in 0..=steps {
            self.turn(shown, way);
        }
        true
    }

    /// A document was saved: others of the same file are not in it any more, and no other program did that.
    pub fn saved(&mut self, shown: &mut Document, id: u64) {
        let Some(saved) = self.find(shown, id) else { return };
        let (Some(path), stamp) = (saved.path().map(Path::to_owned), saved.stamp()) else { return };
        let all = std::iter::once(shown).chain(&mut self.before).chain(&mut self.after);
        let others = all.filter(|other| other.id() != id && other.path() == Some(path.as_path()));
        others.for_each(|other| other.superseded(stamp));
    }

    /// A document by its number, wherever it is.
    pub fn find<'d>(&'d mut self, shown: &'d mut Document, id: u64) -> Option<&'d mut Document> {
        let kept = self.before.iter_mut().chain(&mut self.after);
        std::iter::once(shown).chain(kept).find(|document| document.id() == id)
    }
}

/// One with unsaved changes is never forgotten: it took somebody's work to make it.
fn forget_oldest(documents: &mut Vec<Document>, most_bytes: usize) {
    let mut bytes: usize = documents.iter().map(Document::bytes).sum();
    let is_forgotten = |document: &mut Document| {
        let is_forgotten = bytes > most_bytes && !document.would_be_missed();
        bytes -= if is_forgotten { document.bytes() } else { 0 };
        is_forgotten
    };
    let forgotten: Vec<Document> = documents.extract_if(.., is_forgotten).collect();
    if !forgotten.is_empty() {
        discard(forgotten);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_plan::FlightPlan;

    fn named(name: &str, dirty: bool) -> Document {
        let plan = FlightPlan { name: name.into(), ..FlightPlan::default() };
        match dirty {
            true => Document::unsaved(plan),
            false => Document::new(plan, Some("/a.xml".into()), Vec::new()),
        }
    }

    fn names<'d>(documents: impl Iterator<Item = &'d Document>) -> Vec<String> {
        documents.map(|document| document.plan().name.clone()).collect()
    }

    #[test]
    fn undo_reaches_the_first_of_very_many_documents() {
        let (mut shelf, mut shown) = (Shelf::default(), named("mine", true));
        (0..500).for_each(|round| shelf.open(&mut shown, named(&round.to_string(), false)));
        assert_eq!(std::iter::from_fn(|| shelf.undo(&mut shown).then_some(())).count(), 500);
        assert_eq!(shown.plan().name, "mine");
    }

    #[test]
    fn what_documents_hold_is_bounded_and_unsaved_changes_are_never_forgotten() {
        let mut documents: Vec<Document> = (0..50).map(|i| named(&i.to_string(), i % 10 == 0)).collect();
        let each = documents[0].bytes();
        forget_oldest(&mut documents, 8 * each);
        assert_eq!(names(documents.iter()), ["0", "10", "20", "30", "40", "47", "48", "49"]);
    }

    /// Its changes were given up for another plan, and that was not opened.
    #[test]
    fn what_is_still_shown_is_not_given_up_by_an_undo() {
        let (mut shelf, mut shown) = (Shelf::default(), named("a", false));
        shelf.open(&mut shown, named("b", true));
        shown.set_discarded(true);
        assert!(shelf.undo(&mut shown) && shown.plan().name == "a");
        assert_eq!(names(shelf.unsaved(&shown)), ["b"]);
    }

    /// It took nobody's work, and its file is still there.
    #[test]
    fn an_import_that_was_undone_is_missed_only_when_it_was_worked_on() {
        let import = || Document::imported(FlightPlan { name: "import".into(), ..FlightPlan::default() });
        let (mut shelf, mut shown) = (Shelf::default(), named("mine", true));
        shelf.open(&mut shown, import());
        assert_eq!(names(shelf.unsaved(&shown)), ["import", "mine"]);
        shelf.undo(&mut shown);
        assert_eq!(names(shelf.unsaved(&shown)), ["mine"]);
        shelf.redo(&mut shown);
        assert_eq!(names(shelf.unsaved(&shown)), ["import", "mine"], "it is wanted again");
        shown.replace(FlightPlan { name: "import, edited".into(), ..FlightPlan::default() });
        while shelf.can_undo(&shown) {
            shelf.undo(&mut shown);
        }
        assert_eq!(names(shelf.unsaved(&shown)), ["mine", "import"]);
    }

    /// Undo and redo that go on past it leave it given up; who turns around there, or works on it, has brought it back.
    #[test]
    fn what_was_given_up_stays_so_where_undo_only_comes_past() {
        let (mut shelf, mut shown) = (Shelf::default(), named("first", true));
        shelf.open(&mut shown, named("given up", true));
        shown.set_discarded(true);
        shelf.open(&mut shown, named("last", true));
        assert!(shelf.undo(&mut shown));
        assert_eq!(names(shelf.unsaved(&shown)), ["given up", "first", "last"], "while it is shown");
        assert!(shelf.undo(&mut shown));
        assert_eq!(names(shelf.unsaved(&shown)), ["first", "last"]);
        assert!(shelf.redo(&mut shown) && shelf.redo(&mut shown));
        assert_eq!(names(shelf.unsaved(&shown)), ["last", "first"]);
        assert!(shelf.undo(&mut shown) && shelf.redo(&mut shown));
        assert_eq!(names(shelf.unsaved(&shown)), ["last", "first", "given up"]);
    }

    #[test]
    fn redo_leads_to_no_document_once_another_was_edited_or_opened_and_undo_still_does() {
        let (mut shelf, mut shown) = (Shelf::default(), named("a", true));
        shelf.open(&mut shown, named("b", true));
        shelf.undo(&mut shown);
        assert!(shelf.can_redo(&shown) && shown.plan().name == "a");
        shown.replace(FlightPlan { name: "a, edited".into(), ..FlightPlan::default() });
        assert!(!shelf.can_redo(&shown) && !shelf.redo(&mut shown));
        assert_eq!(shown.plan().name, "a, edited");

        shelf.open(&mut shown, named("c", true));
        assert!(!shelf.can_redo(&shown), "nothing comes after the newest");
        let back = std::iter::from_fn(|| shelf.can_undo(&shown).then(|| shelf.undo(&mut shown)));
        assert_eq!(back.count(), 3);
        let forth = std::iter::from_fn(|| shelf.can_redo(&shown).then(|| shelf.redo(&mut shown)));
        assert_eq!(forth.count(), 3);
        assert_eq!(shown.plan().name, "c");
        assert_eq!(names(shelf.unsaved(&shown)), ["c", "b", "a, edited"]);
    }

    #[test]
    fn a_document_whose_file_another_one_was_saved_in_is_missed_only_when_it_was_edited() {
        let (mut shelf, mut shown) = (Shelf::default(), named("old", false));
        shelf.open(&mut shown, named("new", false));
        shown.replace(FlightPlan { name: "newer".into(), ..FlightPlan::default() });
        let (id, version) = (shown.id(), shown.version());
        shown.saved(version, "/a.xml".into(), "".into(), None);
        shelf.saved(&mut shown, id);
        assert!(names(shelf.unsaved(&shown)).is_empty() && !shown.is_superseded());
        while shelf.can_undo(&shown) {
            shelf.undo(&mut shown);
        }
        assert!(shown.plan().name == "old" && shown.is_dirty() && shown.is_superseded());
        shelf.redo(&mut shown);
        shelf.redo(&mut shown);
        assert!(shown.plan().name == "newer" && names(shelf.unsaved(&shown)).is_empty());
        shelf.undo(&mut shown);
        shelf.undo(&mut shown);
        shown.replace(FlightPlan { name: "old, edited".into(), ..FlightPlan::default() });
        shelf.open(&mut shown, named("other", false));
        assert_eq!(names(shelf.unsaved(&shown)), ["new", "old, edited"]);
    }

    #[test]
    fn turning_to_a_document_keeps_the_order() {
        let (mut shelf, mut shown) = (Shelf::default(), named("a", true));
        for name in ["b", "c", "d"] {
            shelf.open(&mut shown, named(name, true));
        }
        let ids: Vec<u64> = shelf.unsaved(&shown).map(Document::id).collect();
        assert_eq!(names(shelf.unsaved(&shown)), ["d", "a", "b", "c"]);
        assert!(shelf.turn_to(&mut shown, ids[1]) && shown.plan().name == "a");
        assert!(shelf.turn_to(&mut shown, ids[3]) && shown.plan().name == "c");
        assert!(!shelf.turn_to(&mut shown, ids[3]), "it is shown already");
        shelf.redo(&mut shown);
        assert_eq!(shown.plan().name, "d");
    }
}
