//! `below-terrain`: a pattern is lower than the ground at one of its own places.
//!
//! The review sees the ground below all of it, but it flies no plan that has an error anywhere.

use super::Inspection;
use super::remedy::raise;
use super::step::Step;
use crate::uses::Part;
use crate::{LegKind, Problem};
use geometry::LatLon;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    if !matches!(step.leg.kind, LegKind::Pattern(_) | LegKind::Scan(_) | LegKind::Orbit { .. }) {
        return;
    }
    let Some((flown_m, ground_m)) = lowest(view, step).filter(|(flown_m, ground_m)| flown_m < ground_m)
    else {
        return;
    };
    let lacks_m = ground_m - flown_m + super::CLEARANCE_M;
    let message = format!(
        "it goes into the ground, which is {ground_m:.0} m AMSL high at one of its places: raise this leg by {:.0} m",
        lacks_m.ceil()
    );
    let fix = raise(view, &step.leg.id, step.altitude(), flown_m, lacks_m);
    problems.push(Problem::error("below-terrain", message).of(&step.leg.id).perhaps_fixed_by(fix));
}

/// Of its places the one that is nearest to the ground: how high it is flown, and how high the ground is there, metres AMSL.
fn lowest(view: &Inspection, step: &Step) -> Option<(f64, f64)> {
    let altitude = step.altitude()?;
    let mut lowest: Option<(f64, f64)> = None;
    let mut look_at = |at: LatLon| {
        let flown_m = view.altitude_amsl_m(altitude, at, step.around.home_m);
        let Some((flown_m, ground_m)) = flown_m.zip(view.terrain.elevation_m(at)) else { return };
        if lowest.is_none_or(|(flown, ground)| flown_m - ground_m < flown - ground) {
            lowest = Some((flown_m, ground_m));
        }
    };
    step.leg.for_each_part(&mut |part| match part {
        Part::Place(place) => view.place(place).into_iter().for_each(&mut look_at),
        Part::Corner(corner) => look_at(corner),
        Part::Number(_) | Part::Source(..) => {}
    });
    lowest
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs};

    /// The ground is 300 m high; where the fix is, nobody knows.
    #[test]
    fn a_pattern_in_the_ground_is_told_beside_another_error() {
        let legs = |altitude_m: f64, reference: &str| {
            let altitude = format!(r#"altitude="{altitude_m}" altitudeReference="{reference}""#);
            [
                format!(
                    r#"<corridor id="p" width="900" spacing="310" {altitude}><route><point fix="B"/><point fix="C"/></route></corridor>"#
                ),
                format!(
                    r#"<scan id="p" spacing="310" {altitude}><area><corner lat="36.30" lon="-84.17"/><corner lat="36.30" lon="-84.14"/><corner lat="36.33" lon="-84.15"/></area></scan>"#
                ),
                format!(
                    r#"<orbit id="p" radius="400" turns="1" turn="left" {altitude}><centre fix="B"/></orbit>"#
                ),
            ]
        };
        for leg in legs(250.0, "amsl") {
            let with_error = format!(r#"<DF id="a" fix="NOWHERE"/>{leg}"#);
            check_legs(&[(&with_error, &["unknown-fix", "below-terrain"])]);
            fixed_legs(&[(&with_error, "below-terrain")]);
        }
        for leg in legs(350.0, "amsl").into_iter().chain(legs(100.0, "agl")) {
            check_legs(&[(&format!(r#"<DF id="a" fix="NOWHERE"/>{leg}"#), &["unknown-fix"])]);
        }
    }
}
