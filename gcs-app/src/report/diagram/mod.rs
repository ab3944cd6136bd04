//! A diagram of what a plan flies: one stage (or all of it) on plain paper, for the language's documents.
//!
//! Unlike the report's map it explains the geometry, not a flight: generated waypoints, areas with their holes, zones,
//! routes, centres, the way back in another colour, and the altitude where it matters.

mod strip;
mod surroundings;

use super::canvas::{Anchor, Canvas, Pen, Type};
use super::labels::Labels;
use super::map::{arrow, draw_north, draw_places, draw_scale};
use super::style::*;
use super::view::View;
use super::{assemble, zones};
use flight_exec::rehearse::{FlownWaypoint, LegPassage, Preview};
use flight_plan::{Id, Program};
use geometry::LatLon;

const WIDTH: f32 = 840.0;
const HEIGHT: f32 = 540.0;
const TITLE: f32 = 40.0;
const FOOTER: f32 = 56.0;
/// Around what is shown, for its names, pixels.
const MARGIN: f32 = 14.0;
/// Pixels along the path from one arrow head to the next.
const ARROW_EVERY: f32 = 120.0;
/// Flown in the legs' own direction.
const FORTH: Ink = rgb(0x1c62c9);
/// Flown backwards.
const BACK: Ink = rgb(0xc2255c);
/// What belongs to other stages.
const ELSEWHERE: Ink = rgb(0xbcc4cc);
const DIAGRAM_PAPER: Ink = rgb(0xffffff);

/// What is drawn.
struct Diagram<'a> {
    program: &'a Program,
    preview: &'a Preview,
    /// Only this stage's passages, with the others faded.
    stage: Option<&'a Id>,
}

/// A piece of the path as it is drawn.
struct Piece {
    passage: usize,
    line: Vec<(f32, f32)>,
}

/// The picture as PNG bytes: the passages of `stage` (of all stages when there is none), as previewed.
///
/// # Errors
/// Nothing of it was flown, or the encoder fails.
pub fn png(program: &Program, preview: &Preview, stage: Option<&Id>) -> anyhow::Result<Vec<u8>> {
    let diagram = Diagram { program, preview, stage };
    let profile = diagram.altitudes();
    let strip_height = if strip::is_worth_it(&profile) { strip::HEIGHT } else { 0.0 };
    let bottom = HEIGHT - FOOTER - strip_height;
    let window = (MARGIN, TITLE + MARGIN, WIDTH - 2.0 * MARGIN, bottom - TITLE - 2.0 * MARGIN);
    let view = View::around(diagram.extent(), window)
        .ok_or_else(|| anyhow::anyhow!("nothing of this stage is flown: name another with --stage"))?;
    let mut canvas = Canvas::new(WIDTH as u32, HEIGHT as u32, DIAGRAM_PAPER)?;
    diagram.draw(&mut canvas, &view);
    // what the path does beyond the window is not part of the picture
    canvas.rectangle(0.0, 0.0, WIDTH, TITLE, DIAGRAM_PAPER);
    canvas.rectangle(0.0, bottom, WIDTH, HEIGHT, DIAGRAM_PAPER);
    for y in [TITLE, bottom] {
        canvas.line(&[(0.0, y), (WIDTH, y)], Pen::solid(RULE, 1.2));
    }
    canvas.text((18.0, TITLE / 2.0), Anchor::Left, &program.plan.name, Type::bold(21.0, TEXT));
    if strip_height > 0.0 {
        strip::draw(&mut canvas, &profile, (0.0, bottom, WIDTH, strip_height), FORTH);
    }
    draw_scale(&mut canvas, &view, (26.0, HEIGHT - 20.0));
    draw_north(&mut canvas, (WIDTH - 36.0, TITLE + 40.0));
    diagram.draw_legend(&mut canvas);
    canvas.png()
}

