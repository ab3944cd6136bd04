use super::*;
use crate::create::tests::made;
use crate::template::Template;
use crate::transform::places;
use crate::{Act, LegAction, Trigger, check};
use aircraft::Profile;
use proptest::prelude::*;
use terrain::Flat;

fn legs(plan: &FlightPlan) -> Vec<Id> {
    plan.stages.iter().flat_map(|stage| &stage.legs).map(|leg| leg.id.clone()).collect()
}

fn spot(plan: &FlightPlan) -> Spot {
    let stage = plan.stages.iter().find(|stage| stage.kind == StageKind::Mission).unwrap();
    Spot::EndOf(stage.id.clone())
}

#[test]
fn what_was_copied_is_pasted_into_another_plan() {
    let (plan, other) = (made(Template::Patrol), made(Template::Survey));
    let chosen = legs(&plan);
    let text = copy(&plan, &chosen).unwrap();
    let pasted = paste(&other, &text, &spot(&other), None).unwrap();
    let after = pasted.edit.apply(&other).unwrap();
    assert_eq!(pasted.legs.len(), chosen.len());
    for (new, old) in pasted.legs.iter().zip(&chosen) {
        let (new, old) = (after.leg(new).unwrap().leg.clone(), plan.leg(old).unwrap().leg);
        assert_eq!(places(&after, &new), places(&plan, old));
    }
    let ids = lists::ids(&after);
    assert_eq!(ids.len(), lists::ids(&other).len() + plan_legs(&plan), "no identifier is there twice");
    let problems = check(&after, &Profile::default(), &Flat(200.0));
    assert!(!problems.iter().any(|p| p.code.starts_with("unknown")), "{problems:?}");
}

fn plan_legs(plan: &FlightPlan) -> usize {
    plan.all_legs().iter().filter(|c| c.section == crate::Section::Main).count()
}

#[test]
fn copies_go_around_the_pointer_and_keep_their_shape() {
    let plan = made(Template::Patrol);
    let to = LatLon::new(46.2, 8.3);
    let pasted = paste(&plan, &copy(&plan, &legs(&plan)).unwrap(), &spot(&plan), Some(to)).unwrap();
    let after = pasted.edit.apply(&plan).unwrap();
    let all: Vec<LatLon> =
        pasted.legs.iter().flat_map(|id| places(&after, after.leg(id).unwrap().leg)).collect();
    assert!(LocalFrame::around(&all).unwrap().origin().distance_m(to) < 5.0);
    assert_eq!(after.fixes, plan.fixes, "fixes stay where they are");
}

#[test]
fn variables_come_along_and_strange_emergency_plans_do_not() {
    let mut plan = made(Template::Survey);
    let leg = legs(&plan)[0].clone();
    let variable = crate::create::variable(&plan, crate::VariableValue::Number(7.0));
    let name = variable.name.clone();
    let act = Act::Set { variable: name.clone(), to: "1.0".into() };
    let emergency = plan.emergency_plans[0].id.clone();
    plan = Edit::All(vec![
        Edit::Add(Box::new(Thing::Variable(variable))),
        Edit::SetActions { leg: leg.clone(), actions: vec![LegAction { trigger: Trigger::Start, act }] },
        Edit::SetEmergency { of: Some(leg.clone()), cause: None, plan: Some(emergency) },
    ])
    .apply(&plan)
    .unwrap();
    let mut other = made(Template::Patrol);
    other.emergency_plans.clear();
    let pasted = paste(&other, &copy(&plan, &[leg]).unwrap(), &spot(&other), None).unwrap();
    let after = pasted.edit.apply(&other).unwrap();
    assert!(after.variable(&name).is_some());
    assert!(after.leg(&pasted.legs[0]).unwrap().leg.emergency.by_cause.is_empty());
}

#[test]
fn a_set_is_duplicated_behind_itself() {
    let plan = made(Template::Patrol);
    let chosen = &legs(&plan)[..2];
    let pasted = duplicate(&plan, chosen).unwrap();
    let after = pasted.edit.apply(&plan).unwrap();
    let order = legs(&after);
    let last = order.iter().position(|id| *id == chosen[1]).unwrap();
    assert_eq!(&order[last + 1..last + 3], &pasted.legs[..]);
}

