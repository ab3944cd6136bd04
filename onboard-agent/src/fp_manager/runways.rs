//! Pure: a plan's runways as the gateway stores them for Safe mode.

use flight_plan::{FlightPlan, Runway};
use usal::contract::SafeRunway;

/// The best runways of a plan, best first.
pub fn safe_runways(plan: &FlightPlan) -> Vec<SafeRunway> {
    flight_exec::safe_runways(plan).into_iter().map(safe_runway).collect()
}

fn safe_runway(runway: &Runway) -> SafeRunway {
    SafeRunway {
        id: runway.id.to_string(),
        threshold: runway.threshold,
        elevation_amsl_m: runway.elevation_amsl_m,
        heading_deg: runway.heading_deg,
        length_m: runway.length_m,
        priority: runway.priority,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_plan::Id;

    fn runway(n: u32) -> Runway {
        Runway {
            id: Id::new(&format!("r{n}")),
            threshold: geometry::LatLon::new(36.0, -84.0),
            elevation_amsl_m: 300.0,
            heading_deg: f64::from(n),
            length_m: 800.0,
            priority: n,
            approach_entry: None,
        }
    }

    #[test]
    fn the_best_come_first_and_no_more_than_the_gateway_stores() {
        let plan = FlightPlan { runways: (1..=40).rev().map(runway).collect(), ..FlightPlan::default() };
        let priorities: Vec<u32> = safe_runways(&plan).iter().map(|r| r.priority).collect();
        assert_eq!(priorities, (1..=32).collect::<Vec<_>>());
    }
}
