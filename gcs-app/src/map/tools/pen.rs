//! What all drawing has in common: places are clicked one after the other until the figure is whole.

use super::Canvas;
use super::snap::{self, snap_but};
use super::trial::is_at_rest;
use crate::map::polyline::{self, Style};
use crate::map::text;
use crate::map::view::Mercator;
use crate::theme::Palette;
use crate::units::{self, Units};
use egui::{Align2, Key, Painter, Pos2, Stroke, vec2};
use flight_plan::{Place, Value};
use geometry::LatLon;

/// A click so near to the first corner closes an outline, screen points.
const NEAR: f32 = 12.0;
/// An outline can't do that.
const CROSSES: &str = "crosses itself";
/// Points of a circle on the screen.
const ROUND: usize = 72;

/// What is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    /// From one place to another.
    Segment,
    /// A middle and a place on the rim.
    Circle,
    /// Two places or more.
    Line,
    /// Three corners or more, closed.
    Ring,
}

/// A place that was clicked.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// As a leg names it: a fix, where one was under the pointer.
    pub place: Place,
    /// Where it is.
    pub at: LatLon,
    /// What was near there, for people.
    pub on: Option<String>,
}

impl Mark {
    /// A place that is nothing else.
    pub fn at(at: LatLon) -> Self {
        Self { place: Place::Position(Value::Constant(at)), at, on: None }
    }
}

/// A figure on its way.
#[derive(Debug)]
pub struct Pen {
    figure: Figure,
    marks: Vec<Mark>,
    pointer: Option<Mark>,
    /// The pointer has not left the last place.
    rests: bool,
    /// What is wrong with it as it is.
    fault: Option<&'static str>,
    /// Its places are never drawn to the lines of runways.
    is_off_lines: bool,
}

impl Pen {
    /// With nothing drawn yet.
    pub fn new(figure: Figure) -> Self {
        Self { figure, marks: Vec::new(), pointer: None, rests: false, fault: None, is_off_lines: false }
    }

    /// What it draws.
    pub fn figure(&self) -> Figure {
        self.figure
    }

    /// Another figure can be drawn: of more places than one, all but the first would be lost.
    pub fn may_change(&self) -> bool {
        self.len() < 2
    }

    /// Draws another figure from now on, if it may; a place that was clicked alone begins it.
    pub fn set_figure(&mut self, figure: Figure) {
        if figure != self.figure && self.may_change() {
            let marks = self.drawn();
            *self = Self { marks, is_off_lines: self.is_off_lines, ..Self::new(figure) };
        }
    }

    /// What is not flown keeps off the lines of runways: a corner there lies in the final.
    pub fn off_lines(self) -> Self {
        Self { is_off_lines: true, ..self }
    }

    /// The place under the pointer, or what is near there.
    pub fn snap(&self, at: Pos2, canvas: &Canvas<'_>) -> Mark {
        snap_but(at, canvas, &|on, _| self.is_off_lines && snap::is_line(on))
    }

    /// How many places were clicked.
    pub fn len(&self) -> usize {
        self.marks.len()
    }

