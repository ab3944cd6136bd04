//! Random plans, random transitions and random faults on a virtual clock; what came of it is judged by named temporal policies
//! and by a reference model that shares no code with the executor.
//!
//! A sequence is its seed. A failure prints it, and the shortest beginning of it that fails:
//! `LEGWORK_SEED=17 cargo test -p flight-exec --test policies` flies that one again and tells what happened.
//! `LEGWORK_SEQUENCES=1000000 LEGWORK_FROM=250000 cargo test --release -p flight-exec --test policies -- --nocapture`
//! flies many, and goes on where another run has stopped.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod answers;
mod decisions;
mod emergencies;
mod feeding;
mod flight;
#[path = "../common/grid.rs"]
mod grid;
mod horizon;
mod loops;
mod model;
mod place;
mod plans;
mod policy;
mod random;
mod restart;
mod tampering;
mod tape;
mod trace;
mod updates;

use policy::{Findings, Policy};
use std::collections::BTreeMap;
use trace::Trace;

/// Sequences in a plain `cargo test`.
const SEQUENCES: u64 = 200;
/// Moments told before the one that is wrong.
const TOLD: usize = 60;
const EVERY_HAPPENING: usize = usize::MAX;

fn number(variable: &str, default: u64) -> u64 {
    std::env::var(variable).map_or(default, |text| {
        text.parse().unwrap_or_else(|_| panic!("{variable} is a number: `{text}` is none"))
    })
}

fn judge(policy: &Policy, trace: &Trace) -> Findings {
    let mut found = Findings::default();
    (policy.check)(trace, &mut found);
    found
}

/// The first moment at which a trace breaks a policy, and how.
fn first_break(policy: &Policy, trace: &Trace) -> Option<(usize, String)> {
    judge(policy, trace).broken.into_iter().next()
}

/// Tells how a sequence breaks a policy, shortened as far as it still does.
fn complain(policy: &Policy, seed: u64, sequences: u64) -> String {
    let breaks = |n: &usize| first_break(policy, &flight::fly(seed, *n)).is_some();
    let happenings = (0..60).find(breaks).unwrap_or(EVERY_HAPPENING);
    let trace = flight::fly(seed, happenings);
    let Some((at, what)) = first_break(policy, &trace) else { return String::new() };
    let mut text = format!(
        "{}: {}\n  {sequences} sequences; LEGWORK_SEED={seed} is the first, {happenings} happenings are enough\n  moment {at}: {what}\n",
        policy.name, policy.says
    );
    if std::env::var_os("LEGWORK_SEED").is_some() {
        for moment in &trace.moments[at.saturating_sub(TOLD)..=at] {
            text += &format!("    {:?} {:?}\n", moment.now, moment.deed);
            moment.outputs.iter().for_each(|o| text += &format!("        {o:?}\n"));
        }
    }
    text
}

#[test]
fn every_policy_holds_in_every_sequence() {
    let one = std::env::var_os("LEGWORK_SEED").is_some();
    let from = number("LEGWORK_SEED", number("LEGWORK_FROM", 0));
    let until = from + if one { 1 } else { number("LEGWORK_SEQUENCES", SEQUENCES) };
    let mut applied: BTreeMap<&str, u64> = BTreeMap::new();
    let mut broken: BTreeMap<&str, (&Policy, u64, u64)> = BTreeMap::new();
    for seed in from..until {
        let trace = flight::fly(seed, EVERY_HAPPENING);
        for policy in policy::all() {
            let found = judge(policy, &trace);
            *applied.entry(policy.name).or_default() += found.applied.len() as u64;
            if !found.broken.is_empty() {
                broken.entry(policy.name).or_insert((policy, seed, 0)).2 += 1;
            }
        }
        if (seed + 1) % 10_000 == 0 {
            println!("{} sequences, up to seed {seed}; {} policies broken", seed + 1 - from, broken.len());
        }
    }
    let complaints: Vec<_> = broken.values().map(|(p, seed, n)| complain(p, *seed, *n)).collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    println!("how often each policy applied: {applied:#?}");
    let idle: Vec<_> = applied.iter().filter(|(_, n)| **n == 0).map(|(name, _)| name).collect();
    assert!(one || idle.is_empty(), "never exercised: {idle:?}");
}

#[test]
fn policies_have_names_of_their_own() {
    let names: Vec<_> = policy::all().map(|p| p.name).collect();
    let mut distinct = names.clone();
    distinct.sort_unstable();
    distinct.dedup();
    assert_eq!(distinct.len(), names.len());
    assert!(names.len() >= 60, "{}", names.len());
}
