//! Measure: distance and bearing from one place to another.

use super::pen::Mark;
use super::snap::{self, snap};
use super::{Canvas, Card, Grip, Pointer, Tool, Touch};
use crate::command::Queue;
use crate::map::polyline::{self, Style};
use crate::map::text;
use crate::map::view::Mercator;
use crate::panels::Scene;
use crate::theme::Palette;
use crate::units::{self, Units};
use egui::{Align2, CursorIcon, Key, Painter, Pos2, Stroke, vec2};
use geometry::LatLon;

/// The tool: two clicks set the ends, a third begins anew; the ends can be dragged.
#[derive(Debug, Default)]
pub struct Measure {
    from: Option<LatLon>,
    to: Option<LatLon>,
    /// Where the pointer is: the end, until there is one.
    pointer: Option<Mark>,
}

/// Names of the ends, in the order of their keys.
const ENDS: [&str; 2] = ["Measure from here", "Measure to here"];
/// Pieces of the line: it follows the ground, not the map's projection.
const PIECES: u32 = 32;

impl Measure {
    /// Both ends, as far as they are known.
    fn ends(&self) -> Option<(LatLon, LatLon)> {
        Some((self.from?, self.to.or(self.pointer.as_ref().map(|mark| mark.at))?))
    }

    fn set(&mut self, key: usize, to: LatLon) {
        match key {
            _ if !to.is_valid() => {}
            0 => self.from = Some(to),
            _ => self.to = Some(to),
        }
    }
}

impl Tool for Measure {
    fn card(&self) -> &'static Card {
        &Card { id: "measure", name: "Measure", symbol: "📏", key: Key::M }
    }

    fn status(&self, scene: &Scene<'_>) -> Option<String> {
        Some(match self.ends() {
            Some((from, to)) => format!("Measure: {}", result(from, to, scene.units())),
            None => "Measure: click two places. Esc ends it.".into(),
        })
    }

    fn grips(&self, canvas: &Canvas<'_>) -> Vec<Grip> {
        let ends = [self.from, self.to].into_iter().zip(ENDS).enumerate();
        let grip = |(key, (at, name)): (usize, (Option<LatLon>, &str))| {
            Some(Grip { key, name: name.into(), at: canvas.view.place(at?), first: true })
        };
        ends.filter_map(grip).filter(|grip| canvas.view.rect.contains(grip.at)).collect()
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pointer = at.map(|at| snap(at, canvas)).filter(|mark| mark.at.is_valid());
    }

    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        if pointer.grip.is_none() {
            self.put(snap(pointer.at, canvas), canvas, queue);
        }
    }

    fn typed_from(&self) -> Option<Option<LatLon>> {
        Some(self.from)
    }

    fn put(&mut self, mark: Mark, _canvas: &Canvas<'_>, _queue: &mut Queue) {
        if self.to.is_some() {
            self.leave();
        }
        self.set(usize::from(self.from.is_some()), mark.at);
    }

    fn drag(&mut self, grip: usize, to: Pos2, canvas: &Canvas<'_>, _queue: &mut Queue) {
        self.set(grip, snap(to, canvas).at);
    }

    fn wants(&self, key: Key) -> bool {
        key == Key::Escape && self.from.is_some()
    }

    fn key(&mut self, _key: Key, _canvas: &Canvas<'_>, _queue: &mut Queue) {
        self.leave();
    }

    fn leave(&mut self) {
        *self = Self::default();
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, touch: Touch, p: &Palette) {
        if let Some((from, to)) = self.ends() {
            let line: Vec<Mercator> = along(from, to).map(Mercator::from).collect();
            let parts = polyline::visible_parts(&line, canvas.view);
            let style = if self.to.is_some() { Style::Solid } else { Style::Dashed };
            polyline::draw(painter, &parts, Stroke::new(2.0, p.text), style, p.halo);
            let at = canvas.view.place(to) + vec2(10.0, -10.0);
            let result = result(from, to, canvas.scene.units());
            text::haloed(painter, at, Align2::LEFT_BOTTOM, &result, 13.0, p.text, p);
        }
        if let Some(pointer) = self.pointer.as_ref().filter(|_| self.to.is_none()) {
            snap::paint(painter, pointer, canvas, p);
        }
        for grip in self.grips(canvas) {
            let hot = touch.hovered == Some(grip.key) || touch.dragged == Some(grip.key);
            painter.circle(grip.at, if hot { 6.0 } else { 4.5 }, p.halo, Stroke::new(2.0, p.text));
        }
    }
}

/// Places along the shortest way over the ground, both ends included.
fn along(from: LatLon, to: LatLon) -> impl Iterator<Item = LatLon> {
    let way = from.inverse(to);
    let piece = way.distance_m / f64::from(PIECES);
    (0..PIECES)
        .map(move |i| from.destination(way.bearing_start_deg, piece * f64::from(i)))
        .chain(std::iter::once(to))
}

/// `3.2 km · 045° true`: the distance, and the bearing at the start.
fn result(from: LatLon, to: LatLon, units: Units) -> String {
    let way = from.inverse(to);
    let far = units.distance();
    let is_far = way.distance_m >= far.to_si(1.0);
    let distance = if is_far { far } else { units.length() }.show(way.distance_m);
    format!("{distance} · {} true", units::bearing(way.bearing_start_deg))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_read_in_the_units_in_use() {
        let from = LatLon::new(36.0, -84.0);
        for (bearing, distance_m, units, expected) in [
            (90.0, 12_345.0, Units::Si, "12.3 km · 090° true"),
            (359.9, 800.0, Units::Si, "800 m · 000° true"),
            (45.0, 18_520.0, Units::Aviation, "10.0 NM · 045° true"),
            (45.0, 304.8, Units::Aviation, "1000 ft · 045° true"),
        ] {
            assert_eq!(result(from, from.destination(bearing, distance_m), units), expected);
        }
    }

    #[test]
    fn the_line_runs_from_end_to_end_along_the_ground() {
        let (from, to) = (LatLon::new(50.0, -100.0), LatLon::new(50.0, 100.0));
        let line: Vec<LatLon> = along(from, to).collect();
        assert!(line.first().is_some_and(|p| p.distance_m(from) < 1e-3) && line.last() == Some(&to));
        assert!(line.iter().any(|p| p.lat_deg > 80.0), "the shortest way leads over the north");
        let sum: f64 = line.windows(2).map(|w| w[0].distance_m(w[1])).sum();
        assert!((sum - from.distance_m(to)).abs() < 1.0, "{sum}");
    }

    #[test]
    fn a_place_off_the_globe_is_not_taken() {
        let mut measure = Measure::default();
        measure.set(0, LatLon::new(f64::NAN, 0.0));
        assert_eq!(measure.from, None);
    }
}
