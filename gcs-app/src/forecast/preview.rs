//! From a plan to its forecast, by flying it with the code that flies it aboard; from plan to plan only what has changed.

use super::{Alarm, Ending, Forecast, Outline, Passage, Point, Shared, left_out};
use aircraft::{Autopilot, Profile, Winds};
use flight_exec::rehearse::{Diversion, Kept, Options, Preview, PreviewError, Rehearsal, Start, WhatIf};
use flight_exec::review::Margins;
use flight_plan::{FlightPlan, Id, Program};
use geometry::LocalFrame;
use std::collections::BTreeMap;
use std::sync::Arc;
use terrain::Terrain;

/// Most points of a forecast: a longer flight is given in coarser steps.
const MAX_POINTS: f64 = 60_000.0;

/// Flies plan after plan ahead of time.
pub struct Forecaster {
    rehearsal: Rehearsal,
    profile: Profile,
    world: World,
    terrain: Arc<dyn Terrain>,
    /// What came out last.
    last: Shared,
    /// What came out before that the window may still show: it is dropped here, where no frame waits for that.
    former: Vec<Shared>,
}

/// What the flights of a rehearsal have in common besides the aircraft.
#[derive(Debug, Clone, PartialEq)]
struct World {
    winds: Winds,
    energy_share: f64,
    decisions: BTreeMap<Id, Id>,
    autopilot: Option<Autopilot>,
    isa_deviation_c: f64,
}

impl World {
    fn of(what_if: &WhatIf, plan: &FlightPlan) -> Self {
        Self {
            winds: what_if.winds(plan),
            energy_share: what_if.energy_share,
            decisions: what_if.decisions.clone(),
            autopilot: what_if.autopilot,
            isa_deviation_c: what_if.isa_deviation_c,
        }
    }
}

impl Forecaster {
    /// For an aircraft, over a ground.
    pub fn new(profile: Profile, terrain: Arc<dyn Terrain>) -> Self {
        let world = World::of(&WhatIf::default(), &FlightPlan::default());
        let rehearsal = Rehearsal::new(profile.clone(), terrain.clone(), world.winds, options());
        Self { rehearsal, profile, world, terrain, last: Shared::default(), former: Vec::new() }
    }

    /// What would become of the last flight after an alarm.
    pub fn divert(&self, alarm: Alarm) -> Option<Diversion> {
        self.rehearsal.divert(alarm.time_s, alarm.cause)
    }

    /// How the worst alarm would end at a time of the last flight.
    pub fn worst(&self, time_s: f64) -> Option<Ending> {
        let Margins { glide_m, energy_share, .. } = Margins::default();
        let (reach, cause) = self.rehearsal.worst(time_s, glide_m, energy_share)?;
        Some(Ending { reach, cause, stage: self.rehearsal.stage_at(time_s)? })
    }

    /// From now on in this world.
    fn enter(&mut self, what_if: &WhatIf, plan: &FlightPlan) {
        let world = World::of(what_if, plan);
        if self.world != world {
            let options = what_if.options(options());
            let rehearsal = Rehearsal::new(self.profile.clone(), self.terrain.clone(), world.winds, options);
            self.rehearsal = rehearsal.with(what_if.scenario());
            self.world = world;
        }
    }

    /// Flies a plan, which has the values of this world already. The sentence says why it can't be flown at all; one that ends too early is flown until then.
    pub fn fly(&mut self, program: &Arc<Program>, what_if: &WhatIf) -> Result<Shared, String> {
        let plan = &program.plan;
        self.enter(what_if, plan);
        if plan.stages.is_empty() {
            return Err("Nothing to be flown yet: add stages and legs to the plan.".into());
        }
        let start = Start::of(program, self.terrain.as_ref());
        let start = start.ok_or("Add a take-off stage: the preview does not know where to start.")?;
        let outcome = self.rehearsal.fly(program, start, &mut |_| true);
        let Some(preview) = self.rehearsal.preview() else {
            return Err(outcome.err().map_or_else(String::new, |why| why.to_string()));
        };
        let points = points(preview, &self.last.points, self.rehearsal.kept(), self.terrain.as_ref());
        let passages = passages(preview, &points, self.profile.energy_j);
        let forecast = Forecast {
            points,
            passages,
            left_out: left_out::of(preview, program.flown()),
            waypoints: preview.waypoints.iter().filter(|w| !w.replaced).map(|w| w.waypoint.clone()).collect(),
            battery_left: Some(preview.battery_left),
            stops: preview.stops.len(),
            cut_short: cut_short(preview, outcome),
            is_beginning: false,
            outline: Outline::default(),
        };
        forecast.prepare(&self.last);
        self.former.retain(|former| Arc::strong_count(former) > 1);
        self.former.push(std::mem::replace(&mut self.last, Arc::new(forecast)));
        Ok(self.last.clone())
    }
}

