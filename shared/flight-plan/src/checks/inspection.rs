//! What the rules look at: the plan's legs with their geometry at the variables' initial values.

use super::memory::{Memory, Recall};
use crate::expression::{self, Expression, ExpressionError, Names};
use crate::{
    Altitude, AltitudeReference, Branch, Env, FlightPlan, FlightState, Id, Leg, LegContext, LegKind, Place,
    Runway, Section, Stage, StageKind, TurnDirection, Use, Value, VariableValue, Variables,
};
use aircraft::Profile;
use geometry::LatLon;
use geometry::geodesy::{normalise_180, normalise_360};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use terrain::Terrain;

/// Most different expressions of a plan: compiling one takes some 50 µs.
const MOST_EXPRESSIONS: usize = 10_000;

/// Shorter than this a path has no direction, metres.
pub(super) const SHORTEST_M: f64 = 1.0;

/// A plan under inspection.
pub(super) struct Inspection<'a> {
    pub plan: &'a FlightPlan,
    pub profile: &'a Profile,
    pub terrain: &'a dyn Terrain,
    /// Every leg in document order.
    pub steps: Vec<Step<'a>>,
    /// The plan's fixes.
    pub fixes: HashMap<&'a Id, LatLon>,
    /// The plan's runways.
    pub runways: HashMap<&'a Id, &'a Runway>,
    /// Identifiers of its emergency plans.
    pub emergency_plans: HashSet<&'a Id>,
    variables: Variables,
    expressions: HashMap<Arc<str>, Result<Expression, ExpressionError>>,
    home: Option<&'a Runway>,
}

/// A leg with the geometry that is known before the flight.
pub(super) struct Step<'a> {
    pub context: LegContext<'a>,
    /// Where it is entered; `None` when that is only known in flight.
    pub start: Option<Point>,
    /// Where it ends, likewise.
    pub end: Option<Point>,
    /// Airspeed, m/s.
    pub speed_mps: f64,
    /// Its ground path from start to end.
    pub path: Option<Path>,
    /// The step that is flown before it, if the document says so.
    pub before: Option<usize>,
}

/// A point of the path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub position: LatLon,
    pub altitude_amsl_m: Option<f64>,
}

/// A leg's path.
#[derive(Debug, Clone, Copy)]
pub(super) enum Path {
    Line { length_m: f64, course_start_deg: f64, course_end_deg: f64 },
    Arc { centre: LatLon, radius_m: f64, start_bearing_deg: f64, sweep_deg: f64 },
}

impl Path {
    pub fn line(from: LatLon, to: LatLon) -> Self {
        let way = from.inverse(to);
        Path::Line {
            length_m: way.distance_m,
            course_start_deg: way.bearing_start_deg,
            course_end_deg: way.bearing_end_deg,
        }
    }

    /// The arc about `centre` from one position to another; its radius is the end's.
    pub fn arc(from: LatLon, to: LatLon, centre: LatLon, turn: TurnDirection) -> Self {
        let start_bearing_deg = centre.bearing_deg(from);
        let clockwise_deg = normalise_360(centre.bearing_deg(to) - start_bearing_deg);
        let sweep_deg = if turn == TurnDirection::Right { clockwise_deg } else { clockwise_deg - 360.0 };
        Path::Arc { centre, radius_m: centre.distance_m(to), start_bearing_deg, sweep_deg }
    }

    pub fn length_m(&self) -> f64 {
        match self {
            Path::Line { length_m, .. } => *length_m,
            Path::Arc { radius_m, sweep_deg, .. } => radius_m * sweep_deg.abs().to_radians(),
        }
    }

    pub fn course_start_deg(&self) -> f64 {
        match self {
            Path::Line { course_start_deg, .. } => *course_start_deg,
            Path::Arc { start_bearing_deg, sweep_deg, .. } => start_bearing_deg + 90_f64.copysign(*sweep_deg),
        }
    }

    pub fn course_end_deg(&self) -> f64 {
        match self {
            Path::Line { course_end_deg, .. } => *course_end_deg,
            Path::Arc { start_bearing_deg, sweep_deg, .. } => {
                start_bearing_deg + sweep_deg + 90_f64.copysign(*sweep_deg)
            }
        }
    }

