//! "What happens here": what would become of a flight if an alarm were raised at some point of it.
//!
//! The flight is resumed at the nearest place before that point that was kept, and the alarm is given to the executor as it is given
//! aboard. Where the engine fails the plan is also flown without it, and judged by where that ends; where it might, the glide is worked
//! out beside it.

use super::super::engine_out::{AT_RUNWAY_M, Air, Glide, Reach};
use super::super::flight::{Circumstances, Flight};
use super::super::scenario::{Act, Trigger, When};
use super::super::situation::Situation;
use super::super::{LegPassage, Preview, PreviewError, TrackPoint, names_engine};
use super::{Flown, Rehearsal};
use crate::api::{Branching, Command};
use crate::layout::homeward::end_of;
use crate::layout::path::distance_and_course;
use aircraft::glide::{GlidePoint, GlideStart};
use aircraft::{Profile, Winds};
use flight_plan::{Cause, EmergencyPlan, FlightPlan, Id, Program, Runway, StageKind, Variables};
use geometry::LatLon;
use terrain::Terrain;

/// An engine that has failed is noticed aboard so much later, seconds: it is told once a second, and has stood for a second then.
const NOTICED_S: f64 = 2.0;

/// What would happen after an alarm.
#[derive(Debug, Clone, PartialEq)]
pub struct Diversion {
    /// When it is raised, seconds since the start.
    pub time_s: f64,
    /// Why.
    pub cause: Cause,
    /// The leg on which it is raised.
    pub leg: Id,
    /// The emergency plan that answers, and its runway; `None`: there is none, the gateway's Safe mode decides.
    pub plan: Option<(Id, Id)>,
    /// The plan as it would be flown with an engine; or why it would not be.
    pub powered: Result<Powered, String>,
    /// The glide to its runway.
    pub glide: Option<Glide>,
    /// After an engine failure: the plan as it is flown without the engine.
    pub glided: Option<Glided>,
    /// Then: height above the threshold with which a straight glide arrives at an end of its runway, metres, at the end where that is more;
    /// what is lacking, if it is negative.
    pub straight_m: Option<f64>,
}

/// An emergency plan, flown with an engine.
#[derive(Debug, Clone, PartialEq)]
pub struct Powered {
    /// From the alarm on; times are seconds since the start of the flight.
    pub track: Vec<TrackPoint>,
    /// From the alarm to the end, seconds.
    pub time_s: f64,
    /// Share of the energy left at the end, 0..1.
    pub battery_left: f64,
    /// It ends on the ground.
    pub landed: bool,
    /// Why it ends early.
    pub cut_short: Option<PreviewError>,
}

/// An emergency plan, flown with the engine out.
#[derive(Debug, Clone, PartialEq)]
pub struct Glided {
    /// From the failure to the ground; times are seconds since the start of the flight.
    pub track: Vec<TrackPoint>,
    /// From the failure to the ground, seconds.
    pub time_s: f64,
    /// From where it comes down to the runway, metres; 0: it is on the runway.
    pub missed_m: f64,
}

/// A point of a flight at which an alarm is raised.
struct Here<'a> {
    rehearsal: &'a Rehearsal,
    flown: &'a Flown,
    time_s: f64,
    start: GlideStart,
    leg: Id,
}

/// What answers an alarm: an emergency plan with its runway.
type Answer<'a> = (&'a EmergencyPlan, &'a Runway);

impl Rehearsal {
    /// What would become of the last flight if an alarm were raised so many seconds after its start; `None`: nothing was flown.
    ///
    /// Only what follows the nearest place before that was kept is flown again.
    pub fn divert(&self, time_s: f64, cause: Cause) -> Option<Diversion> {
        Here::of(self, time_s)?.diversion(cause)
    }

    /// What the stage is for that the last flight is in so many seconds after its start.
    pub fn stage_at(&self, time_s: f64) -> Option<StageKind> {
        let Here { flown, leg, .. } = Here::of(self, time_s)?;
        Some(flown.program.stage(&flown.program.path(&leg)?)?.kind)
    }

