//! `take-off-incomplete`, `land-incomplete`: a runway or altitude is missing, or the climb-out ends no higher than it
//! begins; `no-landing`: the flight ends in the air; `stage-order`: take-off neither first nor after a landing, or a landing
//! neither last nor before a take-off; `bad-turnaround`, `unused-turnaround`: what is said of the time on the ground is impossible,
//! or no flight follows; `stage-with-legs`: the autopilot performs take-off and landing, legs there would not be flown.

use super::Inspection;
use crate::{
    Altitude, AltitudeReference, Edit, Id, Problem, Stage, StageKind, Turnaround, TurnaroundEnergy, Value,
};

/// Climb-out altitude where a take-off has none, metres above its runway.
const CLIMB_OUT_M: f64 = 100.0;
/// Longest time on the ground between two flights, seconds.
const MOST_ON_GROUND_S: f64 = 86_400.0;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    let plan = view.plan;
    problems.extend(no_landing(&plan.stages));
    let main = std::iter::once((&plan.stages, None));
    let lists = main.chain(plan.emergency_plans.iter().map(|e| (&e.stages, Some(&e.runway))));
    for (stages, landing) in lists {
        for (index, stage) in stages.iter().enumerate() {
            complete(view, stage, landing, problems);
            let kind_at = |index: usize| stages.get(index).map(|stage| stage.kind);
            let before = index.checked_sub(1).and_then(kind_at);
            let behind = kind_at(index + 1);
            let wrong = match stage.kind {
                StageKind::TakeOff => landing.is_some() || before.is_some_and(|b| b != StageKind::Land),
                StageKind::Land => behind.is_some_and(|b| landing.is_some() || b != StageKind::TakeOff),
                _ => false,
            };
            if wrong {
                let message = "take off first in the main plan or directly after a landing there, and land last in a plan or, in the main plan, directly before the take-off of another flight";
                problems.push(Problem::error("stage-order", message).of(&stage.id));
            }
            turnaround(stage, stage.kind == StageKind::Land && behind.is_some(), problems);
        }
    }
}

/// Of a plan that has something to fly.
fn no_landing(stages: &[Stage]) -> Option<Problem> {
    let last = stages.last().filter(|last| last.kind != StageKind::Land)?;
    let flies = stages.iter().any(|stage| !stage.legs.is_empty() || stage.kind == StageKind::TakeOff);
    let message = "add a land stage at the end: without one the flight does not end on the ground. The aircraft circles at its last place until somebody acts";
    flies.then(|| Problem::warning("no-landing", message).of(&last.id))
}

/// `used`: another flight follows.
fn turnaround(stage: &Stage, used: bool, problems: &mut Vec<Problem>) {
    let Turnaround { energy, time_s } = stage.turnaround;
    let energy_is_bad =
        matches!(energy, Some(TurnaroundEnergy::Share(share)) if !(share > 0.0 && share <= 1.0));
    if energy_is_bad || time_s.is_some_and(|seconds| !(0.0..=MOST_ON_GROUND_S).contains(&seconds)) {
        let message = "write `turnaroundEnergy` as a share above 0 and up to 1, or `kept`, and `turnaroundTime` as seconds, at most a day";
        problems.push(Problem::error("bad-turnaround", message).of(&stage.id));
    } else if !used && stage.turnaround != Turnaround::default() {
        let message =
            "remove the turnaround, or put a take-off stage behind this landing: no other flight follows it";
        problems.push(Problem::warning("unused-turnaround", message).of(&stage.id));
    }
}

/// `landing`: the runway of the emergency plan that the stage is in.
fn complete(view: &Inspection, stage: &Stage, landing: Option<&Id>, problems: &mut Vec<Problem>) {
    let mut report = |code, message: &str, fix: Option<Edit>| {
        problems.push(Problem::error(code, message).of(&stage.id).perhaps_fixed_by(fix));
    };
    match stage.kind {
        StageKind::TakeOff if stage.runway.is_none() || stage.altitude.is_none() => {
            let message = "give the take-off stage a `runway` and a climb-out `altitude`";
            report("take-off-incomplete", message, completed(view, stage));
        }
        StageKind::TakeOff => {
            if let Some(height_m) = view.climb_out_height_m(stage).filter(|m| *m <= 0.0) {
                let message = format!(
                    "climb out to an `altitude` above the runway: this one is {:.1} m below it",
                    height_m.abs()
                );
                report("take-off-incomplete", &message, Some(with_altitude(stage, usual())));
            }
        }
        StageKind::Land if stage.runway.is_none() => {
            let runway = landing.or_else(|| only_runway(view));
            report("land-incomplete", "give the land stage a `runway`", runway.map(|r| named(stage, r)));
        }
        _ => {}
    }
    if matches!(stage.kind, StageKind::TakeOff | StageKind::Land) && !stage.legs.is_empty() {
        let message =
            "move these legs to a stage before or after: the autopilot performs take-off and landing itself";
        report("stage-with-legs", message, None);
    }
}

fn completed(view: &Inspection, stage: &Stage) -> Option<Edit> {
    let runway = stage.runway.as_ref().or_else(|| only_runway(view))?;
    let altitude = stage.altitude.clone().unwrap_or_else(usual);
    Some(Edit::All(vec![named(stage, runway), with_altitude(stage, altitude)]))
}

