//! DO_JUMP as iterative legs, where they are well-formed.

use super::placed::{Placed, leg};
use crate::names::Names;
use flight_plan::{IterativeForm, Leg, LegKind, TurnDirection, Value};

/// Deepest nest of loops.
const MAX_DEPTH: usize = 8;
/// When what is never to end ends: there is energy left to come home.
pub const ENOUGH: &str = "battery < 0.4";

/// Makes a loop of the legs from item `target` to the last one; they were flown once when the jump comes, so `repeats` more
/// make `repeats` + 1 passes. Negative: for ever.
///
/// # Errors
/// Why there is no such loop: a sentence.
pub fn close(
    legs: &mut Vec<Placed>,
    target: i64,
    number: i64,
    repeats: f64,
    names: &mut Names,
) -> Result<(), String> {
    let begin = legs.iter().position(|l| l.first >= target).unwrap_or(legs.len());
    // the last one before: jumps into its middle are not a loop
    let before = begin.checked_sub(1).and_then(|i| legs.get(i)).filter(|_| target < number);
    if before.is_some_and(|l| target <= l.last && target > l.first) {
        return Err(format!(
            "the jump to item {target} leads into the middle of another loop, a pattern or a wait and is left out"
        ));
    }
    if begin == legs.len() || target >= number {
        return Err(format!("the jump to item {target} leads to no leg before it and is left out"));
    }
    let depth = legs.iter().skip(begin).map(|l| l.depth).max().unwrap_or(0) + 1;
    if depth > MAX_DEPTH {
        return Err(format!("the jump to item {target} would nest {depth} loops and is left out"));
    }
    if !repeats.is_finite() {
        return Err(format!("the jump to item {target} is left out: it doesn't say how often"));
    }
    if repeats == 0.0 {
        return Ok(());
    }
    let body: Vec<_> = legs.drain(begin..).collect();
    let first = body.first().map_or(number, |l| l.first);
    let passes = (repeats > 0.0).then(|| repeats.round().min(1e9) + 1.0);
    let kind = repeated(body.into_iter().map(|l| l.leg).collect(), passes);
    let id = names.take(&format!("loop{first}"), "loop");
    legs.push(Placed { leg: leg(id, kind), first, last: number, depth });
    Ok(())
}

/// A loop over these legs; without a number of passes it ends when there is just enough energy left.
pub fn repeated(body: Vec<Leg>, passes: Option<f64>) -> LegKind {
    LegKind::Iterative {
        form: IterativeForm::Forward,
        count: passes.map(Value::Constant),
        until: passes.is_none().then(|| ENOUGH.into()),
        turn: TurnDirection::Right,
        body: body.into_iter().map(Into::into).collect(),
    }
}
