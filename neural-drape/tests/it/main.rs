//! The stepper as its users call it.

mod landmarks;
mod run;
mod settings;
mod setup;
