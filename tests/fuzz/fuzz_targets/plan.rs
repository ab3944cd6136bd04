//! Drives [`fuzz_targets::plan`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::plan(bytes));
