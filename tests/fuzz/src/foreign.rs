//! Other programs' formats.

use flight_exec::{Action, Token, Waypoint};
use flight_plan::{FlightPlan, Leg, LegKind, Place, Value};
use geometry::LatLon;
use interchange::{Assumptions, Export, Format, Step, read, write};

/// Notes are listed up to here, and then counted in one more.
const MAX_NOTES: usize = 2001;
/// A plan is longer than what it was read from, but by no more: bytes for each byte, and besides.
const MAX_GROWTH: usize = 400;
const MAX_MADE_UP: usize = 10_000;
/// So near to a place the aircraft is there, metres.
const HERE_M: f64 = 1.0;

/// Any bytes as a `.plan` of QGroundControl.
///
/// # Panics
/// See [`imported`].
pub fn plan(bytes: &[u8]) {
    imported(Format::Plan, bytes);
}

/// Any bytes as a list of waypoints.
///
/// # Panics
/// See [`imported`].
pub fn waypoints(bytes: &[u8]) {
    imported(Format::Waypoints, bytes);
}

/// Any bytes as KML.
///
/// # Panics
/// See [`imported`].
pub fn kml(bytes: &[u8]) {
    imported(Format::Kml, bytes);
}

/// Any bytes as KMZ.
///
/// # Panics
/// See [`imported`].
pub fn kmz(bytes: &[u8]) {
    imported(Format::Kmz, bytes);
}

/// Any bytes as GeoJSON.
///
/// # Panics
/// See [`imported`].
pub fn geojson(bytes: &[u8]) {
    imported(Format::GeoJson, bytes);
}

/// Any bytes as XML of stages and legs.
///
/// # Panics
/// See [`imported`].
pub fn fpxml(bytes: &[u8]) {
    imported(Format::FpXml, bytes);
}

/// Any bytes as GPX.
///
/// # Panics
/// See [`imported`].
pub fn gpx(bytes: &[u8]) {
    imported(Format::Gpx, bytes);
}

/// Whatever was read is a plan that can be written and read again unchanged, is not out of proportion, and can be given
/// back to the other program: as many waypoints as it is given.
fn imported(format: Format, bytes: &[u8]) {
    Format::by_content(bytes);
    let Ok(import) = read(format, bytes, &Assumptions::default()) else { return };
    assert!(import.notes.len() <= MAX_NOTES);
    let document = flight_plan::write(&import.plan);
    assert!(document.len() <= MAX_MADE_UP + MAX_GROWTH * bytes.len(), "{} bytes", document.len());
    assert_eq!(flight_plan::read(&document).plan, import.plan);
    let steps = steps(&import.plan);
    let export = Export { plan: &import.plan, steps: &steps };
    if format.is_written() {
        let written = write(format, &export).unwrap();
        let back = read(format, &written.bytes, &Assumptions::default()).unwrap();
        assert_eq!(ways(&back.plan), ways(&import.plan), "waypoints written and read again");
    }
    write(Format::Csv, &export).unwrap();
}

/// The places of a plan as if they were flown, one after the other.
fn steps(plan: &FlightPlan) -> Vec<Step> {
    let flown = places(plan).into_iter().enumerate();
    let step = |(index, (position, leg)): (usize, (LatLon, &Leg))| Step {
        waypoint: Waypoint {
            token: Token(index as u64 + 1),
            position,
            altitude_amsl_m: 500.0,
            airspeed_mps: 22.0,
            action: Action::Fly,
            fly_over: false,
            on_arc: false,
            leg: leg.id.clone(),
            end_of_plan: false,
        },
        passage: index,
    };
    flown.map(step).collect()
}

/// How many places the plan leads to, one after the other: a circle where the aircraft is already is a wait of the leg before.
fn ways(plan: &FlightPlan) -> usize {
    let places: Vec<LatLon> = places(plan).into_iter().map(|(position, _)| position).collect();
    let apart = |two: &&[LatLon]| two[0].distance_m(two[1]) > HERE_M;
    places.len().min(1) + places.windows(2).filter(apart).count()
}

/// Where the plan's tracks lead, in its order, those in loops too.
fn places(plan: &FlightPlan) -> Vec<(LatLon, &Leg)> {
    let legs = plan.all_legs().into_iter().map(|context| context.leg);
    legs.filter_map(|leg| Some((place(leg)?, leg))).collect()
}

fn place(leg: &Leg) -> Option<LatLon> {
    let (LegKind::Tf(to) | LegKind::Df { to, .. }) = &leg.kind else { return None };
    let Place::Position(Value::Constant(at)) = &to.place else { return None };
    Some(*at)
}
