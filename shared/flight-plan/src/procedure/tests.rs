//! What calls become, and which are refused.

use super::*;
use crate::{Place, compile_document, read};
use aircraft::Profile;
use geometry::LatLon;
use geometry::geodesy::normalise_180;
use proptest::prelude::*;
use terrain::Flat;

fn document(procedures: &str, legs: &str) -> String {
    format!(
        r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="Test" aircraft="trainer">
             <fixes><fix id="A" lat="36.3" lon="-84.20"/> <fix id="B" lat="36.3" lon="-84.15"/></fixes>
             <variables>
               <variable name="where" type="position" initial="36.4 -84.2"/> <variable name="way" type="number" initial="90"/>
               <variable name="size" type="number" initial="300"/>
             </variables>
             <procedures>{procedures}</procedures>
             <mainPlan><stage id="s" type="mission" altitude="500" altitudeReference="amsl"><IF id="i" fix="A"/>{legs}</stage></mainPlan>
           </flightPlan>"#
    )
}

fn flown(procedures: &str, legs: &str) -> (FlightPlan, Vec<Problem>) {
    let reading = read(document(procedures, legs));
    assert_eq!(reading.problems, []);
    let (plan, problems) = instantiate(&reading.plan);
    (plan.into_owned(), problems)
}

/// The legs that a plan without problems flies.
fn legs(procedures: &str, calls: &str) -> FlightPlan {
    let (plan, problems) = flown(procedures, calls);
    assert_eq!(problems, []);
    plan
}

fn codes(procedures: &str, calls: &str) -> Vec<&'static str> {
    flown(procedures, calls).1.iter().map(|p| p.code).collect()
}

const GATE: &str = r#"<procedure id="gate" name="Gate" reference="36.0 -84.0">
      <parameter name="gap" default="= 50.0"/> <parameter name="fast"/>
      <TF id="in" lat="36.0" lon="-84.0" speed="= fast" next="fork"/>
      <intersection id="fork" default="left"><branch id="left" next="out" when="gap &gt; size"/></intersection>
      <CF id="out" lat="36.01" lon="-84.0" course="0"/>
    </procedure>"#;

const FAST: &str = r#"<argument name="fast" value="= size / 10.0"/>"#;

#[test]
fn a_call_becomes_a_loop_of_one_pass_with_its_own_properties() {
    let plan = legs(
        GATE,
        &format!(
            r#"<call id="c" name="There" procedure="gate" altitude="600" altitudeReference="agl" speed="20">
        <action on="start"><photo/></action>{FAST}</call>"#
        ),
    );
    let call = plan.leg(&"c".into()).unwrap().leg;
    assert_eq!((call.name.as_str(), call.actions.len(), call.speed_mps.is_some()), ("There", 1, true));
    let LegKind::Iterative {
        form: IterativeForm::Once,
        count: Some(Value::Constant(1.0)),
        until: None,
        body,
        ..
    } = &call.kind
    else {
        panic!("{call:?}")
    };
    let ids: Vec<&str> = body.iter().map(|l| l.id.as_str()).collect();
    assert_eq!(ids, ["c.in", "c.fork", "c.out"]);
    assert_eq!(body[0].next, Some("c.fork".into()));
    assert_eq!(body[0].speed_mps, Some(Value::Expression("size / 10.0".into())));
    let LegKind::Intersection { branches, default, .. } = &body[1].kind else { panic!() };
    assert_eq!((branches[0].next.clone(), default.clone()), (Some("c.out".into()), Some("left".into())));
    assert_eq!(branches[0].when.as_deref(), Some("50.0 > size"));
    // neither anchor nor bearing: where it was written
    let LegKind::Cf { to, course_deg } = &body[2].kind else { panic!() };
    assert_eq!(to.place, Place::Position(Value::Constant(LatLon::new(36.01, -84.0))));
    assert_eq!(*course_deg, Value::Constant(0.0));
}

fn position(plan: &FlightPlan, leg: &str) -> LatLon {
    match plan.leg(&leg.into()).unwrap().leg.place() {
        Some(Place::Position(Value::Constant(p))) => *p,
        other => panic!("{leg}: {other:?}"),
    }
}

fn course(plan: &FlightPlan, leg: &str) -> f64 {
    match &plan.leg(&leg.into()).unwrap().leg.kind {
        LegKind::Cf { course_deg: Value::Constant(course), .. } => *course,
        other => panic!("{leg}: {other:?}"),
    }
}

