//! Conditions and expressions: a typed subset of the Common Expression Language.
//!
//! The `cel` crate parses; this module checks the types against the plan's names, resolves fixes, and keeps a
//! small tree that is evaluated without allocation surprises: bounded in size and depth, no loops, no side effects.
//! The subset: literals (bool, int, double, string), the plan's variables, the in-flight names, `! - + * / % == != < <= > >= && || ?:`,
//! `double(int)`, `abs(number)`, `min(a, b)`, `max(a, b)`, `distance_to(fix or position)`, `distance(p, q)`,
//! `offset(position, bearing_deg, distance_m)`, `lat_lon(latitude_deg, longitude_deg)`, of polygons
//! `area(polygon)` in m², `centre(polygon)` (of gravity) and `contains(polygon, position)`, and the text tests `contains`, `startsWith`, `endsWith`.
//! As in CEL, int and double compare with each other but do not mix in arithmetic.

mod compile;
mod doubles;
mod eval;
pub(crate) mod range;
mod tokens;

pub use compile::{MAX_DEPTH, MAX_LENGTH, Names, compile, compile_with};
pub use eval::{Env, EvalError, FlightState};
pub(crate) use tokens::{mentioned, substitute};

use crate::Id;
use geometry::LatLon;
use std::sync::Arc;

/// Type of an expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Type {
    /// True or false.
    Bool,
    /// A whole number (CEL `int`).
    Int,
    /// A number (CEL `double`).
    Number,
    /// Text.
    Text,
    /// A position.
    Position,
    /// A polygon.
    Polygon,
}

impl std::fmt::Display for Type {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Type::Bool => "a condition (bool)",
            Type::Int => "a whole number (int)",
            Type::Number => "a number (double)",
            Type::Text => "text",
            Type::Position => "a position",
            Type::Polygon => "a polygon",
        })
    }
}

/// What is wrong with an expression.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{message} (column {column} of `{source_text}`)")]
pub struct ExpressionError {
    /// `expression-syntax`, `unknown-name`, `wrong-type` or `expression-too-large`.
    pub code: &'static str,
    /// Column in the expression, characters from 1.
    pub column: usize,
    /// The expression.
    pub source_text: String,
    /// Says what to do.
    pub message: String,
    /// A name that nobody knows, and the one that was probably meant; or a whole number where a double is needed, and that one.
    pub correction: Option<Box<(Id, Id)>>,
    /// A name that nobody knows, where something is needed that is true or false.
    pub undeclared_flag: Option<Id>,
}

impl ExpressionError {
    /// The expression, or a part of it that has to be true or false, is this name.
    pub(crate) fn of_flag(self, name: &str) -> Self {
        let undeclared_flag =
            (self.code == "unknown-name" && self.correction.is_none()).then(|| Id::new(name));
        Self { undeclared_flag, ..self }
    }
}

/// A checked expression.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    /// Type of its value.
    pub kind: Type,
    /// Variables it reads, each once.
    pub variables: Vec<Id>,
    /// Fixes that it names, whose positions are in it.
    pub fixes: Vec<Id>,
    node: Node,
}

impl Expression {
    /// Its value depends on the flight: on time, energy, motion, wind or place (not on the iteration, which is the plan's).
    pub fn reads_flight(&self) -> bool {
        self.node.reads(|name| name != FlightName::Iteration)
    }

    /// Its value depends on the time of the flight.
    pub fn reads_time(&self) -> bool {
        self.node.reads(|name| name == FlightName::Time)
    }

    /// Its value is the same whenever it is asked for.
    pub fn is_constant(&self) -> bool {
        self.variables.is_empty() && !self.node.reads(|_| true)
    }
}

/// A name whose value the flight gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FlightName {
    Iteration,
    Time,
    Altitude,
    Airspeed,
    Battery,
    Fuel,
    Wind,
    Position,
}

