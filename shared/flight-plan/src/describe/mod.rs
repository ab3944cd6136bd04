//! What can be said about every part of a plan, described once: the properties of each element of the document, what they
//! are called, what they may be, and what it means to leave them out. Whoever shows or changes a plan goes by this.
//!
//! A [`Draft`] is one part as its element. Changing it makes an [`crate::Edit`]: the element is written, read again by the
//! document's own reader, and what the reader says is why a value can't be had. So nothing is typed twice, and whatever the
//! document can say can be edited. `tests/described.rs` compares the descriptions with the schema.

mod actions;
mod change;
mod draft;
mod extent;
mod first;
mod formula;
mod hole;
mod legs;
mod parts;
mod patterns;
mod reference;
mod things;
mod together;

pub use change::Change;
pub use draft::{Draft, Subject};
pub use formula::{Completion, Formula, completions, look};
pub use reference::{Choice, choices};
pub use together::add;

use crate::{Element, Use};

/// An element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Description {
    /// Its name in the document.
    pub element: &'static str,
    /// For people.
    pub label: &'static str,
    /// What it is, in a sentence.
    pub help: &'static str,
    /// Elements that it may become by another name alone, itself among them.
    pub alike: &'static [Word],
    /// What it has, in the order in which it is shown.
    pub groups: &'static [&'static [Row]],
}

/// A word of the document, and what people call it.
pub type Word = (&'static str, &'static str);

/// Something that an element has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Row {
    /// A value.
    Property(Property),
    /// Something that is said in one of several ways.
    OneOf(OneOf),
    /// Elements inside it.
    Children(Children),
}

/// A value of an element: one attribute, or latitude and longitude together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Property {
    /// Its attribute in the document.
    pub attribute: &'static str,
    /// For people.
    pub label: &'static str,
    /// What it is, in a sentence.
    pub help: &'static str,
    /// What it may be.
    pub kind: Kind,
    /// What it means when it is left out; `None`: it must be there.
    pub without: Option<&'static str>,
    /// Its value when it is first given one; empty: it depends on the plan.
    pub first: &'static str,
}

impl Property {
    /// What it measures, if it is a number.
    pub const fn quantity(&self) -> Option<Quantity> {
        match self.kind {
            Kind::Number(range) | Kind::Value(range) => Some(range.quantity),
            _ => None,
        }
    }
}

/// What a value may be. Values are texts as in the document.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// The identifier of the element itself.
    Identifier,
    /// Any text.
    Text,
    /// One of these.
    Choice(&'static [Word]),
    /// `true` or `false`.
    Flag,
    /// A number.
    Number(Range),
    /// A number, or `= expression`.
    Value(Range),
    /// A position in two attributes, the longitude in this one. Its value is `lat lon`.
    LatLon(&'static str),
    /// A position as `lat lon`.
    Position,
    /// Positions with commas between them.
    Positions,
    /// Seconds (`30s`) or metres (`800m`).
    Ahead,
    /// A time in UTC.
    Instant,
    /// Names something else.
    Reference(Sort),
    /// Names of services, with spaces between them.
    Names,
    /// A condition.
    Condition,
    /// `= expression` for this use.
    Formula(Use),
}

/// In which range a number makes sense, and of what it is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// What it measures.
    pub quantity: Quantity,
    /// Not less.
    pub least: f64,
    /// Not more.
    pub most: f64,
}

/// What a number measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Metres along or across.
    Length,
    /// Metres up.
    Height,
    /// Metres a second.
    Speed,
    /// Degrees.
    Angle,
    /// Seconds.
    Time,
    /// How often or how many.
    Count,
    /// Which in an order; 1 is the first.
    Rank,
    /// A part of one.
    Share,
    /// In a unit that the plan names, or none.
    Plain,
}

impl Quantity {
    /// The unit in which a plan writes it; empty: it has none.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Length | Self::Height => "m",
            Self::Speed => "m/s",
            Self::Angle => "°",
            Self::Time => "s",
            Self::Count | Self::Rank | Self::Share | Self::Plain => "",
        }
    }
}

/// What a reference names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sort {
    /// A fix.
    Fix,
    /// A runway.
    Runway,
    /// A variable.
    Variable,
    /// A procedure.
    Procedure,
    /// An emergency plan.
    EmergencyPlan,
    /// A leg of the same list.
    Leg,
    /// A branch of the same intersection.
    Branch,
    /// A parameter of the procedure that is called.
    Parameter,
    /// An aircraft's profile.
    Aircraft,
}

/// Something that is said in exactly one of several ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneOf {
    /// For people.
    pub label: &'static str,
    /// What it is, in a sentence.
    pub help: &'static str,
    /// The ways. One without anything in it is that nothing is said.
    pub ways: &'static [Way],
}

/// A way of saying something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// For people.
    pub label: &'static str,
    /// Attributes that say that it is this way.
    pub fixed: &'static [Word],
    /// What it says.
    pub rows: &'static [Row],
}

/// Elements inside an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Children {
    /// For people.
    pub label: &'static str,
    /// What they are, in a sentence.
    pub help: &'static str,
    /// What each of them may be.
    pub of: &'static [&'static Description],
    /// Not fewer.
    pub least: usize,
    /// Not more.
    pub most: usize,
}

