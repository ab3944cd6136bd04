//! Altitudes by hand: a mark at the end of each leg's passage; dragged up or down, it is the leg's altitude.

use super::Axes;
use crate::command::{DocumentCommand, PreviewCommand, Queue, Selection, ViewCommand};
use crate::forecast::{Passage, Point};
use crate::map::guard;
use crate::map::tools::has_left;
use crate::panels::Scene;
use crate::panels::inspector::inherited;
use crate::theme::{self, Palette};
use egui::{
    Align2, FontId, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, vec2,
};
use flight_plan::{Altitude, AltitudeReference, Edit, Id, Value};
use std::collections::BTreeSet;

/// Marks are so far from each other, and so large to the pointer, screen points.
const REACH: f32 = 14.0;
/// Altitudes are dragged in such steps, in the unit that is shown.
const STEP: f64 = 5.0;

/// The marks, and the drag of one.
#[derive(Debug, Default)]
pub struct Levels {
    drag: Option<Drag>,
    marks: Marks,
}

/// Where the marks are, by the numbers of their passages: looked for again when something else is shown or selected.
#[derive(Debug, Default)]
struct Marks {
    of: Option<Shown>,
    at: Vec<(usize, Pos2)>,
}

/// What marks are of.
#[derive(Debug)]
struct Shown {
    axes: Axes,
    /// Versions of the document and of the forecast.
    versions: (u64, u64),
    selection: Option<Selection>,
    also: BTreeSet<Selection>,
}

impl Marks {
    fn refresh(&mut self, axes: &Axes, scene: &Scene<'_>) -> &[(usize, Pos2)] {
        if !self.of.as_ref().is_some_and(|of| of.is_still(axes, scene)) {
            self.of = Some(Shown::of(axes, scene));
            self.at = marks(axes, scene).into_iter().map(|(index, _, at)| (index, at)).collect();
        }
        &self.at
    }
}

impl Shown {
    fn of(axes: &Axes, scene: &Scene<'_>) -> Self {
        let (selection, also) = (scene.view.selection.clone(), scene.view.also.clone());
        Self { axes: *axes, versions: versions(scene), selection, also }
    }

    fn is_still(&self, axes: &Axes, scene: &Scene<'_>) -> bool {
        (self.axes, self.versions) == (*axes, versions(scene))
            && (&self.selection, &self.also) == (&scene.view.selection, &scene.view.also)
    }
}

fn versions(scene: &Scene<'_>) -> (u64, u64) {
    (scene.document.version(), scene.analysis.forecast_version)
}

/// A drag on its way. It is measured on the axes as they were when it began: they change with the path.
#[derive(Debug)]
struct Drag {
    leg: Id,
    /// In metres, at the beginning.
    was_m: f64,
    reference: AltitudeReference,
    /// Where the pointer was then.
    from: Pos2,
    metres_per_point: f64,
    low_m: f64,
    high_m: f64,
    /// The pointer has left where it was pressed.
    has_left: bool,
}

impl Drag {
    fn begin(scene: &Scene<'_>, leg: &Id, from: Pos2, axes: &Axes) -> Result<Self, String> {
        if let Some(why) = guard::of_legs(scene, std::slice::from_ref(leg)) {
            return Err(why);
        }
        let context = scene.document.plan().leg(leg);
        let said = context.and_then(|context| inherited::altitude_said(&context));
        let said = said.or_else(|| inherited::altitude(scene, leg)).map(|said| said.value);
        match said {
            Some(Altitude { metres: Value::Constant(was_m), reference }) => Ok(Self {
                leg: leg.clone(),
                was_m,
                reference,
                from,
                metres_per_point: (axes.high_m - axes.low_m) / f64::from(axes.plot.height().max(1.0)),
                low_m: axes.low_m,
                high_m: axes.high_m,
                has_left: false,
            }),
            _ => {
                let name = scene.document.plan().label(leg);
                Err(format!("The altitude of {name} is a formula: change it in the inspector."))
            }
        }
    }

    /// The pointer was moved now, and not only by a hand that is not quite still.
    fn follows(&mut self, response: &Response) -> bool {
        self.has_left |= has_left(response);
        self.has_left && response.drag_delta() != Vec2::ZERO
    }

    fn altitude(&self, scene: &Scene<'_>, pointer: Pos2) -> Altitude {
        let metres = self.was_m + f64::from(self.from.y - pointer.y) * self.metres_per_point;
        let unit = scene.units().altitude();
        let metres = unit.to_si((unit.from_si(metres) / STEP).round() * STEP);
        let least = if self.reference == AltitudeReference::Agl { 0.0 } else { f64::MIN };
        Altitude { metres: Value::Constant(metres.max(least)), reference: self.reference }
    }
}

impl Levels {
    /// The lowest and the highest altitude of the axes, while a drag holds them.
    pub fn held_m(&self) -> Option<(f64, f64)> {
        self.drag.as_ref().map(|drag| (drag.low_m, drag.high_m))
    }

