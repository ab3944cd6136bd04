//! Where patterns end: some at a place that is in the document, others at least within a circle.

use super::inspection::Inspection;
use super::patterns::LARGEST_M;
use super::spacings::spacing_m;
use super::step::Step;
use crate::{Altitude, AltitudeReference, Area, LegKind, Pattern, Place, Scan, TurnDirection};
use geometry::geodesy::MAX_LATITUDE_DEG;
use geometry::pattern::{ExpandingSquare, Route, SquareParameters, TrackLine, TrackLineParameters, Vertex};
use geometry::{LatLon, LocalFrame, Turn, Vec2};

/// What distances that are added up in the plane may be off on the earth, as far as [`Region::MAX_M`], metres.
const ROOM_M: f64 = 5.0;
/// Length of a degree of latitude where it is shortest, metres.
const LEAST_DEGREE_M: f64 = 110_574.0;

/// The circle in which a point of the path lies, if its exact place is not known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Region {
    pub centre: LatLon,
    pub radius_m: f64,
    pub altitude_amsl_m: Option<f64>,
}

impl Region {
    /// Farther away and larger nothing is said of it, metres.
    const MAX_M: f64 = 50_000.0;

    /// The least and the greatest distance that the point can have from a place, metres.
    pub fn distances_m(&self, place: LatLon) -> Option<(f64, f64)> {
        let metres = self.centre.distance_m(place);
        let reach_m = self.reach_m();
        (metres + reach_m <= Self::MAX_M).then_some(((metres - reach_m).max(0.0), metres + reach_m))
    }

    /// All of it is near enough to a place for something to be said of the two.
    pub fn is_near(&self, place: LatLon) -> bool {
        self.distances_m(place).is_some()
    }

    /// A part of it is too near to a pole to be flown over.
    pub fn reaches_pole(&self) -> bool {
        self.centre.lat_deg.abs() + self.reach_m() / LEAST_DEGREE_M > MAX_LATITUDE_DEG
    }

    /// Its radius with some room, metres.
    pub fn reach_m(&self) -> f64 {
        self.radius_m + ROOM_M
    }
}

/// Where a pattern ends, if the end does not depend on where it is entered.
pub(super) fn end_of(view: &Inspection, step: &Step, pattern: &Pattern) -> Option<LatLon> {
    match pattern {
        Pattern::FigureEight { centre, .. } | Pattern::Sector { centre, .. } => view.place(centre),
        // around a hole it ends on the side that it was entered from
        Pattern::Spiral { centre, inner_radius_m, inward: true, .. } => {
            view.number(inner_radius_m).filter(|m| *m == 0.0).and_then(|_| view.place(centre))
        }
        Pattern::ExpandingSquare { centre, heading_deg, radius_m, turn, .. } => {
            let frame = LocalFrame::new(view.place(centre)?);
            let (spacing_m, radius_m) = (spacing_m(view, step)?, view.number(radius_m)?);
            let p = SquareParameters {
                centre: Vec2::default(),
                spacing_m,
                heading_deg: view.number(heading_deg)?,
                turn: side(*turn),
                legs: ExpandingSquare::legs_to_cover(radius_m, spacing_m).ok()?,
            };
            let square = ExpandingSquare::new(&p).ok()?;
            position(&frame, square.vertex(square.count().checked_sub(1)?)?)
        }
        Pattern::TrackLine { route, returns, .. } => beside(view, route, spacing_m(view, step)?, *returns),
        _ => None,
    }
}

/// The end of the last pass beside a route.
fn beside(view: &Inspection, route: &[Place], spacing_m: f64, returns: bool) -> Option<LatLon> {
    let places = places(view, route)?;
    let frame = LocalFrame::around(&places)?;
    let points: Vec<Vec2> = places.iter().map(|place| frame.to_local(*place)).collect();
    if points.iter().any(|point| point.length() > frame.radius_m()) {
        return None;
    }
    let p = TrackLineParameters { spacing_m, returns, pairs: 1, first_side: Turn::Right };
    let line = TrackLine::new(&Route::new(&points).ok()?, &p).ok()?;
    position(&frame, line.vertex(line.count().checked_sub(1)?)?)
}

