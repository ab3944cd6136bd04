//! The glide home with the engine out: where the rest of an emergency plan leads, and the height with which a glide arrives.

use super::above_ground::{clears_ground, clears_way_in};
use super::world::World;
use aircraft::Wind;
use aircraft::glide::{GlidePoint, GlideStart, glide};
use aircraft::glide_in::{Arrival, End, WayIn};
use flight_plan::{FlightPlan, Id, Runway, Stage, StageKind};
use geometry::LatLon;

/// Most legs on the way home that are looked at.
const MAX_HALTS: usize = 200;

/// More runways are not stored for Safe mode.
const MOST_RUNWAYS: usize = 32;

/// The runways of a plan that Safe mode is to know, the best first.
pub fn safe_runways(plan: &FlightPlan) -> Vec<&Runway> {
    let mut runways: Vec<&Runway> = plan.runways.iter().collect();
    runways.sort_by_key(|runway| runway.priority);
    runways.truncate(MOST_RUNWAYS);
    runways
}

/// A part of an emergency plan that can be gone to: a leg of a stage, or a landing.
#[derive(Debug, Clone, PartialEq)]
pub struct Halt {
    /// The leg, or the stage that lands.
    pub id: Id,
    /// Where it leads; of a landing, where the final approach begins. `None`: to no place of its own.
    pub place: Option<LatLon>,
}

/// The way home from a leg of an emergency plan on (indices of its stage and, in that, of the leg, or of the loop around it).
pub fn halts(world: &World, section: usize, (stage, leg): (usize, usize)) -> Vec<Halt> {
    let stages = world.program.stages(Some(section)).iter().enumerate().skip(stage);
    let mut all = stages.flat_map(|(index, s)| of_stage(world, s, if index == stage { leg } else { 0 }));
    let mut halts: Vec<Halt> = all.by_ref().take(MAX_HALTS).collect();
    if all.next().is_some() {
        // whatever is left out, it ends with the landing
        let landing =
            world.program.stages(Some(section)).last().into_iter().flat_map(|s| of_stage(world, s, 0));
        halts.pop();
        halts.extend(landing.last());
    }
    halts
}

fn of_stage(world: &World, stage: &Stage, first: usize) -> Vec<Halt> {
    if stage.kind == StageKind::Land {
        let runway = stage.runway.as_ref().and_then(|id| world.program.plan.runway(id));
        let gate = |runway: &Runway| end_of(runway).final_begins_at(world.config.final_approach_m);
        return vec![Halt { id: stage.id.clone(), place: runway.map(gate) }];
    }
    let legs = stage.legs.iter().skip(first);
    let halt = |leg: &flight_plan::Leg| {
        let place = leg.place().and_then(|place| world.place(place).ok());
        Halt { id: leg.id.clone(), place }
    };
    legs.map(|leg| halt(leg)).collect()
}

/// The end of a runway that is named.
pub fn end_of(runway: &Runway) -> End {
    End { strip: runway.strip(), elevation_amsl_m: runway.elevation_amsl_m }
}

/// A runway of the plan from its other end, as high as it is known to be there.
pub fn from_other_end(world: &World, runway: &Runway) -> Runway {
    let other = end_of(runway).opposite(ends(world), |place| world.terrain.elevation_m(place));
    at_other_end(runway, other.map_or(runway.elevation_amsl_m, |end| end.elevation_amsl_m))
}

fn at_other_end(runway: &Runway, elevation_amsl_m: f64) -> Runway {
    Runway { elevation_amsl_m, ..runway.from_other_end() }
}

/// The ends of runways that the plan names.
fn ends<'a>(world: &World<'a>) -> impl Iterator<Item = End> + use<'a> {
    world.program.plan.runways.iter().map(end_of)
}

/// The altitude that a glide straight from a place to the runway needs there, with its reserve, metres AMSL. `None`: the wind does not let
/// it get there.
pub fn needed_amsl_m(world: &World, wind: Wind, position: LatLon, runway: &Runway) -> Option<f64> {
    let from =
        GlideStart { position, altitude_amsl_m: 0.0, course_deg: position.bearing_deg(runway.threshold) };
    Some(-arrival(world, wind, from, [].into_iter(), runway)?.spare_m())
}

