//! Random plans, random transitions and random faults on a virtual clock; what came of it is judged by named temporal policies
//! and by a reference model that shares no code with the executor.
//!
//! A sequence is its seed. A failure prints it, and the shortest beginning of it that fails:
//! `LEGWORK_SEED=17 cargo test -p flight-exec --test policies` flies that one again and prints what happened.
//! `LEGWORK_SEQUENCES=1000000 LEGWORK_FROM=250000 cargo test --release -p flight-exec --test policies -- --nocapture`
//! flies many, and goes on where another run has stopped; `LEGWORK_THREADS=1` leaves the other cores to others.
#![cfg(test)]

mod actions;
mod answers;
mod decisions;
mod emergencies;
mod feeding;
mod flight;
#[path = "../common/grid.rs"]
mod grid;
mod heights;
mod holdings;
mod horizon;
mod loops;
mod model;
mod place;
mod plans;
mod policy;
mod random;
mod reporting;
mod restart;
mod tampering;
mod tape;
mod trace;
mod updates;
mod writing;

use policy::{Findings, Policy};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use trace::Trace;

/// Sequences in a plain `cargo test`.
const SEQUENCES: u64 = 400;
/// Moments printed before the one that is wrong.
const REPORTED: usize = 500;
const EVERY_HAPPENING: usize = usize::MAX;
/// Seeds printed of those that break a policy.
const SEEDS_REPORTED: usize = 12;

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
fn complain(policy: &Policy, seeds: &BTreeSet<u64>) -> String {
    let Some(seed) = seeds.first().copied() else { return String::new() };
    let breaks = |n: &usize| first_break(policy, &flight::fly(seed, *n)).is_some();
    let happenings = (0..60).find(breaks).unwrap_or(EVERY_HAPPENING);
    let trace = flight::fly(seed, happenings);
    let Some((at, what)) = first_break(policy, &trace) else { return String::new() };
    let others: Vec<_> = seeds.iter().take(SEEDS_REPORTED).collect();
    let mut text = format!(
        "{}: {}\n  {} sequences ({others:?}); LEGWORK_SEED={seed} is the first, {happenings} happenings are enough\n  moment {at}: {what}\n",
        policy.name,
        policy.says,
        seeds.len()
    );
    if std::env::var_os("LEGWORK_SEED").is_some() {
        text.extend(trace.moments[at.saturating_sub(REPORTED)..=at].iter().map(reporting::moment));
    }
    text
}

/// What came of many sequences: how often each policy applied, and the seeds that broke it.
#[derive(Default)]
struct Tally {
    applied: BTreeMap<&'static str, u64>,
    broken: BTreeMap<&'static str, BTreeSet<u64>>,
}

impl Tally {
    fn fly(&mut self, seed: u64) {
        let trace = flight::fly(seed, EVERY_HAPPENING);
        for policy in policy::all() {
            let found = judge(policy, &trace);
            *self.applied.entry(policy.name).or_default() += found.applied.len() as u64;
            if !found.broken.is_empty() {
                self.broken.entry(policy.name).or_default().insert(seed);
            }
        }
    }

    fn add(mut self, other: Self) -> Self {
        other.applied.into_iter().for_each(|(name, n)| *self.applied.entry(name).or_default() += n);
        for (name, seeds) in other.broken {
            self.broken.entry(name).or_default().extend(seeds);
        }
        self
    }
}

/// Flies every seed, each thread the next one that nobody has taken.
fn fly_all(seeds: Range<u64>) -> Tally {
    let next = AtomicU64::new(seeds.start);
    let work = || {
        let mut tally = Tally::default();
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end {
                return tally;
            }
            tally.fly(seed);
            if (seed + 1).is_multiple_of(10_000) {
                println!("{} sequences, up to seed {seed}", seed + 1 - seeds.start);
            }
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..number("LEGWORK_THREADS", threads)).map(|_| scope.spawn(work)).collect();
        workers.into_iter().map(|w| w.join().unwrap()).fold(Tally::default(), Tally::add)
    })
}

#[test]
fn every_policy_holds_in_every_sequence() {
    let one = std::env::var_os("LEGWORK_SEED").is_some();
    let from = number("LEGWORK_SEED", number("LEGWORK_FROM", 0));
    let Tally { applied, broken } =
        fly_all(from..from + if one { 1 } else { number("LEGWORK_SEQUENCES", SEQUENCES) });
    let broken = policy::all().filter_map(|p| Some((p, broken.get(p.name)?)));
    let complaints: Vec<_> = broken.map(|(p, seeds)| complain(p, seeds)).collect();
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
