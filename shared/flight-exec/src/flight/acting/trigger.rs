//! When actions are due.

use super::{Done, Passage, Piece, Scene, is_wait};
use crate::api::Output;
use crate::layout::cursor::LayoutError;
use crate::layout::cursor::control::is_control;
use crate::layout::stretch::IssuedWaypoint;
use flight_plan::{Act, EvalError, LegAction, Trigger};
use geometry::{LatLon, LocalFrame};

/// So near to a piece's ends a position counts as beside it, metres.
const NEAR_M: f64 = 1.0;
/// Repeated actions nearer to each other than this are refused, metres.
const MIN_EVERY_M: f64 = 1.0;
/// Most repetitions caught up with at once; those still missing follow in the next steps.
const MAX_AT_ONCE: usize = 64;

/// How far the flight is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    /// Path length, metres.
    way_m: f64,
    /// The piece of the path being flown, where the aircraft is beside it, and whether all of it is flown.
    piece: Piece,
    at: LatLon,
    complete: bool,
}

impl Moment {
    fn new(issued: &IssuedWaypoint, at: LatLon, way_m: f64, complete: bool) -> Self {
        let piece = Piece { from: issued.before.end_of_path().last.position, to: issued.waypoint.position };
        Self { way_m, piece, at, complete }
    }

    /// At the beginning of a passage.
    pub fn begun(issued: &IssuedWaypoint) -> Self {
        Self::new(issued, issued.before.end_of_path().last.position, issued.leg_start_m, false)
    }

    /// At a waypoint.
    pub fn reached(issued: &IssuedWaypoint) -> Self {
        Self::new(issued, issued.waypoint.position, issued.end_m, true)
    }

    /// So far before the waypoint it steers to, metres.
    pub fn on_the_way(issued: &IssuedWaypoint, aircraft: Option<LatLon>, left_m: f64) -> Self {
        let begin = issued.before.end_of_path().last.position;
        Self::new(issued, aircraft.unwrap_or(begin), issued.end_m - left_m, false)
    }
}

