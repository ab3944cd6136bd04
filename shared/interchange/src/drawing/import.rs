//! A drawing as a plan.

use super::zones::{self, DrawnZone};
use super::{Drawing, Feature, LABEL, Shape, Vertex, ends};
use crate::mission::SAME_M;
use crate::mission::placed::{leg, waypoint};
use crate::names::Names;
use crate::note::Notes;
use crate::synthetic::{self, Areas, Assumptions, Vehicle};
use crate::xml::held;
use crate::{Error, Import, MAX_ITEMS};
use flight_plan::{
    Altitude, AltitudeReference, Area, Fix, FlightPlan, Id, LegKind, Runway, Scan, ScanEntry, ScanOrder,
    ScanStyle, Spacing, Stage, StageKind, Value, Zone, ZoneKind,
};
use geometry::LatLon;

/// Most runways: each path looks for the nearest.
const MAX_RUNWAYS: usize = 100;

/// A drawing as a plan.
///
/// # Errors
/// More legs or runways than are read.
pub fn read(mut drawing: Drawing, assumptions: &Assumptions) -> Result<Import, Error> {
    let legs: usize =
        drawing.features.iter().map(|f| if let Shape::Line(l) = &f.shape { l.len() } else { 1 }).sum();
    if legs > MAX_ITEMS {
        return Err(Error::TooMany { what: "points of lines", limit: MAX_ITEMS });
    }
    let mut names = Names::default();
    let mut plan = synthetic::plan(assumptions, Vehicle::default(), &mut drawing.notes);
    if !drawing.name.is_empty() {
        plan.name = held(&drawing.name);
    }
    let mut land = None;
    if let Some((runway, [take_off, landing])) = synthetic::ends(assumptions, &mut names) {
        plan.runways.push(runway);
        plan.stages.push(take_off);
        land = Some(landing);
    }
    let mut importer = Importer { assumptions, names, notes: drawing.notes, plan, land, made_up: Vec::new() };
    // runways first: paths take off from them and land on them
    let is_runway = |f: &Feature| f.mark("legwork") == Some("runway");
    let (runways, others): (Vec<_>, Vec<_>) = drawing.features.into_iter().partition(is_runway);
    if runways.len() > MAX_RUNWAYS {
        return Err(Error::TooMany { what: "runways", limit: MAX_RUNWAYS });
    }
    runways.into_iter().chain(others).for_each(|f| importer.feature(f));
    importer.finish();
    if importer.plan.stages.is_empty() && importer.plan.fixes.is_empty() && importer.plan.zones.is_empty() {
        importer.notes.push("empty", "file", "there is no point, line or area in this file");
    }
    Ok(Import { plan: importer.plan, notes: importer.notes.into_vec() })
}

struct Importer<'a> {
    assumptions: &'a Assumptions,
    names: Names,
    notes: Notes,
    plan: FlightPlan,
    /// The landing that a path ends with: it comes behind everything else.
    land: Option<Stage>,
    /// Runways that the drawing says too little of, and where it does.
    made_up: Vec<(Id, String)>,
}

