//! `zero-length`: a track or arc ends where it begins, so that it has no direction.

use super::Inspection;
use super::path::{Path, SHORTEST_M};
use super::step::Step;
use crate::{Edit, LegKind, Problem};

pub(super) fn check(_: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let Some((start, end)) = step.start.zip(step.end) else { return };
    let directed = matches!(leg.kind, LegKind::Tf(_) | LegKind::Rf { .. });
    let apart_m = match step.path {
        Some(Path::Line { length_m, .. }) => length_m,
        _ if directed => start.position.distance_m(end.position),
        _ => return,
    };
    if directed && apart_m < SHORTEST_M {
        let message = "remove this leg or move its waypoint: it ends where the leg before it ends";
        let fix = Edit::DeleteLeg { leg: leg.id.clone() };
        problems.push(Problem::error("zero-length", message).of(&leg.id).fixed_by(fix));
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs};

    #[test]
    fn tracks_to_where_the_aircraft_is() {
        let twice = r#"<IF id="a" fix="A"/><TF id="b" fix="B"/><TF id="c" fix="B"/>"#;
        let climbing = r#"<IF id="a" fix="A"/><TF id="b" fix="A" altitude="600" altitudeReference="amsl"/>"#;
        let circle =
            r#"<IF id="a" fix="A"/><RF id="b" fix="A" centreLat="36.305" centreLon="-84.20" turn="left"/>"#;
        check_legs(&[
            (twice, &["zero-length"]),
            (climbing, &["zero-length"]),
            (circle, &["zero-length"]),
            (r#"<IF id="a" fix="A"/><DF id="b" fix="A"/><TF id="c" fix="B"/>"#, &[]),
        ]);
        fixed_legs(&[(twice, "zero-length"), (climbing, "zero-length"), (circle, "zero-length")]);
    }
}
