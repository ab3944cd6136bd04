//! Remedies for an altitude that a leg inherits: a wrong one is wrong where it comes from, and the next leg would inherit it again.

use crate::{Altitude, Edit, FlightPlan, Id, LegContext, Problem, Value};

/// An inherited altitude can't be reached: where it comes from is told first.
const STEEP: &str = "too-steep";
/// Problems of an altitude, or of how it is reached.
const CODES: [&str; 4] = ["below-terrain", "low-clearance", "above-ceiling", STEEP];

/// A remedy where the value comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct AtSource {
    /// The stage or loop.
    pub of: Id,
    /// So many legs inherit from there.
    pub legs: usize,
    /// Changes it there.
    pub edit: Edit,
}

/// Says of each problem that comes from an inherited altitude where that is from, and has it changed there: instead of at the leg
/// where no other leg inherits it, else as a choice beside it.
pub fn mend_at_source(plan: &FlightPlan, problems: &mut [Problem]) {
    let is_open = |problem: &&mut Problem| CODES.contains(&problem.code) && problem.at_source.is_none();
    for problem in problems.iter_mut().filter(is_open) {
        let Some(found) = problem.fix.as_deref().and_then(|fix| Inherited::of(plan, fix)) else { continue };
        let said = found.said(problem.subject.as_ref());
        problem.reword(match problem.message.split_once(": ") {
            _ if problem.code == STEEP => format!("{said}: {}", problem.message),
            Some((advice, why)) => format!("{advice} ({said}): {why}"),
            None => format!("{} ({said})", problem.message),
        });
        match found.heirs(plan) {
            legs if legs <= found.raised => problem.fix = Some(Box::new(found.edit)),
            legs => {
                let of = found.source.clone();
                problem.at_source = Some(Box::new(AtSource { of, legs, edit: found.edit }));
            }
        }
    }
}

/// What a remedy would change that is inherited.
struct Inherited {
    /// The last such leg, where it has its altitude from, and which that is.
    leg: Id,
    source: Id,
    altitude: Altitude,
    /// So many legs get another one.
    raised: usize,
    /// The remedy, made at the source.
    edit: Edit,
}

impl Inherited {
    /// `None`: it changes no inherited altitude, or those of several sources.
    fn of(plan: &FlightPlan, fix: &Edit) -> Option<Self> {
        let edits = match fix {
            Edit::All(edits) => edits.as_slice(),
            one => std::slice::from_ref(one),
        };
        let (mut found, mut others): (Option<Self>, Vec<Edit>) = (None, Vec::new());
        for edit in edits {
            let Edit::SetAltitude { of, altitude: Some(to) } = edit else { return None };
            let context = plan.leg(of);
            let Some((source, altitude)) = context.as_ref().and_then(inherits_from) else {
                others.push(edit.clone());
                continue;
            };
            let raised = 1 + match &found {
                Some(former) if former.source != *source => return None,
                former => former.as_ref().map_or(0, |former| former.raised),
            };
            let edit = Edit::SetAltitude { of: source.clone(), altitude: Some(to.clone()) };
            let (leg, source, altitude) = (of.clone(), source.clone(), altitude.clone());
            found = Some(Self { leg, source, altitude, raised, edit });
        }
        let mut found = found?;
        if !others.is_empty() {
            others.push(found.edit);
            found.edit = Edit::All(others);
        }
        Some(found)
    }

    /// `it inherits 20 m AMSL from `stage``.
    fn said(&self, subject: Option<&Id>) -> String {
        let who = if subject == Some(&self.leg) { "it".into() } else { format!("`{}`", self.leg) };
        said(&who, &self.source, &self.altitude)
    }

    /// So many legs inherit from there.
    fn heirs(&self, plan: &FlightPlan) -> usize {
        let from_there = |context: &LegContext<'_>| {
            context.leg.body().is_empty()
                && context.leg.as_fork().is_none()
                && inherits_from(context).is_some_and(|(source, _)| *source == self.source)
        };
        plan.all_legs().iter().filter(|context| from_there(context)).count()
    }
}

/// `it inherits 20 m AMSL from `stage``.
pub(crate) fn said(who: &str, source: &Id, altitude: &Altitude) -> String {
    let metres = match &altitude.metres {
        Value::Constant(metres) => format!("{metres:.0} m"),
        Value::Expression(formula) => format!("`{formula}`"),
    };
    let reference = match altitude.reference {
        crate::AltitudeReference::Amsl => "AMSL",
        crate::AltitudeReference::Agl => "AGL",
        crate::AltitudeReference::Home => "above home",
    };
    crate::legible(&format!("{who} inherits {metres} {reference} from `{source}`")).into_owned()
}