impl Importer<'_> {
    fn finish(&mut self) {
        self.plan.stages.extend(self.land.take());
        for runway in self.plan.runways.iter_mut().filter(|r| r.heading_deg.is_nan()) {
            // nothing takes off from it
            runway.heading_deg = 0.0;
        }
        for (id, place) in &self.made_up {
            let runway = self.plan.runways.iter().find(|runway| runway.id == *id);
            runway
                .into_iter()
                .for_each(|runway| synthetic::note_assumed_runway(runway, place, &mut self.notes));
        }
    }

    fn feature(&mut self, feature: Feature) {
        let mark = feature.mark("legwork").unwrap_or_default().to_owned();
        match (mark.as_str(), &feature.shape) {
            ("runway", Shape::Point(at)) => self.runway(&feature, at),
            ("path", Shape::Point(at)) => self.line(&feature, std::slice::from_ref(at)),
            (_, Shape::Point(at)) => self.fix(&feature, at),
            (_, Shape::Line(line)) => self.line(&feature, line),
            ("keep-in", Shape::Area { .. }) => self.zone(&feature, ZoneKind::KeepIn),
            ("keep-out", Shape::Area { .. }) => self.zone(&feature, ZoneKind::KeepOut),
            (_, Shape::Area { outer, holes, altitude }) => match self.assumptions.areas {
                Areas::Scan => self.area(&feature, outer, holes, altitude.as_ref()),
                Areas::KeepIn => self.area_as_zone(&feature, ZoneKind::KeepIn),
                Areas::KeepOut => self.area_as_zone(&feature, ZoneKind::KeepOut),
            },
        }
    }

    fn fix(&mut self, feature: &Feature, at: &Vertex) {
        if at.altitude.is_some() {
            self.notes.again(
                "altitude-not-carried",
                &feature.place,
                "a fix has no altitude: that of this point is left out",
            );
        }
        let id = self.names.take(&feature.name, "fix");
        // of ours the name of the feature is the identifier
        let ours = feature.mark("legwork") == Some("fix");
        let name = if ours { feature.mark(LABEL).unwrap_or_default() } else { &feature.name }.to_owned();
        let description = feature.description.clone();
        self.plan.fixes.push(Fix { id, position: at.position, name, description });
    }

    fn runway(&mut self, feature: &Feature, at: &Vertex) {
        if self.assumptions.runway.is_some() {
            let message = "this runway is left out: another one was given to take off from and land on";
            return self.notes.push("other-runway", &feature.place, message);
        }
        let elevation_m = match at.altitude.as_ref().map(|a| (&a.metres, a.reference)) {
            Some((Value::Constant(metres), AltitudeReference::Amsl)) => *metres,
            _ => 0.0,
        };
        let id = self.names.take(&feature.name, "runway");
        let (heading_deg, length_m) = (feature.number("heading_deg"), feature.number("length_m"));
        if heading_deg.is_none() || length_m.is_none() {
            self.made_up.push((id.clone(), feature.place.clone()));
        }
        self.plan.runways.push(Runway {
            id,
            threshold: at.position,
            elevation_amsl_m: elevation_m,
            // found later, where a path takes off
            heading_deg: heading_deg.unwrap_or(f64::NAN),
            length_m: length_m.unwrap_or(self.assumptions.runway_length_m),
            priority: feature.number("priority").and_then(priority).unwrap_or(1),
            approach_entry: feature.position("approach_entry_lat", "approach_entry_lon"),
        });
    }

    /// What is flown between take-off and landing; these become stages, where a runway is near.
    fn without_ends<'a>(&mut self, feature: &Feature, line: &'a [Vertex]) -> &'a [Vertex] {
        let mut way = line;
        if self.assumptions.runway.is_some() {
            let begun =
                way.split_first().filter(|(v, _)| ends::begins(feature, v)).map_or(way, |(_, rest)| rest);
            return begun
                .split_last()
                .filter(|(v, _)| ends::ends(feature, v))
                .map_or(begun, |(_, rest)| rest);
        }
        if self.plan.stages.is_empty()
            && let Some((first, rest)) = way.split_first().filter(|(v, _)| ends::begins(feature, v))
            && let Some(stage) =
                ends::stage(StageKind::TakeOff, first, &mut self.plan.runways, &mut self.names)
        {
            self.plan.stages.push(stage);
            way = rest;
        }
        if self.land.is_none()
            && let Some((last, rest)) = way.split_last().filter(|(v, _)| ends::ends(feature, v))
            && let Some(stage) = ends::stage(StageKind::Land, last, &mut self.plan.runways, &mut self.names)
        {
            self.land = Some(stage);
            way = rest;
        }
        way
    }

    fn line(&mut self, feature: &Feature, line: &[Vertex]) {
        self.undescribed(feature);
        let way = self.without_ends(feature, line);
        let line = self.apart(feature, way);
        if line.is_empty() {
            return;
        }
        let mut stage =
            synthetic::stage(self.names.take(&feature.name, "route"), &feature.name, StageKind::EnRoute);
        for (index, vertex) in line.iter().enumerate() {
            let to = waypoint(vertex.position, false);
            // the transit to a line begins anywhere
            let kind = if index == 0 { LegKind::Df { to, turn: None } } else { LegKind::Tf(to) };
            let preferred = if vertex.name.is_empty() {
                format!("{}.{}", stage.id, index + 1)
            } else {
                vertex.name.clone()
            };
            let mut way = leg(self.names.take(&preferred, "leg"), kind);
            way.altitude = Some(self.altitude(vertex.altitude.as_ref(), &feature.place));
            stage.legs.push(way.into());
        }
        self.plan.stages.push(stage);
    }

    /// Neighbouring points at one place are one: no track leads from one to the other. The last one says how high it is left.
    fn apart(&mut self, feature: &Feature, line: &[Vertex]) -> Vec<Vertex> {
        let mut kept: Vec<Vertex> = Vec::new();
        for vertex in line {
            match kept.last_mut().filter(|last| last.position.distance_m(vertex.position) < SAME_M) {
                Some(last) => {
                    last.altitude = vertex.altitude.clone().or(last.altitude.take());
                    let message = "a point where the one before is becomes one with it";
                    self.notes.again("duplicate-waypoint", &feature.place, message);
                }
                None => kept.push(vertex.clone()),
            }
        }
        kept
    }

    /// Legs and stages have names, and no descriptions.
    fn undescribed(&mut self, feature: &Feature) {
        if !feature.description.is_empty() {
            let message = "the description of a line or an area is left out";
            self.notes.again("description-not-carried", &feature.place, message);
        }
    }

    fn altitude(&mut self, drawn: Option<&Altitude>, place: &str) -> Altitude {
        drawn.cloned().unwrap_or_else(|| {
            let message =
                format!("what has no altitude is flown {:.0} m above ground", self.assumptions.height_agl_m);
            self.notes.again("no-altitude", place, &message);
            self.assumptions.altitude()
        })
    }

    fn zone(&mut self, feature: &Feature, kind: ZoneKind) {
        for drawn in zones::of(feature, kind) {
            let (stem, default) = if drawn.is_hole {
                (format!("{}-hole", feature.name), "hole")
            } else {
                (feature.name.clone(), "zone")
            };
            let id = self.names.take(&stem, default);
            self.plan.zones.push(at_every_height(id, drawn));
        }
        if matches!(&feature.shape, Shape::Area { holes, .. } if !holes.is_empty()) {
            let message = match kind {
                ZoneKind::KeepIn => "the holes of this zone become zones to keep out of",
                ZoneKind::KeepOut => {
                    "the holes of this zone are left out: nobody flies inside of them either"
                }
            };
            self.notes.push("zone-holes", &feature.place, message);
        }
    }

    fn area_as_zone(&mut self, feature: &Feature, kind: ZoneKind) {
        let message = match kind {
            ZoneKind::KeepIn => "an area becomes a zone to stay inside of, at every height",
            ZoneKind::KeepOut => "an area becomes a zone to keep out of, at every height",
        };
        self.notes.again("area-as-zone", &feature.place, message);
        self.undescribed(feature);
        self.zone(feature, kind);
    }

    fn area(&mut self, feature: &Feature, outer: &[LatLon], holes: &[Vec<LatLon>], drawn: Option<&Altitude>) {
        let id: Id = self.names.take(&feature.name, "area");
        let spacing_m = self.assumptions.spacing_m;
        let message = format!(
            "area `{id}` is scanned with tracks {spacing_m:.0} m apart: change that, or import areas as zones"
        );
        self.notes.push("area-as-scan", &feature.place, message);
        self.undescribed(feature);
        let scan = Scan {
            area: Area::Polygon { corners: outer.to_vec(), holes: holes.to_vec() },
            style: ScanStyle::Parallel,
            spacing: Spacing::Metres(Value::Constant(spacing_m)),
            heading_deg: None,
            overshoot_m: Value::Constant(0.0),
            entry: ScanEntry::Nearest,
            order: ScanOrder::Interleaved,
        };
        let mut stage = synthetic::stage(
            self.names.take(&format!("{id}-stage"), "stage"),
            &feature.name,
            StageKind::Mission,
        );
        // an area drawn on the ground is not meant to be flown on the ground
        let drawn = drawn.filter(|a| !matches!(a.metres, Value::Constant(m) if m == 0.0));
        let altitude = Some(self.altitude(drawn, &feature.place));
        if self.plan.stages.iter().all(|s| s.legs.is_empty())
            && let Some(corner) = outer.first()
        {
            let mut way = leg(
                self.names.take(&format!("{id}-entry"), "entry"),
                LegKind::Df { to: waypoint(*corner, false), turn: None },
            );
            way.altitude = altitude.clone();
            stage.legs.push(way.into());
        }
        let mut way = leg(id, LegKind::Scan(scan));
        (way.name, way.altitude) = (feature.name.clone(), altitude);
        stage.legs.push(way.into());
        self.plan.stages.push(stage);
    }
}

fn at_every_height(id: Id, drawn: DrawnZone) -> Zone {
    let DrawnZone { name, kind, shape, .. } = drawn;
    Zone { id, name, kind, shape, floor: None, ceiling: None, active: Vec::new() }
}

/// A whole number from 1 on.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "it is within the range and whole"
)]
fn priority(number: f64) -> Option<u32> {
    (number.fract() == 0.0 && (1.0..=f64::from(u32::MAX)).contains(&number)).then_some(number as u32)
}
