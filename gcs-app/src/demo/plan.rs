//! The plan of a demo, flown ahead of time with everything the mission logic will do.

use super::Args;
use super::flight::Ending;
use super::mission::{self, Step, When};
use super::recorded::Transition;
use crate::assets;
use crate::headless::wind::Air;
use crate::headless::{Loaded, Source, forecast, wind};
use crate::panels::ended::destination;
use crate::report::{Happening, Record, Track, assemble, authored, flights};
use aircraft::{Autopilot, Profile, Wind};
use anyhow::{Context, bail};
use flight_exec::Event;
use flight_exec::rehearse::Preview;
use flight_plan::{FlightPlan, Program, Runway};
use std::sync::Arc;
use terrain::Terrain;

/// Everything that is known before the flight.
pub struct Prepared {
    /// The plan.
    pub program: Arc<Program>,
    /// The aircraft.
    pub profile: Profile,
    /// The ground.
    pub terrain: Arc<dyn Terrain>,
    /// Where it starts.
    pub home: Runway,
    /// Where it lands.
    pub destination: Runway,
    /// What the mission logic will do.
    pub steps: Vec<Step>,
    /// The previewed track.
    pub planned: Track,
}

/// Reads, checks and previews the plan.
///
/// # Errors
/// It can't be read, has errors, can't be flown to its end, or the mission logic's steps don't fit it.
pub fn prepare(args: &Args) -> anyhow::Result<Prepared> {
    let loaded = load(args)?;
    let (program, profile) = loaded.compile().map_err(|problems| {
        let list: Vec<String> = problems.iter().map(ToString::to_string).collect();
        anyhow::anyhow!("the plan can't be flown:\n{}", list.join("\n"))
    })?;
    let home =
        program.plan.home().context("the plan has no take-off stage with a runway: give it one")?.clone();
    let destination =
        destination(&program.plan).context("the plan does not end with a land stage: give it one")?.clone();
    let steps = mission::steps_for(&program.plan);
    let (preview, last_plan) = preview(&loaded, &program, profile, air(args), &steps)?;
    let (last_plan, _) = flight_plan::instantiate(&last_plan);
    let planned = forecast::track(&preview, &[program.flown(), &last_plan]);
    let profile = profile.clone();
    Ok(Prepared { program, profile, terrain: loaded.terrain, home, destination, steps, planned })
}

fn load(args: &Args) -> anyhow::Result<Loaded> {
    match &args.plan {
        Some(file) => Source { file: file.clone(), ..Source::default() }.load(),
        None => Source::default().surround(assets::FIRE_WATCH.as_bytes()),
    }
}

/// The wind, and the habits of the autopilot that is simulated.
fn air(args: &Args) -> Air {
    let autopilot = match args.autopilot {
        sim::Personality::ArduPlane => Some(Autopilot::ArduPlane { wp_radius_m: None }),
        sim::Personality::Px4 | sim::Personality::Px4Vtol => Some(Autopilot::Px4),
    };
    Air { wind: args.wind, autopilot, ..Air::default() }
}

/// The plan after all updates of the steps.
fn updated(plan: &FlightPlan, steps: &[Step]) -> anyhow::Result<FlightPlan> {
    let mut plan = plan.clone();
    for act in steps.iter().flat_map(|s| &s.acts) {
        if let mission::Act::Update(edit) = act {
            plan = edit.apply(&plan)?;
        }
    }
    Ok(plan)
}

/// Questions so near in time are the same one, seconds.
const SAME_QUESTION_S: f64 = 5.0;

