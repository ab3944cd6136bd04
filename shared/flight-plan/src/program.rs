//! A checked plan, ready for the executor.
//!
//! [`Program::plan`] is the plan as written, and its hash the identity; [`Program::flown`] is what the executor flies. The hash is
//! computed on request, because an edit rarely needs it.

use crate::checks::{Checked, Expressions, IncrementalCache, checked, checked_again};
use crate::expression::{Env, EvalError, Expression};
use crate::ids::Ids;
use crate::{
    Cause, EmergencyChoice, EmergencyPlan, Fix, FlightPlan, Id, Leg, LegContext, Place, Places, Problem,
    Reading, Stage, Value, xml,
};
use aircraft::Profile;
use geometry::LatLon;
use std::sync::{Arc, OnceLock};
use terrain::Terrain;

/// A plan without errors, its expressions compiled and its lookups resolved; immutable. The default, without a stage, is no
/// plan at all.
#[derive(Debug, Default)]
pub struct Program {
    /// The plan it was made from, as it was written: with its calls.
    pub plan: Arc<FlightPlan>,
    /// The same with its calls instantiated; `None`: it has no calls.
    flown: Option<FlightPlan>,
    hash: OnceLock<Arc<str>>,
    forks: OnceLock<bool>,
    /// What the checks said that does not forbid flying.
    pub warnings: Vec<Problem>,
    ids: Arc<Ids>,
    expressions: Arc<Expressions>,
}

impl PartialEq for Program {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.plan, &other.plan) || self.hash() == other.hash()
    }
}

/// Where a leg or a stage is in the document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LegPath {
    /// `None`: main plan, else the index of the emergency plan.
    pub emergency_plan: Option<usize>,
    /// Index of the stage in its plan.
    pub stage: usize,
    /// Index in each nested list, outermost first; the last one is the leg's own. Empty for a stage.
    pub indices: Vec<usize>,
}

/// Checks a plan and compiles it.
///
/// # Errors
/// Every problem of the plan, if one of them forbids flying.
pub fn compile(
    plan: impl Into<Arc<FlightPlan>>,
    profile: &Profile,
    terrain: &dyn Terrain,
) -> Result<Program, Vec<Problem>> {
    let plan = plan.into();
    let checked = checked(&plan, profile, terrain);
    Program::of(plan, checked)
}

/// As [`compile`], for a plan that is compiled again and again while it is edited (see [`crate::checks::check_again`]).
///
/// # Errors
/// As [`compile`].
pub fn compile_again(
    plan: impl Into<Arc<FlightPlan>>,
    memory: &mut IncrementalCache,
) -> Result<Program, Vec<Problem>> {
    let plan = plan.into();
    let checked = checked_again(&plan, memory);
    Program::of(plan, checked)
}

/// Reads, checks and compiles a document.
///
/// # Errors
/// Every problem of the document, with its place, if one of them forbids flying.
pub fn compile_document(
    document: &[u8],
    profile: &Profile,
    terrain: &dyn Terrain,
) -> Result<Program, Vec<Problem>> {
    compile_reading(xml::read(document), profile, terrain).map(|(program, _)| program)
}

/// Checks and compiles a document that has been read; gives the places of its parts for problems to come.
///
/// # Errors
/// As [`compile_document`].
pub fn compile_reading(
    reading: Reading,
    profile: &Profile,
    terrain: &dyn Terrain,
) -> Result<(Program, Places), Vec<Problem>> {
    if reading.has_errors() {
        return Err(reading.problems);
    }
    let places = reading.places;
    let mut program = compile(reading.plan, profile, terrain).map_err(|mut problems| {
        places.locate(&mut problems);
        problems
    })?;
    places.locate(&mut program.warnings);
    program.warnings.splice(0..0, reading.problems);
    Ok((program, places))
}

impl Program {
    fn of(plan: Arc<FlightPlan>, checked: Checked) -> Result<Self, Vec<Problem>> {
        let Checked { flown, problems, expressions, ids } = checked;
        if problems.iter().any(Problem::is_error) {
            return Err(problems);
        }
        let (hash, forks) = (OnceLock::new(), OnceLock::new());
        Ok(Self { plan, flown, hash, forks, warnings: problems, ids, expressions })
    }

    /// Hex SHA-256 of the plan's canonical XML: its identity. Computed when it is first asked for, because a plan that is being
    /// edited needs none.
    pub fn hash(&self) -> &Arc<str> {
        self.hash.get_or_init(|| xml::hash(&self.plan).into())
    }

    /// There is an intersection with several branches somewhere.
    pub fn has_forks(&self) -> bool {
        let forks = |leg: &Leg| leg.as_fork().is_some_and(|fork| fork.branches.len() > 1);
        *self.forks.get_or_init(|| self.flown().all_legs().iter().any(|context| forks(context.leg)))
    }

    /// The plan that is flown: its calls are expanded to legs (see [`crate::procedure`]).
    pub fn flown(&self) -> &FlightPlan {
        self.flown.as_ref().unwrap_or(&self.plan)
    }

