//! What all templates have in common: places around the runway, heights above it, the way out and the way home.

use super::{HOLD_M, Outline, Template, above_home, fix, hold, leg, stage, to};
use crate::{Altitude, Fix, Id, Leg, LegKind, Place, PlanWaypoint, Runway, Stage, StageKind, TurnDirection};
use aircraft::Profile;
use geometry::{LatLon, LocalFrame, Vec2};
use std::{f64::consts::TAU, sync::Arc};
use terrain::Terrain;

/// Height above the runway at which a take-off ends, metres.
const CLIMB_OUT_M: f64 = 80.0;
/// Above the highest ground on the way, metres.
const CLEARANCE_M: f64 = 150.0;
/// Of the final above the ground under it, metres.
const LOWEST_M: f64 = 60.0;
/// Descent on the final, metres down per metre forward.
pub(crate) const GLIDE_SLOPE: f64 = 0.075;
/// A place on the final stands for the gate from so far before it on, metres.
const GATE_ROOM_M: f64 = 300.0;
/// Share of what an aircraft can fly that its mission's tracks may take; the rest is for climbs, turns and the way there.
const TRACKS: f64 = 0.25;
/// The same of a survey with its turns.
const SURVEYED: f64 = 0.5;
/// The ground is looked at in a grid of so many by so many places.
const GRID: u32 = 32;
/// Along the ways themselves, from place to place, metres; so many places at most.
const WAY_STEP_M: f64 = 100.0;
const MOST_STEPS: f64 = 1000.0;
/// Around what is flown, turn radii.
const ROOM: f64 = 6.0;
/// Around a hold, turn radii.
const HOLD_ROOM: f64 = 1.5;
/// Towards which it is asked how far a mission reaches.
const DIRECTIONS: usize = 16;

/// Climb-out altitude of a take-off.
pub(crate) fn climb_out() -> Altitude {
    above_home(CLIMB_OUT_M)
}

/// What all templates have in common: places around the runway, and heights above it.
pub(super) struct Frame<'a> {
    pub(super) runway: &'a Runway,
    pub(super) turn_radius_m: f64,
    /// The length of tracks that the energy allows, metres.
    pub(super) tracks_m: f64,
    /// The same of a survey's with the turns between them, metres.
    pub(super) surveyed_m: f64,
    /// From the threshold to the departure's fix, metres.
    ahead_m: f64,
    /// From the threshold back to the beginning and to the gate of the final, metres.
    pub(super) final_m: f64,
    pub(super) gate_m: f64,
    /// Of the mission, metres above the runway.
    pub(super) height_m: f64,
    /// The same above the highest ground around, metres.
    pub(super) above_ground_m: f64,
    /// Of the highest ground under the final, metres above the runway.
    hill_m: f64,
    /// Of that under the hold where the final begins, metres above the runway.
    hold_hill_m: f64,
    /// The fixes where the final begins, and lower on it.
    pub(super) final_fix: Id,
    pub(super) gate_fix: Id,
}

impl<'a> Frame<'a> {
    pub(super) fn new(outline: &'a Outline, profile: &Profile, terrain: &dyn Terrain) -> Self {
        let turn_radius_m = profile.turn_radius_m(profile.cruise_airspeed_mps);
        let range_m = profile.energy_j / profile.cruise_power_w * profile.cruise_airspeed_mps;
        let mut frame = Self {
            runway: &outline.runway,
            turn_radius_m,
            tracks_m: TRACKS * range_m,
            surveyed_m: SURVEYED * range_m,
            ahead_m: outline.runway.length_m + (8.0 * turn_radius_m).max(1000.0),
            final_m: (20.0 * turn_radius_m).max(2600.0),
            gate_m: (9.0 * turn_radius_m).max(1200.0),
            height_m: outline.height_m,
            above_ground_m: outline.height_m,
            hill_m: 0.0,
            hold_hill_m: 0.0,
            final_fix: "FINAL".into(),
            gate_fix: "GATE".into(),
        };
        frame.hill_m = frame.hill_on_final(terrain);
        frame.hold_hill_m = frame.hill_below_hold(terrain);
        let hilltop_m = frame.highest_ground(outline, terrain) - outline.runway.elevation_amsl_m;
        frame.height_m = (outline.height_m.max(hilltop_m + CLEARANCE_M) / 10.0).ceil() * 10.0;
        frame.above_ground_m = frame.height_m - hilltop_m;
        frame
    }

