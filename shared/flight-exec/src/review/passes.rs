//! `long-passes`: a loop that ends at a time reads the time only at the end of a pass, and its passes are long.

use super::View;
use crate::api::IterationPlace;
use crate::rehearse::Preview;
use flight_plan::{Id, Leg, Problem};
use std::collections::{HashMap, HashSet};

/// Who ends a loop by the time does not expect to be later than this, seconds.
const LONG_S: f64 = 600.0;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let Ok(planned) = &view.flights.planned else { return };
    let legs = view.program.flown().all_legs();
    let timed: HashSet<&Id> =
        legs.iter().map(|context| context.leg).filter(|leg| is_timed(view, leg)).map(|leg| &leg.id).collect();
    let passes = longest_passes(planned, &timed);
    let in_order = legs.iter().map(|context| &context.leg.id);
    problems.extend(in_order.filter_map(|id| problem(id, passes.get(id)?.longest_s)));
}

fn is_timed(view: &View, leg: &Leg) -> bool {
    let until = leg.as_loop().and_then(|passes| passes.until);
    until.is_some_and(|until| view.program.expression(until).is_ok_and(|until| until.reads_time()))
}

/// The present pass of a loop, and the longest so far.
struct Pass<'a> {
    /// This and the passes around it.
    number: &'a [IterationPlace],
    start_s: f64,
    longest_s: f64,
}

/// Of each of these loops that a flight comes to.
fn longest_passes<'a>(planned: &'a Preview, of: &HashSet<&Id>) -> HashMap<&'a Id, Pass<'a>> {
    let mut passes: HashMap<&Id, Pass> = HashMap::new();
    for passage in planned.legs.iter().filter(|_| !of.is_empty()) {
        let around = &passage.place.iterations;
        for (depth, pass) in around.iter().enumerate().filter(|(_, pass)| of.contains(&pass.leg)) {
            let number = around.get(..=depth).unwrap_or_default();
            let begun = Pass { number, start_s: passage.start_s, longest_s: 0.0 };
            let known = passes.entry(&pass.leg).or_insert(begun);
            if known.number != number {
                (known.number, known.start_s) = (number, passage.start_s);
            }
            known.longest_s = known.longest_s.max(passage.end_s - known.start_s);
        }
    }
    passes
}

fn problem(leg: &Id, longest_s: f64) -> Option<Problem> {
    let message = format!(
        "shorten the passes of `{leg}`, or reckon with one more: its `until` reads the time only at the end of a pass, and they last up to {:.0} min",
        longest_s / 60.0
    );
    (longest_s >= LONG_S).then(|| Problem::warning("long-passes", message).of(leg))
}
