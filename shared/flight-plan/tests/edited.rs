//! A plan that is being edited is checked and compiled where it changed, and comes out as if it had never been seen.
#![cfg(test)]

use aircraft::Profile;
use flight_plan::{
    Altitude, AltitudeReference, Edit, FlightPlan, Id, IncrementalCache, Leg, Problem, Program, Spot, Value,
    VariableValue, check, check_again, compile, compile_again, read,
};
use geometry::LatLon;
use proptest::collection::vec;
use proptest::prelude::*;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use terrain::{Flat, Terrain};

/// Plans with loops, procedures, jumps, variables and emergency plans, and some of what can be wrong.
fn plans() -> Vec<FlightPlan> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/plans");
    let names = [
        "fire-watch",
        "navaid-inspection",
        "alternates",
        "coast-patrol",
        "bad/endless-loop",
        "bad/no-value-in-bounds",
        "bad/rf-not-tangent",
        "bad/duplicate-argument",
    ];
    let plan = |name: &str| read(std::fs::read(folder.join(format!("{name}.xml"))).unwrap()).plan;
    names.into_iter().map(plan).chain([tracks(12), nested(), varied(), arriving()]).collect()
}

const AROUND: [&str; 2] = [
    r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="Tracks" aircraft="trainer"><fixes><fix id="A" lat="36.3" lon="-84.2"/></fixes><runways><runway id="R" lat="36.29" lon="-84.2" elevation="300" heading="0" length="600"/></runways><mainPlan emergency="home"><stage id="to" type="take-off" runway="R" altitude="100" altitudeReference="home"/><stage id="s" type="en-route" altitude="500" altitudeReference="amsl">"#,
    r#"</stage><stage id="l" type="land" runway="R"/></mainPlan><emergencyPlans><emergencyPlan id="home" runway="R"><stage id="h" type="arrival"><DF id="d" fix="A" altitude="450" altitudeReference="amsl"/></stage><stage id="hl" type="land" runway="R"/></emergencyPlan></emergencyPlans></flightPlan>"#,
];

