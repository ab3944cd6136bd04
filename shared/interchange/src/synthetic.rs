//! What other formats leave open and a plan needs: aircraft, runways, heights and spacings.

use crate::names::Names;
use crate::note::Notes;
use aircraft::Profile;
use flight_plan::{Altitude, AltitudeReference, FlightPlan, Id, Runway, Stage, StageKind, Value};
use geometry::LatLon;

/// What an area of a drawing becomes, if the drawing doesn't say.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Areas {
    /// It is scanned.
    #[default]
    Scan,
    /// A zone to stay inside of.
    KeepIn,
    /// A zone to keep out of.
    KeepOut,
}

impl Areas {
    /// All of them, with their names.
    pub const ALL: [(&'static str, Areas); 3] =
        [("scan", Areas::Scan), ("keep-in", Areas::KeepIn), ("keep-out", Areas::KeepOut)];
}

/// A runway that is there, in one of its directions.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownRunway {
    /// What it is called, with its airport.
    pub name: String,
    /// Where a landing begins.
    pub threshold: LatLon,
    /// Where it ends.
    pub end: LatLon,
}

/// What is taken where a file says nothing; each use of one is a note.
#[derive(Debug, Clone)]
pub struct Assumptions {
    /// The aircraft of the plan: name of a profile. `None`: the one that suits what the file says of its vehicle.
    pub aircraft: Option<String>,
    /// Name of the plan, where the file has none.
    pub name: String,
    /// Height above ground of what has no altitude, metres.
    pub height_agl_m: f64,
    /// Length of a runway that is made up, metres.
    pub runway_length_m: f64,
    /// Radius of a loiter that names none, metres.
    pub loiter_radius_m: f64,
    /// Distance between tracks over an area that names none, metres.
    pub spacing_m: f64,
    /// What a drawn area becomes.
    pub areas: Areas,
    /// The runway to take off from and to land on, instead of one that is made up; a drawing gets take-off and landing only
    /// with it.
    pub runway: Option<Runway>,
    /// Which runways there are near a place: where a mission takes off or lands on one and doesn't say in which direction, that
    /// one is meant.
    pub known_runways: fn(LatLon) -> Vec<KnownRunway>,
}

impl Default for Assumptions {
    fn default() -> Self {
        Self {
            aircraft: None,
            name: "Imported plan".into(),
            height_agl_m: 100.0,
            runway_length_m: 600.0,
            loiter_radius_m: 80.0,
            spacing_m: 100.0,
            areas: Areas::default(),
            runway: None,
            known_runways: |_| Vec::new(),
        }
    }
}

impl Assumptions {
    /// The altitude of what has none.
    pub fn altitude(&self) -> Altitude {
        altitude(self.height_agl_m, AltitudeReference::Agl)
    }
}

/// A constant altitude.
pub fn altitude(metres: f64, reference: AltitudeReference) -> Altitude {
    Altitude { metres: Value::Constant(metres), reference }
}

/// A runway where a mission only names a point; says so.
pub fn runway(
    id: Id,
    threshold: LatLon,
    elevation_amsl_m: f64,
    heading_deg: f64,
    length_m: f64,
    place: &str,
    notes: &mut Notes,
) -> Runway {
    let runway =
        Runway { id, threshold, elevation_amsl_m, heading_deg, length_m, priority: 1, approach_entry: None };
    note_assumed_runway(&runway, place, notes);
    runway
}

/// Notes the assumptions about a runway.
pub fn note_assumed_runway(runway: &Runway, place: &str, notes: &mut Notes) {
    let Runway { id, elevation_amsl_m, heading_deg, length_m, .. } = runway;
    let message = format!(
        "runway `{id}` is assumed from a point: {length_m:.0} m long, heading {heading_deg:.0}°, elevation {elevation_amsl_m:.0} m; correct it"
    );
    notes.push("runway-made-up", place, message);
}

/// A stage without legs, altitude and speed.
pub fn stage(id: Id, name: &str, kind: StageKind) -> Stage {
    Stage {
        id,
        name: name.into(),
        kind,
        emergency: Default::default(),
        runway: None,
        altitude: None,
        speed_mps: None,
        turnaround: Default::default(),
        legs: Vec::new(),
    }
}

/// The runway that is given, with a take-off from it and a landing on it.
pub fn ends(assumptions: &Assumptions, names: &mut Names) -> Option<(Runway, [Stage; 2])> {
    let given = assumptions.runway.as_ref()?;
    let runway = Runway { id: names.take(given.id.as_str(), "runway"), ..given.clone() };
    let mut end = |kind, name: &str| Stage {
        runway: Some(runway.id.clone()),
        ..stage(names.take(name, name), "", kind)
    };
    let mut ends = [end(StageKind::TakeOff, "take-off"), end(StageKind::Land, "land")];
    ends[0].altitude = Some(altitude(assumptions.height_agl_m, AltitudeReference::Home));
    Some((runway, ends))
}

/// What a file says of the aircraft that flies it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Vehicle {
    /// Its usual airspeed, m/s.
    pub cruise_mps: Option<f64>,
    /// It takes off or lands upright.
    pub is_vtol: bool,
}