    /// How the worst alarm would end so many seconds after the start, and which that is; `None`: nothing was flown, or the aircraft
    /// is taking off or landing then. The reserves are those of [`Diversion::reach`].
    pub fn worst(&self, time_s: f64, glide_m: f64, energy_share: f64) -> Option<(Reach, Cause)> {
        let here = Here::of(self, time_s)?;
        if matches!(self.stage_at(time_s)?, StageKind::TakeOff | StageKind::Land) {
            return None;
        }
        let mut worst = (here.diversion(Cause::Engine)?.reach(glide_m, energy_share), Cause::Engine);
        let mut tried: Vec<Option<&Id>> = Vec::new();
        for cause in POWERED {
            // with its engine, the aircraft flies a plan alike for whatever cause
            let plan = here.answer(cause).map(|(plan, _)| &plan.id);
            if tried.contains(&plan) {
                continue;
            }
            tried.push(plan);
            let reach = here.diversion(cause)?.reach(glide_m, energy_share);
            if reach < worst.0 {
                worst = (reach, cause);
            }
        }
        Some(worst)
    }
}

/// The alarms after which the engine runs, the most severe first.
const POWERED: [Cause; 4] = [Cause::Energy, Cause::Gps, Cause::Link, Cause::Operator];

impl<'a> Here<'a> {
    fn of(rehearsal: &'a Rehearsal, time_s: f64) -> Option<Self> {
        let flown = rehearsal.flown.as_ref()?;
        let (start, leg) = origin(&flown.preview, time_s)?;
        Some(Self { rehearsal, flown, time_s, start, leg })
    }

    fn answer(&self, cause: Cause) -> Option<Answer<'a>> {
        let program = &self.flown.program;
        answer(program, program.emergency_choice(&self.leg, cause)?.plan_for(cause)?)
    }

    fn diversion(&self, cause: Cause) -> Option<Diversion> {
        let answer = self.answer(cause);
        let powered = match answer {
            Some(_) => self.powered(cause)?,
            None => Err("no emergency plan answers here: the gateway's Safe mode decides".into()),
        };
        let glide = answer.filter(|_| powered.is_ok()).map(|answer| self.glide(answer));
        let fails = answer.filter(|_| cause == Cause::Engine && powered.is_ok());
        let glided = fails.and_then(|(_, runway)| self.glided(runway));
        let straight_m = fails.and_then(|(_, runway)| self.straight_m(runway));
        let plan = answer.map(|(plan, runway)| (plan.id.clone(), runway.id.clone()));
        let (time_s, leg) = (self.time_s, self.leg.clone());
        Some(Diversion { time_s, cause, leg, plan, powered, glide, glided, straight_m })
    }

    /// As it is flown with an engine, or why it is not.
    fn powered(&self, cause: Cause) -> Option<Result<Powered, String>> {
        self.flown_on([self.alarm(self.time_s, cause)], |flight| powered(flight, self.time_s))
    }

    /// As it is flown after the engine failed; until that is noticed, on along its way.
    fn glided(&self, runway: &Runway) -> Option<Glided> {
        let fails = Trigger { at: When::After { seconds: self.time_s }, then: vec![Act::FailEngine] };
        let alarm = self.alarm(self.time_s + NOTICED_S, Cause::Engine);
        let terrain = self.rehearsal.terrain.as_ref();
        let runway = (runway, self.flown.program.flown());
        self.flown_on([fails, alarm], |flight| glided(flight, self.time_s, runway, terrain))?
    }

    fn alarm(&self, seconds: f64, cause: Cause) -> Trigger {
        let alarm = Act::Command(Command::Emergency { cause, plan: None });
        Trigger { at: When::After { seconds }, then: vec![alarm] }
    }

    /// What becomes of the flight if this is done from here on.
    fn flown_on<T>(
        &self,
        triggers: impl IntoIterator<Item = Trigger>,
        judge: impl FnOnce(Flight) -> T,
    ) -> Option<T> {
        let mut scenario = self.rehearsal.scenario.clone();
        scenario.triggers.extend(triggers);
        let (winds, options) = (self.rehearsal.winds, &self.rehearsal.options);
        let given = Circumstances { winds, scenario: &scenario, options };
        Some(judge(self.flown.resumed_before(self.time_s, given)?))
    }

    /// Over the ground, to the end at which there is more to spare.
    fn straight_m(&self, named: &Runway) -> Option<f64> {
        let glides = Glide::straight(&self.flown.program, self.air(), self.start, (named, true));
        glides.iter().filter_map(Glide::arrives_m).reduce(f64::max)
    }

    fn glide(&self, (plan, runway): Answer) -> Glide {
        let program = &self.flown.program;
        let way = (plan, runway, names_engine(program, &self.leg));
        Glide::home(program, self.air(), &Variables::initial(program.flown()), self.start, way)
    }

    fn air(&self) -> Air<'_> {
        let Rehearsal { profile, winds, terrain, .. } = self.rehearsal;
        (profile, *winds, terrain.as_ref())
    }
}

