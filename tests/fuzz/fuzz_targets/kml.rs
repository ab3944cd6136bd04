//! Drives [`fuzz_targets::kml`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::kml(bytes));
