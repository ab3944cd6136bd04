//! Which flights are reviewed.
//!
//! The main plan once for each branch of the intersection that has most, then once for each branch that was not taken so far, at
//! most [`MAX_FLIGHTS`] times; each of the first [`MAX_EMERGENCY_PLANS`] emergency plans
//! once, from the point of those flights that is farthest from where it leads. Of a flight under way, what is ahead of it: it begins
//! behind the waypoints that can't be altered any more, with the energy that is left. By the preview, with real counts, conditions and energy:
//! the plan as it stands, the plan with the branches of each of those flights, and each of those emergency plans from that point.

use super::Conditions;
use super::alternates::Origin;
use super::beginning::Beginning;
use super::emergency_coverage::EmergencyCoverage;
use super::flown::{Flown, Point, fly, tireless};
use super::layout::{LaidOut, StartPoint, Way, counts, decisions, lay_out};
use crate::api::{AircraftState, Command, Event, Output};
use crate::executor::Executor;
use crate::layout::cursor::Cursor;
use crate::layout::path::PathState;
use crate::layout::stretch::IssuedWaypoint;
use crate::rehearse::{Act, Options, Preview, PreviewError, Scenario, Trigger, When, preview, preview_on};
use crate::value::{Config, Decision, LoopCount};
use aircraft::{Profile, Wind};
use flight_plan::{Cause, EmergencyPlan, Id, LegKind, Program};
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;
use terrain::Terrain;

/// Most flights of the main plan.
pub(super) const MAX_FLIGHTS: usize = 8;
/// Most emergency plans that are flown.
pub(super) const MAX_EMERGENCY_PLANS: usize = 16;

/// The flights of a plan.
pub(super) struct Flights {
    /// Each with the rest of what laying it out reported.
    pub main: Vec<Flown>,
    /// Emergency plans, each once for every home of the flights in which it answers: what counts from there is elsewhere.
    pub emergencies: Vec<Flown>,
    /// The plan as it stands.
    pub planned: Result<Preview, PreviewError>,
    /// The plan as it stands, but for the branches that somebody chooses where there is a choice.
    pub chosen: Vec<(Vec<Choice>, Result<Preview, PreviewError>)>,
    /// By emergency plan: as it stands.
    pub landings: BTreeMap<usize, Result<Preview, PreviewError>>,
    /// Branches taken, with their intersections.
    pub taken: HashSet<(Id, Id)>,
    /// Legs that can't be flown, and why.
    pub refused: Vec<(Id, String)>,
    /// Legs that are left because nothing is known of the ground below, and what to do about it.
    pub without_ground: Vec<(Id, String)>,
    /// Every flight of the main plan came to its end.
    pub complete: bool,
    /// They begin in the middle of a flight.
    pub under_way: bool,
}

/// A branch that is chosen at the first crossing of an intersection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Choice {
    pub leg: Id,
    pub branch: Id,
}

/// What every flight has in common.
struct Circumstances<'a> {
    program: &'a Arc<Program>,
    profile: &'a Profile,
    /// The same aircraft with energy for everything.
    tireless: Profile,
    terrain: &'a Arc<dyn Terrain>,
    wind: Wind,
    /// Of a flight under way: as it is.
    executor: Executor,
    under_way: bool,
}

