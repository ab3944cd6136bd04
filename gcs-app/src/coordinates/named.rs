//! What a name of the plan means as a place: an identifier, else what people call the thing.

use flight_plan::{FlightPlan, Id, LegContext, Place, Value, VariableValue};
use geometry::LatLon;

/// Something of the plan that has a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// As a leg names it that goes there: it stays with a fix or a variable.
    pub place: Place,
    /// Where it is now.
    pub at: LatLon,
}

/// What a thing is called, and where it is.
struct Candidate<'a> {
    id: &'a Id,
    name: &'a str,
    is: Named,
}

/// The thing that a name means, whether it is written in capitals or not; an identifier goes before what people call things.
///
/// # Errors
/// A sentence that says which things are called so: they are in several places.
pub fn named(name: &str, plan: &FlightPlan) -> Result<Option<Named>, String> {
    let name = name.trim();
    let wanted = name.to_lowercase();
    let is_id = |known: &Candidate<'_>| known.id.as_str() == name;
    let is_like_id = |known: &Candidate<'_>| known.id.as_str().to_lowercase() == wanted;
    let is_name = |known: &Candidate<'_>| known.name.to_lowercase() == wanted;
    if wanted.is_empty() {
        return Ok(None);
    }
    if let Some(exact) = candidates(plan).find(is_id) {
        return Ok(Some(exact.is));
    }
    let like_ids: Vec<_> = candidates(plan).filter(is_like_id).collect();
    only(name, if like_ids.is_empty() { candidates(plan).filter(is_name).collect() } else { like_ids })
}

fn only(name: &str, found: Vec<Candidate<'_>>) -> Result<Option<Named>, String> {
    let is_elsewhere = |other: &Candidate<'_>| found.first().is_some_and(|first| first.is.at != other.is.at);
    if found.iter().any(is_elsewhere) {
        let ids: Vec<&str> = found.iter().map(|candidate| candidate.id.as_str()).collect();
        return Err(format!("Several things are called “{name}”: write {}.", ids.join(", or ")));
    }
    Ok(found.into_iter().next().map(|first| first.is))
}

/// All that has a place, what a leg can stay with first.
fn candidates(plan: &FlightPlan) -> impl Iterator<Item = Candidate<'_>> {
    let fixes = plan.fixes.iter().map(|fix| {
        let is = Named { place: Place::Fix(fix.id.clone()), at: fix.position };
        Candidate { id: &fix.id, name: &fix.name, is }
    });
    let runways = plan.runways.iter().map(|runway| {
        let is = Named { place: Place::Position(Value::Constant(runway.threshold)), at: runway.threshold };
        Candidate { id: &runway.id, name: "", is }
    });
    let variables = plan.variables.iter().filter_map(|variable| {
        let VariableValue::Position(at) = variable.initial else { return None };
        let place = Place::Position(Value::Expression(variable.name.as_str().into()));
        Some(Candidate { id: &variable.name, name: variable.name.as_str(), is: Named { place, at } })
    });
    let legs = plan.all_legs().into_iter().filter_map(|context| of_leg(plan, &context));
    fixes.chain(runways).chain(variables).chain(legs)
}

fn of_leg<'a>(plan: &FlightPlan, context: &LegContext<'a>) -> Option<Candidate<'a>> {
    let at = match context.leg.place()? {
        Place::Fix(id) => plan.fix(id)?.position,
        Place::Position(Value::Constant(at)) => *at,
        Place::Position(Value::Expression(_)) => return None,
    };
    let is = Named { place: Place::Position(Value::Constant(at)), at };
    Some(Candidate { id: &context.leg.id, name: &context.leg.name, is })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coordinates::{Known, read};

    const PLAN: &str = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer">
        <fixes><fix id="F1" name="Gate" lat="1" lon="1"/><fix id="F2" name="Mill" lat="2" lon="2"/>
          <fix id="F3" name="mill" lat="3" lon="3"/><fix id="R" name="Tower" lat="4" lon="4"/></fixes>
        <runways><runway id="R05" lat="5" lon="5" elevation="0" heading="50" length="500"/></runways>
        <variables><variable name="meeting" type="position" initial="6 6"/></variables>
        <mainPlan><stage id="s" type="mission"><TF id="tower" name="Look" lat="7" lon="7"/></stage></mainPlan></flightPlan>"#;

    fn plan() -> FlightPlan {
        flight_plan::read(PLAN).plan
    }

    fn lat_deg(name: &str) -> f64 {
        let plan = plan();
        let known = Known { plan: Some(&plan), ..Known::default() };
        read(name, &known).unwrap_or_else(|why| panic!("{name}: {why}")).lat_deg.round()
    }

    #[test]
    fn things_are_found_by_what_people_call_them_and_by_their_identifiers_first() {
        for (name, wanted) in
            [("Gate", 1.0), ("gate", 1.0), ("f2", 2.0), ("r05", 5.0), ("Meeting", 6.0), ("look", 7.0)]
        {
            assert_eq!(lat_deg(name), wanted, "{name}");
        }
        assert_eq!(
            (lat_deg("tower"), lat_deg("Tower")),
            (7.0, 7.0),
            "an identifier, though a fix is called so"
        );
        assert_eq!(lat_deg("090° 1 m from gate"), 1.0);
    }

    #[test]
    fn a_name_of_several_places_is_told_with_what_to_write() {
        let told = named("MILL", &plan()).unwrap_err();
        assert_eq!(told, "Several things are called “MILL”: write F2, or F3.");
        assert_eq!(named("nothing", &plan()), Ok(None));
    }

    #[test]
    fn a_leg_stays_with_the_fix_or_variable_that_was_named() {
        let place = |name: &str| named(name, &plan()).unwrap().unwrap().place;
        assert_eq!(place("gate"), Place::Fix("F1".into()));
        assert_eq!(place("meeting"), Place::Position(Value::Expression("meeting".into())));
    }
}