    /// The highest known ground of the mission and of the ways to it and home from anywhere in it, with room for turns, metres AMSL;
    /// the runway's own where none is known.
    fn highest_ground(&self, outline: &Outline, terrain: &dyn Terrain) -> f64 {
        let frame = LocalFrame::new(self.runway.threshold);
        let own = [self.at(self.ahead_m, 0.0), self.at(-self.final_m, 0.0), self.at(0.0, self.side_m())];
        let places = outline.extent.corners(self.runway.heading_deg).into_iter().chain(own);
        let flown = Surroundings::of(&places.map(|at| frame.to_local(at)).collect::<Vec<_>>());
        // the grid alone is too coarse for a ridge across a narrow corridor
        let ways: Vec<Vec2> = self.ways(outline).into_iter().map(|at| frame.to_local(at)).collect();
        let along = ways.windows(2).filter_map(<[Vec2]>::as_array).flat_map(|[from, to]| along(*from, *to));
        flown
            .grid(ROOM * self.turn_radius_m)
            .chain(along)
            .filter_map(|at| terrain.elevation_m(frame.to_geo(at)))
            .fold(self.runway.elevation_amsl_m, f64::max)
    }

    /// The way to the final over these places no higher than its first one is flown, metres AMSL, unless the ground below it asks for more.
    pub(super) fn no_higher_than(&mut self, flown_amsl_m: f64, over: &[LatLon], terrain: &dyn Terrain) {
        let frame = LocalFrame::new(self.runway.threshold);
        let places = over.iter().copied().chain([self.at(-self.final_m, 0.0)]);
        let way: Vec<Vec2> = places.map(|at| frame.to_local(at)).collect();
        let below = way.windows(2).filter_map(<[Vec2]>::as_array).flat_map(|[from, to]| along(*from, *to));
        let elevation_m = self.runway.elevation_amsl_m;
        let ground = below.filter_map(|at| terrain.elevation_m(frame.to_geo(at)));
        let least_m = ground.fold(elevation_m, f64::max) - elevation_m + 2.0 * LOWEST_M;
        let flown_m = ((flown_amsl_m - elevation_m) / 10.0).floor() * 10.0;
        self.height_m = self.height_m.min(flown_m.max((least_m / 10.0).ceil() * 10.0));
        self.height_m = self.height_m.max(self.final_height_m());
    }

    /// From the departure along the mission's line, or around its area, to the final; and from either end to both.
    fn ways(&self, outline: &Outline) -> Vec<LatLon> {
        let heading_deg = self.runway.heading_deg;
        let line = match outline.template {
            Template::Corridor | Template::Patrol => outline.extent.line(heading_deg),
            _ => outline.extent.corners(heading_deg),
        };
        let (out, home) = (self.at(self.ahead_m, 0.0), self.at(-self.final_m, 0.0));
        let ends = [line.first().copied(), line.last().copied()];
        let [first, last] = ends.map(|end| end.unwrap_or(out));
        [vec![out], line, vec![home, first, last, out]].concat()
    }

    /// The highest known ground between the final's beginning and its gate, metres above the runway.
    fn hill_on_final(&self, terrain: &dyn Terrain) -> f64 {
        let share = |i: u32| self.gate_m + (self.final_m - self.gate_m) * f64::from(i) / f64::from(GRID);
        let ground = (0..=GRID).filter_map(|i| terrain.elevation_m(self.at(-share(i), 0.0)));
        ground.fold(0.0, |hill_m: f64, at_m| hill_m.max(at_m - self.runway.elevation_amsl_m))
    }

    /// The highest known ground below the hold where the final begins, to its right, and around it, metres above the runway.
    fn hill_below_hold(&self, terrain: &dyn Terrain) -> f64 {
        let (room_m, share) = (HOLD_ROOM * self.turn_radius_m, |i: u32| f64::from(i) / f64::from(GRID));
        let back_m = |i: u32| self.final_m - room_m + (HOLD_M + 2.0 * room_m) * share(i);
        let right_m = |j: u32| (2.0 * self.turn_radius_m + 2.0 * room_m) * share(j) - room_m;
        let grid = (0..=GRID).flat_map(|i| (0..=GRID).map(move |j| (i, j)));
        let ground = grid.filter_map(|(i, j)| terrain.elevation_m(self.at(-back_m(i), right_m(j))));
        ground.fold(0.0, |hill_m: f64, at_m| hill_m.max(at_m - self.runway.elevation_amsl_m))
    }

