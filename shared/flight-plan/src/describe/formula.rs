//! Expressions while they are written: what they give, what is wrong and where, and what may come next.

use super::Subject;
use crate::expression::{
    self, Env, ExpressionError, FlightState, Names, Type, compile_with, flight_names, functions, mentioned,
};
use crate::{FlightPlan, Parameter, Use, Variable, VariableValue, Variables};

/// What an expression gives before the flight.
#[derive(Debug, Clone, PartialEq)]
pub enum Formula {
    /// This value.
    Value(VariableValue),
    /// No value yet, for this reason; or nobody can say before the flight.
    Nothing(String),
}

/// Something that may be written next.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Completion {
    /// What is put in the place of the word that was begun.
    pub word: String,
    /// What it is.
    pub about: String,
}

/// Looks at an expression (without its `=`) of a part of a plan.
///
/// # Errors
/// What is wrong with it, and at which column.
pub fn look(plan: &FlightPlan, of: &Subject, source: &str, used: Use) -> Result<Formula, ExpressionError> {
    let parameters = parameters(plan, of);
    let known: Vec<Variable> = parameters.iter().filter_map(|p| with_default(plan, p)).collect();
    let is_unknown = |name: &str| {
        parameters.iter().any(|p| p.name.as_str() == name) && !known.iter().any(|v| v.name.as_str() == name)
    };
    let asked_later = !mentioned(source, &is_unknown).is_empty();
    let compiled = match compile_with(source, &Names::of(plan).and(&known)) {
        Err(error) if asked_later && error.code != "expression-syntax" => {
            return Ok(Formula::Nothing("each call gives it a value".into()));
        }
        other => other?,
    };
    let wanted = wanted(used).filter(|wanted| !compiled.gives(*wanted));
    if let Some(wanted) = wanted {
        return Err(ExpressionError {
            code: "wrong-type",
            column: 1,
            source_text: source.into(),
            message: format!("this is {}, but {wanted} is needed here", compiled.kind),
            correction: None,
            undeclared_flag: None,
        });
    }
    let mut variables = Variables::initial(plan);
    known.iter().for_each(|v| variables.put(&v.name, v.initial.clone()));
    let env = Env { variables: &variables, flight: FlightState::at_start(plan.home()) };
    Ok(match compiled.value(&env) {
        Ok(value) => Formula::Value(value),
        Err(why) => Formula::Nothing(why.to_string()),
    })
}

fn wanted(used: Use) -> Option<Type> {
    match used {
        Use::Number => Some(Type::Number),
        Use::Condition => Some(Type::Bool),
        Use::Position => Some(Type::Position),
        Use::Polygon => Some(Type::Polygon),
        Use::Any => None,
    }
}

/// Names that an expression of this part may read beside the plan's variables.
fn parameters<'p>(plan: &'p FlightPlan, of: &Subject) -> &'p [Parameter] {
    match of {
        Subject::Leg(id) => plan.procedure_leg(id).map_or(&[], |(procedure, _)| &procedure.parameters),
        _ => &[],
    }
}

/// A parameter as a variable whose value is its default.
fn with_default(plan: &FlightPlan, parameter: &Parameter) -> Option<Variable> {
    let variables = Variables::initial(plan);
    let env = Env { variables: &variables, flight: FlightState::at_start(plan.home()) };
    let value = expression::compile(parameter.default.as_ref()?, plan).ok()?.value(&env).ok()?;
    Some(Variable::new(parameter.name.clone(), value))
}

/// The word that was begun before the cursor.
fn begun(before: &str) -> &str {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let start = before.trim_end_matches(is_word).len();
    before.get(start..).unwrap_or("")
}

/// What may be written in the place of the word that was begun before the cursor, and how long that word is, bytes.
pub fn completions(plan: &FlightPlan, of: &Subject, before: &str) -> (usize, Vec<Completion>) {
    let quoted = before.matches('\'').count() % 2 == 1;
    let word = if quoted { before.rsplit('\'').next().unwrap_or("") } else { begun(before) };
    let mut found: Vec<Completion> = if quoted { fixes(plan) } else { names(plan, of) };
    let lower = word.to_lowercase();
    found.retain(|c| c.word.to_lowercase().starts_with(&lower) && c.word != word);
    (word.len(), found)
}

