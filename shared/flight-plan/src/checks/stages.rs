//! `take-off-incomplete`, `land-incomplete`: a runway or altitude is missing; `stage-order`: take-off is not first or
//! landing not last; `stage-with-legs`: the autopilot performs take-off and landing, legs there would not be flown.

use super::Inspection;
use crate::{Problem, Stage, StageKind};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    let plan = view.plan;
    let lists = std::iter::once(&plan.stages).chain(plan.emergency_plans.iter().map(|e| &e.stages));
    for (list, stages) in lists.enumerate() {
        for (index, stage) in stages.iter().enumerate() {
            complete(stage, problems);
            let wrong = match stage.kind {
                StageKind::TakeOff => index != 0 || list != 0,
                StageKind::Land => index + 1 != stages.len(),
                _ => false,
            };
            if wrong {
                let message = "take off only in the first stage of the main plan, and land only in the last stage of a plan";
                problems.push(Problem::error("stage-order", message).of(&stage.id));
            }
        }
    }
}

fn complete(stage: &Stage, problems: &mut Vec<Problem>) {
    let mut report = |code, message: &str| problems.push(Problem::error(code, message).of(&stage.id));
    match stage.kind {
        StageKind::TakeOff if stage.runway.is_none() || stage.altitude.is_none() => {
            report("take-off-incomplete", "give the take-off stage a `runway` and a climb-out `altitude`");
        }
        StageKind::Land if stage.runway.is_none() => {
            report("land-incomplete", "give the land stage a `runway`")
        }
        _ => {}
    }
    if matches!(stage.kind, StageKind::TakeOff | StageKind::Land) && !stage.legs.is_empty() {
        report(
            "stage-with-legs",
            "move these legs to a stage before or after: the autopilot performs take-off and landing itself",
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, document};

    #[test]
    fn take_off_and_land_need_what_they_need() {
        let way = r#"<stage id="w" type="en-route" altitude="500" altitudeReference="amsl"><IF id="a" fix="A"/></stage>"#;
        let to = r#"<stage id="t" type="take-off" runway="R" altitude="100" altitudeReference="home"/>"#;
        let cases: [(&str, &[&str]); 5] = [
            (&format!("{to}{way}"), &[]),
            (&format!(r#"<stage id="t" type="take-off" runway="R"/>{way}"#), &["take-off-incomplete"]),
            (&format!(r#"{way}<stage id="l" type="land"/>"#), &["land-incomplete"]),
            (&format!("{way}{to}"), &["stage-order"]),
            (
                &format!(r#"{to}{way}<stage id="l" type="land" runway="R"><TF id="z" fix="B"/></stage>"#),
                &["stage-with-legs"],
            ),
        ];
        for (stages, expected) in cases {
            let found: Vec<_> =
                codes(&document(stages)).into_iter().filter(|c| *c != "no-altitude").collect();
            assert_eq!(found, expected, "{stages}");
        }
    }
}
