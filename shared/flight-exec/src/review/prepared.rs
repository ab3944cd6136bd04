//! The plan's zones, ready to be held against a track.

use super::Conditions;
use flight_plan::{AltitudeReference, Id, Program, Value, Zone, ZoneKind, ZoneShape};
use geometry::zone::{Band, Breach, Rule, Shape, Stretch, Zone as Ground};
use geometry::{LatLon, PathElement};
use terrain::Terrain;

/// Pieces of path shorter than this are not cut further when they lie in no zone to stay in, metres.
const FINEST_M: f64 = 2.0;

/// Zones, and when the flight starts.
pub(super) struct Zones {
    zones: Vec<Prepared>,
    start_unix_s: Option<i64>,
}

/// One zone.
pub(super) struct Prepared {
    pub id: Id,
    pub kind: ZoneKind,
    /// Its limits above mean sea level and those above the ground: it is where both of them are.
    parts: Vec<(Datum, Ground)>,
    active: Vec<flight_plan::ZoneTime>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Datum {
    Amsl,
    Agl,
}

/// A point of a track.
#[derive(Debug, Clone, Copy)]
pub(super) struct At {
    pub position: LatLon,
    pub altitude_amsl_m: f64,
    /// Since the start of the main plan, seconds; `None`: at any time.
    pub time_s: Option<f64>,
}

impl Zones {
    /// A zone that geometry refuses is not there: the check of the plan has refused it before.
    pub fn of(program: &Program, conditions: Conditions) -> Self {
        let home_m = program.plan.home().map_or(0.0, |r| r.elevation_amsl_m);
        let prepared = |zone: &Zone| prepared(zone, home_m, conditions.margins.zone_m);
        let zones = program.plan.zones.iter().filter_map(prepared).collect();
        Self { zones, start_unix_s: conditions.start_unix_s }
    }

    /// There is nothing to hold a track against.
    pub fn is_empty(&self) -> bool {
        self.zones.is_empty()
    }

    /// The time of the flight is not known, but a zone has times.
    pub fn timeless(&self, zone: &Prepared) -> bool {
        self.start_unix_s.is_none() && !zone.active.is_empty()
    }

    /// Where a straight piece of track breaks zones: each zone to keep out of, and the nearest of those to stay in.
    pub fn breaches(&self, from: At, to: At, terrain: &dyn Terrain) -> Vec<(&Prepared, Breach)> {
        let active = |zone: &&Prepared| self.is_active(zone, from.time_s);
        let keep_out = self.zones.iter().filter(|z| z.kind == ZoneKind::KeepOut).filter(active);
        let piece = Piece::new(from, to, terrain);
        let mut found: Vec<_> =
            keep_out.filter_map(|z| z.intrusion(&piece).map(|breach| (z, breach))).collect();
        let keep_in: Vec<&Prepared> =
            self.zones.iter().filter(|z| z.kind == ZoneKind::KeepIn).filter(active).collect();
        if !keep_in.is_empty() {
            found.extend(outside_all(&keep_in, from, to, terrain));
        }
        found
    }

    fn is_active(&self, zone: &Prepared, time_s: Option<f64>) -> bool {
        let Some((start, time_s)) = self.start_unix_s.zip(time_s) else { return true };
        let now = start.saturating_add(time_s as i64);
        zone.active.is_empty() || zone.active.iter().any(|t| (t.from_unix_s..t.until_unix_s).contains(&now))
    }
}

/// A straight piece of track, with its altitudes above mean sea level and above the ground at its ends.
struct Piece {
    amsl: Stretch,
    agl: Stretch,
}

impl Piece {
    fn new(from: At, to: At, terrain: &dyn Terrain) -> Self {
        let element = PathElement::Line { from: from.position, to: to.position };
        let ground_m = |at: At| terrain.elevation_m(at.position).unwrap_or(0.0);
        let (a_m, b_m) = (from.altitude_amsl_m, to.altitude_amsl_m);
        Self {
            amsl: Stretch::new(element, (a_m, b_m)),
            agl: Stretch::new(element, (a_m - ground_m(from), b_m - ground_m(to))),
        }
    }

