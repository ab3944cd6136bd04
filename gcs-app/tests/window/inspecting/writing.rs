//! All that is described can be written: every value, way and list by its own widget, and the document then says what was meant.

use super::{EVERYTHING, Panels, everything, selections};
use crate::recreating::reading::{Next, next};
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers};
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT, Queryable};
use flight_plan::describe::{
    self, Change, Children, Description, Draft, Kind, OneOf, Property, Quantity, Range, Row, Sort, Subject,
};
use flight_plan::{Element, FlightPlan, History, StageKind, Use};
use gcs_app::command::Selection;
use gcs_app::document::Document;
use std::collections::BTreeSet;

/// What is to be done to an element of a part, one after the other, and of which row it is.
struct Wish {
    /// Its element, its row, and what becomes of that.
    what: [String; 3],
    path: Vec<usize>,
    changes: Vec<Change>,
}

/// An element as it is after some changes.
#[derive(Clone, Copy)]
struct At<'e> {
    element: &'e Element,
    path: &'e [usize],
    after: &'e [Change],
}

/// Everything that can be wished of the elements of a part.
struct Wishes<'a> {
    plan: &'a FlightPlan,
    draft: &'a Draft,
    all: Vec<Wish>,
}

impl<'a> Wishes<'a> {
    fn of(plan: &'a FlightPlan, draft: &'a Draft) -> Vec<Wish> {
        let mut wishes = Self { plan, draft, all: Vec::new() };
        let root = At { element: draft.element(), path: &[], after: &[] };
        for (name, label) in draft.description().alike.iter().filter(|(n, _)| *n != root.element.name) {
            wishes.add(root, "Kind", label, Change::Rename(name));
        }
        wishes.rows_of(draft.description(), root);
        wishes.all
    }

    fn add(&mut self, at: At<'_>, row: &str, to: &str, change: Change) {
        let what = [at.element.name.clone(), row.into(), to.into()];
        let changes = [at.after, &[change]].concat();
        self.all.push(Wish { what, path: at.path.to_vec(), changes });
    }

    fn rows_of(&mut self, description: &'static Description, at: At<'_>) {
        description.groups.iter().for_each(|rows| self.rows(rows, at));
    }

    fn rows(&mut self, rows: &'static [Row], at: At<'_>) {
        for row in rows.iter().filter(|row| row.applies(at.element)) {
            match row {
                Row::Property(property) => self.property(property, at),
                Row::OneOf(one) => self.one_of(one, at),
                Row::Children(children) => self.children(children, at),
            }
        }
    }

    fn property(&mut self, property: &Property, at: At<'_>) {
        let now = property.value(at.element);
        for (how, value) in self.others(property, now.as_deref()) {
            self.add(at, property.label, how, Change::Set(*property, Some(value)));
        }
        if property.without.is_some() && now.is_some() {
            self.add(at, property.label, "left out", Change::Set(*property, None));
        }
    }

    /// Every way, and what is said in it.
    fn one_of(&mut self, one: &'static OneOf, at: At<'_>) {
        let now = one.way(at.element);
        for (index, way) in one.ways.iter().enumerate() {
            if Some(index) == now {
                self.rows(way.rows, at);
                continue;
            }
            let choose = Change::Choose(*one, index);
            self.add(at, one.label, way.label, choose.clone());
            let after = [at.after, &[choose]].concat();
            let chosen = changed(self.plan, self.draft, at.path, &after).unwrap();
            let chosen = Draft::of(&chosen, self.draft.subject()).unwrap();
            let element = chosen.element().at(at.path).unwrap();
            self.rows(way.rows, At { element, path: at.path, after: &after });
        }
    }

    fn children(&mut self, children: &'static Children, at: At<'_>) {
        let indices: Vec<usize> = children.indices(at.element).collect();
        for what in children.of {
            if indices.len() < children.most {
                self.add(at, children.label, what.label, Change::Add(what));
            } else if at.element.children[indices[0]].name != what.element {
                self.add(at, children.label, what.label, Change::Become(indices[0], what));
            }
        }
        if indices.len() > children.least {
            let last = *indices.last().unwrap();
            self.add(at, children.label, "removed", Change::Remove(last));
        }
        // the specimen has one of each
        for index in indices.into_iter().filter(|_| at.after.is_empty()) {
            let element = &at.element.children[index];
            let what = children.of.iter().find(|what| what.element == element.name).unwrap();
            self.rows_of(what, At { element, path: &[at.path, &[index]].concat(), after: &[] });
        }
    }