impl Passage {
    /// Does what is due, in the order of the path.
    pub(super) fn act(&mut self, moment: &Moment, scene: &mut Scene, out: &mut Vec<Output>) {
        let program = scene.program;
        let actions = program.leg(&self.leg).map_or(&[][..], |leg| &leg.actions);
        let mut due = Vec::new();
        let mut up_to_m = Vec::new();
        for (number, (action, done)) in actions.iter().zip(&self.done).enumerate() {
            let ways_m = self.due(*done, action, moment, scene).unwrap_or_else(|reason| {
                scene.reported.report(LayoutError::Expression { leg: self.leg.clone(), reason }, out);
                Vec::new()
            });
            let caught_up_m = ways_m.get(MAX_AT_ONCE - 1).copied().unwrap_or(moment.way_m - self.began_m);
            up_to_m.push(caught_up_m.max(done.up_to_m));
            due.extend(ways_m.into_iter().map(|way_m| (way_m, number, &action.act)));
        }
        let beyond = self.beyond(actions, moment, scene);
        for ((done, ahead), up_to_m) in self.done.iter_mut().zip(beyond).zip(up_to_m) {
            (done.ahead, done.up_to_m) = (ahead.unwrap_or(done.ahead), up_to_m);
        }
        due.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, number, act) in due {
            self.fulfil(number, act, scene, out);
        }
    }

    /// Does what is due at the end.
    pub(super) fn act_at_the_end(&mut self, scene: &mut Scene, out: &mut Vec<Output>) {
        let program = scene.program;
        let leg = program.leg(&self.leg);
        let actions = leg.map_or(&[][..], |leg| &leg.actions);
        for (number, action) in actions.iter().enumerate() {
            let done = self.done.get(number);
            let due = action.trigger == Trigger::End && done.is_some_and(|d| d.times == 0);
            if due && (!is_wait(&action.act) || leg.is_some_and(is_control)) {
                self.fulfil(number, &action.act, scene, out);
            }
        }
    }

    fn fulfil(&mut self, number: usize, act: &Act, scene: &mut Scene, out: &mut Vec<Output>) {
        self.done.iter_mut().skip(number).take(1).for_each(|done| done.times += 1);
        self.perform(act, scene, out);
    }

    /// Path lengths at which an action is due by now, one for each time.
    fn due(
        &self,
        done: Done,
        action: &LegAction,
        moment: &Moment,
        scene: &Scene,
    ) -> Result<Vec<f64>, String> {
        let (program, env) = (scene.program, scene.env(self.iteration));
        let way_m = moment.way_m - self.began_m;
        if let Trigger::Every(every) = &action.trigger {
            let every_m = program.eval_number(every, &env).map_err(|why| why.to_string())?;
            return multiples(every_m, done.up_to_m, way_m);
        }
        if done.times > 0 {
            return Ok(Vec::new());
        }
        let once = |due: bool, at_m: f64| if due { vec![at_m] } else { Vec::new() };
        let number = |value| program.eval_number(value, &env).map_err(|why: EvalError| why.to_string());
        Ok(match &action.trigger {
            Trigger::Start => once(true, f64::NEG_INFINITY),
            Trigger::Distance(metres) => number(metres).map(|m| once(way_m >= m, m))?,
            Trigger::Time(seconds) => once(self.flown_s >= number(seconds)?, way_m),
            Trigger::Abeam(place) => {
                let place = program.eval_place(place, &env).map_err(|why| why.to_string())?;
                once(is_abeam(place, done, moment), way_m)
            }
            Trigger::End | Trigger::Every(_) => Vec::new(),
        })
    }

    /// Which positions lie beyond the end of a piece that is complete; `None`: nothing new is known.
    fn beyond(&self, actions: &[LegAction], moment: &Moment, scene: &Scene) -> Vec<Option<bool>> {
        let env = scene.env(self.iteration);
        let of = |action: &LegAction| {
            let Trigger::Abeam(place) = &action.trigger else { return None };
            let place = scene.program.eval_place(place, &env).ok();
            let beside = place.and_then(|p| moment.piece.beside(p));
            beside.filter(|_| moment.complete).map(|(along_m, length_m)| along_m > length_m)
        };
        actions.iter().map(of).collect()
    }
}

/// The aircraft has passed the position of an action on this piece of the path, or on the corner before it.
fn is_abeam(place: LatLon, done: Done, moment: &Moment) -> bool {
    let Some((along_m, length_m)) = moment.piece.beside(place) else { return false };
    let on_corner = done.ahead && along_m < 0.0;
    let on_piece = (-NEAR_M..=length_m + NEAR_M).contains(&along_m);
    let flown_m = moment.piece.beside(moment.at).map_or(0.0, |(flown_m, _)| flown_m);
    on_corner || (on_piece && (moment.complete || flown_m >= along_m))
}

impl Piece {
    /// How far along it a position is abeam, and how long it is, metres; `None` for a piece that is none.
    fn beside(&self, position: LatLon) -> Option<(f64, f64)> {
        let frame = LocalFrame::new(self.from);
        let way = frame.to_local(self.to);
        let length_m = way.length();
        (length_m > NEAR_M).then(|| (frame.to_local(position).dot(way) / length_m, length_m))
    }
}

/// Multiples of a distance on the distance flown since `up_to_m`, metres.
fn multiples(every_m: f64, up_to_m: f64, way_m: f64) -> Result<Vec<f64>, String> {
    if every_m < MIN_EVERY_M {
        return Err(format!("an action every {every_m} m can't be done: give it {MIN_EVERY_M} m or more"));
    }
    // a cast of a negative number gives 0
    let passed = |way_m: f64| (way_m / every_m).floor() as u64;
    let since = passed(up_to_m).saturating_add(1)..=passed(way_m);
    Ok(since.take(MAX_AT_ONCE).map(|n| n as f64 * every_m).collect())
}
