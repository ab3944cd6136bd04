//! What can be done to a part's element.

use super::extent::Extent;
use super::first::First;
use super::parts::CORNER;
use super::{Description, Kind, OneOf, Property, Row, Way};
use crate::Element;

/// A change of one element of a part.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Gives a property a value, as the document has it; `None` leaves it out.
    Set(Property, Option<String>),
    /// Gives a property its first value.
    Begin(Property),
    /// Says something in another of its ways, by its index.
    Choose(OneOf, usize),
    /// Puts a new element into it.
    Add(&'static Description),
    /// Takes out one of its children, by its index.
    Remove(usize),
    /// Takes a child so many places down (or up) among those of its name.
    Move(usize, isize),
    /// Puts a new element in the place of a child.
    Become(usize, &'static Description),
    /// Makes it an element that is alike, by its name.
    Rename(&'static str),
}

/// Applies a change to the element at the end of a path. `None`: there is nothing to be changed there.
pub(super) fn apply(root: &mut Element, at: &[usize], change: &Change, first: &First) -> Option<()> {
    let before = root.clone();
    let element = root.at_mut(at)?;
    match change {
        Change::Set(property, value) => set(element, property, value.as_deref()),
        Change::Begin(property) => set(element, property, Some(&first.value(property, &[]))),
        Change::Choose(one, way) => choose(element, one, *way, first)?,
        Change::Add(what) => {
            let new = first.element(what, &element.children);
            element.children.push(new);
        }
        Change::Remove(child) => {
            element.children.get(*child)?;
            element.children.remove(*child);
        }
        Change::Move(child, by) => shift(&mut element.children, *child, *by)?,
        Change::Become(child, what) => {
            let new = first.element(what, &[]);
            *element.children.get_mut(*child)? = new;
        }
        Change::Rename(name) => element.name = (*name).into(),
    }
    follow(&before, root, at);
    Some(())
}

pub(super) fn set(element: &mut Element, property: &Property, value: Option<&str>) {
    match property.kind {
        Kind::LatLon(_) => {
            let mut parts =
                value.into_iter().flat_map(|v| v.split([' ', ',', ';'])).filter(|part| !part.is_empty());
            property.attributes().for_each(|name| element.set(name, parts.next().map(str::to_owned)));
        }
        _ => element.set(property.attribute, value.map(str::to_owned)),
    }
}

/// What the other ways say goes, unless this one says it too; what this one must say begins with its first value.
fn choose(element: &mut Element, one: &OneOf, way: usize, first: &First) -> Option<()> {
    let chosen = one.ways.get(way)?;
    let extent = Extent::of(element, first.plan);
    let place = first.place_of(element).or_else(|| first.somewhere(extent.as_ref()?.centre));
    for other in one.ways.iter().filter(|other| *other != chosen) {
        leave(element, other, chosen);
    }
    chosen.fixed.iter().for_each(|(name, value)| element.set(name, Some((*value).into())));
    for row in chosen.rows {
        match row {
            Row::Property(property) if property.without.is_none() && property.value(element).is_none() => {
                let reach = extent.as_ref().filter(|_| property.attribute == "radius").map(Extent::radius);
                let value = reach.or_else(|| place.as_ref().and_then(|at| at.as_kind(property.kind)));
                set(element, property, Some(&value.unwrap_or_else(|| first.value(property, &[]))));
            }
            Row::Children(children) => {
                let corners =
                    extent.as_ref().filter(|_| children.of == [&CORNER] && children.count(element) == 0);
                element.children.extend(corners.into_iter().flat_map(Extent::corners));
                first.fill(element, children);
            }
            Row::Property(_) | Row::OneOf(_) => {}
        }
    }
    Some(())
}

fn leave(element: &mut Element, way: &Way, chosen: &Way) {
    way.fixed.iter().for_each(|(name, _)| element.set(name, None));
    for row in way.rows.iter().filter(|row| !chosen.rows.contains(row)) {
        match row {
            Row::Property(property) => set(element, property, None),
            Row::Children(children) => {
                let gone: Vec<usize> = children.indices(element).collect();
                gone.into_iter().rev().for_each(|child| drop(element.children.remove(child)));
            }
            Row::OneOf(_) => {}
        }
    }
}

/// Past its neighbours of the same name.
fn shift(children: &mut [Element], child: usize, by: isize) -> Option<()> {
    let name = children.get(child)?.name.clone();
    let alike: Vec<usize> =
        (0..children.len()).filter(|i| children.get(*i).is_some_and(|c| c.name == name)).collect();
    let place = alike.iter().position(|i| *i == child)?.checked_add_signed(by)?;
    let to = *alike.get(place)?;
    match to > child {
        true => children.get_mut(child..=to)?.rotate_left(1),
        false => children.get_mut(to..=child)?.rotate_right(1),
    }
    Some(())
}

/// The default of an intersection goes on naming its branch.
fn follow(before: &Element, root: &mut Element, at: &[usize]) {
    let id = |root: &Element| root.at(at).filter(|e| e.name == "branch")?.attribute("id").map(str::to_owned);
    if let (Some(old), Some(new)) = (id(before), id(root))
        && root.attribute("default") == Some(&old)
    {
        root.set("default", Some(new));
    }
}
