//! Rubber bands: from a place to wherever the flight may go on from there.

use super::Canvas;
use super::new_leg::{self, Aim};
use crate::map::polyline::{self, Style};
use crate::map::sketch::Handled;
use crate::map::view::Mercator;
use crate::theme::Palette;
use egui::{Painter, Stroke};
use flight_plan::create::{Way, bound_to};
use flight_plan::{EmergencyChoice, FlightPlan, Id, Leg, LegContext, Place, Spot};
use geometry::LatLon;

/// Most bands from one place.
const MOST: usize = 12;
/// Forks behind forks that are looked through.
const DEEPEST: usize = 4;

/// Where the flight may go on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// To there.
    pub to: LatLon,
    /// It is the beginning of an emergency plan.
    pub is_alternate: bool,
}

/// From a new leg there.
pub fn behind(canvas: &Canvas<'_>, aim: &Aim) -> Vec<Band> {
    let plan = canvas.scene.document.plan();
    let mut bands = Vec::new();
    let around = match aim {
        Aim::Spot(Spot::Before(id)) => plan.leg(id).inspect(|context| {
            lead_to(canvas, context.leg, context, DEEPEST, &mut bands);
        }),
        Aim::Spot(Spot::After(id)) => plan.leg(id).inspect(|context| {
            follow(canvas, context, DEEPEST, &mut bands);
        }),
        Aim::Way { from, way } => plan.leg(from).inspect(|context| {
            let branch = context.leg.as_fork().and_then(|fork| {
                let is_it = |branch: &&flight_plan::Branch| match way {
                    Way::Branch(id) => branch.id == *id,
                    Way::New => Some(&branch.id) == fork.default,
                };
                fork.branches.iter().find(is_it)?.next.as_ref()
            });
            match branch.and_then(|id| context.siblings.iter().find(|leg| leg.id == *id)) {
                Some(target) => lead_to(canvas, target, context, DEEPEST, &mut bands),
                None => following(context).into_iter().for_each(|next| {
                    lead_to(canvas, next, context, DEEPEST, &mut bands);
                }),
            }
        }),
        Aim::Spot(Spot::EndOf(_)) => None,
    };
    around.iter().for_each(|context| alternates(canvas, context, &mut bands));
    bands.truncate(MOST);
    bands
}

/// From legs that are there: to what follows them.
pub fn around(canvas: &Canvas<'_>, legs: &[Id]) -> Vec<Band> {
    let contexts: Vec<LegContext<'_>> =
        legs.iter().filter_map(|leg| canvas.scene.document.plan().leg(leg)).collect();
    let mut bands = Vec::new();
    contexts.iter().for_each(|context| follow(canvas, context, DEEPEST, &mut bands));
    contexts.iter().for_each(|context| alternates(canvas, context, &mut bands));
    bands.truncate(MOST);
    bands
}

/// Where a leg comes from.
pub fn before(canvas: &Canvas<'_>, leg: &Id) -> Option<LatLon> {
    new_leg::approach(canvas, &Aim::Spot(Spot::Before(leg.clone()))).map(|before| before.from)
}

/// The legs that go to what is dragged: a waypoint's own, or those of a fix or a variable.
pub fn legs_to(plan: &FlightPlan, dragged: &Handled) -> Vec<Id> {
    let goes_there = |leg: &Leg| match dragged {
        Handled::Fix(fix) => matches!(leg.place(), Some(Place::Fix(id)) if id == fix),
        Handled::Variable(name) => bound_to(leg).as_ref() == Some(name),
        _ => false,
    };
    match dragged {
        Handled::Waypoint(leg) => vec![leg.clone()],
        Handled::Fix(_) | Handled::Variable(_) => {
            let legs = plan.all_legs().into_iter().map(|context| context.leg);
            legs.filter(|leg| goes_there(leg)).take(MOST).map(|leg| leg.id.clone()).collect()
        }
        _ => Vec::new(),
    }
}

fn following<'a>(context: &LegContext<'a>) -> Option<&'a Leg> {
    context.siblings.get(context.index + 1).map(AsRef::as_ref)
}

