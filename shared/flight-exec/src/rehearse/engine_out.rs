//! How an engine failure ends, as far as it can be said without a flight: the one judgement that the review, *What if* and a coverage have in
//! common.
//!
//! An aircraft without an engine leaves out of its emergency plan what the height does not suffice for, so what counts is the best of these
//! glides: straight to either end of the runway, or along all of the plan if that is named for an engine failure.

use super::route;
use crate::layout::homeward::end_of;
use crate::layout::path::distance_and_course;
use aircraft::glide::{GlidePoint, GlideStart, glide};
use aircraft::{Profile, Winds};
use flight_plan::{EmergencyPlan, Program, Runway, StageKind, Variables};
use geometry::{LatLon, PathElement};
use terrain::Terrain;

/// Distance between points of a glide, metres, and the most of them between two places.
const SPACING_M: f64 = 150.0;
const MAX_SAMPLES: f64 = 500.0;
/// So near to an end of a runway the ground is the runway's.
pub(super) const AT_RUNWAY_M: f64 = 400.0;

/// Near a runway no height and no plan helps an aircraft whose engine fails: low, and with the runway behind it or not yet in reach, it lands
/// straight ahead. The review does not count what is flown there, and a coverage says how much of it that is.
pub fn is_near_runway(kind: StageKind) -> bool {
    !matches!(kind, StageKind::EnRoute | StageKind::Mission)
}

/// What a glide is through and over.
pub(crate) type Air<'a> = (&'a Profile, Winds, &'a dyn Terrain);

/// An emergency plan with its runway, and whether it is named for an engine failure.
pub(crate) type Way<'a> = (&'a EmergencyPlan, &'a Runway, bool);

/// A glide to a runway.
#[derive(Debug, Clone, PartialEq)]
pub struct Glide {
    /// Along the emergency plan, which names the cause `engine`; else straight, for that plan was made for a flight with an engine.
    pub along_plan: bool,
    /// To the threshold, or to where it ends in the ground; empty, if the wind does not let it get there.
    pub path: Vec<GlidePoint>,
    /// From the failure to the threshold, seconds; infinite, if the wind does not let it get there.
    pub time_s: f64,
    /// Height above the threshold with which it arrives, metres; what is lacking, if it is negative.
    pub margin_m: f64,
    /// Where it runs into a hill.
    pub hill: Option<LatLon>,
}

/// How a way out ends, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Reach {
    /// Not on the runway.
    Out,
    /// On the runway, but less than the reserve is left.
    Tight,
    /// On the runway with the reserve.
    Good,
}

impl Reach {
    /// By the height above the threshold, and the reserve of that, metres.
    pub(super) fn by_height(over_m: f64, reserve_m: f64) -> Self {
        match over_m {
            over_m if over_m >= reserve_m => Self::Good,
            over_m if over_m >= 0.0 => Self::Tight,
            _ => Self::Out,
        }
    }
}

impl Glide {
    /// Along all of an emergency plan that is named for an engine failure, else straight to its runway.
    pub(crate) fn home(
        program: &Program,
        (profile, winds, terrain): Air,
        variables: &Variables,
        start: GlideStart,
        (plan, runway, named): Way,
    ) -> Self {
        let way = if named { route(program, plan, runway, variables) } else { vec![runway.threshold] };
        let points = glide(profile, winds, start, &way, runway.heading_deg);
        Self::of(named, points, runway, terrain)
    }

    /// Straight to each end of a runway that a glide may land at, the one that is named first. `lines_up`: it turns in line with the runway
    /// there.
    pub(crate) fn straight(
        program: &Program,
        (profile, winds, terrain): Air,
        start: GlideStart,
        (named, lines_up): (&Runway, bool),
    ) -> Vec<Self> {
        let drawn = program.plan.runways.iter().map(end_of);
        let wind = winds.at(named.elevation_amsl_m);
        let other = end_of(named).other(profile, wind, drawn, |place| terrain.elevation_m(place));
        let other =
            other.map(|end| Runway { elevation_amsl_m: end.elevation_amsl_m, ..named.from_other_end() });
        let to = |runway: &Runway| {
            let towards_deg = start.position.bearing_deg(runway.threshold);
            let lands_deg = if lines_up { runway.heading_deg } else { towards_deg };
            let points = glide(profile, winds, start, &[runway.threshold], lands_deg);
            Self::of(false, points, runway, terrain)
        };
        [Some(named), other.as_ref()].into_iter().flatten().map(to).collect()
    }

