//! `bad-levels`: altitudes of a contour that don't follow on each other, or lead into the ground or above the ceiling.

use super::Inspection;
use super::extent::extent;
use super::remedy::changed;
use super::step::Step;
use crate::{AltitudeReference, Edit, Leg, LegKind, Pattern, Problem, Value};

/// Most altitudes of one contour.
const MAX_LEVELS: f64 = 1_000.0;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let LegKind::Pattern(Pattern::Contour { loops, levels, level_step_m, .. }) = &leg.kind else { return };
    let number = |value: &Option<Value<f64>>| value.as_ref().and_then(|v| view.number(v));
    let found = match (levels, level_step_m) {
        (None, None) => None,
        (Some(_), None) => {
            let message = "say by `levelStep` how far apart the levels are, or leave `levels` out".to_owned();
            Some((message, level(leg)))
        }
        (_, Some(_)) => {
            let count = number(levels.as_ref().map_or(loops, |_| levels));
            wrong(view, step, number(level_step_m), number(levels), count)
        }
    };
    let problem = |(message, fix): (String, Option<Edit>)| {
        Problem::error("bad-levels", message).of(&leg.id).perhaps_fixed_by(fix)
    };
    problems.extend(found.map(problem));
}

/// What is wrong with the step between levels, with their number where one is given, or with the last of `count`.
fn wrong(
    view: &Inspection,
    step: &Step,
    step_m: Option<f64>,
    levels: Option<f64>,
    count: Option<f64>,
) -> Option<(String, Option<Edit>)> {
    let leg = &step.leg;
    let step_m = step_m?;
    if step_m == 0.0 {
        let message = "make `levelStep` more than 0 m to climb from level to level, less to descend; without it all is flown at one altitude";
        return Some((message.to_owned(), level(leg)));
    }
    if let Some(n) = levels.filter(|n| n.fract() != 0.0 || !(1.0..=MAX_LEVELS).contains(n)) {
        let message = format!("make the number of levels a whole one from 1 to {MAX_LEVELS}, not {n}");
        return Some((message, with_levels(leg, n.round().clamp(1.0, MAX_LEVELS))));
    }
    let altitude = step.altitude()?;
    let (first_m, steps) = (view.number(&altitude.metres)?, count? - 1.0);
    let last_m = first_m + steps * step_m;
    if let Some(ground_m) = ground_m(view, step, altitude.reference).filter(|ground_m| last_m <= *ground_m) {
        let fits = (((first_m - ground_m) / -step_m).ceil()).max(1.0);
        let message = format!(
            "begin higher, or fly {fits:.0} levels at most: the last one, {:.0} m below the first, leads into the ground",
            first_m - last_m
        );
        let begins_above = first_m > ground_m;
        return Some((message, levels.filter(|_| begins_above).and_then(|_| with_levels(leg, fits))));
    }
    let ceiling_m = view.profile.ceiling_amsl_m;
    // above the ground or home it is at least that
    (last_m > ceiling_m).then(|| {
        let fits = ((ceiling_m - first_m) / step_m).floor() + 1.0;
        let message =
            format!("begin lower, or fly fewer levels: the last one is above the aircraft's ceiling of {ceiling_m:.0} m AMSL");
        (message, levels.filter(|_| fits >= 1.0).and_then(|_| with_levels(leg, fits)))
    })
}

/// Where the ground is in an altitude's reference, metres, if it can be said before the contour is laid out: over known ground the
/// review sees how it lies below each loop, over unknown ground it is not below the sea and every runway.
fn ground_m(view: &Inspection, step: &Step, reference: AltitudeReference) -> Option<f64> {
    let LegKind::Pattern(Pattern::Contour { area, .. }) = &step.leg.kind else { return None };
    let lowest_m = || {
        let (centre, _) = extent(view, area)?;
        let known = view.terrain.elevation_m(centre).is_some();
        (!known).then(|| view.plan.lowest_ground_amsl_m())
    };
    match reference {
        AltitudeReference::Agl => Some(0.0),
        AltitudeReference::Amsl => lowest_m(),
        AltitudeReference::Home => Some(lowest_m()? - step.around.home_m?),
    }
}

/// All at one altitude.
fn level(leg: &Leg) -> Option<Edit> {
    changed(leg, |kind| {
        let LegKind::Pattern(Pattern::Contour { levels, level_step_m, .. }) = kind else { return None };
        (*levels, *level_step_m) = (None, None);
        Some(())
    })
}

fn with_levels(leg: &Leg, n: f64) -> Option<Edit> {
    changed(leg, |kind| {
        let LegKind::Pattern(Pattern::Contour { levels, .. }) = kind else { return None };
        *levels = Some(Value::Constant(n));
        Some(())
    })
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, codes_over, fixed_legs, plan_with};
    use terrain::Tiles;

    fn contour(attributes: &str) -> String {
        format!(
            r#"<contour id="p" spacing="150" loops="3" turn="left" direction="outward" {attributes}><area fix="A" radius="900"/></contour>"#
        )
    }

    fn above_ground(metres: i32, attributes: &str) -> String {
        contour(&format!(r#"altitude="{metres}" altitudeReference="agl" {attributes}"#))
    }

    #[test]
    fn levels_follow_on_each_other_and_stay_between_ground_and_ceiling() {
        let bad: &[&str] = &["bad-levels"];
        check_legs(&[
            (&contour(r#"levels="4" levelStep="60""#), &[]),
            (&contour(r#"levelStep="-20""#), &[]),
            (&contour(r#"levels="4" levelStep="0""#), bad),
            (&contour(r#"levels="4""#), bad),
            (&contour(r#"levels="0" levelStep="60""#), bad),
            (&contour(r#"levels="2.5" levelStep="60""#), bad),
            (&contour(r#"levels="1001" levelStep="1""#), bad),
            (&contour(r#"levels="60" levelStep="60""#), bad),
            (&above_ground(300, r#"levels="4" levelStep="-99""#), &[]),
            (&above_ground(300, r#"levels="4" levelStep="-100""#), bad),
            // as many as there are loops
            (&above_ground(300, r#"levelStep="-149""#), &[]),
            (&above_ground(300, r#"levelStep="-150""#), bad),
        ]);
    }

    /// The runway's elevation is 300 m: nothing is known to lie lower than the sea.
    #[test]
    fn over_unknown_ground_levels_stay_above_the_sea() {
        let above = |reference: &str, attributes: &str| {
            let altitude = format!(r#"altitude="200" altitudeReference="{reference}" {attributes}"#);
            codes_over(&plan_with(&contour(&altitude)), &Tiles::new()).contains(&"bad-levels")
        };
        assert!(!above("amsl", r#"levels="4" levelStep="-60""#));
        assert!(above("amsl", r#"levels="5" levelStep="-60""#));
        assert!(above("amsl", r#"levelStep="-100""#), "as many as there are loops");
        assert!(!above("home", r#"levels="5" levelStep="-100""#), "it ends at 100 m AMSL");
        assert!(above("home", r#"levels="6" levelStep="-100""#));
    }

    #[test]
    fn most_are_repaired() {
        let cases = [
            contour(r#"levels="4" levelStep="0""#),
            contour(r#"levels="4""#),
            contour(r#"levels="2.5" levelStep="60""#),
            contour(r#"levels="60" levelStep="60""#),
            above_ground(300, r#"levels="4" levelStep="-100""#),
            above_ground(300, r#"levels="9" levelStep="-400""#),
        ];
        cases.iter().for_each(|legs| fixed_legs(&[(legs, "bad-levels")]));
    }
}
