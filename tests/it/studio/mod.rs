//! The studio, used in a browser.

mod access;
mod big;
mod browser;
mod brushing;
mod budget;
mod curves;
mod defects;
mod discard;
mod going_on;
mod history;
mod inputs;
mod looks;
mod marks;
mod page;
mod painting;
mod pictures;
mod restart;
mod safety;
mod server;
mod session;
mod wire;
