//! What the rules read: the plan's legs with their geometry at the variables' initial values.

use super::incremental_cache::Recall;
use super::step::{Marks, Point, Step};
use super::trace::Trace;
use crate::expression::{self, Expression, ExpressionError, Names};
use crate::ids::Ids;
use crate::{
    Altitude, AltitudeReference, Env, FlightPlan, FlightState, Id, Leg, LegKind, Place, Runway, Stage, Use,
    Value, VariableValue, Variables,
};
use aircraft::Profile;
use foldhash::{HashMap, HashSet};
use geometry::LatLon;
use std::sync::Arc;
use terrain::Terrain;

/// Most different expressions of a plan: compiling one takes some 50 µs.
const MAX_EXPRESSIONS: usize = 10_000;

/// Expressions by their source, and what became of them.
pub(crate) type Expressions = HashMap<Arc<str>, Result<Expression, ExpressionError>>;

/// A plan under inspection.
pub(super) struct Inspection<'a> {
    pub plan: &'a FlightPlan,
    pub profile: &'a Profile,
    pub terrain: &'a dyn Terrain,
    /// The plan's fixes.
    pub fixes: HashMap<&'a Id, LatLon>,
    /// The plan's runways.
    pub runways: HashMap<&'a Id, &'a Runway>,
    /// Identifiers of its emergency plans.
    pub emergency_plans: HashSet<&'a Id>,
    /// Where everything is that has an identifier.
    pub ids: Arc<Ids>,
    /// Every leg in document order.
    steps: Vec<Step>,
    /// Lists of legs in which one names its successor.
    pub lists: Vec<&'a [Arc<Leg>]>,
    variables: Variables,
    /// For expressions that are compiled now.
    names: Option<Names<'a>>,
    expressions: Arc<Expressions>,
    home: Option<&'a Runway>,
}

impl<'a> Inspection<'a> {
    /// Of a plan, and what there is to be remembered of an earlier one.
    pub fn new(
        plan: &'a FlightPlan,
        profile: &'a Profile,
        terrain: &'a dyn Terrain,
        recall: &mut Recall,
    ) -> Self {
        let mut inspection = Self {
            plan,
            profile,
            terrain,
            fixes: plan.fixes.iter().map(|f| (&f.id, f.position)).collect(),
            runways: plan.runways.iter().map(|r| (&r.id, r)).collect(),
            emergency_plans: plan.emergency_plans.iter().map(|e| &e.id).collect(),
            ids: Arc::default(),
            steps: Vec::new(),
            lists: Vec::new(),
            variables: Variables::initial(plan),
            names: None,
            expressions: recall.expressions.clone(),
            home: plan.home(),
        };
        plan.all_stages().for_each(|(_, stage)| {
            stage.for_each_expression(&mut |source, _| inspection.compile(source));
        });
        let Trace { steps, lists, spots, .. } = Trace::of(&mut inspection, recall);
        let legs: Vec<&Id> = steps.iter().map(|step| &step.leg.id).collect();
        inspection.ids = Ids::of(plan, &legs, spots, &recall.ids, |leg| recall.was(leg));
        (inspection.steps, inspection.lists) = (steps, lists);
        inspection
    }

    /// What is kept for the next check.
    pub fn into_parts(self) -> (Vec<Step>, Arc<Expressions>, Arc<Ids>) {
        (self.steps, self.expressions, self.ids)
    }

    /// The plan's expressions.
    pub fn expressions(&self) -> &Arc<Expressions> {
        &self.expressions
    }

    /// There were more expressions than are compiled.
    pub fn is_full(&self) -> bool {
        self.expressions.len() >= MAX_EXPRESSIONS
    }

    /// Every leg in document order. A rule about one leg reads its step, the two before it and the one after it.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Keeps what the rules about one leg said.
    pub fn keep(&mut self, step: usize, found: Vec<(usize, crate::Problem)>) {
        if let Some(step) = self.steps.get_mut(step) {
            step.found = found;
        }
    }

    /// The step before.
    pub fn before(&self, step: &Step) -> Option<&Step> {
        self.steps.get(step.before?)
    }

    /// The path after a step, if it has a direction.
    pub fn after(&self, step: &Step) -> Option<&Step> {
        self.steps.get(step.after?)
    }

    fn compile(&mut self, source: &Arc<str>) {
        if !self.is_full() && !self.expressions.contains_key(source) {
            let names = self.names.get_or_insert_with(|| Names::of(self.plan));
            let compiled = expression::compile_with(source, names);
            Arc::make_mut(&mut self.expressions).insert(source.clone(), compiled);
        }
    }

    /// Records what a leg has.
    pub fn marks(&mut self, leg: &Leg) -> Marks {
        let mut marks = Marks { jumps: leg.jumps(), ..Marks::default() };
        leg.for_each_expression(&mut |source, _| {
            marks.expressions = true;
            self.compile(source);
        });
        marks.strangers = super::references::has_strangers(self, leg);
        marks
    }