fn options() -> Options {
    let options = Options::default();
    let track_every_s = (options.most_s / MAX_POINTS).max(options.track_every_s);
    Options { track_every_s, ..options }
}

fn cut_short(preview: &Preview, outcome: Result<(), PreviewError>) -> Option<String> {
    match outcome {
        Err(why) => Some(why.to_string()),
        Ok(()) => (!preview.landed).then(|| "The flight does not end on the ground.".to_owned()),
    }
}

/// The points of a track; those that were in the former one have the same ground below them and the same distances between them.
fn points(preview: &Preview, former: &[Point], kept: Kept, terrain: &dyn Terrain) -> Vec<Point> {
    let track = &preview.track;
    let tail = track.len() - kept.tail.min(track.len() - kept.head);
    // the former track is longer or shorter by what was flown anew
    let of_former = |index: usize| match index {
        _ if index < kept.head => former.get(index),
        _ if index >= tail => former.get((index + former.len()).checked_sub(track.len())?),
        _ => None,
    };
    let mut points: Vec<Point> = Vec::with_capacity(track.len());
    let mut moved_m = None;
    for (index, at) in track.iter().enumerate() {
        let known = of_former(index);
        let way_m = || {
            points.last().map_or(0.0, |last| {
                last.distance_m + LocalFrame::new(last.position).to_local(at.position).length()
            })
        };
        let distance_m = match (known, index >= tail) {
            (Some(known), false) => known.distance_m,
            (Some(known), true) => {
                known.distance_m + *moved_m.get_or_insert_with(|| way_m() - known.distance_m)
            }
            (None, _) => way_m(),
        };
        points.push(Point {
            time_s: at.time_s,
            distance_m,
            position: at.position,
            altitude_amsl_m: at.altitude_amsl_m,
            ground_amsl_m: known
                .map_or_else(|| terrain.elevation_m(at.position), |known| known.ground_amsl_m),
            passage: at.passage.unwrap_or(0),
        });
    }
    points
}

fn passages(preview: &Preview, points: &[Point], energy_j: f64) -> Vec<Passage> {
    let at = |time_s: f64| preview.track.partition_point(|p| p.time_s < time_s);
    let left = energy_left(preview, energy_j);
    let passages = preview.legs.iter().zip(left).enumerate().map(|(i, (leg, energy_left))| {
        let (first, end) = (if i == 0 { 0 } else { at(leg.start_s) }, at(leg.end_s));
        Passage {
            leg: leg.place.leg.clone(),
            stage: leg.place.stage.clone(),
            passes: leg.place.iterations.iter().map(|place| place.iteration).collect(),
            reverse: leg.place.reverse,
            first,
            end,
            energy_left,
            clearance_m: clearance_m(points.get(first..end).unwrap_or_default()),
        }
    });
    passages.collect()
}

/// Share of the energy that is left behind each passage: counted back from each landing.
fn energy_left(preview: &Preview, energy_j: f64) -> Vec<f64> {
    let mut left = preview.battery_left;
    let mut behind: Vec<f64> = Vec::with_capacity(preview.legs.len());
    for (index, leg) in preview.legs.iter().enumerate().rev() {
        if let Some(stop) = preview.stops.iter().find(|stop| stop.legs == index + 1) {
            left = stop.battery_left;
        }
        behind.push(left);
        left += leg.energy_j / energy_j;
    }
    behind.reverse();
    behind
}

