//! How far from the path that its author wrote a leg was flown. Preview and simulator share one flight model, so
//! that a deviation from the preview says only that they agree; this one is measured against the plan's own geometry.
//!
//! What counts, for each point of the flown track:
//! - TF: the cross-track distance from the geodesic between its two fixes, where its start is known: the leg flown
//!   before it ended at a fix (so not after a take-off, a scan or an orbit).
//! - RF: the distance from its circle, under the same condition.
//! - Orbit: the distance from its circle, with the variables' values at the end of the passage.
//! - Other legs (a scan's figure is its coverage): nothing.
//!
//! Only the settled part of a leg counts. Left out are, at both ends of a TF or RF, the zones in which the turn
//! onto the neighbouring leg lies: r · tan(A/2) and 100 m, with the turn's radius r at cruise speed before the wind and
//! its angle A, taken as 120° if greater or unknown; at the end of an orbit the same zone, by the way
//! flown. Left out is also what comes before the capture: the first point beyond the zone that is less than 10 m off and
//! on a course less than 10° off the path's. A leg that is never captured counts from its zone on.

use super::assemble::variables_at;
use super::deviation::Statistics;
use super::record::{Passage, PassageKey, Track, TrackPoint};
use flight_exec::Event;
use flight_plan::{Env, FlightPlan, FlightState, Id, LegKind, Place, Program, TurnDirection, Variables};
use geometry::path::course_change_deg;
use geometry::turn::anticipation_m;
use geometry::{LatLon, PathElement, Turn};
use std::collections::HashMap;

/// Added to a turn's anticipation: rolling in and out, metres.
const RESERVE_M: f64 = 100.0;
/// Turns count as at most this, and unknown ones as this, degrees.
const WIDEST_TURN_DEG: f64 = 120.0;
/// A captured path is nearer than this, metres.
const CAPTURED_M: f64 = 10.0;
/// On a captured path the course differs by less than this, degrees.
const CAPTURED_DEG: f64 = 10.0;

/// A leg's path by the plan's geometry alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AuthoredPath {
    /// The line or arc.
    pub element: PathElement,
    /// Flown any number of times round, from anywhere on it.
    pub is_orbit: bool,
    /// Metres after its start that don't count.
    pub start_zone_m: f64,
    /// Metres before its end that don't count.
    pub end_zone_m: f64,
}

/// The authored paths of a flown track's passages, as far as they have one. `plans` are the plan and its updates: the
/// newest that knows a leg says where it goes. The radius is that of a turn, metres.
pub fn paths(
    program: &Program,
    plans: &[&FlightPlan],
    flown: &Track,
    events: &[(f64, Event)],
    turn_radius_m: f64,
) -> HashMap<PassageKey, AuthoredPath> {
    let mut walk = Walk { program, plans, at: None, forward: HashMap::new() };
    let passages = flown.passages().iter().enumerate();
    let steps: Vec<Option<Step>> = passages
        .map(|(i, passage)| {
            let end_s = flown.points().get(flown.range(i).end).map_or(f64::INFINITY, |p| p.time_s);
            walk.step(passage, &variables_at(program, events, end_s))
        })
        .collect();
    let neighbour = |i: Option<usize>| steps.get(i?).copied().flatten().filter(|s| !s.is_orbit);
    let authored = |(i, passage): (usize, &Passage)| {
        let Step { element, is_orbit } = steps.get(i).copied().flatten()?;
        let before = neighbour(i.checked_sub(1))
            .map(|s| course_change_deg(s.element.end_course_deg(), element.start_course_deg()));
        let after = neighbour(Some(i + 1)).filter(|_| !is_orbit);
        let after = after.map(|s| course_change_deg(element.end_course_deg(), s.element.start_course_deg()));
        let path = AuthoredPath {
            element,
            is_orbit,
            start_zone_m: if is_orbit { 0.0 } else { zone_m(before, turn_radius_m) },
            end_zone_m: zone_m(after, turn_radius_m),
        };
        Some((passage.key.clone(), path))
    };
    flown.passages().iter().enumerate().filter_map(authored).collect()
}

/// Length of the zone about a turn that does not count, metres.
fn zone_m(turn_deg: Option<f64>, turn_radius_m: f64) -> f64 {
    let turn_deg = turn_deg.map_or(WIDEST_TURN_DEG, |d| d.abs().min(WIDEST_TURN_DEG));
    anticipation_m(turn_radius_m, turn_deg) + RESERVE_M
}

/// One passage's geometry.
#[derive(Clone, Copy)]
struct Step {
    element: PathElement,
    is_orbit: bool,
}

/// Follows the passages in the order of flight.
struct Walk<'a> {
    program: &'a Program,
    plans: &'a [&'a FlightPlan],
    /// The fix at which the previous passage ended.
    at: Option<LatLon>,
    /// Each leg's latest passage forwards.
    forward: HashMap<String, PathElement>,
}

