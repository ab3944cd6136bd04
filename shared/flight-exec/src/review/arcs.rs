//! `rf-not-on-circle`, `rf-not-tangent`: an RF begins where nobody knows before the flight (behind an FA, which ends where the
//! altitude is reached), and there it is not on its circle, or not on its course.
//!
//! The check of the plan says so where the plan says where the leg before ends; here it is asked of the path as it is laid out.

use super::View;
use super::flown::Flown;
use super::layout::LaidOut;
use crate::layout::path::{distance_and_course, distance_m};
use aircraft::glide::turn_rad;
use flight_plan::{LegKind, Problem, TurnDirection};
use geometry::LatLon;

/// Corner that is still called tangent, degrees.
const TANGENT_DEG: f64 = 1.0;
/// Two positions nearer than this are the same place, metres.
const SAME_PLACE_M: f64 = 1.0;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    for flown in view.flights.all() {
        let passages = flown.waypoints.chunk_by(|a, b| a.passage == b.passage);
        let mut before: &[LaidOut] = &[];
        for passage in passages {
            problems.extend(Arc::of(view, before, passage).and_then(|arc| arc.problem(view, flown)));
            before = passage;
        }
    }
}

/// An RF as it is laid out behind another leg.
struct Arc<'a> {
    before: &'a [LaidOut],
    waypoints: &'a [LaidOut],
    /// Where the leg before ends.
    begins: LatLon,
    centre: LatLon,
    radius_m: f64,
    turn: TurnDirection,
}

impl<'a> Arc<'a> {
    fn of(view: &View, before: &'a [LaidOut], waypoints: &'a [LaidOut]) -> Option<Self> {
        let (last, begins) = (waypoints.last()?, before.last()?.waypoint.position);
        let LegKind::Rf { centre, turn, .. } = view.program.leg(&last.waypoint.leg)?.kind else {
            return None;
        };
        let radius_m = distance_m(centre, last.waypoint.position);
        Some(Self { before, waypoints, begins, centre, radius_m, turn })
    }

    fn problem(&self, view: &View, flown: &Flown) -> Option<Problem> {
        let leg = &self.waypoints.first()?.waypoint.leg;
        let before = &self.before.last()?.waypoint.leg;
        let from = if flown.emergency.is_some() { ", as this emergency plan is entered," } else { "" };
        let advice = "put a leg that ends at its start (DF, CF) before it, or move the arc";
        if let Some(off_m) = self.led_onto_circle_m() {
            let message = format!("{advice}: `{before}` ends{from} {off_m:.0} m off the circle of this arc");
            return Some(Problem::error("rf-not-on-circle", message).of(leg));
        }
        let corner_deg = self.corner_deg().filter(|deg| *deg > TANGENT_DEG)?;
        let until_altitude = matches!(view.program.leg(before)?.kind, LegKind::Fa { .. });
        let message = format!("{advice}: between `{before}` and this arc the path turns by {corner_deg:.0}°");
        until_altitude.then(|| Problem::error("rf-not-tangent", message).of(leg))
    }

    /// How far off the circle the leg before ends, if the path is led straight onto it from there.
    fn led_onto_circle_m(&self) -> Option<f64> {
        let (out_m, bearing_deg) = distance_and_course(self.centre, self.begins);
        let off_m = (out_m - self.radius_m).abs();
        let joins = self.centre.destination(bearing_deg, self.radius_m);
        // in reverse it is come back to its end first, which has its own place on the circle
        let is_led = distance_m(self.waypoints.first()?.waypoint.position, joins) < SAME_PLACE_M;
        (off_m > SAME_PLACE_M && is_led).then_some(off_m)
    }

    /// By how much the path turns where the arc begins.
    fn corner_deg(&self) -> Option<f64> {
        let from = self.before.iter().rev().nth(1)?.waypoint.position;
        let (_, comes_deg) = distance_and_course(from, self.begins);
        let (_, out_deg) = distance_and_course(self.centre, self.begins);
        let side_deg = if self.turn == TurnDirection::Right { 90.0 } else { -90.0 };
        Some(turn_rad(comes_deg, out_deg + side_deg).to_degrees())
    }
}

#[cfg(test)]
mod tests {
    use crate::review::{Conditions, review};
    use aircraft::Profile;
    use flight_plan::compile_document;
    use geometry::LatLon;
    use std::sync::Arc;
    use terrain::{Flat, Terrain};

    /// From A an FA climbs by 300 m to the north; behind it comes an arc of 600 m to the right, whose centre is so far ahead of A and
    /// to the right of the track.
    fn found(ahead_m: f64, right_m: f64) -> Vec<&'static str> {
        let a = LatLon::new(36.3, -84.2);
        let centre = a.destination(0.0, ahead_m).destination(90.0, right_m);
        let end = centre.destination(0.0, 600.0);
        let document = format!(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="Test" aircraft="trainer">
                 <fixes><fix id="A" lat="{}" lon="{}"/></fixes>
                 <mainPlan><stage id="s" type="en-route" altitude="500" altitudeReference="amsl">
                   <IF id="a" fix="A"/><FA id="f" fix="A" course="0" altitude="800" altitudeReference="amsl"/>
                   <RF id="r" lat="{}" lon="{}" centreLat="{}" centreLon="{}" turn="right"/>
                 </stage></mainPlan>
               </flightPlan>"#,
            a.lat_deg, a.lon_deg, end.lat_deg, end.lon_deg, centre.lat_deg, centre.lon_deg
        );
        let (profile, ground): (_, Arc<dyn Terrain>) = (Profile::default(), Arc::new(Flat(300.0)));
        let program = compile_document(document.as_bytes(), &profile, ground.as_ref());
        let program = Arc::new(program.unwrap_or_else(|problems| panic!("{problems:?}")));
        let problems = review(&program, &profile, &ground, Conditions::default());
        problems.iter().map(|p| p.code).filter(|code| code.starts_with("rf-")).collect()
    }

    #[test]
    fn an_arc_behind_a_climb_begins_where_the_climb_ends() {
        // in steps of 500 m along the track, at 4 m/s
        let ends_m =
            (1..20).map(|step| 500.0 * f64::from(step)).find(|ahead_m| found(*ahead_m, 600.0).is_empty());
        assert!(ends_m.is_some(), "one place suits");
        let ends_m = ends_m.unwrap();
        assert_eq!(found(ends_m + 600.0, 0.0), ["rf-not-tangent"]);
        assert_eq!(found(ends_m, 800.0), ["rf-not-on-circle"]);
        assert_eq!(found(ends_m - 400.0, 600.0), ["rf-not-on-circle"]);
        assert_eq!(found(11_000.0, 600.0), ["rf-not-on-circle"]);
    }
}
