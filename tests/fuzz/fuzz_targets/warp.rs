#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drape_fuzz::load_warp(bytes));
