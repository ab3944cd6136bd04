//! Plans that are flown by the targets, and executors that fly them.

use aircraft::Profile;
use flight_exec::{Config, Executor, RestoreError, Snapshot};
use flight_plan::{Id, Program, compile_document};
use std::sync::{Arc, OnceLock};
use terrain::Flat;

/// Plans around one valley that have every kind of leg, holding, loop and decision between them.
const PLANS: [&str; 5] = [
    include_str!("../../../assets/plans/square.xml"),
    include_str!("../../../assets/plans/fire-watch.xml"),
    include_str!("../../../assets/plans/search.xml"),
    include_str!("../../../assets/plans/navaid-inspection.xml"),
    include_str!("../../../assets/plans/alternates.xml"),
];
/// Above the sea, metres.
const GROUND_M: f64 = 349.0;

/// The plans, compiled once, and the names in them; with a name that is in none.
pub struct Known {
    pub plans: Vec<Arc<Program>>,
    pub legs: Vec<Id>,
    pub variables: Vec<Id>,
}

pub fn known() -> &'static Known {
    static KNOWN: OnceLock<Known> = OnceLock::new();
    KNOWN.get_or_init(|| {
        let compiled = |xml: &&str| compile_document(xml.as_bytes(), &Profile::default(), &Flat(GROUND_M));
        let plans: Vec<_> = PLANS.iter().map(compiled).map(|p| Arc::new(p.unwrap())).collect();
        let legs = plans.iter().flat_map(|p| p.flown().all_legs().into_iter().map(|c| c.leg.id.clone()));
        let legs = legs.chain([Id::new("nowhere")]).collect();
        let variables = plans.iter().flat_map(|p| p.plan.variables.iter().map(|v| v.name.clone()));
        let variables = variables.chain([Id::new("nothing")]).collect();
        Known { plans, legs, variables }
    })
}

/// Any number as one of a list.
pub fn pick<T: Clone>(list: &[T], number: u8) -> T {
    list[usize::from(number) % list.len()].clone()
}

/// An executor without a plan.
pub fn resting() -> Executor {
    Executor::new(Config::default(), Arc::new(Flat(GROUND_M)), Profile::default())
}

/// The plan of a hash.
pub fn of_hash(hash: &str) -> Option<Arc<Program>> {
    known().plans.iter().find(|p| **p.hash() == *hash).cloned()
}

/// An executor as it was, with whichever plan it had.
pub fn revived(snapshot: Snapshot) -> Result<Executor, RestoreError> {
    let plan = snapshot.plan.as_deref().and_then(of_hash);
    Executor::restore(Config::default(), Arc::new(Flat(GROUND_M)), Profile::default(), plan, snapshot)
}
