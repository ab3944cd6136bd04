//! Drives [`fuzz_targets::waypoints`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::waypoints(bytes));