    /// Where a leg (or a stage) is.
    pub fn path(&self, id: &Id) -> Option<LegPath> {
        self.ids.path(id)
    }

    /// The stages of the main plan (`None`) or of an emergency plan (its index).
    pub fn stages(&self, emergency_plan: Option<usize>) -> &[Stage] {
        match emergency_plan {
            None => &self.flown().stages,
            Some(index) => self.flown().emergency_plans.get(index).map_or(&[], |e| &e.stages),
        }
    }

    /// The stage on a path.
    pub fn stage(&self, path: &LegPath) -> Option<&Stage> {
        self.stages(path.emergency_plan).get(path.stage)
    }

    /// The list that contains the leg of a path (of a stage: its legs).
    pub fn list(&self, path: &LegPath) -> Option<&[Arc<Leg>]> {
        let mut list = self.stage(path)?.legs.as_slice();
        let outer = path.indices.split_last().map_or(&[][..], |(_, outer)| outer);
        for index in outer {
            list = list.get(*index)?.body();
        }
        Some(list)
    }

    /// The legs from the outermost loop down to the leg itself; empty for a stage.
    pub fn chain(&self, path: &LegPath) -> Vec<&Leg> {
        let mut list = self.stage(path).map_or(&[][..], |s| &s.legs);
        let mut chain: Vec<&Leg> = Vec::with_capacity(path.indices.len());
        for index in &path.indices {
            let Some(leg) = list.get(*index) else { break };
            chain.push(leg);
            list = leg.body();
        }
        chain
    }

    /// A leg by its identifier.
    pub fn leg(&self, id: &Id) -> Option<&Leg> {
        self.chain(&self.path(id)?).last().copied()
    }

    /// A leg of the plan as it is written, with what is around it; none that only a call makes. Quick in any plan: it is found by
    /// its place.
    pub fn written(&self, id: &Id) -> Option<LegContext<'_>> {
        // a call is replaced where it stands, so what is written has its place in both
        self.plan.leg_at(&self.path(id)?).filter(|context| context.leg.id == *id)
    }

    /// The emergency plan of a leg (or stage) for a cause.
    ///
    /// The most specific association wins: the leg's own, the enclosing loops' from the inside out, the stage's, the
    /// document's. At each of these levels the entry for the cause comes before the level's fallback; and a
    /// level's fallback comes before any entry farther out, because an author who wrote it there without a
    /// cause meant every cause. Legs of emergency plans end at the document's association as well; the executor
    /// sees to it that an emergency does not nest.
    pub fn emergency_for(&self, id: &Id, cause: Cause) -> Option<&EmergencyPlan> {
        self.flown().emergency_plan(self.emergency_choice(id, cause)?.plan_for(cause)?)
    }

    /// The emergency plan for a cause on a leg (or stage): see [`Program::emergency_for`].
    pub fn emergency_choice(&self, id: &Id, cause: Cause) -> Option<&EmergencyChoice> {
        let path = self.path(id)?;
        let chain = self.chain(&path);
        let levels = chain.iter().rev().map(|leg| &leg.emergency);
        let mut levels = levels.chain(self.stage(&path).map(|s| &s.emergency)).chain([&self.plan.emergency]);
        levels.find(|level| level.plan_for(cause).is_some())
    }

    /// A number: a constant as it is, an expression evaluated.
    ///
    /// # Errors
    /// The expression has no finite value now.
    pub fn eval_number(&self, value: &Value<f64>, env: &Env) -> Result<f64, EvalError> {
        match value {
            Value::Constant(x) => Ok(*x),
            Value::Expression(source) => self.expression(source)?.number(env),
        }
    }

    /// A condition.
    ///
    /// # Errors
    /// It can't be evaluated now.
    pub fn eval_bool(&self, source: &str, env: &Env) -> Result<bool, EvalError> {
        self.expression(source)?.bool(env)
    }

    /// A position: a constant as it is, an expression evaluated.
    ///
    /// # Errors
    /// The expression has no valid value now.
    pub fn eval_position(&self, value: &Value<LatLon>, env: &Env) -> Result<LatLon, EvalError> {
        match value {
            Value::Constant(p) => Ok(*p),
            Value::Expression(source) => self.expression(source)?.position(env),
        }
    }

    fn fix(&self, id: &Id) -> Option<&Fix> {
        self.plan.fixes.get(self.ids.fix(id)?)
    }

    /// Where a place is now.
    ///
    /// # Errors
    /// Its expression has no valid value now.
    pub fn eval_place(&self, place: &Place, env: &Env) -> Result<LatLon, EvalError> {
        match place {
            Place::Fix(id) => {
                Ok(self.fix(id).ok_or_else(|| EvalError::NotCompiled(id.to_string()))?.position)
            }
            Place::Position(value) => self.eval_position(value, env),
        }
    }

    /// A compiled expression by its source (what variables it reads, its type).
    ///
    /// # Errors
    /// The plan has no such expression.
    pub fn expression(&self, source: &str) -> Result<&Expression, EvalError> {
        let compiled = self.expressions.get(source).and_then(|compiled| compiled.as_ref().ok());
        compiled.ok_or_else(|| EvalError::NotCompiled(source.into()))
    }

    /// True if a leg's geometry, altitude or speed reads this variable (not the legs inside it).
    pub fn leg_reads(&self, leg: &Leg, variable: &Id) -> bool {
        let mut reads = false;
        leg.for_each_expression(&mut |source, _| {
            reads |= self.expression(source).is_ok_and(|e| e.variables.contains(variable));
        });
        reads
    }
}