    /// Follows the pointer.
    pub fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pointer = at.map(|at| self.snap(at, canvas)).filter(|mark| mark.at.is_valid());
        let step = self.marks.last().zip(self.pointer.as_ref());
        self.rests = step.is_some_and(|(last, pointer)| is_at_rest(last.at, pointer.at, canvas));
        let ring: Vec<Pos2> = self.places().map(|at| canvas.view.place(at)).collect();
        self.fault = (self.figure == Figure::Ring && crosses_itself(&ring)).then_some(CROSSES);
    }

    /// An outline would end with this place: it is the first one again.
    pub fn closes(&self, mark: &Mark, canvas: &Canvas<'_>) -> bool {
        let is_first = |first: &Mark| canvas.view.place(first.at).distance(canvas.view.place(mark.at)) < NEAR;
        self.figure == Figure::Ring && self.len() >= 3 && self.marks.first().is_some_and(is_first)
    }

    /// Takes a place; gives the figure when it is whole.
    pub fn put(&mut self, mark: Mark, canvas: &Canvas<'_>) -> Option<Vec<Mark>> {
        if !mark.at.is_valid() {
            return None;
        }
        if self.closes(&mark, canvas) {
            return self.finish();
        }
        self.marks.push(mark);
        let is_whole = matches!(self.figure, Figure::Segment | Figure::Circle) && self.len() == 2;
        if is_whole { self.finish() } else { None }
    }

    /// What was clicked so far; it is forgotten.
    pub fn drawn(&mut self) -> Vec<Mark> {
        std::mem::take(&mut self.marks)
    }

    /// The figure, if it has enough places.
    pub fn finish(&mut self) -> Option<Vec<Mark>> {
        (self.len() >= self.least()).then(|| std::mem::take(&mut self.marks))
    }

    /// What was clicked, if that is enough for the figure.
    pub fn enough(&self) -> Option<Vec<LatLon>> {
        (self.len() >= self.least()).then(|| self.marks.iter().map(|mark| mark.at).collect())
    }

    fn least(&self) -> usize {
        if self.figure == Figure::Ring { 3 } else { 2 }
    }

    /// Does this key mean something to it now?
    pub fn wants(&self, key: Key) -> bool {
        !self.marks.is_empty() && matches!(key, Key::Escape | Key::Enter | Key::Backspace)
    }

    /// Enter ends the figure, Backspace takes the last place back, Escape all of them.
    pub fn key(&mut self, key: Key) -> Option<Vec<Mark>> {
        match key {
            Key::Enter => return self.finish(),
            Key::Backspace => drop(self.marks.pop()),
            _ => self.marks.clear(),
        }
        None
    }

    /// Forgets what was drawn.
    pub fn clear(&mut self) {
        self.marks.clear();
    }

    /// What to do next, so short that two lines of a small map hold it.
    pub fn hint(&self) -> &'static str {
        if self.fault.is_some() {
            return "the outline crosses itself; Backspace takes one back";
        }
        match (self.figure, self.len()) {
            (Figure::Segment, 0) => "click where it begins",
            (Figure::Segment, _) => "click where it ends",
            (Figure::Circle, 0) => "click the middle",
            (Figure::Circle, _) => "click the rim",
            (Figure::Line, 0) => "click the points of the line; Enter or a double click ends it",
            (Figure::Line, 1) => "click the next point; Enter or a double click ends it",
            (Figure::Line, _) => "Enter or a double click ends it; Backspace takes one back",
            (Figure::Ring, 0) => "click the corners; the first, Enter or a double click closes it",
            (Figure::Ring, 1 | 2) => "click the next; the first, Enter or a double click closes it",
            (Figure::Ring, _) => "Enter, a double click or the first closes it; Backspace takes one back",
        }
    }

    /// The figure as it would be if the pointer clicked now and it ended; `None`: it is not whole, or can't be.
    pub fn so_far(&self) -> Option<Vec<Mark>> {
        let pointer = self.pointer.iter().filter(|_| !self.rests);
        let marks: Vec<Mark> = self.marks.iter().chain(pointer).cloned().collect();
        (!self.marks.is_empty() && marks.len() >= self.least() && self.fault.is_none()).then_some(marks)
    }

    /// What was clicked, and where the pointer is.
    fn places(&self) -> impl Iterator<Item = LatLon> {
        self.marks.iter().chain(&self.pointer).map(|mark| mark.at)
    }

    /// What was clicked, and where the pointer is.
    pub fn begun(&self) -> Vec<Mark> {
        self.marks.iter().chain(&self.pointer).cloned().collect()
    }

    /// The places that were clicked.
    pub fn clicked(&self) -> impl Iterator<Item = &Mark> {
        self.marks.iter()
    }

    /// The place that was drawn last.
    pub fn last(&self) -> Option<LatLon> {
        self.marks.last().map(|mark| mark.at)
    }

    /// Where the pointer is.
    pub fn pointer(&self) -> Option<&Mark> {
        self.pointer.as_ref()
    }

    /// Draws what there is, red if it can't be. `is_bad`: what comes of it could not be flown.
    pub fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, is_bad: bool, p: &Palette) {
        let Some(first) = self.marks.first() else {
            return self.paint_snap(painter, canvas, p);
        };
        let colour = if is_bad || self.fault.is_some() { p.warning } else { p.accent };
        let parts = polyline::visible_parts(&self.outline(first.at), canvas.view);
        polyline::draw(painter, &parts, Stroke::new(2.0, colour), Style::Dashed, p.halo);
        for mark in &self.marks {
            painter.circle(canvas.view.place(mark.at), 4.5, p.halo, Stroke::new(2.0, colour));
        }
        self.paint_snap(painter, canvas, p);
        let (Some(last), Some(pointer)) = (self.marks.last(), &self.pointer) else { return };
        let size = self.size(last.at, pointer.at, canvas.scene.units());
        let words: Vec<&str> =
            [size.as_str()].into_iter().chain(self.fault).filter(|w| !w.is_empty()).collect();
        let words = words.join(" · ");
        let at = canvas.view.place(pointer.at) + vec2(10.0, -10.0);
        text::haloed(painter, at, Align2::LEFT_BOTTOM, &words, 13.0, p.text, p);
    }

    /// What a click would take.
    fn paint_snap(&self, painter: &Painter, canvas: &Canvas<'_>, p: &Palette) {
        if let Some(mark) = &self.pointer {
            snap::paint(painter, mark, canvas, p);
        }
    }

    fn outline(&self, first: LatLon) -> Vec<Mercator> {
        match (self.figure, self.places().nth(1)) {
            (Figure::Circle, Some(rim)) => {
                let radius_m = first.distance_m(rim);
                let step_deg = 360.0 / ROUND as f64;
                (0..=ROUND).map(|i| first.destination(step_deg * i as f64, radius_m).into()).collect()
            }
            (Figure::Ring, _) => self.places().chain([first]).map(Mercator::from).collect(),
            _ => self.places().map(Mercator::from).collect(),
        }
    }

    fn size(&self, from: LatLon, to: LatLon, units: Units) -> String {
        match self.figure {
            Figure::Circle => format!("radius {}", length(from.distance_m(to), units)),
            // where the pointer has just clicked there is no direction
            _ if from.distance_m(to) < 1.0 => String::new(),
            _ => way(from, to, units),
        }
    }
}

