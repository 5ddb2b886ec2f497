//! Landmarks: their files, and a doctor who looks at them before and after a run.

pub(crate) mod doctor;
mod file;
pub(crate) mod mirror;
pub(crate) mod suggest;
pub(crate) mod text;

pub(crate) use file::{from_text, label, read};
