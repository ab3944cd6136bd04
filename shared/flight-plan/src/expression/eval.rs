//! Values of expressions.

use super::{Expression, FlightName, Function, Node, Operator, Type};
use crate::{Id, Runway, VariableValue, Variables};
use geometry::{LatLon, LocalFrame, Polygon};
use std::cmp::Ordering;

/// What expressions can know about the flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlightState {
    /// `iteration`: the pass being flown of the innermost loop, from 1; 0 outside loops.
    pub iteration: i64,
    /// `time`: seconds since the start of the flight.
    pub time_s: f64,
    /// `altitude`: metres AMSL.
    pub altitude_amsl_m: f64,
    /// `airspeed`: m/s.
    pub airspeed_mps: f64,
    /// `battery`: share left, 0..1.
    pub battery: f64,
    /// `fuel`: share left, 0..1; of an aircraft without a tank that of its battery.
    pub fuel: f64,
    /// `wind`: its speed, m/s.
    pub wind_mps: f64,
    /// `position`: the aircraft's.
    pub position: LatLon,
}

impl FlightState {
    /// Before a plan's flight: on its [`home`](crate::FlightPlan::home), at 0, 0 without one, and in the first pass of any loop.
    pub fn at_start(home: Option<&Runway>) -> Self {
        let home = home.map_or(LatLon::new(0.0, 0.0), |runway| runway.threshold);
        Self { iteration: 1, ..Self::on_ground(home) }
    }

    /// Before the flight: standing at `position`, everything full.
    pub fn on_ground(position: LatLon) -> Self {
        Self {
            iteration: 0,
            time_s: 0.0,
            altitude_amsl_m: 0.0,
            airspeed_mps: 0.0,
            battery: 1.0,
            fuel: 1.0,
            wind_mps: 0.0,
            position,
        }
    }
}

/// Everything an expression is evaluated over.
#[derive(Debug, Clone, Copy)]
pub struct Env<'a> {
    /// The plan's variables, with their present values.
    pub variables: &'a Variables,
    /// The flight.
    pub flight: FlightState,
}

/// Why an expression has no value now.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EvalError {
    /// A division or remainder by zero.
    #[error("division by zero: guard it with a condition, as in `x != 0.0 ? 1.0 / x : 0.0`")]
    DivisionByZero,
    /// A whole number too large for 64 bits.
    #[error("integer overflow: use doubles for large numbers")]
    Overflow,
    /// The result is infinite or not a number.
    #[error("the result is not a finite number: check the bounds of the variables")]
    NotFinite,
    /// The result is no position on Earth.
    #[error("the result is not a valid position: check the variables it is made of")]
    NotAPosition,
    /// A polygon is not simple, or too large to be measured.
    #[error("this is not a simple polygon of some kilometres: check the variable that it is")]
    NotAPolygon,
    /// A variable has no value, or one of another type: the variables are not this plan's.
    #[error("variable `{0}` has no value of its declared type: initialise the variables from this plan")]
    Variable(Id),
    /// The expression is not part of the program, or has another type than asked for.
    #[error("`{0}` is not an expression of this plan with the wanted type")]
    NotCompiled(String),
}

