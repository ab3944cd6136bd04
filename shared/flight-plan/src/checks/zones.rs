//! `too-many-zones`: more than the path can be held against in time; `bad-zone`: an outline that is no simple polygon or no circle, or limits that are expressions; `zone-altitudes`: a floor
//! that is not below the ceiling; `zone-times`: a time that ends before it begins.

use super::Inspection;
use super::scans::{not_simple, untied};
use crate::{Altitude, AltitudeReference, Edit, Problem, Thing, Value, Zone, ZoneShape};

/// Greatest radius of a zone, metres.
const LARGEST_M: f64 = 200_000.0;
/// Most zones, and most corners of all of them.
const MAX_ZONES: usize = 1000;
const MAX_CORNERS: usize = 10_000;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    let zones = &view.plan.zones;
    let corners = zones.iter().map(|zone| match &zone.shape {
        ZoneShape::Polygon(corners) => corners.len(),
        ZoneShape::Circle { .. } => 1,
    });
    if zones.len() > MAX_ZONES || corners.sum::<usize>() > MAX_CORNERS {
        let message = format!(
            "keep to {MAX_ZONES} zones with {MAX_CORNERS} corners in all: leave out those far from the flight, simplify outlines"
        );
        problems.push(Problem::error("too-many-zones", message));
    }
    for zone in zones {
        outline(zone, problems);
        limits(view, zone, problems);
        times(zone, problems);
    }
}

fn outline(zone: &Zone, problems: &mut Vec<Problem>) {
    let wrong = match &zone.shape {
        ZoneShape::Circle { centre, radius_m } => {
            let possible = centre.is_valid() && *radius_m > 0.0 && *radius_m <= LARGEST_M;
            let message = || {
                format!(
                    "give the zone a centre on Earth and a radius of more than 0 m, at most {LARGEST_M:.0} m"
                )
            };
            (!possible).then(message)
        }
        ZoneShape::Polygon(corners) => not_simple(corners, &[]),
    };
    let problem = wrong.map(|message| Problem::error("bad-zone", message).of(&zone.id));
    problems.extend(problem.map(|problem| problem.perhaps_fixed_by(in_order(zone))));
}

fn in_order(zone: &Zone) -> Option<Edit> {
    let ZoneShape::Polygon(corners) = &zone.shape else { return None };
    let shape = ZoneShape::Polygon(untied(corners, &[])?);
    Some(replaced(zone, Zone { shape, ..zone.clone() }))
}

fn limits(view: &Inspection, zone: &Zone, problems: &mut Vec<Problem>) {
    let both = || zone.floor.iter().chain(&zone.ceiling);
    let constant = |a: &Altitude| matches!(a.metres, Value::Constant(x) if x.is_finite());
    if !both().all(constant) {
        let message = "write floor and ceiling of a zone as finite numbers";
        problems.push(Problem::error("bad-zone", message).of(&zone.id));
        return;
    }
    let Some((floor, ceiling)) = zone.floor.as_ref().zip(zone.ceiling.as_ref()) else { return };
    // above ground and above the sea at once: the review of the path sees them
    let comparable = heights_m(view, floor, ceiling);
    if comparable.is_some_and(|(floor_m, ceiling_m)| floor_m >= ceiling_m) {
        let message = "make the zone's floor lower than its ceiling: as it is, it is nowhere";
        let swapped = Zone { floor: Some(ceiling.clone()), ceiling: Some(floor.clone()), ..zone.clone() };
        let fix = (floor.metres != ceiling.metres).then(|| replaced(zone, swapped));
        problems.push(Problem::error("zone-altitudes", message).of(&zone.id).perhaps_fixed_by(fix));
    }
}

/// Both limits above one datum, metres, if that doesn't depend on the ground below.
fn heights_m(view: &Inspection, floor: &Altitude, ceiling: &Altitude) -> Option<(f64, f64)> {
    if floor.reference == ceiling.reference {
        return view.number(&floor.metres).zip(view.number(&ceiling.metres));
    }
    let home_m = view.common_home_m();
    let amsl_m = |limit: &Altitude| {
        let datum_m = match limit.reference {
            AltitudeReference::Amsl => Some(0.0),
            AltitudeReference::Home => home_m,
            AltitudeReference::Agl => None,
        };
        Some(view.number(&limit.metres)? + datum_m?)
    };
    amsl_m(floor).zip(amsl_m(ceiling))
}