/// The glide from where a flight begins an emergency plan (for the first time), along that plan, or straight to its runway if it is not
/// named for an engine failure there; and the runway. `None`: it begins none.
pub fn glide_instead(
    program: &Program,
    profile: &Profile,
    terrain: &dyn Terrain,
    winds: impl Into<Winds>,
    flown: &Preview,
) -> Option<(Id, Glide)> {
    let of_emergency = |passage: &&LegPassage| matches!(passage.place.plan, Branching::Emergency(_));
    let begun = flown.legs.iter().find(of_emergency)?;
    let Branching::Emergency(plan) = &begun.place.plan else { return None };
    let (plan, runway) = answer(program, plan)?;
    let (start, leg) = origin(flown, begun.start_s - JUST_BEFORE_S)?;
    let choice =
        program.emergency_choice(&leg, Cause::Engine).and_then(|choice| choice.plan_for(Cause::Engine));
    let named = names_engine(program, &leg) && choice == Some(&plan.id);
    let (air, variables) = ((profile, winds.into(), terrain), Variables::initial(program.flown()));
    let glide = Glide::home(program, air, &variables, start, (plan, runway, named));
    Some((runway.id.clone(), glide))
}

/// A point of the track that is not on the emergency plan yet.
const JUST_BEFORE_S: f64 = 1.0;

fn answer<'p>(program: &'p Program, plan: &Id) -> Option<Answer<'p>> {
    let plan = program.flown().emergency_plans.iter().find(|other| other.id == *plan)?;
    Some((plan, program.plan.runway(&plan.runway)?))
}

impl Flown {
    /// The flight at the last place kept that is not later than this. What is yet to be done are the scenario's last triggers.
    fn resumed_before<'a>(&self, time_s: f64, given: Circumstances<'a>) -> Option<Flight<'a>> {
        let is_behind = |begin: &Situation| begin.time_s() > time_s;
        let first = self.stretches.partition_point(|s| !s.begin.as_deref().is_some_and(is_behind));
        let begin = first.checked_sub(1).and_then(|index| self.stretches.get(index)?.begin.as_ref());
        let Some(begin) = begin else {
            let executor = &self.end.executor;
            let (profile, terrain) = (executor.profile(), executor.terrain());
            return Flight::new(&self.program, profile, terrain, self.start, given, false).ok();
        };
        let mut at = begin.as_ref().clone();
        at.executor.swap_program(self.program.clone());
        at.executor.watch(false);
        at.fired.resize(given.scenario.triggers.len(), false);
        Some(Flight::resumed(given, at))
    }
}

impl Diversion {
    /// How it ends: after an engine failure the glide, else the flight with an engine. The reserves: height of a glide above the
    /// threshold, metres, and share of the energy when landed.
    pub fn reach(&self, glide_m: f64, energy_share: f64) -> Reach {
        if self.cause == Cause::Engine {
            let along = self.glide.as_ref().map_or(Reach::Out, |glide| glide.reach(glide_m));
            let straight = self.straight_m.map_or(Reach::Out, |metres| Reach::by_height(metres, glide_m));
            return reach_glided(along.max(straight), self.glided.as_ref());
        }
        reach_powered(&self.powered, energy_share)
    }

    /// The way that is flown, and beside it the one with the engine after its failure, or the glide where it runs. Seconds since the alarm.
    pub fn ways(&self) -> [Vec<GlidePoint>; 2] {
        let powered = self.powered.as_ref().map_or(&[][..], |flown| &flown.track);
        let glide = self.glide.as_ref().map_or(&[][..], |glide| &glide.path);
        match &self.glided {
            Some(glided) => [self.since_alarm(&glided.track), self.since_alarm(powered)],
            None => [self.since_alarm(powered), glide.to_vec()],
        }
    }

    fn since_alarm(&self, track: &[TrackPoint]) -> Vec<GlidePoint> {
        let point = |at: &TrackPoint| GlidePoint {
            time_s: at.time_s - self.time_s,
            position: at.position,
            altitude_amsl_m: at.altitude_amsl_m,
        };
        track.iter().map(point).collect()
    }
}

/// What counts is where it comes down; how much there was to spare is calculated. Where not all of the plan can be glided along, a part is
/// left out in flight: to spare is what a straight glide would have.
fn reach_glided(calculated: Reach, glided: Option<&Glided>) -> Reach {
    match glided {
        Some(glided) if glided.missed_m <= 0.0 => calculated.max(Reach::Tight),
        _ => Reach::Out,
    }
}

