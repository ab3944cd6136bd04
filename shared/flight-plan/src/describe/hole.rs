//! A new hole of an area: a square where there is most room for it.

use super::first::{position, text};
use crate::Element;
use geometry::{LatLon, LocalFrame, Polygon, Vec2};

/// From its middle to its corners at most, metres.
const LARGEST_M: f64 = 200.0;
/// So many by so many places of the area are tried.
const GRID: u32 = 24;

/// Inside the outline that these corners are, and outside of the holes that are there. `None`: the corners are no area.
pub(super) fn inside(parts: &[Element]) -> Option<Element> {
    let outer = corners(parts);
    let holes: Vec<_> =
        parts.iter().filter(|part| part.name == "hole").map(|hole| corners(&hole.children)).collect();
    let frame = LocalFrame::around(&outer)?;
    let area = Polygon::from_geo(&frame, &outer, &holes).ok()?;
    let (middle, room_m) = widest(&area)?;
    let reach_m = (room_m / 2.0).min(LARGEST_M);
    let corner = |quarter: u32| {
        let bearing_rad = (f64::from(quarter) * 90.0 + 45.0).to_radians();
        let at = text(frame.to_geo(middle + Vec2::from_bearing_rad(bearing_rad) * reach_m));
        let (lat, lon) = at.split_once(' ')?;
        let attributes = vec![("lat".into(), lat.into()), ("lon".into(), lon.into())];
        Some(Element { name: "corner".into(), attributes, children: Vec::new() })
    };
    let children = (0..4).map(corner).collect::<Option<_>>()?;
    Some(Element { name: "hole".into(), children, ..Element::default() })
}

/// Where the corners among these are.
pub(super) fn corners(parts: &[Element]) -> Vec<LatLon> {
    let at =
        |corner: &Element| position(&format!("{} {}", corner.attribute("lat")?, corner.attribute("lon")?));
    parts.iter().filter(|part| part.name == "corner").filter_map(at).collect()
}

/// The place that is farthest from all edges, and how far that is, metres; of places that are equal the one nearest to the middle.
fn widest(area: &Polygon) -> Option<(Vec2, f64)> {
    let span = |of: fn(&Vec2) -> f64| {
        let values = || area.outer().iter().map(of);
        (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
    };
    let (east, north) = (span(|corner| corner.e), span(|corner| corner.n));
    let share = |(from, to): (f64, f64), i: u32| from + (to - from) * f64::from(i) / f64::from(GRID);
    let grid = (1..GRID).flat_map(|i| (1..GRID).map(move |j| (i, j)));
    let middle = area.centroid();
    let places = grid.map(|(i, j)| Vec2::new(share(east, i), share(north, j))).chain([middle]);
    let inside = places.filter(|place| area.contains(*place));
    let worth = |(place, room_m): &(Vec2, f64)| room_m - 0.01 * (*place - middle).length();
    inside
        .map(|place| (place, area.distance_to_edge_m(place)))
        .max_by(|one, other| worth(one).total_cmp(&worth(other)))
}

#[cfg(test)]
mod tests {
    use super::super::parts::HOLE;
    use super::super::{Change, Draft, Subject};
    use crate::{Area, FlightPlan, LegKind, Scan, check, read};
    use aircraft::Profile;
    use terrain::Flat;

    /// North of the runway; the second one is a bent strip, whose middle is outside.
    const SQUARE: &str = r#"<corner lat="36.34" lon="-84.22"/><corner lat="36.34" lon="-84.18"/><corner lat="36.37" lon="-84.18"/><corner lat="36.37" lon="-84.22"/>"#;
    const BENT: &str = r#"<corner lat="36.34" lon="-84.22"/><corner lat="36.34" lon="-84.16"/><corner lat="36.40" lon="-84.16"/><corner lat="36.40" lon="-84.17"/><corner lat="36.35" lon="-84.17"/><corner lat="36.35" lon="-84.22"/>"#;

    fn plan(corners: &str) -> FlightPlan {
        read(format!(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="holes" aircraft="trainer"><mainPlan><stage id="m" type="mission">
            <scan id="s" spacing="300"><area>{corners}</area></scan></stage></mainPlan></flightPlan>"#
        ))
        .plan
    }

    /// The plan with one hole more, as the inspector adds it.
    fn with_hole(plan: &FlightPlan) -> FlightPlan {
        let draft = Draft::of(plan, &Subject::Leg("s".into())).unwrap();
        let area = draft.element().children.iter().position(|child| child.name == "area").unwrap();
        draft.edit(plan, &[area], &Change::Add(&HOLE)).unwrap().apply(plan).unwrap()
    }

    #[test]
    fn a_new_hole_is_in_its_area_and_beside_the_others() {
        for corners in [SQUARE, BENT] {
            let mut plan = plan(corners);
            for holes_by_now in 1..=3 {
                plan = with_hole(&plan);
                let errors: Vec<String> = check(&plan, &Profile::default(), &Flat(300.0))
                    .iter()
                    .filter(|problem| problem.code == "bad-polygon")
                    .map(ToString::to_string)
                    .collect();
                assert_eq!(errors, Vec::<String>::new());
                let leg = &plan.leg(&"s".into()).unwrap().leg.kind;
                let LegKind::Scan(Scan { area: Area::Polygon { holes, .. }, .. }) = leg else { panic!() };
                assert_eq!(holes.len(), holes_by_now);
            }
        }
    }
}
