#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drape_fuzz::survive("/nowhere/a.stl", bytes));