    /// Other values of a property, and how each is said.
    fn others(&self, property: &Property, now: Option<&str>) -> Vec<(&'static str, String)> {
        let value = |text: &str| ("value", text.to_owned());
        let all = match property.kind {
            Kind::Identifier => vec![value("renamed")],
            Kind::Text => vec![value("other & <words>")],
            Kind::Choice(words) => words.iter().map(|(word, _)| value(word)).collect(),
            Kind::Flag => [true, false].map(|flag| value(&flag.to_string())).into(),
            Kind::Number(range) => vec![value(&number(range, now))],
            Kind::Value(range) => vec![value(&number(range, now)), ("formula", "= size / 100.0".into())],
            Kind::LatLon(_) | Kind::Position => vec![value("36.5 -84.5")],
            Kind::Positions => vec![value("36.1 -84.1, 36.2 -84.2, 36.3 -84.1")],
            Kind::Ahead => vec![("time", "45s".into()), ("distance", "800m".into())],
            Kind::Instant => vec![value("2026-07-01T06:00:00Z")],
            Kind::Names => vec![value("another one")],
            Kind::Condition => vec![value("battery < 0.25")],
            Kind::Formula(Use::Polygon) => vec![value("= go ? burnt : burnt")],
            Kind::Formula(Use::Position) => vec![value("= spot")],
            Kind::Formula(_) => vec![value("= size + 4.0")],
            Kind::Reference(sort) => self.named(sort),
        };
        // what is so without being said is not said
        let is_unsaid = |to: &str| match property.kind {
            Kind::Flag => property.without.is_some() && to == "false",
            Kind::Choice(words) => {
                words.iter().any(|(word, label)| *word == to && property.without == Some(*label))
            }
            _ => false,
        };
        all.into_iter().filter(|(_, to)| Some(to.as_str()) != now && !is_unsaid(to)).collect()
    }

    fn named(&self, sort: Sort) -> Vec<(&'static str, String)> {
        let choices = describe::choices(self.plan, self.draft, sort);
        choices.into_iter().map(|choice| ("value", choice.id.to_string())).collect()
    }
}

/// A plan with these changes of an element.
fn changed(
    plan: &FlightPlan,
    draft: &Draft,
    path: &[usize],
    changes: &[Change],
) -> Result<FlightPlan, String> {
    let mut history = History::new(plan.clone());
    let edit = match changes {
        [change] => draft.edit(plan, path, change)?,
        several => draft.edit_together(plan, path, several)?,
    };
    history.apply(&edit, None).map_err(|why| why.to_string())?;
    Ok(history.plan().as_ref().clone())
}

/// Another number of a range.
fn number(range: Range, now: Option<&str>) -> String {
    let candidates = match range.quantity {
        Quantity::Share => [0.25, 0.5],
        _ => [4.0, 7.0],
    };
    let fits = |n: &f64| (range.least..=range.most).contains(n) && now != Some(&*n.to_string());
    candidates.into_iter().find(fits).unwrap_or(range.least).to_string()
}

/// A part that is always there, and of one kind: only what it holds is written.
fn is_fixed(row: &Row) -> bool {
    matches!(row, Row::Children(children) if children.of.len() == 1 && (children.least, children.most) == (1, 1))
}

/// All rows of the language that can be written: their elements and labels.
fn described() -> BTreeSet<[String; 2]> {
    let with_children = describe::all().flat_map(|part| [part].into_iter().chain(part.children()));
    with_children
        .flat_map(|of| of.deep_rows().into_iter().map(move |row| (of, row)))
        .filter(|(_, row)| !is_fixed(row))
        .map(|(of, row)| {
            let label = match row {
                Row::Property(property) => property.label,
                Row::OneOf(one) => one.label,
                Row::Children(children) => children.label,
            };
            [of.element.to_owned(), label.to_owned()]
        })
        .collect()
}

impl Panels {
    fn perform(&mut self, gesture: &Next) -> Result<(), String> {
        match gesture {
            Next::Click(name) => self.press(Role::Button, name),
            Next::Tick(name) => self.press(Role::CheckBox, name),
            Next::Begin(name) => {
                let own = format!("Own {}", name.trim_end_matches(": ").to_lowercase());
                let is_inherited = self.0.query_by_role_and_label(Role::Button, &own).is_some();
                self.press(Role::Button, if is_inherited { &own } else { name })
            }
            Next::Choose(list, option) => {
                self.press(Role::ComboBox, list)?;
                // in a long list
                self.find(Role::Button, option)?.scroll_to_me();
                self.0.run_steps(15);
                self.press(Role::Button, option)
            }
            Next::Write(name, text) => self.fill_in(Role::TextInput, name, text),
            Next::Number(name, text) => self.fill_in(Role::SpinButton, name, text),
        }
    }

