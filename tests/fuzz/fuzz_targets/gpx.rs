//! Drives [`fuzz_targets::gpx`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::gpx(bytes));
