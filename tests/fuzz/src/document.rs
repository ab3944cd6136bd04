//! The plan document.

use aircraft::Profile;
use flight_plan::xml::MAX_PROBLEMS;
use flight_plan::{Problem, check, compile, hash, read, write};
use terrain::Flat;

/// Above the sea, metres.
const GROUND_M: f64 = 200.0;

/// Any bytes as a document: read, checked, compiled, written. What can be flown is read again as it was written.
///
/// # Panics
/// A document that is compiled with errors or not without, or that changes when it is written.
pub fn xml(bytes: &[u8]) {
    let reading = read(bytes);
    assert!(reading.problems.len() <= MAX_PROBLEMS);
    let problems = check(&reading.plan, &Profile::default(), &Flat(GROUND_M));
    let written = write(&reading.plan);
    if reading.has_errors() {
        // what was made out of it can be written all the same
        return drop(read(&written));
    }
    let again = read(&written);
    assert!(!again.has_errors(), "what was written has errors: {:?}", again.problems);
    assert_eq!(again.plan, reading.plan, "written and read again");
    assert_eq!(hash(&again.plan), hash(&reading.plan));
    let program = compile(reading.plan, &Profile::default(), &Flat(GROUND_M));
    assert_eq!(program.is_ok(), !problems.iter().any(Problem::is_error));
}
