//! Drives [`fuzz_targets::cel`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::cel(bytes));
