//! `below-terrain`: a leg goes into the ground; `low-clearance`: it comes nearer than the margin, away from runways.

use super::Inspection;
use super::remedy::raise;
use super::step::{Point, Step};
use crate::{Edit, LegKind, Problem, StageKind};

/// Height above the ground that a leg keeps as it is written, metres; departure, approach and land stages may come nearer. The
/// review asks for a little less of the path as flown (`flight_exec::Margins`), because turns and climbs differ from the lines.
pub const MARGIN_M: f64 = 50.0;
/// Distance between samples of the ground, metres: half of what 3″ data resolves.
const SPACING_M: f64 = 45.0;
/// Most samples on a leg.
const MAX_SAMPLES: f64 = 2_000.0;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    if is_high(view, step) == Some(true) {
        return;
    }
    let Some(lowest) = lowest(view, step) else { return };
    let near_runway =
        matches!(step.around.stage.kind, StageKind::Departure | StageKind::Approach | StageKind::Land);
    let advice = || advice(view, step, &lowest);
    let (code, message) = match lowest.clearance_m {
        clearance_m if clearance_m < 0.0 => {
            let ground_m = lowest.ground_m;
            let what = format!("it goes into the ground, which is {ground_m:.0} m AMSL high there");
            ("below-terrain", format!("{what}: {}", advice()))
        }
        clearance_m if clearance_m < MARGIN_M && !near_runway => {
            let what = format!(
                "it passes {:.0} m above the ground, and a plan is written to keep {MARGIN_M:.0} m above it",
                clearance_m.floor()
            );
            ("low-clearance", format!("{}: {what}", advice()))
        }
        _ => return,
    };
    let problem = if lowest.clearance_m < 0.0 { Problem::error } else { Problem::warning };
    let fix = raised(view, step);
    problems.push(problem(code, message).of(&step.leg.id).perhaps_fixed_by(fix));
}

/// Where a leg is nearest to the ground.
struct Lowest {
    clearance_m: f64,
    /// The ground's elevation there, metres AMSL.
    ground_m: f64,
    /// How far along the leg it is, 0..1.
    share: f64,
    /// How much lower than its end the leg still is there, metres.
    below_end_m: f64,
}

/// By how much a leg has to be raised so that no place of it is too low, metres.
#[derive(Default)]
struct Lift {
    /// What it begins with: the end of what is flown before.
    begin_m: f64,
    end_m: f64,
}

impl Lift {
    fn over(places: impl Iterator<Item = Lowest>) -> Self {
        places.filter(|place| place.lacks_m() > 0.0).fold(Self::default(), |lift, place| {
            let on_the_way = |metres| if place.is_on_the_way() { metres } else { 0.0 };
            let (begin_m, end_m) = match place.begin_higher_by_m() {
                Some(by_m) => (by_m, 0.0),
                None => (on_the_way(place.lacks_m()), place.lacks_m()),
            };
            Self { begin_m: lift.begin_m.max(begin_m), end_m: lift.end_m.max(end_m) }
        })
    }
}

impl Lowest {
    /// What it lacks, metres.
    fn lacks_m(&self) -> f64 {
        MARGIN_M - self.clearance_m
    }

    /// Not at the leg's end: its altitude alone would have to rise by more than what is lacking.
    fn is_on_the_way(&self) -> bool {
        self.share < 1.0
    }

    /// The leg is only still climbing there: at the altitude of its end it would pass. So much higher it has to begin, metres.
    fn begin_higher_by_m(&self) -> Option<f64> {
        (self.below_end_m >= self.lacks_m()).then(|| self.lacks_m() / (1.0 - self.share))
    }
}

/// What has to change: the leg, or where it begins.
fn advice(view: &Inspection, step: &Step, lowest: &Lowest) -> String {
    let Some(by_m) = lowest.begin_higher_by_m() else {
        let before = view.before(step).filter(|_| lowest.is_on_the_way());
        let too = before.map_or_else(String::new, |before| format!(" and `{}` before it", before.leg.id));
        return format!("raise this leg{too} by {:.0} m", lowest.lacks_m().ceil());
    };
    let before = match view.before(step) {
        Some(before) => format!("`{}`", before.leg.id),
        None => "the climb before this leg".to_owned(),
    };
    format!(
        "raise {before} by {:.0} m, or hold to climb (HA) behind it, because this leg is still climbing there",
        by_m.ceil()
    )
}

