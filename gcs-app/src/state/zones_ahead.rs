//! Zones on the way ahead of an aircraft: one to keep out of that it comes into, or those to stay in that it leaves. The preview of an
//! order shows them when it is given; the wind, a go-to from elsewhere or Safe mode may lead there all the same.

use flight_plan::{Altitude, AltitudeReference, Value, Zone, ZoneKind, ZoneShape};
use geometry::LatLon;
use geometry::zone::{Band, Rule, Shape, Zone as Ground};
use terrain::Terrain;

/// A point of the way ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Seconds from now.
    pub in_s: f64,
    /// Where.
    pub at: LatLon,
    /// How high, metres AMSL.
    pub amsl_m: f64,
}

/// The zones of a plan, as they are now.
#[derive(Debug, Clone, Copy, Default)]
pub struct Zones<'a> {
    /// All of them.
    pub all: &'a [Zone],
    /// What limits above `home` count from, metres AMSL.
    pub home_m: f64,
    /// The time of day, seconds since 1970; `None`: all are taken for active.
    pub unix_s: Option<i64>,
}

/// A zone that is active, with its ground.
struct Active<'a> {
    zone: &'a Zone,
    ground: Ground,
}

impl Zones<'_> {
    /// What of them is broken first on a way, in words, and what to do about it.
    pub fn broken(&self, way: &[Point], terrain: &dyn Terrain) -> Option<String> {
        let keep_out = self.active(ZoneKind::KeepOut);
        let keep_in = self.active(ZoneKind::KeepIn);
        way.iter().find_map(|point| {
            let is_in = |active: &&Active<'_>| self.is_in(active, point, terrain);
            if let Some(entered) = keep_out.iter().find(is_in) {
                return Some(entering(entered.zone, point.in_s));
            }
            let left = keep_in.first().filter(|_| !keep_in.iter().any(|zone| is_in(&zone)))?;
            Some(leaving(left.zone, point.in_s))
        })
    }

    /// Those of a kind that count now. One that nothing can be held against is told when the plan is checked.
    fn active(&self, kind: ZoneKind) -> Vec<Active<'_>> {
        let counts = |zone: &&Zone| {
            let covers =
                |unix_s| zone.active.iter().any(|t| (t.from_unix_s..t.until_unix_s).contains(&unix_s));
            zone.kind == kind && (zone.active.is_empty() || self.unix_s.is_none_or(covers))
        };
        let of_kind = self.all.iter().filter(counts);
        of_kind.filter_map(|zone| Some(Active { zone, ground: ground(zone)? })).collect()
    }

    fn is_in(&self, active: &Active<'_>, point: &Point, terrain: &dyn Terrain) -> bool {
        let Active { zone, ground } = active;
        let above = |limit: &Altitude| {
            let Value::Constant(metres) = limit.metres else { return None };
            let from_m = match limit.reference {
                AltitudeReference::Amsl => 0.0,
                AltitudeReference::Home => self.home_m,
                AltitudeReference::Agl => terrain.elevation_m(point.at)?,
            };
            Some(point.amsl_m - from_m - metres)
        };
        // a limit of which nothing is known limits nothing
        let above_floor = zone.floor.as_ref().and_then(above).is_none_or(|metres| metres > 0.0);
        let below_ceiling = zone.ceiling.as_ref().and_then(above).is_none_or(|metres| metres < 0.0);
        above_floor && below_ceiling && ground.outside_m(point.at) <= 0.0
    }
}

fn ground(zone: &Zone) -> Option<Ground> {
    let shape = match &zone.shape {
        ZoneShape::Circle { centre, radius_m } => Shape::Circle { centre: *centre, radius_m: *radius_m },
        ZoneShape::Polygon(corners) => Shape::Polygon { outer: corners.clone(), holes: Vec::new() },
    };
    Ground::new(&shape, Band::ALL, Rule::KeepOut, 0.0).ok()
}

fn entering(zone: &Zone, in_s: f64) -> String {
    let name = name(zone);
    match in_s > 0.0 {
        true => format!(
            "It comes into {name}, a zone to keep out of, in {in_s:.0} s. Go to a leg that leads around it, hold, or be ready to take over."
        ),
        false => format!(
            "It is in {name}, a zone to keep out of. Go to a leg that leads out of it, or be ready to take over."
        ),
    }
}