#[test]
fn hostile_text_is_refused_in_words() {
    let plan = made(Template::Patrol);
    let many = "<track/>".repeat(MAX_LEGS + 1);
    let deep = "<iterative>".repeat(100_000);
    for (text, expected) in [
        ("x".repeat(50 << 20), "50 MB"),
        ("hello".into(), "neither legs nor a place"),
        (String::new(), "neither"),
        ("<svg/>".into(), "no flight plan"),
        ("<flightPlan".into(), "no flight plan"),
        (format!("<flightPlan>{many}</flightPlan>"), "no flight plan"),
        (format!("<flightPlan>{deep}"), "no flight plan"),
        (write(&FlightPlan { aircraft: "trainer".into(), ..FlightPlan::default() }), "no legs"),
    ] {
        let refused = paste(&plan, &text, &spot(&plan), None).unwrap_err();
        assert!(refused.contains(expected), "{refused}");
    }
    assert!(copy(&plan, &["nothing".into()]).is_none());
}

#[test]
fn zones_and_fixes_that_no_leg_names_are_pasted_under_new_names() {
    let mut plan = made(Template::Patrol);
    let at = LatLon::new(46.1, 8.1);
    let fix = crate::create::fix(&plan, at);
    plan.fixes.push(fix.clone());
    let shape = crate::ZoneShape::Circle { centre: at, radius_m: 200.0 };
    let zone = crate::create::zone(&plan, crate::ZoneKind::KeepOut, shape);
    plan.zones.push(zone.clone());
    let text = copy(&plan, &[zone.id.clone(), fix.id.clone()]).unwrap();
    let to = LatLon::new(46.2, 8.3);
    let pasted = paste(&plan, &text, &spot(&plan), Some(to)).unwrap();
    assert!(pasted.legs.is_empty());
    let [Thing::Fix(new_fix), Thing::Zone(new_zone)] = pasted.things.as_slice() else { panic!("{pasted:?}") };
    assert!(new_fix.id != fix.id && new_zone.id != zone.id);
    let after = pasted.edit.apply(&plan).unwrap();
    assert_eq!((after.fixes.len(), after.zones.len()), (plan.fixes.len() + 1, plan.zones.len() + 1));
    assert!(after.fix(&new_fix.id).unwrap().position.distance_m(to) < 5.0);
}