/// Even the highest ground around is well below the whole leg.
fn is_high(view: &Inspection, step: &Step) -> Option<bool> {
    let (start, end) = (step.start?, step.end?);
    let (south_west, north_east) = step.path?.around(start.position, end.position)?;
    let lowest_m = start.altitude_amsl_m?.min(end.altitude_amsl_m?);
    Some(lowest_m - view.terrain.at_most_m(south_west, north_east)? >= MARGIN_M)
}

/// High enough all along: begun higher where it only has to climb before, else raised, at both ends if it is too low on the way.
fn raised(view: &Inspection, step: &Step) -> Option<Edit> {
    let Lift { begin_m, end_m } = Lift::over(places(view, step)?);
    let lift = |of: &Step, by_m| raise(view, &of.leg.id, of.altitude(), of.end?.altitude_amsl_m?, by_m);
    let before = view.before(step).filter(|_| begin_m > 0.0);
    match (before, end_m > 0.0) {
        (Some(before), true) => Some(Edit::All(vec![lift(before, begin_m)?, lift(step, end_m)?])),
        (Some(before), false) => lift(before, begin_m),
        (None, true) => lift(step, end_m),
        (None, false) => None,
    }
}

fn lowest(view: &Inspection, step: &Step) -> Option<Lowest> {
    places(view, step)?.min_by(|a, b| a.clearance_m.total_cmp(&b.clearance_m))
}

/// The end of a leg and places along it, as far as their ground is known.
fn places<'a>(view: &'a Inspection, step: &'a Step) -> Option<impl Iterator<Item = Lowest> + 'a> {
    // the preview flies patterns, and sees the ground below all of them
    let end = step.end.filter(|_| !matches!(step.leg.kind, LegKind::Pattern(_)))?;
    let to_m = end.altitude_amsl_m?;
    let at_end = clearance_m(view, end, to_m).map(|(clearance_m, ground_m)| Lowest {
        clearance_m,
        ground_m,
        share: 1.0,
        below_end_m: 0.0,
    });
    let along = step.start.zip(step.path.as_ref()).and_then(|(start, path)| {
        let from_m = start.altitude_amsl_m?;
        let samples = (path.length_m() / SPACING_M).ceil().clamp(1.0, MAX_SAMPLES);
        let lowest_at = move |(share, position)| {
            let below_end_m = (to_m - from_m) * (1.0 - share);
            let there = Point { position, altitude_amsl_m: None };
            let (clearance_m, ground_m) = clearance_m(view, there, to_m - below_end_m)?;
            Some(Lowest { clearance_m, ground_m, share, below_end_m })
        };
        Some(path.along(start.position, end.position, samples as u32).filter_map(lowest_at))
    });
    Some(at_end.into_iter().chain(along.into_iter().flatten()))
}

