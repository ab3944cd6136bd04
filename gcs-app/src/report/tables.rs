//! The report's texts: leg table as CSV, Markdown and HTML, events as JSON lines.

use super::flights::Energy;
use super::record::Record;
use super::{Findings, FlightReport, PassageReport};
use crate::say;
use flight_plan::legible;
use std::fmt::Write;

const COLUMNS: [&str; 12] = [
    "leg",
    "type",
    "stage",
    "iteration",
    "entered",
    "time",
    "previewed",
    "time off",
    "distance",
    "deviation RMS / 95 % / max",
    "from the authored path: RMS / max",
    "passage",
];

/// `m:ss`, or `h:mm:ss` from an hour on.
pub fn clock(seconds: f64) -> String {
    let s = seconds.max(0.0).round() as u64;
    let (h, m, s) = (s / 3600, s / 60 % 60, s % 60);
    if h > 0 { format!("{h}:{m:02}:{s:02}") } else { format!("{m}:{s:02}") }
}

/// One row per passage, plain numbers in seconds and metres.
pub fn csv(findings: &Findings) -> String {
    let mut text = String::from(
        "leg,type,stage,iterations,reverse,occurrence,start_s,time_s,planned_time_s,distance_m,cross_track_rms_m,cross_track_p95_m,cross_track_max_m,authored_rms_m,authored_max_m,flight\n",
    );
    for (index, row) in findings.passages.iter().enumerate() {
        let key = &row.passage.key;
        let flight = findings.flights.iter().find(|flight| flight.passages.contains(&index));
        let flight = flight.map_or(1, |flight| flight.number);
        let cross = row
            .cross_track
            .map_or(",,".to_owned(), |s| format!("{:.2},{:.2},{:.2}", s.rms_m, s.p95_m, s.max_m));
        let authored = row.from_authored.map_or(",".to_owned(), |s| format!("{:.2},{:.2}", s.rms_m, s.max_m));
        let planned = row.planned_time_s.map_or(String::new(), |s| format!("{s:.1}"));
        let (leg, stage, loops) = (quoted(&key.leg), quoted(&row.passage.stage), quoted(&key.iterations));
        text += &format!(
            "{leg},{},{stage},{loops},{},{},{:.1},{:.1},{planned},{:.1},{cross},{authored},{flight}\n",
            row.passage.kind,
            key.reverse,
            key.occurrence + 1,
            row.start_s,
            row.time_s,
            row.distance_m
        );
    }
    text
}

/// One row per flight of the plan, plain numbers in seconds, metres and joules; the share of the energy that is left.
pub fn flights_csv(findings: &Findings) -> String {
    let mut text = String::from("flight,start_s,time_s,distance_m,energy_j,energy_left\n");
    for flight in &findings.flights {
        let energy = flight.energy.map_or(",".to_owned(), |e| format!("{:.0},{:.4}", e.used_j, e.left));
        text += &format!(
            "{},{:.1},{:.1},{:.1},{energy}\n",
            flight.number, flight.start_s, flight.time_s, flight.distance_m
        );
    }
    text
}

/// RFC 4180, and fit to be shown; a leading sign that a spreadsheet would take for a formula is defused.
fn quoted(field: &str) -> String {
    let shown = legible(field);
    let formula = shown.starts_with(['=', '+', '-', '@']);
    let field = if formula { format!("'{shown}") } else { shown.into_owned() };
    if field.contains([',', '"', '\n', '\r']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field }
}

fn cells(row: &PassageReport) -> [String; 12] {
    let key = &row.passage.key;
    let cross = row
        .cross_track
        .map_or("–".to_owned(), |s| format!("{:.1} / {:.1} / {:.1} m", s.rms_m, s.p95_m, s.max_m));
    [
        key.leg.clone(),
        row.passage.kind.to_owned(),
        row.passage.stage.clone(),
        format!("{}{}", key.iterations, if key.reverse { " ←" } else { "" }),
        clock(row.start_s),
        clock(row.time_s),
        row.planned_time_s.map_or("–".to_owned(), clock),
        time_off(row),
        format!("{:.2} km", row.distance_m / 1000.0),
        cross,
        from_authored(row),
        (key.occurrence + 1).to_string(),
    ]
}

