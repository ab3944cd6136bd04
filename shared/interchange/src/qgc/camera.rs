//! `CameraCalc`: spacing, height and picture distance of a pattern.

use super::json::{flag, number};
use crate::note::Notes;
use flight_plan::{Altitude, AltitudeReference, Spacing, Value};
use serde_json::{Map, Value as Json, json};

/// The spacing that a camera gives and the one in the file differ at most by this share, else the file's counts.
const SAME: f64 = 0.01;

/// What a pattern is flown with.
pub struct Camera {
    /// Between tracks.
    pub spacing: Option<Spacing>,
    /// Between pictures, metres; `None`: no pictures.
    pub every_m: Option<f64>,
    /// Metres above `reference`.
    pub height_m: Option<f64>,
    /// Home, AMSL or ground.
    pub reference: AltitudeReference,
}

/// What the calculation says.
pub fn read(transect: &Json, place: &str, notes: &mut Notes) -> Camera {
    let calc = transect.get("CameraCalc").unwrap_or(&Json::Null);
    let height_m = number(calc, "DistanceToSurface").filter(|h| h.abs() < 1e5);
    let side_m = number(calc, "AdjustedFootprintSide").filter(|s| *s > 0.0);
    let every_m = number(calc, "AdjustedFootprintFrontal").filter(|f| *f > 0.0);
    let reference = reference(calc, flag(transect, "FollowTerrain"));
    let spacing = match (lens(calc), side_m) {
        (Some(camera), Some(side_m)) if fits(&camera, height_m, side_m) => Some(spacing(&camera, height_m)),
        (camera, side_m) => {
            if camera.is_some() {
                notes.push(
                    "camera",
                    place,
                    "the camera is left out: its footprint is not the distance between tracks",
                );
            }
            side_m.map(|m| Spacing::Metres(Value::Constant(m)))
        }
    };
    Camera { spacing, every_m, height_m, reference }
}

/// Field of view across the track (degrees) and overlap (0..1), if the camera is known.
fn lens(calc: &Json) -> Option<(f64, f64)> {
    let focal_mm = number(calc, "FocalLength").filter(|f| *f > 0.0)?;
    let landscape = calc.get("Landscape").and_then(Json::as_bool).unwrap_or(true);
    let sensor_mm =
        number(calc, if landscape { "SensorWidth" } else { "SensorHeight" }).filter(|s| *s > 0.0)?;
    let overlap = number(calc, "SideOverlap").filter(|o| (0.0..100.0).contains(o))? / 100.0;
    Some((2.0 * (sensor_mm / (2.0 * focal_mm)).atan().to_degrees(), overlap))
}

/// S = 2·h·tan(FOV/2)·(1 − overlap).
fn fits((fov_deg, overlap): &(f64, f64), height_m: Option<f64>, side_m: f64) -> bool {
    let Some(height_m) = height_m.filter(|h| *h > 0.0) else { return false };
    let footprint_m = 2.0 * height_m * (fov_deg / 2.0).to_radians().tan() * (1.0 - overlap);
    (footprint_m / side_m - 1.0).abs() < SAME
}

fn spacing((fov_deg, overlap): &(f64, f64), height_m: Option<f64>) -> Spacing {
    Spacing::Camera {
        field_of_view_deg: Value::Constant(*fov_deg),
        overlap: Value::Constant(*overlap),
        height_m: height_m.map(Value::Constant),
    }
}

/// `DistanceMode` (1 relative, 2 absolute, 3 and 4 above terrain), before that `DistanceToSurfaceRelative`.
fn reference(calc: &Json, follows_terrain: bool) -> AltitudeReference {
    match calc.get("DistanceMode").and_then(Json::as_u64) {
        _ if follows_terrain => AltitudeReference::Agl,
        Some(2) => AltitudeReference::Amsl,
        Some(3 | 4) => AltitudeReference::Agl,
        Some(_) => AltitudeReference::Home,
        None if calc.get("DistanceToSurfaceRelative").and_then(Json::as_bool) == Some(false) => {
            AltitudeReference::Amsl
        }
        None => AltitudeReference::Home,
    }
}

/// A calculation without a known camera: distances only. `None` for an altitude that is no constant.
pub fn write(spacing_m: f64, every_m: Option<f64>, altitude: &Altitude) -> Option<Json> {
    let Value::Constant(height_m) = altitude.metres else { return None };
    Some(json!({
        "AdjustedFootprintFrontal": every_m.unwrap_or(0.0),
        "AdjustedFootprintSide": spacing_m,
        "CameraName": "Manual (no camera specs)",
        "DistanceMode": mode(altitude.reference),
        "DistanceToSurface": height_m,
        "version": 2,
    }))
}

/// How closely the ground is followed, with QGC's default values: without it, QGC refuses a pattern above terrain.
pub fn terrain(reference: AltitudeReference) -> Map<String, Json> {
    let settings = [
        ("TerrainAdjustTolerance", 10.0),
        ("TerrainAdjustMaxClimbRate", 0.0),
        ("TerrainAdjustMaxDescentRate", 0.0),
    ];
    let follows = reference == AltitudeReference::Agl;
    settings.into_iter().filter(|_| follows).map(|(key, value)| (key.to_owned(), json!(value))).collect()
}

fn mode(reference: AltitudeReference) -> u64 {
    match reference {
        AltitudeReference::Home => 1,
        AltitudeReference::Amsl => 2,
        AltitudeReference::Agl => 3,
    }
}
