//! The flight-test programme and the quirks on a real autopilot, whatever is there; opt-in:
//!
//! `LEGWORK_AUTOPILOT=tcp:127.0.0.1:5760 cargo test -p system-tests --test autopilot -- --nocapture`
//!
//! The mission is laid around the place where the autopilot stands; each flight ends on the ground, and the next begins there.
//! `LEGWORK_SCENARIOS=nominal,gateway_killed` flies only these, and `LEGWORK_QUIRKS=clear_leaves_nothing` tries only these;
//! `LEGWORK_TABLE="ArduPlane 4.7"` writes the results into the columns of that name in `assets/docs/flight-tests.md`.
//!
//! The quirks are tried on the personalities of our simulator, too, and that always.
#![cfg(test)]

use std::env::var;
use system_tests::programme::{self, Scenario, scenarios};
use system_tests::quirks::{self, Autopilot, quirks};
use system_tests::rig::Rig;
use system_tests::table::{Outcomes, Table};

const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/docs/flight-tests.md");
const FAILED: &str = "failed";

/// What is to be tried on it, by the variable that names some. Where only the other kind is named, none of this.
fn is_wanted(name: &str, variable: &str, other: &str) -> bool {
    match var(variable) {
        Ok(only) => only.split(',').any(|wanted| wanted == name || wanted == "all"),
        Err(_) => var(other).is_err(),
    }
}

/// Flies it; how long it took, seconds of the machine's time.
async fn flown(scenario: &Scenario, autopilot: &str) -> anyhow::Result<f64> {
    let mut rig = Rig::attach(autopilot, scenario.simulator).await?;
    println!("{}: the autopilot stands at {:?}", scenario.name, rig.field);
    let began_s = rig.seen.time_s;
    scenario.fly(&mut rig).await?;
    println!("{}", rig.story());
    Ok(rig.seen.time_s - began_s)
}

async fn fly(autopilot: &str) -> Outcomes {
    let mut outcomes = Outcomes::new();
    for scenario in scenarios().filter(|s| is_wanted(s.name, "LEGWORK_SCENARIOS", "LEGWORK_QUIRKS")) {
        let today = jiff::Timestamp::now().strftime("%Y-%m-%d");
        let outcome =
            flown(scenario, autopilot).await.map(|took_s| format!("passed, {took_s:.0} s, {today}"));
        outcomes.insert(scenario.name.to_owned(), told(scenario.name, outcome));
    }
    outcomes
}

fn try_quirks(autopilot: &str) -> anyhow::Result<Outcomes> {
    let is_wanted = |name: &str| is_wanted(name, "LEGWORK_QUIRKS", "LEGWORK_SCENARIOS");
    let mut wanted = quirks().filter(|quirk| is_wanted(quirk.name)).peekable();
    let mut outcomes = Outcomes::new();
    if wanted.peek().is_none() {
        return Ok(outcomes);
    }
    let whose = quirks::whose(autopilot)?;
    for quirk in wanted {
        let outcome = if quirk.of.contains(&whose) {
            told(quirk.name, quirk.check(autopilot).map(|()| "so it is".into()))
        } else {
            "–".into()
        };
        outcomes.insert(quirk.name.to_owned(), outcome);
    }
    Ok(outcomes)
}

fn told(name: &str, outcome: anyhow::Result<String>) -> String {
    let outcome = outcome.unwrap_or_else(|error| {
        println!("{error:#}");
        FAILED.into()
    });
    println!("{name}: {outcome}");
    outcome
}

/// Writes the outcomes into the documents, if that is wanted; the names of those that failed.
fn judged(table: &Table, outcomes: &Outcomes) -> Vec<String> {
    if let Ok(column) = var("LEGWORK_TABLE")
        && !outcomes.is_empty()
    {
        table.write(DOCUMENT, &column, outcomes).unwrap();
    }
    outcomes.iter().filter(|(_, outcome)| *outcome == FAILED).map(|(name, _)| name.clone()).collect()
}

/// The quirks come last: some of them leave the aircraft in the air.
#[tokio::test(flavor = "multi_thread")]
async fn real_autopilot_flies_the_programme_and_has_its_quirks() {
    let Ok(autopilot) = var("LEGWORK_AUTOPILOT") else {
        println!("not tried: set LEGWORK_AUTOPILOT, for example to tcp:127.0.0.1:5760");
        return;
    };
    let mut failed = judged(&programme::table(), &fly(&autopilot).await);
    let tried = tokio::task::spawn_blocking(move || try_quirks(&autopilot)).await.unwrap().unwrap();
    failed.extend(judged(&quirks::table(), &tried));
    assert!(failed.is_empty(), "{failed:?}");
}

/// Each quirk on a simulator of its own that has it, all at the same time: they mostly wait.
fn simulate(autopilot: Autopilot) {
    let failed: Vec<_> = std::thread::scope(|scope| {
        let tried = quirks().filter(|quirk| quirk.of.contains(&autopilot));
        let tried: Vec<_> = tried.map(|quirk| scope.spawn(move || quirk.simulate(autopilot))).collect();
        tried.into_iter().filter_map(|tried| tried.join().unwrap().err()).collect()
    });
    let failed: Vec<_> = failed.iter().map(|error| format!("{error:#}")).collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn arduplane_personality_has_its_quirks() {
    simulate(Autopilot::ArduPlane);
}

#[test]
fn px4_personality_has_its_quirks() {
    simulate(Autopilot::Px4);
}
