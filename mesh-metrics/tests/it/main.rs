//! Tests of the public functions together.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod cloud;
mod invariance;
#[cfg(feature = "serde")]
mod json;
mod shifted_copy;
