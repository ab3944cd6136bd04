//! Drives [`fuzz_targets::executor`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::executor(bytes));
