//! Files of other programs: see `checks.rs`.

#![no_main]

#[path = "../checks.rs"]
#[expect(dead_code, reason = "the other target uses the rest")]
mod checks;

libfuzzer_sys::fuzz_target!(|data: &[u8]| checks::import(data));
