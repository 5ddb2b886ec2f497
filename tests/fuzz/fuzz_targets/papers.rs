#![no_main]
// Run with -close_fd_mask=3: the command prints.
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drape_fuzz::place().papers(bytes));
