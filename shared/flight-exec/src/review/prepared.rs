//! The plan's zones, ready to be held against a track.

use super::Conditions;
use super::stay_in::StayIn;
use aircraft::Profile;
use aircraft::power::demanded_power_w;
use flight_plan::{AltitudeReference, Id, Program, Value, Zone, ZoneKind, ZoneShape, ZoneTime};
use geometry::zone::{Band, Breach, Neighbourhood, Rule, Shape, Stretch, Zone as Ground, ZoneError};
use geometry::{LatLon, PathElement};
use terrain::Terrain;

/// Zones, and when the flight is.
pub(super) struct Zones {
    zones: Vec<Prepared>,
    /// Zones that can't be held against anything, and why.
    pub refused: Vec<(Id, String)>,
    start_unix_s: Option<i64>,
    /// Distance to keep from their edges, metres.
    margin_m: f64,
    /// When no flight lasts any longer, seconds since the start.
    latest_s: f64,
}

/// One zone.
pub(super) struct Prepared {
    pub id: Id,
    pub kind: ZoneKind,
    /// Its limits above mean sea level and those above the ground: it is where both of them are.
    parts: Vec<(Datum, Ground)>,
    /// The zone without its limits: what counts of those above the ground where nothing is known of it.
    pub outline: Ground,
    /// Its ground without limits and margin.
    pub ground: Ground,
    active: Vec<ZoneTime>,
    /// It has limits above `home`, and is so in flights from a home of this elevation, metres AMSL.
    home_m: Option<f64>,
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
    /// When it is flown.
    pub when: When,
    /// How high the home of that flight is, metres AMSL.
    pub home_m: f64,
}

/// A time of the flight, seconds since the start of the main plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum When {
    At(f64),
    /// Then, or later in the flight.
    From(f64),
}

/// A zone, how it is broken the most, and whether only perhaps.
pub(super) type Broken<'z> = (&'z Prepared, Breach, bool);

impl Zones {
    pub fn of(program: &Program, profile: &Profile, conditions: Conditions) -> Self {
        let power_w = demanded_power_w(profile, profile.cruise_airspeed_mps, 0.0, 1.0);
        let stages = &program.plan.stages;
        let on_ground_s: f64 = stages.iter().filter_map(|stage| stage.turnaround.time_s).sum();
        let flights = program.plan.flights().count().max(1) as f64;
        let mut zones = Self {
            zones: Vec::new(),
            refused: Vec::new(),
            start_unix_s: conditions.start_unix_s,
            margin_m: conditions.margins.zone_m,
            latest_s: flights * profile.energy_j / power_w.max(1.0) + on_ground_s,
        };
        for zone in &program.plan.zones {
            let homes_m = homes_m(program, zone);
            let prepared =
                homes_m.into_iter().map(|home_m| prepared(zone, home_m, conditions.margins.zone_m));
            match prepared.collect::<Result<Vec<_>, _>>() {
                Ok(prepared) => zones.zones.extend(prepared),
                Err(error) => zones.refused.push((zone.id.clone(), error.to_string())),
            }
        }
        zones
    }

    /// There is nothing to hold a track against.
    pub fn is_empty(&self) -> bool {
        self.zones.is_empty()
    }

    /// The time of the flight is not known, but a zone has times.
    pub fn timeless(&self, zone: &Prepared) -> bool {
        self.start_unix_s.is_none() && !zone.active.is_empty()
    }

    /// A zone to stay in that has times, if none of the others is always active.
    pub fn timed_keep_in(&self) -> Option<&Id> {
        let mut keep_in = self.to(ZoneKind::KeepIn).peekable();
        let first = *keep_in.peek()?;
        keep_in.all(|zone| !zone.active.is_empty()).then_some(&first.id)
    }

    /// A zone to stay in is active there and then, or may be.
    pub fn confines(&self, at: At) -> bool {
        self.active(self.to(ZoneKind::KeepIn), at).next().is_some()
    }

