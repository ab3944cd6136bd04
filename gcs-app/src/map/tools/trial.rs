//! What is drawn is flown before it is put into the plan: its path, its length and time, and why it can't be flown.

use super::new_leg::{self, Aim};
use super::{Canvas, pen};
use crate::jobs::{Taken, Task};
use crate::map::polyline::{self, Style};
use crate::map::view::Mercator;
use crate::theme::Palette;
use crate::units::{self, Units};
use aircraft::Profile;
use egui::{Color32, Painter, Stroke};
use flight_exec::rehearse::{Options, Preview, Rehearsal, Start, WhatIf};
use flight_plan::create::{self, Approach, is_tried};
use flight_plan::{Altitude, AltitudeReference, FlightPlan, Leg, Program, Spot, Value, compile};
use geometry::LatLon;
use std::sync::Arc;
use terrain::Terrain;

/// Longest part of a leg that is tried out, seconds of flight.
const LONGEST_S: f64 = 300.0;
/// Most waypoints that are tried out.
const MOST_WAYPOINTS: usize = 2000;
/// Above the ground where the plan says nothing, metres.
const HEIGHT_M: f64 = 150.0;

/// Where the pointer is so near to where something begins, it has not left it yet, screen points.
const AT_REST: f32 = 4.0;

/// The pointer has not left a place: what would be drawn from there has no length, and nothing is to be said of it.
pub fn is_at_rest(from: LatLon, to: LatLon, canvas: &Canvas<'_>) -> bool {
    canvas.view.place(from).distance(canvas.view.place(to)) < AT_REST
}

/// A leg as it would be flown.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trial {
    /// The path, as far as it is known.
    pub line: Vec<LatLon>,
    /// Its length, metres, and how long it takes, seconds; `None`: it can't be flown, or is longer than can be tried out.
    pub cost: Option<(f64, f64)>,
    /// Why it can't be flown.
    pub fault: Option<String>,
    /// The aircraft's speed, m/s, for what is too long to be tried out.
    pace_mps: f64,
}

impl Trial {
    /// `1.2 km · 045° · 1:20`, or that it can't be flown.
    pub fn words(&self, from: LatLon, to: LatLon, units: Units) -> String {
        let way = pen::way(from, to, units);
        match (&self.fault, self.cost) {
            (Some(_), _) => format!("{way} · can't be flown"),
            (None, Some((_, time_s))) => format!("{way} · {}", units::duration(time_s)),
            (None, None) if self.pace_mps > 0.0 => {
                format!("{way} · about {}", units::duration(from.distance_m(to) / self.pace_mps))
            }
            (None, None) => way,
        }
    }

    /// `4.2 km · 3:20`.
    pub fn cost_words(&self, units: Units) -> Option<String> {
        let (length_m, time_s) = self.cost?;
        Some(format!("{} · {}", pen::length(length_m, units), units::duration(time_s)))
    }

    /// Draws the path.
    pub fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, p: &Palette) {
        self.paint_in(p.accent, painter, canvas, p);
    }

    /// Draws the path in this colour.
    pub fn paint_in(&self, colour: Color32, painter: &Painter, canvas: &Canvas<'_>, p: &Palette) {
        let line: Vec<Mercator> = self.line.iter().map(|at| (*at).into()).collect();
        let parts = polyline::visible_parts(&line, canvas.view);
        polyline::draw(painter, &parts, Stroke::new(2.0, colour), Style::Dashed, p.halo);
    }
}

/// What is tried out: in which version of the plan, in which world.
#[derive(Debug, Clone, PartialEq)]
struct Wanted {
    version: u64,
    what_if: WhatIf,
    leg: Leg,
    approach: Approach,
    /// It is begun there and then, from wherever the aircraft is; else the path leads there before.
    is_diversion: bool,
}

impl Wanted {
    /// The trial of this one is near enough to be shown until that of the other one is known.
    fn goes_on_as(&self, other: &Self) -> bool {
        (self.version, self.approach) == (other.version, other.approach) && self.what_if == other.what_if
    }
}

/// Legs are tried out one after the other, each on a thread of its own: no frame waits for one.
#[derive(Debug, Default)]
pub struct Trials {
    wanted: Option<Wanted>,
    flying: Option<(Wanted, Task<Trial>)>,
    /// The last one that was tried out.
    tried: Option<(Wanted, Trial)>,
}

