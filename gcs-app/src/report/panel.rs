//! The panel beside the map: legend, happenings, what was measured, the verdict.

use super::canvas::{Anchor, Canvas, Pen, Type};
use super::map::numbered;
use super::record::Record;
use super::style::*;
use super::{Coverage, Findings, tables, zones};
use flight_plan::ZoneKind;

const LINE: f32 = 24.0;
const SIZE: f32 = 15.0;

/// Where the next line goes.
struct Cursor<'a> {
    canvas: &'a mut Canvas,
    left: f32,
    right: f32,
    y: f32,
    bottom: f32,
}

/// Draws into the box `(left, top, right, bottom)`, pixels.
pub fn draw(
    canvas: &mut Canvas,
    record: &Record,
    findings: &Findings,
    (left, top, right, bottom): (f32, f32, f32, f32),
) {
    canvas.rectangle(left, top, right - left, bottom - top, PAPER);
    canvas.line(&[(left, top), (left, bottom)], Pen::solid(RULE, 1.5));
    let mut cursor =
        Cursor { canvas, left: left + 22.0, right: right - 20.0, y: top + 30.0, bottom: bottom - 16.0 };
    legend(&mut cursor, record);
    summary(&mut cursor, record, findings);
    verdict(&mut cursor, record);
    happenings(&mut cursor, record);
}

impl Cursor<'_> {
    fn heading(&mut self, text: &str) {
        self.canvas.text((self.left, self.y), Anchor::Left, text, Type::bold(17.0, TEXT));
        self.y += LINE + 2.0;
    }

    /// A line in parts that fit the width; at the panel's end nothing is drawn any more.
    fn paragraph(&mut self, indent: f32, text: &str, kind: Type) {
        for line in self.wrapped(text, kind.size, self.right - self.left - indent) {
            if self.has_room() {
                self.canvas.text((self.left + indent, self.y), Anchor::Left, &line, kind);
            }
            self.y += LINE - 3.0;
        }
        self.y += 3.0;
    }

    fn has_room(&self) -> bool {
        self.y <= self.bottom
    }

    fn wrapped(&self, text: &str, size: f32, width: f32) -> Vec<String> {
        let mut lines = vec![String::new()];
        for word in text.split_whitespace() {
            let last = lines.last().cloned().unwrap_or_default();
            let longer = if last.is_empty() { word.to_owned() } else { format!("{last} {word}") };
            if last.is_empty() || self.canvas.text_width(&longer, size) <= width {
                lines.pop();
                lines.push(longer);
            } else {
                lines.push(word.to_owned());
            }
        }
        lines
    }

    fn row(&mut self, name: &str, value: &str) {
        self.canvas.text((self.left, self.y), Anchor::Left, name, Type::plain(SIZE, QUIET));
        self.canvas.text((self.right, self.y), Anchor::Right, value, Type::plain(SIZE, TEXT));
        self.y += LINE;
    }

    /// A legend entry: a sample of a line and its meaning.
    fn sample(&mut self, pens: &[Pen], text: &str) {
        let (x, y) = (self.left, self.y);
        for pen in pens {
            self.canvas.line(&[(x, y), (x + 38.0, y)], *pen);
        }
        self.canvas.text((x + 52.0, y), Anchor::Left, text, Type::plain(SIZE, TEXT));
        self.y += LINE;
    }
}

fn legend(cursor: &mut Cursor, record: &Record) {
    cursor.heading("Legend");
    if record.flown.points().is_empty() {
        cursor.sample(&[Pen::solid(PLANNED, 2.6)], "path that will be flown");
    } else {
        cursor.sample(&[Pen::solid(PLANNED.faded(150), 7.0)], "previewed path");
        cursor.sample(&[Pen::solid(FLOWN, 1.9)], "flown track, a mark every 5 minutes");
    }
    if !record.areas.is_empty() {
        cursor.sample(&[Pen::dashed(AREA, 2.4, [9.0, 5.0])], "area to be scanned");
    }
    for (kind, text) in
        [(ZoneKind::KeepOut, "zone to keep out of"), (ZoneKind::KeepIn, "zone to stay inside")]
    {
        if record.zones.iter().any(|zone| zone.kind == kind) {
            cursor.sample(&[zones::pen(kind)], text);
        }
    }
    cursor.sample(&[Pen::solid(RUNWAY, 7.5), Pen::dashed(PAPER, 1.2, [6.0, 4.0])], "runway");
    if has_ground(record) {
        cursor.sample(&[Pen::solid(CONTOUR, 1.4)], "contour, every 100 m");
    }
    cursor.y += 12.0;
}

/// The elevation is known somewhere below the track.
fn has_ground(record: &Record) -> bool {
    record.main_track().points().iter().any(|p| record.terrain.elevation_m(p.position).is_some())
}

