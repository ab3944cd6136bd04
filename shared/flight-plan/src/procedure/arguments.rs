//! Arguments of a call, as the sources that replace its parameters.

use super::Calls;
use crate::expression::{self, Type};
use crate::{Call, Id, Problem, Procedure};
use std::collections::HashMap;
use std::sync::Arc;

/// Most different arguments of a plan: compiling one takes some 50 µs.
const MAX_ARGUMENTS: usize = 10_000;

impl Calls<'_> {
    /// The source of each parameter, over the plan's variables alone.
    pub(super) fn bind(
        &mut self,
        procedure: &Procedure,
        call: &Call,
    ) -> Result<HashMap<Id, Arc<str>>, Problem> {
        let mut given: HashMap<&Id, &Arc<str>> = HashMap::new();
        for (name, source) in &call.arguments {
            if !procedure.parameters.iter().any(|p| p.name == *name) {
                let message = format!("`{}` has no parameter `{name}`: remove this argument", procedure.id);
                return Err(Problem::error("unknown-argument", message));
            }
            if given.insert(name, source).is_some() {
                let message = format!("give the argument `{name}` once");
                return Err(Problem::error("duplicate-argument", message));
            }
        }
        let mut bound = HashMap::new();
        for parameter in &procedure.parameters {
            let argument = given.get(&parameter.name).copied();
            let Some(source) = argument.or(parameter.default.as_ref()) else {
                let message = format!("give the argument `{}`: it has no default", parameter.name);
                return Err(Problem::error("missing-argument", message));
            };
            let kind = self.type_of(source)?;
            if let Some(default) = parameter.default.as_ref().filter(|_| argument.is_some()) {
                same(&parameter.name, kind, self.type_of(default)?)?;
            }
            bound.insert(parameter.name.clone(), source.clone());
        }
        Ok(bound)
    }

    fn type_of(&mut self, source: &Arc<str>) -> Result<Type, Problem> {
        if let Some(known) = self.types.get(source) {
            return known.clone();
        }
        if self.types.len() >= MAX_ARGUMENTS {
            let message = format!("use fewer different arguments: a plan may have {MAX_ARGUMENTS}");
            return Err(Problem::error("too-large", message));
        }
        let compiled = expression::compile_with(source, &self.names);
        let kind = compiled.map(|e| e.kind).map_err(|e| Problem::error(e.code, e.to_string()));
        self.types.insert(source.clone(), kind.clone());
        kind
    }
}

/// A parameter's type is its default's; a whole number is a number.
fn same(name: &Id, given: Type, wanted: Type) -> Result<(), Problem> {
    let number = |kind| if kind == Type::Int { Type::Number } else { kind };
    if number(given) == number(wanted) {
        return Ok(());
    }
    Err(Problem::error("wrong-type", format!("the argument `{name}` must be {wanted}, not {given}")))
}