fn reach_powered(powered: &Result<Powered, String>, energy_share: f64) -> Reach {
    match powered {
        Ok(flown) if flown.landed && flown.battery_left >= energy_share => Reach::Good,
        Ok(flown) if flown.landed => Reach::Tight,
        _ => Reach::Out,
    }
}

/// Where the flight is at a time, and on which leg.
fn origin(preview: &Preview, time_s: f64) -> Option<(GlideStart, Id)> {
    let track = &preview.track;
    let index = track.partition_point(|point| point.time_s < time_s).min(track.len().checked_sub(1)?);
    let at = track.get(index)?;
    let leg = preview.legs.get(at.passage?)?.place.leg.clone();
    let before = track.get(index.saturating_sub(1)).filter(|before| before.position != at.position);
    let (from, to) = match before {
        Some(before) => (before.position, at.position),
        None => (at.position, track.get(index + 1).map_or(at.position, |next| next.position)),
    };
    let course_deg = distance_and_course(from, to).1;
    Some((GlideStart { position: at.position, altitude_amsl_m: at.altitude_amsl_m, course_deg }, leg))
}

fn powered(flight: Flight, since_s: f64) -> Result<Powered, String> {
    let (flown, cut_short) = flight.flown_as_far_as_possible();
    if let Some((_, refusal)) = flown.refusals.last() {
        return Err(refusal.reason.clone());
    }
    let first = flown.track.partition_point(|point| point.time_s < since_s);
    Ok(Powered {
        track: flown.track.get(first..).unwrap_or_default().to_vec(),
        time_s: (flown.time_s - since_s).max(0.0),
        battery_left: flown.battery_left,
        landed: flown.landed,
        cut_short,
    })
}

/// The flight after the engine failed, up to where it is in the ground.
fn glided(
    flight: Flight,
    since_s: f64,
    runway: (&Runway, &FlightPlan),
    terrain: &dyn Terrain,
) -> Option<Glided> {
    let (flown, _) = flight.flown_as_far_as_possible();
    let first = flown.track.partition_point(|point| point.time_s < since_s);
    let mut track = flown.track.get(first..)?.to_vec();
    let missed_m = end_in_ground(&mut track, runway, terrain)?;
    Some(Glided { time_s: track.last()?.time_s - since_s, track, missed_m })
}

/// Cuts a track without an engine where it is in the ground. How far that is from the runway of the plan, metres; 0: on it. `None`: there
/// is no track.
pub(crate) fn end_in_ground(
    track: &mut Vec<TrackPoint>,
    (runway, plan): (&Runway, &FlightPlan),
    terrain: &dyn Terrain,
) -> Option<f64> {
    let [low_m, high_m] = elevations_m(runway, plan, terrain);
    let is_in =
        |at: &TrackPoint, own_m| at.altitude_amsl_m <= ground_m(at.position, (runway, own_m), terrain);
    let is_down = |at: &TrackPoint| is_in(at, low_m);
    if let Some(down) = track.iter().position(is_down) {
        track.truncate(down + 1);
    }
    let last = track.last()?;
    let away_m = runway.strip().beside_m(last.position);
    // it stands as high as the end that it landed on
    Some(if is_in(last, high_m) { (away_m - TOLERANCE_M).max(0.0) } else { away_m.max(1.0) })
}

/// So near to a runway's centre line, or to its ends, one is on it, metres.
const TOLERANCE_M: f64 = 60.0;

/// Elevations of a runway's lower and higher end, metres AMSL: it may be landed on from either.
fn elevations_m(runway: &Runway, plan: &FlightPlan, terrain: &dyn Terrain) -> [f64; 2] {
    let named = end_of(runway);
    let other = named.opposite(plan.runways.iter().map(end_of), |place| terrain.elevation_m(place));
    let [named_m, other_m] = [named, other.unwrap_or(named)].map(|end| end.elevation_amsl_m);
    [named_m.min(other_m), named_m.max(other_m)]
}

/// The ground of a place; near the runway, and where nothing is known, the runway's.
fn ground_m(place: LatLon, (runway, own_m): (&Runway, f64), terrain: &dyn Terrain) -> f64 {
    let strip = runway.strip();
    let ends = [strip.threshold, strip.from_other_end().threshold];
    let near = ends.into_iter().any(|end| distance_and_course(place, end).0 < AT_RUNWAY_M)
        || strip.beside_m(place) < TOLERANCE_M;
    terrain.elevation_m(place).filter(|_| !near).unwrap_or(own_m)
}
