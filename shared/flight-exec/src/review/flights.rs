//! Which flights are looked at.
//!
//! The main plan once for each branch of the intersection that has most, then once for each branch that was not taken so far, at
//! most [`MOST_FLIGHTS`] times; each of the first [`MOST_EMERGENCY_PLANS`] emergency plans
//! once, from the point of those flights that is farthest from where it leads; and the plan as it stands, with its real counts
//! and conditions, by the preview.

use super::alternates::Origin;
use super::flown::{Flown, Point, fly, tireless};
use super::in_force::InForce;
use super::layout::{Way, counts, decisions, lay_out};
use crate::config::Config;
use crate::executor::Executor;
use crate::path::{Level, Passing, PathState};
use crate::preview::{Options, Preview, PreviewError, Scenario, Start, preview};
use aircraft::{Aircraft, Profile, Wind};
use flight_plan::{AltitudeReference, EmergencyPlan, Id, LegKind, Program, Variables};
use geometry::LatLon;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;
use terrain::Terrain;

/// Most flights of the main plan.
pub(super) const MOST_FLIGHTS: usize = 8;
/// Most emergency plans that are flown.
pub(super) const MOST_EMERGENCY_PLANS: usize = 16;

/// The flights of a plan.
pub(super) struct Flights {
    /// Each with the rest of what its lay-out told.
    pub main: Vec<Flown>,
    /// By emergency plan.
    pub emergencies: BTreeMap<usize, Flown>,
    /// The plan as it stands.
    pub planned: Result<Preview, PreviewError>,
    /// Branches taken, with their intersections.
    pub taken: HashSet<(Id, Id)>,
    /// Legs that can't be flown, and why.
    pub refused: Vec<(Id, String)>,
    /// Every flight of the main plan came to its end.
    pub complete: bool,
}

/// Where a flight begins.
#[derive(Clone, Copy)]
struct Beginning {
    position: LatLon,
    altitude_amsl_m: f64,
    heading_deg: f64,
    on_ground: bool,
}

impl Flights {
    pub fn of(program: &Arc<Program>, profile: &Profile, terrain: &Arc<dyn Terrain>, wind: Wind) -> Self {
        let tireless = tireless(profile);
        let executor = executor(program, profile, terrain);
        let beginning = beginning(program, terrain.as_ref());
        let start = start(beginning);
        let options = Options { most_s: 6.0 * 3600.0, step_s: 0.2, ..Options::default() };
        let planned = preview(program, profile, terrain, wind, start, &Scenario::default(), &options);
        let mut flights = Self {
            main: Vec::new(),
            emergencies: BTreeMap::new(),
            planned,
            taken: HashSet::new(),
            refused: Vec::new(),
            complete: true,
        };
        flights.fly_main(program, &executor, &tireless, beginning, wind);
        flights.fly_emergencies(program, &executor, &tireless, wind);
        flights
    }

    /// Every flight.
    pub fn all(&self) -> impl Iterator<Item = &Flown> {
        self.main.iter().chain(self.emergencies.values())
    }

    fn fly_main(
        &mut self,
        program: &Program,
        executor: &Executor,
        tireless: &Profile,
        beginning: Beginning,
        wind: Wind,
    ) {
        let counts = counts(program);
        let mut ways: Vec<Way> = (0..variants(program).min(MOST_FLIGHTS as u64)).map(Way::all).collect();
        let mut flown: Vec<(Way, HashSet<Id>)> = Vec::new();
        while let Some(way) = ways.pop().or_else(|| self.unseen(program, &flown)) {
            let path = beginning.path(tireless);
            let layout = lay_out(executor, None, path, &counts, &decisions(program, &way));
            self.complete &= layout.complete;
            flown.push((way, layout.taken.iter().map(|(leg, _)| leg.clone()).collect()));
            self.taken.extend(layout.taken);
            self.refused.extend(layout.refused);
            self.main.push(fly(beginning.aircraft(tireless), layout.waypoints, wind, None, 0.0));
        }
    }