    /// Where pieces of track break zones, by the number of the piece: each zone to keep out of, and the nearest of those to stay in;
    /// true: it may be that the zone is not active then. Quick if the pieces are near to each other.
    pub fn breaches(&self, track: &[(At, At)], terrain: &dyn Terrain) -> Vec<(usize, Broken<'_>)> {
        let pieces: Vec<Piece> = track.iter().map(|(from, to)| Piece::new(*from, *to, terrain)).collect();
        let Some(place) = Neighbourhood::of(pieces.iter().map(|piece| &piece.amsl)) else {
            return Vec::new();
        };
        let is_near = |zone: &&Prepared| zone.outline.may_be_near_any(&place);
        let keep_out: Vec<&Prepared> = self.to(ZoneKind::KeepOut).filter(is_near).collect();
        let keep_in: Vec<&Prepared> = self.to(ZoneKind::KeepIn).collect();
        let keep_in_near: Vec<&Prepared> = keep_in.iter().copied().filter(is_near).collect();
        let mut found = Vec::new();
        for (number, (&(from, to), piece)) in track.iter().zip(&pieces).enumerate() {
            let entered = self.active(keep_out.iter().copied(), from);
            let intrusion = |(zone, perhaps)| Some((zone, Prepared::intrusion(zone, piece)?, perhaps));
            found.extend(entered.filter_map(intrusion).map(|broken| (number, broken)));
            if !self.active(keep_in_near.iter().copied(), from).any(|(zone, _)| zone.holds(piece)) {
                let all: Vec<(&Prepared, bool)> = self.active(keep_in.iter().copied(), from).collect();
                let left = StayIn { margin_m: self.margin_m, terrain }.left(&all, from, to);
                found.extend(left.map(|broken| (number, broken)));
            }
        }
        found
    }

    fn to(&self, kind: ZoneKind) -> impl Iterator<Item = &Prepared> {
        self.zones.iter().filter(move |zone| zone.kind == kind)
    }

    /// Those of some zones that are active, or may be; true: it may be that they are not.
    fn active<'z>(
        &self,
        zones: impl Iterator<Item = &'z Prepared>,
        at: At,
    ) -> impl Iterator<Item = (&'z Prepared, bool)> {
        let of_this_home = move |zone: &&Prepared| zone.home_m.is_none_or(|home_m| home_m == at.home_m);
        zones.filter(of_this_home).filter_map(move |zone| {
            let Some(start) = self.start_unix_s.filter(|_| !zone.active.is_empty()) else {
                return Some((zone, false));
            };
            let unix_s = |time_s: f64| start.saturating_add(time_s as i64);
            let (first, last) = match at.when {
                When::At(time_s) => (unix_s(time_s), unix_s(time_s)),
                When::From(time_s) => (unix_s(time_s), unix_s(time_s.max(self.latest_s))),
            };
            let overlaps = |t: &&ZoneTime| t.from_unix_s <= last && first < t.until_unix_s;
            let covers = |t: &ZoneTime| t.from_unix_s <= first && last < t.until_unix_s;
            let certain = zone.active.iter().any(covers);
            zone.active.iter().find(overlaps).map(|_| (zone, !certain))
        })
    }
}

/// A straight piece of track, with its altitudes above mean sea level and above the ground at its ends.
pub(super) struct Piece {
    pub amsl: Stretch,
    /// `None`: nothing is known of the ground.
    agl: Option<Stretch>,
}

impl Piece {
    pub fn new(from: At, to: At, terrain: &dyn Terrain) -> Self {
        let element = PathElement::Line { from: from.position, to: to.position };
        let height_m = |at: At| Some(at.altitude_amsl_m - terrain.elevation_m(at.position)?);
        Self {
            amsl: Stretch::new(element, (from.altitude_amsl_m, to.altitude_amsl_m)),
            agl: height_m(from).zip(height_m(to)).map(|heights_m| Stretch::new(element, heights_m)),
        }
    }
}