fn follow(canvas: &Canvas<'_>, context: &LegContext<'_>, depth: usize, bands: &mut Vec<Band>) {
    if let Some(next) = context.successor() {
        lead_to(canvas, next, context, depth, bands);
    }
}

/// Through forks, to each of their branches.
fn lead_to(canvas: &Canvas<'_>, leg: &Leg, beside: &LegContext<'_>, depth: usize, bands: &mut Vec<Band>) {
    if bands.len() >= MOST || depth == 0 {
        return;
    }
    let Some(fork) = leg.as_fork() else {
        let to = new_leg::place_of(canvas, leg.first_flown()).map(|to| Band { to, is_alternate: false });
        return bands.extend(to.filter(|band| !bands.contains(band)));
    };
    let index = beside.siblings.iter().position(|sibling| sibling.id == leg.id);
    let after = index.and_then(|index| beside.siblings.get(index + 1));
    for branch in fork.branches {
        let next = match &branch.next {
            Some(id) => beside.siblings.iter().find(|leg| leg.id == *id),
            None => after,
        };
        if let Some(next) = next {
            lead_to(canvas, next, beside, depth - 1, bands);
        }
    }
    if let (true, Some(after)) = (fork.branches.is_empty(), after) {
        lead_to(canvas, after, beside, depth - 1, bands);
    }
}

/// To where the emergency plans begin that are in force on a leg.
fn alternates(canvas: &Canvas<'_>, context: &LegContext<'_>, bands: &mut Vec<Band>) {
    for (_, id) in &in_force(canvas.scene.document.plan(), context).by_cause {
        let line = canvas.sketch.emergencies.iter().find(|(emergency, _)| emergency == id);
        let first = line.and_then(|(_, line)| line.first());
        let band = first.map(|to| Band { to: *to, is_alternate: true });
        bands.extend(band.filter(|band| !bands.contains(band)));
    }
}

/// The emergency plans that are in force on a leg.
pub fn in_force<'a>(plan: &'a FlightPlan, context: &LegContext<'a>) -> &'a EmergencyChoice {
    let loops = context.loops.iter().rev().map(|leg| &leg.emergency);
    let mut choices = std::iter::once(&context.leg.emergency).chain(loops).chain([&context.stage.emergency]);
    choices.find(|choice| !choice.by_cause.is_empty()).unwrap_or(&plan.emergency)
}

/// Draws bands from a place: dotted to what follows, grey and dashed to alternates.
pub fn paint(painter: &Painter, canvas: &Canvas<'_>, from: LatLon, bands: &[Band], p: &Palette) {
    for band in bands {
        let line: [Mercator; 2] = [from.into(), band.to.into()];
        let parts = polyline::visible_parts(&line, canvas.view);
        let (colour, style) = match band.is_alternate {
            true => (p.contingency, Style::Dashed),
            false => (p.weak, Style::Dotted),
        };
        polyline::draw(painter, &parts, Stroke::new(1.4, colour), style, p.halo);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fix_and_a_variable_drag_every_leg_that_goes_there() {
        let plan = flight_plan::read(
            r#"<flightPlan version="1" id="p">
              <fixes><fix id="A" at="46.0 8.0"/></fixes>
              <variables><variable name="fire" type="position" initial="46.1 8.1"/></variables>
              <mainPlan><stage id="s" type="mission">
                <TF id="a" fix="A"/><TF id="f" at="= fire"/><TF id="p" lat="46" lon="8.2"/><TF id="b" fix="A"/>
              </stage></mainPlan>
            </flightPlan>"#,
        )
        .plan;
        let legs = |dragged: Handled| -> Vec<String> {
            legs_to(&plan, &dragged).iter().map(ToString::to_string).collect()
        };
        assert_eq!(legs(Handled::Fix("A".into())), ["a", "b"]);
        assert_eq!(legs(Handled::Variable("fire".into())), ["f"]);
        assert_eq!(legs(Handled::Waypoint("p".into())), ["p"]);
        assert!(legs(Handled::Radius("p".into())).is_empty());
    }
}