fn usual() -> Altitude {
    Altitude { metres: Value::Constant(CLIMB_OUT_M), reference: AltitudeReference::Home }
}

fn with_altitude(stage: &Stage, altitude: Altitude) -> Edit {
    Edit::SetAltitude { of: stage.id.clone(), altitude: Some(altitude) }
}

fn named(stage: &Stage, runway: &Id) -> Edit {
    Edit::SetRunway { of: stage.id.clone(), runway: runway.clone() }
}

/// The plan's runway, if it has just one.
fn only_runway<'a>(view: &Inspection<'a>) -> Option<&'a Id> {
    match view.plan.runways.as_slice() {
        [runway] => Some(&runway.id),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, document, fixed};

    const WAY: &str = r#"<stage id="w" type="en-route" altitude="500" altitudeReference="amsl"><IF id="a" fix="A"/></stage>"#;

    #[test]
    fn take_off_and_land_need_what_they_need() {
        let to = r#"<stage id="t" type="take-off" runway="R" altitude="100" altitudeReference="home"/>"#;
        let cases: [(&str, &[&str]); 5] = [
            (&format!("{to}{WAY}"), &[]),
            (&format!(r#"<stage id="t" type="take-off" runway="R"/>{WAY}"#), &["take-off-incomplete"]),
            (&format!(r#"{WAY}<stage id="l" type="land"/>"#), &["land-incomplete"]),
            (&format!("{WAY}{to}"), &["stage-order"]),
            (
                &format!(r#"{to}{WAY}<stage id="l" type="land" runway="R"><TF id="z" fix="B"/></stage>"#),
                &["stage-with-legs"],
            ),
        ];
        for (stages, expected) in cases {
            let found: Vec<_> =
                codes(&document(stages)).into_iter().filter(|c| *c != "no-altitude").collect();
            assert_eq!(found, expected, "{stages}");
        }
    }

    #[test]
    fn a_flight_that_ends_in_the_air_is_told() {
        let landing = r#"<stage id="land" type="land" runway="R"/>"#;
        let plan = crate::checks::testing::plan_with(r#"<IF id="a" fix="A"/>"#);
        assert_eq!(codes(&plan.replacen(landing, "", 1)), ["no-landing"]);
    }

    #[test]
    fn another_flight_follows_a_landing_in_the_main_plan() {
        let to = |id: &str| {
            format!(
                r#"<stage id="{id}" type="take-off" runway="R" altitude="100" altitudeReference="home"/>"#
            )
        };
        let land = |id: &str, more: &str| format!(r#"<stage id="{id}" type="land" runway="R" {more}/>"#);
        let way =
            |id: &str| WAY.replace("\"w\"", &format!("\"{id}\"")).replace("\"a\"", &format!("\"{id}-a\""));
        let stages = |between: &str| {
            format!("{}{}{}{between}{}{}", to("t"), way("w"), land("l", ""), way("x"), land("m", ""))
        };
        let turnaround = |more: &str| {
            format!("{}{}{}{}{}{}", to("t"), way("w"), land("l", more), to("u"), way("x"), land("m", ""))
        };
        let cases: [(&str, &[&str]); 8] = [
            (&stages(&to("u")), &[]),
            (&stages(""), &["stage-order"]),
            (&stages(&format!("{}{}", way("y"), to("u"))), &["stage-order", "stage-order"]),
            (&turnaround(r#"turnaroundEnergy="0.9" turnaroundTime="600""#), &[]),
            (&turnaround(r#"turnaroundEnergy="kept""#), &[]),
            (&turnaround(r#"turnaroundEnergy="1.5""#), &["bad-turnaround"]),
            (&turnaround(r#"turnaroundTime="-1""#), &["bad-turnaround"]),
            (&format!("{}{}{}", to("t"), WAY, land("l", r#"turnaroundTime="60""#)), &["unused-turnaround"]),
        ];
        for (stages, expected) in cases {
            assert_eq!(codes(&document(stages)), expected, "{stages}");
        }
    }

    /// The runway is at 300 m.
    #[test]
    fn a_climb_out_ends_above_the_runway() {
        let climb = |altitude: &str, reference: &str| {
            document(&format!(
                r#"<stage id="t" type="take-off" runway="R" altitude="{altitude}" altitudeReference="{reference}"/>{WAY}"#
            ))
        };
        for (altitude, reference) in [("-50", "home"), ("0", "agl"), ("299", "amsl"), ("= 2.0 - 3.0", "home")]
        {
            let document = climb(altitude, reference);
            assert_eq!(codes(&document), ["take-off-incomplete"], "{altitude} {reference}");
            fixed(&document, "take-off-incomplete");
        }
        for (altitude, reference) in [("30", "home"), ("330", "amsl")] {
            assert_eq!(codes(&climb(altitude, reference)), [""; 0], "{altitude} {reference}");
        }
    }

    #[test]
    fn the_only_runway_is_proposed() {
        fixed(&document(&format!(r#"<stage id="t" type="take-off"/>{WAY}"#)), "take-off-incomplete");
        fixed(&document(&format!(r#"{WAY}<stage id="l" type="land"/>"#)), "land-incomplete");
    }
}
