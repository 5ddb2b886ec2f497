//! The method as a user of the library has it.

mod background;
mod contact;
mod brush;
mod curves;
mod interactive;
mod parts;
mod run;
mod starts;
mod support;
mod targets;