impl EmergencyChoice {
    /// The plan this level names for a cause: the cause's own entry, else its fallback.
    pub fn plan_for(&self, cause: Cause) -> Option<&Id> {
        let of = |wanted| self.by_cause.iter().find(|(c, _)| *c == wanted).map(|(_, plan)| plan);
        of(Some(cause)).or_else(|| of(None))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FlightState, Variables};
    use terrain::Flat;

    const FIRE_WATCH: &str = include_str!("../../../assets/plans/fire-watch.xml");

    fn program() -> Program {
        compile_document(FIRE_WATCH.as_bytes(), &Profile::default(), &Flat(300.0)).unwrap()
    }

    #[test]
    fn every_leg_and_stage_is_found_on_its_path() {
        let program = program();
        for context in program.plan.all_legs() {
            let path = program.path(&context.leg.id).unwrap();
            assert_eq!(program.leg(&context.leg.id), Some(context.leg));
            assert_eq!(program.written(&context.leg.id).as_ref(), Some(&context));
            assert_eq!(program.plan.leg(&context.leg.id).as_ref(), Some(&context));
            assert_eq!(program.stage(&path), Some(context.stage));
            assert_eq!(program.list(&path), Some(context.siblings));
            let around: Vec<_> = context.loops.iter().copied().chain([context.leg]).collect();
            assert_eq!(program.chain(&path), around);
        }
        let stage = program.path(&"watch".into()).unwrap();
        assert_eq!((stage.stage, stage.indices.len(), program.chain(&stage).len()), (3, 0, 0));
        assert_eq!(program.leg(&"watch".into()), None);
        assert!(program.written(&"watch".into()).is_none() && program.plan.leg(&"watch".into()).is_none());
    }

    /// Leg, stage, plan; at each of them the cause before the fallback.
    #[test]
    fn the_most_specific_emergency_plan_wins() {
        let program = program();
        let cases = [
            ("o1", Cause::Engine, "return"),           // the document's
            ("sweep", Cause::Operator, "north-strip"), // the stage's fallback
            ("sweep", Cause::Engine, "return"),        // the stage's for this cause
            ("watch", Cause::Link, "north-strip"),     // a stage by itself
            ("look", Cause::Link, "return"),           // the leg's
            ("p2", Cause::Gps, "north-strip"),         // a nested leg inherits
        ];
        for (leg, cause, expected) in cases {
            let found = program.emergency_for(&leg.into(), cause).map(|e| e.id.as_str());
            assert_eq!(found, Some(expected), "{leg} {cause:?}");
        }
        assert_eq!(program.emergency_for(&"gone".into(), Cause::Link), None);
    }

    #[test]
    fn a_fallback_near_beats_a_cause_far_away() {
        let document = FIRE_WATCH.replace(r#"id="sweep""#, r#"id="sweep" emergency="north-strip""#);
        let program = compile_document(document.as_bytes(), &Profile::default(), &Flat(300.0)).unwrap();
        let found = program.emergency_for(&"sweep".into(), Cause::Engine).map(|e| e.id.as_str());
        assert_eq!(found, Some("north-strip"), "the stage names `return` for the engine");
    }

    #[test]
    fn values_follow_the_variables() {
        let program = program();
        let mut variables = Variables::initial(&program.plan);
        let radius = Value::Expression("fire_radius + 150.0".into());
        let flight = FlightState::on_ground(LatLon::new(36.3, -84.2));
        let value = |variables: &Variables| program.eval_number(&radius, &Env { variables, flight });
        assert_eq!(value(&variables), Ok(500.0));
        variables.set(&program.plan, &"fire_radius".into(), crate::VariableValue::Number(450.0)).unwrap();
        assert_eq!(value(&variables), Ok(600.0));
        let env = Env { variables: &variables, flight };
        assert_eq!(program.eval_bool("fire_out || battery < 0.35", &env), Ok(false));
        assert_eq!(program.eval_place(&Place::Fix("GAP".into()), &env), Ok(LatLon::new(36.285, -84.215)));
        assert!(program.eval_bool("no such expression", &env).is_err());
        let sweep = program.leg(&"sweep".into()).unwrap();
        assert!(
            program.leg_reads(sweep, &"fire_radius".into()) && !program.leg_reads(sweep, &"fire_out".into())
        );
    }

    #[test]
    fn problems_of_a_refused_document_have_places() {
        let document = FIRE_WATCH.replace("fire_radius + 150.0", "fire_radios + 150.0");
        let problems = compile_document(document.as_bytes(), &Profile::default(), &Flat(300.0)).unwrap_err();
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert_eq!((problems[0].code, problems[0].location.is_some()), ("unknown-name", true));
    }
}
