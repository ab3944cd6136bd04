//! Killed at any instant, it comes back to the same place.

use crate::policy::{Findings, Policy, policy};
use crate::trace::{Seen, Step, Stimulus, Trace};
use flight_exec::Token;

pub const POLICIES: &[Policy] = &[
    policy(
        "same-after-restart",
        "A restored snapshot gives the same outputs as the uninterrupted executor.",
        same_outputs,
    ),
    policy(
        "status-survives-restart",
        "Place, phase, decision, tokens and proposal survive a restart.",
        status_survives,
    ),
    policy(
        "ahead-survives-restart",
        "The waypoints believed ahead survive a restart, in every detail.",
        ahead_survives,
    ),
    policy("snapshot-of-a-snapshot", "A snapshot of what was restored is the same snapshot.", same_snapshot),
    policy("variables-survive-restart", "Variables survive a restart.", variables_survive),
    policy("no-token-twice-after-restart", "After a restart numbering goes on.", numbering_goes_on),
    policy("snapshots-know-their-plan", "A snapshot is not restored with another plan.", foreign_refused),
];

fn restarts(trace: &Trace) -> impl Iterator<Item = Step<'_>> {
    trace.steps().filter(|s| matches!(s.moment.stimulus, Stimulus::Restarted { .. }))
}

fn same_outputs(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        if let Some(twin) = &step.moment.twin {
            found.expect(step, *twin == step.moment.outputs, || {
                format!("{twin:?}\n  instead of {:?}", step.moment.outputs)
            });
        }
    }
}

fn status_survives(trace: &Trace, found: &mut Findings) {
    for step in restarts(trace) {
        found.expect(step, step.before.status == step.after.status, || format!("{:?}", step.after.status));
    }
}

fn ahead_survives(trace: &Trace, found: &mut Findings) {
    for step in restarts(trace) {
        found.expect(step, step.before.ahead == step.after.ahead, || "other waypoints ahead".into());
    }
}

fn same_snapshot(trace: &Trace, found: &mut Findings) {
    for step in restarts(trace) {
        let Stimulus::Restarted { same_snapshot, .. } = step.moment.stimulus else { continue };
        found.expect(step, same_snapshot, || "another snapshot".into());
    }
}

fn variables_survive(trace: &Trace, found: &mut Findings) {
    for step in restarts(trace) {
        found.expect(step, step.before.variables == step.after.variables, || {
            format!("{:?}", step.after.variables)
        });
    }
}

/// The first token fed after a restart is the next number.
fn numbering_goes_on(trace: &Trace, found: &mut Findings) {
    let highest = |seen: &Seen| seen.tokens().into_iter().max().unwrap_or_default();
    let (mut last, mut restarted) = (Token(0), false);
    for step in trace.steps() {
        restarted |= matches!(step.moment.stimulus, Stimulus::Restarted { .. });
        for (_, waypoints) in step.feeds() {
            if let Some(first) = waypoints.first().filter(|_| std::mem::take(&mut restarted)) {
                found.expect(step, first.token > last, || format!("{:?} after {last:?}", first.token));
            }
            last = waypoints.iter().map(|w| w.token).fold(last, Token::max);
        }
        last = last.max(highest(step.after));
    }
}

fn foreign_refused(trace: &Trace, found: &mut Findings) {
    for step in restarts(trace) {
        let Stimulus::Restarted { foreign_refused, .. } = step.moment.stimulus else { continue };
        found.expect(step, foreign_refused, || "restored with another plan".into());
    }
}
