//! Leaving a zone out of the area that is scanned over it: a hole around the zone, and legs that lead around it where the way to the
//! scan or on from it would cross it. Any other leg that goes into a zone on its way to a place is led around it.
//!
//! How far the hole has to be from the zone depends on how the aircraft turns there, and the way to the scan on where it begins with the
//! hole in it. So each candidate is tried: it is offered only if the plan with it, reviewed like any other, has neither this
//! error nor a new one.
//!
//! The way around a zone stays as high as it was flown to: what descends, as an approach does to its gate, descends behind the zone.
//! Is too little of the leg left there to descend on, that is an error of the plan with it, and it is not offered.

use super::flown::Flown;
use super::{Conditions, View};
use aircraft::Profile;
use flight_plan::create::{self, Drawn, LegChoice};
use flight_plan::{
    Altitude, AltitudeReference, Area, Edit, FlightPlan, Id, Leg, LegKind, Place, Problem, Program, Scan,
    Spot, Value, Zone, ZoneKind, ZoneShape, compile,
};
use geometry::polygon::{EdgeBudget, Interior};
use geometry::{LatLon, LocalFrame, Polygon, Vec2};
use std::sync::Arc;
use terrain::Terrain;

/// Between the hole and the zone, turn radii that are tried, besides margin and overshoot.
const ROOM: [f64; 4] = [1.0, 1.5, 2.0, 3.0];
/// The way around a zone keeps this share of the hole's distance: it does not follow the tracks that end at the hole.
const AROUND: f64 = 0.8;
/// Most plans that are tried for a review.
const MAX_TRIALS: usize = 12;
/// Edges that the search for a way around one zone may compare.
const MAX_EDGES: u64 = 1_000_000;

/// The errors of legs that go into a zone to keep out of, with the edit that leaves the zone out of what they scan, or leads them around
/// it, where there is one that makes the error go away; `found`: what the review said. To be put in their place by [`put_remedies`].
///
/// `go_on` is asked before each trial, which takes as long as a review; false ends the work.
pub fn leave_zones_out(
    program: &Program,
    profile: &Profile,
    terrain: &Arc<dyn Terrain>,
    conditions: Conditions,
    found: &[Problem],
    go_on: &mut dyn FnMut() -> bool,
) -> Vec<Problem> {
    let mut trials = Trials { profile, terrain, conditions, found, left: MAX_TRIALS, go_on };
    let errors = found.iter().filter(|p| p.is_error() && p.code == "keep-out" && p.fix.is_none());
    let remedied = errors.filter_map(|error| {
        let plan = &program.plan;
        let (what, edit) = if let Some(crossing) = Crossing::of(plan, error) {
            let left_out = |room: &f64| trials.leave_out(plan, &crossing, *room);
            ("leave the zone out of its area", ROOM.iter().find_map(left_out)?)
        } else {
            let conflict = Conflict::of(plan, error).filter(|conflict| conflict.goes_to_a_place())?;
            ("go around the zone", trials.lead_around(plan, &conflict)?)
        };
        let message = format!("{what}, or {}", error.message);
        Some(Problem { message, ..error.clone().fixed_by(edit) })
    });
    remedied.collect()
}

/// Puts errors with their remedies in the place of those without.
pub fn put_remedies(problems: &mut [Problem], remedied: Vec<Problem>) {
    for with in remedied {
        if let Some(old) = problems.iter_mut().find(|old| key(old) == key(&with)) {
            *old = Problem { location: old.location, ..with };
        }
    }
}

type Key<'a> = (&'static str, Option<&'a Id>, Option<&'a Id>);

fn key(problem: &Problem) -> Key<'_> {
    (problem.code, problem.subject.as_ref(), problem.zone.as_deref())
}

/// A leg that goes into a zone to keep out of.
struct Conflict<'a> {
    leg: &'a Leg,
    zone: &'a Zone,
}