impl Prepared {
    /// Inside, by all its limits.
    fn intrusion(&self, piece: &Piece) -> Option<Breach> {
        let mut breaches = self.parts.iter().map(|part| self.breach(part, piece));
        let first = breaches.next()??;
        breaches.try_fold(first, |worst, breach| breach.map(|_| worst))
    }

    /// Outside, by one of its limits.
    pub fn excursion(&self, piece: &Piece) -> Option<Breach> {
        self.parts.iter().find_map(|part| self.breach(part, piece))
    }

    /// Inside by all its limits: quicker than to find out how far outside.
    pub fn holds(&self, piece: &Piece) -> bool {
        self.parts.iter().all(|part| {
            let (zone, stretch) = self.held_against(part, piece);
            zone.is_kept_by(stretch)
        })
    }

    /// How far the end of a piece is outside, by its limits alone, metres.
    pub fn off_limits_m(&self, piece: &Piece) -> f64 {
        let off_m = |part| {
            let (zone, stretch) = self.held_against(part, piece);
            zone.off_band_m(stretch.end_altitude_m())
        };
        self.parts.iter().map(off_m).fold(0.0, f64::max)
    }

    /// Its altitude is above mean sea level, whatever the limits count from.
    fn breach(&self, part: &(Datum, Ground), piece: &Piece) -> Option<Breach> {
        let (zone, stretch) = self.held_against(part, piece);
        let breach = zone.breach(stretch)?;
        Some(Breach { altitude_m: piece.amsl.altitude_at_m(breach.distance_m), ..breach })
    }

    fn held_against<'p>(
        &'p self,
        (datum, zone): &'p (Datum, Ground),
        piece: &'p Piece,
    ) -> (&'p Ground, &'p Stretch) {
        match (datum, &piece.agl) {
            (Datum::Amsl, _) => (zone, &piece.amsl),
            (Datum::Agl, Some(agl)) => (zone, agl),
            (Datum::Agl, None) => (&self.outline, &piece.amsl),
        }
    }
}

/// For how many homes a zone has to be prepared, by their elevations: once if none of its limits counts from there.
fn homes_m(program: &Program, zone: &Zone) -> Vec<Option<f64>> {
    let mut limits = zone.floor.iter().chain(&zone.ceiling);
    if !limits.any(|limit| limit.reference == AltitudeReference::Home) {
        return vec![None];
    }
    let plan = &program.plan;
    let home_m = |stage| plan.home_at(stage).map_or(0.0, |runway| runway.elevation_amsl_m);
    let mut homes_m: Vec<f64> = plan.flights().map(home_m).collect();
    homes_m.sort_by(f64::total_cmp);
    homes_m.dedup();
    homes_m.into_iter().map(Some).collect()
}

fn prepared(zone: &Zone, home_m: Option<f64>, margin_m: f64) -> Result<Prepared, ZoneError> {
    let shape = match &zone.shape {
        ZoneShape::Circle { centre, radius_m } => Shape::Circle { centre: *centre, radius_m: *radius_m },
        ZoneShape::Polygon(corners) => Shape::Polygon { outer: corners.clone(), holes: Vec::new() },
    };
    let rule = match zone.kind {
        ZoneKind::KeepIn => Rule::KeepIn,
        ZoneKind::KeepOut => Rule::KeepOut,
    };
    let new = |band, margin_m| Ground::new(&shape, band, rule, margin_m);
    let part = |datum| Ok((datum, new(limits(zone, datum, home_m.unwrap_or(0.0)), margin_m)?));
    let parts = data(zone).into_iter().map(part).collect::<Result<_, ZoneError>>()?;
    let (outline, ground) = (new(Band::ALL, margin_m)?, new(Band::ALL, 0.0)?);
    let (id, kind, active) = (zone.id.clone(), zone.kind, zone.active.clone());
    Ok(Prepared { id, kind, parts, outline, ground, active, home_m })
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