    fn above(&self, datum: Datum) -> &Stretch {
        match datum {
            Datum::Amsl => &self.amsl,
            Datum::Agl => &self.agl,
        }
    }
}

impl Prepared {
    /// Inside, by all its limits.
    fn intrusion(&self, piece: &Piece) -> Option<Breach> {
        let mut breaches = self.parts.iter().map(|(datum, zone)| zone.breach(piece.above(*datum)));
        let first = breaches.next()??;
        breaches.try_fold(first, |worst, breach| breach.map(|_| worst))
    }

    /// Outside, by one of its limits.
    fn excursion(&self, piece: &Piece) -> Option<Breach> {
        self.parts.iter().find_map(|(datum, zone)| zone.breach(piece.above(*datum)))
    }
}

/// The part of a piece that lies in none of the zones to stay in: halved until each part lies in one or is very short.
fn outside_all<'z>(
    zones: &[&'z Prepared],
    from: At,
    to: At,
    terrain: &dyn Terrain,
) -> Option<(&'z Prepared, Breach)> {
    let piece = Piece::new(from, to, terrain);
    let mut nearest: Option<(&Prepared, Breach)> = None;
    for zone in zones {
        let breach = zone.excursion(&piece)?;
        let off_m = |b: &Breach| b.horizontal_m + b.vertical_m;
        if nearest.as_ref().is_none_or(|(_, best)| off_m(&breach) < off_m(best)) {
            nearest = Some((zone, breach));
        }
    }
    let lone = zones.len() == 1;
    if lone || crate::path::distance_m(from.position, to.position) < FINEST_M {
        return nearest;
    }
    let middle = At {
        position: PathElement::Line { from: from.position, to: to.position }
            .point_at(0.5 * from.position.distance_m(to.position)),
        altitude_amsl_m: 0.5 * (from.altitude_amsl_m + to.altitude_amsl_m),
        time_s: from.time_s,
    };
    outside_all(zones, from, middle, terrain).or_else(|| outside_all(zones, middle, to, terrain))
}

fn prepared(zone: &Zone, home_m: f64, margin_m: f64) -> Option<Prepared> {
    let shape = match &zone.shape {
        ZoneShape::Circle { centre, radius_m } => Shape::Circle { centre: *centre, radius_m: *radius_m },
        ZoneShape::Polygon(corners) => Shape::Polygon { outer: corners.clone(), holes: Vec::new() },
    };
    let rule = match zone.kind {
        ZoneKind::KeepIn => Rule::KeepIn,
        ZoneKind::KeepOut => Rule::KeepOut,
    };
    let band = |datum| Some((datum, Ground::new(&shape, limits(zone, datum, home_m), rule, margin_m).ok()?));
    let parts: Vec<_> = data(zone).into_iter().filter_map(band).collect();
    let active = zone.active.clone();
    (!parts.is_empty()).then(|| Prepared { id: zone.id.clone(), kind: zone.kind, parts, active })
}

/// The data in which a zone has limits; without any: sea level.
fn data(zone: &Zone) -> Vec<Datum> {
    let has = |datum| zone.floor.iter().chain(&zone.ceiling).any(|a| self::datum(a.reference) == datum);
    match (has(Datum::Amsl), has(Datum::Agl)) {
        (_, false) => vec![Datum::Amsl],
        (false, true) => vec![Datum::Agl],
        (true, true) => vec![Datum::Amsl, Datum::Agl],
    }
}

fn datum(reference: AltitudeReference) -> Datum {
    match reference {
        AltitudeReference::Amsl | AltitudeReference::Home => Datum::Amsl,
        AltitudeReference::Agl => Datum::Agl,
    }
}

/// The limits that a zone has in a datum, metres.
fn limits(zone: &Zone, of: Datum, home_m: f64) -> Band {
    let limit = |altitude: &Option<flight_plan::Altitude>| {
        let altitude = altitude.as_ref().filter(|a| datum(a.reference) == of)?;
        let Value::Constant(metres) = altitude.metres else { return None };
        Some(if altitude.reference == AltitudeReference::Home { metres + home_m } else { metres })
    };
    Band {
        floor_m: limit(&zone.floor).unwrap_or(Band::ALL.floor_m),
        ceiling_m: limit(&zone.ceiling).unwrap_or(Band::ALL.ceiling_m),
    }
}