    fn of(along_plan: bool, points: Option<Vec<GlidePoint>>, runway: &Runway, terrain: &dyn Terrain) -> Self {
        let arrives = points.as_ref().and_then(|points| points.last().copied());
        let (path, hill) = until_ground(points.unwrap_or_default(), runway, terrain);
        Self {
            along_plan,
            path,
            hill,
            time_s: arrives.map_or(f64::INFINITY, |last| last.time_s),
            margin_m: arrives
                .map_or(f64::NEG_INFINITY, |last| last.altitude_amsl_m - runway.elevation_amsl_m),
        }
    }

    /// How it ends; the reserve is a height above the threshold, metres.
    pub fn reach(&self, reserve_m: f64) -> Reach {
        if self.hill.is_some() { Reach::Out } else { Reach::by_height(self.margin_m, reserve_m) }
    }

    /// Height above the threshold with which it arrives, metres, if no hill and no wind is in its way.
    pub(super) fn arrives_m(&self) -> Option<f64> {
        self.hill.is_none().then_some(self.margin_m).filter(|metres| metres.is_finite())
    }
}

/// The best of the glides after an engine failure.
pub(crate) struct Best {
    /// That glide.
    pub glide: Glide,
    /// How it ends. What gets over an end of the runway without height to line up with it comes down on it.
    pub reach: Reach,
}

impl Best {
    /// From a place; the reserve is a height above the threshold, metres.
    pub fn of(
        program: &Program,
        air: Air,
        variables: &Variables,
        start: GlideStart,
        (plan, runway, named): Way,
        reserve_m: f64,
    ) -> Option<Self> {
        let mut glides = Glide::straight(program, air, start, (runway, true));
        if named && glides.iter().all(|glide| glide.reach(reserve_m) < Reach::Good) {
            glides.push(Glide::home(program, air, variables, start, (plan, runway, true)));
        }
        let better = |one: &Glide, other: &Glide| {
            let by_reach = one.reach(reserve_m).cmp(&other.reach(reserve_m));
            by_reach.then(one.margin_m.total_cmp(&other.margin_m))
        };
        let glide = glides.into_iter().max_by(better)?;
        let gets_over = || Glide::straight(program, air, start, (runway, false));
        let reach = match glide.reach(reserve_m) {
            Reach::Out if gets_over().iter().any(|glide| glide.reach(0.0) > Reach::Out) => Reach::Tight,
            reach => reach,
        };
        Some(Self { glide, reach })
    }
}

/// A glide in small steps, up to where it is in the ground: short of the runway, or in a hill, which is given.
fn until_ground(
    places: Vec<GlidePoint>,
    runway: &Runway,
    terrain: &dyn Terrain,
) -> (Vec<GlidePoint>, Option<LatLon>) {
    let mut path: Vec<GlidePoint> = places.first().copied().into_iter().collect();
    for (from, to) in places.iter().zip(places.iter().skip(1)) {
        let way = PathElement::Line { from: from.position, to: to.position };
        let (length_m, _) = distance_and_course(from.position, to.position);
        let samples = (length_m / SPACING_M).ceil().clamp(1.0, MAX_SAMPLES);
        for sample in 1..=samples as u32 {
            let share = f64::from(sample) / samples;
            let point = GlidePoint {
                time_s: from.time_s + share * (to.time_s - from.time_s),
                position: way.point_at(length_m * share),
                altitude_amsl_m: from.altitude_amsl_m + share * (to.altitude_amsl_m - from.altitude_amsl_m),
            };
            path.push(point);
            let near = distance_and_course(point.position, runway.threshold).0 < AT_RUNWAY_M;
            let ground_m = terrain.elevation_m(point.position).filter(|_| !near);
            if point.altitude_amsl_m < ground_m.unwrap_or(runway.elevation_amsl_m) {
                // below the runway it would have ended in any ground
                let is_hill = !near && point.altitude_amsl_m > runway.elevation_amsl_m;
                return (path, is_hill.then_some(point.position));
            }
        }
    }
    (path, None)
}
