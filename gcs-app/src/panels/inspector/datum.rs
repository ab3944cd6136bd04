//! An altitude that is counted from something else: its number changes with what it is measured from, so that the aircraft stays
//! where it is.

use crate::panels::Scene;
use crate::units::Units;
use flight_plan::describe::Subject;
use flight_plan::{Altitude, AltitudeReference, FlightPlan, Leg, Value, transform};
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
    let datum = |reference| datum_amsl_m(scene.document.plan(), reference, ground);
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
    reference: AltitudeReference,
    ground: Option<f64>,
) -> Result<f64, &'static str> {
    match reference {
        AltitudeReference::Amsl => Ok(0.0),
        AltitudeReference::Agl => ground.ok_or("nothing is known of the ground there"),
        AltitudeReference::Home => plan
            .home()
            .map(|runway| runway.elevation_amsl_m)
            .ok_or("home is the runway of the take-off, and there is none"),
    }
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
