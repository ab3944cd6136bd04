//! `far-away`: a place of a leg that lies very much farther away than all others, as a slip in a coordinate puts it. A warning: a
//! plan may go there. Where it is what makes its neighbours' tracks wrong, it is an error, and stands for theirs; it says what is to
//! be done if the place is right all the same.
//!
//! The places are those that the legs and runways name by constants or fixes. How far they are apart is measured from their middle
//! (the median), which one place that is wrong does not move.

use super::Inspection;
use crate::uses::Part;
use crate::{Id, Leg, Place, Problem, Severity, Value};
use geometry::LatLon;
use std::collections::HashSet;

const CODE: &str = "far-away";
/// So many times as far from the middle as the farthest of the others.
const TIMES: f64 = 10.0;
/// Others that are nearer than this to the middle count as so far away, metres.
const LEAST_M: f64 = 1000.0;
/// Fewer places have no middle to speak of.
const FEWEST: usize = 4;
/// More places than these out there are where the plan goes.
const MOST: usize = 8;
/// Places so near to each other are one, metres.
const SAME_M: f64 = 1.0;
/// Of the sphere on which distances are compared, metres.
const EARTH_M: f64 = 6_371_000.0;

/// What follows from one end of a track being elsewhere.
const FOLLOWS: [&str; 7] = [
    "rf-not-on-circle",
    "rf-not-tangent",
    "turn-too-tight",
    "course-not-intercepted",
    "too-steep",
    "below-terrain",
    "low-clearance",
];

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for far in far_places(view) {
        let message = format!(
            "is its position right? It lies {:.0} km from everything else in the plan",
            far.from_others_m / 1000.0
        );
        let leg = far.steps.first().and_then(|step| view.steps().get(*step));
        problems.extend(leg.map(|step| Problem::warning(CODE, message).of(&step.leg.id)));
    }
}

/// Of what follows from a place that is far away only the cause is said, if there is an error among it.
pub(super) fn alone(view: &Inspection, problems: &mut Vec<Problem>) {
    if !problems.iter().any(|problem| problem.code == CODE) {
        return;
    }
    for far in far_places(view) {
        let around: HashSet<&Id> = around(view, &far.steps);
        let first = far.steps.first().and_then(|step| view.steps().get(*step)).map(|step| &step.leg.id);
        let follows = |p: &Problem| {
            FOLLOWS.contains(&p.code) && p.subject.as_ref().is_some_and(|leg| around.contains(leg))
        };
        let Some(error) = problems.iter().find(|p| p.is_error() && follows(p)).cloned() else {
            // a plan may go there: what is said of the way is not hidden
            continue;
        };
        problems.retain(|p| !follows(p));
        if let Some(cause) = problems.iter_mut().find(|p| p.code == CODE && p.subject.as_ref() == first) {
            cause.severity = Severity::Error;
            let whose = error.subject.as_ref().map_or_else(String::new, |leg| format!(" `{leg}`"));
            cause.reword(format!("{}. If it is right, see to{whose}: {}", cause.message, error.message));
        }
    }
}

/// The legs of these steps, with those flown before and behind them.
fn around<'a>(view: &'a Inspection, steps: &[usize]) -> HashSet<&'a Id> {
    let all = view.steps();
    let before = steps.iter().filter_map(|step| all.get(*step)?.before);
    let behind = all.iter().enumerate().filter(|(_, step)| step.before.is_some_and(|b| steps.contains(&b)));
    let numbers: HashSet<usize> = steps.iter().copied().chain(before).chain(behind.map(|(i, _)| i)).collect();
    numbers.into_iter().filter_map(|number| all.get(number)).map(|step| &step.leg.id).collect()
}

/// A place that is far from all others.
struct Far {
    /// The legs that have it, by their steps, the first one first.
    steps: Vec<usize>,
    /// How far the nearest other place is, metres.
    from_others_m: f64,
}

/// A place, and as a point on the sphere.
struct Spot {
    place: LatLon,
    point: [f64; 3],
    /// Whose; `None`: a runway's.
    step: Option<usize>,
}

impl Spot {
    fn of(place: LatLon, step: Option<usize>) -> Self {
        let ((sin, cos), (east, north)) =
            (place.lat_deg.to_radians().sin_cos(), place.lon_deg.to_radians().sin_cos());
        Self { place, point: [cos * north, cos * east, sin], step }
    }