fn position(frame: &LocalFrame, vertex: Vertex) -> Option<LatLon> {
    let near = vertex.at.length() <= frame.radius_m();
    near.then(|| frame.to_geo(vertex.at)).filter(|place| place.is_valid())
}

fn side(turn: TurnDirection) -> Turn {
    match turn {
        TurnDirection::Left => Turn::Left,
        TurnDirection::Right => Turn::Right,
    }
}

fn places(view: &Inspection, route: &[Place]) -> Option<Vec<LatLon>> {
    route.iter().map(|place| view.place(place)).collect()
}

/// Where a leg ends at the farthest, if it is one that stays within a circle.
pub(super) fn region_of(view: &Inspection, step: &Step) -> Option<Region> {
    let (centre, radius_m) = match &step.leg.kind {
        LegKind::Orbit { centre, radius_m, .. }
        | LegKind::Pattern(
            Pattern::Spiral { centre, outer_radius_m: radius_m, .. }
            | Pattern::Sector { centre, radius_m, .. },
        ) => (view.place(centre)?, view.number(radius_m)?),
        LegKind::Scan(scan) => scanned(view, step, scan)?,
        LegKind::Pattern(Pattern::Corridor { route, width_m, .. }) => {
            let (centre, radius_m) = around(&places(view, route)?)?;
            (centre, radius_m + view.number(width_m)? + beyond_m(view, step)?)
        }
        LegKind::Pattern(Pattern::Contour { area, inward: true, .. }) => extent(view, area)?,
        _ => return None,
    };
    let good = radius_m > 0.0 && radius_m <= LARGEST_M;
    good.then(|| Region { centre, radius_m, altitude_amsl_m: altitude_amsl_m(view, step, centre) })
}

/// Tracks go on beyond the area for their turns.
fn scanned(view: &Inspection, step: &Step, scan: &Scan) -> Option<(LatLon, f64)> {
    let (centre, radius_m) = extent(view, &scan.area)?;
    Some((centre, radius_m + view.number(&scan.overshoot_m)?.max(0.0) + beyond_m(view, step)?))
}

/// No track ends farther beyond what it covers than this, metres: its turn takes half of it.
fn beyond_m(view: &Inspection, step: &Step) -> Option<f64> {
    Some(2.0 * view.turn_radius_m(step.speed_mps) + spacing_m(view, step)?)
}

/// An area that services change is nowhere for certain.
pub(super) fn extent(view: &Inspection, area: &Area) -> Option<(LatLon, f64)> {
    match area {
        Area::Circle { centre, radius_m } => Some((view.place(centre)?, view.number(radius_m)?)),
        Area::Polygon { corners, .. } => around(corners),
        Area::Expression(_) => None,
    }
}

fn around(places: &[LatLon]) -> Option<(LatLon, f64)> {
    let centre = LocalFrame::around(places)?.origin();
    Some((centre, places.iter().map(|place| centre.distance_m(*place)).fold(0.0, f64::max)))
}

