//! What an area or a zone covers, about: it stays where it is and as large as it is when it is said in another way.

use super::first::text;
use super::hole::corners;
use crate::{Element, Env, FlightPlan, FlightState, Variables, expression};
use geometry::{LatLon, LocalFrame, Polygon};
use std::f64::consts::{PI, TAU};

/// Corners of an outline that was a circle.
const CORNERS: u32 = 8;

/// A circle that covers about as much.
#[derive(Debug)]
pub(super) struct Extent {
    pub centre: LatLon,
    radius_m: f64,
}

impl Extent {
    /// `None`: it covers nothing, or only the flight says where.
    pub fn of(element: &Element, plan: &FlightPlan) -> Option<Self> {
        Self::of_outline(&outline(element, plan)).or_else(|| Self::of_circle(element, plan))
    }

    fn of_outline(corners: &[LatLon]) -> Option<Self> {
        let frame = LocalFrame::around(corners)?;
        let area = Polygon::from_geo(&frame, corners, &[]).ok()?;
        Some(Self { centre: frame.to_geo(area.centroid()), radius_m: (area.area_m2() / PI).sqrt() })
    }

    fn of_circle(element: &Element, plan: &FlightPlan) -> Option<Self> {
        let radius_m = element.attribute("radius")?.parse().ok().filter(|radius_m| *radius_m > 0.0)?;
        let number = |name: &str| element.attribute(name)?.parse::<f64>().ok();
        let written = || Some(LatLon::new(number("lat")?, number("lon")?));
        let fix = || Some(plan.fix(&element.attribute("fix")?.into())?.position);
        let formula = || with_formula(element, "centre", plan, |formula, env| formula.position(env).ok());
        let centre = fix().or_else(written).or_else(formula).filter(|at| at.is_valid())?;
        Some(Self { centre, radius_m })
    }

    /// Metres, as the document has it.
    pub fn radius(&self) -> String {
        self.radius_m.round().max(1.0).to_string()
    }

    /// Of an outline that covers as much.
    pub fn corners(&self) -> impl Iterator<Item = Element> {
        let step_rad = TAU / f64::from(CORNERS);
        // of a regular outline of that area
        let reach_m = self.radius_m * (step_rad / step_rad.sin()).sqrt();
        (0..CORNERS).filter_map(move |corner| {
            let bearing_deg = (f64::from(corner) * step_rad).to_degrees();
            let at = text(self.centre.destination(bearing_deg, reach_m));
            let (lat, lon) = at.split_once(' ')?;
            let attributes = vec![("lat".into(), lat.into()), ("lon".into(), lon.into())];
            Some(Element { name: "corner".into(), attributes, ..Element::default() })
        })
    }
}

/// Its corners, or those of the polygon that its formula gives at first.
fn outline(element: &Element, plan: &FlightPlan) -> Vec<LatLon> {
    let written = corners(&element.children);
    let formula = || with_formula(element, "polygon", plan, |formula, env| formula.polygon(env).ok());
    if written.is_empty() { formula().unwrap_or_default() } else { written }
}

fn with_formula<T>(
    element: &Element,
    attribute: &str,
    plan: &FlightPlan,
    value: impl FnOnce(&expression::Expression, &Env) -> Option<T>,
) -> Option<T> {
    let source = element.attribute(attribute)?.trim().trim_start_matches('=');
    let variables = Variables::initial(plan);
    let env = Env { variables: &variables, flight: FlightState::at_start(plan.home()) };
    value(&expression::compile(source, plan).ok()?, &env)
}

#[cfg(test)]
mod tests {
    use super::super::{Change, Draft, OneOf, Row, Subject};
    use super::*;
    use crate::{Area, FlightPlan, LegKind, Place, Scan, Value, read};

    const SQUARE: &str = r#"<corner lat="36.34" lon="-84.22"/><corner lat="36.34" lon="-84.18"/><corner lat="36.37" lon="-84.18"/><corner lat="36.37" lon="-84.22"/>"#;
    const MIDDLE: LatLon = LatLon::new(36.355, -84.20);

    fn plan(area: &str) -> FlightPlan {
        read(format!(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="areas" aircraft="trainer">
            <runways><runway id="R" lat="36.0" lon="-84.0" elevation="300" heading="52" length="600"/></runways>
            <fixes><fix id="F" lat="36.355" lon="-84.2"/></fixes>
            <variables><variable name="burnt" type="polygon" initial="36.34 -84.22, 36.34 -84.18, 36.37 -84.18, 36.37 -84.22"/>
            <variable name="fire" type="position" initial="36.355 -84.2"/></variables>
            <mainPlan><stage id="m" type="mission"><scan id="s" spacing="300">{area}</scan></stage></mainPlan></flightPlan>"#
        ))
        .plan
    }

    /// As the inspector says it in another way.
    fn said_as(plan: &FlightPlan, way: &str) -> FlightPlan {
        let draft = Draft::of(plan, &Subject::Leg("s".into())).unwrap();
        let path = [draft.element().children.iter().position(|child| child.name == "area").unwrap()];
        let Row::Children(areas) = super::super::parts::THE_AREA else { panic!() };
        let one: &OneOf = areas.of[0]
            .rows()
            .find_map(|row| match row {
                Row::OneOf(one) => Some(one),
                _ => None,
            })
            .unwrap();
        let way = one.ways.iter().position(|other| other.label == way).unwrap();
        draft.edit(plan, &path, &Change::Choose(*one, way)).unwrap().apply(plan).unwrap()
    }

    fn area(plan: &FlightPlan) -> Area {
        let LegKind::Scan(Scan { area, .. }) = &plan.leg(&"s".into()).unwrap().leg.kind else { panic!() };
        area.clone()
    }

    /// It went to the runway, 300 m around that.
    #[test]
    fn an_area_that_becomes_a_circle_stays_where_it_is_and_as_large() {
        for area_before in [format!("<area>{SQUARE}</area>"), r#"<area polygon="= burnt"/>"#.into()] {
            let changed = said_as(&plan(&area_before), "a circle at a position");
            let Area::Circle {
                centre: Place::Position(Value::Constant(at)),
                radius_m: Value::Constant(radius_m),
            } = area(&changed)
            else {
                panic!("{:?}", area(&changed))
            };
            assert!(at.distance_m(MIDDLE) < 5.0, "{at:?}");
            // 3587 m by 3329 m
            assert!((radius_m - 1949.0).abs() < 20.0, "{radius_m}");
        }
    }

    #[test]
    fn a_circle_that_becomes_an_outline_stays_where_it_is_and_as_large() {
        for circle in [r#"lat="36.355" lon="-84.2""#, r#"fix="F""#, r#"centre="= fire""#] {
            let plan = plan(&format!(r#"<area {circle} radius="500"/>"#));
            let changed = said_as(&plan, "an outline");
            let Area::Polygon { corners, .. } = area(&changed) else { panic!("{:?}", area(&changed)) };
            let extent = Extent::of_outline(&corners).unwrap();
            assert!(extent.centre.distance_m(MIDDLE) < 1.0, "{extent:?}");
            assert!((extent.radius_m - 500.0).abs() < 1.0, "{extent:?}");
            let again = said_as(&changed, "an outline");
            assert_eq!(area(&again), area(&changed), "it is that already");
        }
    }
}