#[test]
fn more_legs_than_can_be_pasted_are_refused() {
    let mut plan = made(Template::Patrol);
    let leg = plan.stages.iter().flat_map(|stage| &stage.legs).next().unwrap().clone();
    let many =
        (0..=MAX_LEGS).map(|n| Arc::new(Leg { id: Id::new(&format!("x{n}")), ..leg.as_ref().clone() }));
    plan.stages.iter_mut().find(|stage| !stage.legs.is_empty()).unwrap().legs.extend(many);
    let text = copy(&plan, &legs(&plan)).unwrap();
    assert!(paste(&plan, &text, &spot(&plan), None).unwrap_err().contains("at once"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn no_text_is_too_odd(text in "[<>/a-z \"=]{0,200}") {
        let plan = made(Template::Patrol);
        if let Ok(pasted) = paste(&plan, &text, &spot(&plan), None) {
            prop_assert!(pasted.edit.apply(&plan).is_ok());
        }
    }
}

/// What the plan has after a text was pasted into it, and what was pasted.
fn with(plan: &FlightPlan, text: &str) -> (FlightPlan, Pasted) {
    let pasted = paste(plan, text, &spot(plan), Some(LatLon::new(46.2, 8.3))).unwrap();
    (pasted.edit.apply(plan).unwrap(), pasted)
}

#[test]
fn an_emergency_plan_is_copied_with_its_runway_and_stays_where_it_leads() {
    let plan = made(Template::Survey);
    let of = plan.emergency_plans[0].clone();
    let text = copy_named(&plan, &Subject::EmergencyPlan(of.id.clone())).unwrap();
    let places_of = |plan: &FlightPlan, of: &crate::EmergencyPlan| -> Vec<LatLon> {
        of.stages.iter().flat_map(|stage| &stage.legs).flat_map(|leg| places(plan, leg)).collect()
    };
    // into its own plan: a second one to the same runway
    let (after, pasted) = with(&plan, &text);
    let [was, new] = after.emergency_plans.as_slice() else { panic!("{:?}", after.emergency_plans) };
    assert_eq!((was, after.runways.len(), pasted.legs.len()), (&of, plan.runways.len(), 0));
    assert_eq!(new.runway, of.runway);
    assert_ne!((&new.id, &new.name), (&of.id, &of.name));
    assert_eq!(places_of(&after, new), places_of(&plan, &of), "the pointer does not move it");
    assert_eq!(lists::ids(&after).len(), lists::ids(&plan).len() + lists::ids(&plan_of(new)).len());
    // into a plan whose runway of that name is another one
    let mut other = made(Template::Patrol);
    other.emergency_plans.clear();
    other.runways.iter_mut().for_each(|runway| runway.elevation_amsl_m += 20.0);
    let (after, _) = with(&other, &text);
    let new = &after.emergency_plans[0];
    let runway = after.runway(&new.runway).unwrap();
    assert_eq!(Some(runway.threshold), plan.runway(&of.runway).map(|runway| runway.threshold));
    assert_eq!(runway.elevation_amsl_m, plan.runway(&of.runway).unwrap().elevation_amsl_m);
    assert!(new.stages.iter().filter_map(|stage| stage.runway.as_ref()).all(|id| *id == new.runway));
    let problems = check(&after, &Profile::default(), &Flat(200.0));
    assert!(!problems.iter().any(|p| p.code.starts_with("unknown")), "{problems:?}");
}

fn plan_of(emergency: &crate::EmergencyPlan) -> FlightPlan {
    FlightPlan { emergency_plans: vec![emergency.clone()], ..FlightPlan::default() }
}

/// Two procedures, one of which calls the other and reads a variable.
fn with_procedures() -> FlightPlan {
    read(
        r#"<flightPlan version="1" id="p" aircraft="trainer">
          <variables><variable name="high" type="number" initial="120"/></variables>
          <procedures>
            <procedure id="look" name="A look" anchor="46 8"><TF id="up" lat="46" lon="8.01" altitude="= high"/><call id="again" procedure="turn"/></procedure>
            <procedure id="turn" anchor="46 8"><TF id="round" lat="46.01" lon="8"/></procedure>
          </procedures>
          <mainPlan><stage id="s" type="mission"><TF id="a" lat="46" lon="8"/></stage></mainPlan>
        </flightPlan>"#,
    )
    .plan
}

#[test]
fn a_procedure_is_copied_with_what_it_calls_and_a_variable_alone() {
    let plan = with_procedures();
    let names =
        |plan: &FlightPlan| -> Vec<String> { plan.procedures.iter().map(|p| p.id.to_string()).collect() };
    let text = copy_named(&plan, &Subject::Procedure("look".into())).unwrap();
    let mut other = with_procedures();
    (other.procedures, other.variables) = Default::default();
    let (after, pasted) = with(&other, &text);
    assert_eq!((names(&after), after.variables.len()), (vec!["turn".into(), "look".into()], 1));
    assert_eq!(pasted.things.len(), 1, "what it needs was not meant: {:?}", pasted.things);
    let (after, _) = with(&plan, &text);
    assert_eq!(names(&after), ["look", "turn", "look2"]);
    assert_eq!((after.procedures[2].name.as_str(), after.variables.len()), ("A look 2", 1));
    let variable = copy_named(&plan, &Subject::Variable("high".into())).unwrap();
    let (after, _) = with(&plan, &variable);
    let named: Vec<&str> = after.variables.iter().map(|variable| variable.name.as_str()).collect();
    assert_eq!(named, ["high", "high_2"]);
    assert_eq!(after.variables[1].initial, plan.variables[0].initial);
    for gone in [Subject::Variable("low".into()), Subject::EmergencyPlan("look".into()), Subject::Plan] {
        assert_eq!(copy_named(&plan, &gone), None, "{gone:?}");
        assert!(duplicate_named(&plan, &gone).is_err());
    }
}