    /// The one of this name, else the one whose name begins so.
    fn find<'a>(&'a self, role: Role, name: &'a str) -> Result<Node<'a>, String> {
        let label = |node: &Node<'_>| node.accesskit_node().label().unwrap_or_default();
        let whole = self.0.query_all_by_role_and_label(role, name).last();
        let begins = || self.0.query_all_by_role(role).find(|node| label(node).starts_with(name));
        whole.or_else(begins).ok_or_else(|| format!("no {role:?} is called {name:?}"))
    }

    fn press(&mut self, role: Role, name: &str) -> Result<(), String> {
        self.find(role, name)?.click();
        self.0.run_steps(3);
        Ok(())
    }

    fn fill_in(&mut self, role: Role, name: &str, text: &str) -> Result<(), String> {
        self.press(role, name)?;
        self.0.key_press_modifiers(Modifiers::COMMAND, Key::A);
        match text {
            "" => self.0.key_press(Key::Backspace),
            text => self.0.event(Event::Text(text.into())),
        }
        self.0.run_steps(2);
        self.enter();
        Ok(())
    }

    /// Makes a part what it is to be, by its widgets alone.
    fn fulfil(&mut self, subject: &Subject, wanted: &FlightPlan, as_subject: &Subject) -> Result<(), String> {
        let to_be = Draft::of(wanted, as_subject).unwrap();
        for _ in 0..8 {
            let plan = self.plan();
            let now = Draft::of(&plan, subject).or_else(|| Draft::of(&plan, as_subject)).unwrap();
            let Some(gesture) = next(&plan, &now, &to_be) else { break };
            self.perform(&gesture)?;
            if let Some(notice) = self.0.state().notice.clone() {
                return Err(format!("{gesture:?}: {notice}"));
            }
        }
        match Draft::of(&self.plan(), as_subject) {
            Some(made) if made != to_be => Err(format!("{made:?} is not {to_be:?}")),
            Some(_) if self.plan() == *wanted => Ok(()),
            _ => Err("something else changed".into()),
        }
    }
}

/// What a selection is called after a change of its identifier.
fn after(selection: &Option<Selection>, wanted: &FlightPlan, wish: &Wish) -> Subject {
    let is_name =
        |change: &Change| matches!(change, Change::Set(property, _) if property.kind == Kind::Identifier);
    let is_renamed = wish.changes.iter().any(is_name);
    let selection = match selection {
        Some(selection) if is_renamed && wish.path.is_empty() => Some(selection.renamed("renamed".into())),
        other => other.clone(),
    };
    selections(wanted).into_iter().find(|(of, _)| *of == selection).unwrap().1
}

/// What leads down to a landing goes with it to another runway.
fn landed_on(plan: &FlightPlan, subject: &Subject, changes: &[Change]) -> Option<FlightPlan> {
    let (Subject::Stage(of) | Subject::EmergencyPlan(of)) = subject else { return None };
    let [Change::Set(property, Some(runway))] = changes else { return None };
    let is_runway = property.attribute == "runway";
    flight_plan::create::land_on(plan, of, &runway.as_str().into()).filter(|_| is_runway)?.apply(plan).ok()
}

#[test]
fn all_that_is_described_is_written_by_its_own_widget() {
    let plan = everything();
    let mut panels = Panels::open(None);
    let (mut tried, mut failed) = (BTreeSet::new(), Vec::new());
    // a landing has all that a stage can have
    let is_landing = |subject: &Subject| matches!(subject, Subject::Stage(id) if plan.stage(id).is_some_and(|stage| stage.kind == StageKind::Land));
    let mut all = selections(&plan);
    all.sort_by_key(|(_, subject)| !is_landing(subject));
    for (selection, subject) in all {
        let draft = Draft::of(&plan, &subject).unwrap();
        for wish in Wishes::of(&plan, &draft) {
            if !tried.insert(wish.what.clone()) {
                continue;
            }
            let what = format!("{subject:?}: {:?}", wish.what);
            let wanted = changed(&plan, &draft, &wish.path, &wish.changes).unwrap();
            let wanted = landed_on(&plan, &subject, &wish.changes).unwrap_or(wanted);
            panels.select(selection.clone());
            let as_subject = after(&selection, &wanted, &wish);
            if let Err(why) = panels.fulfil(&subject, &wanted, &as_subject) {
                failed.push(format!("{what}: {why}"));
            }
            panels.0.state_mut().document = Document::read(EVERYTHING.as_bytes(), None);
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    let written: BTreeSet<[String; 2]> = tried.into_iter().map(|[element, row, _]| [element, row]).collect();
    let missing: Vec<_> = described().into_iter().filter(|row| !written.contains(row)).collect();
    assert!(missing.is_empty(), "nobody wrote {missing:?}");
}
