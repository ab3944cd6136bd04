//! Runways: drawn, and the other direction of one that is there.

use crate::{FlightPlan, Id, Runway};
use aircraft::Strip;
use geometry::LatLon;
use geometry::geodesy::{normalise_180, normalise_360};

/// Runways in one direction lie so far apart at most to be left and right of one another, metres.
const PARALLEL_M: f64 = 2000.0;
/// What is drawn so near to the centre line of a runway, metres, and off its heading by so much, degrees, is that runway. One beside another
/// is farther away.
const SAME_LINE_M: f64 = 40.0;
const SAME_HEADING_DEG: f64 = 10.0;
/// So near to the end of one the threshold of its other direction lies, metres.
const SAME_END_M: f64 = 100.0;

/// A runway from its landing threshold to its other end, called by its direction.
pub fn runway(plan: &FlightPlan, threshold: LatLon, end: LatLon, elevation_amsl_m: f64) -> Runway {
    let way = threshold.inverse(end);
    let heading_deg = normalise_360(way.bearing_start_deg.round());
    Runway {
        id: runway_id(plan, threshold, heading_deg),
        threshold,
        elevation_amsl_m: elevation_amsl_m.round(),
        heading_deg,
        length_m: way.distance_m.round(),
        priority: last_priority(plan),
        approach_entry: None,
    }
}

/// The other direction of a runway, whose threshold is so high, metres AMSL.
pub fn other_direction(plan: &FlightPlan, runway: &Runway, elevation_amsl_m: f64) -> Runway {
    let other = runway.from_other_end();
    let id = mirrored_id(plan, runway, other.heading_deg)
        .unwrap_or_else(|| runway_id(plan, other.threshold, other.heading_deg));
    Runway { id, elevation_amsl_m: elevation_amsl_m.round(), priority: last_priority(plan), ..other }
}

/// A runway of the plan on which another one is drawn, in either direction; the one in the same direction first.
pub fn lying_there(plan: &FlightPlan, threshold: LatLon, end: LatLon) -> Option<&Runway> {
    let way = threshold.inverse(end);
    let drawn = Strip { threshold, heading_deg: way.bearing_start_deg, length_m: way.distance_m };
    let off_deg = |runway: &Runway| normalise_180(runway.heading_deg - drawn.heading_deg).abs();
    let middle_lies_on = |one: Strip, other: Strip| {
        let middle = one.threshold.destination(one.heading_deg, one.length_m / 2.0);
        other.beside_m(middle) < SAME_LINE_M
    };
    let is_there = |runway: &&Runway| {
        let (strip, is_along) =
            (runway.strip(), off_deg(runway).min(180.0 - off_deg(runway)) < SAME_HEADING_DEG);
        is_along && (middle_lies_on(drawn, strip) || middle_lies_on(strip, drawn))
    };
    plan.runways.iter().filter(is_there).min_by(|a, b| off_deg(a).total_cmp(&off_deg(b)))
}

impl FlightPlan {
    /// The runway that is another one's other direction.
    pub fn opposite(&self, runway: &Runway) -> Option<&Runway> {
        let end = runway.strip().from_other_end();
        let turned =
            |other: &&Runway| normalise_180(other.heading_deg - end.heading_deg).abs() < SAME_HEADING_DEG;
        let others = self.runways.iter().filter(|other| other.id != runway.id);
        others.filter(turned).find(|other| other.threshold.distance_m(end.threshold) < SAME_END_M)
    }
}

fn last_priority(plan: &FlightPlan) -> u32 {
    plan.runways.iter().map(|runway| runway.priority).max().unwrap_or(0).saturating_add(1)
}

/// `R`, and a tenth of the heading, 01 to 36.
fn number(heading_deg: f64) -> String {
    let tenth = (heading_deg / 10.0).round().rem_euclid(36.0);
    format!("R{:02}", if tenth < 1.0 { 36.0 } else { tenth })
}

