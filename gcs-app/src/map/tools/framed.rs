//! What is moved, turned and scaled as one: several things that are selected, or one that has an extent of its own.

use super::Canvas;
use crate::command::Selection;
use crate::map::sketch::radius_edit;
use egui::Rect;
use flight_plan::transform::{self, Motion};
use flight_plan::{Area, Edit, FlightPlan, Id, Leg, Place, Value, VariableValue, ZoneShape, create};
use geometry::LatLon;
use std::sync::Arc;

/// What a handle does to all of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Does {
    Move,
    Turn,
    Scale,
}

impl Does {
    pub const ALL: [Self; 3] = [Self::Move, Self::Turn, Self::Scale];
}

/// A circle looks the same however it is turned.
const ROUND: &[Does] = &[Does::Move, Does::Scale];

/// What can be done with what is selected, and the places it is around on the screen. `None`: it is one thing without an extent, or
/// nothing.
pub fn framed(canvas: &Canvas<'_>) -> Option<(&'static [Does], Rect)> {
    let (does, places) = match canvas.scene.view.also.is_empty() {
        true => alone(canvas)?,
        false => (&Does::ALL[..], together(canvas)?),
    };
    let mut around = Rect::NOTHING;
    places.into_iter().for_each(|at| around.extend_with(canvas.view.place(at)));
    around.is_finite().then_some((does, around))
}

fn together(canvas: &Canvas<'_>) -> Option<Vec<LatLon>> {
    let things = canvas.scene.selected_things();
    let variables = values(canvas, canvas.scene.selected_variables());
    let mut places = transform::places_of(canvas.scene.document.plan(), &things);
    places.extend(variables.iter().flat_map(|(_, value)| places_in(value)));
    (things.len() + variables.len() > 1).then_some(places)
}

/// An area, zone or runway that is selected alone; a runway is made longer by its ends.
fn alone(canvas: &Canvas<'_>) -> Option<(&'static [Does], Vec<LatLon>)> {
    const RIGID: &[Does] = &[Does::Move, Does::Turn];
    let (plan, sketch) = (canvas.scene.document.plan(), canvas.sketch);
    let of_plan = |id: &Id| transform::places_of(plan, std::slice::from_ref(id));
    match canvas.scene.view.selection.as_ref()? {
        Selection::Zone(id) => match plan.zone(id)?.shape {
            ZoneShape::Circle { .. } => Some((ROUND, of_plan(id))),
            ZoneShape::Polygon(_) => Some((&Does::ALL, of_plan(id))),
        },
        Selection::Runway(id) => Some((RIGID, of_plan(id))),
        Selection::Variable(name) => Some((&Does::ALL, sketch.area(name)?.to_vec())),
        Selection::Leg(id) => area(plan.leg(id)?.leg, canvas),
        _ => None,
    }
}

/// The area that a leg covers. `None`: there is none, or it is where an expression says that is no variable alone.
fn area(leg: &Leg, canvas: &Canvas<'_>) -> Option<(&'static [Does], Vec<LatLon>)> {
    let area = leg.area()?;
    let is_said = matches!(
        area,
        Area::Expression(_) | Area::Circle { centre: Place::Position(Value::Expression(_)), .. }
    );
    if is_said && create::bound_to(leg).is_none() {
        return None;
    }
    match area {
        Area::Circle { .. } => {
            let can_grow = radius_edit(canvas.scene.document.plan(), &leg.id, 1.0).is_some();
            let does = if can_grow { ROUND } else { &[Does::Move][..] };
            Some((does, canvas.sketch.circle(&leg.id)?.rim().to_vec()))
        }
        Area::Polygon { .. } | Area::Expression(_) => {
            Some((&Does::ALL, canvas.sketch.outline(&leg.id)?.to_vec()))
        }
    }
}

/// What a drag moves, as it was.
#[derive(Debug)]
pub struct Moved {
    plan: Arc<FlightPlan>,
    set: Vec<Id>,
    variables: Vec<(Id, VariableValue)>,
    /// Of a leg alone that covers a circle, metres.
    radius: Option<(Id, f64)>,
}

impl Moved {
    /// What is selected. What leads down to a runway goes with it, and an area that a variable says with the leg that covers it.
    pub fn of(canvas: &Canvas<'_>) -> Self {
        let scene = canvas.scene;
        let plan = scene.document.plan();
        let set = scene.selected_things();
        let mut variables = scene.selected_variables();
        if let [leg] = set.as_slice() {
            variables.extend(plan.leg(leg).and_then(|context| create::bound_to(context.leg)));
        }
        Self {
            set: create::with_approaches(plan, &set),
            variables: values(canvas, variables),
            radius: match set.as_slice() {
                [leg] => canvas.sketch.circle(leg).map(|circle| (leg.clone(), circle.radius_m)),
                _ => None,
            },
            plan: plan.clone(),
        }
    }

    /// The edit that moves it.
    pub fn edit(&self, motion: &Motion) -> Edit {
        let variables = self.variables.iter().map(|(name, was)| (name, was, motion.value(was)));
        let variables = variables
            .filter(|(_, was, value)| *was != value)
            .map(|(name, _, value)| Edit::SetVariable { name: name.clone(), value });
        // a variable may say it
        let radius = self.radius.as_ref().filter(|_| motion.scale != 1.0);
        let radius = radius.and_then(|(leg, was_m)| radius_edit(&self.plan, leg, was_m * motion.scale));
        let moved = std::iter::once(motion.edit(&self.plan, &self.set));
        Edit::All(moved.chain(variables).chain(radius).collect())
    }
}

/// Those of some variables that are places or areas, with what they are now.
fn values(canvas: &Canvas<'_>, names: Vec<Id>) -> Vec<(Id, VariableValue)> {
    names.into_iter().filter_map(|name| Some((name.clone(), canvas.sketch.value(&name)?))).collect()
}

fn places_in(value: &VariableValue) -> &[LatLon] {
    match value {
        VariableValue::Position(at) => std::slice::from_ref(at),
        VariableValue::Polygon(corners) => corners,
        _ => &[],
    }
}