/// `850 m`, `3.2 km`.
pub fn length(metres: f64, units: Units) -> String {
    let far = units.distance();
    if metres >= far.to_si(1.0) { far.show(metres) } else { units.length().show(metres) }
}

/// `1.2 km · 045°`: the length, and the track at its beginning.
pub fn way(from: LatLon, to: LatLon, units: Units) -> String {
    let way = from.inverse(to);
    format!("{} · {}", length(way.distance_m, units), units::bearing(way.bearing_start_deg))
}

/// Do two edges of a ring that are no neighbours cross?
fn crosses_itself(ring: &[Pos2]) -> bool {
    let edges: Vec<(Pos2, Pos2)> =
        ring.iter().copied().zip(ring.iter().copied().cycle().skip(1)).take(ring.len()).collect();
    let are_neighbours = |i: usize, j: usize| j == i + 1 || (i == 0 && j + 1 == edges.len());
    edges.iter().enumerate().any(|(i, a)| {
        edges.iter().enumerate().skip(i + 1).any(|(j, b)| !are_neighbours(i, j) && cross(*a, *b))
    })
}

fn cross((a, b): (Pos2, Pos2), (c, d): (Pos2, Pos2)) -> bool {
    let side = |p: Pos2, q: Pos2, r: Pos2| (q - p).rot90().dot(r - p);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn rings_that_cross_themselves_are_recognised() {
        let square = [pos2(0.0, 0.0), pos2(9.0, 0.0), pos2(9.0, 9.0), pos2(0.0, 9.0)];
        let bow = [square[0], square[2], square[1], square[3]];
        let dart = [pos2(0.0, 0.0), pos2(9.0, 0.0), pos2(3.0, 3.0), pos2(0.0, 9.0)];
        for (ring, expected) in [(&square[..], false), (&bow, true), (&dart, false), (&square[..3], false)] {
            assert_eq!(crosses_itself(ring), expected, "{ring:?}");
        }
    }
}
