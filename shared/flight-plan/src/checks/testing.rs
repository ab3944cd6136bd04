//! For the rules' tests: a good plan, changed at one place.

use crate::{FlightPlan, Problem, check, read};
use aircraft::Profile;
use terrain::{Flat, Terrain};

/// A plan without problems over flat ground at 300 m; its main plan's legs are `legs`.
pub fn plan_with(legs: &str) -> String {
    document(&format!(
        r#"<stage id="to" type="take-off" runway="R" altitude="100" altitudeReference="home"/>
           <stage id="way" type="en-route" altitude="500" altitudeReference="amsl">{legs}</stage>
           <stage id="land" type="land" runway="R"/>"#
    ))
}

/// A plan with these stages as its main plan.
pub fn document(stages: &str) -> String {
    document_with(
        "",
        stages,
        r#"<emergencyPlan id="home" runway="R">
        <stage id="e1" type="arrival"><DF id="e1d" fix="A" altitude="450" altitudeReference="amsl"/></stage>
        <stage id="e2" type="land" runway="R"/></emergencyPlan>"#,
    )
}

/// A plan with these variables, main plan stages and emergency plans; if there is no landing among the stages, with one behind them.
pub fn document_with(variables: &str, stages: &str, emergency_plans: &str) -> String {
    let landing = match stages.contains(r#"type="land""#) {
        true => "",
        false => r#"<stage id="landing" type="land" runway="R"/>"#,
    };
    format!(
        r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="Test" aircraft="trainer">
             <fixes>
               <fix id="A" lat="36.3" lon="-84.20"/> <fix id="B" lat="36.3" lon="-84.17"/> <fix id="C" lat="36.33" lon="-84.17"/>
               <fix id="GATE" lat="36.3" lon="-84.23"/>
             </fixes>
             <runways><runway id="R" lat="36.3" lon="-84.21" elevation="300" heading="90" length="500" priority="1"/></runways>
             <variables>{variables}</variables>
             <mainPlan emergency="home">{stages}{landing}</mainPlan>
             <emergencyPlans>{emergency_plans}</emergencyPlans>
           </flightPlan>"#
    )
}

/// The codes that a document gives over some terrain, the document's own problems being none.
pub fn codes_over(document: &str, terrain: &dyn Terrain) -> Vec<&'static str> {
    let reading = read(document);
    assert_eq!(reading.problems, [], "the test's document is broken");
    check(&reading.plan, &Profile::default(), terrain).iter().map(|p| p.code).collect()
}

/// The codes that a document gives over flat ground at 300 m.
pub fn codes(document: &str) -> Vec<&'static str> {
    codes_over(document, &Flat(300.0))
}

/// Each main plan's legs give exactly these codes.
pub fn check_legs(cases: &[(&str, &[&str])]) {
    for (legs, expected) in cases {
        assert_eq!(codes(&plan_with(legs)), *expected, "{legs}");
    }
}

/// What is said of the main plan's legs with this code.
pub fn message_of(legs: &str, code: &str) -> String {
    let problem = with_code(&read(plan_with(legs)).plan, code);
    problem.unwrap_or_else(|| panic!("no {code}: {legs}")).message
}

/// Each main plan's legs have a problem with this code, and the edit that it offers removes it.
pub fn fixed_legs(cases: &[(&str, &str)]) {
    for (legs, code) in cases {
        fixed(&plan_with(legs), code);
    }
}

/// A document has a problem with this code, and the edit that it offers removes it; gives what it makes of it.
pub fn fixed(document: &str, code: &str) -> FlightPlan {
    let plan = read(document).plan;
    let problem = with_code(&plan, code).unwrap_or_else(|| panic!("no {code}: {document}"));
    let fix = problem.fix.clone().unwrap_or_else(|| panic!("no edit offered: {problem}"));
    let repaired = fix.apply(&plan).unwrap_or_else(|error| panic!("{error}: {fix:?}"));
    let again = with_code(&repaired, code).filter(|again| again.subject == problem.subject);
    assert_eq!(again, None, "{fix:?} of {document}");
    repaired
}

fn with_code(plan: &FlightPlan, code: &str) -> Option<Problem> {
    check(plan, &Profile::default(), &Flat(300.0)).into_iter().find(|p| p.code == code)
}

#[test]
fn the_test_plan_has_no_problems() {
    check_legs(&[(r#"<IF id="a" fix="A"/><TF id="b" fix="B"/><TF id="c" fix="C"/>"#, &[])]);
}