impl Circumstances<'_> {
    /// A flight with real counts, conditions and energy.
    fn preview(&self, from: Beginning, commands: Vec<Command>) -> Result<Preview, PreviewError> {
        let alarm = commands.iter().any(|command| matches!(command, Command::Emergency { .. }));
        let then = commands.into_iter().map(Act::Command).collect();
        let scenario = Scenario { triggers: vec![Trigger { at: When::After { seconds: 0.0 }, then }] };
        let options = Options { most_s: 6.0 * 3600.0, step_s: 0.2, ..Options::default() };
        if self.under_way {
            let mut flight = self.moved_to(from);
            // an emergency plan is flown whatever is being answered now
            if alarm {
                flight.forget_emergency();
            }
            return preview_on(flight, self.wind, &scenario, &options);
        }
        preview(self.program, self.profile, self.terrain, self.wind, from.start(), &scenario, &options)
    }

    /// The flight under way as it would be somewhere else.
    fn moved_to(&self, to: Beginning) -> Executor {
        let mut executor = self.executor.clone();
        let aircraft = executor.aircraft().map(|aircraft| AircraftState {
            position: to.position,
            altitude_amsl_m: to.altitude_amsl_m,
            track_deg: to.heading_deg,
            battery: 1.0 - to.used_j / self.profile.energy_j,
            on_ground: to.on_ground,
            heading_deg: None,
            // the plan is judged, whatever becomes of a glide
            engine_out: false,
            ..aircraft
        });
        executor.put_aircraft(aircraft);
        executor
    }

    /// The flight that begins at a cursor, behind one that used so much energy, joules: where, and how long the aircraft stands before
    /// it, seconds.
    fn next_flight(&self, mut cursor: Cursor, used_j: f64) -> Option<(Beginning, StartPoint, f64)> {
        let stages = self.program.stages(None);
        let before = stages.get(cursor.stage.checked_sub(1)?)?.turnaround;
        let runway = self.program.plan.runway(stages.get(cursor.stage)?.runway.as_ref()?)?;
        let full_j = self.profile.energy_j;
        let used_j = (1.0 - before.energy_after(1.0 - used_j / full_j)) * full_j;
        let beginning = Beginning { used_j, ..Beginning::on(runway) };
        let path = beginning.path(&self.tireless);
        let (distance_m, time_s) = (cursor.path.distance_m, cursor.path.time_s);
        cursor.move_path_to(PathState { distance_m, time_s, ..path });
        let start_point = StartPoint { kept: Vec::new(), cursor };
        Some((beginning, start_point, before.time_s.unwrap_or(0.0)))
    }

    /// Where the main plan is begun, or gone on with.
    fn start_point(&self, from: Beginning) -> StartPoint {
        if !self.under_way {
            return from.start_point(None, &self.tireless);
        }
        let near = self.executor.alterable_from();
        let laid_out = |h: &IssuedWaypoint| LaidOut {
            waypoint: h.waypoint.clone(),
            wanted_amsl_m: h.waypoint.altitude_amsl_m,
            passage: h.passage,
        };
        let kept = self.executor.horizon().iter().take(near).map(laid_out).collect();
        StartPoint { kept, cursor: self.executor.bookmark(near) }
    }
}

impl Flights {
    pub fn of(
        program: &Arc<Program>,
        profile: &Profile,
        terrain: &Arc<dyn Terrain>,
        conditions: Conditions,
    ) -> Self {
        let wind = conditions.wind;
        let executor = executor(program, profile, terrain);
        let (tireless, under_way) = (tireless(profile), false);
        let given = Circumstances { program, profile, tireless, terrain, wind, executor, under_way };
        Self::flown(&given, Beginning::of_plan(program, terrain.as_ref(), conditions.begin))
    }

    /// Those ahead of a flight under way; `None`: nothing is being flown, or nothing is known of the aircraft.
    pub fn ahead(flight: &Executor, wind: Wind) -> Option<Self> {
        let aircraft = flight.aircraft().filter(|_| flight.is_flying())?;
        let mut executor = flight.clone();
        let mut outputs = Vec::new();
        // the legs under way as they will be in a moment
        if executor.has_refresh_due() {
            executor.refresh(&mut outputs);
        }
        let (program, profile, terrain) = (flight.active(), flight.profile(), flight.terrain());
        let (tireless, under_way) = (tireless(profile), true);
        let given = Circumstances { program, profile, tireless, terrain, wind, executor, under_way };
        let mut flights = Self::flown(&given, Beginning::of(&aircraft, profile));
        flights.refused.extend(outputs.into_iter().filter_map(|output| match output {
            Output::Event(Event::PatternRefused { leg, reason }) => Some((leg, reason)),
            _ => None,
        }));
        Some(flights)
    }

    fn flown(given: &Circumstances, beginning: Beginning) -> Self {
        let planned = given.preview(beginning, Vec::new());
        let mut flights = Self {
            main: Vec::new(),
            emergencies: Vec::new(),
            planned,
            chosen: Vec::new(),
            landings: BTreeMap::new(),
            taken: HashSet::new(),
            refused: Vec::new(),
            without_ground: Vec::new(),
            complete: true,
            under_way: given.under_way,
        };
        flights.fly_main(given, beginning);
        flights.fly_emergencies(given, beginning.used_j);
        flights
    }

    /// Every flight.
    pub fn all(&self) -> impl Iterator<Item = &Flown> {
        self.main.iter().chain(&self.emergencies)
    }

    /// The plan as it stands and with other branches: those of these flights that end.
    pub fn whole(&self) -> impl Iterator<Item = &Preview> {
        self.planned.iter().chain(self.chosen.iter().filter_map(|(_, preview)| preview.as_ref().ok()))
    }

    /// The legs that they come to, one time after the other: what is laid out ends sooner than a preview.
    pub fn legs(&self) -> impl Iterator<Item = &Id> {
        let laid_out =
            self.main.iter().flat_map(|flown| &flown.waypoints).map(|laid_out| &laid_out.waypoint.leg);
        laid_out.chain(self.whole().flat_map(|preview| &preview.legs).map(|passage| &passage.place.leg))
    }

