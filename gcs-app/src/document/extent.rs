//! How much there is to be drawn of a plan.

use flight_plan::{Area, FlightPlan, Leg, LegKind, Pattern, Scan, Zone, ZoneShape};
use std::sync::Arc;

/// What is worked out of a plan with more parts takes longer than a frame has.
const MOST_PARTS: usize = 20_000;

/// So much that no frame can wait until it is looked through.
pub(super) fn is_large(plan: &FlightPlan) -> bool {
    let stages: usize = plan.all_stages().map(|(_, stage)| of_legs(&stage.legs)).sum();
    let procedures: usize = plan.procedures.iter().map(|procedure| of_legs(&procedure.legs)).sum();
    let zones: usize = plan.zones.iter().map(of_zone).sum();
    stages + procedures + zones + plan.fixes.len() > MOST_PARTS
}

fn of_legs(legs: &[Arc<Leg>]) -> usize {
    legs.iter().map(|leg| 1 + corners(leg) + of_legs(leg.body())).sum()
}

fn corners(leg: &Leg) -> usize {
    match &leg.kind {
        LegKind::Scan(Scan { area: Area::Polygon { corners, holes }, .. })
        | LegKind::Pattern(Pattern::Contour { area: Area::Polygon { corners, holes }, .. }) => {
            corners.len() + holes.iter().map(Vec::len).sum::<usize>()
        }
        LegKind::Pattern(Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. }) => route.len(),
        _ => 0,
    }
}

fn of_zone(zone: &Zone) -> usize {
    match &zone.shape {
        ZoneShape::Circle { .. } => 1,
        ZoneShape::Polygon(corners) => 1 + corners.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(inside: &str) -> FlightPlan {
        flight_plan::read(format!(r#"<flightPlan xmlns="urn:legwork:flight-plan:1">{inside}</flightPlan>"#))
            .plan
    }

    fn with_corners(corners: usize) -> FlightPlan {
        let corners: String = (0..corners).map(|n| format!(r#"<corner lat="46" lon="{n}e-6"/>"#)).collect();
        let scan = format!(r#"<scan id="s" spacing="300"><area>{corners}</area></scan>"#);
        let looped = format!(r#"<iterative id="l" count="2">{scan}</iterative>"#);
        read(&format!(r#"<mainPlan><stage id="m" type="mission">{looped}</stage></mainPlan>"#))
    }

    fn with_fixes(fixes: usize) -> FlightPlan {
        let fixes: String = (0..fixes).map(|n| format!(r#"<fix id="F{n}" lat="46" lon="9"/>"#)).collect();
        read(&format!("<fixes>{fixes}</fixes>"))
    }

    #[test]
    fn corners_and_fixes_make_a_plan_large_as_legs_do() {
        assert!(!is_large(&with_corners(MOST_PARTS - 2)) && is_large(&with_corners(MOST_PARTS - 1)));
        assert!(!is_large(&with_fixes(MOST_PARTS)) && is_large(&with_fixes(MOST_PARTS + 1)));
    }
}