fn times(zone: &Zone, problems: &mut Vec<Problem>) {
    if zone.active.iter().any(|t| t.from_unix_s >= t.until_unix_s) {
        let message = "make the zone's active times end after they begin";
        let mut ordered = zone.clone();
        ordered.active.retain(|t| t.from_unix_s != t.until_unix_s);
        for time in &mut ordered.active {
            let (a, b) = (time.from_unix_s, time.until_unix_s);
            (time.from_unix_s, time.until_unix_s) = (a.min(b), a.max(b));
        }
        // a zone without times is always active
        let fix = (!ordered.active.is_empty()).then(|| replaced(zone, ordered));
        problems.push(Problem::error("zone-times", message).of(&zone.id).perhaps_fixed_by(fix));
    }
}

fn replaced(zone: &Zone, with: Zone) -> Edit {
    Edit::Replace { id: zone.id.clone(), with: Box::new(Thing::Zone(with)) }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, fixed, plan_with};

    fn with(zone: &str) -> String {
        let plan = plan_with(r#"<IF id="a" fix="A"/><TF id="b" fix="B"/>"#);
        plan.replace("<mainPlan", &format!("<zones>{zone}</zones><mainPlan"))
    }

    fn circle(attributes: &str, inside: &str) -> String {
        with(&format!(r#"<keepOut id="z" lat="36.5" lon="-84.5" {attributes}>{inside}</keepOut>"#))
    }

    fn polygon(corners: &[(f64, f64)]) -> String {
        let corner = |(x, y): &(f64, f64)| format!(r#"<corner lat="{}" lon="{}"/>"#, 36.5 + y, -84.5 + x);
        with(&format!(r#"<keepIn id="z">{}</keepIn>"#, corners.iter().map(corner).collect::<String>()))
    }

    #[test]
    fn outlines_are_areas() {
        let crossing = [(0.0, 0.0), (0.1, 0.1), (0.1, 0.0), (0.0, 0.1)];
        assert_eq!(codes(&circle(r#"radius="500""#, "")), [""; 0]);
        assert_eq!(codes(&circle(r#"radius="0""#, "")), ["bad-zone"]);
        assert_eq!(codes(&polygon(&[(0.0, 0.0), (0.1, 0.0), (0.1, 0.1)])), [""; 0]);
        assert_eq!(codes(&polygon(&crossing)), ["bad-zone"]);
        assert_eq!(codes(&polygon(&[(0.0, 0.0), (0.1, 0.0)])), ["bad-zone"]);
        fixed(&polygon(&crossing), "bad-zone");
    }

    #[test]
    fn more_zones_than_a_path_is_held_against() {
        let many = |n: usize| -> String {
            (0..n).map(|i| format!(r#"<keepOut id="z{i}" lat="36.5" lon="-84.5" radius="5"/>"#)).collect()
        };
        assert_eq!(codes(&with(&many(1000))), [""; 0]);
        assert_eq!(codes(&with(&many(1001))), ["too-many-zones"]);
    }

    #[test]
    fn a_floor_is_below_its_ceiling() {
        let band = |floor: u32, reference: &str, ceiling: u32| {
            circle(
                &format!(
                    r#"radius="500" floor="{floor}" floorReference="{reference}" ceiling="{ceiling}" ceilingReference="amsl""#
                ),
                "",
            )
        };
        assert_eq!(codes(&band(300, "amsl", 900)), [""; 0]);
        assert_eq!(codes(&band(900, "amsl", 300)), ["zone-altitudes"]);
        assert_eq!(codes(&band(300, "amsl", 300)), ["zone-altitudes"]);
        assert_eq!(codes(&band(900, "agl", 300)), [""; 0]);
        // home is at 300 m
        assert_eq!(codes(&band(599, "home", 900)), [""; 0]);
        assert_eq!(codes(&band(600, "home", 900)), ["zone-altitudes"]);
        fixed(&band(900, "amsl", 300), "zone-altitudes");
    }

    #[test]
    fn times_end_after_they_begin() {
        let active = |from: &str, until: &str| {
            circle(r#"radius="500""#, &format!(r#"<active from="{from}" until="{until}"/>"#))
        };
        let (early, late) = ("2026-06-01T06:00:00Z", "2026-06-01T09:00:00Z");
        assert_eq!(codes(&active(early, late)), [""; 0]);
        assert_eq!(codes(&active(late, early)), ["zone-times"]);
        assert_eq!(codes(&active(early, early)), ["zone-times"]);
        fixed(&active(late, early), "zone-times");
    }
}