const FLIGHT_COLUMNS: [&str; 6] = ["flight", "begins", "time", "distance", "energy", "left"];

fn flight_cells(flight: &FlightReport) -> [String; 6] {
    let energy = |text: fn(Energy) -> String| flight.energy.map_or("–".to_owned(), text);
    [
        flight.number.to_string(),
        clock(flight.start_s),
        clock(flight.time_s),
        format!("{:.2} km", flight.distance_m / 1000.0),
        energy(|e| format!("{:.0} kJ", e.used_j / 1e3)),
        energy(|e| format!("{:.0} %", e.left * 100.0)),
    ]
}

/// The heading and the rows of each table of legs: one, or one for each flight of the plan.
fn legs_by_flight(findings: &Findings) -> impl Iterator<Item = (String, &[PassageReport])> {
    let several = findings.flights.len() > 1;
    findings.flights.iter().map(move |flight| {
        let heading = if several { format!("Legs of flight {}", flight.number) } else { "Legs".to_owned() };
        (heading, findings.passages.get(flight.passages.clone()).unwrap_or_default())
    })
}

/// The flights of the plan, where it has several, one line each.
pub fn flights(findings: &Findings) -> impl Iterator<Item = String> {
    let several = findings.flights.iter().filter(|_| findings.flights.len() > 1);
    several.map(|flight| {
        let [number, begins, time, distance, energy, left] = flight_cells(flight);
        format!("flight {number}: begins {begins}, {time}, {distance}, {energy}, {left} left")
    })
}

/// How much longer it took than previewed, for people.
pub fn time_off(row: &PassageReport) -> String {
    row.time_off().map_or("–".to_owned(), |share| format!("{:+.1} %", share * 100.0))
}

/// Deviations from the authored path, for people.
pub fn from_authored(row: &PassageReport) -> String {
    row.from_authored.map_or("–".to_owned(), |s| format!("{:.1} / {:.1} m", s.rms_m, s.max_m))
}

/// For people, and for diffs.
pub fn markdown(record: &Record, findings: &Findings) -> String {
    let mut text = format!(
        "# {}\n\n{}\n\n![map](map.png)\n\n![profile](profile.png)\n",
        legible(&record.title),
        legible(&record.notes.join(" · "))
    );
    if !record.verdict.is_empty() {
        text += "\n## Verdict\n\n";
        for (holds, sentence) in &record.verdict {
            text += &format!("- {} {}\n", if *holds { "✓" } else { "✗" }, legible(sentence));
        }
    }
    if findings.flights.len() > 1 {
        text += "\n## Flights\n\n";
        text += &pipes(&FLIGHT_COLUMNS, findings.flights.iter().map(flight_cells));
    }
    for (heading, legs) in legs_by_flight(findings) {
        text += &format!("\n## {heading}\n\n");
        text += &pipes(&COLUMNS, legs.iter().map(cells));
    }
    if !findings.coverages.is_empty() {
        text += "\n## Coverage\n\n| area | pass | size | seen |\n|---|---|---|---|\n";
        for c in &findings.coverages {
            text += &format!(
                "| {} | {} | {:.2} km² | {:.2} % |\n",
                legible(&c.label),
                legible(&c.passage.to_string()),
                c.area_m2 / 1e6,
                c.share * 100.0
            );
        }
    }
    text += "\n## What happened\n\n";
    for happening in &record.happenings {
        text += &format!("- {} {}\n", clock(happening.time_s), legible(&happening.text));
    }
    text
}

