//! DO_JUMP as iterative legs, where they are well-formed.

use super::placed::{Placed, leg};
use crate::names::Names;
use flight_plan::{IterativeForm, LegKind, TurnDirection, Value};

/// Deepest nest of loops.
const MAX_DEPTH: usize = 8;
/// Passes of a jump that is never to end.
pub const FOR_EVER: f64 = 1000.0;

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
    let passes = if repeats < 0.0 { FOR_EVER } else { repeats.round().min(1e9) + 1.0 };
    let kind = LegKind::Iterative {
        form: IterativeForm::Forward,
        count: Some(Value::Constant(passes)),
        until: None,
        turn: TurnDirection::Right,
        body: body.into_iter().map(|l| l.leg.into()).collect(),
    };
    let id = names.take(&format!("loop{first}"), "loop");
    legs.push(Placed { leg: leg(id, kind), first, last: number, depth });
    Ok(())
}
