//! `holding-incomplete`: an HA without altitude; `bad-holding`: straight legs without length, or a course outside 0..360.

use super::Inspection;
use super::inspection::altitude_of;
use crate::{HoldingLength, LegKind, Problem};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for step in &view.steps {
        let leg = step.context.leg;
        let (LegKind::Hf(holding) | LegKind::Ha(holding)) = &leg.kind else { continue };
        if matches!(leg.kind, LegKind::Ha(_)) && altitude_of(&step.context).is_none() {
            let message = "give this holding an `altitude`: it ends when that is reached";
            problems.push(Problem::error("holding-incomplete", message).of(&leg.id));
        }
        let (HoldingLength::Distance(length) | HoldingLength::Time(length)) = &holding.leg;
        if view.number(length).is_some_and(|x| x <= 0.0) {
            let message = "make the straight legs of this holding longer than 0";
            problems.push(Problem::error("bad-holding", message).of(&leg.id));
        }
        let course = holding.inbound_course_deg.as_ref().and_then(|c| view.number(c));
        if course.is_some_and(|c| !(0.0..=360.0).contains(&c)) {
            problems.push(
                Problem::error("bad-holding", "write the inbound course as degrees true in 0..360")
                    .of(&leg.id),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, codes, document};

    #[test]
    fn racetracks_have_length_and_course() {
        check_legs(&[
            (r#"<HF id="h" fix="A" course="90" turn="right" length="500"/>"#, &[]),
            (r#"<HF id="h" fix="A" course="90" turn="right" time="0"/>"#, &["bad-holding"]),
            (r#"<HF id="h" fix="A" course="400" turn="left" time="60"/>"#, &["bad-holding"]),
        ]);
    }

    #[test]
    fn a_climb_in_a_holding_needs_its_altitude() {
        let stage =
            r#"<stage id="s" type="departure"><HA id="h" fix="A" turn="right" length="500"/></stage>"#;
        assert!(codes(&document(stage)).contains(&"holding-incomplete"));
    }
}
