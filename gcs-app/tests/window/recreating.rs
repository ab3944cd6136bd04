//! Each of the example plans is made once more in an empty window, by gestures alone, and comes out as the same program.

mod author;
pub mod reading;
mod rows;

use author::Author;

fn recreate(example: &str) {
    let mut author = Author::begin(example);
    author.write_plan();
    author.compare();
}

#[test]
fn square() {
    recreate(super::SQUARE);
}

#[test]
fn alternates() {
    recreate(include_str!("../../../assets/plans/alternates.xml"));
}

#[test]
fn coast_patrol() {
    recreate(include_str!("../../../assets/plans/coast-patrol.xml"));
}

#[test]
fn fire_watch() {
    recreate(include_str!("../../../assets/plans/fire-watch.xml"));
}

#[test]
fn navaid_inspection() {
    recreate(include_str!("../../../assets/plans/navaid-inspection.xml"));
}

#[test]
fn pipeline() {
    recreate(include_str!("../../../assets/plans/pipeline.xml"));
}

#[test]
fn search() {
    recreate(include_str!("../../../assets/plans/search.xml"));
}
