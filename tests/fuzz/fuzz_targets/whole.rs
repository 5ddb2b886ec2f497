#![no_main]
// The format is told by content alone; what takes one of a GLB's parts is among the seeds of the other targets.
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drape_fuzz::drape_both_ways("/nowhere/a", bytes));
