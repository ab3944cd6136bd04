//! `zero-length`: a track or arc ends where it begins, so that it has no direction.

use super::Inspection;
use super::inspection::SHORTEST_M;
use crate::{Edit, LegKind, Problem};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for step in &view.steps {
        let leg = step.context.leg;
        let Some((start, end)) = step.start.zip(step.end) else { continue };
        let directed = matches!(leg.kind, LegKind::Tf(_) | LegKind::Rf { .. });
        // farther than this the geodesic need not be asked
        let near = (start.position.lat_deg - end.position.lat_deg).abs() < 1e-3;
        if directed && near && start.position.distance_m(end.position) < SHORTEST_M {
            let message = "remove this leg or move its waypoint: it ends where the leg before it ends";
            let fix = Edit::DeleteLeg { leg: leg.id.clone() };
            problems.push(Problem::error("zero-length", message).of(&leg.id).fixed_by(fix));
        }
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
