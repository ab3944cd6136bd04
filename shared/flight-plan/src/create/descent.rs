//! How high a new leg of an approach ends: on the way down to the threshold, and not where the hold before it was.

use super::legs_in;
use crate::template::GLIDE_SLOPE;
use crate::{Altitude, AltitudeReference, FlightPlan, Id, Leg, Place, Runway, Spot, Stage, StageKind, Value};
use geometry::LatLon;

/// The altitude on the slope down to the landing that follows; `None`: it is not in an approach, or the path is no higher there anyway.
pub(super) fn on_slope(plan: &FlightPlan, leg: &Leg, at: &Spot) -> Option<Altitude> {
    let (stages, index) = stages_around(plan, at)?;
    let ahead = stages.get(index..)?;
    ahead.first().filter(|stage| stage.kind == StageKind::Approach)?;
    let landing = ahead.iter().find(|stage| stage.kind == StageKind::Land)?;
    let runway = plan.runway(landing.runway.as_ref()?)?;
    let height_m = (position(plan, leg)?.distance_m(runway.threshold) * GLIDE_SLOPE).round();
    let before_m = height_before_m(plan, stages.get(..=index)?, at, runway);
    let is_home = plan.common_home().is_some_and(|home| home.id == runway.id);
    let (metres, reference) = match is_home {
        true => (height_m, AltitudeReference::Home),
        false => ((runway.elevation_amsl_m + height_m).round(), AltitudeReference::Amsl),
    };
    before_m
        .is_none_or(|before_m| height_m < before_m)
        .then_some(Altitude { metres: Value::Constant(metres), reference })
}

/// The stages of the plan that a place is in, and the index of its own.
fn stages_around<'a>(plan: &'a FlightPlan, at: &Spot) -> Option<(&'a [Stage], usize)> {
    let (Spot::Before(id) | Spot::After(id) | Spot::EndOf(id)) = at;
    let is_it = |stage: &Stage| stage.id == *id || legs_in(&stage.legs).iter().any(|leg| leg.id == *id);
    let emergencies = plan.emergency_plans.iter().map(|emergency| emergency.stages.as_slice());
    let mut sections = std::iter::once(plan.stages.as_slice()).chain(emergencies);
    sections.find_map(|stages| Some((stages, stages.iter().position(is_it)?)))
}

/// The height above a runway that the last leg before a place ends at, metres; over its ground that of the runway is taken.
fn height_before_m(plan: &FlightPlan, stages: &[Stage], at: &Spot, runway: &Runway) -> Option<f64> {
    let legs = stages.iter().flat_map(|stage| legs_in(&stage.legs).into_iter().map(move |leg| (leg, stage)));
    let legs: Vec<_> = legs.collect();
    let index = |id: &Id| legs.iter().position(|(leg, _)| leg.id == *id);
    let count = match at {
        Spot::Before(id) => index(id)?,
        Spot::After(id) => index(id)? + 1,
        Spot::EndOf(_) => legs.len(),
    };
    let altitudes =
        legs.iter().take(count).rev().map(|(leg, stage)| leg.altitude.as_ref().or(stage.altitude.as_ref()));
    let Altitude { metres: Value::Constant(metres), reference } = altitudes.flatten().next()? else {
        return None;
    };
    Some(match reference {
        AltitudeReference::Amsl => metres - runway.elevation_amsl_m,
        AltitudeReference::Home => metres + plan.common_home()?.elevation_amsl_m - runway.elevation_amsl_m,
        AltitudeReference::Agl => *metres,
    })
}

/// Where a leg ends, if the plan says.
fn position(plan: &FlightPlan, leg: &Leg) -> Option<LatLon> {
    match leg.place()? {
        Place::Fix(id) => plan.fix(id).map(|fix| fix.position),
        Place::Position(Value::Constant(at)) => Some(*at),
        Place::Position(Value::Expression(_)) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{Drawn, LegChoice, insert, leg, like_beside, tests::made};
    use crate::template::Template;

    const APPROACH: &str = "approach";

    /// The altitude of a track that is drawn so far before the threshold of the survey's runway.
    fn drawn(plan: &FlightPlan, before_m: f64, at: &Spot) -> Option<f64> {
        let runway = plan.home().expect("a runway");
        let place = runway.threshold.destination(runway.heading_deg + 180.0, before_m);
        let place = Drawn::Place(Place::Position(Value::Constant(place)));
        let track =
            leg(plan, &aircraft::Profile::default(), LegChoice::Tf, &place, None, None).expect("a track");
        match like_beside(plan, track, at).altitude {
            Some(Altitude { metres: Value::Constant(metres), reference: AltitudeReference::Home }) => {
                Some(metres)
            }
            None => None,
            other => panic!("{other:?}"),
        }
    }

    /// A survey without a leg in its approach: its arrival ends in a hold above the final.
    fn without_approach() -> FlightPlan {
        let mut plan = made(Template::Survey);
        plan.stages
            .iter_mut()
            .filter(|stage| stage.id.as_str() == APPROACH)
            .for_each(|stage| stage.legs.clear());
        plan
    }

    #[test]
    fn a_leg_of_an_approach_is_on_the_way_down_to_the_threshold() {
        let plan = without_approach();
        let at = Spot::EndOf(APPROACH.into());
        assert_eq!(drawn(&plan, 1200.0, &at), Some(90.0));
        assert_eq!(drawn(&plan, 800.0, &at), Some(60.0));
        assert_eq!(drawn(&plan, 20_000.0, &at), None, "nobody climbs to a slope");
        assert_eq!(drawn(&plan, 1200.0, &Spot::EndOf("mission".into())), None);
    }

    #[test]
    fn so_is_one_behind_or_before_another() {
        let plan = made(Template::Survey);
        let last =
            plan.stage(&APPROACH.into()).and_then(|stage| stage.legs.last()).expect("a leg").id.clone();
        for at in [Spot::After(last.clone()), Spot::Before(last)] {
            assert_eq!(drawn(&plan, 720.0, &at), Some(54.0), "{at:?}");
        }
        let emergency = plan.emergency_plans[0].stages.iter().find(|stage| stage.kind == StageKind::Approach);
        assert_eq!(drawn(&plan, 720.0, &Spot::EndOf(emergency.expect("one").id.clone())), Some(54.0));
    }

    #[test]
    fn elsewhere_than_at_home_it_is_above_the_sea() {
        let mut plan = without_approach();
        let other =
            Runway { id: Id::new("OTHER"), elevation_amsl_m: 350.0, ..plan.home().expect("one").clone() };
        let landing = plan.stages.iter_mut().find(|stage| stage.kind == StageKind::Land).expect("a landing");
        landing.runway = Some(other.id.clone());
        plan.runways.push(other);
        let place = Drawn::Place(Place::Position(Value::Constant(
            plan.runways[0].threshold.destination(270.0, 800.0),
        )));
        let track =
            leg(&plan, &aircraft::Profile::default(), LegChoice::Tf, &place, None, None).expect("a track");
        let altitude = on_slope(&plan, &track, &Spot::EndOf(APPROACH.into()));
        let above = Altitude { metres: Value::Constant(410.0), reference: AltitudeReference::Amsl };
        assert_eq!(altitude, None, "the hold is at {:?}, below that", plan.stage(&"arrival".into()));
        plan.stages.iter_mut().for_each(|stage| stage.legs.clear());
        assert_eq!(on_slope(&plan, &track, &Spot::EndOf(APPROACH.into())), Some(above));
        assert!(insert(&plan, track, Spot::EndOf(APPROACH.into())).apply(&plan).is_ok());
    }
}
