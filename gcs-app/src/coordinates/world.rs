//! Cities and airports by their names.

use crate::assets::places::{Group, Place};
use geometry::LatLon;

/// Shorter beginnings of a name suggest nothing: half the world begins with them.
const SHORTEST: usize = 3;
/// So many names are suggested in a sentence.
pub(super) const SUGGESTED: usize = 3;

/// Where the place of that name is: a city by its name, an airport by its code or its name. Capitals and accents don't
/// matter; of several the most important one is meant.
pub(super) fn named(name: &str, world: &[Group<'_>]) -> Option<LatLon> {
    let name = plain(name);
    let is_meant = |place: &&Place<'_>| {
        let full = plain(place.name);
        full == name || full.split_once(' ').is_some_and(|(code, rest)| code == name || rest == name)
    };
    // a city's second word is no name of it
    let (cities, airports) = world.split_first()?;
    let city = cities.iter().find(|place| plain(place.name) == name);
    city.or_else(|| airports.iter().flat_map(Group::iter).find(is_meant)).map(Place::position)
}

/// The cities of that name and the airport of that code.
pub fn exact<'a>(name: &str, world: &'a [Group<'a>]) -> Vec<Place<'a>> {
    let name = plain(name);
    let is_it = |(group, place): &(usize, &Place<'_>)| {
        let full = plain(place.name);
        full == name || (*group > 0 && full.split_once(' ').is_some_and(|(code, _)| code == name))
    };
    let of_groups =
        world.iter().enumerate().flat_map(|(group, places)| places.iter().map(move |p| (group, p)));
    of_groups.filter(is_it).map(|(_, place)| *place).collect()
}

/// At most so many places in whose name a word begins like that: airports of just that name, then the most important ones.
pub fn like<'a>(name: &str, world: &'a [Group<'a>], most: usize) -> Vec<Place<'a>> {
    let name = plain(name);
    if name.chars().count() < SHORTEST {
        return Vec::new();
    }
    let begins = |place: &&Place<'_>| {
        let full = plain(place.name);
        full.starts_with(&name) || full.contains(&format!(" {name}"))
    };
    let mut found: Vec<Place<'a>> = world.iter().flat_map(Group::iter).filter(begins).copied().collect();
    found.sort_by_key(|place| {
        plain(place.name).split_once(' ').is_none_or(|(_, of_airport)| of_airport != name)
    });
    found.truncate(most);
    found
}

/// Small letters without the accents of Latin scripts.
fn plain(name: &str) -> String {
    let without = |c: char| match c {
        'à'..='å' | 'ā' | 'ă' | 'ą' => 'a',
        'ç' | 'ć' | 'č' => 'c',
        'è'..='ë' | 'ē' | 'ę' | 'ě' => 'e',
        'ì'..='ï' | 'ī' | 'ı' => 'i',
        'ł' => 'l',
        'ñ' | 'ń' | 'ň' => 'n',
        'ò'..='ö' | 'ø' | 'ō' | 'ő' => 'o',
        'ř' => 'r',
        'ś' | 'š' | 'ş' => 's',
        'ţ' => 't',
        'ù'..='ü' | 'ū' | 'ů' | 'ű' => 'u',
        'ý' | 'ÿ' => 'y',
        'ź' | 'ż' | 'ž' => 'z',
        other => other,
    };
    name.trim().to_lowercase().chars().map(without).collect()
}