/// Every element that stands for a part of a plan, whatever it is inside.
pub fn all() -> impl Iterator<Item = &'static Description> {
    things::ALL.iter().chain(legs::ALL).chain(patterns::ALL)
}

/// The part that an element stands for.
pub fn of(element: &str) -> Option<&'static Description> {
    all().find(|d| d.element == element || d.alike.iter().any(|(name, _)| *name == element))
}

impl Description {
    /// What it has.
    pub fn rows(&self) -> impl Iterator<Item = &'static Row> {
        self.groups.iter().copied().flatten()
    }

    /// Every row, in every way.
    pub fn deep_rows(&self) -> Vec<&'static Row> {
        let mut found = Vec::new();
        self.groups.iter().for_each(|rows| collect(rows, &mut found));
        found
    }

    /// Every attribute that it may have.
    pub fn attributes(&self) -> Vec<&'static str> {
        let mut found = Vec::new();
        for row in self.deep_rows() {
            match row {
                Row::Property(property) => found.extend(property.attributes()),
                Row::OneOf(one) => {
                    found.extend(one.ways.iter().flat_map(|way| way.fixed).map(|(name, _)| *name));
                }
                Row::Children(_) => {}
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// What may stand in it.
    pub fn children(&self) -> Vec<&'static Description> {
        let of = |row: &&'static Row| match row {
            Row::Children(children) => Some(children.of),
            _ => None,
        };
        self.deep_rows().iter().filter_map(of).flatten().copied().collect()
    }

    /// What may stand in it under this name.
    pub fn child(&self, element: &str) -> Option<&'static Description> {
        self.children().into_iter().find(|child| child.element == element)
    }
}

fn collect(rows: &'static [Row], into: &mut Vec<&'static Row>) {
    for row in rows {
        into.push(row);
        if let Row::OneOf(one) = row {
            one.ways.iter().for_each(|way| collect(way.rows, into));
        }
    }
}

impl Row {
    /// What is said of the time behind a landing is nothing to be asked of another stage, unless it says that already.
    pub fn applies(&self, element: &Element) -> bool {
        const BEHIND_LANDING: [&str; 2] = ["turnaroundEnergy", "turnaroundTime"];
        let of: Vec<&str> = match self {
            Row::Property(property) => property.attributes().collect(),
            Row::OneOf(one) => one.ways.iter().flat_map(|way| way.fixed).map(|(name, _)| *name).collect(),
            Row::Children(_) => Vec::new(),
        };
        let is_said = |attribute: &&str| element.attribute(attribute).is_some();
        !of.iter().any(|attribute| BEHIND_LANDING.contains(attribute))
            || element.attribute("type") == Some("land")
            || of.iter().any(is_said)
    }
}

impl Property {
    /// The attributes that hold it.
    pub fn attributes(&self) -> impl Iterator<Item = &'static str> {
        let second = match self.kind {
            Kind::LatLon(lon) => Some(lon),
            _ => None,
        };
        std::iter::once(self.attribute).chain(second)
    }

    /// Its value in an element; `None`: it is left out.
    pub fn value(&self, element: &Element) -> Option<String> {
        let given: Vec<&str> = self.attributes().filter_map(|name| element.attribute(name)).collect();
        (!given.is_empty()).then(|| given.join(" "))
    }
}

impl OneOf {
    /// In which way an element says it.
    pub fn way(&self, element: &Element) -> Option<usize> {
        let whole = self.ways.iter().position(|way| way.is_whole(element));
        whole.or_else(|| self.ways.iter().position(|way| way.is_begun(element)))
    }
}

impl Way {
    /// The element says it in this way, with all that belongs to it.
    fn is_whole(&self, element: &Element) -> bool {
        let says = |(name, value): &Word| element.attribute(name) == Some(value);
        let there = |row: &Row| match row {
            Row::Property(property) => property.without.is_some() || property.value(element).is_some(),
            Row::OneOf(_) => true,
            Row::Children(children) => children.count(element) >= children.least,
        };
        !self.is_empty() && self.fixed.iter().all(says) && self.rows.iter().all(there)
    }

    /// Something of it is there; where nothing must be, always.
    fn is_begun(&self, element: &Element) -> bool {
        let has = |row: &Row| match row {
            Row::Property(property) => property.value(element).is_some(),
            Row::OneOf(_) => false,
            Row::Children(children) => children.count(element) > 0,
        };
        self.is_empty() || self.rows.iter().any(has)
    }

    /// Nothing is said.
    pub fn is_empty(&self) -> bool {
        self.fixed.is_empty() && self.rows.is_empty()
    }
}

impl Children {
    /// How many an element has.
    pub fn count(&self, element: &Element) -> usize {
        self.indices(element).count()
    }

    /// Their indices among all children of an element.
    pub fn indices<'e>(&'e self, element: &'e Element) -> impl Iterator<Item = usize> + 'e {
        let is_one = |child: &Element| self.of.iter().any(|d| d.element == child.name);
        element.children.iter().enumerate().filter(move |(_, child)| is_one(child)).map(|(index, _)| index)
    }
}