    fn fly_main(&mut self, given: &Circumstances, beginning: Beginning) {
        let program = given.program;
        let from = given.start_point(beginning).cursor;
        let counts = counts(&given.executor, &from);
        // under way, many an intersection is behind: each further way is one that the flights so far come to
        let variants = if given.under_way { 1 } else { variants(program).min(MAX_FLIGHTS as u64) };
        let mut ways: Vec<Way> = (0..variants).map(Way::all).collect();
        let mut flown: Vec<(Way, HashSet<Id>)> = Vec::new();
        while let Some(way) = ways.pop().or_else(|| self.unseen(program, &flown)) {
            let decisions = decisions(program, &way, &from);
            let taken = self.fly_way(given, beginning, &counts, &decisions);
            self.fly_chosen(given, beginning, choices(&decisions, &from, &taken));
            flown.push((way, taken.iter().map(|(leg, _)| leg.clone()).collect()));
            self.taken.extend(taken);
        }
    }

    /// One way through the main plan, flight after flight; gives the branches taken.
    fn fly_way(
        &mut self,
        given: &Circumstances,
        beginning: Beginning,
        counts: &[LoopCount],
        decisions: &[Decision],
    ) -> HashSet<(Id, Id)> {
        let mut taken = HashSet::new();
        let mut ahead = Some((beginning, given.start_point(beginning), 0.0));
        while let Some((beginning, start_point, start_s)) = ahead.take() {
            let mut layout = lay_out(&given.executor, start_point, counts, decisions);
            self.complete &= layout.complete;
            taken.extend(layout.taken.drain());
            self.refused.extend(layout.refused.iter().cloned());
            self.without_ground.extend(layout.without_ground.iter().cloned());
            if start_s > 0.0 {
                // who starts it may do so later
                layout.hurried_from = Some(0);
            }
            let next = layout.next.take();
            let flown = fly(beginning.aircraft(&given.tireless), layout, given.wind, None, start_s);
            let (flown_s, used_j) = flown.points.last().map_or((0.0, 0.0), |last| (last.time_s, last.used_j));
            let landed_s = start_s + flown_s;
            let next = next.and_then(|cursor| given.next_flight(cursor, used_j));
            self.main.push(flown);
            ahead =
                next.map(|(begin, start_point, on_ground_s)| (begin, start_point, landed_s + on_ground_s));
        }
        taken
    }

    /// The plan with the branches of a way; not if it has no choice, or if the plan as it stands takes them anyway.
    fn fly_chosen(&mut self, given: &Circumstances, beginning: Beginning, choices: Vec<Choice>) {
        let known = self.chosen.iter().any(|(known, _)| *known == choices);
        let anyway = self.planned.as_ref().is_ok_and(|planned| takes(planned, &choices));
        if choices.is_empty() || known || anyway {
            return;
        }
        let decide = |c: &Choice| Command::Decide { leg: c.leg.clone(), branch: c.branch.clone() };
        let preview = given.preview(beginning, choices.iter().map(decide).collect());
        self.chosen.push((choices, preview));
    }