fn fixes(plan: &FlightPlan) -> Vec<Completion> {
    plan.fixes.iter().map(|fix| completion(fix.id.as_str(), &fix.name)).collect()
}

fn names(plan: &FlightPlan, of: &Subject) -> Vec<Completion> {
    let parameters = parameters(plan, of).iter().map(|p| completion(p.name.as_str(), "parameter"));
    let variables = plan.variables.iter().map(|v| completion(v.name.as_str(), &about(v)));
    let flight = flight_names().map(|(name, about)| completion(name, about));
    let functions = functions().map(|(name, about)| completion(&format!("{name}("), about));
    parameters.chain(variables).chain(flight).chain(functions).collect()
}

fn completion(word: &str, about: &str) -> Completion {
    Completion { word: word.into(), about: about.into() }
}

fn about(variable: &Variable) -> String {
    let kind = variable.initial.type_name();
    match variable.unit.as_str() {
        "" => format!("variable, {kind}"),
        unit => format!("variable, {kind}, {unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read;

    fn plan() -> FlightPlan {
        read(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><fixes><fix id="FAR" lat="36" lon="-84" name="Far away"/></fixes>
            <variables><variable name="size" type="number" unit="m" initial="300"/></variables>
            <procedures><procedure id="p"><parameter name="free"/><parameter name="side" default="= size * 2.0"/><TF id="inner" fix="FAR"/></procedure></procedures>
            <mainPlan><stage id="s" type="mission"><TF id="a" fix="FAR"/></stage></mainPlan></flightPlan>"#,
        )
        .plan
    }

    fn words(before: &str, of: &Subject) -> Vec<String> {
        completions(&plan(), of, before).1.into_iter().map(|c| c.word).collect()
    }

    #[test]
    fn a_formula_has_a_result_or_a_fault_with_its_column() {
        let (plan, leg) = (plan(), Subject::Leg("a".into()));
        let number = |x| Ok(Formula::Value(VariableValue::Number(x)));
        assert_eq!(look(&plan, &leg, "size + 1.0", Use::Number), number(301.0));
        let fault = look(&plan, &leg, "size + side", Use::Number).unwrap_err();
        assert_eq!((fault.code, fault.column), ("unknown-name", 8));
        assert_eq!(look(&plan, &leg, "size", Use::Condition).unwrap_err().code, "wrong-type");
        assert_eq!(look(&plan, &leg, "size +", Use::Number).unwrap_err().code, "expression-syntax");
        assert!(matches!(look(&plan, &leg, "1.0 / (size - size)", Use::Number), Ok(Formula::Nothing(_))));
    }

    #[test]
    fn inside_a_procedure_its_parameters_are_known() {
        let (plan, leg) = (plan(), Subject::Leg("inner".into()));
        let side = look(&plan, &leg, "side + 1.0", Use::Number);
        assert_eq!(side, Ok(Formula::Value(VariableValue::Number(601.0))));
        assert!(matches!(look(&plan, &leg, "free + 1.0", Use::Number), Ok(Formula::Nothing(_))));
        assert!(look(&plan, &Subject::Leg("a".into()), "side + 1.0", Use::Number).is_err());
    }

    #[test]
    fn what_was_begun_is_completed() {
        let (leg, inner) = (Subject::Leg("a".into()), Subject::Leg("inner".into()));
        assert_eq!(words("2.0 * si", &leg), ["size"]);
        assert_eq!(words("2.0 * si", &inner), ["side", "size"]);
        assert_eq!(words("dis", &leg), ["distance(", "distance_to("]);
        assert_eq!(words("distance_to('f", &leg), ["FAR"]);
        assert_eq!(words("size", &leg), [""; 0], "nothing is left to be done");
        assert!(words("", &leg).contains(&"battery".to_owned()));
    }
}