    /// So many metres in the runway's direction from its threshold, and to its right.
    pub(super) fn at(&self, ahead_m: f64, right_m: f64) -> LatLon {
        let heading_deg = self.runway.heading_deg;
        self.runway.threshold.destination(heading_deg, ahead_m).destination(heading_deg + 90.0, right_m)
    }

    /// From the runway's line to the downwind of a circuit, metres.
    fn side_m(&self) -> f64 {
        (5.0 * self.turn_radius_m).max(900.0)
    }

    /// Of the glide slope, so many metres before the threshold.
    fn slope_height_m(&self, before_m: f64) -> f64 {
        (before_m * GLIDE_SLOPE).min(self.final_height_m()).max(self.hill_m + LOWEST_M).round()
    }

    /// The final leads over a gate, unless one of these places on it is there already: metres before the threshold.
    pub(super) fn has_gate(&self, over: &[(f64, Place)]) -> bool {
        over.iter().all(|(before_m, _)| *before_m > self.gate_m + GATE_ROOM_M)
    }

    /// Not above the mission: a mission that ends beside the final would leave no room to climb there.
    fn final_height_m(&self) -> f64 {
        let least_m = (self.hill_m + 2.0 * LOWEST_M).max(self.hold_hill_m + LOWEST_M);
        (self.final_m * GLIDE_SLOPE).min(self.height_m).max(least_m).round()
    }

    pub(super) fn fixes(&self) -> Vec<Fix> {
        vec![
            fix("DEP", self.at(self.ahead_m, 0.0)),
            fix(self.final_fix.as_str(), self.at(-self.final_m, 0.0)),
            fix(self.gate_fix.as_str(), self.at(-self.gate_m, 0.0)),
        ]
    }

    pub(super) fn take_off(&self) -> Stage {
        let (runway, altitude) = (Some(self.runway.id.clone()), Some(above_home(CLIMB_OUT_M)));
        Stage { runway, altitude, ..stage("take-off", "Take-off", StageKind::TakeOff) }
    }

    /// Ahead of the runway, and up in a hold to the mission's height.
    pub(super) fn departure(&self) -> Stage {
        let heading_deg = self.runway.heading_deg;
        let climb = LegKind::Ha(hold("DEP", heading_deg, TurnDirection::Right));
        let legs = vec![
            Leg {
                altitude: Some(above_home(CLIMB_OUT_M + 20.0)),
                ..leg("d1", "Runway track", LegKind::Tf(to("DEP")))
            },
            Leg { altitude: Some(above_home(self.height_m)), ..leg("d2", "Climb in the hold", climb) },
        ];
        let legs = legs.into_iter().map(Arc::new).collect();
        Stage { legs, ..stage("departure", "Departure", StageKind::Departure) }
    }

    /// Downwind, beside the runway.
    pub(super) fn circuit(&self, fixes: &mut Vec<Fix>) -> Vec<Leg> {
        fixes.push(fix("CROSS", self.at(self.ahead_m, self.side_m())));
        fixes.push(fix("DOWN", self.at(-self.gate_m, self.side_m())));
        vec![
            leg("crosswind", "Crosswind", LegKind::Tf(to("CROSS"))),
            leg("downwind", "Downwind", LegKind::Tf(to("DOWN"))),
        ]
    }

    /// Down the final from its beginning: over these places, so many metres before the threshold, and the gate.
    fn approach(&self, prefix: &str, over: &[(f64, Place)]) -> Vec<Leg> {
        let mut places = over.to_vec();
        if self.has_gate(over) {
            places.push((self.gate_m, Place::Fix(self.gate_fix.clone())));
        }
        places.sort_by(|one, other| other.0.total_cmp(&one.0));
        let legs = places.into_iter().enumerate().map(|(index, (before_m, place))| {
            let kind = LegKind::Tf(PlanWaypoint { place, fly_over: false });
            let altitude = Some(above_home(self.slope_height_m(before_m)));
            Leg { altitude, ..leg(&format!("{prefix}ap{}", index + 1), "Final approach", kind) }
        });
        legs.collect()
    }

