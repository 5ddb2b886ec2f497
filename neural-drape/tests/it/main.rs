//! The stepper as its users call it.

mod finish;
mod inputs;
mod landmarks;
mod paper;
mod part;
mod regions;
mod resume;
mod run;
mod schedule;
mod settings;
mod setup;
mod steps;
mod vertices;
