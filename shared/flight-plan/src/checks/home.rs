//! `no-home`: an altitude counts from the take-off runway, and the plan has no take-off stage that would name it.

use super::Inspection;
use super::step::Step;
use crate::{Altitude, AltitudeReference, Id, Problem, StageKind};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    if takes_off(view) {
        return;
    }
    let stages = view.plan.all_stages().filter_map(|(_, stage)| Some((&stage.id, stage.altitude.as_ref()?)));
    let zones = view.plan.zones.iter().flat_map(|zone| {
        let limits = zone.floor.iter().chain(&zone.ceiling);
        limits.map(|limit| (&zone.id, limit))
    });
    let homeless = stages.chain(zones).filter(|(_, a)| counts_from_home(a));
    problems.extend(homeless.map(|(of, _)| problem(of)));
}

/// The altitude of a leg itself.
pub(super) fn leg(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    if step.leg.altitude.as_ref().is_some_and(counts_from_home) && !takes_off(view) {
        problems.push(problem(&step.leg.id));
    }
}

/// Another rule reports a take-off stage without its runway.
fn takes_off(view: &Inspection) -> bool {
    view.plan.stages.iter().any(|stage| stage.kind == StageKind::TakeOff)
}

fn counts_from_home(altitude: &Altitude) -> bool {
    altitude.reference == AltitudeReference::Home
}

fn problem(of: &Id) -> Problem {
    let message = "write this altitude `amsl` or `agl`, or give the plan a take-off stage: `home` is the runway of the take-off, and there is none";
    Problem::error("no-home", message).of(of)
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, codes, document};

    #[test]
    fn home_without_a_take_off_is_nowhere() {
        let stage = |altitude: &str, leg: &str| {
            document(&format!(
                r#"<stage id="s" type="en-route" {altitude}><DF id="a" fix="A" {leg}/></stage>"#
            ))
        };
        let (home, amsl) =
            (r#"altitude="500" altitudeReference="home""#, r#"altitude="500" altitudeReference="amsl""#);
        assert_eq!(codes(&stage(amsl, "")), [""; 0]);
        assert_eq!(codes(&stage(home, "")), ["no-home"]);
        assert_eq!(codes(&stage(amsl, home)), ["no-home"]);
        check_legs(&[(&format!(r#"<DF id="a" fix="A" {home}/>"#), &[])]);
    }

    #[test]
    fn limits_of_zones_above_home() {
        let plan = document(
            r#"<stage id="s" type="en-route" altitude="500" altitudeReference="amsl"><DF id="a" fix="A"/></stage>"#,
        );
        let zone = r#"<zones><keepOut id="z" lat="36.5" lon="-84.5" radius="500" floor="90" floorReference="home"/></zones>"#;
        assert_eq!(codes(&plan.replace("<mainPlan", &format!("{zone}<mainPlan"))), ["no-home"]);
    }
}
