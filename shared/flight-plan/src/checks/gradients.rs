//! `too-steep`: a climb or descent that the aircraft can't fly on the length of the leg.

use super::path::SHORTEST_M;
use super::remedy::relevelled;
use super::step::Step;
use super::{CLEARANCE_M, Inspection};
use crate::at_source;
use crate::legible::told_apart;
use crate::{Edit, Id, IterativeForm, LegKind, Problem, StageKind};

/// So much does rounding make of it, metres: what another program writes has four decimals.
const ROUNDED_M: f64 = 0.1;
/// So much more than the aircraft does the gateway grants on a way, metres: it is flown, and ends so far from its altitude. The
/// waypoints of a climb are written so.
const GRANTED_M: f64 = 10.0;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let Some((gain_m, length_m)) = gain_and_length_m(step) else { return };
    let limit = limit_mps(view, step, gain_m);
    let possible_m = length_m / step.speed_mps * limit;
    let lacking_m = gain_m.abs() - possible_m;
    if lacking_m > ROUNDED_M {
        let what = if gain_m > 0.0 { "climb" } else { "descend" };
        let (at_least, at_most) = if step.start.is_none() { ("at least ", "at most ") } else { ("", "") };
        let (takes, does) = told_apart(gain_m.abs() / (length_m / step.speed_mps), limit);
        let is_final = gain_m < 0.0 && ends_approach(step);
        let cause = beginning(view, step, limit, is_final);
        let from_m = step.entry_altitude_amsl_m().filter(|_| !is_final || cause.is_none());
        let ends = from_m.map_or_else(String::new, |from_m| {
            // in whole metres that it reaches
            let reached_m =
                if gain_m > 0.0 { (from_m + possible_m).floor() } else { (from_m - possible_m).ceil() };
            format!("end it at {reached_m:.0} m AMSL, ")
        });
        let begins = cause.as_ref().map_or_else(String::new, |begins| begins.told());
        let message = format!(
            "{begins}{ends}lengthen this leg from {at_most}{:.0} m to {:.0} m or hold to {what} before it (HA): it takes {at_least}{takes} m/s, the aircraft does {does} m/s",
            length_m.floor(),
            (gain_m.abs() / limit * step.speed_mps).ceil()
        );
        let say = if lacking_m > GRANTED_M { Problem::error } else { Problem::warning };
        let problem = |message| say("too-steep", message).of(&step.leg.id);
        let problem = match (cause, Reached::of(step, limit).filter(|_| !is_final)) {
            (Some(begins), _) => problem(message).fixed_by(begins.edit),
            (None, Some(reached)) => reached.mends(view, step, message, problem),
            (None, None) => problem(message),
        };
        problems.push(problem);
    }
}

/// What the aircraft climbs or descends, m/s.
fn limit_mps(view: &Inspection, step: &Step, gain_m: f64) -> f64 {
    let (climb, descent) = (view.profile.max_climb_mps, view.profile.max_descent_mps);
    // flown backwards, a climb is a descent
    match (flown_backwards(step), gain_m > 0.0) {
        (true, _) => climb.min(descent),
        (false, true) => climb,
        (false, false) => descent,
    }
}

/// Another altitude for the leg before.
struct Beginning<'a> {
    leg: &'a Id,
    /// Metres AMSL: whole ones from which this leg is flown.
    altitude_amsl_m: f64,
    is_higher: bool,
    edit: Edit,
}

impl Beginning<'_> {
    fn told(&self) -> String {
        let verb = if self.is_higher { "raise" } else { "lower" };
        format!("{verb} `{}` to {:.0} m AMSL, ", self.leg, self.altitude_amsl_m)
    }
}

/// The end of an approach is where the landing begins: a higher one would only make that too steep.
fn ends_approach(step: &Step) -> bool {
    step.around.stage.kind == StageKind::Approach && step.after.is_none()
}

