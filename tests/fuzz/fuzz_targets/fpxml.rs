//! Drives [`fuzz_targets::fpxml`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::fpxml(bytes));