    /// An expression that compiles.
    fn expression(&self, source: &str) -> Option<&Expression> {
        self.compiled(source)?.as_ref().ok()
    }

    /// The result of compiling an expression; `None`: the plan has too many expressions.
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

    /// A value at the start, of any type.
    pub fn value(&self, source: &str) -> Option<VariableValue> {
        self.expression(source)?.value(&self.env()).ok()
    }

    fn env(&self) -> Env<'_> {
        Env { variables: &self.variables, flight: FlightState::at_start(self.home()) }
    }

    /// A number at the start, if it has a finite value then.
    pub fn number(&self, value: &Value<f64>) -> Option<f64> {
        match value {
            Value::Constant(x) => Some(*x).filter(|x| x.is_finite()),
            Value::Expression(source) => self.expression(source)?.number(&self.env()).ok(),
        }
    }

    /// A position at the start, if it is one that can be flown to then.
    pub fn position(&self, value: &Value<LatLon>) -> Option<LatLon> {
        self.anywhere(value).filter(|p| p.is_navigable())
    }

    /// A position at the start, if it is valid then, also near a pole.
    pub fn anywhere(&self, value: &Value<LatLon>) -> Option<LatLon> {
        match value {
            Value::Constant(p) => Some(*p).filter(|p| p.is_valid()),
            Value::Expression(source) => self.expression(source)?.position(&self.env()).ok(),
        }
    }

    /// Where a place is at the start.
    pub fn place(&self, place: &Place) -> Option<LatLon> {
        match place {
            Place::Fix(id) => self.fixes.get(id).copied().filter(|p| p.is_navigable()),
            Place::Position(value) => self.position(value),
        }
    }

    /// What `home` altitudes count from in what is flown in any flight of the plan, metres AMSL; `None`: that differs from flight to
    /// flight, or nobody takes off.
    pub fn common_home_m(&self) -> Option<f64> {
        self.plan.common_home().map(|runway| runway.elevation_amsl_m)
    }

    /// What they count from at a stage of the main plan, metres AMSL.
    pub fn home_at_m(&self, stage: usize) -> Option<f64> {
        self.plan.home_at(stage).map(|runway| runway.elevation_amsl_m)
    }

    /// An altitude above a position, metres AMSL; `home_m`: what `home` is there.
    pub fn altitude_amsl_m(&self, altitude: &Altitude, at: LatLon, home_m: Option<f64>) -> Option<f64> {
        let datum_m = match altitude.reference {
            AltitudeReference::Amsl => 0.0,
            AltitudeReference::Agl => self.terrain.elevation_m(at)?,
            AltitudeReference::Home => home_m?,
        };
        Some(self.number(&altitude.metres)? + datum_m)
    }

    /// The aircraft's planning turn radius, metres.
    pub fn turn_radius_m(&self, speed_mps: f64) -> f64 {
        self.profile.turn_radius_m(speed_mps)
    }

    /// Where a take-off ends: straight on from the runway's end, at the best climb.
    pub fn climb_out(&self, stage: &Stage) -> Option<Point> {
        let runway = self.runways.get(stage.runway.as_ref()?).filter(|r| r.threshold.is_navigable())?;
        let height_m = self.climb_out_height_m(stage)?;
        let climb_s = height_m.max(0.0) / self.profile.max_climb_mps.max(0.1);
        let way_m = runway.length_m + climb_s * self.profile.cruise_airspeed_mps;
        if !way_m.is_finite() || !runway.heading_deg.is_finite() {
            return None;
        }
        let position = runway.threshold.destination(runway.heading_deg, way_m);
        Some(Point { position, altitude_amsl_m: Some(runway.elevation_amsl_m + height_m) })
    }

    /// How high above its runway a take-off ends, metres.
    pub fn climb_out_height_m(&self, stage: &Stage) -> Option<f64> {
        let (runway, altitude) = (self.runways.get(stage.runway.as_ref()?)?, stage.altitude.as_ref()?);
        let metres = self.number(&altitude.metres)?;
        Some(match altitude.reference {
            AltitudeReference::Amsl => metres - runway.elevation_amsl_m,
            AltitudeReference::Agl | AltitudeReference::Home => metres,
        })
    }

    pub fn end_of(&self, step: &Step) -> Option<Point> {
        let position = match &step.leg.kind {
            LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, .. } | LegKind::Rf { to, .. } => {
                self.place(&to.place)
            }
            LegKind::Cf { to, .. } => self.place(&to.place),
            LegKind::Pattern(pattern) => super::extent::end_of(self, step, pattern),
            LegKind::Hf(h) | LegKind::Ha(h) | LegKind::Hm { holding: h, .. } => self.place(&h.fix.place),
            _ => None,
        }?;
        let own = step.altitude().and_then(|a| self.altitude_amsl_m(a, position, step.around.home_m));
        Some(Point { position, altitude_amsl_m: own.or_else(|| step.entry_altitude_amsl_m()) })
    }
}
