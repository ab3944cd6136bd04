//! What must hold of the path as it is flown: turns, holdings, patterns and the wind included.
//!
//! `flight_plan::check` reads a plan's text and legs. Here the executor's own cursor lays the compiled plan out and the simulated
//! aircraft flies it: every branch of every intersection, loops for two passes (the first from outside, the second from
//! their own end), each emergency plan from the point that is worst for it. The preview then flies, with real counts, times and
//! energy: the plan as it stands, the plan with each other branch, and each emergency plan without help from anybody. Then
//! each rule judges those flights: one rule a file, each with the codes it gives.
//!
//! The work is bounded: the module `flights` says by what. What was not reviewed is reported (`not-reviewed`).
//!
//! # Who reviews what, and when
//!
//! [`compile_and_review`] is check and review together. The FP Manager runs it for each proposal on a thread of its own, with the
//! wind and the time of day of now; `legwork check` and the window run it for each edit. The last two then try the extremes of the
//! variables' bounds ([`review_extremes`]: the same plan with other initial values, at most [`MAX_TRIALS`] times), and look for
//! remedies that have to be tried ([`leave_zones_out`], [`bring_within_glide`]). On board a proposal is answered without both. A plan that was accepted is
//! not reviewed again after a restart. For a flight under way see the module `ahead`.

mod ahead;
mod alternates;
mod altitudes;
mod arcs;
mod beginning;
mod by_runway;
mod ceiling;
mod emergency_coverage;
mod emergency_routes;
mod endurance;
mod extremes;
mod flights;
mod flown;
mod foresight;
mod gates;
mod glide;
mod held;
mod landings;
mod layout;
mod left_out;
mod open_end;
mod other_ways;
mod passes;
pub mod plausibility;
mod powered;
mod prepared;
mod refused;
mod remedy;
mod stay_in;
mod steep_landings;
mod terrain_clearance;
mod tracks;
mod turns;
mod unknown_terrain;
mod unseen;
mod waypoints;
mod wind;
mod within_glide;
mod zones;

use crate::rehearse::Start;
pub use ahead::{compile_and_review_ahead, review_ahead, review_command, review_turn};
use aircraft::{Autopilot, Profile, Wind};
use alternates::Origin;
use emergency_coverage::EmergencyCoverage;
pub use extremes::{MAX_TRIALS, review_extremes};
use flight_plan::checks::CLEARANCE_M;
use flight_plan::{
    AltitudeReference, Edit, Env, FlightState, Id, LegKind, Problem, Program, StageKind, Value, Variables,
    mend_at_source,
};
use flights::Flights;
pub use foresight::foresee;
pub use left_out::{leave_zones_out, put_remedies};
pub use open_end::{ending_conditions, open_end};
use prepared::Zones;
use std::collections::HashSet;
use std::sync::Arc;
use terrain::Terrain;
pub use within_glide::bring_within_glide;

/// What a plan is reviewed for, besides the aircraft and the ground.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Conditions {
    /// The wind on the whole flight.
    pub wind: Wind,
    /// When it starts (of a flight under way: now), seconds since 1970-01-01T00:00:00Z; `None`: not known, zones are taken as
    /// always active.
    pub start_unix_s: Option<i64>,
    /// Where a plan without a take-off begins; `None`: over the first place that it names.
    pub begin: Option<Start>,
    /// What is kept in reserve.
    pub margins: Margins,
    /// The autopilot by whose habits a flight that is foreseen is flown; `None`: close to the lines, as in reviews.
    pub autopilot: Option<Autopilot>,
    /// The autopilot of a flight that is foreseen holds indicated airspeeds, in air that is so much warmer than the standard's, °C;
    /// `None`: true ones, as in reviews.
    pub isa_deviation_c: Option<f64>,
    /// The steepest landing that the autopilot takes, degrees; `None`: it has not told that.
    pub landing_deg: Option<f64>,
}

/// What is kept in reserve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins {
    /// Height above the ground away from runways that the path as flown keeps, metres. A little less than what the check asks for
    /// of the plan as it is written ([`flight_plan::checks::CLEARANCE_M`]): turns and climbs as flown differ by some metres from
    /// the lines of the plan, and a plan that is written well should not be warned of for that.
    pub terrain_m: f64,
    /// Distance from the edges of zones, metres.
    pub zone_m: f64,
    /// Share of the energy left when landed, 0..1.
    pub energy_share: f64,
    /// Height above the threshold with which a glide arrives, metres.
    pub glide_m: f64,
}

