//! Giving out points, with their altitudes; circling at the end of a leg.

use super::{Cursor, CursorLog, CursorPhase, Emission, Step};
use crate::api::{Action, TERRAIN_MARGIN_M};
use crate::layout::expand::Point;
use crate::layout::homeward::{arrival, halts};
use crate::layout::path::{PathEnd, PathState, distance_and_course};
use crate::layout::world::World;
use crate::value::Choice;
use aircraft::glide::GlideStart;
use aircraft::power::glide_sink_mps;
use flight_plan::{Act, StageKind, Trigger};

/// Each waypoint may lie so much beyond what the aircraft climbs on the way to it, metres, so that it never waits for its
/// target, however wide it turns. The gateway grants ten.
const CLIMB_LEAD_M: f64 = 8.0;

impl Cursor {
    /// Seconds to be circled at the end of the leg before it is left.
    pub(super) fn wait_due(&self, world: &World, notes: &mut CursorLog) -> Option<f64> {
        let leg = self.leg(world).filter(|leg| !leg.actions.is_empty() && self.expansion.is_some())?;
        if world.waited == Some(self.passage) {
            return None;
        }
        let inside = self.inside(world);
        let seconds = leg.actions.iter().map(|action| match (&action.trigger, &action.act) {
            (Trigger::End, Act::Wait { seconds }) => {
                notes.value(&leg.id, inside.number(seconds)).unwrap_or(0.0)
            }
            _ => 0.0,
        });
        Some(seconds.map(|s: f64| s.max(0.0)).sum()).filter(|s| *s > 0.0)
    }

    pub(super) fn wait(&mut self, seconds: f64, notes: CursorLog, world: &World) -> Step {
        // what was left for the wait stays left, whatever its condition says afterwards
        let leaves = notes.choices.iter().any(|c| matches!(c, Choice::Hold { .. }));
        let doing = if leaves { CursorPhase::Leaving } else { self.doing };
        let sealed = (!notes.is_empty()).then(|| Box::new(Cursor { doing, ..self.clone() }));
        let circle = self.circle_here(world);
        // the end of a leg that was left may be over unknown ground: there the altitude stays
        let amsl_m = circle.level.and_then(|level| world.amsl_m(level, circle.position, self.home.as_ref()));
        let emission = self.emit(circle, amsl_m.unwrap_or(self.path.commanded_amsl_m), world);
        Step::Waypoint(Box::new(Emission { wait_s: Some(seconds), notes, sealed, ..emission }))
    }

    /// Circling at the end of the path, as high and as fast as it was passed; where the leg has passed nothing, at its own
    /// altitude and speed.
    pub(super) fn circle_here(&self, world: &World) -> Point {
        let last = &self.path.last;
        let own = (self.level, self.airspeed_mps);
        let (level, mps) = if self.given == 0 { own } else { (last.level, last.airspeed_mps) };
        Point {
            action: Action::Loiter { radius_m: world.turn_radius_m(mps) },
            level: Some(level),
            airspeed_mps: Some(mps),
            ..Point::fly(last.position)
        }
    }

    /// How far it can descend and climb on a way, metres; with the engine out it descends, however little it is asked to.
    ///
    /// A climb is spread over the waypoints of its leg: nobody could fly it between two of them, and the gateway refuses such a gradient.
    fn vertical_room_m(&self, length_m: f64, airspeed_mps: f64, world: &World) -> (f64, f64) {
        let (profile, seconds) = (world.profile, length_m / world.ground_speed_mps(airspeed_mps));
        let descent_m = profile.max_descent_mps * seconds;
        let climb_m = match world.glides_in {
            Some(_) => (-glide_sink_mps(profile, airspeed_mps, 1.0) * seconds).max(-descent_m),
            None => profile.max_climb_mps * seconds,
        };
        (descent_m, climb_m)
    }