impl<'a> Conflict<'a> {
    fn of(plan: &'a FlightPlan, error: &Problem) -> Option<Self> {
        let leg = plan.leg(error.subject.as_ref()?)?.leg;
        let zone = plan.zone(error.zone.as_deref()?).filter(|zone| zone.kind == ZoneKind::KeepOut)?;
        Some(Self { leg, zone })
    }

    /// Another place on its way changes nothing but the way.
    fn goes_to_a_place(&self) -> bool {
        matches!(self.leg.kind, LegKind::Tf(_) | LegKind::Df { .. })
    }

    /// The places of a way around the zone, at this distance; none: nothing is in the way.
    fn way_around(&self, (from, to): (LatLon, LatLon), apart_m: f64) -> Option<Vec<LatLon>> {
        let middle = match &self.zone.shape {
            ZoneShape::Circle { centre, .. } => *centre,
            ZoneShape::Polygon(corners) => *corners.first()?,
        };
        let frame = LocalFrame::around(&[from, to, middle])?;
        let ring = around(&frame, &self.zone.shape, apart_m)?;
        let (start, end) = (frame.to_local(from), frame.to_local(to));
        let places = || ring.iter().chain([&start, &end]);
        let reach_m = places().map(|at| at.length()).fold(0.0, f64::max) * 2.0 + apart_m;
        let world = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
        let world = world.map(|(n, e)| Vec2 { n: n * reach_m, e: e * reach_m });
        let outside = Polygon::new(world.to_vec(), vec![ring.to_vec()]).ok()?;
        let way = Interior::of(outside).shortest_path(start, end, &mut EdgeBudget::new(MAX_EDGES))?;
        Some(way.into_iter().map(|at| frame.to_geo(at)).collect())
    }
}

/// A scan of an outline that goes into a zone.
struct Crossing<'a> {
    conflict: Conflict<'a>,
    scan: &'a Scan,
    corners: &'a [LatLon],
    holes: &'a [Vec<LatLon>],
}

impl<'a> Crossing<'a> {
    fn of(plan: &'a FlightPlan, error: &Problem) -> Option<Self> {
        let conflict = Conflict::of(plan, error)?;
        let LegKind::Scan(scan) = &conflict.leg.kind else { return None };
        let Area::Polygon { corners, holes } = &scan.area else { return None };
        Some(Self { conflict, scan, corners, holes })
    }

    /// The scan with a hole that keeps this distance from the zone, metres; `None`: it would not be inside the area, or touches
    /// another hole.
    fn with_hole(&self, apart_m: f64) -> Option<Leg> {
        let frame = LocalFrame::around(self.corners)?;
        let hole =
            around(&frame, &self.conflict.zone.shape, apart_m)?.map(|corner| frame.to_geo(corner)).to_vec();
        let holes: Vec<Vec<LatLon>> = self.holes.iter().cloned().chain([hole]).collect();
        Polygon::from_geo(&frame, self.corners, &holes).ok()?;
        let area = Area::Polygon { corners: self.corners.to_vec(), holes };
        let kind = LegKind::Scan(Scan { area, ..self.scan.clone() });
        Some(Leg { kind, ..self.conflict.leg.clone() })
    }
}

/// A rectangle that keeps this distance from a zone, metres; of an outline along its narrowest way.
fn around(frame: &LocalFrame, shape: &ZoneShape, apart_m: f64) -> Option<[Vec2; 4]> {
    let (ring, heading_deg, apart_m) = match shape {
        ZoneShape::Circle { centre, radius_m } => (vec![frame.to_local(*centre)], 0.0, apart_m + radius_m),
        ZoneShape::Polygon(corners) => {
            let zone = Polygon::from_geo(frame, corners, &[]).ok()?;
            (zone.outer().to_vec(), zone.narrowest_heading_deg(), apart_m)
        }
    };
    let along = Vec2::from_bearing_rad(heading_deg.to_radians());
    let across = Vec2 { n: -along.e, e: along.n };
    let span = |direction: Vec2| {
        let places = || ring.iter().map(|corner| corner.dot(direction));
        let low = places().fold(f64::INFINITY, f64::min);
        let high = places().fold(f64::NEG_INFINITY, f64::max);
        [low - apart_m, high + apart_m]
    };
    let ([back, ahead], [left, right]) = (span(along), span(across));
    let corners = [(back, left), (back, right), (ahead, right), (ahead, left)];
    Some(corners.map(|(on, beside)| along * on + across * beside))
}

