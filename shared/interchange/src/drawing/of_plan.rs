//! A plan and its flown waypoints as a drawing.

use super::{BEGINS, Drawing, ENDS, Feature, LABEL, Shape, Vertex};
use crate::losses::{self, Kept};
use crate::note::Notes;
use crate::synthetic::altitude;
use crate::{Export, Format, csv};
use flight_plan::{AltitudeReference, Fix, FlightPlan, Runway, Zone, ZoneKind, ZoneShape};
use geometry::LatLon;

/// Corners that approximate a circle.
const CIRCLE_CORNERS: u32 = 72;

/// The flown path as a line, fixes and runways as points, zones as areas. GPX knows no areas.
pub fn of(export: &Export<'_>, format: Format, notes: &mut Notes) -> Drawing {
    let areas = format != Format::Gpx;
    losses::note_losses(
        export,
        Kept { fixes: true, runways: areas, zones: areas, ..Kept::default() },
        &|_| false,
        notes,
    );
    let mut features: Vec<Feature> = path(export, notes).into_iter().collect();
    features.extend(points(export.plan));
    if areas {
        features.extend(export.plan.zones.iter().map(|z| zone(z, notes)));
    }
    Drawing::new(export.plan.name.clone(), features)
}

fn path(export: &Export<'_>, notes: &mut Notes) -> Option<Feature> {
    let vertices: Vec<Vertex> = export
        .steps
        .iter()
        .map(|s| Vertex {
            position: s.waypoint.position,
            altitude: Some(altitude(s.waypoint.altitude_amsl_m, AltitudeReference::Amsl)),
            name: s.waypoint.leg.to_string(),
            kind: csv::action(&s.waypoint.action).into(),
        })
        .collect();
    let crosses = vertices
        .iter()
        .zip(vertices.iter().skip(1))
        .any(|(a, b)| (a.position.lon_deg - b.position.lon_deg).abs() > 180.0);
    if crosses {
        notes.push(
            "antimeridian",
            "path",
            "the path crosses the antimeridian: other programs may draw it around the world",
        );
    }
    if export.steps.iter().any(|s| s.waypoint.fly_over) {
        notes.push("fly-over-not-carried", "path", "which waypoints are crossed before the turn is left out");
    }
    let mut marks = marks("path", &[]);
    let kind = |vertex: Option<&Vertex>| vertex.map_or(String::new(), |v| v.kind.clone());
    marks.push((BEGINS.into(), kind(vertices.first())));
    marks.push((ENDS.into(), kind(vertices.last())));
    let shape = match vertices.len() {
        0 => return None,
        1 => vertices.into_iter().next().map(Shape::Point)?,
        _ => Shape::Line(vertices),
    };
    let name = export.plan.name.clone();
    Some(Feature { place: String::new(), name, description: String::new(), marks, shape })
}

fn points(plan: &FlightPlan) -> impl Iterator<Item = Feature> + '_ {
    let fixes = plan.fixes.iter().map(|fix| Feature {
        place: String::new(),
        name: fix.id.to_string(),
        description: fix.description.clone(),
        marks: fix_marks(fix),
        shape: Shape::Point(Vertex { kind: "fix".into(), ..Vertex::new(fix.position, None) }),
    });
    let runways = plan.runways.iter().map(|r| {
        let elevation = altitude(r.elevation_amsl_m, AltitudeReference::Amsl);
        Feature {
            place: String::new(),
            name: r.id.to_string(),
            description: String::new(),
            marks: runway_marks(r),
            shape: Shape::Point(Vertex {
                kind: "runway".into(),
                ..Vertex::new(r.threshold, Some(elevation))
            }),
        }
    });
    fixes.chain(runways)
}

fn fix_marks(fix: &Fix) -> Vec<(String, String)> {
    let label = (!fix.name.is_empty()).then(|| (LABEL.to_owned(), fix.name.clone()));
    marks("fix", &[]).into_iter().chain(label).collect()
}

fn runway_marks(runway: &Runway) -> Vec<(String, String)> {
    let mut numbers = vec![
        ("heading_deg", runway.heading_deg),
        ("length_m", runway.length_m),
        ("priority", runway.priority.into()),
    ];
    if let Some(entry) = runway.approach_entry {
        numbers.extend([("approach_entry_lat", entry.lat_deg), ("approach_entry_lon", entry.lon_deg)]);
    }
    marks("runway", &numbers)
}

fn zone(zone: &Zone, notes: &mut Notes) -> Feature {
    let kind = match zone.kind {
        ZoneKind::KeepIn => "keep-in",
        ZoneKind::KeepOut => "keep-out",
    };
    let (outer, marks) = match &zone.shape {
        ZoneShape::Polygon(corners) => (corners.clone(), marks(kind, &[])),
        ZoneShape::Circle { centre, radius_m } => {
            notes.push("circle-as-polygon", zone.id.as_str(), "this circle is drawn as a polygon");
            let circle =
                [("centre_lat", centre.lat_deg), ("centre_lon", centre.lon_deg), ("radius_m", *radius_m)];
            (round(*centre, *radius_m), marks(kind, &circle))
        }
    };
    let shape = Shape::Area { outer, holes: Vec::new(), altitude: None };
    Feature { place: String::new(), name: zone.id.to_string(), description: zone.name.clone(), marks, shape }
}

fn round(centre: LatLon, radius_m: f64) -> Vec<LatLon> {
    let step_deg = 360.0 / f64::from(CIRCLE_CORNERS);
    // anticlockwise, as RFC 7946 wants outer rings
    (0..CIRCLE_CORNERS).map(|i| centre.destination(360.0 - step_deg * f64::from(i), radius_m)).collect()
}

fn marks(kind: &str, numbers: &[(&str, f64)]) -> Vec<(String, String)> {
    let kind = std::iter::once(("legwork".to_owned(), kind.to_owned()));
    kind.chain(numbers.iter().map(|(name, value)| ((*name).to_owned(), value.to_string()))).collect()
}