impl Default for Margins {
    fn default() -> Self {
        Self { terrain_m: CLEARANCE_M - 10.0, zone_m: 10.0, energy_share: 0.05, glide_m: 15.0 }
    }
}

/// What the rules read.
struct View<'a> {
    program: &'a Program,
    profile: &'a Profile,
    terrain: &'a dyn Terrain,
    conditions: Conditions,
    /// Their values where the flights begin.
    variables: Variables,
    flights: Flights,
    zones: Zones,
    emergency_coverage: EmergencyCoverage,
}

type Rule = fn(&View, &mut Vec<Problem>);

/// Every rule; the order is that of the problems.
const RULES: [Rule; 22] = [
    refused::check,
    unseen::check,
    wind::check,
    zones::check,
    unknown_terrain::check,
    terrain_clearance::check,
    by_runway::check,
    ceiling::check,
    altitudes::check,
    turns::check,
    arcs::check,
    tracks::check,
    waypoints::check,
    endurance::check,
    held::check,
    passes::check,
    gates::check,
    landings::check,
    steep_landings::check,
    emergency_routes::check,
    powered::check,
    glide::check,
];

/// Every problem of the path that a compiled plan makes the aircraft fly, each once for a leg.
///
/// Variables have their initial values; [`review_extremes`] tries others.
pub fn review(
    program: &Arc<Program>,
    profile: &Profile,
    terrain: &Arc<dyn Terrain>,
    conditions: Conditions,
) -> Vec<Problem> {
    View::of(program, profile, terrain, conditions).problems()
}

impl<'a> View<'a> {
    /// From its start, with the variables' initial values.
    fn of(
        program: &'a Arc<Program>,
        profile: &'a Profile,
        terrain: &'a Arc<dyn Terrain>,
        conditions: Conditions,
    ) -> Self {
        let flights = Flights::of(program, profile, terrain, conditions);
        let variables = Variables::initial(program.flown());
        Self::new(program, profile, terrain.as_ref(), conditions, variables, flights)
    }

    fn new(
        program: &'a Program,
        profile: &'a Profile,
        terrain: &'a dyn Terrain,
        conditions: Conditions,
        variables: Variables,
        flights: Flights,
    ) -> Self {
        let zones = Zones::of(program, profile, conditions);
        let emergency_coverage = EmergencyCoverage::of(program, flights.legs());
        Self { program, profile, terrain, conditions, variables, flights, zones, emergency_coverage }
    }

    /// What every rule finds.
    fn problems(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        RULES.iter().for_each(|rule| rule(self, &mut problems));
        let causes = waypoints::near_pole_alone(wind::without_what_follows(self, problems));
        let mut found = once(causes, &self.program.warnings);
        mend_at_source(&self.program.plan, &mut found);
        found
    }
}