/// Plans that are tried.
struct Trials<'a> {
    profile: &'a Profile,
    terrain: &'a Arc<dyn Terrain>,
    conditions: Conditions,
    /// What the plan as it is has.
    found: &'a [Problem],
    /// So many more may be tried.
    left: usize,
    go_on: &'a mut dyn FnMut() -> bool,
}

/// What came out.
struct Tried {
    errors: Vec<Problem>,
    /// From which leg to which a flight goes on, and between which places; those of the main plan first.
    joints: Vec<Joint>,
}

/// Where one leg ends and another begins.
struct Joint {
    from: Id,
    to: Id,
    gap: (LatLon, LatLon),
    /// What the legs ask for there, metres AMSL.
    heights_amsl_m: (f64, f64),
}

impl Joint {
    /// The altitude that a way around something between the legs is flown at by a leg beside `of`, one of them: the higher of theirs. With
    /// the lower one the aircraft would sink over other ground than where the plan has it sink, or climb later. `None`: that of `of`.
    fn altitude(&self, plan: &FlightPlan, of: &Leg) -> Option<Altitude> {
        let (own_m, other_m, other) = match self.heights_amsl_m {
            (from, to) if self.to == of.id => (to, from, &self.from),
            (from, to) => (from, to, &self.to),
        };
        let said = |leg: &Id| plan.leg(leg).and_then(|context| context.altitude().cloned());
        let (own, other) = (said(&of.id), said(other));
        if own == other {
            return of.altitude.clone();
        }
        if let (Some(own), Some(other)) = (&own, &other)
            && let (Value::Constant(own_m), Value::Constant(other_m)) = (&own.metres, &other.metres)
            && own.reference == other.reference
        {
            return if own_m < other_m { Some(other.clone()) } else { of.altitude.clone() };
        }
        // what follows the ground may be lower beside the zone than the aircraft was before it
        if own_m >= other_m && own.is_none_or(|own| own.reference != AltitudeReference::Agl) {
            return of.altitude.clone();
        }
        let metres = Value::Constant(own_m.max(other_m).ceil());
        Some(Altitude { metres, reference: AltitudeReference::Amsl })
    }
}

