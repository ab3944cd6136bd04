//! Whether two flights are one from here on: the same place in the plan, the same motion, the same waypoints ahead, whatever time
//! it is and however much was flown and counted before.
//!
//! Every field is named: one that is added does not compile until it is compared, or left out with a reason.

use super::scenario::Moment;
use super::situation::{Due, Situation};
use crate::flight::all_equivalent;

/// From here on two flights are one.
pub(super) fn are_equivalent(one: &Situation, other: &Situation) -> bool {
    // the energy left makes no difference, nor do sums, counts and numbers: what follows is shifted by them
    #[rustfmt::skip]
    let Situation {
        executor, aircraft, guidance, buffer, moment, now_us, due, stepped_us, waiting_us, requests: _, fired, ended, entered: _,
        began_us: _, used_before_j: _, distance_m: _, passage: _, steered: _, passages: _, waypoints: _, renumbering: _,
    } = one;
    if !aircraft.moves_as(&other.aircraft) || *guidance != other.guidance {
        return false;
    }
    let Some(offset) = executor.offset_from(&other.executor) else { return false };
    (waiting_us, fired, ended) == (&other.waiting_us, &other.fired, &other.ended)
        && (now_us == stepped_us) == (other.now_us == other.stepped_us)
        && left_us(due, *now_us) == left_us(&other.due, other.now_us)
        && same_place(moment, &other.moment)
        && all_equivalent(buffer, &other.buffer, |a, b| offset.waypoint(a, b))
        && executor.is_equivalent(&other.executor, &offset)
}

/// Until something is due by itself, microseconds.
fn left_us(due: &Due, now_us: u64) -> [u64; 2] {
    // how far the motion is advanced only says how long the next step is
    let Due { report_us, track_us, advance_us: _ } = *due;
    [report_us, track_us].map(|us| us.wrapping_sub(now_us))
}

fn same_place(one: &Moment, other: &Moment) -> bool {
    // times are held against each other by what is due
    let Moment { time_s: _, in_leg_s: _, place, waypoints } = one;
    (place, waypoints) == (&other.place, &other.waypoints)
}