fn leaving(zone: &Zone, in_s: f64) -> String {
    let name = name(zone);
    match in_s > 0.0 {
        true => format!(
            "It leaves {name}, a zone to stay in, in {in_s:.0} s. Go to a leg inside of it, hold, or be ready to take over."
        ),
        false => format!(
            "It is outside of {name}, a zone to stay in. Go to a leg inside of it, or be ready to take over."
        ),
    }
}

/// What people call it.
fn name(zone: &Zone) -> String {
    let name = if zone.name.is_empty() { zone.id.as_str() } else { &zone.name };
    format!("“{name}”")
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::Flat;

    const HERE: LatLon = LatLon::new(46.0, 9.0);

    /// Northwards from here at this altitude, 20 m/s.
    fn way(amsl_m: f64) -> Vec<Point> {
        let point = |i: u32| Point {
            in_s: 2.5 * f64::from(i),
            at: HERE.destination(0.0, 50.0 * f64::from(i)),
            amsl_m,
        };
        (0..20).map(point).collect()
    }

    fn zones(text: &str) -> Vec<Zone> {
        let plan = format!(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><zones>{text}</zones></flightPlan>"#
        );
        flight_plan::read(plan.as_bytes()).plan.zones
    }

    fn told(text: &str, amsl_m: f64, unix_s: Option<i64>) -> String {
        let all = zones(text);
        assert!(!all.is_empty(), "{text}");
        let zones = Zones { all: &all, home_m: 300.0, unix_s };
        zones.broken(&way(amsl_m), &Flat(250.0)).unwrap_or_default()
    }

    #[test]
    fn the_first_zone_that_is_broken_is_told_with_the_time_until_then() {
        let ahead = r#"<keepOut id="far" lat="46.0072" lon="9" radius="100"/>
            <keepOut id="z" name="Village" lat="46.0044" lon="9" radius="100"/>"#;
        let said = told(ahead, 400.0, None);
        assert!(said.starts_with("It comes into “Village”, a zone to keep out of, in 20 s"), "{said}");
        let here = r#"<keepOut id="z" lat="46" lon="9" radius="100"/>"#;
        assert!(told(here, 400.0, None).starts_with("It is in “z”"));
        let field = r#"<keepIn id="in" lat="46" lon="9" radius="520"/>"#;
        assert!(told(field, 400.0, None).starts_with("It leaves “in”, a zone to stay in, in 28 s"));
        let two = field.to_owned() + r#"<keepIn id="on" lat="46.0081" lon="9" radius="520"/>"#;
        assert_eq!(told(&two, 400.0, None), "", "one of them is enough");
    }

    #[test]
    fn limits_and_times_count() {
        let zone = |limits: &str, times: &str| {
            format!(r#"<keepOut id="z" {limits} lat="46.0045" lon="9" radius="100">{times}</keepOut>"#)
        };
        for (limits, amsl_m, is_broken) in [
            (r#"ceiling="500" ceilingReference="amsl""#, 499.0, true),
            (r#"ceiling="500" ceilingReference="amsl""#, 501.0, false),
            (r#"ceiling="100" ceilingReference="home""#, 401.0, false),
            (r#"ceiling="100" ceilingReference="agl""#, 349.0, true),
            (r#"ceiling="100" ceilingReference="agl""#, 351.0, false),
            (r#"floor="100" floorReference="agl""#, 349.0, false),
        ] {
            assert_eq!(!told(&zone(limits, ""), amsl_m, None).is_empty(), is_broken, "{limits} {amsl_m}");
        }
        let noon = r#"<active from="2026-06-01T10:00:00Z" until="2026-06-01T12:00:00Z"/>"#;
        let from = 1_780_308_000;
        for (unix_s, is_broken) in
            [(Some(from - 1), false), (Some(from), true), (Some(from + 7200), false), (None, true)]
        {
            assert_eq!(!told(&zone("", noon), 400.0, unix_s).is_empty(), is_broken, "{unix_s:?}");
        }
    }
}
