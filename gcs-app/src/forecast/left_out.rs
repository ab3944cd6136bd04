//! Legs that the aircraft would leave out: nothing is known of the ground that their altitude counts from, or they can't be laid out.

use flight_exec::Event;
use flight_exec::rehearse::Preview;
use flight_plan::{FlightPlan, Id, Section};
use std::collections::{HashMap, HashSet};

/// A leg on which less way is made is not flown, metres.
const LEAST_M: f64 = 1.0;

/// A leg of the plan that is not flown where the flight comes by.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOut {
    /// The leg.
    pub leg: Id,
    /// Its stage.
    pub stage: Id,
    /// Why, and what to do.
    pub reason: String,
    /// Index of the passage that is flown in its place.
    pub before: usize,
}

/// Those of a flight, in the order of the plan.
pub(super) fn of(preview: &Preview, flown: &FlightPlan) -> Vec<LeftOut> {
    let refused: HashMap<&Id, &str> = preview.events.iter().filter_map(|(_, event)| refusal(event)).collect();
    if refused.is_empty() {
        return Vec::new();
    }
    let places = places(flown);
    let place = |id: &Id| places.get(id).copied();
    // a loop comes by one that can't be laid out, and makes no way on it
    let on_the_way = preview.legs.iter().filter(|passage| passage.distance_m > LEAST_M);
    let passed: HashSet<&Id> = on_the_way.map(|passage| &passage.place.leg).collect();
    let main = flown.all_legs().into_iter().filter(|context| context.section == Section::Main);
    // one of which only the new pattern was refused is flown by its old one
    let left = main.filter(|context| !passed.contains(&context.leg.id));
    let left = left.filter_map(|context| {
        let (leg, stage) = (&context.leg.id, &context.stage.id);
        let reason = (*refused.get(leg)?).to_owned();
        let is_earlier = |id: &Id| place(id).is_some_and(|at| Some(at) < place(leg));
        let earlier = preview.legs.iter().rposition(|passage| is_earlier(&passage.place.leg));
        Some(LeftOut {
            leg: leg.clone(),
            stage: stage.clone(),
            reason,
            before: earlier.map_or(0, |index| index + 1),
        })
    });
    left.collect()
}

fn refusal(event: &Event) -> Option<(&Id, &str)> {
    match event {
        Event::PatternRefused { leg, reason } => Some((leg, reason)),
        _ => None,
    }
}

/// Stages and legs of the main plan by their place in the document.
fn places(flown: &FlightPlan) -> HashMap<&Id, (usize, usize)> {
    let stages = flown.stages.iter().enumerate().map(|(index, stage)| (&stage.id, (index, 0)));
    let mut places: HashMap<&Id, (usize, usize)> = stages.collect();
    let main = flown.all_legs().into_iter().filter(|context| context.section == Section::Main);
    for (index, context) in main.enumerate() {
        let stage = places.get(&context.stage.id).map_or(0, |place| place.0);
        places.insert(&context.leg.id, (stage, index + 1));
    }
    places
}

#[cfg(test)]
mod tests {
    use super::super::preview::Forecaster;
    use aircraft::Profile;
    use flight_exec::rehearse::WhatIf;
    use flight_plan::compile;
    use geometry::LatLon;
    use std::sync::Arc;
    use terrain::Terrain;

    #[derive(Debug)]
    struct Nothing;

    impl Terrain for Nothing {
        fn elevation_m(&self, _: LatLon) -> Option<f64> {
            None
        }
    }

    #[test]
    fn a_leg_in_a_loop_is_left_out_though_the_loop_comes_by() {
        let text = include_str!("../../../assets/plans/square.xml");
        let (plain, high) = (r#"<TF id="side3" fix="C"/>"#, r#"altitude="120" altitudeReference="agl""#);
        let body = format!(r#"<TF id="l1" fix="B"/><TF id="l2" fix="C" {high}/>"#);
        let there = format!(
            r#"<iterative id="loop" form="reverse" count="2" turn="left"><IF id="l0" fix="A"/>{body}</iterative>"#
        );
        assert!(text.contains(plain));
        let plan = flight_plan::read(text.replace(plain, &there)).plan;
        let (profile, ground): (_, Arc<dyn Terrain>) = (Profile::default(), Arc::new(Nothing));
        let program = Arc::new(compile(plan, &profile, ground.as_ref()).unwrap());
        let forecast = Forecaster::new(profile, ground).fly(&program, &WhatIf::default()).unwrap();
        let left: Vec<_> = forecast.left_out.iter().map(|l| l.leg.as_str()).collect();
        assert_eq!(left, ["l2"]);
        assert!(forecast.passages.iter().any(|passage| passage.reverse), "and comes back");
    }

    #[test]
    fn a_leg_above_a_ground_that_is_not_known_is_left_out_between_its_neighbours() {
        let square = include_str!("../../../assets/plans/square.xml");
        let agl = |text: String, leg: &str, fix: &str| {
            let plain = format!(r#"<TF id="{leg}" fix="{fix}"/>"#);
            let raised = format!(r#"<TF id="{leg}" fix="{fix}" altitude="120" altitudeReference="agl"/>"#);
            assert!(text.contains(&plain));
            text.replace(&plain, &raised)
        };
        let text = agl(agl(square.to_owned(), "side2", "B"), "side3", "C");
        let plan = flight_plan::read(text).plan;
        let (profile, ground): (_, Arc<dyn Terrain>) = (Profile::default(), Arc::new(Nothing));
        let program = Arc::new(compile(plan, &profile, ground.as_ref()).unwrap());
        let forecast = Forecaster::new(profile, ground).fly(&program, &WhatIf::default()).unwrap();
        let left: Vec<_> = forecast.left_out.iter().map(|l| (l.leg.as_str(), l.stage.as_str())).collect();
        assert_eq!(left, [("side2", "circuit"), ("side3", "circuit")]);
        for left in &forecast.left_out {
            assert!(left.reason.contains("elevation"), "{}", left.reason);
            let next = &forecast.passages[left.before];
            let before = &forecast.passages[left.before - 1];
            assert_eq!((before.leg.as_str(), next.leg.as_str()), ("side1", "side4"));
        }
    }
}
