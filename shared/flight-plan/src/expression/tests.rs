//! What expressions mean, with the `cel` crate's own interpreter as the oracle.

use super::*;
use crate::{FlightPlan, Variable, VariableValue, Variables};
use proptest::prelude::*;

fn variable(name: &str, initial: VariableValue) -> Variable {
    Variable::new(name.into(), initial)
}

/// A square of 2 km around a position.
fn square(middle: LatLon) -> Vec<LatLon> {
    let corner = |bearing_deg: f64| middle.destination(bearing_deg, 1000.0 * 2.0_f64.sqrt());
    [45.0, 135.0, 225.0, 315.0].map(corner).to_vec()
}

fn plan() -> FlightPlan {
    let here = LatLon::new(36.3, -84.2);
    FlightPlan {
        fixes: vec![crate::Fix {
            id: "A".into(),
            position: here,
            name: String::new(),
            description: String::new(),
        }],
        variables: vec![
            variable("x", VariableValue::Number(2.5)),
            variable("flag", VariableValue::Bool(true)),
            variable("word", VariableValue::Text("smoke".into())),
            variable("place", VariableValue::Position(here)),
            variable("field", VariableValue::Polygon(square(here))),
            variable(
                "bow",
                VariableValue::Polygon(vec![
                    here,
                    LatLon::new(36.3, -84.1),
                    LatLon::new(36.4, -84.2),
                    LatLon::new(36.2, -84.1),
                ]),
            ),
        ],
        ..FlightPlan::default()
    }
}

fn with_env<T>(plan: &FlightPlan, use_it: impl FnOnce(&Env) -> T) -> T {
    let variables = Variables::initial(plan);
    let flight = FlightState {
        iteration: 3,
        time_s: 60.0,
        battery: 0.5,
        ..FlightState::on_ground(LatLon::new(36.3, -84.1))
    };
    use_it(&Env { variables: &variables, flight })
}

fn number(source: &str) -> Result<f64, EvalError> {
    let plan = plan();
    with_env(&plan, |env| compile(source, &plan).unwrap().number(env))
}

fn condition(source: &str) -> Result<bool, EvalError> {
    let plan = plan();
    with_env(&plan, |env| compile(source, &plan).unwrap().bool(env))
}

#[test]
fn numbers() {
    let cases = [
        ("1 + 2 * 3", 7.0),
        ("7 / 2", 3.0),
        ("7.0 / 2.0", 3.5),
        ("-7 % 3", -1.0),
        ("x * 2.0 + double(iteration)", 8.0),
        ("flag ? time : 0.0", 60.0),
        ("min(x, 1) + max(x, 4) + abs(-x)", 7.5),
        ("- - x", 2.5),
    ];
    for (source, expected) in cases {
        assert_eq!(number(source), Ok(expected), "{source}");
    }
}

#[test]
fn conditions() {
    let cases = [
        ("iteration >= 3 && battery < 0.6", true),
        ("1 == 1.0 && x != 2", true),
        ("word.startsWith('smo') && word.endsWith('ke') && word.contains('mok')", true),
        ("word + 'y' == 'smokey'", true),
        ("'a' < 'b' && !('b' <= 'a')", true),
        ("place == position || distance(place, place) > 0.0", false),
        ("abs(distance_to('A') - distance_to(place)) < 0.001", true),
        ("distance_to(offset(position, 90.0, 500.0)) > 499.9", true),
        ("abs(distance(lat_lon(36.3, -84.2), place)) < 0.001", true),
        ("contains(field, place) && !contains(field, position)", true),
        ("field.contains(offset(place, 0, 999)) && !field.contains(offset(place, 0, 1001))", true),
        // a millionth: the curvature of the Earth over a kilometre
        ("abs(area(field) - 4000000.0) < 4.0", true),
        ("distance(centre(field), place) < 1.0", true),
        ("field == field && contains('field', 'eld')", true),
        // either side decides alone
        ("flag || 1 / 0 == 1", true),
        ("1 / 0 == 1 || flag", true),
        ("!flag && 1 / 0 == 1", false),
    ];
    for (source, expected) in cases {
        assert_eq!(condition(source), Ok(expected), "{source}");
    }
}

#[test]
fn what_has_no_value() {
    let cases = [
        ("1 / 0", EvalError::DivisionByZero),
        ("1 % 0", EvalError::DivisionByZero),
        ("9223372036854775807 + 1", EvalError::Overflow),
        ("1.0 / 0.0", EvalError::DivisionByZero),
        ("distance(place, offset(place, 0.0, 1e300))", EvalError::NotAPosition),
        ("area(bow)", EvalError::NotAPolygon),
        ("distance(lat_lon(91, 0), place)", EvalError::NotAPosition),
    ];
    for (source, expected) in cases {
        assert_eq!(number(source), Err(expected), "{source}");
    }
}