#[test]
fn anchor_and_bearing_move_and_turn_positions_and_courses() {
    let plan = legs(GATE, &format!(r#"<call id="c" procedure="gate" fix="B" bearing="90">{FAST}</call>"#));
    let fix = LatLon::new(36.3, -84.15);
    assert_eq!(position(&plan, "c.in"), fix);
    let way = fix.inverse(position(&plan, "c.out"));
    let written = LatLon::new(36.0, -84.0).distance_m(LatLon::new(36.01, -84.0));
    assert!(
        (way.distance_m - written).abs() < 1e-6 && (way.bearing_start_deg - 90.0).abs() < 1e-9,
        "{way:?}"
    );
    // still straight along the way from the anchor
    assert!((course(&plan, "c.out") - way.bearing_end_deg).abs() < 1e-9);
}

/// A procedure inside another goes with it, by itself or placed in it.
#[test]
fn calls_inside_procedures_move_with_them() {
    let outer = r#"<procedure id="two" reference="36.0 -84.0">
        <call id="here" procedure="gate"><argument name="fast" value="= 21.0"/></call>
        <call id="there" procedure="gate" lat="36.02" lon="-84.0" bearing="180"><argument name="fast" value="= 22.0"/></call>
      </procedure>"#;
    let plan = legs(
        &format!("{GATE}{outer}"),
        r#"<call id="c" procedure="two" lat="36.5" lon="-84.5" bearing="90"/>"#,
    );
    let anchor = LatLon::new(36.5, -84.5);
    assert_eq!(position(&plan, "c.here.in"), anchor);
    let (first, there) = (anchor.inverse(position(&plan, "c.here.out")), position(&plan, "c.there.in"));
    assert!(
        (first.bearing_start_deg - 90.0).abs() < 1e-6
            && (first.distance_m * 2.0 - anchor.distance_m(there)).abs() < 0.1
    );
    // turned back towards the first one's end
    assert!(position(&plan, "c.there.out").distance_m(position(&plan, "c.here.out")) < 0.1);
    assert!(normalise_180(course(&plan, "c.there.out") - 270.0).abs() < 0.05);
}

#[test]
fn expressions_as_anchor_and_bearing_become_offsets() {
    let plan =
        legs(GATE, &format!(r#"<call id="c" procedure="gate" at="= where" bearing="= way">{FAST}</call>"#));
    let place = |leg: &str| match plan.leg(&leg.into()).unwrap().leg.place() {
        Some(Place::Position(Value::Expression(source))) => source.to_string(),
        other => panic!("{other:?}"),
    };
    assert_eq!(place("c.in"), "where");
    assert!(place("c.out").starts_with("offset(where, double(way) - 0.0 + 0.0, 1109."), "{}", place("c.out"));
    let plan = legs(GATE, &format!(r#"<call id="c" procedure="gate" bearing="= way">{FAST}</call>"#));
    let LegKind::Cf { course_deg, .. } = &plan.leg(&"c.out".into()).unwrap().leg.kind else { panic!() };
    assert_eq!(*course_deg, Value::Expression("double(way) - 0.0 + 0.0".into()));
    let arc = r#"<procedure id="arc" reference="36.0 -84.0"><RF id="r" fix="B" centreLat="36" centreLon="-84.1" turn="left"/></procedure>"#;
    assert_eq!(codes(arc, r#"<call id="c" procedure="arc" at="= where"/>"#), ["procedure-anchor"]);
}

/// What the offsets give at the variables' values is where constants would have put it.
#[test]
fn an_expression_places_as_its_value_does() {
    let call = |at: &str| legs(GATE, &format!(r#"<call id="c" procedure="gate" {at}>{FAST}</call>"#));
    let (bound, fixed) =
        (call(r#"at="= where" bearing="= way""#), call(r#"lat="36.4" lon="-84.2" bearing="90""#));
    let Some(Place::Position(Value::Expression(source))) = bound.leg(&"c.out".into()).unwrap().leg.place()
    else {
        panic!()
    };
    let variables = crate::Variables::initial(&bound);
    let env =
        crate::Env { variables: &variables, flight: crate::FlightState::on_ground(LatLon::new(36.0, -84.0)) };
    let there = crate::expression::compile(source, &bound).unwrap().position(&env).unwrap();
    assert!(there.distance_m(position(&fixed, "c.out")) < 1e-6);
}

#[test]
fn what_can_not_be_called() {
    let gate = |inside: &str| format!(r#"<call id="c" procedure="gate">{inside}</call>"#);
    let cases: [(String, &[&str]); 10] = [
        (gate(FAST), &[]),
        (gate(""), &["missing-argument"]),
        (gate(&format!("{FAST}{FAST}")), &["duplicate-argument"]),
        (gate(&format!(r#"{FAST}<argument name="slow" value="= 1.0"/>"#)), &["unknown-argument"]),
        (gate(r#"<argument name="fast" value="= gone"/>"#), &["unknown-name"]),
        (gate(r#"<argument name="fast" value="= 1.0) + (1.0"/>"#), &["expression-syntax"]),
        (gate(&format!(r#"{FAST}<argument name="gap" value="= where"/>"#)), &["wrong-type"]),
        (gate(&format!(r#"{FAST}<argument name="gap" value="= 40"/>"#)), &[]),
        (r#"<call id="c" procedure="none"/>"#.into(), &["unknown-procedure"]),
        (r#"<call id="c" procedure="still" fix="B"/>"#.into(), &["procedure-anchor"]),
    ];
    let still = r#"<procedure id="still"><TF id="t" fix="A"/></procedure>"#;
    for (call, expected) in cases {
        let (plan, problems) = flown(&format!("{GATE}{still}"), &call);
        assert_eq!(problems.iter().map(|p| p.code).collect::<Vec<_>>(), expected, "{call}");
        let left = matches!(plan.leg(&"c".into()).unwrap().leg.kind, LegKind::Call(_));
        assert_eq!(left, !expected.is_empty(), "{call}");
        assert!(problems.iter().all(|p| p.subject == Some("c".into())));
    }
}

#[test]
fn procedures_that_call_themselves_are_refused_even_uncalled() {
    let procedure = |id: &str, calls: &str| {
        let calls = calls.split_whitespace().enumerate();
        let legs: String = calls.map(|(i, p)| format!(r#"<call id="{id}{i}" procedure="{p}"/>"#)).collect();
        format!(r#"<procedure id="{id}">{legs}<TF id="{id}t" fix="A"/></procedure>"#)
    };
    let subjects = |procedures: &[(&str, &str)], called: &str| -> Vec<String> {
        let procedures: String = procedures.iter().map(|(id, calls)| procedure(id, calls)).collect();
        let problems = flown(&procedures, &format!(r#"<call id="c" procedure="{called}"/>"#)).1;
        problems.iter().map(|p| format!("{} {}", p.code, p.subject.as_ref().unwrap())).collect()
    };
    let cycle = |ids: &[&str]| ids.iter().map(|id| format!("procedure-cycle {id}")).collect::<Vec<_>>();
    assert_eq!(subjects(&[("a", "a")], "a"), cycle(&["a"]));
    assert_eq!(subjects(&[("a", "b"), ("b", "c"), ("c", "b"), ("d", "")], "d"), cycle(&["b", "c"]));
    assert_eq!(subjects(&[("a", "b b"), ("b", "")], "a"), [""; 0]);
    assert_eq!(subjects(&[("a", "z")], "a"), ["unknown-procedure a0"]);
    let chain: Vec<(String, String)> =
        (0..=MAX_NESTING).map(|i| (format!("p{i}"), format!("p{}", i + 1))).collect();
    let mut chain: Vec<(&str, &str)> = chain.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    chain[MAX_NESTING].1 = "";
    assert_eq!(subjects(&chain, "p1"), ["too-deep p0"]);
}

#[test]
fn doubling_sixteen_times_is_no_bomb() {
    let procedure = |i: usize| {
        let calls: String =
            (0..20).map(|k| format!(r#"<call id="c{i}-{k}" procedure="p{}"/>"#, i + 1)).collect();
        format!(
            r#"<procedure id="p{i}">{}</procedure>"#,
            if i == 15 { r#"<TF id="t" fix="A"/>"#.into() } else { calls }
        )
    };
    let procedures: String = (0..16).map(procedure).collect();
    assert_eq!(codes(&procedures, r#"<call id="c" procedure="p0"/>"#), ["too-large"]);
    // and so with an argument that doubles in length
    let doubling = |i: usize| {
        format!(
            r#"<procedure id="p{i}"><parameter name="x"/><call id="c{i}" procedure="p{}"><argument name="x" value="= x + x"/></call></procedure>"#,
            i + 1
        )
    };
    let last = r#"<procedure id="p15"><parameter name="x"/><TF id="t" fix="A" speed="= x"/></procedure>"#;
    let procedures: String = (0..15).map(doubling).chain([last.to_owned()]).collect();
    let call = r#"<call id="c" procedure="p0"><argument name="x" value="= 1.0"/></call>"#;
    assert_eq!(codes(&procedures, call), ["expression-too-large"]);
}

/// A long expression at each of very many points.
#[test]
fn a_long_anchor_is_not_repeated_without_end() {
    let points = r#"<point lat="36.01" lon="-84.01"/>"#.repeat(100_000);
    let corridor = format!(
        r#"<procedure id="p" reference="36.0 -84.0"><corridor id="c1" width="5" spacing="1"><route>{points}</route></corridor></procedure>"#
    );
    let call = |length: usize| {
        let at = format!("offset(where, 0.0, 0.0{})", " + 0.0".repeat(length / 6));
        format!(r#"<call id="c" procedure="p" at="= {at}"/>"#)
    };
    assert_eq!(codes(&corridor, &call(900)), ["too-large"]);
    // this one the checks refuse, as an expression
    let (plan, problems) = flown(&corridor, &call(900_000));
    assert_eq!(problems, []);
    assert!(matches!(plan.leg(&"c".into()).unwrap().leg.kind, LegKind::Call(_)));
}

#[test]
fn a_program_flies_the_legs_and_keeps_the_plan_as_written() {
    let good = include_str!("../../../../assets/plans/square.xml");
    let called = good.replace("<mainPlan", r#"<procedures><procedure id="out-and-back"><TF id="o" fix="A"/><TF id="b" fix="B"/></procedure></procedures>
        <mainPlan"#);
    assert_ne!(called, good);
    let document = called.replacen("</stage>", r#"<call id="trip" procedure="out-and-back"/></stage>"#, 1);
    let program = compile_document(document.as_bytes(), &Profile::default(), &Flat(300.0)).unwrap();
    assert_eq!(program.hash().as_ref(), crate::hash(&read(&document).plan));
    let path = program.path(&"trip.b".into()).unwrap();
    assert_eq!(program.chain(&path).iter().map(|l| l.id.as_str()).collect::<Vec<_>>(), ["trip", "trip.b"]);
    assert!(matches!(program.written(&"trip".into()).unwrap().leg.kind, LegKind::Call(_)));
    assert_eq!(program.written(&"trip.b".into()), None, "only the call makes it");
    assert_eq!(program.written(&"side1".into()), program.plan.leg(&"side1".into()));
}

#[test]
fn problems_of_a_called_leg_stand_at_the_call() {
    let reading = read(document(GATE, &format!("\n\n<call id=\"c\" procedure=\"gate\">{FAST}</call>")));
    let call = reading.places.get(&"c".into());
    assert!(call.is_some() && reading.places.get(&"c.out".into()) == call);
    assert_eq!(reading.places.get(&"nowhere.out".into()), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Moved, a procedure keeps its shape: distances between its points stay to a hundred-thousandth. (It is moved on an
    /// ellipsoid, whose curvature differs by 0.7 % between equator and pole: over 4 km that is some (4/6371)² of it.)
    #[test]
    fn a_moved_procedure_keeps_its_shape(
        to in (-60.0..60.0, -180.0..180.0), bearing in 0.0..360.0,
        p in (-0.03..0.03, -0.03..0.03), q in (-0.03..0.03, -0.03..0.03),
    ) {
        let procedure = |p: (f64, f64), q: (f64, f64)| format!(
            r#"<procedure id="p" reference="36 -84" bearing="10"><TF id="p" lat="{}" lon="{}"/><TF id="q" lat="{}" lon="{}"/></procedure>"#,
            36.0 + p.0, p.1 - 84.0, 36.0 + q.0, q.1 - 84.0);
        let call = format!(r#"<call id="c" procedure="p" lat="{}" lon="{}" bearing="{bearing}"/>"#, to.0, to.1);
        let plan = legs(&procedure(p, q), &call);
        let before = LatLon::new(36.0 + p.0, p.1 - 84.0).distance_m(LatLon::new(36.0 + q.0, q.1 - 84.0));
        let after = position(&plan, "c.p").distance_m(position(&plan, "c.q"));
        prop_assert!((before - after).abs() <= 1e-5 * 8000.0, "{before} {after}");
    }
}
