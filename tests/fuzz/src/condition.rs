//! Conditions and numbers in CEL.

use flight_plan::expression::{MAX_LENGTH, Type, compile};
use flight_plan::{
    Env, EvalError, Expression, Fix, FlightPlan, FlightState, Id, Variable, VariableValue, Variables,
};
use geometry::LatLon;

const HERE: LatLon = LatLon::new(36.3, -84.2);

/// Any text as an expression: parsed, type-checked, evaluated. Its value has the type that was found, and is the one
/// that the `cel` crate's own interpreter finds.
///
/// # Panics
/// A value of another type, or another value than the interpreter's.
pub fn cel(bytes: &[u8]) {
    let Ok(source) = std::str::from_utf8(bytes) else { return };
    let plan = plan();
    match compile(source, &plan) {
        Ok(expression) => evaluated(source, &expression, &plan),
        Err(error) => {
            assert!(error.column >= 1 && !error.message.is_empty(), "{error:?}");
            assert!(error.source_text.chars().count() <= 80, "{error:?}");
        }
    }
}

fn evaluated(source: &str, expression: &Expression, plan: &FlightPlan) {
    assert!(source.len() <= MAX_LENGTH);
    for variable in &expression.variables {
        assert!(plan.variables.iter().any(|v| v.name == *variable), "{source} reads {variable}");
    }
    let flight = FlightState { iteration: 3, time_s: 60.0, battery: 0.5, ..FlightState::on_ground(HERE) };
    let variables = Variables::initial(plan);
    let ours = expression.value(&Env { variables: &variables, flight });
    if let Ok(value) = &ours {
        let kind = match value {
            VariableValue::Bool(_) => Type::Bool,
            VariableValue::Number(_) => Type::Number,
            VariableValue::Text(_) => Type::Text,
            VariableValue::Position(_) => Type::Position,
            VariableValue::Polygon(_) => Type::Polygon,
        };
        assert!(expression.gives(kind), "{source}: {:?} is no {kind:?}", expression.kind);
    }
    if let Ok(theirs) = interpreted(source, &flight) {
        compared(source, &ours, &theirs);
    }
}

/// Where the interpreter has a value, ours is the same; an infinite number is a value of its alone.
fn compared(source: &str, ours: &Result<VariableValue, EvalError>, theirs: &cel::Value) {
    let same = match (ours, theirs) {
        (Ok(VariableValue::Bool(a)), cel::Value::Bool(b)) => a == b,
        (Ok(VariableValue::Number(a)), cel::Value::Int(b)) => *a == *b as f64,
        (Ok(VariableValue::Number(a)), cel::Value::Float(b)) => a == b,
        (Ok(VariableValue::Text(a)), cel::Value::String(b)) => *a == **b,
        (Err(EvalError::NotFinite), cel::Value::Float(b)) => !b.is_finite(),
        // with doubles it goes on with what is infinite or no number
        (Err(EvalError::DivisionByZero), _) => true,
        _ => false,
    };
    assert!(same, "{source}: {ours:?}, but cel says {theirs:?}");
}

fn interpreted(source: &str, flight: &FlightState) -> Result<cel::Value, String> {
    let mut context = cel::Context::default();
    context.add_variable_from_value("x", 2.5);
    context.add_variable_from_value("flag", true);
    context.add_variable_from_value("word", "smoke");
    context.add_variable_from_value("iteration", flight.iteration);
    let numbers = [
        ("time", flight.time_s),
        ("altitude", flight.altitude_amsl_m),
        ("airspeed", flight.airspeed_mps),
        ("battery", flight.battery),
        ("fuel", flight.fuel),
        ("wind", flight.wind_mps),
    ];
    for (name, value) in numbers {
        context.add_variable_from_value(name, value);
    }
    let program = cel::Program::compile(source).map_err(|e| e.to_string())?;
    program.execute(&context).map_err(|e| e.to_string())
}

fn plan() -> FlightPlan {
    let corner = |bearing_deg: f64| HERE.destination(bearing_deg, 1414.0);
    let field = [45.0, 135.0, 225.0, 315.0].map(corner).to_vec();
    FlightPlan {
        fixes: vec![Fix {
            id: Id::new("A"),
            position: HERE,
            name: String::new(),
            description: String::new(),
        }],
        variables: vec![
            variable("x", VariableValue::Number(2.5)),
            variable("flag", VariableValue::Bool(true)),
            variable("word", VariableValue::Text("smoke".into())),
            variable("place", VariableValue::Position(HERE)),
            variable("field", VariableValue::Polygon(field)),
        ],
        ..FlightPlan::default()
    }
}

fn variable(name: &str, initial: VariableValue) -> Variable {
    let (name, unit, writers) = (Id::new(name), String::new(), Vec::new());
    Variable { name, initial, unit, min: None, max: None, max_length: None, writers }
}
