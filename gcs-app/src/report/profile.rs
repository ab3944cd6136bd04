//! `profile.png`: altitude planned and flown over time, the ground below, and the cross-track error.

use super::canvas::{Anchor, Canvas, Pen, Type};
use super::deviation;
use super::record::{Record, Track};
use super::style::*;

const WIDTH: f32 = 1600.0;
const HEIGHT: f32 = 820.0;
const LEFT: f32 = 86.0;
const RIGHT: f32 = WIDTH - 28.0;
/// Top and bottom of the altitude's box.
const ALTITUDE: (f32, f32) = (126.0, 560.0);
/// Top and bottom of the cross-track error's box.
const CROSS: (f32, f32) = (620.0, 764.0);
/// Backgrounds of neighbouring stages.
const BANDS: [Ink; 2] = [rgb(0xeef2f7), rgb(0xfaf9f6)];
/// Half the range of the cross-track box, metres; grows if more was measured.
const CROSS_RANGE_M: f64 = 20.0;

/// The picture as PNG bytes.
///
/// # Errors
/// Nothing to draw, or the encoder fails.
pub fn png(record: &Record) -> anyhow::Result<Vec<u8>> {
    let mut canvas = Canvas::new(WIDTH as u32, HEIGHT as u32, PAPER)?;
    let axes = Axes::of(record).ok_or_else(|| anyhow::anyhow!("the track is empty: nothing to draw"))?;
    draw_header(&mut canvas, record);
    draw_stages(&mut canvas, &axes, record.main_track());
    draw_grid(&mut canvas, &axes);
    draw_ground(&mut canvas, &axes, record);
    draw_altitudes(&mut canvas, &axes, record);
    draw_happenings(&mut canvas, &axes, record);
    draw_cross_track(&mut canvas, &axes, record);
    draw_legend(&mut canvas, record);
    canvas.png()
}

/// From seconds and metres to pixels.
struct Axes {
    start_s: f64,
    end_s: f64,
    low_m: f64,
    high_m: f64,
}

impl Axes {
    fn of(record: &Record) -> Option<Self> {
        let all = || record.planned.points().iter().chain(record.flown.points());
        let start_s = all().map(|p| p.time_s).min_by(f64::total_cmp)?;
        let end_s = all().map(|p| p.time_s).max_by(f64::total_cmp)?.max(start_s + 1.0);
        let ground = all().filter_map(|p| record.terrain.elevation_m(p.position));
        let low = all().map(|p| p.altitude_amsl_m).chain(ground).min_by(f64::total_cmp)?;
        let high = all().map(|p| p.altitude_amsl_m).max_by(f64::total_cmp)?;
        let low_m = (low / 100.0).floor() * 100.0;
        Some(Self { start_s, end_s, low_m, high_m: ((high + 60.0) / 100.0).ceil() * 100.0 })
    }

    fn x(&self, time_s: f64) -> f32 {
        LEFT + ((time_s - self.start_s) / (self.end_s - self.start_s)) as f32 * (RIGHT - LEFT)
    }

    fn y(&self, altitude_m: f64) -> f32 {
        let share = (altitude_m - self.low_m) / (self.high_m - self.low_m);
        ALTITUDE.1 - share as f32 * (ALTITUDE.1 - ALTITUDE.0)
    }
}

fn draw_header(canvas: &mut Canvas, record: &Record) {
    canvas.text(
        (26.0, 28.0),
        Anchor::Left,
        &format!("{}: altitude and cross-track error", record.title),
        Type::bold(26.0, TEXT),
    );
    canvas.text((26.0, 57.0), Anchor::Left, &record.notes.join("  ·  "), Type::plain(16.0, QUIET));
}

/// Stages of a track in order: name, start, end (seconds).
fn stages(track: &Track) -> Vec<(String, f64, f64)> {
    let mut found: Vec<(String, f64, f64)> = Vec::new();
    let time = |i: usize| track.points().get(i).or(track.points().last()).map_or(0.0, |p| p.time_s);
    for (i, passage) in track.passages().iter().enumerate() {
        let range = track.range(i);
        match found.last_mut() {
            Some((name, _, end)) if *name == passage.stage => *end = time(range.end),
            _ => found.push((passage.stage.clone(), time(range.start), time(range.end))),
        }
    }
    found
}

