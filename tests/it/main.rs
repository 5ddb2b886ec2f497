//! End-to-end tests: the command as a user runs it, files in and files out.

mod architecture;
mod bad_input;
mod bake;
mod commands;
mod data;
mod gate;
mod landmarks;
mod nothing_misread;
mod real_pair;
mod regions;
mod seams;
mod studio;
mod study;
mod suite;
mod support;
mod transfer;
