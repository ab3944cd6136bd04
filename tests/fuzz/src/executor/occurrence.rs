//! What can happen, made from bytes. Numbers are any numbers: not-a-number and infinities too.

use arbitrary::Arbitrary;
use flight_plan::{Cause, Id, Leg, LegKind, VariableValue};
use geometry::LatLon;

#[derive(Debug, Arbitrary)]
pub enum Occurrence {
    Wait { tenths_s: u8 },
    Leap { nanoseconds: u64 },
    UntilDue,
    Propose { plan: u8, seen: Option<u8>, forbidden: bool },
    Update { plan: u8 },
    Order(Order),
    Fly { waypoints: u8 },
    Report(Report),
    Steered { token: Option<u16> },
    Rejected { token: u16 },
    GatewayControls(bool),
    Restart,
}

/// Legs, plans and variables are numbers in lists.
#[derive(Debug, Arbitrary)]
pub enum Order {
    Start,
    Hold,
    Resume,
    SkipLeg,
    GoTo(u8),
    SetCount(u8, u64),
    Decide(u8, u8),
    Set(u8, Value),
    Emergency(u8, Option<u8>),
    ReturnToMain(u8),
    Commit(u8, Option<u8>),
}

#[derive(Debug, Arbitrary)]
pub enum Value {
    Bool(bool),
    /// Of an order of magnitude that a plan's variables have.
    Small(i16),
    Number(f64),
    Text(String),
    Position(f64, f64),
    /// Metres east and north of a place in the plans' country.
    Near(i16, i16),
    Polygon(Vec<(i16, i16)>),
}

#[derive(Debug, Arbitrary)]
pub struct Report {
    pub position: (f64, f64),
    pub motion: [f64; 4],
    pub air: [f64; 3],
    pub on_ground: bool,
}

const NEAR: LatLon = LatLon::new(36.32, -84.17);

fn near((east_m, north_m): (i16, i16)) -> LatLon {
    NEAR.destination(90.0, east_m.into()).destination(0.0, north_m.into())
}

impl From<Value> for VariableValue {
    fn from(value: Value) -> Self {
        match value {
            Value::Bool(value) => VariableValue::Bool(value),
            Value::Small(value) => VariableValue::Number(f64::from(value) / 8.0),
            Value::Number(value) => VariableValue::Number(value),
            Value::Text(value) => VariableValue::Text(value),
            Value::Position(lat_deg, lon_deg) => VariableValue::Position(LatLon::new(lat_deg, lon_deg)),
            Value::Near(east_m, north_m) => VariableValue::Position(near((east_m, north_m))),
            Value::Polygon(corners) => VariableValue::Polygon(corners.into_iter().map(near).collect()),
        }
    }
}

pub fn cause(number: u8) -> Cause {
    use Cause as C;
    let all = [C::Operator, C::Payload, C::Traffic, C::Link, C::Gps, C::Energy, C::Engine];
    all[usize::from(number) % all.len()]
}

/// A branch of an intersection.
pub fn branch(leg: &Leg, number: u8) -> Option<Id> {
    let LegKind::Intersection { branches, .. } = &leg.kind else { return None };
    branches.get(usize::from(number) % branches.len().max(1)).map(|b| b.id.clone())
}