impl View<'_> {
    /// What the stage of a leg (or a stage itself) is for.
    fn stage_kind(&self, leg: &Id) -> Option<StageKind> {
        Some(self.program.stage(&self.program.path(leg)?)?.kind)
    }

    /// A leg that the aircraft flies by waypoints: take-off and landing are low, and the autopilot performs them.
    fn is_steered(&self, leg: &Id) -> bool {
        let performed = [StageKind::TakeOff, StageKind::Land];
        self.stage_kind(leg).is_some_and(|kind| !performed.contains(&kind))
    }

    /// A number of the plan at its start, with the variables' values where the flights begin, if it has a value there.
    fn number(&self, value: &Value<f64>) -> Option<f64> {
        let flight = FlightState::at_start(self.program.plan.home());
        self.program.eval_number(value, &Env { variables: &self.variables, flight }).ok()
    }

    /// What `home` altitudes count from on a leg of the main plan, metres AMSL.
    fn home_m(&self, leg: &Id) -> f64 {
        let path = self.program.path(leg).filter(|path| path.emergency_plan.is_none());
        let plan = &self.program.plan;
        let home = path.map_or_else(|| plan.home(), |path| plan.home_at(path.stage));
        home.map_or(0.0, |runway| runway.elevation_amsl_m)
    }

    /// A leg that loops: what is flown in its name is a turn.
    fn is_loop(&self, leg: &Id) -> bool {
        self.program.leg(leg).is_some_and(|leg| matches!(leg.kind, LegKind::Iterative { .. }))
    }

    /// Another altitude for a leg that the plan has as it is written (not only by a call): `by_m` above the one that leads to
    /// `wanted_amsl_m` now, counted from what that one counts from.
    fn relevelled(&self, leg: &Id, wanted_amsl_m: f64, by_m: f64) -> Option<Edit> {
        let (metres, reference) = self.counted(leg, wanted_amsl_m)?;
        Some(Edit::relevel(leg, metres, reference, by_m))
    }

    /// The same, higher by at least `by_m`, in tens of metres.
    fn raised(&self, leg: &Id, wanted_amsl_m: f64, by_m: f64) -> Option<Edit> {
        let (metres, reference) = self.counted(leg, wanted_amsl_m)?;
        Some(Edit::raise(leg, metres, reference, by_m))
    }

    /// The altitude of a leg as it is written, metres, and what that counts from.
    fn counted(&self, leg: &Id, wanted_amsl_m: f64) -> Option<(f64, AltitudeReference)> {
        match self.program.written(leg)?.altitude() {
            Some(written) => Some((self.number(&written.metres)?, written.reference)),
            None => Some((wanted_amsl_m, AltitudeReference::Amsl)),
        }
    }

    /// Points of the flights of the main plan, so many seconds apart.
    fn origins(&self, every_s: f64) -> impl Iterator<Item = Origin> + '_ {
        self.flights.main.iter().flat_map(move |flown| {
            let mut due_s = 0.0;
            flown.points.iter().filter_map(move |point| {
                if point.time_s < due_s {
                    return None;
                }
                due_s = point.time_s + every_s;
                Some(Origin {
                    leg: flown.leg(point)?.clone(),
                    position: point.position,
                    altitude_amsl_m: point.altitude_amsl_m,
                    course_deg: point.course_deg,
                    time_s: point.time_s,
                    used_j: point.used_j,
                })
            })
        })
    }

    /// Points of the plan as it stands and with other branches, with the energy used by then; where it ends in none of these ways,
    /// those of the bounded flights.
    fn origins_with_energy(&self) -> Vec<Origin> {
        const EVERY_S: f64 = 5.0;
        let full_j = self.profile.energy_j;
        let whole = self.flights.whole();
        let mut points: Vec<Origin> =
            whole.flat_map(|preview| flights::points(preview, full_j, EVERY_S)).collect();
        if points.is_empty() {
            points = self.origins(EVERY_S).collect();
        }
        points.retain(|point| self.is_steered(&point.leg));
        points
    }
}

/// Reads, checks, compiles and reviews a document: what a plan goes through before it is accepted anywhere.
///
/// # Errors
/// Every problem of the document, with its place, if one of them forbids flying. Warnings are in the program.
pub fn compile_and_review(
    document: &[u8],
    profile: &Profile,
    terrain: &Arc<dyn Terrain>,
    conditions: Conditions,
) -> Result<Arc<Program>, Vec<Problem>> {
    reviewed(document, profile, terrain, |program| review(program, profile, terrain, conditions))
}

/// Reads, checks and compiles a document, and reviews the program.
fn reviewed(
    document: &[u8],
    profile: &Profile,
    terrain: &Arc<dyn Terrain>,
    look: impl FnOnce(&Arc<Program>) -> Vec<Problem>,
) -> Result<Arc<Program>, Vec<Problem>> {
    let (program, places) =
        flight_plan::compile_reading(flight_plan::read(document), profile, terrain.as_ref())?;
    let mut program = Arc::new(program);
    let mut problems = look(&program);
    places.locate(&mut problems);
    if problems.iter().any(Problem::is_error) {
        problems.splice(0..0, program.warnings.iter().cloned());
        return Err(problems);
    }
    // nobody else has it yet
    if let Some(program) = Arc::get_mut(&mut program) {
        program.warnings.append(&mut problems);
    }
    Ok(program)
}

/// The first problem of each code and subject, without those that are known already.
fn once(problems: Vec<Problem>, known: &[Problem]) -> Vec<Problem> {
    let mut seen: HashSet<(&'static str, Option<Id>)> =
        known.iter().map(|p| (p.code, p.subject.clone())).collect();
    problems.into_iter().filter(|p| seen.insert((p.code, p.subject.clone()))).collect()
}
