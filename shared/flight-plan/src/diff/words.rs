//! What changed in one part, as phrases: its attributes, then what stands inside it.

use crate::xml::{self, Element, Piece};
use geometry::LatLon;
use std::collections::HashMap;

/// Up to so many changes inside a part are listed one by one, more only by their number.
const MOST: usize = 4;
/// Longest description of something that came or went, bytes.
const LONGEST: usize = 120;
/// Of a number that is told.
const DECIMALS: usize = 6;
/// The attributes of a position.
const POSITION: [&str; 2] = ["lat", "lon"];
/// Attributes that distinguish elements of one name: branches, parameters and arguments, emergencies by cause.
const KEYS: [&str; 3] = ["id", "name", "cause"];

/// Empty: nothing.
pub(super) fn between(old: &Piece, new: &Piece) -> Vec<String> {
    let (old, new) = (xml::text(old), xml::text(new));
    if old == new {
        return Vec::new();
    }
    let mut words = Vec::new();
    if let (Some(old), Some(new)) = (Element::of(&old), Element::of(&new)) {
        if old.name != new.name {
            words.push(format!("{} → {}", old.name, new.name));
        }
        words.extend(inside(&old, &new));
    }
    if words.is_empty() {
        words.push("other properties".into());
    }
    words
}

/// How something that may be missing has changed, by its name.
pub(super) fn change_of(name: &str, old: Option<&str>, new: Option<&str>) -> Option<String> {
    match (old, new) {
        (None, Some(new)) => Some(format!("{name} {} added", short(new))),
        (Some(old), None) => Some(format!("{name} {} removed", short(old))),
        (Some(old), Some(new)) if old != new => {
            let (old, new) = legible(old, new);
            Some(format!("{name} {old} → {new}"))
        }
        _ => None,
    }
}

/// Numbers with no more digits than tell the two apart.
fn legible(old: &str, new: &str) -> (String, String) {
    let (shorter_old, shorter_new) = (short(old), short(new));
    if shorter_old == shorter_new { (old.into(), new.into()) } else { (shorter_old, shorter_new) }
}

/// A number with no more digits than anybody reads: six decimals of a degree are 11 cm. What else is said stays as it is.
pub(super) fn short(text: &str) -> String {
    let has_more = text.split_once('.').is_some_and(|(_, decimals)| decimals.len() > DECIMALS);
    let number = text.parse::<f64>().ok().filter(|number| has_more && number.is_finite());
    number.map_or_else(|| text.to_owned(), |number| format!("{number:.DECIMALS$}"))
}

/// How an attribute has changed, with what its numbers count in: said once where that is the same for both.
fn attribute(name: &str, old: &Element, new: &Element) -> Option<String> {
    let (was, now) = ((old.attribute(name), measure(name, old)), (new.attribute(name), measure(name, new)));
    let with = |(value, measure): (Option<&str>, &str)| value.map(|value| format!("{value}{measure}"));
    match (was, now) {
        ((Some(was), before), (Some(now), measure)) if before == measure => {
            change_of(name, Some(was), Some(now)).map(|change| format!("{change}{measure}"))
        }
        _ => change_of(name, with(was).as_deref(), with(now).as_deref()),
    }
}

/// `moved by 340 m to 36.26656, -84.16964`: two attributes are one place.
fn moved(old: &Element, new: &Element) -> Option<String> {
    let (was, now) = (position(old)?, position(new)?);
    let LatLon { lat_deg, lon_deg } = now;
    let of_digits = |degrees: f64| (degrees * 1e5).round() / 1e5;
    let to = format!("{}, {}", of_digits(lat_deg), of_digits(lon_deg));
    (was != now).then(|| format!("moved by {:.0} m to {to}", was.distance_m(now)))
}

fn position(of: &Element) -> Option<LatLon> {
    let [lat, lon] = POSITION.map(|name| of.attribute(name)?.parse().ok());
    Some(LatLon::new(lat?, lon?)).filter(|at| at.is_valid())
}

/// What a number counts in, and an altitude from; nothing for a formula.
fn measure(name: &str, of: &Element) -> &'static str {
    let is_number = of.attribute(name).is_some_and(|value| value.parse::<f64>().is_ok());
    let reference = match name {
        _ if !is_number => return "",
        "altitude" => "altitudeReference",
        "floor" => "floorReference",
        "ceiling" => "ceilingReference",
        "speed" => return " m/s",
        _ => return "",
    };
    match of.attribute(reference) {
        Some("agl") => " m above ground",
        Some("home") => " m above home",
        _ => " m AMSL",
    }
}

