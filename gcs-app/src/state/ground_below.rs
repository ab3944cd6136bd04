//! The ground below an aircraft: on a runway of its plan as high as that is said to be, elsewhere as the elevations have it. Those are
//! coarse, and lie many metres off where a runway was cut or filled.

use aircraft::glide_in::End;
use flight_plan::{Id, Runway};
use geometry::LatLon;
use terrain::Terrain;

/// How high the ground is.
#[derive(Debug, Clone, PartialEq)]
pub struct GroundBelow {
    /// Metres AMSL.
    pub amsl_m: f64,
    /// The runway that says so.
    pub runway: Option<Id>,
}

impl GroundBelow {
    /// At a place; `None`: it is not known there.
    pub fn at(place: LatLon, runways: &[Runway], terrain: &dyn Terrain) -> Option<Self> {
        let runway = runways.iter().find(|runway| runway.strip().is_stood_on(place));
        match runway {
            Some(runway) => {
                let amsl_m = elevation_m(runway, runways, place);
                Some(Self { amsl_m, runway: Some(runway.id.clone()) })
            }
            None => Some(Self { amsl_m: terrain.elevation_m(place)?, runway: None }),
        }
    }
}

/// Of a place on a runway, which slopes from its threshold to that of its other direction, metres AMSL.
fn elevation_m(runway: &Runway, runways: &[Runway], place: LatLon) -> f64 {
    let end = |runway: &Runway| End { strip: runway.strip(), elevation_amsl_m: runway.elevation_amsl_m };
    let begins_m = runway.elevation_amsl_m;
    let ends_m =
        end(runway).opposite(runways.iter().map(end), |_| None).map_or(begins_m, |end| end.elevation_amsl_m);
    let share = runway.threshold.distance_m(place) / runway.length_m.max(1.0);
    begins_m + (ends_m - begins_m) * share.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::Flat;

    fn runway(id: &str, threshold: LatLon, heading_deg: f64, elevation_amsl_m: f64) -> Runway {
        let (length_m, priority, approach_entry) = (600.0, 1, None);
        Runway { id: id.into(), threshold, elevation_amsl_m, heading_deg, length_m, priority, approach_entry }
    }

    #[test]
    fn a_runway_is_as_high_as_it_is_said_to_be_and_slopes_to_its_other_direction() {
        let (threshold, coarse) = (LatLon::new(36.32, -84.17), Flat(372.0));
        let along = |metres| threshold.destination(52.0, metres);
        let one = runway("R05", threshold, 52.0, 350.0);
        let both = [one.clone(), runway("R23", along(600.0), 232.0, 356.0)];
        let below = |place, runways: &[Runway]| {
            let ground = GroundBelow::at(place, runways, &coarse).unwrap();
            (ground.amsl_m.round(), ground.runway.map(|id| id.to_string()))
        };
        let of = |id: &str| Some(id.to_owned());
        assert_eq!(
            below(along(300.0), std::slice::from_ref(&one)),
            (350.0, of("R05")),
            "nothing says that it slopes"
        );
        assert_eq!(below(along(300.0), &both), (353.0, of("R05")));
        assert_eq!(below(along(640.0), &both), (356.0, of("R05")), "just behind its end");
        assert_eq!(below(along(300.0).destination(142.0, 80.0), &both), (372.0, None), "beside it");
    }
}
