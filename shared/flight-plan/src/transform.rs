//! Legs, fixes, zones and runways moved, turned and scaled together, about a pivot.

use crate::figures;
use crate::uses::SlotMut;
use crate::{Edit, FlightPlan, Id, Leg, Part, Place, Runway, Thing, Value, VariableValue, Zone, ZoneShape};
use geometry::LatLon;
use geometry::geodesy::normalise_360;
use std::collections::HashSet;

/// Numbers that are directions: they turn with what they belong to.
const DIRECTIONS: [&str; 3] = ["course", "heading", "bearing"];
/// Numbers that are sizes: they grow with what they belong to. How far apart tracks are does not.
const SIZES: [&str; 5] = ["radius", "innerRadius", "outerRadius", "width", "length"];

/// Where a set goes: everything keeps its distance and bearing from the pivot, but for the turn and the scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// What stays in its place in the set.
    pub pivot: LatLon,
    /// Where that goes.
    pub to: LatLon,
    /// Clockwise, degrees.
    pub turn_deg: f64,
    /// 1 keeps the size.
    pub scale: f64,
}

impl Motion {
    /// The whole set from one place to another.
    pub fn shift(pivot: LatLon, to: LatLon) -> Self {
        Self { pivot, to, turn_deg: 0.0, scale: 1.0 }
    }

    fn is_still(&self) -> bool {
        self.pivot == self.to && self.turn_deg == 0.0 && self.scale == 1.0
    }

    /// A place of the set.
    pub fn place(&self, from: LatLon) -> LatLon {
        if self.is_still() {
            return from;
        }
        let way = self.pivot.inverse(from);
        figures::place(
            self.to.destination(way.bearing_start_deg + self.turn_deg, way.distance_m * self.scale),
        )
    }

    /// A variable of the set: a place or an area; anything else is as it was.
    pub fn value(&self, value: &VariableValue) -> VariableValue {
        match value {
            VariableValue::Position(at) => VariableValue::Position(self.place(*at)),
            VariableValue::Polygon(corners) => {
                VariableValue::Polygon(corners.iter().map(|at| self.place(*at)).collect())
            }
            other => other.clone(),
        }
    }

    /// A leg of the set; a place that is a fix is where `fix` says, `None` keeps it.
    pub fn leg(&self, leg: &mut Leg, fix: &dyn Fn(&Id) -> Option<LatLon>) {
        leg.for_each_slot_mut(&mut |slot| match slot {
            SlotMut::Place(Place::Position(Value::Constant(at))) | SlotMut::Corner(at) => {
                *at = self.place(*at)
            }
            SlotMut::Place(place) => {
                if let Place::Fix(id) = place
                    && let Some(at) = fix(id)
                {
                    *place = Place::Position(Value::Constant(self.place(at)));
                }
            }
            SlotMut::Number(name, value) => self.number(name, value),
            SlotMut::Optional(name, Some(value)) => self.number(name, value),
            SlotMut::Optional(_, None) | SlotMut::Source(..) => {}
        });
    }

    fn number(&self, name: &str, value: &mut Value<f64>) {
        let Value::Constant(number) = value else { return };
        if DIRECTIONS.contains(&name) && self.turn_deg != 0.0 {
            *number = figures::direction_deg(normalise_360(*number + self.turn_deg));
        }
        if SIZES.contains(&name) {
            *number *= self.scale;
        }
    }