    /// From anywhere to the runway. `prefix`: of the identifiers; `over`: places of the final, so many metres before the threshold.
    pub(super) fn way_home(&self, prefix: &str, over: &[(f64, Place)]) -> Vec<Stage> {
        let id = |text: &str| format!("{prefix}{text}");
        let holding = hold(self.final_fix.as_str(), self.runway.heading_deg, TurnDirection::Right);
        let (height_m, final_m) = (self.height_m, self.final_height_m());
        let line_up = if height_m > final_m { LegKind::Ha(holding) } else { LegKind::Hf(holding) };
        let direct = LegKind::Df { to: to(self.final_fix.as_str()), turn: None };
        let arrival = vec![
            Leg { altitude: Some(above_home(height_m)), ..leg(&id("a1"), "Direct to the final", direct) },
            Leg { altitude: Some(above_home(final_m)), ..leg(&id("a2"), "Descend in the hold", line_up) },
        ];
        let approach = self.approach(prefix, over);
        let runway = Some(self.runway.id.clone());
        vec![
            Stage {
                legs: arrival.into_iter().map(Arc::new).collect(),
                ..stage(&id("arrival"), "Arrival", StageKind::Arrival)
            },
            Stage {
                legs: approach.into_iter().map(Arc::new).collect(),
                ..stage(&id("approach"), "Approach", StageKind::Approach)
            },
            Stage { runway, ..stage(&id("land"), "Landing", StageKind::Land) },
        ]
    }
}

/// The places of a straight way that are looked at.
fn along(from: Vec2, to: Vec2) -> impl Iterator<Item = Vec2> {
    let count = ((to - from).length() / WAY_STEP_M).ceil().clamp(1.0, MOST_STEPS) as u32;
    (0..=count).map(move |i| from + (to - from) * (f64::from(i) / f64::from(count)))
}

/// How far some places reach in each of some directions: with so many, all that lies between them and little else.
struct Surroundings([(Vec2, f64); DIRECTIONS]);

impl Surroundings {
    fn of(places: &[Vec2]) -> Self {
        Self(std::array::from_fn(|index| {
            let towards = Vec2::from_bearing_rad(index as f64 * TAU / DIRECTIONS as f64);
            (towards, places.iter().map(|at| at.dot(towards)).fold(f64::MIN, f64::max))
        }))
    }

    /// A grid of places between them and so far around, metres.
    fn grid(&self, room_m: f64) -> impl Iterator<Item = Vec2> {
        // north, east, south and west
        let [north, east, south, west] = [0, 1, 2, 3].map(|side| self.0[side * DIRECTIONS / 4].1 + room_m);
        let share = |i: u32, from: f64, to: f64| from + (to - from) * f64::from(i) / f64::from(GRID);
        let grid = (0..=GRID).flat_map(move |i| (0..=GRID).map(move |j| (i, j)));
        grid.map(move |(i, j)| Vec2 { e: share(i, -west, east), n: share(j, -south, north) })
            .filter(move |at| self.0.iter().all(|(towards, reach_m)| at.dot(*towards) <= reach_m + room_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::template::Extent;

    /// Flat ground with one hill, so narrow that no grid over a corridor of 40 km finds it.
    struct Hill(LatLon);
    impl Terrain for Hill {
        fn elevation_m(&self, at: LatLon) -> Option<f64> {
            Some(if at.distance_m(self.0) < 90.0 { 900.0 } else { 300.0 })
        }
    }

    #[test]
    fn a_ridge_across_a_narrow_corridor_is_flown_over() {
        let threshold = LatLon::new(46.0, 8.0);
        let runway = Runway {
            id: "R".into(),
            threshold,
            elevation_amsl_m: 300.0,
            heading_deg: 90.0,
            length_m: 500.0,
            priority: 1,
            approach_entry: None,
        };
        let (from, far_m, course_deg) = (threshold.destination(45.0, 6_000.0), 40_000.0, 45.0);
        let extent = Extent::Drawn(vec![from, from.destination(course_deg, far_m)]);
        let outline = Outline {
            template: Template::Corridor,
            aircraft: "trainer".into(),
            runway,
            extent,
            height_m: 150.0,
        };
        let height_m = |terrain: &dyn Terrain| outline.mission_height_m(&Profile::default(), terrain);
        assert_eq!(height_m(&terrain::Flat(300.0)), 150.0);
        for share in [0.111, 0.254, 0.398, 0.517, 0.693, 0.875] {
            let hill = Hill(from.destination(course_deg, share * far_m));
            assert!(height_m(&hill) >= 600.0 + CLEARANCE_M, "{share}");
        }
    }
}