impl Trials<'_> {
    /// The edit that leaves the zone out with so much room to turn, if it makes the error go away.
    fn leave_out(&mut self, plan: &FlightPlan, crossing: &Crossing<'_>, room: f64) -> Option<Edit> {
        let turn_m = self.profile.turn_radius_m(self.profile.cruise_airspeed_mps);
        let Value::Constant(overshoot_m) = crossing.scan.overshoot_m else { return None };
        let apart_m = self.conditions.margins.zone_m + room * turn_m + overshoot_m.max(0.0);
        let hole = Box::new(crossing.with_hole(apart_m)?);
        let conflict = &crossing.conflict;
        let mut edits = vec![Edit::ReplaceLeg { leg: conflict.leg.id.clone(), with: hole }];
        let holed = edits.first()?.apply(plan).ok()?;
        let tried = self.fly(&holed)?;
        if self.is_good(&tried, conflict) {
            return Some(Edit::All(edits));
        }
        let detoured = detours(holed, &tried, conflict, AROUND * apart_m, self.profile, &mut edits)?;
        let tried = self.fly(&detoured)?;
        self.is_good(&tried, conflict).then_some(Edit::All(edits))
    }

    /// The edit that leads a leg around the zone on its way to its place, and what follows it, too; with as little room to turn as makes
    /// the error go away.
    fn lead_around(&mut self, plan: &FlightPlan, conflict: &Conflict<'_>) -> Option<Edit> {
        let turn_m = self.profile.turn_radius_m(self.profile.cruise_airspeed_mps);
        let flown = self.fly(plan)?;
        ROOM.iter().find_map(|room| {
            let apart_m = self.conditions.margins.zone_m + room * turn_m;
            let mut edits = Vec::new();
            let detoured = detours(plan.clone(), &flown, conflict, apart_m, self.profile, &mut edits)?;
            let tried = self.fly(&detoured)?;
            self.is_good(&tried, conflict).then_some(Edit::All(edits))
        })
    }

    /// No error that the plan did not have before, and the zone is in the way of neither the leg nor what follows it.
    fn is_good(&self, tried: &Tried, conflict: &Conflict<'_>) -> bool {
        tried.errors.iter().all(|error| {
            let is_known = self.found.iter().any(|known| known.is_error() && key(known) == key(error));
            let is_here = error.subject.as_ref().is_some_and(|of| {
                let follows = |joint: &Joint| joint.from == conflict.leg.id && joint.to == *of;
                *of == conflict.leg.id || tried.joints.iter().any(follows)
            });
            is_known && !(is_here && error.zone.as_deref() == Some(&conflict.zone.id))
        })
    }

    fn fly(&mut self, plan: &FlightPlan) -> Option<Tried> {
        self.left = self.left.checked_sub(1)?;
        if !(self.go_on)() {
            self.left = 0;
            return None;
        }
        let program = Arc::new(compile(plan.clone(), self.profile, self.terrain.as_ref()).ok()?);
        let view = View::of(&program, self.profile, self.terrain, self.conditions);
        let errors = view.problems().into_iter().filter(Problem::is_error).collect();
        Some(Tried { errors, joints: view.flights.all().flat_map(joints).collect() })
    }
}

fn joints(flown: &Flown) -> impl Iterator<Item = Joint> + '_ {
    let pairs = flown.waypoints.iter().zip(flown.waypoints.iter().skip(1));
    let pairs = pairs.filter(|(a, b)| a.waypoint.leg != b.waypoint.leg);
    pairs.map(|(a, b)| Joint {
        from: a.waypoint.leg.clone(),
        to: b.waypoint.leg.clone(),
        gap: (a.waypoint.position, b.waypoint.position),
        heights_amsl_m: (a.wanted_amsl_m, b.wanted_amsl_m),
    })
}

/// The plan with legs that lead around the zone before the leg and behind it, as far as they are needed; what that takes is added to
/// the edits. `None`: nothing is to be led around.
fn detours(
    mut plan: FlightPlan,
    tried: &Tried,
    conflict: &Conflict<'_>,
    apart_m: f64,
    profile: &Profile,
    edits: &mut Vec<Edit>,
) -> Option<FlightPlan> {
    let of = &conflict.leg.id;
    let before = tried.joints.iter().find(|joint| joint.to == *of);
    let behind = tried.joints.iter().find(|joint| joint.from == *of);
    let known = edits.len();
    for joint in before.into_iter().chain(behind) {
        let altitude = joint.altitude(&plan, conflict.leg);
        let mut spot = if joint.to == *of { Spot::Before(of.clone()) } else { Spot::After(of.clone()) };
        for at in conflict.way_around(joint.gap, apart_m)? {
            let place = Drawn::Place(Place::Position(Value::Constant(at)));
            let mut leg = create::leg(&plan, profile, LegChoice::Tf, &place, None, None)?;
            leg.altitude.clone_from(&altitude);
            let id = leg.id.clone();
            let edit = Edit::InsertLeg { leg: Box::new(leg), at: spot.clone() };
            plan = edit.apply(&plan).ok()?;
            edits.push(edit);
            if matches!(spot, Spot::After(_)) {
                spot = Spot::After(id);
            }
        }
    }
    (edits.len() > known).then_some(plan)
}
