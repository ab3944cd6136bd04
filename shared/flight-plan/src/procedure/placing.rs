//! Where a call puts what its procedure has written.

use crate::expression::MAX_LENGTH;
use crate::{Call, FlightPlan, Place, Problem, Procedure, Value};
use geometry::LatLon;
use geometry::geodesy::normalise_360;

/// How positions and courses move.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Placing {
    /// Not at all.
    AsWritten,
    /// Distances and bearings from a reference point become the same distances, and bearings turned by an angle, from an anchor.
    Moved {
        /// In the procedure.
        reference: LatLon,
        /// Where it is moved to.
        anchor: Value<LatLon>,
        /// Degrees, clockwise.
        turn_deg: Value<f64>,
    },
}

impl Placing {
    /// What a call does. Its anchor and bearing have been moved with what is `around` it. `None`: its anchor or bearing
    /// is not one, or too long, which the checks say.
    pub fn of(
        procedure: &Procedure,
        call: &Call,
        around: Option<&Placing>,
        plan: &FlightPlan,
    ) -> Result<Option<Placing>, Problem> {
        let around = around.cloned().unwrap_or(Placing::AsWritten);
        if call.anchor.is_none() && call.bearing_deg.is_none() {
            return Ok(Some(around));
        }
        let Some(reference) = procedure.reference.filter(|p| p.is_valid()) else {
            let message = format!(
                "give the procedure `{}` a `reference`, or the call no position and no bearing",
                procedure.id
            );
            return Err(Problem::error("procedure-anchor", message));
        };
        let anchor = match &call.anchor {
            None => around.position(reference),
            Some(Place::Position(position)) => position.clone(),
            Some(Place::Fix(id)) => match plan.fix(id) {
                Some(fix) => Value::Constant(fix.position),
                None => return Ok(None),
            },
        };
        let turn_deg = match &call.bearing_deg {
            None => around.turn_deg(),
            Some(Value::Constant(to)) => Value::Constant(to - procedure.bearing_deg),
            Some(Value::Expression(to)) => {
                Value::Expression(format!("double({to}) - {}", number(procedure.bearing_deg)).into())
            }
        };
        // too long to be compiled, let alone to be repeated
        let long = |source: &str| source.len() > MAX_LENGTH;
        if matches!(&anchor, Value::Expression(source) if long(source))
            || matches!(&turn_deg, Value::Expression(source) if long(source))
        {
            return Ok(None);
        }
        let somewhere = !matches!(&anchor, Value::Constant(p) if !p.is_valid())
            && !matches!(&turn_deg, Value::Constant(x) if !x.is_finite());
        Ok(somewhere.then_some(Placing::Moved { reference, anchor, turn_deg }))
    }

    fn turn_deg(&self) -> Value<f64> {
        match self {
            Placing::AsWritten => Value::Constant(0.0),
            Placing::Moved { turn_deg, .. } => turn_deg.clone(),
        }
    }

    /// Where a position of the procedure is moved to; an invalid one stays as it is.
    pub fn position(&self, p: LatLon) -> Value<LatLon> {
        let Placing::Moved { reference, anchor, turn_deg } = self else { return Value::Constant(p) };
        if !p.is_valid() {
            return Value::Constant(p);
        }
        let way = reference.inverse(p);
        if way.distance_m == 0.0 {
            return anchor.clone();
        }
        match (anchor, turn_deg) {
            (Value::Constant(anchor), Value::Constant(turn_deg)) => {
                Value::Constant(anchor.destination(way.bearing_start_deg + turn_deg, way.distance_m))
            }
            _ => {
                let (anchor, bearing) = (position_source(anchor), turned(turn_deg, way.bearing_start_deg));
                Value::Expression(format!("offset({anchor}, {bearing}, {})", number(way.distance_m)).into())
            }
        }
    }

    /// What becomes of a course, degrees true, at a position of the procedure (`None`: it is not known where).
    ///
    /// The angle between the course and the way from the reference point stays; so a course that is far from
    /// there takes the meridians' convergence along, when both positions are constants.
    pub fn course(&self, course_deg: f64, at: Option<LatLon>) -> Value<f64> {
        let Placing::Moved { reference, anchor, turn_deg } = self else { return Value::Constant(course_deg) };
        match (anchor, turn_deg) {
            (Value::Constant(anchor), Value::Constant(turn_deg)) => {
                let way = at
                    .filter(|p| p.is_valid())
                    .map(|p| reference.inverse(p))
                    .filter(|way| way.distance_m > 0.0);
                let turn_deg = way.map_or(*turn_deg, |way| {
                    let there = anchor.direct(way.bearing_start_deg + turn_deg, way.distance_m);
                    there.bearing_end_deg - way.bearing_end_deg
                });
                Value::Constant(normalise_360(course_deg + turn_deg))
            }
            (_, turn_deg @ Value::Expression(_)) => Value::Expression(turned(turn_deg, course_deg).into()),
            (_, Value::Constant(turn_deg)) => Value::Constant(normalise_360(course_deg + turn_deg)),
        }
    }
}

/// CEL source of an angle that is turned.
fn turned(turn_deg: &Value<f64>, angle_deg: f64) -> String {
    match turn_deg {
        Value::Constant(turn_deg) => number(turn_deg + angle_deg),
        Value::Expression(source) => format!("{source} + {}", number(angle_deg)),
    }
}

fn position_source(position: &Value<LatLon>) -> String {
    match position {
        Value::Constant(p) => format!("lat_lon({}, {})", number(p.lat_deg), number(p.lon_deg)),
        Value::Expression(source) => source.to_string(),
    }
}

/// A CEL double; negative ones in brackets.
fn number(x: f64) -> String {
    if x < 0.0 { format!("(-{:?})", -x) } else { format!("{x:?}") }
}
