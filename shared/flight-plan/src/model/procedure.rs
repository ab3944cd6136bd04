//! Named, parameterised fragments of legs.

use super::{Id, Leg, Place, Value};
use geometry::LatLon;
use std::sync::Arc;

/// A fragment that can be called at any place, in any direction, with arguments.
///
/// Its positions are written where they are for its own reference point and bearing; a call moves and turns them. That is so
/// for constants: what a fix or an expression gives is where it is, and does not move (see [`crate::procedure`]).
#[derive(Debug, Clone, PartialEq)]
pub struct Procedure {
    /// Its identifier.
    pub id: Id,
    /// What people call it.
    pub name: String,
    /// Names that its expressions may read beside the plan's variables.
    pub parameters: Vec<Parameter>,
    /// The point that is moved to a call's anchor; `None`: the procedure can't be moved.
    pub reference: Option<LatLon>,
    /// The direction that is turned to a call's bearing, degrees true.
    pub bearing_deg: f64,
    /// Its legs, in order.
    pub legs: Vec<Arc<Leg>>,
}

/// A parameter of a procedure.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name, an identifier of the expression language.
    pub name: Id,
    /// CEL source of its value when a call gives none; `None`: a call must give one. Its type is the parameter's.
    pub default: Option<Arc<str>>,
}

/// A call of a procedure. Flown, it is its legs, whose identifiers are `call.leg`.
#[derive(Debug, Clone, PartialEq)]
pub struct Call {
    /// The procedure.
    pub procedure: Id,
    /// Parameter names and the CEL sources of their values.
    pub arguments: Vec<(Id, Arc<str>)>,
    /// Where the procedure's reference point is moved to; `None`: not moved.
    pub anchor: Option<Place>,
    /// What its bearing is turned to, degrees true; `None`: not turned.
    pub bearing_deg: Option<Value<f64>>,
}
