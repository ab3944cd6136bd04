//! What something says when it is new.

use super::reference::{Choice, choices_of};
use super::{Children, Description, Kind, Property, Row, Sort, hole};
use crate::{Element, FlightPlan, Id, Place, Value};
use geometry::LatLon;

/// A plan and a part of it, from which first values are taken.
pub(super) struct First<'p> {
    pub plan: &'p FlightPlan,
    /// The part, as it is before the change.
    pub root: &'p Element,
}

/// A place, as an element has it.
pub(super) struct Somewhere {
    fix: Option<Id>,
    at: Option<LatLon>,
}

impl Somewhere {
    /// The same place, said in another way.
    pub fn as_kind(&self, kind: Kind) -> Option<String> {
        let at = self.at?;
        match kind {
            Kind::LatLon(_) => Some(format!("{} {}", at.lat_deg, at.lon_deg)),
            Kind::Formula(crate::Use::Position) => {
                Some(format!("= lat_lon({:?}, {:?})", at.lat_deg, at.lon_deg))
            }
            Kind::Reference(Sort::Fix) => self.fix.as_ref().map(Id::to_string),
            _ => None,
        }
    }
}

impl First<'_> {
    /// Where an element is, and the fix that is there.
    pub fn place_of(&self, element: &Element) -> Option<Somewhere> {
        let named = element.attribute("fix").map(Id::new);
        let fix = named.and_then(|id| self.plan.fix(&id));
        let number = |name: &str| element.attribute(name)?.parse::<f64>().ok();
        let written = number("lat").zip(number("lon")).map(|(lat, lon)| LatLon::new(lat, lon));
        self.somewhere(fix.map(|fix| fix.position).or(written)?)
    }

    /// A position, and the fix that is there.
    pub fn somewhere(&self, at: LatLon) -> Option<Somewhere> {
        let there = self.plan.fixes.iter().find(|fix| fix.position == at).or_else(|| self.nearest(at));
        Some(Somewhere { fix: there.map(|fix| fix.id.clone()), at: Some(at) })
    }

    fn nearest(&self, at: LatLon) -> Option<&crate::Fix> {
        let distance = |fix: &&crate::Fix| at.distance_m(fix.position);
        self.plan.fixes.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// A new element beside others.
    pub fn element(&self, what: &Description, beside: &[Element]) -> Element {
        if what.element == "hole"
            && let Some(hole) = hole::inside(beside)
        {
            return hole;
        }
        let alike: Vec<&Element> = beside.iter().filter(|other| other.name == what.element).collect();
        let mut new = Element { name: what.element.into(), ..Element::default() };
        what.groups.iter().for_each(|rows| self.begin(&mut new, rows, &alike));
        new
    }

    /// What must be said; in the way in which the last neighbour says it.
    fn begin(&self, new: &mut Element, rows: &[Row], alike: &[&Element]) {
        for row in rows {
            match row {
                Row::Property(property) if property.without.is_none() => {
                    super::change::set(new, property, Some(&self.value(property, alike)));
                }
                Row::Property(_) => {}
                Row::OneOf(one) => {
                    let way = alike.last().and_then(|last| one.way(last)).and_then(|way| one.ways.get(way));
                    if let Some(way) = way.or(one.ways.first()) {
                        way.fixed.iter().for_each(|(name, value)| new.set(name, Some((*value).into())));
                        self.begin(new, way.rows, alike);
                    }
                }
                Row::Children(children) => self.fill(new, children),
            }
        }
    }

    /// As many of some children as must be there.
    pub fn fill(&self, new: &mut Element, children: &Children) {
        for _ in children.count(new)..children.least {
            let Some(what) = children.of.first() else { return };
            let child = self.element(what, &new.children);
            new.children.push(child);
        }
    }

    /// A property's first value, other than those of its element's neighbours where it must be.
    pub fn value(&self, property: &Property, beside: &[&Element]) -> String {
        let taken: Vec<String> = beside.iter().filter_map(|other| property.value(other)).collect();
        match property.kind {
            Kind::LatLon(_) => text(self.beside(&taken, beside.first().is_some_and(|e| e.name == "point"))),
            Kind::Position => text(self.home()),
            Kind::Positions => self.triangle(),
            Kind::Identifier => free(beside.first().map_or("new", |e| &e.name), &taken),
            Kind::Choice(words) => {
                let mut words = words.iter().map(|(word, _)| *word);
                let free = words.find(|word| !taken.iter().any(|t| t == word));
                let usual = !taken.iter().any(|t| t == property.first) && !property.first.is_empty();
                if usual { property.first.into() } else { free.unwrap_or(property.first).into() }
            }
            Kind::Reference(sort) => self.reference(sort, &taken),
            Kind::Formula(crate::Use::Polygon) => self.polygon(),
            Kind::Formula(_) if property.first.is_empty() => "= 0.0".into(),
            _ => property.first.into(),
        }
    }

    fn reference(&self, sort: Sort, taken: &[String]) -> String {
        let all: Vec<Choice> = choices_of(self.plan, self.root, sort);
        let free = all.iter().find(|choice| !taken.iter().any(|t| t == choice.id.as_str()));
        free.or(all.first()).map_or_else(|| "none".into(), |choice| choice.id.to_string())
    }

    fn polygon(&self) -> String {
        let is_polygon = |v: &&crate::Variable| matches!(v.initial, crate::VariableValue::Polygon(_));
        self.plan
            .variables
            .iter()
            .find(is_polygon)
            .map_or_else(|| "= area".into(), |v| format!("= {}", v.name))
    }

    /// Where the plan is.
    fn home(&self) -> LatLon {
        let runway = self.plan.home().or(self.plan.runways.first()).map(|runway| runway.threshold);
        let legs = self.plan.all_legs();
        let mut places = legs.iter().filter_map(|context| match context.leg.place() {
            Some(Place::Position(Value::Constant(at))) => Some(*at),
            _ => None,
        });
        let fix = self.plan.fixes.first().map(|fix| fix.position);
        runway.or(fix).or_else(|| places.next()).unwrap_or(LatLon::new(0.0, 0.0))
    }

    /// The next of some places: of a line beyond its end, of a ring between the last and the first.
    fn beside(&self, taken: &[String], line: bool) -> LatLon {
        let places: Vec<LatLon> = taken.iter().filter_map(|t| position(t)).collect();
        match places[..] {
            [] => self.home(),
            [.., before, last] if line => last.destination(before.inverse(last).bearing_end_deg, SIDE_M),
            [first, _, .., last] if !line => {
                LatLon::new((first.lat_deg + last.lat_deg) / 2.0, (first.lon_deg + last.lon_deg) / 2.0)
            }
            // 90 and 210 degrees: of a triangle
            [.., last] => last.destination(120.0 * places.len() as f64 - 30.0, SIDE_M),
        }
    }

    fn triangle(&self) -> String {
        let mut corners: Vec<String> = Vec::new();
        for _ in 0..3 {
            corners.push(text(self.beside(&corners, false)));
        }
        corners.join(", ")
    }
}

/// Between new corners, metres.
const SIDE_M: f64 = 400.0;

/// To a centimetre: more digits say nothing.
pub(super) fn text(at: LatLon) -> String {
    let rounded = |degrees: f64| (degrees * 1e7).round() / 1e7;
    format!("{} {}", rounded(at.lat_deg), rounded(at.lon_deg))
}

pub(super) fn position(text: &str) -> Option<LatLon> {
    let (lat, lon) = text.split_once(' ')?;
    Some(LatLon::new(lat.parse().ok()?, lon.parse().ok()?))
}

fn free(stem: &str, taken: &[String]) -> String {
    let mut names = (1..=taken.len() + 1).map(|n| format!("{stem}{n}"));
    names.find(|name| !taken.contains(name)).unwrap_or_else(|| stem.into())
}