/// The loop or stage that says the altitude of a leg without one of its own.
fn inherits_from<'a>(context: &LegContext<'a>) -> Option<(&'a Id, &'a Altitude)> {
    let loops = context.loops.iter().rev().map(|leg| (&leg.id, leg.altitude.as_ref()));
    let stage = (&context.stage.id, context.stage.altitude.as_ref());
    // what a take-off says is where the climb-out ends
    let said = context.altitude().filter(|_| context.leg.altitude.is_none())?;
    let from = loops.chain([stage]).find(|(_, altitude)| altitude.is_some())?.0;
    Some((from, said))
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::plan_with;
    use crate::{FlightPlan, Id, Problem, Value, check, read};
    use aircraft::Profile;
    use terrain::Flat;

    /// Over flat ground at 300 m; the stage `way` says 250 m AMSL in place of its 500.
    fn low(legs: &str) -> (FlightPlan, Vec<Problem>) {
        let plan = read(plan_with(legs).replacen(r#"altitude="500""#, r#"altitude="250""#, 1)).plan;
        let found = check(&plan, &Profile::default(), &Flat(300.0));
        (plan, found.into_iter().filter(|problem| problem.code == "below-terrain").collect())
    }

    fn metres(plan: &FlightPlan, id: &str) -> Option<f64> {
        let id = Id::new(id);
        let leg = plan.leg(&id).and_then(|context| context.leg.altitude.as_ref());
        let said = leg.or_else(|| plan.stage(&id)?.altitude.as_ref())?;
        match said.metres {
            Value::Constant(metres) => Some(metres),
            Value::Expression(_) => None,
        }
    }

    #[test]
    fn what_only_one_leg_inherits_is_mended_where_it_comes_from() {
        let (plan, found) =
            low(r#"<IF id="a" fix="A"/><TF id="b" fix="B" altitude="400" altitudeReference="amsl"/>"#);
        let [problem, ..] = found.as_slice() else { panic!("nothing found") };
        assert!(
            problem
                .message
                .ends_with("AMSL high there (it inherits 250 m AMSL from `way`): raise this leg by 100 m"),
            "{problem}"
        );
        assert_eq!(problem.at_source, None);
        let mended = problem.fix.as_ref().unwrap().apply(&plan).unwrap();
        assert_eq!((metres(&mended, "way"), metres(&mended, "a")), (Some(350.0), None));
    }

    #[test]
    fn what_several_legs_inherit_is_offered_for_the_leg_and_for_all() {
        let (plan, found) = low(r#"<IF id="a" fix="A"/><TF id="b" fix="B"/><TF id="c" fix="C"/>"#);
        let problem = found.iter().find(|problem| problem.subject == Some("a".into())).unwrap();
        let alone = problem.fix.as_ref().unwrap().apply(&plan).unwrap();
        assert_eq!((metres(&alone, "way"), metres(&alone, "a")), (Some(250.0), Some(350.0)));
        let there = problem.at_source.as_ref().unwrap();
        assert_eq!((there.of.as_str(), there.legs), ("way", 3));
        let mended = there.edit.apply(&plan).unwrap();
        assert_eq!((metres(&mended, "way"), metres(&mended, "a")), (Some(350.0), None));
        let left = check(&mended, &Profile::default(), &Flat(300.0));
        assert!(left.iter().all(|problem| problem.code != "below-terrain"), "{left:?}");
    }

    /// The stage `way` is so low that its first leg can't descend to it: first alone, and where the next leg would be too steep then,
    /// for all of them.
    #[test]
    fn a_leg_too_steep_for_the_altitude_it_inherits_says_so_and_has_it_changed_there() {
        let stage = r#"<stage id="high" type="en-route" altitude="1400" altitudeReference="amsl"><IF id="h" fix="A"/></stage><stage id="way""#;
        let found = |legs: &str| {
            let text = plan_with(legs).replacen(r#"<stage id="way""#, stage, 1);
            let plan = read(&text).plan;
            let found = check(&plan, &Profile::default(), &Flat(300.0));
            let steep: Vec<Problem> = found.into_iter().filter(|p| p.code == "too-steep").collect();
            (plan, steep)
        };
        let said = "it inherits 500 m AMSL from `way`: end it at ";
        let (plan, steep) = found(r#"<TF id="b" fix="B"/><TF id="c" fix="C"/>"#);
        let [problem] = steep.as_slice() else { panic!("{steep:?}") };
        assert!(problem.message.starts_with(said), "{problem}");
        let mended = problem.at_source.as_ref().unwrap().edit.apply(&plan).unwrap();
        assert!(metres(&mended, "way") > Some(900.0) && metres(&mended, "b").is_none());
        // from what is reached at its end the short one can't descend to the rest
        let (plan, steep) = found(r#"<TF id="b" fix="B"/><TF id="c" lat="36.3" lon="-84.165"/>"#);
        let [problem] = steep.as_slice() else { panic!("{steep:?}") };
        assert!(problem.message.starts_with(said), "{problem}");
        let mended = problem.fix.as_ref().unwrap().apply(&plan).unwrap();
        assert!(metres(&mended, "way") > Some(900.0) && metres(&mended, "b").is_none());
        assert!(check(&mended, &Profile::default(), &Flat(300.0)).iter().all(|p| p.code != "too-steep"));
    }

    #[test]
    fn an_altitude_of_the_legs_own_is_mended_there_and_nothing_is_said_of_others() {
        let own = r#"altitude="250" altitudeReference="amsl""#;
        let (_, found) = low(&format!(r#"<IF id="a" fix="A" {own}/><TF id="b" fix="B" {own}/>"#));
        assert!(!found.is_empty());
        for problem in found {
            assert!(!problem.message.contains("inherits") && problem.at_source.is_none(), "{problem}");
        }
    }

    /// Said once, however often a list of problems comes by.
    #[test]
    fn a_remedy_at_its_source_stays_as_it_is() {
        for legs in [r#"<IF id="a" fix="A"/>"#, r#"<IF id="a" fix="A"/><TF id="b" fix="B"/>"#] {
            let (plan, found) = low(legs);
            let mut again = found.clone();
            super::mend_at_source(&plan, &mut again);
            assert_eq!(again, found);
        }
    }
}
