//! The glide home with the engine out: where the rest of an emergency plan leads, and the height with which a glide arrives.

use super::path::distance_m;
use super::world::World;
use aircraft::Wind;
use aircraft::glide::{GlideStart, glide, reserve_m};
use flight_plan::{Id, Runway, Stage, StageKind};
use geometry::LatLon;
use geometry::geodesy::normalise_180;

/// Off the runway's heading by more than this a path is not on the final approach, which then gets a point to line up at first, degrees.
pub const ALIGNED_DEG: f64 = 30.0;
/// Most legs on the way home that are looked at.
const MAX_HALTS: usize = 200;

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
        let gate = |runway: &Runway| final_begins_at(runway, world.config.final_approach_m);
        return vec![Halt { id: stage.id.clone(), place: runway.map(gate) }];
    }
    let legs = stage.legs.iter().skip(first);
    let halt = |leg: &flight_plan::Leg| {
        let place = leg.place().and_then(|place| world.place(place).ok());
        Halt { id: leg.id.clone(), place }
    };
    legs.map(|leg| halt(leg)).collect()
}

/// Where a final approach of a length begins.
pub fn final_begins_at(runway: &Runway, length_m: f64) -> LatLon {
    runway.threshold.destination(runway.heading_deg + 180.0, length_m)
}

/// Nearer to the threshold than where the final approach begins, and on the runway's line.
pub fn is_on_final(here: LatLon, begins: LatLon, runway: &Runway) -> bool {
    let off_deg = normalise_180(here.bearing_deg(runway.threshold) - runway.heading_deg);
    distance_m(here, runway.threshold) <= distance_m(begins, runway.threshold) && off_deg.abs() <= ALIGNED_DEG
}

/// How a glide by way of some places to a runway ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// Height above the threshold there, metres; what is lacking, if it is negative.
    pub height_m: f64,
    /// Height that the way takes, metres.
    pub taken_m: f64,
}

impl Arrival {
    /// So much more than the reserve, metres; what of it is lacking, if it is negative.
    pub fn spare_m(&self) -> f64 {
        self.height_m - reserve_m(self.taken_m)
    }

    /// The altitude that a glide straight from a place to the runway needs there, with its reserve, metres AMSL. `None`: the wind does not
    /// let it get there.
    pub fn needed_amsl_m(world: &World, wind: Wind, position: LatLon, runway: &Runway) -> Option<f64> {
        let from =
            GlideStart { position, altitude_amsl_m: 0.0, course_deg: position.bearing_deg(runway.threshold) };
        Some(-Self::of(world, wind, from, [].into_iter(), runway)?.spare_m())
    }

    /// Of one that goes to a landing at once, and whether it does so by the place where the final approach begins. That is left out if the
    /// height does not suffice for the way by it; and nobody goes back to it from nearer on the runway's line.
    pub fn at_landing(
        world: &World,
        wind: Wind,
        from: GlideStart,
        begins: LatLon,
        runway: &Runway,
    ) -> (bool, Option<Self>) {
        let has_passed = is_on_final(from.position, begins, runway);
        let by_it = Self::of(world, wind, from, [begins].into_iter(), runway);
        let by_it = by_it.filter(|arrival| !has_passed && arrival.height_m >= 0.0);
        (by_it.is_some(), by_it.or_else(|| Self::of(world, wind, from, [].into_iter(), runway)))
    }

    /// `None`: the wind does not let it get there.
    pub fn of(
        world: &World,
        wind: Wind,
        from: GlideStart,
        places: impl Iterator<Item = LatLon>,
        runway: &Runway,
    ) -> Option<Self> {
        let way: Vec<LatLon> = places.chain([runway.threshold]).collect();
        let end = *glide(world.profile, wind.into(), from, &way, runway.heading_deg)?.last()?;
        Some(Self {
            height_m: end.altitude_amsl_m - runway.elevation_amsl_m,
            taken_m: from.altitude_amsl_m - end.altitude_amsl_m,
        })
    }
}
