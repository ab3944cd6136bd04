//! What the demo prints at its end.

use crate::report::{Findings, Record, clock, flight_lines, from_authored, time_off};
use std::path::Path;

/// The leg table, the verdict and where the report is, on standard output.
///
/// # Errors
/// Standard output can't be written.
pub fn print(record: &Record, findings: &Findings, wall_s: f64, folder: &Path) -> std::io::Result<()> {
    table(findings).lines().try_for_each(|row| say!("{row}"))?;
    flight_lines(findings).try_for_each(|line| say!("{line}"))?;
    for coverage in &findings.coverages {
        say!("seen of {}: {:.2} %", coverage.label, coverage.share * 100.0)?;
    }
    for (holds, sentence) in &record.verdict {
        say!("{} {sentence}", if *holds { "ok  " } else { "FAIL" })?;
    }
    let flown_s = record.flown.duration_s();
    say!(
        "{} flown in {wall_s:.1} s ({:.0} × real time); report: {}",
        clock(flown_s),
        flown_s / wall_s.max(0.1),
        folder.join("report.html").display()
    )?;
    let good = record.verdict.iter().all(|(holds, _)| *holds);
    let words = match (good, record.by_hand.is_empty()) {
        (true, true) => "The mission was flown as planned.",
        (true, false) => "The mission was flown as commanded.",
        (false, _) => "The mission was NOT flown as planned.",
    };
    say!("{words}")
}

fn table(findings: &Findings) -> String {
    let mut text = format!(
        "{:<26} {:<10} {:>7} {:>7} {:>9} {:>9}   {:<28}   from the authored path: RMS / max\n",
        "leg", "type", "entered", "time", "time off", "distance", "cross-track RMS / 95 % / max"
    );
    for row in &findings.passages {
        let cross = row.cross_track.map_or("not previewed".to_owned(), |s| {
            format!("{:.1} / {:.1} / {:.1} m", s.rms_m, s.p95_m, s.max_m)
        });
        text += &format!(
            "{:<26} {:<10} {:>7} {:>7} {:>9} {:>6.2} km   {cross:<28}   {}\n",
            row.passage.key.to_string(),
            row.passage.kind,
            clock(row.start_s),
            clock(row.time_s),
            time_off(row),
            row.distance_m / 1000.0,
            from_authored(row)
        );
    }
    text
}