/// A plan without content; says for which aircraft.
pub fn plan(assumptions: &Assumptions, vehicle: Vehicle, notes: &mut Notes) -> FlightPlan {
    let aircraft = assumptions.aircraft.clone().unwrap_or_else(|| suiting(vehicle, notes).to_owned());
    FlightPlan { name: assumptions.name.clone(), aircraft, ..FlightPlan::default() }
}

/// Speeds nearer than this are the same, m/s: in words, and for what is flown.
const ABOUT_MPS: f64 = 1.0;
const SAME_MPS: f64 = 0.05;

fn cruise_mps(aircraft: &str) -> Option<f64> {
    Profile::by_name(aircraft).ok().map(|profile| profile.cruise_airspeed_mps)
}

/// The usual airspeed of the file, m/s, where the aircraft chosen has another; `None`, with a note, if it can't fly it. Of an aircraft
/// that is not one of ours a check of the plan knows better.
pub fn own_cruise_mps(aircraft: &str, vehicle: Vehicle, notes: &mut Notes) -> Option<f64> {
    let speed_mps = vehicle.cruise_mps.filter(|speed| *speed > 0.0)?;
    let Ok(Profile { min_airspeed_mps, max_airspeed_mps, cruise_airspeed_mps, .. }) =
        Profile::by_name(aircraft)
    else {
        return Some(speed_mps);
    };
    if (min_airspeed_mps..=max_airspeed_mps).contains(&speed_mps) {
        return Some(speed_mps).filter(|speed| (speed - cruise_airspeed_mps).abs() > SAME_MPS);
    }
    let message = format!(
        "the file's usual speed of {speed_mps} m/s is left out: the aircraft flies {min_airspeed_mps} to {max_airspeed_mps} m/s, and {cruise_airspeed_mps} m/s where no leg says otherwise"
    );
    notes.push("speed-not-flown", "file", message);
    None
}

fn suiting(vehicle: Vehicle, notes: &mut Notes) -> &'static str {
    let name = Profile::suiting(vehicle.cruise_mps, vehicle.is_vtol);
    let why = match vehicle {
        Vehicle { is_vtol: true, .. } => "it takes off or lands upright".to_owned(),
        Vehicle { cruise_mps: Some(speed), .. } => match cruise_mps(name) {
            Some(own) if (own - speed).abs() > ABOUT_MPS => {
                format!("of those there are, its {own:.0} m/s are nearest to the {speed:.0} m/s of the file")
            }
            _ => format!("it flies at {speed:.0} m/s"),
        },
        Vehicle { .. } => "the file doesn't say how fast it flies".to_owned(),
    };
    let message = format!(
        "the plan is for the aircraft `{name}`: {why}; choose another if that is wrong (there are {})",
        Profile::names().join(", ")
    );
    notes.push("aircraft-assumed", "file", message);
    name
}