impl Trials {
    /// A leg that would be put there; flown anew only when it is another.
    pub fn fly(&mut self, leg: Option<Leg>, aim: &Aim, approach: Option<Approach>, canvas: &Canvas<'_>) {
        self.try_out(leg.zip(approach), false, aim, canvas);
    }

    /// A leg that the aircraft turns to there and then, on the way along the leg that it is aimed behind.
    pub fn divert(&mut self, leg: Option<Leg>, aim: &Aim, from: Approach, canvas: &Canvas<'_>) {
        self.try_out(leg.zip(Some(from)), true, aim, canvas);
    }

    fn try_out(&mut self, leg: Option<(Leg, Approach)>, is_diversion: bool, aim: &Aim, canvas: &Canvas<'_>) {
        self.take();
        let scene = canvas.scene;
        self.wanted = leg.map(|(leg, approach)| Wanted {
            version: scene.document.version(),
            what_if: scene.view.what_if.clone(),
            leg,
            approach,
            is_diversion,
        });
        let Some(wanted) = self.wanted.clone().filter(|_| self.flying.is_none()) else { return };
        if self.tried.as_ref().is_some_and(|(tried, _)| *tried == wanted) {
            return;
        }
        let (plan, ground) = (scene.document.plan().clone(), scene.layers.elevations().clone());
        let (aim, asked) = (aim.clone(), wanted.clone());
        let task = Task::begin(scene.layers.wake(), move || fly(&asked, &aim, &plan, &ground));
        self.flying = Some((wanted, task));
    }

    fn take(&mut self) {
        let Some((wanted, task)) = self.flying.take() else { return };
        match task.take() {
            Taken::NotYet => self.flying = Some((wanted, task)),
            Taken::Done(trial) => self.tried = Some((wanted, trial)),
            Taken::Failed => self.tried = Some((wanted, Trial::default())),
        }
    }

    /// What came out; `None`: nothing was tried out, or not yet.
    pub fn get(&self) -> Option<&Trial> {
        let (tried, trial) = self.tried.as_ref()?;
        self.wanted.as_ref().filter(|wanted| tried.goes_on_as(wanted)).map(|_| trial)
    }

    /// Something is being tried out.
    pub fn is_flying(&self) -> bool {
        self.flying.is_some()
    }