    /// Positions along the way from `start` to `end`: `steps` steps of one length, each with its share (0..=1) of the way.
    ///
    /// A line is followed as a geodesic from kilometre to kilometre; in between, latitude and longitude are
    /// interpolated, which is much quicker. That is off by d²·tan φ / 8R at the most: 0.2 m at 85°, beyond which every
    /// position is computed.
    pub fn along(&self, start: LatLon, end: LatLon, steps: u32) -> impl Iterator<Item = (f64, LatLon)> + '_ {
        const CHUNK_M: f64 = 1_000.0;
        let share = move |i: u32| f64::from(i) / f64::from(steps.max(1));
        let straight = matches!(self, Path::Line { .. }) && start.lat_deg.abs() < 85.0;
        let step_m = self.length_m() / f64::from(steps.max(1));
        let chunk = if straight { (CHUNK_M / step_m).clamp(1.0, f64::from(steps.max(1))) as u32 } else { 1 };
        let (mut from, mut to, mut begins) = (start, start, None);
        (0..=steps).map(move |i| {
            let first = i - i % chunk;
            if begins.replace(first) != Some(first) {
                from = if first == 0 { start } else { to };
                let last = (first + chunk).min(steps);
                to = if last == steps { end } else { self.at(start, share(last)) };
            }
            let last = (first + chunk).min(steps);
            let inside = f64::from(i - first) / f64::from((last - first).max(1));
            (share(i), between(from, to, inside))
        })
    }

    /// The position a share (0..1) of the way along, from `start`.
    fn at(&self, start: LatLon, share: f64) -> LatLon {
        match self {
            Path::Line { length_m, course_start_deg, .. } => {
                start.destination(*course_start_deg, length_m * share)
            }
            Path::Arc { centre, radius_m, start_bearing_deg, sweep_deg } => {
                centre.destination(start_bearing_deg + sweep_deg * share, *radius_m)
            }
        }
    }
}

/// The position a share (0..1) of the way between two that are near each other, by latitude and longitude.
fn between(from: LatLon, to: LatLon, share: f64) -> LatLon {
    let lon_deg = from.lon_deg + normalise_180(to.lon_deg - from.lon_deg) * share;
    LatLon::new(from.lat_deg + (to.lat_deg - from.lat_deg) * share, normalise_180(lon_deg))
}

/// Angle between two courses, degrees in 0..=180.
pub(super) fn course_change_deg(from_deg: f64, to_deg: f64) -> f64 {
    normalise_180(to_deg - from_deg).abs()
}

impl<'a> Inspection<'a> {
    pub fn new(
        plan: &'a FlightPlan,
        profile: &'a Profile,
        terrain: &'a dyn Terrain,
        memory: &mut Memory,
    ) -> Self {
        let variables = Variables::initial(plan);
        let mut inspection = Self {
            plan,
            profile,
            terrain,
            steps: Vec::new(),
            fixes: plan.fixes.iter().map(|f| (&f.id, f.position)).collect(),
            runways: plan.runways.iter().map(|r| (&r.id, r)).collect(),
            emergency_plans: plan.emergency_plans.iter().map(|e| &e.id).collect(),
            variables,
            expressions: compiled(plan),
            home: plan.home(),
        };
        let mut recall = Recall::new(memory);
        inspection.trace(&mut recall);
        recall.finish();
        inspection
    }

    /// An expression that compiles.
    fn expression(&self, source: &str) -> Option<&Expression> {
        self.compiled(source)?.as_ref().ok()
    }

    /// What became of an expression; `None`: the plan has too many to look at.
    pub fn compiled(&self, source: &str) -> Option<&Result<Expression, ExpressionError>> {
        self.expressions.get(source)
    }

