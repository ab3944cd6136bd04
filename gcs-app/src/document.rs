//! The plan being edited: immutable states, undo and redo over all of them, and its file.

pub(crate) mod changed;
mod extent;
mod names;

use crate::command::Selection;
use crate::files::Stamp;
use flight_plan::{Edit, FlightPlan, History, Id, Problem, in_names};
use names::Names;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The document.
#[derive(Debug)]
pub struct Document {
    history: History,
    gesture: u64,
    path: Option<PathBuf>,
    /// The file as it was last read or written.
    stamp: Option<Stamp>,
    /// What was in it then.
    text: Option<Arc<str>>,
    reading_problems: Vec<Problem>,
    /// Not everything in its file could be read.
    is_partial: bool,
    names: Names,
    is_large: bool,
    version: u64,
    /// Edits so far, without steps back and forth.
    edits: u64,
    /// The first version.
    id: u64,
    /// Its changes were not wanted any more when another took its place.
    is_discarded: bool,
    /// Another document was saved in its file.
    is_superseded: bool,
    /// Its edits by then, if it had no changes of its own: without more of them nobody misses it.
    superseded_at: Option<u64>,
    /// It was made of a file of another format.
    is_import: bool,
}

impl Default for Document {
    fn default() -> Self {
        Self::new(new_plan(), None, Vec::new())
    }
}

/// An empty plan, for the aircraft that comes with the product.
fn new_plan() -> FlightPlan {
    FlightPlan { name: "New plan".into(), aircraft: "trainer".into(), ..FlightPlan::default() }
}

impl Document {
    /// A plan, where it came from, and what was wrong with its text.
    pub fn new(plan: FlightPlan, path: Option<PathBuf>, reading_problems: Vec<Problem>) -> Self {
        let mut document = Self {
            history: History::new(plan),
            gesture: 0,
            path,
            stamp: None,
            text: None,
            is_partial: reading_problems.iter().any(Problem::is_error),
            reading_problems,
            names: Names::default(),
            is_large: false,
            version: 0,
            edits: 0,
            id: 0,
            is_discarded: false,
            is_superseded: false,
            superseded_at: None,
            is_import: false,
        };
        document.changed();
        document.id = document.version;
        document
    }

    /// A plan from the text of a document; whatever is wrong with it, it opens.
    pub fn read(bytes: &[u8], path: Option<PathBuf>) -> Self {
        let reading = flight_plan::read(bytes);
        let text = std::str::from_utf8(bytes).ok().map(Arc::from);
        let losses = reading.losses().cloned().collect();
        Self { text, ..Self::new(reading.plan, path, losses) }
    }

    /// Takes over what another program wrote in its file, as a step that can be undone.
    pub fn reread(&mut self, theirs: Self) {
        // of a large plan no frame can wait for them: they were looked up where it was read
        self.names = theirs.names;
        self.replace(theirs.history.plan().as_ref().clone());
        (self.reading_problems, self.is_partial) = (theirs.reading_problems, theirs.is_partial);
        (self.text, self.stamp) = (theirs.text, theirs.stamp);
        self.history.mark_saved();
    }

    /// A plan that was never saved to its file; it differs from that.
    pub fn recovered(bytes: &[u8], path: Option<PathBuf>) -> Self {
        Self { path, ..Self::unsaved(flight_plan::read(bytes).plan) }
    }

    /// A plan that is in no file yet, and that somebody would miss.
    pub fn unsaved(plan: FlightPlan) -> Self {
        let mut document = Self::new(plan, None, Vec::new());
        document.history.mark_unsaved();
        document
    }

    /// A plan from a file of another format, which holds it still.
    pub fn imported(plan: FlightPlan) -> Self {
        Self { is_import: true, ..Self::unsaved(plan) }
    }

