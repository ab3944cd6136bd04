//! Bringing a flight within the glide of a runway: another runway of the plan, where one is near enough, else more height.
//!
//! What else changes with that can't be said beforehand: a climb gets too steep, another leg is out of reach then. So each candidate is
//! tried: it is offered only if the plan with it, reviewed like any other, has neither this problem nor a new one.

use super::glide::{Tried, on_planned_flight, start};
use super::{Conditions, View};
use crate::rehearse::{Glide, Reach};
use aircraft::Profile;
use flight_plan::create::{self, WayHome};
use flight_plan::{Altitude, Cause, Edit, FlightPlan, Id, Problem, Program, Runway, Value, compile};
use std::collections::BTreeMap;
use std::sync::Arc;
use terrain::Terrain;

/// So much higher than what is lacking it is tried, one after the other, metres: what climbs more is elsewhere meanwhile.
const MORE_M: [f64; 3] = [0.0, 20.0, 50.0];
/// Most plans that are tried for a review.
const MAX_TRIALS: usize = 8;

/// The problems of glides, with the edit that brings the flight within the glide where there is one that leaves nothing of the kind;
/// `found`: what the review said. To be put in their place by [`put_remedies`](super::put_remedies).
///
/// `go_on` is asked before each trial, which takes as long as a review; false ends the work.
pub fn bring_within_glide(
    program: &Arc<Program>,
    profile: &Profile,
    terrain: &Arc<dyn Terrain>,
    conditions: Conditions,
    found: &[Problem],
    go_on: &mut dyn FnMut() -> bool,
) -> Vec<Problem> {
    let is_meant = |problem: &&Problem| problem.code.starts_with("glide-") && problem.fix.is_none();
    let mut problems = found.iter().filter(is_meant).peekable();
    if problems.peek().is_none() || !go_on() {
        return Vec::new();
    }
    let view = View::of(program, profile, terrain, conditions);
    let glides = on_planned_flight(&view);
    let mut left = MAX_TRIALS;
    let remedied = problems.filter_map(|problem| {
        let plan = problem.subject.as_ref()?;
        let short: Vec<&Tried> =
            glides.iter().filter(|glide| glide.reach < Reach::Good && *glide.plan == *plan).collect();
        let scopes = [stage_of, leg_of].into_iter();
        let elsewhere = scopes.filter_map(|scope| elsewhere(&view, &short, &glides, scope));
        let candidates = elsewhere.chain(higher(&view, &short));
        let mut tried = candidates.filter(|remedy| {
            left = if go_on() { left.saturating_sub(1) } else { 0 };
            left > 0 && removes(&view, problem, &remedy.edit, found, terrain)
        });
        let Remedy { told, edit } = tried.next()?;
        let message = format!("{}. The fix {told}", problem.message);
        Some(Problem { message, ..problem.clone().fixed_by(edit) })
    });
    remedied.collect()
}

/// What may help.
struct Remedy {
    /// What it does: `flies `survey` higher`.
    told: String,
    edit: Edit,
}

/// With the edit, the problem is gone and there is no new one.
fn removes(
    view: &View,
    problem: &Problem,
    edit: &Edit,
    found: &[Problem],
    terrain: &Arc<dyn Terrain>,
) -> bool {
    let Some(program) = edited(view, edit, terrain) else { return false };
    let then = View::of(&program, view.profile, terrain, view.conditions).problems();
    let same = |one: &Problem, other: &Problem| (one.code, &one.subject) == (other.code, &other.subject);
    let is_known = |after: &Problem| {
        found.iter().chain(&view.program.warnings).any(|before| same(before, after)) && !same(problem, after)
    };
    program.warnings.iter().chain(&then).all(is_known)
}

fn edited(view: &View, edit: &Edit, terrain: &Arc<dyn Terrain>) -> Option<Arc<Program>> {
    let plan = edit.apply(&view.program.plan).ok()?;
    compile(plan, view.profile, terrain.as_ref()).ok().map(Arc::new)
}

/// Who may name a plan for what is flown there: its stage, or its leg.
type Scope = for<'a> fn(&'a View, &'a Id) -> Option<&'a Id>;

fn stage_of<'a>(view: &'a View, leg: &'a Id) -> Option<&'a Id> {
    Some(&view.program.stage(&view.program.path(leg)?)?.id)
}

fn leg_of<'a>(view: &'a View, leg: &'a Id) -> Option<&'a Id> {
    view.program.written(leg).map(|_| leg)
}