    fn distance_m(&self, from: &[f64; 3]) -> f64 {
        let square: f64 = self.point.iter().zip(from).map(|(a, b)| (a - b).powi(2)).sum();
        EARTH_M * square.sqrt()
    }
}

fn far_places(view: &Inspection) -> Vec<Far> {
    let spots = spots(view);
    let Some(middle) = middle(&spots) else { return Vec::new() };
    let mut sorted: Vec<(f64, &Spot)> = spots.iter().map(|spot| (spot.distance_m(&middle), spot)).collect();
    sorted.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    // at least half of them are the plan itself
    let near = sorted.len().div_ceil(2);
    let beyond = |i: &usize| match (sorted.get(i - 1), sorted.get(*i)) {
        (Some((last_m, _)), Some((here_m, _))) => *here_m > limit_m(*last_m),
        _ => false,
    };
    let Some(first) = (near.max(1)..sorted.len()).find(beyond) else { return Vec::new() };
    let (inside, outside) = sorted.split_at(first);
    let limit_m = limit_m(inside.last().map_or(0.0, |(m, _)| *m));
    if outside.len() > MOST {
        return Vec::new();
    }
    let mut far: Vec<Far> = outside.iter().filter_map(|(_, spot)| far_from(spot, &spots, limit_m)).collect();
    far.sort_by(|a, b| a.steps.cmp(&b.steps));
    far.dedup_by(|a, b| a.steps == b.steps);
    far
}

fn limit_m(spread_m: f64) -> f64 {
    TIMES * spread_m.max(LEAST_M)
}

/// `None`: something else is near it, or no leg goes there.
fn far_from(spot: &Spot, all: &[Spot], limit_m: f64) -> Option<Far> {
    let (same, others): (Vec<&Spot>, Vec<&Spot>) =
        all.iter().partition(|other| other.distance_m(&spot.point) <= SAME_M);
    let nearest = others.into_iter().min_by(|a, b| {
        let [a, b] = [a, b].map(|other| other.distance_m(&spot.point));
        a.total_cmp(&b)
    })?;
    let from_others_m = nearest.place.distance_m(spot.place);
    let mut steps: Vec<usize> = same.iter().filter_map(|same| same.step).collect();
    steps.sort_unstable();
    steps.dedup();
    (from_others_m > limit_m && !steps.is_empty()).then_some(Far { steps, from_others_m })
}

/// The median of each coordinate.
fn middle(spots: &[Spot]) -> Option<[f64; 3]> {
    let median = |axis: usize| {
        let mut values: Vec<f64> = spots.iter().filter_map(|s| s.point.get(axis).copied()).collect();
        let half = values.len() / 2;
        Some(*values.select_nth_unstable_by(half, f64::total_cmp).1)
    };
    if spots.len() < FEWEST { None } else { Some([median(0)?, median(1)?, median(2)?]) }
}

fn spots(view: &Inspection) -> Vec<Spot> {
    let runways = view.plan.runways.iter().map(|runway| runway.threshold).filter(|at| at.is_valid());
    let mut spots: Vec<Spot> = runways.map(|at| Spot::of(at, None)).collect();
    for (number, step) in view.steps().iter().enumerate() {
        places(view, &step.leg, &mut |at| spots.push(Spot::of(at, Some(number))));
    }
    spots
}

