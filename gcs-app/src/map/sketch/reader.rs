//! What the values of a plan come to, for a sketch.

use super::Sketch;
use flight_plan::{Area, Env, FlightPlan, Id, Leg, LegKind, Place, Scan, Value, expression};
use geometry::LatLon;
use std::collections::HashMap;

/// Reads places and numbers with the variables as they are.
pub(super) struct Reader<'a> {
    pub plan: &'a FlightPlan,
    pub fixes: HashMap<&'a Id, LatLon>,
    pub env: Env<'a>,
    /// Of the plan before.
    pub former: &'a Sketch,
}

impl Reader<'_> {
    pub fn place(&self, place: &Place) -> Option<LatLon> {
        let at = match place {
            Place::Fix(id) => *self.fixes.get(id)?,
            Place::Position(Value::Constant(at)) => *at,
            Place::Position(Value::Expression(source)) => {
                expression::compile(source, self.plan).ok()?.position(&self.env).ok()?
            }
        };
        at.is_valid().then_some(at)
    }

    pub fn place_of(&self, leg: &Leg) -> Option<LatLon> {
        leg.place().and_then(|place| self.place(place))
    }

    pub fn polygon(&self, source: &str) -> Option<Vec<LatLon>> {
        expression::compile(source, self.plan).ok()?.polygon(&self.env).ok()
    }

    pub fn number(&self, value: &Value<f64>) -> Option<f64> {
        match value {
            Value::Constant(number) => Some(*number),
            Value::Expression(source) => expression::compile(source, self.plan).ok()?.number(&self.env).ok(),
        }
    }

    pub fn line_of(&self, leg: &Leg, line: &mut Vec<LatLon>) {
        if let LegKind::Scan(Scan { area: Area::Polygon { corners, .. }, .. }) = &leg.kind {
            line.extend(corners.first().filter(|c| c.is_valid()));
        }
        line.extend(leg.place().and_then(|p| self.place(p)));
        leg.body().iter().for_each(|inner| self.line_of(inner, line));
    }
}