/// A value while evaluating; text is borrowed unless it was joined.
#[derive(Debug, Clone, PartialEq)]
enum Scalar<'a> {
    Bool(bool),
    Int(i64),
    Number(f64),
    Text(std::borrow::Cow<'a, str>),
    Position(LatLon),
    Polygon(&'a [LatLon]),
}

impl Expression {
    /// The value of a condition.
    pub fn bool(&self, env: &Env) -> Result<bool, EvalError> {
        match eval(&self.node, env)? {
            Scalar::Bool(b) => Ok(b),
            _ => Err(EvalError::NotCompiled("condition".into())),
        }
    }

    /// The value of a number; finite.
    pub fn number(&self, env: &Env) -> Result<f64, EvalError> {
        let value = number(eval(&self.node, env)?)?;
        if value.is_finite() { Ok(value) } else { Err(EvalError::NotFinite) }
    }

    /// The value of a position; valid.
    pub fn position(&self, env: &Env) -> Result<LatLon, EvalError> {
        let value = position(eval(&self.node, env)?)?;
        if value.is_valid() { Ok(value) } else { Err(EvalError::NotAPosition) }
    }

    /// The corners of a polygon.
    pub fn polygon(&self, env: &Env) -> Result<Vec<LatLon>, EvalError> {
        match eval(&self.node, env)? {
            Scalar::Polygon(corners) => Ok(corners.to_vec()),
            _ => Err(mismatch("polygon")),
        }
    }

    /// Its value, of any type; an int as a number.
    pub fn value(&self, env: &Env) -> Result<VariableValue, EvalError> {
        Ok(match eval(&self.node, env)? {
            Scalar::Bool(b) => VariableValue::Bool(b),
            Scalar::Text(text) => VariableValue::Text(text.into_owned()),
            Scalar::Polygon(corners) => VariableValue::Polygon(corners.to_vec()),
            Scalar::Position(_) => VariableValue::Position(self.position(env)?),
            Scalar::Int(_) | Scalar::Number(_) => VariableValue::Number(self.number(env)?),
        })
    }

    /// It can be used where `wanted` is asked for (an int where a number is).
    pub fn gives(&self, wanted: Type) -> bool {
        self.kind == wanted || (self.kind == Type::Int && wanted == Type::Number)
    }
}

fn eval<'a>(node: &'a Node, env: &Env<'a>) -> Result<Scalar<'a>, EvalError> {
    Ok(match node {
        Node::Bool(b) => Scalar::Bool(*b),
        Node::Int(i) => Scalar::Int(*i),
        Node::Number(x) => Scalar::Number(*x),
        Node::Text(t) => Scalar::Text(t.as_ref().into()),
        Node::Position(p) => Scalar::Position(*p),
        Node::Variable(name) => variable(name, env)?,
        Node::Flight(name) => flight(*name, &env.flight),
        Node::Not(a) => Scalar::Bool(!truth(a, env)?),
        Node::Negate(a) => match eval(a, env)? {
            Scalar::Int(i) => Scalar::Int(i.checked_neg().ok_or(EvalError::Overflow)?),
            other => Scalar::Number(-number(other)?),
        },
        Node::And(a, b) => Scalar::Bool(absorbing(a, b, env, false)?),
        Node::Or(a, b) => Scalar::Bool(absorbing(a, b, env, true)?),
        Node::Choose(c, a, b) => eval(if truth(c, env)? { a } else { b }, env)?,
        Node::Binary(operator, a, b) => binary(*operator, eval(a, env)?, eval(b, env)?)?,
        Node::Call(function, arguments) => call(*function, arguments, env)?,
    })
}

/// `&&` (absorbing false) and `||` (absorbing true): as in CEL, either side decides alone,
/// even if the other one fails.
fn absorbing(a: &Node, b: &Node, env: &Env, absorbing: bool) -> Result<bool, EvalError> {
    match (truth(a, env), || truth(b, env)) {
        (Ok(left), _) if left == absorbing => Ok(absorbing),
        (Ok(_), right) => right(),
        (Err(error), right) => match right() {
            Ok(right) if right == absorbing => Ok(absorbing),
            _ => Err(error),
        },
    }
}

fn variable<'a>(name: &Id, env: &Env<'a>) -> Result<Scalar<'a>, EvalError> {
    Ok(match env.variables.get(name).ok_or_else(|| EvalError::Variable(name.clone()))? {
        VariableValue::Bool(b) => Scalar::Bool(*b),
        VariableValue::Number(x) => Scalar::Number(*x),
        VariableValue::Text(t) => Scalar::Text(t.as_str().into()),
        VariableValue::Position(p) => Scalar::Position(*p),
        VariableValue::Polygon(corners) => Scalar::Polygon(corners),
    })
}