fn summary(cursor: &mut Cursor, record: &Record, findings: &Findings) {
    let track = record.main_track();
    cursor.heading(if record.flown.points().is_empty() { "Preview" } else { "Flight" });
    cursor.row("time", &tables::clock(track.duration_s()));
    let distance_m: f64 = findings.flights.iter().map(|flight| flight.distance_m).sum();
    cursor.row("way over the ground", &format!("{:.1} km", distance_m / 1000.0));
    for flight in findings.flights.iter().filter(|_| findings.flights.len() > 1) {
        let left = flight.energy.map_or(String::new(), |e| format!(", {:.0} % left", e.left * 100.0));
        let (time, km) = (tables::clock(flight.time_s), flight.distance_m / 1000.0);
        cursor.row(&format!("flight {}", flight.number), &format!("{time}, {km:.1} km{left}"));
    }
    cursor.row("passages of legs", &track.passages().len().to_string());
    for kind in ["TF", "RF"] {
        if let Some(worst) = findings.worst(kind) {
            cursor.row(&format!("greatest deviation, {kind}"), &format!("{:.1} m", worst.worst_m()));
        }
    }
    for coverage in &findings.coverages {
        cursor.row(&seen_of(coverage), &format!("{:.2} %", coverage.share * 100.0));
    }
    cursor.y += 12.0;
}

/// The name of a row: an area may be flown over there and back.
fn seen_of(coverage: &Coverage) -> String {
    format!("seen of {}", coverage.passage)
}

/// Only what does not hold is spelled out here; the tables have all of it.
fn verdict(cursor: &mut Cursor, record: &Record) {
    if record.verdict.is_empty() {
        return;
    }
    let failed: Vec<&String> =
        record.verdict.iter().filter(|(holds, _)| !*holds).map(|(_, text)| text).collect();
    cursor.heading(match (failed.is_empty(), record.by_hand.is_empty()) {
        (true, true) => "Flown as planned",
        (true, false) => "Flown as commanded",
        (false, _) => "Not flown as planned",
    });
    let held = record.verdict.len() - failed.len();
    tick(cursor, failed.is_empty());
    let text = format!("{held} of {} conditions hold", record.verdict.len());
    cursor.paragraph(24.0, &text, Type::plain(SIZE, TEXT));
    if !record.by_hand.is_empty() {
        let text = format!("The operator took part: {}", record.by_hand.join(", "));
        cursor.paragraph(24.0, &text, Type::plain(SIZE, TEXT));
    }
    for text in failed {
        tick(cursor, false);
        cursor.paragraph(24.0, text, Type::plain(SIZE, BAD));
    }
    cursor.y += 12.0;
}

/// A tick or a cross, drawn: the font has neither.
fn tick(cursor: &mut Cursor, holds: bool) {
    if !cursor.has_room() {
        return;
    }
    let (x, y) = (cursor.left + 7.0, cursor.y);
    if holds {
        cursor.canvas.line(&[(x - 6.0, y), (x - 1.5, y + 4.5), (x + 6.5, y - 5.0)], Pen::solid(GOOD, 2.4));
    } else {
        cursor.canvas.line(&[(x - 5.0, y - 5.0), (x + 5.0, y + 5.0)], Pen::solid(BAD, 2.4));
        cursor.canvas.line(&[(x - 5.0, y + 5.0), (x + 5.0, y - 5.0)], Pen::solid(BAD, 2.4));
    }
}

fn happenings(cursor: &mut Cursor, record: &Record) {
    let start = record.main_track().points().first().map_or(0.0, |p| p.time_s);
    let important: Vec<_> = record.happenings.iter().filter(|h| h.important).collect();
    if important.is_empty() {
        return;
    }
    cursor.heading("What happened");
    for (i, happening) in important.iter().enumerate() {
        if cursor.has_room() {
            numbered(cursor.canvas, (cursor.left + 10.0, cursor.y), i + 1);
        }
        let text = format!("{}  {}", tables::clock(happening.time_s - start), happening.text);
        cursor.paragraph(32.0, &text, Type::plain(SIZE, TEXT));
        cursor.y += 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_back_over_an_area_has_a_row_of_its_own() {
        let mut record = crate::report::made_up_record();
        record.areas.push(record.areas[0].clone());
        record.areas[1].passage.reverse = true;
        let mut back = record.flown.clone();
        back.begin(record.areas[1].passage.clone(), "scan", "Fire watch".into());
        record.flown.points().iter().for_each(|p| back.push(*p));
        record.flown = back;
        let names: Vec<String> = Findings::of(&record).coverages.iter().map(seen_of).collect();
        assert_eq!(names, ["seen of sweep (patrol 1)", "seen of sweep (patrol 1) reversed"]);
    }

    #[test]
    fn contours_are_where_the_ground_is_known() {
        let mut record = crate::report::made_up_record();
        assert!(has_ground(&record));
        record.terrain = std::sync::Arc::new(terrain::Tiles::new());
        assert!(!has_ground(&record));
    }
}
