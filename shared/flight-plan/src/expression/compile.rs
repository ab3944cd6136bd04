//! From CEL source to a checked tree.

use super::{Expression, ExpressionError, FlightName, Function, Node, Operator, Type, doubles};
use crate::suggest::{did_you_mean, meant, question};
use crate::{FlightPlan, Id, Variable, VariableValue};
use cel::common::ast::{CallExpr, Expr, IdedExpr, LiteralValue, SourceInfo, operators};
use cel::parser::Parser;
use foldhash::HashMap;
use geometry::LatLon;

/// Longest expression, bytes.
pub const MAX_LENGTH: usize = 1000;
/// Deepest nesting, both of brackets and of the tree.
pub const MAX_DEPTH: usize = 48;

/// The names of a plan, looked up at once however many there are.
#[derive(Debug)]
pub struct Names<'a> {
    variables: HashMap<&'a str, &'a Variable>,
    fixes: HashMap<&'a str, LatLon>,
}

impl<'a> Names<'a> {
    /// The names of a plan.
    pub fn of(plan: &'a FlightPlan) -> Self {
        Self {
            variables: plan.variables.iter().map(|v| (v.name.as_str(), v)).collect(),
            fixes: plan.fixes.iter().map(|f| (f.id.as_str(), f.position)).collect(),
        }
    }

    /// With other variables besides, which hide the plan's.
    pub(crate) fn and(mut self, more: &'a [Variable]) -> Self {
        self.variables.extend(more.iter().map(|v| (v.name.as_str(), v)));
        self
    }
}

/// Parses and type-checks `source` over a plan's fixes and variables.
///
/// # Errors
/// What is wrong with it, and where.
pub fn compile(source: &str, plan: &FlightPlan) -> Result<Expression, ExpressionError> {
    compile_with(source, &Names::of(plan))
}

/// As [`compile`], for many expressions of one plan.
///
/// # Errors
/// As [`compile`].
pub fn compile_with(source: &str, names: &Names) -> Result<Expression, ExpressionError> {
    let at_start = |code, message: String| ExpressionError {
        code,
        column: 1,
        source_text: shorten(source),
        message,
        correction: None,
        undeclared_flag: None,
    };
    if source.len() > MAX_LENGTH || bracket_depth(source) > MAX_DEPTH {
        return Err(at_start(
            "expression-too-large",
            format!(
                "simplify this expression: at most {MAX_LENGTH} bytes and {MAX_DEPTH} nested brackets are allowed"
            ),
        ));
    }
    if source.trim().is_empty() {
        return Err(at_start("expression-syntax", "write an expression here".into()));
    }
    let (tree, places) = Parser::new()
        .max_recursion_depth(2 * MAX_DEPTH as u16)
        .parse_with_source_info(source)
        .map_err(|errors| syntax_error(source, errors))?;
    let mut checker = Checker { names, source, places, variables: Vec::new(), fixes: Vec::new() };
    let (node, kind) = checker.check(&tree, 0)?;
    Ok(Expression { kind, variables: checker.variables, fixes: checker.fixes, node })
}

/// For messages: long sources are cut.
fn shorten(source: &str) -> String {
    if source.chars().count() <= 80 {
        source.into()
    } else {
        source.chars().take(79).chain(['…']).collect()
    }
}

/// Deepest nesting of brackets, also unbalanced ones (the parser sees those as well).
fn bracket_depth(source: &str) -> usize {
    let (mut depth, mut deepest) = (0_usize, 0);
    for byte in source.bytes() {
        match byte {
            b'(' | b'[' | b'{' | b'?' | b'!' | b'-' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        deepest = deepest.max(depth);
    }
    deepest
}

/// The parser's first complaint, as ours.
fn syntax_error(source: &str, errors: cel::ParseErrors) -> ExpressionError {
    let first = errors.errors.first();
    let column = first.map_or(1, |e| e.pos.1.max(1).unsigned_abs());
    let complaint =
        first.map_or_else(|| "not an expression".into(), |e| e.msg.lines().next().unwrap_or("").to_owned());
    ExpressionError {
        code: "expression-syntax",
        column,
        source_text: shorten(source),
        message: format!("this is not a CEL expression, correct it: {complaint}"),
        correction: None,
        undeclared_flag: None,
    }
}

type Checked = Result<(Node, Type), ExpressionError>;

/// Walks the parser's tree; knows the plan's names.
struct Checker<'a> {
    names: &'a Names<'a>,
    source: &'a str,
    places: SourceInfo,
    variables: Vec<Id>,
    fixes: Vec<Id>,
}