/// As runways are called: by their number; where that is taken, with a letter beside another one, else with a number behind it.
fn runway_id(plan: &FlightPlan, threshold: LatLon, heading_deg: f64) -> Id {
    let name = number(heading_deg);
    let is_beside = |other: &Runway| other.threshold.distance_m(threshold) < PARALLEL_M;
    let letters = if plan.runways.iter().any(is_beside) { &["", "L", "R", "C"][..] } else { &[""] };
    let mut names = letters.iter().map(|letter| format!("{name}{letter}"));
    let free = names.find(|name| plan.unique_id(name).as_str() == name);
    free.map_or_else(|| plan.fresh_id(&format!("{name}-")), |name| Id::new(&name))
}

/// The left one of two is the right one from its other end: `R23R` to `R05L`. `None`: it has no letter, or that is taken.
fn mirrored_id(plan: &FlightPlan, runway: &Runway, heading_deg: f64) -> Option<Id> {
    let letter = runway.id.as_str().strip_prefix(&number(runway.heading_deg))?;
    let mirrored = match letter {
        "L" => "R",
        "R" => "L",
        "C" => "C",
        _ => return None,
    };
    let name = format!("{}{mirrored}", number(heading_deg));
    (plan.unique_id(&name).as_str() == name).then(|| Id::new(&name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Thing;

    const HOME: LatLon = LatLon::new(46.0, 9.0);

    fn with(plan: &FlightPlan, runway: Runway) -> FlightPlan {
        crate::Edit::Add(Box::new(Thing::Runway(runway))).apply(plan).unwrap()
    }

    fn one() -> (FlightPlan, LatLon) {
        let plan = crate::read(r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"/>"#).plan;
        let end = HOME.destination(52.0, 600.0);
        (with(&plan, runway(&plan, HOME, end, 300.0)), end)
    }

    #[test]
    fn a_runway_that_is_drawn_where_one_lies_is_that_one_in_either_direction() {
        let (plan, end) = one();
        let found = |from: LatLon, to: LatLon| lying_there(&plan, from, to).map(|runway| runway.id.as_str());
        assert_eq!((found(HOME, end), found(end, HOME)), (Some("R05"), Some("R05")));
        let aside = |place: LatLon, metres| place.destination(142.0, metres);
        assert_eq!(found(aside(HOME, 25.0), aside(end, 25.0)), Some("R05"), "as the pointer has it");
        assert_eq!(found(HOME, HOME.destination(52.0, 1500.0)), Some("R05"), "a longer one");
        assert_eq!(found(aside(HOME, 60.0), aside(end, 60.0)), None, "beside it");
        assert_eq!(found(HOME, HOME.destination(90.0, 600.0)), None, "across");
        let beyond = HOME.destination(52.0, 800.0);
        assert_eq!(found(beyond, beyond.destination(52.0, 600.0)), None, "behind it");
    }

    #[test]
    fn the_other_direction_begins_at_the_other_end_and_is_known_by_that() {
        let (plan, end) = one();
        let runway = plan.runways[0].clone();
        assert_eq!(plan.opposite(&runway), None);
        let other = other_direction(&plan, &runway, 306.4);
        assert_eq!((other.id.as_str(), other.heading_deg, other.length_m), ("R23", 232.0, 600.0));
        assert_eq!((other.elevation_amsl_m, other.priority), (306.0, 2));
        assert!(other.threshold.distance_m(end) < 1.0);
        let plan = with(&plan, other.clone());
        assert_eq!(plan.opposite(&runway).map(|found| &found.id), Some(&other.id));
        assert_eq!(plan.opposite(&other).map(|found| &found.id), Some(&runway.id));
        assert_eq!(
            lying_there(&plan, end, HOME).map(|found| &found.id),
            Some(&other.id),
            "the same direction first"
        );
    }

    #[test]
    fn from_its_other_end_the_left_one_is_the_right_one() {
        let (plan, _) = one();
        for (letter, other) in
            [("R05L", "R23R"), ("R05R", "R23L"), ("R05C", "R23C"), ("R05", "R23"), ("west", "R23")]
        {
            let runway = Runway { id: letter.into(), ..plan.runways[0].clone() };
            assert_eq!(other_direction(&plan, &runway, 300.0).id.as_str(), other);
        }
    }
}