/// How a glide by way of some places to a runway ends. `None`: the wind does not let it get there.
pub fn arrival(
    world: &World,
    wind: Wind,
    from: GlideStart,
    places: impl Iterator<Item = LatLon>,
    runway: &Runway,
) -> Option<Arrival> {
    Arrival::along(&points(world, wind, from, places, runway)?, runway.elevation_amsl_m)
}

fn points(
    world: &World,
    wind: Wind,
    from: GlideStart,
    places: impl Iterator<Item = LatLon>,
    runway: &Runway,
) -> Option<Vec<GlidePoint>> {
    let way: Vec<LatLon> = places.chain([runway.threshold]).collect();
    glide(world.profile, wind.into(), from, &way, runway.heading_deg)
}

/// A glide by way of some places to a runway is above the ground all the way.
pub fn is_clear(
    world: &World,
    wind: Wind,
    from: GlideStart,
    places: impl Iterator<Item = LatLon>,
    runway: &Runway,
) -> bool {
    points(world, wind, from, places, runway).is_some_and(|points| clears_ground(world.terrain, &points))
}

/// How a glide that goes to a landing at once flies in.
#[derive(Debug, Clone, PartialEq)]
pub struct GlideIn {
    /// The runway, as it is landed on.
    pub runway: Runway,
    /// That is from its other end.
    pub from_other_end: bool,
    /// By a place so far before the threshold, in line with the runway, metres. `None`: straight to the threshold.
    pub final_m: Option<f64>,
    /// `None`: the wind does not let it get there.
    pub arrival: Option<Arrival>,
    /// It gets there, above the ground all the way.
    lands: bool,
}

impl GlideIn {
    /// The best way in ([`WayIn::best`]) above the ground, at the end that the plan names before the other one. If the height suffices for
    /// none: straight to the end that is named, or to the other one if less is lacking there.
    pub fn of(world: &World, wind: Wind, from: GlideStart, runway: &Runway) -> Self {
        let named = end_of(runway);
        let other = named.other(world.profile, wind, ends(world), |place| world.terrain.elevation_m(place));
        let ends: Vec<End> = [named].into_iter().chain(other).collect();
        let ways = WayIn::all((world.profile, wind), from, &ends, world.config.final_approach_m);
        let elevation_m = |way: &WayIn| ends.get(way.end).map_or(f64::NAN, |end| end.elevation_amsl_m);
        let best = WayIn::best(&ways, |way| clears_way_in(world.terrain, way, elevation_m(way)));
        let way = best.or_else(|| Self::as_near_as_it_gets(&ways));
        let reversed = way.filter(|way| way.end > 0);
        Self {
            runway: reversed.map_or_else(|| runway.clone(), |way| at_other_end(runway, elevation_m(way))),
            from_other_end: reversed.is_some(),
            final_m: way.and_then(|way| way.final_m),
            arrival: way.and_then(|way| way.arrival),
            lands: best.is_some(),
        }
    }

    /// Nothing that gets there is clear of the ground, or nothing gets there.
    fn as_near_as_it_gets(ways: &[WayIn]) -> Option<&WayIn> {
        let straight = || ways.iter().filter(|way| !way.is_in_line());
        let named = straight().next()?;
        let lacks_less = |other: &&WayIn| !named.gets_there() && other.height_m() > named.height_m();
        let in_line = ways.iter().find(|way| way.is_in_line() && way.gets_there());
        in_line.or_else(|| straight().find(lacks_less)).or(Some(named))
    }

    /// It gets there, above the ground all the way: Safe mode lands there, too.
    pub fn lands(&self) -> bool {
        self.lands
    }

    /// It would get there if no ground were in its way.
    pub fn is_blocked(&self) -> bool {
        self.arrival.is_some_and(|arrival| arrival.height_m >= 0.0) && !self.lands
    }
}
