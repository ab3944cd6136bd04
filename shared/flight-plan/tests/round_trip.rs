//! Any plan is written and read back unchanged, and the same plan gives the same bytes.
#![cfg(test)]

mod random;

use flight_plan::*;
use proptest::prelude::*;
use random::{has_duplicates, plan};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn reading_what_was_written_gives_the_plan_back(plan in plan()) {
        let document = write(&plan);
        let reading = read(&document);
        prop_assert_eq!(&reading.problems, &[]);
        prop_assert_eq!(&reading.plan, &plan);
        prop_assert_eq!(write(&reading.plan), document);
        prop_assert_eq!(hash(&reading.plan), hash(&plan));
    }

    #[test]
    fn different_plans_have_different_hashes(a in plan(), b in plan()) {
        prop_assert_eq!(hash(&a) == hash(&b), a == b);
        let told = flight_plan::diff::changes(&a, &b);
        prop_assert!(told.is_empty() == (a == b) || has_duplicates(&a) || has_duplicates(&b), "{:?}", told);
    }

    #[test]
    fn a_plan_does_not_differ_from_itself(plan in plan()) {
        prop_assert!(Difference::between(&plan, &plan).is_empty() || has_duplicates(&plan));
    }
}
