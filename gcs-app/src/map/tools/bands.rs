//! Rubber bands: from a place to wherever the flight may go on from there.

use super::Canvas;
use super::new_leg::{self, Aim};
use crate::map::polyline::{self, Style};
use crate::map::view::Mercator;
use crate::theme::Palette;
use egui::{Painter, Stroke};
use flight_plan::create::Way;
use flight_plan::{EmergencyChoice, FlightPlan, Id, Leg, LegContext, Spot};
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

/// From a leg that is there: to what follows it and to what it comes from, which is the second value.
pub fn around(canvas: &Canvas<'_>, leg: &Id) -> (Vec<Band>, Option<LatLon>) {
    let Some(context) = canvas.scene.document.plan().leg(leg) else { return (Vec::new(), None) };
    let mut bands = Vec::new();
    follow(canvas, &context, DEEPEST, &mut bands);
    alternates(canvas, &context, &mut bands);
    bands.truncate(MOST);
    let before = new_leg::approach(canvas, &Aim::Spot(Spot::Before(leg.clone())));
    (bands, before.map(|before| before.from))
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

fn in_force<'a>(plan: &'a FlightPlan, context: &LegContext<'a>) -> &'a EmergencyChoice {
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