fn flight(name: FlightName, flight: &FlightState) -> Scalar<'static> {
    match name {
        FlightName::Iteration => Scalar::Int(flight.iteration),
        FlightName::Time => Scalar::Number(flight.time_s),
        FlightName::Altitude => Scalar::Number(flight.altitude_amsl_m),
        FlightName::Airspeed => Scalar::Number(flight.airspeed_mps),
        FlightName::Battery => Scalar::Number(flight.battery),
        FlightName::Fuel => Scalar::Number(flight.fuel),
        FlightName::Wind => Scalar::Number(flight.wind_mps),
        FlightName::Position => Scalar::Position(flight.position),
    }
}

/// The checker has seen to the types; these only fail when variables of another plan are given.
fn mismatch(wanted: &str) -> EvalError {
    EvalError::NotCompiled(wanted.into())
}

fn truth(node: &Node, env: &Env) -> Result<bool, EvalError> {
    match eval(node, env)? {
        Scalar::Bool(b) => Ok(b),
        _ => Err(mismatch("condition")),
    }
}

fn number(value: Scalar) -> Result<f64, EvalError> {
    match value {
        Scalar::Int(i) => Ok(i as f64),
        Scalar::Number(x) => Ok(x),
        _ => Err(mismatch("number")),
    }
}

fn position(value: Scalar) -> Result<LatLon, EvalError> {
    match value {
        Scalar::Position(p) => Ok(p),
        _ => Err(mismatch("position")),
    }
}

fn binary<'a>(operator: Operator, a: Scalar<'a>, b: Scalar<'a>) -> Result<Scalar<'a>, EvalError> {
    use Operator as O;
    Ok(match operator {
        O::Equal => Scalar::Bool(equal(&a, &b)),
        O::NotEqual => Scalar::Bool(!equal(&a, &b)),
        O::Less => Scalar::Bool(order(&a, &b)?.is_some_and(Ordering::is_lt)),
        O::LessOrEqual => Scalar::Bool(order(&a, &b)?.is_some_and(Ordering::is_le)),
        O::Greater => Scalar::Bool(order(&a, &b)?.is_some_and(Ordering::is_gt)),
        O::GreaterOrEqual => Scalar::Bool(order(&a, &b)?.is_some_and(Ordering::is_ge)),
        O::Add | O::Subtract | O::Multiply | O::Divide | O::Remainder => match (a, b) {
            (Scalar::Int(a), Scalar::Int(b)) => Scalar::Int(integer(operator, a, b)?),
            (Scalar::Text(a), Scalar::Text(b)) => Scalar::Text((a.into_owned() + &b).into()),
            (a, b) => Scalar::Number(real(operator, number(a)?, number(b)?)?),
        },
    })
}

fn integer(operator: Operator, a: i64, b: i64) -> Result<i64, EvalError> {
    let divides = matches!(operator, Operator::Divide | Operator::Remainder);
    if divides && b == 0 {
        return Err(EvalError::DivisionByZero);
    }
    match operator {
        Operator::Add => a.checked_add(b),
        Operator::Subtract => a.checked_sub(b),
        Operator::Multiply => a.checked_mul(b),
        Operator::Divide => a.checked_div(b),
        _ => a.checked_rem(b),
    }
    .ok_or(EvalError::Overflow)
}

/// Unlike in CEL, doubles too have no value where whole numbers have none: a condition must not hold by an infinity.
fn real(operator: Operator, a: f64, b: f64) -> Result<f64, EvalError> {
    let value = match operator {
        Operator::Add => a + b,
        Operator::Subtract => a - b,
        Operator::Multiply => a * b,
        Operator::Divide if b == 0.0 => return Err(EvalError::DivisionByZero),
        Operator::Divide => a / b,
        _ => return Err(mismatch("whole number")),
    };
    Some(value).filter(|value| value.is_finite()).ok_or(EvalError::NotFinite)
}