impl Walk<'_> {
    fn step(&mut self, passage: &Passage, variables: &Variables) -> Option<Step> {
        if passage.kind == "turn-round" {
            // comes back to where it began
            return None;
        }
        let from = self.at.take();
        if passage.key.reverse {
            let element = self.forward.get(&passage.key.leg)?.reversed();
            self.at = Some(element.end());
            return Some(Step { element, is_orbit: false });
        }
        let id = Id::new(&passage.key.leg);
        let (plan, leg) = self.plans.iter().rev().find_map(|plan| Some((*plan, plan.leg(&id)?.leg)))?;
        self.at = self.end(plan, &leg.kind, variables);
        let step = self.forwards(plan, &leg.kind, from, variables)?;
        if !step.is_orbit {
            self.forward.insert(passage.key.leg.clone(), step.element);
        }
        Some(step)
    }

    fn forwards(
        &self,
        plan: &FlightPlan,
        kind: &LegKind,
        from: Option<LatLon>,
        variables: &Variables,
    ) -> Option<Step> {
        let (element, is_orbit) = match kind {
            LegKind::Tf(_) => (PathElement::Line { from: from?, to: self.at? }, false),
            LegKind::Rf { centre, turn, .. } => {
                (PathElement::arc_between(*centre, from?, self.at?, side(*turn)), false)
            }
            LegKind::Orbit { centre, radius_m, turn, .. } => {
                let centre = self.position(plan, centre, variables)?;
                let radius_m = self.program.eval_number(radius_m, &env(variables)).ok()?;
                let sweep_deg = 360.0 * side(*turn).sign();
                (PathElement::Arc { centre, radius_m, start_bearing_deg: 0.0, sweep_deg }, true)
            }
            _ => return None,
        };
        Some(Step { element, is_orbit })
    }

    /// The fix at which a leg ends.
    fn end(&self, plan: &FlightPlan, kind: &LegKind, variables: &Variables) -> Option<LatLon> {
        let to = match kind {
            LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, .. } | LegKind::Rf { to, .. } => to,
            LegKind::Hf(holding) | LegKind::Ha(holding) => &holding.fix,
            _ => return None,
        };
        self.position(plan, &to.place, variables)
    }

    fn position(&self, plan: &FlightPlan, place: &Place, variables: &Variables) -> Option<LatLon> {
        match place {
            Place::Fix(id) => plan.fix(id).map(|fix| fix.position),
            Place::Position(value) => self.program.eval_position(value, &env(variables)).ok(),
        }
    }
}

fn side(turn: TurnDirection) -> Turn {
    match turn {
        TurnDirection::Left => Turn::Left,
        TurnDirection::Right => Turn::Right,
    }
}

/// Places that depend on the flight itself have no authored position; the ground stands in for it.
fn env(variables: &Variables) -> Env<'_> {
    Env { variables, flight: FlightState::on_ground(LatLon::new(0.0, 0.0)) }
}

/// Deviations of a passage's points from its authored path; `None` if it has no settled part.
pub fn deviation(path: &AuthoredPath, points: &[TrackPoint]) -> Option<Statistics> {
    let settled = if path.is_orbit { before_exit(path, points) } else { between_zones(path, points) };
    let begin = settled.windows(2).position(|w| is_captured(w[0], w[1])).unwrap_or(0);
    Statistics::of(settled.iter().skip(begin).map(|(_, offset_m)| offset_m.abs()).collect())
}

/// Positions and offsets between the zones of a line or arc.
fn between_zones(path: &AuthoredPath, points: &[TrackPoint]) -> Vec<(LatLon, f64)> {
    let settled_m = path.start_zone_m..=path.element.length_m() - path.end_zone_m;
    let nearest = points.iter().map(|p| (p.position, path.element.nearest(p.position)));
    nearest
        .filter(|(_, near)| settled_m.contains(&near.distance_m))
        .map(|(p, near)| (p, near.cross_track_m))
        .collect()
}

/// Positions and offsets up to the last metres flown.
fn before_exit(path: &AuthoredPath, points: &[TrackPoint]) -> Vec<(LatLon, f64)> {
    let mut left_m = 0.0;
    let steps = points.windows(2).rev().take_while(|w| {
        left_m += w[0].position.distance_m(w[1].position);
        left_m < path.end_zone_m
    });
    let settled = points.len().saturating_sub(steps.count() + 1);
    let offset_m = |p: LatLon| path.element.nearest(p).cross_track_m;
    points.iter().take(settled).map(|p| (p.position, offset_m(p.position))).collect()
}

