//! What a comparison comes to whatever the flight: between which numbers its sides can be.

use super::{Expression, FlightName, Function, Node, Operator};
use crate::Id;

/// The least and the greatest value that something can have.
pub type Range = (f64, f64);

/// Nothing is known of it.
const ANY: Range = (f64::NEG_INFINITY, f64::INFINITY);
/// Altitudes at which anything is flown, metres AMSL.
const ALTITUDES_M: Range = (-500.0, 12_000.0);
/// Half the way round the Earth and a little more, metres.
const FARTHEST_M: f64 = 20_100_000.0;

/// A comparison of something that changes, whose outcome doesn't.
#[derive(Debug, Clone, PartialEq)]
pub struct Decided {
    /// It always holds; else it never does.
    pub holds: bool,
    /// What is compared, if that is a name alone, and between which values it is.
    pub name: Option<(String, Range)>,
    /// The number that a name alone is compared with.
    pub number: Option<f64>,
}

impl Expression {
    /// The first comparison of numbers that reads something and is decided all the same. `bounds`: those of the plan's variables.
    pub fn decided(&self, bounds: &dyn Fn(&Id) -> Range) -> Option<Decided> {
        decided(&self.node, bounds)
    }
}

fn decided(node: &Node, bounds: &dyn Fn(&Id) -> Range) -> Option<Decided> {
    match node {
        Node::Not(a) => decided(a, bounds),
        Node::And(a, b) | Node::Or(a, b) => decided(a, bounds).or_else(|| decided(b, bounds)),
        Node::Choose(a, b, c) => [a, b, c].iter().find_map(|node| decided(node, bounds)),
        Node::Binary(operator, a, b) if is_read(a) || is_read(b) => {
            let (left, right) = (range(a, bounds), range(b, bounds));
            let holds = outcome(*operator, left, right)?;
            let (name, other) = match (name_of(a), name_of(b)) {
                (Some(name), _) => (Some((name, left)), right),
                (None, Some(name)) => (Some((name, right)), left),
                (None, None) => (None, ANY),
            };
            let number = (other.0 == other.1).then_some(other.0);
            Some(Decided { holds, name, number })
        }
        _ => None,
    }
}

/// It reads a variable or the flight.
fn is_read(node: &Node) -> bool {
    match node {
        Node::Variable(_) => true,
        Node::Negate(a) => is_read(a),
        Node::Binary(_, a, b) => is_read(a) || is_read(b),
        Node::Call(_, arguments) => arguments.iter().any(is_read),
        other => other.reads(|_| true),
    }
}

fn name_of(node: &Node) -> Option<String> {
    match node {
        Node::Variable(id) => Some(id.to_string()),
        Node::Flight(flight) => {
            let mut all = FlightName::ALL.iter();
            all.find(|(_, name, ..)| name == flight).map(|(word, ..)| (*word).to_owned())
        }
        Node::Call(Function::Double, arguments) => arguments.first().and_then(name_of),
        _ => None,
    }
}

fn outcome(operator: Operator, a: Range, b: Range) -> Option<bool> {
    let less = |a: Range, b: Range| match () {
        () if a.1 < b.0 => Some(true),
        () if a.0 >= b.1 => Some(false),
        () => None,
    };
    let apart = a.1 < b.0 || b.1 < a.0;
    match operator {
        Operator::Less => less(a, b),
        Operator::Greater => less(b, a),
        Operator::LessOrEqual => less(b, a).map(|greater| !greater),
        Operator::GreaterOrEqual => less(a, b).map(|less| !less),
        Operator::Equal => apart.then_some(false),
        Operator::NotEqual => apart.then_some(true),
        _ => None,
    }
}

fn range(node: &Node, bounds: &dyn Fn(&Id) -> Range) -> Range {
    match node {
        Node::Number(x) => (*x, *x),
        Node::Int(i) => (*i as f64, *i as f64),
        Node::Variable(id) => bounds(id),
        Node::Flight(name) => flight_range(*name),
        Node::Negate(a) => {
            let (low, high) = range(a, bounds);
            (-high, -low)
        }
        Node::Binary(operator, a, b) => combined(*operator, range(a, bounds), range(b, bounds)),
        Node::Call(function, arguments) => {
            let ranges: Vec<Range> = arguments.iter().map(|node| range(node, bounds)).collect();
            of_function(*function, &ranges)
        }
        _ => ANY,
    }
}

fn flight_range(name: FlightName) -> Range {
    match name {
        FlightName::Battery | FlightName::Fuel => (0.0, 1.0),
        FlightName::Altitude => ALTITUDES_M,
        FlightName::Iteration | FlightName::Time | FlightName::Airspeed | FlightName::Wind => {
            (0.0, f64::INFINITY)
        }
        FlightName::Position => ANY,
    }
}

fn combined(operator: Operator, a: Range, b: Range) -> Range {
    let (low, high) = match operator {
        Operator::Add => (a.0 + b.0, a.1 + b.1),
        Operator::Subtract => (a.0 - b.1, a.1 - b.0),
        _ => ANY,
    };
    // infinities that cancel out
    if low.is_nan() || high.is_nan() { ANY } else { (low, high) }
}

fn of_function(function: Function, arguments: &[Range]) -> Range {
    match (function, arguments) {
        (Function::Double, [a]) => *a,
        (Function::Abs, [a]) if a.0 >= 0.0 => *a,
        (Function::Abs, [a]) => ((-a.1).max(0.0), a.1.max(-a.0)),
        (Function::Min, [a, b]) => (a.0.min(b.0), a.1.min(b.1)),
        (Function::Max, [a, b]) => (a.0.max(b.0), a.1.max(b.1)),
        (Function::Distance, _) => (0.0, FARTHEST_M),
        (Function::Area, _) => (0.0, f64::INFINITY),
        _ => ANY,
    }
}
