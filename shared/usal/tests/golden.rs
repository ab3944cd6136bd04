//! The contract as a file: every change of it shows as a difference.
#![cfg(test)]

use usal::Description;
use usal::spec::SERVICES;

/// `LEGWORK_BLESS=1 cargo test -p usal` rewrites the file: look at the difference before
/// committing it; it is a change of the contract.
#[test]
fn the_contract_is_the_one_in_the_golden_file() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/contract.json");
    let descriptions: Vec<Description> = SERVICES.iter().map(|service| service.describe()).collect();
    let now = serde_json::to_string_pretty(&descriptions).unwrap() + "\n";
    if std::env::var_os("LEGWORK_BLESS").is_some() {
        std::fs::write(path, &now).unwrap();
    }
    let golden = std::fs::read_to_string(path).unwrap_or_default();
    let first = golden.lines().zip(now.lines()).position(|(a, b)| a != b);
    assert!(
        golden == now,
        "the contract differs from contract.json, first in line {:?}",
        first.map(|n| n + 1)
    );
}