    /// The plan.
    pub fn plan(&self) -> &Arc<FlightPlan> {
        self.history.plan()
    }
    /// The same for all versions of a document, and for no other document; never 0.
    pub fn id(&self) -> u64 {
        self.id
    }
    /// Differs whenever the plan differs.
    pub fn version(&self) -> u64 {
        self.version
    }
    /// Differs whenever somebody worked on it; steps back and forth are no work.
    pub fn edits(&self) -> u64 {
        self.edits
    }
    /// What was wrong with the text, until the first edit.
    pub fn reading_problems(&self) -> &[Problem] {
        &self.reading_problems
    }
    /// Its file.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }
    /// Its file's name, or what there is instead.
    pub fn file_name(&self) -> String {
        let name = self.path.as_deref().and_then(Path::file_name);
        name.map_or_else(|| "not saved yet".into(), |n| n.to_string_lossy().into_owned())
    }
    /// It differs from its file.
    pub fn is_dirty(&self) -> bool {
        !self.history.is_saved()
    }
    /// It differs from its file, and nobody said that it need not be kept.
    pub fn would_be_missed(&self) -> bool {
        self.is_dirty() && !self.is_discarded && self.superseded_at != Some(self.edits)
    }
    /// It is in another file as it came from there: nobody worked on it.
    pub fn is_untouched_import(&self) -> bool {
        self.is_import && self.edits == 0
    }
    /// Its changes are not wanted any more.
    pub fn is_discarded(&self) -> bool {
        self.is_discarded
    }
    /// Its changes are not wanted any more, or wanted again. Whoever edits it wants them.
    pub fn set_discarded(&mut self, is_discarded: bool) {
        self.is_discarded = is_discarded;
    }
    /// Another document was saved in its file: written over it, that would be lost.
    pub fn is_superseded(&self) -> bool {
        self.is_superseded
    }
    /// Its file holds what could not be read: written over it, that would be lost.
    pub fn is_partial(&self) -> bool {
        self.is_partial
    }
    /// It has no file and was never edited: nothing is lost when another takes its place.
    pub fn is_nobodys(&self) -> bool {
        self.path.is_none() && !self.is_dirty() && !self.can_undo() && !self.can_redo()
    }
    /// About what it and its history hold, bytes.
    pub fn bytes(&self) -> usize {
        self.history.bytes() + self.text.as_ref().map_or(0, |text| text.len())
    }
    /// It has so many parts that what is worked out of it takes longer than a frame has.
    pub fn is_large(&self) -> bool {
        self.is_large
    }
    /// There is a step to take back.
    pub fn can_undo(&self) -> bool {
        self.history.can_undo()
    }
    /// There is a step to redo.
    pub fn can_redo(&self) -> bool {
        self.history.can_redo()
    }
    /// What a leg is called in the document; empty for one that is not there.
    pub fn kind_name(&self, leg: &Id) -> &'static str {
        self.names.kind(leg).unwrap_or_default()
    }

    /// What people call a part of the plan: its name, else its identifier.
    pub fn label<'a>(&'a self, id: &'a Id) -> &'a str {
        self.names.name(id).unwrap_or(id.as_str())
    }

    /// The procedure that a leg calls; `None`: it is no call.
    pub fn called(&self, leg: &Id) -> Option<&Id> {
        self.names.called(leg)
    }

    /// A sentence about the plan, with names in the place of the identifiers that stand in it as `` `id` ``.
    pub fn in_names(&self, sentence: &str) -> String {
        in_names(sentence, |id| self.names.name(id).or_else(|| self.names.name(&self.written(id))))
    }

    /// The leg of the document that a flown one stands for: that of the procedure, where it was made by a call.
    pub fn written(&self, flown: &Id) -> Id {
        let text = flown.as_str();
        let inner = text.match_indices('.').filter_map(|(dot, _)| text.get(dot + 1..)).map(Id::new);
        let mut made = inner.filter(|_| self.names.kind(flown).is_none());
        made.find(|id| self.plan().procedure_leg(id).is_some()).unwrap_or_else(|| flown.clone())
    }

    /// The call in the stages that has made a flown leg; `None`: it is a leg of the document itself.
    pub fn call_of(&self, flown: &Id) -> Option<Id> {
        if self.names.kind(flown).is_some() {
            return None;
        }
        let text = flown.as_str();
        let mut outer = text.match_indices('.').filter_map(|(dot, _)| text.get(..dot)).map(Id::new);
        outer.find(|id| self.names.kind(id) == Some("call"))
    }

    /// A flown leg is wanted as itself, as the call that has made it, or as the leg of the procedure that it stands for.
    pub fn is_wanted(&self, flown: &Id, wanted: impl Fn(&Id) -> bool) -> bool {
        // only what a call has made has a dot: it is looked up
        let is_made = || flown.as_str().contains('.') && self.names.kind(flown).is_none();
        wanted(flown)
            || (is_made()
                && (wanted(&self.written(flown)) || self.call_of(flown).is_some_and(|call| wanted(&call))))
    }

    /// What a flown leg is in the document: a leg, also of a procedure, or a stage that is flown without legs.
    pub fn part_of(&self, flown: &Id) -> Selection {
        let written = self.written(flown);
        let is_stage = self.plan().all_stages().any(|(_, stage)| stage.id == written);
        if is_stage { Selection::Stage(written) } else { Selection::Leg(written) }
    }

    /// Replaces the plan by another one, as a step that can be undone.
    pub fn replace(&mut self, plan: FlightPlan) {
        self.history.replace(plan);
        self.edits += 1;
        self.changed();
    }

    /// Applies an edit as a step of its own. The sentence says why it can't be done.
    pub fn edit(&mut self, edit: &Edit) -> Result<(), String> {
        self.apply(edit, None)
    }

    /// Applies an edit as part of a gesture: everything until [`Document::end_gesture`] is one step.
    pub fn drag_edit(&mut self, edit: &Edit) -> Result<(), String> {
        self.apply(edit, Some(self.gesture))
    }

    /// The gesture is over.
    pub fn end_gesture(&mut self) {
        self.gesture += 1;
        self.history.end_gesture();
    }

    fn apply(&mut self, edit: &Edit, gesture: Option<u64>) -> Result<(), String> {
        self.history.apply(edit, gesture).map_err(|error| error.to_string())?;
        self.edits += 1;
        self.changed();
        Ok(())
    }

    /// Takes the last step back.
    pub fn undo(&mut self) {
        if self.history.undo() {
            self.changed();
        }
    }

    /// Redoes the last step that was taken back.
    pub fn redo(&mut self) {
        if self.history.redo() {
            self.changed();
        }
    }

    /// A version of it was written to `path`, which is its file now, in these words.
    pub fn saved(&mut self, version: u64, path: PathBuf, text: Arc<str>, stamp: Option<Stamp>) {
        (self.path, self.text, self.stamp) = (Some(path), Some(text), stamp);
        (self.is_partial, self.is_superseded, self.superseded_at) = (false, false, None);
        if version == self.version {
            self.history.mark_saved();
        } else {
            // what is shown now may be what the file had before
            self.history.mark_unsaved();
        }
    }

    /// Another document was saved in its file, which is in this state now.
    pub fn superseded(&mut self, stamp: Option<Stamp>) {
        if !self.is_dirty() {
            self.superseded_at = Some(self.edits);
        }
        (self.is_superseded, self.stamp) = (true, stamp);
        self.history.mark_unsaved();
    }

    /// Its file no longer has it.
    pub fn differs_from_file(&mut self) {
        self.history.mark_unsaved();
    }

    /// The text of its file as it was last read or written.
    pub fn text(&self) -> Option<&Arc<str>> {
        self.text.as_ref()
    }

    /// The file's state as it was last read or written; `None`: not known, or of no importance.
    pub fn stamp(&self) -> Option<Stamp> {
        self.stamp
    }

    /// Remembers the state of the file that it was read from; `None`: it may be overwritten whatever it is now.
    pub fn set_stamp(&mut self, stamp: Option<Stamp>) {
        self.stamp = stamp;
    }

    fn changed(&mut self) {
        self.is_discarded = false;
        if self.version > 0 {
            self.reading_problems.clear();
        }
        self.names.refresh(self.history.plan());
        self.is_large = extent::is_large(self.history.plan());
        // versions are never used twice, not even by another document of this run
        self.version = next_version();
    }
}

