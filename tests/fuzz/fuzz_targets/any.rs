#![no_main]
// No extension: the format is told by content alone; gzip is among the seeds.
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drape_fuzz::survive("/nowhere/a", bytes));
