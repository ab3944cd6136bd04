//! Drives [`fuzz_targets::kmz`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::kmz(bytes));