fn next_version() -> u64 {
    use std::sync::atomic::{AtomicU64, Ordering};
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_plan::Fix;
    use geometry::LatLon;

    fn document() -> Document {
        let fix = Fix {
            id: "A".into(),
            position: LatLon::new(1.0, 1.0),
            name: String::new(),
            description: String::new(),
        };
        Document::new(FlightPlan { fixes: vec![fix], ..new_plan() }, None, Vec::new())
    }

    #[test]
    fn a_leg_that_a_call_made_is_wanted_with_the_call_and_with_the_procedures_leg() {
        let plan = r#"<flightPlan xmlns="urn:legwork:flight-plan:1"><procedures><procedure id="look" reference="46 9">
            <TF id="near" lat="46" lon="9"/></procedure></procedures><mainPlan><stage id="m" type="mission">
            <call id="c1" procedure="look"/><call id="c2" procedure="look"/><TF id="b" lat="46.1" lon="9"/></stage></mainPlan></flightPlan>"#;
        let d = Document::new(flight_plan::read(plan).plan, None, Vec::new());
        let with = |wanted: &str| {
            let flown = ["c1.near", "c2.near", "b"].into_iter();
            flown
                .filter(|flown| d.is_wanted(&(*flown).into(), |id| id.as_str() == wanted))
                .collect::<Vec<_>>()
        };
        assert_eq!(with("c2"), ["c2.near"]);
        assert_eq!(with("near"), ["c1.near", "c2.near"]);
        assert_eq!((with("b"), with("m"), with("c2.near")), (vec!["b"], vec![], vec!["c2.near"]));
    }

    fn moved(lat: f64) -> Edit {
        Edit::MoveFix { fix: "A".into(), to: LatLon::new(lat, 1.0) }
    }

    fn latitude(d: &Document) -> f64 {
        d.plan().fixes[0].position.lat_deg
    }

    #[test]
    fn what_was_read_again_is_called_as_it_is_there_and_undone_as_before() {
        let named = |name: &str| {
            let mut plan = document().plan().as_ref().clone();
            plan.fixes[0].name = name.into();
            Document::new(plan, None, Vec::new())
        };
        let mut d = named("mine");
        d.reread(named("theirs"));
        assert!(d.label(&"A".into()) == "theirs" && !d.is_dirty());
        d.undo();
        assert_eq!(d.label(&"A".into()), "mine");
    }

    #[test]
    fn a_drag_is_one_step_and_undo_is_exact() {
        let mut d = document();
        let before = d.plan().clone();
        for lat in [2.0, 3.0, 4.0] {
            d.drag_edit(&moved(lat)).unwrap();
        }
        d.end_gesture();
        d.drag_edit(&moved(5.0)).unwrap();
        d.end_gesture();
        assert!(d.is_dirty());
        d.undo();
        assert_eq!(latitude(&d), 4.0, "the second drag is a step of its own");
        d.undo();
        assert_eq!(*d.plan(), before);
        assert!(!d.can_undo() && !d.is_dirty());
        d.redo();
        d.redo();
        assert_eq!(latitude(&d), 5.0);
        assert!(!d.can_redo());
    }

    #[test]
    fn a_new_edit_forgets_what_was_undone() {
        let mut d = document();
        d.edit(&moved(2.0)).unwrap();
        d.undo();
        d.edit(&moved(3.0)).unwrap();
        assert!(!d.can_redo());
        assert_eq!(latitude(&d), 3.0);
    }

    #[test]
    fn an_edit_that_cannot_be_done_says_why_and_changes_nothing() {
        let mut d = document();
        let refused = d.edit(&Edit::MoveFix { fix: "nowhere".into(), to: LatLon::new(0.0, 0.0) });
        assert!(refused.unwrap_err().contains("nowhere"));
        assert!(!d.can_undo());
    }

    #[test]
    fn a_broken_text_opens_with_its_problems_until_it_is_edited() {
        let mut d = Document::read(b"<flightPlan", None);
        assert!(!d.reading_problems().is_empty());
        d.replace(new_plan());
        assert!(d.reading_problems().is_empty());
    }
}