/// Tracks of 1 km, to and fro.
fn tracks(legs: usize) -> FlightPlan {
    let track = |i: usize| {
        let (lat, lon) = (36.3 + 0.005 * (i / 2 % 40) as f64, -84.2 + 0.011 * (i.div_ceil(2) % 2) as f64);
        format!(r#"<TF id="leg-{i}" lat="{lat:.6}" lon="{lon:.6}"/>"#)
    };
    let legs: String = (0..legs).map(track).collect();
    read(format!("{}{legs}{}", AROUND[0], AROUND[1])).plan
}

/// A loop in a loop, a jump over one, and an intersection that leads back.
fn nested() -> FlightPlan {
    let legs = r#"<TF id="a" fix="A" next="out"/><iterative id="out" form="reverse" count="2" altitude="520" altitudeReference="amsl">
        <TF id="b" lat="36.31" lon="-84.2"/><iterative id="in" form="forward" count="3"><TF id="c" lat="36.31" lon="-84.19"/>
        <RF id="r" lat="36.32" lon="-84.18" centreLat="36.32" centreLon="-84.19" turn="left"/></iterative></iterative>
        <intersection id="i" default="on"><branch id="on"/><branch id="back" next="a"/></intersection><TF id="z" lat="36.33" lon="-84.2"/>"#;
    read(format!("{}{legs}{}", AROUND[0], AROUND[1])).plan
}

/// Legs whose altitude and speed are said around them, and an expression that names a fix.
fn varied() -> FlightPlan {
    let variables = r#"<variables><variable name="h" type="number" initial="500"/><variable name="v" type="number" initial="24"/></variables>"#;
    let legs = r#"<TF id="a" fix="A" altitude="= distance_to('A') > 2000.0 ? 520.0 : 510.0" altitudeReference="amsl"/><iterative id="i" form="forward" count="2" altitude="= h" altitudeReference="amsl">
        <TF id="b" lat="36.31" lon="-84.2"/><TF id="c" lat="36.31" lon="-84.19"/></iterative></stage>
        <stage id="t" type="en-route" altitude="500" altitudeReference="amsl" speed="= v"><TF id="d" lat="36.33" lon="-84.2"/><TF id="e" lat="36.32" lon="-84.2"/>"#;
    let around = AROUND.map(|text| text.replace("</runways>", &format!("</runways>{variables}")));
    read(format!("{}{legs}{}", around[0], around[1])).plan
}

/// Courses that are joined, places abeam of tracks, and ways that lead again to where the aircraft is.
fn arriving() -> FlightPlan {
    let legs = r#"<TF id="a" fix="A"/><TF id="b" lat="36.31" lon="-84.2"><action on="abeam" fix="A"><photo/></action></TF>
        <CF id="c" lat="36.33" lon="-84.18" course="70"/><DF id="d" lat="36.34" lon="-84.16"/><CF id="e" lat="36.35" lon="-84.15" course="0"/>
        <HF id="h" fix="A" course="0" turn="left" length="500"/><CF id="f" lat="36.32" lon="-84.19" course="40"/>
        <iterative id="l" form="forward" count="2"><TF id="k" lat="36.31" lon="-84.19"><action on="abeam" lat="36.3" lon="-84.1"><photo/></action></TF></iterative>
        <TF id="y" lat="36.32" lon="-84.2"/><intersection id="i" default="on"><branch id="on"/><branch id="back" next="y"/></intersection><TF id="z" lat="36.33" lon="-84.2"/>"#;
    read(format!("{}{legs}{}", AROUND[0], AROUND[1])).plan
}

/// What a random edit is made of: which kind, and numbers to choose with.
type Choice = (u8, usize, usize, f64, f64);

fn choice() -> impl Strategy<Value = Choice> {
    (0..21_u8, any::<usize>(), any::<usize>(), -0.02..0.02, -0.02..0.02)
}

/// One of some things, if there are any.
fn one<T: Clone>(of: &[T], number: usize) -> Option<T> {
    of.get(number % of.len().max(1)).cloned()
}

fn edit(plan: &FlightPlan, (kind, a, b, north, east): Choice) -> Option<Edit> {
    let legs: Vec<Leg> = plan.all_legs().iter().map(|c| c.leg.clone()).collect();
    let stages: Vec<Id> = plan.all_stages().map(|(_, s)| s.id.clone()).collect();
    let (leg, other) = (one(&legs, a)?, one(&legs, b)?);
    let to = LatLon::new(36.31 + north, -84.19 + east);
    let metres = (north * 1e5).round();
    let amsl = |metres| Altitude { metres: Value::Constant(metres), reference: AltitudeReference::Amsl };
    let changed = |change: &dyn Fn(&mut Leg)| {
        let mut with = Box::new(leg.clone());
        change(&mut with);
        Edit::ReplaceLeg { leg: leg.id.clone(), with }
    };
    Some(match kind {
        0..4 => Edit::MoveWaypoint { leg: leg.id, to },
        4 => Edit::DeleteLeg { leg: leg.id },
        5 => Edit::MoveLeg { leg: leg.id, at: Spot::Before(other.id) },
        6 => Edit::PasteLeg { leg: Box::new(leg), at: Spot::After(other.id) },
        // with the identifier that it has
        7 => Edit::InsertLeg { leg: Box::new(leg), at: Spot::After(other.id) },
        8 => Edit::SetAltitude { of: leg.id, altitude: (a % 2 == 0).then(|| amsl(500.0 + metres)) },
        9 => Edit::SetAltitude { of: one(&stages, b)?, altitude: (a % 2 == 0).then(|| amsl(500.0 + metres)) },
        10 => Edit::SetSpeed { of: leg.id, speed_mps: Some(Value::Constant(25.0 + metres / 100.0)) },
        11 => Edit::SetFlyOver { leg: leg.id, fly_over: a % 2 == 0 },
        12 => changed(&|leg| leg.next = Some(other.id.clone())),
        13 => changed(&|leg| leg.speed_mps = Some(Value::Expression(format!("20.0 + {metres}").into()))),
        14 => Edit::MoveFix { fix: one(&plan.fixes, b)?.id, to },
        15 => Edit::MoveStage { stage: one(&stages, a)?, before: one(&stages, b)? },
        16 => Edit::Remove { id: one(&stages, a)? },
        17 => changed(&|leg| leg.id = other.id.clone()),
        18 => Edit::SetEmergency { of: (a % 2 == 0).then_some(leg.id), cause: None, plan: None },
        19 => Edit::MoveThing { id: one(&plan.fixes, a)?.id, before: one(&plan.fixes, b).map(|fix| fix.id) },
        _ => Edit::Rename { id: leg.id, name: format!("{metres}") },
    })
}

/// A variable begins with another value of its type.
fn begin_otherwise(plan: &FlightPlan, (_, a, _, north, east): Choice) -> Option<FlightPlan> {
    let mut plan = plan.clone();
    let number = a % plan.variables.len().max(1);
    let initial = &mut plan.variables.get_mut(number)?.initial;
    match initial {
        VariableValue::Bool(b) => *b = !*b,
        VariableValue::Number(x) => *x += 1e4 * north,
        VariableValue::Text(text) => text.push('x'),
        VariableValue::Position(p) => *p = LatLon::new(36.31 + north, -84.19 + east),
        VariableValue::Polygon(corners) => corners.iter_mut().for_each(|p| p.lat_deg += north),
    }
    Some(plan)
}

/// The program as anybody can see it.
fn seen(program: &Program) -> impl PartialEq + std::fmt::Debug + use<> {
    let flown = program.flown();
    let mut expressions = Vec::new();
    let legs = flown.all_legs();
    legs.iter()
        .for_each(|c| c.leg.for_each_expression(&mut |source, _| expressions.push(source.to_string())));
    let compiled = expressions.iter().map(|source| program.expression(source).is_ok()).collect::<Vec<_>>();
    let ids = legs.iter().map(|c| &c.leg.id).chain(flown.all_stages().map(|(_, s)| &s.id));
    let ids = ids.chain(flown.fixes.iter().map(|f| &f.id));
    let paths: Vec<_> = ids.map(|id| program.path(id)).collect();
    (flown.clone(), program.hash().clone(), program.warnings.clone(), paths, compiled)
}

fn expect_the_same(
    plan: &Arc<FlightPlan>,
    ground: &dyn Terrain,
    memories: &mut [IncrementalCache; 2],
) -> Result<(), TestCaseError> {
    let profile = Profile::default();
    let [checks, compiles] = memories;
    let fresh: Vec<Problem> = check(plan, &profile, ground);
    prop_assert_eq!(check_again(plan, checks), fresh);
    match (compile_again(plan.clone(), compiles), compile(plan.clone(), &profile, ground)) {
        (Ok(again), Ok(fresh)) => prop_assert_eq!(seen(&again), seen(&fresh)),
        (Err(again), Err(fresh)) => prop_assert_eq!(again, fresh),
        (again, _) => prop_assert!(false, "one is refused: {again:?}"),
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Whatever was edited, fixed as proposed, or undone.
    #[test]
    fn an_edited_plan_is_checked_and_compiled_as_if_it_were_new(
        base in 0..12_usize, edits in vec((choice(), 0..9_u8), 1..8),
    ) {
        let ground: Arc<dyn Terrain> = Arc::new(Flat(300.0));
        let mut memories = [(); 2].map(|()| IncrementalCache::new(Profile::default(), ground.clone()));
        let mut history = vec![Arc::new(plans().swap_remove(base))];
        expect_the_same(&history[0], ground.as_ref(), &mut memories)?;
        for (choice, how) in edits {
            let plan = history.last().unwrap().clone();
            let fix = || check(&plan, &Profile::default(), ground.as_ref()).into_iter().find_map(|p| p.fix);
            let edited = match how {
                0 => history.first().cloned(),
                1 => fix().and_then(|fix| fix.apply(&plan).ok()).map(Arc::new),
                2 => begin_otherwise(&plan, choice).map(Arc::new),
                _ => edit(&plan, choice).and_then(|edit| edit.apply(&plan).ok()).map(Arc::new),
            };
            history.extend(edited);
            expect_the_same(history.last().unwrap(), ground.as_ref(), &mut memories)?;
        }
    }
}

/// Ground that counts who looks at it.
struct Counting(AtomicUsize);

impl Terrain for Counting {
    fn elevation_m(&self, _: LatLon) -> Option<f64> {
        self.0.fetch_add(1, Ordering::Relaxed);
        Some(300.0)
    }
}

#[test]
fn an_edit_of_one_leg_costs_what_a_few_legs_cost() {
    let ground = Arc::new(Counting(AtomicUsize::new(0)));
    let mut memory = IncrementalCache::new(Profile::default(), ground.clone());
    let mut samples = |plan: &FlightPlan| {
        ground.0.store(0, Ordering::Relaxed);
        check_again(plan, &mut memory);
        ground.0.load(Ordering::Relaxed)
    };
    let few = samples(&tracks(6));
    let plan = tracks(600);
    assert!(samples(&plan) > 50 * few);
    assert_eq!(samples(&plan), 0, "nothing has changed");
    let edits = [
        Edit::MoveWaypoint { leg: "leg-300".into(), to: LatLon::new(36.451, -84.199) },
        Edit::DeleteLeg { leg: "leg-300".into() },
        Edit::MoveFix { fix: "A".into(), to: LatLon::new(36.451, -84.199) },
        Edit::SetSpeed { of: "leg-300".into(), speed_mps: Some(Value::Constant(22.0)) },
        Edit::PasteLeg {
            leg: Box::new(plan.leg(&"leg-296".into()).unwrap().leg.clone()),
            at: Spot::After("leg-300".into()),
        },
    ];
    for edit in edits {
        let edited = edit.apply(&plan).unwrap();
        let taken = samples(&edited);
        assert!(
            0 < taken && taken < 2 * few,
            "{edit:?}: {taken} samples of the ground, a plan of six legs takes {few}"
        );
        samples(&plan);
    }
}

#[test]
fn an_edit_copies_what_it_changes() {
    let plan = nested();
    let edited = Edit::MoveWaypoint { leg: "c".into(), to: LatLon::new(36.4, -84.2) }.apply(&plan).unwrap();
    let own: Vec<String> = plan
        .all_legs()
        .iter()
        .zip(edited.all_legs())
        .filter(|(old, new)| !std::ptr::eq(old.leg, new.leg))
        .map(|(old, _)| old.leg.id.to_string())
        .collect();
    assert_eq!(own, ["out", "in", "c"], "the leg, and the loops around it");
}
