#![no_main]
// The fuzzer writes a document, a zero byte and a buffer; the sizes between them are put right here.
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drape_fuzz::survive(
    "/nowhere/a.glb",
    &drape_fuzz::glb(bytes)
));