/// `(height above the ground, ground elevation there)`, metres.
fn clearance_m(view: &Inspection, at: Point, altitude_m: f64) -> Option<(f64, f64)> {
    let ground_m = view.terrain.elevation_m(at.position)?;
    Some((altitude_m - ground_m, ground_m))
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes_over, fixed, message_of, plan_with};
    use crate::{check, read};
    use aircraft::Profile;
    use geometry::LatLon;
    use terrain::Terrain;

    /// A ridge between A and B.
    struct Ridge(f64);
    impl Terrain for Ridge {
        fn elevation_m(&self, p: LatLon) -> Option<f64> {
            Some(if (p.lon_deg + 84.185).abs() < 0.001 { self.0 } else { 300.0 })
        }
    }

    #[test]
    fn a_ridge_between_two_waypoints_is_seen() {
        let plan = plan_with(r#"<IF id="a" fix="A"/><TF id="b" fix="B"/>"#);
        for (ridge_m, expected) in
            [(440.0, &[][..]), (460.0, &["low-clearance"]), (510.0, &["below-terrain"])]
        {
            assert_eq!(codes_over(&plan, &Ridge(ridge_m)), expected, "{ridge_m}");
        }
    }

    /// From 500 m to 700 m over a ridge in the middle: at 600 m there, it would be high enough at its end.
    #[test]
    fn a_leg_that_is_still_climbing_is_begun_higher() {
        let low = r#"<IF id="a" fix="A"/><TF id="b" fix="B" altitude="700" altitudeReference="amsl"/>"#;
        for (ridge_m, code) in [(570.0, "low-clearance"), (630.0, "below-terrain")] {
            let plan = read(plan_with(low)).plan;
            let found = check(&plan, &Profile::default(), &Ridge(ridge_m));
            let [problem] = found.as_slice() else { panic!("{found:?}") };
            assert_eq!(problem.code, code);
            assert!(problem.message.contains("raise `a` by "), "{problem}");
            assert!(problem.message.contains("or hold to climb (HA) behind it"), "{problem}");
            let repaired = problem.fix.as_ref().unwrap().apply(&plan).unwrap();
            assert_eq!(check(&repaired, &Profile::default(), &Ridge(ridge_m)), []);
        }
        let same = plan_with(&low.replace("700", "500"));
        let found = check(&read(same).plan, &Profile::default(), &Ridge(470.0));
        assert!(found[0].message.starts_with("raise this leg and `a` before it by 20 m"), "{found:?}");
    }

    /// Two ridges between A and B: from 500 m to 700 m the one is passed too low because the leg is still climbing, the other because
    /// even its end is too low.
    struct Ridges;
    impl Terrain for Ridges {
        fn elevation_m(&self, p: LatLon) -> Option<f64> {
            let is_at = |lon_deg: f64| (p.lon_deg - lon_deg).abs() < 0.001;
            let [early, late] = [-84.19, -84.175].map(is_at);
            Some(if early {
                560.0
            } else if late {
                655.0
            } else {
                300.0
            })
        }
    }

    /// It had to be pressed once for each ridge.
    #[test]
    fn one_remedy_clears_all_places_of_a_leg() {
        let low = r#"<IF id="a" fix="A"/><TF id="b" fix="B" altitude="700" altitudeReference="amsl"/>"#;
        let plan = read(plan_with(low)).plan;
        let found = check(&plan, &Profile::default(), &Ridges);
        let [problem] = found.as_slice() else { panic!("{found:?}") };
        let repaired = problem.fix.as_ref().unwrap().apply(&plan).unwrap();
        assert_eq!(check(&repaired, &Profile::default(), &Ridges), []);
    }

    /// A leg that leads too low, from one that is high enough, over flat ground at 300 m.
    #[test]
    fn only_the_leg_that_is_named_is_raised() {
        let legs = r#"<IF id="a" fix="A"/><TF id="b" fix="B" altitude="250" altitudeReference="amsl"/>"#;
        let plan = read(plan_with(legs)).plan;
        let repaired = fixed(&plan_with(legs), "below-terrain");
        let altitude = |plan: &crate::FlightPlan, id: &str| {
            plan.leg(&id.into()).and_then(|context| context.leg.altitude.clone())
        };
        assert_eq!(altitude(&repaired, "a"), altitude(&plan, "a"));
        assert!(message_of(legs, "below-terrain").ends_with(": raise this leg by 100 m"));
    }

    /// Over flat ground at 300 m.
    #[test]
    fn a_leg_that_is_too_low_is_raised() {
        for altitude_m in [340, 250] {
            let low = format!(
                r#"<IF id="a" fix="A"/><TF id="b" fix="B" altitude="{altitude_m}" altitudeReference="amsl"/>"#
            );
            let code = if altitude_m < 300 { "below-terrain" } else { "low-clearance" };
            fixed(&plan_with(&low), code);
        }
    }

    /// The ground and the runway are at 300 m.
    #[test]
    fn a_remedy_counts_from_what_the_altitude_counted_from() {
        for (reference, low_m, raised_m) in
            [("amsl", "320.5", 350.0), ("agl", "20.5", 50.0), ("home", "20", 50.0)]
        {
            let leg = |id: &str, fix: &str, kind: &str| {
                format!(
                    r#"<{kind} id="{id}" fix="{fix}" altitude="{low_m}" altitudeReference="{reference}"/>"#
                )
            };
            let plan = plan_with(&format!("{}{}", leg("a", "A", "IF"), leg("b", "B", "TF")));
            let repaired = fixed(&plan, "low-clearance");
            let altitude = repaired.leg(&"a".into()).unwrap().leg.altitude.clone().unwrap();
            let said = (altitude.reference.name(), altitude.metres);
            assert_eq!(said, (reference, crate::Value::Constant(raised_m)));
        }
    }
}
