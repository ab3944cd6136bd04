//! The other direction of a runway, on the ground at its own end.

use crate::airfields::Ground;
use flight_plan::{Edit, FlightPlan, Id, Runway, Thing, create};
use terrain::Terrain;

/// What adds it, wherever that is offered.
pub const ADD_OTHER: &str = "Add its other direction";

/// What is less is what an elevation was rounded by, metres.
const ROUNDED_M: f64 = 1.0;

/// Its other direction as it would be added.
///
/// # Errors
/// Why there is none to be added.
pub fn other_direction(plan: &FlightPlan, of: &Id, ground: &dyn Terrain) -> Result<Runway, &'static str> {
    let runway = plan.runway(of).ok_or("It is no longer in the plan")?;
    if plan.opposite(runway).is_some() {
        return Err("Its other direction is in the plan already");
    }
    Ok(create::other_direction(plan, runway, elevation_m(runway, ground)))
}

/// The edit that adds it, and what it is called.
///
/// # Errors
/// As [`other_direction`].
pub fn add_other_direction(
    plan: &FlightPlan,
    of: &Id,
    ground: &dyn Terrain,
) -> Result<(Id, Edit), &'static str> {
    let other = other_direction(plan, of, ground)?;
    Ok((other.id.clone(), Edit::Add(Box::new(Thing::Runway(other)))))
}

/// How high its other end is, metres AMSL: as the ground there, from the elevation that it begins with; as that where no ground is known.
fn elevation_m(runway: &Runway, ground: &dyn Terrain) -> f64 {
    let end = runway.from_other_end().threshold;
    match Ground::of(ground, end) {
        // coarse elevations lie as far off at the one end as at the other
        Ground::Elevations(amsl_m) => {
            let off_m = ground
                .elevation_m(runway.threshold)
                .map_or(0.0, |begins_m| runway.elevation_amsl_m - begins_m);
            if off_m.abs() < ROUNDED_M { amsl_m } else { amsl_m + off_m }
        }
        Ground::Airport(amsl_m, _) => amsl_m,
        Ground::Unknown => runway.elevation_amsl_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    /// Rises to the east.
    struct Slope;

    impl Terrain for Slope {
        fn elevation_m(&self, at: LatLon) -> Option<f64> {
            Some(300.0 + 1000.0 * (at.lon_deg - 9.0))
        }
    }

    struct Unknown;

    impl Terrain for Unknown {
        fn elevation_m(&self, _: LatLon) -> Option<f64> {
            None
        }
    }

    #[test]
    fn the_other_direction_begins_as_high_as_its_own_end_is() {
        // far from any airport
        let (threshold, end) = (LatLon::new(40.0, 9.0 - 50.0), LatLon::new(40.0, 9.01 - 50.0));
        let mut plan = FlightPlan::default();
        let drawn = |amsl_m| create::runway(&FlightPlan::default(), threshold, end, amsl_m);
        struct There;
        impl Terrain for There {
            fn elevation_m(&self, at: LatLon) -> Option<f64> {
                Slope.elevation_m(LatLon::new(at.lat_deg, at.lon_deg + 50.0))
            }
        }
        let mut height_m = |amsl_m, ground: &dyn Terrain| {
            plan.runways = vec![drawn(amsl_m)];
            let id = plan.runways[0].id.clone();
            other_direction(&plan, &id, ground).map(|other| other.elevation_amsl_m)
        };
        assert_eq!(height_m(300.0, &There), Ok(310.0));
        assert_eq!(height_m(322.0, &There), Ok(332.0), "the elevations are off at both ends");
        assert_eq!(height_m(322.0, &Unknown), Ok(322.0), "nothing is known there");
    }
}