    /// The runway where the aircraft stands.
    pub fn home(&self) -> Option<&'a Runway> {
        self.home
    }

    /// A compiled expression has a value at the start.
    pub fn has_value(&self, source: &str, used: Use) -> bool {
        self.has_value_with(source, used, &self.variables)
    }

    /// A compiled expression has a value at the start if the variables have these ones.
    pub fn has_value_with(&self, source: &str, used: Use, variables: &Variables) -> bool {
        let env = Env { variables, ..self.env() };
        self.expression(source).is_some_and(|e| match used {
            Use::Number => e.number(&env).is_ok(),
            Use::Condition => e.bool(&env).is_ok(),
            Use::Position => e.position(&env).is_ok(),
            Use::Polygon => e.polygon(&env).is_ok(),
            Use::Any => e.value(&env).is_ok(),
        })
    }

    /// A value at the start, of whatever type.
    pub fn value(&self, source: &str) -> Option<VariableValue> {
        self.expression(source)?.value(&self.env()).ok()
    }

    fn env(&self) -> Env<'_> {
        let home = self.home().map_or(LatLon::new(0.0, 0.0), |r| r.threshold);
        Env {
            variables: &self.variables,
            flight: FlightState { iteration: 1, ..FlightState::on_ground(home) },
        }
    }

    /// A number at the start, if it has a finite value then.
    pub fn number(&self, value: &Value<f64>) -> Option<f64> {
        match value {
            Value::Constant(x) => Some(*x).filter(|x| x.is_finite()),
            Value::Expression(source) => self.expression(source)?.number(&self.env()).ok(),
        }
    }

    /// A position at the start, if it is valid then.
    pub fn position(&self, value: &Value<LatLon>) -> Option<LatLon> {
        match value {
            Value::Constant(p) => Some(*p).filter(|p| p.is_valid()),
            Value::Expression(source) => self.expression(source)?.position(&self.env()).ok(),
        }
    }

    /// Where a place is at the start.
    pub fn place(&self, place: &Place) -> Option<LatLon> {
        match place {
            Place::Fix(id) => self.fixes.get(id).copied().filter(|p| p.is_valid()),
            Place::Position(value) => self.position(value),
        }
    }

    /// An altitude above a position, metres AMSL.
    pub fn altitude_amsl_m(&self, altitude: &Altitude, at: LatLon) -> Option<f64> {
        let datum_m = match altitude.reference {
            AltitudeReference::Amsl => 0.0,
            AltitudeReference::Agl => self.terrain.elevation_m(at)?,
            AltitudeReference::Home => self.home()?.elevation_amsl_m,
        };
        Some(self.number(&altitude.metres)? + datum_m)
    }

    /// The aircraft's planning turn radius, metres.
    pub fn turn_radius_m(&self, speed_mps: f64) -> f64 {
        self.profile.turn_radius_m(speed_mps)
    }

    fn trace(&mut self, recall: &mut Recall) {
        let mut arrival = Arrival::default();
        let mut section = None;
        for (of, stage) in self.plan.all_stages() {
            if section.replace(of) != Some(of) {
                arrival = Arrival::default();
            }
            arrival = match stage.kind {
                StageKind::TakeOff => Arrival { point: self.climb_out(stage), step: None },
                _ => self.trace_list(&stage.legs, stage, of, &mut Vec::new(), arrival, recall),
            };
        }
    }

    /// Where a take-off ends: straight on from the runway's end, at the best climb.
    fn climb_out(&self, stage: &Stage) -> Option<Point> {
        let runway = self.runways.get(stage.runway.as_ref()?).filter(|r| r.threshold.is_valid())?;
        let metres = self.number(&stage.altitude.as_ref()?.metres)?;
        let height_m = match stage.altitude.as_ref()?.reference {
            AltitudeReference::Amsl => metres - runway.elevation_amsl_m,
            AltitudeReference::Agl | AltitudeReference::Home => metres,
        };
        let climb_s = height_m.max(0.0) / self.profile.max_climb_mps.max(0.1);
        let way_m = runway.length_m + climb_s * self.profile.cruise_airspeed_mps;
        if !way_m.is_finite() || !runway.heading_deg.is_finite() {
            return None;
        }
        let position = runway.threshold.destination(runway.heading_deg, way_m);
        Some(Point { position, altitude_amsl_m: Some(runway.elevation_amsl_m + height_m) })
    }

    fn trace_list(
        &mut self,
        legs: &'a [Leg],
        stage: &'a Stage,
        section: Section<'a>,
        loops: &mut Vec<&'a Leg>,
        mut arrival: Arrival,
        recall: &mut Recall,
    ) -> Arrival {
        for (index, leg) in legs.iter().enumerate() {
            let follows = index == 0 || legs.get(index - 1).is_some_and(|previous| leads_to(previous, leg));
            let entry = if follows { arrival } else { Arrival::default() };
            let context = LegContext { leg, stage, section, loops: loops.clone(), siblings: legs, index };
            arrival = self.trace_leg(context, entry, recall);
            if let LegKind::Iterative { body, .. } = &leg.kind {
                loops.push(leg);
                arrival = self.trace_list(body, stage, section, loops, entry, recall);
                loops.pop();
            }
        }
        arrival
    }

    fn trace_leg(&mut self, context: LegContext<'a>, entry: Arrival, recall: &mut Recall) -> Arrival {
        let leg = context.leg;
        let start = entry.point;
        let speed_mps = self.speed_mps(&context);
        let mut step = Step { context, start, end: start, speed_mps, path: None, before: entry.step };
        if !matches!(leg.kind, LegKind::Iterative { .. } | LegKind::Intersection { .. }) {
            step.end = self.end_of(&step);
            step.path =
                start.zip(step.end).and_then(|(from, to)| path_of(leg, from.position, to.position, recall));
        }
        let passes_through = matches!(leg.kind, LegKind::Intersection { .. });
        let arrival = Arrival {
            point: step.end,
            step: if passes_through { entry.step } else { Some(self.steps.len()) },
        };
        self.steps.push(step);
        arrival
    }

    fn end_of(&self, step: &Step) -> Option<Point> {
        let position = match &step.context.leg.kind {
            LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, .. } | LegKind::Rf { to, .. } => {
                self.place(&to.place)
            }
            LegKind::Cf { to, .. } => self.place(&to.place),
            LegKind::Hf(h) | LegKind::Ha(h) | LegKind::Hm { holding: h, .. } => self.place(&h.fix.place),
            _ => None,
        }?;
        let own = altitude_of(&step.context).and_then(|a| self.altitude_amsl_m(a, position));
        let inherited = || step.start.and_then(|s| s.altitude_amsl_m);
        Some(Point { position, altitude_amsl_m: own.or_else(inherited) })
    }

    fn speed_mps(&self, context: &LegContext) -> f64 {
        let own = std::iter::once(context.leg)
            .chain(context.loops.iter().rev().copied())
            .find_map(|l| l.speed_mps.as_ref());
        let value = own.or(context.stage.speed_mps.as_ref()).and_then(|v| self.number(v));
        value.filter(|v| *v > 0.0).unwrap_or(self.profile.cruise_airspeed_mps)
    }
}