    /// With the engine out: an altitude below which the glide home from a point would be short of its reserve, metres AMSL. No height is
    /// given away there. The points of a landing say so themselves: in its circles the way is not that by what lies behind.
    fn kept_for_the_glide(&self, point: Point, course_deg: f64, world: &World) -> f64 {
        let needed_m = || {
            let (wind, section) = (world.glides_in?, self.section?);
            let stage = world.program.stages(Some(section)).get(self.stage)?;
            if stage.kind == StageKind::Land {
                return None;
            }
            let runway = &world.program.flown().emergency_plans.get(section)?.runway;
            let runway = world.program.plan.runway(runway)?;
            let top = self.loops.first().map_or(self.index, |outermost| outermost.index);
            let ahead = halts(world, section, (self.stage, top + 1));
            let from = GlideStart { position: point.position, altitude_amsl_m: 0.0, course_deg };
            let arrival = arrival(world, wind, from, ahead.iter().filter_map(|halt| halt.place), runway)?;
            Some(-arrival.spare_m())
        };
        needed_m().unwrap_or(f64::NEG_INFINITY)
    }

    /// With the engine out: the altitude that a waypoint is told at least, metres AMSL, as far as what it has there lets it: some autopilots
    /// circle a waypoint until they have its altitude. A way that has less leads into the ground, and no gateway takes it.
    fn least_in_a_glide(point: Point, world: &World) -> f64 {
        let ground_m = world.glides_in.and_then(|_| world.terrain.elevation_m(point.position));
        ground_m.map_or(f64::NEG_INFINITY, |metres| metres + TERRAIN_MARGIN_M)
    }

    /// The waypoint at a point, `altitude_amsl_m` high, and the path up to it.
    pub(super) fn emit(&mut self, point: Point, altitude_amsl_m: f64, world: &World) -> Emission {
        let level = point.level.unwrap_or(self.level);
        let airspeed_mps = point.airspeed_mps.unwrap_or(self.airspeed_mps);
        let from = self.rejoined.take().map_or(self.path, |path| *path);
        let (length_m, course_deg) = distance_and_course(from.last.position, point.position);
        let time_s = length_m / airspeed_mps.max(1.0);
        let altitude_amsl_m = self.kept_for_the_glide(point, course_deg, world).max(altitude_amsl_m);
        let (descent_m, climb_m) = self.vertical_room_m(length_m, airspeed_mps, world);
        let towards = |from_m: f64, lead_m: f64| {
            altitude_amsl_m.max(from_m - descent_m - lead_m).min(from_m + climb_m + lead_m)
        };
        let (commanded_amsl_m, predicted_amsl_m) = match point.action {
            Action::TakeOff { .. } => (altitude_amsl_m, altitude_amsl_m),
            Action::Land { .. } => (altitude_amsl_m, towards(from.predicted_amsl_m, 0.0)),
            Action::Fly | Action::Loiter { .. } => {
                // ahead of the aircraft, and from the waypoint before it no steeper than the gateway grants
                let ahead_m = towards(from.predicted_amsl_m, CLIMB_LEAD_M);
                let (down_m, up_m) = (descent_m + CLIMB_LEAD_M, climb_m + CLIMB_LEAD_M);
                let commanded_m =
                    ahead_m.max(from.commanded_amsl_m - down_m).min(from.commanded_amsl_m + up_m);
                let predicted_m = towards(from.predicted_amsl_m, 0.0);
                let least_m = Self::least_in_a_glide(point, world).min(predicted_m + CLIMB_LEAD_M);
                (commanded_m.max(least_m), predicted_m)
            }
        };
        self.path = PathState {
            last: PathEnd { position: point.position, level, airspeed_mps, fly_over: point.fly_over },
            course_deg: if length_m > 0.5 { course_deg } else { from.course_deg },
            predicted_amsl_m,
            commanded_amsl_m,
            distance_m: from.distance_m + length_m,
            time_s: from.time_s + time_s,
        };
        self.given += 1;
        if matches!(point.action, Action::Loiter { .. }) {
            self.doing = CursorPhase::Waiting;
        }
        Emission {
            position: point.position,
            altitude_amsl_m: commanded_amsl_m,
            airspeed_mps,
            action: point.action,
            fly_over: point.fly_over,
            on_arc: point.on_arc,
            wait_s: None,
            notes: CursorLog::default(),
            sealed: None,
        }
    }
}