    /// A way to a branch that was not taken yet: one that came to its intersection, but there another branch.
    fn unseen(&self, program: &Program, flown: &[(Way, HashSet<Id>)]) -> Option<Way> {
        if flown.len() >= MAX_FLIGHTS || !program.has_forks() {
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

    /// `used_j`: the energy used by now. Whether what is left there lasts is asked of every point of the flights as they are
    /// flown, and not of these.
    fn fly_emergencies(&mut self, given: &Circumstances, used_j: f64) {
        let program = given.program;
        let emergency_coverage = EmergencyCoverage::of(program, self.legs());
        for (index, plan) in program.flown().emergency_plans.iter().enumerate().take(MAX_EMERGENCY_PLANS) {
            for (home, leg, worst) in self.worst_for(program, plan, index, &emergency_coverage) {
                let beginning = Beginning::at(&worst, used_j);
                let flown = self.fly_emergency(given, index, (beginning, home, worst.time_s));
                self.emergencies.push(Flown { entered_from: leg, ..flown });
                let alarm = Command::Emergency { cause: Cause::Operator, plan: Some(plan.id.clone()) };
                let flown = || given.preview(beginning, vec![alarm]);
                self.landings.entry(index).or_insert_with(flown);
            }
        }
    }

    /// Lays an emergency plan out from where it begins, in the flight from a home, and when.
    fn fly_emergency(
        &mut self,
        given: &Circumstances,
        index: usize,
        (beginning, home, from_s): (Beginning, Option<Id>, f64),
    ) -> Flown {
        let mut start_point = beginning.start_point(Some(index), &given.tireless);
        start_point.cursor.home = home;
        let (counts, decisions) = (
            counts(&given.executor, &start_point.cursor),
            decisions(given.program, &Way::default(), &start_point.cursor),
        );
        let layout = lay_out(&given.executor, start_point, &counts, &decisions);
        self.refused.extend(layout.refused.iter().cloned());
        self.without_ground.extend(layout.without_ground.iter().cloned());
        let aircraft = beginning.aircraft(&given.tireless);
        fly(aircraft, layout, given.wind, Some(index), from_s)
    }

    /// The point that is farthest from where an emergency plan leads, of those where it is in force; of all, if it is
    /// so nowhere (an operator may still choose it). One for each home that the flights have there, with that and the leg that is flown
    /// there.
    fn worst_for(
        &self,
        program: &Program,
        plan: &EmergencyPlan,
        index: usize,
        emergency_coverage: &EmergencyCoverage,
    ) -> Vec<(Option<Id>, Option<Id>, Point)> {
        let Some(runway) = program.plan.runway(&plan.runway).map(|r| r.threshold) else { return Vec::new() };
        let all = || self.main.iter().flat_map(|flown| flown.points.iter().map(move |p| (flown, *p)));
        let farthest = |points: &mut dyn Iterator<Item = (&Flown, Point)>| {
            let far = |p: &Point| crate::layout::path::distance_m(p.position, runway);
            let worst = points.max_by(|(_, a), (_, b)| far(a).total_cmp(&far(b)));
            worst.map(|(flown, point)| (flown.home.clone(), flown.leg(&point).cloned(), point))
        };
        let applies = |(flown, p): &(&Flown, Point)| {
            flown.leg(p).is_some_and(|leg| emergency_coverage.plans(leg).any(|i| i == index))
        };
        let mut homes: Vec<f64> = self.main.iter().map(|flown| flown.home_m).collect();
        homes.sort_by(f64::total_cmp);
        homes.dedup();
        let from =
            |home_m: f64| farthest(&mut all().filter(|(flown, _)| flown.home_m == home_m).filter(applies));
        let worst: Vec<_> = homes.into_iter().filter_map(from).collect();
        if worst.is_empty() { farthest(&mut all()).into_iter().collect() } else { worst }
    }
}

/// Points of a previewed flight, so many seconds apart, with the energy used by then: within a passage it is used evenly.
/// `full_j`: what the aircraft holds.
pub(super) fn points(planned: &Preview, full_j: f64, every_s: f64) -> Vec<Origin> {
    let mut used_j = Vec::with_capacity(planned.legs.len());
    // what was used before its first passage
    let mut sum_j = planned.energy_j - planned.legs.iter().map(|passage| passage.energy_j).sum::<f64>();
    for (index, passage) in planned.legs.iter().enumerate() {
        if let Some(stop) = planned.stops.iter().find(|stop| stop.legs == index) {
            sum_j = (1.0 - stop.battery_after) * full_j;
        }
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
            course_deg: crate::layout::path::distance_and_course(point.position, next.position).1,
            time_s: point.time_s,
            used_j: before_j + share * passage.energy_j,
        });
    }
    points
}

/// Flights that take each branch of the intersection with most of them.
fn variants(program: &Program) -> u64 {
    if !program.has_forks() {
        return 1;
    }
    let branches = |leg: &flight_plan::Leg| match &leg.kind {
        LegKind::Intersection { branches, .. } => branches.len() as u64,
        _ => 1,
    };
    program.flown().all_legs().iter().map(|c| branches(c.leg)).max().unwrap_or(1).max(1)
}

fn executor(program: &Arc<Program>, profile: &Profile, terrain: &Arc<dyn Terrain>) -> Executor {
    Executor::with_program(program, Config::default(), terrain.clone(), profile.clone())
}

/// The branches of a way at the intersections that it comes to, in the plan's order.
fn choices(decisions: &[Decision], from: &Cursor, taken: &HashSet<(Id, Id)>) -> Vec<Choice> {
    let first = decisions.iter().filter(|d| d.crossing == from.crossings_of(&d.leg) + 1);
    let choices = first.map(|d| Choice { leg: d.leg.clone(), branch: d.branch.clone() });
    choices.filter(|c| taken.contains(&(c.leg.clone(), c.branch.clone()))).collect()
}

/// A flight takes these branches where it comes to their intersections first.
fn takes(planned: &Preview, choices: &[Choice]) -> bool {
    choices.iter().all(|choice| {
        let first = planned.events.iter().find_map(|(_, event)| match event {
            Event::DecisionTaken { leg, branch, .. } if *leg == choice.leg => Some(branch),
            _ => None,
        });
        first == Some(&choice.branch)
    })
}