/// The altitude that is written for a leg: its own, else that of the loops around it, else the stage's.
pub(super) fn altitude_of<'a>(context: &LegContext<'a>) -> Option<&'a Altitude> {
    let around = std::iter::once(context.leg).chain(context.loops.iter().rev().copied());
    let stage = context.stage.altitude.as_ref().filter(|_| context.stage.kind != StageKind::TakeOff);
    around.into_iter().find_map(|l| l.altitude.as_ref()).or(stage)
}

/// How the path gets to the next leg.
#[derive(Debug, Clone, Copy, Default)]
struct Arrival {
    point: Option<Point>,
    step: Option<usize>,
}

/// True if `leg` can follow the sibling before it in the document.
fn leads_to(previous: &Leg, leg: &Leg) -> bool {
    let names = |next: &Option<Id>| next.as_ref().is_none_or(|id| *id == leg.id);
    match &previous.kind {
        LegKind::Intersection { branches, .. } if !branches.is_empty() => {
            branches.iter().any(|b: &Branch| names(&b.next))
        }
        _ => names(&previous.next),
    }
}

fn path_of(leg: &Leg, from: LatLon, to: LatLon, recall: &mut Recall) -> Option<Path> {
    match &leg.kind {
        LegKind::Tf(_) => Some(recall.line(from, to)),
        LegKind::Rf { centre, turn, .. } if centre.is_valid() => Some(Path::arc(from, to, *centre, *turn)),
        _ => None,
    }
}

fn compiled(plan: &FlightPlan) -> HashMap<Arc<str>, Result<Expression, ExpressionError>> {
    let names = Names::of(plan);
    let mut compiled: HashMap<Arc<str>, Result<Expression, ExpressionError>> = HashMap::new();
    let mut add = |source: &Arc<str>, _| {
        if compiled.len() < MOST_EXPRESSIONS {
            let compile = || expression::compile_with(source, &names);
            compiled.entry(source.clone()).or_insert_with(compile);
        }
    };
    plan.all_stages().for_each(|(_, stage)| stage.for_each_expression(&mut add));
    plan.all_legs().iter().for_each(|c| c.leg.for_each_expression(&mut add));
    compiled
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Beside the geodesic itself.
        #[test]
        fn positions_along_a_path_are_on_it(
            lat in -89.0..89.0, lon in -180.0..180.0, course in 0.0..360.0, length_m in 10.0..50_000.0, steps in 1..200_u32,
        ) {
            let start = LatLon::new(lat, lon);
            let end = start.destination(course, length_m);
            let path = Path::line(start, end);
            let along: Vec<_> = path.along(start, end, steps).collect();
            prop_assert_eq!(along.len(), steps as usize + 1);
            for (share, position) in along {
                // see `along`; a path that goes on beyond 85° from below: 1 km² · tan 85.5° / 8R
                prop_assert!(position.distance_m(path.at(start, share)) < 0.3);
            }
        }
    }
}