    /// A set of a plan's legs, with what is inside them, fixes, zones and runways. A fix that is not of the set goes with its legs
    /// if no other leg uses it; of another one, they leave. What is bound to a variable stays where the variable says.
    pub fn edit(&self, plan: &FlightPlan, set: &[Id]) -> Edit {
        if self.is_still() {
            return Edit::All(Vec::new());
        }
        let together = with_inner(plan, set);
        let used: HashSet<Id> = fixes(plan, |id| !together.contains(id));
        let outside: HashSet<Id> = used.into_iter().filter(|fix| !set.contains(fix)).collect();
        let mut moved: HashSet<Id> = fixes(plan, |id| together.contains(id));
        moved.extend(set.iter().cloned());
        let own = moved.difference(&outside).filter_map(|id| plan.fix(id));
        let mut edits: Vec<Edit> =
            own.map(|fix| Edit::MoveFix { fix: fix.id.clone(), to: self.place(fix.position) }).collect();
        edits.extend(self.zones_and_runways(plan, set));
        let elsewhere = |id: &Id| plan.fix(id).map(|fix| fix.position).filter(|_| outside.contains(id));
        for context in plan.all_legs() {
            if !together.contains(&context.leg.id) || !context.leg.body().is_empty() {
                continue;
            }
            let mut leg = context.leg.clone();
            self.leg(&mut leg, &elsewhere);
            if leg != *context.leg {
                edits.push(Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(leg) });
            }
        }
        Edit::All(edits)
    }

    fn zones_and_runways(&self, plan: &FlightPlan, set: &[Id]) -> Vec<Edit> {
        let zones = plan.zones.iter().filter(|zone| set.contains(&zone.id)).map(|zone| {
            let mut zone = zone.clone();
            self.zone(&mut zone);
            (zone.id.clone(), Thing::Zone(zone))
        });
        let runways = self.runways(plan, set).into_iter();
        let runways = runways.map(|runway| (runway.id.clone(), Thing::Runway(runway)));
        zones.chain(runways).map(|(id, thing)| Edit::Replace { id, with: Box::new(thing) }).collect()
    }

    /// The runways of a set; what is the other direction of one of them stays that.
    fn runways(&self, plan: &FlightPlan, set: &[Id]) -> Vec<Runway> {
        let mut moved: Vec<Runway> = Vec::new();
        for runway in plan.runways.iter().filter(|runway| set.contains(&runway.id)) {
            if moved.iter().any(|known| known.id == runway.id) {
                continue;
            }
            let mut there = runway.clone();
            self.runway(&mut there);
            let along = Self { pivot: runway.threshold, to: there.threshold, scale: 1.0, ..*self };
            moved.push(there);
            moved.extend(plan.opposite(runway).map(|other| {
                let mut other = other.clone();
                along.runway(&mut other);
                other
            }));
        }
        moved
    }

    /// A zone of the set.
    pub(crate) fn zone(&self, zone: &mut Zone) {
        match &mut zone.shape {
            ZoneShape::Circle { centre, radius_m } => {
                *centre = self.place(*centre);
                *radius_m *= self.scale;
            }
            ZoneShape::Polygon(corners) => corners.iter_mut().for_each(|at| *at = self.place(*at)),
        }
    }

    /// A runway of the set; it keeps its length.
    pub(crate) fn runway(&self, runway: &mut Runway) {
        runway.threshold = self.place(runway.threshold);
        runway.approach_entry.iter_mut().for_each(|at| *at = self.place(*at));
        if self.turn_deg != 0.0 {
            runway.heading_deg = normalise_360(runway.heading_deg + self.turn_deg);
        }
    }
}

/// The places of a set of legs, fixes, zones and runways.
pub fn places_of(plan: &FlightPlan, set: &[Id]) -> Vec<LatLon> {
    let set: HashSet<&Id> = set.iter().collect();
    let contexts = plan.all_legs();
    let legs = contexts.iter().filter(|context| set.contains(&context.leg.id));
    let mut found: Vec<LatLon> = legs.flat_map(|context| places(plan, context.leg)).collect();
    found.extend(plan.fixes.iter().filter(|fix| set.contains(&fix.id)).map(|fix| fix.position));
    found.extend(plan.zones.iter().filter(|zone| set.contains(&zone.id)).flat_map(outline));
    for runway in plan.runways.iter().filter(|runway| set.contains(&runway.id)) {
        found.extend([runway.threshold, runway.threshold.destination(runway.heading_deg, runway.length_m)]);
    }
    found.retain(|at| at.is_valid());
    found
}

fn outline(zone: &Zone) -> Vec<LatLon> {
    match &zone.shape {
        ZoneShape::Circle { centre, radius_m } => {
            [0.0, 90.0, 180.0, 270.0].map(|bearing| centre.destination(bearing, *radius_m)).to_vec()
        }
        ZoneShape::Polygon(corners) => corners.clone(),
    }
}

/// The places of a leg, as far as they are constants or fixes.
pub fn places(plan: &FlightPlan, leg: &Leg) -> Vec<LatLon> {
    let mut places = Vec::new();
    leg.for_each_part(&mut |part| match part {
        Part::Place(Place::Position(Value::Constant(at))) => places.push(*at),
        Part::Place(Place::Fix(id)) => places.extend(plan.fix(id).map(|fix| fix.position)),
        Part::Corner(at) => places.push(at),
        _ => {}
    });
    places.retain(|at| at.is_valid());
    places
}

/// Legs and the legs inside them.
fn with_inner(plan: &FlightPlan, legs: &[Id]) -> HashSet<Id> {
    let contexts = plan.all_legs();
    let inside = contexts.iter().filter(|context| {
        legs.contains(&context.leg.id) || context.loops.iter().any(|around| legs.contains(&around.id))
    });
    inside.map(|context| context.leg.id.clone()).collect()
}

/// The fixes that some legs use, in procedures and emergency plans too.
fn fixes(plan: &FlightPlan, wanted: impl Fn(&Id) -> bool) -> HashSet<Id> {
    let mut found = HashSet::new();
    let mut add = |leg: &Leg| {
        leg.for_each_part(&mut |part| {
            if let Part::Place(Place::Fix(id)) = part {
                found.insert(id.clone());
            }
        });
    };
    crate::create::every_leg(plan).into_iter().filter(|leg| wanted(&leg.id)).for_each(|leg| add(leg));
    found
}

#[cfg(test)]
mod tests;