    /// A way to a branch that was not taken yet: one that came to its intersection, but there another branch.
    fn unseen(&self, program: &Program, flown: &[(Way, HashSet<Id>)]) -> Option<Way> {
        if flown.len() >= MOST_FLIGHTS {
            return None;
        }
        let legs = program.flown().all_legs();
        legs.iter().find_map(|context| {
            let LegKind::Intersection { branches, .. } = &context.leg.kind else { return None };
            let id = &context.leg.id;
            let (way, _) = flown.iter().find(|(_, came_to)| came_to.contains(id))?;
            let seen = |branch: &Id| self.taken.contains(&(id.clone(), branch.clone()));
            let index = branches.iter().position(|b| !seen(&b.id))? as u64;
            // tried before, in vain
            let again = flown.iter().any(|(other, _)| other.named.get(id) == Some(&index));
            let mut named = way.named.clone();
            named.insert(id.clone(), index);
            (!again).then(|| Way { named, ..way.clone() })
        })
    }

    fn fly_emergencies(&mut self, program: &Program, executor: &Executor, tireless: &Profile, wind: Wind) {
        let counts = counts(program);
        let in_force = InForce::of(program);
        for (index, plan) in program.flown().emergency_plans.iter().enumerate().take(MOST_EMERGENCY_PLANS) {
            let Some(worst) = self.worst_for(program, plan, index, &in_force) else { continue };
            let beginning = Beginning {
                position: worst.position,
                altitude_amsl_m: worst.altitude_amsl_m,
                heading_deg: worst.course_deg,
                on_ground: false,
            };
            let path = beginning.path(tireless);
            let layout = lay_out(executor, Some(index), path, &counts, &decisions(program, &Way::default()));
            self.refused.extend(layout.refused);
            let aircraft = beginning.aircraft(tireless);
            let flown = fly(aircraft, layout.waypoints, wind, Some(index), worst.time_s);
            self.emergencies.insert(index, flown);
        }
    }

    /// The point that is farthest from where an emergency plan leads, of those where it is in force; of all, if it is
    /// so nowhere (an operator may still choose it).
    fn worst_for(
        &self,
        program: &Program,
        plan: &EmergencyPlan,
        index: usize,
        in_force: &InForce,
    ) -> Option<Point> {
        let runway = program.plan.runway(&plan.runway)?.threshold;
        let all = || self.main.iter().flat_map(|flown| flown.points.iter().map(move |p| (flown, *p)));
        let farthest = |points: &mut dyn Iterator<Item = Point>| {
            let far = |p: &Point| crate::path::distance_m(p.position, runway);
            points.max_by(|a, b| far(a).total_cmp(&far(b)))
        };
        let applies = |(flown, p): &(&Flown, Point)| {
            flown.leg(p).is_some_and(|leg| in_force.plans(leg).any(|i| i == index))
        };
        let first = farthest(&mut all().filter(applies).map(|(_, p)| p));
        first.or_else(|| farthest(&mut all().map(|(_, p)| p)))
    }
}

/// Points of a previewed flight, so many seconds apart, with the energy used by then: within a passage it is used evenly.
pub(super) fn points(planned: &Preview, every_s: f64) -> Vec<Origin> {
    let mut used_j = Vec::with_capacity(planned.legs.len());
    let mut sum_j = 0.0;
    for passage in &planned.legs {
        used_j.push(sum_j);
        sum_j += passage.energy_j;
    }
    let mut due_s = 0.0;
    let mut points = Vec::new();
    for pair in planned.track.windows(2) {
        let [point, next] = pair else { continue };
        let Some(passage) = point.passage.and_then(|i| Some((planned.legs.get(i)?, used_j.get(i)?))) else {
            continue;
        };
        if point.time_s < due_s {
            continue;
        }
        due_s = point.time_s + every_s;
        let (passage, before_j) = passage;
        let length_s = (passage.end_s - passage.start_s).max(1.0);
        let share = ((point.time_s - passage.start_s) / length_s).clamp(0.0, 1.0);
        points.push(Origin {
            leg: passage.place.leg.clone(),
            position: point.position,
            altitude_amsl_m: point.altitude_amsl_m,
            course_deg: crate::path::distance_and_course(point.position, next.position).1,
            time_s: point.time_s,
            used_j: before_j + share * passage.energy_j,
        });
    }
    points
}