    /// Offers the marks, and follows the drag of one. They are painted where the pointer is over the plot.
    pub fn run(&mut self, ui: &Ui, painter: &Painter, axes: &Axes, scene: &Scene<'_>, queue: &mut Queue) {
        if scene.out_of_date().is_some() && self.drag.is_none() {
            return;
        }
        let p = theme::of(ui);
        let is_near = ui.rect_contains_pointer(axes.plot.expand(REACH));
        let mut marks = std::mem::take(&mut self.marks);
        for (index, at) in marks.refresh(axes, scene).iter().copied() {
            let Some(passage) = scene.forecast().passages.get(index) else { continue };
            let response = mark(ui, scene, passage, index, at);
            self.react(&response, passage, axes, scene, queue);
            if is_near || response.has_focus() || response.dragged() {
                draw(painter, at, response.hovered() || response.dragged(), p);
            }
        }
        self.marks = marks;
        self.paint(painter, ui.ctx().pointer_interact_pos(), scene, p);
    }

    fn react(
        &mut self,
        response: &Response,
        passage: &Passage,
        axes: &Axes,
        scene: &Scene<'_>,
        queue: &mut Queue,
    ) {
        if response.clicked() || response.drag_started() {
            queue.view(ViewCommand::Select(Some(scene.document.part_of(&passage.leg))));
        }
        if let Some(end) = end_of(scene, passage).filter(|_| response.clicked()) {
            queue.preview(PreviewCommand::Scrub(Some(end.time_s)));
        }
        if response.drag_started()
            && let Some(from) = response.ctx.input(|i| i.pointer.press_origin())
        {
            match Drag::begin(scene, &passage.leg, from, axes) {
                Ok(drag) => self.drag = Some(drag),
                Err(why) => queue.view(ViewCommand::Notice(why)),
            }
        }
        if let (Some(drag), Some(pointer)) = (&mut self.drag, response.interact_pointer_pos())
            && response.dragged()
            && drag.follows(response)
        {
            let altitude = Some(drag.altitude(scene, pointer));
            queue.document(DocumentCommand::DragEdit(Edit::SetAltitude { of: drag.leg.clone(), altitude }));
        }
        if response.drag_stopped() && self.drag.take().is_some() {
            queue.document(DocumentCommand::EndGesture);
        }
    }

    /// What the drag has come to.
    fn paint(&self, painter: &Painter, pointer: Option<Pos2>, scene: &Scene<'_>, p: &Palette) {
        let Some((drag, pointer)) = self.drag.as_ref().zip(pointer) else { return };
        let words = inherited::altitude_text(scene, &drag.altitude(scene, pointer));
        let text = format!("{} {words}", scene.document.plan().label(&drag.leg));
        // to the side where there is more room for it
        let (beside, align) = match pointer.x > painter.clip_rect().center().x {
            true => (-12.0, Align2::RIGHT_BOTTOM),
            false => (12.0, Align2::LEFT_BOTTOM),
        };
        painter.text(pointer + vec2(beside, -10.0), align, text, FontId::proportional(12.0), p.text);
    }
}

/// The ends of the passages that are on the plot, far enough from each other to be told apart; those of the selected leg first.
fn marks<'a>(axes: &Axes, scene: &Scene<'a>) -> Vec<(usize, &'a Passage, Pos2)> {
    let forecast = scene.forecast();
    let is_of_plan = |leg: &Id| !scene.document.kind_name(leg).is_empty();
    let places = forecast.passages.iter().enumerate();
    let places =
        places.filter_map(|(index, passage)| Some((index, passage, axes.place(end_of(scene, passage)?))));
    let places: Vec<_> = places.filter(|(.., at)| axes.plot.expand(1.0).contains(*at)).collect();
    let is_selected = |passage: &Passage| scene.is_selected(&Selection::Leg(passage.leg.clone()));
    let (first, rest): (Vec<_>, Vec<_>) =
        places.into_iter().partition(|(_, passage, _)| is_selected(passage));
    // whole screen points suffice, and are in order
    let mut taken: BTreeSet<i64> = BTreeSet::new();
    // whose leg it is takes longest to find out, and few are asked
    let is_free = |(_, passage, at): &(usize, &Passage, Pos2)| {
        let (x, gap) = (at.x.round() as i64, REACH as i64 + 1);
        taken.range(x - gap + 1..x + gap).next().is_none() && is_of_plan(&passage.leg) && taken.insert(x)
    };
    first.into_iter().chain(rest).filter(is_free).collect()
}

/// Where a passage ends, and its mark is.
fn end_of<'a>(scene: &Scene<'a>, passage: &Passage) -> Option<&'a Point> {
    scene.forecast().points.get(passage.first..passage.end)?.last()
}

fn mark(ui: &Ui, scene: &Scene<'_>, passage: &Passage, index: usize, at: Pos2) -> Response {
    let rect = Rect::from_center_size(at, Vec2::splat(REACH));
    let response = ui.interact(rect, ui.scope_id().with(("level", index)), Sense::click_and_drag());
    let pass: Vec<String> = passage.passes.iter().map(ToString::to_string).collect();
    let pass = if pass.is_empty() { String::new() } else { format!(", pass {}", pass.join(".")) };
    let name = format!("Altitude of {}{pass}", scene.document.label(&passage.leg));
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    response.on_hover_cursor(egui::CursorIcon::ResizeVertical)
}

fn draw(painter: &Painter, at: Pos2, hot: bool, p: &Palette) {
    let size = if hot { 6.0 } else { 4.0 };
    let corners = [vec2(0.0, -1.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(-1.0, 0.0)].map(|d| at + d * size);
    painter.add(Shape::convex_polygon(corners.to_vec(), p.halo, Stroke::new(1.6, p.accent)));
}