impl FlightName {
    /// Every in-flight name with its meaning.
    const ALL: [(&'static str, FlightName, Type, &'static str); 8] = [
        ("iteration", FlightName::Iteration, Type::Int, "the pass of the innermost loop, from 1"),
        ("time", FlightName::Time, Type::Number, "seconds since the start"),
        ("altitude", FlightName::Altitude, Type::Number, "metres above mean sea level"),
        ("airspeed", FlightName::Airspeed, Type::Number, "m/s"),
        ("battery", FlightName::Battery, Type::Number, "the share that is left, 0 to 1"),
        ("fuel", FlightName::Fuel, Type::Number, "the share that is left, 0 to 1"),
        ("wind", FlightName::Wind, Type::Number, "m/s"),
        ("position", FlightName::Position, Type::Position, "the aircraft's"),
    ];
}

/// The functions, with what they give.
const FUNCTIONS: [(&str, &str); 13] = [
    ("double", "a whole number as a double"),
    ("abs", "a number without its sign"),
    ("min", "the smaller of two numbers"),
    ("max", "the greater of two numbers"),
    ("distance", "metres between two positions"),
    ("distance_to", "metres from the aircraft to a fix or position"),
    ("offset", "a position: from one, by a bearing and metres"),
    ("lat_lon", "a position: latitude and longitude"),
    ("area", "square metres of a polygon"),
    ("centre", "the middle of a polygon"),
    ("contains", "a polygon has a position inside, a text another one"),
    ("startsWith", "a text begins with another one"),
    ("endsWith", "a text ends with another one"),
];

/// The names that every expression may read, with what they mean.
pub(crate) fn flight_names() -> impl Iterator<Item = (&'static str, &'static str)> {
    FlightName::ALL.iter().map(|(name, _, _, meaning)| (*name, *meaning))
}

/// The functions, with what they give.
pub(crate) fn functions() -> impl Iterator<Item = (&'static str, &'static str)> {
    FUNCTIONS.into_iter()
}

/// True for names that a variable or parameter can have.
pub fn is_variable_name(name: &str) -> bool {
    let word = name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    word && !name.is_empty() && !name.starts_with(|c: char| c.is_ascii_digit()) && !is_reserved(name)
}

/// True for names that a variable can't have because the language has them.
pub fn is_reserved(name: &str) -> bool {
    /// CEL's keywords and reserved words.
    const WORDS: [&str; 22] = [
        "true",
        "false",
        "null",
        "in",
        "as",
        "break",
        "const",
        "continue",
        "else",
        "for",
        "function",
        "if",
        "import",
        "let",
        "loop",
        "package",
        "namespace",
        "return",
        "var",
        "void",
        "while",
        "int",
    ];
    WORDS.contains(&name)
        || FUNCTIONS.iter().any(|(n, _)| *n == name)
        || FlightName::ALL.iter().any(|(n, ..)| *n == name)
}

/// Arithmetic and comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

/// Functions of numbers, positions, polygons and text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Function {
    Double,
    Abs,
    Min,
    Max,
    Distance,
    Offset,
    LatLon,
    Area,
    Centre,
    Inside,
    Contains,
    StartsWith,
    EndsWith,
}

/// A checked tree.
#[derive(Debug, Clone, PartialEq)]
enum Node {
    Bool(bool),
    Int(i64),
    Number(f64),
    Text(Arc<str>),
    Position(LatLon),
    Variable(Id),
    Flight(FlightName),
    Not(Box<Node>),
    Negate(Box<Node>),
    And(Box<Node>, Box<Node>),
    Or(Box<Node>, Box<Node>),
    Choose(Box<Node>, Box<Node>, Box<Node>),
    Binary(Operator, Box<Node>, Box<Node>),
    Call(Function, Vec<Node>),
}

impl Node {
    fn reads(&self, wanted: fn(FlightName) -> bool) -> bool {
        match self {
            Node::Flight(name) => wanted(*name),
            Node::Bool(_) | Node::Int(_) | Node::Number(_) | Node::Text(_) => false,
            Node::Position(_) | Node::Variable(_) => false,
            Node::Not(a) | Node::Negate(a) => a.reads(wanted),
            Node::And(a, b) | Node::Or(a, b) | Node::Binary(_, a, b) => a.reads(wanted) || b.reads(wanted),
            Node::Choose(a, b, c) => [a, b, c].iter().any(|node| node.reads(wanted)),
            Node::Call(_, arguments) => arguments.iter().any(|node| node.reads(wanted)),
        }
    }
}

#[cfg(test)]
mod tests;
