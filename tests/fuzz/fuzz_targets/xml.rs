//! Drives [`fuzz_targets::xml`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::xml(bytes));
