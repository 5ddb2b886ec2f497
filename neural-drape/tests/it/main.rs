//! The stepper as its users call it.

mod inputs;
mod landmarks;
mod part;
mod regions;
mod resume;
mod run;
mod settings;
mod setup;
