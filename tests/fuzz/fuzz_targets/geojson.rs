//! Drives [`fuzz_targets::geojson`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::geojson(bytes));
