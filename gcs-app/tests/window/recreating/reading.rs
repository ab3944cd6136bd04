//! What is to be done next in the inspector, so that a part of the plan becomes like another.

use flight_plan::describe::{Children, Draft, Kind, OneOf, Property, Quantity, Row, Sort, choices};
use flight_plan::{Element, FlightPlan};

/// A gesture in the inspector.
#[derive(Debug, Clone, PartialEq)]
pub enum Next {
    /// The button of this name.
    Click(String),
    /// The box to tick.
    Tick(String),
    /// The button whose name begins so.
    Begin(String),
    /// An option of a list.
    Choose(String, String),
    /// A text into a field.
    Write(String, String),
    /// A number into a field.
    Number(String, String),
}

/// A part as it is and as it is to be.
pub struct Reader<'a> {
    plan: &'a FlightPlan,
    draft: &'a Draft,
}

/// The next gesture; `None`: they are alike.
pub fn next(plan: &FlightPlan, now: &Draft, wanted: &Draft) -> Option<Next> {
    let (is, be) = (now.element(), wanted.element());
    if is.name != be.name {
        let word = now.description().alike.iter().find(|(name, _)| *name == be.name).unwrap();
        return Some(Next::Choose("Kind".into(), word.1.into()));
    }
    let reader = Reader { plan, draft: now };
    now.description().groups.iter().find_map(|rows| reader.rows(rows, is, be, ""))
}

impl Reader<'_> {
    fn rows(&self, rows: &'static [Row], is: &Element, be: &Element, prefix: &str) -> Option<Next> {
        rows.iter().find_map(|row| match row {
            Row::Property(property) => self.property(property, is, be, prefix),
            Row::OneOf(one) => self.one_of(one, is, be, prefix),
            Row::Children(children) => self.children(children, is, be, prefix),
        })
    }

    fn one_of(&self, one: &'static OneOf, is: &Element, be: &Element, prefix: &str) -> Option<Next> {
        let (now, wanted) = (one.way(is), one.way(be).unwrap());
        if now == Some(wanted) {
            return self.rows(one.ways[wanted].rows, is, be, prefix);
        }
        let is_level = matches!(one.ways, [own, none] if own.rows.len() == 2 && none.is_empty());
        Some(match (is_level, wanted) {
            (true, 0) => Next::Begin(format!("{prefix}{}: ", one.label)),
            (true, _) => Next::Click(format!("{prefix}Leave out the {}", one.label.to_lowercase())),
            (false, _) => Next::Choose(format!("{prefix}{}", one.label), one.ways[wanted].label.into()),
        })
    }

    fn children(&self, of: &'static Children, is: &Element, be: &Element, prefix: &str) -> Option<Next> {
        let (now, wanted): (Vec<_>, Vec<_>) = (of.indices(is).collect(), of.indices(be).collect());
        let what = |e: &Element| *of.of.iter().find(|what| what.element == e.name).unwrap();
        if now.len() < wanted.len() {
            let new = what(&be.children[wanted[now.len()]]);
            return Some(Next::Click(format!("{prefix}Add {}", new.label.to_lowercase())));
        }
        if now.len() > wanted.len() {
            let last = what(&is.children[*now.last().unwrap()]);
            return Some(Next::Click(format!("{prefix}{} {}: remove", last.label, now.len())));
        }
        now.iter().zip(&wanted).enumerate().find_map(|(number, (now, wanted))| {
            let (is, be) = (&is.children[*now], &be.children[*wanted]);
            if is.name != be.name {
                return Some(Next::Choose(format!("{prefix}{}", of.label), what(be).label.into()));
            }
            let inner = match of.most {
                1 => prefix.to_owned(),
                _ => format!("{prefix}{} {}: ", what(be).label, number + 1),
            };
            what(be).groups.iter().find_map(|rows| self.rows(rows, is, be, &inner))
        })
    }

    fn property(&self, property: &Property, is: &Element, be: &Element, prefix: &str) -> Option<Next> {
        let (now, wanted) = (property.value(is), property.value(be));
        if now == wanted {
            return None;
        }
        let name = format!("{prefix}{}", property.label);
        Some(match (&now, &wanted) {
            (_, None) => leave_out(property, name, prefix),
            (None, Some(_)) if !is_there_when_absent(property.kind) => Next::Begin(format!("{name}: ")),
            (_, Some(wanted)) => self.set(property, name, now.as_deref().unwrap_or(""), wanted),
        })
    }

    fn set(&self, property: &Property, name: String, now: &str, wanted: &str) -> Next {
        let source = |text: &str| text.trim_start_matches('=').trim().to_owned();
        match property.kind {
            Kind::Choice(words) => {
                let word = words.iter().find(|(word, _)| *word == wanted).unwrap();
                Next::Choose(name, word.1.into())
            }
            Kind::Reference(sort) => Next::Choose(name, self.label(sort, wanted)),
            Kind::Flag => Next::Tick(name),
            Kind::Value(_) if now.starts_with('=') != wanted.starts_with('=') => {
                Next::Click(format!("{name}: number or formula"))
            }
            Kind::Value(_) if wanted.starts_with('=') => Next::Write(name, source(wanted)),
            Kind::Number(range) | Kind::Value(range) if range.quantity == Quantity::Share => {
                Next::Number(name, (wanted.parse::<f64>().unwrap() * 100.0).to_string())
            }
            Kind::Number(_) | Kind::Value(_) => Next::Number(name, wanted.into()),
            Kind::Ahead if now.ends_with('m') == wanted.ends_with('m') => {
                Next::Number(name, wanted.trim_end_matches(['s', 'm']).into())
            }
            Kind::Ahead => {
                let of = if wanted.ends_with('m') { "of distance" } else { "of time" };
                Next::Choose(format!("{name}: of time or distance"), of.into())
            }
            Kind::Formula(_) => Next::Write(name, source(wanted)),
            _ => Next::Write(name, wanted.into()),
        }
    }

    /// What a list calls it.
    fn label(&self, sort: Sort, id: &str) -> String {
        let found = choices(self.plan, self.draft, sort).into_iter().find(|choice| choice.id.as_str() == id);
        found.unwrap_or_else(|| panic!("{id} is not there yet: {:?}", self.draft.subject())).label()
    }
}

fn is_there_when_absent(kind: Kind) -> bool {
    matches!(kind, Kind::Text | Kind::Flag | Kind::Choice(_) | Kind::Reference(_))
}

fn leave_out(property: &Property, name: String, prefix: &str) -> Next {
    match property.kind {
        Kind::Text => Next::Write(name, String::new()),
        Kind::Flag => Next::Tick(name),
        Kind::Choice(_) | Kind::Reference(_) => {
            Next::Choose(name, property.without.unwrap_or_default().into())
        }
        _ => Next::Click(format!("{prefix}Leave out {}", property.label)),
    }
}