/// Flights that take each branch of the intersection with most of them.
fn variants(program: &Program) -> u64 {
    let branches = |leg: &flight_plan::Leg| match &leg.kind {
        LegKind::Intersection { branches, .. } => branches.len() as u64,
        _ => 1,
    };
    program.flown().all_legs().iter().map(|c| branches(c.leg)).max().unwrap_or(1).max(1)
}

fn executor(program: &Arc<Program>, profile: &Profile, terrain: &Arc<dyn Terrain>) -> Executor {
    let mut executor = Executor::new(Config::default(), terrain.clone(), profile.clone());
    executor.state.variables = Variables::initial(program.flown());
    executor.program = program.clone();
    executor
}

/// On the runway; without a take-off, over the first place that the plan names, at the height at which it asks to be there.
fn beginning(program: &Program, terrain: &dyn Terrain) -> Beginning {
    if let Some(runway) = program.plan.home() {
        return Beginning {
            position: runway.threshold,
            altitude_amsl_m: runway.elevation_amsl_m,
            heading_deg: runway.heading_deg,
            on_ground: true,
        };
    }
    let variables = Variables::initial(program.flown());
    let flight = flight_plan::FlightState::on_ground(LatLon::new(0.0, 0.0));
    let env = flight_plan::Env { variables: &variables, flight };
    let legs = program.flown().all_legs();
    let first = legs.iter().find_map(|c| program.eval_place(c.leg.place()?, &env).ok());
    let position = first.unwrap_or(LatLon::new(0.0, 0.0));
    let own = legs.iter().find_map(|c| c.leg.altitude.as_ref().or(c.stage.altitude.as_ref()));
    let metres = own.and_then(|a| program.eval_number(&a.metres, &env).ok()).unwrap_or(0.0);
    let ground_m = match own.map(|a| a.reference) {
        Some(AltitudeReference::Agl) => terrain.elevation_m(position).unwrap_or(0.0),
        _ => 0.0,
    };
    Beginning { position, altitude_amsl_m: metres + ground_m, heading_deg: 0.0, on_ground: false }
}

fn start(beginning: Beginning) -> Start {
    if beginning.on_ground {
        return Start::Runway;
    }
    let Beginning { position, altitude_amsl_m, heading_deg, .. } = beginning;
    Start::InFlight { position, altitude_amsl_m, heading_deg }
}

impl Beginning {
    fn aircraft(&self, profile: &Profile) -> Aircraft {
        if self.on_ground {
            return Aircraft::on_runway(
                profile.clone(),
                self.position,
                self.altitude_amsl_m,
                self.heading_deg,
            );
        }
        Aircraft::in_flight(profile.clone(), self.position, self.altitude_amsl_m, self.heading_deg)
    }

    fn path(&self, profile: &Profile) -> PathState {
        let level = Level { metres: self.altitude_amsl_m, reference: AltitudeReference::Amsl };
        PathState {
            last: Passing {
                position: self.position,
                level,
                airspeed_mps: profile.cruise_airspeed_mps,
                fly_over: false,
            },
            course_deg: self.heading_deg,
            predicted_amsl_m: self.altitude_amsl_m,
            commanded_amsl_m: self.altitude_amsl_m,
            distance_m: 0.0,
            time_s: 0.0,
        }
    }
}