fn equal(a: &Scalar, b: &Scalar) -> bool {
    match order(a, b) {
        Ok(order) => order == Some(Ordering::Equal),
        Err(_) => a == b,
    }
}

/// Numbers by size, int and double together; text by code points.
fn order(a: &Scalar, b: &Scalar) -> Result<Option<Ordering>, EvalError> {
    match (a, b) {
        (Scalar::Int(a), Scalar::Int(b)) => Ok(Some(a.cmp(b))),
        (Scalar::Text(a), Scalar::Text(b)) => Ok(Some(a.cmp(b))),
        _ => Ok(number(a.clone())?.partial_cmp(&number(b.clone())?)),
    }
}

fn call<'a>(function: Function, arguments: &'a [Node], env: &Env<'a>) -> Result<Scalar<'a>, EvalError> {
    let argument = |i: usize| eval(arguments.get(i).ok_or_else(|| mismatch("function"))?, env);
    let real = |i| number(argument(i)?);
    let place = |i| position(argument(i)?);
    Ok(match function {
        Function::Double => Scalar::Number(real(0)?),
        Function::Abs => Scalar::Number(real(0)?.abs()),
        Function::Min => Scalar::Number(real(0)?.min(real(1)?)),
        Function::Max => Scalar::Number(real(0)?.max(real(1)?)),
        Function::Distance => Scalar::Number(distance_m(place(0)?, place(1)?)?),
        Function::Offset => Scalar::Position(offset(place(0)?, real(1)?, real(2)?)?),
        Function::LatLon => Scalar::Position(LatLon::new(real(0)?, real(1)?)),
        Function::Area => Scalar::Number(Outline::of(argument(0)?)?.polygon.area_m2()),
        Function::Centre => {
            let outline = Outline::of(argument(0)?)?;
            Scalar::Position(outline.frame.to_geo(outline.polygon.centroid()))
        }
        Function::Inside => Scalar::Bool(Outline::of(argument(0)?)?.contains(place(1)?)?),
        Function::Contains | Function::StartsWith | Function::EndsWith => {
            match (argument(0)?, argument(1)?) {
                (Scalar::Text(a), Scalar::Text(b)) => Scalar::Bool(match function {
                    Function::Contains => a.contains(b.as_ref()),
                    Function::StartsWith => a.starts_with(b.as_ref()),
                    _ => a.ends_with(b.as_ref()),
                }),
                _ => return Err(mismatch("text")),
            }
        }
    })
}

/// A polygon in its own plane.
struct Outline {
    frame: LocalFrame,
    polygon: Polygon,
}

impl Outline {
    fn of(value: Scalar) -> Result<Self, EvalError> {
        let Scalar::Polygon(corners) = value else { return Err(mismatch("polygon")) };
        let frame = LocalFrame::around(corners).ok_or(EvalError::NotAPolygon)?;
        let polygon = Polygon::from_geo(&frame, corners, &[]).map_err(|_| EvalError::NotAPolygon)?;
        Ok(Self { frame, polygon })
    }

    fn contains(&self, p: LatLon) -> Result<bool, EvalError> {
        // beyond the frame's radius, where it would not be exact, there is nothing of the polygon
        let near = distance_m(self.frame.origin(), p)? <= self.frame.radius_m();
        Ok(near && self.polygon.contains(self.frame.to_local(p)))
    }
}

fn distance_m(a: LatLon, b: LatLon) -> Result<f64, EvalError> {
    if a.is_valid() && b.is_valid() { Ok(a.distance_m(b)) } else { Err(EvalError::NotAPosition) }
}

fn offset(from: LatLon, bearing_deg: f64, distance_m: f64) -> Result<LatLon, EvalError> {
    /// Half the Earth's circumference: nothing is farther.
    const FARTHEST_M: f64 = 2.1e7;
    let finite = bearing_deg.is_finite() && distance_m.abs() <= FARTHEST_M;
    if from.is_valid() && finite {
        Ok(from.destination(bearing_deg, distance_m))
    } else {
        Err(EvalError::NotAPosition)
    }
}
