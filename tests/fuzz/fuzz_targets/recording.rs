//! Drives [`fuzz_targets::recording`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::recording(bytes));
