//! `segment-too-short`: a track is shorter than what the turns at its ends take of it.

use super::Inspection;
use super::path::{Path, course_change_deg};
use super::remedy::{slow_mps, slower};
use super::step::Step;
use crate::{Edit, LegKind, Problem};

/// Turns up to this need no room, degrees (guidance: no fly-by for less).
const STRAIGHT_DEG: f64 = 3.0;
/// Intercept angle after a fly-over, degrees.
const INTERCEPT_DEG: f64 = 30.0;
/// Fly-by beyond this is flown as a fly-over, degrees.
const STEEPEST_FLY_BY_DEG: f64 = 150.0;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let Some(Path::Line { length_m, .. }) = step.directed() else { return };
    let mut turns = Turns::default();
    if let Some(before) = view.before(step) {
        turns.start_m = turn(view, before, step).map_or(0.0, |(_, (_, behind_m))| behind_m);
    }
    if let Some((deg, (ahead_m, _))) = view.after(step).and_then(|after| turn(view, step, after)) {
        (turns.end_deg, turns.end_m) = (deg, ahead_m);
    }
    let needed_m = turns.start_m + turns.end_m;
    if length_m < needed_m {
        // still enough when the number is shown in whole metres
        let (wanted_m, shown_m) = ((needed_m + 0.5).ceil(), length_m.floor());
        let or_slower = if can_be_slow(view, step, length_m / needed_m) { ", or fly it slower" } else { "" };
        let message = format!(
            "lengthen this track to {wanted_m:.0} m{or_slower}: it is {shown_m:.0} m long, the turns at its ends need more"
        );
        let problem = Problem::warning("segment-too-short", message).of(&step.leg.id);
        problems.push(problem.perhaps_fixed_by(fitted(view, step, &turns, length_m)));
    }
}

/// The track change between two steps, degrees, and what the turn takes of them, metres.
fn turn(view: &Inspection, from: &Step, to: &Step) -> Option<(f64, (f64, f64))> {
    let change_deg = course_change_deg(from.directed()?.course_end_deg(), to.directed()?.course_start_deg());
    Some((change_deg, room(view, from, change_deg)))
}

/// What the turns at the ends of a track take of it, metres.
#[derive(Debug, Clone, Default)]
struct Turns {
    start_m: f64,
    end_m: f64,
    /// The track change at its end.
    end_deg: f64,
}

/// Fly-over instead of fly-by at the end, or a lower speed on this track and the one before it.
fn fitted(view: &Inspection, step: &Step, turns: &Turns, length_m: f64) -> Option<Edit> {
    let leg = &step.leg;
    let turn_is_fly_by = turns.end_m > 0.0 && matches!(leg.kind, LegKind::Tf(_));
    if turn_is_fly_by && turns.start_m <= length_m && turns.end_deg <= STEEPEST_FLY_BY_DEG {
        return Some(Edit::SetFlyOver { leg: leg.id.clone(), fly_over: true });
    }
    let factor = slower_by(length_m / (turns.start_m + turns.end_m));
    let before = view.before(step)?;
    let both = [before, step].map(|s| slower(view, &s.leg.id, s.speed_mps * factor));
    Some(Edit::All(both.into_iter().collect::<Option<Vec<_>>>()?))
}

/// The turns at both ends can be flown so slowly that they take only such a share of the room.
fn can_be_slow(view: &Inspection, step: &Step, share: f64) -> bool {
    let factor = slower_by(share);
    let mut both = view.before(step).into_iter().chain([step]);
    both.all(|s| slow_mps(view, s.speed_mps * factor).is_some())
}

/// The room of a turn grows with the square of the speed, which rounds down to tenths.
fn slower_by(share: f64) -> f64 {
    share.sqrt()
}

/// Metres that a turn takes of the track before it and of the track after it (guidance.md §1).
fn room(view: &Inspection, step: &Step, change_deg: f64) -> (f64, f64) {
    let radius_m = view.turn_radius_m(step.speed_mps);
    if change_deg <= STRAIGHT_DEG {
        return (0.0, 0.0);
    }
    let fly_over = matches!(&step.leg.kind, LegKind::Tf(to) | LegKind::Rf { to, .. } if to.fly_over);
    if fly_over || change_deg > STEEPEST_FLY_BY_DEG {
        return (0.0, fly_over_room_m(radius_m, change_deg.to_radians()));
    }
    let anticipation_m = radius_m * (change_deg.to_radians() / 2.0).tan();
    (anticipation_m, anticipation_m)
}

/// Distance past a fly-over fix until established on the new track, both turns with the same radius.
fn fly_over_room_m(radius_m: f64, change_rad: f64) -> f64 {
    let intercept_rad = INTERCEPT_DEG.to_radians();
    let turn = change_rad.sin() - change_rad.cos() / intercept_rad.tan() + 1.0 / intercept_rad.sin();
    (radius_m * (turn + (intercept_rad / 2.0).tan())).max(0.0)
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs, message_of};

    /// East, `metres` north, then west again: two turns of 90° by 137 m each.
    fn with(metres: f64, attributes: &str) -> String {
        let lat = 36.3 + metres / 110_970.0;
        format!(
            r#"<IF id="a" fix="A"/><TF id="b" fix="B" {attributes}/><TF id="c" lat="{lat}" lon="-84.17"/><TF id="d" lat="{lat}" lon="-84.20"/>"#
        )
    }

    #[test]
    fn a_track_leaves_room_for_its_turns() {
        check_legs(&[
            (&with(300.0, ""), &[]),
            (&with(250.0, ""), &["segment-too-short"]),
            (&with(500.0, r#"flyOver="true""#), &["segment-too-short"]),
            (&with(700.0, r#"flyOver="true""#), &[]),
            (&with(250.0, r#"speed="20""#), &[]),
        ]);
        fixed_legs(&[
            (&with(250.0, ""), "segment-too-short"),
            (&with(500.0, r#"flyOver="true""#), "segment-too-short"),
        ]);
    }

    #[test]
    fn what_is_advised_helps() {
        for (metres, slow) in [(273.0, true), (250.0, true), (60.0, false)] {
            let message = message_of(&with(metres, ""), "segment-too-short");
            let (wanted, rest) =
                message.strip_prefix("lengthen this track to ").unwrap().split_once(" m").unwrap();
            check_legs(&[(&with(wanted.parse().unwrap(), ""), &[])]);
            assert_eq!(rest.starts_with(", or fly it slower"), slow, "{message}");
        }
    }
}