fn clearance_m(points: &[Point]) -> Option<f64> {
    let heights = points.iter().filter_map(|point| Some(point.altitude_amsl_m - point.ground_amsl_m?));
    heights.reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_plan::{Edit, compile};
    use terrain::Flat;

    /// A forecast that goes on from the one before is the one that begins anew, whatever was done in between.
    #[test]
    fn from_edit_to_edit_it_is_the_forecast_of_the_plan() {
        let (profile, terrain) = (Profile::default(), crate::assets::demo_terrain());
        let program =
            |plan: &FlightPlan| Arc::new(compile(plan.clone(), &profile, terrain.as_ref()).unwrap());
        let mut plan = flight_plan::read(include_bytes!("../../../assets/plans/fire-watch.xml")).plan;
        let mut forecaster = Forecaster::new(profile.clone(), terrain.clone());
        forecaster.fly(&program(&plan), &WhatIf::default()).unwrap();
        for (fix, degrees) in [("RIDGE2", 10.0), ("CLIMB", 200.0), ("RIDGE2", 300.0)] {
            let to = plan.fix(&fix.into()).unwrap().position.destination(degrees, 60.0);
            plan = Edit::MoveFix { fix: fix.into(), to }.apply(&plan).unwrap();
            let kept = forecaster.fly(&program(&plan), &WhatIf::default()).unwrap();
            let fresh = Forecaster::new(profile.clone(), terrain.clone())
                .fly(&program(&plan), &WhatIf::default())
                .unwrap();
            assert_eq!(kept.points.len(), fresh.points.len());
            for (a, b) in kept.points.iter().zip(&fresh.points) {
                // one is a sum over all of the way, the other over its parts
                assert!((a.distance_m - b.distance_m).abs() < 1e-6);
                assert_eq!(*a, Point { distance_m: a.distance_m, ..b.clone() });
            }
            for (a, b) in kept.passages.iter().zip(&fresh.passages) {
                assert!((a.energy_left - b.energy_left).abs() < 1e-9);
                assert_eq!(*a, Passage { energy_left: a.energy_left, ..b.clone() });
            }
            assert_eq!(kept.passages.len(), fresh.passages.len());
            assert_eq!(kept.waypoints, fresh.waypoints);
        }
    }

    #[test]
    fn energy_falls_from_leg_to_leg_to_what_is_left_at_the_end() {
        let terrain: Arc<dyn Terrain> = Arc::new(Flat(300.0));
        let plan = flight_plan::read(include_bytes!("../../../assets/plans/square.xml")).plan;
        let program = compile(plan, &Profile::default(), terrain.as_ref()).unwrap();
        let forecast =
            Forecaster::new(Profile::default(), terrain).fly(&Arc::new(program), &WhatIf::default()).unwrap();
        let left: Vec<f64> = forecast.passages.iter().map(|passage| passage.energy_left).collect();
        assert!(left.is_sorted_by(|a, b| a > b) && left[0] < 1.0, "{left:?}");
        let at_end = forecast.battery_left.unwrap();
        assert!((left.last().unwrap() - at_end).abs() < 1e-9, "{left:?}, {at_end}");
        let heights: Vec<f64> = forecast.passages.iter().filter_map(|passage| passage.clearance_m).collect();
        assert!(
            heights.len() == left.len() && heights[1..heights.len() - 1].iter().all(|h| *h > 10.0),
            "{heights:?}"
        );
    }

    #[test]
    fn a_flight_that_its_energy_does_not_allow_is_shown_as_far_as_it_goes() {
        let profile = Profile { energy_j: 5e4, ..Profile::default() };
        let plan = flight_plan::read(include_bytes!("../../../assets/plans/square.xml")).plan;
        let terrain: Arc<dyn Terrain> = Arc::new(Flat(300.0));
        let Ok(program) = compile(plan, &Profile::default(), terrain.as_ref()) else { return };
        let forecast = Forecaster::new(profile, terrain).fly(&Arc::new(program), &WhatIf::default()).unwrap();
        assert!(forecast.duration_s() > 60.0);
        assert!(forecast.cut_short.as_ref().unwrap().contains("energy"));
    }
}
