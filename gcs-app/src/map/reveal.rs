//! Where things are, and bringing what is out of view into it.

use super::sketch::Sketch;
use super::view::View;
use super::{MapState, zones};
use crate::command::Selection;
use crate::panels::Scene;
use flight_plan::{FlightPlan, Leg, Place, Section, transform};
use geometry::{LatLon, LocalFrame};
use std::sync::Arc;
use walkers::{MapMemory, lat_lon};

/// What is to be brought into view.
#[derive(Debug)]
pub(super) enum Wanted {
    /// What was selected, or where it is.
    Selected(Selection),
    /// All of these.
    Places(Vec<LatLon>),
}

impl MapState {
    /// Brings what was selected into the middle, if it is not in view; in the next frame, for it may be new.
    pub fn reveal(&mut self, selection: &Selection) {
        self.reveal = Some(Wanted::Selected(selection.clone()));
    }

    /// Brings all of these into view, if one is not; in the next frame, when what takes its place beside the map is there.
    pub fn reveal_all(&mut self, places: Vec<LatLon>) {
        self.reveal = Some(Wanted::Places(places));
    }

    /// Where its middle was put; `None`: it follows the aircraft.
    pub fn middle(&self) -> Option<LatLon> {
        self.memory.detached().map(|at| LatLon::new(at.y(), at.x()))
    }

    /// Where something selectable is or begins, if it is anywhere.
    pub fn place_of(&self, selection: &Selection, plan: &FlightPlan) -> Option<LatLon> {
        place_or_begin(selection, plan, &self.sketch)
    }

    /// True: it was out of view. Of several places the map shows all.
    pub(super) fn come_to(
        &self,
        wanted: &Wanted,
        view: &View,
        scene: &Scene<'_>,
        memory: &mut MapMemory,
    ) -> bool {
        let plan = scene.document.plan();
        let is_out = |at: &LatLon| !view.rect.contains(view.place(*at));
        let (found, all) = match wanted {
            Wanted::Selected(what) => {
                (self.place_of(what, plan).filter(is_out), transform::places_of(plan, &scene.selected_set()))
            }
            Wanted::Places(all) => (all.iter().copied().find(is_out), all.clone()),
        };
        let Some(at) = found else { return false };
        match View::fit(&all, view.rect.size()).filter(|_| all.len() > 1) {
            Some((middle, zoom)) => {
                memory.center_at(middle);
                // never nearer than it was, and fit keeps within the map's range
                let _ = memory.set_zoom(zoom.min(memory.zoom()));
            }
            None => memory.center_at(lat_lon(at.lat_deg, at.lon_deg)),
        }
        true
    }
}

/// Where something selectable is, if it is anywhere.
pub fn place_of(selection: &Selection, plan: &FlightPlan, sketch: &Sketch) -> Option<LatLon> {
    let of_leg = |leg| sketch.handles.iter().find(|h| h.what.leg() == Some(leg)).map(|h| h.at);
    match selection {
        Selection::Leg(id) => of_leg(id).or_else(|| plan.leg(id).and_then(|c| place_of_leg(plan, c.leg))),
        Selection::Stage(id) => {
            let legs = &plan.stage(id)?.legs;
            legs.iter().find_map(|leg| place_of_leg(plan, leg).or_else(|| of_leg(&leg.id)))
        }
        Selection::Emergency(id) => sketch.emergencies.iter().find(|(e, _)| e == id)?.1.first().copied(),
        Selection::Fix(id) => plan.fix(id).map(|f| f.position),
        Selection::Runway(id) => plan.runway(id).map(|r| r.threshold),
        Selection::Zone(id) => plan.zone(id).and_then(zones::middle),
        Selection::Variable(id) => {
            let area = || sketch.areas.iter().find(|(area, _)| area == id);
            let middle = || LocalFrame::around(&area()?.1).map(|frame| frame.origin());
            sketch.variables.iter().find(|v| v.name == *id).map(|v| v.at).or_else(middle)
        }
        Selection::Procedure(_) => {
            let inside = sketch.open_procedure(Some(selection))?;
            inside.line.first().copied().or(inside.reference)
        }
    }
}

/// The same; what names a place or a runway that is not there begins where the leg before it ends, and without one before it is near
/// the leg behind it, or the runway that it leads to.
pub fn place_or_begin(selection: &Selection, plan: &FlightPlan, sketch: &Sketch) -> Option<LatLon> {
    place_of(selection, plan, sketch).or_else(|| {
        let (legs, runway) = around(selection, plan)?;
        let mut places =
            legs.into_iter().filter_map(|leg| place_of(&Selection::Leg(leg.id.clone()), plan, sketch));
        places.next().or(runway)
    })
}

/// The legs around a leg or a stage: before it, the nearest first, of its list, then of the stages before; and then those behind it. And
/// the runway that all of them lead to.
fn around<'p>(selection: &Selection, plan: &'p FlightPlan) -> Option<(Vec<&'p Arc<Leg>>, Option<LatLon>)> {
    let context = match selection {
        Selection::Leg(id) => Some(plan.leg(id)?),
        _ => None,
    };
    let stage = context.as_ref().map_or(selection.id(), |context| &context.stage.id);
    let (section, _) = plan.all_stages().find(|(_, other)| other.id == *stage)?;
    let (stages, runway) = match section {
        Section::Main => (&plan.stages, plan.home()),
        Section::Emergency(emergency) => (&emergency.stages, plan.runway(&emergency.runway)),
    };
    let at = stages.iter().position(|other| other.id == *stage)?;
    let (own, behind) = match &context {
        Some(context) => context.siblings.split_at_checked(context.index)?,
        None => Default::default(),
    };
    let earlier = stages.get(..at).unwrap_or_default().iter().flat_map(|other| &other.legs);
    let earlier: Vec<&Arc<Leg>> = earlier.chain(own).collect();
    let later = stages.get(at + 1..).unwrap_or_default().iter().flat_map(|other| &other.legs);
    let legs = earlier.into_iter().rev().chain(behind).chain(later).collect();
    Some((legs, runway.map(|runway| runway.threshold)))
}

fn place_of_leg(plan: &FlightPlan, leg: &Leg) -> Option<LatLon> {
    match leg.place() {
        Some(Place::Fix(id)) => plan.fix(id).map(|f| f.position),
        Some(Place::Position(_)) => None,
        None => leg.body().iter().find_map(|inner| place_of_leg(plan, inner)),
    }
}
