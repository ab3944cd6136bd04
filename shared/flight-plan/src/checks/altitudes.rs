//! `above-ceiling`: higher than the aircraft flies; `bad-value`: far below any land; `no-altitude`: nothing says how high a leg is flown.

use super::Inspection;
use super::remedy::relevelled;
use super::step::Step;
use crate::{Altitude, AltitudeReference, Id, LegKind, Problem};

/// Lower than any land (the shore of the Dead Sea is at −430 m), metres AMSL.
pub const LOWEST_AMSL_M: f64 = -500.0;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    let main = view.plan.stages.iter().enumerate().map(|(i, stage)| (stage, view.home_at_m(i)));
    let emergencies = view.plan.emergency_plans.iter().flat_map(|plan| &plan.stages);
    for (stage, home_m) in main.chain(emergencies.map(|stage| (stage, view.common_home_m()))) {
        let own = stage.runway.as_ref().and_then(|id| view.runways.get(id).copied());
        let at = own.or(view.home()).map(|r| r.threshold);
        let amsl_m = stage.altitude.as_ref().zip(at).and_then(|(a, at)| view.altitude_amsl_m(a, at, home_m));
        bounds(view, amsl_m, (&stage.id, stage.altitude.as_ref()), problems);
    }
    // legs in document order: the first one is the main plan's first, if that has any
    view.steps().first().into_iter().for_each(|step| unknown(view, step, problems));
}

/// That of a leg itself.
pub(super) fn leg(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    bounds(view, own_altitude_m(view, step), (&leg.id, leg.altitude.as_ref()), problems);
}

/// The altitude that is written on a leg, at its end or (if that is not known) over sea level.
fn own_altitude_m(view: &Inspection, step: &Step) -> Option<f64> {
    let altitude: &Altitude = step.leg.altitude.as_ref()?;
    let home_m = step.around.home_m;
    match (step.end, altitude.reference) {
        (Some(end), _) => view.altitude_amsl_m(altitude, end.position, home_m),
        (None, AltitudeReference::Amsl) => view.number(&altitude.metres),
        (None, _) => view.place(step.leg.place()?).and_then(|at| view.altitude_amsl_m(altitude, at, home_m)),
    }
}

fn bounds(
    view: &Inspection,
    amsl_m: Option<f64>,
    (of, written): (&Id, Option<&Altitude>),
    problems: &mut Vec<Problem>,
) {
    // over unknown ground what is written has to be enough
    let lowest_m = amsl_m.or_else(|| view.number(&written?.metres));
    if lowest_m.is_some_and(|m| m < LOWEST_AMSL_M) {
        let message =
            format!("raise the altitude: {LOWEST_AMSL_M:.0} m AMSL is below any land, and this is lower");
        problems.push(Problem::error("bad-value", message).of(of));
    }
    let ceiling_m = view.profile.ceiling_amsl_m;
    if let Some(amsl_m) = amsl_m.filter(|m| *m > ceiling_m) {
        let message = format!(
            "lower the altitude to {ceiling_m:.0} m AMSL or less: {amsl_m:.0} m AMSL is above the aircraft's ceiling"
        );
        let fix = relevelled(view, of, written, amsl_m, ceiling_m - amsl_m);
        problems.push(Problem::error("above-ceiling", message).of(of).perhaps_fixed_by(fix));
    }
}

/// The first leg of a plan has no leg before it to take its altitude from.
fn unknown(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let moves = !matches!(leg.kind, LegKind::Iterative { .. } | LegKind::Intersection { .. });
    let takes_off = view.home().is_some();
    if moves && step.around.main && !takes_off && step.altitude().is_none() {
        let message = "give this leg or its stage an `altitude`: nothing before it says how high it is flown";
        problems.push(Problem::error("no-altitude", message).of(&leg.id));
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, codes, document, fixed_legs, message_of, plan_with};

    #[test]
    fn above_the_ceiling_in_any_datum() {
        let with = |altitude: &str| format!(r#"<DF id="a" fix="A" {altitude}/>"#);
        check_legs(&[
            (&with(r#"altitude="3000" altitudeReference="amsl""#), &[]),
            (&with(r#"altitude="3001" altitudeReference="amsl""#), &["above-ceiling"]),
            (&with(r#"altitude="2701" altitudeReference="agl""#), &["above-ceiling"]),
            (&with(r#"altitude="2701" altitudeReference="home""#), &["above-ceiling"]),
        ]);
        fixed_legs(&[(&with(r#"altitude="2701" altitudeReference="agl""#), "above-ceiling")]);
    }

    #[test]
    fn below_any_land_in_any_datum() {
        for (reference, written) in [("amsl", "-501"), ("home", "-801"), ("agl", "-801"), ("amsl", "-1e308")]
        {
            let low = format!(r#"<DF id="a" fix="A" altitude="{written}" altitudeReference="{reference}"/>"#);
            let message = message_of(&low, "bad-value");
            assert!(message.starts_with("raise the altitude"), "{message}");
        }
        let stage = r#"<stage id="s" type="en-route" altitude="-1e308" altitudeReference="amsl"><DF id="a" fix="A"/></stage>"#;
        assert!(codes(&document(stage)).contains(&"bad-value"));
        let dead_sea = r#"<DF id="a" fix="A" altitude="-400" altitudeReference="amsl"/>"#;
        assert!(!codes(&plan_with(dead_sea)).contains(&"bad-value"));
    }

    /// The second flight takes off from a field at 2400 m; what answers in both may be at either height.
    #[test]
    fn above_home_is_above_the_field_of_the_flight() {
        let level = r#"altitude="700" altitudeReference="home""#;
        let stages = format!(
            r#"<stage id="t" type="take-off" runway="R" altitude="100" altitudeReference="home"/>
            <stage id="w" type="en-route" {level}><HA id="a" fix="A" course="90" turn="right" length="1000"/></stage><stage id="l" type="land" runway="R"/>
            <stage id="u" type="take-off" runway="S" altitude="100" altitudeReference="home"/>
            <stage id="x" type="en-route" altitude="100" altitudeReference="home"><HA id="b" fix="A" course="90" turn="right" length="1000" {level}/></stage>
            <stage id="m" type="land" runway="S"/>"#
        );
        let field = r#"</runways>"#;
        let high = r#"<runway id="S" lat="36.3" lon="-84.21" elevation="2400" heading="90" length="500" priority="2"/></runways>"#;
        let document = document(&stages).replacen(field, high, 1);
        let found =
            crate::check(&crate::read(&document).plan, &aircraft::Profile::default(), &terrain::Flat(300.0));
        let high: Vec<_> = found.iter().filter(|p| p.code == "above-ceiling").collect();
        assert_eq!(
            high.iter().map(|p| p.subject.clone().unwrap()).collect::<Vec<_>>(),
            [crate::Id::new("b")]
        );
        let answer = r#"altitude="450" altitudeReference="amsl""#;
        assert!(document.contains(answer));
        let in_both = document.replacen(answer, r#"altitude="2700" altitudeReference="home""#, 1);
        assert_eq!(
            codes(&in_both).iter().filter(|code| **code == "above-ceiling").count(),
            1,
            "not of `e1d`"
        );
    }

    #[test]
    fn a_plan_that_never_says_how_high() {
        let stage = r#"<stage id="s" type="en-route"><DF id="a" fix="A"/></stage>"#;
        assert_eq!(codes(&document(stage)), ["no-altitude"]);
    }
}
