//! The whole method from a program of your own:
//! `cargo run --release -p mesh-draping --example transfer -- SOURCE TARGET LANDMARKS OUT`
//!
//! It writes the bytes that `drape transfer SOURCE TARGET --landmarks LANDMARKS -o OUT` writes.

use mesh_draping::{landmarks, Error, Preset, Source, Target, Transfer};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let [source, target, pairs, out] = paths.as_slice() else {
        return Err("give SOURCE TARGET LANDMARKS OUT".into());
    };
    Ok(transfer(source, target, pairs, out)?)
}

fn transfer(source: &str, target: &str, pairs: &str, out: &str) -> Result<(), Error> {
    let source = Source::read(source)?;
    let target = Target::read(target)?;
    let landmarks = landmarks::read(pairs, &source, &target)?;
    let outcome = Transfer::new(&source, &target, &landmarks, Preset::standard()).run()?;
    outcome.write(out)
}