impl Checker<'_> {
    fn error(&self, at: &IdedExpr, code: &'static str, message: impl Into<String>) -> ExpressionError {
        let offset = self.places.offset_for(at.id).map_or(0, |(start, _)| start as usize);
        ExpressionError {
            code,
            column: offset + 1,
            source_text: shorten(self.source),
            message: message.into(),
            correction: None,
            undeclared_flag: None,
        }
    }

    fn wrong_type(&self, at: &IdedExpr, wanted: &str, found: Type) -> ExpressionError {
        self.error(at, "wrong-type", format!("{wanted} is needed here, not {found}"))
    }

    fn check(&mut self, at: &IdedExpr, depth: usize) -> Checked {
        if depth > 4 * MAX_DEPTH {
            return Err(self.error(
                at,
                "expression-too-large",
                "simplify this expression: it nests too deeply",
            ));
        }
        match &at.expr {
            Expr::Literal(literal) => self.literal(at, literal),
            Expr::Ident(name) => self.name(at, name),
            Expr::Call(call) => self.call(at, call, depth + 1),
            _ => Err(self.error(
                at,
                "expression-syntax",
                "use only numbers, text, names, operators and functions: lists, maps, fields and macros are not part of plan expressions",
            )),
        }
    }

    fn literal(&self, at: &IdedExpr, literal: &LiteralValue) -> Checked {
        Ok(match literal {
            LiteralValue::Boolean(b) => (Node::Bool(*b.inner()), Type::Bool),
            LiteralValue::Int(i) => (Node::Int(*i.inner()), Type::Int),
            LiteralValue::Double(d) => (Node::Number(*d.inner()), Type::Number),
            LiteralValue::String(s) => (Node::Text(s.inner().into()), Type::Text),
            LiteralValue::UInt(_) | LiteralValue::Bytes(_) | LiteralValue::Null => {
                return Err(self.error(
                    at,
                    "wrong-type",
                    "write this as a number (5 or 5.0), text or true/false",
                ));
            }
        })
    }

    fn name(&mut self, at: &IdedExpr, name: &str) -> Checked {
        if let Some((_, flight, kind, _)) = FlightName::ALL.iter().find(|(n, ..)| *n == name) {
            return Ok((Node::Flight(*flight), *kind));
        }
        let Some(variable) = self.names.variables.get(name) else {
            let meant = self.name_meant(name);
            let asked = meant.map_or_else(String::new, question);
            let message = format!("declare the variable `{name}` or correct its name{asked}");
            let correction = meant.map(|meant| Box::new((Id::new(name), Id::new(meant))));
            return Err(ExpressionError { correction, ..self.error(at, "unknown-name", message) });
        };
        let kind = match variable.initial {
            VariableValue::Bool(_) => Type::Bool,
            VariableValue::Number(_) => Type::Number,
            VariableValue::Text(_) => Type::Text,
            VariableValue::Position(_) => Type::Position,
            VariableValue::Polygon(_) => Type::Polygon,
        };
        if !self.variables.contains(&variable.name) {
            self.variables.push(variable.name.clone());
        }
        Ok((Node::Variable(variable.name.clone()), kind))
    }

    /// What a name that nobody knows was probably meant to be.
    fn name_meant(&self, name: &str) -> Option<&str> {
        let of_flight = super::flight_names().map(|(known, _)| known);
        meant(name, self.names.variables.keys().copied().chain(of_flight))
    }

    fn call(&mut self, at: &IdedExpr, call: &CallExpr, depth: usize) -> Checked {
        let name = call.func_name.as_str();
        // `t.contains(u)` is checked as `contains(t, u)`
        let arguments: Vec<&IdedExpr> = call.target.as_deref().into_iter().chain(&call.args).collect();
        if let Some(operator) = binary_operator(name) {
            return self.binary(at, operator, &arguments, depth);
        }
        match (name, arguments.as_slice()) {
            (operators::LOGICAL_NOT, [a]) => Ok((Node::Not(self.bool(a, depth)?), Type::Bool)),
            (operators::NEGATE, [a]) => {
                let (node, kind) = self.numeric(a, depth)?;
                Ok((Node::Negate(node.into()), kind))
            }
            (operators::LOGICAL_AND, [a, b]) => {
                Ok((Node::And(self.bool(a, depth)?, self.bool(b, depth)?), Type::Bool))
            }
            (operators::LOGICAL_OR, [a, b]) => {
                Ok((Node::Or(self.bool(a, depth)?, self.bool(b, depth)?), Type::Bool))
            }
            (operators::CONDITIONAL, [c, a, b]) => self.choose(c, a, b, depth),
            ("distance_to", [to]) => self.distance_to(to, depth),
            _ => self.function(at, name, &arguments, depth),
        }
    }

    fn bool(&mut self, at: &IdedExpr, depth: usize) -> Result<Box<Node>, ExpressionError> {
        self.expect(at, Type::Bool, depth).map_err(|error| match &at.expr {
            Expr::Ident(name) => error.of_flag(name),
            _ => error,
        })
    }

    fn expect(&mut self, at: &IdedExpr, wanted: Type, depth: usize) -> Result<Box<Node>, ExpressionError> {
        match self.check(at, depth)? {
            (node, kind) if kind == wanted => Ok(node.into()),
            // an int counts as a number where nothing is computed with it
            (node, Type::Int) if wanted == Type::Number => {
                Ok(Node::Call(Function::Double, vec![node]).into())
            }
            (_, kind) => Err(self.wrong_type(at, &wanted.to_string(), kind)),
        }
    }

    fn numeric(&mut self, at: &IdedExpr, depth: usize) -> Checked {
        match self.check(at, depth)? {
            checked @ (_, Type::Int | Type::Number) => Ok(checked),
            (_, kind) => Err(self.wrong_type(at, "a number", kind)),
        }
    }

    fn choose(&mut self, c: &IdedExpr, a: &IdedExpr, b: &IdedExpr, depth: usize) -> Checked {
        let condition = self.bool(c, depth)?;
        let (yes, kind) = self.check(a, depth)?;
        let (no, other) = self.check(b, depth)?;
        if kind != other {
            return Err(self.wrong_type(b, &format!("{kind}, as in the other branch,"), other));
        }
        Ok((Node::Choose(condition, yes.into(), no.into()), kind))
    }

    fn binary(
        &mut self,
        at: &IdedExpr,
        operator: Operator,
        arguments: &[&IdedExpr],
        depth: usize,
    ) -> Checked {
        let &[a, b] = arguments else {
            return Err(self.error(at, "expression-syntax", "this operator takes two operands"));
        };
        let (left, kind) = self.check(a, depth)?;
        let (right, other) = self.check(b, depth)?;
        let result = self.binary_type(at, operator, kind, other);
        let written = |error| doubles::corrected(error, self.source, operator, [(a, kind), (b, other)]);
        let result = result.map_err(written)?;
        Ok((Node::Binary(operator, left.into(), right.into()), result))
    }

    /// Which types an operator takes, as in CEL: no mixed arithmetic, `%` for int only, `+` for text too.
    fn binary_type(
        &self,
        at: &IdedExpr,
        operator: Operator,
        a: Type,
        b: Type,
    ) -> Result<Type, ExpressionError> {
        use {Operator as O, Type as T};
        let numbers = matches!((a, b), (T::Int | T::Number, T::Int | T::Number));
        let ordered = numbers || (a == b && a == T::Text);
        match operator {
            O::Equal | O::NotEqual if a == b || numbers => Ok(T::Bool),
            O::Less | O::LessOrEqual | O::Greater | O::GreaterOrEqual if ordered => Ok(T::Bool),
            O::Remainder if a == T::Int && b == T::Int => Ok(T::Int),
            O::Add | O::Subtract | O::Multiply | O::Divide if numbers && a == b => Ok(a),
            O::Add if a == T::Text && b == T::Text => Ok(T::Text),
            _ if numbers && a != b => Err(self.error(
                at,
                "wrong-type",
                "write both operands as doubles (200.0 instead of 200) or convert with double(…)",
            )),
            _ => Err(self.error(at, "wrong-type", format!("this operator can't be applied to {a} and {b}"))),
        }
    }

    /// `distance_to('COVE')` or `distance_to(position)`.
    fn distance_to(&mut self, to: &IdedExpr, depth: usize) -> Checked {
        let target = match &to.expr {
            Expr::Literal(LiteralValue::String(id)) => {
                let fix = self.names.fixes.get(id.inner());
                let unknown = || {
                    let name = id.inner();
                    let meant = did_you_mean(name, self.names.fixes.keys().copied());
                    let message = format!("there is no fix `{name}`: add it or correct its name{meant}");
                    self.error(to, "unknown-name", message)
                };
                let position = *fix.ok_or_else(unknown)?;
                self.fixes.push(Id::new(id.inner()));
                Node::Position(position)
            }
            _ => *self.expect(to, Type::Position, depth)?,
        };
        Ok((Node::Call(Function::Distance, vec![Node::Flight(FlightName::Position), target]), Type::Number))
    }

    fn function(&mut self, at: &IdedExpr, name: &str, arguments: &[&IdedExpr], depth: usize) -> Checked {
        use Type::{Bool, Number, Polygon, Position, Text};
        // the one name with two meanings: its argument decides
        let of_polygon = name == "contains" && self.is_polygon(arguments);
        let (function, parameters, result): (_, &[Type], _) = match name {
            "double" => (Function::Double, &[Number], Number),
            "abs" => (Function::Abs, &[Number], Number),
            "min" => (Function::Min, &[Number, Number], Number),
            "max" => (Function::Max, &[Number, Number], Number),
            "distance" => (Function::Distance, &[Position, Position], Number),
            "offset" => (Function::Offset, &[Position, Number, Number], Position),
            "lat_lon" => (Function::LatLon, &[Number, Number], Position),
            "area" => (Function::Area, &[Polygon], Number),
            "centre" => (Function::Centre, &[Polygon], Position),
            "contains" if of_polygon => (Function::Inside, &[Polygon, Position], Bool),
            "contains" => (Function::Contains, &[Text, Text], Bool),
            "startsWith" => (Function::StartsWith, &[Text, Text], Bool),
            "endsWith" => (Function::EndsWith, &[Text, Text], Bool),
            // how the parser calls the operator
            "@in" => {
                let message =
                    "`in` is not part of plan expressions: compare with each value, and join that with ||";
                return Err(self.error(at, "expression-syntax", message));
            }
            _ => {
                let meant = did_you_mean(name, super::functions().map(|(known, _)| known));
                let message = format!("there is no function `{name}`: correct its name{meant}");
                return Err(self.error(at, "unknown-name", message));
            }
        };
        if arguments.len() != parameters.len() {
            let message = format!("`{name}` takes {} arguments, not {}", parameters.len(), arguments.len());
            return Err(self.error(at, "wrong-type", message));
        }
        let mut nodes = Vec::with_capacity(arguments.len());
        for (argument, wanted) in arguments.iter().zip(parameters) {
            nodes.push(*self.expect(argument, *wanted, depth)?);
        }
        Ok((Node::Call(function, nodes), result))
    }

    /// The first argument is the name of a polygon.
    fn is_polygon(&self, arguments: &[&IdedExpr]) -> bool {
        let Some(Expr::Ident(name)) = arguments.first().map(|a| &a.expr) else { return false };
        let variable = self.names.variables.get(name.as_str());
        variable.is_some_and(|v| matches!(v.initial, VariableValue::Polygon(_)))
    }
}

fn binary_operator(name: &str) -> Option<Operator> {
    Some(match name {
        operators::ADD => Operator::Add,
        operators::SUBSTRACT => Operator::Subtract,
        operators::MULTIPLY => Operator::Multiply,
        operators::DIVIDE => Operator::Divide,
        operators::MODULO => Operator::Remainder,
        operators::EQUALS => Operator::Equal,
        operators::NOT_EQUALS => Operator::NotEqual,
        operators::LESS => Operator::Less,
        operators::LESS_EQUALS => Operator::LessOrEqual,
        operators::GREATER => Operator::Greater,
        operators::GREATER_EQUALS => Operator::GreaterOrEqual,
        _ => return None,
    })
}