/// Another runway that a straight glide reaches from all of the stages, or legs, where this one is not reached: a way home to it becomes
/// theirs for the cause `engine`.
fn elsewhere(view: &View, short: &[&Tried], all: &[Tried], scope: Scope) -> Option<Remedy> {
    let mut namers: Vec<&Id> = short.iter().filter_map(|glide| scope(view, &glide.from.leg)).collect();
    namers.dedup();
    let is_there = |glide: &&Tried| scope(view, &glide.from.leg).is_some_and(|id| namers.contains(&id));
    let there: Vec<&Tried> = all.iter().filter(is_there).collect();
    let plan = &view.program.plan;
    let runway = plan.runways.iter().find(|runway| there.iter().all(|glide| reaches(view, glide, runway)))?;
    let (id, made) = way_home(view, plan, runway, short)?;
    let named = namers.iter().map(|namer| Edit::SetEmergency {
        of: Some((*namer).clone()),
        cause: Some(Cause::Engine),
        plan: Some(id.clone()),
    });
    let edit = Edit::All(made.into_iter().chain(named).collect());
    let namers: Vec<String> = namers.iter().map(|namer| format!("`{namer}`")).collect();
    let told = format!(
        "names a plan to `{}` for the cause `engine` on {}: that runway is reached from there",
        runway.id,
        namers.join(", ")
    );
    Some(Remedy { told, edit })
}

fn reaches(view: &View, glide: &Tried, runway: &Runway) -> bool {
    let air = (view.profile, view.conditions.wind.into(), view.terrain);
    let glides = Glide::straight(view.program, air, start(&glide.from), (runway, true));
    glides.iter().any(|glide| glide.reach(view.conditions.margins.glide_m) == Reach::Good)
}

/// The emergency plan that lands there, and the edit that makes it if there is none.
fn way_home(view: &View, plan: &FlightPlan, runway: &Runway, short: &[&Tried]) -> Option<(Id, Option<Edit>)> {
    if let Some(known) = plan.emergency_plans.iter().find(|known| known.runway == runway.id) {
        return Some((known.id.clone(), None));
    }
    let lowest = short.iter().min_by(|a, b| a.from.altitude_amsl_m.total_cmp(&b.from.altitude_amsl_m))?;
    let from = Some((lowest.from.position, lowest.from.altitude_amsl_m));
    let way = WayHome { runway, outwards: &[], from };
    let (id, edit) = create::emergency_plan(plan, way, view.profile, view.terrain);
    Some((id, Some(edit)))
}

/// Whatever says the altitudes of these legs says so much more as the worst glide lacks, or a little more; then what is flown before them,
/// too: what they are still climbing from.
fn higher<'a>(view: &'a View, short: &'a [&Tried]) -> impl Iterator<Item = Remedy> + 'a {
    let with_before = [false, true].into_iter();
    with_before.flat_map(move |with_before| {
        MORE_M.into_iter().filter_map(move |more_m| raised(view, short, with_before, more_m))
    })
}

fn raised(view: &View, short: &[&Tried], with_before: bool, more_m: f64) -> Option<Remedy> {
    let mut raised: BTreeMap<&Id, (&Altitude, f64)> = BTreeMap::new();
    for glide in short {
        let by_m = Some(glide.missing_m(view)).filter(|metres| metres.is_finite())? + more_m;
        let before = view.flights.planned.as_ref().ok().filter(|_| with_before).and_then(|flown| {
            let first = flown.legs.iter().position(|passage| passage.place.leg == glide.from.leg)?;
            Some(&flown.legs.get(first.checked_sub(1)?)?.place.leg)
        });
        for leg in before.into_iter().chain([&glide.from.leg]) {
            let (owner, altitude) = owner(view, leg)?;
            let known = raised.entry(owner).or_insert((altitude, by_m));
            known.1 = known.1.max(by_m);
        }
    }
    let edits = raised.iter().map(|(owner, (altitude, by_m))| {
        let Value::Constant(metres) = altitude.metres else { return None };
        Some(Edit::raise(owner, metres, altitude.reference, *by_m))
    });
    let edits: Vec<Edit> = edits.collect::<Option<_>>()?;
    let owners: Vec<String> = raised.keys().map(|owner| format!("`{owner}`")).collect();
    (!edits.is_empty())
        .then(|| Remedy { told: format!("flies {} higher", owners.join(", ")), edit: Edit::All(edits) })
}

/// What says the altitude of a leg: itself, a loop or the stage around it.
fn owner<'a>(view: &'a View, leg: &Id) -> Option<(&'a Id, &'a Altitude)> {
    let context = view.program.written(leg)?;
    let own = [(&context.leg.id, &context.leg.altitude)].into_iter();
    let loops = context.loops.iter().rev().map(|leg| (&leg.id, &leg.altitude));
    let mut all = own.chain(loops).chain([(&context.stage.id, &context.stage.altitude)]);
    all.find_map(|(id, altitude)| Some((id, altitude.as_ref()?)))
}
