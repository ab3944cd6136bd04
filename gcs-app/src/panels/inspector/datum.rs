//! An altitude that is counted from something else: its number changes with what it is measured from, so that the aircraft stays
//! where it is.

use crate::panels::Scene;
use crate::units::Units;
use flight_plan::describe::Subject;
use flight_plan::{Altitude, AltitudeReference, FlightPlan, Leg, Runway, Value, transform};
use geometry::LatLon;

/// What came of it.
pub struct Recounted {
    /// The number, as it counts now.
    pub metres: Value<f64>,
    /// What is to be said of it.
    pub remark: Option<String>,
}

/// The same height, counted from `to`; where that is not known, the same number.
pub fn recounted(scene: &Scene<'_>, of: &Subject, altitude: &Altitude, to: AltitudeReference) -> Recounted {
    let kept = |why: &str| Recounted {
        metres: altitude.metres.clone(),
        remark: Some(format!("The number stays as it was: {why}.")),
    };
    let Value::Constant(metres) = altitude.metres else { return kept("it is a formula") };
    let ground = ground_amsl_m(scene, of);
    let datum = |reference| datum_amsl_m(scene.document.plan(), of, reference, ground);
    match (datum(altitude.reference), datum(to)) {
        (Ok(from_m), Ok(to_m)) => Recounted {
            // to 10 cm: there and back is the same number
            metres: Value::Constant(((metres + from_m - to_m) * 10.0).round() / 10.0),
            remark: by_the_ground(altitude.reference, to, ground, scene.units()),
        },
        (Err(why), _) | (_, Err(why)) => kept(why),
    }
}

/// Where a reference is, metres AMSL.
fn datum_amsl_m(
    plan: &FlightPlan,
    of: &Subject,
    reference: AltitudeReference,
    ground: Option<f64>,
) -> Result<f64, &'static str> {
    match reference {
        AltitudeReference::Amsl => Ok(0.0),
        AltitudeReference::Agl => ground.ok_or("nothing is known of the ground there"),
        AltitudeReference::Home => home(plan, of)
            .map(|runway| runway.elevation_amsl_m)
            .ok_or("home is the runway of the take-off, and there is none, or one at another elevation"),
    }
}

/// Of a leg or stage of the main plan, that of its flight; else that of all flights.
fn home<'a>(plan: &'a FlightPlan, of: &Subject) -> Option<&'a Runway> {
    let stage = match of {
        Subject::Leg(id) => plan.leg(id).map(|context| &context.stage.id),
        Subject::Stage(id) => Some(id),
        _ => None,
    };
    let index = stage.and_then(|id| plan.stages.iter().position(|stage| stage.id == *id));
    index.map_or_else(|| plan.common_home(), |index| plan.home_at(index))
}

/// The ground under one place is meant, and the leg may lead over other ground.
fn by_the_ground(
    from: AltitudeReference,
    to: AltitudeReference,
    ground: Option<f64>,
    units: Units,
) -> Option<String> {
    let counts = [from, to].contains(&AltitudeReference::Agl);
    let ground_m = ground.filter(|_| counts && from != to)?;
    Some(format!("By the ground at its place, {} AMSL.", units.altitude().show(ground_m)))
}

fn ground_amsl_m(scene: &Scene<'_>, of: &Subject) -> Option<f64> {
    scene.ground.0.elevation_m(place(scene.document.plan(), of)?)
}

/// The place of a leg, of the first leg of a stage that has one, or of its runway.
fn place(plan: &FlightPlan, of: &Subject) -> Option<LatLon> {
    match of {
        Subject::Leg(id) => place_of_leg(plan, plan.any_leg(id)?),
        Subject::Stage(id) => {
            let stage = plan.stage(id)?;
            let runway = || plan.runway(stage.runway.as_ref()?).map(|runway| runway.threshold);
            stage.legs.iter().find_map(|leg| place_of_leg(plan, leg)).or_else(runway)
        }
        // the ground of a zone has many heights
        _ => None,
    }
}

fn place_of_leg(plan: &FlightPlan, leg: &Leg) -> Option<LatLon> {
    let own = transform::places(plan, leg).first().copied();
    own.or_else(|| leg.body().iter().find_map(|inner| place_of_leg(plan, inner)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn home_is_the_field_from_which_the_flight_took_off() {
        let plan = flight_plan::read(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><runways>
              <runway id="low" lat="36.3" lon="-84.1" elevation="300" heading="52" length="600"/>
              <runway id="high" lat="36.4" lon="-84.1" elevation="500" heading="52" length="600"/></runways><mainPlan>
              <stage id="to1" type="take-off" runway="low"/><stage id="one" type="mission"><TF id="a" lat="36.3" lon="-84.2"/></stage>
              <stage id="land1" type="land" runway="high"/><stage id="to2" type="take-off" runway="high"/>
              <stage id="two" type="mission"><TF id="b" lat="36.4" lon="-84.2"/></stage>
              <stage id="land2" type="land" runway="low"/></mainPlan></flightPlan>"#,
        )
        .plan;
        let of = |subject| home(&plan, &subject).map(|runway| runway.id.to_string());
        assert_eq!(of(Subject::Leg("a".into())).as_deref(), Some("low"));
        assert_eq!(of(Subject::Leg("b".into())).as_deref(), Some("high"));
        assert_eq!(of(Subject::Stage("two".into())).as_deref(), Some("high"));
        assert_eq!(of(Subject::Zone("z".into())), None, "it is of both flights");
    }
}