    /// Forgets it.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

fn fly(wanted: &Wanted, aim: &Aim, plan: &FlightPlan, ground: &Arc<dyn Terrain>) -> Trial {
    let Wanted { what_if, leg, approach, .. } = wanted;
    let profile = Profile::by_name(&plan.aircraft).unwrap_or_default();
    let ground_amsl_m = ground.elevation_m(approach.from);
    let home_amsl_m = home_amsl_m(plan, aim);
    let level_amsl_m = level_amsl_m(new_leg::level(plan, aim), home_amsl_m, ground_amsl_m.unwrap_or(0.0));
    let mut tried = create::trial(plan, *approach, (level_amsl_m, home_amsl_m), leg);
    if wanted.is_diversion {
        tried.stages.iter_mut().for_each(|stage| stage.legs.retain(|other| other.id == leg.id));
    }
    let program = match compile(tried.clone(), &profile, ground.as_ref()) {
        Ok(program) => Arc::new(program),
        Err(problems) => {
            let fault = problems.iter().find(|problem| problem.is_error());
            let fault = fault.map(|problem| tried.in_names(&problem.message));
            return Trial { fault, ..Trial::default() };
        }
    };
    let pace_mps = profile.cruise_airspeed_mps;
    // as the preview of the whole plan
    let rehearsal = Rehearsal::new(profile, ground.clone(), what_if.winds(plan), options());
    Trial { pace_mps, ..flown(wanted, level_amsl_m, &program, rehearsal) }
}

fn options() -> Options {
    let most_s = LONGEST_S;
    Options { most_s, most_waypoints: MOST_WAYPOINTS, step_s: 0.2, ..Options::default() }
}

fn flown(wanted: &Wanted, altitude_amsl_m: f64, program: &Arc<Program>, mut rehearsal: Rehearsal) -> Trial {
    let Wanted { leg, approach, is_diversion, .. } = wanted;
    let heading_deg = approach.course_deg.unwrap_or(0.0);
    let run_up_m = if *is_diversion { 0.0 } else { create::RUN_UP_M };
    let position = approach.from.destination(heading_deg + 180.0, run_up_m);
    let start = Start::InFlight { position, altitude_amsl_m, heading_deg };
    // it ends in the air; a path that is cut short is drawn as far as it goes
    let outcome = rehearsal.fly(program, start, &mut |_| true);
    match rehearsal.preview() {
        Some(preview) => part_of(leg, preview),
        None => Trial { fault: outcome.err().map(|why| why.to_string()), ..Trial::default() },
    }
}

/// The part of a flight that is the leg's.
fn part_of(leg: &Leg, preview: &Preview) -> Trial {
    let is_its = |passage: Option<usize>| {
        passage.and_then(|i| preview.legs.get(i)).is_some_and(|passage| is_tried(&passage.place.leg, &leg.id))
    };
    let line =
        preview.track.iter().filter(|point| is_its(point.passage)).map(|point| point.position).collect();
    let its = || preview.legs.iter().filter(|passage| is_tried(&passage.place.leg, &leg.id));
    let length_m: f64 = its().map(|passage| passage.distance_m).sum();
    let time_s: f64 = its().map(|passage| passage.end_s - passage.start_s).sum();
    let is_whole = preview.time_s < LONGEST_S && time_s > 0.0;
    Trial { line, cost: is_whole.then_some((length_m, time_s)), ..Trial::default() }
}

/// What `home` altitudes count from at a place of the plan, metres AMSL.
fn home_amsl_m(plan: &FlightPlan, aim: &Aim) -> f64 {
    let (Aim::Spot(Spot::Before(id) | Spot::After(id) | Spot::EndOf(id)) | Aim::Way { from: id, .. }) = aim;
    let of_leg = plan.leg(id).map(|context| &context.stage.id);
    let stage = plan.stages.iter().position(|stage| stage.id == *of_leg.unwrap_or(id));
    let home = stage.map_or_else(|| plan.home(), |stage| plan.home_at(stage));
    home.map_or(0.0, |runway| runway.elevation_amsl_m)
}

/// An altitude in force, as far as it is a number.
fn level_amsl_m(level: Option<&Altitude>, home_amsl_m: f64, ground_amsl_m: f64) -> f64 {
    match level {
        Some(Altitude { metres: Value::Constant(metres), reference }) => match reference {
            AltitudeReference::Amsl => *metres,
            AltitudeReference::Agl => ground_amsl_m + metres,
            AltitudeReference::Home => home_amsl_m + metres,
        },
        _ => ground_amsl_m + HEIGHT_M,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn home_is_that_of_the_flight_in_which_the_leg_is_drawn() {
        let runway = |id: &str, elevation: u32| {
            format!(
                r#"<runway id="{id}" lat="36.2" lon="-84.1" elevation="{elevation}" heading="90" length="500"/>"#
            )
        };
        let flight = |number: u32| {
            format!(
                r#"<stage id="up{number}" type="take-off" runway="R{number}" altitude="90" altitudeReference="home"/>
                <stage id="out{number}" type="mission" altitude="200" altitudeReference="home"><TF id="a{number}" lat="36.3" lon="-84.1"/></stage>
                <stage id="down{number}" type="land" runway="R{number}"/>"#
            )
        };
        let document = format!(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="x" aircraft="trainer"><runways>{}{}</runways><mainPlan>{}{}</mainPlan></flightPlan>"#,
            runway("R1", 100),
            runway("R2", 700),
            flight(1),
            flight(2)
        );
        let plan = flight_plan::read(&document).plan;
        let home_m = |spot| home_amsl_m(&plan, &Aim::Spot(spot));
        let homes = [
            Spot::After("a1".into()),
            Spot::EndOf("out1".into()),
            Spot::Before("a2".into()),
            Spot::EndOf("out2".into()),
            Spot::After("elsewhere".into()),
        ];
        assert_eq!(homes.map(home_m), [100.0, 100.0, 700.0, 700.0, 100.0]);
        let way = Aim::Way { from: "a2".into(), way: create::Way::New };
        assert_eq!(home_amsl_m(&plan, &way), 700.0);
    }
}