fn draw_stages(canvas: &mut Canvas, axes: &Axes, track: &Track) {
    let mut labelled_to = 0.0f32;
    for (i, (name, from, to)) in stages(track).into_iter().enumerate() {
        let (x0, x1) = (axes.x(from), axes.x(to));
        let band = BANDS[i % BANDS.len()];
        for (top, bottom) in [ALTITUDE, CROSS] {
            canvas.rectangle(x0, top, x1 - x0, bottom - top, band);
        }
        // short stages beside each other take turns in two rows
        let half = canvas.text_width(&name, 15.0) / 2.0;
        let x = ((x0 + x1) / 2.0).clamp(LEFT + half, RIGHT - half);
        let y = if x - half < labelled_to + 10.0 { ALTITUDE.0 - 36.0 } else { ALTITUDE.0 - 15.0 };
        if y > ALTITUDE.0 - 20.0 {
            labelled_to = x + half;
        }
        canvas.text((x, y), Anchor::Middle, &name, Type::bold(15.0, QUIET));
        canvas.line(&[(x0, ALTITUDE.0), (x0, ALTITUDE.1)], Pen::solid(RULE, 1.0));
    }
}

/// The least of 1, 2, 5, 10, … that gives at most `most` steps.
fn step(range: f64, most: f64) -> f64 {
    let least = (range / most).max(1e-6);
    let decade = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * decade).find(|s| *s >= least).unwrap_or(10.0 * decade)
}

/// Multiples of `step` between two values.
fn ticks(from: f64, to: f64, step: f64) -> impl Iterator<Item = f64> {
    let first = (from / step).ceil() as i64;
    (first..=(to / step + 1e-9).floor() as i64).map(move |i| i as f64 * step)
}

fn draw_grid(canvas: &mut Canvas, axes: &Axes) {
    let thin = Pen::solid(RULE, 1.0);
    for m in ticks(axes.low_m, axes.high_m, step(axes.high_m - axes.low_m, 8.0)) {
        let y = axes.y(m);
        canvas.line(&[(LEFT, y), (RIGHT, y)], thin);
        canvas.text((LEFT - 10.0, y), Anchor::Right, &format!("{m:.0}"), Type::plain(15.0, TEXT));
    }
    let minutes = (axes.end_s - axes.start_s) / 60.0;
    for minute in ticks(0.0, minutes, step(minutes, 12.0)) {
        let x = axes.x(axes.start_s + minute * 60.0);
        canvas.line(&[(x, CROSS.1), (x, CROSS.1 + 6.0)], Pen::solid(TEXT, 1.2));
        canvas.text((x, CROSS.1 + 19.0), Anchor::Middle, &format!("{minute}"), Type::plain(15.0, TEXT));
    }
    canvas.text(
        (RIGHT, CROSS.1 + 40.0),
        Anchor::Right,
        "minutes since the flight began",
        Type::plain(15.0, QUIET),
    );
    canvas.text((26.0, ALTITUDE.0 - 15.0), Anchor::Left, "m AMSL", Type::plain(15.0, QUIET));
}

/// The ground below the track; where nothing is known, nothing is drawn.
fn draw_ground(canvas: &mut Canvas, axes: &Axes, record: &Record) {
    let mut run: Vec<(f32, f32)> = Vec::new();
    let mut last_x = f32::MIN;
    for p in record.main_track().points() {
        let x = axes.x(p.time_s);
        match record.terrain.elevation_m(p.position) {
            Some(m) if x - last_x >= 1.0 => {
                run.push((x, axes.y(m)));
                last_x = x;
            }
            Some(_) => {}
            None => fill_ground(canvas, &std::mem::take(&mut run)),
        }
    }
    fill_ground(canvas, &run);
}

fn fill_ground(canvas: &mut Canvas, run: &[(f32, f32)]) {
    let (Some(first), Some(last)) = (run.first(), run.last()) else { return };
    let mut shape = run.to_vec();
    shape.extend([(last.0, ALTITUDE.1), (first.0, ALTITUDE.1)]);
    canvas.polygon(&shape, GROUND.faded(120));
    canvas.line(run, Pen::solid(GROUND, 1.6));
}

