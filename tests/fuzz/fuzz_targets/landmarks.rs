#![no_main]
libfuzzer_sys::fuzz_target!(|text: &str| drape_fuzz::read_landmarks(text));