/// The leg before has an altitude of its own, and this one only goes back to that of its stage, or down to its landing (`is_final`): there
/// lies the cause. `None`: it does not, or the leg before can't be flown to another one.
fn beginning<'a>(view: &'a Inspection, step: &Step, most_mps: f64, is_final: bool) -> Option<Beginning<'a>> {
    let goes_back = |before: &&Step| step.leg.altitude.is_none() && before.leg.altitude.is_some();
    let before = view.before(step).filter(|before| is_final || goes_back(before))?;
    let (from_m, to_m) = (step.start?.altitude_amsl_m?, step.end?.altitude_amsl_m?);
    let possible_m = step.path?.length_m() / step.speed_mps * most_mps;
    let is_higher = to_m > from_m;
    let altitude_amsl_m = if is_higher { (to_m - possible_m).ceil() } else { (to_m + possible_m).floor() };
    let edit = relevelled(view, &before.leg.id, before.altitude(), from_m, altitude_amsl_m - from_m)?;
    let is_flown = before.entry_altitude_amsl_m().is_none_or(|entry_m| {
        let gain_m = altitude_amsl_m - entry_m;
        let most_m = longest_m(before).map(|m| m / before.speed_mps * limit_mps(view, before, gain_m));
        most_m.is_none_or(|most_m| gain_m.abs() <= most_m)
    });
    let ground_m = view.terrain.elevation_m(step.start?.position).unwrap_or(f64::NEG_INFINITY);
    let is_flown = is_flown && (is_higher || altitude_amsl_m - ground_m >= CLEARANCE_M);
    is_flown.then_some(Beginning { leg: &before.leg.id, altitude_amsl_m, is_higher, edit })
}

/// The altitude that is reached at the end of a leg, metres AMSL, and the one that is asked for there.
struct Reached {
    to_m: f64,
    reached_m: f64,
}

impl Reached {
    fn of(step: &Step, limit_mps: f64) -> Option<Self> {
        let (from_m, to_m) = (step.start?.altitude_amsl_m?, step.end?.altitude_amsl_m?);
        let possible_m = step.path?.length_m() / step.speed_mps * limit_mps;
        let reached_m = from_m + (to_m - from_m).clamp(-possible_m, possible_m);
        Some(Self { to_m, reached_m })
    }

    /// The leg gets the altitude that it reaches. Where that only makes the next one too steep: what says the altitude of both gets
    /// it, if anything does.
    fn mends(
        &self,
        view: &Inspection,
        step: &Step,
        message: String,
        problem: impl Fn(String) -> Problem,
    ) -> Problem {
        let edit = |of| relevelled(view, of, step.altitude(), self.to_m, self.reached_m - self.to_m);
        let next = view.after(step).filter(|next| is_steeper_from(view, next, self.reached_m));
        let Some(next) = next else { return problem(message).perhaps_fixed_by(edit(&step.leg.id)) };
        let said_by = |step: &Step| match &step.leg.altitude {
            None => step.around.says_altitude().map(|(id, altitude)| (id.clone(), altitude.clone())),
            Some(_) => None,
        };
        match said_by(step).filter(|both| said_by(next).as_ref() == Some(both)) {
            Some((of, altitude)) => {
                let said = at_source::said("it", &of, &altitude);
                problem(format!("{said}: {message}")).perhaps_fixed_by(edit(&of))
            }
            None => problem(message),
        }
    }
}

/// Begun at this altitude, it takes more than the aircraft does, and more than now.
fn is_steeper_from(view: &Inspection, step: &Step, from_m: f64) -> bool {
    let ends = step.entry_altitude_amsl_m().zip(step.end.and_then(|end| end.altitude_amsl_m));
    let Some(((now_m, to_m), length_m)) = ends.zip(longest_m(step)) else { return false };
    let gain_m = to_m - from_m;
    let possible_m = length_m / step.speed_mps * limit_mps(view, step, gain_m);
    gain_m.abs() > possible_m + ROUNDED_M && gain_m.abs() > (to_m - now_m).abs()
}