/// Near the path and nearly parallel to it.
fn is_captured((here, offset_m): (LatLon, f64), (next, next_m): (LatLon, f64)) -> bool {
    let aside_m = here.distance_m(next) * CAPTURED_DEG.to_radians().sin();
    offset_m.abs() < CAPTURED_M && (next_m - offset_m).abs() < aside_m
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOME: LatLon = LatLon::new(36.3, -84.2);

    fn line() -> AuthoredPath {
        let element = PathElement::Line { from: HOME, to: HOME.destination(40.0, 3000.0) };
        AuthoredPath { element, is_orbit: false, start_zone_m: 300.0, end_zone_m: 300.0 }
    }

    fn arc(is_orbit: bool) -> AuthoredPath {
        let element =
            PathElement::Arc { centre: HOME, radius_m: 400.0, start_bearing_deg: 90.0, sweep_deg: -270.0 };
        AuthoredPath { element, is_orbit, start_zone_m: 100.0, end_zone_m: 100.0 }
    }

    /// Flown along an element, every 10 m, each point as far to the right as `aside` says of its way.
    fn flown(element: PathElement, aside: impl Fn(f64) -> f64) -> Vec<TrackPoint> {
        let steps = (element.length_m() / 10.0) as u32;
        let point = |i: u32| {
            let pose = element.pose_at(f64::from(i) * 10.0);
            let position = pose.position.destination(pose.bearing_end_deg + 90.0, aside(f64::from(i) * 10.0));
            TrackPoint { time_s: f64::from(i), position, altitude_amsl_m: 500.0 }
        };
        (0..=steps).map(point).collect()
    }

    #[test]
    fn an_offset_is_found_as_it_is() {
        for path in [line(), arc(false), arc(true)] {
            for aside_m in [5.0, -5.0, 40.0] {
                let s = deviation(&path, &flown(path.element, |_| aside_m)).unwrap();
                let found = [s.rms_m, s.max_m].map(|m| (m - aside_m.abs()).abs() < 0.01);
                assert_eq!(found, [true, true], "{aside_m} m aside: {s:?} on {path:?}");
            }
        }
    }

    #[test]
    fn end_zones_do_not_count_and_the_middle_does() {
        for path in [line(), arc(false)] {
            let end_m = path.element.length_m() - path.end_zone_m;
            let in_zone = |at_m: f64| at_m < path.start_zone_m - 5.0 || at_m > end_m + 5.0;
            let cut = deviation(&path, &flown(path.element, |m| if in_zone(m) { 80.0 } else { 1.0 }));
            assert!(cut.unwrap().max_m < 1.01, "{cut:?} on {path:?}");
            let middle = path.element.length_m() / 2.0;
            let bump = |m: f64| if (m - middle).abs() < 20.0 { 30.0 } else { 1.0 };
            assert!((deviation(&path, &flown(path.element, bump)).unwrap().max_m - 30.0).abs() < 0.1);
        }
    }

    #[test]
    fn what_comes_before_the_capture_does_not_count() {
        for path in [line(), arc(true)] {
            // comes in at 30°, then stays 2 m aside
            let s = deviation(&path, &flown(path.element, |m| (350.0 - 0.5 * m).max(2.0))).unwrap();
            assert!((s.max_m - 2.0).abs() < 0.1, "{s:?} on {path:?}");
        }
    }

    #[test]
    fn an_orbit_is_left_before_it_ends() {
        let path = arc(true);
        let end_m = path.element.length_m() - 80.0;
        let s = deviation(&path, &flown(path.element, |m| (0.5 * (m - end_m)).max(0.0))).unwrap();
        assert!(s.max_m < 0.01, "{s:?}");
    }

    #[test]
    fn short_legs_have_no_settled_part() {
        let element = PathElement::Line { from: HOME, to: HOME.destination(40.0, 500.0) };
        assert_eq!(deviation(&AuthoredPath { element, ..line() }, &flown(element, |_| 0.0)), None);
    }

    #[test]
    fn only_legs_between_fixes_have_a_path_and_turns_widen_the_zones() {
        let terrain = crate::assets::demo_terrain();
        let profile = aircraft::Profile::by_name("trainer").unwrap();
        let document = crate::assets::FIRE_WATCH.as_bytes();
        let program = flight_plan::compile_document(document, &profile, terrain.as_ref()).unwrap();
        let mut track = Track::default();
        for (leg, kind, reverse) in [
            ("d1", "TF", false),
            ("d2", "RF", false),
            ("d3", "TF", false),
            ("look", "orbit", false),
            ("regroup", "TF", false),
            ("to-ridge", "TF", false),
            ("p2", "TF", false),
            ("patrol", "turn-round", true),
            ("p2", "TF", true),
        ] {
            let key = PassageKey { leg: leg.into(), iterations: String::new(), reverse, occurrence: 0 };
            track.begin(key, kind, String::new());
        }
        let paths = paths(&program, &[&program.plan], &track, &[], 150.0);
        let of = |leg: &str, reverse| paths.iter().find(|(k, _)| k.leg == leg && k.reverse == reverse);
        assert!(of("d1", false).is_none() && of("regroup", false).is_none() && paths.len() == 6);
        let (_, there) = of("p2", false).unwrap();
        let (_, back) = of("p2", true).unwrap();
        assert_eq!(there.element.reversed(), back.element);
        let (_, after_arc) = of("d3", false).unwrap();
        assert!(after_arc.start_zone_m < 110.0, "tangential: {after_arc:?}");
        let widest_m = 150.0 * 60.0_f64.to_radians().tan() + 100.0;
        assert!((after_arc.end_zone_m - widest_m).abs() < 1e-6, "unknown: {after_arc:?}");
    }
}