/// A table of Markdown.
fn pipes<const N: usize>(head: &[&str; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let mut text = format!("| {} |\n|{}\n", head.join(" | "), "---|".repeat(N));
    for row in rows {
        text += &format!("| {} |\n", row.map(|cell| legible(&cell).replace('|', "\\|")).join(" | "));
    }
    text
}

const HEAD: &str = "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\">\n<style>\
body{font:15px/1.5 system-ui,sans-serif;color:#1f2933;background:#faf9f6;max-width:1200px;margin:2em auto;padding:0 1em}\
img{width:100%;border:1px solid #c9ced4}table{border-collapse:collapse;width:100%}\
th,td{text-align:left;padding:.3em .7em;border-bottom:1px solid #c9ced4}td{font-variant-numeric:tabular-nums}\
.good::before{content:'✓ ';color:#15803d}.bad::before{content:'✗ ';color:#b91c1c}.bad{color:#b91c1c}ul{list-style:none;padding:0}\
</style>\n";

/// The same with the pictures, for a browser.
pub fn html(record: &Record, findings: &Findings) -> String {
    let title = escaped(&record.title);
    let mut text = format!(
        "{HEAD}<title>{title}</title>\n<h1>{title}</h1>\n<p>{}</p>\n",
        escaped(&record.notes.join(" · "))
    );
    text += "<ul>\n";
    for (holds, sentence) in &record.verdict {
        text +=
            &format!("<li class=\"{}\">{}</li>\n", if *holds { "good" } else { "bad" }, escaped(sentence));
    }
    text += "</ul>\n<img src=\"map.png\" alt=\"map of the flight\">\n<img src=\"profile.png\" alt=\"altitude profile\">\n";
    if findings.flights.len() > 1 {
        text += "<h2>Flights</h2>\n";
        let rows = findings.flights.iter().map(flight_cells);
        text += &table(&FLIGHT_COLUMNS.map(str::to_owned), rows);
    }
    for (heading, legs) in legs_by_flight(findings) {
        text += &format!("<h2>{heading}</h2>\n");
        text += &table(&COLUMNS.map(str::to_owned), legs.iter().map(cells));
    }
    if !findings.coverages.is_empty() {
        text += "<h2>Coverage</h2>\n";
        let rows = findings.coverages.iter().map(|c| {
            [
                c.label.clone(),
                c.passage.to_string(),
                format!("{:.2} km²", c.area_m2 / 1e6),
                format!("{:.2} %", c.share * 100.0),
            ]
        });
        text += &table(&["area", "pass", "size", "seen"].map(str::to_owned), rows);
    }
    text += "<h2>What happened</h2>\n";
    text += &table(
        &["time", "what"].map(str::to_owned),
        record.happenings.iter().map(|h| [clock(h.time_s), h.text.clone()]),
    );
    text
}

fn table<const N: usize>(head: &[String; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let row = |tag: &str, cells: &[String; N]| {
        let cells = cells.iter().fold(String::new(), |mut text, cell| {
            // writing to a String never fails
            let _ = write!(text, "<{tag}>{}</{tag}>", escaped(cell));
            text
        });
        format!("<tr>{cells}</tr>\n")
    };
    let body: String = rows.map(|r| row("td", &r)).collect();
    format!("<table>\n{}{body}</table>\n", row("th", head))
}

/// Fit for a page, and to be shown.
fn escaped(text: &str) -> String {
    legible(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// One JSON object a line: `time_s`, `text` and what the service said.
pub fn events(record: &Record) -> String {
    record
        .happenings
        .iter()
        .map(|h| {
            let event = serde_json::json!({"time_s": h.time_s, "text": h.text, "details": h.details});
            say::json_line(&event) + "\n"
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::{Jobs, Progress};
    use crate::report;

    #[test]
    fn clocks() {
        for (s, text) in [(0.0, "0:00"), (59.6, "1:00"), (61.0, "1:01"), (3661.0, "1:01:01"), (-5.0, "0:00")]
        {
            assert_eq!(clock(s), text);
        }
    }

    #[test]
    fn hostile_names_stay_text() {
        assert_eq!(quoted("=1+1"), "'=1+1");
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
        assert_eq!(escaped("<script>&\""), "&lt;script&gt;&amp;&quot;");
    }

    #[test]
    fn names_can_not_steer_whoever_reads_a_report() {
        const HOSTILE: &str = "a\u{202e}b\u{9b}2J\u{2066}c\u{1b}[1m";
        let mut record = report::record::tests::record();
        let mut flown = record.flown.clone();
        let key = report::PassageKey { leg: HOSTILE.into(), ..record.flown.passages()[0].key.clone() };
        flown.begin(key, "TF", HOSTILE.into());
        record.flown.points().iter().for_each(|p| {
            flown.push(report::TrackPoint { time_s: p.time_s + 5000.0, ..*p });
        });
        record.flown = flown;
        record.title = HOSTILE.into();
        record.notes.push(HOSTILE.into());
        record.verdict.push((true, HOSTILE.into()));
        record.areas.iter_mut().for_each(|area| area.label = HOSTILE.into());
        record.happenings.iter_mut().for_each(|happening| happening.text = HOSTILE.into());
        let findings = Findings::of(&record);
        for text in [markdown(&record, &findings), html(&record, &findings), csv(&findings), events(&record)]
        {
            let raw = text.chars().find(|c| *c != '\n' && flight_plan::legible::is_unseen(*c));
            assert!(raw.is_none() && text.contains("202e"), "{raw:?} in {text}");
        }
    }

    #[test]
    fn a_whole_report_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let record = report::record::tests::record();
        let findings = report::write(&record, folder.path(), &Progress::default()).unwrap().unwrap();
        assert_eq!(findings.passages.len(), record.flown.passages().len());
        assert!(findings.worst("TF").unwrap().worst_m() > 3.0 && findings.worst("RF").is_none());
        for name in ["map.png", "profile.png"] {
            let bytes = std::fs::read(folder.path().join(name)).unwrap();
            assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 20_000, "{name}: {} bytes", bytes.len());
        }
        let lines = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap().lines().count();
        assert_eq!((lines("legs.csv"), lines("flights.csv")), (findings.passages.len() + 1, 2));
        assert_eq!(lines("events.jsonl"), record.happenings.len());
        let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
        assert!(page.contains("sweep") && page.contains("class=\"bad\""));
    }

    #[test]
    fn each_flight_of_a_plan_has_its_section() {
        let mut record = report::record::tests::record();
        let mut flown = record.flown.clone();
        let key = report::PassageKey { leg: "to2".into(), ..record.flown.passages()[0].key.clone() };
        flown.begin(key, "take-off", "Again".into());
        record.flown.points().iter().for_each(|p| {
            flown.push(report::TrackPoint { time_s: p.time_s + 5000.0, ..*p });
        });
        record.flown = flown;
        record.energy =
            vec![Energy { used_j: 250_000.0, left: 0.4 }, Energy { used_j: 125_000.0, left: 0.71 }];
        let findings = Findings::of(&record);
        let page = markdown(&record, &findings);
        for part in [
            "## Flights",
            "| 2 | 1:23:20 |",
            "| 125 kJ | 71 % |",
            "## Legs of flight 1",
            "## Legs of flight 2",
        ] {
            assert!(page.contains(part), "{part} is missing in\n{page}");
        }
        let page = html(&record, &findings);
        assert!(page.contains("<h2>Flights</h2>") && page.contains("<h2>Legs of flight 2</h2>"));
        assert!(
            csv(&findings).lines().last().unwrap().ends_with(",2")
                && flights_csv(&findings).contains(",250000,0.4000")
        );
        assert_eq!(flights(&findings).count(), 2);
    }

    #[test]
    fn a_report_that_was_cancelled_leaves_no_files() {
        let folder = tempfile::tempdir().unwrap();
        let mut jobs = Jobs::default();
        let running = jobs.begin("Making the report".into());
        jobs.cancel(running.id());
        let record = report::record::tests::record();
        assert!(report::write(&record, folder.path(), running.progress()).unwrap().is_none());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let record = report::record::tests::record();
        let error = report::write(&record, &file.path().join("sub"), &Progress::default()).unwrap_err();
        assert!(format!("{error:#}").contains("choose another"), "{error:#}");
    }
}
