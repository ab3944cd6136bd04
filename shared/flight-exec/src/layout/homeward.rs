//! The glide home with the engine out: where the rest of an emergency plan leads, and the height with which a glide arrives.

use super::above_ground::clears_ground;
use super::path::distance_m;
use super::world::World;
use aircraft::Wind;
use aircraft::glide::{GlidePoint, GlideStart, glide, may_land_unnamed, reserve_m};
use flight_plan::{Id, Runway, Stage, StageKind};
use geometry::LatLon;
use geometry::geodesy::normalise_180;

/// Off the runway's heading by more than this a path is not on the final approach, which then gets a point to line up at first, degrees.
pub const ALIGNED_DEG: f64 = 30.0;
/// Final approaches that a glide may fly, as shares of the whole one.
const FINALS: [f64; 3] = [1.0, 0.5, 0.3];
/// The other end of a runway, of which only the place is known, may be so much higher or lower by the elevation model, metres.
const LEVEL_M: f64 = 8.0;
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

    /// `None`: the wind does not let it get there.
    pub fn of(
        world: &World,
        wind: Wind,
        from: GlideStart,
        places: impl Iterator<Item = LatLon>,
        runway: &Runway,
    ) -> Option<Self> {
        Self::along(&points(world, wind, from, places, runway)?, runway)
    }

    fn along(points: &[GlidePoint], runway: &Runway) -> Option<Self> {
        let (from, end) = (points.first()?, points.last()?);
        Some(Self {
            height_m: end.altitude_amsl_m - runway.elevation_amsl_m,
            taken_m: from.altitude_amsl_m - end.altitude_amsl_m,
        })
    }
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
    /// It is above the ground all the way.
    clears: bool,
}

impl GlideIn {
    /// Above the ground by the longest final approach that the height suffices for with the whole reserve, to the end that the plan names
    /// before the other one; else without the reserve, else straight. Nobody goes back to where a final begins from nearer on the runway's
    /// line. If the height suffices for none: straight to the end that is named, or to the other one if less is lacking there.
    pub fn of(world: &World, wind: Wind, from: GlideStart, runway: &Runway) -> Self {
        let by = |end: &(Runway, bool), final_m| Self::by(world, wind, from, end, final_m);
        let other = other_end(world, wind, runway).map(|other| (other, true));
        let ends: Vec<(Runway, bool)> = [(runway.clone(), false)].into_iter().chain(other).collect();
        let in_line =
            ends.iter().flat_map(|end| finals(world, from.position, &end.0).map(move |m| by(end, m)));
        let in_line: Vec<Self> = in_line.filter(Self::gets_there).collect();
        let straight: Vec<Self> = ends.iter().map(|end| by(end, None)).collect();
        let clear =
            |ways: &[Self], best: fn(&Self) -> bool| ways.iter().find(|way| best(way) && way.clears).cloned();
        let found = clear(&in_line, Self::keeps_reserve).or_else(|| clear(&in_line, Self::gets_there));
        let found = found.or_else(|| clear(&straight, Self::gets_there));
        found.unwrap_or_else(|| {
            Self::as_near_as_it_gets(&in_line, straight, by(&(runway.clone(), false), None))
        })
    }

    /// Nothing that gets there is clear of the ground, or nothing gets there.
    fn as_near_as_it_gets(in_line: &[Self], straight: Vec<Self>, named: Self) -> Self {
        if let Some(way) = in_line.first() {
            return way.clone();
        }
        let lacks_less = |other: &Self| !named.gets_there() && other.height_m() > named.height_m();
        straight.into_iter().find(lacks_less).unwrap_or(named)
    }

    /// It would get there if no ground were in its way.
    pub fn is_blocked(&self) -> bool {
        self.gets_there() && !self.clears
    }

    fn by(
        world: &World,
        wind: Wind,
        from: GlideStart,
        (runway, from_other_end): &(Runway, bool),
        final_m: Option<f64>,
    ) -> Self {
        let begins = final_m.map(|metres| final_begins_at(runway, metres));
        let points = points(world, wind, from, begins.into_iter(), runway);
        let arrival = points.as_deref().and_then(|points| Arrival::along(points, runway));
        let gets_there = arrival.is_some_and(|arrival| arrival.height_m >= 0.0);
        let clears = gets_there && points.is_some_and(|points| clears_ground(world.terrain, &points));
        Self { runway: runway.clone(), from_other_end: *from_other_end, final_m, arrival, clears }
    }

    /// Above the threshold, metres.
    fn height_m(&self) -> f64 {
        self.arrival.map_or(f64::NEG_INFINITY, |arrival| arrival.height_m)
    }

    fn gets_there(&self) -> bool {
        self.height_m() >= 0.0
    }

    fn keeps_reserve(&self) -> bool {
        self.arrival.is_some_and(|arrival| arrival.spare_m() >= 0.0)
    }
}

/// Lengths of the final approaches to an end of a runway that may be flown from a place; `None`: it is on one.
fn finals(world: &World, here: LatLon, runway: &Runway) -> impl Iterator<Item = Option<f64>> + use<> {
    let whole_m = world.config.final_approach_m;
    let is_there = is_on_final(here, final_begins_at(runway, whole_m), runway);
    let shares = FINALS.into_iter().filter(move |_| !is_there).map(move |share| Some(share * whole_m));
    shares.chain(is_there.then_some(None))
}

/// The other end of a runway, if a glide may land there and it is not known to lie higher or lower.
fn other_end(world: &World, wind: Wind, runway: &Runway) -> Option<Runway> {
    let other = runway.from_other_end();
    let is_level = |ground_m: f64| (ground_m - other.elevation_amsl_m).abs() <= LEVEL_M;
    let may_land = may_land_unnamed(world.profile, wind, other.heading_deg);
    let fits = may_land && world.terrain.elevation_m(other.threshold).is_none_or(is_level);
    fits.then_some(other)
}
