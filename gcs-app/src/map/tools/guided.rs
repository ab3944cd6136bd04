//! Draws what the guide to a new plan asks for: a place, the runway, the mission.

use super::pen::{Figure, Mark, Pen};
use super::snap::snap;
use super::{Canvas, Card, Pointer, Tool, Touch};
use crate::command::{Queue, ViewCommand};
use crate::guide::{Answer, Drawing, Guide, MissionFigure};
use crate::panels::{Scene, start};
use crate::theme::Palette;
use egui::{CursorIcon, Key, Painter, Pos2};
use flight_plan::template::Extent;
use geometry::LatLon;

/// In use as long as the guide asks for something on the map; not in the toolbar.
#[derive(Debug)]
pub struct Guided {
    pen: Pen,
    /// What is drawn now.
    drawing: Option<Drawing>,
    /// Where the mission was before it is drawn anew.
    before: Option<Extent>,
}

impl Default for Guided {
    fn default() -> Self {
        Self { pen: Pen::new(Figure::Segment), drawing: None, before: None }
    }
}

impl Guided {
    /// Does the guide ask for something?
    pub fn is_wanted(scene: &Scene<'_>) -> bool {
        start::is_wanted(scene) && scene.view.guide.drawing.is_some()
    }

    /// Draws what is asked for now; what was drawn of something else is dropped.
    pub fn follow(&mut self, guide: &Guide) {
        if self.drawing != guide.drawing {
            (self.drawing, self.before) = (guide.drawing, guide.extent.clone());
            self.pen.clear();
        }
        let figure = match MissionFigure::of(guide.template) {
            Some(MissionFigure::Area) if self.drawing == Some(Drawing::Mission) => Figure::Ring,
            Some(MissionFigure::Line) if self.drawing == Some(Drawing::Mission) => Figure::Line,
            Some(MissionFigure::Circle) if self.drawing == Some(Drawing::Mission) => Figure::Circle,
            _ => Figure::Segment,
        };
        if figure != self.pen.figure() && !self.pen.may_change() {
            // it was of another template
            self.pen.clear();
        }
        self.pen.set_figure(figure);
    }

    /// Who makes the plan without ending the outline means what is drawn of it.
    fn begin(&self, queue: &mut Queue) {
        if self.drawing == Some(Drawing::Mission) {
            let so_far = self.pen.enough().map(Extent::Drawn).or(self.before.clone());
            queue.view(ViewCommand::Guide(Answer::Begun(so_far)));
        }
    }

    fn complete(&self, marks: &[Mark], queue: &mut Queue) {
        let answer = match (self.drawing, self.pen.figure(), marks) {
            (Some(Drawing::Runway), _, [threshold, end, ..]) => Answer::Runway(threshold.at, end.at),
            (Some(Drawing::Mission), Figure::Circle, [centre, rim, ..]) => {
                let radius_m = centre.at.distance_m(rim.at).round();
                Answer::Mission(Extent::Around { centre: centre.at, radius_m })
            }
            (Some(Drawing::Mission), ..) => {
                Answer::Mission(Extent::Drawn(marks.iter().map(|mark| mark.at).collect::<Vec<LatLon>>()))
            }
            _ => return,
        };
        queue.view(ViewCommand::Guide(answer));
    }
}

impl Tool for Guided {
    fn card(&self) -> &'static Card {
        &Card { id: "guided", name: "Draw what the guide asks for", symbol: "✏", key: Key::G }
    }

    fn status(&self, scene: &Scene<'_>) -> Option<String> {
        let guide = &scene.view.guide;
        let escape = "Esc ends it.";
        Some(match guide.drawing? {
            Drawing::Place => "Zoom in and click where you fly, or type it into the card.".into(),
            Drawing::Runway if self.pen.len() == 0 => {
                format!("Runway: click the landing threshold. {escape}")
            }
            Drawing::Runway => format!("Runway: click its other end. {escape}"),
            Drawing::Mission => {
                let what = MissionFigure::of(guide.template).map_or("", MissionFigure::name);
                format!("{}, the {what}: {}. {escape}", guide.template.name(), self.pen.hint())
            }
        })
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.follow(&canvas.scene.view.guide);
        self.pen.hover(at, canvas);
    }

    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        if self.drawing == Some(Drawing::Place) {
            let at = canvas.view.geo(pointer.at);
            if at.is_valid() {
                queue.view(ViewCommand::Guide(Answer::Place(at)));
            }
        } else if let Some(marks) = self.pen.put(snap(pointer.at, canvas), canvas) {
            self.complete(&marks, queue);
        } else {
            self.begin(queue);
        }
    }

    fn finish(&mut self, _canvas: &Canvas<'_>, queue: &mut Queue) {
        if let Some(marks) = self.pen.finish() {
            self.complete(&marks, queue);
        }
    }

    fn wants(&self, key: Key) -> bool {
        // nothing is begun as long as a place is asked for: Escape is for the card
        (key == Key::Escape && self.drawing != Some(Drawing::Place)) || self.pen.wants(key)
    }

    fn key(&mut self, key: Key, _canvas: &Canvas<'_>, queue: &mut Queue) {
        if key == Key::Escape && self.pen.len() == 0 {
            queue.view(ViewCommand::Guide(Answer::Draw(None)));
        } else if let Some(marks) = self.pen.key(key) {
            self.complete(&marks, queue);
        } else {
            self.begin(queue);
        }
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, _touch: Touch, p: &Palette) {
        if self.drawing != Some(Drawing::Place) {
            self.pen.paint(painter, canvas, false, p);
        }
    }
}
