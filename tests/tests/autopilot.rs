//! The flight-test programme on a real autopilot, whatever is there; opt-in:
//!
//! `LEGWORK_AUTOPILOT=tcp:127.0.0.1:5760 cargo test -p system-tests --test autopilot -- --nocapture`
//!
//! The mission is laid around the place where the autopilot stands; each flight ends on the ground, and the next begins there.
//! `LEGWORK_SCENARIOS=nominal,gateway_killed` flies only these; `LEGWORK_TABLE="ArduPlane 4.7"` writes the results into the
//! column of that name in `assets/docs/flight-tests.md`.
#![cfg(test)]

use std::env::var;
use system_tests::programme::{Scenario, scenarios, table};
use system_tests::rig::Rig;

const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/docs/flight-tests.md");

/// Flies it; how long it took, seconds of the machine's time.
async fn flown(scenario: &Scenario, autopilot: &str) -> anyhow::Result<f64> {
    let mut rig = Rig::attach(autopilot, scenario.simulator).await?;
    println!("{}: the autopilot stands at {:?}", scenario.name, rig.field);
    let began_s = rig.seen.time_s;
    scenario.fly(&mut rig).await?;
    println!("{}", rig.story());
    Ok(rig.seen.time_s - began_s)
}

#[tokio::test(flavor = "multi_thread")]
async fn real_autopilot_flies_the_programme() {
    let Ok(autopilot) = var("LEGWORK_AUTOPILOT") else {
        println!("not flown: set LEGWORK_AUTOPILOT, for example to tcp:127.0.0.1:5760");
        return;
    };
    let only = var("LEGWORK_SCENARIOS").unwrap_or_default();
    let is_wanted = |s: &Scenario| only.is_empty() || only.split(',').any(|name| name == s.name);
    let mut outcomes = table::Outcomes::new();
    for scenario in scenarios().filter(|s| is_wanted(s)) {
        let outcome = match flown(scenario, &autopilot).await {
            Ok(took_s) => format!("passed, {took_s:.0} s"),
            Err(error) => {
                println!("{error:#}");
                "failed".into()
            }
        };
        println!("{}: {outcome}", scenario.name);
        outcomes.insert(scenario.name.to_owned(), outcome);
    }
    if let Ok(column) = var("LEGWORK_TABLE") {
        let document = std::fs::read_to_string(DOCUMENT).unwrap();
        std::fs::write(DOCUMENT, table::renewed(&document, Some((&column, &outcomes))).unwrap()).unwrap();
    }
    let failed: Vec<_> = outcomes.iter().filter(|(_, outcome)| *outcome == "failed").collect();
    assert!(failed.is_empty(), "{failed:?}");
}
