//! The method as a user of the library has it.

mod background;
mod brush;
mod contact;
mod curves;
mod interactive;
mod parts;
mod run;
mod starts;
mod support;
mod targets;