/// How much higher it ends than it begins, and how long it is; `None`: there is nothing to gain, or it can't be said.
fn gain_and_length_m(step: &Step) -> Option<(f64, f64)> {
    let length_m = longest_m(step).filter(|m| *m >= SHORTEST_M)?;
    let gain_m = step.end?.altitude_amsl_m? - step.entry_altitude_amsl_m()?;
    // nothing to gain needs no time
    (gain_m.abs() > 0.1).then_some((gain_m, length_m))
}

/// How long its path is; of a track that is entered within a circle: from the farthest side.
fn longest_m(step: &Step) -> Option<f64> {
    let path = step.path.map(|path| path.length_m());
    path.or_else(|| match step.leg.kind {
        LegKind::Tf(_) => Some(step.start_within?.distances_m(step.end?.position)?.1),
        _ => None,
    })
}

fn flown_backwards(step: &Step) -> bool {
    step.around.loops.iter().any(|l| l.form == IterativeForm::Reverse)
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, document, fixed, fixed_legs, message_of, plan_with};
    use crate::{Problem, check, read};
    use aircraft::Profile;
    use terrain::Flat;

    /// From A at 500 m to B, 2695 m away: 107.8 s at 25 m/s, so at most 431 m.
    fn with(altitude_m: f64) -> String {
        format!(
            r#"<IF id="a" fix="A"/><TF id="b" fix="B" altitude="{altitude_m}" altitudeReference="amsl"/>"#
        )
    }

    #[test]
    fn climbs_and_descents_within_the_aircraft() {
        check_legs(&[
            (&with(930.0), &[]),
            (&with(935.0), &["too-steep"]),
            (
                r#"<IF id="a" fix="A" altitude="935" altitudeReference="amsl"/><TF id="b" fix="B"/>"#,
                &["too-steep"],
            ),
        ]);
        fixed_legs(&[(&with(935.0), "too-steep"), (&with(60.0), "too-steep")]);
    }

    #[test]
    fn a_descent_is_made_by_descending() {
        let message = message_of(&with(60.0), "too-steep");
        assert!(message.contains(" or hold to descend before it (HA): "), "{message}");
    }

    #[test]
    fn what_is_too_steep_is_told_with_what_would_do() {
        for (altitude_m, takes) in [(935.0, "4.04"), (931.5, "4.003")] {
            let message = message_of(&with(altitude_m), "too-steep");
            let (advice, why) = message.split_once(": ").unwrap();
            assert!(why.starts_with(&format!("it takes {takes} m/s, the aircraft does 4.0")), "{message}");
            let reached: f64 =
                advice.strip_prefix("end it at ").unwrap().split(' ').next().unwrap().parse().unwrap();
            check_legs(&[(&with(reached), &[])]);
            check_legs(&[(&with(reached + 1.0), &["too-steep"])]);
            let length: f64 = advice
                .split("lengthen this leg from 2694 m to ")
                .nth(1)
                .unwrap()
                .split(' ')
                .next()
                .unwrap()
                .parse()
                .unwrap();
            let lon = -84.20 + (length + 1.0) / 2694.6 * 0.03;
            let longer = with(altitude_m).replace(r#"fix="B""#, &format!(r#"lat="36.3" lon="{lon}""#));
            check_legs(&[(&longer, &[])]);
        }
    }

    /// The leg before was raised by itself, and this one goes back to its stage's altitude.
    #[test]
    fn the_altitude_of_the_leg_before_is_named_first_where_it_is_the_cause() {
        let raised = |metres: f64| {
            format!(
                r#"<IF id="a" fix="A" altitude="{metres}" altitudeReference="amsl"/><TF id="b" fix="B"/>"#
            )
        };
        let message = message_of(&raised(1100.0), "too-steep");
        let rest = message.strip_prefix("lower `a` to ").unwrap_or_else(|| panic!("{message}"));
        let highest: f64 = rest.split(' ').next().unwrap().parse().unwrap();
        check_legs(&[(&raised(highest), &[]), (&raised(highest + 2.0), &["too-steep"])]);
        let found = check(&read(plan_with(&raised(1100.0))).plan, &Profile::default(), &Flat(300.0));
        let fix = found.iter().find_map(|problem| problem.fix.as_ref()).unwrap();
        assert!(format!("{fix:?}").contains("\"a\""), "the fix is what is named first: {fix:?}");
        let both = r#"<IF id="a" fix="A" altitude="1100" altitudeReference="amsl"/><TF id="b" fix="B" altitude="500" altitudeReference="amsl"/>"#;
        assert!(message_of(both, "too-steep").starts_with("end it at "), "its own altitude is asked for");
    }

    /// To raise the end of the approach would make the landing too steep, whose fix lowers it again.
    #[test]
    fn an_approach_that_is_too_steep_is_begun_lower() {
        let approach = |entry: f64| {
            document(&format!(
                r#"<stage id="s" type="en-route"><IF id="a" fix="B" altitude="{entry}" altitudeReference="amsl"/></stage>
                   <stage id="ap" type="approach"><TF id="b" fix="A" altitude="400" altitudeReference="amsl"/></stage>"#
            ))
        };
        let mended = fixed(&approach(900.0), "too-steep");
        let metres = |leg: &str| match mended.leg(&leg.into()).unwrap().leg.altitude.clone().unwrap().metres {
            crate::Value::Constant(metres) => metres,
            crate::Value::Expression(formula) => panic!("{formula}"),
        };
        assert!(metres("a") < 832.0 && metres("b") == 400.0, "{} {}", metres("a"), metres("b"));
        let found = check(&read(approach(900.0)).plan, &Profile::default(), &Flat(300.0));
        let message = &found.iter().find(|problem| problem.code == "too-steep").unwrap().message;
        assert!(message.starts_with("lower `a` to ") && !message.contains("end it at"), "{message}");
    }

    /// What is written with four decimals is a hair steeper than what it was written from.
    #[test]
    fn rounding_makes_nothing_too_steep() {
        let exact_m = 500.0 + 2694.6 / 25.0 * 4.0;
        assert!(check_plan(exact_m + 0.05).is_empty());
        for lacking_m in [0.2, 5.0, 9.0, 11.0, 100.0] {
            let found = check_plan(exact_m + lacking_m);
            assert_eq!(found.len(), 1, "{lacking_m}");
            assert_eq!(found[0].is_error(), lacking_m > 10.0, "{}", found[0]);
            let (from, to) = found[0].message.split_once(" m to ").unwrap();
            let (from, to) = (from.rsplit(' ').next().unwrap(), to.split(' ').next().unwrap());
            assert!(from.parse::<f64>().unwrap() < to.parse::<f64>().unwrap(), "{}", found[0]);
        }
    }

    fn check_plan(altitude_m: f64) -> Vec<Problem> {
        let plan = read(plan_with(&with(altitude_m))).plan;
        check(&plan, &Profile::default(), &Flat(300.0))
    }

    /// The next track is 3.3 km long: from 931 m it leads down to 500 m, and no farther.
    #[test]
    fn no_edit_is_offered_that_makes_the_next_leg_too_steep() {
        let down_to = |next_m: f64| {
            let legs = format!(
                r#"<IF id="a" fix="A" altitude="1400" altitudeReference="amsl"/><TF id="b" fix="B" altitude="900" altitudeReference="amsl"/><TF id="c" fix="C" altitude="{next_m}" altitudeReference="amsl"/>"#
            );
            let found = check(&read(plan_with(&legs)).plan, &Profile::default(), &Flat(300.0));
            assert_eq!(found.len(), 1, "{found:?}");
            (found[0].subject.clone(), found[0].fix.is_some())
        };
        assert_eq!(down_to(600.0), (Some("b".into()), true));
        assert_eq!(down_to(400.0), (Some("b".into()), false));
    }
}
