//! What is being shown and changed: one part of the plan, or several legs together.

use super::super::{Scene, field};
use crate::command::{DocumentCommand, Queue, Selection, ViewCommand};
use flight_plan::describe::{Change, Draft, Kind, OneOf, Property, Quantity, Row, Subject};
use flight_plan::{Edit, Element, FlightPlan, Id, create};

/// A part of the plan, down to one of its elements.
pub struct Page<'a, 's> {
    pub scene: &'a Scene<'s>,
    pub queue: &'a mut Queue,
    /// Where the changes go: to all of them at once. There is always one.
    drafts: &'a [Draft],
    first: &'a Draft,
    /// Which element, by indices among children.
    path: Vec<usize>,
    /// What names begin with inside that element.
    prefix: String,
}

impl<'a, 's> Page<'a, 's> {
    /// `None`: there is nothing to be shown.
    pub fn of(scene: &'a Scene<'s>, drafts: &'a [Draft], queue: &'a mut Queue) -> Option<Self> {
        let first = drafts.first()?;
        Some(Self { scene, queue, drafts, first, path: Vec::new(), prefix: String::new() })
    }

    pub fn plan(&self) -> &'a FlightPlan {
        self.scene.document.plan()
    }

    pub fn subject(&self) -> &'a Subject {
        self.first.subject()
    }

    pub fn draft(&self) -> &'a Draft {
        self.first
    }

    /// The leg or stage it is, if it is one, and its own element is shown.
    pub fn leg_or_stage(&self) -> Option<&'a Id> {
        match self.first.subject() {
            Subject::Leg(id) | Subject::Stage(id) if self.path.is_empty() => Some(id),
            _ => None,
        }
    }

    pub fn is_several(&self) -> bool {
        self.drafts.len() > 1
    }

    /// The element that is shown; of several legs the first one's.
    pub fn element(&self) -> &'a Element {
        // what was there when the path was made is there now
        self.first.element().at(&self.path).unwrap_or(self.first.element())
    }

    /// The elements that are changed together.
    pub fn elements(&self) -> impl Iterator<Item = &'a Element> {
        self.drafts.iter().map(Draft::element)
    }

    /// Each of the legs has it.
    pub fn is_common(&self, row: &Row) -> bool {
        self.drafts.iter().skip(1).all(|draft| draft.description().rows().any(|other| other == row))
    }

    /// All that is changed together.
    pub fn drafts(&self) -> &'a [Draft] {
        self.drafts
    }

    /// Each of several has its own, and is itself by that: the place and the name of a thing, where it is no leg.
    pub fn is_own(&self, property: &Property) -> bool {
        let says_which =
            property.attribute == "name" || matches!(property.kind, Kind::LatLon(_) | Kind::Position);
        self.is_several_things() && says_which
    }

    /// The same of ways in which a place is said.
    pub fn is_own_way(&self, one: &OneOf) -> bool {
        let says_where = |row: &Row| matches!(row, Row::Property(property) if self.is_own(property));
        self.is_several_things() && one.ways.iter().any(|way| way.rows.iter().any(says_where))
    }

    fn is_several_things(&self) -> bool {
        self.is_several() && !matches!(self.first.subject(), Subject::Leg(_))
    }

    /// The change can be made.
    pub fn can(&self, change: &Change) -> bool {
        self.edit(change).is_ok()
    }

    /// The name of a widget.
    pub fn name(&self, label: &str) -> String {
        format!("{}{label}", self.prefix)
    }

    /// Shows a child of the element; names begin with `prefix` meanwhile.
    pub fn inside<R>(&mut self, child: usize, prefix: &str, show: impl FnOnce(&mut Self) -> R) -> R {
        self.path.push(child);
        let outside = self.prefix.len();
        self.prefix.push_str(prefix);
        let result = show(self);
        self.prefix.truncate(outside);
        self.path.pop();
        result
    }

    fn edit(&self, change: &Change) -> Result<Edit, String> {
        let edit = |draft: &Draft| draft.edit(self.plan(), &self.path, change);
        match self.drafts {
            [draft] => edit(draft),
            several => several.iter().map(edit).collect::<Result<_, _>>().map(Edit::All),
        }
    }

    /// What makes these changes of each, together; `None`: of one they can't be made.
    pub fn edit_each(
        &self,
        mut changes: impl FnMut(&Draft, &Element) -> Option<Vec<Change>>,
    ) -> field::Change<Edit> {
        let mut edit = |draft: &Draft| {
            let element = draft.element().at(&self.path)?;
            draft.edit_together(self.plan(), &self.path, &changes(draft, element)?).ok()
        };
        let edits: Option<Vec<Edit>> = self.drafts.iter().map(&mut edit).collect();
        edits.map_or(field::Change::None, |edits| field::Change::Set(Edit::All(edits)))
    }

    /// Why a change can't be made.
    pub fn refuses(&self, change: &Change) -> Option<String> {
        let edit = match self.edit(change) {
            Ok(edit) => edit,
            Err(why) => return Some(why),
        };
        edit.apply(self.plan()).err().map(|why| why.to_string())
    }

    /// Makes a change as one undo step, or says why it can't be made.
    pub fn change(&mut self, change: &Change) {
        match self.edit(change) {
            Ok(edit) => {
                let selection = self.renamed(change, &edit);
                self.queue.edit(edit);
                if selection.is_some() {
                    self.queue.view(ViewCommand::Select(selection));
                }
            }
            Err(why) => self.queue.view(ViewCommand::Notice(why)),
        }
    }

    /// The selection under its new identifier, if the change gives it one.
    fn renamed(&self, change: &Change, edit: &Edit) -> Option<Selection> {
        match change {
            Change::Set(property, Some(to)) if self.path.is_empty() && property.kind == Kind::Identifier => {
                edit.apply(self.plan()).ok()?;
                Some(self.scene.view.selection.as_ref()?.renamed(Id::new(to.trim())))
            }
            _ => None,
        }
    }

    /// Sets a property.
    pub fn set(&mut self, property: &Property, value: Option<String>) {
        self.change(&Change::Set(*property, value));
    }

    /// It is something to be asked of each of the parts.
    pub fn applies(&self, row: &Row) -> bool {
        self.elements().all(|element| row.applies(element))
    }

    /// A new variable with a number's value, which gives it from then on.
    pub fn bind_to_new(&mut self, property: &Property, value: f64) {
        let of = self.element().attribute("id").unwrap_or(&self.element().name);
        let unit = property.quantity().map_or("", Quantity::unit);
        let of = format!("{of}_{}", property.attribute);
        let (name, add) = create::named_variable(self.plan(), &of, value, unit);
        match self.edit(&Change::Set(*property, Some(format!("= {name}")))) {
            Ok(bind) => {
                self.queue.edit(Edit::All(vec![add, bind]));
                self.queue.view(ViewCommand::Select(Some(Selection::Variable(name))));
            }
            Err(why) => self.queue.view(ViewCommand::Notice(why)),
        }
    }

    /// Sets a property as its field is changed: a drag becomes one undo step.
    pub fn send(&mut self, property: &Property, change: field::Change<String>) {
        match change {
            field::Change::None => {}
            field::Change::Moving(value) => {
                if let Ok(edit) = self.edit(&Change::Set(*property, Some(value))) {
                    self.send_edit(field::Change::Moving(edit));
                }
            }
            field::Change::Set(value) => self.set(property, Some(value)),
            field::Change::Ended => self.send_edit(field::Change::Ended),
        }
    }

    /// Makes an edit as a field is changed: a drag becomes one undo step.
    pub fn send_edit(&mut self, change: field::Change<Edit>) {
        match change {
            field::Change::None => {}
            field::Change::Moving(edit) => self.queue.document(DocumentCommand::DragEdit(edit)),
            field::Change::Set(edit) => self.queue.edit(edit),
            field::Change::Ended => self.queue.document(DocumentCommand::EndGesture),
        }
    }
}