impl Diagram<'_> {
    fn passage(&self, index: Option<usize>) -> Option<&LegPassage> {
        self.preview.legs.get(index?)
    }

    fn shows(&self, passage: Option<usize>) -> bool {
        self.passage(passage).is_some_and(|p| self.stage.is_none_or(|stage| p.place.stage == *stage))
    }

    /// Everything that must be in the picture.
    fn extent(&self) -> impl Iterator<Item = LatLon> {
        let track = self.preview.track.iter().filter(|p| self.shows(p.passage)).map(|p| p.position);
        let waypoints = self.waypoints().map(|w| w.waypoint.position);
        let path: Vec<LatLon> = track.chain(waypoints).chain(self.outlines()).collect();
        let zones = zones::near(&self.program.plan.zones, &path);
        path.into_iter().chain(zones)
    }

    /// The waypoints that were flown to.
    fn waypoints(&self) -> impl Iterator<Item = &FlownWaypoint> {
        self.preview.waypoints.iter().filter(|w| self.shows(w.passage) && !w.replaced)
    }

    fn ink(&self, passage: usize) -> Ink {
        match self.passage(Some(passage)) {
            Some(p) if !self.shows(Some(passage)) || p.place.leg == p.place.stage => ELSEWHERE,
            Some(p) if p.place.reverse => BACK,
            _ => FORTH,
        }
    }

    /// Metres flown and metres AMSL of what is shown.
    fn altitudes(&self) -> Vec<(f64, f64)> {
        let mut flown_m = 0.0;
        let mut last = None;
        let shown = self.preview.track.iter().filter(|p| self.shows(p.passage));
        shown
            .map(|p| {
                flown_m += last.map_or(0.0, |before: LatLon| before.distance_m(p.position));
                last = Some(p.position);
                (flown_m, p.altitude_amsl_m)
            })
            .collect()
    }

    fn draw(&self, canvas: &mut Canvas, view: &View) {
        let pieces = self.pieces(view);
        let mut labels = Labels::new(view.window());
        labels.keep_corner_for_north();
        pieces.iter().for_each(|piece| labels.keep_clear(&piece.line));
        self.draw_surroundings(canvas, view, &mut labels);
        self.draw_path(canvas, &pieces);
        self.draw_waypoints(canvas, view);
        draw_places(canvas, view, &mut labels, &assemble::places(&self.program.plan), DIAGRAM_PAPER);
        self.label_legs(canvas, &pieces, &mut labels);
    }

    /// The path cut where a passage ends; each piece reaches to the beginning of the next.
    fn pieces(&self, view: &View) -> Vec<Piece> {
        let mut pieces: Vec<Piece> = Vec::new();
        for point in &self.preview.track {
            let Some(passage) = point.passage else { continue };
            let at = view.place(point.position);
            if pieces.last().is_none_or(|piece| piece.passage != passage) {
                if let Some(last) = pieces.last_mut() {
                    last.line.push(at);
                }
                pieces.push(Piece { passage, line: Vec::new() });
            }
            let Some(piece) = pieces.last_mut() else { continue };
            // less than a pixel is not seen
            if piece.line.last().is_none_or(|(x, y)| (at.0 - x).hypot(at.1 - y) >= 1.0) {
                piece.line.push(at);
            }
        }
        pieces
    }

    /// Other stages below, then forth as a broad line and back as a narrow one: both are seen where they coincide.
    fn draw_path(&self, canvas: &mut Canvas, pieces: &[Piece]) {
        for (ink, width) in [(ELSEWHERE, 2.0), (FORTH, 3.6), (BACK, 1.9)] {
            for piece in pieces.iter().filter(|piece| self.ink(piece.passage) == ink) {
                canvas.line(&piece.line, Pen::solid(ink, width));
            }
        }
        let mut before = 0.0;
        for piece in pieces {
            let ink = self.ink(piece.passage);
            before = arrows(canvas, &piece.line, before, ink);
        }
    }

    fn draw_waypoints(&self, canvas: &mut Canvas, view: &View) {
        let radius = if self.waypoints().count() > 120 { 2.4 } else { 3.8 };
        for waypoint in self.waypoints() {
            let at = view.place(waypoint.waypoint.position);
            canvas.disc(at, radius, TEXT);
            canvas.disc(at, radius - 1.4, DIAGRAM_PAPER);
        }
    }

    /// Each leg's identifier beside its first passage; what has only one leg needs none.
    fn label_legs(&self, canvas: &mut Canvas, pieces: &[Piece], labels: &mut Labels) {
        let mut named: Vec<&Id> = Vec::new();
        let mut first: Vec<(&Piece, &Id)> = Vec::new();
        for piece in pieces.iter().filter(|piece| self.shows(Some(piece.passage))) {
            let Some(passage) = self.passage(Some(piece.passage)) else { continue };
            let leg = &passage.place.leg;
            if !named.contains(&leg) && *leg != passage.place.stage {
                named.push(leg);
                first.push((piece, leg));
            }
        }
        if first.len() < 2 {
            return;
        }
        for (piece, leg) in first {
            let ink = self.ink(piece.passage);
            labels.along(canvas, &piece.line, leg.as_str(), Type::plain(15.0, ink).on(DIAGRAM_PAPER));
        }
    }

    fn draw_legend(&self, canvas: &mut Canvas) {
        let back = self.preview.track.iter().filter_map(|p| p.passage).any(|p| self.ink(p) == BACK);
        let mut x = WIDTH - 22.0;
        let y = HEIGHT - 26.0;
        let mut entry = |canvas: &mut Canvas, text: &str, sign: &dyn Fn(&mut Canvas, f32)| {
            x -= canvas.text((x, y), Anchor::Right, text, Type::plain(15.0, TEXT)) + 8.0;
            sign(canvas, x);
            x -= 48.0;
        };
        entry(canvas, "waypoint", &|canvas, x| {
            canvas.disc((x - 4.0, y), 4.5, TEXT);
            canvas.disc((x - 4.0, y), 3.0, DIAGRAM_PAPER);
        });
        let line = |ink: Ink, width: f32| {
            move |canvas: &mut Canvas, x: f32| {
                canvas.line(&[(x - 30.0, y), (x, y)], Pen::solid(ink, width));
                arrow(canvas, (x - 15.0, y), (1.0, 0.0), ink);
            }
        };
        if back {
            entry(canvas, "flown backwards", &line(BACK, 1.9));
        }
        entry(canvas, "flown", &line(FORTH, 3.6));
    }
}

/// Arrow heads along a line, `before` pixels after the last one; gives how far the last one is behind at its end.
fn arrows(canvas: &mut Canvas, line: &[(f32, f32)], before: f32, ink: Ink) -> f32 {
    let mut since = before;
    for pair in line.windows(2) {
        let [(ax, ay), (bx, by)] = pair else { continue };
        let length = (bx - ax).hypot(by - ay);
        since += length;
        if since >= ARROW_EVERY && length > 0.0 {
            since = 0.0;
            arrow(canvas, (*bx, *by), ((bx - ax) / length, (by - ay) / length), ink);
        }
    }
    since
}

#[cfg(test)]
mod tests;
