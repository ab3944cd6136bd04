//! `QGC WPL 110`: a header, then one item a line: number, current, frame, command, four parameters, latitude, longitude, altitude,
//! autocontinue, separated by tabs (spaces are read as well). Item 0 is the home position.
//! Source: the MAVLink developer guide, "Plain-Text File Format".

use crate::losses::{self, Kept};
use crate::mission::{self, Entry, Item, Mission, commands};
use crate::note::Notes;
use crate::synthetic::Assumptions;
use crate::text::text_of;
use crate::{Error, Export, Import, MAX_ITEMS, lists};
use std::fmt::Write;

/// Fields of a line.
const FIELDS: usize = 12;

/// Reads a list.
pub fn read(bytes: &[u8], assumptions: &Assumptions) -> Result<Import, Error> {
    let mut notes = Notes::default();
    let text = text_of(bytes, &mut notes)?;
    if lists::is_one(&text) {
        return lists::read(&text, assumptions, notes);
    }
    let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    let header = lines.next().map(|(_, line)| line).unwrap_or_default();
    match header.split_whitespace().collect::<Vec<_>>()[..] {
        ["QGC", "WPL", "110"] => {}
        ["QGC", "WPL", version] => {
            let reason = format!("version {version} of WPL is not known: save the mission as version 110");
            return Err(Error::malformed("line 1", reason));
        }
        _ => {
            return Err(Error::malformed(
                "line 1",
                "this is no waypoint file: its first line is not QGC WPL 110",
            ));
        }
    }
    let mut items = Vec::new();
    for (number, line) in lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#')) {
        if items.len() > MAX_ITEMS {
            return Err(Error::TooMany { what: "items", limit: MAX_ITEMS });
        }
        items.push(item(number, line, &mut notes)?);
    }
    Ok(mission::read(assembled(items)?, assumptions, notes))
}

/// Item 0 is home, and comes first.
fn assembled(items: Vec<Item>) -> Result<Mission, Error> {
    let mut mission = Mission::default();
    for (index, item) in items.into_iter().enumerate() {
        match (item.number, index) {
            // lists of fences and rally points may have no home
            (0, 0) if commands::FENCES.contains(&item.command) || item.command == commands::RALLY_POINT => {
                mission.entries.push(Entry::Item(item));
            }
            (0, 0) => {
                mission.home = item.position();
                let metres = item.param(7);
                mission.home_amsl_m =
                    (mission.home.is_some() && metres.is_finite()).then(|| metres.clamp(-1e5, 1e5));
            }
            (0, _) => {
                let reason =
                    "item 0 is the home position and comes first, once: give this one another number";
                return Err(Error::malformed(item.place, reason));
            }
            _ => mission.entries.push(Entry::Item(item)),
        }
    }
    Ok(mission)
}

fn item(number: usize, line: &str, notes: &mut Notes) -> Result<Item, Error> {
    let place = format!("line {number}");
    let fields: Vec<&str> = line.split_whitespace().take(FIELDS + 1).collect();
    if fields.len() != FIELDS {
        let reason = format!(
            "an item has {FIELDS} fields, not {}: the file is cut off or of another kind",
            fields.len()
        );
        return Err(Error::malformed(place, reason));
    }
    let mut values = [0.0; FIELDS];
    for (value, field) in values.iter_mut().zip(&fields) {
        *value = field
            .parse()
            .map_err(|_| Error::malformed(place.clone(), format!("`{}` is no number", short(field))))?;
    }
    let [number, _, frame, command, a, b, c, d, lat, lon, altitude, auto] = values;
    if auto == 0.0 {
        notes.again("autocontinue", &place, "an item that waits for the operator continues by itself");
    }
    let params = [a, b, c, d, lat, lon, altitude].map(|p: f64| if p.is_finite() { p } else { f64::NAN });
    Ok(Item { place, number: crate::saturated(number), frame: code(frame), command: code(command), params })
}

/// One beyond its range is saturated, and then no known frame or command.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast of floats saturates")]
fn code(number: f64) -> u16 {
    number as u16
}

fn short(field: &str) -> String {
    field.chars().take(40).collect()
}

/// Writes a list.
pub fn write(export: &Export<'_>, notes: &mut Notes) -> Vec<u8> {
    losses::note_losses(export, Kept { actions: true, speeds: true, ..Kept::default() }, &|_| false, notes);
    let (home, elevation_m) = mission::home(export, notes);
    let mut text = "QGC WPL 110\n".to_owned();
    line(
        &mut text,
        0,
        commands::FRAME_GLOBAL,
        commands::WAYPOINT,
        [0.0, 0.0, 0.0, 0.0, home.lat_deg, home.lon_deg, elevation_m],
    );
    for (index, item) in mission::items(export, notes).iter().enumerate() {
        line(&mut text, index + 1, item.frame, item.command, item.params);
    }
    text.into_bytes()
}

fn line(text: &mut String, number: usize, frame: u16, command: u16, params: [f64; 7]) {
    let current = u8::from(number == 0);
    // a text file has no word for "none"
    let [a, b, c, d, lat, lon, altitude] = params.map(|p| if p.is_finite() { p } else { 0.0 });
    // writing to a string can't fail
    let _ = writeln!(
        text,
        "{number}\t{current}\t{frame}\t{command}\t{a:.6}\t{b:.6}\t{c:.6}\t{d:.6}\t{lat:.9}\t{lon:.9}\t{altitude:.4}\t1"
    );
}