/// How high a leg ends whose end may be anywhere; above the ground that is not known.
fn altitude_amsl_m(view: &Inspection, step: &Step, centre: LatLon) -> Option<f64> {
    match (&step.leg.kind, step.altitude()) {
        (LegKind::Pattern(Pattern::Contour { level_step_m: Some(_), .. }), _) => None,
        (_, Some(Altitude { reference: AltitudeReference::Agl, .. })) => None,
        (_, Some(altitude)) => view.altitude_amsl_m(altitude, centre, step.around.home_m),
        (_, None) => step.entry_altitude_amsl_m(),
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, codes, document, plan_with};

    const CENTRE: &str = r#"<centre fix="C"/>"#;

    /// A pattern about C, 3.3 km north of B, from which a track leads to a place.
    fn after(pattern: &str, (lat, lon): (f64, f64)) -> String {
        format!(r#"<IF id="a" fix="A"/>{pattern}<TF id="t" lat="{lat}" lon="{lon}"/>"#)
    }

    /// C, and so many metres east and north of it.
    fn off(east_m: f64, north_m: f64) -> (f64, f64) {
        (36.33 + north_m / 110_971.0, -84.17 + east_m / 89_794.0)
    }

    #[test]
    fn a_track_to_where_a_pattern_ends_has_no_length() {
        let square = |turn: &str, heading: u32| {
            format!(
                r#"<expandingSquare id="p" spacing="300" radius="900" heading="{heading}" turn="{turn}">{CENTRE}</expandingSquare>"#
            )
        };
        let spiral = |inner: u32| {
            format!(
                r#"<spiral id="p" innerRadius="{inner}" outerRadius="900" spacing="300" direction="inward" turn="left">{CENTRE}</spiral>"#
            )
        };
        let sector = format!(r#"<sector id="p" radius="2000" turn="left">{CENTRE}</sector>"#);
        let eight = format!(r#"<figureEight id="p" radius="300" turn="left">{CENTRE}</figureEight>"#);
        let line = |returns: bool| {
            format!(
                r#"<trackLine id="p" spacing="400" returns="{returns}"><route><point fix="C"/><point lat="36.33" lon="-84.12"/></route></trackLine>"#
            )
        };
        let nothing: &[&str] = &["zero-length"];
        check_legs(&[
            // three rings of four legs, and a leg of seven spacings more
            (&after(&square("right", 0), off(-900.0, 1200.0)), nothing),
            (&after(&square("left", 0), off(900.0, 1200.0)), nothing),
            (&after(&square("right", 90), off(1200.0, 900.0)), nothing),
            (&after(&square("right", 0), off(900.0, 1200.0)), &[]),
            (&after(&spiral(0), off(0.0, 0.0)), nothing),
            (&after(&spiral(200), off(0.0, 0.0)), &[]),
            (&after(&sector, off(0.0, 0.0)), nothing),
            (&after(&eight, off(0.0, 0.0)), nothing),
            // back on the left side
            (&after(&line(true), off(0.0, 200.0)), nothing),
            (&after(&line(true), off(0.0, -200.0)), &[]),
        ]);
    }

    fn orbit(attributes: &str, after: &str) -> String {
        format!(r#"<orbit id="o" radius="300" turn="left" {attributes}>{CENTRE}</orbit>{after}"#)
    }

    fn scan(after: &str) -> String {
        format!(r#"<scan id="o" spacing="300"><area fix="C" radius="500"/></scan>{after}"#)
    }

    fn to(metres: u32, lon: f64) -> String {
        format!(r#"<TF id="t" lat="36.33" lon="{lon}" altitude="{metres}" altitudeReference="amsl"/>"#)
    }

    /// 4 m/s at 25 m/s are 0.16 m a metre, from 500 m AMSL.
    #[test]
    fn what_is_too_steep_from_the_farthest_side_is_an_error() {
        let steep: &[&str] = &["too-steep"];
        // 2 km from the centre, at most 2305 m from the circle, and 2879 m from a scan with its turns
        let east = -84.17 + 2000.0 / 89_794.0;
        let in_ground = r#"altitude="200" altitudeReference="agl""#;
        check_legs(&[
            (&orbit("", &to(860, east)), &[]),
            (&orbit("", &to(880, east)), steep),
            (&orbit(in_ground, &to(880, east)), &[]),
            (&scan(&to(950, east)), &[]),
            (&scan(&to(1100, east)), steep),
            // a level that is taken over
            (
                &orbit(
                    "",
                    &format!(r#"<orbit id="p" radius="300" turn="left">{CENTRE}</orbit>{}"#, to(880, east)),
                ),
                steep,
            ),
        ]);
    }

    /// Nobody knows where a climb on a track ends, nor an area that a service gives.
    #[test]
    fn nothing_is_said_where_nothing_is_certain() {
        let climb =
            r#"<IF id="a" fix="A"/><FA id="f" fix="B" course="90" altitude="600" altitudeReference="amsl"/>"#;
        let east = -84.17 + 2000.0 / 89_794.0;
        check_legs(&[(&format!("{climb}{}", to(1500, east)), &[])]);
        let far = r#"<orbit id="o" radius="100000" turn="left"><centre fix="C"/></orbit>"#;
        assert_eq!(codes(&plan_with(&format!("{far}{}", to(2900, east)))), [""; 0]);
        let stage = format!(
            r#"<stage id="s" type="mission" altitude="500" altitudeReference="amsl">{}</stage>"#,
            orbit("", &to(880, east))
        );
        assert_eq!(codes(&document(&stage)), ["too-steep"], "without a take-off, too");
    }
}