/// Previews the flight with the mission logic: again for each decision, as the time at which it is asked for
/// depends on what was done before.
fn preview(
    loaded: &Loaded,
    program: &Arc<Program>,
    profile: &Profile,
    air: Air,
    steps: &[Step],
) -> anyhow::Result<(Preview, FlightPlan)> {
    let compile = |plan: FlightPlan| {
        flight_plan::compile(plan, profile, loaded.terrain.as_ref())
            .map(Arc::new)
            .map_err(|problems| anyhow::anyhow!("the changed plan can't be flown: {problems:?}"))
    };
    let decisions = steps.iter().filter(|s| matches!(s.when, When::Asked { .. })).count();
    let mut asked_s: Vec<f64> = Vec::new();
    loop {
        let scenario = mission::scenario(steps, &program.plan, compile, &asked_s)?;
        let (terrain, scenario) = (&loaded.terrain, &scenario);
        let ahead = forecast::Ahead { program, profile, terrain, air, scenario };
        let preview = ahead.fly().context("the plan can't be flown to its end")?;
        let asked: Vec<f64> = preview
            .events
            .iter()
            .filter(|(_, e)| matches!(e, Event::DecisionRequested(_)))
            .map(|(t, _)| *t)
            .collect();
        if asked_s.len() < decisions {
            // what was decided in the moment it was asked for last time may not be asked for now
            let after_s = asked_s.last().map_or(f64::NEG_INFINITY, |last| last + SAME_QUESTION_S);
            let Some(next) = asked.iter().find(|at_s| **at_s > after_s) else {
                bail!(
                    "the mission logic waits for {decisions} decisions, the preview was asked for {}",
                    asked.len()
                )
            };
            asked_s.push(*next);
            continue;
        }
        if let Some((seconds, refusal)) = preview.refusals.first() {
            bail!("in the preview, the mission logic was refused after {seconds:.0} s: {refusal}");
        }
        if let Some(index) = preview.not_fired.first() {
            bail!("in the preview, the mission logic did not come to step {}", index + 1);
        }
        return Ok((preview, updated(&program.plan, steps)?));
    }
}

impl Prepared {
    /// The record of a flight, without a verdict yet. Times count from the start of the plan.
    pub fn record(&self, ending: &Ending, wind: &Wind) -> Record {
        let recorded = &ending.recorded;
        let flown_plans: Vec<_> =
            recorded.plans.iter().map(|(_, plan)| flight_plan::instantiate(plan).0).collect();
        let mut plans = vec![self.program.flown()];
        plans.extend(flown_plans.iter().map(|plan| plan.as_ref()));
        let points = recorded.points.get(..flights::until_rest(&recorded.points)).unwrap_or_default();
        let flown = assemble::track(points, &recorded.events, &plans);
        let turn_radius_m = self.profile.turn_radius_m(self.profile.cruise_airspeed_mps + wind.speed_mps());
        Record {
            title: self.program.plan.name.clone(),
            notes: vec![
                format!("{}, simulated", self.program.plan.aircraft),
                format!("wind {}", wind::shown(wind)),
                format!("plan {}", self.program.hash().get(..12).unwrap_or(self.program.hash())),
            ],
            planned: self.planned.clone(),
            authored: authored::paths(&self.program, &plans, &flown, &recorded.events, turn_radius_m),
            places: assemble::places(&self.program.plan),
            zones: self.program.plan.zones.clone(),
            areas: assemble::areas(&self.program, &flown, &recorded.events),
            routes: assemble::routes(&self.program, &flown),
            energy: flights::reported(&flown, &recorded.battery, self.profile.energy_j),
            flown,
            happenings: happenings(ending),
            verdict: Vec::new(),
            by_hand: ending.outcome.by_hand.clone(),
            terrain: self.terrain.clone(),
        }
    }
}

/// What the executor told, and where the gateway entered Safe mode.
fn happenings(ending: &Ending) -> Vec<Happening> {
    let plan = ending.recorded.events.iter().map(|(time_s, event)| assemble::happening(*time_s, event));
    let safe = ending.outcome.states.iter().filter(|state| state.is_safe_mode());
    let mut all: Vec<Happening> = plan.chain(safe.map(Transition::happening)).collect();
    all.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fire_watch_is_previewed_with_all_its_steps() {
        let args = Args {
            headless: true,
            report: "unused".into(),
            plan: None,
            wind: Wind::from_direction(270.0, 5.0),
            autopilot: sim::Personality::default(),
            speed: None,
            light: false,
            screenshot: None,
            after: 0.0,
        };
        let prepared = prepare(&args).unwrap();
        assert_eq!(prepared.steps.len(), 6);
        let legs: Vec<&str> = prepared.planned.passages().iter().map(|p| p.key.leg.as_str()).collect();
        for leg in ["d2", "sweep", "look", "regroup", "p2", "h2", "ap1"] {
            assert!(legs.contains(&leg), "{leg} is not in {legs:?}");
        }
        assert_eq!(
            legs.iter().filter(|l| **l == "sweep").count(),
            2,
            "the fire is out after the second round"
        );
        assert_eq!(prepared.destination.id.as_str(), "R05");
    }
}