/// Of two elements: their attributes and what is in them.
fn inside(old: &Element, new: &Element) -> Vec<String> {
    let moved = moved(old, new);
    let is_told = |name: &str| moved.is_some() && POSITION.contains(&name);
    let names = new.attributes.iter().filter(|(name, _)| !is_told(name));
    let changed = names.map(|(name, _)| attribute(name, old, new));
    let gone = old.attributes.iter().filter(|(name, _)| new.attribute(name).is_none());
    let gone = gone.map(|(name, _)| attribute(name, old, new));
    let changed = changed.chain(gone).flatten();
    let mut words: Vec<String> = moved.iter().cloned().chain(changed).collect();
    if let ([was], [now]) = (&old.children[..], &new.children[..])
        && was.name != now.name
    {
        words.push(format!("{} → {}", was.short(), now.short()));
        return words;
    }
    let mut names: Vec<&str> =
        old.children.iter().chain(&new.children).map(|child| child.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    for name in names {
        words.extend(children(name, old, new));
    }
    words
}

/// Of the children of one name.
fn children(name: &str, old: &Element, new: &Element) -> Vec<String> {
    let (old, new) = (old.called(name), new.called(name));
    let words = match (by_key(&old), by_key(&new)) {
        (Some(before), Some(after)) => keyed(&old, &new, (&before, &after)),
        _ => in_order(name, &old, &new),
    };
    if words.len() <= MOST {
        return words;
    }
    vec![match (old.len(), new.len()) {
        (0, _) => format!("{name} added"),
        (_, 0) => format!("{name} removed"),
        (before, now) if before == now => format!("{name} changed"),
        (before, now) => format!("{name}: {now} instead of {before}"),
    }]
}

/// Elements by the attribute that distinguishes them; `None`: there is none.
type Keys<'e> = HashMap<&'e str, &'e Element>;

fn by_key<'e>(list: &[&'e Element]) -> Option<Keys<'e>> {
    let keys: Keys = list.iter().filter_map(|element| Some((element.key()?, *element))).collect();
    (keys.len() == list.len()).then_some(keys)
}

fn keyed(old: &[&Element], new: &[&Element], (before, after): (&Keys, &Keys)) -> Vec<String> {
    let key = |e: &&Element| e.key().unwrap_or_default().to_owned();
    let label = |e: &Element| format!("{} {}", e.name, key(&e));
    let mut words = Vec::new();
    for now in new {
        match before.get(key(now).as_str()) {
            Some(was) => words.extend(within(&label(now), was, now)),
            None => words.push(format!("{} added{}", label(now), now.in_brackets())),
        }
    }
    let gone = old.iter().filter(|was| !after.contains_key(key(was).as_str()));
    words.extend(gone.map(|was| format!("{} removed{}", label(was), was.in_brackets())));
    let kept = |list: &[&Element], other: &Keys| -> Vec<String> {
        list.iter().map(key).filter(|key| other.contains_key(key.as_str())).collect()
    };
    if kept(old, after) != kept(new, before) {
        words.push(format!("{} in another order", new.first().map_or("", |e| &e.name)));
    }
    words
}

/// Leaves out what is the same at the beginning and at the end.
fn in_order(name: &str, old: &[&Element], new: &[&Element]) -> Vec<String> {
    let shorter = old.len().min(new.len());
    let first = old.iter().zip(new).take_while(|(was, now)| was == now).count();
    let alike = old.iter().rev().zip(new.iter().rev()).take_while(|(was, now)| was == now).count();
    let last = alike.min(shorter - first);
    let rest = |list: &'_ [&'_ Element]| first..list.len() - last;
    let (was, now) = (old.get(rest(old)).unwrap_or_default(), new.get(rest(new)).unwrap_or_default());
    if was.len() == now.len() {
        let label = |i: usize| match old.len() {
            1 => name.to_owned(),
            _ => format!("{name} {}", first + i + 1),
        };
        let pairs = was.iter().zip(now).enumerate();
        return pairs.flat_map(|(i, (was, now))| within(&label(i), was, now)).collect();
    }
    let gone = was.iter().map(|e| format!("{name} removed{}", e.in_brackets()));
    gone.chain(now.iter().map(|e| format!("{name} added{}", e.in_brackets()))).collect()
}

/// What changed in something that has a label of its own.
fn within(label: &str, old: &Element, new: &Element) -> Option<String> {
    let words = inside(old, new);
    match words.len() {
        0 => None,
        1..=MOST => Some(format!("{label}: {}", words.join("; "))),
        _ => Some(format!("{label} changed")),
    }
}

impl Element {
    fn called(&self, name: &str) -> Vec<&Element> {
        self.children.iter().filter(|child| child.name == name).collect()
    }

    fn key(&self) -> Option<&str> {
        KEYS.iter().find_map(|key| self.attribute(key))
    }

    /// `photo`, or `wait (seconds 30)`.
    fn short(&self) -> String {
        format!("{}{}", self.name, self.in_brackets())
    }

    /// ` (on end, photo)`; nothing if there is nothing to say, or too much.
    fn in_brackets(&self) -> String {
        let shown = self.attributes.iter().filter(|(name, _)| !KEYS.contains(&name.as_str()));
        let shown = shown.map(|(name, value)| format!("{name} {}", short(value)));
        let parts: Vec<String> = shown.chain(self.children.iter().map(Element::short)).collect();
        let text = parts.join(", ");
        if text.is_empty() || text.len() > LONGEST { String::new() } else { format!(" ({text})") }
    }
}