fn draw_altitudes(canvas: &mut Canvas, axes: &Axes, record: &Record) {
    let line = |track: &Track| -> Vec<(f32, f32)> {
        track.points().iter().map(|p| (axes.x(p.time_s), axes.y(p.altitude_amsl_m))).collect()
    };
    if record.flown.points().is_empty() {
        canvas.line(&line(&record.planned), Pen::solid(PLANNED, 2.6));
        return;
    }
    canvas.line(&line(&record.planned), Pen::solid(PLANNED.faded(150), 7.0));
    canvas.line(&line(&record.flown), Pen::solid(FLOWN, 2.0));
}

fn draw_happenings(canvas: &mut Canvas, axes: &Axes, record: &Record) {
    let mut last = f32::MIN;
    let mut y = ALTITUDE.0 + 16.0;
    for (i, happening) in record.happenings.iter().filter(|h| h.important).enumerate() {
        let x = axes.x(happening.time_s);
        y = if x - last < 26.0 { y + 26.0 } else { ALTITUDE.0 + 16.0 };
        last = x;
        canvas.line(&[(x, ALTITUDE.0), (x, ALTITUDE.1)], Pen::dashed(MARK.faded(150), 1.2, [4.0, 4.0]));
        super::map::numbered(canvas, (x, y), i + 1);
    }
}

fn draw_cross_track(canvas: &mut Canvas, axes: &Axes, record: &Record) {
    let offsets = deviation::signed(&record.planned, &record.flown);
    let most = offsets.iter().flatten().fold(0.0f64, |m, o| m.max(o.abs()));
    let range = CROSS_RANGE_M.max((most / 10.0).ceil() * 10.0);
    let y = |m: f64| (CROSS.0 + CROSS.1) / 2.0 - (m / range) as f32 * (CROSS.1 - CROSS.0) / 2.0;
    for m in ticks(-range, range, step(2.0 * range, 5.0)) {
        canvas.line(&[(LEFT, y(m)), (RIGHT, y(m))], Pen::solid(RULE, 1.0));
        canvas.text((LEFT - 10.0, y(m)), Anchor::Right, &format!("{m:.0}"), Type::plain(15.0, TEXT));
    }
    canvas.text(
        (26.0, CROSS.0 - 20.0),
        Anchor::Left,
        "cross-track error, m (right of the previewed path: up)",
        Type::plain(15.0, QUIET),
    );
    let mut run = Vec::new();
    for (point, offset) in record.flown.points().iter().zip(&offsets) {
        match offset {
            Some(m) => run.push((axes.x(point.time_s), y(*m))),
            None => canvas.line(&std::mem::take(&mut run), Pen::solid(FLOWN, 1.4)),
        }
    }
    canvas.line(&run, Pen::solid(FLOWN, 1.4));
    if record.flown.points().is_empty() {
        let middle = ((LEFT + RIGHT) / 2.0, (CROSS.0 + CROSS.1) / 2.0);
        canvas.text(middle, Anchor::Middle, "nothing was flown yet", Type::plain(15.0, QUIET));
    }
}

fn draw_legend(canvas: &mut Canvas, record: &Record) {
    let flown = !record.flown.points().is_empty();
    let mut entries =
        vec![(if flown { PLANNED.faded(150) } else { PLANNED }, if flown { 7.0 } else { 2.6 }, "previewed")];
    if flown {
        entries.push((FLOWN, 2.0, "flown"));
    }
    if record.main_track().points().iter().any(|p| record.terrain.elevation_m(p.position).is_some()) {
        entries.push((GROUND.faded(160), 9.0, "ground"));
    }
    let mut x = RIGHT;
    for (ink, width, text) in entries.into_iter().rev() {
        let text_width = canvas.text((x, 57.0), Anchor::Right, text, Type::plain(15.0, TEXT));
        x -= text_width + 10.0;
        canvas.line(&[(x - 36.0, 57.0), (x, 57.0)], Pen::solid(ink, width));
        x -= 66.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        for (range, most, expected) in
            [(1100.0, 8.0, 200.0), (43.0, 12.0, 5.0), (40.0, 5.0, 10.0), (1.0, 12.0, 0.1)]
        {
            assert!((step(range, most) - expected).abs() < 1e-9, "{range}/{most}: {}", step(range, most));
        }
        assert_eq!(ticks(-20.0, 20.0, 10.0).count(), 5);
    }

    #[test]
    fn stages_are_bands_without_gaps() {
        let bands = stages(&crate::report::record::tests::record().flown);
        assert_eq!(bands.len(), 6);
        assert!(bands.windows(2).all(|w| w[0].2 == w[1].1));
    }
}
