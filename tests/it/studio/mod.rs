//! The studio, used in a browser.

mod big;
mod browser;
mod discard;
mod going_on;
mod inputs;
mod page;
mod pictures;
mod restart;
mod safety;
mod server;
mod session;
mod wire;
