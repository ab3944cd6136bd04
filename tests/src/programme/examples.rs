//! The example plans, laid around where the aircraft stands.

use super::{Scenario, land_by_plan};
use crate::laid::laid;
use crate::plans::Field;
use crate::rig::Rig;
use anyhow::ensure;
use usal::contract::{Phase, PlanEvent};

/// Their names, and the plans.
pub const EXAMPLES: [(&str, &str); 7] = [
    ("example_alternates", include_str!("../../../assets/plans/alternates.xml")),
    ("example_coast_patrol", include_str!("../../../assets/plans/coast-patrol.xml")),
    ("example_fire_watch", include_str!("../../../assets/plans/fire-watch.xml")),
    ("example_navaid_inspection", include_str!("../../../assets/plans/navaid-inspection.xml")),
    ("example_pipeline", include_str!("../../../assets/plans/pipeline.xml")),
    ("example_search", include_str!("../../../assets/plans/search.xml")),
    ("example_square", include_str!("../../../assets/plans/square.xml")),
];

/// A scenario for each of them, by its number.
macro_rules! examples {
    ($($number:literal: $what:literal;)*) => {
        pub const SCENARIOS: &[Scenario] = &[$(Scenario {
            name: EXAMPLES[$number].0,
            happens: concat!("nothing; the example plan ", $what),
            expected: "the plan is flown to its end, and nobody decides anything",
            plan: |field| around(EXAMPLES[$number].1, field),
            simulator: &["--wind", "270,5"],
            fly: |rig| Box::pin(to_its_end(rig)),
        },)*];
    };
}

examples! {
    0: "`alternates`: a ridge survey";
    1: "`coast-patrol`: a bay and a coast, twice";
    2: "`fire-watch`: three rounds, a ridge patrol";
    3: "`navaid-inspection`: figure eight, orbits, radials";
    4: "`pipeline`: a corridor, photographed and filmed";
    5: "`search`: expanding square and sectors";
    6: "`square`: once around the field";
}

/// The plan around a field. How high the ground is there is not known, and a camera is told how high it is over the field.
fn around(plan: &str, field: Field) -> anyhow::Result<String> {
    laid(&plan.replace("fieldOfView=", "height=\"500\" fieldOfView="), field)
}

async fn to_its_end(rig: &mut Rig) -> anyhow::Result<()> {
    land_by_plan(rig).await?;
    let finishes = |event: &PlanEvent| matches!(event, PlanEvent::PhaseChanged { phase: Phase::Finished });
    rig.until("the end of the plan", 30.0, |_, seen| seen.plan.iter().any(finishes)).await?;
    let in_emergency = rig.seen.plan.iter().any(|event| matches!(event, PlanEvent::EmergencyStarted { .. }));
    ensure!(!in_emergency, "it flew an emergency plan");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    const ELSEWHERE: Field =
        Field { threshold: LatLon::new(-35.3633, 149.1652), elevation_m: 584.0, heading_deg: 353.0 };

    #[test]
    fn every_example_can_be_flown_elsewhere() {
        for (name, plan) in EXAMPLES {
            let laid = around(plan, ELSEWHERE).unwrap();
            let reading = flight_plan::read(laid.as_bytes());
            assert!(reading.problems.is_empty(), "{name}: {:?}", reading.problems);
            let flat = terrain::Flat(ELSEWHERE.elevation_m);
            let problems = flight_plan::compile(reading.plan, &aircraft::Profile::default(), &flat).err();
            assert!(problems.is_none(), "{name}: {problems:#?}");
        }
    }
}