/// The places that are written in a leg, those of its fixes among them; not those that are computed.
fn places(view: &Inspection, leg: &Leg, visit: &mut dyn FnMut(LatLon)) {
    leg.for_each_part(&mut |part| {
        let place = match part {
            Part::Place(Place::Fix(id)) => view.fixes.get(id).copied(),
            Part::Place(Place::Position(Value::Constant(at))) => Some(*at),
            Part::Corner(at) => Some(at),
            Part::Place(Place::Position(Value::Expression(_))) | Part::Number(_) | Part::Source(..) => None,
        };
        if let Some(place) = place.filter(|at| at.is_valid()) {
            visit(place);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::CODE;
    use crate::checks::testing::{codes, document_with, plan_with};
    use crate::{Problem, check, read};
    use aircraft::Profile;
    use terrain::Flat;

    fn problems(legs: &str) -> Vec<Problem> {
        check(&read(plan_with(legs)).plan, &Profile::default(), &Flat(300.0))
    }

    /// A square of some 3 km; `b` is where it is put.
    fn square(b: &str) -> String {
        format!(r#"<IF id="a" fix="A"/><TF id="b" {b}/><TF id="c" fix="C"/><TF id="d" fix="A"/>"#)
    }

    #[test]
    fn a_place_far_from_all_others_is_named_first_with_its_distance() {
        let found = problems(&square(r#"lat="37.2" lon="-84.17""#));
        let first = &found[0];
        assert_eq!((first.code, first.subject.as_ref().unwrap().as_str()), (CODE, "b"));
        assert!(first.message.contains("It lies 97 km from everything else"), "{first}");
        assert!(!first.is_error(), "a plan may go there: {first}");
    }

    #[test]
    fn a_plan_that_is_large_or_goes_to_a_second_area_has_no_place_far_away() {
        // 10 km from the rest, of which the others are 3 km apart
        assert!(!codes(&plan_with(&square(r#"lat="36.39" lon="-84.17""#))).contains(&CODE));
        let there = r#"<TF id="e" lat="37.2" lon="-84.17"/><TF id="f" lat="37.21" lon="-84.17"/>"#;
        let second = format!("{}{there}", square(r#"fix="B""#));
        assert!(!codes(&plan_with(&second)).contains(&CODE));
        let ferry: String = (0..12)
            .map(|i| format!(r#"<TF id="t{i}" lat="{}" lon="-84.20"/>"#, 36.4 + 0.4 * f64::from(i)))
            .collect();
        assert!(!codes(&plan_with(&ferry)).contains(&CODE));
    }

    #[test]
    fn it_is_an_error_in_the_place_of_what_it_makes_of_its_neighbours() {
        let legs = r#"<IF id="a" fix="A"/><TF id="b" lat="37.2" lon="-84.17"/>
            <RF id="r" fix="C" centreLat="36.315" centreLon="-84.17" turn="left"/><TF id="d" fix="A"/>"#;
        let found = problems(legs);
        assert_eq!((found[0].code, found[0].is_error()), (CODE, true), "{found:?}");
        assert!(!found.iter().any(|p| p.code.starts_with("rf-")), "{found:?}");
        assert!(found[0].message.contains("If it is right, see to `r`: move the centre"), "{found:?}");
    }

    /// At 345 m over flat ground at 300 m.
    #[test]
    fn what_is_said_of_the_way_to_a_place_that_may_be_right_stays() {
        let low = square(r#"lat="37.2" lon="-84.17" altitude="345" altitudeReference="amsl""#);
        let found = problems(&low);
        assert!(found.iter().all(|problem| !problem.is_error()), "{found:?}");
        let of_b = |code: &str| {
            found.iter().any(|p| p.code == code && p.subject.as_ref().is_some_and(|leg| leg.as_str() == "b"))
        };
        assert!(of_b(CODE) && of_b("low-clearance"), "{found:?}");
    }

    #[test]
    fn one_fix_that_several_legs_fly_to_is_said_once_and_two_slips_twice() {
        let fix = r#"<TF id="f" lat="37.2" lon="-84.17"/>"#;
        let twice =
            format!(r#"{}{fix}<TF id="g" fix="C"/>{}"#, square(r#"fix="B""#), fix.replace("\"f\"", "\"h\""));
        let far = |legs: &str| problems(legs).iter().filter(|p| p.code == CODE).count();
        assert_eq!(far(&twice), 1);
        assert_eq!(far(&twice.replace(r#"id="h" lat="37.2""#, r#"id="h" lat="35.0""#)), 2);
    }

    #[test]
    fn a_plan_of_nothing_or_of_computed_places_is_looked_at_all_the_same() {
        for stages in ["", r#"<stage id="s" type="en-route"><TF id="a" position="v"/></stage>"#] {
            let variable = r#"<variable name="v" type="position" initialLat="0" initialLon="0"/>"#;
            assert!(!codes_of(&document_with(variable, stages, "")).contains(&CODE));
        }
    }

    fn codes_of(document: &str) -> Vec<&'static str> {
        let plan = read(document).plan;
        check(&plan, &Profile::default(), &Flat(300.0)).iter().map(|p| p.code).collect()
    }
}
