//! A pair built in code, whose true correspondence is known: no file is needed to see a drape.

mod creature;
mod files;

pub(crate) use files::write;