#[test]
fn what_does_not_compile_and_where() {
    let cases = [
        ("", "expression-syntax", 1),
        ("x +", "expression-syntax", 4),
        ("1.0 + fire", "unknown-name", 7),
        ("distance_to('Z')", "unknown-name", 13),
        ("size(word)", "unknown-name", 5),
        ("x + 1", "wrong-type", 3),
        ("x && flag", "wrong-type", 1),
        ("flag + flag", "wrong-type", 6),
        ("place < place", "wrong-type", 7),
        ("flag ? 1 : 2.0", "wrong-type", 12),
        ("min(1.0)", "wrong-type", 4),
        ("5u", "wrong-type", 1),
        ("area(place)", "wrong-type", 6),
        ("contains(field, 'a')", "wrong-type", 17),
        ("contains(place, place)", "wrong-type", 10),
        ("[1, 2]", "expression-syntax", 1),
        ("x in [1.0]", "expression-syntax", 3),
        ("word.length", "expression-syntax", 5),
    ];
    let plan = plan();
    for (source, code, column) in cases {
        let error = compile(source, &plan).unwrap_err();
        assert_eq!((error.code, error.column), (code, column), "{source}: {error}");
    }
}

#[test]
fn expressions_that_are_too_large() {
    let plan = plan();
    let deep = |open: &str, close: &str| format!("{}1{}", open.repeat(200), close.repeat(200));
    for source in
        [deep("(", ")"), deep("-", ""), deep("!", ""), "1+".repeat(600) + "1", deep("true ? 1 : ", "")]
    {
        assert_eq!(compile(&source, &plan).unwrap_err().code, "expression-too-large");
    }
    assert!(compile(&("1+".repeat(400) + "1"), &plan).is_err_and(|e| e.code == "expression-too-large"));
}

/// A thread of a test has 2 MiB, and so have those that read plans; a stack that is too small would end the process.
#[test]
fn the_deepest_expressions_fit_into_the_stack_of_a_thread() {
    let nest = |open: &str, close: &str| format!("{}true{}", open.repeat(MAX_DEPTH), close.repeat(MAX_DEPTH));
    for source in [nest("(", ")"), nest("!", ""), nest("true ? true : ", "")] {
        assert!(compile(&source, &plan()).is_ok(), "{source}");
    }
    assert_eq!(compile(&nest("[", "]"), &plan()).unwrap_err().code, "expression-syntax");
}

#[test]
fn it_knows_the_variables_it_reads() {
    let expression = compile("x + x + (flag ? time : 1.0)", &plan()).unwrap();
    assert_eq!(expression.variables, [Id::new("x"), Id::new("flag")]);
}

/// Numbers and conditions of the part that `cel` evaluates too.
fn source() -> impl Strategy<Value = String> {
    let int = prop_oneof![(-4_i64..5).prop_map(|i| format!("({i})")), Just("iteration".into())];
    let int = int.prop_recursive(3, 8, 2, |inner| {
        (inner.clone(), prop::sample::select(vec!["+", "-", "*", "/", "%"]), inner)
            .prop_map(|(a, op, b)| format!("({a} {op} {b})"))
    });
    let double =
        prop_oneof![(-4..5).prop_map(|i| format!("({}.5)", i)), Just("x".into()), Just("time".into())];
    // never NaN: CEL compares it as false, as we do, where the oracle knows no such comparison
    let double = double.prop_recursive(3, 8, 2, |inner| {
        prop_oneof![
            (inner.clone(), prop::sample::select(vec!["+", "-", "*"]), inner.clone())
                .prop_map(|(a, op, b)| format!("({a} {op} {b})")),
            inner.prop_map(|a| format!("({a} / (-1.5))")),
        ]
    });
    let number = prop_oneof![int, double];
    let comparison = prop::sample::select(vec!["<", "<=", ">", ">=", "==", "!="]);
    let condition = prop_oneof![
        4 => (number.clone(), comparison, number).prop_map(|(a, op, b)| format!("({a} {op} {b})")),
        1 => Just("flag".to_owned()),
    ];
    condition.prop_recursive(3, 8, 3, |inner| {
        prop_oneof![
            (inner.clone(), prop::sample::select(vec!["&&", "||"]), inner.clone())
                .prop_map(|(a, op, b)| format!("({a} {op} {b})")),
            (inner.clone(), inner.clone(), inner.clone()).prop_map(|(a, b, c)| format!("({a} ? {b} : {c})")),
            inner.prop_map(|a| format!("!{a}")),
        ]
    })
}

fn by_oracle(source: &str) -> Result<bool, cel::ExecutionError> {
    let mut context = cel::Context::default();
    context.add_variable_from_value("x", 2.5);
    context.add_variable_from_value("flag", true);
    context.add_variable_from_value("iteration", 3_i64);
    context.add_variable_from_value("time", 60.0);
    cel::Program::compile(source).unwrap().execute(&context).map(|value| value == cel::Value::Bool(true))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn conditions_mean_what_cel_says(source in source()) {
        prop_assume!(compile(&source, &plan()).is_ok());
        match (condition(&source), by_oracle(&source)) {
            (Ok(ours), Ok(theirs)) => prop_assert_eq!(ours, theirs),
            (Err(_), Err(_)) => {}
            (ours, theirs) => prop_assert!(false, "{:?} but cel says {:?}", ours, theirs),
        }
    }

    #[test]
    fn garbage_never_panics(source in "[a-z0-9.+*/()\\[\\]{}?:!<>=&|'\" ,-]{0,60}") {
        let _ = compile(&source, &plan());
    }

    #[test]
    fn any_text_never_panics(source in "\\PC{0,40}") {
        let _ = compile(&source, &plan());
    }
}
