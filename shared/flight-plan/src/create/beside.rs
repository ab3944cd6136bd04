//! What a new leg has from the leg beside it.

use super::arrange::list_of;
use super::descent::on_slope;
use crate::{FlightPlan, Id, Leg, LegKind, Spot};
use std::sync::Arc;

/// A new leg for a place of the plan, at the altitude and speed that the leg beside it has as its own: between two legs at 80 m
/// in a stage at 150 m, it would rise to 150 m otherwise. What that leg inherits, the new one inherits too. In an approach it is on the
/// way down to the threshold.
#[must_use]
pub fn like_beside(plan: &FlightPlan, leg: Leg, at: &Spot) -> Leg {
    if matches!(leg.kind, LegKind::Call(_)) {
        return leg;
    }
    let beside = beside(plan, at);
    let on_slope = || on_slope(plan, &leg, at);
    let altitude = leg.altitude.clone().or_else(on_slope).or_else(|| beside?.altitude.clone());
    let speed_mps = leg.speed_mps.clone().or_else(|| beside?.speed_mps.clone());
    Leg { altitude, speed_mps, ..leg }
}

/// The leg before a place in its list, else the one behind it.
fn beside<'a>(plan: &'a FlightPlan, at: &Spot) -> Option<&'a Leg> {
    match at {
        Spot::After(id) => plan.any_leg(id),
        Spot::Before(id) => {
            let (list, index) = list_of(plan, id)?;
            list.get(index.saturating_sub(1)).map(Arc::as_ref)
        }
        Spot::EndOf(id) => inside(plan, id)?.last().map(Arc::as_ref),
    }
}

/// The legs of a stage, procedure or loop.
fn inside<'a>(plan: &'a FlightPlan, id: &Id) -> Option<&'a [Arc<Leg>]> {
    let of_stage = || plan.stage(id).map(|stage| stage.legs.as_slice());
    let of_procedure = || plan.procedure(id).map(|procedure| procedure.legs.as_slice());
    of_stage().or_else(of_procedure).or_else(|| plan.any_leg(id).map(Leg::body))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{Drawn, LegChoice, leg};
    use crate::{Altitude, AltitudeReference, Edit, Place, Value};
    use geometry::LatLon;

    fn at_80_m() -> Altitude {
        Altitude { metres: Value::Constant(80.0), reference: AltitudeReference::Home }
    }

    fn track(plan: &FlightPlan) -> Leg {
        let place = Drawn::Place(Place::Position(Value::Constant(LatLon::new(41.5, 1.5))));
        leg(plan, &aircraft::Profile::default(), LegChoice::Tf, &place, None, None).expect("a track")
    }

    /// A survey that ends with a track at 80 m and 17 m/s, and one that inherits; those tracks.
    fn low_then_not() -> (FlightPlan, Id, Id) {
        let plan = crate::create::tests::made(crate::template::Template::Survey);
        let append = |plan: &FlightPlan, leg: &Leg| {
            let at = Spot::EndOf("mission".into());
            Edit::InsertLeg { leg: Box::new(leg.clone()), at }.apply(plan).expect("appended")
        };
        let low = Leg { altitude: Some(at_80_m()), speed_mps: Some(Value::Constant(17.0)), ..track(&plan) };
        let plan = append(&plan, &low);
        let other = track(&plan);
        (append(&plan, &other), low.id, other.id)
    }

    #[test]
    fn behind_or_before_a_low_leg_a_new_one_is_low() {
        let (plan, low, other) = low_then_not();
        for at in [Spot::After(low), Spot::Before(other)] {
            let new = like_beside(&plan, track(&plan), &at);
            assert_eq!(
                (new.altitude, new.speed_mps),
                (Some(at_80_m()), Some(Value::Constant(17.0))),
                "{at:?}"
            );
        }
    }

    #[test]
    fn beside_a_leg_that_inherits_a_new_one_inherits() {
        let (plan, _, other) = low_then_not();
        for at in [Spot::After(other), Spot::EndOf("mission".into())] {
            let new = like_beside(&plan, track(&plan), &at);
            assert_eq!((new.altitude, new.speed_mps), (None, None), "{at:?}");
        }
    }

    #[test]
    fn what_a_leg_ends_at_stays_its_own() {
        let (plan, low, _) = low_then_not();
        let climb =
            Leg { altitude: Some(Altitude { metres: Value::Constant(200.0), ..at_80_m() }), ..track(&plan) };
        let new = like_beside(&plan, climb.clone(), &Spot::After(low));
        assert_eq!(new.altitude, climb.altitude);
    }
}
